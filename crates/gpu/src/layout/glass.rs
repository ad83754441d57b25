//! Layers of glass: what a frame counts of them, and how much room they get.

use crate::plan::{Caps, GLASS_LAYER_BYTES};

/// Words of a layer: depth key, triangle id, the next layer, and three of what it does to a color.
pub const LAYER_WORDS: usize = GLASS_LAYER_BYTES as usize / 4;
/// Layers of a block, in which the same word of all of them is a row.
pub const BLOCK: usize = 32;
/// Bytes of a pixel of a band: the head of its list.
pub const HEAD_BYTES: u64 = 4;
/// Bytes of every pixel for its opaque triangle, in the same buffer.
pub const OPAQUE_BYTES: u64 = 4;
/// Bytes of every pixel for what its layers compose to, in the buffer of the picture.
pub const COMPOSED_BYTES: u64 = 12;
/// Bytes of every pixel's depth and triangle id in the buffer of the layers, at most.
const NEAREST_BYTES: u64 = 8;
/// Layers that the first picture of a scene has room for.
pub const FIRST_LAYERS: u32 = 1 << 16;
/// Layers that take so little memory that fewer would not help.
pub const FEWEST_LAYERS: u32 = 1 << 12;
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

/// Place of a word of a layer among the words of all, each counted from 0.
pub fn layer_word(layer: usize, word: usize) -> usize {
    layer / BLOCK * (BLOCK * LAYER_WORDS) + word * BLOCK + layer % BLOCK
}

/// Bytes of so many layers, in whole blocks.
pub fn layer_bytes(layers: u32) -> u64 {
    GLASS_LAYER_BYTES * u64::from(layers).next_multiple_of(BLOCK as u64)
}

/// Pixels of a band, the last of which may have fewer.
pub fn band_length(pixels: u64, bands: u32) -> u64 {
    pixels.div_ceil(bands.max(1).into())
}

/// Layers that the adapter binds behind so many pixels that are drawn in `bands` bands.
fn bound_layers(pixels: u64, bands: u32, caps: &Caps) -> u64 {
    let limit = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
    let others = pixels * (NEAREST_BYTES + OPAQUE_BYTES)
        + HEAD_BYTES * band_length(pixels, bands)
        + size_of::<GlassRecord>() as u64;
    let block = GLASS_LAYER_BYTES * BLOCK as u64;
    limit.saturating_sub(others) / block * BLOCK as u64
}

/// Layers of a band that may be in memory, at least 1: as many as `tuned`, and as the adapter binds.
pub fn most_layers(pixels: u64, bands: u32, caps: &Caps, tuned: u32) -> u32 {
    bound_layers(pixels, bands, caps).clamp(1, tuned.max(1).into()) as u32
}

/// The fewest bands in which the lists of so many pixels, empty ones, can be bound at all.
pub fn fewest_bands(pixels: u64, caps: &Caps) -> u32 {
    bands_from(1, |bands| bound_layers(pixels, bands, caps) > 0).unwrap_or(1)
}

/// The number of bands, more than `bands`, that divides so many layers of each of these into runs
/// that have room, `most` of that number, if they are spread evenly; none where that is more than
/// [`MOST_BANDS`].
pub fn more_bands(bands: u32, demand: u32, most: impl Fn(u32) -> u32) -> Option<u32> {
    let all = u64::from(bands.max(1)) * u64::from(demand);
    bands_from(bands.max(1).checked_mul(2)?, |bands| {
        all.div_ceil(bands.into()) <= most(bands).into()
    })
}

/// The first of `bands` and its doubles up to [`MOST_BANDS`] that will do.
fn bands_from(bands: u32, will_do: impl Fn(u32) -> bool) -> Option<u32> {
    std::iter::successors(Some(bands), |bands| bands.checked_mul(2))
        .take_while(|bands| *bands <= MOST_BANDS)
        .find(|bands| will_do(*bands))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest bindings that WebGPU promises.
    const PORTABLE: Caps = Caps {
        max_storage_binding_bytes: 128 << 20,
        ..Caps::ALL
    };

    #[test]
    fn thirty_two_layers_at_4k_fit_the_bindings_that_are_promised() {
        let pixels = 3840 * 2160;
        let most = |bands| most_layers(pixels, bands, &PORTABLE, u32::MAX);
        let first = fewest_bands(pixels, &PORTABLE);
        let demand = (32 * pixels).div_ceil(first.into()) as u32;
        let bands = more_bands(first, demand, most).expect("some number of bands");
        assert!((128..=256).contains(&bands), "{bands} bands");
        let bytes = pixels * (NEAREST_BYTES + OPAQUE_BYTES)
            + HEAD_BYTES * band_length(pixels, bands)
            + layer_bytes(most(bands));
        assert!(bytes <= PORTABLE.max_storage_binding_bytes, "{bytes} bytes");
        assert!(u64::from(most(bands)) * u64::from(bands) >= 32 * pixels);
    }

    #[test]
    fn bands_are_as_few_as_have_room_and_never_too_many() {
        let room = |_| 100;
        assert_eq!(more_bands(1, 101, room), Some(2));
        assert_eq!(more_bands(1, 801, room), Some(16));
        assert_eq!(more_bands(4, 101, room), Some(8));
        assert_eq!(more_bands(MOST_BANDS, 101, room), None);
        assert_eq!(more_bands(1, u32::MAX, room), None);
        assert_eq!(fewest_bands(64, &Caps::ALL), 1);
    }

    #[test]
    fn layers_have_words_of_their_own_in_whole_blocks() {
        let mut seen = std::collections::BTreeSet::new();
        for layer in 0..3 * BLOCK {
            for word in 0..LAYER_WORDS {
                assert!(seen.insert(layer_word(layer, word)));
            }
        }
        let last = seen.last().map(|word| 4 * (*word as u64 + 1));
        assert_eq!(last, Some(layer_bytes(2 * BLOCK as u32 + 1)));
    }
}
