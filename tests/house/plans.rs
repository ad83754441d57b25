//! Promise: a plan gives a reason for every axis that decides about something in the picture, and
//! for no other; an option is taken for its speed by what it costs on the adapter, measured there
//! or else on others of its kind.

use std::sync::Arc;

use rasterlab::{
    accuracy::{
        AXES, AccuracyOptions, AxisOption, Coverage, CurlNoise, DotCulling, Perspective, Skinning,
        Transparency, VertexTransform, Visibility, XraySums,
    },
    effects::{Effect, EnabledEffect, Stack},
    plan::{AccuracyRequest, Caps, MeasuredCosts, Plan, StackTraits, Tier, plan},
    preset::{ClipPlayback, Preset, SceneSource},
    preset_file,
    scene::needs::Needs,
};

fn planned(scene: &str, clip: &str, effects: &[&str], tier: Tier) -> (Plan, Stack) {
    planned_for(&Caps::ALL, scene, clip, effects, at_tier(tier))
}

fn at_tier(tier: Tier) -> AccuracyRequest {
    AccuracyRequest {
        tier,
        ..AccuracyRequest::default()
    }
}

fn planned_for(
    caps: &Caps,
    scene: &str,
    clip: &str,
    effects: &[&str],
    request: AccuracyRequest,
) -> (Plan, Stack) {
    let enabled = |name: &&str| EnabledEffect::new(Effect::find(name).expect("an effect"));
    let stack = Stack(effects.iter().map(enabled).collect());
    let playback = ClipPlayback {
        clip: clip.into(),
        ..ClipPlayback::default()
    };
    let preset = Preset {
        scene: SceneSource::Builtin(scene.into()),
        stack: stack.clone(),
        playback,
        ..Preset::default()
    };
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let view = preset.view(&scene, [320, 240]);
    let draws = stack.draws(&scene, &view).expect("a small scene");
    let traits = StackTraits::of(&stack, &request).expect("no two of a slot");
    let needs = Arc::new(Needs::of(&scene, &draws, &view));
    let plan = plan(&needs, &traits, caps, &caps.tuning(), &request);
    (plan.expect("a plan"), stack)
}

/// A tier where packed32 was measured to take so much of the time without.
fn measured(tier: Tier, packed32: f64) -> AccuracyRequest {
    let default = AccuracyOptions::default();
    let mut measured = MeasuredCosts::default();
    let packed = AccuracyOptions {
        visibility: Visibility::Packed32,
        ..default
    };
    measured.learn(&[(default, 10.0), (packed, 10.0 * packed32)]);
    AccuracyRequest {
        measured,
        ..at_tier(tier)
    }
}

#[test]
fn what_was_measured_decides_which_option_is_cheaper_and_the_tolerance_whether_it_may_be_taken() {
    let visibility = |caps: &Caps, request| {
        let (plan, _) = planned_for(caps, "teapot?tess=4", "", &["lambert"], request);
        plan.key.options.visibility
    };
    let software = Caps {
        software: true,
        ..Caps::ALL
    };
    let (card, packed64, packed32) = (Caps::ALL, Visibility::Packed64, Visibility::Packed32);
    for (what, caps, request, wanted) in [
        (
            "a card gains nothing as a rule",
            &card,
            at_tier(Tier::Draft),
            packed64,
        ),
        ("it is cheaper", &card, measured(Tier::Draft, 0.8), packed32),
        (
            "that may be noise",
            &card,
            measured(Tier::Draft, 0.98),
            packed64,
        ),
        ("it is dearer", &card, measured(Tier::Draft, 1.3), packed64),
        (
            "it is not allowed",
            &card,
            measured(Tier::Precise, 0.1),
            packed64,
        ),
        (
            "it is not allowed",
            &card,
            measured(Tier::Reference, 0.1),
            packed64,
        ),
        (
            "it is not allowed",
            &card,
            measured(Tier::Strict, 0.1),
            packed64,
        ),
        (
            "software gains as a rule",
            &software,
            at_tier(Tier::Draft),
            packed32,
        ),
        (
            "what was measured elsewhere no longer counts",
            &software,
            measured(Tier::Draft, 1.0),
            packed64,
        ),
    ] {
        assert_eq!(visibility(caps, request), wanted, "{what}");
    }
    let request = measured(Tier::Draft, 0.8);
    let (plan, _) = planned_for(&Caps::ALL, "teapot?tess=4", "", &["lambert"], request);
    let why = plan.reason(&AXES[Visibility::AXIS]).expect("a reason");
    assert!(
        why.starts_with("packed32: it takes 0.80 of the default's time as measured here"),
        "{why}"
    );
}

#[test]
fn an_axis_has_a_reason_where_it_decides_about_something() {
    let has = |plan: &Plan, axis: usize| plan.reason(&AXES[axis]).is_some();
    let (plain, _) = planned("teapot?tess=4", "", &["lambert"], Tier::Precise);
    for axis in [Coverage::AXIS, VertexTransform::AXIS, Perspective::AXIS] {
        assert!(has(&plain, axis), "{}", AXES[axis].name);
    }
    for axis in [
        DotCulling::AXIS,
        Skinning::AXIS,
        CurlNoise::AXIS,
        XraySums::AXIS,
        Transparency::AXIS,
    ] {
        assert!(
            !has(&plain, axis),
            "{} decides about nothing",
            AXES[axis].name
        );
    }
    let (walker, _) = planned("walker?tess=1", "Walk", &["lambert"], Tier::Precise);
    assert!(has(&walker, Skinning::AXIS));
    let (xray, _) = planned("teapot?tess=4", "", &["xray"], Tier::Precise);
    assert!(has(&xray, XraySums::AXIS) && !has(&plain, XraySums::AXIS));
    let (panes, _) = planned("panes", "", &[], Tier::Precise);
    assert!(has(&panes, Transparency::AXIS));
    let (dots, _) = planned("teapot?tess=4", "", &["dots"], Tier::Precise);
    assert!(has(&dots, DotCulling::AXIS));
    let why = plain.reason(&AXES[Coverage::AXIS]).expect("a reason");
    assert!(why.starts_with("fixed8: "), "{why}");
}

#[test]
fn the_same_request_gives_the_same_plan_whichever_plan_it_starts_from() {
    let (precise, stack) = planned("teapot?tess=4", "", &["lambert"], Tier::Precise);
    let under = |tier: Tier| {
        precise
            .under(&stack, &Caps::ALL.tuning(), &at_tier(tier))
            .expect("a plan")
    };
    let (strict, _) = planned("teapot?tess=4", "", &["lambert"], Tier::Strict);
    assert_eq!(under(Tier::Strict), strict);
    let draft = under(Tier::Draft).prediction;
    assert!(
        draft.wrong_ppm <= Tier::Draft.tolerance().wrong_ppm,
        "{draft:?}"
    );
}
