//! Built-in effects by their own text: the hooks of an effect, evaluated in f64 from its WGSL as
//! those of a file are. They are a third witness beside the kernels and the functions in Rust.

use std::sync::Arc;

use naga::valid::{ValidationFlags, Validator};

use super::{
    picture_twin,
    twin::{self, Function},
};
use crate::{
    effects::{
        Effect,
        hooks::{Hooks, SampleHook, VertexHook},
    },
    evaluator::{LowerError, Precision},
    shader::{
        glue::Chain,
        image_passes::pass_function,
        library::Library,
        link::{self, LinkError},
        reflect::capabilities,
    },
};

/// Why the text of an effect cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum EvaluatedError {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error("{0}")]
    Refused(String),
    #[error(transparent)]
    Lower(#[from] LowerError),
}

/// The hooks of `effect`, with each function of them evaluated from the text that the library has
/// for it. Bounds stay as they are.
///
/// # Errors
/// The text cannot be linked, is not valid, or uses what cannot be evaluated.
pub fn evaluated(library: &Library, effect: &Arc<Effect>) -> Result<Hooks, EvaluatedError> {
    evaluated_in(library, effect, Precision::Double)
}

/// [`evaluated`] with floats of another precision.
pub fn evaluated_in(
    library: &Library,
    effect: &Arc<Effect>,
    precision: Precision,
) -> Result<Hooks, EvaluatedError> {
    let linked = link::link_effect(library, effect)?;
    let text = &linked.text;
    let module = naga::front::wgsl::parse_str(text)
        .map_err(|error| EvaluatedError::Refused(error.emit_to_string(text)))?;
    let validated = Validator::new(ValidationFlags::all(), capabilities()).validate(&module);
    validated.map_err(|error| EvaluatedError::Refused(error.emit_to_string(text)))?;
    let function = |chain: Chain, precision| {
        Function::new(&module, text, &chain.function(effect), effect, precision)
    };
    let mut hooks = effect.hooks.clone();
    if let Some(hook) = hooks.vertex.take() {
        let [chosen, single] =
            [precision, Precision::Single].map(|precision| function(Chain::Vertex, precision));
        hooks.vertex = Some(VertexHook {
            moved: twin::vertex(chosen?, single?, hook.needs_triangle, None).moved,
            ..hook
        });
    }
    if let Some(hook) = hooks.sample.take() {
        let is_drawn = twin::sample(function(Chain::Sample, precision)?).is_drawn;
        let sample_setup = match hook.has_setup {
            true => twin::sample_setup(function(Chain::SampleSetup, precision)?),
            false => hook.sample_setup.clone(),
        };
        hooks.sample = Some(SampleHook {
            is_drawn,
            sample_setup,
            ..hook
        });
    }
    if hooks.surface.is_some() {
        let function = function(Chain::Surface, precision)?;
        hooks.surface = Some(twin::surface(function.clone(), function));
    }
    if let Some(hook) = hooks.image {
        let function = function(Chain::Image, precision)?;
        hooks.image = Some(picture_twin::image(
            function.clone(),
            function,
            hook.reads_previous,
        ));
    }
    if let Some(hook) = hooks.passes {
        let functions = (0..hook.passes.len())
            .map(|pass| {
                let name = pass_function(effect, pass);
                Function::new(&module, text, &name, effect, precision)
            })
            .collect::<Result<Vec<_>, _>>()?;
        hooks.passes = Some(picture_twin::passes(
            hook.passes,
            functions.clone(),
            functions,
        ));
    }
    Ok(hooks)
}
