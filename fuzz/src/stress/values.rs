//! Values: non-finite numbers, triangles without area, and mirrored transforms.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    drawing::stack,
    scenes::{
        SimpleMesh, camera_view, pixel_view, scene_of_meshes, triangle_soup, triangle_soup_in_units,
    },
};
use crate::{
    frame::NO_TRIANGLE,
    scene::{
        Scene,
        camera::{Camera, Projection},
    },
};

pub const CASES: &[Case] = &[
    Case {
        number: 12,
        name: "non-finite-positions",
        about: "NaN, infinities, FLT_MAX and subnormals in every coordinate: such triangles are rejected and counted, the others are exact",
        expectation: Expectation::Exact,
        run: non_finite_positions,
    },
    Case {
        number: 12,
        name: "non-finite-attributes",
        about: "NaN, infinities and extremes in normals and colors: finite values replace them",
        expectation: Expectation::Exact,
        run: non_finite_attributes,
    },
    Case {
        number: 17,
        name: "degenerate-triangles",
        about: "triangles without area, repeated vertices and indices, empty meshes, empty scenes: counted and not drawn",
        expectation: Expectation::Exact,
        run: degenerate_triangles,
    },
    Case {
        number: 24,
        name: "mirrored-transforms",
        about: "transforms with a negative determinant, single- and double-sided: facing as in glTF",
        expectation: Expectation::Exact,
        run: mirrored_transforms,
    },
];

fn non_finite_positions(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(64, 64);
    let good = [[4.0, 4.0, 0.25], [60.0, 8.0, 0.5], [8.0, 60.0, 0.75f32]];
    let huge = (1u64 << 40) as f32;
    let bad = [
        f32::NAN,
        -f32::NAN,
        f32::from_bits(0x7f80_0001),
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        -f32::MAX,
        huge,
        -huge,
    ];
    let (mut positions, mut nonfinite, mut range) = (good.to_vec(), 0, 0);
    for value in bad {
        for index in 0..9 {
            let mut corners = good.map(|p| [p[0], p[1], 0.9]);
            corners[index / 3][index % 3] = value;
            positions.extend(corners);
            if value.is_finite() {
                range += 1
            } else {
                nonfinite += 1
            }
        }
    }
    let good_too = good.map(|[x, y, z]| [64.0 - x, y, z]);
    positions.extend(good_too);
    let last = positions.len() as u32 / 3 - 1;
    let capture = context.exact_on_all(
        &scene_of_meshes(&[triangle_soup(positions)]),
        &view,
        "bad positions",
    )?;
    let counters = capture.frame.counters;
    let counted = (
        counters.rejected_nonfinite,
        counters.rejected_range,
        counters.degenerate,
    );
    equal(
        &counted,
        &(nonfinite, range, 0),
        "triangles rejected as not finite, as out of range, as without area",
    )?;
    check!(
        capture
            .frame
            .triangle_id
            .iter()
            .all(|&triangle_id| [0, last, NO_TRIANGLE].contains(&triangle_id)),
        "a rejected triangle owns a pixel"
    );
    let alone = scene_of_meshes(&[triangle_soup([good, good_too].concat())]);
    let reference = context.exact_on_all(&alone, &view, "good positions alone")?;
    check!(
        capture.frame.depth_key == reference.frame.depth_key,
        "a rejected triangle leaves a trace in the depth keys"
    );

    // The largest accepted coordinates are clipped; subnormals count as 0.
    let below = f32::from_bits(huge.to_bits() - 1);
    let vast = scene_of_meshes(&[triangle_soup(vec![
        [-below, -below, 0.5],
        [below, -below, 0.5],
        [0.0, below, 0.5],
    ])]);
    let capture = context.exact_on_all(&vast, &view, "just below 2^40")?;
    equal(
        &capture.frame.covered(),
        &(64 * 64),
        "pixels of a triangle just below 2^40",
    )?;
    let with = |zero: f32| {
        scene_of_meshes(&[triangle_soup(vec![
            [zero, zero, 0.5],
            [50.0, zero, zero],
            [zero, 50.0, 0.25],
        ])])
    };
    let zero = context.exact_on_all(&with(0.0), &view, "zero")?;
    let subnormal = context.exact_on_all(&with(f32::from_bits(0x007f_ffff)), &view, "subnormal")?;
    check!(
        zero.frame == subnormal.frame && zero.geometry == subnormal.geometry,
        "a subnormal is not 0"
    );
    Ok(())
}

fn non_finite_attributes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let bad = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        -f32::MAX,
        1e-40,
        -1e-40,
        0.0,
        1e20,
        -3.0,
    ];
    let (mut positions, mut normals, mut colors) = (vec![], vec![], vec![]);
    for (i, value) in bad.into_iter().enumerate() {
        for component in 0..4 {
            let (x, y) = (6.0 * i as f32 + 1.0, 10.0 * component as f32 + 1.0);
            for (corner, [dx, dy]) in [[0.0, 0.0], [5.0, 0.0], [0.0, 9.0]].into_iter().enumerate() {
                let (mut normal, mut color) = ([0.3, 0.2, 0.9], [0.9, 0.5, 0.2, 1.0f32]);
                if corner == component % 3 {
                    color[component] = value;
                    if component < 3 {
                        normal[component] = value
                    } else {
                        normal = [value; 3]
                    }
                }
                positions.push([x + dx, y + dy, 0.5]);
                normals.push(normal);
                colors.push(color);
            }
        }
    }
    let both = |normals: &[[f32; 3]], colors: &[[f32; 4]]| {
        scene_of_meshes(&[SimpleMesh {
            positions: positions.clone(),
            normals: normals.to_vec(),
            colors: colors.to_vec(),
            ..SimpleMesh::default()
        }])
    };
    for (what, scene) in [
        ("normals", both(&normals, &[])),
        ("colors", both(&[], &colors)),
        ("both", both(&normals, &colors)),
    ] {
        for effects in [&["lambert"][..], &["normals"], &["facet", "lambert"]] {
            let what = format!("bad {what} under {}", effects.join(" and "));
            let capture =
                context.exact_on_all_with(&scene, &pixel_view(64, 64), &stack(effects), &what)?;
            check!(
                capture.frame.covered() > 700,
                "{what}: {} pixels",
                capture.frame.covered()
            );
        }
    }
    Ok(())
}

fn degenerate_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(32, 32);
    let points = vec![
        [1.0, 1.0, 0.5],
        [30.0, 2.0, 0.5],
        [3.0, 30.0, 0.5],
        [15.5, 1.5, 0.5],
        [1.0, 1.0, 0.9],
    ];
    let none = SimpleMesh {
        positions: points.clone(),
        indices: vec![0, 0, 0, 0, 1, 1, 0, 1, 3, 0, 4, 1, 2, 0, 2],
        ..SimpleMesh::default()
    };
    let capture = context.exact_on_all(
        &scene_of_meshes(std::slice::from_ref(&none)),
        &view,
        "repeated indices",
    )?;
    equal(
        &(capture.frame.covered(), capture.frame.counters.degenerate),
        &(0, 5),
        "pixels and triangles without area",
    )?;

    // A very long line without area, and a tiny triangle that the snap collapses to a point.
    let line = triangle_soup_in_units(&[(
        [[-8_000_000, -8_000_000], [0, 0], [8_000_000, 8_000_000]],
        0.5,
    )]);
    let speck = triangle_soup(vec![
        [9.5, 9.5, 0.5],
        [9.5001, 9.5, 0.5],
        [9.5, 9.5001, 0.5],
    ]);
    let capture = context.exact_on_all(
        &scene_of_meshes(&[none, line, speck]),
        &view,
        "lines and specks",
    )?;
    equal(
        &(capture.frame.covered(), capture.frame.counters.degenerate),
        &(0, 7),
        "pixels and triangles without area",
    )?;

    // Meshes without triangles, without vertices, alone and among others; a scene without meshes.
    let empty = SimpleMesh {
        positions: vec![[1.0, 1.0, 0.5]; 2],
        ..SimpleMesh::default()
    };
    let nothing = SimpleMesh::default();
    let whole = triangle_soup(points[..3].to_vec());
    for (parts, covered) in [
        (vec![], false),
        (vec![nothing.clone()], false),
        (vec![empty.clone()], false),
        (vec![empty.clone(), nothing.clone(), empty.clone()], false),
        (
            vec![empty.clone(), nothing.clone(), whole.clone(), empty.clone()],
            true,
        ),
        (vec![nothing, whole, empty], true),
    ] {
        let what = format!(
            "{} meshes, {} of triangles",
            parts.len(),
            u32::from(covered)
        );
        let capture = context.exact_on_all(&scene_of_meshes(&parts), &view, &what)?;
        equal(
            &(capture.frame.covered() > 0),
            &covered,
            &format!("{what}: anything drawn"),
        )?;
        equal(&capture.frame.counters, &Default::default(), &what)?;
    }
    Ok(())
}

fn mirrored_transforms(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let camera = Camera {
        eye: DVec3::Z * 4.0,
        projection: Projection::Orthographic { height_m: 2.6 },
        ..Camera::default()
    };
    for double_sided in [false, true] {
        let mut plain = Scene::clone(&*context.scene("sphere?triangles=900")?);
        plain.materials[0].double_sided = double_sided;
        let mut drawn = |scale: DVec3| {
            let mut scene = plain.clone();
            scene.instances[0].world_from_object = DMat4::from_scale(scale);
            let view = camera_view(&scene, &camera, [128, 96]);
            context.exact_on_all_with(
                &Arc::new(scene),
                &view,
                &stack(&["lambert"]),
                &format!("scale {scale}, double-sided {double_sided}"),
            )
        };
        let straight = drawn(DVec3::ONE)?;
        // Mirrored left to right the same triangles are visible, except at samples on edges, where
        // left and right differ.
        let left_right = drawn(DVec3::new(-1.0, 1.0, 1.0))?;
        let rows = straight
            .frame
            .triangle_id
            .chunks_exact(128)
            .flat_map(|row| row.iter().rev());
        let different = rows
            .zip(&left_right.frame.triangle_id)
            .filter(|(a, b)| a != b)
            .count();
        check!(
            different <= 8,
            "mirrored left to right, {different} pixels show another triangle"
        );
        // Mirrored front to back its other side is visible, again from the outside.
        let turned = drawn(DVec3::new(1.0, 1.0, -1.0))?;
        let shared = turned
            .frame
            .triangle_id
            .iter()
            .filter(|&o| *o != NO_TRIANGLE && straight.frame.triangle_id.contains(o))
            .count();
        check!(
            shared < turned.frame.covered() / 10,
            "mirrored front to back, {shared} pixels show the front"
        );
        check!(
            turned.frame.covered() > 3000,
            "{} pixels",
            turned.frame.covered()
        );
    }
    Ok(())
}
