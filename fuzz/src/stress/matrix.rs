//! Scenes by effects by options by work distributions: every pair of them in few pictures.

use std::sync::Arc;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    covering::{covering_rows, scenes_of_rows},
    drawing::{options, stack, tunings},
    random::{Values, shake},
    scenes::Rng,
};
use crate::{
    accuracy::{
        AXES, Axis, AxisOption, Culling, DepthFormat, Parameters, PinnedOptions, PositionFormat,
        Skinning,
    },
    effects::Stack,
    measure::Budget,
    plan::{AccuracyRequest, Caps, Tuning},
    preset::{ClipPlayback, Clock, Preset, SceneSource},
    scene::Scene,
};

pub const CASES: &[Case] = &[Case {
    number: 36,
    name: "every-pair",
    about: "every pair of a scene, an effect, an option and a work distribution, with the scenes that differ in their kernels; other pictures for each seed",
    expectation: Expectation::Exact,
    run: every_pair,
}];

/// Rigid scenes: together they take each path through the kernels.
pub const SCENES: &[&str] = &[
    "teapot?tess=8",
    "sphere?triangles=5000",
    "sphere?triangles=200",
    "knot?tess=24",
    "cube-wall",
    "field?count=27&triangles=200",
    "globe?tess=6",
    "panels",
    "leaves?n=40",
    "grid?cell=1",
    "grid?cell=0.4",
    "fan?n=13",
    "sizes",
    "slivers",
    "stack",
    "near",
    "chamber",
];

/// Scenes of the gallery that stress nothing in particular.
pub const GALLERY_SCENES: &[&str] = &[
    "town?houses=3",
    "still-life?tess=1",
    "finishes?tess=4&columns=3&lamps=5",
];

/// Scenes with deformed meshes, which the strict vertex stage refuses.
pub const DEFORMED_SCENES: &[&str] = &["tentacle?tess=3", "walker?tess=1"];

/// Scenes that between them take each path through the kernels: every way to store vertices, masks,
/// textures, clipping, triangles of every size, deep stacks, many draws, joints and morph targets.
const SCENES_OF_PAIRS: &[&str] = &[
    "teapot?tess=8",
    "panels",
    "leaves?n=40",
    "panes",
    "near",
    "sizes",
    "stack",
    "town?houses=3",
    "walker?tess=1",
    "tentacle?tess=3",
];

/// Most particles of a picture.
const MAX_PARTICLES: f64 = 200.0;
/// Time of every picture, seconds: clips and particles have moved.
const TIME_S: f64 = 0.4;

/// Image effects whose many passes take long to compile. They read a finished picture, as those among the
/// [`factors`] do, so each chain meets the options that are in the text of its passes and no others.
const IMAGE_CHAINS: &[&[&str]] = &[
    &["ambient", "depth_of_field", "bloom"],
    &["sky", "blur", "glow_edges", "paint"],
    &["aberration", "halftone", "palette", "glitch", "crt"],
];

/// What a level of a factor gives a picture.
#[derive(Clone, Copy)]
enum Level {
    Effects(&'static [&'static str]),
    Pin(&'static Axis, usize),
    Tuning(Tuning),
    RandomValues(bool),
    Gradient(bool),
}

fn pins<O: AxisOption>(levels: &[O]) -> Vec<Level> {
    levels
        .iter()
        .map(|option| Level::Pin(&AXES[O::AXIS], option.index()))
        .collect()
}

/// The factors of [`every_pair`] besides the scene. Effects that exclude one another are levels of
/// one factor.
fn factors(caps: &Caps) -> Vec<Vec<Level>> {
    let effects = |levels: &[&'static [&'static str]]| {
        levels
            .iter()
            .map(|names| Level::Effects(names))
            .collect::<Vec<_>>()
    };
    vec![
        effects(&[
            &[],
            &["facet", "lambert"],
            &["triangle_id", "fog"],
            &["normals", "matcap", "toon"],
            &["studio", "hatch"],
            &["depth"],
        ]),
        effects(&[
            &[],
            &["dissolve"],
            &["stipple"],
            &["wireframe"],
            &["boxes"],
            &["points"],
        ]),
        effects(&[&[], &["explode"], &["inflate", "psx"], &["wobble"]]),
        effects(&[
            &[],
            &["xray"],
            &["overdraw"],
            &["race"],
            &["glass"],
            &["draw_order"],
            &["draw_order", "xray"],
        ]),
        effects(&[&[], &["posterize"], &["outline"], &["dither"], &["tonemap"]]),
        effects(&[&[], &["sharpen", "vignette"], &["pixelate", "grain"]]),
        effects(&[&[], &["shadow"], &["dots"], &["particles"]]),
        pins(&options(caps)),
        pins(&[Culling::None, Culling::Frustum, Culling::TwoPass]),
        pins(&[DepthFormat::Reversed, DepthFormat::Integer]),
        pins(&[PositionFormat::Stored, PositionFormat::Relative]),
        pins(&[Skinning::Linear, Skinning::Dual]),
        pins(&[Parameters::Uniform, Parameters::Baked]),
        tunings()
            .into_iter()
            .chain([caps.tuning()])
            .map(Level::Tuning)
            .collect(),
        [false, true].map(Level::RandomValues).to_vec(),
        [false, true].map(Level::Gradient).to_vec(),
    ]
}

/// A preset of the scene `query` with these effects.
fn preset(query: &str, scene: &Scene, stack: Stack) -> Preset {
    let clip = scene
        .rig
        .clips
        .first()
        .map(|clip| clip.name.clone())
        .unwrap_or_default();
    let mut preset = Preset {
        scene: SceneSource::Builtin(query.into()),
        stack,
        clock: Clock {
            time_s: TIME_S,
            ..Clock::default()
        },
        playback: ClipPlayback {
            clip,
            ..ClipPlayback::default()
        },
        ..Preset::default()
    };
    limit(&mut preset.stack, scene);
    preset
}

/// Keeps the values on which the work of a picture depends where a picture of any scene is quickly
/// drawn: lengths within a fraction of the scene's radius, few particles and dots.
fn limit(stack: &mut Stack, scene: &Scene) {
    let radius = scene.bounds().radius().clamp(1e-3, 1e5);
    for (name, field, range) in [
        ("explode", "amount_m", [0.0, 0.2 * radius]),
        ("inflate", "amount_m", [-0.1 * radius, 0.1 * radius]),
        ("wobble", "amplitude_m", [0.0, 0.1 * radius]),
        ("particles", "count", [0.0, MAX_PARTICLES]),
        ("particles", "radius_m", [0.0, 0.05 * radius]),
        ("dots", "spacing_m", [radius / 60.0, 1e5]),
    ] {
        if let Some(enabled) = stack.get_mut(name) {
            let field = enabled.effect.field(field).expect("a field of the effect");
            let value = field.get(&enabled.words)[0]
                .clamp(range[0], range[1])
                .clamp(field.hard[0], field.hard[1]);
            field
                .set(&mut enabled.words, &[value])
                .expect("a value within the range");
        }
    }
}

fn with_random_values(mut stack: Stack, rng: &mut Rng) -> Stack {
    stack
        .0
        .iter_mut()
        .for_each(|enabled| shake(rng, enabled, Values::OfSlider));
    stack
}

/// What the pictures of a row share.
#[derive(Default)]
struct Row {
    effects: Vec<&'static str>,
    pins: PinnedOptions,
    tuning: Option<Tuning>,
    is_random: bool,
    is_gradient: bool,
}

impl Row {
    fn of_levels(levels: impl Iterator<Item = Level>) -> Self {
        let mut row = Self::default();
        for level in levels {
            match level {
                Level::Effects(effects) => row.effects.extend(effects),
                Level::Pin(axis, option) => row.pins.set(axis, Some(option)),
                Level::Tuning(tuning) => row.tuning = Some(tuning),
                Level::RandomValues(is_random) => row.is_random = is_random,
                Level::Gradient(is_gradient) => row.is_gradient = is_gradient,
            }
        }
        row
    }
}

fn every_pair(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(36);
    let caps = context.renderer.gpu().caps;
    let factors = factors(&caps);
    let rows = covering_rows(&factors.iter().map(Vec::len).collect::<Vec<_>>(), &mut rng);
    let queries = SCENES_OF_PAIRS;
    let scenes = queries
        .iter()
        .map(|query| context.scene(query))
        .collect::<Result<Vec<_>, _>>()?;
    let of_rows = scenes_of_rows(&rows, scenes.len());
    for (levels, of_row) in rows.iter().zip(&of_rows) {
        let levels = factors.iter().zip(levels).map(|(factor, &at)| factor[at]);
        let row = Row::of_levels(levels);
        for &at in of_row {
            judge(context, &mut rng, queries[at], &scenes[at], &row)?;
        }
    }
    let tunings = tunings();
    for (turn, chain) in IMAGE_CHAINS.iter().enumerate() {
        for parameters in pins(&[Parameters::Uniform, Parameters::Baked]) {
            for is_random in [false, true] {
                let levels = [
                    Level::Effects(&["lambert"]),
                    Level::Effects(chain),
                    parameters,
                    Level::Tuning(tunings[turn % tunings.len()]),
                    Level::RandomValues(is_random),
                ];
                let row = Row::of_levels(levels.into_iter());
                let at = turn % scenes.len();
                judge(context, &mut rng, queries[at], &scenes[at], &row)?;
            }
        }
    }
    Ok(())
}

/// Draws the scene `query` as `row` says and judges the picture.
fn judge(
    context: &mut CaseContext,
    rng: &mut Rng,
    query: &str,
    scene: &Arc<Scene>,
    row: &Row,
) -> Result<(), EarlyEnd> {
    const SIZE: [u32; 2] = [96, 72];
    if let Some(tuning) = row.tuning {
        context.renderer.set_tuning(tuning);
    }
    let mut stack = stack(&row.effects);
    if row.is_random {
        stack = with_random_values(stack, rng);
    }
    let mut preset = preset(query, scene, stack);
    if row.is_gradient {
        preset.output.background_bottom = Some([0.9, 0.3, 0.1, 1.0]);
    }
    let (view, stack) = (preset.view(scene, SIZE), preset.evaluated_stack());
    let what = format!(
        "{query} with {:?}{}, {}, {:?}",
        row.effects,
        if row.is_random {
            " of random values"
        } else {
            ""
        },
        row.pins.words(),
        row.tuning
    );
    let accuracy = AccuracyRequest {
        pins: row.pins,
        ..AccuracyRequest::default()
    };
    let (_, verdict) = context.judged(scene, &view, &stack, &accuracy, &what)?;
    // How many pixels lie in the depth band depends on scene and effects alone, and the scenes
    // reach its limit in pictures as small as these. Random values, boxes and discs may put
    // many pixels on a step of color.
    let has_steps = row.is_random
        || ["boxes", "points"]
            .iter()
            .any(|name| row.effects.contains(name));
    let mut budget = Budget::default();
    if has_steps {
        budget.max_step_band_fraction = 1.0;
    }
    let judgement = verdict.report.within(&budget);
    judgement.map_err(|fault| EarlyEnd::Failed(format!("{what}: {fault}")))?;
    let (ill, vertices) = (verdict.report.ill_conditioned, verdict.report.vertices);
    check!(
        row.is_random || ill * 100 <= vertices,
        "{what}: {ill} of {vertices} corners are not judged"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn every_effect_but_the_trail_is_in_the_matrix() {
        let factors = factors(&Caps::ALL);
        let levels = factors.iter().flatten().filter_map(|level| {
            if let Level::Effects(names) = level {
                Some(*names)
            } else {
                None
            }
        });
        let effects: BTreeSet<&str> = levels
            .chain(IMAGE_CHAINS.iter().copied())
            .flatten()
            .copied()
            .collect();
        // A trail needs the pictures before.
        assert_eq!(
            effects,
            EFFECTS
                .iter()
                .map(|effect| effect.name.as_str())
                .filter(|name| *name != "smear")
                .collect()
        );
    }
}
