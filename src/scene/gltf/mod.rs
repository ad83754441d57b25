//! glTF 2.0 loader for untrusted files.
//!
//! The crate `gltf` parses and validates the JSON. Everything else (URIs, buffers, accessors, the node tree) is checked here
//! in 64-bit arithmetic and against [`limits`] before a byte is read. Attribute bytes are copied as they are. Every error is
//! one sentence that names the file, the mesh, the primitive and the accessor.
//!
//! Supported: triangle lists, strips and fans, all index widths, interleaved, sparse and quantized accessors, base colour and
//! emission with their textures, vertex colours, the nodes and cameras of the default scene, skins, morph targets and clips.
//! Skipped with an entry in [`Scene::notes`]: points, lines, normal maps and the rest of physically based shading.

mod buffers;
mod clips;
mod container;
mod materials;
mod meshes;
mod nodes;
mod skin;
mod soft;
mod uri;

use std::{
    fmt::Display,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use super::Scene;

/// Upper limits of everything that a file can demand.
pub mod limits {
    const MIB: u64 = 1 << 20;
    /// Size of the model file, and of each file that it refers to.
    pub const FILE_BYTES: u64 = 256 * MIB;
    /// Total size of all files of a model.
    pub const TOTAL_BYTES: u64 = 512 * MIB;
    pub const JSON_BYTES: u64 = 64 * MIB;
    /// JSON objects; each may need hundreds of bytes once parsed.
    pub const JSON_OBJECTS: usize = 1_000_000;
    /// Size of the largest storage binding that every adapter supports.
    pub const BINDING_BYTES: u64 = 128 * MIB;
    /// Vertices of all primitives, each counted once however often it is instanced.
    pub const VERTICES: u64 = 4_000_000;
    /// Triangles of all primitives, each counted once however often it is instanced.
    pub const TRIANGLES: u64 = 10_000_000;
    /// Instances of primitives.
    pub const INSTANCES: usize = 65_536;
    /// Nodes from a root to a leaf.
    pub const NODE_DEPTH: usize = 256;
    /// Joints of a skin.
    pub const JOINTS: usize = 256;
    /// Joints of all skins.
    pub const ALL_JOINTS: usize = 1_000_000;
    /// Morph targets of a mesh.
    pub const SHAPES: usize = 256;
    /// Morph weights of all nodes.
    pub const WEIGHTS: usize = 4_000_000;
    /// Channels of all clips.
    pub const CHANNELS: usize = 262_144;
    /// Key times and values of all clips.
    pub const KEY_NUMBERS: usize = 16_000_000;
    /// Width and height of an image in texels.
    pub const IMAGE_SIDE: u32 = 8192;
    /// Decoded size of all images, without mip levels.
    pub const IMAGES_BYTES: u64 = 512 * MIB;
    /// Messages to the user.
    pub const NOTES: usize = 32;
}

/// Why a model cannot be loaded; one sentence.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(pub String);

impl LoadError {
    fn new(reason: impl Display) -> Self {
        Self(reason.to_string())
    }

    /// Prepends the place of the error.
    fn within(self, place: impl Display) -> Self {
        Self(format!("{place}: {}", self.0))
    }
}

/// Reads a file next to the model, given its relative path and the largest size in bytes.
pub type ReadFile<'a> = dyn FnMut(&Path, u64) -> Result<Vec<u8>, LoadError> + 'a;

/// Loads a `.gltf` or `.glb` file. Only files in its folder and below are read.
///
/// # Errors
/// If a file cannot be read, is malformed, or exceeds [`limits`]; the sentence begins with the file name.
pub fn load(path: &Path) -> Result<Scene, LoadError> {
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let open = || {
        let bytes = container::read_regular(path, limits::FILE_BYTES)?;
        parse(&bytes, &mut |beside, most| container::read_beside(path, beside, most))
    };
    match open() {
        Ok(scene) => Ok(Scene { name, ..scene }),
        Err(error) => Err(error.within(file)),
    }
}

/// Loads a model from memory. `read` supplies the files that it refers to, by relative paths without `..`.
///
/// # Errors
/// If the model is malformed, exceeds [`limits`], or `read` fails.
pub fn parse(bytes: &[u8], read: &mut ReadFile) -> Result<Scene, LoadError> {
    // A panic in the validation of the crate `gltf` must not close the window.
    catch_unwind(AssertUnwindSafe(|| meshes::scene(bytes, read)))
        .unwrap_or_else(|_| Err(LoadError::new("the loader failed on this file, which is a bug: please report it")))
}

/// A name from a file, made safe for messages: quoted, escaped and at most 60 characters.
fn quoted(name: &str) -> String {
    let short: String = name.chars().take(60).collect();
    if short.len() < name.len() { format!("{:?}", short + "…") } else { format!("{short:?}") }
}

/// `kind "name"`, or `kind 3` if it has no name.
fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {}", quoted(name)),
        _ => format!("{kind} {index}"),
    }
}
