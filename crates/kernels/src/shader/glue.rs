//! Glue: generated WGSL. The parameters of the stack's effects with constants for their choices,
//! one call chain per hook, and buffers that a kernel key declares in one of several ways.

use std::{borrow::Cow, fmt::Write, sync::Arc};

use super::image_files::kernel_words;
use crate::{
    effects::{Effect, EffectSource, EnabledEffect, constant_name},
    params::{Field, ValueType, WgslType},
    scene::model::MOST_SHAPES,
    shader::key::{EffectList, Fetch, KernelKey},
};

/// Bytes from the start of one effect's parameters to the next are a multiple of this (WGSL,
/// uniform address space).
const MEMBER_ALIGN: usize = 16;

/// Constants and the `Effects` struct for the enabled effects, in order. With none there is no
/// struct and no binding; with `baked` parameters there is a constant instead of a binding.
pub fn effects(key: &KernelKey) -> String {
    let EffectList {
        list: effects,
        baked,
        ..
    } = &key.effects;
    let mut text = String::new();
    let mut files: Vec<&str> = Vec::new();
    for effect in effects {
        if files.contains(&effect.file_stem()) {
            continue;
        }
        files.push(effect.file_stem());
        for field in &effect.fields {
            if let ValueType::Choice(words) = &field.value_type {
                for (index, word) in words.iter().enumerate() {
                    let name = constant_name(effect.file_stem(), &field.name, word);
                    let name = effect.source.as_ref().map_or(name.clone(), |source| {
                        EffectSource::unique(&source.stem, &name)
                    });
                    writeln!(text, "const {name} = {index}u;").expect("writing to a string");
                }
            }
        }
    }
    if !effects.is_empty() {
        text.push_str("struct Effects {\n");
        for effect in effects {
            writeln!(
                text,
                "    @align({MEMBER_ALIGN}) {}: {},",
                effect.name, effect.wgsl_struct
            )
            .expect("writing to a string");
        }
        text.push_str("}\n");
        if baked.is_empty() {
            writeln!(
                text,
                "@group(0) @binding(12) var<{}> effects: Effects;",
                uniform(key)
            )
            .expect("writing to a string");
        } else {
            let values: Vec<String> = effects
                .iter()
                .zip(baked)
                .map(|(effect, words)| constructor(effect, words))
                .collect();
            writeln!(text, "const effects = Effects({});", values.join(", "))
                .expect("writing to a string");
        }
    }
    text
}

/// An effect's parameters as a constant expression: every number as the shortest decimal that is
/// exactly itself.
fn constructor(effect: &Effect, words: &[u32]) -> String {
    let literal = |wgsl: WgslType, word: u32| match wgsl {
        WgslType::F32 | WgslType::Vec4F32 => format!("{:?}f", f32::from_bits(word)),
        WgslType::I32 => format!("i32({})", word as i32),
        WgslType::U32 => format!("{word}u"),
    };
    let member = |field: &Field| {
        let components: Vec<String> = words[field.offset / 4..][..field.wgsl.words()]
            .iter()
            .map(|&word| literal(field.wgsl, word))
            .collect();
        if components.len() == 1 {
            components[0].clone()
        } else {
            format!("vec4f({})", components.join(", "))
        }
    };
    let members = effect.members();
    let members: Vec<String> = members.iter().map(|field| member(field)).collect();
    format!("{}({})", effect.wgsl_struct, members.join(", "))
}

/// A hook as the kernels call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    Vertex,
    Sample,
    /// What sample effects compute once per triangle.
    SampleSetup,
    Surface,
    /// What a shaded surface of glass does to the color behind it.
    Glass,
    Image,
}

impl Chain {
    pub const ALL: [Self; 6] = [
        Self::Vertex,
        Self::Sample,
        Self::SampleSetup,
        Self::Surface,
        Self::Glass,
        Self::Image,
    ];

    /// Name in `//@ use glue/NAME` and in the names of WGSL functions.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Sample => "sample",
            Self::SampleSetup => "sample_setup",
            Self::Surface => "surface",
            Self::Glass => "glass",
            Self::Image => "image",
        }
    }

    /// Are its effects called for parts of the scene? Setups of samples are computed for all
    /// triangles, and pixels belong to no part.
    const fn is_scoped(self) -> bool {
        matches!(
            self,
            Self::Vertex | Self::Sample | Self::Surface | Self::Glass
        )
    }

    /// The effects of a stack that this chain calls, in order.
    pub fn effects(self, effects: &[Arc<Effect>]) -> impl Iterator<Item = &Arc<Effect>> {
        effects.iter().filter(move |effect| self.has(effect))
    }

    /// Does this chain call the effect?
    fn has(self, effect: &Effect) -> bool {
        let hooks = &effect.hooks;
        match self {
            Self::Vertex => hooks.vertex.is_some(),
            Self::Sample => hooks.sample.is_some(),
            Self::SampleSetup => hooks.sample.as_ref().is_some_and(|hook| hook.has_setup),
            Self::Surface => hooks.surface.is_some(),
            Self::Glass => hooks.makes_glass,
            Self::Image => hooks.image.is_some(),
        }
    }

    /// The effect's WGSL function: `<stem>` for an effect of one function, else `<stem>_<hook>`.
    pub fn function(self, effect: &Effect) -> String {
        if let Some(source) = &effect.source {
            let functions = &source.functions;
            let name = match self {
                Self::Vertex => &functions.vertex,
                Self::Sample => &functions.sample,
                Self::SampleSetup => &functions.sample_setup,
                Self::Surface => &functions.surface,
                // No file brings glass.
                Self::Glass => &None,
                Self::Image => &functions.image,
            };
            return name.clone().unwrap_or_default();
        }
        let functions = Self::ALL.iter().filter(|chain| chain.has(effect)).count();
        if functions == 1 {
            effect.file_stem().into()
        } else {
            format!("{}_{}", effect.file_stem(), self.name())
        }
    }

    /// The generated function `glue_<hook>` that calls every effect in stack order. An effect with
    /// a scope is called where its draw has the scope's bit; text without scopes reads no such
    /// bits.
    pub fn text(self, key: &KernelKey) -> String {
        let list = &key.effects;
        let effects = list.list.as_slice();
        let (head, tail) = match self {
            Self::Vertex => (
                "fn glue_vertex(vertex: Vertex, draw: u32) -> Vertex {\n    var v = vertex;\n",
                "    return v;\n}\n",
            ),
            Self::Sample => (
                "fn glue_sample(sample: Sample, draw: u32, entry: u32) -> bool {\n    var s = sample;\n",
                "    return true;\n}\n",
            ),
            Self::SampleSetup => (
                "fn glue_sample_setup(setup: TriangleSetup, entry: u32) {\n",
                "}\n",
            ),
            Self::Surface => (
                "fn glue_surface(surface: Surface, draw: u32) -> Surface {\n    var s = surface;\n",
                "    return s;\n}\n",
            ),
            Self::Glass if key.surface.has_transmission => (
                "fn glue_glass(surface: Surface, draw: u32) -> GlassLayer {\n    var layer = transmission_layer(surface);\n",
                "    return layer;\n}\n",
            ),
            Self::Glass => (
                "fn glue_glass(surface: Surface, draw: u32) -> GlassLayer {\n    var layer = glass_blended(surface);\n",
                "    return layer;\n}\n",
            ),
            Self::Image => (
                "fn glue_image(pixel: Pixel) -> Pixel {\n    var q = pixel;\n",
                "    return q;\n}\n",
            ),
        };
        let with_setup: Vec<&Arc<Effect>> = Self::SampleSetup.effects(effects).collect();
        let setup_of = |effect: &Effect| {
            with_setup
                .iter()
                .position(|other| other.name == effect.name)
        };
        let mut text = head.to_owned();
        let scope = |effect: &Effect| {
            if self.is_scoped() {
                list.scope(effect)
            } else {
                None
            }
        };
        if self.effects(effects).any(|effect| scope(effect).is_some()) {
            text.push_str("    let scopes = draws[draw].scopes;\n");
        }
        for effect in self.effects(effects) {
            let (function, name) = (self.function(effect), &effect.name);
            let line = match self {
                Self::Vertex => format!("    v = {function}(v, effects.{name});"),
                Self::Surface if is_lit(effect, key) => {
                    format!("    s = {function}_under_lights(s, effects.{name});")
                }
                Self::Surface => format!("    s = {function}(s, effects.{name});"),
                Self::Glass => format!("    layer = {function}(surface, effects.{name});"),
                Self::Image => format!("    q = {function}(q, effects.{name});"),
                Self::Sample => {
                    let load = setup_of(effect).map_or(String::new(), |index| {
                        format!("    s.setup = sample_setup_load(entry, {index}u);\n")
                    });
                    format!("{load}    if !{function}(s, effects.{name}) {{ return false; }}")
                }
                Self::SampleSetup => {
                    let index = setup_of(effect).expect("an effect of this chain has a setup");
                    format!(
                        "    sample_setup_store(entry, {index}u, {function}(setup, effects.{name}));"
                    )
                }
            };
            match scope(effect) {
                Some(bit) => writeln!(
                    text,
                    "    if (scopes & {}u) != 0u {{\n{line}\n    }}",
                    1u32 << bit
                ),
                None => writeln!(text, "{line}"),
            }
            .expect("writing to a string");
        }
        text.push_str(tail);
        text
    }
}

/// Do lights that come with the scene shine on the effect?
pub fn is_lit(effect: &Effect, key: &KernelKey) -> bool {
    key.surface.lights > 0 && effect.hooks.lit.is_some()
}

/// Buffers that [`binding`] declares.
pub const BINDINGS: [&str; 6] = [
    "draws",
    "shapes",
    "index_bytes",
    "queues",
    "clipped_triangles",
    "particle_step",
];

/// Functions that come with the buffer of draws.
pub const DRAW_FUNCTIONS: [&str; 4] = [
    "draw_of_triangle",
    "draw_of_vertex",
    "draw_of_block",
    "draw_beside_points",
];

/// The draw that a triangle or a vertex belongs to, or where points are projected as they are drawn,
/// a block of them and one of all other triangles. A scene of one draw has no search in its text:
/// a loop that an override switches off still costs 6 % of a frame of ten million triangles (NVIDIA
/// H200, 2026-11-22).
pub fn draw_functions(key: &KernelKey) -> String {
    let function = |name: &str, first: &str| {
        if key.vertices.is_single_draw {
            return format!("fn {name}(id: u32) -> u32 {{\n    return 0u;\n}}\n");
        }
        format!(
            "fn {name}(id: u32) -> u32 {{
    var search = search_begin(frame.draw_count);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {{
        search = search_narrow(search, {first} <= id);
    }}
    return search.low;
}}
"
        )
    };
    let first = |member: &str| format!("draws[search_middle(search)].{member}");
    let firsts = [
        first("first_triangle"),
        first("first_vertex"),
        first("first_block"),
        first("first_triangle") + " - " + &first("first_point"),
    ];
    let known = if key.work.projects_points { 4 } else { 2 };
    let functions = DRAW_FUNCTIONS.iter().zip(&firsts).take(known);
    functions
        .map(|(name, first)| function(name, first))
        .collect()
}

/// The declaration of a buffer whose form depends on the key. Where the key has no such buffer, a
/// private variable stands in for it, which code that runs never touches.
pub fn binding(name: &str, key: &KernelKey) -> Option<String> {
    let binding = |index: u32, access: &str, kind: &str| {
        format!("@group(0) @binding({index}) var<{access}> {name}: {kind};\n")
    };
    let or_none = |exists: bool, index: u32, access: &str, element: &str| match exists {
        true => binding(index, access, &format!("array<{element}>")),
        false => format!("var<private> {name}: array<{element}, 1>;\n"),
    };
    match name {
        "draws" if key.vertices.is_single_draw => Some(binding(1, uniform(key), "array<Draw, 1>")),
        "draws" if key.vertices.is_instanced => {
            Some(binding(1, "storage, read", "array<InstancedDraw>"))
        }
        "draws" => Some(binding(1, "storage, read", "array<Draw>")),
        "shapes" => Some(binding(
            39,
            uniform(key),
            &format!("array<DrawShape, {MOST_SHAPES}>"),
        )),
        "index_bytes" => Some(or_none(
            key.vertices.fetch != Fetch::Direct,
            3,
            "storage, read",
            "u32",
        )),
        "queues" => Some(or_none(key.has_queues(), 8, "storage, read_write", "u32")),
        "particle_step" => Some(binding(20, uniform(key), "ParticleStep")),
        "clipped_triangles" => Some(or_none(
            key.paths.has_clipping,
            9,
            "storage, read",
            "ClippedTriangle",
        )),
        _ => None,
    }
}

/// The address space of values that conditions read and that all invocations share.
const fn uniform(key: &KernelKey) -> &'static str {
    if key.work.stored_uniforms {
        "storage, read"
    } else {
        "uniform"
    }
}

/// The text of `lib/surface` with more members of the surface: how its material reflects, which only
/// kernels have whose effects read it, and what passes through it, where light does.
pub fn with_finish(surface: &str, has_transmission: bool) -> Cow<'_, str> {
    let passed = if has_transmission {
        "    passed: vec3f,\n"
    } else {
        ""
    };
    match surface.rfind('}') {
        Some(end) => Cow::Owned(format!(
            "{}    finish: Finish,\n{passed}{}",
            &surface[..end],
            &surface[end..]
        )),
        None => Cow::Borrowed(surface),
    }
}

/// The struct of an effect's parameters, from its members.
pub fn struct_of(effect: &Effect) -> String {
    let members: Vec<String> = effect
        .members()
        .iter()
        .map(|field| format!("    {}: {},\n", field.name, field.wgsl.name()))
        .collect();
    format!("struct {} {{\n{}}}\n", effect.wgsl_struct, members.concat())
}

/// The declaration of a struct in the text of a file.
pub fn struct_text<'a>(text: &'a str, name: &str) -> &'a str {
    let head = format!("struct {name} {{");
    let Some(begin) = text.find(&head) else {
        return "";
    };
    text[begin..]
        .find("}\n")
        .map_or("", |end| &text[begin..begin + end + 2])
}

/// Bytes of the `Effects` uniform for this stack; empty when there is none.
pub fn uniform_bytes(stack: &[EnabledEffect]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for words in kernel_words(stack) {
        bytes.extend_from_slice(bytemuck::cast_slice(&words));
        bytes.resize(bytes.len().next_multiple_of(MEMBER_ALIGN), 0);
    }
    bytes
}
