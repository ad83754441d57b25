//! Draw order: how many samples each triangle has, where a limit falls, and which share of all comes before a triangle.

use rayon::prelude::*;

use super::{
    coverage::{OrientedTriangle, triangles},
    rules::SampleTests,
};
use crate::{
    effects::{Stack, draw_order::Mode},
    frame::Geometry,
    scene::{Scene, draw::Draw, view::View},
};

/// Where the drawing stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Triangles before this one are drawn whole, those behind it not at all.
    pub straddler: u32,
    /// Of its own samples those before this pixel are drawn, counted row by row.
    pub pixel: usize,
    /// Samples to be drawn, and all that there are.
    pub limit: u64,
    pub total: u64,
}

/// May the adapter choose which samples it draws?
pub fn is_free(stack: &Stack) -> bool {
    stack.draw_order().is_some_and(|order| Mode::of(order.mode) == Mode::Scheduler)
}

/// Where the order of a stack stops the drawing of `drawn` triangles; none without an order.
pub fn cut(stack: &Stack, rules: &SampleTests, drawn: &[OrientedTriangle], view: &View) -> Option<Cut> {
    let order = stack.draw_order()?;
    let counts = counts(rules, drawn, view);
    let total = counts.iter().map(|(_, count)| count).sum();
    let limit = order.limit_of(total);
    let mut before = 0;
    for (straddler, count) in counts {
        if limit < before + count {
            let mut samples: Vec<usize> = drawn.iter().filter(|t| t.id == straddler).flat_map(|t| samples(rules, t, view)).collect();
            samples.sort_unstable();
            return Some(Cut { straddler, pixel: samples[(limit - before) as usize], limit, total });
        }
        before += count;
    }
    Some(Cut { straddler: u32::MAX, pixel: 0, limit, total })
}

/// For every triangle of the scene, the share of all samples that come before it; empty where no order is kept.
pub fn ranks(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, geometry: &Geometry) -> Vec<f64> {
    if stack.draw_order().is_none() {
        return Vec::new();
    }
    let (drawn, _) = triangles(scene, draws, geometry);
    let mut ranks = vec![0.0; scene.triangle_count() as usize];
    let counts = counts(&SampleTests::of(stack, geometry).masked(scene, draws, stack), &drawn, view);
    counts.iter().for_each(|(id, count)| ranks[*id as usize] = *count as f64);
    let total = ranks.iter().sum::<f64>().max(1.0);
    let mut before = 0.0;
    for rank in &mut ranks {
        let count = *rank;
        *rank = before / total;
        before += count;
    }
    ranks
}

/// Samples of every drawn triangle, its pieces together, by rising id.
fn counts(rules: &SampleTests, drawn: &[OrientedTriangle], view: &View) -> Vec<(u32, u64)> {
    let mut counts: Vec<(u32, u64)> = drawn.par_iter().map(|t| (t.id, samples(rules, t, view).count() as u64)).collect();
    counts.sort_by_key(|(id, _)| *id);
    counts.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        kept.1 += if is_same { next.1 } else { 0 };
        is_same
    });
    counts
}

/// Pixels whose samples a triangle draws.
fn samples<'a>(rules: &'a SampleTests, triangle: &'a OrientedTriangle, view: &View) -> impl Iterator<Item = usize> + 'a {
    let (columns, rows) = triangle.bounds(view, rules);
    let width = view.width as usize;
    rows.flat_map(move |y| columns.clone().filter(move |&x| triangle.at(x, y, rules).is_some()).map(move |x| y * width + x))
}
