//! What the page and the worker that measures tell each other, as TOML.

use serde::{Deserialize, Serialize};

use super::{
    point::{Metric, Point},
    request::Report,
};
use crate::{
    accuracy::{AXES, Axis, PinnedOptions},
    app::picture::sent::{in_words, of_words},
    measure::timing::Spread,
};

#[derive(Serialize, Deserialize)]
struct PointsInWords {
    points: Vec<PointInWords>,
}

/// A point; TOML has no list with gaps.
#[derive(Serialize, Deserialize)]
struct PointInWords {
    /// Indices of axes, each with that of its option.
    pins: Vec<[usize; 2]>,
    /// 5, 50 and 95 %, and the interval of the median.
    ms: Option<[f64; 5]>,
    samples: usize,
    /// NaN where nothing was measured.
    errors: [f64; Metric::ALL.len()],
    more: Vec<(String, f64)>,
    note: Option<String>,
}

impl PointInWords {
    fn of(point: &Point) -> Self {
        let pinned = |(index, axis)| Some([index, point.pins.get(axis)?]);
        Self {
            pins: AXES.iter().enumerate().filter_map(pinned).collect(),
            ms: point
                .ms
                .map(|ms| [ms.p5, ms.p50, ms.p95, ms.median[0], ms.median[1]]),
            samples: point.samples,
            errors: point.errors.map(|error| error.unwrap_or(f64::NAN)),
            more: point.more.clone(),
            note: point.note.clone(),
        }
    }

    fn point(self) -> Point {
        let mut pins = PinnedOptions::default();
        for [index, option] in self.pins {
            if let Some(axis) = AXES.get(index).filter(|axis| option < axis.words.len()) {
                pins.set(axis, Some(option));
            }
        }
        let spread = |[p5, p50, p95, low, high]: [f64; 5]| Spread {
            p5,
            p50,
            p95,
            median: [low, high],
        };
        Point {
            pins,
            ms: self.ms.map(spread),
            samples: self.samples,
            errors: self.errors.map(|error| Some(error).filter(|e| !e.is_nan())),
            more: self.more,
            note: self.note,
        }
    }
}

/// The points for [`received`].
///
/// # Errors
/// None that is known.
pub fn sent(points: &[Point]) -> Result<String, String> {
    in_words(&PointsInWords {
        points: points.iter().map(PointInWords::of).collect(),
    })
}

/// The points that a worker has sent.
///
/// # Errors
/// It has sent something else.
pub fn received(text: &str) -> Result<Vec<Point>, String> {
    let words: PointsInWords = of_words(text)?;
    Ok(words.points.into_iter().map(PointInWords::point).collect())
}

/// The report for [`heard`].
///
/// # Errors
/// None that is known.
pub fn told(report: &Report) -> Result<String, String> {
    in_words(report)
}

/// The report that a worker has told; none if that is something else.
pub fn heard(text: &str) -> Option<Report> {
    of_words(text).ok()
}

/// Axes by their names, for [`named`].
pub fn names(axes: &[&'static Axis]) -> String {
    axes.iter()
        .map(|axis| axis.name)
        .collect::<Vec<_>>()
        .join(" ")
}

/// The axes of these names.
pub fn named(names: &str) -> Vec<&'static Axis> {
    names.split(' ').filter_map(Axis::find).collect()
}
