//! Programs as WGSL, and values of their operands.

use super::{
    generator::{Number, Source, Statement},
    run::{State, V},
};

/// Functions that the random statements call.
pub const PRELUDE: &str = "var<private> zero: i32;
struct S { v: vec4i, n: array<i32, 3>, m: array<vec2i, 2> }
var<private> g: vec4i = vec4i(1, 2, 3, 4);
fn touch(p: ptr<function, vec4i>, q: vec4i, k: i32) -> vec4i {
    let before = *p;
    (*p).x = q.y + k;
    g.y += q.x;
    if k > 0 { return q + *p; }
    *p = (*p).wzyx;
    return before;
}
fn blend(p: ptr<function, vec4i>, q: vec4i) { (*p).x += 1; (*p).z = q.x; *p += q; }
fn read(p: ptr<function, vec4i>) -> vec4i { return *p; }
fn same(q: S) -> S { return q; }
fn globals(k: i32) -> vec4i { let before = g; g.x ^= k; if k < 0 { return before; } return g; }";
pub const RESULT: &str = "s.v + w * 3 + g * 5 + vec4i(s.n[0], s.n[1], s.n[2], s.m[0].x) * 7 + vec4i(s.m[0].y, s.m[1], 0) * 11";

pub const XYZW: [&str; 4] = ["x", "y", "z", "w"];

impl Source {
    pub fn text(&self) -> String {
        match self {
            Source::V => "s.v".to_owned(),
            Source::W => "w".to_owned(),
            Source::G => "g".to_owned(),
            Source::Let(name) => format!("k{name}"),
            Source::CopyV(name) => format!("k{name}.v"),
            Source::Swizzle(pattern, source) => format!(
                "({}).{}",
                source.text(),
                pattern.map(|at| XYZW[at]).concat()
            ),
            Source::Sum(a, b) => format!("({} + {})", a.text(), b.text()),
            Source::Splat(at, source) => format!("vec4i(({}).{})", source.text(), XYZW[*at]),
        }
    }

    pub fn value(&self, state: &State) -> V {
        match self {
            Source::V => state.s.v,
            Source::W => state.w,
            Source::G => state.g,
            Source::Let(name) => {
                state
                    .lets
                    .iter()
                    .rev()
                    .find(|(other, _)| other == name)
                    .expect("in scope")
                    .1
            }
            Source::CopyV(name) => {
                state
                    .copies
                    .iter()
                    .rev()
                    .find(|(other, _)| other == name)
                    .expect("in scope")
                    .1
                    .v
            }
            Source::Swizzle(pattern, source) => {
                let source = source.value(state);
                pattern.map(|at| source[at])
            }
            Source::Sum(a, b) => {
                let (a, b) = (a.value(state), b.value(state));
                std::array::from_fn(|at| a[at].wrapping_add(b[at]))
            }
            Source::Splat(at, source) => [source.value(state)[*at]; 4],
        }
    }
}

/// Indices beyond the end mean the last element; negative ones are beyond the end.
pub fn index(number: i32, len: usize) -> usize {
    (number.cast_unsigned() as usize).min(len - 1)
}

impl Number {
    pub fn text(&self) -> String {
        match self {
            Number::Constant(value) => format!("bitcast<i32>({}u)", value.cast_unsigned()),
            Number::Component(source, at) => format!("({}).{}", source.text(), XYZW[*at]),
            Number::Dynamic(at) => format!("s.v[{} + zero]", at.text()),
            Number::N(at) => format!("s.n[{} + zero]", at.text()),
            Number::M(at, component) => format!("s.m[{} + zero].{}", at.text(), XYZW[*component]),
        }
    }

    pub fn value(&self, state: &State) -> i32 {
        match self {
            Number::Constant(value) => *value,
            Number::Component(source, at) => source.value(state)[*at],
            Number::Dynamic(at) => state.s.v[index(at.value(state), 4)],
            Number::N(at) => state.s.n[index(at.value(state), 3)],
            Number::M(at, component) => state.s.m[index(at.value(state), 2)][*component],
        }
    }
}

pub fn text(statements: &[Statement]) -> String {
    statements
        .iter()
        .map(|statement| statement.text() + "\n")
        .collect()
}

impl Statement {
    pub fn text(&self) -> String {
        match self {
            Statement::Let(name, source) => format!("let k{name} = {};", source.text()),
            Statement::Copy(name) => format!("let k{name} = same(s);"),
            Statement::SetV(source) => format!("s.v = {};", source.text()),
            Statement::SetW(source) => format!("w = {};", source.text()),
            Statement::SetG(source) => format!("g = {};", source.text()),
            Statement::SetComponent(at, number) => {
                format!("s.v.{} = {};", XYZW[*at], number.text())
            }
            Statement::AddW(at, number) => format!("w.{} += {};", XYZW[*at], number.text()),
            Statement::SetDynamic(at, number) => {
                format!("s.v[{} + zero] = {};", at.text(), number.text())
            }
            Statement::SetN(at, number) => {
                format!("s.n[{} + zero] = {};", at.text(), number.text())
            }
            Statement::SetM(at, component, number) => format!(
                "s.m[{} + zero].{} = {};",
                at.text(),
                XYZW[*component],
                number.text()
            ),
            Statement::SwapM => "s.m = array<vec2i, 2>(s.m[1].yx, s.m[0]);".to_owned(),
            Statement::Touch(source, number) => {
                format!("w = touch(&s.v, {}, {});", source.text(), number.text())
            }
            Statement::Blend(source) => format!("blend(&s.v, {});", source.text()),
            Statement::Late(number, source) => {
                format!(
                    "{{ var late: vec4i; if {} > 0 {{ late = {}; w.y += late.x; }} w += late; }}",
                    number.text(),
                    source.text()
                )
            }
            Statement::LoopOver(source, at) => {
                let (source, at) = (source.text(), XYZW[*at]);
                format!(
                    "{{ let r = {source}; for (var t = 0; t < 3; t++) {{ w += r; s.v.{at} += 1; g.{at} -= 2; }} }}"
                )
            }
            Statement::Read => "{ let r = read(&s.v); s.v.x += 1; w += r; }".to_owned(),
            Statement::Globals(number) => format!(
                "{{ let r = globals({}); g.x += 1; w ^= r; }}",
                number.text()
            ),
            Statement::Restore(name) => format!("s = k{name};"),
            Statement::If(number, accept, reject) => format!(
                "if {} > 0 {{\n{}}} else {{\n{}}}",
                number.text(),
                text(accept),
                text(reject)
            ),
            Statement::For(name, count, body) => {
                format!(
                    "for (var k{name} = 0u; k{name} < {count}u; k{name} += 1u) {{\n{}}}",
                    text(body)
                )
            }
            Statement::Switch(number, first, second, other) => format!(
                "switch {} & 3 {{ case 0: {{\n{}}} case 1, 2: {{\n{}}} default: {{\n{}}} }}",
                number.text(),
                text(first),
                text(second),
                text(other)
            ),
            Statement::BreakIf(number) => format!(
                "loop {{ if {} > 3 {{ break; }} w.x += 1; break; }}",
                number.text()
            ),
            Statement::ContinueIf(number) => {
                format!(
                    "for (var t = 0; t < 3; t++) {{ if {} > t {{ continue; }} s.v.y += t; }}",
                    number.text()
                )
            }
            Statement::ReturnIf(number) => format!("if {} == 1 {{ return w; }}", number.text()),
        }
    }
}
