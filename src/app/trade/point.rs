//! The points of a measurement: time and error of each combination, and which combinations are on
//! the Pareto front.

use crate::{
    accuracy::{Axis, PinnedOptions},
    measure::timing::Spread,
};

/// A kind of error. Each is 0 where the picture is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Pixels that show another triangle than the exact picture.
    #[default]
    Wrong,
    /// Largest difference of a color channel.
    Color,
    /// Samples that are covered and not drawn, or drawn more often than covered.
    Coverage,
    /// Pixels that face a light and get more than half of it too much or too little.
    Light,
}

impl Metric {
    pub const ALL: [Self; 4] = [Self::Wrong, Self::Color, Self::Coverage, Self::Light];

    /// The metrics that these points have: light only if the scene has one.
    pub fn of(points: &[Point]) -> Vec<Self> {
        Self::ALL
            .into_iter()
            .filter(|metric| {
                *metric != Self::Light || points.iter().any(|point| point.error(*metric).is_some())
            })
            .collect()
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Wrong => "by rounding",
            Self::Color => "color difference",
            Self::Coverage => "holes and doubles",
            Self::Light => "wrong light",
        }
    }

    pub const fn unit(self) -> &'static str {
        match self {
            Self::Wrong => "px",
            Self::Color => "of 255",
            Self::Coverage => "per Mpx",
            Self::Light => "ppm",
        }
    }
}

/// The time and the error of one combination.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The option on every axis that was measured.
    pub pins: PinnedOptions,
    /// Milliseconds; none where it could not run or has no timer.
    pub ms: Option<Spread>,
    pub samples: usize,
    /// In the order of [`Metric::ALL`].
    pub errors: [Option<f64>; Metric::ALL.len()],
    /// Further numbers, each with its name and unit.
    pub more: Vec<(String, f64)>,
    /// Why it could not be drawn, or what dominates it.
    pub note: Option<String>,
}

impl Point {
    pub fn error(&self, metric: Metric) -> Option<f64> {
        self.errors[metric as usize].filter(|error| error.is_finite())
    }

    /// Time and error, where both were measured.
    pub fn position(&self, metric: Metric) -> Option<(Spread, f64)> {
        let ms = self.ms.filter(|ms| ms.p50.is_finite() && ms.p50 > 0.0)?;
        Some((ms, self.error(metric)?.max(0.0)))
    }
}

/// Where a point stands among all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// On the Pareto front: every other that is at least as exact is slower, by more than the
    /// noise.
    Front,
    /// Noise decides whether another that is at least as exact is quicker.
    Tied,
    /// Another that is at least as exact is quicker, by more than the noise.
    Dominated,
}

/// Where each point stands in time and error; none for those that were not measured.
pub fn standings(points: &[Point], metric: Metric) -> Vec<Option<Standing>> {
    let positions: Vec<_> = points.iter().map(|point| point.position(metric)).collect();
    let standing = |at: usize| {
        let (ms, error) = positions[at]?;
        let others = positions
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at)
            .filter_map(|(_, position)| *position);
        let as_exact: Vec<Spread> = others
            .filter(|(_, other)| *other <= error)
            .map(|(ms, _)| ms)
            .collect();
        Some(match () {
            () if as_exact.iter().any(|other| other.is_clearly_below(&ms)) => Standing::Dominated,
            () if as_exact.iter().all(|other| ms.is_clearly_below(other)) => Standing::Front,
            () => Standing::Tied,
        })
    };
    (0..points.len()).map(standing).collect()
}

/// The table as comma-separated values, a column for every measured axis.
pub fn csv(points: &[Point], axes: &[&'static Axis]) -> String {
    let cell = |text: &str| {
        if text.contains([',', '"', '\n']) {
            format!("\"{}\"", text.replace('"', "\"\""))
        } else {
            text.to_owned()
        }
    };
    let mut head: Vec<String> = axes.iter().map(|axis| axis.name.to_owned()).collect();
    head.extend(["ms p5", "ms p50", "ms p95", "samples"].map(str::to_owned));
    let metrics = Metric::of(points);
    head.extend(
        metrics
            .iter()
            .map(|metric| format!("{} {}", metric.name(), metric.unit())),
    );
    let more = points
        .iter()
        .map(|point| &point.more)
        .max_by_key(|more| more.len());
    head.extend(more.into_iter().flatten().map(|(name, _)| name.clone()));
    head.push("note".into());
    let mut text = head.join(",") + "\n";
    for point in points {
        let mut line: Vec<String> = axes
            .iter()
            .map(|axis| {
                point
                    .pins
                    .get(axis)
                    .map_or(String::new(), |option| axis.words[option].to_owned())
            })
            .collect();
        let number = |value: Option<f64>| {
            value.map_or_else(|| "not measured".into(), |value| value.to_string())
        };
        line.extend([0, 1, 2].map(|i| number(point.ms.map(|ms| [ms.p5, ms.p50, ms.p95][i]))));
        line.push(point.samples.to_string());
        line.extend(
            metrics
                .iter()
                .map(|metric| number(point.errors[*metric as usize])),
        );
        let further = |i: usize| point.more.get(i).map(|(_, value)| *value);
        line.extend((0..more.map_or(0, Vec::len)).map(|i| number(further(i))));
        line.push(cell(point.note.as_deref().unwrap_or_default()));
        text += &(line.join(",") + "\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{Coverage, DepthFormat};

    /// Thirty samples, up to a tenth above `ms`.
    fn point(coverage: Coverage, depth: DepthFormat, ms: f64, wrong: f64) -> Point {
        let samples: Vec<f64> = (0..30)
            .map(|i| ms * (1.0 + 0.01 * f64::from(i % 11)))
            .collect();
        Point {
            pins: PinnedOptions::of(coverage).with(depth),
            ms: Spread::of(&samples),
            samples: 30,
            errors: [Some(wrong), Some(0.0), None, None],
            more: vec![("bytes".into(), 7.0)],
            note: None,
        }
    }

    fn points() -> Vec<Point> {
        vec![
            point(Coverage::Float, DepthFormat::Ndc16, 1.0, 500.0),
            point(Coverage::Float, DepthFormat::Reversed, 1.5, 200.0),
            point(Coverage::Fixed8, DepthFormat::Ndc16, 2.0, 300.0),
            point(Coverage::Fixed8, DepthFormat::Reversed, 2.5, 0.0),
            point(Coverage::Fixed12, DepthFormat::Reversed, 3.0, 0.0),
        ]
    }

    #[test]
    fn the_front_holds_what_nothing_dominates() {
        use Standing::{Dominated, Front};
        assert_eq!(
            standings(&points(), Metric::Wrong),
            [Front, Front, Dominated, Front, Dominated].map(Some)
        );
        let expected = [Front, Dominated, Dominated, Dominated, Dominated].map(Some);
        assert_eq!(
            standings(&points(), Metric::Color),
            expected,
            "all are exact, so only the fastest is on the front"
        );
        assert_eq!(
            standings(&points(), Metric::Coverage),
            [None; 5],
            "not measured is no point"
        );
    }

    #[test]
    fn noise_decides_no_front() {
        use Standing::{Dominated, Front, Tied};
        let at = |ms: f64, wrong: f64| point(Coverage::Fixed8, DepthFormat::Reversed, ms, wrong);
        // The second seems to be quicker by 1 %, and the third is slower by far.
        assert_eq!(
            standings(&[at(1.01, 0.0), at(1.0, 0.0), at(2.0, 0.0)], Metric::Wrong),
            [Tied, Tied, Dominated].map(Some)
        );
        // The times do not differ beyond the noise, so its error saves no time that was measured.
        assert_eq!(
            standings(&[at(1.0, 9.0), at(1.01, 0.0)], Metric::Wrong),
            [Tied, Front].map(Some)
        );
        assert_eq!(
            standings(&[at(1.0, 9.0), at(2.0, 0.0)], Metric::Wrong),
            [Front, Front].map(Some)
        );
        assert_eq!(
            standings(&[at(1.0, 9.0)], Metric::Wrong),
            [Some(Front)],
            "alone"
        );
    }

    #[test]
    fn csv_has_a_column_for_every_axis_and_says_what_was_not_measured() {
        let axes = ["coverage", "depth"].map(|name| Axis::find(name).expect("an axis"));
        let mut points = points();
        points.truncate(1);
        points[0].note = Some("a, b".into());
        let text = csv(&points, &axes);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines[0],
            "coverage,depth,ms p5,ms p50,ms p95,samples,by rounding px,color difference of 255,holes and doubles per Mpx,bytes,note"
        );
        let ms = points[0].ms.expect("it was timed");
        let expected = format!(
            "float,ndc16,{},{},{},30,500,0,not measured,7,\"a, b\"",
            ms.p5, ms.p50, ms.p95
        );
        assert_eq!(lines[1], expected);
    }
}
