//! A small grammar of effects: constants of all kinds, locals, loops, branches, helpers.

use std::fmt::Write;

use super::{
    super::scenes::Rng,
    constants::{CONSTANTS, Constant, SNIPPETS, UNFOLDED},
    helpers::{HELPERS, Helper},
};

/// The types that expressions have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Float,
    Vec2,
    Vec3,
    Vec4,
    Signed,
    Unsigned,
    Bool,
}

impl Kind {
    const NAMES: [(Self, &str); 7] = [
        (Self::Float, "f32"),
        (Self::Vec2, "vec2f"),
        (Self::Vec3, "vec3f"),
        (Self::Vec4, "vec4f"),
        (Self::Signed, "i32"),
        (Self::Unsigned, "u32"),
        (Self::Bool, "bool"),
    ];

    fn name(self) -> &'static str {
        Self::NAMES[self as usize].1
    }

    pub fn of_name(name: &str) -> Self {
        let kind = Self::NAMES.iter().find(|kind| kind.1 == name);
        kind.unwrap_or_else(|| panic!("no type {name}")).0
    }

    pub fn of_components(count: usize) -> Self {
        [Self::Float, Self::Vec2, Self::Vec3, Self::Vec4][count - 1]
    }

    /// Components, of floats.
    pub fn components(self) -> Option<usize> {
        [Self::Float, Self::Vec2, Self::Vec3, Self::Vec4]
            .iter()
            .position(|kind| *kind == self)
            .map(|index| index + 1)
    }
}

/// An expression, and the largest magnitude of its components.
pub(super) struct Value {
    pub text: String,
    pub bound: f64,
}

/// A name that expressions may use.
#[derive(Clone)]
struct Name {
    text: String,
    kind: Kind,
    bound: f64,
}

/// The hook that an effect is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Surface,
    Pixel,
    Sample,
    Vertex,
}

/// An effect that was written.
pub struct Written {
    pub text: String,
    pub place: Place,
    /// It has a hash of sines, whose digits no two devices share: its colors are not compared.
    pub has_sine_hash: bool,
}

/// The effect `index` of a corpus; its name is [`super::NAME`].
pub fn effect(seed: u32, index: u32) -> Written {
    let mut rng = Rng(seed ^ index.wrapping_mul(0x9e37_79b1));
    rng.next_u32();
    let place = match rng.between(0, 20) {
        0 | 1 => Place::Pixel,
        2 | 3 => Place::Sample,
        4 => Place::Vertex,
        _ => Place::Surface,
    };
    let writer = Writer {
        rng,
        names: Vec::new(),
        helpers: Vec::new(),
        body: String::new(),
        fresh: 0,
        indent: 1,
    };
    let text = writer.effect(place, index);
    Written {
        has_sine_hash: text.contains("fn sine_hash("),
        text,
        place,
    }
}

pub(super) struct Writer {
    pub rng: Rng,
    names: Vec<Name>,
    pub helpers: Vec<&'static Helper>,
    body: String,
    fresh: u32,
    indent: usize,
}

impl Writer {
    pub fn one_in(&mut self, n: i32) -> bool {
        self.rng.between(0, n) == 0
    }

    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.rng.between(0, list.len() as i32) as usize]
    }

    fn fresh(&mut self) -> String {
        self.fresh += 1;
        let stem = self.pick(&["a", "value", "uv", "q", "shade", "tone", "k", "amount"]);
        format!("{stem}{}", self.fresh)
    }

    fn line(&mut self, text: &str) {
        let indent = "    ".repeat(self.indent);
        self.body.push_str(&format!("{indent}{text}\n"));
    }

    fn name(&mut self, text: &str, kind: Kind, bound: f64) {
        self.names.push(Name {
            text: text.into(),
            kind,
            bound,
        });
    }

    fn effect(mut self, place: Place, index: u32) -> String {
        let count = self.rng.between(1, 5);
        for _ in 0..count {
            let helper = &HELPERS[self.rng.between(0, HELPERS.len() as i32) as usize];
            if self.helpers.iter().all(|taken| taken.name != helper.name) {
                self.helpers.push(helper);
            }
        }
        let mut text = format!("// Written: effect {index} of a corpus.\n//@ use lib/hash\n");
        let mut constants = String::new();
        for _ in 0..self.rng.between(0, 4) {
            let name = format!("CONSTANT_{}", self.fresh());
            let name = name.to_uppercase();
            let (kind, value, bound) = self.constant(true);
            let kind_text = if self.one_in(2) {
                format!(": {}", kind.name())
            } else {
                String::new()
            };
            writeln!(constants, "const {name}{kind_text} = {value};").expect("written");
            self.name(&name, kind, bound);
        }
        text.push_str(&constants);
        text.push_str(
            "
struct Written {
    /// How much.
    @range(0.0, 1.0, 0.5) amount: f32,
    @range(0.0, 0.1, 0.05) @unit(m) height_m: f32,
    @range(1, 8, 3) count: u32,
    @range(-4, 4, 1) offset: i32,
    @color(1.0, 0.5, 0.25) tint: vec4f,
    @toggle(1) is_on: u32,
}
",
        );
        for helper in &self.helpers {
            text.push_str(&format!("\n{}\n", helper.text));
        }
        self.name("p.amount", Kind::Float, 1.0);
        self.name("p.count", Kind::Unsigned, 8.0);
        self.name("p.offset", Kind::Signed, 4.0);
        self.name("p.tint", Kind::Vec4, 1.0);
        self.name("(p.is_on != 0u)", Kind::Bool, 1.0);
        let head = match place {
            Place::Surface => {
                self.name("s.color", Kind::Vec4, 1.5);
                self.name("s.normal", Kind::Vec3, 1.0);
                self.name("s.view", Kind::Vec3, 1.0);
                self.name("s.position", Kind::Vec3, 2.0);
                self.name("surface.screen", Kind::Vec2, 1.0);
                self.name("s.barycentrics", Kind::Vec3, 1.0);
                self.name("s.triangle_id", Kind::Unsigned, 1e9);
                "fn written(surface: Surface, p: Written) -> Surface {\n    var s = surface;\n"
            }
            Place::Pixel => {
                self.name("x.color", Kind::Vec4, 1.0);
                self.name("x.x", Kind::Unsigned, 1e3);
                self.name("x.y", Kind::Unsigned, 1e3);
                "fn written(pixel: Pixel, p: Written) -> Pixel {\n    var x = pixel;\n"
            }
            Place::Sample => {
                self.name("sample.at.x", Kind::Unsigned, 1e3);
                self.name("sample.at.y", Kind::Unsigned, 1e3);
                self.name("sample.triangle", Kind::Unsigned, 1e9);
                "fn written(sample: Sample, p: Written) -> bool {\n"
            }
            Place::Vertex => {
                self.name("v.position", Kind::Vec3, 2.0);
                self.name("v.normal", Kind::Vec3, 1.0);
                "fn written(vertex: Vertex, p: Written) -> Vertex {\n    var v = vertex;\n"
            }
        };
        self.statements(3, place == Place::Sample || place == Place::Vertex);
        match place {
            Place::Surface => {
                let color = self.expression(Kind::Vec3, 4);
                let early = self.one_in(6);
                if early {
                    self.line("if s.color.a < 0.001 { return surface; }");
                }
                let alpha = self.pick(&["1.0", "s.color.a", "surface.color.a"]);
                let color = self.unit(color);
                self.line(&format!("s.color = vec4f({color}, {alpha});"));
                self.line("return s;");
            }
            Place::Pixel => {
                let color = self.expression(Kind::Vec3, 4);
                let color = self.unit(color);
                self.line(&format!("x.color = vec4f({color}, 1.0);"));
                self.line("return x;");
            }
            Place::Sample => {
                let value = self.expression(Kind::Unsigned, 3).text;
                self.line(&format!("return ({value}) % 4u != 1u;"));
            }
            Place::Vertex => {
                let value = self.expression(Kind::Float, 2);
                let value = if value.bound > 1.0 {
                    format!("sin({})", value.text)
                } else {
                    value.text
                };
                self.line(&format!("v.offset += v.normal * p.height_m * ({value});"));
                self.line("return v;");
            }
        }
        text.push('\n');
        text.push_str(head);
        text.push_str(&self.body);
        text.push_str("}\n");
        text
    }

    /// A color between 0 and 1 without hard edges of its own.
    fn unit(&mut self, color: Value) -> String {
        let text = color.text;
        match self.rng.between(0, 3) {
            0 => format!("0.5 + 0.5 * sin({text})"),
            1 => format!("abs({text}) / (1.0 + abs({text}))"),
            _ => format!("clamp({text}, vec3f(0.0), vec3f(1.0))"),
        }
    }

    /// Declarations and control flow; `is_whole` without floats that could decide.
    fn statements(&mut self, depth: u32, is_whole: bool) {
        for _ in 0..self.rng.between(2, 7) {
            self.statement(depth, is_whole);
        }
    }

    fn statement(&mut self, depth: u32, is_whole: bool) {
        let kinds: &[Kind] = if is_whole {
            &[Kind::Unsigned, Kind::Signed, Kind::Bool]
        } else {
            &[
                Kind::Float,
                Kind::Float,
                Kind::Vec2,
                Kind::Vec3,
                Kind::Vec3,
                Kind::Vec4,
                Kind::Unsigned,
                Kind::Signed,
                Kind::Bool,
            ]
        };
        let kind = self.pick(kinds);
        let choice = self.rng.between(0, 12);
        match choice {
            // What #7793 is about: constants in let, and what is made of them.
            0 | 1 => {
                let word = self.pick(&["let", "let", "const", "var"]);
                let (kind, value, bound) = self.constant(word == "const");
                let name = self.fresh();
                self.line(&format!("{word} {name} = {value};"));
                self.name(&name, kind, bound);
            }
            2 if !is_whole => {
                let snippet = SNIPPETS[self.rng.between(0, SNIPPETS.len() as i32) as usize];
                let name = self.fresh();
                let text = snippet.text.replace('$', &name);
                text.lines().for_each(|line| self.line(line));
                self.name(&name, snippet.kind, snippet.bound);
            }
            3 if depth > 0 => {
                let (name, value) = (self.fresh(), self.expression(kind, 2));
                self.line(&format!("var {name} = {};", value.text));
                self.name(&name, kind, value.bound);
                self.branch(&name, kind, value.bound, depth, is_whole);
            }
            4 if depth > 0 && !is_whole => self.summing_loop(),
            5 if depth > 0 => self.shadowing(kind),
            _ => {
                let (name, value) = (self.fresh(), self.expression(kind, 3));
                let kind_text = if self.one_in(3) {
                    format!(": {}", kind.name())
                } else {
                    String::new()
                };
                let word = self.pick(&["let", "let", "var"]);
                self.line(&format!("{word} {name}{kind_text} = {};", value.text));
                self.name(&name, kind, value.bound);
            }
        }
    }

    /// Assigns the variable in one of the ways that programs branch.
    fn branch(&mut self, name: &str, kind: Kind, bound: f64, depth: u32, is_whole: bool) {
        let known = self.names.len();
        let assigned = |writer: &mut Self| {
            if depth > 1 && writer.one_in(3) {
                writer.statement(depth - 1, is_whole);
            }
            let value = writer.expression(kind, 2);
            writer.line(&format!("{name} = {};", value.text));
            value.bound
        };
        let mut largest = bound;
        if self.one_in(3) {
            let selector = self.expression(Kind::Unsigned, 1).text;
            self.line(&format!("switch ({selector}) % 3u {{"));
            for head in ["case 0u: {", "case 1u: {", "default: {"] {
                self.indent += 1;
                self.line(head);
                self.indent += 1;
                largest = assigned(self).max(largest);
                self.names.truncate(known);
                self.indent -= 1;
                self.line("}");
                self.indent -= 1;
            }
        } else {
            let condition = self.expression(Kind::Bool, 1).text;
            self.line(&format!("if {condition} {{"));
            self.indent += 1;
            largest = assigned(self).max(largest);
            self.names.truncate(known);
            self.indent -= 1;
            if self.one_in(2) {
                self.line("} else {");
                self.indent += 1;
                largest = assigned(self).max(largest);
                self.names.truncate(known);
                self.indent -= 1;
            }
        }
        self.line("}");
        if let Some(variable) = self.names.iter_mut().find(|one| one.text == name) {
            variable.bound = largest;
        }
    }

    fn summing_loop(&mut self) {
        let (sum, i) = (self.fresh(), self.fresh());
        let turns = self.rng.between(2, 6);
        self.line(&format!("var {sum} = 0.0;"));
        let head = match self.rng.between(0, 3) {
            0 => format!("for (var {i} = 0; {i} < {turns}; {i}++) {{"),
            1 => format!("for (var {i}: i32 = {turns}; {i} > 0; {i} -= 1) {{"),
            _ => {
                self.line(&format!("var {i} = 0;"));
                format!("while {i} < {turns} {{")
            }
        };
        self.line(&head);
        self.indent += 1;
        let known = self.names.len();
        self.name(&i, Kind::Signed, 8.0);
        if self.one_in(3) && !head.starts_with("while") {
            self.line(&format!("if {i} == 1 {{ continue; }}"));
        }
        let value = self.expression(Kind::Float, 2);
        self.line(&format!(
            "{sum} += ({}) * {:.2};",
            value.text,
            1.0 / f64::from(turns)
        ));
        if self.one_in(3) {
            self.line(&format!("if {i} > 6 {{ break; }}"));
        }
        if head.starts_with("while") {
            self.line(&format!("{i} += 1;"));
        }
        self.names.truncate(known);
        self.indent -= 1;
        self.line("}");
        self.name(&sum, Kind::Float, value.bound * 1.5);
    }

    /// A block in which a name means something else.
    fn shadowing(&mut self, kind: Kind) {
        let (name, value) = (self.fresh(), self.expression(kind, 2));
        self.line(&format!("var {name} = {};", value.text));
        self.name(&name, kind, value.bound);
        self.line("{");
        self.indent += 1;
        let known = self.names.len();
        let inner = self.expression(kind, 1);
        self.line(&format!("let {name} = {};", inner.text));
        let other = self.fresh();
        self.line(&format!("let {other} = {name};"));
        self.line(&format!("_ = {other};"));
        self.names.truncate(known);
        self.indent -= 1;
        self.line("}");
    }

    /// A constant of some kind, written in one of the ways that the language has. One for a `const`
    /// is seldom one that a `const` refuses.
    fn constant(&mut self, is_const: bool) -> (Kind, String, f64) {
        let is_unfolded = self.one_in(if is_const { 40 } else { 3 });
        let list: &[Constant] = if is_unfolded { &UNFOLDED } else { &CONSTANTS };
        let constant = self.pick(list);
        (constant.kind, constant.text.into(), constant.bound)
    }

    /// A name of the kind, if there is one.
    pub fn known(&mut self, kind: Kind) -> Option<Value> {
        let known: Vec<Name> = self
            .names
            .iter()
            .filter(|name| name.kind == kind)
            .cloned()
            .collect();
        // What was declared last is used most.
        let index = match known.len() {
            0 => return None,
            count if self.one_in(2) => count - 1,
            count => self.rng.between(0, count as i32) as usize,
        };
        Some(Value {
            text: known[index].text.clone(),
            bound: known[index].bound,
        })
    }

    pub fn literal(&mut self, kind: Kind) -> Value {
        let number = (self.rng.real(0.05, 2.0) * 100.0).round() / 100.0;
        let text = match kind {
            Kind::Float => match self.rng.between(0, 5) {
                0 => format!("{number:.1}f"),
                1 => format!("{number:.2e}"),
                2 => "1.".into(),
                3 => ".25".into(),
                _ => format!("{number:.2}"),
            },
            Kind::Vec2 => format!("vec2f({number:.2}, 0.7)"),
            Kind::Vec3 => self
                .pick(&[
                    "vec3f(0.2, 0.5, 0.9)",
                    "vec3f(0.4)",
                    "vec3(0.1, 0.2, 0.3)",
                    "vec3<f32>(1, 0.5, 0)",
                ])
                .into(),
            Kind::Vec4 => self
                .pick(&[
                    "vec4f(0.1, 0.2, 0.3, 1.0)",
                    "vec4f()",
                    "vec4(vec2(0.5), 0.25, 1.0)",
                ])
                .into(),
            Kind::Signed => self.pick(&["3", "-2", "7i", "0x10", "1"]).into(),
            Kind::Unsigned => self.pick(&["3u", "0xffu", "17u", "1u"]).into(),
            Kind::Bool => self.pick(&["true", "false"]).into(),
        };
        Value { text, bound: 2.5 }
    }
}
