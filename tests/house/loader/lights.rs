//! Promise: the lights of a glTF file arrive as the extension defines them, at most sixteen of them,
//! where their nodes are, which clips may move; a light that breaks it is left out by name.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;
use rasterlab::{
    preset::{ClipPlayback, Preset},
    scene::{
        Scene,
        punctual::{LightKind, MAX_LIGHTS, PlacedLight},
    },
};
use serde_json::{Value, json};

use super::model::*;

/// The square, and a node for each light.
fn lit(lights: &[Value]) -> Model {
    let mut model = Model::square()
        .with("/extensionsUsed", json!(["KHR_lights_punctual"]))
        .with(
            "/extensions",
            json!({ "KHR_lights_punctual": { "lights": lights } }),
        );
    for light in 0..lights.len() {
        let node = model.push(
            "nodes",
            json!({ "extensions": { "KHR_lights_punctual": { "light": light } } }),
        );
        model.json["scenes"][0]["nodes"]
            .as_array_mut()
            .expect("a list")
            .push(json!(node));
    }
    model
}

fn placed(scene: &Scene, preset: &Preset) -> Vec<PlacedLight> {
    preset.view(scene, [8, 8]).scene_state.lights.to_vec()
}

#[test]
fn each_kind_arrives_with_its_color_intensity_range_and_cone() {
    let scene = lit(&[
        json!({ "type": "directional" }),
        json!({ "type": "point", "name": "Lamp", "color": [1, 0.5, 0], "intensity": 40, "range": 7 }),
        json!({ "type": "spot", "intensity": 2, "spot": {} }),
        json!({ "type": "spot", "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } }),
    ])
    .scene();
    assert_eq!(scene.notes, [""; 0]);
    let read: Vec<_> = scene
        .lights
        .iter()
        .map(|light| (light.kind, light.light, light.range_m, light.node))
        .collect();
    let cone = |inner, outer| LightKind::Spot { inner, outer };
    assert_eq!(
        read,
        [
            (LightKind::Directional, [1.0; 3], None, None),
            (LightKind::Point, [40.0, 20.0, 0.0], Some(7.0), None),
            (cone(0.0, FRAC_PI_4), [2.0; 3], None, None),
            (cone(0.25, 0.5), [1.0; 3], None, None),
        ]
    );
    assert_eq!(scene.lights[1].name, "Lamp");
}

#[test]
fn a_light_shines_from_its_node_along_its_negative_z_whatever_its_scale() {
    // A quarter turn about x takes -z down.
    let turn = [-(FRAC_PI_4.sin()), 0.0, 0.0, FRAC_PI_4.cos()];
    let scene = lit(&[json!({ "type": "spot", "range": 4 })])
        .with("/nodes/1/translation", json!([1, 2, 3]))
        .with("/nodes/1/rotation", json!(turn))
        .with("/nodes/1/scale", json!([5, 5, 5]))
        .scene();
    let light = placed(&scene, &Preset::default())[0];
    let toward = DVec3::from(light.toward.map(f64::from));
    assert!((toward - DVec3::Y).length() < 1e-6, "{toward}");
    assert_eq!(
        (light.position, light.inverse_range),
        ([1.0, 2.0, 3.0], 0.25)
    );
    assert!(light.has_position);
}

#[test]
fn a_clip_moves_a_light_and_a_spin_turns_it() {
    let mut model = lit(&[json!({ "type": "point" })]);
    let times = model.floats("SCALAR", &[0.0, 2.0]);
    let places = model.floats("VEC3", &[0.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    let target = json!({ "node": 1, "path": "translation" });
    let scene = model
        .with("/animations", json!([{ "name": "Go", "channels": [{ "sampler": 0, "target": target }], "samplers": [{ "input": times, "output": places }] }]))
        .scene();
    let mut preset = Preset {
        playback: ClipPlayback {
            clip: "Go".into(),
            clip_time_s: Some(0.5),
            ..ClipPlayback::default()
        },
        ..Preset::default()
    };
    assert_eq!(placed(&scene, &preset)[0].position, [2.0, 0.0, 0.0]);
    (preset.spin_deg_per_s, preset.clock.time_s) = (90.0, 1.0);
    let [x, _, z] = placed(&scene, &preset)[0].position;
    // About the middle of the square.
    assert!((x - 0.5).abs() < 1e-6 && (z + 1.5).abs() < 1e-6, "{x} {z}");
}

#[test]
fn more_lights_than_shine_are_counted_and_unknown_types_named() {
    let scene = lit(&vec![json!({ "type": "point" }); MAX_LIGHTS + 3]).scene();
    assert_eq!(scene.lights.len(), MAX_LIGHTS);
    assert_eq!(
        scene.notes,
        ["it has 19 lights; the first 16 shine, and 3 are left out"]
    );
    let scene = lit(&[
        json!({ "type": "sky", "name": "Dome" }),
        json!({ "type": "point" }),
    ])
    .scene();
    assert_eq!((scene.lights.len(), scene.faults.len()), (1, 0));
    assert_eq!(
        scene.notes,
        ["light \"Dome\" is left out: its type is unknown"]
    );
}

#[test]
fn lights_for_the_exposure_of_a_camera_are_told_with_a_strength_that_dims_them() {
    // A lamp of 1000 W as Blender writes it, eight meters above the square.
    let lamp = lit(&[json!({ "type": "point", "intensity": 54351 })])
        .with("/nodes/1/translation", json!([0.5, 0.5, 8]))
        .scene();
    assert_eq!(
        lamp.notes,
        [
            "its lights are some 3e2 times as strong as what a picture holds; studio.lights = 4e-3 dims them"
        ]
    );
}

#[test]
fn a_light_that_breaks_the_extension_is_left_out_with_the_reason() {
    let wide = json!({ "outerConeAngle": FRAC_PI_2 + 0.1 });
    let crossed = json!({ "innerConeAngle": 0.7, "outerConeAngle": 0.3 });
    for (light, sentence) in [
        (
            json!({ "intensity": 1 }),
            "light 0 is left out: it has no type",
        ),
        (
            json!({ "type": "point", "intensity": -1 }),
            "its intensity is -1; it must be from 0 to 1e9",
        ),
        (
            json!({ "type": "point", "intensity": 1e38 }),
            "it must be from 0 to 1e9",
        ),
        (
            json!({ "type": "point", "color": [1, 2] }),
            "its color is [1,2]; it must be 3 numbers",
        ),
        (
            json!({ "type": "point", "color": [0, -2, 0] }),
            "its color is -2; it must be from 0 to 1e9",
        ),
        (
            json!({ "type": "point", "range": -1 }),
            "its range is -1; it must be above 0",
        ),
        (
            json!({ "type": "spot", "spot": wide }),
            "that at most pi / 2",
        ),
        (
            json!({ "type": "spot", "spot": crossed }),
            "the inner one must be from 0 to the outer one",
        ),
        (json!("point"), "light 0 is left out: it is \"point\""),
    ] {
        let scene = lit(&[light]).dropped(sentence);
        assert!(scene.lights.is_empty(), "{sentence}");
    }
    lit(&[json!({ "type": "point" })])
        .with(
            "/nodes/1/extensions",
            json!({ "KHR_lights_punctual": { "light": 1 } }),
        )
        .dropped("its light is 1, but there are only 1 lights");
    let flat = lit(&[json!({ "type": "directional" })])
        .with("/nodes/1/scale", json!([1, 1, 0]))
        .scene();
    assert_eq!(
        flat.notes,
        ["light 0 is left out: its node has no direction"]
    );
}
