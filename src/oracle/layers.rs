//! Layers: what a pixel shows where an effect does not leave it to the nearest triangle alone.
//!
//! Every covered sample is shaded in f64 and added up in u64. An adapter adds f32 colours and weights that were rounded to
//! whole numbers; where either answer of a rounding is right, or a float key may lie on either side of the depth window, the
//! pixel has an interval of right answers, derived without a look at the adapter's.

use glam::{DVec3, DVec4};

use super::{
    coverage::{Coverage, Hit, OrientedTriangle, draw_of, scatter},
    finish,
    light::Light,
    moved::VertexEvaluator,
    order::ranks,
    rules::SampleTests,
    steps::ways,
    surface::{Triangle, encoded},
};
use crate::{
    effects::{
        Stack, Surface,
        hooks::Layers,
        overdraw::Overdraw,
        xray::{self, Xray},
    },
    frame::Geometry,
    math::linear_light,
    scene::{Scene, draw::Draw, view::View},
};

/// Bound of the error of a shaded f32 colour, of 1.
const COLOR_SLACK: f64 = 1.0 / (1 << 16) as f64;

/// Bound of the error of an f32 weight, of 1.
const WEIGHT_SLACK: f64 = 1.0 / (1 << 15) as f64;

/// A picture of layers. Images are row-major.
pub(super) struct Layered {
    /// Gamma-encoded RGBA, each 0 to 1.
    pub colors: Vec<DVec4>,
    /// Least and largest of each channel that is right before the last rounding.
    pub bounds: Vec<[DVec4; 2]>,
    /// Weights or layers per pixel.
    pub counted: Vec<u32>,
    /// Least and largest that is right.
    pub count_bounds: Vec<[u64; 2]>,
}

/// What is to be drawn, and what stands in front of each pixel.
pub(super) struct Scenery<'a> {
    pub scene: &'a Scene,
    pub draws: &'a [Draw],
    pub view: &'a View,
    pub geometry: &'a Geometry,
    pub rules: &'a SampleTests<'a>,
    pub triangles: &'a [OrientedTriangle],
    pub triangle_ids: &'a [u32],
    pub keys: &'a [u32],
}

/// The picture that the effect in the visibility slot makes; none where the nearest triangle is shown.
pub(super) fn layered(scenery: &Scenery, coverage: &Coverage, stack: &Stack) -> Option<Layered> {
    match stack.layers(scenery.scene.triangle_count())? {
        Layers::Xray { bits } => Some(averaged(scenery, stack, &stack.params("xray")?, bits)),
        Layers::Overdraw => Some(heat(scenery.view, coverage, &stack.params("overdraw")?)),
        Layers::Race => None,
    }
}

fn heat(view: &View, coverage: &Coverage, params: &Overdraw) -> Layered {
    let nothing = finish::background(view);
    let color = |layers: u32| {
        let color = params.color(params.heat(layers));
        if layers == 0 { nothing } else { color.extend(1.0) }
    };
    let counted = coverage.layers();
    let colors: Vec<_> = counted.iter().map(|&layers| color(layers)).collect();
    let bounds = colors.iter().map(|&color| [color; 2]).collect();
    let count_bounds = counted.iter().map(|&layers| [layers.into(); 2]).collect();
    Layered { colors, bounds, counted, count_bounds }
}

/// A layer whose weight has more than one right answer.
struct Open {
    colors: [[u64; 3]; 2],
    weights: [u64; 2],
}

/// The sums of one pixel.
#[derive(Default)]
struct CountSamples {
    /// As f64 says.
    sums: [u64; 3],
    weight: u64,
    /// Of layers whose weight is certain: least and largest sums, and the weight.
    sure_sums: [[u64; 3]; 2],
    sure_weight: u64,
    open: Vec<Open>,
}

fn averaged(scenery: &Scenery, stack: &Stack, params: &Xray, bits: u32) -> Layered {
    let tallies = tallies(scenery, stack, params, bits);
    let largest = tallies.iter().map(|tally| tally.weight).max().unwrap_or(0);
    // An overflow anywhere draws the whole picture again with fewer bits.
    if let (true, Some(fewer)) = (largest > xray::capacity(bits).into(), xray::fewer(bits)) {
        return averaged(scenery, stack, params, fewer);
    }
    let whole = f64::from((1u32 << bits) - 1);
    let nothing = finish::background(scenery.view);
    // What shines through is the background as pictures hold it, in whole bytes.
    let [red, green, blue] = [nothing.x, nothing.y, nothing.z].map(linear_light);
    let background = DVec4::new(red, green, blue, nothing.w);
    let mut layered = Layered { colors: Vec::new(), bounds: Vec::new(), counted: Vec::new(), count_bounds: Vec::new() };
    for tally in &tallies {
        let color = if tally.weight == 0 { nothing } else { tally.color(params, background, whole) };
        layered.colors.push(color);
        layered.bounds.push(if tally.weight == 0 { [color; 2] } else { tally.bounds(params, background, whole) });
        layered.counted.push(u32::try_from(tally.weight).unwrap_or(u32::MAX));
        layered.count_bounds.push(tally.weights());
    }
    layered
}

fn tallies(scenery: &Scenery, stack: &Stack, params: &Xray, bits: u32) -> Vec<CountSamples> {
    let Scenery { scene, draws, view, geometry, rules, triangles, triangle_ids, keys } = *scenery;
    let mut tallies: Vec<CountSamples> = (0..view.pixels()).map(|_| CountSamples::default()).collect();
    let width = view.width as usize;
    let (ranks, ways) = (ranks(scene, draws, view, stack, geometry), ways(scene, stack));
    let ways = &ways;
    let light = Light::of(scene, view, stack, geometry);
    let light = light.as_ref();
    scatter(rules, triangles, view, &mut tallies, |triangle| {
        let mut surface: Option<Option<Triangle<'_>>> = None;
        let rank = ranks.get(triangle.id as usize).copied().unwrap_or(0.0);
        move |tally: &mut CountSamples, x: usize, y: usize, hit: Hit| {
            let pixel = y * width + x;
            let least = f64::from(f32::from_bits(params.threshold(keys[pixel], view.linear_depth_m.is_none())));
            let is_front = triangle_ids[pixel] == triangle.id;
            // A depth too small for a key has key 1.
            let [low, high] = hit.interval.map(|depth| depth.max(f64::from(f32::from_bits(1))));
            if high < least && !is_front {
                return;
            }
            let known = surface.get_or_insert_with(|| {
                let draw = draw_of(scene, draws, triangle.id)?;
                Triangle::new(&VertexEvaluator::new(scene, draw, view, stack), scene, view, geometry, triangle.id)
            });
            let Some(known) = known else { return };
            let surface = known.surface(view, x, y, [0.0; 3]);
            let place = known.place(view, &surface);
            let lit = |nudge: f64| light.map_or(0.0, |light| light.arrives(&place, triangle.id, nudge));
            let shaded = stack.shade(Surface { rank, lit: lit(0.0), ..surface });
            // Near a step of colour either side of it is right, and near the edge of a texel.
            let nudged = ways.iter().map(|way| {
                let surface = known.surface(view, x, y, way.aside);
                stack.shade(Surface { rank, lit: lit(way.step), nudge: way.step, ..surface }).color.truncate()
            });
            let ends = nudged.fold([shaded.color.truncate(); 2], |[least, most], color| [least.min(color), most.max(color)]);
            let weight = params.weight_of(&shaded);
            let counts = [is_front || hit.depth >= least, is_front || low >= least];
            // On what clipping left, f32 places a sample only to some 2^-16 of its distance.
            let is_clipped_triangle = triangle.entry != triangle.id as usize;
            let error_bound = match (params.unit() > 1, is_clipped_triangle) {
                (false, _) => 0.0,
                (true, false) => WEIGHT_SLACK,
                (true, true) => 8.0 * WEIGHT_SLACK,
            };
            tally.add(shaded.color.truncate(), ends, weight, error_bound, bits, counts);
        }
    });
    tallies
}

impl CountSamples {
    /// Adds a layer, whose colour lies between `ends`; `counts` says whether it lies inside the window, and whether that
    /// is certain.
    fn add(&mut self, color: DVec3, ends: [DVec3; 2], weight: f64, error_bound: f64, bits: u32, [counts, is_certain]: [bool; 2]) {
        let whole = f64::from((1u32 << bits) - 1);
        let rounded =
            |color: DVec3, error_bound: f64| color.to_array().map(|c| ((c + error_bound).clamp(0.0, 1.0) * whole + 0.5).floor() as u64);
        let error_bound = error_bound * f64::from(xray::FULL_WEIGHT);
        let [weight, low, high] = [0.0, -error_bound, error_bound].map(|nudge| (weight + nudge + 0.5).floor().max(1.0) as u64);
        let (exact, least, most) = (rounded(color, 0.0), rounded(ends[0], -COLOR_SLACK), rounded(ends[1], COLOR_SLACK));
        if counts {
            (0..3).for_each(|c| self.sums[c] += exact[c] * weight);
            self.weight += weight;
        }
        if is_certain && low == high {
            for (sums, color) in self.sure_sums.iter_mut().zip([least, most]) {
                (0..3).for_each(|c| sums[c] += color[c] * weight);
            }
            self.sure_weight += weight;
        } else {
            self.open.push(Open { colors: [least, most], weights: [if is_certain { low } else { 0 }, high] });
        }
    }

    fn color(&self, params: &Xray, background: DVec4, whole: f64) -> DVec4 {
        let average = DVec3::from_array(self.sums.map(|sum| xray::average(sum, self.weight) as f64 / whole));
        encoded(params.seen(average, background, self.weight as f64))
    }

    fn weights(&self) -> [u64; 2] {
        [0, 1].map(|end| self.sure_weight + self.open.iter().map(|open| open.weights[end]).sum::<u64>())
    }

    /// Colours between which every right answer lies: the ends of the average with the ends of the weight.
    fn bounds(&self, params: &Xray, background: DVec4, whole: f64) -> [DVec4; 2] {
        let averages = [0, 1].map(|end| DVec3::from_array([0, 1, 2].map(|channel| self.extreme(channel, end == 1) / whole)));
        let corners = averages.map(|average| self.weights().map(|weight| encoded(params.seen(average, background, weight as f64))));
        let all = corners.as_flattened();
        let fold = |pick: fn(DVec4, DVec4) -> DVec4| all.iter().copied().reduce(pick).expect("four corners");
        [fold(DVec4::min), fold(DVec4::max)]
    }

    /// Least or largest average of a channel, in steps: layers above it weigh as much, those below as little as they may,
    /// or the other way round (Dinkelbach).
    fn extreme(&self, channel: usize, is_most: bool) -> f64 {
        let end = usize::from(is_most);
        let mut average = self.sure_sums[end][channel] as f64 / self.sure_weight.max(1) as f64;
        for _ in 0..32 {
            let (mut sum, mut weight) = (self.sure_sums[end][channel], self.sure_weight);
            for open in &self.open {
                let color = open.colors[end][channel];
                let taken = open.weights[usize::from((color as f64 > average) == is_most)];
                (sum, weight) = (sum + color * taken, weight + taken);
            }
            let next = sum as f64 / weight.max(1) as f64;
            if next == average {
                break;
            }
            average = next;
        }
        // The last division rounds to the nearest step.
        if self.open.is_empty() && self.sure_sums[0][channel] == self.sure_sums[1][channel] {
            return xray::average(self.sure_sums[0][channel], self.sure_weight) as f64;
        }
        if is_most { (average + 0.5).floor() } else { (average - 0.5).ceil() }
    }
}
