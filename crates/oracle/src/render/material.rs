//! Materials in f64: textures looked up as glTF 2.0 (section 3.8) and its samplers define it.

use glam::{DVec2, DVec3};

use super::super::perturbation::TexturePerturbation;
use crate::{
    math::linear_light,
    scene::{
        Primitive, Scene,
        texture::{Filter, Level, MipFilter, Texture, Wrap, texcoord},
    },
};

/// A material as one triangle shows it.
pub struct TriangleMaterial<'a> {
    scene: &'a Scene,
    base: Option<TextureLookup<'a>>,
    emission: DVec3,
    emissive: Option<TextureLookup<'a>>,
    is_unlit: bool,
}

/// A texture with the coordinates of a triangle's corners.
struct TextureLookup<'a> {
    texture: &'a Texture,
    corners: [DVec2; 3],
    /// Sums of the magnitudes of a coordinate's terms, to which rounding errors are proportional.
    terms: DVec2,
}

/// Weights of the corners at a sample, and how they change from pixel to pixel.
#[derive(Clone, Copy)]
pub struct SampleWeights {
    pub weights: [f64; 3],
    /// Their differences to the next pixel on the right and to the next one below.
    pub slopes: [[f64; 3]; 2],
    /// Bounds of the weights' errors in f32.
    pub errors: [f64; 3],
}

impl<'a> TriangleMaterial<'a> {
    /// None for a material that is only a base color.
    pub fn of(scene: &'a Scene, primitive: &'a Primitive, corners: [u32; 3]) -> Option<Self> {
        let material = &scene.materials[primitive.material];
        if material.is_plain() {
            return None;
        }
        let lookup = |slot: usize| {
            let (texture, texcoords) =
                material.textures()[slot].zip(primitive.texcoords[slot].as_ref())?;
            let at = corners.map(|corner| texcoord(texcoords, &scene.vertex_bytes, corner));
            let magnitudes = texture
                .image_from_texcoord
                .map(|row| row.map(|v| f64::from(v).abs()));
            let terms = at.map(|at| {
                DVec2::from(
                    magnitudes.map(|[u, v, offset]| u * at.x.abs() + v * at.y.abs() + offset),
                )
            });
            Some(TextureLookup {
                texture,
                corners: at.map(|at| texture.image_coordinates(at)),
                terms: terms[0].max(terms[1]).max(terms[2]),
            })
        };
        let emission = DVec3::from(material.emission.map(f64::from));
        Some(Self {
            scene,
            base: lookup(0),
            emission,
            emissive: lookup(1),
            is_unlit: material.unlit,
        })
    }

    /// Color of a surface with the base color `base`, and the part of it that no light changes.
    pub fn color(
        &self,
        base: DVec3,
        at: &SampleWeights,
        perturbation: TexturePerturbation,
    ) -> (DVec3, DVec3) {
        let looked_up = |lookup: &Option<TextureLookup>| {
            lookup.as_ref().map_or(DVec3::ONE, |lookup| {
                lookup.color(self.scene, at, perturbation)
            })
        };
        let color = base * looked_up(&self.base);
        if self.is_unlit {
            return (color, color);
        }
        let glow = self.emission * looked_up(&self.emissive);
        (color + glow, glow)
    }
}

impl TextureLookup<'_> {
    fn color(&self, scene: &Scene, at: &SampleWeights, perturbation: TexturePerturbation) -> DVec3 {
        let levels = &scene.images[self.texture.image].levels;
        let size = DVec2::from(levels[0].size.map(f64::from));
        let mixed =
            |k: [f64; 3]| self.corners[0] * k[0] + self.corners[1] * k[1] + self.corners[2] * k[2];
        let spans = at.slopes.map(|slope| (mixed(slope) * size).length());
        let detail = libm::log2(spans[0].max(spans[1]).max(1e-15));
        let uv = mixed(at.weights);
        let from_weights: DVec2 = (0..3)
            .map(|k| (self.corners[k] - uv).abs() * at.errors[k])
            .sum();
        // Corners err by a few roundings; the level of detail by the errors of the weights and by
        // those of its logarithm.
        let uv_error = (from_weights + self.terms / f64::from(1 << 21)).max(DVec2::splat(1e-7));
        let detail_error =
            (1.0 / f64::from(1 << 10) + 4.0 * at.errors.iter().sum::<f64>()).min(1.0);
        let [across, down, level] = perturbation;
        self.filtered(
            levels,
            uv + uv_error * DVec2::new(across, down),
            detail + level * detail_error,
        )
    }

    /// The filtered color at texture coordinates `uv`, where a pixel spans 2^detail texels.
    fn filtered(&self, levels: &[Level], uv: DVec2, detail: f64) -> DVec3 {
        let at = |level: f64, filter: Filter| self.level(&levels[level as usize], uv, filter);
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

    fn level(&self, level: &Level, uv: DVec2, filter: Filter) -> DVec3 {
        let at = uv * DVec2::from(level.size.map(f64::from));
        match filter {
            Filter::Nearest => self.texel(level, at.x.floor(), at.y.floor()),
            Filter::Linear => {
                // Texels lie at the centers of their squares.
                let (x, y) = (at.x - 0.5, at.y - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let row = |row: f64| {
                    self.texel(level, left, row)
                        .lerp(self.texel(level, left + 1.0, row), x - left)
                };
                row(top).lerp(row(top + 1.0), y - top)
            }
        }
    }

    fn texel(&self, level: &Level, x: f64, y: f64) -> DVec3 {
        let [width, height] = level.size;
        let [across, down] = self.texture.wrap;
        let (x, y) = (
            wrapped(x as i64, width.into(), across),
            wrapped(y as i64, height.into(), down),
        );
        let [red, green, blue, _] = level.texels[(y * i64::from(width) + x) as usize];
        DVec3::from([red, green, blue].map(|byte| linear_light(f64::from(byte) / 255.0)))
    }
}

/// The texel of a side that a coordinate anywhere wraps to.
fn wrapped(at: i64, side: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => at.rem_euclid(side),
        Wrap::Clamp => at.clamp(0, side - 1),
        // There and back again: 0 1 2 2 1 0 0 1 …
        Wrap::Mirrored => {
            let there_and_back = at.rem_euclid(2 * side);
            there_and_back.min(2 * side - 1 - there_and_back)
        }
    }
}
