//! Promise: numbers that contradict each other cost the part that they belong to, with a message that
//! names the place, before anything is allocated; a model of which nothing is left is refused.

use rasterlab::scene::gltf::limits;
use serde_json::{Value, json};

use super::{
    model::*,
    motion::{morphed, skinned},
};

#[test]
fn counts_are_capped_before_anything_is_allocated() {
    let mut model = Model::square();
    model.view(&[0, 0, 0, 0]);
    let sparse = model.set(
        r#"
        - /accessors/0/bufferView
        /accessors/0/sparse {"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":2}}
        "#,
    );
    sparse.play(
        r#"
        /accessors/0/count 1099511627776
        ! mesh "X" primitive 0 POSITION: accessor 0: count is 1099511627776; allowed: at most 30000000, because its files have only
        /accessors/0/count 1000000000
        ! POSITION: accessor 0: count is 1000000000; allowed: at most 30000000
        /accessors/0/count 30000000
        ! POSITION: the model has 30000000 vertices or more; allowed: at most 4000000
        /accessors/0/count 0
        ! POSITION: accessor 0: count is 0; it must be at least 1
        /accessors/0/sparse/count 0
        ! POSITION: accessor 0 sparse: count is 0; allowed: 1 to 4
        /accessors/0/sparse/count 5
        ! accessor 0 sparse: count is 5; allowed: 1 to 4
        ! accessor 0 sparse: its 1 values exceed bufferView 2, which has 4 bytes
        /accessors/0/sparse/indices/byteOffset 18446744073709551615
        ! its 1 indices exceed
        "#,
    );
}

#[test]
fn sparse_indices_must_rise_and_stay_inside() {
    for indices in [[1u8, 1], [2, 1], [3, 4]] {
        let mut model = Model::square();
        model.view(&indices);
        model.view(&[0; 24]);
        model.play(
            r#"
            /accessors/0/sparse {"count":2,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}
            ! indices must increase and stay below 4
            "#,
        );
    }
}

#[test]
fn accessors_views_strides_and_types_must_fit_each_other() {
    for mode in [4, 5, 6] {
        let short = Model::square().with("P/mode", mode);
        short.play(
            "/accessors/1/count 2\n! indices: 2 corners form no triangle; it takes at least 3",
        );
    }
}

#[test]
fn values_that_are_not_finite_are_left_out() {
    for bad in ["nan", "inf", "-inf"] {
        let transcript = r#"
            & VEC3 F32 0 0 0 1 0 0 1 1 0 0 BAD 0
            A/POSITION 2
            ~ mesh "X" primitive 0 POSITION: vertex 3 has a value that is not finite; 1 of 2 triangles have such a vertex and are left out
            & VEC3 F32 0 0 0 1 0 0 1 1 0 0 1e12 0
            A/POSITION 2
            ~ mesh "X" primitive 0 POSITION: vertex 3 lies beyond 6.9e10; 1 of 2 triangles have such a vertex and are left out
            & VEC3 F32 0 0 0 1 0 0 1 1 0 0 BAD 0
            A/POSITION 2
            P/mode 1
            ~ 1 of 3 lines have such a vertex
            & VEC3 F32 BAD 0.5*11
            A/POSITION 2
            ! mesh "X" primitive 0 POSITION: vertex 0 has a value that is not finite, as has each of its triangles
            & VEC3 F32 0.5*10 BAD 0.5
            A/NORMAL 2
            ~ mesh "X" primitive 0 NORMAL: vertex 3 has a value that is not finite
            & VEC4 F32 0.5*14 BAD 0.5
            A/COLOR_0 2
            ~ mesh "X" primitive 0 COLOR_0: vertex 3 has a value that is not finite
        "#;
        Model::square().play(&transcript.replace("BAD", bad));
    }
    let far = json!({ "matrix": [1e30, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] });
    let mut deep = vec![far; 12];
    (0..11).for_each(|node| deep[node]["children"] = json!([node + 1]));
    deep[11]["mesh"] = json!(0);
    Model::square()
        .with("/nodes", deep)
        .refused("node 10: its world transform is not finite");
}

#[test]
fn nodes_are_made_to_form_trees_of_any_depth() {
    let twice = Model::square()
        .set("/scenes/0/nodes [0,0]")
        .dropped("scene 0: node 0 is listed twice");
    assert_eq!(triangles(&twice), square());
    for length in [257, 100_000] {
        let mut nodes: Vec<Value> = (1..length).map(|i| json!({ "children": [i] })).collect();
        nodes.push(json!({ "mesh": 0 }));
        let scene = Model::square()
            .with("/nodes", nodes)
            .load()
            .expect("depth does not matter");
        assert_eq!((triangles(&scene), scene.faults.len()), (square(), 0));
    }
}

#[test]
fn a_small_file_cannot_ask_for_much() {
    // 1,000 primitives over one accessor of 4,001 vertices.
    let mut many = Model::empty().set("& VEC3 F32 0*12006");
    (0..1_000).for_each(|_| many.primitive(json!({ "attributes": { "POSITION": 0 } })));
    many.refused("mesh \"X\" primitive 999 POSITION: the model has 4002000 vertices or more; allowed: at most 4000000");
    let shown =
        |model: Model, count: usize| model.with("/nodes", vec![json!({ "mesh": 0 }); count]);
    let mut placed =
        shown(Model::square(), 263).with("/scenes/0/nodes", (0..263).collect::<Vec<_>>());
    let primitive = placed.json["meshes"][0]["primitives"][0].clone();
    placed.json["meshes"][0]["primitives"] = vec![primitive; 1_000].into();
    placed.refused("node 262: the nodes show 263000 primitives or more; allowed: at most 262144, because its files have only");
    let soft = morphed()
        .with("P/targets", vec![json!({}); 256])
        .without("/meshes/0/weights");
    shown(soft, 15_626).refused(
        "node 15625: the nodes have 4000256 morph weights or more; allowed: at most 4000000",
    );
    let jointed = skinned(0.0).without("/skins/0/inverseBindMatrices");
    let jointed = jointed.with("/skins", vec![json!({ "joints": vec![1; 256] }); 3_907]);
    jointed.refused("the skins have 1000192 joints; allowed: at most 1000000");
    let nodes = "{},".repeat(limits::JSON_OBJECTS);
    let objects = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{nodes}{{}}]}}");
    let error = load(objects.as_bytes()).unwrap_err().to_string();
    assert_eq!(
        error,
        "the JSON has 1000003 objects; allowed: at most 1000000"
    );
}

#[test]
fn long_and_strange_names_stay_out_of_the_sentence() {
    let name = format!("line\nbreak \u{1b}[31m{}", "x".repeat(100_000));
    let model = Model::square()
        .with("/meshes/0/name", name)
        .with("/accessors/0/count", 5);
    let error = model.load().unwrap_err().to_string();
    assert!(
        error.len() < 300 && !error.contains(['\n', '\u{1b}']),
        "{error}"
    );
}
