//! Checking: an effect file is linked alone and validated, so that every fault is reported at its line before any kernel is
//! compiled.

use naga::{
    Module,
    valid::{Capabilities, ValidationFlags, Validator},
};

use super::error::{EffectError, Place, Text};
use crate::{
    effects::Effect,
    shader::{
        library::Library,
        link::{self, LinkError, Linked},
    },
};

/// Most bytes of a function's local variables.
const MAX_LOCAL_BYTES: u32 = 4096;

/// The module of an effect alone.
pub struct Checked {
    pub module: Module,
    /// The text that was read.
    pub linked: Linked,
}

/// Links and validates the effect; its file is `stem` below `effects`.
///
/// # Errors
/// What the linker or naga refuses, at its line of the file.
pub fn check(text: &Text<'_>, effect: &'static Effect) -> Result<Checked, EffectError> {
    let linked = link::link_effect(&Library::from_env(), effect).map_err(|error| of_link(text, effect, &error))?;
    let places = Places { text, linked: &linked, name: format!("effects/{}", effect.file_stem()) };
    let module = naga::front::wgsl::parse_str(&linked.text).map_err(|error| {
        let span = error.labels().next().and_then(|(span, _)| span.to_range());
        let label = error.labels().next().map_or("", |(_, label)| label);
        let detail = if label.is_empty() || error.message().contains(label) { String::new() } else { format!(" ({label})") };
        places.error(span, &format!("{}{detail}", error.message()))
    })?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    validator.validate(&module).map_err(|error| {
        let span = error.spans().next().and_then(|(span, _)| span.to_range());
        let mut message = error.as_inner().to_string();
        let mut cause = std::error::Error::source(error.as_inner());
        while let Some(inner) = cause {
            message = format!("{message}: {inner}");
            cause = inner.source();
        }
        places.error(span, &message)
    })?;
    check_locals(&places, &module)?;
    Ok(Checked { module, linked })
}

/// Refuses local variables that take more memory than an invocation should have.
fn check_locals(places: &Places<'_>, module: &Module) -> Result<(), EffectError> {
    let mut layouter = naga::proc::Layouter::default();
    if layouter.update(module.to_ctx()).is_err() {
        return Err(places.text.whole("a type is too large"));
    }
    for (_, function) in module.functions.iter() {
        for (handle, local) in function.local_variables.iter() {
            let bytes = layouter[local.ty].size;
            if bytes > MAX_LOCAL_BYTES {
                let name = local.name.as_deref().unwrap_or("a variable");
                let message = format!("{name} takes {bytes} bytes; a variable of an effect takes at most {MAX_LOCAL_BYTES}");
                return Err(places.error(function.local_variables.get_span(handle).to_range(), &message));
            }
        }
    }
    Ok(())
}

/// Where lines of a linked text come from.
struct Places<'a> {
    text: &'a Text<'a>,
    linked: &'a Linked,
    /// The file as the linker calls it.
    name: String,
}

impl Places<'_> {
    /// An error at a byte range of the linked text, without line breaks in its message.
    fn error(&self, span: Option<std::ops::Range<usize>>, message: &str) -> EffectError {
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        let message = message.trim_end_matches('.').to_owned();
        let Some(span) = span else { return self.text.whole(message) };
        let place = Place::of(&self.linked.text, span.start, span.len());
        let line = place.line as usize - 1;
        let file = self.linked.files.iter().rev().find(|(_, first)| *first <= line);
        match file {
            Some((name, first)) if *name == self.name && line - first < self.text.text.lines().count() => {
                // Attributes are blank in the linked text, so the line is taken from the file.
                let line_text = self.text.text.lines().nth(line - first).unwrap_or_default().trim_end().chars().take(200).collect();
                let place = Place { line: (line - first) as u32 + 1, text: line_text, ..place };
                EffectError { file: self.text.file.into(), place: Some(place), message }
            }
            _ => self.text.whole(message),
        }
    }
}

fn of_link(text: &Text<'_>, effect: &Effect, error: &LinkError) -> EffectError {
    let own = format!("effects/{}", effect.file_stem());
    match error {
        LinkError::Undeclared { file, line, name, declared_in } if *file == own => {
            let offset: usize = text.text.split_inclusive('\n').take(*line as usize - 1).map(str::len).sum();
            let column = text.text[offset..].find(name.as_str()).unwrap_or(0);
            let is_open = declared_in.strip_prefix("lib/").is_some_and(|file| super::declaration::LIBRARY.contains(&file));
            let message = match is_open {
                true => format!("{name} is declared in {declared_in}; add the line //@ use {declared_in}"),
                false => format!("{name} belongs to the kernels, and an effect cannot use it; choose another name"),
            };
            text.error(offset + column, name.len(), message)
        }
        other => text.whole(other.to_string()),
    }
}
