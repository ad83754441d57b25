//! Promises about pictures: effects, materials, skins, shadows, particles and dots look as in the
//! oracle.

#[path = "../common/mod.rs"]
mod common;

mod dots;
mod effects_layers;
mod effects_move;
mod effects_paint;
mod effects_samples;
mod glass;
mod kept;
mod lights;
mod looks;
mod maps;
mod materials;
mod particles;
mod ported;
mod scopes;
mod shadows;
mod skins;
mod snapshots;
