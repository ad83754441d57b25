//! Reads a document: first version and required extensions, then part by part.

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
    fields::{Lenient, Object},
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

/// Extensions that are read, besides those of materials.
pub const READ: [&str; 7] = [
    QUANTIZATION,
    WEBP,
    MESHOPT,
    DRACO,
    INSTANCING,
    VARIANTS,
    LIGHTS,
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
    /// A part, by its place in a list, with the name that messages call it by. What is no object
    /// is told, and read as none.
    pub fn lenient(&self, kind: &str, index: usize, part: Object<'a>) -> Lenient<'a> {
        let name = part.text("name");
        let lenient = Lenient {
            notes: self.notes,
            name: called(kind, index, name.clone().ok().flatten()),
        };
        lenient.field(name);
        lenient
    }

    /// The object at a place of a list; none where it is something else, which is told.
    pub fn object(&self, kind: &str, index: usize, value: &'a Value) -> Option<Object<'a>> {
        let lenient = Lenient {
            notes: self.notes,
            name: called(kind, index, None),
        };
        lenient.field(Object::of(value).map(Some))
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
    let value: Value = serde_json::from_str(&text).map_err(|error| none(&error))?;
    let root = Object::of(&value).map_err(|error| none(&error))?;
    check_version(root, notes)?;
    let lenient = Lenient {
        notes,
        name: "the file".into(),
    };
    let names = |key: &str| -> Vec<String> {
        let list = lenient.list(root.list(key));
        let name = |value: &Value| match value.as_str() {
            Some(name) => Some(name.to_owned()),
            None => {
                lenient.fault(format_args!("its {key} list what is no text"));
                None
            }
        };
        list.iter().filter_map(name).collect()
    };
    let (extensions_used, extensions_required) =
        (names("extensionsUsed"), names("extensionsRequired"));
    check_required(&extensions_required, notes)?;
    let list = |key: &str| lenient.list(root.list(key));
    let lists = Lists {
        notes,
        accessors: list("accessors"),
        views: list("bufferViews"),
        buffers: list("buffers"),
        images: list("images"),
        samplers: list("samplers"),
        textures: list("textures"),
        materials: list("materials"),
        meshes: list("meshes"),
        nodes: list("nodes"),
        skins: list("skins"),
        cameras: list("cameras"),
        variants: variants::listed(&lenient, root),
        lights: match lenient.field(root.extension(LIGHTS)) {
            Some(extension) => lenient.list(extension.list("lights")),
            None => &[],
        },
    };
    let document = Document {
        accessors: parts(lists.accessors, |index, part| {
            shapes::accessor(&lists, index, part)
        }),
        views: parts(lists.views, |_, part| shapes::view(&lists, part)),
        buffers: parts(lists.buffers, |index, part| {
            shapes::buffer(&lists, index, part)
        }),
        images: parts(lists.images, |index, part| {
            materials::image(&lists, index, part)
        }),
        textures: parts(lists.textures, |index, part| {
            materials::texture(&lists, index, part)
        }),
        materials: each(lists.materials, |index, value| {
            materials::material(&lists, index, value)
        }),
        meshes: each(lists.meshes, |index, value| {
            shapes::mesh(&lists, index, value)
        }),
        nodes: each(lists.nodes, |index, value| {
            shapes::node(&lists, index, value)
        }),
        skins: parts(lists.skins, |_, part| motion::skin(&lists, part)),
        cameras: parts(lists.cameras, |_, part| shapes::camera(part)),
        lights: parts(lists.lights, |_, part| lights::light(part)),
        clips: each(list("animations"), |index, value| {
            motion::clip(&lists, index, value)
        }),
        scene: shapes::scene(&lists, root, list("scenes")),
        variants: variants::names(lists.variants),
        extensions_used,
        extensions_required,
    };
    Ok(document)
}

fn parts<T>(list: &[Value], read: impl Fn(usize, Object) -> Part<T>) -> Vec<Part<T>> {
    each(list, |index, value| {
        Object::of(value).and_then(|part| read(index, part))
    })
}

fn each<'a, T>(list: &'a [Value], read: impl Fn(usize, &'a Value) -> T) -> Vec<T> {
    list.iter()
        .enumerate()
        .map(|(index, value)| read(index, value))
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
fn check_version(root: Object, notes: &Notes) -> Result<(), LoadError> {
    let asset = match root.object("asset") {
        Ok(Some(asset)) => asset,
        Ok(None) => {
            return Err(LoadError::new(
                "it is not a glTF file: its JSON has no asset",
            ));
        }
        Err(reason) => {
            return Err(LoadError::new(format!("it is not a glTF file: {reason}")));
        }
    };
    let text = |key: &str| match asset.value(key)? {
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
