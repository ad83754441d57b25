//! The scale of the timeline: seconds to points and back.

use egui::Rect;

use crate::preset::animation::Track;

/// A range of seconds from the left to the right end of `rect`.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    from_s: f64,
    to_s: f64,
    rect: Rect,
}

impl Span {
    pub fn new([from_s, to_s]: [f64; 2], rect: Rect) -> Self {
        Self { from_s, to_s, rect }
    }

    pub fn x(&self, time_s: f64) -> f32 {
        let t = (time_s - self.from_s) / (self.to_s - self.from_s);
        self.rect.left() + (t.clamp(-1.0, 2.0) * f64::from(self.rect.width())) as f32
    }

    pub fn time_s(&self, x: f32) -> f64 {
        self.from_s + f64::from(x - self.rect.left()) * self.seconds_per_point()
    }

    pub fn seconds_per_point(&self) -> f64 {
        (self.to_s - self.from_s) / f64::from(self.rect.width().max(1.0))
    }

    /// Begin and end, seconds.
    pub fn ends_s(&self) -> [f64; 2] {
        [self.from_s, self.to_s]
    }

    pub fn rect(&self) -> Rect {
        self.rect
    }
}

/// What the timeline shows: the range, and every keyframe outside it.
pub fn extent([from_s, to_s]: [f64; 2], tracks: &[&Track]) -> [f64; 2] {
    let times = tracks
        .iter()
        .flat_map(|track| track.keys())
        .map(|key| key.time_s);
    times.fold([from_s, to_s], |[low, high], time_s| {
        [low.min(time_s), high.max(time_s)]
    })
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_position_maps_back_to_its_time() {
        let span = Span::new(
            [-1.0, 3.0],
            Rect::from_min_max(pos2(100.0, 0.0), pos2(900.0, 10.0)),
        );
        for time_s in [-1.0, 0.0, 1.234, 3.0] {
            assert!(
                (span.time_s(span.x(time_s)) - time_s).abs() < 1e-3,
                "{time_s}"
            );
        }
    }
}
