//! Statistics of timings.

/// The `p`-quantile (0 to 1) by linear interpolation between the sorted samples; none without
/// samples.
pub fn percentile(samples: &[f64], p: f64) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let position = p.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (
        sorted[position.floor() as usize],
        sorted[position.ceil() as usize],
    );
    Some(low + (high - low) * position.fract())
}

/// Samples more than five (scaled) median absolute deviations from the median.
pub fn outliers(samples: &[f64]) -> usize {
    // The standard deviation of a normal distribution, in median absolute deviations.
    const NORMAL: f64 = 1.4826;
    let Some(median) = percentile(samples, 0.5) else {
        return 0;
    };
    let distances: Vec<f64> = samples
        .iter()
        .map(|sample| (sample - median).abs())
        .collect();
    let mad = percentile(&distances, 0.5).unwrap_or(0.0) * NORMAL;
    distances
        .iter()
        .filter(|distance| **distance > 5.0 * mad && mad > 0.0)
        .count()
}

/// Have the samples settled: do the medians of the last `window` samples and of the `window` before
/// them differ by at most `tolerance`, as a fraction?
pub fn is_settled(samples: &[f64], window: usize, tolerance: f64) -> bool {
    let Some(begin) = samples.len().checked_sub(2 * window).filter(|_| window > 0) else {
        return false;
    };
    let (before, last) = samples[begin..].split_at(window);
    match (percentile(before, 0.5), percentile(last, 0.5)) {
        (Some(before), Some(last)) => (last - before).abs() <= tolerance * before.abs(),
        _ => false,
    }
}

/// How timings are spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    pub p5: f64,
    pub p50: f64,
    pub p95: f64,
    /// The interval in which the true median lies with a probability of at least 95 % for every
    /// distribution: two of the sorted samples. Anywhere from 0 up where there are too few
    /// samples to tell.
    pub median: [f64; 2],
}

impl Spread {
    /// None without samples.
    pub fn of(samples: &[f64]) -> Option<Self> {
        let at = |p: f64| percentile(samples, p);
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = match outer_ranks(sorted.len()) {
            Some([low, high]) => [sorted[low], sorted[high]],
            None => [0.0, f64::INFINITY],
        };
        Some(Self {
            p5: at(0.05)?,
            p50: at(0.5)?,
            p95: at(0.95)?,
            median,
        })
    }

    /// Is it quicker by more than the noise? The intervals of the medians must not overlap.
    pub fn is_clearly_below(&self, other: &Self) -> bool {
        self.median[1] < other.median[0]
    }
}

/// Indices of the two of `count` sorted samples between which the median lies with a probability of
/// at least 95 %; none of fewer than six samples. Each sample lies below the median with a
/// probability of one half, so the number of those below is binomial.
fn outer_ranks(count: usize) -> Option<[usize; 2]> {
    const TAIL: f64 = 0.025;
    // Of many samples the distribution is normal, and 2^-count is no float any more.
    if count > 1000 {
        let half_width = 1.96 * (count as f64).sqrt() / 2.0;
        let low = ((count as f64 / 2.0 - half_width).floor() as usize).min(count - 1);
        return Some([low, count - 1 - low]);
    }
    let mut probability = libm::exp2(-(count as f64));
    let (mut tail, mut low) = (0.0, None);
    for below in 0..count / 2 {
        tail += probability;
        if tail > TAIL {
            break;
        }
        low = Some(below);
        probability *= (count - below) as f64 / (below + 1) as f64;
    }
    low.map(|low| [low, count - 1 - low])
}

#[cfg(test)]
mod tests {
    use super::{Spread, is_settled, outer_ranks, outliers, percentile};

    #[test]
    fn samples_settle_when_their_median_stays() {
        // The clock of an idle device rises.
        let mut rising: Vec<f64> = (0..20).map(|i| 0.77 - 0.027 * f64::from(i)).collect();
        assert!(!is_settled(&rising, 5, 0.02));
        rising.extend([
            0.23, 0.231, 0.229, 0.9, 0.23, 0.23, 0.228, 0.231, 0.23, 0.23,
        ]);
        assert!(is_settled(&rising, 5, 0.02), "one outlier does not matter");
        assert!(!is_settled(&[1.0; 9], 5, 0.02), "two windows are needed");
    }

    #[test]
    fn the_interval_of_a_median_has_the_ranks_of_the_tables() {
        // Nonparametric 95 % intervals of a median: ranks 1 and 6 of 6, 2 and 9 of 10, 6 and 15 of
        // 20, 10 and 21 of 30.
        let ranks = [5, 6, 10, 20, 30].map(outer_ranks);
        assert_eq!(
            ranks,
            [
                None,
                Some([0, 5]),
                Some([1, 8]),
                Some([5, 14]),
                Some([9, 20])
            ]
        );
        let [low, high] = outer_ranks(1001).expect("many samples");
        let [low_of_fewer, _] = outer_ranks(1000).expect("many samples");
        assert!(
            low + high == 1000 && low.abs_diff(low_of_fewer) <= 2,
            "{low} {low_of_fewer}"
        );
    }

    #[test]
    fn a_difference_within_the_noise_is_not_clear() {
        let around = |middle: f64| {
            Spread::of(
                &(0..30)
                    .map(|i| middle + 0.01 * f64::from(i % 10))
                    .collect::<Vec<_>>(),
            )
            .expect("samples")
        };
        assert!(
            around(1.0).is_clearly_below(&around(1.2))
                && !around(1.2).is_clearly_below(&around(1.0))
        );
        assert!(
            !around(1.0).is_clearly_below(&around(1.01))
                && !around(1.01).is_clearly_below(&around(1.0))
        );
        let few = |ms: f64| Spread::of(&[ms; 5]).expect("samples");
        assert!(
            !few(1.0).is_clearly_below(&few(9.0)),
            "five samples decide nothing"
        );
        assert_eq!(Spread::of(&[]), None);
        let one = Spread::of(&[3.0]).expect("a sample");
        assert_eq!((one.p5, one.p50, one.p95), (3.0, 3.0, 3.0));
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
