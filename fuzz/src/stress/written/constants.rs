//! Constants as people write them: every built-in function of constants, vectors, matrices, arrays
//! and structs that are named and then taken apart.

use std::sync::LazyLock;

use super::writer::Kind;

/// An expression of constants, or lines that declare `$`.
#[derive(Clone, Copy)]
pub struct Constant {
    pub kind: Kind,
    pub text: &'static str,
    /// Largest magnitude.
    pub bound: f64,
}

use Kind::{Float as F, Signed as I, Unsigned as U, Vec2 as V2, Vec3 as V3, Vec4 as V4};

/// A constant of every line: its type, its largest magnitude, and the expression.
fn read(lines: &'static str) -> Vec<Constant> {
    let constant = |line: &'static str| {
        let (kind, rest) = line.split_once(' ').expect("a type");
        let (bound, text) = rest.split_once(' ').expect("a magnitude");
        let bound = bound.parse().expect("a number");
        Constant {
            kind: Kind::of_name(kind),
            text,
            bound,
        }
    };
    lines.lines().skip(1).map(constant).collect()
}

const fn snippet(kind: Kind, text: &'static str, bound: f64) -> Constant {
    Constant { kind, text, bound }
}

/// Together with [`UNFOLDED`] every built-in function of numbers.
pub static CONSTANTS: LazyLock<Vec<Constant>> = LazyLock::new(|| {
    read(
        "
vec2f 0.3 vec2f(0.2, 0.3)
vec2f 3.2 vec2f(320.0, 240.0) / 100.0
vec3f 1 vec3f(0.299, 0.587, 0.114)
vec3f 1 vec3f(1.0) - vec3f(0.25, 0.5, 0.75)
vec4f 1 vec4f(vec3f(0.5), 1.0)
vec4f 0.4 vec4f(0.1, 0.2, 0.3, 0.4).wzyx
vec3f 2 mat3x3f(0.2, 0.1, 0.0, 0.3, 0.9, 0.1, 0.5, 0.0, 0.9) * vec3f(0.5, 0.25, 1.0)
vec3f 1 mat3x3f(0.2, 0.1, 0.0, 0.3, 0.9, 0.1, 0.5, 0.0, 0.9)[1]
vec2f 3 vec2f(1.0, 2.0) * mat2x2f(0.8, 0.6, -0.6, 0.8)
f32 1 array<f32, 3>(0.25, 0.5, 0.75)[1]
f32 1 array(0.25, 0.5, 0.75)[2]
f32 0.4 1.0 / 3.0
f32 1.6 3.14159265359 * 0.5
f32 3.5 f32(7) / 2
f32 0.75 -0.75
f32 3 0x1.8p1
i32 8 7 % 3 - 5
i32 8 -8 >> 1u
i32 3 i32(2.7)
u32 16 1u << 4u
u32 1e9 0xdeadbeefu ^ 0x1234u
u32 4 u32(3.9)
bool 1 3 > 2 && !(1.0 > 2.0)
bool 1 all(vec2f(1.0, 2.0) < vec2f(2.0, 3.0))
bool 1 any(vec3<bool>(false, true, false))
f32 1 select(0.25, 0.75, true)
vec2f 1 select(vec2f(0.1), vec2f(0.9), vec2<bool>(true, false))
f32 1 abs(-0.5)
f32 1.1 acos(0.5)
f32 1 acosh(1.5)
f32 1 asin(0.5)
f32 1 asinh(0.5)
f32 1 atan(0.5)
f32 1 atanh(0.5)
f32 1 atan2(0.5, 0.75)
f32 1 ceil(0.2)
vec2f 1 clamp(vec2f(0.2, 3.0), vec2f(0.5), vec2f(1.0))
f32 1 clamp(0.2, 0.5, 1.0)
f32 1 cos(0.5)
f32 1.2 cosh(0.5)
i32 32 countLeadingZeros(12)
u32 32 countOneBits(0xf0u)
u32 32 countTrailingZeros(0xf0u)
vec3f 1 cross(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0))
f32 3 degrees(0.05)
f32 1 distance(vec2f(0.1, 0.2), vec2f(0.4, 0.6))
f32 1 distance(0.25, 0.75)
f32 2 dot(vec3f(0.1, 0.2, 0.3), vec3f(1.0, 2.0, 3.0))
i32 11 dot(vec2i(1, 2), vec2i(3, 4))
i32 16 dot4I8Packed(0x01020304u, 0x01010101u)
u32 16 dot4U8Packed(0x01020304u, 0x01010101u)
f32 2 exp(0.25)
f32 2 exp2(0.25)
u32 32 firstLeadingBit(40u)
i32 32 firstLeadingBit(-40)
u32 32 firstTrailingBit(40u)
f32 2 floor(1.7)
f32 2 fma(0.5, 2.0, 0.25)
f32 1 fract(1.7)
f32 1 inverseSqrt(4.0)
f32 1 length(vec2f(0.3, 0.4))
f32 1 length(-0.5)
f32 1 log(2.0)
f32 2 log2(3.0)
f32 1 max(0.5, 0.25)
u32 8 max(3u, 5u)
vec3f 1 min(vec3f(0.5), vec3f(0.25, 0.75, 1.0))
vec3f 1 normalize(vec3f(1.0, 2.0, 2.0))
f32 2 pow(2.0, 0.5)
f32 2 radians(90.0)
u32 1e9 reverseBits(1u)
f32 2 round(1.5)
f32 1 saturate(1.5)
f32 1 sign(-0.5)
i32 1 sign(-3)
f32 1 sin(0.5)
vec3f 1 sin(vec3f(0.1, 0.2, 0.3))
f32 1 sinh(0.5)
f32 2 sqrt(2.0)
f32 1 step(0.5, 0.75)
f32 1 tan(0.5)
f32 1 tanh(0.5)
f32 2 trunc(1.7)
",
    )
});

/// Functions of constants that naga does not compute beforehand, so that a `const` refuses them.
pub static UNFOLDED: LazyLock<Vec<Constant>> = LazyLock::new(|| {
    read(
        "
u32 1e9 bitcast<u32>(1.5f)
f32 1 bitcast<f32>(0x3f800000u)
f32 1 determinant(mat2x2f(0.8, 0.6, -0.6, 0.8))
f32 1 determinant(mat3x3f(1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 2.0))
u32 256 extractBits(0xabcdu, 4u, 8u)
i32 16 extractBits(-5, 1u, 4u)
vec2f 1 faceForward(vec2f(0.1, 0.2), vec2f(1.0, 0.0), vec2f(0.0, 1.0))
f32 1 frexp(1.5).fract
i32 4 frexp(1.5).exp
u32 256 insertBits(0xffu, 3u, 4u, 4u)
f32 2 ldexp(0.5, 2)
vec3f 1 mix(vec3f(0.1), vec3f(0.9), 0.25)
vec3f 1 mix(vec3f(0.1), vec3f(0.9), vec3f(0.25, 0.5, 0.75))
f32 1 modf(1.7).fract
f32 2 modf(1.7).whole
u32 1e9 pack2x16float(vec2f(0.5, 0.25))
u32 1e9 pack2x16snorm(vec2f(0.5, -0.25))
u32 1e9 pack2x16unorm(vec2f(0.5, 0.25))
u32 1e9 pack4x8snorm(vec4f(0.5, -0.25, 0.0, 1.0))
u32 1e9 pack4x8unorm(vec4f(0.5, 0.25, 0.0, 1.0))
u32 1e9 pack4xI8(vec4i(1, -2, 3, -4))
u32 1e9 pack4xU8(vec4u(1, 2, 3, 4))
f32 1 quantizeToF16(0.1)
vec3f 1 reflect(vec3f(1.0, -1.0, 0.0), vec3f(0.0, 1.0, 0.0))
vec3f 1 refract(vec3f(0.6, -0.8, 0.0), vec3f(0.0, 1.0, 0.0), 0.7)
f32 1 smoothstep(0.0, 1.0, 0.25f)
vec2f 1 transpose(mat2x2f(0.8, 0.6, -0.6, 0.8))[0]
vec2f 1 unpack2x16snorm(0x40007fffu)
vec2f 1 unpack2x16unorm(0x8000ffffu)
vec4f 1 unpack4x8snorm(0x7f40c081u)
vec4f 1 unpack4x8unorm(0xff804020u)
i32 128 unpack4xI8(0xff804020u).y
u32 256 unpack4xU8(0xff804020u).z
",
    )
});

/// Among them the two cases of gfx-rs/wgpu#7793. `unpack2x16float` is given no constant: Mesa 22.3
/// makes 0 of the second half of one.
pub const SNIPPETS: &[Constant] = &[
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
