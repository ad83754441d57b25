//! Two other rasterizers that draw the same buffers: the hardware's, and a beginner's kernel.

mod deform;
mod geometry;
mod materials;

pub mod hardware;
pub mod naive;
