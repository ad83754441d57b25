//! Axis-aligned boxes.

use glam::{DMat4, DVec3};

/// Exclusive limit of the magnitude of a matrix entry or a coordinate, 2^40: below it all products
/// are finite in f32.
pub const MAX_MAGNITUDE: f64 = (1u64 << 40) as f64;

/// Exclusive limit of the coordinates that readers keep, 2^36: the matrices of a camera that frames
/// such places stay below [`MAX_MAGNITUDE`].
pub const MAX_PLACE: f64 = (1u64 << 36) as f64;

/// Is it a place that can be drawn?
pub fn is_near(place: [f64; 3]) -> bool {
    place.iter().all(|value| value.abs() < MAX_PLACE)
}

/// Axis-aligned box in meters, both ends included. Empty when `min` exceeds `max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates.
    pub min: DVec3,
    /// The largest coordinates.
    pub max: DVec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// A box without points.
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// Returns true if the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Grows the box to contain `point`.
    pub fn include(&mut self, point: DVec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Includes `bounds`, grown by `margin` on every side and then transformed by `matrix`.
    pub fn include_transformed(&mut self, matrix: &DMat4, bounds: &Self, margin: f64) {
        if !bounds.is_empty() {
            let grown = Self {
                min: bounds.min - margin,
                max: bounds.max + margin,
            };
            grown
                .corners()
                .into_iter()
                .for_each(|corner| self.include(matrix.transform_point3(corner)));
        }
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    self.min[axis]
                } else {
                    self.max[axis]
                }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The center; the origin when empty.
    pub fn center(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            (self.min + self.max) * 0.5
        }
    }

    /// Half the length of the diagonal; 0 when empty.
    pub fn radius(&self) -> f64 {
        if self.is_empty() {
            0.0
        } else {
            (self.max - self.min).length() * 0.5
        }
    }
}
