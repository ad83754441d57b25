//! Coverage: which samples are covered by triangles of every size and shape.

use super::{
    adversarial::{near_collinear_triangle, near_miss_triangle, near_tie_mesh},
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, layers, once},
    context::CaseContext,
    drawing::{WorkDistribution, pinned, stack},
    scenes::{
        Rng, SimpleMesh, pixel_view, reference_coverage, scene_of_meshes, triangle_soup,
        triangle_soup_in_units,
    },
};
use crate::{math::GUARD_BAND, measure::compare};

pub const CASES: &[Case] = &[
    Case {
        number: 4,
        name: "translation",
        about: "near-miss triangles moved by whole pixels: the coverage moves along and does not change",
        expectation: Expectation::Exact,
        run: translation,
    },
    Case {
        number: 5,
        name: "sizes",
        about: "triangles of 10^-3 to 10^9 px cover exactly the samples on the inner side of their edges",
        expectation: Expectation::Exact,
        run: sizes,
    },
    Case {
        number: 6,
        name: "dense-grids",
        about: "cells of 0.1, 0.4 and 1 px: no hole and no double hit",
        expectation: Expectation::Exact,
        run: dense_grids,
    },
    Case {
        number: 7,
        name: "slivers",
        about: "needles with a length of a million times their width share edges without holes or double hits",
        expectation: Expectation::Exact,
        run: slivers,
    },
    Case {
        number: 8,
        name: "size-class-borders",
        about: "triangles at the borders of every size class and at the limit of i32: the same picture on all paths",
        expectation: Expectation::Exact,
        run: size_class_borders,
    },
    Case {
        number: 8,
        name: "edges-beside-axes",
        about: "large triangles with an edge that leaves an axis by 0 to 2 units and ends at a sample on the border of a tile",
        expectation: Expectation::Exact,
        run: edges_beside_axes,
    },
    Case {
        number: 23,
        name: "near-misses",
        about: "a million random triangles, each with an edge through a sample or one step beside it",
        expectation: Expectation::Exact,
        run: near_misses,
    },
    Case {
        number: 23,
        name: "near-ties",
        about: "meshes whose vertices lie within 32 floats of a tie of the snap and next to samples are watertight",
        expectation: Expectation::Exact,
        run: near_ties,
    },
];

fn edges_beside_axes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut triangles = Vec::new();
    // The edge goes from `along` 0 to the far side, and from `across` to `across + lean`; the third
    // corner lies on either side of it.
    for (sample, beside, lean) in [63, 64, 127, 128]
        .into_iter()
        .flat_map(|s| (-1..=1).flat_map(move |b| (-2..=2).map(move |l| (s, b, l))))
    {
        let across = 256 * sample + 128 + beside;
        for (is_upright, third) in [
            (false, -20_000),
            (false, 80_000),
            (true, -20_000),
            (true, 80_000),
        ] {
            let place = |along: i32, across: i32| {
                if is_upright {
                    [across, along]
                } else {
                    [along, across]
                }
            };
            // Both ends lie at samples, so the edge comes closest to the samples of the border at
            // one of them.
            let corners = [
                place(128, across),
                place(256 * 190 + 128, across + lean),
                place(256 * 95, third),
            ];
            triangles.push((corners, 0.1 + 0.001 * triangles.len() as f32));
        }
    }
    let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
    context
        .exact_on_all(
            &scene,
            &pixel_view(192, 192),
            "edges that leave an axis by at most 2 units",
        )
        .map(drop)
}

fn translation(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(11);
    let soup: Vec<_> = (0..60)
        .map(|i| {
            (
                near_miss_triangle(&mut rng, [600, 8192, 40_000][i % 3], [32, 32]),
                0.1 + 0.01 * i as f32,
            )
        })
        .collect();
    let view = pixel_view(128, 128);
    let mut drawn = |by: [i32; 2]| {
        let moved: Vec<_> = soup
            .iter()
            .map(|(corners, z)| (corners.map(|[x, y]| [x + 256 * by[0], y + 256 * by[1]]), *z))
            .collect();
        context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&moved)]),
            &view,
            &format!("moved by {by:?}"),
        )
    };
    let still = drawn([0, 0])?;
    for by in [[1, 0], [0, 1], [31, 17], [64, 96]] {
        let moved = drawn(by)?;
        for (x, y) in (0..128 - by[0]).flat_map(|x| (0..128 - by[1]).map(move |y| (x, y))) {
            let (from, to) = (
                (y * 128 + x) as usize,
                ((y + by[1]) * 128 + x + by[0]) as usize,
            );
            let found = (moved.frame.triangle_id[to], layers(&moved)[to]);
            equal(
                &found,
                &(still.frame.triangle_id[from], layers(&still)[from]),
                &format!("moved by {by:?}: triangle id and hits of {x}, {y}"),
            )?;
        }
    }
    Ok(())
}

fn sizes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for exponent in -3..=9 {
        let size = libm::pow(10.0, f64::from(exponent)) as f32;
        let (x, y) = (32.3f32, 31.7f32);
        let scene = scene_of_meshes(&[triangle_soup(vec![
            [x, y - size, 0.5],
            [x + size, y, 0.5],
            [x, y + size, 0.5],
        ])]);
        let capture =
            context.exact_on_all(&scene, &pixel_view(64, 64), &format!("10^{exponent} px"))?;
        for (pixel, &hits) in layers(&capture).iter().enumerate() {
            let (px, py) = ((pixel % 64) as f32 + 0.5, (pixel / 64) as f32 + 0.5);
            let inside_by = (size - (py - y).abs() - (px - x)).min(px - x);
            if inside_by.abs() > 1.0 / 128.0 {
                equal(
                    &hits,
                    &u32::from(inside_by > 0.0),
                    &format!("10^{exponent} px, hits of pixel {pixel}"),
                )?;
            }
        }
    }
    Ok(())
}

fn dense_grids(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for query in [
        "grid?cell=0.1&width=48&height=48",
        "grid?cell=0.4&width=96&height=96",
        "grid?cell=1&lattice=16&width=96&height=96",
    ] {
        let grid = context.scene(query)?;
        let size = if query.contains("48") {
            [48, 48]
        } else {
            [96, 96]
        };
        let capture = context.exact_on_all(&grid, &context.view(&grid, size), query)?;
        once(&capture, query)?;
    }
    Ok(())
}

fn slivers(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(17);
    let guard = GUARD_BAND;
    for height in 1..=8 {
        // Two adjacent needles; with the areas above and below them they cover each sample once.
        let (left, right) = (rng.between(2000, 14_000), rng.between(2000, 14_000));
        let [a, b] = [[-guard, left], [guard, right]];
        let [c, d] = [[-guard, left + height], [guard, right + height]];
        let [e, f, g, h] = [
            [-guard, -guard],
            [guard, -guard],
            [-guard, guard],
            [guard, guard],
        ];
        let faces = [
            [e, f, a],
            [f, b, a],
            [a, b, c],
            [b, d, c],
            [c, d, g],
            [d, h, g],
        ];
        let what = format!("height {height} of 256");
        let capture = context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&faces.map(|face| (face, 0.5)))]),
            &pixel_view(64, 64),
            &what,
        )?;
        once(&capture, &what)?;
    }
    let needles = context.scene("slivers?n=200&length=30000")?;
    context.exact_on_all(&needles, &context.view(&needles, [256, 256]), "needles")?;
    Ok(())
}

fn size_class_borders(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(23);
    let px = 256;
    // Box sides at the borders of all classes: 8 px and 32 px of one invocation, 64 px, 128 px of
    // extent, and the limit of i32.
    for extent in [
        8 * px,
        11 * px,
        32 * px,
        33 * px,
        64 * px,
        65 * px,
        128 * px - 1,
        128 * px,
        128 * px + 1,
        46_340,
        46_341,
        65_536,
    ] {
        let mut triangles = Vec::new();
        for i in 0..24 {
            let at = [
                rng.between(-extent / 2, 128 * px),
                rng.between(-extent / 2, 128 * px),
            ];
            let [near, far] = [rng.between(0, extent + 1), rng.between(0, extent + 1)];
            let mut corners = [[0, 0], [extent, near], [far, extent]];
            if i % 2 == 1 {
                corners = corners.map(|[x, y]| [extent - x, y]);
            }
            if i % 3 == 0 {
                // A box of that width and the smallest height, and the reverse.
                corners = if i % 2 == 0 {
                    [[0, 0], [extent, 128], [far, 256]]
                } else {
                    [[0, 0], [128, extent], [256, near]]
                };
            }
            triangles.push((
                corners.map(|[x, y]| [x + at[0], y + at[1]]),
                0.2 + 0.01 * i as f32,
            ));
        }
        context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&triangles)]),
            &pixel_view(128, 128),
            &format!("extent {extent} units"),
        )?;
    }
    // Boxes of 63 to 65 and 127 to 129 samples, the limits of one invocation.
    let boxes = [
        (7, 9),
        (8, 8),
        (5, 13),
        (1, 127),
        (8, 16),
        (3, 43),
        (64, 2),
        (2, 65),
    ];
    let triangles = boxes
        .into_iter()
        .enumerate()
        .flat_map(|(i, (width, height))| {
            let corners_of = |turned: bool| {
                let (w, h) = if turned {
                    (height, width)
                } else {
                    (width, height)
                };
                [[0, 0], [px * w, 0], [px * w, px * h]]
                    .map(|[x, y]: [i32; 2]| [x + 40 * i as i32, y + 17 * i as i32])
            };
            [
                (corners_of(false), 0.2 + 0.02 * i as f32),
                (corners_of(true), 0.21 + 0.02 * i as f32),
            ]
        });
    context.exact_on_all(
        &scene_of_meshes(&[triangle_soup_in_units(&triangles.collect::<Vec<_>>())]),
        &pixel_view(128, 128),
        "boxes of 63 to 130 samples",
    )?;
    Ok(())
}

fn near_misses(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let option = context.quick_option();
    let view = pixel_view(64, 64);
    // Extent in units, triangles per picture, pictures: a million triangles altogether.
    for (extent, count, pictures) in [
        (300, 120_000, 5),
        (1500, 60_000, 6),
        (9000, 6000, 4),
        (32_768, 900, 4),
        (70_000, 300, 4),
        (2_000_000, 200, 4),
        (8_388_607, 200, 4),
    ] {
        for picture in 1..=pictures {
            let mut rng = context.rng((picture as u32).wrapping_mul(0x9e37_79b1) ^ extent as u32);
            let depth = |rng: &mut Rng| rng.between(1, 1024) as f32 / 1024.0;
            let triangles: Vec<_> = (0..count)
                .map(|_| {
                    (
                        near_miss_triangle(&mut rng, extent, [64, 64]),
                        depth(&mut rng),
                    )
                })
                .collect();
            let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
            let what = format!("extent {extent} units, picture {picture}");
            let capture = if count > 2000 {
                context.renderer.set_tuning(WorkDistribution::Card.tuning());
                context
                    .exact(&scene, &view, &stack(&[]), &pinned(option), &what)?
                    .0
            } else {
                context.exact_on_all(&scene, &view, &what)?
            };
            // No vertex may move: the lattice is exact in f32.
            let placed = triangles.iter().flat_map(|(corners, _)| *corners);
            let moved = capture
                .geometry
                .vertices
                .iter()
                .zip(placed)
                .find(|(v, [x, y])| v.flags != 0 || (v.x, v.y) != (*x, *y));
            check!(moved.is_none(), "{what}: a vertex has moved: {moved:?}");
            // Flat triangles have the depth of their corners, so no pixel is in the depth band.
            let reference = reference_coverage(&scene, &view)?;
            equal(
                &compare::triangle_ids(&capture.frame.triangle_id, &reference.triangle_ids()),
                &Default::default(),
                &format!("{what}: triangle ids"),
            )?;
            equal(
                &compare::triangle_ids(layers(&capture), &reference.layers()),
                &Default::default(),
                &format!("{what}: hits"),
            )?;
        }
    }
    Ok(())
}

fn near_ties(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let size = [64, 64];
    let view = pixel_view(64, 64);
    for round in 0..8u32 {
        let mut rng = context.rng(round.wrapping_mul(0x85eb_ca6b) ^ 0x7135);
        let cell = [2, 3, 5, 16][round as usize % 4];
        let (positions, indices) = near_tie_mesh(&mut rng, size, cell);
        let what = format!("cells of {cell} px, round {round}");
        let shared = SimpleMesh {
            positions: positions.clone(),
            indices: indices.clone(),
            ..SimpleMesh::default()
        };
        let capture = context.exact_on_all(&scene_of_meshes(&[shared]), &view, &what)?;
        once(&capture, &what)?;
        // With separate corners for every triangle, equal positions must snap to equal units.
        let loose = triangle_soup(indices.iter().map(|&i| positions[i as usize]));
        let apart = context.exact_on_all(
            &scene_of_meshes(&[loose]),
            &view,
            &format!("{what}, triangles apart"),
        )?;
        once(&apart, &format!("{what}, triangles apart"))?;
        let parted = indices
            .iter()
            .zip(&apart.geometry.vertices)
            .find(|(i, v)| capture.geometry.vertices[**i as usize] != **v);
        check!(
            parted.is_none(),
            "{what}: equal positions were snapped differently: {parted:?}"
        );
    }
    for round in 0..4u32 {
        let mut rng = context.rng(round.wrapping_mul(0xc2b2_ae35) ^ 0x51de);
        let slivers = (0..400).flat_map(|i| {
            near_collinear_triangle(&mut rng, size).map(|[x, y]| [x, y, 0.2 + 0.001 * i as f32])
        });
        let scene = scene_of_meshes(&[triangle_soup(slivers)]);
        context.exact_on_all(
            &scene,
            &view,
            &format!("slivers of no width, round {round}"),
        )?;
    }
    Ok(())
}
