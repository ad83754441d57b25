//! Depth: eleven decades, layers one key apart, and large ratios of w within a triangle.

use std::collections::BTreeSet;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    drawing::stack,
    scenes::{
        SimpleMesh, Winding, pixel_view, quad, rotated_square, scene_of_meshes, square_perspective,
        triangle_soup, triangle_soup_in_units,
    },
};
use crate::frame::NO_TRIANGLE;

pub const CASES: &[Case] = &[
    Case {
        number: 13,
        name: "depth-range",
        about: "pairs of layers 0.1 % apart over eleven decades of depth: the nearer one wins",
        expectation: Expectation::Exact,
        run: depth_range,
    },
    Case {
        number: 15,
        name: "coplanar-layers",
        about: "layers one depth key apart: the nearest wins; of equal keys the smaller id wins",
        expectation: Expectation::Exact,
        run: coplanar_layers,
    },
    Case {
        number: 28,
        name: "w-ratios",
        about: "w from 1 to 2, 10, 1,000 and 10^6 within a triangle: attributes and depth of every sample",
        expectation: Expectation::Bounded(
            "depth within its stated relative error, colors within one step of 255",
        ),
        run: w_ratios,
    },
];

fn depth_range(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for near in [1e-3, 1e-5] {
        let view = square_perspective(64, 64, near);
        let mut positions = Vec::new();
        // Farther pairs are larger on the screen; the farther layer of a pair comes first.
        for decade in 0..11 {
            for nearer in [1.001, 1.0] {
                let w = near * 1.5 * libm::pow(10.0, f64::from(decade)) * nearer;
                positions.extend(quad(
                    rotated_square(
                        [0.0, 0.0],
                        0.1 + 0.1 * f64::from(decade),
                        0.3 * f64::from(decade),
                    ),
                    [w; 4],
                    Winding::Forward,
                ));
            }
        }
        let what = format!("near plane at {near:e}");
        let capture = context.exact_on_all_with(
            &scene_of_meshes(&[triangle_soup(positions)]),
            &view,
            &stack(&["depth"]),
            &what,
        )?;
        let seen: BTreeSet<u32> = capture
            .frame
            .triangle_id
            .iter()
            .copied()
            .filter(|&o| o != NO_TRIANGLE)
            .collect();
        check!(
            seen.iter().all(|triangle_id| triangle_id % 4 >= 2),
            "{what}: the farther of a pair shows among {seen:?}"
        );
        check!(seen.len() >= 20, "{what}: {} triangles show", seen.len());
    }
    Ok(())
}

fn coplanar_layers(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(64, 64);
    let mut rng = context.rng(5);
    // Layers in random order, one float apart: small triangles, and large ones.
    for (what, corners) in [
        ("small", [[0, 0], [24 * 256, 0], [0, 24 * 256]]),
        ("large", [[-60_000, -90_000], [90_000, 0], [0, 90_000]]),
    ] {
        let mut steps: Vec<u32> = (0..40).chain(10..20).collect();
        rng.shuffle(&mut steps);
        let layers: Vec<_> = steps
            .iter()
            .map(|step| (corners, f32::from_bits(0.5f32.to_bits() + step)))
            .collect();
        let capture = context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&layers)]),
            &view,
            &format!("{what} layers"),
        )?;
        let nearest = steps
            .iter()
            .position(|&step| step == 39)
            .unwrap_or_default();
        let mut triangle_ids: Vec<u32> = capture
            .frame
            .triangle_id
            .iter()
            .copied()
            .filter(|&o| o != NO_TRIANGLE)
            .collect();
        triangle_ids.dedup();
        equal(
            &triangle_ids,
            &vec![nearest as u32],
            &format!("{what} layers: triangle ids"),
        )?;
        let top = 0.5f32.to_bits() + 39;
        check!(
            capture
                .frame
                .depth_key
                .iter()
                .all(|&key| key == 0 || key == top),
            "{what} layers: a depth key is not the nearest's"
        );

        // The nearest layer twice more: of equal keys the smaller id wins.
        let again: Vec<_> = layers
            .iter()
            .chain([&layers[nearest]; 2])
            .copied()
            .collect();
        let equals = context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&again)]),
            &view,
            &format!("equal {what} layers"),
        )?;
        check!(
            equals.frame.triangle_id == capture.frame.triangle_id,
            "equal {what} layers: a larger id wins"
        );
    }
    Ok(())
}

fn w_ratios(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    for ratio in [2.0, 10.0, 1e3, 1e6f64] {
        let (w, mid) = (1.0f64, ratio.sqrt());
        let corners = [
            ([-0.95, -0.9], w),
            ([0.95, -0.7], ratio),
            ([0.1, 0.95], mid),
        ];
        let positions = corners
            .map(|([x, y], w)| [x * w, y * w, -w].map(|v| v as f32))
            .to_vec();
        let colors = vec![
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 0.5],
            [0.0, 0.0, 1.0, 0.0],
        ];
        let normals = vec![[1.0, 0.0, 0.1], [0.0, 1.0, 0.1], [-1.0, 0.2, 0.5]];
        let scene = scene_of_meshes(&[SimpleMesh {
            positions,
            normals,
            colors,
            ..SimpleMesh::default()
        }]);
        for effects in [&[][..], &["normals"], &["depth"]] {
            let view = square_perspective(160, 160, 1.0 / 1024.0);
            let what = format!("ratio {ratio}, {effects:?}");
            let capture = context.exact_on_all_with(&scene, &view, &stack(effects), &what)?;
            check!(
                capture.frame.covered() > 5000,
                "{what}: {} pixels",
                capture.frame.covered()
            );
        }
    }
    Ok(())
}
