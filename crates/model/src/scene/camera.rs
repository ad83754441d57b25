//! Cameras: position and lens, as a person writes them.

use glam::DVec3;

use super::bounds::Bounds;
use crate::math::view_from_world;

/// Smallest near distance that keeps every quotient of the vertex stage finite.
pub const MIN_NEAR_M: f64 = 1.0 / (1 << 20) as f64;

/// How much of the picture's smaller side a framed scene fills.
pub const FRAMED: f64 = 0.8;

/// How much of the picture a framed model fills, at least of its width or of its height.
pub const FILLED: f64 = 0.88;

/// The room in a picture that a framed model fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// How much of this is filled.
    part: f64,
    /// Width and height over the picture's height.
    sides: [f64; 2],
}

impl Frame {
    /// The square of which [`FRAMED`] tells. `aspect` is the picture's width over its height.
    pub fn square(aspect: f64) -> Self {
        Self {
            part: FRAMED,
            sides: [aspect.clamp(1e-3, 1.0); 2],
        }
    }

    /// The part of the whole picture of which [`FILLED`] tells.
    pub fn whole(aspect: f64) -> Self {
        Self {
            part: FILLED,
            sides: [aspect.clamp(1e-3, 1e3), 1.0],
        }
    }

    /// Width and height that are filled, of a picture of this height.
    pub fn filled(self, height: f64) -> [f64; 2] {
        self.sides.map(|side| height * self.part * side)
    }
}

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

    /// The camera that looks along `direction` and in whose picture `points` fill the frame across or
    /// down, in the middle.
    pub fn around(points: &[DVec3], direction: DVec3, frame: Frame) -> Self {
        let fov_y_deg: f64 = 45.0;
        let [across, down] = frame.filled(libm::tan(fov_y_deg.to_radians() * 0.5));
        let direction = direction.try_normalize().unwrap_or(DVec3::NEG_Z);
        let turned = view_from_world(DVec3::ZERO, direction, DVec3::Y);
        // Where the planes through the eye along the frame's sides must lie at least: x and y to
        // the right, left, top and bottom, z towards the eye.
        let (mut planes, mut near, mut far) =
            ([f64::NEG_INFINITY; 4], f64::NEG_INFINITY, f64::INFINITY);
        for point in points {
            let p = turned.transform_point3(*point);
            let asides = [(p.x, across), (-p.x, across), (p.y, down), (-p.y, down)];
            for (plane, (aside, side)) in planes.iter_mut().zip(asides) {
                *plane = plane.max(aside + side * p.z);
            }
            (near, far) = (near.max(p.z), far.min(p.z));
        }
        if points.is_empty() {
            return Self::framing(&Bounds::EMPTY, direction, 1.0);
        }
        let [right, left, top, bottom] = planes;
        let middle = (near + far) * 0.5;
        let apart = ((right + left) / (2.0 * across)).max((top + bottom) / (2.0 * down));
        let eye_z = apart.max(near);
        let distance = if eye_z - middle > 1e-9 * (1.0 + middle.abs()) {
            eye_z - middle
        } else {
            2.5
        };
        let back = turned.inverse();
        let at = |z: f64| {
            back.transform_point3(DVec3::new((right - left) * 0.5, (top - bottom) * 0.5, z))
        };
        Self {
            eye: at(middle + distance),
            target: at(middle),
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y_deg },
            near_m: (distance * 1e-3).max(MIN_NEAR_M),
        }
    }

    /// The same pose, counted from another point of the world.
    #[must_use]
    pub fn counted_from(self, origin: DVec3) -> Self {
        Self {
            eye: self.eye - origin,
            target: self.target - origin,
            ..self
        }
    }

    /// Unit vector from the eye to the target.
    pub fn forward(&self) -> DVec3 {
        (self.target - self.eye)
            .try_normalize()
            .unwrap_or(DVec3::NEG_Z)
    }
}
