//! Culling: pictures of a walk with two passes, each of which hides behind what the picture before it showed.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    drawing::stack,
    scenes::Rng,
};
use crate::{
    accuracy::{Culling, PinnedOptions},
    plan::AccuracyRequest,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

pub const CASES: &[Case] = &[Case {
    number: 34,
    name: "culled-walk",
    about: "a walk with two-pass culling, where each picture hides behind what the one before it showed: every picture is complete",
    expectation: Expectation::Exact,
    run: culled_walk,
}];

/// A walk through a scene: small steps and turns, and now and then a jump.
pub fn walk(scene: &Scene, rng: &mut Rng, steps: usize, size: [u32; 2]) -> Vec<View> {
    let bounds = scene.bounds();
    let reach = bounds.radius().min(30.0);
    let (mut eye, mut turn) = (bounds.center() + DVec3::splat(0.2 * reach), 0.0);
    let mut views = Vec::new();
    let mut pitch = 0.1;
    for step in 0..steps {
        let [mut stride, mut swing] = [0.03 * reach, 0.2];
        if step % 5 == 4 {
            [stride, swing] = [0.7 * reach, 3.0];
        }
        eye += DVec3::new(rng.real(-stride, stride), rng.real(-stride, stride), rng.real(-stride, stride));
        turn += rng.real(-swing, swing);
        if step % 3 == 2 {
            pitch = rng.real(-0.9, 0.9);
        }
        let way = DQuat::from_rotation_y(turn) * DVec3::new(0.0, pitch, -1.0);
        let projection =
            if step % 7 == 6 { Projection::Orthographic { height_m: reach } } else { Projection::Perspective { fov_y_deg: 70.0 } };
        let camera = Camera { eye, target: eye + way, up: DVec3::Y, projection, near_m: 0.02 };
        views.push(View::new(&camera, size[0], size[1], &bounds, DMat4::IDENTITY, [0.0; 4]));
    }
    views
}

fn culled_walk(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let options = context.options();
    let mut rng = context.rng(0x3a1);
    let mut hidden = 0;
    // A town is one large mesh, whose meshlets lie far from its origin.
    for (query, steps, size) in [("field?count=64&triangles=600", 8, [128, 96]), ("cube-wall", 8, [128, 96]), ("town", 12, [200, 136])] {
        let scene: Arc<Scene> = context.scene(query)?;
        let views = walk(&scene, &mut rng, steps, size);
        let mut meshlets = None;
        for &option in &options {
            let pins = PinnedOptions::of(option).with(Culling::TwoPass);
            let accuracy = AccuracyRequest { pins, ..AccuracyRequest::default() };
            for (step, view) in views.iter().enumerate() {
                let what = format!("{query}, step {step}, {}", pins.words());
                let culled = context.exact_next(&scene, view, &stack(&["lambert"]), &accuracy, &what)?;
                hidden += culled.hidden;
                equal(&culled.all(), meshlets.get_or_insert(culled.all()), &format!("{what}: meshlets"))?;
            }
        }
    }
    check!(hidden > 0, "nothing was hidden on the whole walk");
    Ok(())
}
