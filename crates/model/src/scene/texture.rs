//! Textures as plain data: images with their mip levels, and how a material samples them.
//!
//! Texels stay the bytes of the file: colors sRGB-encoded, data as it is. Filtering happens in linear
//! light, so each reader decodes colors before it blends. The mip levels are computed here once, so that every renderer
//! and the oracle start from the same bytes.

use glam::DVec2;

use super::accessor::Accessor;
use crate::math::linear_light;

/// A picture for surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Shown to people.
    pub name: String,
    /// The picture, followed by its mip levels down to one texel; only the picture where no
    /// sampler uses mip levels.
    pub levels: Vec<Level>,
    /// Its texels are numbers from 0 to 1 in steps of 1/255, not colors.
    pub is_data: bool,
}

/// Texels row by row from the top, RGBA: sRGB-encoded with linear alpha, or all linear in an image
/// of data.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Width and height, each at least 1.
    pub size: [u32; 2],
    /// `width * height` texels.
    pub texels: Vec<[u8; 4]>,
}

impl Image {
    /// An image without mip levels.
    ///
    /// # Panics
    /// If there are not `width * height` texels, or none.
    pub fn new(name: &str, size: [u32; 2], texels: Vec<[u8; 4]>) -> Self {
        assert!(
            !texels.is_empty() && texels.len() == size[0] as usize * size[1] as usize,
            "an image of {size:?} has texels"
        );
        Self {
            name: name.into(),
            levels: vec![Level { size, texels }],
            is_data: false,
        }
    }

    /// The same bytes as numbers, not colors. Comes before [`Self::with_mipmaps`].
    pub fn of_data(self) -> Self {
        Self {
            is_data: true,
            ..self
        }
    }

    /// The same image with at most `side` texels along each side: halved as often as that takes.
    pub fn at_most(mut self, side: u32) -> Self {
        while self.size().into_iter().max() > Some(side)
            && let Some(smaller) = self.levels[0].halved(self.is_data)
        {
            self.levels = vec![smaller];
        }
        self
    }

    /// The same image with all mip levels.
    pub fn with_mipmaps(mut self) -> Self {
        self.levels.truncate(1);
        let is_data = self.is_data;
        while let Some(smaller) = self.levels.last().and_then(|level| level.halved(is_data)) {
            self.levels.push(smaller);
        }
        self
    }

    /// Width and height of the picture.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> u64 {
        self.levels
            .iter()
            .map(|level| 4 * level.texels.len() as u64)
            .sum()
    }
}

impl Level {
    /// The next mip level: half as wide and high, rounded down. Each texel is the area-weighted
    /// mean of what it covers, of colors in linear light. `None` for a single texel.
    fn halved(&self, is_data: bool) -> Option<Self> {
        if self.size == [1, 1] {
            return None;
        }
        let linear = |value: f64| if is_data { value } else { linear_light(value) };
        let light: [f64; 256] = std::array::from_fn(|byte| linear(byte as f64 / 255.0));
        // The smallest linear value that rounds to each byte.
        let least: [f64; 256] =
            std::array::from_fn(|byte| linear((byte as f64 - 0.5).max(0.0) / 255.0));
        let size = self.size.map(|side| (side / 2).max(1));
        let covered_texels = [0, 1].map(|axis| {
            (0..size[axis])
                .map(|at| covered_texels(at, size[axis], self.size[axis]))
                .collect::<Vec<_>>()
        });
        let texel = |x: usize, y: usize| {
            let mut sum = [0.0; 4];
            for &(row, high) in &covered_texels[1][y] {
                for &(column, wide) in &covered_texels[0][x] {
                    let texel = self.texels[row * self.size[0] as usize + column];
                    (0..3).for_each(|c| sum[c] += light[usize::from(texel[c])] * high * wide);
                    sum[3] += f64::from(texel[3]) * high * wide;
                }
            }
            let encoded = |value: f64| (least.partition_point(|&least| least <= value) - 1) as u8;
            [
                encoded(sum[0]),
                encoded(sum[1]),
                encoded(sum[2]),
                (sum[3] + 0.5).floor() as u8,
            ]
        };
        let texels = (0..size[1] as usize)
            .flat_map(|y| (0..size[0] as usize).map(move |x| (x, y)))
            .map(|(x, y)| texel(x, y))
            .collect();
        Some(Self { size, texels })
    }
}

/// The texels, of `of` in a row, that texel `at` of `side` in a row covers, each with its fraction.
fn covered_texels(at: u32, side: u32, of: u32) -> Vec<(usize, f64)> {
    let scale = f64::from(of) / f64::from(side);
    let (from, to) = (f64::from(at) * scale, f64::from(at + 1) * scale);
    let part = |texel: u32| ((f64::from(texel) + 1.0).min(to) - f64::from(texel).max(from)) / scale;
    let range = from.floor() as u32..(to.ceil() as u32).min(of);
    range
        .map(|texel| (texel as usize, part(texel)))
        .filter(|(_, fraction)| *fraction > 1e-9)
        .collect()
}

/// How coordinates beyond the edges of an image are wrapped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat = 0,
    /// The image repeats, every second time mirrored.
    Mirrored = 1,
    /// The outermost texels continue.
    Clamp = 2,
}

/// How a value between texel centers is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Filter {
    /// The value of the nearest texel.
    Nearest = 0,
    /// Bilinear interpolation of the four nearest texels.
    #[default]
    Linear = 1,
}

/// Which mip levels are read where a pixel covers several texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MipFilter {
    /// Only the full image.
    Unused = 0,
    /// The level of the nearest size.
    Nearest = 1,
    /// Linear interpolation between the two nearest levels.
    #[default]
    Mixed = 2,
}

/// How a material samples an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// Index into `Scene::images`.
    pub image: usize,
    /// Horizontally and vertically.
    pub wrap: [Wrap; 2],
    /// Filter where a texel covers a pixel or more.
    pub mag_filter: Filter,
    /// Filter where a pixel covers more than a texel.
    pub min_filter: Filter,
    /// Which mip levels are read.
    pub mip_filter: MipFilter,
    /// The set of texture coordinates: n of `TEXCOORD_n`.
    pub set: u32,
    /// Rows of the affine map from stored texture coordinates to image coordinates, in which 0 and
    /// 1 are the left and right edges, or the top and bottom ones.
    pub image_from_texcoord: [[f32; 3]; 2],
}

impl Texture {
    /// The whole image, repeated, with linear filters, by the first set of coordinates.
    pub fn plain(image: usize) -> Self {
        Self {
            image,
            wrap: Default::default(),
            mag_filter: Filter::Linear,
            min_filter: Filter::Linear,
            mip_filter: MipFilter::Mixed,
            set: 0,
            image_from_texcoord: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }

    /// Image coordinates of stored texture coordinates.
    pub fn image_coordinates(&self, texcoord: DVec2) -> DVec2 {
        DVec2::from(self.image_from_texcoord.map(|row| {
            let [u, v, offset] = row.map(f64::from);
            u * texcoord.x + v * texcoord.y + offset
        }))
    }
}

/// Units of [`Texture::units`] per texel.
pub const UNITS_PER_TEXEL: f64 = 256.0;

/// Largest magnitude of an image coordinate, which is the largest number of repeats.
pub const MAX_REPEATS: f64 = 65_536.0;

impl Texture {
    /// Stored texture coordinates in units of 1/256 texel of an image of this size, from which
    /// integer decisions are made. Clamped to ±2^29 units, two million texels.
    pub fn units(&self, size: [u32; 2], texcoord: DVec2) -> [i32; 2] {
        const MAX_UNITS: f64 = (1 << 29) as f64;
        let units =
            self.image_coordinates(texcoord) * DVec2::from(size.map(f64::from)) * UNITS_PER_TEXEL;
        units
            .to_array()
            .map(|v| v.clamp(-MAX_UNITS, MAX_UNITS).round_ties_even() as i32)
    }
}

/// The texture coordinates of a vertex as they are stored.
pub fn texcoord(texcoords: &Accessor, bytes: &[u8], vertex: u32) -> DVec2 {
    DVec2::new(
        texcoords.value(bytes, vertex, 0),
        texcoords.value(bytes, vertex, 1),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{hash, srgb};

    #[test]
    fn mip_levels_halve_down_to_a_texel_and_keep_the_mean_of_their_light() {
        for size in [[1, 1], [8, 8], [7, 3], [1, 9], [16, 5]] {
            let noise = |i: u32| hash(i).to_le_bytes();
            let image = Image::new("noise", size, (0..size[0] * size[1]).map(noise).collect())
                .with_mipmaps();
            let sizes: Vec<_> = image.levels.iter().map(|level| level.size).collect();
            assert_eq!((sizes[0], *sizes.last().expect("a level")), (size, [1, 1]));
            assert!(
                sizes
                    .windows(2)
                    .all(|pair| pair[1] == pair[0].map(|side| (side / 2).max(1))),
                "{sizes:?}"
            );
            let mean = |level: &Level, c: usize| {
                let light = |texel: &[u8; 4]| linear_light(f64::from(texel[c]) / 255.0);
                level.texels.iter().map(light).sum::<f64>() / level.texels.len() as f64
            };
            for (level, c) in image
                .levels
                .iter()
                .flat_map(|level| (0..3).map(move |c| (level, c)))
            {
                let (kept, whole) = (srgb(mean(level, c)), srgb(mean(&image.levels[0], c)));
                // A rounding a level.
                assert!(
                    (kept - whole).abs() < 0.6 / 255.0 * image.levels.len() as f64,
                    "{size:?} {c}: {kept} for {whole}"
                );
            }
        }
    }

    #[test]
    fn black_and_white_mix_to_half_the_light() {
        let checks = Image::new("checks", [2, 1], vec![[0, 0, 0, 0], [255; 4]]).with_mipmaps();
        assert_eq!(checks.levels[1].texels, [[188, 188, 188, 128]]);
        assert_eq!(checks.bytes(), 12);
    }
}
