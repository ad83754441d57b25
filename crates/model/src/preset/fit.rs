//! The fit of lengths and points from one scene to another.

use glam::DVec3;

use crate::{
    params::{Field, Measure},
    scene::{Bounds, camera::Camera},
};

/// Largest coordinate of a polyline, meters.
const FARTHEST_M: f64 = 1e9;

/// The unit of a preset's lengths and points: of its effects, their keyframes and the polyline.
/// Cameras are always in meters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// Meters; points in world space.
    #[default]
    Meter,
    /// The radius of the scene's box, half its diagonal; points count from the center of the box.
    Scene,
}

impl LengthUnit {
    pub(super) const ALL: [Self; 2] = [Self::Meter, Self::Scene];
    /// The words in files.
    pub const WORDS: &[&str] = &["m", "scene"];
}

/// From the box of one scene to the box of another: lengths grow with the radius, points move with
/// the center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    from: DVec3,
    to: DVec3,
    scale: f64,
    /// Nearest and farthest depth of both boxes as their cameras see them, meters.
    depths: Option<[[f64; 2]; 2]>,
}

impl Fit {
    /// From one box to another; none if one of them has no extent, so that there is nothing to
    /// compare.
    pub fn between(from: &Bounds, to: &Bounds) -> Option<Self> {
        let scale = to.radius() / from.radius();
        (scale.is_finite() && scale > 0.0).then(|| Self {
            from: from.center(),
            to: to.center(),
            scale,
            depths: None,
        })
    }

    /// From the unit of a scene with this box to meters; none if the box has no extent.
    pub fn of_scene_unit(bounds: &Bounds) -> Option<Self> {
        let scale = bounds.radius();
        (scale.is_finite() && scale > 0.0).then(|| Self {
            from: DVec3::ZERO,
            to: bounds.center(),
            scale,
            depths: None,
        })
    }

    /// The same place, counted from another point.
    #[must_use]
    pub fn counted_from(self, origin: DVec3) -> Self {
        Self {
            to: self.to - origin,
            ..self
        }
    }

    /// From the world of a scene to the same, counted from another point.
    pub(super) fn to_origin(origin: DVec3) -> Self {
        Self {
            from: origin,
            to: DVec3::ZERO,
            scale: 1.0,
            depths: None,
        }
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            scale: 1.0 / self.scale,
            depths: self.depths.map(|[from, to]| [to, from]),
        }
    }

    /// The fit of depths from what one camera sees of its box to what another sees of its own.
    /// Without it depths are lengths.
    #[must_use]
    pub fn with_cameras(self, from: (&Camera, &Bounds), to: (&Camera, &Bounds)) -> Self {
        let depths = [from, to].map(|(camera, bounds)| {
            let forward = camera.forward();
            let depths = bounds.corners().map(|p| (p - camera.eye).dot(forward));
            let near = depths.into_iter().fold(f64::INFINITY, f64::min);
            let far = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
            [near.max(0.0), far]
        });
        let is_known = depths
            .iter()
            .all(|[near, far]| far.is_finite() && far > near);
        Self {
            depths: is_known.then_some(depths),
            ..self
        }
    }

    /// A depth of the first box is `offset` plus `scale` times one of the second.
    pub(super) fn depth_line(&self) -> Option<[f64; 2]> {
        let [[near, far], [other_near, other_far]] = self.depths?;
        let scale = (far - near) / (other_far - other_near);
        Some([near - other_near * scale, scale])
    }

    /// Where a point comes to lie.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.to + (point - self.from) * self.scale
    }

    pub(super) fn is_identity(&self) -> bool {
        self.from == self.to && self.scale == 1.0 && self.depths.is_none_or(|[from, to]| from == to)
    }

    /// The components of a value of `field`, inside its range, and whether they had to be moved
    /// into it.
    pub(super) fn components(&self, field: &Field, value: &[f64]) -> (Vec<f64>, bool) {
        let fitted: Vec<f64> = match (field.measure(), value) {
            (Measure::Length, _) => value.iter().map(|v| v * self.scale).collect(),
            (Measure::PerLength, _) => value.iter().map(|v| v / self.scale).collect(),
            (Measure::Depth | Measure::PerDepth, [value]) => {
                let [offset, per] = self.depth_line().unwrap_or([0.0, 1.0 / self.scale]);
                vec![match field.measure() {
                    Measure::Depth => ((value - offset) / per).max(field.hard[0]),
                    _ => value * per,
                }]
            }
            (Measure::Height, [height]) => vec![self.point(DVec3::Y * *height).y],
            (Measure::Point, [x, y, z]) => self.point(DVec3::new(*x, *y, *z)).to_array().to_vec(),
            _ => value.to_vec(),
        };
        let [low, high] = field.hard;
        let clamped: Vec<f64> = fitted.iter().map(|v| v.clamp(low, high)).collect();
        let is_clamped = clamped != fitted;
        (clamped, is_clamped)
    }

    /// The polyline at its new place. Points that fall together become one.
    pub(super) fn polyline(&self, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let moved = |point: &[f32; 3]| {
            let point = self.point(DVec3::from(point.map(f64::from)));
            point
                .clamp(DVec3::splat(-FARTHEST_M), DVec3::splat(FARTHEST_M))
                .as_vec3()
                .to_array()
        };
        let mut fitted: Vec<[f32; 3]> = points.iter().map(moved).collect();
        fitted.dedup();
        if fitted.len() < 2 { Vec::new() } else { fitted }
    }
}
