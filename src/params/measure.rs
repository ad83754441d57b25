//! What a parameter measures in space, from its unit: how its value changes when the scene is larger or lies elsewhere.

use super::{Param, ValueType};

/// What a value measures in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Nothing: the value is the same for a scene of any size.
    None,
    /// A length, a speed or an acceleration, which grows with the scene.
    Length,
    /// The inverse of a length, such as a density.
    PerLength,
    /// A point in world space.
    Point,
    /// A height in world space, along y.
    Height,
}

impl Param {
    /// What the value measures. Directions are points without a unit, and extents are never negative.
    pub fn measure(&self) -> Measure {
        let is_continuous = matches!(self.value_type, ValueType::F32 | ValueType::F64);
        match (self.value_type, self.unit) {
            (ValueType::Point | ValueType::Position, "m") if self.hard[0] < 0.0 => Measure::Point,
            (ValueType::Point | ValueType::Position, "m") => Measure::Length,
            (_, "m") if self.height => Measure::Height,
            (_, "m" | "cm" | "mm" | "m/s" | "m/s²") if is_continuous => Measure::Length,
            (_, "per m") if is_continuous => Measure::PerLength,
            _ => Measure::None,
        }
    }
}
