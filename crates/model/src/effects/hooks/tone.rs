//! Tones and colors that several effects compute alike.

use glam::{DVec2, DVec3, DVec4};

use crate::math::srgb;

/// A color parameter, linear.
pub fn rgb(c: [f32; 4]) -> DVec3 {
    DVec3::new(c[0].into(), c[1].into(), c[2].into())
}

/// A color parameter, gamma-encoded; alpha as it is.
pub fn encoded(c: [f32; 4]) -> DVec4 {
    let [r, g, b, alpha] = c.map(f64::from);
    DVec4::new(srgb(r), srgb(g), srgb(b), alpha)
}

/// From 0 at `low` to 1 at `high` without a kink (Hermite).
pub fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Relative luminance of linear RGB (Rec. 709).
pub fn luminance(linear: DVec3) -> f64 {
    linear.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Rank of a cell in the order in which a matrix of ordered dithering (Bayer 1973) with a side of
/// 2^bits fills up: for every bit, the checkerboard first. 0 to 4^bits - 1.
pub fn bayer_rank(x: u32, y: u32, bits: u32) -> u32 {
    (0..bits).fold(0, |rank, bit| {
        rank << 2 | ((x ^ y) >> bit & 1) << 1 | y >> bit & 1
    })
}

/// Cosine and sine of an angle in degrees. Its mirror in `shaders/lib/angle.wgsl` is a polynomial,
/// since the functions built into WGSL may err by 2^-11, which is a sixth of a pixel across a small
/// picture.
pub fn turned(degrees: f64) -> DVec2 {
    let quarters = (degrees / 90.0).round();
    let x = (degrees - 90.0 * quarters) * (std::f64::consts::PI / 180.0);
    let (cos, sin) = (libm::cos(x), libm::sin(x));
    match quarters.rem_euclid(4.0) as u32 {
        0 => DVec2::new(cos, sin),
        1 => DVec2::new(-sin, cos),
        2 => DVec2::new(-cos, -sin),
        _ => DVec2::new(sin, -cos),
    }
}
