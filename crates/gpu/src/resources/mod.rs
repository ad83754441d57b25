//! What is made on a device: buffers, textures and pipelines.

pub mod buffers;
pub mod textures;

pub mod hardware_pipeline;
pub mod pipelines;
