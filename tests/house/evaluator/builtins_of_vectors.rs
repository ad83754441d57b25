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
    let pack = program(
        "fn f(a: f32) -> u32 { return pack2x16float(vec2(0.0, a)) >> 16u; }",
        "f",
    );
    let quantize = program("fn f(a: f32) -> f32 { return quantizeToF16(a); }", "f");
    let (mut unpack, mut pack, mut quantize) =
        (unpack.machine(), pack.machine(), quantize.machine());
    let mut run = |argument: Word, at: usize| -> Word {
        let machine = [&mut unpack, &mut pack, &mut quantize]
            .into_iter()
            .nth(at)
            .expect("three machines");
        machine
            .call(&[argument], &mut rasterlab::evaluator::NoHost)
            .expect("no loops")[0]
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
fn geometric_functions() {
    let ab = [1.0, -2.0, 3.0, 0.5, 0.25, -4.0];
    vectors("a: vec3f, b: vec3f -> f32", "dot(a, b)", &ab, &[-12.0]);
    vectors(
        "a: vec3f, b: vec3f -> vec3f",
        "cross(a, b)",
        &ab,
        &[8.0 - 0.75, 1.5 + 4.0, 0.25 + 1.0],
    );
    vectors(
        "a: vec3f, b: vec3f -> f32",
        "length(a)",
        &ab,
        &[14f64.sqrt()],
    );
    vectors(
        "a: vec3f, b: vec3f -> f32",
        "distance(a, b)",
        &ab,
        &[(0.25f64 + 5.0625 + 49.0).sqrt()],
    );
    let length = 14f64.sqrt();
    vectors(
        "a: vec3f, b: vec3f -> vec3f",
        "normalize(a)",
        &ab,
        &[1.0 / length, -2.0 / length, 3.0 / length],
    );
    vectors(
        "a: vec3f, b: vec3f -> vec3f",
        "faceForward(a, b, a)",
        &ab,
        &[1.0, -2.0, 3.0],
    );
    vectors(
        "a: vec3f, b: vec3f -> vec3f",
        "faceForward(a, a, a)",
        &ab,
        &[-1.0, 2.0, -3.0],
    );
    vectors(
        "a: vec3f, b: vec3f -> vec3f",
        "reflect(a, vec3f(0.0, 1.0, 0.0))",
        &ab,
        &[1.0, 2.0, 3.0],
    );
    let (sine, ratio) = (0.6, 1.2);
    let cosine = (1.0f64 - (ratio * sine) * (ratio * sine)).sqrt();
    vectors(
        "a: vec2f, b: vec2f, c: f32 -> vec2f",
        "refract(a, b, c)",
        &[sine, -0.8, 0.0, 1.0, ratio],
        &[ratio * sine, -cosine],
    );
    vectors(
        "a: vec2f, b: vec2f, c: f32 -> vec2f",
        "refract(a, b, c)",
        &[sine, -0.8, 0.0, 1.0, 2.0],
        &[0.0, 0.0],
    );
    vectors(
        "a: vec2f, t: f32 -> vec2f",
        "mix(a, vec2f(1.0, 2.0), t)",
        &[3.0, 4.0, 0.25],
        &[2.5, 3.5],
    );
    vectors(
        "a: vec2f -> vec2f",
        "modf(a).fract + modf(a).whole * 10.0",
        &[3.25, -4.5],
        &[30.25, -40.5],
    );
    vectors(
        "a: vec2f -> vec2f",
        "frexp(a).fract + vec2f(frexp(a).exp)",
        &[3.0, -0.25],
        &[2.75, -1.5],
    );
}

#[test]
fn matrices() {
    // Columns (1, 2, 3) and (4, 5, 6).
    let m = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let with = |more: &[f64]| [m.as_slice(), more].concat();
    vectors(
        "m: mat2x3f, v: vec2f -> vec3f",
        "m * v",
        &with(&[10.0, 100.0]),
        &[410.0, 520.0, 630.0],
    );
    vectors(
        "m: mat2x3f, v: vec3f -> vec2f",
        "v * m",
        &with(&[1.0, 10.0, 100.0]),
        &[321.0, 654.0],
    );
    vectors(
        "m: mat2x3f -> mat3x2f",
        "transpose(m)",
        &m,
        &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0],
    );
    vectors(
        "m: mat2x3f -> mat2x2f",
        "transpose(m) * m",
        &m,
        &[14.0, 32.0, 32.0, 77.0],
    );
    vectors(
        "m: mat2x3f -> mat2x3f",
        "m * 2.0 - m + 1.5 * m",
        &m,
        &m.map(|x| 2.5 * x),
    );
    vectors("m: mat2x3f -> vec3f", "m[1].zyx", &m, &[6.0, 5.0, 4.0]);
    vectors(
        "m: mat2x2f -> f32",
        "determinant(m)",
        &[1.0, 2.0, 3.0, 4.0],
        &[-2.0],
    );
    vectors(
        "m: mat3x3f -> f32",
        "determinant(m)",
        &[2.0, 0.0, 1.0, 1.0, 3.0, 2.0, 1.0, 1.0, 4.0],
        &[18.0],
    );
    let four = [
        2.0, 0.0, 1.0, 3.0, 1.0, 3.0, 2.0, -1.0, 1.0, 1.0, 4.0, 0.0, 5.0, 2.0, -2.0, 1.0,
    ];
    // By elimination.
    let mut rows: Vec<Vec<f64>> = four.chunks(4).map(<[f64]>::to_vec).collect();
    let mut determinant = 1.0;
    while let Some((first, rest)) = rows.split_first() {
        determinant *= first[0];
        let eliminated = |row: &Vec<f64>| {
            row.iter()
                .zip(first)
                .skip(1)
                .map(|(x, y)| x - row[0] / first[0] * y)
                .collect()
        };
        rows = rest.iter().map(eliminated).collect();
    }
    vectors("m: mat4x4f -> f32", "determinant(m)", &four, &[determinant]);
}
