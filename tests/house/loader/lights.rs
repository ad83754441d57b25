//! Promise: the lights of a glTF file arrive as the extension defines them, at most sixteen of them,
//! where their nodes are, which clips may move; a light that breaks it is left out by name.

use std::f64::consts::FRAC_PI_4;

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

/// The square, and a node for each light of a list.
pub fn lit(lights: &str) -> Model {
    let lights: Value = serde_json::from_str(&format!("[{lights}]")).expect("lights");
    let count = lights.as_array().map_or(0, Vec::len);
    let mut model = Model::square()
        .with("/extensionsUsed", json!(["KHR_lights_punctual"]))
        .with(
            "/extensions",
            json!({ "KHR_lights_punctual": { "lights": lights } }),
        );
    for light in 0..count {
        model.push(
            "nodes",
            json!({ "extensions": { "KHR_lights_punctual": { "light": light } } }),
        );
    }
    model.with("/scenes/0/nodes", (0..=count).collect::<Vec<_>>())
}

fn placed(scene: &Scene, preset: &Preset) -> Vec<PlacedLight> {
    preset.view(scene, [8, 8]).scene_state.lights.to_vec()
}

#[test]
fn each_kind_arrives_with_its_color_intensity_range_and_cone() {
    let scene = lit(r#"{"type":"directional"}, {"type":"point","name":"Lamp","color":[1,0.5,0],"intensity":4,"range":7},
        {"type":"spot","intensity":2,"spot":{}}, {"type":"spot","spot":{"innerConeAngle":0.25,"outerConeAngle":0.5}}"#)
    .silent();
    let lights = scene.lights.iter();
    let read: Vec<_> = lights
        .map(|light| (light.kind, light.light, light.range_m, light.node))
        .collect();
    let cone = |inner, outer| LightKind::Spot { inner, outer };
    let wanted = [
        (LightKind::Directional, [1.0; 3], None, None),
        (LightKind::Point, [4.0, 2.0, 0.0], Some(7.0), None),
        (cone(0.0, FRAC_PI_4), [2.0; 3], None, None),
        (cone(0.25, 0.5), [1.0; 3], None, None),
    ];
    assert_eq!(read, wanted);
    assert_eq!(scene.lights[1].name, "Lamp");
}

#[test]
fn a_light_shines_from_its_node_along_its_negative_z_whatever_its_scale() {
    // A quarter turn about x takes -z down.
    let turn = [-(FRAC_PI_4.sin()), 0.0, 0.0, FRAC_PI_4.cos()];
    let model = lit(r#"{"type":"spot","range":4}"#).with("/nodes/1/rotation", json!(turn));
    let scene = model
        .set("/nodes/1/translation [1,2,3]\n/nodes/1/scale [5,5,5]")
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
    let scene = lit(r#"{"type":"point"}"#)
        .set("& SCALAR F32 0 2\n& VEC3 F32 0 0 0 8 0 0")
        .animated(
            json!({ "node": 1, "path": "translation" }),
            json!({ "input": 2, "output": 3 }),
        )
        .scene();
    let playback = ClipPlayback {
        clip: "Move".into(),
        clip_time_s: Some(0.5),
        ..ClipPlayback::default()
    };
    let mut preset = Preset {
        playback,
        ..Preset::default()
    };
    assert_eq!(placed(&scene, &preset)[0].position, [2.0, 0.0, 0.0]);
    (preset.spin_deg_per_s, preset.clock.time_s) = (90.0, 1.0);
    let [x, _, z] = placed(&scene, &preset)[0].position;
    // About the middle of the square.
    assert!((x - 0.5).abs() < 1e-6 && (z + 1.5).abs() < 1e-6, "{x} {z}");
}

#[test]
fn what_is_left_out_or_too_strong_is_one_note() {
    let nineteen = [r#"{"type":"point"}"#; MAX_LIGHTS + 3].join(",");
    // A lamp of 1000 W as Blender writes it, eight meters above the square.
    let lamp = r#"{"type":"point","intensity":54351}"#;
    for (lights, node, count, note) in [
        (
            &*nineteen,
            "",
            MAX_LIGHTS,
            "it has 19 lights; the first 16 shine, and 3 are left out",
        ),
        (
            r#"{"type":"sky","name":"Dome"}, {"type":"point"}"#,
            "",
            1,
            "light \"Dome\" is left out: its type is unknown",
        ),
        (
            lamp,
            "/nodes/1/translation [0.5,0.5,8]",
            1,
            "its lights are some 3e2 times as strong as what a picture holds; studio.lights = 4e-3 dims them, as in the plain look",
        ),
        (
            r#"{"type":"directional"}"#,
            "/nodes/1/scale [1,1,0]",
            0,
            "light 0 is left out: its node has no direction",
        ),
    ] {
        let scene = lit(lights).set(node).scene();
        assert_eq!(scene.notes, [note]);
        assert_eq!(scene.faults, [""; 0]);
        assert_eq!(scene.lights.len(), count, "{note}");
    }
}

#[test]
fn a_light_that_breaks_the_extension_is_left_out_with_the_reason() {
    for (light, sentence) in [
        (r#"{"intensity":1}"#, "light 0 is left out: it has no type"),
        (
            r#"{"type":"point","intensity":-1}"#,
            "its intensity is -1; it must be from 0 to 1e9",
        ),
        (
            r#"{"type":"point","intensity":1e38}"#,
            "it must be from 0 to 1e9",
        ),
        (
            r#"{"type":"point","color":[1,2]}"#,
            "its color is [1,2]; it must be 3 numbers",
        ),
        (
            r#"{"type":"point","color":[0,-2,0]}"#,
            "its color is -2; it must be from 0 to 1e9",
        ),
        (
            r#"{"type":"point","range":-1}"#,
            "its range is -1; it must be above 0",
        ),
        (
            r#"{"type":"spot","spot":{"outerConeAngle":1.68}}"#,
            "that at most pi / 2",
        ),
        (
            r#"{"type":"spot","spot":{"innerConeAngle":0.7,"outerConeAngle":0.3}}"#,
            "the inner one must be from 0 to the outer one",
        ),
        ("\"point\"", "light 0 is left out: it is \"point\""),
    ] {
        assert!(lit(light).dropped(sentence).lights.is_empty(), "{sentence}");
    }
    lit(r#"{"type":"point"}"#)
        .play("/nodes/1/extensions {\"KHR_lights_punctual\":{\"light\":1}}\n~ its light is 1, but there are only 1 lights");
}
