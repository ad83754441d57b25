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
