//! Texels in f64: what a material's images show at a sample, written from the standard's words about samplers.
//!
//! An adapter finds places in an image and their scale in f32. How far it may be off is bounded here, and a judge looks that
//! far aside: what lies between the answers is right. Mixed texels hardly change over such a distance; where the nearest is
//! taken, the two sides of a texel's edge are both right.

use glam::{DVec2, DVec3};

use crate::{
    math::linear_light,
    scene::{
        Primitive, Scene,
        texture::{Filter, Level, MipFilter, Texture, Wrap, texcoord},
    },
};

/// How far to preset aside, in bounds of error: across, down, and in the scale.
pub(super) type Aside = [f64; 3];

/// Every way to preset aside, straight first.
pub(super) const ASIDES: [Aside; 5] = [[0.0; 3], [1.0; 3], [-1.0; 3], [1.0, -1.0, 1.0], [-1.0, 1.0, -1.0]];

/// A material as one triangle shows it.
pub(super) struct Material<'a> {
    scene: &'a Scene,
    base: Option<TextureLookup<'a>>,
    emission: DVec3,
    glow: Option<TextureLookup<'a>>,
    is_unlit: bool,
}

/// A texture with the places of the corners in its image.
struct TextureLookup<'a> {
    texture: &'a Texture,
    corners: [DVec2; 3],
    /// Sums of the magnitudes of the terms that make a place: rounding errors are proportional to them.
    terms: DVec2,
}

/// How the corners share a sample, and how that changes from pixel to pixel.
#[derive(Clone, Copy)]
pub(super) struct Shares {
    pub weights: [f64; 3],
    /// A pixel to the right, and one down.
    pub slopes: [[f64; 3]; 2],
    /// How far an adapter's weights may be off.
    pub doubts: [f64; 3],
}

impl<'a> Material<'a> {
    /// None for a material that is a base colour and no more.
    pub fn of(scene: &'a Scene, primitive: &'a Primitive, corners: [u32; 3]) -> Option<Self> {
        let material = &scene.materials[primitive.material];
        if material.is_plain() {
            return None;
        }
        let preset_file = |slot: usize| {
            let (texture, texcoords) = material.textures()[slot].zip(primitive.texcoords[slot].as_ref())?;
            let at = corners.map(|corner| texcoord(texcoords, &scene.vertex_bytes, corner));
            let magnitudes = texture.image_from_texcoord.map(|row| row.map(|v| f64::from(v).abs()));
            let terms = at.map(|at| DVec2::from(magnitudes.map(|[u, v, offset]| u * at.x.abs() + v * at.y.abs() + offset)));
            Some(TextureLookup {
                texture,
                corners: at.map(|at| texture.image_coordinates(at)),
                terms: terms[0].max(terms[1]).max(terms[2]),
            })
        };
        let emission = DVec3::from(material.emission.map(f64::from));
        Some(Self { scene, base: preset_file(0), emission, glow: preset_file(1), is_unlit: material.unlit })
    }

    /// Colour of a surface whose base colour is `base`, and the part of it that no light changes.
    pub fn seen(&self, base: DVec3, shares: &Shares, aside: Aside) -> (DVec3, DVec3) {
        let light = |preset_file: &Option<TextureLookup>| {
            preset_file.as_ref().map_or(DVec3::ONE, |preset_file| preset_file.light(self.scene, shares, aside))
        };
        let color = base * light(&self.base);
        if self.is_unlit {
            return (color, color);
        }
        let glow = self.emission * light(&self.glow);
        (color + glow, glow)
    }
}

impl TextureLookup<'_> {
    fn light(&self, scene: &Scene, shares: &Shares, aside: Aside) -> DVec3 {
        let levels = &scene.images[self.texture.image].levels;
        let size = DVec2::from(levels[0].size.map(f64::from));
        let mixed = |k: [f64; 3]| self.corners[0] * k[0] + self.corners[1] * k[1] + self.corners[2] * k[2];
        let spans = shares.slopes.map(|slope| (mixed(slope) * size).length());
        let detail = libm::log2(spans[0].max(spans[1]).max(1e-15));
        let place = mixed(shares.weights);
        let weighed: DVec2 = (0..3).map(|k| (self.corners[k] - place).abs() * shares.doubts[k]).sum();
        // Corners err by a few roundings, the scale by as much as what it is made of, and by its logarithm.
        let error_bound = (weighed + self.terms / f64::from(1 << 21)).max(DVec2::splat(1e-7));
        let scale = 1.0 / f64::from(1 << 10) + 4.0 * shares.doubts.iter().sum::<f64>();
        self.filtered(levels, place + error_bound * DVec2::new(aside[0], aside[1]), detail + aside[2] * scale.min(1.0))
    }

    /// The light at a place, where a pixel spans 2^detail texels.
    fn filtered(&self, levels: &[Level], place: DVec2, detail: f64) -> DVec3 {
        let at = |level: f64, filter: Filter| self.level(&levels[level as usize], place, filter);
        let last = levels.len() as f64 - 1.0;
        if detail <= 0.0 {
            return at(0.0, self.texture.mag_filter);
        }
        let filter = self.texture.min_filter;
        match self.texture.mip_filter {
            MipFilter::Unused => at(0.0, filter),
            MipFilter::Nearest => at((detail + 0.5).floor().min(last), filter),
            MipFilter::Mixed => {
                let level = detail.min(last);
                let above = level.ceil().min(last);
                at(level.floor(), filter).lerp(at(above, filter), level - level.floor())
            }
        }
    }

    fn level(&self, level: &Level, place: DVec2, filter: Filter) -> DVec3 {
        let at = place * DVec2::from(level.size.map(f64::from));
        match filter {
            Filter::Nearest => self.texel(level, at.x.floor(), at.y.floor()),
            Filter::Linear => {
                // Texels stand in the middles of their squares.
                let (x, y) = (at.x - 0.5, at.y - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let row = |row: f64| self.texel(level, left, row).lerp(self.texel(level, left + 1.0, row), x - left);
                row(top).lerp(row(top + 1.0), y - top)
            }
        }
    }

    fn texel(&self, level: &Level, x: f64, y: f64) -> DVec3 {
        let [width, height] = level.size;
        let [across, down] = self.texture.wrap;
        let (x, y) = (wrapped(x as i64, width.into(), across), wrapped(y as i64, height.into(), down));
        let [red, green, blue, _] = level.texels[(y * i64::from(width) + x) as usize];
        DVec3::from([red, green, blue].map(|byte| linear_light(f64::from(byte) / 255.0)))
    }
}

/// The texel of a side that stands for one anywhere.
fn wrapped(at: i64, side: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => at.rem_euclid(side),
        Wrap::Clamp => at.clamp(0, side - 1),
        // Going out and back again: 0 1 2 2 1 0 0 1 …
        Wrap::Mirrored => {
            let there_and_back = at.rem_euclid(2 * side);
            there_and_back.min(2 * side - 1 - there_and_back)
        }
    }
}
