//! Constants of the sub-pixel grid, distances between floats, f64 matrices rounded once to f32,
//! gamma encoding and hashes.
//!
//! A matrix is named after the spaces it connects, so that adjacent names cancel:
//! `clip_from_object = clip_from_world * world_from_object`.

use glam::{DMat4, DVec3};

/// Bits of the fraction of a snapped position by default (16.8 fixed point).
pub const SUBPIXEL_BITS: u32 = 8;

/// Sub-pixel units in a pixel with that many bits.
pub const UNITS_PER_PIXEL: i32 = 1 << SUBPIXEL_BITS;

/// The largest disc of a point has this radius, in pixels: with the triangle about it it is small.
pub const MAX_POINT_RADIUS_PX: f64 = 32.0;

/// Largest |x| and |y| of a snapped vertex that needs no guard-band clipping, in units of 1/256 px
/// (32,767.996 px; symmetric, and exact in an f32).
pub const GUARD_BAND: i32 = 8_388_607;

/// Side of a square in which every edge function fits an i32, in units of 1/256 px: 128 px, a whole
/// number of blocks. The limit is 181 px; the difference allows for blocks that overhang.
pub const SMALL_EXTENT: i32 = 128 * UNITS_PER_PIXEL;

/// Distance between two floats in units in the last place: 0 for equal values and for +0 and -0,
/// `u32::MAX` if one is NaN.
pub fn ulp_distance(a: f32, b: f32) -> u32 {
    if a.is_nan() || b.is_nan() {
        return u32::MAX;
    }
    let ordered = |v: f32| {
        let bits = v.to_bits() as i32;
        i64::from(if bits < 0 {
            i32::MIN.wrapping_sub(bits)
        } else {
            bits
        })
    };
    ordered(a).abs_diff(ordered(b)).min(u64::from(u32::MAX)) as u32
}

/// Columns of a matrix, each entry rounded once from f64 to f32.
pub fn rounded_columns(m: &DMat4) -> [[f32; 4]; 4] {
    m.to_cols_array_2d().map(|column| column.map(|v| v as f32))
}

/// Rigid view matrix (right-handed, looking down -z). `eye` and `target` must differ and `up` must
/// not be parallel to the view direction; otherwise another up axis is used, so the result is
/// always finite.
pub fn view_from_world(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let back = (eye - target).try_normalize().unwrap_or(DVec3::Z);
    let right = [up, DVec3::Y, DVec3::X]
        .into_iter()
        .find_map(|up| up.cross(back).try_normalize())
        .unwrap_or(DVec3::X);
    let up = back.cross(right);
    DMat4::from_cols(
        DVec3::new(right.x, up.x, back.x).extend(0.0),
        DVec3::new(right.y, up.y, back.y).extend(0.0),
        DVec3::new(right.z, up.z, back.z).extend(0.0),
        DVec3::new(-right.dot(eye), -up.dot(eye), -back.dot(eye)).extend(1.0),
    )
}

/// Rotation about +y by `radians`, computed by a pure-Rust maths library, so that every host gets
/// the same bits.
pub fn rotation_y(radians: f64) -> DMat4 {
    let (sin, cos) = libm::sincos(radians);
    DMat4::from_cols(
        DVec3::new(cos, 0.0, -sin).extend(0.0),
        DVec3::Y.extend(0.0),
        DVec3::new(sin, 0.0, cos).extend(0.0),
        DVec3::ZERO.extend(1.0),
    )
}

/// A rotation about a vertical axis through a point.
pub fn turned_about(axis: DVec3, radians: f64) -> DMat4 {
    let turn = rotation_y(radians);
    match axis == DVec3::ZERO {
        true => turn,
        false => DMat4::from_translation(axis) * turn * DMat4::from_translation(-axis),
    }
}

/// A gamma-encoded value from 0 to 1 as linear light (IEC 61966-2-1).
pub fn linear_light(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        libm::pow((encoded + 0.055) / 1.055, 2.4)
    }
}

/// Linear light, clamped to [0, 1], gamma-encoded (IEC 61966-2-1). The power 1/2.4 is that of roots,
/// which take a third of its time: sqrt(sqrt(c) cbrt(c)).
pub fn srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * (c.sqrt() * libm::cbrt(c)).sqrt() - 0.055
    }
}

/// A gamma-encoded sRGB value in [0, 1] to linear light.
pub fn linear_of_srgb(encoded: f64) -> f64 {
    let c = encoded.clamp(0.0, 1.0);
    if c <= 0.040_45 {
        c / 12.92
    } else {
        libm::pow((c + 0.055) / 1.055, 2.4)
    }
}

/// Linear light in [0, 1] to a gamma-encoded sRGB byte, ties away from zero.
pub fn srgb_byte(linear: f64) -> u8 {
    (srgb(linear) * 255.0 + 0.5).floor() as u8
}

/// 2^32 over the golden ratio: what seeds are multiplied by, so that neighboring ones differ in all
/// their bits.
pub const HASH_GOLDEN: u32 = 0x9e37_79b9;

/// Integer hash with full avalanche (Ettinger and Wellons, "lowbias32"); a bijection of u32.
pub fn hash(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// FNV-1a with 64 bits (Fowler, Noll and Vo) of the bytes of words, the lowest byte first.
pub fn fnv1a(words: &[u32]) -> u64 {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A hash as a number in [0, 1) with 24 bits, exact in f32.
pub fn hash_unit(x: u32) -> f64 {
    f64::from(hash(x) >> 8) / f64::from(1 << 24)
}

/// Sine of an angle in turns; whole turns are subtracted first, so that they cost no precision.
pub fn sin_turns(turns: f64) -> f64 {
    libm::sin((turns - turns.round()) * std::f64::consts::TAU)
}

/// Cosine of an angle in turns.
pub fn cos_turns(turns: f64) -> f64 {
    libm::cos((turns - turns.round()) * std::f64::consts::TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulp_distance_counts_steps_across_zero() {
        assert_eq!(ulp_distance(1.0, f32::from_bits(1.0f32.to_bits() + 3)), 3);
        assert_eq!(ulp_distance(0.0, -0.0), 0);
        assert_eq!(ulp_distance(f32::from_bits(1), -f32::from_bits(1)), 2);
        assert_eq!(ulp_distance(f32::NAN, 0.0), u32::MAX);
    }

    #[test]
    fn view_matrix_stays_finite_when_degenerate() {
        let same = view_from_world(DVec3::ONE, DVec3::ONE, DVec3::Y);
        assert!(same.is_finite());
        let straight_down = view_from_world(DVec3::Y, DVec3::ZERO, DVec3::Y);
        assert!(straight_down.is_finite() && (straight_down.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn hash_gives_its_published_values() {
        assert_eq!((hash(1), hash(0xdead_beef)), (0x6889_90c0, 0xe628_c683));
        assert_eq!(
            (fnv1a(&[]), fnv1a(&[u32::from_le_bytes(*b"foob")])),
            (0xcbf2_9ce4_8422_2325, 0xdd12_0e79_0c25_12af)
        );
    }

    #[test]
    fn srgb_of_roots_is_that_of_the_power() {
        for light in (0..=1 << 20).map(|step| f64::from(step) / f64::from(1 << 20)) {
            let power = 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055;
            assert!(light <= 0.003_130_8 || (srgb(light) - power).abs() < 5e-16);
        }
        assert!(srgb(f64::NAN).is_nan() && srgb(-1.0) == 0.0);
        assert_eq!(srgb(f64::INFINITY), srgb(1.0));
    }

    #[test]
    fn srgb_hits_both_ends() {
        assert_eq!(
            (srgb_byte(0.0), srgb_byte(1.0), srgb_byte(0.215_860_5)),
            (0, 255, 128)
        );
        for byte in 0..=255 {
            assert_eq!(srgb_byte(linear_of_srgb(f64::from(byte) / 255.0)), byte);
        }
    }
}
