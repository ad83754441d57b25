//! f32 arithmetic with flush-to-zero (`docs/exactness.md` §10): every operation rounds to nearest,
//! ties to even; operands and results below 2^-126 become zero and keep their sign.
//!
//! Rust's f32 operations are IEEE 754 operations that the compiler neither fuses nor reorders, so
//! this module adds only the flushing. A result is flushed if its value, rounded to 24 bits with an
//! unbounded exponent, is below 2^-126: directly below 2^-126 that is finer than the spacing of
//! subnormals.

/// Replaces a subnormal number by zero of the same sign.
pub fn operand(a: f32) -> f32 {
    if a.abs() < f32::MIN_POSITIVE {
        0f32.copysign(a)
    } else {
        a
    }
}

pub fn sum(a: f32, b: f32) -> f32 {
    // A sum this small is exact, so its rounding needs no second look.
    operand(operand(a) + operand(b))
}

pub fn difference(a: f32, b: f32) -> f32 {
    sum(a, -b)
}

pub fn product(a: f32, b: f32) -> f32 {
    let (a, b) = (operand(a), operand(b));
    flushed(a * b, f64::from(a) * f64::from(b))
}

/// `a / b`; `b` must not be zero.
pub fn quotient(a: f32, b: f32) -> f32 {
    let (a, b) = (operand(a), operand(b));
    flushed(a / b, f64::from(a) / f64::from(b))
}

/// The nearest integer, ties to even, clamped to ±2^24.
pub fn round(a: f32) -> i32 {
    a.round_ties_even().clamp(-16_777_216.0, 16_777_216.0) as i32
}

/// Returns `rounded`, or zero of its sign if `value`, rounded to 24 bits, is below 2^-126.
fn flushed(rounded: f32, value: f64) -> f32 {
    const UP: f64 = (1u64 << 62) as f64;
    let is_below = ((value * UP) as f32).abs() < f32::MIN_POSITIVE * UP as f32;
    if is_below {
        0f32.copysign(rounded)
    } else {
        rounded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_that_round_up_to_the_smallest_normal_number_are_kept() {
        let floor = f32::MIN_POSITIVE;
        let below_one = 1.0 - f32::EPSILON / 2.0;
        assert_eq!(product(floor, 1.0), floor);
        // Gradual underflow has no number between 2^-126 - 2^-149 and 2^-126 and would round up.
        assert_eq!((floor * below_one, product(floor, below_one)), (floor, 0.0));
        assert_eq!(product(-floor, below_one).to_bits(), (-0f32).to_bits());
        // (1 + e)(1 - e) = 1 - e² rounds to 1 in 24 bits.
        let (above, below) = (1.0 + f32::EPSILON, 1.0 - f32::EPSILON);
        assert_eq!(product(floor * above, below), floor);
        assert_eq!(quotient(floor, 2.0), 0.0);
        assert_eq!(sum(floor * 1.5, -floor), 0.0);
        assert_eq!(sum(floor / 2.0, 1.0), 1.0);
    }

    #[test]
    fn halves_round_to_even() {
        assert_eq!(
            [-1.5, -0.5, 0.5, 1.5, 2.5, 3e9].map(round),
            [-2, 0, 0, 2, 2, 16_777_216]
        );
    }
}
