//! Pictures that the effect of a file takes as inputs.

use std::{
    ops::Range,
    sync::{Arc, LazyLock},
};

use glam::DVec4;

use crate::math::linear_light;

/// Linear light of every byte: the floats that the kernels read.
pub static LIGHT_OF_BYTES: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_light(byte as f64 / 255.0) as f32));

/// A decoded picture.
#[derive(Clone, PartialEq, Eq)]
pub struct ImageFile {
    /// The bytes of the file, a PNG.
    pub png: Vec<u8>,
    /// Width and height, texels, each at least 1.
    pub size: [u32; 2],
    /// Row by row from the top, sRGB-encoded RGBA with linear alpha.
    pub texels: Vec<[u8; 4]>,
}

impl ImageFile {
    /// A texel, linear red, green, blue, and alpha; outside, the nearest one.
    pub fn texel(&self, x: i64, y: i64) -> DVec4 {
        let [width, height] = self.size.map(i64::from);
        let (x, y) = (x.clamp(0, width - 1), y.clamp(0, height - 1));
        let [r, g, b, alpha] = self.texels[(y * width + x) as usize];
        let light = |byte: u8| f64::from(LIGHT_OF_BYTES[usize::from(byte)]);
        DVec4::new(light(r), light(g), light(b), f64::from(alpha) / 255.0)
    }
}

impl std::fmt::Debug for ImageFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} x {} texels", self.size[0], self.size[1])
    }
}

/// A member of an effect's struct of parameters that is a picture: a `u32`, which the kernels are
/// given as the number of the picture among those of the stack, and the oracle as that among those
/// of the effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageInput {
    /// Name of the member.
    pub name: String,
    /// Byte offset of the member in the struct.
    pub offset: usize,
    /// Where the file names the picture, in quotation marks: bytes of [`super::EffectSource::written`].
    pub named: Range<usize>,
    pub file: Arc<ImageFile>,
}
