//! Statistics of timings.

/// The `p`-quantile (0 to 1) by linear interpolation between the sorted samples; none without samples.
pub fn percentile(samples: &[f64], p: f64) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let position = p.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    Some(low + (high - low) * position.fract())
}

/// Samples more than five (scaled) median absolute deviations from the median.
pub fn outliers(samples: &[f64]) -> usize {
    // The standard deviation of a normal distribution, in median absolute deviations.
    const NORMAL: f64 = 1.4826;
    let Some(median) = percentile(samples, 0.5) else { return 0 };
    let distances: Vec<f64> = samples.iter().map(|sample| (sample - median).abs()).collect();
    let mad = percentile(&distances, 0.5).unwrap_or(0.0) * NORMAL;
    distances.iter().filter(|distance| **distance > 5.0 * mad && mad > 0.0).count()
}

#[cfg(test)]
mod tests {
    use super::{outliers, percentile};

    #[test]
    fn outliers_are_those_far_from_most() {
        assert_eq!(outliers(&[1.0, 1.1, 0.9, 1.05, 0.95, 9.0]), 1);
        assert_eq!(outliers(&[1.0; 8]), 0);
        assert_eq!(outliers(&[]), 0);
    }

    #[test]
    fn percentiles_interpolate_and_ignore_order() {
        assert_eq!(percentile(&[3.0, 1.0, 2.0], 0.5), Some(2.0));
        assert_eq!(percentile(&[1.0, 2.0], 0.5), Some(1.5));
        assert_eq!(percentile(&[1.0, 2.0, 3.0], 1.0), Some(3.0));
        assert_eq!(percentile(&[], 0.5), None);
    }
}
