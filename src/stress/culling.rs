//! Culling: pictures of a walk with two passes, each of which hides behind what the picture before it showed.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, same},
    context::CaseContext,
    drawing::stack,
    scenes::{Rng, scene_of_meshes, triangle_soup},
};
use crate::{
    accuracy::{Culling, PinnedOptions, PositionFormat},
    effects::Stack,
    plan::AccuracyRequest,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

pub const CASES: &[Case] = &[
    Case {
        number: 34,
        name: "culled-walk",
        about: "a walk with two-pass culling, where each picture hides behind what the one before it showed: every picture is complete",
        expectation: Expectation::Exact,
        run: culled_walk,
    },
    Case {
        number: 34,
        name: "slivers-at-the-border",
        about: "slivers along each border of the picture, far from the origin, where rounding moves them in or out: culling loses none",
        expectation: Expectation::Bounded("the same triangle ids, depth keys and numbers of hits as without culling"),
        run: slivers_at_the_border,
    },
];

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

/// Triangles a few pixels long along the four borders of the picture of a camera at `eye` that looks along -z, each a mesh of its own, at
/// most `spread` pixels from the border on either side. `pixel`: the side of a pixel at a distance of 1 m.
fn slivers(rng: &mut Rng, eye: DVec3, [width, height]: [u32; 2], pixel: f64, spread: f64, distance: f64) -> Arc<Scene> {
    let sliver = |i: usize| {
        let half = [0.5 * f64::from(width), 0.5 * f64::from(height)];
        let aside = i % 2;
        let side = if i % 4 < 2 { 1.0 } else { -1.0 };
        let across = side * (half[aside] + rng.real(-spread, spread));
        let along = rng.real(-half[1 - aside], half[1 - aside]);
        let corners = [[0.0, 0.0], [8.0, 0.3], [3.0, 0.6]].map(|[far, thick]| {
            let mut at = [0.0; 2];
            (at[aside], at[1 - aside]) = (across + thick, along + far);
            (eye + DVec3::new(at[0] * pixel, at[1] * pixel, -1.0) * distance).as_vec3().to_array()
        });
        triangle_soup(corners)
    };
    scene_of_meshes(&(0..96).map(sliver).collect::<Vec<_>>())
}

fn slivers_at_the_border(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(0xb0d);
    let size = [64, 48];
    let (mut outside, mut drawn) = (0, 0);
    for offset in [0.0, 1e4, 1e6] {
        for projection in [Projection::Perspective { fov_y_deg: 50.0 }, Projection::Orthographic { height_m: 12.0 }] {
            let (pixel, distance) = match projection {
                Projection::Perspective { fov_y_deg } => (2.0 * libm::tan(0.5 * fov_y_deg.to_radians()) / f64::from(size[1]), 10.0),
                Projection::Orthographic { height_m } => (height_m / f64::from(size[1]), 1.0),
            };
            let eye = DVec3::new(0.7, -0.6, 0.4) * offset;
            // How far rounding moves a corner, at least.
            let spread = 1.0 + offset * f64::from(f32::EPSILON) / (pixel * distance);
            let scene = slivers(&mut rng, eye, size, pixel, spread, distance);
            let camera = Camera { eye, target: eye + DVec3::NEG_Z, up: DVec3::Y, projection, near_m: 0.5 };
            let view = View::new(&camera, size[0], size[1], &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
            for position in [PositionFormat::Stored, PositionFormat::Relative] {
                let accuracy = |culling| {
                    let pins = PinnedOptions::of(culling).with(position).with(context.quick_option());
                    AccuracyRequest { pins, ..AccuracyRequest::default() }
                };
                let [whole, frustum, two_pass] = [Culling::None, Culling::Frustum, Culling::TwoPass].map(accuracy);
                let what = format!("{offset:e} m from the origin, {projection:?}, {} positions", position.name());
                let reference = context.captured(&scene, &view, &Stack::default(), &whole, &what)?;
                for (culled, how) in [(frustum, "frustum"), (two_pass, "two-pass")] {
                    let what = format!("{what}, {how}");
                    let capture = context.captured(&scene, &view, &Stack::default(), &culled, &what)?;
                    same(&capture, &reference, &what)?;
                    outside += context.renderer.culled().unwrap_or_default().outside;
                }
                drawn += reference.frame.covered();
            }
        }
    }
    check!(outside > 100 && drawn > 100, "{outside} slivers were culled, and {drawn} pixels show others");
    Ok(())
}
