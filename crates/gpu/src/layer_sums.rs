//! The sums of an x-ray: which of their forms holds the layers of a picture.

use crate::{effects::hooks::Layers, shader::key::KernelKey};

/// What the sums of an x-ray need where those of earlier pictures overflowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct RoomForLayers {
    /// Bits per channel, where more of them overflowed.
    pub fewer_bits: Option<u32>,
    /// A word for each sum instead of a 64-bit integer for all.
    pub is_deep: bool,
}

impl RoomForLayers {
    /// Changes a key whose sums would overflow.
    pub fn make(self, key: &mut KernelKey) {
        if let (Some(Layers::Xray { bits }), Some(fewer)) =
            (&mut key.framebuffer.layers, self.fewer_bits)
        {
            *bits = fewer.min(*bits);
        }
        key.framebuffer.has_one64_sums &= !self.is_deep;
    }

    /// Does it change this key?
    pub fn changes(self, key: &KernelKey) -> bool {
        let has_fewer = matches!((key.framebuffer.layers, self.fewer_bits), (Some(Layers::Xray { bits }), Some(fewer)) if fewer < bits);
        has_fewer || (self.is_deep && key.framebuffer.has_one64_sums)
    }
}
