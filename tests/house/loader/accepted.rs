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
    for kind in ["U8", "U16", "U32"] {
        let model = Model::square().set(&format!("& SCALAR {kind} 0 1 2 0 2 3\nP/indices 2"));
        assert_eq!(triangles(&model.scene()), square(), "{kind}");
    }
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
        let scene = Model::square()
            .with("P/mode", mode)
            .with("/accessors/1/count", 5)
            .scene();
        [0, 1, 2].map(|t| scene.primitives[0].corners(&scene, t))
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
    model.view(&bytes);
    let scene = model
        .set(
            r#"
            & SCALAR U16 0 1 2 0 2 3
            /bufferViews/0/byteStride 28
            /accessors [{"bufferView":0,"byteOffset":8,"componentType":5126,"type":"VEC3","count":4},{"bufferView":0,"byteOffset":20,"componentType":5126,"type":"VEC3","count":4,"min":[0,0,0],"max":[1,1,1]},{"bufferView":0,"byteOffset":32,"componentType":5121,"type":"VEC4","count":4,"normalized":true},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":6}]
            /meshes/0/primitives [{"attributes":{"NORMAL":0,"POSITION":1,"COLOR_0":2},"indices":3}]
            "#,
        )
        .scene();
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
    let color =
        [0, 1, 2, 3].map(|component| color.value(&scene.vertex_bytes, 3, component) * 255.0);
    assert_eq!(color, [30.0, 20.0, 30.0, 255.0]);
}

#[test]
fn sparse_elements_replace_their_base_or_zeros() {
    for has_base in [true, false] {
        let mut model = Model::square();
        let indices = model.view(&[1, 3]);
        let values = model.view(&le_floats(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
        let mut model = model.with("/accessors/0/sparse", sparse(2, indices, values));
        if !has_base {
            model = model.without("/accessors/0/bufferView");
        }
        let base = |c: usize| SQUARE[c].map(|v| f64::from(v) * f64::from(u8::from(has_base)));
        let wanted = [
            [base(0), [5.0, 6.0, 7.0], base(2)],
            [base(0), base(2), [8.0, 9.0, 10.0]],
        ];
        assert_eq!(triangles(&model.scene()), wanted);
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

/// Two nodes with the mesh, the second moved.
fn twice() -> Model {
    Model::square().set(r#"/nodes [{"mesh":0},{"mesh":0,"translation":[3,0,0]}]"#)
}

#[test]
fn only_the_default_scene_is_shown() {
    for (changes, wanted) in [
        ("/scene 1", &[3.0][..]),
        ("- /scene", &[0.0]),
        ("- /scene\n- /scenes", &[0.0, 3.0]),
    ] {
        let model = twice()
            .set(r#"/scenes [{"nodes":[0]},{"nodes":[1]}]"#)
            .set(changes);
        let places: Vec<f64> = model
            .scene()
            .instances
            .iter()
            .map(|i| i.world_from_object.w_axis.x)
            .collect();
        assert_eq!(places, wanted, "{changes}");
    }
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
        let normals = scene.primitives[0].normals;
        DVec3::from_array([0, 1, 2].map(|l| normals.value(&scene.vertex_bytes, vertex, l)))
    };
    let mut flat = Model::empty();
    flat.floats("VEC3", &[0, 1, 2, 0, 3, 1].map(|i| corners[i]).concat());
    flat.primitive(json!({ "attributes": { "POSITION": 0 } }));
    let flat = flat.scene();
    assert_eq!((normal(&flat, 0), normal(&flat, 3)), (DVec3::Z, DVec3::X));
    let mut smooth = Model::empty();
    smooth.floats("VEC3", &corners.concat());
    smooth.numbers("SCALAR U16 0 1 2 0 3 1");
    smooth.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    let smooth = smooth.scene();
    assert!(normal(&smooth, 0).distance(DVec3::new(2.0, 0.0, 1.0).normalize()) < 1e-6);
    assert_eq!(normal(&smooth, 2), DVec3::Z);
    for scene in [&flat, &smooth] {
        let primitive = &scene.primitives[0];
        assert!(primitive.is_faceted && !primitive.normals_agree);
    }
    let given = Model::square().set("& VEC3 F32 0 0 1 0 0 1 0 0 1 0 0 1\nA/NORMAL 2");
    assert!(!given.scene().primitives[0].is_faceted);
}

#[test]
fn vertex_colors_come_in_three_widths() {
    // An opaque material ignores alpha.
    for (accessor, normalized, wanted) in [
        ("VEC3 F32 0.25*12", false, 0.25),
        ("VEC3 U8 51*12", true, 0.2),
        ("VEC4 U16 13107*16", true, 0.2),
    ] {
        let changes = format!("& {accessor}\n/accessors/2/normalized {normalized}\nA/COLOR_0 2");
        let scene = Model::square().set(&changes).scene();
        let color = scene.primitives[0].colors.unwrap();
        let channels = [0, 1, 2].map(|component| color.value(&scene.vertex_bytes, 2, component));
        assert_eq!((color.components, channels), (3, [wanted; 3]), "{accessor}");
    }
}

#[test]
fn cameras_of_the_file_keep_their_lens_and_place() {
    let model = Model::square().set(
        r#"
        /cameras [{"type":"perspective","name":"near","perspective":{"yfov":1.0,"znear":0.25}},{"type":"orthographic","orthographic":{"xmag":2,"ymag":3,"znear":0,"zfar":9}},{"type":"perspective","perspective":{"yfov":0.0,"znear":1}}]
        /nodes [{"mesh":0},{"camera":0,"translation":[0.5,0.5,4]},{"camera":1,"name":"side","translation":[9,0,0],"rotation":[0,0.7071067811865476,0,0.7071067811865476]},{"camera":2}]
        /scenes/0/nodes [0,1,2,3]
        "#,
    );
    let scene = model.scene();
    let [near, side] = &scene.cameras[..] else {
        panic!("{:?}", scene.cameras)
    };
    let read = (near.name.as_str(), near.pose.eye, near.pose.near_m);
    assert_eq!(read, ("near", DVec3::new(0.5, 0.5, 4.0), 0.25));
    let middle = DVec3::new(0.5, 0.5, 0.0);
    assert!(
        near.pose.target.distance(middle) < 1e-12,
        "the target lies at the distance of the scene's middle"
    );
    let fov_y_deg = 1f64.to_degrees();
    assert_eq!(near.pose.projection, Projection::Perspective { fov_y_deg });
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
    let model = Model::square()
        .set("/extensionsUsed [\"KHR_materials_clearcoat\"]\n/animations []\nA/_HEAT 0");
    let scene = model.scene();
    assert_noted(
        &scene,
        "the extension \"KHR_materials_clearcoat\" is not supported and is ignored",
    );
    let nothing = Model::empty().set("/nodes [{}]").scene();
    assert!(nothing.notes[0].contains("nothing to draw"));
}

#[test]
fn lines_are_pairs_of_corners_whichever_way_they_are_joined() {
    for (mode, wanted) in [
        (1, "0 1, 2 3"),
        (2, "0 1, 1 2, 2 3, 3 0"),
        (3, "0 1, 1 2, 2 3"),
    ] {
        let mut model = Model::square();
        model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": mode }));
        let scene = model.scene();
        let lines = &scene.primitives[1];
        let ends = |segment| {
            let [a, same, b] = lines.corners(&scene, 2 * segment);
            assert_eq!(same, a);
            format!("{a} {b}")
        };
        let segments: Vec<String> = (0..lines.triangle_count() / 2).map(ends).collect();
        assert_eq!(segments.join(", "), wanted);
    }
}

#[test]
fn small_integers_are_places_when_the_file_says_that_it_is_quantized() {
    let model = Model::square()
        .set(
            r#"
            & VEC4 I8 0 0 0 0 127 0 0 0 127 127 0 0 0 127 0 0
            & VEC4 I8 0 0 127 0 0 0 127 0 0 0 127 0 0 0 127 0
            /accessors/2/type "VEC3"
            /accessors/2/min [0,0,0]
            /accessors/2/max [1,1,1]
            /accessors/3/type "VEC3"
            /accessors/3/normalized true
            /bufferViews/2/byteStride 4
            /bufferViews/3/byteStride 4
            P/attributes {"POSITION":2,"NORMAL":3}
            "#,
        )
        .with("/nodes/0/scale", json!([1.0 / 127.0, 1.0 / 127.0, 1.0]));
    model.refused("POSITION: accessor 2 has the type 3 x I8, which glTF does not allow for it");
    let model = model.set("/extensionsUsed [\"KHR_mesh_quantization\"]\n/extensionsRequired [\"KHR_mesh_quantization\"]");
    let [_, _, [x, y, _]] = triangles(&model.silent())[0];
    assert!((x - 1.0).abs() < 1e-6 && (y - 1.0).abs() < 1e-6);
    let normalized = model
        .set("/accessors/2/normalized true\n/nodes/0/scale [1,1,1]")
        .scene();
    assert_eq!(triangles(&normalized), square());
}

#[test]
fn the_names_of_a_model_are_its_parts() {
    // Children stand before their parents in the file.
    let scene = Model::square()
        .set(
            r#"
            /materials [{"name":"Lens"}]
            /meshes [{"name":"Shell\nof glass","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]
            /nodes [{"name":"Eye","mesh":0},{"mesh":1},{"name":"Head","children":[0,1]},{"name":"Empty"}]
            /scenes [{"nodes":[2,3]}]
            "#,
        )
        .scene();
    let parts: Vec<_> = parts(&scene)
        .into_iter()
        .map(|p| (p.kind, p.name, p.depth, p.instances))
        .collect();
    for (kind, wanted) in [
        (
            PartKind::Mesh,
            &[("Shell\\u{a}of glass", 0, 1), ("mesh 1", 0, 1)][..],
        ),
        (PartKind::Material, &[("Lens", 0, 1), ("default", 0, 1)]),
        (
            PartKind::Node,
            &[("Head", 0, 2), ("Eye", 1, 1), ("node 1", 1, 1)],
        ),
    ] {
        let found = parts.iter().filter(|part| part.0 == kind);
        let found: Vec<_> = found
            .map(|(_, name, depth, instances)| (name.as_str(), *depth, *instances))
            .collect();
        assert_eq!(found, wanted);
    }
}
