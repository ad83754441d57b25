//! Built-in functions that pack, and those of vectors and matrices, against formulas in plain Rust.

use rasterlab::evaluator::Word;

use super::{
    common::program,
    lattice::{Scalar, larger, one, smaller, two, vectors},
};

#[test]
fn packing() {
    let round = |x: f64, low: f64, scale: f64| {
        (0.5 + scale * smaller(larger(f64::from(x as f32), low), 1.0)).floor() as i32
    };
    two(
        "pack4x8snorm(vec4(a, b, -a, 0.5))",
        move |a: f64, b: f64| {
            u32::from_le_bytes([a, b, -a, 0.5].map(|x| round(x, -1.0, 127.0) as u8))
        },
    );
    two(
        "pack4x8unorm(vec4(a, b, -a, 0.5))",
        move |a: f64, b: f64| {
            u32::from_le_bytes([a, b, -a, 0.5].map(|x| round(x, 0.0, 255.0) as u8))
        },
    );
    two("pack2x16snorm(vec2(a, b))", move |a: f64, b: f64| {
        round(a, -1.0, 32767.0).cast_unsigned() & 0xffff
            | (round(b, -1.0, 32767.0).cast_unsigned() << 16)
    });
    two("pack2x16unorm(vec2(a, b))", move |a: f64, b: f64| {
        round(a, 0.0, 65535.0).cast_unsigned() | (round(b, 0.0, 65535.0).cast_unsigned() << 16)
    });
    one("unpack4x8snorm(a).z", |a: u32| {
        (f64::from(a.to_le_bytes()[2] as i8) / 127.0).max(-1.0)
    });
    one("unpack4x8unorm(a).w", |a: u32| {
        f64::from(a.to_le_bytes()[3]) / 255.0
    });
    one("unpack2x16snorm(a).y", |a: u32| {
        (f64::from((a >> 16) as u16 as i16) / 32767.0).max(-1.0)
    });
    one("unpack2x16unorm(a).x", |a: u32| {
        f64::from(a as u16) / 65535.0
    });
    two("pack4xI8(vec4(a, b, 3, -4))", |a: i32, b: i32| {
        u32::from_le_bytes([a as u8, b as u8, 3, 252])
    });
    two("pack4xU8(vec4(a, b, 3, 4))", |a: u32, b: u32| {
        u32::from_le_bytes([a as u8, b as u8, 3, 4])
    });
    two("pack4xI8Clamp(vec4(a, b, 3, -4))", |a: i32, b: i32| {
        u32::from_le_bytes([a.clamp(-128, 127) as u8, b.clamp(-128, 127) as u8, 3, 252])
    });
    two("pack4xU8Clamp(vec4(a, b, 3, 4))", |a: u32, b: u32| {
        u32::from_le_bytes([a.min(255) as u8, b.min(255) as u8, 3, 4])
    });
    one("unpack4xI8(a).y", |a: u32| {
        i32::from(a.to_le_bytes()[1] as i8)
    });
    one("unpack4xU8(a).y", |a: u32| u32::from(a.to_le_bytes()[1]));
}

/// Value of a half-precision float, from its definition.
fn half(bits: u32) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = ((bits >> 10) & 31, f64::from(bits & 0x3ff) / 1024.0);
    match exponent {
        0 => sign * fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * (1.0 + fraction) * 2f64.powi(exponent as i32 - 15),
    }
}

#[test]
fn half_precision() {
    let unpack = program("fn f(a: u32) -> vec2f { return unpack2x16float(a); }", "f");
    let pack = "fn f(a: f32) -> u32 { return pack2x16float(vec2(0.0, a)) >> 16u; }";
    let pack = program(pack, "f");
    let quantize = program("fn f(a: f32) -> f32 { return quantizeToF16(a); }", "f");
    let mut machines = [&unpack, &pack, &quantize].map(|program| program.machine());
    let mut run = |argument: Word, at: usize| -> Word {
        let result = machines[at].call(&[argument], &mut rasterlab::evaluator::NoHost);
        result.expect("no loops")[0]
    };
    for bits in 0..0x10000u32 {
        let value = half(bits);
        assert!(
            run(Word::from_u32(bits), 0).to_f64().same(value),
            "{bits:#x}"
        );
        if value.is_nan() {
            continue;
        }
        assert_eq!(run(Word::from_f64(value), 1).to_u32(), bits);
        assert_eq!(run(Word::from_f64(value), 2).to_f64(), value);
        // Between two neighbors the nearer one, and at the middle the even one.
        let next = half(bits + 1);
        if bits & 0x7fff < 0x7bff {
            let middle = (value + next) / 2.0;
            assert_eq!(
                run(Word::from_f64(middle), 1).to_u32(),
                bits + (bits & 1),
                "{bits:#x}"
            );
            assert_eq!(
                run(Word::from_f64(value + (next - value) * 0.49), 1).to_u32(),
                bits
            );
            assert_eq!(
                run(Word::from_f64(value + (next - value) * 0.51), 2).to_f64(),
                next
            );
        }
    }
    assert_eq!(run(Word::from_f64(65519.9), 1).to_u32(), 0x7bff);
    assert_eq!(run(Word::from_f64(-65520.0), 1).to_u32(), 0xfc00);
    assert_eq!(run(Word::from_f64(1e30), 2).to_f64(), f64::INFINITY);
    assert_eq!(run(Word::from_f64(1e-30), 1).to_u32(), 0);
}

#[test]
fn geometric_functions_and_matrices() {
    // M has the columns (1, 2, 3) and (4, 5, 6).
    let cases = "
a: vec3f, b: vec3f -> f32 | dot(a, b) | AB | -12
a: vec3f, b: vec3f -> vec3f | cross(a, b) | AB | 7.25 5.5 1.25
a: vec3f, b: vec3f -> f32 | length(a) | AB | 3.7416573867739413
a: vec3f, b: vec3f -> f32 | distance(a, b) | AB | 7.369701486491838
a: vec3f, b: vec3f -> vec3f | normalize(a) | AB | 0.2672612419124244 -0.5345224838248488 0.8017837257372732
a: vec3f, b: vec3f -> vec3f | faceForward(a, b, a) | AB | 1 -2 3
a: vec3f, b: vec3f -> vec3f | faceForward(a, a, a) | AB | -1 2 -3
a: vec3f, b: vec3f -> vec3f | reflect(a, vec3f(0.0, 1.0, 0.0)) | AB | 1 2 3
a: vec2f, b: vec2f, c: f32 -> vec2f | refract(a, b, c) | 0.6 -0.8 0 1 1.2 | 0.72 -0.6939740629158989
a: vec2f, b: vec2f, c: f32 -> vec2f | refract(a, b, c) | 0.6 -0.8 0 1 2 | 0 0
a: vec2f, t: f32 -> vec2f | mix(a, vec2f(1.0, 2.0), t) | 3 4 0.25 | 2.5 3.5
a: vec2f -> vec2f | modf(a).fract + modf(a).whole * 10.0 | 3.25 -4.5 | 30.25 -40.5
a: vec2f -> vec2f | frexp(a).fract + vec2f(frexp(a).exp) | 3 -0.25 | 2.75 -1.5
m: mat2x3f, v: vec2f -> vec3f | m * v | M 10 100 | 410 520 630
m: mat2x3f, v: vec3f -> vec2f | v * m | M 1 10 100 | 321 654
m: mat2x3f -> mat3x2f | transpose(m) | M | 1 4 2 5 3 6
m: mat2x3f -> mat2x2f | transpose(m) * m | M | 14 32 32 77
m: mat2x3f -> mat2x3f | m * 2.0 - m + 1.5 * m | M | 2.5 5 7.5 10 12.5 15
m: mat2x3f -> vec3f | m[1].zyx | M | 6 5 4
m: mat2x2f -> f32 | determinant(m) | 1 2 3 4 | -2
m: mat3x3f -> f32 | determinant(m) | 2 0 1 1 3 2 1 1 4 | 18
m: mat4x4f -> f32 | determinant(m) | 2 0 1 3 1 3 2 -1 1 1 4 0 5 2 -2 1 | -109.0
";
    let cases = cases
        .replace("AB", "1 -2 3 0.5 0.25 -4")
        .replace("| M", "| 1 2 3 4 5 6");
    for case in cases.trim().lines() {
        let parts: Vec<&str> = case.split(" | ").collect();
        let numbers = |at: usize| -> Vec<f64> {
            parts[at]
                .split(' ')
                .map(|word| word.parse().expect("a number"))
                .collect()
        };
        vectors(parts[0], parts[1], &numbers(2), &numbers(3));
    }
}
