//! Bounds how far the picture of an f32 renderer may be from the exact one (`docs/exactness.md`
//! §9). Every file belongs to one of `render` and bounds what that computes, for any rounding,
//! order and fusion of operations that WGSL allows.

pub mod colors;
pub mod coverage;
pub mod deform;
pub mod dots;
pub mod glass;
pub mod layers;
pub mod mask;
pub mod particles;
pub mod perturbations;
pub mod sample_setup;
pub mod snap;
pub mod surface;
pub mod vertex;
