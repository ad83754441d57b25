//! Constants as people write them: every built-in function of constants, vectors, matrices, arrays
//! and structs that are named and then taken apart.

use super::writer::Kind;

/// An expression of constants.
#[derive(Clone, Copy)]
pub struct Constant {
    pub kind: Kind,
    pub text: &'static str,
    /// Largest magnitude.
    pub bound: f64,
}

/// Lines that declare `$`.
#[derive(Clone, Copy)]
pub struct Snippet {
    pub kind: Kind,
    pub text: &'static str,
    pub bound: f64,
}

use Kind::{Bool as B, Float as F, Signed as I, Unsigned as U, Vec2 as V2, Vec3 as V3, Vec4 as V4};

const fn constant(kind: Kind, text: &'static str, bound: f64) -> Constant {
    Constant { kind, text, bound }
}

const fn snippet(kind: Kind, text: &'static str, bound: f64) -> Snippet {
    Snippet { kind, text, bound }
}

/// Together with [`UNFOLDED`] every built-in function of numbers.
pub const CONSTANTS: &[Constant] = &[
    constant(V2, "vec2f(0.2, 0.3)", 0.3),
    constant(V2, "vec2f(320.0, 240.0) / 100.0", 3.2),
    constant(V3, "vec3f(0.299, 0.587, 0.114)", 1.0),
    constant(V3, "vec3f(1.0) - vec3f(0.25, 0.5, 0.75)", 1.0),
    constant(V4, "vec4f(vec3f(0.5), 1.0)", 1.0),
    constant(V4, "vec4f(0.1, 0.2, 0.3, 0.4).wzyx", 0.4),
    constant(
        V3,
        "mat3x3f(0.2, 0.1, 0.0, 0.3, 0.9, 0.1, 0.5, 0.0, 0.9) * vec3f(0.5, 0.25, 1.0)",
        2.0,
    ),
    constant(
        V3,
        "mat3x3f(0.2, 0.1, 0.0, 0.3, 0.9, 0.1, 0.5, 0.0, 0.9)[1]",
        1.0,
    ),
    constant(V2, "vec2f(1.0, 2.0) * mat2x2f(0.8, 0.6, -0.6, 0.8)", 3.0),
    constant(F, "array<f32, 3>(0.25, 0.5, 0.75)[1]", 1.0),
    constant(F, "array(0.25, 0.5, 0.75)[2]", 1.0),
    constant(F, "1.0 / 3.0", 0.4),
    constant(F, "3.14159265359 * 0.5", 1.6),
    constant(F, "f32(7) / 2", 3.5),
    constant(F, "-0.75", 0.75),
    constant(F, "0x1.8p1", 3.0),
    constant(I, "7 % 3 - 5", 8.0),
    constant(I, "-8 >> 1u", 8.0),
    constant(I, "i32(2.7)", 3.0),
    constant(U, "1u << 4u", 16.0),
    constant(U, "0xdeadbeefu ^ 0x1234u", 1e9),
    constant(U, "u32(3.9)", 4.0),
    constant(B, "3 > 2 && !(1.0 > 2.0)", 1.0),
    constant(B, "all(vec2f(1.0, 2.0) < vec2f(2.0, 3.0))", 1.0),
    constant(B, "any(vec3<bool>(false, true, false))", 1.0),
    constant(F, "select(0.25, 0.75, true)", 1.0),
    constant(
        V2,
        "select(vec2f(0.1), vec2f(0.9), vec2<bool>(true, false))",
        1.0,
    ),
    constant(F, "abs(-0.5)", 1.0),
    constant(F, "acos(0.5)", 1.1),
    constant(F, "acosh(1.5)", 1.0),
    constant(F, "asin(0.5)", 1.0),
    constant(F, "asinh(0.5)", 1.0),
    constant(F, "atan(0.5)", 1.0),
    constant(F, "atanh(0.5)", 1.0),
    constant(F, "atan2(0.5, 0.75)", 1.0),
    constant(F, "ceil(0.2)", 1.0),
    constant(V2, "clamp(vec2f(0.2, 3.0), vec2f(0.5), vec2f(1.0))", 1.0),
    constant(F, "clamp(0.2, 0.5, 1.0)", 1.0),
    constant(F, "cos(0.5)", 1.0),
    constant(F, "cosh(0.5)", 1.2),
    constant(I, "countLeadingZeros(12)", 32.0),
    constant(U, "countOneBits(0xf0u)", 32.0),
    constant(U, "countTrailingZeros(0xf0u)", 32.0),
    constant(V3, "cross(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0))", 1.0),
    constant(F, "degrees(0.05)", 3.0),
    constant(F, "distance(vec2f(0.1, 0.2), vec2f(0.4, 0.6))", 1.0),
    constant(F, "distance(0.25, 0.75)", 1.0),
    constant(F, "dot(vec3f(0.1, 0.2, 0.3), vec3f(1.0, 2.0, 3.0))", 2.0),
    constant(I, "dot(vec2i(1, 2), vec2i(3, 4))", 11.0),
    constant(I, "dot4I8Packed(0x01020304u, 0x01010101u)", 16.0),
    constant(U, "dot4U8Packed(0x01020304u, 0x01010101u)", 16.0),
    constant(F, "exp(0.25)", 2.0),
    constant(F, "exp2(0.25)", 2.0),
    constant(U, "firstLeadingBit(40u)", 32.0),
    constant(I, "firstLeadingBit(-40)", 32.0),
    constant(U, "firstTrailingBit(40u)", 32.0),
    constant(F, "floor(1.7)", 2.0),
    constant(F, "fma(0.5, 2.0, 0.25)", 2.0),
    constant(F, "fract(1.7)", 1.0),
    constant(F, "inverseSqrt(4.0)", 1.0),
    constant(F, "length(vec2f(0.3, 0.4))", 1.0),
    constant(F, "length(-0.5)", 1.0),
    constant(F, "log(2.0)", 1.0),
    constant(F, "log2(3.0)", 2.0),
    constant(F, "max(0.5, 0.25)", 1.0),
    constant(U, "max(3u, 5u)", 8.0),
    constant(V3, "min(vec3f(0.5), vec3f(0.25, 0.75, 1.0))", 1.0),
    constant(V3, "normalize(vec3f(1.0, 2.0, 2.0))", 1.0),
    constant(F, "pow(2.0, 0.5)", 2.0),
    constant(F, "radians(90.0)", 2.0),
    constant(U, "reverseBits(1u)", 1e9),
    constant(F, "round(1.5)", 2.0),
    constant(F, "saturate(1.5)", 1.0),
    constant(F, "sign(-0.5)", 1.0),
    constant(I, "sign(-3)", 1.0),
    constant(F, "sin(0.5)", 1.0),
    constant(V3, "sin(vec3f(0.1, 0.2, 0.3))", 1.0),
    constant(F, "sinh(0.5)", 1.0),
    constant(F, "sqrt(2.0)", 2.0),
    constant(F, "step(0.5, 0.75)", 1.0),
    constant(F, "tan(0.5)", 1.0),
    constant(F, "tanh(0.5)", 1.0),
    constant(F, "trunc(1.7)", 2.0),
];

/// Functions of constants that naga does not compute beforehand, so that a `const` refuses them.
pub const UNFOLDED: &[Constant] = &[
    constant(U, "bitcast<u32>(1.5f)", 1e9),
    constant(F, "bitcast<f32>(0x3f800000u)", 1.0),
    constant(F, "determinant(mat2x2f(0.8, 0.6, -0.6, 0.8))", 1.0),
    constant(
        F,
        "determinant(mat3x3f(1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 2.0))",
        1.0,
    ),
    constant(U, "extractBits(0xabcdu, 4u, 8u)", 256.0),
    constant(I, "extractBits(-5, 1u, 4u)", 16.0),
    constant(
        V2,
        "faceForward(vec2f(0.1, 0.2), vec2f(1.0, 0.0), vec2f(0.0, 1.0))",
        1.0,
    ),
    constant(F, "frexp(1.5).fract", 1.0),
    constant(I, "frexp(1.5).exp", 4.0),
    constant(U, "insertBits(0xffu, 3u, 4u, 4u)", 256.0),
    constant(F, "ldexp(0.5, 2)", 2.0),
    constant(V3, "mix(vec3f(0.1), vec3f(0.9), 0.25)", 1.0),
    constant(
        V3,
        "mix(vec3f(0.1), vec3f(0.9), vec3f(0.25, 0.5, 0.75))",
        1.0,
    ),
    constant(F, "modf(1.7).fract", 1.0),
    constant(F, "modf(1.7).whole", 2.0),
    constant(U, "pack2x16float(vec2f(0.5, 0.25))", 1e9),
    constant(U, "pack2x16snorm(vec2f(0.5, -0.25))", 1e9),
    constant(U, "pack2x16unorm(vec2f(0.5, 0.25))", 1e9),
    constant(U, "pack4x8snorm(vec4f(0.5, -0.25, 0.0, 1.0))", 1e9),
    constant(U, "pack4x8unorm(vec4f(0.5, 0.25, 0.0, 1.0))", 1e9),
    constant(U, "pack4xI8(vec4i(1, -2, 3, -4))", 1e9),
    constant(U, "pack4xU8(vec4u(1, 2, 3, 4))", 1e9),
    constant(F, "quantizeToF16(0.1)", 1.0),
    constant(
        V3,
        "reflect(vec3f(1.0, -1.0, 0.0), vec3f(0.0, 1.0, 0.0))",
        1.0,
    ),
    constant(
        V3,
        "refract(vec3f(0.6, -0.8, 0.0), vec3f(0.0, 1.0, 0.0), 0.7)",
        1.0,
    ),
    constant(F, "smoothstep(0.0, 1.0, 0.25f)", 1.0),
    constant(V2, "transpose(mat2x2f(0.8, 0.6, -0.6, 0.8))[0]", 1.0),
    constant(V2, "unpack2x16snorm(0x40007fffu)", 1.0),
    constant(V2, "unpack2x16unorm(0x8000ffffu)", 1.0),
    constant(V4, "unpack4x8snorm(0x7f40c081u)", 1.0),
    constant(V4, "unpack4x8unorm(0xff804020u)", 1.0),
    constant(I, "unpack4xI8(0xff804020u).y", 128.0),
    constant(U, "unpack4xU8(0xff804020u).z", 256.0),
];

/// Among them the two cases of gfx-rs/wgpu#7793. `unpack2x16float` is given no constant: Mesa 22.3
/// makes 0 of the second half of one.
pub const SNIPPETS: &[Snippet] = &[
    snippet(F, "let $_g = vec2f(0.2, 0.3);\nlet $ = $_g.x + 1.0;", 2.0),
    snippet(
        F,
        "let $_res = vec2f(320.0, 240.0);\nlet $ = $_res.x / $_res.y;",
        2.0,
    ),
    snippet(
        F,
        "let $_m = mat2x2f(0.8, 0.6, -0.6, 0.8);\nlet $ = $_m[0].x + $_m[1][0];",
        2.0,
    ),
    snippet(
        F,
        "let $_w = array<f32, 4>(0.1, 0.2, 0.3, 0.4);\nlet $ = $_w[2] * 2.0 + $_w[p.count & 3u];",
        2.0,
    ),
    snippet(
        V3,
        "let $_a = vec3f(0.2, 0.4, 0.6);\nvar $ = $_a * 2.0;\n$.y += $_a.z;\n$.x *= 0.5;",
        2.0,
    ),
    snippet(
        V3,
        "const $_A = vec3f(0.2, 0.4, 0.6);\nlet $ = abs($_A - vec3f(1.0)) * p.amount;",
        2.0,
    ),
    snippet(
        V3,
        "let $_a = vec3f(0.9, 0.1, 0.4);\nlet $_b = cross($_a, vec3f(0.0, 1.0, 0.0));\nlet $ = normalize($_b) + $_a.zxy;",
        2.0,
    ),
    snippet(
        F,
        "let $_k = 3;\nlet $_half = f32($_k) * 0.5;\nlet $ = pow($_half, 2.0) - f32($_k % 2);",
        3.0,
    ),
    snippet(
        V2,
        "let $_c = cos(0.5);\nlet $_s = sin(0.5);\nlet $ = mat2x2f($_c, $_s, -$_s, $_c) * vec2f(0.5, 0.25);",
        2.0,
    ),
    snippet(
        F,
        "var $ = 0.0;\nlet $_taps = array<vec2f, 3>(vec2f(0.0), vec2f(0.5, 0.1), vec2f(-0.5, 0.2));\nfor (var i = 0; i < 3; i++) { $ += dot($_taps[i], vec2f(0.3, 0.7)); }",
        2.0,
    ),
    snippet(
        F,
        "var $_parts = array<f32, 3>();\n$_parts[0] = 0.5;\n$_parts[p.count % 3u] += 0.25;\nlet $ = $_parts[0] + $_parts[1] + $_parts[2];",
        2.0,
    ),
    snippet(
        V4,
        "let $_lo = vec4f(0.0);\nlet $_hi = vec4f(1.0);\nlet $ = clamp(p.tint * 1.5, $_lo, $_hi);",
        1.0,
    ),
    snippet(
        F,
        "let $_half = unpack2x16float(pack2x16float(vec2f(p.amount, 0.7)));\nlet $ = $_half.x + $_half.y;",
        2.0,
    ),
    snippet(
        U,
        "let $_h = 2166136261u;\nlet $ = ($_h ^ p.count) * 16777619u;",
        1e9,
    ),
    snippet(
        F,
        "let $_b = vec2<bool>(true, false);\nlet $ = select(0.1, 0.9, any($_b) && p.amount > 0.25);",
        1.0,
    ),
    snippet(
        F,
        "let $_one = 1.0;\nvar $ = $_one;\nif $_one > 0.5 { $ = $_one - 0.5; }",
        1.0,
    ),
    snippet(
        V3,
        "let $_pi = 3.14159;\nlet $_t = $_pi * 2.0 * vec3f(0.0, 0.33, 0.67);\nlet $ = 0.5 + 0.5 * cos($_t + p.amount);",
        1.0,
    ),
    snippet(
        F,
        "let $_f = frexp(6.5);\nlet $_w = modf(2.75);\nlet $ = $_f.fract + f32($_f.exp) * 0.1 + $_w.fract;",
        2.0,
    ),
    snippet(
        I,
        "let $_q = vec3i(3, -4, 5);\nlet $ = $_q.x * $_q.y + dot($_q, vec3i(1));",
        32.0,
    ),
];
