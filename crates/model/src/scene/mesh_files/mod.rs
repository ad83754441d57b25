//! Loaders of OBJ with its MTL, of STL, PLY, XYZ, LAS and LAZ, for untrusted files.
//!
//! What the formats allow is drawn as far as it is supported. A part that breaks them (a line, a
//! face, a material, a texture) is left out and the rest is kept, with one sentence for each kind
//! that names the first and counts the others. Only what leaves nothing to draw is an error, and
//! what exceeds the [`limits`](super::gltf::limits), which are checked before memory is taken.
//!
//! Coordinates stay as they are: +y is up, one unit is a meter. Colors are numbers as they are shown
//! on a screen (sRGB). Faces are drawn from both sides. Without normals they are flat, but for the
//! smoothing groups of OBJ. Polygons are cut into triangles.

mod beside;
mod builder;
mod colors;
mod findings;
mod las;
mod laz;
mod mtl;
mod obj;
mod ply;
mod polygons;
mod stl;
mod stream;
mod xyz;

use super::gltf::{LoadError, ReadFile, Source, limits::Limits, other_file};
use crate::scene::{memory::MemoryBudget, model::Scene};

/// A loader: of a model in any source, within a memory budget, with a function that supplies the
/// files beside the model.
pub type LoadModel = fn(&dyn Source, MemoryBudget, &mut ReadFile) -> Result<Scene, LoadError>;

/// A loader of a cloud whose points have several colors, with the name of the one to be shown.
pub type LoadCloud = fn(&dyn Source, MemoryBudget, &str, &mut ReadFile) -> Result<Scene, LoadError>;

pub use las::{load as load_las, load_shown as load_las_shown};
pub use obj::load as load_obj;
pub use ply::load as load_ply;
pub use stl::load as load_stl;
pub use xyz::{load as load_xyz, load_shown as load_xyz_shown};

/// The first bytes of a model.
///
/// # Errors
/// The model is too large, or is something else: not `what`, of which `is_it` tells by those bytes.
fn head(
    model: &dyn Source,
    budget: MemoryBudget,
    what: &str,
    is_it: fn(&[u8]) -> bool,
) -> Result<Vec<u8>, LoadError> {
    let (size, limits) = (model.size(), Limits::of_files(budget));
    if size > limits.file_bytes {
        return Err(limits.exceeded(format_args!("it has {size} bytes"), limits.file_bytes));
    }
    let mut head = Vec::new();
    model.append_to(&mut head, 0..size.min(1024))?;
    match other_file::named(&head) {
        Some(other) if !is_it(&head) => Err(LoadError::new(format!("it is not {what}: {other}"))),
        _ => Ok(head),
    }
}
