//! glTF 2.0 loader for untrusted files.
//!
//! The crate `gltf` parses and validates the JSON. Everything else (URIs, buffers, accessors, the
//! node tree) is checked here in 64-bit arithmetic and against [`limits`] before a byte is read.
//! Attribute bytes are copied as they are. Every error is one sentence that names the file, the
//! mesh, the primitive and the accessor.
//!
//! Supported: triangle lists, strips and fans, all index widths, interleaved, sparse, quantized and
//! compressed (Draco, meshopt) accessors, base color and emission with their textures, vertex
//! colors, the nodes and cameras of the default scene, skins, morph targets and clips. Skipped with
//! an entry in [`Scene::notes`](crate::scene::Scene::notes): points, lines, normal maps and the
//! rest of physically based shading.

mod buffers;
mod checks;
mod clips;
mod compression;
mod deformation;
mod document;
mod draco;
mod element;
mod error;
pub mod limits;
mod load;
mod materials;
mod meshes;
mod meshopt;
mod nodes;
mod notes;
mod repair;
mod skin;
mod source;
mod uri;

pub use error::{LoadError, ReadFile};
pub use load::{load, load_within};
pub use source::{PART_BYTES, Source, reserve};
