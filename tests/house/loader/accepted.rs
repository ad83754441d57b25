//! Promise: what the standard allows arrives exactly: indices, attributes, transforms, scenes,
//! materials and cameras.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;
use rasterlab::scene::{
    Scene,
    camera::Projection,
    parts::{PartKind, parts},
};
use serde_json::json;

use super::model::*;

#[test]
fn every_index_width_names_the_same_triangles() {
    assert_eq!(triangles(&Model::square().scene()), square());
    let mut bytes = Model::square();
    let indices = bytes.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6);
    assert_eq!(
        triangles(
            &bytes
                .with("/meshes/0/primitives/0/indices", json!(indices))
                .scene()
        ),
        square()
    );
    let mut words = Model::square();
    let indices = words.accessor(
        &[0u32, 1, 2, 0, 2, 3].map(u32::to_le_bytes).concat(),
        U32,
        "SCALAR",
        6,
    );
    assert_eq!(
        triangles(
            &words
                .with("/meshes/0/primitives/0/indices", json!(indices))
                .scene()
        ),
        square()
    );
    let mut direct = Model::empty();
    let positions = direct.floats("VEC3", &[0, 1, 2, 0, 2, 3].map(|i| SQUARE[i]).concat());
    direct.primitive(json!({ "attributes": { "POSITION": positions } }));
    let scene = direct.scene();
    assert!(scene.primitives[0].indices.is_none());
    assert_eq!(triangles(&scene), square());
}

#[test]
fn strips_and_fans_follow_the_order_of_the_standard() {
    let corners = |mode: u32| {
        let model = Model::square()
            .with("/meshes/0/primitives/0/mode", json!(mode))
            .with("/accessors/1/count", json!(5));
        let scene = model.scene();
        (0..3)
            .map(|t| scene.primitives[0].corners(&scene, t))
            .collect::<Vec<_>>()
    };
    // Indices 0 1 2 0 2. glTF 2.0, 3.7.2.1: strips {i, i + (1 + i % 2), i + (2 - i % 2)}, fans {i +
    // 1, i + 2, 0}.
    assert_eq!(corners(5), [[0, 1, 2], [1, 0, 2], [2, 0, 2]]);
    assert_eq!(corners(6), [[1, 2, 0], [2, 0, 0], [0, 2, 0]]);
}

#[test]
fn interleaved_bytes_stay_as_the_file_has_them() {
    let mut model = Model::empty();
    let mut bytes = vec![7; 8];
    for (i, position) in SQUARE.iter().enumerate() {
        bytes.extend(le_floats(&[0.0, 0.0, 2.0]));
        bytes.extend(le_floats(position));
        bytes.extend([10 * i as u8, 20, 30, 255]);
    }
    let view = model.view(&bytes);
    let model = model.with(&format!("/bufferViews/{view}/byteStride"), json!(28));
    let mut model = model;
    let part = |offset: usize, component: u32, kind: &str| {
        json!({ "bufferView": view, "byteOffset": offset, "componentType": component, "type": kind, "count": 4,
            "normalized": component == U8, "min": [0, 0, 0], "max": [1, 1, 1] })
    };
    let [normals, positions, colors] = [
        part(8, F32, "VEC3"),
        part(20, F32, "VEC3"),
        part(32, U8, "VEC4"),
    ]
    .map(|a| model.push("accessors", a));
    let indices = model.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    model.primitive(json!({ "attributes": { "POSITION": positions, "NORMAL": normals, "COLOR_0": colors }, "indices": indices }));
    let scene = model.scene();
    assert_eq!(
        scene.vertex_bytes, bytes,
        "the view is copied once and whole"
    );
    assert_eq!(triangles(&scene), square());
    let primitive = &scene.primitives[0];
    assert_eq!(
        (primitive.positions.stride, primitive.positions.offset),
        (28, 20)
    );
    let color = primitive.colors.unwrap();
    assert_eq!(
        [0, 1, 2, 3].map(|component| color.value(&scene.vertex_bytes, 3, component) * 255.0),
        [30.0, 20.0, 30.0, 255.0]
    );
}

#[test]
fn sparse_elements_replace_their_base_or_zeros() {
    for has_base in [true, false] {
        let mut model = Model::square();
        let indices = model.view(&[1, 3]);
        let values = model.view(&le_floats(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
        let sparse = json!({ "count": 2, "indices": { "bufferView": indices, "componentType": U8 }, "values": { "bufferView": values } });
        model = model.with("/accessors/0/sparse", sparse);
        if !has_base {
            model = model.without("/accessors/0/bufferView");
        }
        let scene = model.scene();
        let base = |c: usize| {
            if has_base {
                SQUARE[c].map(f64::from)
            } else {
                [0.0; 3]
            }
        };
        assert_eq!(
            triangles(&scene),
            [
                [base(0), [5.0, 6.0, 7.0], base(2)],
                [base(0), base(2), [8.0, 9.0, 10.0]]
            ]
        );
    }
}

#[test]
fn transforms_multiply_from_root_to_leaf() {
    let model = Model::square().with(
        "/nodes",
        json!([
            { "translation": [10, 0, 0], "rotation": [0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2], "scale": [2, 2, 2], "children": [1] },
            { "matrix": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "mesh": 0 },
        ]),
    );
    let scene = model.scene();
    // (1, 1, 0) -> mirrored (1, -1, 5) -> scaled (2, -2, 10) -> turned (2, 2, 10) -> moved (12, 2,
    // 10)
    let corner = DVec3::from(triangles(&scene)[0][2]);
    assert!(
        corner.distance(DVec3::new(12.0, 2.0, 10.0)) < 1e-6,
        "{corner}"
    );
    assert!(scene.instances[0].world_from_object.determinant() < 0.0);
}

#[test]
fn a_mesh_is_stored_once_and_placed_by_every_node() {
    let model = Model::square()
        .with(
            "/nodes",
            json!([{ "mesh": 0 }, { "mesh": 0, "translation": [3, 0, 0] }]),
        )
        .with("/scenes/0/nodes", json!([0, 1]));
    let scene = model.scene();
    assert_eq!(
        (
            scene.primitives.len(),
            scene.instances.len(),
            scene.triangle_count()
        ),
        (1, 2, 4)
    );
    assert_eq!(scene.bounds().max.x, 4.0);
}

#[test]
fn only_the_default_scene_is_shown() {
    let two = Model::square().with(
        "/nodes",
        json!([{ "mesh": 0 }, { "mesh": 0, "translation": [3, 0, 0] }]),
    );
    let shown = |model: Model| {
        model
            .scene()
            .instances
            .iter()
            .map(|i| i.world_from_object.w_axis.x)
            .collect::<Vec<_>>()
    };
    let scenes = two.with("/scenes", json!([{ "nodes": [0] }, { "nodes": [1] }]));
    assert_eq!(shown(scenes.clone().with("/scene", json!(1))), [3.0]);
    assert_eq!(shown(scenes.clone().without("/scene")), [0.0]);
    assert_eq!(
        shown(scenes.without("/scene").without("/scenes")),
        [0.0, 3.0]
    );
}

#[test]
fn without_normals_planes_are_lit_and_smooth_normals_lead_vertex_effects() {
    // Two faces that meet at a right angle along the y axis, of areas 1/2 and 1.
    let corners: [[f32; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, -2.0],
    ];
    let normal = |scene: &Scene, vertex: u32| {
        DVec3::from_array([0, 1, 2].map(|l| {
            scene.primitives[0]
                .normals
                .value(&scene.vertex_bytes, vertex, l)
        }))
    };
    let mut flat = Model::empty();
    let positions = flat.floats("VEC3", &[0, 1, 2, 0, 3, 1].map(|i| corners[i]).concat());
    flat.primitive(json!({ "attributes": { "POSITION": positions } }));
    let flat = flat.scene();
    assert_eq!((normal(&flat, 0), normal(&flat, 3)), (DVec3::Z, DVec3::X));
    let mut smooth = Model::empty();
    let positions = smooth.floats("VEC3", &corners.concat());
    let indices = smooth.shorts("SCALAR", &[0, 1, 2, 0, 3, 1]);
    smooth.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    let smooth = smooth.scene();
    assert!(normal(&smooth, 0).distance(DVec3::new(2.0, 0.0, 1.0).normalize()) < 1e-6);
    assert_eq!(normal(&smooth, 2), DVec3::Z);
    for scene in [&flat, &smooth] {
        let primitive = &scene.primitives[0];
        assert!(primitive.is_faceted && !primitive.normals_agree);
    }
    let mut given = Model::square();
    let normals = given.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let given = given.with("/meshes/0/primitives/0/attributes/NORMAL", json!(normals));
    assert!(!given.scene().primitives[0].is_faceted);
}

#[test]
fn base_color_and_double_sides_come_from_the_material() {
    let material = json!({ "name": "red", "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.1, 0.2, 1.0] } });
    let model = Model::square()
        .with("/materials", json!([material]))
        .with("/meshes/0/primitives/0/material", json!(0));
    let scene = model.scene();
    let red = &scene.materials[scene.primitives[0].material];
    assert_eq!(
        (red.name.as_str(), red.base_color, red.double_sided),
        ("red", [0.8, 0.1, 0.2, 1.0], true)
    );
    let plain = Model::square().scene();
    assert_eq!(
        plain.materials[plain.primitives[0].material].base_color,
        [1.0; 4]
    );
}

#[test]
fn vertex_colors_come_in_three_widths() {
    let read = |model: Model| {
        let scene = model.scene();
        let color = scene.primitives[0].colors.unwrap();
        (
            color.components,
            [0, 1, 2].map(|component| color.value(&scene.vertex_bytes, 2, component)),
        )
    };
    let add = |normalized: bool, make: &dyn Fn(&mut Model) -> usize| {
        let mut model = Model::square();
        let colors = make(&mut model);
        model.json["accessors"][colors]["normalized"] = json!(normalized);
        model.with("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors))
    };
    assert_eq!(
        read(add(false, &|m| m.floats("VEC3", &[0.25; 12]))),
        (3, [0.25; 3])
    );
    assert_eq!(
        read(add(true, &|m| m.accessor(&[51; 12], U8, "VEC3", 4))),
        (3, [0.2; 3])
    );
    assert_eq!(
        read(add(true, &|m| m.shorts("VEC4", &[13_107; 16]))),
        (3, [0.2; 3]),
        "an opaque material ignores alpha"
    );
}

#[test]
fn cameras_of_the_file_keep_their_lens_and_place() {
    let model = Model::square()
        .with(
            "/cameras",
            json!([
                { "type": "perspective", "name": "near", "perspective": { "yfov": 1.0, "znear": 0.25 } },
                { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 9 } },
                { "type": "perspective", "perspective": { "yfov": 0.0, "znear": 1 } },
            ]),
        )
        .with(
            "/nodes",
            json!([
                { "mesh": 0 }, { "camera": 0, "translation": [0.5, 0.5, 4] },
                { "camera": 1, "name": "side", "translation": [9, 0, 0], "rotation": [0, FRAC_1_SQRT_2, 0, FRAC_1_SQRT_2] },
                { "camera": 2 },
            ]),
        )
        .with("/scenes/0/nodes", json!([0, 1, 2, 3]));
    let scene = model.scene();
    let [near, side] = &scene.cameras[..] else {
        panic!("{:?}", scene.cameras)
    };
    assert_eq!(
        (near.name.as_str(), near.pose.eye, near.pose.near_m),
        ("near", DVec3::new(0.5, 0.5, 4.0), 0.25)
    );
    assert!(
        near.pose.target.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-12,
        "the target lies at the distance of the scene's middle"
    );
    assert_eq!(
        near.pose.projection,
        Projection::Perspective {
            fov_y_deg: 1f64.to_degrees()
        }
    );
    assert_eq!(
        (side.name.as_str(), side.pose.projection),
        ("side", Projection::Orthographic { height_m: 6.0 })
    );
    assert!(side.pose.forward().distance(DVec3::NEG_X) < 1e-6);
    assert!(
        scene
            .notes
            .iter()
            .any(|note| note.contains("camera 2") && note.contains("yfov")),
        "{:?}",
        scene.notes
    );
}

#[test]
fn what_is_left_out_is_noted() {
    let mut model = Model::square()
        .with("/extensionsUsed", json!(["KHR_materials_clearcoat"]))
        .with("/animations", json!([]));
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    model.json["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = json!(0);
    let scene = model.scene();
    assert_eq!(scene.primitives.len(), 1);
    for part in [
        "mesh \"X\" primitive 1 is skipped: points and lines",
        "the extension \"KHR_materials_clearcoat\" is not supported and is ignored",
    ] {
        assert!(
            scene.notes.iter().any(|note| note.contains(part)),
            "{part}: {:?}",
            scene.notes
        );
    }
    let nothing = Model::empty().with("/nodes", json!([{}])).scene();
    assert!(nothing.notes[0].contains("nothing to draw"));
}

#[test]
fn small_integers_are_places_when_the_file_says_that_it_is_quantized() {
    let mut model = Model::square();
    let places = model.accessor(
        &[0, 0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0, 0, 127, 0, 0],
        5120,
        "VEC3",
        4,
    );
    let view = model.json["accessors"][places]["bufferView"]
        .as_u64()
        .unwrap();
    let normals = model.accessor(&[0, 0, 127, 0].repeat(4), 5120, "VEC3", 4);
    let below = model.json["accessors"][normals]["bufferView"]
        .as_u64()
        .unwrap();
    let model = model
        .with(&format!("/bufferViews/{view}/byteStride"), json!(4))
        .with(&format!("/bufferViews/{below}/byteStride"), json!(4))
        .with(&format!("/accessors/{normals}/normalized"), json!(true))
        .with(
            "/meshes/0/primitives/0/attributes",
            json!({ "POSITION": places, "NORMAL": normals }),
        )
        .with("/nodes/0/scale", json!([1.0 / 127.0, 1.0 / 127.0, 1.0]));
    model.refused("POSITION: accessor 2 has the type 3 x I8, which glTF does not allow for it");
    let model = model
        .with("/extensionsUsed", json!(["KHR_mesh_quantization"]))
        .with("/extensionsRequired", json!(["KHR_mesh_quantization"]));
    let scene = model.scene();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let [_, _, [x, y, _]] = triangles(&scene)[0];
    assert!((x - 1.0).abs() < 1e-6 && (y - 1.0).abs() < 1e-6);
    let normalized = model
        .with(&format!("/accessors/{places}/normalized"), json!(true))
        .with("/nodes/0/scale", json!([1, 1, 1]))
        .scene();
    assert_eq!(triangles(&normalized), square());
}

#[test]
fn the_names_of_a_model_are_its_parts() {
    let mut model = Model::square();
    model.json["meshes"][0]["name"] = json!("Shell\nof glass");
    model.json["materials"] = json!([{ "name": "Lens" }]);
    model.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let second = model.json["meshes"][0].clone();
    model.json["meshes"] =
        json!([model.json["meshes"][0], { "primitives": [second["primitives"][0]] }]);
    model.json["meshes"][1]["primitives"][0]
        .as_object_mut()
        .unwrap()
        .remove("material");
    // Children stand before their parents in the file.
    model.json["nodes"] = json!([{ "name": "Eye", "mesh": 0 }, { "mesh": 1 }, { "name": "Head", "children": [0, 1] }, { "name": "Empty" }]);
    model.json["scenes"] = json!([{ "nodes": [2, 3] }]);
    let scene = model.scene();
    let names = |kind| {
        parts(&scene)
            .into_iter()
            .filter(move |part| part.kind == kind)
            .map(|p| (p.name, p.depth, p.instances))
            .collect::<Vec<_>>()
    };
    let part = |name: &str, depth, instances| (name.to_owned(), depth, instances);
    assert_eq!(
        names(PartKind::Mesh),
        [part("Shell\\u{a}of glass", 0, 1), part("mesh 1", 0, 1)]
    );
    assert_eq!(
        names(PartKind::Material),
        [part("Lens", 0, 1), part("default", 0, 1)]
    );
    assert_eq!(
        names(PartKind::Node),
        [part("Head", 0, 2), part("Eye", 1, 1), part("node 1", 1, 1)]
    );
}
