//! Attribute values classified by their f32 bits, so that no float comparison decides what is drawn
//! (`docs/exactness.md` §2).

use crate::{
    frame::vertex_flags,
    scene::{Accessor, ComponentType},
};

/// The value of an f32, given its bits; a subnormal counts as 0.
/// Errors: [`vertex_flags::NONFINITE`] for NaN and infinities, [`vertex_flags::OUT_OF_RANGE`] for
/// magnitudes of 2^40 or more.
pub fn classified(bits: u32) -> Result<f64, u32> {
    match bits >> 23 & 255 {
        255 => Err(vertex_flags::NONFINITE),
        167.. => Err(vertex_flags::OUT_OF_RANGE),
        0 => Ok(0.0),
        _ => Ok(f32::from_bits(bits).into()),
    }
}

/// One component of an attribute, [`classified`] if it is an f32. Integers are always in range.
pub fn component(
    bytes: &[u8],
    accessor: &Accessor,
    element: u32,
    component: u32,
) -> Result<f64, u32> {
    match accessor.component_type {
        ComponentType::F32 => classified(accessor.f32_bits(bytes, element, component)),
        _ => Ok(accessor.value(bytes, element, component)),
    }
}
