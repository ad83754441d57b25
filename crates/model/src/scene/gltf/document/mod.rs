//! The JSON of a model, read with the types of the crate `gltf`.
//!
//! A value that breaks the standard costs the part that it belongs to, or only itself where the
//! part keeps its meaning without it, and leaves a fault in the [`Notes`](super::notes::Notes). What
//! is read is sound in itself: indices are in range, enumerations known. Parts that others refer to
//! by index are `Result`s, so that the others find out, and a part that nothing uses costs nothing.

mod element;
mod lights;
mod materials;
mod motion;
mod parts;
mod read;
mod shapes;
mod variants;

pub use parts::*;
pub use read::{QUANTIZATION, is_read, parse_document};
pub use shapes::MIN_QUATERNION_LENGTH;
