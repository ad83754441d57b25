//! glTF 2.0 loader for untrusted files.
//!
//! What the standard calls valid is drawn as far as it is supported. What breaks it is left out, and
//! the rest is kept, with one sentence that names the part: the mesh, the primitive and the accessor,
//! for instance. Only what leaves nothing to draw is an error, and what exceeds the [`limits`], which
//! are checked in 64-bit arithmetic before a byte is read. Attribute bytes are copied as they are.
//!
//! Supported: triangle lists, strips and fans, points and lines, all index widths, interleaved, sparse, quantized and
//! compressed (Draco, meshopt) accessors, base color and emission with their textures, vertex
//! colors, the nodes, cameras and lights of the default scene, many instances of a node's mesh, skins, morph
//! targets and clips. Left out with
//! an entry in [`Scene::notes`](crate::scene::Scene::notes): normal maps and the rest of physically based shading.

pub(super) mod buffers;
pub(super) mod checks;
mod clips;
mod compression;
mod container;
mod deformation;
mod document;
mod draco;
pub(super) mod error;
pub(super) mod images;
mod instances;
mod instancing;
pub mod limits;
mod lines;
pub(super) mod load;
mod mask;
mod materials;
mod meshes;
mod meshopt;
mod nodes;
pub(super) mod notes;
pub(super) mod other_file;
mod skin;
mod source;
pub(super) mod uri;

pub use error::{LoadError, ReadFile};
pub use load::{load, load_variant, load_within};
pub use source::{PART_BYTES, Source, reserve};
