//! Layers of a picture: which form of an x-ray's sums holds them, and in how many bands those of
//! glass are drawn.

use crate::{effects::hooks::Layers, shader::key::KernelKey};

/// What layers need where those of earlier pictures overflowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct RoomForLayers {
    /// Bits per channel, where more of them overflowed.
    pub fewer_bits: Option<u32>,
    /// A word for each sum instead of a 64-bit integer for all.
    pub is_deep: bool,
    /// Bands of pixels in which glass is drawn; 0 as 1.
    pub glass_bands: u32,
}

impl RoomForLayers {
    /// Changes a key whose layers would overflow.
    pub fn make(self, key: &mut KernelKey) {
        if let (Some(Layers::Xray { bits }), Some(fewer)) =
            (&mut key.framebuffer.layers, self.fewer_bits)
        {
            *bits = fewer.min(*bits);
        }
        key.framebuffer.has_one64_sums &= !self.is_deep;
        if key.has_glass() {
            key.framebuffer.glass_bands = self.glass_bands.max(1);
        }
    }

    /// Does it change this key?
    pub fn changes(self, key: &KernelKey) -> bool {
        let has_fewer = matches!((key.framebuffer.layers, self.fewer_bits), (Some(Layers::Xray { bits }), Some(fewer)) if fewer < bits);
        let has_bands = key.has_glass() && self.glass_bands > key.framebuffer.glass_bands;
        has_fewer || has_bands || (self.is_deep && key.framebuffer.has_one64_sums)
    }
}
