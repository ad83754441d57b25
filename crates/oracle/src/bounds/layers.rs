//! Which pictures of layers are right. An adapter sums f32 colors and weights rounded to whole
//! numbers. Where either answer of a rounding is right, or a float key may lie on either side of
//! the depth window, a pixel has an interval of right answers (`docs/exactness.md` §9). Whether a
//! wider search is worth its time depends on the adapter's answer; what it finds does not.

use glam::{DVec3, DVec4};

use super::{
    super::{
        perturbation::Perturbation,
        render::{
            background::background,
            coverage::{Hit, scatter},
            draw_order::ranks,
            layers::{
                LayerImage, LayerInput, LayerMode, fixed_color, fixed_weight, is_front, steps,
                window_depth, xray_color,
            },
            shadow::Light,
            surface::SurfaceTriangle,
        },
        shot::Shot,
    },
    coverage::depth_interval,
    glass::glass_bounds,
    perturbations::{Search, WIDE_SLACK, color_steps, interpolations, of_layers, textures},
    surface::{CornerErrors, Doubt, SampleErrors},
};
use crate::{
    effects::{Surface, xray, xray::Xray},
    work::Canceled,
};

/// Bound of the error of a shaded f32 color, of 1.
const COLOR_ERROR: f64 = 1.0 / (1 << 16) as f64;

/// Bound of the error of an f32 weight, of 1.
const WEIGHT_ERROR: f64 = 1.0 / (1 << 15) as f64;

/// Right answers for a picture of layers. Images are row-major.
pub struct LayerBounds {
    /// Smallest and largest value of each channel before the last rounding.
    pub colors: Vec<[DVec4; 2]>,
    /// Smallest and largest sum of weights, or number of layers.
    pub counted: Vec<[u64; 2]>,
}

/// The right answers round `image`, without those that only a [wider search](LayerBounds::widen)
/// finds.
pub fn layer_bounds(input: &LayerInput, image: &LayerImage) -> Result<LayerBounds, Canceled> {
    if let LayerMode::Glass(layers) = &image.mode {
        return glass_bounds(input, layers, None);
    }
    let LayerMode::Xray { params, bits } = &image.mode else {
        let colors = image.colors.iter().map(|&color| [color; 2]).collect();
        return Ok(LayerBounds {
            colors,
            counted: image
                .counted
                .iter()
                .map(|&layers| [layers.into(); 2])
                .collect(),
        });
    };
    let sums = sums(input, params, *bits, None)?;
    let rows = Rows::of(input);
    let color = |(i, sum): (usize, &SumBounds)| sum.pixel(i, image, &rows, params, *bits);
    Ok(LayerBounds {
        colors: sums.iter().enumerate().map(color).collect(),
        counted: sums.iter().map(SumBounds::weights).collect(),
    })
}

impl LayerBounds {
    /// Adds the answers at these pixels that are right where interpolated normals and depths err so
    /// far that colors do not change in proportion: hundreds of shades a layer, which are not
    /// computed where the adapter's answer is known to be right without them.
    pub fn widen(
        &mut self,
        input: &LayerInput,
        image: &LayerImage,
        pixels: &[bool],
    ) -> Result<(), Canceled> {
        if let LayerMode::Glass(layers) = &image.mode {
            let wide = glass_bounds(input, layers, Some(pixels))?;
            for (i, _) in pixels.iter().enumerate().filter(|(_, asked)| **asked) {
                self.colors[i] = wide.colors[i];
            }
            return Ok(());
        }
        let LayerMode::Xray { params, bits } = &image.mode else {
            return Ok(());
        };
        let rows = Rows::of(input);
        for (i, sum) in sums(input, params, *bits, Some(pixels))?
            .iter()
            .enumerate()
            .filter(|(i, _)| pixels[*i])
        {
            self.colors[i] = sum.pixel(i, image, &rows, params, *bits);
            self.counted[i] = sum.weights();
        }
        Ok(())
    }
}

/// The background of every row of a picture.
struct Rows {
    background: Vec<DVec4>,
    width: usize,
}

impl Rows {
    fn of(input: &LayerInput) -> Self {
        Self {
            background: background(input.shot.view),
            width: input.shot.view.width as usize,
        }
    }
}

/// A layer whose weight has more than one right answer.
struct AmbiguousLayer {
    colors: [[u64; 3]; 2],
    weights: [u64; 2],
}

/// Bounds of the sums of one pixel.
#[derive(Default)]
struct SumBounds {
    /// Of the layers with a certain weight: smallest and largest sums.
    certain: [[u64; 3]; 2],
    certain_weight: u64,
    ambiguous: Vec<AmbiguousLayer>,
}

/// A layer as f32 may have it.
struct Layer {
    /// Smallest and largest color.
    colors: [DVec3; 2],
    weight: f64,
    weight_error: f64,
    /// It lies inside the depth window whichever way its depth is rounded.
    is_certain: bool,
}

/// How a sample of a layer is shaded to find all that f32 may make of it.
pub(super) struct SampleShade<'a> {
    pub shot: &'a Shot<'a>,
    pub light: Option<&'a Light<'a>>,
    pub rank: f64,
    /// Those of all layers.
    pub perturbations: &'a [Perturbation],
    pub search: Search,
}

impl SampleShade<'_> {
    /// The shaded surface of `known` at a pixel under every perturbation, the exact one first.
    /// `errors` are those of the sample, with whether its side may turn.
    pub fn surfaces(
        &self,
        known: &SurfaceTriangle<'_>,
        (errors, may_turn): (SampleErrors, bool),
        [x, y]: [usize; 2],
    ) -> impl Iterator<Item = Surface> {
        let (scene, stack) = (self.shot.scene, self.shot.stack);
        let lit_point = known.lit_point(&known.surface(x, y, &Perturbation::default()));
        let offsets = match self.search {
            Search::Quick => [Vec::new(), Vec::new()],
            Search::Wide => known.texture_offsets(x, y),
        };
        let turned = color_steps(stack).iter().map(|&color_step| Perturbation {
            is_turned: true,
            color_step,
            ..Perturbation::default()
        });
        let mut all: Vec<Surface> = self
            .perturbations
            .iter()
            .copied()
            .chain(interpolations(stack, errors, self.search))
            .chain(turned.filter(|_| may_turn))
            .chain(textures(scene, stack, &offsets))
            .map(|perturbation| {
                let step = perturbation.color_step;
                let lit = self
                    .light
                    .map_or(0.0, |light| light.arrives(&lit_point, known.id(), step));
                Surface {
                    rank: self.rank,
                    lit,
                    step_offset: step,
                    ..known.surface(x, y, &perturbation)
                }
            })
            .collect();
        stack.shade_all(&mut all, known.scopes, &self.shot.light());
        all.into_iter()
    }
}

/// Bounds of the sums of every pixel; of a wider search, at the pixels for which it is asked.
fn sums(
    input: &LayerInput,
    params: &Xray,
    bits: u32,
    wider_at: Option<&[bool]>,
) -> Result<Vec<SumBounds>, Canceled> {
    let (view, stack) = (input.shot.view, input.shot.stack);
    let mut sums: Vec<SumBounds> = (0..view.pixels()).map(|_| SumBounds::default()).collect();
    let (ranks, light) = (
        ranks(&input.shot, input.geometry)?,
        Light::of(&input.shot, input.geometry),
    );
    let perturbations = of_layers(input.shot.scene, view, stack);
    let (ranks, light, perturbations) = (&ranks, light.as_ref(), &perturbations);
    let search = if wider_at.is_some() {
        Search::Wide
    } else {
        Search::Quick
    };
    scatter(input.tests, input.triangles, view, &mut sums, |triangle| {
        let mut surface: Option<Option<(SurfaceTriangle<'_>, CornerErrors)>> = None;
        let rank = ranks.get(triangle.id as usize).copied().unwrap_or(0.0);
        move |sum: &mut SumBounds, x: usize, y: usize, hit: Hit| {
            let pixel = y * view.width as usize + x;
            if wider_at.is_some_and(|asked| !asked[pixel]) {
                return;
            }
            let threshold = window_depth(input, params, pixel);
            // A depth too small for a normal float has key 1.
            let [low, high] =
                depth_interval(triangle, &hit).map(|depth| depth.max(f64::from(f32::from_bits(1))));
            let is_front = is_front(input, pixel, triangle.id, high);
            if high < threshold && !is_front {
                return;
            }
            let of_triangle = || {
                let known = SurfaceTriangle::new(&input.shot, input.geometry, triangle.id)?;
                Some((
                    known,
                    CornerErrors::of(&input.shot, triangle.id, input.geometry.packed_bits),
                ))
            };
            let Some((known, errors)) = surface.get_or_insert_with(of_triangle) else {
                return;
            };
            let (errors, may_turn) = (errors.at(known, x, y), errors.may_turn(known, x, y));
            let shade = SampleShade {
                shot: &input.shot,
                light,
                rank,
                perturbations,
                search,
            };
            let mut shaded = shade.surfaces(known, (errors, may_turn), [x, y]);
            let exact = shaded.next().expect("the first perturbation is none");
            let color = exact.color.truncate();
            let weight = params.weight_of(&exact);
            let (colors, weights) = shaded.fold(
                ([color; 2], [weight; 2]),
                |([least, most], [lightest, heaviest]), shaded| {
                    let (color, weight) = (shaded.color.truncate(), params.weight_of(&shaded));
                    (
                        [least.min(color), most.max(color)],
                        [lightest.min(weight), heaviest.max(weight)],
                    )
                },
            );
            let slack = if errors.doubt() == Doubt::Wide {
                WIDE_SLACK
            } else {
                0.0
            };
            let (color_slack, weight_slack) = (
                (colors[1] - colors[0]) * slack,
                (weights[1] - weights[0]) * slack,
            );
            let colors = [
                (colors[0] - color_slack).max(DVec3::ZERO),
                colors[1] + color_slack,
            ];
            let weights = [
                (weights[0] - weight_slack).max(0.0),
                (weights[1] + weight_slack).min(f64::from(params.unit())),
            ];
            // On a clipped triangle f32 has a sample's position only to some 2^-16 of its distance.
            let weight_error = match (params.unit() > 1, triangle.is_clipped()) {
                (false, _) => 0.0,
                (true, false) => WEIGHT_ERROR,
                (true, true) => 8.0 * WEIGHT_ERROR,
            };
            sum.add(
                &Layer {
                    colors,
                    weight: 0.5 * (weights[0] + weights[1]),
                    weight_error: weight_error
                        + 0.5 * (weights[1] - weights[0]) / f64::from(xray::FULL_WEIGHT),
                    is_certain: is_front || low >= threshold,
                },
                bits,
            );
        }
    })?;
    Ok(sums)
}

impl SumBounds {
    fn add(&mut self, layer: &Layer, bits: u32) {
        let error = layer.weight_error * f64::from(xray::FULL_WEIGHT);
        let [low, high] = [-error, error].map(|error| fixed_weight(layer.weight, error));
        let colors = [
            fixed_color(layer.colors[0], -COLOR_ERROR, bits),
            fixed_color(layer.colors[1], COLOR_ERROR, bits),
        ];
        if layer.is_certain && low == high {
            for (sums, color) in self.certain.iter_mut().zip(colors) {
                (0..3).for_each(|c| sums[c] += color[c] * low);
            }
            self.certain_weight += low;
        } else {
            self.ambiguous.push(AmbiguousLayer {
                colors,
                weights: [if layer.is_certain { low } else { 0 }, high],
            });
        }
    }

    /// Colors of a pixel between which every right answer lies.
    fn pixel(
        &self,
        i: usize,
        image: &LayerImage,
        rows: &Rows,
        params: &Xray,
        bits: u32,
    ) -> [DVec4; 2] {
        if image.counted[i] == 0 {
            [image.colors[i]; 2]
        } else {
            self.colors(rows.background[i / rows.width], params, bits)
        }
    }

    /// Smallest and largest sum of weights.
    fn weights(&self) -> [u64; 2] {
        [0, 1].map(|end| {
            self.certain_weight
                + self
                    .ambiguous
                    .iter()
                    .map(|layer| layer.weights[end])
                    .sum::<u64>()
        })
    }

    /// Colors between which every right answer lies: both ends of the average with both ends of the
    /// weight.
    fn colors(&self, background: DVec4, params: &Xray, bits: u32) -> [DVec4; 2] {
        let average = |end: End| {
            DVec3::from_array([0, 1, 2].map(|channel| self.average(channel, end) / steps(bits)))
        };
        let corners = [End::Least, End::Most].map(|end| {
            self.weights()
                .map(|weight| xray_color(background, params, average(end), weight))
        });
        let all = corners.as_flattened();
        let fold = |pick: fn(DVec4, DVec4) -> DVec4| {
            all.iter().copied().reduce(pick).expect("four corners")
        };
        [fold(DVec4::min), fold(DVec4::max)]
    }

    /// Smallest or largest average of a channel, in steps. For the largest, layers above the
    /// average weigh as much and those below as little as they may; for the smallest, the other
    /// way round. The average is found by iteration (Dinkelbach 1967).
    fn average(&self, channel: usize, end: End) -> f64 {
        let certain = self.certain[end as usize][channel];
        let mut average = certain as f64 / self.certain_weight.max(1) as f64;
        for _ in 0..32 {
            let (mut sum, mut weight) = (certain, self.certain_weight);
            for layer in &self.ambiguous {
                let color = layer.colors[end as usize][channel];
                let taken =
                    layer.weights[usize::from((color as f64 > average) == (end == End::Most))];
                (sum, weight) = (sum + color * taken, weight + taken);
            }
            let next = sum as f64 / weight.max(1) as f64;
            if next == average {
                break;
            }
            average = next;
        }
        // The last division rounds to the nearest step.
        if self.ambiguous.is_empty() && self.certain[0][channel] == self.certain[1][channel] {
            return xray::average(self.certain[0][channel], self.certain_weight) as f64;
        }
        if end == End::Most {
            (average + 0.5).floor()
        } else {
            (average - 0.5).ceil()
        }
    }
}

/// An end of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Least = 0,
    Most = 1,
}
