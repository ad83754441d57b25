//! Reading: the text of an effect file becomes an effect with the hooks that its functions are on.

use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};

use super::{
    check::{self, Parts},
    declaration::{self, Author},
    error::{EffectError, Text},
    images, picture_twin, rewrite,
    tokens::Token,
    twin::{self, Function},
    words,
};
use crate::{
    effects::{
        EMBEDDED_IMAGE, Effect, EffectSource, SurfaceInput, hooks::Hooks, text::reads_triangle,
    },
    evaluator::Precision,
    shader::library::Library,
};

/// Most bytes of an effect file, apart from pictures inside its text.
pub const MAX_BYTES: usize = 64 << 10;
/// Most bytes of an effect file with pictures inside its text.
pub const MAX_SHARED_BYTES: usize = MAX_BYTES + images::MAX_IMAGE_BYTES / 3 * 4 + 1024;
/// Most instructions of a hook that has loops, with all that it calls. Loops take
/// [`rewrite::MAX_TURNS`] turns together, so that the product bounds what a pixel can cost.
pub const MAX_LOOPED_INSTRUCTIONS: usize = 8192;
/// Longest name of an effect.
const MAX_NAME_CHARS: usize = 40;
/// Most unused effects that are kept.
const MAX_UNUSED: usize = 64;
/// Names that mean something else in preset files, on the command line or in effect files.
pub const RESERVED_NAMES: [&str; 23] = [
    "about",
    "accuracy",
    "animation",
    "background",
    "camera",
    "clock",
    "effect_files",
    "effects",
    "ground",
    "light",
    "name",
    "output",
    "pixel",
    "playback",
    "polyline",
    "sample",
    "scene",
    "schema",
    "stack",
    "surface",
    "tags",
    "test",
    "vertex",
];

/// Is it a name that an effect may have?
///
/// # Errors
/// Completes a sentence that begins with the name.
pub fn check_name(name: &str) -> Result<(), String> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !name.starts_with(|c: char| c.is_ascii_lowercase())
        || !name.chars().all(is_letter)
        || name.len() > MAX_NAME_CHARS
        || name.contains("__")
        || name.ends_with('_')
    {
        return Err(format!(
            "is no name for an effect; it begins with a small letter and has at most {MAX_NAME_CHARS} small letters, digits and single _ between them"
        ));
    }
    if words::is_reserved(name) || words::is_predeclared(name) {
        return Err("is a word of WGSL; choose another name".into());
    }
    if Effect::find(name).is_some() {
        return Err("is the name of a built-in effect; choose another".into());
    }
    if RESERVED_NAMES.contains(&name) {
        return Err("has another meaning in presets or effect files; choose another name".into());
    }
    Ok(())
}

/// The name of the effect that the file at `path` holds.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// [`read_beside`] of a text without a folder: pictures that it takes as inputs are inside it.
pub fn read(file: &str, stem: &str, written: &str) -> Result<Arc<Effect>, EffectError> {
    read_beside(file, stem, written, None)
}

/// Reads the effect `stem` from the text of its file, which messages call `file`, and the pictures
/// that it names from `folder`. Equal texts of one name give the same effect. Each text is checked
/// once, since every preset of a folder asks for the effects beside it; a few effects that no preset
/// uses any more stay in memory.
///
/// # Errors
/// The first fault, at its line.
pub fn read_beside(
    file: &str,
    stem: &str,
    written: &str,
    folder: Option<&Path>,
) -> Result<Arc<Effect>, EffectError> {
    static READ: Mutex<BTreeMap<(String, String), Arc<Effect>>> = Mutex::new(BTreeMap::new());
    let known = || READ.lock().unwrap_or_else(PoisonError::into_inner);
    // Files that use a folder of shaders are checked against that folder as it is now.
    let is_kept = matches!(Library::of_process(), Library::Embedded);
    let key = (stem.to_owned(), written.to_owned());
    let found = known().get(&key).filter(|_| is_kept).cloned();
    let is_current = |source: &Arc<EffectSource>| images::are_current(source, folder);
    if let Some(effect) = found.filter(|effect| effect.source.as_ref().is_some_and(is_current)) {
        return Ok(effect);
    }
    let effect = Arc::new(read_anew(file, stem, written, folder)?);
    if !is_kept {
        return Ok(effect);
    }
    let mut known = known();
    if known.len() >= MAX_UNUSED {
        known.retain(|_, effect| Arc::strong_count(effect) > 1);
    }
    // Another thread may have read it meanwhile.
    match known.get(&key).filter(|known| **known == effect) {
        Some(known) => Ok(known.clone()),
        None => {
            known.insert(key, effect.clone());
            Ok(effect)
        }
    }
}

fn read_anew(
    file: &str,
    stem: &str,
    written: &str,
    folder: Option<&Path>,
) -> Result<Effect, EffectError> {
    let text = Text {
        file,
        text: written,
    };
    check_name(stem).map_err(|reason| text.whole(format!("{stem:?} {reason}")))?;
    let check_length = |bytes: usize, most: usize| match bytes > most {
        true => Err(text.whole(format!(
            "the file has {bytes} bytes; an effect has at most {most}"
        ))),
        false => Ok(()),
    };
    // Only a text that has a picture inside is longer.
    check_length(
        written.len(),
        match written.contains(EMBEDDED_IMAGE) {
            true => MAX_SHARED_BYTES,
            false => MAX_BYTES,
        },
    )?;
    let declaration = declaration::read(&text, stem, Author::Anybody)?;
    let named = &declaration.parameters.images;
    check_length(
        written.len() - images::embedded_bytes(written, named),
        MAX_BYTES,
    )?;
    let fields = &declaration.parameters.fields;
    if let Some(vertex) = &declaration.hooks.vertex
        && declaration.reach.is_none()
        && twin::lengths(fields).next().is_none()
    {
        let name = declaration.tokens.iter().find(|token| token.text == vertex);
        let message = "a vertex effect needs an f32 parameter with @unit(m), since it moves a vertex by at most the sum of these lengths, or @reach before a function that says how far";
        return Err(text.at_any(name, message));
    }
    let rewritten = rewrite::rewritten(stem, written, &declaration);
    let source = Arc::new(EffectSource {
        stem: stem.into(),
        written: written.into(),
        linked: rewritten.text.clone(),
        has_endless_loop: has_endless_loop(&declaration.tokens),
        functions: rewritten.functions.clone(),
        images: images::read(&text, named, folder)?,
    });
    let mut effect = Effect {
        name: stem.into(),
        about: declaration.about.clone(),
        hooks: Hooks::default(),
        fields: fields.clone(),
        given: declaration.parameters.given.clone(),
        defaults: declaration.parameters.defaults.clone(),
        wgsl_struct: EffectSource::unique(stem, declaration.struct_name),
        source: Some(source.clone()),
        base: None,
        is_repeatable: |_| true,
    };
    let parts = Parts {
        text: &text,
        stem,
        declaration: &declaration,
        rewritten: &rewritten,
    };
    let whole = Arc::new(effect.clone());
    let checked = check::check(parts, &whole)?;
    let function = |name: &str, precision: Precision| {
        let read = Function::new(
            &checked.module,
            &checked.linked.text,
            name,
            &whole,
            precision,
        );
        let function = read.map_err(|error| {
            let spans: Vec<naga::Span> = error
                .span()
                .map(|span| naga::Span::new(span.start as u32, span.end as u32))
                .into_iter()
                .collect();
            check::error_at(parts, &checked.linked, &spans, &error.to_string())
        })?;
        let length = function.instructions();
        if rewritten.has_loops && length > MAX_LOOPED_INSTRUCTIONS {
            let message = format!(
                "the effect has {length} instructions with all that it calls; an effect with loops has at most {MAX_LOOPED_INSTRUCTIONS}"
            );
            return Err(text.whole(message));
        }
        Ok(function)
    };
    let members: Vec<&str> = declaration
        .tokens
        .windows(2)
        .filter(|pair| pair[0].text == ".")
        .map(|pair| pair[1].text)
        .collect();
    let hooks = &mut effect.hooks;
    if let Some(name) = &source.functions.vertex {
        let needs_triangle = reads_triangle(&declaration.tokens);
        let reach = declaration.reach.as_ref().map(|reach| {
            let name = EffectSource::unique(stem, &reach.name);
            Ok::<_, EffectError>((function(&name, Precision::Double)?, reach.takes_radius))
        });
        let mut hook = twin::vertex(
            function(name, Precision::Double)?,
            function(name, Precision::Single)?,
            needs_triangle,
            reach.transpose()?,
        );
        if let Some(written) = &declaration.hooks.vertex {
            let name = EffectSource::unique(stem, written);
            hook.unheld = Some(twin::moving(function(&name, Precision::Double)?));
        }
        hooks.vertex = Some(hook);
    }
    if let Some(name) = &source.functions.sample {
        hooks.sample = Some(twin::sample(function(name, Precision::Double)?));
    }
    if let Some(name) = &source.functions.surface {
        hooks.surface = Some(twin::surface(
            function(name, Precision::Double)?,
            function(name, Precision::Single)?,
        ));
        hooks.surface_inputs = SurfaceInput::ALL
            .into_iter()
            .filter(|input| members.contains(&input.member()))
            .collect();
    }
    if let Some(name) = &source.functions.image {
        let reads_previous = declaration
            .tokens
            .iter()
            .any(|token| token.text == "image_previous");
        hooks.image = Some(picture_twin::image(
            function(name, Precision::Double)?,
            function(name, Precision::Single)?,
            reads_previous,
        ));
    }
    if !source.functions.passes.is_empty() {
        let all = |precision: Precision| -> Result<Vec<Function>, EffectError> {
            let names = source.functions.passes.iter();
            names.map(|name| function(name, precision)).collect()
        };
        hooks.passes = Some(picture_twin::passes(
            declaration.passes.clone(),
            all(Precision::Double)?,
            all(Precision::Single)?,
        ));
    }
    // Any comparison in the text may be a step of color.
    let has_color = source.functions.surface.is_some() || source.functions.image.is_some();
    hooks.has_steps = has_color && !declaration.is_smooth;
    Ok(effect)
}

/// Is there a `loop` without `break` and `return`?
fn has_endless_loop(tokens: &[Token<'_>]) -> bool {
    let is_endless = |at: usize| {
        let mut depth = 0;
        let body = tokens[at + 1..].iter().take_while(|token| {
            depth += i32::from(token.text == "{") - i32::from(token.text == "}");
            depth > 0
        });
        !body
            .into_iter()
            .any(|token| ["break", "return"].contains(&token.text))
    };
    let mut loops = (0..tokens.len()).filter(|at| tokens[*at].text == "loop");
    loops.any(|at| tokens.get(at + 1).is_some_and(|next| next.text == "{") && is_endless(at))
}

/// The text of a file.
pub fn decoded(text: &Text<'_>, bytes: Vec<u8>) -> Result<String, EffectError> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let lossy = String::from_utf8_lossy(error.as_bytes());
        let message =
            "this byte is not UTF-8, and an effect file is UTF-8 text; save it in that encoding";
        Text {
            text: &lossy,
            ..*text
        }
        .error(valid, 1, message)
    })
}
