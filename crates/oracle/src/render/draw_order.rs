//! Draw order: how many samples each triangle has, where a limit stops the drawing, and which
//! fraction of all samples precedes each triangle (`docs/exactness.md` §7).

use rayon::prelude::*;

use super::{
    super::shot::Shot,
    sample_rules::{DrawLimit, SampleTests},
    triangles::{OrientedTriangle, triangles},
};
use crate::{
    effects::{Stack, draw_order::Mode},
    frame::Geometry,
    scene::view::View,
    work::{Canceled, map_each},
};

/// Returns true if the adapter may choose which samples it draws.
pub fn is_free(stack: &Stack) -> bool {
    stack
        .draw_order()
        .is_some_and(|order| Mode::of(order.mode) == Mode::Scheduler)
}

/// The tests up to where the draw order of `stack` stops the drawing of these triangles.
pub fn limited<'a>(
    tests: SampleTests<'a>,
    stack: &Stack,
    drawn: &[OrientedTriangle],
    view: &View,
) -> Result<SampleTests<'a>, Canceled> {
    let limit = draw_limit(stack, &tests, drawn, view)?;
    Ok(tests.up_to(limit, view.width))
}

/// Where the draw order of a stack stops the drawing of `drawn` triangles; none without a draw
/// order.
pub fn draw_limit(
    stack: &Stack,
    tests: &SampleTests,
    drawn: &[OrientedTriangle],
    view: &View,
) -> Result<Option<DrawLimit>, Canceled> {
    let Some(order) = stack.draw_order() else {
        return Ok(None);
    };
    let counts = counts(tests, drawn, view)?;
    let total = counts.iter().map(|(_, count)| count).sum();
    let limit = order.limit_of(total);
    let mut before = 0;
    for (boundary_triangle, count) in counts {
        if limit < before + count {
            let of_boundary = drawn.iter().filter(|t| t.id == boundary_triangle);
            let mut samples: Vec<usize> =
                of_boundary.flat_map(|t| samples(tests, t, view)).collect();
            samples.sort_unstable();
            return Ok(Some(DrawLimit {
                boundary_triangle,
                pixel: samples[(limit - before) as usize],
                limit,
                total,
            }));
        }
        before += count;
    }
    Ok(Some(DrawLimit {
        boundary_triangle: u32::MAX,
        pixel: 0,
        limit,
        total,
    }))
}

/// For every triangle of the scene, the fraction of all samples that precedes it; empty without a
/// draw order.
pub fn ranks(shot: &Shot, geometry: &Geometry) -> Result<Vec<f64>, Canceled> {
    if shot.stack.draw_order().is_none() {
        return Ok(Vec::new());
    }
    let (drawn, _) = triangles(shot, geometry)?;
    let mut ranks = vec![0.0; shot.scene.triangle_count() as usize];
    let counts = counts(&SampleTests::new(shot, geometry), &drawn, shot.view)?;
    counts
        .iter()
        .for_each(|(id, count)| ranks[*id as usize] = *count as f64);
    let total = ranks.iter().sum::<f64>().max(1.0);
    let mut before = 0.0;
    for rank in &mut ranks {
        let count = *rank;
        *rank = before / total;
        before += count;
    }
    Ok(ranks)
}

/// Number of samples of every drawn triangle, all its clipped triangles together, by rising id.
fn counts(
    tests: &SampleTests,
    drawn: &[OrientedTriangle],
    view: &View,
) -> Result<Vec<(u32, u64)>, Canceled> {
    let count = |t: &OrientedTriangle| (t.id, samples(tests, t, view).count() as u64);
    let mut counts = map_each(drawn.par_iter(), count)?;
    counts.sort_by_key(|(id, _)| *id);
    counts.dedup_by(|next, first| {
        let is_same = next.0 == first.0;
        first.1 += if is_same { next.1 } else { 0 };
        is_same
    });
    Ok(counts)
}

/// Pixels whose samples a triangle draws.
fn samples<'a>(
    tests: &'a SampleTests,
    triangle: &'a OrientedTriangle,
    view: &View,
) -> impl Iterator<Item = usize> + 'a {
    let (columns, rows) = triangle.bounds(view, tests);
    let width = view.width as usize;
    rows.flat_map(move |y| {
        columns
            .clone()
            .filter(move |&x| triangle.at(x, y, tests).is_some())
            .map(move |x| y * width + x)
    })
}
