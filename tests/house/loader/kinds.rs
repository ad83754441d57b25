//! Promise: of every kind of thing that writers do, what the standard calls valid opens without a
//! fault, and what breaks it opens with one that names the part. Whatever value of the JSON is wrong,
//! the model opens with a note or is refused in a sentence.

use base64::{Engine, prelude::BASE64_STANDARD};
use rasterlab::{
    math::hash,
    scene::{
        Scene,
        gltf::{self, LoadError},
    },
};
use serde_json::{Value, json};

use super::{model::*, motion};

fn load(json: &[u8]) -> Result<Scene, LoadError> {
    gltf::load(json, &mut |path, _| match path.to_str() {
        Some("data.bin") => Ok(Model::square().bytes),
        _ => Err(LoadError::new("it is not there")),
    })
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

#[test]
fn what_is_valid_opens_without_a_fault() {
    let mut floats = motion::morphed();
    as_floats(&mut floats.json);
    let strong = Model::textured().set(
        r#"
        M/emissiveFactor [1,1,1]
        M/extensions {"KHR_materials_emissive_strength":{"emissiveStrength":1e5}}
        "#,
    );
    let mut bare = Model::square();
    bare.primitive(json!({ "attributes": {}, "mode": 4 }));
    let mut zeros = Model::square();
    zeros.push("accessors", json!({ "componentType": F32, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 0, 0] }));
    let zeros = zeros.set("P/targets [{\"POSITION\":2}]");
    let moving = Model::square().set("& SCALAR F32 0 1\n& VEC3 F32 0*6");
    let channels = [
        json!({ "path": "translation" }),
        json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/nodes/0" } } }),
    ];
    let channels = channels.map(|target| {
        moving
            .clone()
            .animated(target, json!({ "input": 2, "output": 3 }))
    });
    let others = [
        r#"/buffers [{"byteLength":60},{"byteLength":8}]"#,
        r#"/extensions {"KHR_lights_punctual":{"lights":[{"type":"sky"}]}}"#,
        "/accessors/1/count 5",
        r#"/extensionsRequired ["KHR_materials_sheen","KHR_materials_clearcoat"]"#,
        r#"/asset/version "2.1""#,
        "/bufferViews/0/byteStride null",
    ];
    let others = others.map(|changes| Model::square().set(changes));
    for model in [floats, strong, bare, zeros]
        .into_iter()
        .chain(channels)
        .chain(others)
    {
        let scene = model.scene();
        assert_eq!(scene.faults, [""; 0], "{}", model.json);
        assert!(scene.triangle_count() > 0, "{}", model.json);
    }
    let bytes = Model::square().bytes;
    let base64 = BASE64_STANDARD.encode(&bytes);
    let hex: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    for uri in [
        &*format!(
            "data:application/octet-stream;base64,{}",
            base64.replace('A', "%41")
        ),
        &format!("data:;base64,{}\n{}", &base64[..8], &base64[8..]),
        &format!("data:,{hex}"),
        "sub/../data.bin",
        "./data.bin",
        ".\\data.bin",
    ] {
        let json = Model::square().with("/buffers/0/uri", uri).json.to_string();
        let scene = load(json.as_bytes()).unwrap_or_else(|error| panic!("{uri}: {error}"));
        assert_eq!(
            (triangles(&scene), scene.notes.len()),
            (square(), 0),
            "{uri}"
        );
    }
}

#[test]
fn what_breaks_the_standard_opens_with_one_fault_that_names_the_part() {
    let mut shifted = Model::square();
    shifted.bytes.insert(0, 0);
    shifted.play(
        r"
        /bufferViews/0/byteOffset 1
        /bufferViews/1/byteOffset 49
        /buffers/0/byteLength 61
        - P/indices
        /accessors/0/count 3
        ~ accessor 0: byteOffset 0
        ",
    );
    let json = Model::square()
        .with("/buffers/0/uri", "data.bin")
        .json
        .to_string();
    for (start, end, part) in [
        ("\u{feff}", "", "byte order mark"),
        ("", "\0\0", "padded with NUL"),
    ] {
        let scene = load(format!("{start}{json}{end}").as_bytes()).expect(part);
        assert_eq!((triangles(&scene), scene.faults.len()), (square(), 1));
        assert!(scene.faults[0].contains(part), "{:?}", scene.faults);
    }
}

#[test]
fn a_file_of_another_kind_says_so() {
    for (bytes, sentence) in [
        (
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
            "Git LFS pointer",
        ),
        ("\n<!DOCTYPE html><html></html>", "HTML page"),
        ("PK\x03\x04....", "zip archive"),
        ("", "it is empty"),
        ("garbage", "neither with \"glTF\" nor with the {"),
    ] {
        let error = load(bytes.as_bytes()).expect_err(sentence).to_string();
        assert!(
            error.starts_with("it is not a glTF file: ") && error.contains(sentence),
            "{error}"
        );
    }
    let error = load(b"\x89PNG\r\n").unwrap_err().to_string();
    assert!(
        error.starts_with("it is not a glTF file: ") && error.contains("PNG picture"),
        "{error}"
    );
    Model::square()
        .set("/nodes/0/scale [1e-5,1e-5,1e-5]")
        .scene();
}

#[test]
fn alpha_is_opaque_or_masks_by_image_factor_or_vertices() {
    let painted = |alphas: [f32; 4]| {
        let mut model = Model::square();
        let colors: Vec<f32> = alphas.iter().flat_map(|&a| [1.0, 0.5, 0.25, a]).collect();
        model.floats("VEC4", &colors);
        model.set(
            r#"
            A/COLOR_0 2
            P/material 0
            /materials [{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.8]}}]
            "#,
        )
    };
    let opaque = painted([0.1, 0.2, 0.3, 0.4]).scene();
    assert_eq!(
        opaque.primitives[0].colors.map(|colors| colors.components),
        Some(3)
    );
    let material = &opaque.materials[0];
    assert_eq!((material.base_color[3], material.alpha_cutoff), (1.0, None));
    let masked = |alphas| painted(alphas).set("M/alphaMode \"MASK\"");
    assert_eq!(masked([0.7; 4]).material().alpha_cutoff, None);
    assert_eq!(masked([0.5; 4]).scene().triangle_count(), 0);
    let scene = masked([0.0, 1.0, 0.5, 0.25]).scene();
    let primitive = &scene.primitives[0];
    let material = &scene.materials[primitive.material];
    assert_eq!(material.alpha_cutoff, Some(0.625));
    let texture = material.base_texture.expect("a ramp");
    let places = primitive.texcoords[0].expect("the alpha of the vertices");
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
    let camera =
        json!({ "type": "perspective", "name": name, "perspective": { "yfov": 1, "znear": 1 } });
    let mut model = Model::textured()
        .with("/cameras", json!([camera]))
        .with("/nodes/0/camera", 0);
    for place in ["/nodes/0", "/meshes/0", "M"] {
        model = model.with(&format!("{place}/name"), name);
    }
    let scene = model.with("/extensionsUsed", json!([name])).scene();
    let written = "a\\u{202e}b\\u{2066}\\u{200b}\\u{a}c";
    let (node, mesh) = (&scene.named_nodes[0].name, &scene.primitives[0].mesh);
    assert_eq!(
        [node, mesh, &scene.materials[0].name, &scene.cameras[0].name],
        [written; 4]
    );
    assert!(scene.notes[0].contains(written), "{:?}", scene.notes);
    assert!(scene.primitives[0].name.contains(written));
}

/// A model of every part, without a note.
fn everything() -> Model {
    let mut model = Model::textured();
    model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    model.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(4));
    let model = model.set(
        r#"
        & VEC4 U8 0*16
        & VEC3 F32 0*12
        & SCALAR F32 0 1
        & VEC3 F32 0*6
        A/NORMAL 3
        A/WEIGHTS_0 4
        A/JOINTS_0 5
        P/targets [{"POSITION":6}]
        P/mode 4
        /meshes/0/weights [0.5]
        /cameras [{"type":"perspective","perspective":{"yfov":1.0,"znear":0.25}}]
        /samplers/0 {"magFilter":9728,"wrapS":10497}
        M/alphaMode "OPAQUE"
        M/doubleSided true
        /skins [{"joints":[1]}]
        /nodes [{"mesh":0,"skin":0},{"name":"joint","translation":[0,0,0],"children":[2]},{"camera":0}]
        /scenes/0/nodes [0,1]
        "#,
    );
    let sampler = json!({ "input": 7, "output": 8, "interpolation": "LINEAR" });
    model.animated(json!({ "node": 1, "path": "translation" }), sampler)
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
    let wrong = r#"[true, "x", -1, 1.5, 1e39, 99, 18446744073709551615, [], [true], {}]"#;
    let wrong: Vec<Value> = serde_json::from_str(wrong).expect("values");
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
        let of_numbers = ["target", "weights", "min", "max", "translation"];
        let is_index = right.is_u64() && !of_numbers.iter().any(|part| parent.ends_with(part));
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

/// Bits that flip in the bytes of a model leave it sound, too.
#[test]
fn flipped_bits_leave_a_sound_model_or_a_sentence() {
    let good = everything().glb();
    let mut loaded = 0;
    for seed in 0..4_000u32 {
        let mut bytes = good.clone();
        for flip in 0..1 + hash(seed) % 4 {
            let at = hash(seed.wrapping_mul(16) + flip + 1);
            let bit = at as usize % (8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        if let Ok(scene) = gltf::load(&bytes, &mut |_, _| Err(LoadError::new("no files here"))) {
            assert_sound(&scene);
            loaded += 1;
        }
    }
    assert!(loaded > 100, "only {loaded} files still load");
}
