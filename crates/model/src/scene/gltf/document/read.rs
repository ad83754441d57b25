//! Reads a document: first version and required extensions, then part by part.

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{
    super::{
        compression::{DRACO, MESHOPT},
        container,
        error::{LoadError, called, quoted},
        instancing::INSTANCING,
        limits,
        materials::EXTENSIONS,
        notes::Notes,
    },
    Document, Part,
    element::{Element, Object, wrong},
    lights, materials, motion, shapes,
    variants::{self, VARIANTS},
};

/// Extension of textures whose image is a WebP.
pub const WEBP: &str = "EXT_texture_webp";

/// Extension that allows small integers as attributes. Every attribute is read by its component
/// type anyway.
pub const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Extension of lights without a size.
pub const LIGHTS: &str = "KHR_lights_punctual";

/// Extension that hides nodes with all that is below them.
pub const VISIBILITY: &str = "KHR_node_visibility";

/// Extensions that are read, besides those of materials.
pub const READ: [&str; 8] = [
    QUANTIZATION,
    WEBP,
    MESHOPT,
    DRACO,
    INSTANCING,
    VARIANTS,
    LIGHTS,
    VISIBILITY,
];

/// Is the extension read?
pub fn is_read(extension: &str) -> bool {
    READ.contains(&extension) || EXTENSIONS.contains(&extension)
}

/// The lists at the top of a document, and where messages go.
pub struct Lists<'a> {
    pub notes: &'a Notes,
    pub accessors: &'a [Value],
    pub views: &'a [Value],
    pub buffers: &'a [Value],
    pub images: &'a [Value],
    pub samplers: &'a [Value],
    pub textures: &'a [Value],
    pub materials: &'a [Value],
    pub meshes: &'a [Value],
    pub nodes: &'a [Value],
    pub skins: &'a [Value],
    pub cameras: &'a [Value],
    pub variants: &'a [Value],
    pub lights: &'a [Value],
}

impl<'a> Lists<'a> {
    /// The object at a place of a list, with the name that messages call it by; none where it is
    /// something else, which is told.
    pub fn element(&self, kind: &str, index: usize, value: &'a Value) -> Option<Element<'a>> {
        let name = called(kind, index, value.get("name").and_then(Value::as_str));
        match Element::of(self.notes, name.clone(), value) {
            Ok(element) => Some(element),
            Err(reason) => {
                self.notes
                    .fault(|| format!("{name}: {reason}; it is left out"));
                None
            }
        }
    }

    /// An object that messages call by what it is part of.
    pub fn nameless<'b>(&'b self, value: &'b Value) -> Part<Element<'b>> {
        Element::of(self.notes, String::new(), value)
    }

    /// A part of which every field may be left out.
    pub fn read<T: DeserializeOwned>(&self, part: &mut Element) -> Option<T> {
        let read = part.read(&[]);
        part.lenient(read)
    }

    pub fn accessors(&self) -> (&'static str, usize) {
        ("accessors", self.accessors.len())
    }

    /// Fails if a field is an index beyond a list.
    pub fn check(&self, of: &Object, key: &str, parts: (&str, usize)) -> Result<(), String> {
        Element::check_index(of, key, parts)
    }
}

/// Reads the JSON.
///
/// # Errors
/// It is no JSON or no glTF 2, exceeds [`limits`], or requires a compression that is not read.
pub fn parse_document(json: &[u8], notes: &Notes) -> Result<Document, LoadError> {
    check_size(json)?;
    let text = container::text(json, notes);
    let none =
        |error: &dyn std::fmt::Display| LoadError::new(format!("it is not a glTF file: {error}"));
    if !text.trim_start().starts_with('{') {
        return Err(none(
            &"it begins neither with \"glTF\" nor with the { of JSON; fetch or export it again",
        ));
    }
    let broken = |error| none(&format_args!("its JSON cannot be read: {error}"));
    let value: Value = serde_json::from_str(&text).map_err(broken)?;
    let Value::Object(mut root) = value else {
        return Err(none(&"its JSON is no object"));
    };
    check_version(&root, notes)?;
    let fault = |reason: String| notes.fault(|| format!("the file: {reason}; it is left out"));
    let take_list = |object: &mut Object, key: &str| match object.remove(key) {
        Some(Value::Array(list)) => list,
        None | Some(Value::Null) => Vec::new(),
        Some(other) => {
            fault(wrong(key, &other, "a list"));
            Vec::new()
        }
    };
    let mut names = |key: &str| -> Vec<String> {
        let name = |value| match value {
            Value::String(name) => Some(name),
            _ => {
                fault(format!("its {key} list what is no text"));
                None
            }
        };
        let list = take_list(&mut root, key);
        list.into_iter().filter_map(name).collect()
    };
    let (extensions_used, extensions_required) =
        (names("extensionsUsed"), names("extensionsRequired"));
    check_required(&extensions_required, notes)?;
    let take_object = |object: &mut Object, key: &str| match object.remove(key) {
        Some(Value::Object(object)) => object,
        None | Some(Value::Null) => Object::new(),
        Some(other) => {
            fault(wrong(key, &other, "an object"));
            Object::new()
        }
    };
    let mut extensions = take_object(&mut root, "extensions");
    let (mut variants, mut lights) = (
        take_object(&mut extensions, VARIANTS),
        take_object(&mut extensions, LIGHTS),
    );
    let mut list = |key: &str| take_list(&mut root, key);
    let [animations, scenes] = ["animations", "scenes"].map(&mut list);
    let [accessors, views, buffers, images] =
        ["accessors", "bufferViews", "buffers", "images"].map(&mut list);
    let [samplers, textures, materials, meshes] =
        ["samplers", "textures", "materials", "meshes"].map(&mut list);
    let [nodes, skins, cameras] = ["nodes", "skins", "cameras"].map(&mut list);
    let (variants, lights) = (
        take_list(&mut variants, "variants"),
        take_list(&mut lights, "lights"),
    );
    let lists = Lists {
        notes,
        accessors: &accessors,
        views: &views,
        buffers: &buffers,
        images: &images,
        samplers: &samplers,
        textures: &textures,
        materials: &materials,
        meshes: &meshes,
        nodes: &nodes,
        skins: &skins,
        cameras: &cameras,
        variants: &variants,
        lights: &lights,
    };
    Ok(Document {
        accessors: parts(&lists, "accessor", lists.accessors, shapes::accessor),
        views: parts(&lists, "bufferView", lists.views, shapes::view),
        buffers: parts(&lists, "buffer", lists.buffers, shapes::buffer),
        images: parts(&lists, "image", lists.images, materials::image),
        textures: parts(&lists, "texture", lists.textures, materials::texture),
        materials: each(&lists, lists.materials, materials::material),
        meshes: each(&lists, lists.meshes, shapes::mesh),
        nodes: each(&lists, lists.nodes, shapes::node),
        skins: parts(&lists, "skin", lists.skins, motion::skin),
        cameras: parts(&lists, "camera", lists.cameras, |_, part| {
            shapes::camera(part)
        }),
        lights: parts(&lists, "light", lists.lights, |_, part| lights::light(part)),
        clips: each(&lists, &animations, motion::clip),
        scene: shapes::scene(&lists, root.get("scene"), &scenes),
        variants: variants::names(lists.variants),
        extensions_used,
        extensions_required,
    })
}

fn parts<'a, T>(
    lists: &Lists<'a>,
    kind: &str,
    list: &'a [Value],
    read: impl Fn(&Lists<'a>, Element<'a>) -> Part<T>,
) -> Vec<Part<T>> {
    each(lists, list, |lists, index, value| {
        let name = called(kind, index, value.get("name").and_then(Value::as_str));
        read(lists, Element::of(lists.notes, name, value)?)
    })
}

fn each<'a, T>(
    lists: &Lists<'a>,
    list: &'a [Value],
    read: impl Fn(&Lists<'a>, usize, &'a Value) -> T,
) -> Vec<T> {
    list.iter()
        .enumerate()
        .map(|(index, value)| read(lists, index, value))
        .collect()
}

fn check_size(json: &[u8]) -> Result<(), LoadError> {
    let count = |wanted: u8| json.iter().filter(|&&byte| byte == wanted).count();
    let exceeded = |what: &str, count: usize, most: usize| {
        Err(LoadError::end(format!(
            "the JSON has {count} {what}; allowed: at most {most}"
        )))
    };
    match (json.len(), count(b'{'), count(b',')) {
        (bytes, ..) if bytes as u64 > limits::JSON_BYTES => {
            exceeded("bytes", bytes, limits::JSON_BYTES as usize)
        }
        (_, objects, _) if objects > limits::JSON_OBJECTS => {
            exceeded("objects", objects, limits::JSON_OBJECTS)
        }
        (.., values) if values > limits::JSON_VALUES => {
            exceeded("values", values, limits::JSON_VALUES)
        }
        _ => Ok(()),
    }
}

/// Checks `asset.version` and `asset.minVersion`.
fn check_version(root: &Object, notes: &Notes) -> Result<(), LoadError> {
    let none = |reason: &str| Err(LoadError::new(format!("it is not a glTF file: {reason}")));
    let asset = match root.get("asset") {
        Some(Value::Object(asset)) => asset,
        None | Some(Value::Null) => return none("its JSON has no asset"),
        Some(other) => return none(&wrong("asset", other, "an object")),
    };
    let text = |key: &str| match asset.get(key)? {
        Value::Null => None,
        Value::String(text) => Some(text.clone()),
        other => {
            notes.fault(|| format!("the {key} of its asset is not a text; it is read as one"));
            Some(other.to_string())
        }
    };
    let number = |version: &str| -> Option<(u32, u32)> {
        let (major, minor) = version.split_once('.').unwrap_or((version, "0"));
        Some((major.trim().parse().ok()?, minor.trim().parse().ok()?))
    };
    match text("version") {
        None => notes.fault(|| "its asset has no version; it is read as glTF 2.0"),
        Some(version) => match number(&version) {
            Some((2, _)) => {}
            _ => {
                return Err(LoadError::new(format!(
                    "glTF version {} is not supported; export as version 2.0",
                    quoted(&version)
                )));
            }
        },
    }
    match text("minVersion").map(|least| (number(&least), least)) {
        Some((Some(least), shown)) if least > (2, 0) => Err(LoadError::new(format!(
            "it needs a reader of glTF {}, by its minVersion, and this one reads 2.0; export as \
             version 2.0",
            quoted(&shown)
        ))),
        Some((None, shown)) => {
            notes.fault(|| format!("its minVersion {} is no version", quoted(&shown)));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Is it an extension, of its name, without which data cannot be unpacked?
pub fn is_unknown_compression(extension: &str) -> bool {
    let name = extension.to_lowercase();
    !is_read(extension)
        && ["compress", "draco", "meshopt", "codec"]
            .iter()
            .any(|part| name.contains(part))
}

/// Refuses required compressions that are not read; of other extensions that are not, the shape is
/// drawn.
fn check_required(required: &[String], notes: &Notes) -> Result<(), LoadError> {
    if let Some(name) = required.iter().find(|name| is_unknown_compression(name)) {
        let remedy = match name.as_str() {
            "KHR_meshopt_compression" => {
                "export the model with EXT_meshopt_compression, or without compression"
            }
            _ => "export the model without compression",
        };
        return Err(LoadError::new(format!(
            "it requires the extension {}, which is not supported; {remedy}",
            quoted(name)
        )));
    }
    let unread = required.iter().filter(|name| !is_read(name));
    notes.extend(unread.map(|name| {
        format!(
            "it requires the extension {}, which is not supported; what does not need it is drawn",
            quoted(name)
        )
    }));
    Ok(())
}
