// Softfloat: IEEE binary32 in u32 arithmetic, so that every adapter and the CPU compute the same bits. Rounds to nearest, ties to
// even. A subnormal operand is 0 with its sign, and so is a result whose biased exponent is below 1 after rounding. Positions and
// matrices are checked before, so these functions never see NaN, infinity or overflow.

const SOFTFLOAT_SIGN = 0x80000000u;
const SOFTFLOAT_ONE = 0x3f800000u;

fn softfloat_exponent(v: u32) -> u32 {
    return (v >> 23u) & 255u;
}

// 24 bits; 0 for zeros and subnormals.
fn softfloat_significand(v: u32) -> u32 {
    return select((v & 0x7fffffu) | 0x800000u, 0u, softfloat_exponent(v) == 0u);
}

// Packs a significand whose leading bit is bit 31; bit 0 is sticky: it tells whether any lower bit was lost. Rounding up to the
// next power of two carries into the exponent.
fn softfloat_pack(sign: u32, exponent: i32, significand: u32) -> u32 {
    let kept = significand >> 8u;
    let rounded = kept + (((significand & 255u) + 127u + (kept & 1u)) >> 8u);
    let bits = (exponent - 1) * 0x800000 + i32(rounded);
    return sign | select(0u, u32(bits), bits >= 0x800000);
}

fn softfloat_negate(v: u32) -> u32 {
    return v ^ SOFTFLOAT_SIGN;
}

fn softfloat_add(x: u32, y: u32) -> u32 {
    // The larger magnitude comes first; three bits stand below both significands.
    let is_less = (x & ~SOFTFLOAT_SIGN) < (y & ~SOFTFLOAT_SIGN);
    let a = select(x, y, is_less);
    let b = select(y, x, is_less);
    let large = softfloat_significand(a) << 3u;
    let small = softfloat_significand(b) << 3u;
    let apart = min(softfloat_exponent(a) - softfloat_exponent(b), 31u);
    let is_lossy = (small & ((1u << apart) - 1u)) != 0u;
    let moved = (small >> apart) | select(0u, 1u, is_lossy);
    let is_minus = ((a ^ b) & SOFTFLOAT_SIGN) != 0u;
    let sum = select(large + moved, large - moved, is_minus);
    let zeros = countLeadingZeros(sum);
    let packed = softfloat_pack(a & SOFTFLOAT_SIGN, i32(softfloat_exponent(a) + 5u) - i32(zeros), sum << (zeros & 31u));
    // x - x is +0; the sum of two zeros of the same sign keeps that sign.
    return select(packed, select(a & SOFTFLOAT_SIGN, 0u, is_minus), sum == 0u);
}

fn softfloat_subtract(x: u32, y: u32) -> u32 {
    return softfloat_add(x, softfloat_negate(y));
}

fn softfloat_multiply(x: u32, y: u32) -> u32 {
    let a = softfloat_significand(x);
    let b = softfloat_significand(y);
    let sign = (x ^ y) & SOFTFLOAT_SIGN;
    // 48 bits from 16-bit limbs; the lowest 16 only set the sticky bit.
    let low = (a & 0xffffu) * (b & 0xffffu);
    let middle = (a & 0xffffu) * (b >> 16u) + (a >> 16u) * (b & 0xffffu);
    let product = (low >> 16u) + middle + (((a >> 16u) * (b >> 16u)) << 16u);
    let sticky = select(0u, 1u, (low & 0xffffu) != 0u);
    let zeros = countLeadingZeros(product);
    let packed = softfloat_pack(sign, i32(softfloat_exponent(x) + softfloat_exponent(y)) - 126 - i32(zeros), (product << (zeros & 31u)) | sticky);
    return select(packed, sign, a == 0u || b == 0u);
}

// x / y for y other than 0: 26 steps of long division, and a sticky bit for the remainder.
fn softfloat_divide(x: u32, y: u32) -> u32 {
    let divisor = softfloat_significand(y);
    let numerator = softfloat_significand(x);
    let sign = (x ^ y) & SOFTFLOAT_SIGN;
    let is_less = numerator < divisor;
    var rest = select(numerator, numerator << 1u, is_less);
    var quotient = 0u;
    for (var i = 0u; i < 26u; i += 1u) {
        let fits = rest >= divisor;
        quotient = (quotient << 1u) | select(0u, 1u, fits);
        rest = select(rest, rest - divisor, fits) << 1u;
    }
    let exponent = i32(softfloat_exponent(x)) - i32(softfloat_exponent(y)) + 127 - select(0, 1, is_less);
    return select(softfloat_pack(sign, exponent, (quotient << 6u) | select(0u, 1u, rest != 0u)), sign, numerator == 0u);
}

// Nearest integer, ties to even, clamped to +-2^24.
fn softfloat_round(v: u32) -> i32 {
    let exponent = softfloat_exponent(v);
    let significand = softfloat_significand(v);
    // Fraction bits; with 25 of them the value is always below one half.
    let behind = u32(clamp(150 - i32(exponent), 0, 25));
    let is_odd = (significand >> behind) & 1u;
    let nearest = (2u * significand + (1u << behind) - 1u + is_odd) >> (behind + 1u);
    let size = i32(select(nearest, 0x1000000u, exponent > 150u));
    return select(size, -size, v >= SOFTFLOAT_SIGN);
}

// An integer of at most 24 bits as a float, exactly.
fn softfloat_from(v: i32) -> u32 {
    let size = u32(abs(v));
    let zeros = countLeadingZeros(size);
    let bits = ((157u - zeros) << 23u) + ((size << zeros) >> 8u);
    return select(bits | select(0u, SOFTFLOAT_SIGN, v < 0), 0u, size == 0u);
}

// An integer that orders as floats do; both zeros and subnormals are 0.
fn softfloat_order(v: u32) -> i32 {
    let size = select(i32(v & ~SOFTFLOAT_SIGN), 0, softfloat_exponent(v) == 0u);
    return select(size, -size, v >= SOFTFLOAT_SIGN);
}
