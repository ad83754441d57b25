//! Options: which one is taken on every accuracy axis, and which combinations no kernel can draw.

use std::sync::Arc;

use super::{
    AccuracyRequest, Tolerance,
    caps::Caps,
    costs,
    error::PlanError,
    predict::{Prediction, predict, predict_all},
    traits::StackTraits,
};
use crate::{
    accuracy::{
        AXES, AccuracyOptions, Axis, AxisOption, Clipping, Coverage, Culling, CurlNoise,
        DepthFormat, DotCulling, Parameters, ParticleStorage, Perspective, PositionFormat,
        SampleCounter, ShaderChecks, ShadowMapSize, ShadowTaps, Skinning, Transparency,
        VertexTransform, Visibility, XraySums,
    },
    effects::{
        Effect,
        dots::LineSource,
        hooks::{Layers, Shape},
        points,
        xray::Reach,
    },
    math::SUBPIXEL_BITS,
    scene::needs::Needs,
};

/// Largest side of a picture whose pixels all lie inside the guard band of 1/4096 px.
const FIXED12_SIDE: u32 = 2047;

/// Most triangles whose ids leave packed32 eight bits for depth.
const PACKED32_TRIANGLES: u64 = (1 << 24) - 1;

/// What options are chosen for.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'a> {
    pub needs: &'a Needs,
    /// Positions of the scene are all f32, even if the tuning chooses another format.
    pub f32_positions: bool,
    pub stack: &'a StackTraits,
    pub layers: Option<Layers>,
    pub caps: &'a Caps,
    pub request: &'a AccuracyRequest,
}

/// Why an option was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    /// The picture has nothing that the axis decides about.
    Unused,
    Pinned,
    /// The default, or what the tier starts from.
    Default,
    /// It takes less time, and its error fits the tolerance.
    Cheaper,
    /// Rounding moves corners of meshes far from the origin, which stored positions are predicted
    /// to cost.
    FarFromOrigin(Prediction),
    /// The picture cannot take the culling that was asked for.
    Limited {
        asked: Culling,
        why: &'static str,
    },
}

/// The options of a picture, why each is taken, and what they are predicted to err by.
pub(super) struct Choice {
    pub options: AccuracyOptions,
    pub causes: [Cause; AXES.len()],
    pub prediction: Prediction,
}

/// Chooses an option on every axis: pins first, then the options that save time and fit the
/// tolerance.
pub(super) fn choose(inputs: &Inputs) -> Result<Choice, PlanError> {
    let Inputs { needs, request, .. } = *inputs;
    let mut options = base_options(inputs);
    let mut causes = [Cause::Default; AXES.len()];
    if let Some(stored) = far_from_origin(&options, inputs) {
        options.position_format = PositionFormat::Relative;
        causes[PositionFormat::AXIS] = Cause::FarFromOrigin(stored);
    }
    for (index, axis) in AXES.iter().enumerate() {
        if is_unused(index, inputs) {
            causes[index] = Cause::Unused;
        } else if request.pins.get(axis).is_some() {
            causes[index] = Cause::Pinned;
        } else if causes[index] == Cause::Default
            && let Some(option) = cheapest(axis, &options, inputs)
        {
            options.set(axis, option);
            causes[index] = Cause::Cheaper;
        }
    }
    if let Some((culling, why)) = culling_limit(&options, inputs) {
        causes[Culling::AXIS] = Cause::Limited {
            asked: options.culling,
            why,
        };
        options.culling = culling;
    }
    check(&options, inputs)?;
    Ok(Choice {
        options,
        causes,
        prediction: predict_all(&options, needs),
    })
}

/// The options to start from: the tier's, the pinned ones, and those that scene, stack and view
/// decide.
fn base_options(inputs: &Inputs) -> AccuracyOptions {
    let Inputs {
        needs,
        stack,
        caps,
        request,
        ..
    } = *inputs;
    let visibility = if caps.int64_atomics {
        Visibility::Packed64
    } else {
        Visibility::Split32
    };
    let mut options = AccuracyOptions {
        visibility,
        ..request.tier.base()
    };
    request.pins.apply(&mut options);
    // The pose has its joint matrices made for a skinning already.
    options.skinning = needs.skinning.unwrap_or_default();
    // The view says how finely shadows are drawn.
    (options.shadow_map_size, options.shadow_taps) = if stack.reads_light() {
        needs.shadow.options()
    } else {
        Default::default()
    };
    if stack.dots.is_none() {
        options.dot_culling = DotCulling::default();
    }
    if needs.glass_draws == 0 {
        options.transparency = Transparency::default();
    }
    if !needs.particle_discs {
        (options.curl_noise, options.particle_storage) =
            (CurlNoise::default(), ParticleStorage::default());
    }
    if inputs.layers == Some(Layers::Race) {
        options.visibility = Visibility::Race;
    }
    options
}

/// Does the axis decide about something that the picture does not have?
fn is_unused(index: usize, inputs: &Inputs) -> bool {
    match index {
        DotCulling::AXIS => inputs.stack.dots.is_none(),
        ShadowMapSize::AXIS | ShadowTaps::AXIS => !inputs.stack.reads_light(),
        Skinning::AXIS => inputs.needs.skinning.is_none(),
        CurlNoise::AXIS | ParticleStorage::AXIS => !inputs.stack.has_particles,
        SampleCounter::AXIS => inputs.stack.draw_order.is_none(),
        XraySums::AXIS => inputs.stack.xray.is_none(),
        Transparency::AXIS => inputs.needs.glass_draws == 0,
        Clipping::AXIS => !inputs.needs.clipping,
        Perspective::AXIS => !inputs.needs.perspective,
        Parameters::AXIS => inputs
            .stack
            .effects
            .iter()
            .all(|effect| effect.fields.is_empty()),
        _ => false,
    }
}

/// The predicted cost of positions as they are stored, where the view asks for others or it exceeds
/// the tolerance: then positions relative to the eye are taken unasked, since they cost no time. A
/// strict picture follows from the preset alone, as the view does.
fn far_from_origin(options: &AccuracyOptions, inputs: &Inputs) -> Option<Prediction> {
    let stored = predict(
        PositionFormat::AXIS,
        options.position_format.index(),
        inputs.needs,
    );
    if inputs.request.pins.option::<PositionFormat>().is_some() {
        return None;
    }
    let is_strict = options.vertex_transform == VertexTransform::Strict;
    let is_over = !is_strict && !stored.is_within(&inputs.request.tolerance());
    (inputs.needs.is_far || is_over).then_some(stored)
}

/// The option of the axis that saves the most time within the tolerance, if any does.
fn cheapest(axis: &Axis, options: &AccuracyOptions, inputs: &Inputs) -> Option<usize> {
    let Inputs {
        needs,
        caps,
        request,
        ..
    } = *inputs;
    let cost = |option: usize| costs::of(axis, option, needs, caps, &request.measured);
    let saves =
        |option: &usize| axis.index() != Skinning::AXIS && cost(*option) < cost(options.get(axis));
    let mut cheaper: Vec<usize> = (0..axis.words.len()).filter(saves).collect();
    cheaper.sort_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    let tolerance: Tolerance = request.tolerance();
    cheaper.into_iter().find(|option| {
        let mut tried = *options;
        tried.set(axis, *option);
        check(&tried, inputs).is_ok() && predict_all(&tried, needs).is_within(&tolerance)
    })
}

/// The most culling that the picture allows, and why, where that is less than was asked for.
/// Culling never shows, so a preset that pins it is drawn without.
fn culling_limit(options: &AccuracyOptions, inputs: &Inputs) -> Option<(Culling, &'static str)> {
    let stack = inputs.stack;
    let (most, why) = match (inputs.layers, options.visibility) {
        _ if options.position_format.packed_bits().is_some() => (
            Culling::None,
            "packed positions lie outside the bounds of their meshlets",
        ),
        _ if stack.vertex_effect().is_some() => {
            (Culling::None, "effects move meshes out of their bounds")
        }
        _ if stack.has_particles => (Culling::None, "particles move out of any meshlet's bounds"),
        _ if stack.shape == Shape::Points || inputs.needs.points => (
            Culling::None,
            "discs reach out of the bounds of their meshes",
        ),
        _ if stack.draw_order.is_some() => (
            Culling::None,
            "a draw order counts the samples of every triangle",
        ),
        (Some(Layers::Race), _) | (_, Visibility::Race) => {
            (Culling::None, "a race shows what happens to every triangle")
        }
        (Some(Layers::Xray { .. } | Layers::Overdraw), _) => {
            (Culling::Frustum, "layers that are hidden count too")
        }
        (_, Visibility::Packed32) => (
            Culling::Frustum,
            "packed32 stores too little of a depth to cull against",
        ),
        _ => return None,
    };
    (options.culling > most).then_some((most, why))
}

/// Refuses what no kernel can draw.
fn check(options: &AccuracyOptions, inputs: &Inputs) -> Result<(), PlanError> {
    let Inputs {
        needs, stack, caps, ..
    } = *inputs;
    if !options.visibility.is_supported(caps.int64_atomics) {
        return Err(PlanError::NoInt64Atomics);
    }
    if options.visibility == Visibility::Packed32 && needs.triangles > PACKED32_TRIANGLES {
        return Err(PlanError::TooManyTriangles {
            triangles: needs.triangles,
        });
    }
    if options.coverage.subpixel_bits() != SUBPIXEL_BITS
        && let Some(effect) = subpixel_effect(stack)
    {
        return Err(PlanError::SubpixelGrid {
            option: options.coverage.name(),
            effect,
        });
    }
    if options.coverage == Coverage::Fixed12 && needs.size.iter().any(|side| *side > FIXED12_SIDE) {
        return Err(PlanError::PictureTooLarge { size: needs.size });
    }
    if options.depth == DepthFormat::Integer && options.coverage.is_float() {
        return Err(PlanError::FloatCoverage {
            option: options.coverage.name(),
        });
    }
    if options.position_format.packed_bits().is_some()
        && let Some(what) = deformation(needs)
    {
        return Err(PlanError::PackedDeformation {
            option: options.position_format.name(),
            what,
        });
    }
    if options.dot_culling == DotCulling::Cpu
        && let Some(what) = moving_lines(inputs)
    {
        return Err(PlanError::MovingLines { what });
    }
    if options.vertex_transform == VertexTransform::Strict
        && let Some(what) = inexact_part(options, inputs)
    {
        return Err(PlanError::NotStrict { what });
    }
    if options.shader_checks == ShaderChecks::Trusted
        && let Some(effect) = stack.effects.iter().find(|effect| effect.is_of_file())
    {
        return Err(PlanError::UncheckedEffect {
            effect: effect.name.clone(),
        });
    }
    check_xray(options, stack)
}

/// Refuses an xray that the sums or the depths cannot draw.
fn check_xray(options: &AccuracyOptions, stack: &StackTraits) -> Result<(), PlanError> {
    let Some(xray) = stack.xray else {
        return Ok(());
    };
    if options.xray_sums != XraySums::Four32 && xray.unit() != 1 {
        return Err(PlanError::XrayWeights {
            option: options.xray_sums.name(),
        });
    }
    if !matches!(options.depth, DepthFormat::Reversed | DepthFormat::Integer)
        && Reach::of(xray.layers) == Reach::Window
    {
        return Err(PlanError::XrayWindow {
            option: options.depth.name(),
        });
    }
    Ok(())
}

/// An effect whose integers are in units of 1/256 px.
fn subpixel_effect(stack: &StackTraits) -> Option<String> {
    let measures = |effect: &&Arc<Effect>| {
        effect
            .hooks
            .sample
            .as_ref()
            .is_some_and(|hook| hook.has_setup)
            || **effect == *points::EFFECT
    };
    stack
        .effects
        .iter()
        .find(measures)
        .map(|effect| effect.name.clone())
}

/// What changes the shape of a mesh after its positions are packed, if anything.
fn deformation(needs: &Needs) -> Option<&'static str> {
    match (
        needs.particle_discs,
        needs.skinning.is_some() || needs.morph_targets,
    ) {
        (true, _) => Some("particles move"),
        (false, true) => Some("joints or morph targets deform one"),
        (false, false) => None,
    }
}

/// What moves lines away from where a tree of fixed lines has them, if anything.
fn moving_lines(inputs: &Inputs) -> Option<String> {
    if inputs.stack.dots == Some(LineSource::Polyline) {
        return None;
    }
    let by_effect = inputs
        .stack
        .vertex_effect()
        .map(|effect| format!("the effect {} moves them", effect.name));
    by_effect.or_else(|| {
        inputs
            .needs
            .moves
            .then(|| "the scene's own clips may move them".to_owned())
    })
}

/// What depends on floats or on chance even behind a strict vertex stage, if anything.
fn inexact_part(options: &AccuracyOptions, inputs: &Inputs) -> Option<String> {
    let Inputs { needs, stack, .. } = *inputs;
    if let Some(effect) = &stack.inexact_effect {
        return Some(format!("the effect {} {}", effect.name, effect.why));
    }
    if options.position_format.packed_bits().is_some() {
        return Some(format!(
            "position_format {} unpacks positions in floats",
            options.position_format.name()
        ));
    }
    let deforms = needs.skinning.is_some() || needs.morph_targets;
    let parts = [
        (deforms, "joints or morph targets deform a mesh in floats"),
        (needs.particle_discs, "particles move in floats"),
        (
            !inputs.f32_positions,
            "a mesh of the scene has positions that are not f32",
        ),
        (
            needs.masked && needs.clipping,
            "the mask of a clipped triangle is placed in floats",
        ),
    ];
    parts
        .into_iter()
        .find(|(is_there, _)| *is_there)
        .map(|(_, what)| what.to_owned())
}
