//! Right colors near steps of color (`docs/exactness.md` §9): a value that f64 puts on one side of a step may lie on the other in
//! f32, and then either answer is right.
//!
//! An effect decides a step on a value plus [`Perturbation::color_step`], so shading with a small perturbation to either side finds
//! the pixels that lie so near a step: the step band. It does not depend on the adapter's picture; it is counted, and a
//! [`Budget`](crate::measure::Budget) limits it. Texture lookups are perturbed in the same way; there, values between the answers
//! are right as well.

use std::collections::{HashMap, HashSet};

use super::{
    super::{
        perturbation::Perturbation,
        render::{
            layers::LayerImage,
            resolve::{ResolveInput, background, finish, shade_perturbed},
            surface::{each_surface, surface_colors},
        },
        shot::Shot,
    },
    layers::LayerBounds,
    perturbations::{color_steps, has_textures, interpolations, is_far, perturbations},
};
use crate::frame::{Geometry, NO_TRIANGLE};

/// The pictures that are right.
pub struct AcceptedColors {
    /// The exact picture first.
    pictures: Vec<Vec<[u8; 4]>>,
    /// Values between the pictures are right too.
    is_span: bool,
    /// Pictures that belong to the same perturbation of color steps.
    per_step: usize,
    /// Smallest and largest right color of pixels where what is interpolated is in doubt.
    unsure: HashMap<usize, [[u8; 4]; 2]>,
}

impl AcceptedColors {
    /// Of a picture that shows the nearest triangle of each pixel.
    pub fn of_surfaces(shot: &Shot, input: &ResolveInput, geometry: &Geometry) -> Self {
        let shaded = |perturbation: &Perturbation| shade_perturbed(shot, input, geometry, perturbation);
        // Taps of a shadow map change one by one, so any fraction between the extremes is right.
        let is_span = has_textures(shot.scene) || is_far(shot.view) || shot.stack.light().is_some();
        let pictures: Vec<_> = perturbations(shot.scene, shot.view, shot.stack).iter().map(shaded).collect();
        let per_step = pictures.len() / color_steps(shot.stack).len();
        Self { pictures, is_span, per_step, unsure: HashMap::new() }
    }

    /// Of a picture of layers.
    pub fn of_layers(shot: &Shot, input: &ResolveInput, image: &LayerImage, bounds: &LayerBounds) -> Self {
        let ends = [0, 1].map(|end| bounds.colors.iter().map(|bounds| bounds[end]).collect::<Vec<_>>());
        let finished = |&step: &f64| [&image.colors, &ends[0], &ends[1]].map(|colors| finish(shot, input, colors, step));
        Self { pictures: color_steps(shot.stack).iter().flat_map(finished).collect(), is_span: true, per_step: 3, unsure: HashMap::new() }
    }

    /// Adds what is right where interpolated normals and depths err, at the pixels where `adapter` has another color. Those of other
    /// pixels are not asked for, which saves most of the work. A color that follows from a normal or a depth of which almost nothing is
    /// known may be any.
    pub fn with_interpolations(mut self, shot: &Shot, input: &ResolveInput, geometry: &Geometry, adapter: &[[u8; 4]]) -> Self {
        let nearest = self.nearest(adapter);
        let differs = |i: &usize| (0..4).any(|c| nearest[*i][c].abs_diff(adapter[*i][c]) > 1);
        let pixels: Vec<usize> = (0..adapter.len()).filter(differs).collect();
        if pixels.is_empty() {
            return self;
        }
        let mut triangle_ids = vec![NO_TRIANGLE; adapter.len()];
        pixels.iter().for_each(|&i| triangle_ids[i] = input.triangle_ids[i]);
        let pictures: Vec<_> = interpolations(shot.stack)
            .iter()
            .map(|perturbation| {
                let colors = surface_colors(shot, &triangle_ids, background(shot.view), geometry, perturbation);
                finish(shot, input, &colors, perturbation.color_step)
            })
            .collect();
        let is_unknown = each_surface(shot, &triangle_ids, geometry, &Perturbation::default(), |found| {
            found.is_some_and(|(triangle, surface)| triangle.is_unknown(surface.pixel))
        });
        let span = |i: usize| {
            let answers = || self.pictures.iter().chain(&pictures).map(|picture| picture[i]);
            if is_unknown[i] && pictures.iter().any(|picture| picture[i] != self.pictures[0][i]) {
                return [[u8::MIN; 4], [u8::MAX; 4]];
            }
            [u8::min, u8::max]
                .map(|pick: fn(u8, u8) -> u8| [0, 1, 2, 3].map(|c| answers().map(|a| a[c]).reduce(pick).expect("there is an answer")))
        };
        self.unsure = pixels.into_iter().map(|i| (i, span(i))).collect();
        self
    }

    /// The exact picture.
    pub fn exact(&self) -> Vec<[u8; 4]> {
        self.pictures[0].clone()
    }

    /// For every channel, the right answer nearest to the adapter's.
    pub fn nearest(&self, adapter: &[[u8; 4]]) -> Vec<[u8; 4]> {
        let channel = |i: usize, c: usize| {
            if let Some([least, most]) = self.unsure.get(&i) {
                return adapter[i][c].clamp(least[c], most[c]);
            }
            let answers = self.pictures.iter().map(|picture| picture[i][c]);
            if self.is_span {
                let (least, most) = answers.fold((u8::MAX, u8::MIN), |(least, most), answer| (least.min(answer), most.max(answer)));
                return adapter[i][c].clamp(least, most);
            }
            answers.min_by_key(|answer| answer.abs_diff(adapter[i][c])).expect("there is an answer")
        };
        (0..adapter.len()).map(|i| [0, 1, 2, 3].map(|c| channel(i, c))).collect()
    }

    /// The picture of every perturbation of color steps, without other perturbations; the exact one first.
    fn at_steps(&self) -> Vec<&Vec<[u8; 4]>> {
        self.pictures.iter().step_by(self.per_step).collect()
    }

    /// Number of different sets of right colors in the step band: a flat area on a step is one.
    pub fn step_band_colors(&self) -> u64 {
        let answers = self.at_steps();
        let pixels = self.step_band().into_iter().enumerate().filter(|(_, is_band)| *is_band);
        let sets: HashSet<Vec<[u8; 4]>> = pixels.map(|(i, _)| answers.iter().map(|answer| answer[i]).collect()).collect();
        sets.len() as u64
    }

    /// The step band: pixels with answers more than 1 of 255 apart because of a step of color. Empty without steps.
    pub fn step_band(&self) -> Vec<bool> {
        let answers = self.at_steps();
        let [exact, others @ ..] = answers.as_slice() else { return Vec::new() };
        if others.is_empty() {
            return Vec::new();
        }
        let differs = |i: usize| others.iter().any(|other| (0..4).any(|c| other[i][c].abs_diff(exact[i][c]) > 1));
        (0..exact.len()).map(differs).collect()
    }
}
