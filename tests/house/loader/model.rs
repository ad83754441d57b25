//! A glTF model that a test writes piece by piece, and checks that every loaded scene must pass.

use image::{ImageBuffer, ImageFormat, Rgba};
use rasterlab::scene::{
    Material, Scene,
    gltf::{self, LoadError},
    texture::Texture,
};
use serde_json::{Value, json};

pub use super::sound::*;

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
        model.floats("VEC3", &SQUARE.concat());
        model.numbers("SCALAR U16 0 1 2 0 2 3");
        model.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
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
        let count = values.len() / components(kind);
        self.accessor(&le_floats(values), F32, kind, count)
    }

    /// With an animation of one channel.
    pub fn animated(self, target: Value, sampler: Value) -> Self {
        let channels = json!([{ "sampler": 0, "target": target }]);
        self.with(
            "/animations",
            json!([{ "name": "Move", "channels": channels, "samplers": [sampler] }]),
        )
    }

    /// With one value of the JSON changed or added. `P` stands for the primitive, `A` for its
    /// attributes, `M` for the material.
    pub fn with(mut self, pointer: &str, value: impl Into<Value>) -> Self {
        let (parent, key) = self.parent(pointer);
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.into(),
            _ => parent[key] = value.into(),
        }
        self
    }

    pub fn without(mut self, pointer: &str) -> Self {
        let (parent, key) = self.parent(pointer);
        parent.as_object_mut().unwrap().remove(&key).unwrap();
        self
    }

    fn parent(&mut self, pointer: &str) -> (&mut Value, String) {
        let (first, rest) = pointer.split_at(pointer.find('/').unwrap_or(pointer.len()));
        let start = match first {
            "P" => "/meshes/0/primitives/0",
            "A" => "/meshes/0/primitives/0/attributes",
            "M" => "/materials/0",
            _ => "",
        };
        let whole = format!("{start}{rest}");
        let (parent, key) = whole.rsplit_once('/').unwrap();
        let parent = self.json.pointer_mut(parent);
        (parent.unwrap_or_else(|| panic!("no {pointer}")), key.into())
    }

    /// With a list of changes, one a line: `POINTER JSON`, `- POINTER` for what is taken away,
    /// `& KIND TYPE NUMBERS` for one more accessor, where `0*12` are twelve numbers.
    pub fn set(self, changes: &str) -> Self {
        let lines = changes.lines().map(str::trim);
        lines
            .filter(|line| !line.is_empty())
            .fold(self, |mut model, line| {
                let (mark, rest) = line.split_once(' ').unwrap_or((line, ""));
                match mark {
                    "-" => model.without(rest),
                    "&" => {
                        model.numbers(rest);
                        model
                    }
                    _ => {
                        let value: Value = serde_json::from_str(rest)
                            .unwrap_or_else(|error| panic!("{line}: {error}"));
                        model.with(mark, value)
                    }
                }
            })
    }

    /// An accessor written as in [`Self::set`].
    pub fn numbers(&mut self, text: &str) -> usize {
        let mut words = text.split(' ');
        let [kind, component] = [0, 1].map(|_| words.next().expect("a kind and a type"));
        let numbers: Vec<f64> = words
            .flat_map(|word| {
                let (number, count) = word.split_once('*').unwrap_or((word, "1"));
                vec![number.parse().unwrap(); count.parse().unwrap()]
            })
            .collect();
        let write = |number: &f64| match component {
            "F32" => (*number as f32).to_le_bytes().to_vec(),
            "I8" => vec![*number as i8 as u8],
            "U8" => vec![*number as u8],
            "I16" => (*number as i16).to_le_bytes().to_vec(),
            "U16" => (*number as u16).to_le_bytes().to_vec(),
            _ => (*number as u32).to_le_bytes().to_vec(),
        };
        let bytes: Vec<u8> = numbers.iter().flat_map(write).collect();
        let types = [
            ("I8", I8),
            ("U8", U8),
            ("I16", I16),
            ("U16", U16),
            ("U32", U32),
            ("F32", F32),
        ];
        let (_, component) = types
            .into_iter()
            .find(|(name, _)| *name == component)
            .unwrap();
        self.accessor(&bytes, component, kind, numbers.len() / components(kind))
    }

    /// A transcript: changes as in [`Self::set`] up to a line that says what becomes of the model
    /// with them; then it begins anew. `~ TEXT` is a fault and the part is dropped, `? TEXT` a note,
    /// `! TEXT` a refusal, `_ TEXT` one or the other, `.` means that nothing is said, and `= TEXT` is
    /// what [`describe`] tells, or these, with `&&` between them.
    #[track_caller]
    pub fn play(&self, transcript: &str) {
        let mut changes = String::new();
        for line in transcript.lines().map(str::trim) {
            let (mark, text) = line.split_once(' ').unwrap_or((line, ""));
            if mark == "#" {
                continue;
            }
            if !["~", "?", "!", "_", ".", "="].contains(&mark) {
                changes += line;
                changes += "\n";
                continue;
            }
            let model = self.clone().set(&changes);
            changes.clear();
            match mark {
                "~" => drop(model.dropped(text)),
                "?" => model.left_out(text),
                "=" => {
                    let found = describe(&model.scene());
                    let parts = text.split(" && ");
                    parts.for_each(|part| {
                        assert!(found.contains(part), "{part}\nis not in {found}")
                    });
                }
                "!" => model.refused(text),
                "_" => model.without_it(text),
                _ => drop(model.silent()),
            }
        }
        assert!(
            changes.trim().is_empty(),
            "nothing is expected of {changes}"
        );
    }

    pub fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.bytes)
    }

    pub fn load(&self) -> Result<Scene, LoadError> {
        load(&self.glb())
    }

    pub fn scene(&self) -> Scene {
        let scene = self
            .load()
            .unwrap_or_else(|error| panic!("{error}\n{}", self.json));
        assert_sound(&scene);
        scene
    }

    /// It loads without a note.
    #[track_caller]
    pub fn silent(&self) -> Scene {
        let scene = self.scene();
        assert_eq!(scene.notes, [""; 0]);
        scene
    }

    /// The scene without a part: it loads, and one fault names the part.
    #[track_caller]
    pub fn dropped(&self, sentence: &str) -> Scene {
        let scene = self.scene();
        let faults = &scene.faults;
        let count = faults
            .iter()
            .filter(|fault| fault.contains(sentence))
            .count();
        assert_eq!(count, 1, "said: {faults:?}\nnot:  {sentence}");
        assert!(scene.triangle_count() > 0, "{sentence}");
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
        let said = self
            .load()
            .map_or_else(|error| vec![error.to_string()], |scene| scene.faults);
        assert!(
            said.iter().any(|said| said.contains(sentence)),
            "said: {said:?}\nnot:  {sentence}"
        );
    }

    /// As [`Self::dropped`], whether that breaks the standard or not.
    #[track_caller]
    pub fn left_out(&self, sentence: &str) {
        let scene = self.scene();
        assert_noted(&scene, sentence);
        assert!(scene.triangle_count() > 0, "{sentence}");
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
        let mut model = Self::empty();
        model.floats("VEC3", &SQUARE.concat());
        let mut model = model.set(
            r#"
            & VEC2 F32 0 0 1 0 1 1 0 1
            & SCALAR U16 0 1 2 0 2 3
            /meshes/0/primitives [{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]
            /materials [{"name":"paper","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}]
            /textures [{"source":0,"sampler":0}]
            /samplers [{}]
            /images [{"name":"flag","bufferView":3,"mimeType":"image/png"}]
            "#,
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

/// What a model has: numbers of its parts, its bounds, and the material of its first primitive.
fn describe(scene: &Scene) -> String {
    let [triangles, instances] = [scene.triangle_count(), scene.instances.len() as u64];
    let [primitives, images] = [scene.primitives.len(), scene.images.len()];
    let material = scene
        .primitives
        .first()
        .map(|primitive| &scene.materials[primitive.material]);
    format!(
        "{triangles} triangles, {instances} instances, {primitives} primitives, {images} images, {:?}, {material:?}",
        scene.bounds()
    )
}

/// A sparse part of an accessor: indices of bytes and values from these views.
pub fn sparse(count: usize, indices: usize, values: usize) -> Value {
    json!({ "count": count, "indices": { "bufferView": indices, "componentType": U8 }, "values": { "bufferView": values } })
}

#[track_caller]
pub fn assert_noted(scene: &Scene, sentence: &str) {
    let notes = &scene.notes;
    assert!(
        notes.iter().any(|note| note.contains(sentence)),
        "said: {notes:?}\nnot:  {sentence}"
    );
}

/// Loads bytes that ask for no other file.
pub fn load(bytes: &[u8]) -> Result<Scene, LoadError> {
    gltf::load(bytes, &mut |path, _| {
        panic!("{} was asked for", path.display())
    })
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
