//! SampleTests: which covered samples are drawn, by the sample effects of the stack. Integers alone.

use super::{
    coverage::{OrientedTriangle, draw_of},
    mask,
    order::{self, Cut},
};
use crate::{
    effects::{
        Stack,
        hooks::{Sample, SampleHook, Shape},
    },
    frame::Geometry,
    math::UNITS_PER_PIXEL,
    scene::{Scene, draw::Draw, view::View},
};

/// The sample effects of a stack with what they settled per triangle.
pub struct SampleTests<'a> {
    effects: Vec<Link<'a>>,
    sample_setups: &'a [[u32; 4]],
    /// Effects that decide, and so decisions per entry.
    deciding: usize,
    /// Whose materials may leave samples out.
    masked: Option<(&'a Scene, &'a [Draw])>,
    /// What triangles cover.
    pub(super) shape: Shape,
    /// Radius of discs about corners, in units.
    pub(super) radius: i64,
    /// Ids of the triangles of which only a disc is drawn.
    discs: std::ops::Range<u32>,
    /// Units in a pixel.
    pub(super) unit: i64,
    /// Depth keys are quotients of integers.
    pub(super) integer_keys: bool,
    /// Where a draw order stops, in a picture so many pixels wide.
    cut: Option<(Cut, u32)>,
}

struct Link<'a> {
    hook: SampleHook,
    words: &'a [u32],
    /// Place among the effects that decide.
    place: Option<usize>,
}

impl Default for SampleTests<'_> {
    fn default() -> Self {
        let unit = UNITS_PER_PIXEL.into();
        Self {
            effects: Vec::new(),
            sample_setups: &[],
            deciding: 0,
            masked: None,
            shape: Shape::default(),
            radius: 0,
            discs: 0..0,
            unit,
            integer_keys: false,
            cut: None,
        }
    }
}

impl<'a> SampleTests<'a> {
    /// The rules of `stack`, with the decisions that `geometry` carries.
    pub fn of(stack: &'a Stack, geometry: &'a Geometry) -> Self {
        let mut deciding = 0;
        let effects = stack
            .each(|hooks| hooks.sample)
            .map(|(hook, words)| {
                let place = hook.has_setup.then_some(deciding);
                deciding += usize::from(hook.has_setup);
                Link { hook, words, place }
            })
            .collect();
        Self {
            effects,
            sample_setups: &geometry.sample_setups,
            deciding,
            masked: None,
            shape: stack.shape(),
            radius: stack.point_radius().into(),
            // What fills boxes or draws corners shows no triangles.
            discs: if stack.shape() == Shape::Triangles { geometry.particle_discs.clone() } else { 0..0 },
            unit: 1 << geometry.subpixel_bits,
            integer_keys: geometry.exact.keys,
            cut: None,
        }
    }

    /// The same, where the materials of a scene may leave samples out, too.
    pub fn masked(mut self, scene: &'a Scene, draws: &'a [Draw], stack: &Stack) -> Self {
        self.masked = mask::is_there(scene, stack).then_some((scene, draws));
        self
    }

    /// The same, up to where the draw order of `stack` stops the drawing of these triangles.
    pub fn ordered(mut self, stack: &Stack, triangles: &[OrientedTriangle], view: &View) -> Self {
        self.cut = order::cut(stack, &self, triangles, view).map(|cut| (cut, view.width));
        self
    }

    /// Where a draw order stops.
    pub fn cut(&self) -> Option<Cut> {
        self.cut.map(|(cut, _)| cut)
    }

    fn is_in_order(&self, id: u32, x: u32, y: u32) -> bool {
        self.cut
            .is_none_or(|(cut, width)| id < cut.straddler || id == cut.straddler && (y as usize * width as usize + x as usize) < cut.pixel)
    }

    /// Is a covered sample drawn? `weights` are the doubled areas opposite the corners of the oriented triangle.
    pub(super) fn is_drawn(&self, triangle: &OrientedTriangle, x: u32, y: u32, weights: [i64; 3]) -> bool {
        if !self.is_in_order(triangle.id, x, y) {
            return false;
        }
        let is_disc = self.discs.contains(&triangle.id);
        if self.effects.is_empty() && self.masked.is_none() && !is_disc {
            return true;
        }
        let area: i64 = weights.iter().sum();
        let shift = (64 - area.unsigned_abs().leading_zeros()).saturating_sub(31);
        let mut parts = weights.map(|weight| (weight.max(0) >> shift) as u32);
        if triangle.is_turned {
            parts.swap(1, 2);
        }
        // A splat that had to be cut is not drawn.
        if is_disc && (triangle.entry != triangle.id as usize || !is_in_disc(parts)) {
            return false;
        }
        let records = self.deciding + if self.masked.is_some() { mask::RECORDS } else { 0 };
        let settled = &self.sample_setups[triangle.entry * records..][..records];
        let is_left = self.effects.iter().all(|link| {
            let decided = link.place.map_or([0; 4], |place| settled[place]);
            (link.hook.is_drawn)(&Sample { x, y, triangle: triangle.id, parts, decided }, link.words)
        });
        is_left
            && self.masked.is_none_or(|(scene, draws)| {
                let draw = draw_of(scene, draws, triangle.id).expect("a triangle belongs to a draw");
                mask::is_drawn(scene, &scene.primitives[draw.primitive], triangle, parts, &settled[self.deciding..])
            })
    }
}

/// Does a sample lie in the ellipse that touches the sides of its triangle in their middles? Its shares a, b, c of the whole
/// then are at most as unequal as those of the middle of a side, 1/2, 1/2 and 0: a² + b² + c² <= (a + b + c)² / 2.
fn is_in_disc(parts: [u32; 3]) -> bool {
    let squares: u128 = parts.iter().map(|&part| u128::from(part).pow(2)).sum();
    let whole: u128 = parts.iter().map(|&part| u128::from(part)).sum();
    2 * squares <= whole * whole
}
