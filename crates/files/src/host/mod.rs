//! The host: what the core, which knows no files and no environment, is given of the machine it
//! runs on.

pub mod disk;
pub mod memory;
pub mod model;
pub mod shaders;
