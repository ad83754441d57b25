//! Depth keys as kernels store them: what each format of `shaders/variants/depth` and each word of
//! `shaders/lib/packed32.wgsl` stands for.

use super::key::{FramebufferLayout, KernelKey};
use crate::{
    accuracy::DepthFormat,
    frame::{DepthRounding, NO_TRIANGLE},
};

/// Bits of 2^-31, the farthest depth that logarithmic and packed keys tell apart.
const FIRST_BITS: u32 = 0x3000_0000;
/// Bits of a depth of 1, and one more: the keys of standard depth count down from here.
const STANDARD_FIRST: u32 = 0x3f80_0001;

impl KernelKey {
    /// Bits of a depth key that shares a word with a triangle id, before it is shortened, and the
    /// least key that counts: two far depths below 2^-31 are one.
    pub(super) const fn depth_key_range(&self) -> (u32, u32) {
        match self.options.depth {
            DepthFormat::Ndc16 | DepthFormat::Log16 => (16, 0),
            DepthFormat::Log24 => (24, 0),
            DepthFormat::Standard => (30, 0),
            DepthFormat::Reversed | DepthFormat::Integer => (28, FIRST_BITS),
        }
    }

    /// Distance of logarithmic keys, in steps of a float's bits.
    pub(super) const fn depth_log_step(&self) -> u32 {
        if matches!(self.options.depth, DepthFormat::Log16) {
            1 << 12
        } else {
            1 << 4
        }
    }

    /// Bits that a depth key loses when it shares a word with a triangle id.
    const fn lost_key_bits(&self) -> u32 {
        match self.framebuffer_layout() {
            FramebufferLayout::Packed32 => {
                (self.depth_key_range().0 + self.framebuffer.triangle_id_bits).saturating_sub(32)
            }
            FramebufferLayout::Split32 | FramebufferLayout::Packed64 => 0,
        }
    }

    /// Triangle id and depth key of a pixel from the word that they share, as
    /// `shaders/lib/packed32.wgsl` packs them.
    pub fn unpack(&self, word: u32) -> (u32, u32) {
        let id_bits = self.framebuffer.triangle_id_bits;
        match word {
            0 => (NO_TRIANGLE, 0),
            _ => (
                !word & ((1 << id_bits) - 1),
                (((word >> id_bits) << self.lost_key_bits()) + self.depth_key_range().1).max(1),
            ),
        }
    }

    /// Bits of the reversed depth that a stored key stands for, as the shader decodes them; 0 where
    /// nothing is.
    pub fn depth_bits(&self, key: u32) -> u32 {
        let depth = match self.options.depth {
            _ if key == 0 => return 0,
            DepthFormat::Reversed | DepthFormat::Integer => return key,
            DepthFormat::Log16 | DepthFormat::Log24 => {
                return FIRST_BITS + key * self.depth_log_step();
            }
            DepthFormat::Standard => 1.0 - f32::from_bits(STANDARD_FIRST - key),
            DepthFormat::Ndc16 => key as f32 * (1.0f64 / 65535.0) as f32,
        };
        depth.to_bits().max(1)
    }

    /// Which depths a key stands for, once it is decoded by [`Self::depth_bits`].
    pub fn depth_rounding(&self) -> DepthRounding {
        let exact = DepthRounding::default();
        // The lost bits are zeros; the key may have been as many steps nearer.
        let steps = f64::from(1u32 << self.lost_key_bits());
        let float_step = f64::from(f32::EPSILON);
        match self.options.depth {
            DepthFormat::Reversed | DepthFormat::Integer
                if self.framebuffer_layout() != FramebufferLayout::Packed32 =>
            {
                exact
            }
            DepthFormat::Reversed | DepthFormat::Integer => DepthRounding {
                relative_up: (steps - 1.0) * float_step,
                least_key: FIRST_BITS,
                ..exact
            },
            DepthFormat::Log16 | DepthFormat::Log24 => {
                let step = self.depth_log_step();
                DepthRounding {
                    relative_up: steps * f64::from(step) * float_step,
                    least_key: FIRST_BITS + step,
                    ..exact
                }
            }
            // The difference from 1 is rounded, to a 2^-24 at most.
            DepthFormat::Standard => DepthRounding {
                down: float_step,
                up: steps * float_step,
                ..exact
            },
            DepthFormat::Ndc16 => {
                let step = 1.0 / 65535.0;
                DepthRounding {
                    down: 0.51 * step,
                    up: (steps - 0.49) * step,
                    least_key: self.depth_bits(1),
                    ..exact
                }
            }
        }
    }
}
