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

/// Have the samples settled: do the medians of the last `window` samples and of the `window` before them differ by at most
/// `tolerance`, as a fraction?
pub fn is_settled(samples: &[f64], window: usize, tolerance: f64) -> bool {
    let Some(begin) = samples.len().checked_sub(2 * window).filter(|_| window > 0) else { return false };
    let (before, last) = samples[begin..].split_at(window);
    match (percentile(before, 0.5), percentile(last, 0.5)) {
        (Some(before), Some(last)) => (last - before).abs() <= tolerance * before.abs(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::{is_settled, outliers, percentile};

    #[test]
    fn samples_settle_when_their_median_stays() {
        // The clock of an idle device rises.
        let mut rising: Vec<f64> = (0..20).map(|i| 0.77 - 0.027 * f64::from(i)).collect();
        assert!(!is_settled(&rising, 5, 0.02));
        rising.extend([0.23, 0.231, 0.229, 0.9, 0.23, 0.23, 0.228, 0.231, 0.23, 0.23]);
        assert!(is_settled(&rising, 5, 0.02), "one outlier does not matter");
        assert!(!is_settled(&[1.0; 9], 5, 0.02), "two windows are needed");
    }

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
