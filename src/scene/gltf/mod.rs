//! glTF 2.0: models from files that nobody vouches for.
//!
//! The crate `gltf` parses and validates the JSON; everything after that (URIs, buffers, accessors, the node tree) is
//! checked here, in 64-bit arithmetic and under the limits of [`limits`], before a byte is read. Attribute bytes are then
//! taken over as they are. Every refusal is one sentence that names file, mesh, primitive and accessor.
//!
//! Read: triangle lists, strips and fans, any index width, interleaved, sparse and quantized accessors, base colour and
//! emission with their textures, vertex colours, the default scene's nodes and cameras, skins, morph targets and clips. Named
//! in [`Scene::notes`] and left out: points, lines, normal maps and what else physically based shading asks for.

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

/// Everything that a file may ask for, in one table.
pub mod limits {
    const MIB: u64 = 1 << 20;
    /// Size of the model file, and of each file that it names.
    pub const FILE_BYTES: u64 = 256 * MIB;
    /// All files of a model together.
    pub const TOTAL_BYTES: u64 = 512 * MIB;
    pub const JSON_BYTES: u64 = 64 * MIB;
    /// JSON objects: each may cost hundreds of bytes once parsed.
    pub const JSON_OBJECTS: usize = 1_000_000;
    /// One portable storage binding.
    pub const BINDING_BYTES: u64 = 128 * MIB;
    /// Of all primitives together, before instancing.
    pub const VERTICES: u64 = 4_000_000;
    /// Of all primitives together, before instancing.
    pub const TRIANGLES: u64 = 10_000_000;
    /// Placements of primitives.
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
    /// Texels across and down an image.
    pub const IMAGE_SIDE: u32 = 8192;
    /// All images once they are decoded, before smaller copies are made of them.
    pub const IMAGES_BYTES: u64 = 512 * MIB;
    /// Notes kept for the user.
    pub const NOTES: usize = 32;
}

/// Why a model cannot be drawn; one sentence.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(pub String);

impl LoadError {
    fn new(reason: impl Display) -> Self {
        Self(reason.to_string())
    }

    /// Says where.
    fn within(self, place: impl Display) -> Self {
        Self(format!("{place}: {}", self.0))
    }
}

/// Reads a file that lies beside the model, given its relative path and the most bytes it may have.
pub type ReadFile<'a> = dyn FnMut(&Path, u64) -> Result<Vec<u8>, LoadError> + 'a;

/// Loads a `.gltf` or `.glb`. Only the model's own folder is read.
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

/// Reads a model from memory; `read` supplies the files that it names, by relative paths that never climb.
pub fn parse(bytes: &[u8], read: &mut ReadFile) -> Result<Scene, LoadError> {
    // The crate's validation is code of others; a panic there must not take the window along.
    catch_unwind(AssertUnwindSafe(|| meshes::scene(bytes, read)))
        .unwrap_or_else(|_| Err(LoadError::new("the loader stumbled over this file; please report it")))
}

/// A name from a file, fit for a message: quoted, escaped and short.
fn quoted(name: &str) -> String {
    let short: String = name.chars().take(60).collect();
    if short.len() < name.len() { format!("{:?}", short + "…") } else { format!("{short:?}") }
}

/// `kind "name"`, or `kind 3` for a thing without a name.
fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {}", quoted(name)),
        _ => format!("{kind} {index}"),
    }
}
