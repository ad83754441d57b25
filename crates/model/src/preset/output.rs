//! Size and background of the picture of a preset.

use crate::scene::Background;

/// Each with its name, as it is typed and shown, and its width and height in pixels. All are even,
/// as videos need it.
pub const NAMED_SIZES: [(&str, [u32; 2]); 4] = [
    ("1080p", [1920, 1080]),
    ("4k", [3840, 2160]),
    ("square", [1080, 1080]),
    ("story", [1080, 1920]),
];

/// The size of this name, in any case of letters.
pub fn named_size(name: &str) -> Option<[u32; 2]> {
    NAMED_SIZES
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(name))
        .map(|(_, size)| *size)
}

/// Size and background of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Width and height in pixels, each 0 to 16,384.
    pub size: [u32; 2],
    /// Linear RGBA; of a gradient that of the top edge.
    pub background: [f32; 4],
    /// Linear RGBA of the bottom edge; none: the background is one color.
    pub background_bottom: Option<[f32; 4]>,
    /// The height of a picture in which lengths in pixels are what they say, 1 to 16,384; in others
    /// they grow and shrink with the height. None: that of `size`.
    pub reference_height_px: Option<u32>,
}

impl Output {
    /// What pixels without a triangle show.
    pub fn backdrop(&self) -> Background {
        Background {
            top: self.background,
            bottom: self.background_bottom.unwrap_or(self.background),
        }
    }

    /// Another size, in which lengths in pixels fill the same part of the picture.
    pub fn resize(&mut self, size: [u32; 2]) {
        let reference = self.reference_height_px.unwrap_or(self.size[1]);
        self.size = size;
        self.reference_height_px = (reference != size[1] && reference > 0).then_some(reference);
    }

    /// Factor of lengths in pixels in a picture of this height.
    pub fn length_scale(&self, height: f64) -> f64 {
        let reference = f64::from(self.reference_height_px.unwrap_or(self.size[1]));
        if reference > 0.0 && height > 0.0 {
            height / reference
        } else {
            1.0
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self {
            size: [320, 240],
            background: [0.012, 0.014, 0.02, 1.0],
            background_bottom: None,
            reference_height_px: None,
        }
    }
}
