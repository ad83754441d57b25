//! Right colors near steps of color (`docs/exactness.md` §9): a value that f64 puts on one side of
//! a step may lie on the other in f32, and then either answer is right.
//!
//! An effect decides a step on a value plus [`Perturbation::color_step`], so shading with a small
//! perturbation to either side finds the pixels that lie so near a step: the step band. It does not
//! depend on the adapter's picture; it is counted, and a [`Budget`](crate::measure::Budget) limits
//! it. Texture lookups are perturbed in the same way; there, values between the answers
//! are right as well.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::{
    super::{
        perturbation::Perturbation,
        render::{
            background::background,
            draw_order::ranks,
            layers::LayerImage,
            resolve::{
                Finish, PictureTables, ResolveInput, at_ties, finish, finish_at_ties,
                shade_perturbed,
            },
            shading::{encoded, lit_surface},
            shadow::Light,
            surface::SurfaceTriangle,
        },
        shot::Shot,
    },
    layers::LayerBounds,
    perturbations::{
        Search, WIDE_SLACK, color_steps, interpolations, of_pictures, places, textures,
    },
    surface::{CornerErrors, Doubt},
};
use crate::{
    effects::Surface,
    frame::Geometry,
    measure::Budget,
    work::{Canceled, map_each},
};

/// The pictures that are right.
pub struct AcceptedColors {
    /// The exact picture first.
    pictures: Vec<Vec<[u8; 4]>>,
    /// Values between the pictures are right too.
    is_span: bool,
    /// Pictures that belong to the same perturbation of color steps.
    per_step: usize,
    /// Smallest and largest right color of pixels where the adapter has another color than all
    /// pictures.
    unsure: HashMap<usize, [[u8; 4]; 2]>,
    unsure_pixels: u64,
}

/// Smallest and largest value of every channel; none of no colors.
fn span(colors: impl Iterator<Item = [u8; 4]>) -> Option<[[u8; 4]; 2]> {
    let both =
        |pick: fn(u8, u8) -> u8, a: [u8; 4], b: [u8; 4]| [0, 1, 2, 3].map(|c| pick(a[c], b[c]));
    colors
        .map(|color| [color; 2])
        .reduce(|a, b| [both(u8::min, a[0], b[0]), both(u8::max, a[1], b[1])])
}

impl AcceptedColors {
    /// Of a picture that shows the nearest triangle of each pixel.
    pub fn of_surfaces(
        shot: &Shot,
        input: &ResolveInput,
        geometry: &Geometry,
    ) -> Result<Self, Canceled> {
        let shaded =
            |perturbation: &Perturbation| shade_perturbed(shot, input, geometry, perturbation);
        // Taps of a shadow map change one by one, so any fraction between the extremes is right.
        let is_span = !shot.scene.images.is_empty() || shot.stack.light().is_some();
        let pictures = of_pictures(shot.scene, shot.stack)
            .iter()
            .map(shaded)
            .collect::<Result<Vec<_>, _>>()?;
        let per_step = pictures.len() / color_steps(shot.stack).len();
        Ok(Self {
            pictures,
            is_span,
            per_step,
            unsure: HashMap::new(),
            unsure_pixels: 0,
        })
    }

    /// Of a picture of layers.
    pub fn of_layers(
        shot: &Shot,
        input: &ResolveInput,
        image: &LayerImage,
        bounds: &LayerBounds,
    ) -> Result<Self, Canceled> {
        let ends = [0, 1].map(|end| {
            bounds
                .colors
                .iter()
                .map(|bounds| bounds[end])
                .collect::<Vec<_>>()
        });
        // The exact picture comes first, then those between which every right one lies.
        let mut pictures = Vec::new();
        for &step in color_steps(shot.stack) {
            pictures.push(finish(shot, input, &image.colors, step)?);
            for colors in [&image.colors, &ends[0], &ends[1]] {
                pictures.extend(finish_at_ties(shot, input, colors, step)?);
            }
        }
        Ok(Self {
            pictures,
            is_span: true,
            per_step: 7,
            unsure: HashMap::new(),
            unsure_pixels: 0,
        })
    }

    /// Adds what is right where places and interpolated normals and depths err, at the pixels where
    /// `adapter` has another color. Those of other pixels are not asked for, which saves most
    /// of the work.
    pub fn with_interpolations(
        mut self,
        shot: &Shot,
        input: &ResolveInput,
        geometry: &Geometry,
        adapter: &[[u8; 4]],
    ) -> Result<Self, Canceled> {
        let nearest = self.nearest(adapter);
        let difference = |i: usize| {
            (0..4)
                .map(|c| nearest[i][c].abs_diff(adapter[i][c]))
                .max()
                .unwrap_or(0)
        };
        // Of one step, only where they are more than any picture may have.
        let of_one_step = (0..adapter.len()).filter(|&i| difference(i) == 1).count() as u64;
        let least = if of_one_step > Budget::ROUNDING_PIXELS {
            1
        } else {
            2
        };
        let pixels: Vec<usize> = (0..adapter.len())
            .filter(|&i| difference(i) >= least)
            .collect();
        if pixels.is_empty() {
            return Ok(self);
        }
        let (ranks, light) = (ranks(shot, geometry)?, Light::of(shot, geometry));
        let tables = PictureTables::of(shot);
        let (finish, background) = (Finish::new(shot, input, &tables), background(shot.view));
        let right = |&i: &usize| {
            let id = input.triangle_ids[i];
            let (x, y) = (i % shot.view.width as usize, i / shot.view.width as usize);
            let known = span(self.pictures.iter().map(|picture| picture[i]))?;
            let Some(triangle) = SurfaceTriangle::new(shot, geometry, id) else {
                let steps = color_steps(shot.stack).iter();
                let colors = finish.colors(steps.map(|&step| (i, background[y], step)));
                let all = span(
                    known
                        .into_iter()
                        .chain(colors.into_iter().flat_map(at_ties)),
                )?;
                return (all != known).then_some((i, all));
            };
            let corners = CornerErrors::of(shot, id, geometry.packed_bits);
            let (errors, may_turn) = (
                corners.at(&triangle, x, y),
                corners.may_turn(&triangle, x, y),
            );
            let rank = ranks.get(id as usize).copied().unwrap_or(0.0);
            let finished = |perturbations: &mut dyn Iterator<Item = Perturbation>| {
                let lit = |perturbation: Perturbation| {
                    let surface = triangle.surface(x, y, &perturbation);
                    let surface = Surface { rank, ..surface };
                    lit_surface(&triangle, surface, light.as_ref(), perturbation.color_step)
                };
                let mut surfaces: Vec<Surface> = perturbations.map(lit).collect();
                let steps: Vec<f64> = surfaces.iter().map(|s| s.step_offset).collect();
                shot.stack
                    .shade_all(&mut surfaces, triangle.scopes, &shot.light());
                let colors = surfaces.iter().map(|surface| encoded(surface.color));
                let finished = finish.colors(colors.zip(steps).map(|(c, step)| (i, c, step)));
                finished.into_iter().flat_map(at_ties)
            };
            let on_either_side = |perturbation: Perturbation| {
                [false, true]
                    .into_iter()
                    .filter(|&is_turned| !is_turned || may_turn)
                    .map(move |is_turned| Perturbation {
                        is_turned,
                        ..perturbation
                    })
            };
            let offsets = triangle.texture_offsets(x, y);
            let mut around = interpolations(shot.stack, errors, Search::Wide)
                .chain(places(shot.stack).filter(|_| may_turn))
                .flat_map(on_either_side)
                .chain(textures(shot.scene, shot.stack, &offsets));
            let [least, most] = span(finished(&mut around)).unwrap_or([self.pictures[0][i]; 2]);
            let slack = |c: usize| {
                if errors.doubt() == Doubt::Wide {
                    (f64::from(most[c] - least[c]) * WIDE_SLACK).ceil() as u8
                } else {
                    0
                }
            };
            let wide = [
                [0, 1, 2, 3].map(|c| least[c].saturating_sub(slack(c))),
                [0, 1, 2, 3].map(|c| most[c].saturating_add(slack(c))),
            ];
            let all = span(
                known
                    .into_iter()
                    .chain(wide)
                    .chain(finished(&mut places(shot.stack))),
            )?;
            (all != known).then_some((i, all))
        };
        self.unsure = map_each(pixels.par_iter(), right)?
            .into_iter()
            .flatten()
            .collect();
        self.unsure_pixels = self.unsure.keys().filter(|&&i| difference(i) > 1).count() as u64;
        Ok(self)
    }

    /// Number of pixels whose color, more than a step of 255 away, only the errors of places and of
    /// interpolated normals and depths explain.
    pub fn unsure_pixels(&self) -> u64 {
        self.unsure_pixels
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
                let (least, most) = answers.fold((u8::MAX, u8::MIN), |(least, most), answer| {
                    (least.min(answer), most.max(answer))
                });
                return adapter[i][c].clamp(least, most);
            }
            answers
                .min_by_key(|answer| answer.abs_diff(adapter[i][c]))
                .expect("there is an answer")
        };
        (0..adapter.len())
            .map(|i| [0, 1, 2, 3].map(|c| channel(i, c)))
            .collect()
    }

    /// The picture of every perturbation of color steps, without other perturbations; the exact one
    /// first.
    fn at_steps(&self) -> Vec<&Vec<[u8; 4]>> {
        self.pictures.iter().step_by(self.per_step).collect()
    }

    /// Number of different sets of right colors in the step band. An area of one tone that lies on
    /// a step counts once: as one set, however many triangles it has, or as one triangle, where
    /// an effect draws lines on it that give its pixels different sets.
    pub fn step_band_colors(&self, shot: &Shot, geometry: &Geometry, triangle_ids: &[u32]) -> u64 {
        let answers = self.at_steps();
        let mut known = HashMap::new();
        let mut is_flat = |id: u32| {
            *known.entry(id).or_insert_with(|| {
                SurfaceTriangle::new(shot, geometry, id).is_some_and(|triangle| triangle.is_flat())
            })
        };
        let (mut flat_triangles, mut flat_sets, mut sets) =
            (HashSet::new(), HashSet::new(), HashSet::new());
        for (i, _) in self
            .step_band()
            .into_iter()
            .enumerate()
            .filter(|(_, is_band)| *is_band)
        {
            let set: Vec<[u8; 4]> = answers.iter().map(|answer| answer[i]).collect();
            if is_flat(triangle_ids[i]) {
                flat_triangles.insert(triangle_ids[i]);
                flat_sets.insert(set);
            } else {
                sets.insert(set);
            }
        }
        (flat_triangles.len().min(flat_sets.len()) + sets.len()) as u64
    }

    /// The step band: pixels with answers more than 1 of 255 apart because of a step of color.
    /// Empty without steps.
    pub fn step_band(&self) -> Vec<bool> {
        let answers = self.at_steps();
        let [exact, others @ ..] = answers.as_slice() else {
            return Vec::new();
        };
        if others.is_empty() {
            return Vec::new();
        }
        let differs = |i: usize| {
            others
                .iter()
                .any(|other| (0..4).any(|c| other[i][c].abs_diff(exact[i][c]) > 1))
        };
        (0..exact.len()).map(differs).collect()
    }
}
