//! Clipping: the guard band, w at and near zero, and the near plane moving through a surface.

use std::sync::Arc;

use glam::DVec3;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, once},
    context::CaseContext,
    drawing::{pinned, stack},
    scenes::{camera_view, pixel_view, scene_of_meshes, triangle_soup, triangle_soup_in_units},
};
use crate::{
    math::GUARD_BAND,
    scene::{Scene, camera::Camera},
};

pub const CASES: &[Case] = &[
    Case {
        number: 9,
        name: "guard-band",
        about: "corners on the guard band and one unit beyond, in all combinations: exact inside, no cracks beyond",
        expectation: Expectation::Exact,
        run: guard_band,
    },
    Case {
        number: 11,
        name: "near-plane-sweep",
        about: "the near plane moves through a closed shell and the ground below it in 1,000 steps",
        expectation: Expectation::Bounded(
            "at most 48 pixels along a cut may show a neighboring triangle",
        ),
        run: near_plane_sweep,
    },
];

fn guard_band(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(16, 16);
    let center = [2125, 1971];
    let option = pinned(context.quick_option());
    let (mut whole, mut cut) = (0, 0);
    // Each coordinate of four corners lies on the guard band or one unit beyond.
    for beyond in 0..256 {
        let corner = |i: usize, [x, y]: [i32; 2]| {
            let reach = |axis: usize| GUARD_BAND + (beyond >> (2 * i + axis) & 1);
            [x * reach(0), y * reach(1)]
        };
        let [a, b, c, d] = [
            corner(0, [-1, -1]),
            corner(1, [1, -1]),
            corner(2, [1, 1]),
            corner(3, [-1, 1]),
        ];
        let faces = [
            [center, a, b],
            [center, b, c],
            [center, c, d],
            [center, d, a],
        ];
        let scene = scene_of_meshes(&[triangle_soup_in_units(&faces.map(|face| (face, 0.5)))]);
        let what = format!("corners beyond: {beyond:08b}");
        let capture = match beyond {
            // All inside, one corner beyond in either axis, all beyond: on every option.
            0 | 1 | 2 | 255 => context.exact_on_all(&scene, &view, &what)?,
            _ => context.exact(&scene, &view, &stack(&[]), &option, &what)?.0,
        };
        once(&capture, &what)?;
        for (vertex, [x, y]) in capture.geometry.vertices.iter().zip(faces.as_flattened()) {
            let is_inside = x.abs().max(y.abs()) <= GUARD_BAND;
            check!(
                (vertex.flags == 0) == is_inside,
                "{what}: the vertex at {x}, {y} has the flags {}",
                vertex.flags
            );
            check!(
                !is_inside || (vertex.x, vertex.y) == (*x, *y),
                "{what}: {vertex:?} for {x}, {y}"
            );
        }
        let counters = capture.frame.counters;
        (whole, cut) = (whole + 4 - counters.clipped, cut + counters.clipped);
    }
    check!(
        whole >= 4 * 16 && cut > 512,
        "{whole} triangles whole, {cut} cut"
    );
    Ok(())
}

fn near_plane_sweep(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut shell = Scene::clone(&*context.scene("sphere?triangles=300")?);
    shell.materials[0].double_sided = true;
    let ground = scene_of_meshes(&[triangle_soup(vec![
        [-50.0, -0.5, -50.0],
        [-50.0, -0.5, 50.0],
        [50.0, -0.5, 50.0],
    ])]);
    let shell = Arc::new(shell);
    let option = pinned(context.quick_option());
    let (mut cut, mut worst) = (0, 0);
    for step in 0..1000 {
        let way = f64::from(step) / 1000.0;
        let scene = if step % 4 == 0 { &ground } else { &shell };
        let eye = DVec3::new(0.3 - 0.4 * way, 0.9 - 1.6 * way, 1.7 - 1.4 * way);
        let camera = Camera {
            eye,
            target: DVec3::new(0.1, -0.2, -1.0),
            near_m: 0.1,
            ..Camera::default()
        };
        let view = camera_view(scene, &camera, [48, 32]);
        let (capture, verdict) = context.exact(
            scene,
            &view,
            &stack(&["depth"]),
            &option,
            &format!("step {step}"),
        )?;
        cut += u32::from(capture.frame.counters.clipped > 0);
        worst = worst.max(verdict.report.explained_by_snap);
    }
    check!(cut > 300, "{cut} pictures were clipped");
    // Clipped outlines may move by less than a pixel: at most one row along the longest cut.
    check!(
        worst <= 48,
        "{worst} pixels differ from the oracle's own picture"
    );
    context.note(format!(
        "at most {worst} pixels of a picture differ from the oracle's along a cut"
    ));
    Ok(())
}
