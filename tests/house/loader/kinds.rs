//! Promise: of every kind of thing that writers do, what the standard calls valid opens without a
//! fault, and what breaks it opens with one that names the part. Whatever value of the JSON is wrong,
//! the model opens with a note or is refused in a sentence.

use base64::{Engine, prelude::BASE64_STANDARD};
use rasterlab::scene::{
    Scene,
    gltf::{self, LoadError},
};
use serde_json::{Value, json};

use super::{model::*, motion};

fn load(json: &[u8]) -> Result<Scene, LoadError> {
    gltf::load(json, &mut |path, _| match path.to_str() {
        Some("data.bin") => Ok(Model::square().bytes),
        _ => Err(LoadError::new("it is not there")),
    })
}

/// The square as a `.gltf` whose buffer has this URI.
fn with_uri(uri: &str) -> Vec<u8> {
    let model = Model::square().with("/buffers/0/uri", json!(uri));
    model.json.to_string().into_bytes()
}

/// Every integer of the JSON as a float, as some writers give them.
fn as_floats(value: &mut Value) {
    match value {
        Value::Number(number) => *value = json!(number.as_f64()),
        Value::Array(list) => list.iter_mut().for_each(as_floats),
        Value::Object(map) => map.values_mut().for_each(as_floats),
        _ => {}
    }
}

fn clip(target: Value) -> Model {
    let mut model = Model::square();
    let input = model.floats("SCALAR", &[0.0, 1.0]);
    let output = model.floats("VEC3", &[0.0; 6]);
    model.with(
        "/animations",
        json!([{ "channels": [{ "sampler": 0, "target": target }], "samplers": [{ "input": input, "output": output }] }]),
    )
}

#[test]
fn what_is_valid_opens_without_a_fault() {
    let mut zeros = Model::square();
    let still = zeros.push(
        "accessors",
        json!({ "componentType": F32, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 0, 0] }),
    );
    let zeros = zeros.with(
        "/meshes/0/primitives/0/targets",
        json!([{ "POSITION": still }]),
    );
    let mut bare = Model::square();
    bare.primitive(json!({ "attributes": {}, "mode": 4 }));
    let mut placeholder = Model::square();
    placeholder.push("buffers", json!({ "byteLength": 8 }));
    let light = json!({ "KHR_lights_punctual": { "lights": [{ "type": "sky" }] } });
    let mut floats = motion::morphed();
    as_floats(&mut floats.json);
    let harmless = json!(["KHR_materials_sheen", "KHR_materials_clearcoat"]);
    for (name, model) in [
        ("an accessor of zeros", zeros),
        (
            "a channel without a node",
            clip(json!({ "path": "translation" })),
        ),
        (
            "a pointer",
            clip(
                json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/nodes/0" } } }),
            ),
        ),
        ("no POSITION", bare),
        ("a buffer that nothing reads", placeholder),
        (
            "a light of unknown type",
            Model::square().with("/extensions", light),
        ),
        ("integers as floats", floats),
        (
            "corners left over",
            Model::square().with("/accessors/1/count", json!(5)),
        ),
        (
            "a strong light",
            Model::textured()
                .with("/materials/0/emissiveFactor", json!([1, 1, 1]))
                .with(
                    "/materials/0/extensions",
                    json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 1e5 } }),
                ),
        ),
        (
            "required extensions",
            Model::square().with("/extensionsRequired", harmless),
        ),
        (
            "a later minor version",
            Model::square().with("/asset/version", json!("2.1")),
        ),
        (
            "no stride",
            Model::square().with("/bufferViews/0/byteStride", json!(null)),
        ),
    ] {
        let scene = model.scene();
        assert_eq!(scene.faults, [""; 0], "{name}");
        assert!(scene.triangle_count() > 0, "{name}");
    }
    let base64 = BASE64_STANDARD.encode(Model::square().bytes);
    for uri in [
        format!(
            "data:application/octet-stream;base64,{}",
            base64.replace('A', "%41")
        ),
        format!("data:;base64,{}\n{}", &base64[..8], &base64[8..]),
        format!(
            "data:,{}",
            Model::square()
                .bytes
                .iter()
                .map(|b| format!("%{b:02x}"))
                .collect::<String>()
        ),
        "sub/../data.bin".into(),
        "./data.bin".into(),
        ".\\data.bin".into(),
    ] {
        let scene = load(&with_uri(&uri)).unwrap_or_else(|error| panic!("{uri}: {error}"));
        assert_eq!(
            (triangles(&scene), scene.notes.len()),
            (square(), 0),
            "{uri}"
        );
    }
}

#[test]
fn older_materials_keep_their_color() {
    let older = json!({ "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [0.5, 0.25, 1, 1], "diffuseTexture": { "index": 0 } } });
    let model = Model::textured()
        .without("/materials/0/pbrMetallicRoughness")
        .with("/materials/0/extensions", older)
        .with(
            "/extensionsRequired",
            json!(["KHR_materials_pbrSpecularGlossiness"]),
        );
    let material = model.material();
    assert_eq!(material.base_color, [0.5, 0.25, 1.0, 1.0]);
    assert!(material.base_texture.is_some() && model.scene().notes.is_empty());
}

#[test]
fn what_breaks_the_standard_opens_with_one_fault_that_names_the_part() {
    let mut shifted = Model::square();
    shifted.bytes.insert(0, 0);
    let shifted = shifted
        .with("/bufferViews/0/byteOffset", json!(1))
        .with("/bufferViews/1/byteOffset", json!(49))
        .with("/buffers/0/byteLength", json!(61))
        .without("/meshes/0/primitives/0/indices")
        .with("/accessors/0/count", json!(3));
    let mut texture = Model::textured();
    texture.json["images"][0] = json!({ "uri": "missing.png", "name": "flag" });
    for (part, model) in [
        (
            "material \"paper\": baseColorTexture: image \"flag\"",
            Model::textured().with("/images/0/bufferView", json!(0)),
        ),
        (
            "primitive 0 TEXCOORD_3",
            Model::textured().with(&format!("{}/texCoord", super::materials::BASE), json!(3)),
        ),
        (
            "primitive 0 POSITION: accessor 0 has no min and max",
            Model::square().without("/accessors/0/min"),
        ),
        ("accessor 0: byteOffset 0", shifted),
        (
            "primitive 0: its attribute \"BATCHID\" is none of glTF",
            Model::square().with("/meshes/0/primitives/0/attributes/BATCHID", json!(0)),
        ),
        (
            "version of its asset is not a text",
            Model::square().with("/asset/version", json!(2.0)),
        ),
        (
            "node 0: its skin is 3",
            Model::square().with("/nodes/0/skin", json!(3)),
        ),
        (
            "node 0: its camera is \"x\"",
            Model::square().with("/nodes/0/camera", json!("x")),
        ),
        (
            "the file: its scene is 7",
            Model::square().with("/scene", json!(7)),
        ),
        (
            "material 0: it is 5",
            Model::square().with("/materials", json!([5])),
        ),
    ] {
        model.dropped(part);
    }
    let json = Model::square()
        .with("/buffers/0/uri", json!("data.bin"))
        .json
        .to_string();
    let padded = |start: &str, end: &str| load(format!("{start}{json}{end}").as_bytes());
    for (scene, part) in [
        (padded("\u{feff}", ""), "byte order mark"),
        (padded("", "\0\0"), "padded with NUL"),
    ] {
        let scene = scene.expect(part);
        assert_eq!((triangles(&scene), scene.faults.len()), (square(), 1));
        assert!(scene.faults[0].contains(part), "{:?}", scene.faults);
    }
}

#[test]
fn a_file_of_another_kind_says_so() {
    for (bytes, sentence) in [
        (
            &b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"[..],
            "Git LFS pointer",
        ),
        (b"\n<!DOCTYPE html><html></html>", "HTML page"),
        (b"PK\x03\x04....", "zip archive"),
        (b"\x89PNG\r\n", "PNG picture"),
        (b"", "it is empty"),
    ] {
        let error = load(bytes).expect_err(sentence).to_string();
        assert!(
            error.starts_with("it is not a glTF file: ") && error.contains(sentence),
            "{error}"
        );
    }
    let compressed = Model::square().with("/extensionsRequired", json!(["ACME_mesh_compression"]));
    compressed.refused("it requires the extension \"ACME_mesh_compression\"");
}

#[test]
fn a_model_too_small_to_draw_says_so() {
    let scaled = |scale: f64| Model::square().with("/nodes/0/scale", json!([scale, scale, scale]));
    scaled(1e-9).refused("the model is 1.4e-9 m large; models below 4e-6 m are too small to draw");
    scaled(1e-5).scene();
}

#[test]
fn alpha_is_opaque_or_masks_by_image_factor_or_vertices() {
    let painted = |alphas: [f32; 4]| {
        let mut model = Model::square();
        let colors: Vec<f32> = alphas.iter().flat_map(|&a| [1.0, 0.5, 0.25, a]).collect();
        let colors = model.floats("VEC4", &colors);
        model
            .with("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors))
            .with("/meshes/0/primitives/0/material", json!(0))
            .with(
                "/materials",
                json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.8] } }]),
            )
    };
    let opaque = painted([0.1, 0.2, 0.3, 0.4]).scene();
    assert_eq!(
        opaque.primitives[0].colors.map(|colors| colors.components),
        Some(3)
    );
    assert_eq!(
        (
            opaque.materials[0].base_color[3],
            opaque.materials[0].alpha_cutoff
        ),
        (1.0, None)
    );
    let masked = |alphas| {
        painted(alphas)
            .with("/materials/0/alphaMode", json!("MASK"))
            .scene()
    };
    assert_eq!(
        masked([0.7; 4]).materials[masked([0.7; 4]).primitives[0].material].alpha_cutoff,
        None
    );
    assert_eq!(masked([0.5; 4]).triangle_count(), 0);
    let scene = masked([0.0, 1.0, 0.5, 0.25]);
    let primitive = &scene.primitives[0];
    let material = &scene.materials[primitive.material];
    assert_eq!(material.alpha_cutoff, Some(0.625));
    let (texture, places) = (
        material.base_texture.expect("a ramp"),
        primitive.texcoords[0].expect("the alpha of the vertices"),
    );
    let texels = &scene.images[texture.image].levels[0].texels;
    for (vertex, alpha) in [(0, 0), (1, 255), (2, 128), (3, 64)] {
        let u = places.value(&scene.vertex_bytes, vertex, 0);
        assert_eq!(
            texels[(u * 256.0) as usize],
            [255, 255, 255, alpha],
            "{vertex}"
        );
    }
}

#[test]
fn characters_that_hide_or_reorder_are_written_out_in_every_name() {
    let name = "a\u{202e}b\u{2066}\u{200b}\nc";
    let mut model = Model::textured()
        .with("/nodes/0/name", json!(name))
        .with("/meshes/0/name", json!(name));
    model.json["materials"][0]["name"] = json!(name);
    let camera =
        json!({ "type": "perspective", "name": name, "perspective": { "yfov": 1, "znear": 1 } });
    let scene = model
        .with("/cameras", json!([camera]))
        .with("/nodes/0/camera", json!(0))
        .with("/extensionsUsed", json!([name]))
        .scene();
    let shown = "a\\u{202e}b\\u{2066}\\u{200b}\\u{a}c";
    assert_eq!(
        [
            &scene.named_nodes[0].name,
            &scene.primitives[0].mesh,
            &scene.materials[0].name,
            &scene.cameras[0].name
        ],
        [shown; 4]
    );
    assert!(
        scene.notes[0].contains(shown) && scene.primitives[0].name.contains(shown),
        "{:?}",
        scene.notes
    );
}

/// A model of every part, without a note.
fn everything() -> Model {
    let mut model = Model::textured();
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let joints = model.accessor(&[0, 0, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(4));
    let still = model.floats("VEC3", &[0.0; 12]);
    let times = model.floats("SCALAR", &[0.0, 1.0]);
    let places = model.floats("VEC3", &[0.0; 6]);
    for (name, accessor) in [
        ("NORMAL", normals),
        ("JOINTS_0", joints),
        ("WEIGHTS_0", weights),
    ] {
        model.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }
    model
        .with("/meshes/0/primitives/0/targets", json!([{ "POSITION": still }]))
        .with("/meshes/0/primitives/0/mode", json!(4))
        .with("/meshes/0/weights", json!([0.5]))
        .with("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.25 } }]))
        .with("/samplers/0", json!({ "magFilter": 9728, "wrapS": 10497 }))
        .with("/materials/0/alphaMode", json!("OPAQUE"))
        .with("/materials/0/doubleSided", json!(true))
        .with("/skins", json!([{ "joints": [1] }]))
        .with(
            "/nodes",
            json!([{ "mesh": 0, "skin": 0 }, { "name": "joint", "translation": [0, 0, 0], "children": [2] }, { "camera": 0 }]),
        )
        .with("/scenes/0/nodes", json!([0, 1]))
        .with(
            "/animations",
            json!([{ "name": "Move", "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
                "samplers": [{ "input": times, "output": places, "interpolation": "LINEAR" }] }]),
        )
}

/// The pointers of all values below the top.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let at = format!("{at}/{key}");
        found.push(at.clone());
        pointers(value, &at, found);
    };
    match value {
        Value::Array(list) => list
            .iter()
            .enumerate()
            .for_each(|(i, value)| below(&i.to_string(), value)),
        Value::Object(map) => map.iter().for_each(|(key, value)| below(key, value)),
        _ => {}
    }
}

/// Loads it: notes, or a sentence. Panics where neither is sound.
fn outcome(model: &Model, about: &str) -> Vec<String> {
    match model.load() {
        Ok(scene) => {
            assert_sound(&scene);
            scene.notes
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                sentence.len() > 10 && !sentence.contains('\n'),
                "{about}: {sentence:?}"
            );
            vec![sentence]
        }
    }
}

#[test]
fn whatever_value_is_wrong_the_model_opens_with_a_note_or_is_refused_in_a_sentence() {
    let whole = everything();
    assert_eq!(outcome(&whole, "whole"), [""; 0]);
    let mut all = Vec::new();
    pointers(&whole.json, "", &mut all);
    let wrong = [
        json!(true),
        json!("x"),
        json!(-1),
        json!(1.5),
        json!(1e39),
        json!(99),
        json!(18_446_744_073_709_551_615u64),
        json!([]),
        json!([true]),
        json!({}),
    ];
    let kind = |value: &Value| match value {
        Value::Bool(_) => 0,
        Value::Number(_) => 1,
        Value::String(_) => 2,
        Value::Array(_) => 3,
        _ => 4,
    };
    let mut silent = Vec::new();
    for pointer in &all {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        let mut without = whole.clone();
        match without.json.pointer_mut(parent).expect("its parent") {
            Value::Array(list) => drop(list.remove(key.parse().expect("a place"))),
            Value::Object(map) => drop(map.remove(key)),
            _ => unreachable!("only these have parts"),
        }
        outcome(&without, &format!("without {pointer}"));
        let right = whole.json.pointer(pointer).expect("a value").clone();
        let is_index = right.is_u64()
            && !["target", "weights", "min", "max", "translation"]
                .iter()
                .any(|part| parent.ends_with(part));
        for value in &wrong {
            let about = format!("{pointer} = {value}");
            let notes = outcome(&whole.clone().with(pointer, value.clone()), &about);
            let is_wrong = kind(value) != kind(&right) || is_index && value.as_f64() == Some(-1.0);
            if is_wrong && notes.is_empty() {
                silent.push(about);
            }
        }
    }
    assert_eq!(silent, [""; 0], "a wrong value must leave a note");
}
