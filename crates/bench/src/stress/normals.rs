//! Normals: planes and corner normals that point along an axis, where two of three components are
//! zero.

use glam::DVec3;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    drawing::{pinned, stack},
    scenes::{SimpleMesh, camera_view, scene_of_meshes},
};
use crate::scene::camera::{Camera, Projection};

pub const CASES: &[Case] = &[Case {
    number: 12,
    name: "normals-along-axes",
    about: "triangles whose edges point along the axes, and corner normals along the axes of length 10^-12 to 10^12: every one has a normal",
    expectation: Expectation::Exact,
    run: normals_along_axes,
}];

/// The six unit vectors along the axes.
const AXES: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

/// A right triangle with legs along two vectors, its right angle at one of the three corners.
fn right_triangle(at: [f32; 3], legs: [[f32; 3]; 2], right_angle: usize) -> [[f32; 3]; 3] {
    let beside = |leg: [f32; 3]| std::array::from_fn(|axis| at[axis] + leg[axis]);
    let mut corners = [at, beside(legs[0]), beside(legs[1])];
    corners.rotate_right(right_angle);
    corners
}

fn normals_along_axes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let (mut positions, mut zero, mut axial) = (Vec::new(), Vec::new(), Vec::new());
    for (row, first) in AXES.into_iter().enumerate() {
        let others = AXES
            .into_iter()
            .filter(|second| first.iter().zip(second).all(|(a, b)| a * b == 0.0));
        for (column, second) in others.enumerate() {
            for right_angle in 0..3 {
                let at = [
                    2.5 * (4 * right_angle + column) as f32 - 13.75,
                    2.5 * row as f32 - 6.25,
                    0.0,
                ];
                positions.extend(right_triangle(at, [first, second], right_angle));
                zero.extend([[0.0; 3]; 3]);
                axial.extend(
                    [first.map(|component| component * [1.0, 1e-12, 1e12][right_angle]); 3],
                );
            }
        }
    }
    let camera = Camera {
        eye: DVec3::new(5.0, 7.0, 11.0),
        target: DVec3::ZERO,
        projection: Projection::Orthographic { height_m: 20.0 },
        ..Camera::default()
    };
    for (what, normals) in [("planes", zero), ("corner normals", axial)] {
        let scene = scene_of_meshes(&[SimpleMesh {
            positions: positions.clone(),
            normals,
            ..SimpleMesh::default()
        }]);
        let view = camera_view(&scene, &camera, [384, 240]);
        // `explode` carries triangles along their planes, `wobble` turns planes and corner normals.
        for effects in [
            &["normals"][..],
            &["facet", "normals"],
            &["explode", "normals"],
            &["wobble", "normals"],
            &["wobble", "facet", "normals"],
        ] {
            let what = format!("{what} under {}", effects.join(" and "));
            let accuracy = pinned(context.quick_option());
            let (capture, _) = context.exact(&scene, &view, &stack(effects), &accuracy, &what)?;
            check!(
                capture.frame.covered() > 2000,
                "{what}: {} pixels",
                capture.frame.covered()
            );
        }
    }
    Ok(())
}
