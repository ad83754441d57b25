//! Promise: numbers that contradict each other cost the part that they belong to, with a message that
//! names the place, before anything is allocated; a model of which nothing is left is refused.

use rasterlab::scene::gltf::{self, limits};
use serde_json::{Value, json};

use super::{
    model::*,
    motion::{morphed, skinned},
};

#[test]
fn counts_are_capped_before_anything_is_allocated() {
    let sparse = |count: u64| {
        let mut model = Model::square();
        let view = model.view(&[0, 0, 0, 0]);
        let overlay = json!({ "count": 1, "indices": { "bufferView": view, "componentType": U8 }, "values": { "bufferView": view } });
        model
            .without("/accessors/0/bufferView")
            .with("/accessors/0/sparse", overlay)
            .with("/accessors/0/count", json!(count))
    };
    sparse(1 << 40).refused(
        "mesh \"X\" primitive 0 POSITION: accessor 0: count is 1099511627776; allowed: at most 30000000, because its files have only",
    );
    sparse(1_000_000_000)
        .refused("POSITION: accessor 0: count is 1000000000; allowed: at most 30000000");
    sparse(30_000_000)
        .refused("POSITION: the model has 30000000 vertices or more; allowed: at most 4000000");
    sparse(0).refused("POSITION: accessor 0: count is 0; it must be at least 1");
    let zero = sparse(4).with("/accessors/0/sparse/count", json!(0));
    zero.refused("POSITION: accessor 0 sparse: count is 0; allowed: 1 to 4");
    sparse(4)
        .with("/accessors/0/sparse/count", json!(5))
        .refused("accessor 0 sparse: count is 5; allowed: 1 to 4");
    sparse(4).refused("accessor 0 sparse: its 1 values exceed bufferView 2, which has 4 bytes");
    sparse(4)
        .with("/accessors/0/sparse/indices/byteOffset", json!(u64::MAX))
        .refused("its 1 indices exceed");
}

#[test]
fn sparse_indices_must_rise_and_stay_inside() {
    for indices in [[1u8, 1], [2, 1], [3, 4]] {
        let mut model = Model::square();
        let at = model.view(&indices);
        let values = model.view(&[0; 24]);
        let sparse = json!({ "count": 2, "indices": { "bufferView": at, "componentType": U8 }, "values": { "bufferView": values } });
        model
            .with("/accessors/0/sparse", sparse)
            .refused("indices must increase and stay below 4");
    }
}

#[test]
fn accessors_must_lie_in_their_views_and_views_in_their_buffers() {
    let place = "mesh \"X\" primitive 0 POSITION: accessor 0: ";
    Model::square()
        .with("/accessors/0/count", json!(5))
        .refused(&format!(
            "{place}5 elements of 12 bytes from byte 0 exceed bufferView 0, which has 48 bytes"
        ));
    Model::square()
        .with("/accessors/0/byteOffset", json!(4))
        .refused(&format!("{place}4 elements of 12 bytes from byte 4 exceed"));
    Model::square()
        .with("/accessors/0/byteOffset", json!(u64::MAX - 3))
        .refused(place);
    Model::square()
        .with("/bufferViews/0/byteOffset", json!(u64::MAX - 3))
        .refused(place);
    Model::square()
        .with("/bufferViews/0/byteLength", json!(1u64 << 60))
        .refused("bufferView 0 (1152921504606846976 bytes from byte 0) exceeds buffer 0, which has 60 bytes");
    Model::square()
        .with("/buffers/0/byteLength", json!(1u64 << 60))
        .dropped("buffer 0: byteLength is 1152921504606846976, but the buffer has only 60 bytes");
    Model::square()
        .with("/buffers/0/byteLength", json!(40))
        .refused("bufferView 0 (48 bytes from byte 0) exceeds buffer 0, which has 40 bytes");
    Model::square()
        .with("/accessors/1/count", json!(9))
        .refused(
            "mesh \"X\" primitive 0 indices: accessor 1: 9 elements of 2 bytes from byte 0 exceed",
        );
}

#[test]
fn strides_and_offsets_must_fit_their_components() {
    Model::square()
        .with("/bufferViews/0/byteStride", json!(8))
        .refused("byteStride is 8; it must be at least 12");
    Model::square()
        .with("/bufferViews/0/byteStride", json!(14))
        .refused("4 elements of 14 bytes from byte 0 exceed");
    Model::square()
        .with("/accessors/0/byteOffset", json!(2))
        .refused("4 elements of 12 bytes from byte 2 exceed");
    Model::square()
        .with("/bufferViews/1/byteStride", json!(4))
        .refused("indices: accessor 1: 6 elements of 4 bytes");
}

#[test]
fn attributes_must_have_the_types_of_the_standard() {
    let place = "mesh \"X\" primitive 0 POSITION: accessor 0 has the type";
    Model::square()
        .with("/accessors/0/componentType", json!(U8))
        .refused(&format!("{place} 3 x U8, which glTF does not allow for it"));
    Model::square()
        .with("/accessors/0/type", json!("SCALAR"))
        .refused(&format!("{place} 1 x F32"));
    Model::square()
        .with("/accessors/0/type", json!("VEC2"))
        .refused(place);
    Model::square()
        .with("/accessors/1/componentType", json!(I16))
        .refused("indices: accessor 1 has the type 1 x I16, which glTF does not allow for it");
    let mut float = Model::square();
    let indices = float.floats("SCALAR", &[0.0; 6]);
    float
        .with("/meshes/0/primitives/0/indices", json!(indices))
        .refused("indices: accessor 2 has the type");
    Model::square()
        .with("/accessors/1/type", json!("VEC3"))
        .with("/accessors/1/count", json!(2))
        .refused("indices: accessor 1 has the type");
    let attribute = |name: &str, make: &dyn Fn(&mut Model) -> usize| {
        let mut model = Model::square();
        let accessor = make(&mut model);
        model.with(
            &format!("/meshes/0/primitives/0/attributes/{name}"),
            json!(accessor),
        )
    };
    attribute("NORMAL", &|m| m.floats("VEC4", &[0.0; 16]))
        .dropped("NORMAL: accessor 2 has the type");
    attribute("NORMAL", &|m| m.floats("VEC3", &[0.0; 9]))
        .dropped("NORMAL: accessor 2 has 3 elements, but the primitive has 4 vertices");
    Model::square()
        .with("/meshes/0/primitives/0/attributes/POSITION", json!(9))
        .refused("mesh \"X\" primitive 0: its POSITION refers to accessor 9, but there are only 2");
    attribute("COLOR_0", &|m| m.shorts("VEC4", &[0; 16]))
        .dropped("COLOR_0: accessor 2 has the type 4 x U16, which glTF does not allow for it");
}

#[test]
fn indices_past_the_vertices_are_refused() {
    for bad in [4, 0xffff] {
        let mut model = Model::square();
        let indices = model.shorts("SCALAR", &[0, 1, 2, 0, 2, bad]);
        model
            .with("/meshes/0/primitives/0/indices", json!(indices))
            .refused(&format!("mesh \"X\" primitive 0 indices: corner 5 refers to vertex {bad}, but there are only 4"));
    }
}

#[test]
fn corners_must_make_a_triangle() {
    for mode in [4, 5, 6] {
        let short = Model::square()
            .with("/meshes/0/primitives/0/mode", json!(mode))
            .with("/accessors/1/count", json!(2));
        short.refused("indices: 2 corners form no triangle; it takes at least 3");
    }
}

#[test]
fn values_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (name, values) in [("POSITION", 12), ("NORMAL", 12), ("COLOR_0", 16)] {
            let mut model = Model::square();
            let mut floats = vec![0.5; values];
            floats[values - 2] = bad;
            let accessor = model.floats(if values == 12 { "VEC3" } else { "VEC4" }, &floats);
            let model = model.with(
                &format!("/meshes/0/primitives/0/attributes/{name}"),
                json!(accessor),
            );
            let sentence =
                format!("mesh \"X\" primitive 0 {name}: vertex 3 has a value that is not finite");
            match name {
                "POSITION" => model.refused(&sentence),
                _ => drop(model.dropped(&sentence)),
            }
        }
    }
    Model::square()
        .with("/nodes/0/translation", json!([1e39, 0, 0]))
        .dropped("node 0: its translation is [1e+39,0,0]; it must be numbers below 3.4e38");
    let far = json!({ "matrix": [1e30, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] });
    let mut deep = vec![far; 12];
    (0..11).for_each(|node| deep[node]["children"] = json!([node + 1]));
    deep[11]["mesh"] = json!(0);
    Model::square()
        .with("/nodes", json!(deep))
        .refused("node 10: its world transform is not finite");
    Model::square()
        .with("/nodes/0/rotation", json!([0, 0, 0, 0]))
        .dropped("node 0: its rotation is a quaternion of length 0e0");
    Model::square()
        .with(
            "/nodes/0/matrix",
            json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
        )
        .dropped("the last row of its matrix");
}

#[test]
fn nodes_are_made_to_form_trees_of_any_depth() {
    let nodes = |nodes: Value| Model::square().with("/nodes", nodes);
    nodes(json!([{ "children": [0], "mesh": 0 }])).dropped("node 0: it is its own ancestor");
    nodes(json!([{ "children": [1], "mesh": 0 }, { "children": [0] }]))
        .dropped("node 0: it is its own ancestor");
    nodes(json!([{ "mesh": 0 }, { "children": [2] }, { "name": "b", "children": [1] }]))
        .dropped("it is its own ancestor");
    nodes(json!([{ "children": [2], "mesh": 0 }, { "children": [2] }, { "name": "child" }]))
        .dropped("node \"child\": it has more than one parent");
    nodes(json!([{ "children": [1, 1], "mesh": 0 }, {}]))
        .dropped("node 1: it has more than one parent");
    let twice = Model::square()
        .with("/scenes/0/nodes", json!([0, 0]))
        .dropped("scene 0: node 0 is listed twice");
    assert_eq!(triangles(&twice), square());
    let chain = |length: usize| {
        nodes(
            (0..length)
                .map(|i| {
                    if i + 1 < length {
                        json!({ "children": [i + 1] })
                    } else {
                        json!({ "mesh": 0 })
                    }
                })
                .collect(),
        )
    };
    for length in [257, 100_000] {
        let scene = chain(length).load().expect("depth does not matter");
        assert_eq!((triangles(&scene), scene.faults.len()), (square(), 0));
    }
}

#[test]
fn a_small_file_cannot_ask_for_much() {
    // 1,000 primitives over one accessor of 4,001 vertices.
    let mut many = Model::empty();
    let positions = many.floats("VEC3", &vec![0.0; 3 * 4_002]);
    (0..1_000).for_each(|_| many.primitive(json!({ "attributes": { "POSITION": positions } })));
    many.refused("mesh \"X\" primitive 999 POSITION: the model has 4002000 vertices or more; allowed: at most 4000000");
    let mut placed = Model::square();
    placed.json["meshes"][0]["primitives"] =
        vec![placed.json["meshes"][0]["primitives"][0].clone(); 1_000].into();
    placed.json["nodes"] = vec![json!({ "mesh": 0 }); 263].into();
    placed.json["scenes"] = json!([{ "nodes": (0..263).collect::<Vec<_>>() }]);
    placed.refused("node 262: the nodes show 263000 primitives or more; allowed: at most 262144, because its files have only");
    let mut soft = morphed()
        .with(
            "/meshes/0/primitives/0/targets",
            json!(vec![json!({}); 256]),
        )
        .without("/meshes/0/weights");
    soft.json["nodes"] = vec![json!({ "mesh": 0 }); 15_626].into();
    soft.refused(
        "node 15625: the nodes have 4000256 morph weights or more; allowed: at most 4000000",
    );
    let mut jointed = skinned(0.0).without("/skins/0/inverseBindMatrices");
    jointed.json["skins"] = vec![json!({ "joints": vec![1; 256] }); 3_907].into();
    jointed.refused("the skins have 1000192 joints; allowed: at most 1000000");
    let objects = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{}{{}}]}}",
        "{},".repeat(limits::JSON_OBJECTS)
    );
    let error = gltf::load(objects.as_bytes(), &mut |_, _| unreachable!()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the JSON has 1000003 objects; allowed: at most 1000000"
    );
}

#[test]
fn long_and_strange_names_stay_out_of_the_sentence() {
    let name = format!("line\nbreak \u{1b}[31m{}", "x".repeat(100_000));
    let error = Model::square()
        .with("/meshes/0/name", json!(name))
        .with("/accessors/0/count", json!(5))
        .load()
        .unwrap_err()
        .to_string();
    assert!(
        error.len() < 300 && !error.contains(['\n', '\u{1b}']),
        "{error}"
    );
}
