//! Materials in f64: textures looked up as glTF 2.0 (section 3.8) and its samplers define it.

use glam::{DVec2, DVec3, DVec4};

use super::super::perturbation::TexturePerturbation;
use crate::{
    effects::hooks::Finish,
    math::linear_light,
    scene::{
        Material, Primitive, Scene,
        material::{TEXTURE_SLOTS, TextureSlot},
        texture::{Filter, Image, Level, MipFilter, Texture, Wrap, texcoord},
    },
};

/// Most offsets of a lookup along an axis, for each level.
const MAX_OFFSETS: f64 = 12.0;

/// A material as one triangle shows it.
pub struct TriangleMaterial<'a> {
    scene: &'a Scene,
    material: &'a Material,
    /// Those of every slot.
    lookups: [Option<TextureLookup<'a>>; TEXTURE_SLOTS],
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
    /// None for a material that is only a base color, without maps.
    pub fn of(scene: &'a Scene, primitive: &'a Primitive, corners: [u32; 3]) -> Option<Self> {
        let material = &scene.materials[primitive.material];
        if material.is_plain() && material.textures() == [None; TEXTURE_SLOTS] {
            return None;
        }
        let lookup = |slot: TextureSlot| {
            let texcoords = primitive.texcoords[slot as usize].as_ref();
            let (texture, texcoords) = material.texture(slot).zip(texcoords)?;
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
        Some(Self {
            scene,
            material,
            lookups: TextureSlot::ALL.map(lookup),
        })
    }

    /// Offsets of lookups across and down, in error bounds, between which colors change evenly:
    /// both ends, and every middle and edge of a texel that the bounds reach, or some of very many.
    pub fn offsets(&self, at: &SampleWeights) -> [Vec<f64>; 2] {
        [0, 1].map(|axis| {
            let lookups = self.lookups.iter().flatten();
            let inner = lookups.flat_map(|lookup| lookup.offsets(self.scene, at, axis));
            let mut offsets: Vec<f64> = [-1.0, 0.0, 1.0].into_iter().chain(inner).collect();
            // Maps of one size meet their texels together.
            offsets.sort_by(f64::total_cmp);
            offsets.dedup();
            offsets
        })
    }

    /// RGBA of the texture in a slot; none without one.
    fn texel(
        &self,
        slot: TextureSlot,
        at: &SampleWeights,
        perturbation: TexturePerturbation,
    ) -> Option<DVec4> {
        let lookup = self.lookups[slot as usize].as_ref()?;
        Some(lookup.texel(self.scene, at, perturbation))
    }

    /// Alpha of the base color texture; 1 without one.
    pub fn alpha(&self, at: &SampleWeights, perturbation: TexturePerturbation) -> f64 {
        self.texel(TextureSlot::Base, at, perturbation)
            .map_or(1.0, |texel| texel.w)
    }

    /// How it reflects, where its factors alone make `finish`.
    pub fn finish(
        &self,
        mut finish: Finish,
        at: &SampleWeights,
        perturbation: TexturePerturbation,
    ) -> Finish {
        if !self.material.has_finish_maps() {
            return finish;
        }
        if let Some(texel) = self.texel(TextureSlot::Finish, at, perturbation) {
            finish.roughness *= texel.y;
            finish.metallic *= texel.z;
        }
        if let Some(texel) = self.texel(TextureSlot::Occlusion, at, perturbation) {
            let strength = f64::from(self.material.occlusion_strength);
            finish.occlusion = 1.0 + strength * (texel.x - 1.0);
        }
        finish
    }

    /// Where its texture turns the normal: along the tangent, across it and outward, of any length.
    /// None without such a texture.
    pub fn bump(&self, at: &SampleWeights, perturbation: TexturePerturbation) -> Option<DVec3> {
        let texel = self.texel(TextureSlot::Normal, at, perturbation)?;
        let scale = f64::from(self.material.normal_scale);
        Some((texel.truncate() * 2.0 - 1.0) * DVec3::new(scale, scale, 1.0))
    }

    /// Color of a surface with the base color `base`, and the part of it that no light changes.
    pub fn color(
        &self,
        base: DVec3,
        at: &SampleWeights,
        perturbation: TexturePerturbation,
    ) -> (DVec3, DVec3) {
        let looked_up = |slot: TextureSlot| {
            self.texel(slot, at, perturbation)
                .map_or(DVec3::ONE, DVec4::truncate)
        };
        let color = base * looked_up(TextureSlot::Base);
        if self.material.unlit {
            return (color, color);
        }
        let emission = DVec3::from(self.material.emission.map(f64::from));
        let glow = emission * looked_up(TextureSlot::Emission);
        (color + glow, glow)
    }
}

/// Where a texture is looked up.
struct Place {
    uv: DVec2,
    /// Bound of its error.
    uv_error: DVec2,
    /// A pixel spans 2^detail texels.
    detail: f64,
    detail_error: f64,
}

impl TextureLookup<'_> {
    fn place(&self, scene: &Scene, at: &SampleWeights) -> Place {
        let size = DVec2::from(scene.images[self.texture.image].size().map(f64::from));
        let mixed =
            |k: [f64; 3]| self.corners[0] * k[0] + self.corners[1] * k[1] + self.corners[2] * k[2];
        let spans = at.slopes.map(|slope| (mixed(slope) * size).length());
        let uv = mixed(at.weights);
        let from_weights: DVec2 = (0..3)
            .map(|k| (self.corners[k] - uv).abs() * at.errors[k])
            .sum();
        // Corners err by a few roundings; the level of detail by the errors of the weights and by
        // those of its logarithm.
        Place {
            uv,
            uv_error: (from_weights + self.terms / f64::from(1 << 21)).max(DVec2::splat(1e-7)),
            detail: libm::log2(spans[0].max(spans[1]).max(1e-15)),
            detail_error: (1.0 / f64::from(1 << 10) + 4.0 * at.errors.iter().sum::<f64>()).min(1.0),
        }
    }

    /// Linear RGBA.
    fn texel(&self, scene: &Scene, at: &SampleWeights, perturbation: TexturePerturbation) -> DVec4 {
        let place = self.place(scene, at);
        let [across, down, level] = perturbation;
        self.filtered(
            &scene.images[self.texture.image],
            place.uv + place.uv_error * DVec2::new(across, down),
            place.detail + level * place.detail_error,
        )
    }

    /// Offsets along an axis, in error bounds, at which the lookup meets the middle of a texel, and
    /// those between two such.
    fn offsets(&self, scene: &Scene, at: &SampleWeights, axis: usize) -> Vec<f64> {
        let place = self.place(scene, at);
        let levels = &scene.images[self.texture.image].levels;
        // Levels between which the lookup may mix.
        let level = |detail: f64| (detail.max(0.0) as usize).min(levels.len() - 1);
        let used = level(place.detail - place.detail_error)
            ..=(level(place.detail + place.detail_error) + 1).min(levels.len() - 1);
        used.flat_map(|level| {
            let side = f64::from(levels[level].size[axis]);
            let (middle, error) = (place.uv[axis] * side, place.uv_error[axis] * side);
            // In halves of texels: middles, and the edges where the nearest texel changes.
            let first = (2.0 * (middle - error)).ceil();
            let count = ((2.0 * (middle + error)).floor() - first + 1.0).max(0.0);
            let step = (count / MAX_OFFSETS).ceil().max(1.0);
            (0..)
                .map(move |i| f64::from(i) * step)
                .take_while(move |i| *i < count)
                .map(move |i| (0.5 * (first + i) - middle) / error)
        })
        .collect()
    }

    /// The filtered color at texture coordinates `uv`, where a pixel spans 2^detail texels.
    fn filtered(&self, image: &Image, uv: DVec2, detail: f64) -> DVec4 {
        let Image {
            levels, is_data, ..
        } = image;
        let at = |level: f64, filter: Filter| {
            self.level((&levels[level as usize], *is_data), uv, filter)
        };
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

    /// Of one level, and whether it has data.
    fn level(&self, level: (&Level, bool), uv: DVec2, filter: Filter) -> DVec4 {
        let at = uv * DVec2::from(level.0.size.map(f64::from));
        match filter {
            Filter::Nearest => self.stored(level, at.x.floor(), at.y.floor()),
            Filter::Linear => {
                // Texels lie at the centers of their squares.
                let (x, y) = (at.x - 0.5, at.y - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let row = |row: f64| {
                    self.stored(level, left, row)
                        .lerp(self.stored(level, left + 1.0, row), x - left)
                };
                row(top).lerp(row(top + 1.0), y - top)
            }
        }
    }

    fn stored(&self, (level, is_data): (&Level, bool), x: f64, y: f64) -> DVec4 {
        let [width, height] = level.size;
        let [across, down] = self.texture.wrap;
        let (x, y) = (
            wrapped(x as i64, width.into(), across),
            wrapped(y as i64, height.into(), down),
        );
        let texel = level.texels[(y * i64::from(width) + x) as usize];
        let [red, green, blue, alpha] = texel.map(|byte| f64::from(byte) / 255.0);
        let color = DVec3::new(red, green, blue);
        let color = match is_data {
            true => color,
            false => color.map(linear_light),
        };
        color.extend(alpha)
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
