//! The glTF loader: what it accepts arrives exactly, what it refuses is refused in a sentence, and nothing panics,
//! hangs, or is read outside the model's folder.

use std::{
    f64::consts::FRAC_1_SQRT_2,
    fs,
    path::{Path, PathBuf},
};

use base64::{Engine, prelude::BASE64_STANDARD};
use glam::DVec3;
use rasterlab::{
    math::hash,
    scene::{
        Scene,
        camera::Projection,
        gltf::{self, LoadError, limits},
        pose::{Motion, Pose},
    },
};
use serde_json::{Value, json};

const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// A model being written: JSON, and the bytes of its one buffer.
#[derive(Clone)]
struct Model {
    json: Value,
    bytes: Vec<u8>,
}

impl Model {
    fn empty() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
            "meshes": [{ "name": "X", "primitives": [] }], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        });
        Self { json, bytes: Vec::new() }
    }

    /// Mesh "X" with one primitive: accessor 0 holds four positions, accessor 1 u16 indices 0 1 2 0 2 3.
    fn square() -> Self {
        let mut model = Self::empty();
        let positions = model.floats("VEC3", &SQUARE.concat());
        let indices = model.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
        model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
        model
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json.get(list).is_none() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    fn primitive(&mut self, value: Value) {
        self.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(value);
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bytes.len());
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let mut accessor = json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        if kind == "VEC3" {
            // The standard wants them with positions.
            (accessor["min"], accessor["max"]) = (json!([0, 0, 0]), json!([1, 1, 1]));
        }
        self.push("accessors", accessor)
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        self.accessor(&le_floats(values), F32, kind, values.len() / components(kind))
    }

    fn shorts(&mut self, kind: &str, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, U16, kind, values.len() / components(kind))
    }

    /// With one value of the JSON changed or added.
    fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = self.json.pointer_mut(parent).unwrap_or_else(|| panic!("no {parent}"));
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            _ => parent[key] = value,
        }
        self
    }

    fn without(mut self, pointer: &str) -> Self {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        self.json.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(key).unwrap();
        self
    }

    fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.bytes)
    }

    fn load(&self) -> Result<Scene, LoadError> {
        gltf::parse(&self.glb(), &mut |path, _| panic!("{} was asked for", path.display()))
    }

    fn scene(&self) -> Scene {
        let scene = self.load().unwrap_or_else(|error| panic!("{error}\n{}", self.json));
        assert_sound(&scene);
        scene
    }

    #[track_caller]
    fn refused(&self, sentence: &str) {
        let error = self.load().expect_err(sentence).to_string();
        assert!(error.contains(sentence), "said: {error}\nnot:  {sentence}");
        assert!(!error.contains('\n') && !error.contains("is a bug"), "{error}");
    }
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn components(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => panic!("{kind}"),
    }
}

fn le_floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// Corners of every triangle in world space, in drawing order.
fn triangles(scene: &Scene) -> Vec<[[f64; 3]; 3]> {
    let mut triangles = Vec::new();
    for instance in &scene.instances {
        let primitive = &scene.primitives[instance.primitive];
        for t in 0..primitive.triangle_count() {
            let corner = |vertex| instance.world_from_object.transform_point3(primitive.position(scene, vertex).map(f64::from).into());
            triangles.push(primitive.corners(scene, t).map(|vertex| corner(vertex).to_array()));
        }
    }
    triangles
}

/// The square's two triangles, for comparison.
fn square() -> Vec<[[f64; 3]; 3]> {
    [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c: usize| SQUARE[c].map(f64::from))).into()
}

/// Everything that later stages take for granted: each accessor can be read to its end, and every pose is finite.
fn assert_sound(scene: &Scene) {
    if !scene.rig.is_empty() {
        let clips = (0..scene.rig.clips.len()).map(Some).chain([None]);
        for (clip, time_s) in clips.flat_map(|clip| [0.0, 0.7, 1e9, -3.5].map(|time_s| (clip, time_s))) {
            let pose = Pose::at(scene, &Motion { clip, time_s, ..Motion::default() });
            assert!(
                (0..scene.instances.len())
                    .all(|i| !pose.place(i).is_nan() && pose.deform(i).is_none_or(|b| b.weights.iter().all(|w| w.is_finite())))
            );
        }
        assert!(scene.rig.nodes.iter().enumerate().all(|(i, node)| node.parent.is_none_or(|parent| parent < i)));
    }
    assert!(scene.vertex_bytes.len().is_multiple_of(4) && scene.index_bytes.len().is_multiple_of(4));
    assert!(scene.instances.iter().all(|i| i.primitive < scene.primitives.len() && i.world_from_object.is_finite()));
    for primitive in &scene.primitives {
        assert!(primitive.material < scene.materials.len());
        let deformation = &primitive.deformation;
        let shapes = deformation.morph_targets.iter().flat_map(|shape| [shape.positions, shape.normals]);
        let held = deformation.influences.iter().flat_map(|set| [Some(set.joints), Some(set.weights)]);
        let attributes = [Some(primitive.positions), Some(primitive.normals), primitive.colors];
        for accessor in attributes.into_iter().chain(shapes).chain(held).flatten() {
            assert_eq!(accessor.count, primitive.vertex_count());
            assert!(accessor.offset % accessor.component_type.bytes() == 0 && accessor.stride % accessor.component_type.bytes() == 0);
            for vertex in 0..accessor.count {
                assert!((0..accessor.components).all(|lane| accessor.value(&scene.vertex_bytes, vertex, lane).is_finite()));
            }
        }
        for vertex in 0..primitive.vertex_count() {
            let p = DVec3::from(primitive.position(scene, vertex).map(f64::from));
            assert!(p.cmpge(primitive.bounds.min).all() && p.cmple(primitive.bounds.max).all());
        }
        for t in 0..primitive.triangle_count() {
            let corners = primitive.corners(scene, t);
            assert!(corners.iter().all(|&c| c < primitive.vertex_count()));
            let [a, b, c] = corners.map(|c| DVec3::from(primitive.position(scene, c).map(f64::from)));
            assert!(a.distance(b).max(b.distance(c)).max(c.distance(a)) <= primitive.longest_edge * (1.0 + 1e-12));
        }
    }
}

// ---- accepted ----

#[test]
fn every_index_width_names_the_same_triangles() {
    assert_eq!(triangles(&Model::square().scene()), square());
    let mut bytes = Model::square();
    let indices = bytes.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6);
    assert_eq!(triangles(&bytes.with("/meshes/0/primitives/0/indices", json!(indices)).scene()), square());
    let mut words = Model::square();
    let indices = words.accessor(&[0u32, 1, 2, 0, 2, 3].map(u32::to_le_bytes).concat(), U32, "SCALAR", 6);
    assert_eq!(triangles(&words.with("/meshes/0/primitives/0/indices", json!(indices)).scene()), square());
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
        let model = Model::square().with("/meshes/0/primitives/0/mode", json!(mode)).with("/accessors/1/count", json!(5));
        let scene = model.scene();
        (0..3).map(|t| scene.primitives[0].corners(&scene, t)).collect::<Vec<_>>()
    };
    // Indices 0 1 2 0 2. glTF 2.0, 3.7.2.1: strips {i, i + (1 + i % 2), i + (2 - i % 2)}, fans {i + 1, i + 2, 0}.
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
    let [normals, positions, colors] =
        [part(8, F32, "VEC3"), part(20, F32, "VEC3"), part(32, U8, "VEC4")].map(|a| model.push("accessors", a));
    let indices = model.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    model.primitive(json!({ "attributes": { "POSITION": positions, "NORMAL": normals, "COLOR_0": colors }, "indices": indices }));
    let scene = model.scene();
    assert_eq!(scene.vertex_bytes, bytes, "the view is copied once and whole");
    assert_eq!(triangles(&scene), square());
    let primitive = &scene.primitives[0];
    assert_eq!((primitive.positions.stride, primitive.positions.offset), (28, 20));
    let color = primitive.colors.unwrap();
    assert_eq!([0, 1, 2, 3].map(|lane| color.value(&scene.vertex_bytes, 3, lane) * 255.0), [30.0, 20.0, 30.0, 255.0]);
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
        let base = |c: usize| if has_base { SQUARE[c].map(f64::from) } else { [0.0; 3] };
        assert_eq!(triangles(&scene), [[base(0), [5.0, 6.0, 7.0], base(2)], [base(0), base(2), [8.0, 9.0, 10.0]]]);
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
    // (1, 1, 0) -> mirrored (1, -1, 5) -> scaled (2, -2, 10) -> turned (2, 2, 10) -> moved (12, 2, 10)
    let corner = DVec3::from(triangles(&scene)[0][2]);
    assert!(corner.distance(DVec3::new(12.0, 2.0, 10.0)) < 1e-6, "{corner}");
    assert!(scene.instances[0].world_from_object.determinant() < 0.0);
}

#[test]
fn a_mesh_is_stored_once_and_placed_by_every_node() {
    let model = Model::square()
        .with("/nodes", json!([{ "mesh": 0 }, { "mesh": 0, "translation": [3, 0, 0] }]))
        .with("/scenes/0/nodes", json!([0, 1]));
    let scene = model.scene();
    assert_eq!((scene.primitives.len(), scene.instances.len(), scene.triangle_count()), (1, 2, 4));
    assert_eq!(scene.bounds().max.x, 4.0);
}

#[test]
fn only_the_default_scene_is_shown() {
    let two = Model::square().with("/nodes", json!([{ "mesh": 0 }, { "mesh": 0, "translation": [3, 0, 0] }]));
    let shown = |model: Model| model.scene().instances.iter().map(|i| i.world_from_object.w_axis.x).collect::<Vec<_>>();
    let scenes = two.with("/scenes", json!([{ "nodes": [0] }, { "nodes": [1] }]));
    assert_eq!(shown(scenes.clone().with("/scene", json!(1))), [3.0]);
    assert_eq!(shown(scenes.clone().without("/scene")), [0.0]);
    assert_eq!(shown(scenes.without("/scene").without("/scenes")), [0.0, 3.0]);
}

#[test]
fn missing_normals_are_flat_without_indices_and_smooth_with_them() {
    // Two faces that meet at a right angle along the y axis, of areas 1/2 and 1.
    let corners: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -2.0]];
    let normal = |scene: &Scene, vertex: u32| {
        DVec3::from_array([0, 1, 2].map(|l| scene.primitives[0].normals.value(&scene.vertex_bytes, vertex, l)))
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
}

#[test]
fn base_colour_and_double_sides_come_from_the_material() {
    let material = json!({ "name": "red", "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.1, 0.2, 1.0] } });
    let model = Model::square().with("/materials", json!([material])).with("/meshes/0/primitives/0/material", json!(0));
    let scene = model.scene();
    let red = &scene.materials[scene.primitives[0].material];
    assert_eq!((red.name.as_str(), red.base_color, red.double_sided), ("red", [0.8, 0.1, 0.2, 1.0], true));
    let plain = Model::square().scene();
    assert_eq!(plain.materials[plain.primitives[0].material].base_color, [1.0; 4]);
}

#[test]
fn vertex_colours_come_in_three_widths() {
    let read = |model: Model| {
        let scene = model.scene();
        let color = scene.primitives[0].colors.unwrap();
        (color.components, [0, 1, 2].map(|lane| color.value(&scene.vertex_bytes, 2, lane)))
    };
    let add = |normalized: bool, make: &dyn Fn(&mut Model) -> usize| {
        let mut model = Model::square();
        let colors = make(&mut model);
        model.json["accessors"][colors]["normalized"] = json!(normalized);
        model.with("/meshes/0/primitives/0/attributes/COLOR_0", json!(colors))
    };
    assert_eq!(read(add(false, &|m| m.floats("VEC3", &[0.25; 12]))), (3, [0.25; 3]));
    assert_eq!(read(add(true, &|m| m.accessor(&[51; 12], U8, "VEC3", 4))), (3, [0.2; 3]));
    assert_eq!(read(add(true, &|m| m.shorts("VEC4", &[13_107; 16]))), (4, [0.2; 3]));
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
    let [near, side] = &scene.cameras[..] else { panic!("{:?}", scene.cameras) };
    assert_eq!((near.name.as_str(), near.pose.eye, near.pose.near_m), ("near", DVec3::new(0.5, 0.5, 4.0), 0.25));
    assert!(near.pose.target.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-12, "the target lies at the distance of the scene's middle");
    assert_eq!(near.pose.projection, Projection::Perspective { fov_y_deg: 1f64.to_degrees() });
    assert_eq!((side.name.as_str(), side.pose.projection), ("side", Projection::Orthographic { height_m: 6.0 }));
    assert!(side.pose.forward().distance(DVec3::NEG_X) < 1e-6);
    assert!(scene.notes.iter().any(|note| note.contains("camera 2") && note.contains("yfov")), "{:?}", scene.notes);
}

#[test]
fn what_is_left_out_is_noted() {
    let mut model = Model::square().with("/extensionsUsed", json!(["KHR_materials_clearcoat"])).with("/animations", json!([]));
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    model.json["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = json!(0);
    let scene = model.scene();
    assert_eq!(scene.primitives.len(), 1);
    for part in
        ["mesh \"X\" primitive 1 is skipped: points and lines", "the extension \"KHR_materials_clearcoat\" is not supported and is ignored"]
    {
        assert!(scene.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", scene.notes);
    }
    let nothing = Model::empty().with("/nodes", json!([{}])).scene();
    assert!(nothing.notes[0].contains("nothing to draw"));
}

/// A skin of two joints over the square; `tilt` moves the second one away from where it was bound.
fn skinned(tilt: f64) -> Model {
    let mut model = Model::square();
    let moved = |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0];
    let inverse = model.floats("MAT4", &[moved(-1.0), moved(-2.0)].concat());
    let joints = model.accessor(&[0, 1, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats("VEC4", &[[1.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]].concat());
    model
        .with("/skins", json!([{ "inverseBindMatrices": inverse, "joints": [1, 2] }]))
        .with(
            "/nodes",
            json!([
                { "mesh": 0, "skin": 0, "translation": [100, 100, 100] },
                { "translation": [4, 0, 0], "children": [2] }, { "translation": [1.0, 0, tilt] },
            ]),
        )
        .with("/scenes/0/nodes", json!([0, 1]))
        .with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints))
        .with("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(weights))
}

/// Corners of every triangle as a moment of a clip places and bends them.
fn posed(scene: &Scene, clip: Option<usize>, time_s: f64) -> Vec<[[f64; 3]; 3]> {
    let pose = Pose::at(scene, &Motion { clip, time_s, ..Motion::default() });
    let mut triangles = Vec::new();
    for (index, instance) in scene.instances.iter().enumerate() {
        let primitive = &scene.primitives[instance.primitive];
        let corner = |vertex| {
            let object = match pose.deform(index) {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => primitive.position(scene, vertex).map(f64::from).into(),
            };
            pose.place(index).transform_point3(object).to_array()
        };
        triangles.extend((0..primitive.triangle_count()).map(|t| primitive.corners(scene, t).map(corner)));
    }
    triangles
}

#[test]
fn a_skin_at_rest_places_its_mesh_by_the_joints_alone() {
    let scene = skinned(0.0).scene();
    assert_eq!(posed(&scene, None, 0.0)[0], [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]);
    assert_eq!(scene.primitives.len(), 1, "the file's bytes are drawn");
    assert_eq!((scene.bounds().min, scene.bounds().max), (DVec3::new(3.0, 0.0, 0.0), DVec3::new(4.0, 1.0, 0.0)));
}

#[test]
fn a_skin_that_stands_otherwise_than_bound_bends_its_mesh() {
    let scene = skinned(8.0).scene();
    assert_eq!(posed(&scene, None, 0.0)[0], [[3.0, 0.0, 0.0], [4.0, 0.0, 8.0], [4.0, 1.0, 4.0]], "weights are normalised, and blend");
    assert!(scene.notes.iter().any(|note| note.contains("1 vertices have weights that do not sum to 1")), "{:?}", scene.notes);
}

#[test]
fn a_vertex_without_weight_is_held_by_its_first_joint_and_said_to_be() {
    let mut model = skinned(8.0);
    let joints = model.accessor(&[1, 0, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats("VEC4", &[0.0; 16]);
    let model = model
        .with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints))
        .with("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(weights));
    let scene = model.scene();
    assert_eq!(posed(&scene, None, 0.0)[0][0], [3.0, 0.0, 8.0]);
    assert!(
        scene.notes.iter().any(|note| note.contains("4 vertices have only weights of 0; they follow their first joint")),
        "{:?}",
        scene.notes
    );
}

#[test]
fn eight_joints_hold_a_vertex_in_any_width() {
    let narrow = skinned(8.0);
    let mut wide = narrow.clone();
    let joints = wide.shorts("VEC4", &[0; 16]);
    let more = wide.accessor(&[1; 16], U8, "VEC4", 4);
    let weights = wide.shorts("VEC4", &[13_107, 0, 0, 0].repeat(4));
    let others = wide.accessor(&[51, 51, 51, 51].repeat(4), U8, "VEC4", 4);
    for accessor in [weights, others] {
        wide.json["accessors"][accessor]["normalized"] = json!(true);
    }
    let set = |model: Model, name: &str, accessor: usize| model.with(&format!("/meshes/0/primitives/0/attributes/{name}"), json!(accessor));
    let wide = set(set(set(set(wide, "JOINTS_0", joints), "WEIGHTS_0", weights), "JOINTS_1", more), "WEIGHTS_1", others);
    let scene = wide.scene();
    assert_eq!(scene.primitives[0].deformation.influences.len(), 2);
    // A fifth of the first joint, four fifths of the second.
    let [_, _, z] = posed(&scene, None, 0.0)[0][0];
    assert!((z - 0.8 * 8.0).abs() < 1e-12, "{z}");
    wide.without("/meshes/0/primitives/0/attributes/WEIGHTS_1").refused("lacks JOINTS_1 or WEIGHTS_1");
}

/// A square under a node that a clip named "Move" moves: keys at 1 and 3 s.
fn clip(path: &str, interpolation: &str, kind: &str, values: &[f32]) -> Model {
    let mut model = Model::square();
    let input = model.floats("SCALAR", &[1.0, 3.0]);
    let output = model.floats(kind, values);
    model.with("/nodes", json!([{ "children": [1], "translation": [10, 0, 0] }, { "mesh": 0, "name": "SimpleMesh" }])).with(
        "/animations",
        json!([{
            "name": "Move", "channels": [{ "sampler": 0, "target": { "node": 1, "path": path } }],
            "samplers": [{ "input": input, "output": output, "interpolation": interpolation }],
        }]),
    )
}

#[test]
fn clips_move_nodes_and_all_that_hangs_on_them() {
    let values = [0.0, 0.0, 0.0, 0.0, 4.0, 8.0];
    let scene = clip("translation", "LINEAR", "VEC3", &values).scene();
    assert_eq!((scene.rig.clips[0].name.as_str(), scene.rig.clips[0].duration_s), ("Move", 3.0));
    let corner = |scene: &Scene, time_s: f64| posed(scene, scene.rig.clip("Move"), time_s)[0][0];
    assert_eq!([0.0, 1.5, 3.0].map(|t| corner(&scene, t)), [[10.0, 0.0, 0.0], [10.0, 1.0, 2.0], [10.0, 4.0, 8.0]]);
    assert_eq!(corner(&scene, 4.5), corner(&scene, 1.5), "a clip goes round");
    assert_eq!(posed(&scene, None, 2.0), triangles(&scene), "at rest the file's placements hold");
    let step = clip("translation", "STEP", "VEC3", &values).scene();
    assert_eq!(corner(&step, 2.9), [10.0, 0.0, 0.0]);
    let tangents = [[9.0; 3], [0.0; 3], [0.0, 2.0, 0.0], [0.0, -2.0, 0.0], [0.0, 4.0, 8.0], [9.0; 3]].concat();
    let cubic = clip("translation", "CUBICSPLINE", "VEC3", &tangents).scene();
    // Half way of a cubic Hermite curve over 2 s: (a + b) / 2 + 2 (out - in) / 8.
    assert_eq!(corner(&cubic, 2.0), [10.0, 3.0, 4.0]);
}

#[test]
fn rotations_are_slerped_and_taken_by_their_direction() {
    let root = FRAC_1_SQRT_2 as f32;
    let scene = clip("rotation", "LINEAR", "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0 * root, 2.0 * root]).scene();
    assert!(scene.notes.iter().any(|note| note == "1 rotation keyframes are not unit quaternions; they are normalized"));
    // A third of a quarter turn about z takes (1, 0, 0) to (cos 30°, sin 30°, 0).
    let [x, y, _] = posed(&scene, Some(0), 1.0 + 2.0 / 3.0)[0][1];
    assert!((x - 10.0 - 0.75f64.sqrt()).abs() < 1e-7 && (y - 0.5).abs() < 1e-7, "{x} {y}");
}

#[test]
fn clips_blend_joint_by_joint() {
    let mut model = clip("translation", "LINEAR", "VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 8.0]);
    let mut second = model.json["animations"][0].clone();
    second["name"] = json!("Still");
    second["samplers"][0]["output"] = json!(model.floats("VEC3", &[0.0, 2.0, 0.0, 0.0, 2.0, 0.0]));
    model.push("animations", second);
    let scene = model.scene();
    let pose = Pose::at(&scene, &Motion { clip: Some(0), other: Some(1), blend: 0.25, time_s: 2.0, ..Motion::default() });
    assert_eq!(pose.place(0).w_axis.truncate(), DVec3::new(10.0, 0.5, 3.0));
}

/// A square with two morph targets, the second sparse, and weights for them.
fn morphed() -> Model {
    let mut model = Model::square();
    let first = model.floats("VEC3", &[[0.0, 0.0, 1.0]; 4].concat());
    let turned = model.floats("VEC3", &[[1.0, 0.0, 0.0]; 4].concat());
    let (at, values) = (model.view(&[2]), model.view(&le_floats(&[0.0, 5.0, 0.0])));
    let second = model.push(
        "accessors",
        json!({ "componentType": F32, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 5, 0],
            "sparse": { "count": 1, "indices": { "bufferView": at, "componentType": U8 }, "values": { "bufferView": values } } }),
    );
    model
        .with("/meshes/0/primitives/0/targets", json!([{ "POSITION": first, "NORMAL": turned }, { "POSITION": second }]))
        .with("/meshes/0/weights", json!([0.5, 1.0]))
}

#[test]
fn morph_targets_are_mixed_by_the_weights_of_node_mesh_and_clip() {
    let scene = morphed().scene();
    assert_eq!(posed(&scene, None, 0.0)[0], [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 6.0, 0.5]]);
    assert_eq!(posed(&morphed().with("/nodes/0/weights", json!([0.0, 0.0])).scene(), None, 0.0), square());
    let mut moving = morphed();
    let input = moving.floats("SCALAR", &[0.0, 2.0]);
    let output = moving.floats("SCALAR", &[0.0, 0.0, 1.0, -1.0]);
    let moving = moving.with(
        "/animations",
        json!([{ "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }], "samplers": [{ "input": input, "output": output }] }]),
    );
    let scene = moving.scene();
    assert_eq!(scene.rig.clips[0].name, "clip 0");
    assert_eq!(posed(&scene, Some(0), 1.0)[0], [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, -1.5, 0.5]]);
    moving
        .clone()
        .with("/animations/0/channels/0/target/node", json!(0))
        .with("/accessors/6/count", json!(3))
        .refused("clip 0 channel 0: weights of node 0: output: has 3 elements; its keyframes need 4");
    moving.without("/meshes/0/primitives/0/targets").without("/meshes/0/weights").refused("the node has no mesh with morph targets");
}

#[test]
fn small_integers_are_places_when_the_file_says_that_it_is_quantized() {
    let mut model = Model::square();
    let places = model.accessor(&[0, 0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0, 0, 127, 0, 0], 5120, "VEC3", 4);
    let view = model.json["accessors"][places]["bufferView"].as_u64().unwrap();
    let normals = model.accessor(&[0, 0, 127, 0].repeat(4), 5120, "VEC3", 4);
    let below = model.json["accessors"][normals]["bufferView"].as_u64().unwrap();
    let model = model
        .with(&format!("/bufferViews/{view}/byteStride"), json!(4))
        .with(&format!("/bufferViews/{below}/byteStride"), json!(4))
        .with(&format!("/accessors/{normals}/normalized"), json!(true))
        .with("/meshes/0/primitives/0/attributes", json!({ "POSITION": places, "NORMAL": normals }))
        .with("/nodes/0/scale", json!([1.0 / 127.0, 1.0 / 127.0, 1.0]));
    model.refused("POSITION: accessor 2 has the type 3 x I8, which glTF does not allow for it");
    let model =
        model.with("/extensionsUsed", json!(["KHR_mesh_quantization"])).with("/extensionsRequired", json!(["KHR_mesh_quantization"]));
    let scene = model.scene();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let [_, _, [x, y, _]] = triangles(&scene)[0];
    assert!((x - 1.0).abs() < 1e-6 && (y - 1.0).abs() < 1e-6);
    let normalized = model.with(&format!("/accessors/{places}/normalized"), json!(true)).with("/nodes/0/scale", json!([1, 1, 1])).scene();
    assert_eq!(triangles(&normalized), square());
}

#[test]
fn buffers_come_from_data_uris_and_from_files_beside_the_model() {
    let model = Model::square();
    let data = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&model.bytes));
    let embedded = model.clone().with("/buffers/0/uri", json!(data)).json.to_string();
    let scene = gltf::parse(embedded.as_bytes(), &mut |_, _| unreachable!()).unwrap();
    assert_eq!(triangles(&scene), square());

    let folder = Folder::new();
    fs::create_dir(folder.path("parts")).unwrap();
    fs::write(folder.path("parts/my data.bin"), &model.bytes).unwrap();
    let scene = folder.load(&model.with("/buffers/0/uri", json!("./parts/my%20data.bin"))).unwrap();
    assert_eq!((triangles(&scene), scene.name.as_str()), (square(), "model"));
}

// ---- refused: containers, URIs, files ----

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, model: &Model) -> Result<Scene, LoadError> {
        fs::write(self.path("model.gltf"), model.json.to_string()).unwrap();
        gltf::load(&self.path("model.gltf"))
    }
}

#[test]
fn uris_that_lead_out_of_the_folder_are_refused_unread() {
    // The bytes are there to be had: one folder up, and by absolute path.
    let outer = Folder::new();
    let model = Model::square();
    fs::write(outer.path("secret.bin"), &model.bytes).unwrap();
    fs::create_dir(outer.path("inner")).unwrap();
    let absolute = outer.path("secret.bin").display().to_string();
    let uris = [
        "../secret.bin".into(),
        "./../secret.bin".into(),
        "a/../../secret.bin".into(),
        "%2e%2e/secret.bin".into(),
        "%2E%2E%2Fsecret.bin".into(),
        "..\\secret.bin".into(),
        "..%5csecret.bin".into(),
        absolute.clone(),
        format!("file:{absolute}"),
        format!("file://{absolute}"),
        format!("FILE://{absolute}"),
        "http://localhost/secret.bin".into(),
        "C:/secret.bin".into(),
        "C%3A/secret.bin".into(),
        "secret%FF.bin".into(),
        "secret%.bin".into(),
        "secret%+1.bin".into(),
        "secret%00.bin".into(),
        "".into(),
        ".".into(),
    ];
    for uri in uris {
        let text = model.clone().with("/buffers/0/uri", json!(uri)).json.to_string();
        let error = gltf::parse(text.as_bytes(), &mut |path, _| panic!("{uri}: {} was asked for", path.display())).expect_err(&uri);
        assert!(error.to_string().starts_with("buffer 0: URI "), "{error}");
        let file = outer.path("inner/model.gltf");
        fs::write(&file, text).unwrap();
        assert!(gltf::load(&file).is_err(), "{uri}");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_refused() {
    let (outer, inner) = (Folder::new(), Folder::new());
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    fs::write(outer.path("data.bin"), &model.bytes).unwrap();
    std::os::unix::fs::symlink(outer.path("data.bin"), inner.path("data.bin")).unwrap();
    let error = inner.load(&model).unwrap_err().to_string();
    assert_eq!(error, "model.gltf: buffer 0: \"data.bin\": it lies outside the model's folder; copy it there");
    // A link that stays inside is an ordinary file.
    fs::remove_file(inner.path("data.bin")).unwrap();
    fs::write(inner.path("real.bin"), &model.bytes).unwrap();
    std::os::unix::fs::symlink("real.bin", inner.path("data.bin")).unwrap();
    assert!(inner.load(&model).is_ok());
}

#[cfg(unix)]
#[test]
fn pipes_and_folders_are_refused_without_being_opened() {
    let folder = Folder::new();
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    fs::create_dir(folder.path("data.bin")).unwrap();
    assert!(folder.load(&model).unwrap_err().to_string().ends_with("it is not a regular file"));
    fs::remove_dir(folder.path("data.bin")).unwrap();
    // Opening a pipe that nobody writes to would wait for ever.
    assert!(std::process::Command::new("mkfifo").arg(folder.path("data.bin")).status().unwrap().success());
    assert!(folder.load(&model).unwrap_err().to_string().ends_with("it is not a regular file"));
    assert!(std::process::Command::new("mkfifo").arg(folder.path("pipe.glb")).status().unwrap().success());
    assert_eq!(gltf::load(&folder.path("pipe.glb")).unwrap_err().to_string(), "pipe.glb: it is not a regular file");
    assert!(gltf::load(Path::new("/dev/zero")).is_err());
}

#[test]
fn huge_and_absent_files_are_refused() {
    let folder = Folder::new();
    let model = Model::square().with("/buffers/0/uri", json!("data.bin"));
    assert!(folder.load(&model).unwrap_err().to_string().starts_with("model.gltf: buffer 0: \"data.bin\": cannot read the file: "));
    // Sparse on disk: no test writes 300 MiB.
    fs::File::create(folder.path("data.bin")).unwrap().set_len(300 << 20).unwrap();
    assert!(folder.load(&model).unwrap_err().to_string().ends_with("it has 314572800 bytes; allowed: at most 268435456"));
    fs::File::create(folder.path("huge.glb")).unwrap().set_len(limits::FILE_BYTES + 1).unwrap();
    assert_eq!(
        gltf::load(&folder.path("huge.glb")).unwrap_err().to_string(),
        "huge.glb: it has 268435457 bytes; allowed: at most 268435456"
    );
    assert!(gltf::load(&folder.path("absent.glb")).unwrap_err().to_string().starts_with("absent.glb: cannot read the file: "));
}

#[test]
fn buffers_together_have_a_budget() {
    let mut model = Model::square();
    model.json["buffers"] = json!([{ "byteLength": 1, "uri": "a" }, { "byteLength": 1, "uri": "b" }, { "byteLength": 1, "uri": "c" }]);
    let mut asked = Vec::new();
    let error = gltf::parse(model.json.to_string().as_bytes(), &mut |path, most| {
        asked.push((path.display().to_string(), most));
        Ok(vec![0; most.min(200 << 20) as usize])
    })
    .unwrap_err();
    assert_eq!(asked, [("a".into(), 256 << 20), ("b".into(), 256 << 20), ("c".into(), 112 << 20)]);
    assert!(error.to_string().contains("bufferView 0 (48 bytes from byte 0) exceeds buffer 0, which has 1 bytes"), "{error}");
}

#[test]
fn glb_lengths_are_checked_before_use() {
    let good = Model::square().glb();
    let refused = |bytes: &[u8], sentence: &str| {
        let error = gltf::parse(bytes, &mut |_, _| unreachable!()).expect_err(sentence).to_string();
        assert!(error.contains(sentence) && !error.contains("is a bug"), "said: {error}\nnot:  {sentence}");
    };
    let patched = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    refused(b"glTF", "the GLB header has 4 of 12 bytes");
    refused(&good[..11], "the GLB header has 11 of 12 bytes");
    refused(&good[..12], "the GLB header states");
    refused(&patched(4, 1), "GLB version 1 is not supported");
    for length in [0, 11, u32::MAX, good.len() as u32 + 1] {
        refused(&patched(8, length), &format!("the GLB header states {length} bytes"));
    }
    refused(&patched(8, 12), "the first GLB chunk is not JSON");
    refused(&patched(12, u32::MAX), "a GLB chunk states 4294967295 bytes");
    refused(&patched(16, 0), "the first GLB chunk is not JSON");
    refused(b"", "not a glTF file");
    refused(b"\x89PNG", "not a glTF file");
    refused("[".repeat(200_000).as_bytes(), "not a glTF file");
}

#[test]
fn versions_and_extensions_are_named() {
    Model::square().with("/asset/version", json!("1.0")).refused("glTF version \"1.0\" is not supported");
    Model::square().with("/asset", json!({})).refused("missing field `version`");
    Model::square()
        .with("/extensionsRequired", json!(["KHR_draco_mesh_compression"]))
        .refused("it requires the extension \"KHR_draco_mesh_compression\", which is not supported; export the model without compression");
    Model::square()
        .with("/extensionsRequired", json!(["EXT_meshopt_compression"]))
        .refused("it requires the extension \"EXT_meshopt_compression\", which is not supported; export the model without compression");
    Model::square().with("/extensionsRequired", json!(["KHR_mesh_quantization"])).scene();
    for accepted in
        ["KHR_lights_punctual", "KHR_materials_unlit", "KHR_materials_ior", "KHR_materials_emissive_strength", "KHR_texture_transform"]
    {
        Model::square().with("/extensionsRequired", json!([accepted])).scene();
    }
}

// ---- refused: numbers that do not agree ----

#[test]
fn counts_are_capped_before_anything_is_allocated() {
    let sparse = |count: u64| {
        let mut model = Model::square();
        let view = model.view(&[0, 0, 0, 0]);
        let overlay = json!({ "count": 1, "indices": { "bufferView": view, "componentType": U8 }, "values": { "bufferView": view } });
        model.without("/accessors/0/bufferView").with("/accessors/0/sparse", overlay).with("/accessors/0/count", json!(count))
    };
    sparse(1 << 40).refused("mesh \"X\" primitive 0 POSITION: accessor 0: count is 1099511627776; allowed: 1 to 30000000");
    sparse(1_000_000_000).refused("POSITION: accessor 0: count is 1000000000; allowed: 1 to");
    sparse(30_000_000).refused("POSITION: the model has 30000000 vertices or more; allowed: at most 4000000");
    sparse(0).refused("POSITION: accessor 0: count is 0; allowed: 1 to");
    let zero = sparse(4).with("/accessors/0/sparse/count", json!(0));
    zero.refused("POSITION: accessor 0 sparse: count is 0; allowed: 1 to 4");
    sparse(4).with("/accessors/0/sparse/count", json!(5)).refused("accessor 0 sparse: count is 5; allowed: 1 to 4");
    sparse(4).refused("accessor 0 sparse: its 1 values exceed bufferView 2, which has 4 bytes");
    sparse(4).with("/accessors/0/sparse/indices/byteOffset", json!(u64::MAX)).refused("its 1 indices exceed");
}

#[test]
fn sparse_indices_must_rise_and_stay_inside() {
    for indices in [[1u8, 1], [2, 1], [3, 4]] {
        let mut model = Model::square();
        let at = model.view(&indices);
        let values = model.view(&[0; 24]);
        let sparse = json!({ "count": 2, "indices": { "bufferView": at, "componentType": U8 }, "values": { "bufferView": values } });
        model.with("/accessors/0/sparse", sparse).refused("indices must increase and stay below 4");
    }
}

#[test]
fn accessors_must_lie_in_their_views_and_views_in_their_buffers() {
    let place = "mesh \"X\" primitive 0 POSITION: accessor 0: ";
    Model::square()
        .with("/accessors/0/count", json!(5))
        .refused(&format!("{place}5 elements of 12 bytes from byte 0 exceed bufferView 0, which has 48 bytes"));
    Model::square().with("/accessors/0/byteOffset", json!(4)).refused(&format!("{place}4 elements of 12 bytes from byte 4 exceed"));
    Model::square().with("/accessors/0/byteOffset", json!(u64::MAX - 3)).refused(place);
    Model::square().with("/bufferViews/0/byteOffset", json!(u64::MAX - 3)).refused(place);
    Model::square()
        .with("/bufferViews/0/byteLength", json!(1u64 << 60))
        .refused("bufferView 0 (1152921504606846976 bytes from byte 0) exceeds buffer 0, which has 60 bytes");
    Model::square()
        .with("/buffers/0/byteLength", json!(1u64 << 60))
        .refused("buffer 0: byteLength is 1152921504606846976, but the buffer has only 60 bytes");
    Model::square()
        .with("/buffers/0/byteLength", json!(40))
        .refused("bufferView 0 (48 bytes from byte 0) exceeds buffer 0, which has 40 bytes");
    Model::square()
        .with("/accessors/1/count", json!(9))
        .refused("mesh \"X\" primitive 0 indices: accessor 1: 9 elements of 2 bytes from byte 0 exceed");
    Model::square().without("/accessors/0/bufferView").refused("bufferView");
}

#[test]
fn strides_and_offsets_must_fit_their_components() {
    Model::square().with("/bufferViews/0/byteStride", json!(8)).refused("byteStride is 8; it must be a multiple of 4 and at least 12");
    Model::square().with("/bufferViews/0/byteStride", json!(14)).refused("byteStride is 14; it must be a multiple of 4");
    Model::square()
        .with("/accessors/0/byteOffset", json!(2))
        .refused("byteOffset 2, added to that of its bufferView, must be a multiple of the component size, 4");
    Model::square()
        .with("/bufferViews/0/byteOffset", json!(2))
        .refused("byteOffset 0, added to that of its bufferView, must be a multiple");
    Model::square()
        .with("/accessors/1/byteOffset", json!(1))
        .refused("indices: accessor 1: byteOffset 1, added to that of its bufferView, must be a multiple");
    Model::square().with("/bufferViews/1/byteStride", json!(4)).refused("indices: accessor 1: 6 elements of 4 bytes");
}

#[test]
fn attributes_must_have_the_types_of_the_standard() {
    let place = "mesh \"X\" primitive 0 POSITION: accessor 0 has the type";
    Model::square().with("/accessors/0/componentType", json!(U8)).refused(&format!("{place} 3 x U8, which glTF does not allow for it"));
    Model::square().with("/accessors/0/type", json!("SCALAR")).refused(&format!("{place} 1 x F32"));
    Model::square().with("/accessors/0/type", json!("VEC2")).refused(place);
    Model::square()
        .with("/accessors/1/componentType", json!(I16))
        .refused("indices: accessor 1 has the type 1 x I16, which glTF does not allow for it");
    let mut float = Model::square();
    let indices = float.floats("SCALAR", &[0.0; 6]);
    float.with("/meshes/0/primitives/0/indices", json!(indices)).refused("indices: accessor 2 has the type");
    Model::square()
        .with("/accessors/1/type", json!("VEC3"))
        .with("/accessors/1/count", json!(2))
        .refused("indices: accessor 1 has the type");
    let attribute = |name: &str, make: &dyn Fn(&mut Model) -> usize| {
        let mut model = Model::square();
        let accessor = make(&mut model);
        model.with(&format!("/meshes/0/primitives/0/attributes/{name}"), json!(accessor))
    };
    attribute("NORMAL", &|m| m.floats("VEC4", &[0.0; 16])).refused("NORMAL: accessor 2 has the type");
    attribute("NORMAL", &|m| m.floats("VEC3", &[0.0; 9])).refused("NORMAL: accessor 2 has 3 elements, but the primitive has 4 vertices");
    Model::square()
        .with("/meshes/0/primitives/0/attributes/POSITION", json!(9))
        .refused("mesh \"X\": POSITION refers to accessor 9, but there are only 2");
    attribute("COLOR_0", &|m| m.shorts("VEC4", &[0; 16]))
        .refused("COLOR_0: accessor 2 has the type 4 x U16, which glTF does not allow for it");
    Model::square().without("/meshes/0/primitives/0/attributes/POSITION").refused("POSITION");
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
fn corners_must_make_whole_triangles() {
    Model::square()
        .with("/accessors/1/count", json!(5))
        .refused("indices: 5 corners do not form whole triangles; their number must be a multiple of 3");
    for mode in [5, 6] {
        let short = Model::square().with("/meshes/0/primitives/0/mode", json!(mode)).with("/accessors/1/count", json!(2));
        short.refused("indices: 2 corners do not form whole triangles; their number must be at least 3");
    }
    Model::square().without("/meshes/0/primitives/0/indices").refused("POSITION: 4 corners do not form whole triangles");
}

#[test]
fn values_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (name, values) in [("POSITION", 12), ("NORMAL", 12), ("COLOR_0", 16)] {
            let mut model = Model::square();
            let mut floats = vec![0.5; values];
            floats[values - 2] = bad;
            let accessor = model.floats(if values == 12 { "VEC3" } else { "VEC4" }, &floats);
            let model = model.with(&format!("/meshes/0/primitives/0/attributes/{name}"), json!(accessor));
            model.refused(&format!("mesh \"X\" primitive 0 {name}: vertex 3 has a value that is not finite"));
        }
    }
    Model::square().with("/nodes/0/translation", json!([1e39, 0, 0])).refused("node 0: its world transform is not finite");
    Model::square().with("/nodes/0/rotation", json!([0, 0, 0, 0])).refused("node 0: its rotation is a quaternion of length 0e0");
    Model::square().with("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])).refused("the last row of its matrix");
}

#[test]
fn nodes_must_form_a_shallow_tree() {
    let nodes = |nodes: Value| Model::square().with("/nodes", nodes);
    nodes(json!([{ "children": [0], "mesh": 0 }])).refused("node 0: it is its own ancestor");
    nodes(json!([{ "children": [1] }, { "children": [0] }])).refused("it is its own ancestor");
    nodes(json!([{ "mesh": 0 }, { "children": [2] }, { "name": "b", "children": [1] }])).refused("it is its own ancestor");
    nodes(json!([{ "children": [2] }, { "children": [2] }, { "name": "child" }])).refused("node \"child\": it has more than one parent");
    nodes(json!([{ "children": [1, 1] }, {}])).refused("node 1: it has more than one parent");
    nodes(json!([{}, { "children": [0] }])).refused("scene 0: node 0 has a parent");
    Model::square().with("/scenes/0/nodes", json!([0, 0])).refused("scene 0: node 0 is listed twice");
    let chain = |length: usize| {
        nodes((0..length).map(|i| if i + 1 < length { json!({ "children": [i + 1] }) } else { json!({ "mesh": 0 }) }).collect())
    };
    chain(limits::NODE_DEPTH).scene();
    chain(limits::NODE_DEPTH + 1).refused("node 256: it lies deeper than 256 levels");
    chain(100_000).refused("it lies deeper than 256 levels");
}

#[test]
fn images_must_exist_although_nothing_looks_them_up() {
    Model::square().with("/images", json!([{}])).refused("image 0: it has neither a URI nor a bufferView");
    let mut beyond = Model::square();
    let view = beyond.push("bufferViews", json!({ "buffer": 0, "byteOffset": 10, "byteLength": 1000 }));
    beyond
        .with("/images", json!([{ "bufferView": view, "mimeType": "image/png", "name": "skin" }]))
        .refused("image \"skin\": bufferView 2 (1000 bytes from byte 10) exceeds");
}

#[test]
fn skins_must_fit_their_meshes() {
    let place = "mesh \"X\" primitive 0: ";
    skinned(0.0)
        .with("/skins/0/joints", json!([1]))
        .refused(&format!("{place}JOINTS_0: vertex 0 refers to joint 1, but the skin has 1 joints"));
    skinned(0.0).with("/skins/0/joints", json!([1, 2, 1])).refused("skin 0: inverseBindMatrices: it has 2 matrices for 3 joints");
    skinned(0.0).with("/skins/0/joints", json!(vec![1; 257])).refused("skin 0: it has 257 joints; allowed: 1 to 256");
    skinned(0.0).with("/accessors/2/type", json!("VEC4")).refused("inverseBindMatrices: must be MAT4 of FLOAT");
    skinned(0.0).with("/accessors/3/componentType", json!(5120)).refused(&format!("{place}JOINTS_0: must be VEC4"));
    skinned(0.0)
        .with("/accessors/4/count", json!(3))
        .refused(&format!("{place}WEIGHTS_0: has 3 elements, but the primitive has 4 vertices"));
    skinned(0.0).without("/meshes/0/primitives/0/attributes/WEIGHTS_0").refused("lacks JOINTS_0 or WEIGHTS_0");
    let mut flat = skinned(0.0);
    let inverse = flat.floats("MAT4", &[f32::NAN; 32]);
    flat.with("/skins/0/inverseBindMatrices", json!(inverse)).refused("skin 0: inverseBindMatrices: matrix 0 must be finite");
    let mut negative = skinned(0.0);
    let weights = negative.floats("VEC4", &[-1.0; 16]);
    negative.with("/meshes/0/primitives/0/attributes/WEIGHTS_0", json!(weights)).refused("WEIGHTS_0: vertex 0 has the weight -1");
}

fn keys(values: [f32; 2], output: &[f32]) -> Model {
    let mut model = clip("translation", "LINEAR", "VEC3", output);
    let input = model.floats("SCALAR", &values);
    model.with("/animations/0/samplers/0/input", json!(input))
}

const CHANNEL: &str = "clip \"Move\" channel 0: translation of node \"Part\": ";

#[test]
fn key_values_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY] {
        keys([1.0, 3.0], &[0.0, 0.0, 0.0, 0.0, bad, 0.0]).refused(&format!("{CHANNEL}output: keyframe 1 has the value {bad}"));
    }
    clip("rotation", "LINEAR", "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
        .refused("clip \"Move\" channel 0: rotation of node \"Part\": output: keyframe 1 is a quaternion of length 0e0");
}

#[test]
fn key_times_that_do_not_rise_are_refused() {
    keys([1.0, 1.0], &[0.0; 6]).refused(&format!("{CHANNEL}input: keyframe 1 at 1 s follows 1 s; times must increase"));
    keys([2.0, 1.0], &[0.0; 6]).refused(&format!("{CHANNEL}input: keyframe 1 at 1 s follows 2 s; times must increase"));
    keys([-1.0, 1.0], &[0.0; 6]).refused(&format!("{CHANNEL}input: keyframe 0 has the time -1 s"));
    keys([f32::NAN, 1.0], &[0.0; 6]).refused(&format!("{CHANNEL}input: keyframe 0 has the time NaN s"));
    keys([1.0, f32::INFINITY], &[0.0; 6]).refused(&format!("{CHANNEL}input: keyframe 1 has the time inf s"));
}

#[test]
fn channels_must_fit_their_nodes_and_their_keys() {
    keys([1.0, 3.0], &[0.0; 9]).refused(&format!("{CHANNEL}output: has 3 elements; its keyframes need 2"));
    clip("translation", "CUBICSPLINE", "VEC3", &[0.0; 6]).refused(&format!("{CHANNEL}output: has 2 elements; its keyframes need 6"));
    clip("translation", "LINEAR", "VEC4", &[0.0; 8])
        .refused(&format!("{CHANNEL}output: has a type that glTF does not allow for this property"));
    let good = clip("translation", "LINEAR", "VEC3", &[0.0; 6]);
    good.clone().with("/animations/0/samplers/0/input", json!(0)).refused(&format!("{CHANNEL}input: must be SCALAR of FLOAT"));
    good.clone()
        .with("/nodes/1/matrix", json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))
        .refused(&format!("{CHANNEL}the node has a matrix; only a node with translation, rotation and scale can be animated"));
    let twice = json!([{ "sampler": 0, "target": { "node": 1, "path": "translation" } }, { "sampler": 0, "target": { "node": 1, "path": "translation" } }]);
    good.clone()
        .with("/animations/0/channels", twice)
        .refused("clip \"Move\" channel 1: another channel already animates the translation of its node");
    good.with("/animations/0/channels/0/target/node", json!(7))
        .refused("clip \"Move\" channel 0: its target is node 7, which does not exist");
}

#[test]
fn morph_targets_must_fit_their_mesh() {
    let place = "mesh \"X\" primitive 0 target 0 POSITION: ";
    morphed().with("/accessors/2/count", json!(3)).refused(&format!("{place}accessor 2 has 3 elements, but the primitive has 4 vertices"));
    morphed().with("/accessors/2/componentType", json!(U32)).refused(&format!("{place}accessor 2 has the type"));
    morphed().with("/meshes/0/weights", json!([1.0])).refused("node 0: it has 1 weights for 2 morph targets");
    let mut nan = morphed();
    let bad = nan.floats("VEC3", &[f32::NAN; 12]);
    nan.with("/meshes/0/primitives/0/targets/0/POSITION", json!(bad)).refused(&format!("{place}vertex 0 has a value that is not finite"));
    let mut uneven = morphed();
    uneven.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    uneven.refused("node 0: the primitives of its mesh have 0 and 2 morph targets");
    let many = morphed().with("/meshes/0/primitives/0/targets", json!(vec![json!({ "POSITION": 2 }); limits::MORPH_TARGETS + 1]));
    many.without("/meshes/0/weights").refused("its mesh has 257 morph targets; allowed: at most 256");
}

#[test]
fn a_small_file_cannot_ask_for_much() {
    // 1,000 primitives over one accessor of 4,001 vertices.
    let mut many = Model::empty();
    let positions = many.floats("VEC3", &vec![0.0; 3 * 4_002]);
    (0..1_000).for_each(|_| many.primitive(json!({ "attributes": { "POSITION": positions } })));
    many.refused("mesh \"X\" primitive 999 POSITION: the model has 4002000 vertices or more; allowed: at most 4000000");
    let mut placed = Model::square();
    placed.json["nodes"] = vec![json!({ "mesh": 0 }); limits::INSTANCES + 1].into();
    placed.json["scenes"] = json!([{ "nodes": (0..=limits::INSTANCES).collect::<Vec<_>>() }]);
    placed.refused("node 65536: the nodes show more than 65536 primitives");
    let mut soft = morphed().with("/meshes/0/primitives/0/targets", json!(vec![json!({}); 256])).without("/meshes/0/weights");
    soft.json["nodes"] = vec![json!({ "mesh": 0 }); 15_626].into();
    soft.refused("node 15625: the nodes have 4000256 morph weights or more; allowed: at most 4000000");
    let mut jointed = skinned(0.0).without("/skins/0/inverseBindMatrices");
    jointed.json["skins"] = vec![json!({ "joints": vec![1; 256] }); 3_907].into();
    jointed.refused("the skins have 1000192 joints; allowed: at most 1000000");
    let objects = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{}{{}}]}}", "{},".repeat(limits::JSON_OBJECTS));
    let error = gltf::parse(objects.as_bytes(), &mut |_, _| unreachable!()).unwrap_err();
    assert_eq!(error.to_string(), "the JSON has 1000003 objects; allowed: at most 1000000");
}

#[test]
fn long_and_strange_names_stay_out_of_the_sentence() {
    let name = format!("line\nbreak \u{1b}[31m{}", "x".repeat(100_000));
    let error = Model::square().with("/meshes/0/name", json!(name)).with("/accessors/0/count", json!(5)).load().unwrap_err().to_string();
    assert!(error.len() < 300 && !error.contains(['\n', '\u{1b}']), "{error}");
}

// ---- hostile bytes ----

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
    let outcome = gltf::parse(bytes, &mut |_, _| Err(LoadError("no files here".into())));
    match outcome {
        Ok(scene) => {
            assert_sound(&scene);
            true
        }
        Err(error) => {
            assert!(!error.to_string().contains("is a bug"), "{about}: a panic was caught");
            false
        }
    }
}

#[test]
fn truncated_files_never_panic() {
    let good = everything().glb();
    assert!(never_panics(&good, "whole"));
    for length in 0..good.len() {
        assert!(!never_panics(&good[..length], &format!("first {length} bytes")));
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
    assert!(loaded > 100, "only {loaded} files still load: the mutations are too rough to reach far");
}

/// Numbers of the JSON replaced by awkward ones: this reaches what lies behind the parser.
#[test]
fn awkward_numbers_never_panic() {
    const AWKWARD: [&str; 12] = ["0", "1", "2", "3", "5", "-1", "255", "65536", "4294967295", "4294967296", "18446744073709551615", "1e39"];
    let model = everything();
    let text = model.json.to_string();
    let is_number =
        |i: usize| text.as_bytes()[i].is_ascii_digit() && !text.as_bytes()[i - 1].is_ascii_alphanumeric() && text.as_bytes()[i - 1] != b'_';
    let numbers: Vec<usize> = (1..text.len()).filter(|&i| is_number(i) && !b".\"".contains(&text.as_bytes()[i - 1])).collect();
    let mut loaded = 0;
    for seed in 0..6_000u32 {
        let start = numbers[hash(3 * seed) as usize % numbers.len()];
        let end = (start..text.len()).find(|&i| !b"0123456789.e-".contains(&text.as_bytes()[i])).unwrap();
        let value = AWKWARD[hash(3 * seed + 1) as usize % AWKWARD.len()];
        let json = format!("{}{value}{}", &text[..start], &text[end..]);
        loaded += u32::from(never_panics(&glb(json.as_bytes(), &model.bytes), &json));
    }
    assert!(loaded > 500, "only {loaded} files still load");
}

// ---- the corpus ----

const CORPUS: &str = "/usr/share/assimp/models";

fn models_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            models_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn corpus_loads_what_is_well_formed_and_refuses_the_rest() {
    if std::env::var_os("RASTERLAB_CORPUS").is_some_and(|value| value == "skip") {
        eprintln!("RASTERLAB_CORPUS=skip: the models of assimp-testmodels were not read");
        return;
    }
    let corpus = Path::new(CORPUS);
    assert!(corpus.is_dir(), "{CORPUS} is missing: install the Debian package assimp-testmodels, or set RASTERLAB_CORPUS=skip");
    let mut models = Vec::new();
    ["glTF", "glTF2"].iter().for_each(|folder| models_below(&corpus.join(folder), &mut models));
    assert!(models.len() > 40, "{} models", models.len());
    for path in models {
        let name = path.strip_prefix(corpus).unwrap().display().to_string();
        let expected = EXPECTED.iter().find(|(start, _)| name.starts_with(start)).map(|(_, expected)| *expected);
        match (gltf::load(&path), expected) {
            (Ok(scene), None) => {
                assert_sound(&scene);
                assert!(
                    scene.triangle_count() > 0 || name.contains("PrimitiveMode") || name.contains("cameras"),
                    "{name}: {:?}",
                    scene.notes
                );
            }
            (Ok(_), Some(sentence)) => panic!("{name} was accepted; expected: {sentence}"),
            (Err(error), Some(sentence)) => assert!(error.to_string().contains(sentence), "{name} said: {error}\nnot: {sentence}"),
            (Err(error), None) => panic!("{name} was refused: {error}"),
        }
    }
}

/// Models of the corpus that must be refused, and what the refusal says.
const EXPECTED: &[(&str, &str)] = &[
    ("glTF/BoxTextured-glTF-Binary", "GLB version 1 is not supported"),
    ("glTF/", "is not supported; export as version 2.0"),
    ("glTF2/BoxTextured-glTF-techniqueWebGL", "it requires the extension \"KHR_technique_webgl\""),
    ("glTF2/BoxWithInfinites", "attributes[\"POSITION\"].min"),
    ("glTF2/IncorrectVertexArrays", "attributes[\"POSITION\"].min"),
    ("glTF2/IndexOutOfRange/All", "mesh \"Mesh\" primitive 0 indices: corner 0 refers to vertex 65535, but there are only 24"),
    ("glTF2/IndexOutOfRange/Index", "mesh \"Mesh\" primitive 0 indices: corner 0 refers to vertex 255, but there are only 24"),
    ("glTF2/MissingBin", "buffer 0: \"BoxTextured0.bin\": cannot read the file"),
    ("glTF2/RecursiveNodes", "node 0: it is its own ancestor"),
    ("glTF2/SchemaFailures", "malformed glTF: invalid type"),
    ("glTF2/TestNoRootNode/NoScene", "scene: Index out of bounds"),
    ("glTF2/TestNoRootNode/SceneWithoutNodes", "missing field `nodes`"),
    ("glTF2/draco", "it requires the extension \"KHR_draco_mesh_compression\""),
    ("glTF2/issue_3269", "TEXCOORD_0: it is missing, although a texture of the material uses it"),
    ("glTF2/wrongTypes", "malformed glTF: invalid type"),
];
