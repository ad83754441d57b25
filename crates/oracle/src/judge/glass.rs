//! Judges the layers of glass on every sample, from the adapter's own geometry: which are there, and
//! in which order.

use super::super::{
    arithmetic::depth_key::key_fits,
    bounds::coverage::{cover_claims, depth_interval},
    render::{coverage::scatter, glass::nearness, layers::LayerInput, triangles::OrientedTriangle},
};
use crate::{
    frame::{Frame, NO_TRIANGLE},
    measure::ErrorReport,
    work::Canceled,
};

/// A triangle of glass that covers a sample, with the interval in which its depth lies.
#[derive(Clone, Copy)]
struct BoundedHit {
    triangle_id: u32,
    interval: [f64; 2],
}

/// Counts the pixels whose layers are not right. The opaque triangle behind them must be one that
/// may be the nearest. A layer must be listed if it is nearer for certain, and must not be if it is
/// farther for certain. Keys must lie within their bounds, and layers be sorted by key, of equal
/// keys by id: then the order is right wherever the bounds decide it.
pub fn judge_glass(
    report: &mut ErrorReport,
    input: &LayerInput,
    frame: &Frame,
) -> Result<(), Canceled> {
    let (shot, lists) = (&input.shot, &frame.glass);
    if lists.is_empty() {
        return Ok(());
    }
    let is_glass =
        |triangle: &OrientedTriangle| shot.draw_of(triangle.id).is_some_and(|draw| draw.is_glass);
    let (glass, opaque): (Vec<OrientedTriangle>, Vec<OrientedTriangle>) = input
        .triangles
        .iter()
        .partition(|triangle| is_glass(triangle));
    let behind = cover_claims(input.tests, &opaque, shot.view, &lists.behind)?;
    let mut hits: Vec<Vec<BoundedHit>> = vec![Vec::new(); shot.view.pixels()];
    scatter(input.tests, &glass, shot.view, &mut hits, |triangle| {
        |hits: &mut Vec<BoundedHit>, _, _, hit| {
            hits.push(BoundedHit {
                triangle_id: triangle.id,
                interval: depth_interval(triangle, &hit),
            });
        }
    })?;
    let is_wrong = |(pixel, hits): (usize, &Vec<BoundedHit>)| {
        let (sample, layers) = (&behind.samples[pixel], lists.at(pixel));
        if !sample.allows(lists.behind[pixel]) {
            return true;
        }
        let wall = sample
            .claimed
            .filter(|_| lists.behind[pixel] != NO_TRIANGLE)
            .unwrap_or([f64::NEG_INFINITY; 2]);
        // Shortened keys tie where depths do not.
        let rounding = &frame.depth_rounding;
        let step = |depth: f64| depth * rounding.relative_up + rounding.up + rounding.down;
        let must = hits
            .iter()
            .filter(|hit| hit.interval[0] > wall[1] + step(wall[1].max(0.0)));
        let is_listed = |hit: &BoundedHit| {
            layers
                .iter()
                .any(|layer| layer.triangle_id == hit.triangle_id)
        };
        let is_right = |layer: &crate::frame::GlassHit| {
            hits.iter().any(|hit| {
                hit.triangle_id == layer.triangle_id
                    && hit.interval[1] >= wall[0] - step(wall[0].max(0.0))
                    && key_fits(layer.depth_key, rounding, hit.interval)
            })
        };
        let is_sorted = layers
            .windows(2)
            .all(|pair| nearness(&pair[0]) > nearness(&pair[1]));
        !(must.into_iter().all(is_listed) && layers.iter().all(is_right) && is_sorted)
    };
    report.layer_counts_wrong += hits.iter().enumerate().filter(|at| is_wrong(*at)).count() as u64;
    Ok(())
}
