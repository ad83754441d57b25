//! Small models: one of everything that the loader follows, and each case that some loader once got
//! wrong.

use image::ImageFormat;
use serde_json::{Value, json};

use crate::{Seed, model::*};

pub fn seeds() -> Vec<Seed> {
    let mut seeds: Vec<Seed> = vec![
        ("square.glb".into(), Model::square().glb()),
        ("textured.glb".into(), Model::textured().glb()),
        ("webp.glb".into(), webp().glb()),
        ("skinned.glb".into(), skinned().glb()),
        ("everything.glb".into(), everything().glb()),
        ("data-uri.gltf".into(), data_uri().into_bytes()),
        ("strip.glb".into(), strip().glb()),
        ("quantized.glb".into(), quantized().glb()),
        ("transformed.glb".into(), transformed().glb()),
        ("lights.glb".into(), lights().glb()),
    ];
    let tolerated = |name: &str, place: &str, value: Value| {
        (
            format!("{name}.glb"),
            Model::square().with(place, value).glb(),
        )
    };
    seeds.extend([
        tolerated("extras-list", "/extras", json!([1, "two"])),
        tolerated("extras-number", "/nodes/0/extras", json!(7)),
        tolerated("extras-null", "/meshes/0/extras", Value::Null),
        tolerated("scene-without-nodes", "/scenes/0", json!({})),
        tolerated("root-that-is-a-child", "/nodes", json!([{ "mesh": 0 }, { "children": [0] }])),
        tolerated("node-in-a-circle", "/nodes", json!([{ "mesh": 0, "children": [0] }])),
        tolerated("count-of-billions", "/accessors/0/count", json!(4_294_967_295_u32)),
        tolerated("offset-past-the-end", "/bufferViews/0/byteOffset", json!(u64::MAX)),
        tolerated(
            "positions-without-bytes",
            "/accessors/0",
            json!({ "componentType": 5126, "type": "VEC3", "count": 90_000, "min": [0, 0, 0], "max": [1, 1, 1], "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 0 } } }),
        ),
        tolerated("uri-with-dots", "/buffers/0/uri", json!("../../../../etc/passwd")),
        tolerated("uri-of-a-host", "/buffers/0/uri", json!("\\\\host\\share\\a.bin")),
        tolerated("many-extensions", "/extensionsUsed", json!((0..200).map(|number| format!("X_{number}")).collect::<Vec<_>>())),
        tolerated("deep-nodes", "/nodes", deep_nodes()),
        tolerated("long-name", "/meshes/0/name", json!("\u{202e}é\u{7}".repeat(300))),
    ]);
    seeds.push(("many-instances.glb".into(), many_instances().glb()));
    seeds.push((
        "texture-without-image.glb".into(),
        Model::textured().with("/textures/0", json!({})).glb(),
    ));
    seeds.push(("cut.glb".into(), Model::textured().glb()[..300].to_vec()));
    seeds.push((
        "deep.gltf".into(),
        [b"{\"extras\":".to_vec(), b"[".repeat(2000)].concat(),
    ));
    seeds
}

fn deep_nodes() -> Value {
    let mut nodes: Vec<Value> = (1..300)
        .map(|child| json!({ "children": [child] }))
        .collect();
    nodes.push(json!({ "mesh": 0 }));
    json!(nodes)
}

/// Each node shows the mesh: work that multiplies.
fn many_instances() -> Model {
    Model::square()
        .with("/nodes", json!(vec![json!({ "mesh": 0 }); 400]))
        .with("/scenes/0/nodes", json!((0..400).collect::<Vec<u32>>()))
}

fn webp() -> Model {
    let model = Model::textured()
        .showing(&encoded(ImageFormat::WebP))
        .with("/images/0/mimeType", json!("image/webp"));
    model
        .with(
            "/textures/0",
            json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } }),
        )
        .with("/extensionsUsed", json!(["EXT_texture_webp"]))
}

fn data_uri() -> String {
    use base64::Engine as _;
    let mut model = Model::textured();
    let bytes = base64::engine::general_purpose::STANDARD.encode(&model.bytes);
    model.json["buffers"][0]["uri"] =
        json!(format!("data:application/octet-stream;base64,{bytes}"));
    model.json.to_string()
}

fn strip() -> Model {
    let mut model = Model::square();
    let indices = model.accessor(&[0, 1, 3, 2, 1, 1, 2, 0], U8, "SCALAR", 8);
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": indices, "mode": 5 }));
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": 6 }));
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": 1 }));
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    model
}

fn quantized() -> Model {
    let mut model = Model::square();
    let corners: Vec<u8> = [
        [0i16, 0, 0, 0],
        [32767, 0, 0, 0],
        [32767, 32767, 0, 0],
        [0, 32767, -32768, 0],
    ]
    .concat()
    .iter()
    .flat_map(|v| v.to_le_bytes())
    .collect();
    let view = model.view(&corners);
    model.json["bufferViews"][view]["byteStride"] = json!(8);
    let accessor = json!({ "bufferView": view, "componentType": I16, "normalized": true, "type": "VEC3", "count": 4, "min": [0, 0, -32768], "max": [32767, 32767, 0] });
    let positions = model.push("accessors", accessor);
    model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": 1 }));
    model
        .with("/extensionsUsed", json!(["KHR_mesh_quantization"]))
        .with("/extensionsRequired", json!(["KHR_mesh_quantization"]))
}

fn transformed() -> Model {
    let transform = json!({ "KHR_texture_transform": { "offset": [0.5, -9.5], "rotation": 1.5, "scale": [-0.001, 3], "texCoord": 0 } });
    Model::textured()
        .with(
            "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions",
            transform,
        )
        .with("/extensionsUsed", json!(["KHR_texture_transform"]))
        .with("/materials/0/alphaMode", json!("MASK"))
        .with("/materials/0/doubleSided", json!(true))
        .with("/materials/0/emissiveFactor", json!([1, 0.5, 0]))
        .with(
            "/samplers/0",
            json!({ "magFilter": 9728, "minFilter": 9987, "wrapS": 33071, "wrapT": 33648 }),
        )
        .with(
            "/nodes/0",
            json!({ "mesh": 0, "matrix": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 5, 6, 7, 1] }),
        )
}

fn lights() -> Model {
    let lights = json!([{ "type": "directional", "intensity": 3 }, { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.2 }, "range": 5 }]);
    Model::square()
        .with("/extensionsUsed", json!(["KHR_lights_punctual"]))
        .with(
            "/extensions",
            json!({ "KHR_lights_punctual": { "lights": lights } }),
        )
        .with(
            "/nodes/0/extensions",
            json!({ "KHR_lights_punctual": { "light": 0 } }),
        )
}

/// A square on two joints.
fn skinned() -> Model {
    let mut model = Model::square();
    let moved = |x: f32| {
        [
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0,
        ]
    };
    let inverse = model.floats("MAT4", &[moved(-1.0), moved(-2.0)].concat());
    let joints = model.accessor(&[0, 1, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats(
        "VEC4",
        &[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 2.0, 0.0, 0.0],
            [0.5, 0.5, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
        ]
        .concat(),
    );
    let nodes = json!([{ "mesh": 0, "skin": 0 }, { "translation": [4, 0, 0], "children": [2] }, { "translation": [1, 0, 0.5] }]);
    model
        .with(
            "/skins",
            json!([{ "inverseBindMatrices": inverse, "joints": [1, 2] }]),
        )
        .with("/nodes", nodes)
        .with("/scenes/0/nodes", json!([0, 1]))
        .with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints))
        .with(
            "/meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(weights),
        )
}

/// Skin, morph targets, sparse accessor, clips, colors, camera, material and image.
fn everything() -> Model {
    let mut model = skinned();
    let indices = model.view(&[1, 3]);
    let values = model.view(&le_floats(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
    let colors = model.accessor(&[9; 16], U8, "VEC4", 4);
    model.json["accessors"][colors]["normalized"] = json!(true);
    let targets = json!([{ "POSITION": 0, "NORMAL": 0 }]);
    model.json["meshes"][0]["primitives"][0]["targets"] = targets.clone();
    model.primitive(
        json!({ "attributes": { "POSITION": 0, "COLOR_0": colors, "JOINTS_0": 3, "WEIGHTS_0": 4 }, "mode": 5, "targets": targets }),
    );
    let times = model.floats("SCALAR", &[0.0, 0.5, 2.0]);
    let turns = model.floats("VEC4", &[0.0, 0.0, 0.0, 1.0].repeat(9));
    let weights = model.floats("SCALAR", &[0.0, 1.0, 0.5]);
    let channels = json!([{ "sampler": 0, "target": { "node": 2, "path": "rotation" } }, { "sampler": 1, "target": { "node": 0, "path": "weights" } }]);
    let samplers = json!([{ "input": times, "output": turns, "interpolation": "CUBICSPLINE" }, { "input": times, "output": weights }]);
    let sparse = json!({ "count": 2, "indices": { "bufferView": indices, "componentType": U8 }, "values": { "bufferView": values } });
    model
        .with("/animations", json!([{ "name": "Turn", "channels": channels, "samplers": samplers }]))
        .with("/accessors/0/sparse", sparse)
        .with("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.25 } }, { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 } }]))
        .with("/nodes/1/camera", json!(0))
        .with("/nodes/2/camera", json!(1))
        .with("/materials", json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.5] }, "alphaMode": "BLEND" }]))
        .with("/meshes/0/primitives/0/material", json!(0))
}
