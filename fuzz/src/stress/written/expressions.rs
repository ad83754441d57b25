//! Expressions of every type, as deep as they are asked for.

use super::{
    helpers::Helper,
    writer::{Kind, Value, Writer},
};

/// The largest magnitude that an expression may reach before it is folded back.
const LARGEST: f64 = 24.0;

impl Writer {
    pub fn expression(&mut self, kind: Kind, depth: u32) -> Value {
        if depth == 0 || self.one_in(6) {
            if let Some(value) = self.known(kind)
                && !self.one_in(5)
            {
                return value;
            }
            return self.literal(kind);
        }
        let value = match kind {
            Kind::Signed => self.signed(depth - 1),
            Kind::Unsigned => self.unsigned(depth - 1),
            Kind::Bool => self.condition(depth - 1),
            _ => self.float(kind, depth - 1),
        };
        if kind.components().is_some() && value.bound > LARGEST {
            let text = value.text;
            return Value {
                text: if self.one_in(2) {
                    format!("sin({text})")
                } else {
                    format!("cos({text} * 0.25)")
                },
                bound: 1.0,
            };
        }
        value
    }

    fn signed(&mut self, depth: u32) -> Value {
        let a = self.expression(Kind::Signed, depth).text;
        let b = self.expression(Kind::Signed, depth).text;
        let text = match self.rng.between(0, 14) {
            0 => format!("(({a}) % 64 + ({b}) % 64)"),
            1 => format!("(({a}) % 100 - 3)"),
            2 => format!("(({a}) % 32 * 5)"),
            3 => format!("({a}) / 3"),
            4 => format!("({a}) & 15"),
            5 => format!("({a}) ^ ({b})"),
            6 => format!("min({a}, {b})"),
            7 => format!("abs(({a}) % 1000)"),
            8 => format!("clamp({a}, -5, 5)"),
            9 => format!("({a}) >> 1u"),
            10 => format!("select({a}, {b}, ({a}) > 2)"),
            11 => format!("sign({a})"),
            12 => format!("countOneBits({a})"),
            _ => format!("~({a})"),
        };
        Value {
            text: format!("({text})"),
            bound: 1e9,
        }
    }

    fn unsigned(&mut self, depth: u32) -> Value {
        let a = self.expression(Kind::Unsigned, depth).text;
        let b = self.expression(Kind::Unsigned, depth).text;
        let text = match self.rng.between(0, 17) {
            0 => format!("(({a}) & 0xffu) + (({b}) & 63u)"),
            1 => format!("(({a}) & 1023u) * 2654435u"),
            2 => format!("({a}) ^ (({b}) >> 3u)"),
            3 => format!("({a}) >> 2u"),
            4 => format!("(({a}) & 0xffffu) << 4u"),
            5 => format!("({a}) % 7u"),
            6 => format!("({a}) / 3u"),
            7 => format!("max({a}, {b})"),
            8 => format!("countOneBits({a})"),
            9 => format!("reverseBits({a})"),
            10 => format!("firstLeadingBit(({a}) | 1u)"),
            11 => format!("extractBits({a}, 2u, 5u)"),
            12 => format!("insertBits({a}, {b}, 4u, 8u)"),
            13 => format!("hash({a})"),
            14 => format!("select({a}, {b}, ({b}) < 9u)"),
            15 => format!("countTrailingZeros(({a}) | 16u)"),
            _ => format!("u32(abs(i32(({a}) & 255u) - 7))"),
        };
        Value {
            text: format!("({text})"),
            bound: 1e9,
        }
    }

    fn condition(&mut self, depth: u32) -> Value {
        let text = match self.rng.between(0, 8) {
            0 => format!(
                "{} < {}",
                self.expression(Kind::Unsigned, depth).text,
                self.expression(Kind::Unsigned, depth).text
            ),
            1 => format!(
                "{} == {}",
                self.expression(Kind::Signed, depth).text,
                self.expression(Kind::Signed, depth).text
            ),
            2 => format!("!({})", self.expression(Kind::Bool, depth).text),
            3 => format!(
                "({}) && ({})",
                self.expression(Kind::Bool, depth).text,
                self.expression(Kind::Bool, depth).text
            ),
            4 => format!(
                "({}) || ({})",
                self.expression(Kind::Bool, depth).text,
                self.expression(Kind::Bool, depth).text
            ),
            5 => format!(
                "({}) != ({})",
                self.expression(Kind::Bool, depth).text,
                self.expression(Kind::Bool, depth).text
            ),
            6 => format!(
                "(({}) & 1u) == 0u",
                self.expression(Kind::Unsigned, depth).text
            ),
            _ => format!(
                "any(vec2({}, false))",
                self.expression(Kind::Bool, depth).text
            ),
        };
        Value {
            text: format!("({text})"),
            bound: 1.0,
        }
    }

    /// A float or a vector of floats, whose slope stays moderate.
    fn float(&mut self, kind: Kind, depth: u32) -> Value {
        let callable: Vec<&'static Helper> = self
            .helpers
            .iter()
            .copied()
            .filter(|one| one.result == kind)
            .collect();
        if !callable.is_empty() && self.one_in(3) {
            let helper = self.pick(&callable);
            let arguments: Vec<String> = helper
                .parameters
                .iter()
                .map(|kind| self.expression(*kind, depth.min(1)).text)
                .collect();
            return Value {
                text: format!("{}({})", helper.name, arguments.join(", ")),
                bound: helper.bound,
            };
        }
        let count = kind.components().unwrap_or(1);
        if count == 1 && self.one_in(3) {
            return self.reduced(depth);
        }
        if count > 1 && self.one_in(4) {
            return self.composed(count, depth);
        }
        let (a, b) = (self.expression(kind, depth), self.expression(kind, depth));
        let c = self.expression(Kind::Float, 0);
        let one = if count == 1 {
            "1.0".to_owned()
        } else {
            format!("vec{count}f(1.0)")
        };
        let (at, bt, ct) = (&a.text, &b.text, &c.text);
        let (text, bound) = match self.rng.between(0, 30) {
            0 | 1 => (format!("{at} + {bt}"), a.bound + b.bound),
            2 => (format!("{at} - {bt}"), a.bound + b.bound),
            3 | 4 => (format!("({at}) * ({bt})"), a.bound * b.bound),
            5 => (format!("({at}) * {ct}"), a.bound * c.bound),
            6 => (format!("({at}) / (abs({bt}) + 0.5)"), a.bound * 2.0),
            7 => (
                format!("mix({at}, {bt}, clamp({ct}, 0.0, 1.0))"),
                a.bound.max(b.bound),
            ),
            8 => (format!("sin({at})"), 1.0),
            9 => (format!("cos(({at}) * 2.0)"), 1.0),
            10 => (format!("abs({at})"), a.bound),
            11 => (format!("min({at}, {bt})"), a.bound.max(b.bound)),
            12 => (format!("max({at}, {bt})"), a.bound.max(b.bound)),
            13 => (format!("smoothstep({one} * -0.5f, {one} * 1.5, {at})"), 1.0),
            14 => (format!("sqrt(abs({at}) + 0.1)"), (a.bound + 0.1).sqrt()),
            15 => (format!("exp(-abs({at}))"), 1.0),
            16 => (
                format!("pow(abs({at}) + 0.1, {one} * 1.5)"),
                (a.bound + 0.1).powf(1.5),
            ),
            17 => (format!("log2(abs({at}) + 1.0)"), (a.bound + 1.0).log2()),
            18 => (format!("saturate({at})"), 1.0),
            19 => (format!("tanh({at})"), 1.0),
            20 => (
                format!("fma({at}, {one} * 0.5, {bt})"),
                a.bound * 0.5 + b.bound,
            ),
            21 => (format!("inverseSqrt(abs({at}) + 0.5)"), 1.5),
            22 => (format!("-({at})"), a.bound),
            23 => (
                format!(
                    "select({at}, {bt}, {})",
                    self.expression(Kind::Bool, depth.min(1)).text
                ),
                a.bound.max(b.bound),
            ),
            24 => (format!("atan2({at}, abs({bt}) + 0.5)"), 1.6),
            25 => (format!("radians(({at}) * 20.0)"), a.bound * 0.35),
            26 => (format!("fract(({at}) * 0.5)"), 1.0),
            27 => (format!("floor({at})"), a.bound + 1.0),
            28 => (format!("step({one} * 0.25, {at})"), 1.0),
            _ => (format!("clamp({at}, {one} * -1.5, {one} * 1.5)"), 1.5),
        };
        Value {
            text: format!("({text})"),
            bound,
        }
    }

    /// A float of vectors, integers or bits.
    fn reduced(&mut self, depth: u32) -> Value {
        let components = self.pick(&[2usize, 3, 4]);
        let kind = Kind::of_components(components);
        let vector = self.expression(kind, depth);
        let other = self.expression(kind, depth.min(1));
        let (v, w) = (&vector.text, &other.text);
        let root = (components as f64).sqrt();
        let letters = self.pick(&["x", "y", "r", "g"]);
        let (text, bound) = match self.rng.between(0, 10) {
            0 => (format!("({v}).{letters}"), vector.bound),
            1 => (format!("({v})[1]"), vector.bound),
            2 => (format!("length({v})"), vector.bound * root),
            3 => (
                format!("dot({v}, {w})"),
                vector.bound * other.bound * components as f64,
            ),
            4 => (
                format!("distance({v}, {w})"),
                (vector.bound + other.bound) * root,
            ),
            5 => (
                format!(
                    "f32({} % 16)",
                    self.expression(Kind::Signed, depth.min(1)).text
                ),
                16.0,
            ),
            6 => (
                format!(
                    "f32({} & 7u)",
                    self.expression(Kind::Unsigned, depth.min(1)).text
                ),
                7.0,
            ),
            7 => (
                format!(
                    "hash_unit({})",
                    self.expression(Kind::Unsigned, depth.min(1)).text
                ),
                1.0,
            ),
            8 => (
                format!("f32({})", self.expression(Kind::Bool, depth.min(1)).text),
                1.0,
            ),
            _ => (
                format!("({v})[{} & 1u]", self.expression(Kind::Unsigned, 0).text),
                vector.bound,
            ),
        };
        Value { text, bound }
    }

    /// A vector of parts.
    fn composed(&mut self, count: usize, depth: u32) -> Value {
        if self.one_in(2) {
            let vector = self.expression(Kind::Vec4, depth.min(1));
            let swizzles: &[&str] = match count {
                2 => &["xy", "zw", "yx", "rg", "xx"],
                3 => &["xyz", "rgb", "zyx", "bgr", "xxy"],
                _ => &["xyzw", "wzyx", "rgba", "xxyy"],
            };
            return Value {
                text: format!("({}).{}", vector.text, self.pick(swizzles)),
                bound: vector.bound,
            };
        }
        let first = self.expression(Kind::of_components(count - 1), depth.min(1));
        let last = self.expression(Kind::Float, depth.min(1));
        let text = match self.rng.between(0, 3) {
            0 => format!("vec{count}f({})", last.text),
            1 => format!("vec{count}f({}, {})", last.text, first.text),
            _ => format!("vec{count}<f32>({}, {})", first.text, last.text),
        };
        Value {
            text,
            bound: first.bound.max(last.bound),
        }
    }
}
