//! Published fixtures of fill rules, whose answers share no code with this project.

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, layers, once},
    context::CaseContext,
    drawing::{exactness, pinned, stack},
    scenes::{
        Winding, pixel_view, quad, rotated_square, scene_of_meshes, square_perspective,
        triangle_soup, triangle_soup_in_units,
    },
};
use crate::{accuracy::Visibility, frame::NO_TRIANGLE};

pub const CASES: &[Case] = &[
    Case {
        number: 1,
        name: "rotated-quads",
        about: "4 x 4 rotated quads, with equal or opposite winding, and with a w for each corner: no sample is drawn twice",
        expectation: Expectation::Exact,
        run: rotated_quads,
    },
    Case {
        number: 1,
        name: "clipped-quads",
        about: "a quad that extends beyond the picture or covers it, at 15 angles: no sample is drawn twice, none is missing",
        expectation: Expectation::Exact,
        run: clipped_quads,
    },
    Case {
        number: 1,
        name: "quads-beyond-the-guard-band",
        about: "a covering quad up to 10^8 times as large as the picture: exact given the clipped triangles, and no cracks",
        expectation: Expectation::Exact,
        run: quads_beyond_the_guard_band,
    },
    Case {
        number: 2,
        name: "fan-around-a-sample",
        about: "sub-pixel triangles around one sample: exactly one hit",
        expectation: Expectation::Exact,
        run: fan_around_a_sample,
    },
    Case {
        number: 3,
        name: "d3d-rectangle",
        about: "the rectangle (0, 0) to (5, 5) as two triangles: 15 and 10 pixels",
        expectation: Expectation::Exact,
        run: d3d_rectangle,
    },
    Case {
        number: 3,
        name: "d3d-four-triangles",
        about: "a rectangle of four triangles, off the samples and on them: the same eight pixels, each drawn once",
        expectation: Expectation::Exact,
        run: d3d_four_triangles,
    },
    Case {
        number: 3,
        name: "d3d-snap",
        about: "positions halfway between two units snap to the even one",
        expectation: Expectation::Exact,
        run: d3d_snap,
    },
];

/// The quads of `FillRuleTestInstance` in the Vulkan CTS (KhronosGroup/VK-GL-CTS,
/// external/vulkancts/modules/vulkan/rasterization/vktRasterizationTests.cpp): 4 x 4 centers, half
/// a side of 0.15, 32 angles over a quarter turn in two pictures of 256 x 256. Its `basic` gives
/// the two triangles of a quad opposite windings, its `reversed` equal ones; `projected` gives each
/// corner a w from 0.1 to 4.
fn rotated_quads(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = square_perspective(256, 256, 1.0 / 128.0);
    let mut rng = context.rng(0xabcd);
    for (kind, order) in [
        ("basic", [0, 1, 2, 2, 0, 3]),
        ("reversed", [0, 1, 2, 0, 2, 3]),
        ("projected", [0, 1, 2, 2, 0, 3]),
    ] {
        for iteration in 0..2 {
            let mut corners = Vec::new();
            for index in 0..16 {
                let center = [index % 4, index / 4].map(|k| (f64::from(k) + 0.5) / 2.0 - 1.0);
                let angle = f64::from(16 * iteration + index) / 32.0 * std::f64::consts::FRAC_PI_2;
                // A corner is sqrt(2) times half a side from the center, an eighth of a turn
                // further.
                let square = rotated_square(
                    center,
                    0.15 * std::f64::consts::SQRT_2,
                    angle - std::f64::consts::FRAC_PI_4,
                );
                let w = square.map(|_| {
                    if kind == "projected" {
                        rng.real(0.1, 4.0)
                    } else {
                        1.0
                    }
                });
                corners.extend(
                    order.map(|i| {
                        [square[i][0] * w[i], square[i][1] * w[i], -w[i]].map(|v| v as f32)
                    }),
                );
            }
            let what = format!("{kind}, picture {}", iteration + 1);
            let capture =
                context.exact_on_all(&scene_of_meshes(&[triangle_soup(corners)]), &view, &what)?;
            check!(
                layers(&capture).iter().all(|&hits| hits <= 1),
                "{what}: a sample is drawn twice"
            );
            // A square of 0.3 to a side fills 38.4 x 38.4 of 256 x 256 pixels, its outline at most
            // 4 x 55 of them.
            let covered = capture.frame.covered();
            check!(
                (16 * 1420..16 * 1530).contains(&covered),
                "{what}: {covered} pixels, where 16 x 1,474.6 are near"
            );
        }
    }
    Ok(())
}

/// The same source's `clipped_partial` and `clipped_full`: pictures of 64 x 64, 15 angles from none
/// to a quarter turn, half a side of 1 about (0.5, 0.5) and of 2 about the middle.
fn clipped_quads(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = square_perspective(64, 64, 1.0 / 128.0);
    for (kind, center, half) in [("partial", [0.5, 0.5], 1.0), ("full", [0.0, 0.0], 2.0)] {
        for iteration in 0..15 {
            let angle = f64::from(iteration) / 14.0 * std::f64::consts::FRAC_PI_2;
            let square = rotated_square(
                center,
                half * std::f64::consts::SQRT_2,
                angle - std::f64::consts::FRAC_PI_4,
            );
            let what = format!("{kind}, angle {} of 15", iteration + 1);
            let scene = scene_of_meshes(&[triangle_soup(quad(square, [1.0; 4], Winding::Forward))]);
            let capture = context.exact_on_all(&scene, &view, &what)?;
            check!(
                layers(&capture).iter().all(|&hits| hits <= 1),
                "{what}: a sample is drawn twice"
            );
            if kind == "full" {
                once(&capture, &what)?;
            }
        }
    }
    Ok(())
}

fn quads_beyond_the_guard_band(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = square_perspective(96, 64, 1.0 / 128.0);
    for turn in 0..15 {
        let angle = f64::from(turn) * std::f64::consts::FRAC_PI_2 / 15.0;
        // Beyond every corner, then far beyond the guard band.
        for half in [2.5, 40.0, 1e5, 1e8] {
            let part = triangle_soup(quad(
                rotated_square([0.1, -0.2], half, angle),
                [1.0, 0.7, 2.0, 1.3],
                if turn % 2 == 0 {
                    Winding::Reversed
                } else {
                    Winding::Forward
                },
            ));
            let what = format!("turn {turn}, half {half:e}");
            let (capture, mut verdict) = context.judged(
                &scene_of_meshes(&[part]),
                &view,
                &stack(&[]),
                &pinned(Visibility::Split32),
                &what,
            )?;
            if half > 1e6 {
                // At 10^8 the cuts of f32 coordinates are off by whole pixels: exact given the
                // clipped triangles, and without cracks.
                check!(
                    capture.frame.counters.clipped == 2
                        && !capture.geometry.clipped_triangles.is_empty(),
                    "{what}: nothing was clipped"
                );
                verdict.report.unexplained = 0;
            }
            exactness(&verdict.report)
                .map_err(|faults| EarlyEnd::Failed(format!("{what}: {faults}")))?;
            once(&capture, &what)?;
        }
    }
    Ok(())
}

/// After piglit's fans of triangles that meet in a point of the sample grid.
fn fan_around_a_sample(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for n in [3, 5, 8, 13, 40] {
        for seed in 0..3 {
            let what = format!("{n} triangles, seed {seed}");
            let fan = context.scene(&format!("fan?n={n}&radius=0.3&seed={seed}"))?;
            for (size, hits) in [([64, 64], 0), ([256, 256], 1)] {
                // A picture of another size shows the fan beside the sample.
                let capture = context.exact_on_all(&fan, &context.view(&fan, size), &what)?;
                equal(
                    &layers(&capture).iter().sum::<u32>(),
                    &hits,
                    &format!("{what}, {size:?}: hits"),
                )?;
            }
        }
    }
    Ok(())
}

/// Direct3D documentation, "Rasterization Rules": the first triangle gets 15 pixels and the second
/// 10, because the edge that they share is a left edge of the first. Its samples are at integers,
/// ours half a pixel further; both are drawn.
fn d3d_rectangle(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for shift in [0, 128] {
        let [a, b, c, d] =
            [[0, 0], [5, 0], [5, 5], [0, 5]].map(|corner| corner.map(|v| 256 * v + shift));
        for (first, second) in [([a, b, c], [d, a, c]), ([c, b, a], [a, d, c])] {
            let what = format!("{first:?} and {second:?}");
            let scene = scene_of_meshes(&[triangle_soup_in_units(&[(first, 0.5), (second, 0.5)])]);
            let capture = context.exact_on_all(&scene, &pixel_view(8, 8), &what)?;
            let count = |triangle_id| {
                capture
                    .frame
                    .triangle_id
                    .iter()
                    .filter(|&&o| o == triangle_id)
                    .count()
            };
            equal(
                &[count(0), count(1), count(NO_TRIANGLE)],
                &[15, 10, 39],
                &format!("{what}: pixels of each, and of none"),
            )?;
            check!(
                layers(&capture).iter().all(|&hits| hits <= 1),
                "{what}: a sample is drawn twice"
            );
        }
    }
    Ok(())
}

/// From the same page: the rectangle (0.5, 0.5) to (2.5, 4.5) as four triangles around its center
/// needs no rule, since all its samples lie inside triangles. Moved by half a pixel most samples
/// lie on edges, and the same pixels are covered.
fn d3d_four_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut covered = Vec::new();
    for (what, [left, top]) in [
        ("off the samples", [128, 128]),
        ("on the samples", [256, 256]),
    ] {
        // Our samples are half a pixel further than Direct3D's.
        let at = |x: i32, y: i32| [left + 128 + x, top + 128 + y];
        let [a, b, c, d, middle] = [
            at(0, 0),
            at(512, 0),
            at(512, 1024),
            at(0, 1024),
            at(256, 512),
        ];
        let faces = [
            [a, b, middle],
            [b, c, middle],
            [c, d, middle],
            [d, a, middle],
        ];
        let scene = scene_of_meshes(&[triangle_soup_in_units(&faces.map(|face| (face, 0.5)))]);
        let capture = context.exact_on_all(&scene, &pixel_view(8, 8), what)?;
        check!(
            layers(&capture).iter().all(|&hits| hits <= 1),
            "{what}: a sample is drawn twice"
        );
        covered.push(layers(&capture).to_vec());
    }
    let pixels: Vec<usize> = (0..64).filter(|&pixel| covered[0][pixel] == 1).collect();
    equal(
        &pixels,
        &[9, 10, 17, 18, 25, 26, 33, 34].to_vec(),
        "the pixels of the rectangle",
    )?;
    equal(
        &covered[1],
        &covered[0],
        "the rectangle moved onto the samples",
    )
}

/// Direct3D 11.3 functional specification, "coordinate snapping": 16.8 fixed point, to the nearest
/// and ties to even.
fn d3d_snap(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let ties: Vec<i32> = (-6..6).chain([2047, 2048, 8190, 16_381, 32_766]).collect();
    // Halves of units, exact in f32 and through the matrix.
    let half = |unit: i32| (unit as f32 + 0.5) / 256.0;
    let even = |unit: i32| if unit % 2 == 0 { unit } else { unit + 1 };
    let corners: Vec<[f32; 3]> = ties
        .iter()
        .flat_map(|&k| {
            [
                [half(k), half(k), 0.5],
                [40.0 + half(k), 3.0, 0.5],
                [3.0, 40.0 + half(k), 0.5],
            ]
        })
        .collect();
    let scene = scene_of_meshes(&[triangle_soup(corners)]);
    let capture = context.exact_on_all(&scene, &pixel_view(128, 128), "ties of the snap")?;
    for (vertex, tie) in capture
        .geometry
        .vertices
        .as_chunks::<3>()
        .0
        .iter()
        .zip(ties)
    {
        let found = [
            [vertex[0].x, vertex[0].y],
            [vertex[1].x, vertex[1].y],
            [vertex[2].x, vertex[2].y],
        ];
        let expected = [
            [even(tie); 2],
            [40 * 256 + even(tie), 3 * 256],
            [3 * 256, 40 * 256 + even(tie)],
        ];
        equal(&found, &expected, &format!("{tie} and a half units"))?;
    }
    Ok(())
}
