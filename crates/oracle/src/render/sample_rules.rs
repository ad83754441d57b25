//! Sample tests: which covered samples are drawn, by the sample effects of the stack, masks, discs
//! and the draw order. Integers alone decide.

use std::ops::Range;

use super::{
    super::shot::{Shot, draw_of},
    mask,
    triangles::OrientedTriangle,
};
use crate::{
    effects::{
        Stack,
        hooks::{Sample, SampleHook, Shape},
    },
    frame::Geometry,
    math::UNITS_PER_PIXEL,
    scene::{Scene, draw::Draw},
};

/// The sample tests of a stack, with what they know of each triangle.
pub struct SampleTests<'a> {
    effects: Vec<EffectTest<'a>>,
    sample_setups: &'a [[u32; 4]],
    /// Setups of effects per entry; those of masks follow them.
    effect_setups: usize,
    /// The scene whose materials may mask samples out.
    masked: Option<(&'a Scene, &'a [Draw])>,
    /// The scene on whose parts effects with a scope act.
    scoped: Option<(&'a Scene, &'a [Draw])>,
    /// What triangles cover.
    pub shape: Shape,
    /// Radius of discs round corners, in sub-pixel units.
    pub radius: i64,
    /// Ids of the triangles of which only the inscribed disc is drawn: particles.
    discs: Range<u32>,
    /// Sub-pixel units in a pixel.
    pub unit: i64,
    /// Depth keys are quotients of integers.
    pub has_integer_keys: bool,
    /// Where a draw order stops, in a picture of this many pixels a row.
    limit: Option<(DrawLimit, u32)>,
}

/// What leaves a covered sample out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut<'a> {
    /// It comes after the limit of the draw order.
    DrawOrder,
    /// It lies outside the disc of a particle.
    Disc,
    /// The sample effect of this name.
    Effect(&'a str),
    /// The mask of the material.
    Mask,
}

struct EffectTest<'a> {
    name: &'a str,
    hook: &'a SampleHook,
    words: &'a [u32],
    /// Index among the setups of an entry; none for an effect without one.
    setup: Option<usize>,
    /// Its bit in [`Draw::scopes`]; none for an effect on the whole scene.
    scope: Option<u32>,
}

/// Where a draw order stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawLimit {
    /// Triangles before this one are drawn completely, those after it not at all.
    pub boundary_triangle: u32,
    /// Of its own samples, those before this pixel (row-major) are drawn.
    pub pixel: usize,
    /// Number of samples that are drawn.
    pub limit: u64,
    /// Number of samples there are.
    pub total: u64,
}

impl Default for SampleTests<'_> {
    /// Draws every covered sample of plain triangles.
    fn default() -> Self {
        Self {
            effects: Vec::new(),
            sample_setups: &[],
            effect_setups: 0,
            masked: None,
            scoped: None,
            shape: Shape::default(),
            radius: 0,
            discs: 0..0,
            unit: UNITS_PER_PIXEL.into(),
            has_integer_keys: false,
            limit: None,
        }
    }
}

impl<'a> SampleTests<'a> {
    /// The tests of a picture, with the setups that `geometry` carries.
    pub fn new(shot: &Shot<'a>, geometry: &'a Geometry) -> Self {
        let masked = mask::is_masked(shot.scene, shot.stack).then_some((shot.scene, shot.draws));
        let tests = Self::of_effects(shot.stack, geometry);
        let scoped = tests
            .effects
            .iter()
            .any(|effect| effect.scope.is_some())
            .then_some((shot.scene, shot.draws));
        Self {
            masked,
            scoped,
            ..tests
        }
    }

    /// The tests of a stack alone, without masks and without effects that have a scope.
    pub fn of_effects(stack: &'a Stack, geometry: &'a Geometry) -> Self {
        let mut effect_setups = 0;
        let effects = stack
            .0
            .iter()
            .zip(stack.scope_bits())
            .filter_map(|(enabled, scope)| {
                let hook = enabled.effect.hooks.sample.as_ref()?;
                let setup = hook.has_setup.then_some(effect_setups);
                effect_setups += usize::from(hook.has_setup);
                Some(EffectTest {
                    name: &enabled.effect.name,
                    hook,
                    words: &enabled.words,
                    setup,
                    scope,
                })
            })
            .collect();
        Self {
            effects,
            sample_setups: &geometry.sample_setups,
            effect_setups,
            shape: stack.shape(),
            radius: stack.point_radius().into(),
            // Boxes and points replace triangles, so there are no discs.
            discs: if stack.shape() == Shape::Triangles {
                geometry.particle_discs.clone()
            } else {
                0..0
            },
            unit: 1 << geometry.subpixel_bits,
            has_integer_keys: geometry.bit_exact.depth_keys,
            ..Self::default()
        }
    }

    /// The same tests up to a draw limit, in a picture `width` pixels wide.
    pub fn up_to(self, limit: Option<DrawLimit>, width: u32) -> Self {
        Self {
            limit: limit.map(|limit| (limit, width)),
            ..self
        }
    }

    /// Where a draw order stops.
    pub fn limit(&self) -> Option<DrawLimit> {
        self.limit.map(|(limit, _)| limit)
    }

    fn is_within_limit(&self, id: u32, x: u32, y: u32) -> bool {
        self.limit.is_none_or(|(limit, width)| {
            let pixel = y as usize * width as usize + x as usize;
            id < limit.boundary_triangle || id == limit.boundary_triangle && pixel < limit.pixel
        })
    }

    /// Returns true if a covered sample is drawn. `weights` are the doubled areas opposite the
    /// corners of the oriented triangle.
    pub fn is_drawn(&self, triangle: &OrientedTriangle, x: u32, y: u32, weights: [i64; 3]) -> bool {
        self.left_out_by(triangle, x, y, weights).is_none()
    }

    /// What leaves a covered sample out; none if it is drawn.
    pub fn left_out_by(
        &self,
        triangle: &OrientedTriangle,
        x: u32,
        y: u32,
        weights: [i64; 3],
    ) -> Option<LeftOut<'a>> {
        if self.are_simple() {
            return (!self.is_within_limit(triangle.id, x, y)).then_some(LeftOut::DrawOrder);
        }
        self.left_out_in_row(triangle, y, &[(x, weights)])[0]
    }

    /// Does nothing but a draw order leave samples out?
    pub fn are_simple(&self) -> bool {
        self.effects.is_empty() && self.masked.is_none() && self.discs.is_empty()
    }

    /// The same of several samples in a row, each with its column and weights.
    pub fn left_out_in_row(
        &self,
        triangle: &OrientedTriangle,
        y: u32,
        row: &[(u32, [i64; 3])],
    ) -> Vec<Option<LeftOut<'a>>> {
        let is_disc = self.discs.contains(&triangle.id);
        let sample = |&(x, weights): &(u32, [i64; 3])| {
            let area: i64 = weights.iter().sum();
            let shift = (64 - area.unsigned_abs().leading_zeros()).saturating_sub(31);
            let part = |weight: i64| (weight.max(0) >> shift) as u32;
            Sample {
                x,
                y,
                triangle: triangle.id,
                areas: triangle.in_file_order(weights.map(part)),
                setup: [0; 4],
            }
        };
        let mut samples: Vec<Sample> = row.iter().map(sample).collect();
        let mut left_out: Vec<Option<LeftOut<'a>>> = samples
            .iter()
            .map(|sample| {
                if !self.is_within_limit(triangle.id, sample.x, y) {
                    return Some(LeftOut::DrawOrder);
                }
                // A disc that would have to be clipped is not drawn.
                let is_left = is_disc && (triangle.is_clipped() || !is_in_disc(sample.areas));
                is_left.then_some(LeftOut::Disc)
            })
            .collect();
        if self.effects.is_empty() && self.masked.is_none() {
            return left_out;
        }
        let records = self.effect_setups
            + if self.masked.is_some() {
                mask::RECORDS
            } else {
                0
            };
        let setups = &self.sample_setups[triangle.entry * records..][..records];
        let scopes = self.scoped.map_or(0, |(scene, draws)| {
            draw_of(scene, draws, triangle.id).map_or(0, |draw| draw.scopes)
        });
        for effect in &self.effects {
            if effect.scope.is_some_and(|bit| scopes >> bit & 1 == 0) {
                continue;
            }
            let setup = effect.setup.map_or([0; 4], |index| setups[index]);
            samples.iter_mut().for_each(|sample| sample.setup = setup);
            let mut drawn = vec![true; samples.len()];
            (effect.hook.is_drawn)(&samples, effect.words, &mut drawn);
            for (left_out, is_drawn) in left_out.iter_mut().zip(drawn) {
                *left_out = left_out.or((!is_drawn).then_some(LeftOut::Effect(effect.name)));
            }
        }
        if let Some((scene, draws)) = self.masked {
            let draw = draw_of(scene, draws, triangle.id).expect("a triangle belongs to a draw");
            let primitive = &scene.primitives[draw.primitive];
            let setups = &setups[self.effect_setups..];
            for (left_out, sample) in left_out.iter_mut().zip(&samples) {
                if left_out.is_none()
                    && !mask::is_drawn(scene, primitive, triangle, sample.areas, setups)
                {
                    *left_out = Some(LeftOut::Mask);
                }
            }
        }
        left_out
    }
}

/// Returns true in the ellipse that touches the sides of a triangle at their midpoints, given the
/// areas opposite the corners. The fractions a, b, c of the whole are then at most as unequal as at
/// such a midpoint, 1/2, 1/2 and 0: a² + b² + c² <= (a + b + c)² / 2.
fn is_in_disc(parts: [u32; 3]) -> bool {
    let squares: u128 = parts.iter().map(|&part| u128::from(part).pow(2)).sum();
    let whole: u128 = parts.iter().map(|&part| u128::from(part)).sum();
    2 * squares <= whole * whole
}
