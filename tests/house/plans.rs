//! Promise: a plan gives a reason for every axis that decides about something in the picture, and for no other; what a tier is expected
//! to cost follows from what was measured.

use std::sync::Arc;

use rasterlab::{
    accuracy::{AXES, AxisOption, Coverage, CurlNoise, DotCulling, Perspective, Skinning, VertexTransform, Visibility, XraySums},
    effects::{Effect, EnabledEffect, Stack},
    plan::{AccuracyRequest, Caps, MEASURED_OPTIONS, Measured, OptionCosts, Plan, StackTraits, Tier, plan},
    preset::{ClipPlayback, Preset, SceneSource},
    preset_file,
    scene::needs::Needs,
};

fn planned(scene: &str, clip: &str, effects: &[&str], tier: Tier) -> (Plan, Stack) {
    planned_for(&Caps::ALL, scene, clip, effects, tier)
}

fn planned_for(caps: &Caps, scene: &str, clip: &str, effects: &[&str], tier: Tier) -> (Plan, Stack) {
    let stack = Stack(effects.iter().map(|name| EnabledEffect::new(Effect::find(name).expect("an effect"))).collect());
    let playback = ClipPlayback { clip: clip.into(), ..ClipPlayback::default() };
    let preset = Preset { scene: SceneSource::Builtin(scene.into()), stack: stack.clone(), playback, ..Preset::default() };
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let view = preset.view(&scene, [320, 240]);
    let draws = stack.draws(&scene, &view).expect("a small scene");
    let request = AccuracyRequest { tier, ..AccuracyRequest::default() };
    let traits = StackTraits::of(&stack, &request).expect("no two of a slot");
    let needs = Arc::new(Needs::of(&scene, &draws, &view));
    (plan(&needs, &traits, caps, &caps.tuning(), &request).expect("a plan"), stack)
}

/// An adapter whose calibration found that packed32 takes so much of the defaults' time, and every other option as much as the defaults.
fn calibrated(packed32: f64) -> Caps {
    let mut options = OptionCosts { defaults_ms: [1.0, 4.0], options_ms: [[1.0, 4.0]; MEASURED_OPTIONS.len()] };
    let at =
        MEASURED_OPTIONS.iter().position(|option| *option == (Visibility::AXIS, Visibility::Packed32.index())).expect("it is measured");
    options.options_ms[at] = [packed32, 4.0 * packed32];
    Caps { measured: Some(Measured { options, max_small_samples: 48 }), ..Caps::ALL }
}

#[test]
fn a_calibration_decides_which_option_is_cheaper_and_the_tolerance_whether_it_may_be_taken() {
    let visibility = |caps: &Caps, tier: Tier| planned_for(caps, "teapot?tess=4", "", &["lambert"], tier).0.key.options.visibility;
    assert_eq!(visibility(&Caps::ALL, Tier::Draft), Visibility::Packed64, "a card without a calibration gains nothing");
    assert_eq!(visibility(&calibrated(0.8), Tier::Draft), Visibility::Packed32);
    assert_eq!(visibility(&calibrated(0.98), Tier::Draft), Visibility::Packed64, "that may be noise");
    assert_eq!(visibility(&calibrated(1.3), Tier::Draft), Visibility::Packed64);
    for tier in [Tier::Precise, Tier::Reference, Tier::Strict] {
        assert_eq!(visibility(&calibrated(0.1), tier), Visibility::Packed64, "{}", tier.name());
    }
    // What was measured elsewhere no longer counts.
    let software = |packed32: f64| Caps { software: true, ..calibrated(packed32) };
    assert_eq!(visibility(&Caps { measured: None, ..software(1.0) }, Tier::Draft), Visibility::Packed32);
    assert_eq!(visibility(&software(1.0), Tier::Draft), Visibility::Packed64);

    let (plan, _) = planned_for(&calibrated(0.8), "teapot?tess=4", "", &["lambert"], Tier::Draft);
    let why = plan.reason(&AXES[Visibility::AXIS]).expect("a reason");
    assert!(why.starts_with("packed32: 0.80 of the default's time as calibrated"), "{why}");
    assert!((plan.expected_time() - 0.8).abs() < 1e-12);
    assert_eq!(plan.key.paths.max_small_samples, 48);
    let small = plan.reasons().into_iter().find(|note| note.name == "small").expect("a reason");
    assert_eq!(small.why, "one invocation walks up to 48 samples: as the calibration measured");
}

#[test]
fn an_axis_has_a_reason_where_it_decides_about_something() {
    let has = |plan: &Plan, axis: usize| plan.reason(&AXES[axis]).is_some();
    let (plain, _) = planned("teapot?tess=4", "", &["lambert"], Tier::Precise);
    for axis in [Coverage::AXIS, VertexTransform::AXIS, Perspective::AXIS] {
        assert!(has(&plain, axis), "{}", AXES[axis].name);
    }
    for axis in [DotCulling::AXIS, Skinning::AXIS, CurlNoise::AXIS, XraySums::AXIS] {
        assert!(!has(&plain, axis), "{} decides about nothing", AXES[axis].name);
    }
    let (walker, _) = planned("walker?tess=1", "Walk", &["lambert"], Tier::Precise);
    assert!(has(&walker, Skinning::AXIS));
    let (xray, _) = planned("teapot?tess=4", "", &["xray"], Tier::Precise);
    assert!(has(&xray, XraySums::AXIS) && !has(&plain, XraySums::AXIS));
    let (dots, _) = planned("teapot?tess=4", "", &["dots"], Tier::Precise);
    assert!(has(&dots, DotCulling::AXIS));
    let why = plain.reason(&AXES[Coverage::AXIS]).expect("a reason");
    assert!(why.starts_with("fixed8: "), "{why}");
}

#[test]
fn a_stricter_tier_is_expected_to_cost_no_less() {
    let (precise, stack) = planned("teapot?tess=4", "", &["lambert"], Tier::Precise);
    let under = |tier: Tier| {
        let request = AccuracyRequest { tier, ..AccuracyRequest::default() };
        precise.under(&stack, &Caps::ALL.tuning(), &request).expect("a plan")
    };
    let times: Vec<f64> = Tier::ALL.iter().map(|tier| under(*tier).expected_time()).collect();
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "{times:?}");
    assert!((precise.expected_time() - 1.0).abs() < 1e-12 && times[4] > 1.1, "{times:?}");
    // The same request gives the same plan, whichever plan it starts from.
    assert_eq!(under(Tier::Strict), planned("teapot?tess=4", "", &["lambert"], Tier::Strict).0);
    let draft = under(Tier::Draft).prediction;
    assert!(draft.wrong_ppm <= Tier::Draft.tolerance().wrong_ppm, "{draft:?}");
}
