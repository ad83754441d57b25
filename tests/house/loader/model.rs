//! A glTF model that a test writes piece by piece, and checks that every loaded scene must pass.

use glam::DVec3;
use image::{ImageBuffer, ImageFormat, Rgba};
use rasterlab::scene::{
    Material, Scene,
    gltf::{self, LoadError},
    pose::{Motion, Pose},
    texture::Texture,
};
use serde_json::{Value, json};

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A model being written: JSON, and the bytes of its one buffer.
#[derive(Clone)]
pub struct Model {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Model {
    pub fn empty() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
            "meshes": [{ "name": "X", "primitives": [] }], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        });
        Self {
            json,
            bytes: Vec::new(),
        }
    }

    /// Mesh "X" with one primitive: accessor 0 holds four positions, accessor 1 u16 indices 0 1 2 0
    /// 2 3.
    pub fn square() -> Self {
        let mut model = Self::empty();
        let positions = model.floats("VEC3", &SQUARE.concat());
        let indices = model.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
        model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
        model
    }

    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json.get(list).is_none() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn primitive(&mut self, value: Value) {
        self.json["meshes"][0]["primitives"]
            .as_array_mut()
            .unwrap()
            .push(value);
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bytes.len());
        self.push(
            "bufferViews",
            json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }),
        )
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let mut accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        if kind == "VEC3" {
            // The standard wants them with positions.
            (accessor["min"], accessor["max"]) = (json!([0, 0, 0]), json!([1, 1, 1]));
        }
        self.push("accessors", accessor)
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        self.accessor(
            &le_floats(values),
            F32,
            kind,
            values.len() / components(kind),
        )
    }

    pub fn shorts(&mut self, kind: &str, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, U16, kind, values.len() / components(kind))
    }

    /// With one value of the JSON changed or added.
    pub fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = self
            .json
            .pointer_mut(parent)
            .unwrap_or_else(|| panic!("no {parent}"));
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            _ => parent[key] = value,
        }
        self
    }

    pub fn without(mut self, pointer: &str) -> Self {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        self.json
            .pointer_mut(parent)
            .unwrap()
            .as_object_mut()
            .unwrap()
            .remove(key)
            .unwrap();
        self
    }

    pub fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.bytes)
    }

    pub fn load(&self) -> Result<Scene, LoadError> {
        gltf::load(&self.glb(), &mut |path, _| {
            panic!("{} was asked for", path.display())
        })
    }

    pub fn scene(&self) -> Scene {
        let scene = self
            .load()
            .unwrap_or_else(|error| panic!("{error}\n{}", self.json));
        assert_sound(&scene);
        scene
    }

    /// The scene without a part: it loads, and one fault names the part.
    #[track_caller]
    pub fn dropped(&self, sentence: &str) -> Scene {
        let scene = self.scene();
        let faults = &scene.faults;
        assert!(
            faults
                .iter()
                .filter(|fault| fault.contains(sentence))
                .count()
                == 1
                && scene.triangle_count() > 0,
            "{} triangles, and said: {faults:?}\nnot:  {sentence}",
            scene.triangle_count()
        );
        assert!(
            faults
                .iter()
                .all(|fault| scene.notes.contains(fault) && !fault.contains('\n'))
        );
        scene
    }

    /// It loads and says so, or is refused with the sentence where nothing else is left.
    #[track_caller]
    pub fn without_it(&self, sentence: &str) {
        let said = match self.load() {
            Ok(scene) => scene.faults,
            Err(error) => vec![error.to_string()],
        };
        assert!(
            said.iter().any(|said| said.contains(sentence)),
            "said: {said:?}\nnot:  {sentence}"
        );
    }

    /// As [`Self::dropped`], whether that breaks the standard or not.
    #[track_caller]
    pub fn left_out(&self, sentence: &str) {
        let scene = self.scene();
        assert!(
            scene.notes.iter().any(|note| note.contains(sentence)) && scene.triangle_count() > 0,
            "said: {:?}\nnot:  {sentence}",
            scene.notes
        );
    }

    #[track_caller]
    pub fn refused(&self, sentence: &str) {
        let error = self.load().expect_err(sentence).to_string();
        assert!(error.contains(sentence), "said: {error}\nnot:  {sentence}");
        assert!(!error.contains('\n'), "{error}");
    }

    /// A square whose material "paper" shows the PNG "flag": accessor 0 holds positions, 1 texture
    /// coordinates, 2 indices; buffer view 3 holds the image.
    pub fn textured() -> Self {
        let mut model = Self {
            json: json!({
                "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
                "meshes": [{ "name": "X", "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
                "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
                "materials": [{ "name": "paper", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
                "textures": [{ "source": 0, "sampler": 0 }], "samplers": [{}],
                "images": [{ "name": "flag", "bufferView": 3, "mimeType": "image/png" }],
            }),
            bytes: Vec::new(),
        };
        let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
        let positions = model.accessor(&le_floats(&square), F32, "VEC3", 4);
        (
            model.json["accessors"][positions]["min"],
            model.json["accessors"][positions]["max"],
        ) = (json!([0, 0, 0]), json!([1, 1, 0]));
        model.accessor(
            &le_floats(&[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]),
            F32,
            "VEC2",
            4,
        );
        model.accessor(
            &le([0u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes)),
            U16,
            "SCALAR",
            6,
        );
        assert_eq!(model.view(&encoded(ImageFormat::Png)), 3);
        model
    }

    /// With another image.
    pub fn showing(mut self, bytes: &[u8]) -> Self {
        let view = self.view(bytes);
        self.with("/images/0/bufferView", json!(view))
    }

    pub fn material(&self) -> Material {
        let scene = self.scene();
        scene.materials[scene.primitives[0].material].clone()
    }

    pub fn texture(&self) -> Texture {
        self.material().base_texture.expect("a texture")
    }
}

pub const SQUARE: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

fn components(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => panic!("{kind}"),
    }
}

pub fn le_floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
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

pub fn le<const N: usize>(values: impl IntoIterator<Item = [u8; N]>) -> Vec<u8> {
    values.into_iter().flatten().collect()
}

/// 2 x 1 texels, red and translucent green.
pub fn encoded(format: ImageFormat) -> Vec<u8> {
    let picture = ImageBuffer::<Rgba<u8>, _>::from_raw(2, 1, vec![255, 0, 0, 255, 0, 200, 0, 100])
        .expect("eight bytes");
    let mut bytes = std::io::Cursor::new(Vec::new());
    match format {
        ImageFormat::Png | ImageFormat::WebP => {
            picture.write_to(&mut bytes, format).expect("it is encoded")
        }
        _ => image::DynamicImage::from(picture)
            .into_rgb8()
            .write_to(&mut bytes, format)
            .expect("it is encoded"),
    }
    bytes.into_inner()
}

/// Corners of every triangle in world space, in drawing order.
pub fn triangles(scene: &Scene) -> Vec<[[f64; 3]; 3]> {
    let mut triangles = Vec::new();
    for instance in &scene.instances {
        let primitive = &scene.primitives[instance.primitive];
        for t in 0..primitive.triangle_count() {
            let corner = |vertex| {
                instance
                    .world_from_object
                    .transform_point3(primitive.position(scene, vertex).map(f64::from).into())
            };
            triangles.push(
                primitive
                    .corners(scene, t)
                    .map(|vertex| corner(vertex).to_array()),
            );
        }
    }
    triangles
}

/// The square's two triangles, for comparison.
pub fn square() -> Vec<[[f64; 3]; 3]> {
    [[0, 1, 2], [0, 2, 3]]
        .map(|t| t.map(|c: usize| SQUARE[c].map(f64::from)))
        .into()
}

/// Everything that later stages take for granted: each accessor can be read to its end, and every
/// pose is finite.
pub fn assert_sound(scene: &Scene) {
    if !scene.rig.is_empty() {
        let clips = (0..scene.rig.clips.len()).map(Some).chain([None]);
        for (clip, time_s) in
            clips.flat_map(|clip| [0.0, 0.7, 1e9, -3.5].map(|time_s| (clip, time_s)))
        {
            let pose = Pose::at(
                scene,
                &Motion {
                    clip,
                    time_s,
                    ..Motion::default()
                },
            );
            assert!((0..scene.instances.len()).all(|i| {
                !pose.instance_transform(i).is_nan()
                    && pose
                        .deform(i)
                        .is_none_or(|b| b.weights.iter().all(|w| w.is_finite()))
            }));
        }
        assert!(
            scene
                .rig
                .nodes
                .iter()
                .enumerate()
                .all(|(i, node)| node.parent.is_none_or(|parent| parent < i))
        );
    }
    assert!(
        scene.vertex_bytes.len().is_multiple_of(4) && scene.index_bytes.len().is_multiple_of(4)
    );
    assert!(
        scene
            .instances
            .iter()
            .all(|i| i.primitive < scene.primitives.len() && i.world_from_object.is_finite())
    );
    for primitive in &scene.primitives {
        assert!(primitive.material < scene.materials.len());
        let deformation = &primitive.deformation;
        let shapes = deformation
            .morph_targets
            .iter()
            .flat_map(|shape| [shape.positions, shape.normals]);
        let held = deformation
            .influences
            .iter()
            .flat_map(|set| [Some(set.joints), Some(set.weights)]);
        let attributes = [
            Some(primitive.positions),
            Some(primitive.normals),
            primitive.colors,
        ];
        for accessor in attributes.into_iter().chain(shapes).chain(held).flatten() {
            assert_eq!(accessor.count, primitive.vertex_count());
            assert!(
                accessor.offset % accessor.component_type.bytes() == 0
                    && accessor.stride % accessor.component_type.bytes() == 0
            );
            for vertex in 0..accessor.count {
                assert!((0..accessor.components).all(|component| {
                    accessor
                        .value(&scene.vertex_bytes, vertex, component)
                        .is_finite()
                }));
            }
        }
        for vertex in 0..primitive.vertex_count() {
            let p = DVec3::from(primitive.position(scene, vertex).map(f64::from));
            assert!(p.cmpge(primitive.bounds.min).all() && p.cmple(primitive.bounds.max).all());
        }
        for t in 0..primitive.triangle_count() {
            let corners = primitive.corners(scene, t);
            assert!(corners.iter().all(|&c| c < primitive.vertex_count()));
            let [a, b, c] =
                corners.map(|c| DVec3::from(primitive.position(scene, c).map(f64::from)));
            assert!(
                a.distance(b).max(b.distance(c)).max(c.distance(a))
                    <= primitive.longest_edge * (1.0 + 1e-12)
            );
        }
    }
}

/// Corners of every triangle as a moment of a clip places and bends them.
pub fn posed(scene: &Scene, clip: Option<usize>, time_s: f64) -> Vec<[[f64; 3]; 3]> {
    let pose = Pose::at(
        scene,
        &Motion {
            clip,
            time_s,
            ..Motion::default()
        },
    );
    let mut triangles = Vec::new();
    for (index, instance) in scene.instances.iter().enumerate() {
        let primitive = &scene.primitives[instance.primitive];
        let corner = |vertex| {
            let object = match pose.deform(index) {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => primitive.position(scene, vertex).map(f64::from).into(),
            };
            pose.instance_transform(index)
                .transform_point3(object)
                .to_array()
        };
        triangles.extend(
            (0..primitive.triangle_count()).map(|t| primitive.corners(scene, t).map(corner)),
        );
    }
    triangles
}
