//! Cameras: position and lens, as a person writes them.

use glam::DVec3;

use super::bounds::Bounds;
use crate::math::view_from_world;

/// Smallest near distance that keeps every quotient of the vertex stage finite.
pub const MIN_NEAR_M: f64 = 1.0 / (1 << 20) as f64;

/// How depth becomes picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Vertical field of view in degrees, within (0, 180).
    Perspective { fov_y_deg: f64 },
    /// Height of the visible box in meters.
    Orthographic { height_m: f64 },
}

/// A pose: right-handed, y up, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    pub projection: Projection,
    /// Distance of the near plane in meters, at least [`MIN_NEAR_M`]. Only a perspective clips
    /// there.
    pub near_m: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 1.0, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y_deg: 45.0 },
            near_m: 0.01,
        }
    }
}

impl Camera {
    /// The nearest camera that looks along `direction` at the center of `bounds` and shows all of
    /// it with a small margin.
    pub fn framing(bounds: &Bounds, direction: DVec3, aspect: f64) -> Self {
        let fov_y_deg: f64 = 45.0;
        let tan_y = libm::tan(fov_y_deg.to_radians() * 0.5) * 0.92;
        let tan_x = tan_y * aspect.clamp(1e-3, 1e3);
        let direction = direction.try_normalize().unwrap_or(DVec3::NEG_Z);
        let turned = view_from_world(DVec3::ZERO, direction, DVec3::Y);
        let needed = |corner: DVec3| {
            let p = turned.transform_vector3(corner - bounds.center());
            p.z + (p.x.abs() / tan_x).max(p.y.abs() / tan_y)
        };
        let shown = bounds.corners().map(needed).into_iter().fold(0.0, f64::max);
        let distance = if bounds.is_empty() || shown <= 0.0 {
            2.5
        } else {
            shown
        };
        Self {
            eye: bounds.center() - direction * distance,
            target: bounds.center(),
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y_deg },
            near_m: (distance * 1e-3).max(MIN_NEAR_M),
        }
    }

    /// Unit vector from the eye to the target.
    pub fn forward(&self) -> DVec3 {
        (self.target - self.eye)
            .try_normalize()
            .unwrap_or(DVec3::NEG_Z)
    }
}
