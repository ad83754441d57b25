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
use crate::measure::compare;

pub const CASES: &[Case] = &[
    Case {
        number: 4,
        name: "translation",
        about: "near-miss triangles moved by whole pixels: the coverage moves along and does not change",
        expectation: Expectation::Exact,
        run: translation,
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
