//! Built-in effects by their files: the declarations of `shaders/effects/NAME.wgsl` are the effect,
//! and its functions, evaluated in f64, are the reference. A text is parsed when it is first
//! evaluated.

use std::{
    borrow::Cow,
    fmt::Write,
    sync::{Arc, LazyLock, OnceLock},
};

use super::{
    assembled::assembled,
    attributes,
    declaration::{self, Author, Declaration, OF_FUNCTIONS, REACH},
    error::{EffectError, Text},
    picture_twin,
    tokens::{Token, closing, tokens},
    twin::{self, Function},
};
use crate::{
    effects::{
        Effect, SurfaceInput, constant_name,
        hooks::{
            Hooks, ImageAt, ImageHook, ImagePass, PassHook, Picture, Pixel, Sample, SampleHook,
            Surface, VertexHook,
        },
    },
    evaluator::Precision,
    params::ValueType,
    shaders::{Library, sections},
};

/// The effect that the built-in file `name` declares.
///
/// # Errors
/// The first fault of the file.
pub fn built_in(name: &str) -> Result<Effect, EffectError> {
    let file = format!("shaders/effects/{name}.wgsl");
    let whole = Library::Embedded.text(&format!("effects/{name}"));
    let whole = whole.unwrap_or_default();
    let text = Text {
        file: &file,
        text: &whole[sections(&whole)[0].1.clone()],
    };
    let declaration = declaration::read(&text, name, Author::Lab)?;
    let mut effect = Effect {
        name: name.into(),
        about: declaration.about.clone(),
        hooks: Hooks::default(),
        fields: declaration.parameters.fields.clone(),
        given: declaration.parameters.given.clone(),
        defaults: declaration.parameters.defaults.clone(),
        wgsl_struct: declaration.struct_name.into(),
        source: None,
        base: None,
        is_repeatable: |_| true,
    };
    effect.hooks = hooks(&effect, &declaration);
    Ok(effect)
}

/// The file of an effect that shows what surrounds the scene uses this one.
const SURROUNDINGS: &str = "variants/surroundings";

/// The hooks that the functions of a file are on.
fn hooks(effect: &Effect, declaration: &Declaration<'_>) -> Hooks {
    let functions = &declaration.hooks;
    let text = |names: Vec<String>| Arc::new(LazyText::new(effect, names, false));
    let mut hooks = Hooks {
        shows_surroundings: declaration.uses.iter().any(|used| used == SURROUNDINGS),
        ..Hooks::default()
    };
    if let Some(name) = &functions.vertex {
        let needs_triangle = reads_triangle(&declaration.tokens);
        let reach = declaration.reach.clone();
        let names = [Some(name), reach.as_ref().map(|reach| &reach.name)];
        let text = text(names.into_iter().flatten().cloned().collect());
        let hook: Arc<LazyLock<VertexHook, _>> = Arc::new(LazyLock::new(move || {
            let reach = reach.map(|reach| (text.exact(1), reach.takes_radius));
            twin::vertex(text.exact(0), text.rounded(0), needs_triangle, reach)
        }));
        let (moved, error_bound) = (hook.clone(), hook.clone());
        hooks.vertex = Some(VertexHook {
            needs_triangle,
            moved: Arc::new(move |v, words| (moved.moved)(v, words)),
            error_bound: Arc::new(move |v, bound, words| {
                (error_bound.error_bound)(v, bound, words)
            }),
            max_displacement_m: Arc::new(move |radius_m, words| {
                (hook.max_displacement_m)(radius_m, words)
            }),
            unheld: None,
        });
    }
    if let Some(name) = &functions.sample {
        // Of integers alone: a setup that takes floats has a side in Rust.
        let setup = format!("{}_sample_setup", effect.name);
        let has_setup = declaration.declared.contains(&setup);
        let names = [Some(name.clone()), has_setup.then_some(setup)];
        let text = text(names.into_iter().flatten().collect());
        let hook: Arc<LazyLock<SampleHook, _>> = Arc::new(LazyLock::new(move || SampleHook {
            sample_setup: match has_setup {
                true => twin::sample_setup(text.exact(1)),
                false => Arc::new(|_, _, _| [0; 4]),
            },
            ..twin::sample(text.exact(0))
        }));
        let tested = hook.clone();
        hooks.sample = Some(SampleHook {
            has_setup,
            error_bound: Arc::new(|_, _| 0.0),
            is_from_floats: Arc::new(|_| false),
            sample_setup: Arc::new(move |setup, words, first| {
                (hook.sample_setup)(setup, words, first)
            }),
            is_drawn: Arc::new(
                move |samples: &[Sample], words: &[u32], drawn: &mut [bool]| {
                    (tested.is_drawn)(samples, words, drawn)
                },
            ),
        });
    }
    if let Some(name) = &functions.surface {
        let (text, known) = (text(vec![name.clone()]), OnceLock::new());
        hooks.surface = Some(Arc::new(move |surfaces: &mut [Surface], words: &[u32]| {
            known.get_or_init(|| twin::surface(text.exact(0), text.rounded(0)))(surfaces, words)
        }));
        hooks.surface_inputs = surface_inputs(&declaration.tokens);
    }
    if let Some(name) = &functions.image {
        let reads_previous = declaration
            .tokens
            .iter()
            .any(|token| token.text == "image_previous");
        let (text, known) = (text(vec![name.clone()]), OnceLock::new());
        let finish = move |pixels: &mut [Pixel], picture: &Picture<'_>, words: &[u32]| {
            let hook: &ImageHook = known.get_or_init(|| {
                picture_twin::image(text.exact(0), text.rounded(0), reads_previous)
            });
            (hook.finish)(pixels, picture, words)
        };
        hooks.image = Some(ImageHook {
            reads_previous,
            finish: Arc::new(finish),
        });
    }
    if !declaration.passes.is_empty() {
        let names: Vec<String> = declaration
            .passes
            .iter()
            .map(|pass| pass.name.clone())
            .collect();
        // Without a picture of what surrounds the scene, and with one.
        let known = [false, true].map(|has_picture| {
            let (text, count) = (
                LazyText::new(effect, names.clone(), has_picture),
                names.len(),
            );
            LazyLock::new(move || -> PassHook {
                let [exact, rounded] = [LazyText::exact, LazyText::rounded]
                    .map(|functions| (0..count).map(|pass| functions(&text, pass)).collect());
                picture_twin::passes(Vec::new(), exact, rounded)
            })
        });
        let shows = hooks.shows_surroundings;
        let run = move |index: usize, pixels: &[ImageAt<'_>], words: &[u32]| {
            let has = |at: &ImageAt<'_>| at.input.panorama.is_some();
            let has_picture = shows && pixels.first().is_some_and(has);
            (known[usize::from(has_picture)].run)(index, pixels, words)
        };
        // A pass of a built-in effect is called by what follows the effect's name.
        let named = |pass: &ImagePass| {
            let rest = pass.name.strip_prefix(&effect.name).unwrap_or(&pass.name);
            ImagePass {
                name: rest.trim_start_matches('_').into(),
                ..pass.clone()
            }
        };
        hooks.passes = Some(PassHook {
            passes: declaration.passes.iter().map(named).collect(),
            run: Arc::new(run),
        });
    }
    let has_color = functions.surface.is_some() || functions.image.is_some();
    hooks.has_steps = has_color && !declaration.is_smooth;
    hooks
}

/// Functions of a built-in effect, read when they are first called.
struct LazyText {
    /// For its members.
    effect: Effect,
    names: Vec<String>,
    /// It shows a picture of what surrounds the scene.
    has_picture: bool,
    /// Each function in f64 and in f32.
    functions: OnceLock<Vec<[Function; 2]>>,
}

impl LazyText {
    fn new(effect: &Effect, names: Vec<String>, has_picture: bool) -> Self {
        Self {
            effect: effect.clone(),
            names,
            has_picture,
            functions: OnceLock::new(),
        }
    }

    fn functions(&self) -> &[[Function; 2]] {
        self.functions.get_or_init(|| {
            let roots: Vec<&str> = self.names.iter().map(String::as_str).collect();
            let constants = constants(&self.effect);
            let text = assembled(&self.effect.name, &roots, &constants, self.has_picture);
            let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| {
                panic!("{}: {}", self.effect.name, error.emit_to_string(&text))
            });
            let function = |name: &&str| {
                [Precision::Double, Precision::Single].map(|precision| {
                    Function::new(&module, &text, name, &self.effect, precision)
                        .unwrap_or_else(|error| panic!("{name}: {error}"))
                })
            };
            roots.iter().map(function).collect()
        })
    }

    fn exact(&self, index: usize) -> Function {
        self.functions()[index][0].clone()
    }

    fn rounded(&self, index: usize) -> Function {
        self.functions()[index][1].clone()
    }
}

/// The constants of an effect's choices.
fn constants(effect: &Effect) -> String {
    let mut text = String::new();
    for field in &effect.fields {
        if let ValueType::Choice(words) = &field.value_type {
            for (index, word) in words.iter().enumerate() {
                let name = constant_name(&effect.name, &field.name, word);
                writeln!(text, "const {name} = {index}u;").expect("writing to a string");
            }
        }
    }
    text
}

/// Does a text read of a corner what its triangle alone has?
pub fn reads_triangle(tokens: &[Token<'_>]) -> bool {
    let members = ["flat_normal", "center", "arm", "center_screen", "triangle"];
    tokens
        .windows(2)
        .any(|pair| pair[0].text == "." && members.contains(&pair[1].text))
}

/// The members of the surface that a text reads: those of names that are declared as surfaces, but
/// not what is only assigned to.
fn surface_inputs(tokens: &[Token<'_>]) -> Vec<SurfaceInput> {
    let text = |index: usize| tokens.get(index).map_or("", |token| token.text);
    let mut surfaces: Vec<&str> = Vec::new();
    let mut read: Vec<&str> = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        let [next, after] = [1, 2].map(|ahead| text(index + ahead));
        if token.text == "fn" {
            surfaces.clear();
        } else if next == ":" && after == "Surface"
            || next == "=" && surfaces.contains(&after) && text(index + 3) == ";"
        {
            surfaces.push(token.text);
        } else if next == "." && surfaces.contains(&token.text) {
            let is_assigned = text(index + 3) == "=" && text(index + 4) != "=";
            if !is_assigned {
                read.push(after);
            }
        }
    }
    SurfaceInput::ALL
        .into_iter()
        .filter(|input| read.contains(&input.member()))
        .collect()
}

/// A text of WGSL with spaces in place of what only the lab knows: the attributes of parameters and
/// functions.
pub fn without_attributes(text: &str) -> Cow<'_, str> {
    blanked(text, false)
}

/// The same without the functions that kernels do not call, those behind `@reach`.
pub fn for_kernels(text: &str) -> Cow<'_, str> {
    blanked(text, true)
}

fn blanked(text: &str, is_for_kernels: bool) -> Cow<'_, str> {
    let tokens = tokens(text);
    let is_ours = |name: &str| attributes::NAMES.contains(&name) || OF_FUNCTIONS.contains(&name);
    let mut blanked: Option<Vec<u8>> = None;
    for (at, pair) in tokens.windows(2).enumerate() {
        if pair[0].text != "@" || !is_ours(pair[1].text) {
            continue;
        }
        let last = match tokens.get(at + 2) {
            Some(open) if open.text == "(" => tokens[closing(&tokens, at + 2)],
            _ if is_for_kernels && pair[1].text == REACH => {
                let body = (at..tokens.len()).find(|&index| tokens[index].text == "{");
                body.map_or(pair[1], |body| tokens[closing(&tokens, body)])
            }
            _ => pair[1],
        };
        let bytes = blanked.get_or_insert_with(|| text.as_bytes().to_vec());
        bytes[pair[0].offset..last.end()]
            .iter_mut()
            .filter(|byte| **byte != b'\n')
            .for_each(|byte| *byte = b' ');
    }
    blanked
        .and_then(|bytes| String::from_utf8(bytes).ok())
        .map_or(Cow::Borrowed(text), Cow::Owned)
}
