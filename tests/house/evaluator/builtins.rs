//! Operators and built-in functions of scalars on a lattice of values, against formulas in plain
//! Rust.

use super::lattice::{larger, one, smaller, three, two};

#[test]
fn float_operators() {
    two("a + b", |a: f64, b: f64| a + b);
    two("a - b", |a: f64, b: f64| a - b);
    two("a * b", |a: f64, b: f64| a * b);
    two("a / b", |a: f64, b: f64| a / b);
    two("a % b", |a: f64, b: f64| {
        if a.is_infinite() || b == 0.0 || a.is_nan() || b.is_nan() {
            f64::NAN
        } else {
            a % b
        }
    });
    one("-a", |a: f64| -a);
    two("a == b", |a: f64, b: f64| a == b);
    two("a != b", |a: f64, b: f64| a != b);
    two("a < b", |a: f64, b: f64| a < b);
    two("a <= b", |a: f64, b: f64| a <= b);
    two("a > b", |a: f64, b: f64| a > b);
    two("a >= b", |a: f64, b: f64| a >= b);
    two("!(a < b) && a != b", |a: f64, b: f64| {
        (a.is_nan() || b.is_nan() || a >= b) && a != b
    });
}

#[test]
fn integer_operators() {
    two("a + b", |a: u32, b: u32| a.wrapping_add(b));
    two("a - b", |a: u32, b: u32| a.wrapping_sub(b));
    two("a * b", |a: u32, b: u32| a.wrapping_mul(b));
    two("a / b", |a: u32, b: u32| a.checked_div(b).unwrap_or(a));
    two("a % b", |a: u32, b: u32| a.checked_rem(b).unwrap_or(0));
    two("a | b", |a: u32, b: u32| a | b);
    two("a ^ b", |a: u32, b: u32| a ^ b);
    two("a << b", |a: u32, b: u32| a << (b % 32));
    two("a >> b", |a: u32, b: u32| a >> (b % 32));
    two("a << b", |a: i32, b: u32| a << (b % 32));
    two("a >> b", |a: i32, b: u32| a >> (b % 32));
    one("~a", |a: u32| !a);
    two("a < b", |a: i32, b: i32| a < b);
    two("a >= b", |a: i32, b: i32| a >= b);
    two("a < b", |a: u32, b: u32| a < b);
    two("a >= b", |a: u32, b: u32| a >= b);
    two("a == b", |a: u32, b: u32| a == b);
    two("a != b", |a: i32, b: i32| a != b);
}

#[test]
fn bool_operators() {
    two("a && b", |a: bool, b: bool| a && b);
    two("a || b", |a: bool, b: bool| a || b);
    two("a & b", |a: bool, b: bool| a & b);
    two("a | b", |a: bool, b: bool| a | b);
    two("a == b", |a: bool, b: bool| a == b);
    two("a != b", |a: bool, b: bool| a != b);
    one("!a", |a: bool| !a);
    one("all(vec3<bool>(a, true, a))", |a: bool| a);
    one("any(vec3<bool>(a, false, a))", |a: bool| a);
    one("all(a)", |a: bool| a);
    three(
        "select(a, b, c)",
        |a: f64, b: f64, c: bool| if c { b } else { a },
    );
    three(
        "select(a, b, c)",
        |a: i32, b: i32, c: bool| if c { b } else { a },
    );
    three(
        "select(vec2(a, b), vec2(b, a), vec2(c, !c)).y",
        |a: u32, b: u32, c: bool| if c { b } else { a },
    );
}

#[test]
fn conversions() {
    one("i32(a)", |a: f64| {
        if a.is_nan() {
            0
        } else {
            a.trunc().clamp(-2147483648.0, 2147483520.0) as i32
        }
    });
    one("u32(a)", |a: f64| {
        if a.is_nan() {
            0
        } else {
            a.trunc().clamp(0.0, 4294967040.0) as u32
        }
    });
    one("bool(a)", |a: f64| a != 0.0);
    one("f32(a)", |a: i32| f64::from(a));
    one("f32(a)", |a: u32| f64::from(a));
    one("f32(a)", |a: bool| if a { 1.0 } else { 0.0 });
    one("u32(a)", |a: i32| a.cast_unsigned());
    one("i32(a)", |a: u32| a.cast_signed());
    one("u32(a)", |a: bool| u32::from(a));
    one("i32(a)", |a: bool| i32::from(a));
    one("bool(a)", |a: i32| a != 0);
    one("bool(a)", |a: u32| a != 0);
    one("bitcast<u32>(a)", |a: i32| a.cast_unsigned());
    one("bitcast<i32>(a)", |a: u32| a.cast_signed());
    one("bitcast<f32>(a)", |a: u32| f64::from(f32::from_bits(a)));
    one("bitcast<f32>(a)", |a: i32| {
        f64::from(f32::from_bits(a.cast_unsigned()))
    });
    one("bitcast<u32>(a) & 0x7fffffffu", |a: f64| {
        if a.is_nan() {
            0x7fc0_0000
        } else {
            (a as f32).to_bits() & 0x7fff_ffff
        }
    });
    one("bitcast<i32>(a) < 0 && a < 0.0", |a: f64| a < 0.0);
    // A float is rounded before its bits are taken.
    one("bitcast<u32>(a * 0.1)", |a: f64| {
        ((a * 0.1) as f32).to_bits()
    });
}

#[test]
fn float_functions() {
    one("abs(a)", |a: f64| if a < 0.0 { -a } else { a });
    two("min(a, b)", smaller);
    two("max(a, b)", larger);
    three("clamp(a, b, c)", |a: f64, b: f64, c: f64| {
        smaller(larger(a, b), c)
    });
    one("saturate(a)", |a: f64| smaller(larger(a, 0.0), 1.0));
    one("sign(a)", |a: f64| {
        if a.is_nan() {
            a
        } else {
            f64::from(i8::from(a > 0.0) - i8::from(a < 0.0))
        }
    });
    one("floor(a)", f64::floor);
    one("ceil(a)", f64::ceil);
    one(
        "trunc(a)",
        |a: f64| if a < 0.0 { a.ceil() } else { a.floor() },
    );
    one("fract(a)", |a: f64| a - a.floor());
    one("round(a)", |a: f64| {
        let down = a.floor();
        match a - down {
            rest if rest < 0.5 => down,
            rest if rest > 0.5 => down + 1.0,
            _ if a.is_infinite() || a.is_nan() => a,
            _ => 2.0 * (a / 2.0).round(),
        }
    });
    type Function = fn(f64) -> f64;
    let functions: [(&str, Function); 18] = [
        ("sqrt", f64::sqrt),
        ("exp", f64::exp),
        ("exp2", f64::exp2),
        ("log", f64::ln),
        ("log2", f64::log2),
        ("sin", f64::sin),
        ("cos", f64::cos),
        ("tan", f64::tan),
        ("asin", f64::asin),
        ("acos", f64::acos),
        ("atan", f64::atan),
        ("sinh", f64::sinh),
        ("cosh", f64::cosh),
        ("tanh", f64::tanh),
        ("asinh", f64::asinh),
        ("acosh", f64::acosh),
        ("atanh", f64::atanh),
        ("length", f64::abs),
    ];
    for (name, function) in functions {
        one(&format!("{name}(a)"), function);
    }
    one("inverseSqrt(a)", |a: f64| 1.0 / a.sqrt());
    two("pow(a, b)", f64::powf);
    two("atan2(a, b)", f64::atan2);
    one("radians(a)", |a: f64| a * std::f64::consts::PI / 180.0);
    one("degrees(a)", |a: f64| a * 180.0 / std::f64::consts::PI);
    two(
        "step(a, b)",
        |edge: f64, x: f64| if edge <= x { 1.0 } else { 0.0 },
    );
    three("mix(a, b, c)", |a: f64, b: f64, t: f64| {
        a * (1.0 - t) + b * t
    });
    three("smoothstep(a, b, c)", |low: f64, high: f64, x: f64| {
        let t = smaller(larger((x - low) / (high - low), 0.0), 1.0);
        t * t * (3.0 - 2.0 * t)
    });
    three("fma(a, b, c)", |a: f64, b: f64, c: f64| a.mul_add(b, c));
    one("modf(a).whole", f64::trunc);
    one(
        "modf(a).fract",
        |a: f64| if a.is_infinite() { 0.0 } else { a % 1.0 },
    );
    one("frexp(a).fract * 0.0 + f32(frexp(a).exp)", |a: f64| {
        if a == 0.0 {
            0.0
        } else if a.is_finite() {
            a.abs().log2().floor() + 1.0
        } else {
            f64::NAN
        }
    });
    one("ldexp(frexp(a).fract, frexp(a).exp)", |a: f64| a);
    one(
        "abs(frexp(a).fract) >= 0.5 && abs(frexp(a).fract) < 1.0",
        |a: f64| a != 0.0 && a.is_finite(),
    );
    two("ldexp(a, b % 500)", |a: f64, b: i32| a * 2f64.powi(b % 500));
    two("distance(a, b)", |a: f64, b: f64| (a - b).abs());
}

#[test]
fn integer_functions() {
    one("abs(a)", |a: i32| a.wrapping_abs());
    one("abs(a)", |a: u32| a);
    one("sign(a)", |a: i32| a.signum());
    two("min(a, b)", |a: u32, b: u32| a.min(b));
    two("max(a, b)", |a: u32, b: u32| a.max(b));
    three("clamp(a, b, c)", |a: i32, b: i32, c: i32| a.max(b).min(c));
    three("clamp(a, b, c)", |a: u32, b: u32, c: u32| a.max(b).min(c));
    one("countLeadingZeros(a)", |a: u32| a.leading_zeros());
    one("countTrailingZeros(a)", |a: i32| a.trailing_zeros() as i32);
    one("countOneBits(a)", |a: i32| a.count_ones() as i32);
    one("reverseBits(a)", |a: u32| {
        (0..32)
            .map(|bit| ((a >> bit) & 1) << (31 - bit))
            .sum::<u32>()
    });
    one("firstTrailingBit(a)", |a: u32| {
        (0..32).find(|bit| (a >> bit) & 1 == 1).unwrap_or(u32::MAX)
    });
    one("firstLeadingBit(a)", |a: u32| {
        (0..32)
            .rev()
            .find(|bit| (a >> bit) & 1 == 1)
            .unwrap_or(u32::MAX)
    });
    one("firstLeadingBit(a)", |a: i32| {
        (0..32)
            .rev()
            .find(|bit| (a >> bit) & 1 != (a >> 31) & 1)
            .unwrap_or(-1)
    });
    let bits = |word: u32, offset: u32, count: u32| {
        let offset = offset.min(32);
        let count = count.min(32 - offset);
        (0..count)
            .map(|bit| ((word >> (offset + bit)) & 1) << bit)
            .sum::<u32>()
    };
    three("extractBits(a, b, c)", move |a: u32, b: u32, c: u32| {
        bits(a, b, c)
    });
    three("extractBits(a, b, c)", move |a: i32, b: u32, c: u32| {
        let count = c.min(32 - b.min(32));
        let value = bits(a.cast_unsigned(), b, c);
        let negative = count > 0 && (value >> (count - 1)) & 1 == 1;
        if negative && count < 32 {
            value.cast_signed().wrapping_sub((1i64 << count) as i32)
        } else {
            value.cast_signed()
        }
    });
    let insert = |word: u32, new: u32, offset: u32, count: u32| {
        let offset = offset.min(32);
        let end = offset + count.min(32 - offset);
        (0..32)
            .map(|bit| {
                if (offset..end).contains(&bit) {
                    ((new >> (bit - offset)) & 1) << bit
                } else {
                    word & (1 << bit)
                }
            })
            .sum::<u32>()
    };
    three(
        "insertBits(a, 0x12345678u ^ a, b, c)",
        move |a: u32, b: u32, c: u32| insert(a, 0x1234_5678 ^ a, b, c),
    );
    three("insertBits(a, -1, b, c)", move |a: i32, b: u32, c: u32| {
        insert(a.cast_unsigned(), u32::MAX, b, c).cast_signed()
    });
    let lanes = |word: u32| word.to_le_bytes();
    two("dot4U8Packed(a, b)", move |a: u32, b: u32| {
        (0..4)
            .map(|at| u32::from(lanes(a)[at]) * u32::from(lanes(b)[at]))
            .sum::<u32>()
    });
    two("dot4I8Packed(a, b)", move |a: u32, b: u32| {
        (0..4)
            .map(|at| i32::from(lanes(a)[at] as i8) * i32::from(lanes(b)[at] as i8))
            .sum::<i32>()
    });
    two("dot(vec2(a, b), vec2(b, b))", |a: i32, b: i32| {
        a.wrapping_mul(b).wrapping_add(b.wrapping_mul(b))
    });
}
