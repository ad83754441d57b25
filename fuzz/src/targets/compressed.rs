//! Compressed meshes: streams of Draco and of meshopt.
//!
//! Input begins with five bytes that choose the kind, the stride, the filter and the count, or of
//! Draco the number of indices and of points; the stream follows.

use serde_json::{Value, json};

use super::{Outcome, Target, model};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "compressed",
    about: "Draco and meshopt streams of models",
    views: &[],
    limit: Limit::new(20, 2048),
    check,
};

/// Bytes in front of the stream: kind (0 is Draco), stride, filter, and the count as little-endian
/// u16; of Draco stride and filter are the number of indices, another u16.
pub const HEAD: usize = 5;

/// Bytes in front of the stream in the model's buffer.
const ZEROS: usize = 16;

fn check(input: &[u8]) -> Outcome {
    let Some((&[kind, stride, filter, low, high], stream)) = input.split_first_chunk::<HEAD>()
    else {
        return Err("it has no head".into());
    };
    let count = usize::from(u16::from_le_bytes([low, high]));
    let json = match kind % 4 {
        0 => draco(
            stream.len(),
            count,
            usize::from(u16::from_le_bytes([stride, filter])),
        ),
        mode => meshopt(
            stream.len(),
            count,
            usize::from(stride),
            usize::from(mode - 1),
            usize::from(filter),
        ),
    };
    let scene = model::read(&views::joined(
        json.to_string().as_bytes(),
        &[&[0; ZEROS], stream].concat(),
    ))
    .map_err(|error| error.to_string())?;
    model::use_scene(&scene);
    Ok(())
}

fn base(stream: usize) -> Value {
    json!({
        "asset": { "version": "2.0" }, "buffers": [{ "byteLength": ZEROS + stream }], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        "bufferViews": [{ "buffer": 0, "byteOffset": ZEROS, "byteLength": stream.max(1) }, { "buffer": 0, "byteLength": ZEROS }],
    })
}

fn draco(stream: usize, count: usize, indices: usize) -> Value {
    let mut json = base(stream);
    let accessor = |lanes: usize, kind: u32| json!({ "componentType": kind, "normalized": kind == 5121, "type": format!("VEC{lanes}"), "count": count, "min": vec![-10; lanes], "max": vec![10; lanes] });
    json["accessors"] = json!([
        accessor(3, 5126), accessor(3, 5126), accessor(2, 5126), accessor(4, 5121), { "componentType": 5123, "type": "SCALAR", "count": indices },
    ]);
    json["meshes"] = json!([{ "primitives": [{
        "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3 }, "indices": 4,
        "extensions": { "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3 } } },
    }] }]);
    (json["extensionsUsed"], json["extensionsRequired"]) = (
        json!(["KHR_draco_mesh_compression"]),
        json!(["KHR_draco_mesh_compression"]),
    );
    json
}

fn meshopt(stream: usize, count: usize, stride: usize, mode: usize, filter: usize) -> Value {
    let mut json = base(stream);
    let mode = ["ATTRIBUTES", "TRIANGLES", "INDICES"][mode];
    let filter = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"][filter % 4];
    // Positions are sparse: zeros that take no bytes of the file.
    let vertices = if mode == "ATTRIBUTES" { count } else { 65_535 };
    json["buffers"]
        .as_array_mut()
        .expect("a list")
        .push(json!({ "byteLength": count * stride, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }));
    json["bufferViews"].as_array_mut().expect("a list").push(json!({
        "buffer": 1, "byteLength": count * stride,
        "extensions": { "EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": ZEROS, "byteLength": stream, "byteStride": stride, "count": count, "mode": mode, "filter": filter,
        } },
    }));
    let sparse = json!({ "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 1, "byteOffset": 4 } });
    let positions = json!({ "sparse": sparse, "componentType": 5126, "type": "VEC3", "count": vertices, "min": [0, 0, 0], "max": [1, 1, 1] });
    let decoded = match (mode, stride) {
        ("ATTRIBUTES", 12..) => {
            json!({ "bufferView": 2, "componentType": 5126, "type": "VEC3", "count": count, "min": [0, 0, 0], "max": [1, 1, 1] })
        }
        ("ATTRIBUTES", _) => {
            json!({ "bufferView": 2, "componentType": 5121, "normalized": true, "type": "VEC4", "count": count })
        }
        (_, 2) => {
            json!({ "bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": count })
        }
        _ => json!({ "bufferView": 2, "componentType": 5125, "type": "SCALAR", "count": count }),
    };
    if mode == "ATTRIBUTES" {
        json["bufferViews"][2]["byteStride"] = json!(stride);
    }
    json["accessors"] = json!([positions, decoded]);
    let primitive = match (mode, stride) {
        ("ATTRIBUTES", 12..) => json!({ "attributes": { "POSITION": 1 }, "mode": 5 }),
        ("ATTRIBUTES", _) => json!({ "attributes": { "POSITION": 0, "COLOR_0": 1 }, "mode": 5 }),
        _ => json!({ "attributes": { "POSITION": 0 }, "indices": 1 }),
    };
    json["meshes"] = json!([{ "primitives": [primitive] }]);
    (json["extensionsUsed"], json["extensionsRequired"]) = (
        json!(["EXT_meshopt_compression"]),
        json!(["EXT_meshopt_compression"]),
    );
    json
}
