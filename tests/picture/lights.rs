//! Promise: the lights that come with a scene shine in pictures as in the oracle's, each kind as its
//! formula says, and a scene without them, or a stack that they do not shine on, has no trace of them
//! in its kernels.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};
use rasterlab::{
    effects::{Stack, hooks::Surface},
    oracle,
    scene::{
        Scene,
        punctual::{LightKind, PlacedLight, SceneLight},
        view::View,
    },
    shader::{Pass, library::Library, link},
};

use crate::common::*;

const SIZE: [u32; 2] = [160, 100];

/// Balls under lamps of every kind.
fn balls(lamps: u32) -> (Arc<Scene>, View) {
    let scene = scene(&format!("finishes?tess=4&columns=4&rows=3&lamps={lamps}"));
    let view = view(&scene, SIZE);
    (scene, view)
}

/// Studio without a sun, in a room without light.
fn dark(lights: f64) -> Stack {
    let mut stack = stack(&["studio"]);
    stack.0[0]
        .set("sun", &[0.0, 0.0, 0.0, 1.0])
        .set("strength", &[0.0])
        .set("lights", &[lights]);
    stack
}

fn lamps_look_as_in_the_oracle_alone_through_glass_in_an_xray_and_behind_effects(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = balls(6);
    let option = pinned(quick_option(&renderer));
    for effects in reach.of(
        1,
        [
            &["studio"][..],
            &["studio", "tonemap", "fog"],
            &["wobble", "studio", "toon"],
            &["studio", "glass"],
            &["studio", "xray"],
        ],
    ) {
        let what = effects.join(" ");
        renderer.exact(&scene, &view, &stack(effects), &option, &what);
    }
    renderer.exact(&scene, &view, &dark(1.0), &option, "lamps alone");
}

#[test]
fn lamps_are_in_the_kernel_only_where_they_shine() {
    let Some(mut renderer) = loan() else { return };
    let option = pinned(quick_option(&renderer));
    let mut lights = |lamps: u32, effects: &[&str]| {
        let (scene, view) = balls(lamps);
        renderer.judged(&scene, &view, &stack(effects), &option);
        let key = renderer.key().expect("something was drawn");
        let variants = key.variants(Pass::Resolve);
        let linked = link::link(&Library::Embedded, &Pass::Resolve.path(), key, &variants);
        let text = linked.expect("it links").text;
        (key.surface.lights, text.contains("under_lights"))
    };
    assert_eq!(lights(0, &["studio"]), (0, false));
    assert_eq!(lights(3, &["lambert"]), (0, false));
    assert_eq!(lights(3, &["studio"]), (3, true));
}

fn mistakes_in_lamps_are_caught(reach: Reach) {
    let Some(healthy) = loan() else {
        return;
    };
    let (scene, view) = balls(3);
    let (stack, option) = (dark(1.0), pinned(quick_option(&healthy)));
    let mistakes = [
        (
            "(window * cone * cone / squared)",
            "(window * cone / squared)",
        ),
        ("max(1.0 - reach * reach, 0.0)", "max(1.0 - reach, 0.0)"),
        (
            "for (var i = 0u; i < punctual_count();",
            "for (var i = 1u; i < punctual_count();",
        ),
    ];
    for (from, to) in reach.of(1, mistakes) {
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &option);
        assert!(exactness(&verdict.report).is_err(), "{to}");
    }
}

/// What a white matt surface at the origin shows, facing up, under one light.
fn shown(light: &PlacedLight, stack: &Stack) -> DVec3 {
    let up = Surface {
        normal: DVec3::Y,
        flat_normal: DVec3::Y,
        view: DVec3::new(0.6, 0.8, 0.0),
        ..Surface::example(DVec3::ONE, 0)
    };
    let lights = [*light];
    let light = rasterlab::effects::hooks::Lighting {
        lights: &lights,
        panorama: None,
    };
    stack.shade(up, u32::MAX, &light).color.truncate()
}

#[test]
fn a_light_is_the_sun_of_its_direction_with_the_strength_that_its_formula_gives() {
    let down = DMat4::from_cols(
        DVec4::X,
        DVec4::Z,
        DVec4::new(0.6, 0.8, 0.0, 0.0),
        DVec4::new(1.2, 1.6, 0.0, 1.0),
    );
    let light = |kind, range_m| {
        let light = SceneLight {
            name: String::new(),
            kind,
            light: [0.9, 0.6, 0.3],
            range_m,
            world_from_light: down,
            node: None,
        };
        light.placed(&down)
    };
    let sun = |strength: f64| {
        let mut stack = stack(&["studio"]);
        let [red, green, blue] = [0.9, 0.6, 0.3].map(|v| v * strength / std::f64::consts::PI);
        stack.0[0]
            .set("sun", &[red, green, blue, 1.0])
            .set("sun_direction", &[0.6, 0.8, 0.0])
            .set("strength", &[0.0]);
        shown(&PlacedLight::default(), &stack)
    };
    let spot = LightKind::Spot {
        inner: 0.1,
        outer: 0.2,
    };
    // Two meters away, on the axis of the spot.
    for (kind, range_m, strength) in [
        (LightKind::Directional, None, 1.0),
        (LightKind::Point, None, 0.25),
        (LightKind::Point, Some(4.0), 0.25 * 15.0 / 16.0),
        (LightKind::Point, Some(1.9), 0.0),
        (spot, None, 0.25),
    ] {
        for factor in [1.0, 3.0] {
            let (lamp, sun) = (
                shown(&light(kind, range_m), &dark(factor)),
                sun(strength * factor),
            );
            assert!((lamp - sun).length() < 1e-5, "{kind:?}: {lamp} for {sun}");
            assert!((sun.x > 0.0) == (strength > 0.0));
        }
    }
    assert_eq!(shown(&light(spot, None), &dark(0.0)), DVec3::ZERO);
}

#[test]
fn a_scene_without_its_lamps_is_the_scene_with_lamps_of_no_strength() {
    let draw = |lamps: u32, lights: f64| {
        let (scene, view) = balls(lamps);
        let mut stack = stack(&["studio"]);
        stack.0[0].set("lights", &[lights]);
        oracle::render(&scene, &view, &stack)
            .expect("it fits")
            .color
    };
    let none = draw(0, 1.0);
    assert_eq!(draw(5, 0.0), none);
    assert_ne!(draw(5, 1.0), none);
}

few_and_all!(
    lamps_look_as_in_the_oracle_alone_through_glass_in_an_xray_and_behind_effects,
    mistakes_in_lamps_are_caught,
);
