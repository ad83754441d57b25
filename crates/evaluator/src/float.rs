//! Float operations that Rust does not have as WGSL means them.

/// `x` as the precision has it: itself, or rounded to the nearest f32.
#[inline(always)]
pub(crate) fn round<const SINGLE: bool>(x: f64) -> f64 {
    if SINGLE { f64::from(x as f32) } else { x }
}

/// -1, 0 or 1; NaN for NaN.
pub(crate) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x
    }
}

/// Limited to `low` and then to `high`, also where `low` is above `high`; `low` for NaN.
#[inline(always)]
pub(crate) fn clamp(x: f64, low: f64, high: f64) -> f64 {
    x.max(low).min(high)
}

/// (1 - t) of `a` and t of `b`.
#[inline(always)]
pub(crate) fn mix<const SINGLE: bool>(a: f64, b: f64, t: f64) -> f64 {
    let rest = round::<SINGLE>(1.0 - t);
    round::<SINGLE>(round::<SINGLE>(a * rest) + round::<SINGLE>(b * t))
}

#[inline(always)]
pub(crate) fn smooth_step<const SINGLE: bool>(low: f64, high: f64, x: f64) -> f64 {
    let t = round::<SINGLE>(round::<SINGLE>(x - low) / round::<SINGLE>(high - low));
    let t = clamp(t, 0.0, 1.0);
    round::<SINGLE>(round::<SINGLE>(t * t) * round::<SINGLE>(3.0 - round::<SINGLE>(2.0 * t)))
}

/// a * b + c with one rounding to the precision.
#[inline(always)]
pub(crate) fn fma<const SINGLE: bool>(a: f64, b: f64, c: f64) -> f64 {
    if SINGLE {
        f64::from((a as f32).mul_add(b as f32, c as f32))
    } else {
        a.mul_add(b, c)
    }
}

/// Fraction in [0.5, 1) with the sign of `x`, and exponent: x = fraction * 2^exponent. Zero, NaN
/// and infinities come with exponent 0.
pub(crate) fn frexp(x: f64) -> (f64, i32) {
    if x == 0.0 || !x.is_finite() {
        return (x, 0);
    }
    let (scaled, shift) = if x.abs() < f64::MIN_POSITIVE {
        (x * 2f64.powi(64), -64)
    } else {
        (x, 0)
    };
    let bits = scaled.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32 - 1022;
    (
        f64::from_bits(bits & !(0x7ff << 52) | (1022 << 52)),
        exponent + shift,
    )
}

/// x * 2^exponent, also where the power alone would overflow.
pub(crate) fn ldexp(x: f64, exponent: i32) -> f64 {
    let exponent = exponent.clamp(-2200, 2200);
    // The powers are exact, and only the last product can round.
    let step = exponent.clamp(-1000, 1000);
    let next = (exponent - step).clamp(-1000, 1000);
    x * 2f64.powi(step) * 2f64.powi(next) * 2f64.powi(exponent - step - next)
}

/// Toward zero, limited to the f32 numbers in the range of i32; 0 for NaN.
pub(crate) fn to_i32(x: f64) -> i32 {
    x.min(2147483520.0) as i32 * i32::from(!x.is_nan())
}

/// Toward zero, limited to the f32 numbers in the range of u32; 0 for NaN.
pub(crate) fn to_u32(x: f64) -> u32 {
    x.min(4294967040.0) as u32 * u32::from(!x.is_nan())
}

/// Bits of the half-precision float nearest to the f32 nearest to `x`, ties to even.
pub(crate) fn to_half(x: f64) -> u32 {
    let x = x as f32;
    let sign = (x.to_bits() >> 16) & 0x8000;
    let magnitude = f64::from(x.abs());
    if x.is_nan() {
        return sign | 0x7e00;
    }
    if magnitude >= 65520.0 {
        return sign | 0x7c00;
    }
    if magnitude < 2f64.powi(-14) {
        // Subnormal, or the least normal number after rounding: its bits continue those of the
        // subnormals.
        return sign | (magnitude * 2f64.powi(24)).round_ties_even() as u32;
    }
    let (fraction, exponent) = frexp(magnitude);
    // 1024 to 2048, whose carry into the exponent is right as it is.
    let significand = (fraction * 2048.0).round_ties_even() as u32;
    sign | ((((exponent + 13) as u32) << 10) + significand)
}

/// Value of the half-precision float in the low 16 bits.
pub(crate) fn from_half(bits: u32) -> f64 {
    let significand = f64::from(bits & 0x3ff);
    let exponent = (bits >> 10) & 0x1f;
    let magnitude = match exponent {
        0 => significand * 2f64.powi(-24),
        31 if significand == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + significand) * 2f64.powi(exponent as i32 - 25),
    };
    if bits & 0x8000 == 0 {
        magnitude
    } else {
        -magnitude
    }
}

/// Nearest integer to `x` * `scale` with halves up, as the packing functions of WGSL round; `x` is
/// rounded to f32 and limited to [low, 1].
pub(crate) fn normalized(x: f64, low: f64, scale: f64) -> i32 {
    let x = clamp(f64::from(x as f32), low, 1.0);
    (0.5 + scale * x).floor() as i32
}
