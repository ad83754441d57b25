//! Promise: compressed models decode as the reference encoders and decoders have them, and faulty
//! streams are refused in a sentence.
//!
//! `meshopt.json` was written by meshoptimizer 1.3.0 and `draco.json` by the encoder and decoder of
//! the npm package draco3d: each entry holds a compressed stream and what the reference decoder
//! makes of it.

use base64::{Engine as _, prelude::BASE64_STANDARD};
use serde_json::{Value, json};

use super::model::*;

fn entries(text: &str) -> Vec<Value> {
    serde_json::from_str(text).expect("a list of entries")
}

fn meshopt() -> Vec<Value> {
    entries(include_str!("meshopt.json"))
}

fn draco() -> Vec<Value> {
    entries(include_str!("draco.json"))
}

fn bytes(entry: &Value, name: &str) -> Vec<u8> {
    BASE64_STANDARD
        .decode(entry[name].as_str().unwrap())
        .unwrap()
}

fn number(entry: &Value, name: &str) -> usize {
    entry[name].as_u64().unwrap() as usize
}

/// Adds a compressed view of `entry` to the model, in a fallback buffer without bytes; returns its
/// index.
fn compressed_view(model: &mut Model, entry: &Value, encoded: &[u8]) -> usize {
    let raw = model.view(encoded);
    let offset = model.json["bufferViews"][raw]["byteOffset"].clone();
    let (count, stride) = (number(entry, "count"), number(entry, "stride"));
    let extension = |value: Value| json!({ "EXT_meshopt_compression": value });
    let marked = extension(json!({ "fallback": true }));
    let fallback = model.push(
        "buffers",
        json!({ "byteLength": count * stride, "extensions": marked }),
    );
    model.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    model.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let about = extension(json!({
        "buffer": 0, "byteOffset": offset, "byteLength": encoded.len(), "byteStride": stride, "count": count,
        "mode": entry["mode"], "filter": entry["filter"],
    }));
    model.push(
        "bufferViews",
        json!({ "buffer": fallback, "byteLength": count * stride, "extensions": about }),
    )
}

/// A model whose vertex colors are the first three bytes of every element of `entry`, or whose
/// indices it is.
fn model_of(entry: &Value, encoded: &[u8]) -> Model {
    let (count, stride) = (number(entry, "count"), number(entry, "stride"));
    let mut model = Model::empty();
    if entry["mode"] == "ATTRIBUTES" {
        let view = compressed_view(&mut model, entry, encoded);
        model.json["bufferViews"][view]["byteStride"] = json!(stride);
        let decoded = bytes(entry, "decoded").len();
        let positions = model.floats("VEC3", &vec![0.0; 3 * decoded / stride.max(1)]);
        let indices = model.numbers("SCALAR U16 0*3");
        let color = |offset: usize| json!({ "bufferView": view, "byteOffset": offset, "componentType": U8, "normalized": true, "type": "VEC4", "count": count });
        for offset in (0..stride).step_by(4) {
            let colors = model.push("accessors", color(offset));
            model.primitive(json!({ "attributes": { "POSITION": positions, "COLOR_0": colors }, "indices": indices }));
        }
    } else {
        let decoded = bytes(entry, "decoded");
        let index = |bytes: &[u8]| {
            bytes
                .iter()
                .rev()
                .fold(0, |sum, &byte| 256 * sum + usize::from(byte))
        };
        let indices = decoded.chunks(stride).filter(|_| stride <= 4);
        let largest = indices.map(index).max().unwrap_or(0);
        let positions = model.floats("VEC3", &vec![0.0; 3 * (1 + largest)]);
        let view = compressed_view(&mut model, entry, encoded);
        let kind = if stride == 2 { U16 } else { U32 };
        let indices = model.push(
            "accessors",
            json!({ "bufferView": view, "componentType": kind, "type": "SCALAR", "count": count }),
        );
        model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    }
    model
}

fn is_small(entry: &Value) -> bool {
    // Indices of billions need as many vertices, and an empty list is no accessor.
    !entry["name"].as_str().unwrap().ends_with("far") && number(entry, "count") >= 3
}

#[test]
fn meshopt_streams_decode_as_the_reference_has_them() {
    let entries = meshopt();
    assert!(entries.len() > 15);
    for entry in entries.iter().filter(|entry| is_small(entry)) {
        let decoded = bytes(entry, "decoded");
        let scene = model_of(entry, &bytes(entry, "encoded")).scene();
        let is_vertices = entry["mode"] == "ATTRIBUTES";
        let stored = if is_vertices {
            &scene.vertex_bytes
        } else {
            &scene.index_bytes
        };
        let is_there = stored.windows(decoded.len()).any(|part| part == decoded);
        assert!(is_there, "{}", entry["name"]);
        assert_eq!(scene.notes.len(), 0, "{:?}", scene.notes);
    }
}

#[test]
fn faulty_meshopt_streams_are_refused() {
    let mut entries = meshopt().into_iter();
    let entry = entries
        .find(|entry| entry["name"] == "attributes 12 x 65")
        .unwrap();
    let encoded = bytes(&entry, "encoded");
    model_of(&entry, &encoded[..40])
        .without_it("EXT_meshopt_compression: its compressed data is cut off");
    let with = |name: &str, value: Value| {
        let mut entry = entry.clone();
        entry[name] = value;
        model_of(&entry, &encoded)
    };
    with("count", json!(1_000_000_000)).refused("it unpacks to 12000000000 bytes");
    with("count", json!(9_000_000)).without_it("its compressed data is cut off");
    with("mode", json!("TRIANGLES")).without_it("byteStride is 12; Triangles allows 2 or 4");
    with("filter", json!("OCTAHEDRAL"))
        .without_it("the filter Octahedral does not fit mode Attributes with byteStride 12");
    with("filter", json!("NEW")).without_it("its EXT_meshopt_compression is malformed");
    let mut other = encoded.clone();
    other[0] = 0xa1;
    model_of(&entry, &other).without_it("begins with [a1]; this version begins with a0");
}

/// A model whose one primitive is compressed, without any other bytes.
fn draco_model(entry: &Value, encoded: &[u8]) -> Model {
    let mut model = Model::empty();
    let view = model.view(encoded);
    let points = number(entry, "points");
    let mut attributes = json!({});
    let mut ids = json!({});
    for (name, attribute) in entry["attributes"].as_object().unwrap() {
        let lanes = attribute["values"].as_array().unwrap().len() / points;
        let is_color = name == "COLOR_0";
        let accessor = json!({
            "componentType": if is_color { U8 } else { F32 }, "normalized": is_color, "type": format!("VEC{lanes}"), "count": points,
            "min": vec![-10; lanes], "max": vec![10; lanes],
        });
        attributes[name] = json!(model.push("accessors", accessor));
        ids[name] = attribute["id"].clone();
    }
    let count = entry["indices"].as_array().unwrap().len();
    let indices = json!({ "componentType": U16, "type": "SCALAR", "count": count });
    let indices = model.push("accessors", indices);
    let extension =
        json!({ "KHR_draco_mesh_compression": { "bufferView": view, "attributes": ids } });
    model.primitive(
        json!({ "attributes": attributes, "indices": indices, "extensions": extension }),
    );
    model.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    model.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    model
}

#[test]
fn draco_streams_decode_as_the_reference_has_them() {
    for entry in draco() {
        let scene = draco_model(&entry, &bytes(&entry, "encoded")).scene();
        let primitive = &scene.primitives[0];
        let list = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
        let corners = (0..primitive.triangle_count()).flat_map(|t| primitive.corners(&scene, t));
        assert_eq!(
            corners.map(f64::from).collect::<Vec<_>>(),
            list(&entry["indices"]),
            "{}",
            entry["name"]
        );
        for (name, accessor) in [
            ("POSITION", &primitive.positions),
            ("NORMAL", &primitive.normals),
            ("COLOR_0", primitive.colors.as_ref().unwrap()),
        ] {
            let wanted = list(&entry["attributes"][name]["values"]);
            let lanes = wanted.len() as u32 / accessor.count;
            for (i, wanted) in wanted.iter().enumerate() {
                let (vertex, lane) = (i as u32 / lanes, i as u32 % lanes);
                let value = accessor.value(&scene.vertex_bytes, vertex, lane);
                let value = if name == "COLOR_0" {
                    255.0 * value
                } else {
                    value
                };
                let is_near = (value - wanted).abs() < 1e-4;
                assert!(
                    is_near,
                    "{}: {name} {i}: {value} and {wanted}",
                    entry["name"]
                );
            }
        }
        assert_eq!(scene.notes, [""; 0]);
    }
}

#[test]
fn faulty_draco_streams_are_refused() {
    let entry = &draco()[0];
    let encoded = bytes(entry, "encoded");
    let place = "mesh 0 primitive 0: KHR_draco_mesh_compression: ";
    for bytes in [&encoded[..encoded.len() / 2], b"DRACO"] {
        draco_model(entry, bytes).refused(&format!("{place}its Draco data cannot be decoded"));
    }
    draco_model(entry, &encoded).play(
        r"
        P/extensions/KHR_draco_mesh_compression/bufferView 9
        ! mesh 0 primitive 0: KHR_draco_mesh_compression: bufferView 9 does not exist
        P/extensions/KHR_draco_mesh_compression/attributes/POSITION 7
        ! POSITION: its Draco data has no attribute 7
        /accessors/0/count 35
        ! accessor 0 has 35 elements, and the Draco data 36
        ",
    );
    let mut many = draco_model(entry, &encoded);
    let first = many.json["meshes"][0]["primitives"][0].clone();
    many.json["meshes"][0]["primitives"] = vec![first; 3].into();
    assert_eq!(
        many.scene().primitives.len(),
        3,
        "primitives may share their data"
    );
    assert!(super::model::load(b"{}").is_err());
}
