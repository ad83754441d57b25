//! Promise: in single precision, the evaluator agrees with that of the WESL compiler, which walks the syntax tree and shares no code with
//! naga.
//!
//! Known deviations of wesl 0.4, which keep a case out of the comparison or widen its tolerance:
//! - It stops with an error where `++` overflows. Such inputs are skipped.
//! - It does not implement smoothstep, fma, reflect, refract, faceForward, modf, determinant, quantizeToF16, reverseBits, firstLeadingBit,
//!   firstTrailingBit, extractBits, insertBits, dot4U8Packed and dot4I8Packed; those are compared in `tests/house/evaluator/builtins.rs` only.
//! - Its floats have x / y = x where y is 0 or the quotient overflows, as WGSL has for integers; here they follow IEEE 754.
//! - Its acosh is Rust's of f32, which loses a few bits near 1: up to 16 ulp.
//! - It rounds between the steps of degrees, radians, inverseSqrt and of transcendental functions, which WGSL leaves open: 1 or 2 ulp.

use std::collections::HashMap;

use rasterlab_evaluator::{NoHost, Options, Precision, Program, Word};
use wesl::eval::{Instance, LiteralInstance};
use wesl::syntax::{Expression, TranslationUnit};

fn single(source: &str, function: &str) -> Program {
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    let options = Options {
        precision: Precision::Single,
        ..Options::default()
    };
    Program::new(&module, function, &options).unwrap_or_else(|error| panic!("{error}\n{source}"))
}

/// Scalars of a result.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scalar {
    F(f32),
    I(i32),
    U(u32),
    B(bool),
}

fn flatten(instance: &Instance, scalars: &mut Vec<Scalar>) {
    match instance {
        Instance::Literal(literal) => scalars.push(match *literal {
            LiteralInstance::F32(x) => Scalar::F(x),
            LiteralInstance::I32(x) => Scalar::I(x),
            LiteralInstance::U32(x) => Scalar::U(x),
            LiteralInstance::Bool(x) => Scalar::B(x),
            ref other => panic!("a result of type {other:?}"),
        }),
        Instance::Vec(vector) => vector.iter().for_each(|x| flatten(x, scalars)),
        Instance::Mat(matrix) => matrix.iter_cols().for_each(|x| flatten(x, scalars)),
        Instance::Array(array) => array.iter().for_each(|x| flatten(x, scalars)),
        Instance::Struct(members) => members
            .members
            .iter()
            .for_each(|member| flatten(member, scalars)),
        other => panic!("a result of type {other:?}"),
    }
}

const FLOATS: [f32; 16] = [
    0.0, 1.0, -1.0, 0.5, -0.25, 0.1, -0.7, 2.5, -3.5, 3.3333333, 1e-20, -1e-3, 12345.678, -65504.0,
    16777216.0, 3e10,
];
const INTEGERS: [i32; 12] = [0, 1, -1, 2, -3, 7, 31, 100, -128, 65535, i32::MAX, i32::MIN];

struct Outcome {
    compared: usize,
    skipped: usize,
    differences: Vec<String>,
}

/// Compares `f(a: f32, b: f32, i: i32, u: u32)` on a lattice; floats may differ by `ulps`.
fn compare(source: &str, ulps: u32) -> Outcome {
    let program = single(source, "f");
    let mut machine = program.machine();
    let unit: TranslationUnit = source
        .parse()
        .unwrap_or_else(|error| panic!("{error}\n{source}"));
    let mut outcome = Outcome {
        compared: 0,
        skipped: 0,
        differences: Vec::new(),
    };
    for at in 0..96usize {
        let a = FLOATS[at % 16];
        let b = FLOATS[(at * 7 + at / 16) % 16];
        let i = INTEGERS[(at * 5) % 12];
        let u = INTEGERS[(at * 11 + at / 12) % 12].cast_unsigned();
        let call = format!(
            "f(bitcast<f32>({}u), bitcast<f32>({}u), bitcast<i32>({}u), {u}u)",
            a.to_bits(),
            b.to_bits(),
            i.cast_unsigned()
        );
        let expression: Expression = call.parse().expect("a call");
        let Ok(Some(instance)) = wesl::exec(&expression, &unit, HashMap::new(), HashMap::new()).0
        else {
            outcome.skipped += 1;
            continue;
        };
        let mut expected = Vec::new();
        flatten(&instance, &mut expected);
        let arguments = [
            Word::from_f64(a.into()),
            Word::from_f64(b.into()),
            Word::from_i32(i),
            Word::from_u32(u),
        ];
        let given = machine.call(&arguments, &mut NoHost).expect("it ends");
        assert_eq!(given.len(), expected.len(), "{source}");
        outcome.compared += 1;
        for (word, &expected) in given.iter().zip(&expected) {
            let (given, is_same) = match expected {
                Scalar::F(x) => {
                    let given = word.to_f64() as f32;
                    assert!(
                        given.is_nan() || f64::from(given) == word.to_f64(),
                        "{given} is no f32"
                    );
                    (Scalar::F(given), close(given, x, ulps))
                }
                Scalar::I(x) => (Scalar::I(word.to_i32()), word.to_i32() == x),
                Scalar::U(x) => (Scalar::U(word.to_u32()), word.to_u32() == x),
                Scalar::B(x) => (Scalar::B(word.to_bool()), word.to_bool() == x),
            };
            if !is_same {
                outcome.differences.push(format!(
                    "({a:?}, {b:?}, {i}, {u}): {given:?}, wesl {expected:?}"
                ));
            }
        }
    }
    outcome
}

fn close(a: f32, b: f32, ulps: u32) -> bool {
    let ordered = |x: f32| {
        let bits = i64::from(x.to_bits().cast_signed());
        if bits < 0 {
            i64::from(i32::MIN) - bits
        } else {
            bits
        }
    };
    a == b
        || a.is_nan() && b.is_nan()
        || (ordered(a) - ordered(b)).unsigned_abs() <= u64::from(ulps)
}

/// Compares every case; one without any comparable input is an error.
fn compare_all(cases: &[(&str, u32)], wrap: impl Fn(&str) -> String) {
    let mut report = String::new();
    for &(case, ulps) in cases {
        let source = wrap(case);
        let outcome = compare(&source, ulps);
        if outcome.compared < 8 {
            report.push_str(&format!(
                "{case}\n  only {} of {} inputs compared\n",
                outcome.compared,
                outcome.compared + outcome.skipped
            ));
        }
        if let Some(first) = outcome.differences.first() {
            report.push_str(&format!(
                "{case}\n  {} differences, the first: {first}\n",
                outcome.differences.len()
            ));
        }
    }
    assert!(report.is_empty(), "\n{report}");
}

/// An expression of `a: f32, b: f32, i: i32, u: u32`, after its type.
fn expression(case: &str) -> String {
    let (ty, expression) = case.split_once(": ").expect("a type and an expression");
    format!("fn f(a: f32, b: f32, i: i32, u: u32) -> {ty} {{ return {expression}; }}")
}

#[test]
fn operators() {
    let cases = [
        "f32: a + b",
        "f32: a - b",
        "f32: a * b",
        "f32: a / select(b, 0.3, b == 0.0)",
        "f32: a % select(b, 0.3, b == 0.0)",
        "f32: -a",
        "f32: a * b + a / 3.0",
        "bool: a < b",
        "bool: a <= b || a == b",
        "bool: !(a > b) && u > 3u",
        "i32: i + 5",
        "i32: i - i32(u)",
        "i32: i * 7919",
        "i32: i / 7",
        "i32: i % 7",
        "i32: -i",
        "i32: ~i",
        "i32: i / i32(u % 5u)",
        "i32: i & 0xff",
        "i32: i | 12",
        "i32: i ^ 0x5555",
        "i32: i << (u % 32u)",
        "i32: i >> (u % 32u)",
        "u32: u + 4000000000u",
        "u32: u - 3u",
        "u32: u * 2654435769u",
        "u32: u / 7u",
        "u32: u % 10u",
        "u32: ~u",
        "u32: u >> 3u",
        "u32: u << 5u",
        "vec3f: vec3f(a, b, 1.0) * 2.0 + vec3f(b)",
        "vec2f: vec2f(a, b).yx - a",
        "vec4f: vec4f(a, vec2f(b, 1.0), f32(i))",
        "vec3<bool>: vec3f(a, b, 0.5) < vec3f(b, a, 0.25)",
        "vec2i: vec2i(i, 3) + vec2i(vec2u(u, 1u))",
        "f32: vec4f(a, b, a, b).w",
        "f32: f32(i)",
        "f32: f32(u)",
        "u32: u32(i)",
        "i32: i32(u)",
        "i32: i32(a)",
        "u32: u32(abs(a))",
        "bool: bool(a)",
        "f32: f32(i > 3)",
        "u32: bitcast<u32>(a)",
        "i32: bitcast<i32>(b)",
        "f32: bitcast<f32>(u & 0x7f7fffffu)",
        "f32: select(a, b, i > 2)",
        "vec2f: select(vec2f(a, b), vec2f(b, a), vec2<bool>(u > 7u, a < b))",
        "bool: all(vec2f(a, b) > vec2f(0.0))",
        "bool: any(vec2f(a, b) > vec2f(0.0))",
        "mat2x2f: mat2x2f(a, b, b, a) * 2.0",
        "vec2f: mat2x2f(a, b, 1.0, 2.0) * vec2f(b, a)",
        "vec2f: vec2f(b, a) * mat2x2f(a, b, 1.0, 2.0)",
        "mat2x3f: mat2x3f(a, b, 1.0, 2.0, a, b) + mat2x3f(b, b, b, a, a, a)",
        "mat2x2f: mat3x2f(a, b, 1.0, 2.0, a, b) * mat2x3f(b, 1.0, a, 0.5, 0.25, b)",
    ];
    compare_all(&cases.map(|case| (case, 0)), expression);
}

#[test]
fn functions() {
    let exact = [
        "f32: abs(a)",
        "i32: abs(i)",
        "f32: min(a, b)",
        "f32: max(a, b)",
        "u32: min(u, 100u)",
        "i32: max(i, -5)",
        "f32: clamp(a, -1.0, 2.0)",
        "f32: saturate(a)",
        "f32: sign(a)",
        "i32: sign(i)",
        "f32: floor(a)",
        "f32: ceil(a)",
        "f32: round(a)",
        "f32: trunc(a)",
        "f32: fract(a)",
        "f32: sqrt(abs(a))",
        "f32: step(a, b)",
        "f32: mix(a, b, 0.25)",
        "vec2f: mix(vec2f(a, b), vec2f(1.0), 0.75)",
        "f32: dot(vec3f(a, b, 1.0), vec3f(b, 0.5, a))",
        "i32: dot(vec2i(i, 2), vec2i(3, i))",
        "vec3f: cross(vec3f(a, b, 1.0), vec3f(b, 0.5, a))",
        "f32: length(vec2f(a, b))",
        "f32: distance(vec2f(a, b), vec2f(b, 1.0))",
        "vec2f: normalize(vec2f(a, 1.0))",
        "f32: frexp(a).fract",
        "i32: frexp(a).exp",
        "f32: ldexp(a, 3)",
        "mat3x2f: transpose(mat2x3f(a, b, 1.0, 2.0, b, 0.5))",
        "u32: countOneBits(u)",
        "u32: countLeadingZeros(u)",
        "u32: countTrailingZeros(u)",
        "u32: pack4x8unorm(vec4f(a, b, 0.5, 1.0))",
        "u32: pack4x8snorm(vec4f(a, b, 0.5, -1.0))",
        "u32: pack2x16unorm(vec2f(a, b))",
        "u32: pack2x16snorm(vec2f(a, b))",
        "u32: pack2x16float(clamp(vec2f(a, b), vec2f(-60000.0), vec2f(60000.0)))",
        "vec4f: unpack4x8unorm(u)",
        "vec4f: unpack4x8snorm(u)",
        "vec2f: unpack2x16unorm(u)",
        "vec2f: unpack2x16snorm(u)",
        "vec2f: unpack2x16float(u & 0x7bff7bffu)",
        "u32: pack4xU8(vec4u(u, 1u, 2u, 300u))",
        "u32: pack4xI8(vec4i(i, 1, -2, 300))",
        "vec4u: unpack4xU8(u)",
        "vec4i: unpack4xI8(u)",
    ];
    compare_all(&exact.map(|case| (case, 0)), expression);
    let rounded = [
        ("f32: degrees(a)", 1),
        ("f32: radians(a)", 1),
        ("f32: inverseSqrt(abs(a) + 0.25)", 1),
        ("f32: sin(a)", 2),
        ("f32: cos(a)", 2),
        ("f32: tan(a)", 2),
        ("f32: asin(saturate(a))", 2),
        ("f32: acos(saturate(a))", 2),
        ("f32: atan(a)", 2),
        ("f32: atan2(a, b)", 2),
        ("f32: sinh(clamp(a, -9.0, 9.0))", 2),
        ("f32: cosh(clamp(a, -9.0, 9.0))", 2),
        ("f32: tanh(a)", 2),
        ("f32: asinh(a)", 2),
        ("f32: acosh(1.0 + abs(a))", 16),
        ("f32: atanh(clamp(a, -0.5, 0.5))", 2),
        ("f32: exp(min(a, 20.0))", 2),
        ("f32: exp2(min(a, 20.0))", 2),
        ("f32: log(abs(a) + 0.1)", 2),
        ("f32: log2(abs(a) + 0.1)", 2),
        ("f32: pow(abs(a), 0.3)", 2),
        ("f32: pow(abs(a) + 1.0, -1.7)", 2),
    ];
    compare_all(&rounded, expression);
}

#[test]
fn statements() {
    let cases = [
        "fn f(a: f32, b: f32, i: i32, u: u32) -> f32 { var s = a; for (var k = 0u; k < u % 7u; k++) { s = s * 0.5 + b; if k == 4u { continue; } s += 1.0; } return s; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> i32 { switch i { case 0, 1: { return 10; } case -1: { return 20; } case 7: { if a > 0.0 { break; } return 30; } default: { return i / 2; } } return 99; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> u32 { var n = u & 1023u; var steps = 0u; while n > 1u { if n % 2u == 0u { n = n / 2u; } else { n = 3u * n + 1u; } steps += 1u; } return steps; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> u32 { var n = 0u; loop { n += 3u; if n > u % 50u { break; } continuing { n *= 2u; break if n > 60u; } } return n; }",
        "struct S { x: f32, v: vec3f, n: array<i32, 3> }
         fn change(s: ptr<function, S>, by: f32) { (*s).x += by; (*s).v.y = (*s).x; (*s).n[1] = 5; }
         fn make(a: f32) -> S { var s: S; s.x = a; s.v = vec3f(a, 1.0, 2.0); s.n[2] = 7; return s; }
         fn f(a: f32, b: f32, i: i32, u: u32) -> f32 { var s = make(a); let before = s; change(&s, b); var t = s; t.v.z = before.v.y; return before.x + s.x * 2.0 + t.v.z + f32(t.n[1] + before.n[1] + s.n[2]) + s.v.y; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> f32 { var m = array<vec2f, 4>(vec2f(a), vec2f(b, 1.0), vec2f(2.0), vec2f(0.5, a)); m[u % 4u].x += 1.0; m[(u + 1u) % 4u][u % 2u] = b; let k = m[(u + 2u) % 4u]; return m[0].x + m[1].y * 2.0 + m[u % 4u].y + k.x; }",
        "fn swap(a: ptr<function, f32>, b: ptr<function, f32>) { let t = *a; *a = *b; *b = t; }
         fn f(a: f32, b: f32, i: i32, u: u32) -> vec2f { var x = a; var y = b; swap(&x, &y); if x > y { swap(&x, &y); } return vec2f(x, y); }",
        "const T = array<u32, 5>(3u, 1u, 4u, 1u, 5u); fn f(a: f32, b: f32, i: i32, u: u32) -> u32 { var s = 0u; for (var k = 0u; k < 5u; k += 1u) { if k == u % 5u { continue; } s = s * 10u + T[k]; } return s; }",
        "fn fib(n: u32) -> u32 { var x = 0u; var y = 1u; for (var k = 0u; k < n; k++) { let z = x + y; x = y; y = z; } return x; }
         fn f(a: f32, b: f32, i: i32, u: u32) -> u32 { return fib(u % 20u) + fib((u + 1u) % 10u); }",
        "var<private> g: i32 = 4; fn touch(n: i32) -> i32 { let old = g; g = g * 3 + n; return old; }
         fn f(a: f32, b: f32, i: i32, u: u32) -> i32 { let before = g; let x = touch(i % 100); let y = touch(2); return before * 1000 + x * 100 + y * 10 + g; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> vec3f { var v = vec3f(a, b, 1.0); v = v.zxy; v.x = v.y; let w = v; v.y = w.x + w.z; return v + w; }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> mat2x2f { var m = mat2x2f(a, b, 1.0, 2.0); m[1] = m[0].yx; m[u % 2u].x = 5.0; let c = m[0]; m[0] += c; return m; }",
        "fn early(a: f32, n: u32) -> f32 { for (var k = 0u; k < 10u; k++) { for (var j = 0u; j < 3u; j++) { if k * 3u + j == n { return a + f32(k); } } } return -a; }
         fn f(a: f32, b: f32, i: i32, u: u32) -> f32 { return early(a, u % 40u) * 2.0 + early(b, 3u); }",
        "fn f(a: f32, b: f32, i: i32, u: u32) -> i32 { var x = i; x++; x += 3; x *= 2; x -= 1; x /= 3; x %= 100; x &= 0x7f; x |= 256; x ^= 3; x <<= 2u; x >>= 1u; x--; return x; }",
        "fn g(x: f32) -> f32 { return x; } fn f(a: f32, b: f32, i: i32, u: u32) -> f32 { var x = a; let y = g(x); x = b; let p = &x; *p += y; return y * 2.0 + x; }",
    ];
    compare_all(&cases.map(|case| (case, 0)), str::to_owned);
}
