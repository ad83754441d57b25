//! Layers of glass: what a frame counts of them, and how much room they get.

use super::{renderer::Renderer, view_resources::Request};
use crate::{effects::glass::GlassDraws, plan::Caps, shader::KernelKey};

/// Bytes of a layer: depth key, triangle id, the next layer, and what it does to a color.
pub const LAYER_BYTES: u64 = 24;
/// Bytes of every pixel beside its layers: the head of its list, and what they compose to.
pub const HEAD_BYTES: u64 = 4;
pub const COMPOSED_BYTES: u64 = 16;
/// Bytes of every pixel's depth and triangle id in the same buffer, at most.
const NEAREST_BYTES: u64 = 8;
/// Most bands of pixels that a picture is drawn in.
pub const MOST_BANDS: u32 = 4096;

/// What a frame counts of layers of glass, as `shaders/lib/glass` numbers the words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct GlassRecord {
    /// Layers of the last band.
    pub layers: u32,
    /// Bands that were drawn.
    pub bands: u32,
    /// Most layers of a band before the last.
    pub most: u32,
    /// Pixels with more layers than are sorted.
    pub deep_pixels: u32,
    pub spare: [u32; 4],
}

impl GlassRecord {
    /// Most layers of a band.
    pub fn demand(&self) -> u32 {
        self.layers.max(self.most)
    }
}

/// Layers that a picture of so many pixels may have in memory at a time: as many as `tuned`, and as
/// the adapter binds behind the pixels.
pub fn most_layers(pixels: u64, caps: &Caps, tuned: u32) -> u32 {
    let limit = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
    let counts = 2 * size_of::<GlassRecord>() as u64;
    let others = pixels * (NEAREST_BYTES + HEAD_BYTES + COMPOSED_BYTES) + counts;
    (limit.saturating_sub(others) / LAYER_BYTES)
        .min(tuned.into())
        .max(1) as u32
}

/// The number of bands that divides so many layers of each of `bands` bands into runs of at most
/// `most`, if they are spread evenly; none where that is more than [`MOST_BANDS`].
pub fn more_bands(bands: u32, demand: u32, most: u32) -> Option<u32> {
    let parts = demand.div_ceil(most.max(1)).checked_next_power_of_two()?;
    bands
        .max(1)
        .checked_mul(parts.max(2))
        .filter(|bands| *bands <= MOST_BANDS)
}

impl Request<'_> {
    /// Which draws are drawn as glass.
    pub(super) fn glass(&self) -> GlassDraws {
        if self.accuracy.is_seen_through() {
            self.stack.glass()
        } else {
            GlassDraws::Nothing
        }
    }
}

impl Renderer {
    /// Makes room for the layers of glass of a band, which are `demand`, or has the next pictures
    /// drawn in more bands; false where they are as many as can be.
    pub(super) fn make_room_for_glass(&mut self, key: &KernelKey, demand: u32) -> bool {
        let Ok(frame) = self.picture.frame() else {
            return false;
        };
        let pixels = frame.view.pixels() as u64;
        let most = most_layers(
            pixels,
            &self.device.gpu.caps,
            self.device.tuning.glass_layers,
        );
        let capacity = &mut self.picture.capacities.glass;
        *capacity = demand.checked_next_power_of_two().unwrap_or(most).min(most);
        if demand <= most {
            return true;
        }
        let bands = more_bands(key.framebuffer.glass_bands, demand, most);
        bands
            .iter()
            .for_each(|bands| self.history.divide_glass(*bands));
        bands.is_some()
    }
}
