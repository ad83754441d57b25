//! What a parameter measures in space, from its unit: how its value changes when the scene is
//! larger or lies elsewhere.

use super::value::ValueType;

/// What a value measures in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Nothing: the value is the same for a scene of any size.
    None,
    /// A length, a speed or an acceleration, which grows with the scene.
    Length,
    /// The inverse of a length, such as a density.
    PerLength,
    /// A distance from the eye along the viewing direction.
    Depth,
    /// The inverse of a length along the viewing direction.
    PerDepth,
    /// A point in world space.
    Point,
    /// A height in world space, along y.
    Height,
}

impl Measure {
    /// What a parameter of this type and unit measures. Directions are points without a unit, and
    /// extents are points whose range, which begins at `low`, has no negative numbers.
    pub(super) fn of(value_type: &ValueType, unit: &str, low: f64, is_height: bool) -> Self {
        let is_point = matches!(value_type, ValueType::Point | ValueType::Position);
        let is_number = matches!(value_type, ValueType::F32 | ValueType::F64);
        match unit {
            "m" if is_point && low < 0.0 => Self::Point,
            "m" if is_number && is_height => Self::Height,
            "m" if is_point => Self::Length,
            "m" | "cm" | "mm" | "m/s" | "m/s²" if is_number => Self::Length,
            "per m" if is_number => Self::PerLength,
            _ => Self::None,
        }
    }
}
