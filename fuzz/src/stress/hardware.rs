//! Comparison with the adapter's fixed-function rasterizer: the same snapped positions through its
//! render pipeline.

use pollster::FutureExt as _;

use super::{
    adversarial::near_miss_triangle,
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    scenes::{pixel_view, scene_of_meshes, triangle_soup_in_units},
};
use crate::frame::NO_TRIANGLE;

pub const CASES: &[Case] = &[Case {
    number: 32,
    name: "hardware-cross-check",
    about: "the same snapped positions through the fixed-function pipeline give the same triangle ids, except on samples on an edge",
    expectation: Expectation::Exact,
    run: hardware_cross_check,
}];

const SIDE: u32 = 64;

/// A triangle in units of 1/256 px with one depth.
type Flat = ([[i32; 2]; 3], f32);

/// The picture of the fixed-function pipeline. A power-of-two picture size keeps all positions
/// exact up to its own snap.
fn witness(context: &CaseContext, triangles: &[Flat]) -> Result<Vec<u32>, EarlyEnd> {
    let half = 128.0 * SIDE as f32;
    let to_ndc =
        |[x, y]: [i32; 2], depth: f32| [x as f32 / half - 1.0, 1.0 - y as f32 / half, depth];
    let corners: Vec<_> = triangles
        .iter()
        .flat_map(|(corners, depth)| corners.map(|corner| to_ndc(corner, *depth)))
        .collect();
    Ok(context
        .renderer
        .hardware_ids([SIDE, SIDE], &corners)
        .block_on()?)
}

/// The snap grid of the pipeline in units of 1/256 px: 1 if it distinguishes edges one unit from a
/// sample, else 16, since Vulkan guarantees only 4 subpixel bits.
fn witness_grid(context: &CaseContext) -> Result<i32, EarlyEnd> {
    let sample = 256 * 32 + 128;
    let mut bars = Vec::new();
    // One bar per row, which ends or begins this many units from the sample.
    for (row, from_sample) in (-8..=8).enumerate() {
        for (half, [left, right]) in [[1024, sample + from_sample], [sample + from_sample, 15_360]]
            .into_iter()
            .enumerate()
        {
            let top = 256 * (2 * row as i32 + half as i32);
            let [a, b, c, d] = [
                [left, top],
                [right, top],
                [right, top + 256],
                [left, top + 256],
            ];
            bars.extend([([a, b, c], 0.5), ([a, c, d], 0.5)]);
        }
    }
    let triangle_ids = witness(context, &bars)?;
    let is_fine = (-8..=8).enumerate().all(|(row, from_sample)| {
        let drawn =
            [0, 1].map(|half| triangle_ids[(2 * row + half) * SIDE as usize + 32] != NO_TRIANGLE);
        // A left edge includes its samples, a right edge does not.
        drawn == [from_sample > 0, from_sample <= 0]
    });
    Ok(if is_fine { 1 } else { 16 })
}

/// Samples on an edge or a corner of a triangle. APIs specify coverage only for samples inside or
/// outside.
fn mask(triangles: &[Flat]) -> Vec<bool> {
    let mut masked = vec![false; (SIDE * SIDE) as usize];
    for (corners, _) in triangles {
        let [a, b, c] = corners.map(|corner| corner.map(i64::from));
        for pixel in 0..i64::from(SIDE * SIDE) {
            let p = [pixel % i64::from(SIDE), pixel / i64::from(SIDE)].map(|k| 256 * k + 128);
            let edge = |from: [i64; 2], to: [i64; 2]| {
                (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
            };
            let edges = [edge(a, b), edge(b, c), edge(c, a)];
            let is_touched = edges.iter().all(|e| *e >= 0) || edges.iter().all(|e| *e <= 0);
            masked[pixel as usize] |= is_touched && edges.contains(&0);
        }
    }
    masked
}

fn hardware_cross_check(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let grid = witness_grid(context)?;
    let view = pixel_view(SIDE, SIDE);
    let side = 256 * SIDE as i32;
    let (mut masked_samples, mut samples) = (0, 0);
    for (extent, count) in [(700, 1000), (3000, 600), (9000, 200), (16_384, 60)] {
        for picture in 0..4u32 {
            let mut rng = context.rng(extent as u32 ^ picture.wrapping_mul(0x27d4_eb2f));
            let mut flat = |i: usize| loop {
                // Inside the picture, because clipping moves vertices.
                let corners = near_miss_triangle(&mut rng, extent, [SIDE as i32; 2])
                    .map(|corner| corner.map(|v| (v + grid / 2) / grid * grid));
                if corners
                    .as_flattened()
                    .iter()
                    .all(|v| (0..=side).contains(v))
                {
                    return (corners, (i + 1) as f32 / 1024.0);
                }
            };
            let triangles: Vec<Flat> = (0..count).map(&mut flat).collect();
            let what = format!("extent {extent} units, picture {picture}");
            let ours = context.exact_on_all(
                &scene_of_meshes(&[triangle_soup_in_units(&triangles)]),
                &view,
                &what,
            )?;
            let theirs = witness(context, &triangles)?;
            let masked = mask(&triangles);
            masked_samples += masked.iter().filter(|is_masked| **is_masked).count();
            samples += masked.len();
            let pixels = ours
                .frame
                .triangle_id
                .iter()
                .zip(&theirs)
                .zip(&masked)
                .enumerate();
            let wrong: Vec<_> = pixels
                .filter(|(_, ((a, b), is_masked))| a != b && !**is_masked)
                .map(|(i, (pair, _))| (i, pair))
                .collect();
            check!(
                wrong.is_empty(),
                "{what}: {} pixels outside the mask have another triangle id in the fixed-function pipeline; first (pixel, (ours, theirs)): {:?}",
                wrong.len(),
                wrong[0]
            );
            check!(
                theirs.iter().any(|triangle_id| *triangle_id != NO_TRIANGLE),
                "{what}: the fixed-function pipeline drew nothing"
            );
        }
    }
    check!(
        masked_samples > 0 && masked_samples < samples / 2,
        "{masked_samples} of {samples} samples are masked"
    );
    context.note(format!(
        "{masked_samples} of {samples} samples lie on an edge and are masked; positions are multiples of 1/{} px",
        256 / grid
    ));
    Ok(())
}
