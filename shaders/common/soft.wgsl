// Soft floats: IEEE binary32 in u32 arithmetic, so that every adapter and the CPU get the same bits. Nearest, ties to even; a
// subnormal operand is 0 with its sign, and so is a result whose biased exponent is below 1 after rounding. The gate on
// positions and matrices keeps NaN, infinity and overflow away, so none of these functions looks for them.

const SOFT_SIGN = 0x80000000u;
const SOFT_ONE = 0x3f800000u;

fn soft_exponent(v: u32) -> u32 {
    return (v >> 23u) & 255u;
}

// 24 bits; 0 for zeros and subnormals.
fn soft_significand(v: u32) -> u32 {
    return select((v & 0x7fffffu) | 0x800000u, 0u, soft_exponent(v) == 0u);
}

// Packs a significand whose leading bit is bit 31; whatever was lost below it shows in bit 0. Rounding up to the next power of
// two carries into the exponent by itself.
fn soft_pack(sign: u32, exponent: i32, significand: u32) -> u32 {
    let kept = significand >> 8u;
    let rounded = kept + (((significand & 255u) + 127u + (kept & 1u)) >> 8u);
    let bits = (exponent - 1) * 0x800000 + i32(rounded);
    return sign | select(0u, u32(bits), bits >= 0x800000);
}

fn soft_negate(v: u32) -> u32 {
    return v ^ SOFT_SIGN;
}

fn soft_add(x: u32, y: u32) -> u32 {
    // The larger magnitude comes first; three bits stand below both significands.
    let is_less = (x & ~SOFT_SIGN) < (y & ~SOFT_SIGN);
    let a = select(x, y, is_less);
    let b = select(y, x, is_less);
    let large = soft_significand(a) << 3u;
    let small = soft_significand(b) << 3u;
    let apart = min(soft_exponent(a) - soft_exponent(b), 31u);
    let is_lossy = (small & ((1u << apart) - 1u)) != 0u;
    let moved = (small >> apart) | select(0u, 1u, is_lossy);
    let is_minus = ((a ^ b) & SOFT_SIGN) != 0u;
    let sum = select(large + moved, large - moved, is_minus);
    let zeros = countLeadingZeros(sum);
    let packed = soft_pack(a & SOFT_SIGN, i32(soft_exponent(a) + 5u) - i32(zeros), sum << (zeros & 31u));
    // Nothing is left of x - x but +0; zeros of one sign keep it.
    return select(packed, select(a & SOFT_SIGN, 0u, is_minus), sum == 0u);
}

fn soft_subtract(x: u32, y: u32) -> u32 {
    return soft_add(x, soft_negate(y));
}

fn soft_multiply(x: u32, y: u32) -> u32 {
    let a = soft_significand(x);
    let b = soft_significand(y);
    let sign = (x ^ y) & SOFT_SIGN;
    // 48 bits from 16-bit limbs; the lowest 16 only tell whether there is anything.
    let low = (a & 0xffffu) * (b & 0xffffu);
    let middle = (a & 0xffffu) * (b >> 16u) + (a >> 16u) * (b & 0xffffu);
    let product = (low >> 16u) + middle + (((a >> 16u) * (b >> 16u)) << 16u);
    let sticky = select(0u, 1u, (low & 0xffffu) != 0u);
    let zeros = countLeadingZeros(product);
    let packed = soft_pack(sign, i32(soft_exponent(x) + soft_exponent(y)) - 126 - i32(zeros), (product << (zeros & 31u)) | sticky);
    return select(packed, sign, a == 0u || b == 0u);
}

// x / y for y other than 0: 26 steps of long division, and whether a remainder is left.
fn soft_divide(x: u32, y: u32) -> u32 {
    let divisor = soft_significand(y);
    let numerator = soft_significand(x);
    let sign = (x ^ y) & SOFT_SIGN;
    let is_less = numerator < divisor;
    var rest = select(numerator, numerator << 1u, is_less);
    var quotient = 0u;
    for (var i = 0u; i < 26u; i += 1u) {
        let fits = rest >= divisor;
        quotient = (quotient << 1u) | select(0u, 1u, fits);
        rest = select(rest, rest - divisor, fits) << 1u;
    }
    let exponent = i32(soft_exponent(x)) - i32(soft_exponent(y)) + 127 - select(0, 1, is_less);
    return select(soft_pack(sign, exponent, (quotient << 6u) | select(0u, 1u, rest != 0u)), sign, numerator == 0u);
}

// Nearest integer, ties to even, held to +-2^24.
fn soft_round(v: u32) -> i32 {
    let exponent = soft_exponent(v);
    let significand = soft_significand(v);
    // Bits behind the point; with 25 of them the value is below a half whatever they are.
    let behind = u32(clamp(150 - i32(exponent), 0, 25));
    let is_odd = (significand >> behind) & 1u;
    let nearest = (2u * significand + (1u << behind) - 1u + is_odd) >> (behind + 1u);
    let size = i32(select(nearest, 0x1000000u, exponent > 150u));
    return select(size, -size, v >= SOFT_SIGN);
}

// An integer of at most 24 bits as a float: exact.
fn soft_from(v: i32) -> u32 {
    let size = u32(abs(v));
    let zeros = countLeadingZeros(size);
    let bits = ((157u - zeros) << 23u) + ((size << zeros) >> 8u);
    return select(bits | select(0u, SOFT_SIGN, v < 0), 0u, size == 0u);
}

// An integer that orders as the floats do; both zeros are 0, and so are subnormals.
fn soft_order(v: u32) -> i32 {
    let size = select(i32(v & ~SOFT_SIGN), 0, soft_exponent(v) == 0u);
    return select(size, -size, v >= SOFT_SIGN);
}
