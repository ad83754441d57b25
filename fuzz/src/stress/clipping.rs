//! Clipping: the near plane moving through a surface.

use std::sync::Arc;

use glam::DVec3;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    drawing::{pinned, stack},
    scenes::{camera_view, scene_of_meshes, triangle_soup},
};
use crate::scene::{Scene, camera::Camera};

pub const CASES: &[Case] = &[Case {
    number: 11,
    name: "near-plane-sweep",
    about: "the near plane moves through a closed shell and the ground below it in 1,000 steps",
    expectation: Expectation::Bounded(
        "at most 48 pixels along a cut may show a neighboring triangle",
    ),
    run: near_plane_sweep,
}];

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
