//! Small pictures of presets and effects: their sizes, and what is drawn for an effect.

use std::sync::{Arc, atomic::AtomicBool};

use crate::{preset::Preset, scene::Scene};

/// Size of a thumbnail in pixels; shown at half of it.
pub const THUMBNAIL: [u32; 2] = [144, 108];

/// Size of the thumbnail of a tile, pixels.
pub const LARGE_THUMBNAIL: [u32; 2] = [288, 216];

/// A picture of an effect that is to be drawn.
pub struct EffectPicture {
    pub effect: String,
    pub preset: Preset,
    pub scene: Arc<Scene>,
    pub size: [u32; 2],
    pub cancelled: Arc<AtomicBool>,
}
