//! Colors: numbers as they are shown on a screen (sRGB), in linear light.

use crate::math::linear_light;

/// The brightest light, the largest finite f16.
const BRIGHTEST: f32 = 65_504.0;

/// Linear light of a color from 0 up. What is brighter than white is linear already.
pub fn linear(color: [f32; 3]) -> [f32; 3] {
    color.map(|value| match value.max(0.0) {
        value if value <= 1.0 => linear_light(value.into()) as f32,
        value => value.min(BRIGHTEST),
    })
}

/// A color of a vertex from 0 to 1 in linear light, in units of 1/65535; the last is unused.
pub fn of_vertex(color: [f32; 3]) -> [u16; 4] {
    let unit = |value: f32| (linear_light(value.clamp(0.0, 1.0).into()) * 65_535.0).round() as u16;
    let [r, g, b] = color.map(unit);
    [r, g, b, u16::MAX]
}
