//! f32 with a simpler floor: nearest, ties to even, and whatever is below 2^-126 is 0, before an operation and after it.
//!
//! Rust's own f32 neither fuses nor reorders, so nothing but the flushing has to be said. After an operation it asks for
//! the result as 24 bits would hold it at any exponent: just below 2^-126 that is finer than the steps of f32.

/// 0, with its sign, in place of a subnormal.
pub fn operand(a: f32) -> f32 {
    if a.abs() < f32::MIN_POSITIVE { 0f32.copysign(a) } else { a }
}

pub fn sum(a: f32, b: f32) -> f32 {
    // Sums so small are exact.
    operand(operand(a) + operand(b))
}

pub fn difference(a: f32, b: f32) -> f32 {
    sum(a, -b)
}

pub fn product(a: f32, b: f32) -> f32 {
    let (a, b) = (operand(a), operand(b));
    kept(a * b, f64::from(a) * f64::from(b))
}

/// For `b` other than 0.
pub fn quotient(a: f32, b: f32) -> f32 {
    let (a, b) = (operand(a), operand(b));
    kept(a / b, f64::from(a) / f64::from(b))
}

/// Nearest integer, ties to even, held to ±2^24.
pub fn round(a: f32) -> i32 {
    a.round_ties_even().clamp(-16_777_216.0, 16_777_216.0) as i32
}

/// `rounded`, or 0 with its sign where 24 bits of the value (of which 53 are given) stay below 2^-126.
fn kept(rounded: f32, value: f64) -> f32 {
    const UP: f64 = (1u64 << 62) as f64;
    let is_below = ((value * UP) as f32).abs() < f32::MIN_POSITIVE * UP as f32;
    if is_below { 0f32.copysign(rounded) } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounds_up_to_the_floor_stays_and_what_does_not_goes() {
        let floor = f32::MIN_POSITIVE;
        let below_one = 1.0 - f32::EPSILON / 2.0;
        assert_eq!(product(floor, 1.0), floor);
        // Value f32 has no number between 2^-126 - 2^-149 and 2^-126, and would round to the latter.
        assert_eq!((floor * below_one, product(floor, below_one)), (floor, 0.0));
        assert_eq!(product(-floor, below_one).to_bits(), (-0f32).to_bits());
        // (1 + e)(1 - e) = 1 - e², which no 24 bits tell from 1.
        let (above, below) = (1.0 + f32::EPSILON, 1.0 - f32::EPSILON);
        assert_eq!(product(floor * above, below), floor);
        assert_eq!(quotient(floor, 2.0), 0.0);
        assert_eq!(sum(floor * 1.5, -floor), 0.0);
        assert_eq!(sum(floor / 2.0, 1.0), 1.0);
    }

    #[test]
    fn halves_round_to_even() {
        assert_eq!([-1.5, -0.5, 0.5, 1.5, 2.5, 3e9].map(round), [-2, 0, 0, 2, 2, 16_777_216]);
    }
}
