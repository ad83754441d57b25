//! Promise: truncated, flipped and edited files never panic.

use image::ImageFormat;
use rasterlab::{
    math::hash,
    scene::gltf::{self, LoadError},
};
use serde_json::json;

use super::{model::*, motion::skinned};

/// A model with every kind of thing the loader follows.
fn everything() -> Model {
    let mut model = skinned(0.5);
    let indices = model.view(&[1, 3]);
    let values = model.view(&le_floats(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
    let colors = model.accessor(&[9; 16], U8, "VEC4", 4);
    model.json["accessors"][colors]["normalized"] = json!(true);
    let target = json!([{ "POSITION": 0, "NORMAL": 0 }]);
    model.json["meshes"][0]["primitives"][0]["targets"] = target.clone();
    model.primitive(
        json!({ "attributes": { "POSITION": 0, "COLOR_0": colors, "JOINTS_0": 3, "WEIGHTS_0": 4 }, "mode": 5, "targets": target }),
    );
    let times = model.floats("SCALAR", &[0.0, 0.5, 2.0]);
    let turns = model.floats("VEC4", &[0.0, 0.0, 0.0, 1.0].repeat(9));
    let weights = model.floats("SCALAR", &[0.0, 1.0, 0.5]);
    model = model.with(
        "/animations",
        json!([{
            "channels": [{ "sampler": 0, "target": { "node": 2, "path": "rotation" } }, { "sampler": 1, "target": { "node": 0, "path": "weights" } }],
            "samplers": [{ "input": times, "output": turns, "interpolation": "CUBICSPLINE" }, { "input": times, "output": weights }],
        }]),
    );
    model
        .with(
            "/accessors/0/sparse",
            json!({ "count": 2, "indices": { "bufferView": indices, "componentType": U8 }, "values": { "bufferView": values } }),
        )
        .with("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.25 } }]))
        .with("/nodes/1/camera", json!(0))
        .with("/images", json!([{ "bufferView": 0, "mimeType": "image/png" }]))
        .with("/materials", json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 1] }, "alphaMode": "BLEND" }]))
        .with("/meshes/0/primitives/0/material", json!(0))
}

fn never_panics(bytes: &[u8], about: &str) -> bool {
    let outcome = gltf::load(bytes, &mut |_, _| Err(LoadError::new("no files here")));
    match outcome {
        Ok(scene) => {
            assert_sound(&scene);
            true
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                !sentence.is_empty() && !sentence.contains('\n'),
                "{about}: {sentence}"
            );
            false
        }
    }
}

#[test]
fn truncated_files_never_panic() {
    let good = everything().glb();
    assert!(never_panics(&good, "whole"));
    let json = good.len() - everything().bytes.len() - 8;
    for length in 0..good.len() {
        // What lies in the bytes that are left may be drawn.
        let loads = never_panics(&good[..length], &format!("first {length} bytes"));
        assert!(!loads || length >= json, "first {length} bytes");
    }
}

#[test]
fn flipped_bits_never_panic() {
    let good = everything().glb();
    let mut loaded = 0;
    for seed in 0..4_000u32 {
        let mut bytes = good.clone();
        for flip in 0..1 + hash(seed) % 4 {
            let at = hash(seed.wrapping_mul(16) + flip + 1);
            let bit = at as usize % (8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        loaded += u32::from(never_panics(&bytes, &format!("seed {seed}")));
    }
    assert!(
        loaded > 100,
        "only {loaded} files still load: the mutations are too rough to reach far"
    );
}

/// Numbers of the JSON replaced by awkward ones: this reaches what lies behind the parser.
#[test]
fn awkward_numbers_never_panic() {
    const AWKWARD: [&str; 12] = [
        "0",
        "1",
        "2",
        "3",
        "5",
        "-1",
        "255",
        "65536",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "1e39",
    ];
    let model = everything();
    let text = model.json.to_string();
    let is_number = |i: usize| {
        text.as_bytes()[i].is_ascii_digit()
            && !text.as_bytes()[i - 1].is_ascii_alphanumeric()
            && text.as_bytes()[i - 1] != b'_'
    };
    let numbers: Vec<usize> = (1..text.len())
        .filter(|&i| is_number(i) && !b".\"".contains(&text.as_bytes()[i - 1]))
        .collect();
    let mut loaded = 0;
    for seed in 0..6_000u32 {
        let start = numbers[hash(3 * seed) as usize % numbers.len()];
        let end = (start..text.len())
            .find(|&i| !b"0123456789.e-".contains(&text.as_bytes()[i]))
            .unwrap();
        let value = AWKWARD[hash(3 * seed + 1) as usize % AWKWARD.len()];
        let json = format!("{}{value}{}", &text[..start], &text[end..]);
        loaded += u32::from(never_panics(&glb(json.as_bytes(), &model.bytes), &json));
    }
    assert!(loaded > 500, "only {loaded} files still load");
}

#[test]
fn broken_images_never_panic() {
    let (png, jpeg) = (encoded(ImageFormat::Png), encoded(ImageFormat::Jpeg));
    let mut loaded = 0;
    for seed in 0..1_200u32 {
        let mut bytes = if seed % 2 == 0 {
            png.clone()
        } else {
            jpeg.clone()
        };
        for flip in 0..1 + seed % 3 {
            let at = rasterlab::math::hash(8 * seed + flip) as usize % (8 * bytes.len());
            bytes[at / 8] ^= 1 << (at % 8);
        }
        match Model::textured().showing(&bytes).load() {
            Ok(scene) => loaded += u32::from(scene.faults.is_empty()),
            Err(error) => panic!("seed {seed}: {error}"),
        }
    }
    assert!(
        loaded > 20,
        "only {loaded} still load: the mutations are too rough"
    );
}
