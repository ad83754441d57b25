//! Shaders as text: the library of files, the linker, the generated glue, the kernel key and what naga says of it all.
//! Names no GPU.

mod frames;
pub mod glue;
pub mod key;
pub mod library;
pub mod link;
mod pass;
pub mod reflect;
mod slots;

pub use key::{Fetch, KernelKey, Pass};
