//! Promise: textures, samplers and materials of a file load as the standard defines them,
//! or are refused with a message.

use glam::DVec3;
use rasterlab::{
    preset::{ClipPlayback, Clock, Preset},
    scene::{camera::Camera, texture::Texture},
};
use serde_json::json;

use super::model::*;

#[test]
fn transforms_scale_turn_and_move_and_may_name_another_set() {
    let transform = json!({ "offset": [0.25, -1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 3 });
    let model = Model::textured()
        .set("& VEC2 U16 0*2 65535 0 65535*2 0 65535\n/accessors/3/normalized true\nA/TEXCOORD_3 3")
        .with(
            "M/pbrMetallicRoughness/baseColorTexture/extensions",
            json!({ "KHR_texture_transform": transform }),
        );
    let texture = model.texture();
    assert_eq!(texture.set, 3);
    // A quarter turn, counterclockwise with v down, takes u to -v and v to u.
    for (stored, placed) in [
        ([0.0, 0.0], [0.25, -1.0]),
        ([1.0, 0.0], [0.25, -3.0]),
        ([0.0, 1.0], [3.25, -1.0]),
    ] {
        let place = texture.image_coordinates(stored.into());
        assert!(
            place.abs_diff_eq(placed.into(), 1e-6),
            "{stored:?}: {place}"
        );
    }
    let texcoords = model.scene().primitives[0].texcoords[0];
    assert_eq!(texcoords.map(|texcoords| texcoords.normalized), Some(true));
    let named = Model::textured().set("M/pbrMetallicRoughness/baseColorTexture/texCoord 0");
    assert_eq!(named.texture(), Texture::plain(0));
}

#[test]
fn coordinates_come_in_every_width_of_the_standard_and_quantized_ones_where_the_file_says_so() {
    for (kind, full, is_normalized) in [("U8", 255, true), ("U16", 65535, true), ("I16", 1, false)]
    {
        let mut model = Model::textured().set(&format!(
            "& VEC2 {kind} 0*2 {full} 0 {full}*2 0 {full}\n/accessors/3/normalized {is_normalized}\nA/TEXCOORD_0 3"
        ));
        if !is_normalized {
            model.dropped("mesh \"X\" primitive 0 TEXCOORD_0: accessor 3 has the type 2 x I16, which glTF does not allow for it");
            model = model.set("/extensionsRequired [\"KHR_mesh_quantization\"]\n/extensionsUsed [\"KHR_mesh_quantization\"]");
        }
        let scene = model.scene();
        let texcoords = scene.primitives[0].texcoords[0].expect("coordinates");
        let corner = |vertex| {
            [0, 1].map(|component| texcoords.value(&scene.vertex_bytes, vertex, component))
        };
        let corners = [0, 1, 2, 3].map(corner);
        assert_eq!(
            corners,
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            "{kind}"
        );
    }
}

#[test]
fn a_node_that_doubles_its_mesh_doubles_the_thickness() {
    // Its neighbor shows the mesh as it is.
    let scene = Model::textured()
        .set(
            r#"
            M/extensions {"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{"thicknessFactor":3,"attenuationDistance":1.5,"attenuationColor":[0.5,1,0]}}
            /nodes [{"mesh":0},{"mesh":0,"scale":[2,2,2]},{"mesh":0,"scale":[-2,2,2]}]
            /scenes/0/nodes [0,1,2]
            "#,
        )
        .scene();
    let materials = scene
        .instances
        .iter()
        .map(|instance| scene.primitives[instance.primitive].material);
    let of_nodes: Vec<[f32; 3]> = materials
        .map(|material| scene.materials[material].attenuation)
        .collect();
    assert_eq!(
        of_nodes,
        [[0.25, 1.0, 0.0], [0.0625, 1.0, 0.0], [0.0625, 1.0, 0.0]]
    );
    assert_eq!(scene.primitives.len(), 2, "nodes of one scale share one");
}

#[test]
fn what_a_mask_leaves_nothing_of_is_not_drawn() {
    let changes = "M/alphaMode \"MASK\"\nM/pbrMetallicRoughness {\"baseColorFactor\":[1,1,1,0.4]}";
    let nothing = Model::textured().set(changes).scene();
    assert_eq!(nothing.triangle_count(), 0);
    assert_noted(&nothing, "is skipped: the alpha of its material");
}

#[test]
fn textures_that_do_not_fit_are_left_out_by_name() {
    for key in ["wrapS", "magFilter", "minFilter"] {
        let scene = Model::textured()
            .with(&format!("/samplers/0/{key}"), 1)
            .scene();
        assert_eq!(scene.materials[0].base_texture, Some(Texture::plain(0)));
        assert_eq!(scene.faults, [""; 0]);
        assert_noted(
            &scene,
            &format!("sampler 0: its {key} is 1; it must be one of"),
        );
    }
    let basis = Model::textured()
        .set("/extensionsRequired [\"KHR_texture_basisu\"]")
        .scene();
    let wanted = "it requires the extension \"KHR_texture_basisu\", which is not supported; what does not need it is drawn";
    assert_eq!(
        (basis.notes, basis.faults),
        (vec![wanted.to_owned()], vec![])
    );
}

#[test]
fn cameras_of_a_file_are_chosen_by_name_and_go_with_their_nodes() {
    let model = Model::textured().set(
        r#"
        & SCALAR F32 0 2
        & VEC3 F32 0 0 5 4 0 5
        /accessors/3/min [0]
        /accessors/3/max [2]
        /cameras [{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}},{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}]
        /nodes [{"mesh":0},{"children":[2]},{"camera":0,"name":"chase","translation":[0,1,0]},{"camera":1,"name":"still","translation":[0,0,9]}]
        /scenes/0/nodes [0,1,3]
        "#,
    );
    let moved = json!({ "node": 1, "path": "translation" });
    let scene = model
        .animated(moved, json!({ "input": 3, "output": 4 }))
        .scene();
    let names: Vec<&str> = scene
        .cameras
        .iter()
        .map(|camera| camera.name.as_str())
        .collect();
    assert_eq!(names, ["chase", "still"]);
    // At rest its node stands in its parent's place; the first camera is taken unasked.
    for (camera, clip, time_s, eye) in [
        ("", "", 0.5, [0.0, 1.0, 0.0]),
        ("", "Move", 0.5, [1.0, 1.0, 5.0]),
        ("chase", "Move", 1.5, [3.0, 1.0, 5.0]),
        ("#1", "Move", 1.5, [0.0, 0.0, 9.0]),
        ("still", "", 0.0, [0.0, 0.0, 9.0]),
    ] {
        let preset = Preset {
            scene_camera: camera.into(),
            playback: ClipPlayback {
                clip: clip.into(),
                ..ClipPlayback::default()
            },
            clock: Clock {
                time_s,
                ..Clock::default()
            },
            ..Preset::default()
        };
        preset
            .check(&scene)
            .unwrap_or_else(|error| panic!("{error}"));
        let view = preset.view(&scene, [64, 48]);
        assert_eq!(
            (view.eye, view.forward),
            (eye.into(), DVec3::NEG_Z),
            "{camera} {clip}"
        );
    }
    let lost = Preset {
        scene_camera: "crane".into(),
        ..Preset::default()
    };
    let wanted = "scene.camera: the scene has no camera \"crane\"; it has \"chase\", \"still\"";
    assert_eq!(lost.check(&scene).unwrap_err().to_string(), wanted);
    let eye = DVec3::splat(7.0);
    let camera = Some(Camera {
        eye,
        ..Camera::default()
    });
    let own = Preset {
        scene_camera: "still".into(),
        camera,
        ..Preset::default()
    };
    assert_eq!(
        own.view(&scene, [64, 48]).eye,
        eye,
        "a preset's own camera comes first"
    );
}
