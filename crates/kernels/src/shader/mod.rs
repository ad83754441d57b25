//! Shaders as text: the library of files, the linker, the generated glue, the kernel key and what
//! naga says of it all. Names no GPU.

pub mod backends;
mod depth_keys;
mod features;
mod frames;
pub mod glue;
pub mod image_files;
pub mod image_passes;
pub mod key;
pub mod link;
pub mod pass;
pub mod reflect;
mod source;
pub mod specialize;

pub use key::{Fetch, KernelKey};
pub use pass::Pass;
pub use rasterlab_model::shaders as library;
