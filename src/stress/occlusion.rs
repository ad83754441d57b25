//! What culling may only just hide: meshes behind a wall with holes.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, EulerRot};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    scenes::{Rng, scene_of_meshes, triangle_soup},
};
use crate::{
    accuracy::{Culling, PinnedOptions},
    effects::Stack,
    plan::AccuracyRequest,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

pub const CASES: &[Case] = &[Case {
    number: 34,
    name: "culled-behind-holes",
    about: "meshes behind a wall with holes of a few pixels, from millimeters to kilometers: two-pass culling hides what the wall covers, and nothing else",
    expectation: Expectation::Exact,
    run: culled_behind_holes,
}];

const SIZE: [u32; 2] = [128, 96];
/// Distance of the wall, in units of the scene.
const DISTANCE: f64 = 10.0;
const FOV_Y_DEG: f64 = 50.0;

/// A camera with its axes as columns: right, up and backward.
struct Eye {
    axes: DMat3,
    /// Meters per unit of the scene.
    scale: f64,
}

impl Eye {
    /// Side of a pixel at [`DISTANCE`], in units.
    fn pixel() -> f64 {
        2.0 * libm::tan(0.5 * FOV_Y_DEG.to_radians()) * DISTANCE / f64::from(SIZE[1])
    }

    /// World space of a point of the camera's space, units.
    fn point(&self, [right, up, ahead]: [f64; 3]) -> [f32; 3] {
        (self.axes * DVec3::new(right, up, -ahead) * self.scale).as_vec3().to_array()
    }

    /// Two triangles in a plane across the view, with this center and these half sides.
    fn rectangle(&self, [right, up, ahead]: [f64; 3], [a, b]: [f64; 2]) -> [[f32; 3]; 6] {
        [[-a, -b], [-a, b], [a, b], [-a, -b], [a, b], [a, -b]].map(|[x, y]| self.point([right + x, up + y, ahead]))
    }

    /// From a place beside the origin, units.
    fn view(&self, scene: &Scene, aside: [f64; 2]) -> View {
        let eye = self.axes * DVec3::new(aside[0], aside[1], 0.0) * self.scale;
        let projection = Projection::Perspective { fov_y_deg: FOV_Y_DEG };
        let camera =
            Camera { eye, target: eye - self.axes.z_axis * self.scale, up: self.axes.y_axis, projection, near_m: 0.1 * self.scale };
        View::new(&camera, SIZE[0], SIZE[1], &scene.bounds(), DMat4::IDENTITY, [0.0; 4])
    }
}

/// A wall of squares of four pixels, one in twelve of which is missing, and rectangles of half a pixel to sixteen pixels behind it,
/// each a mesh of its own.
fn wall_with_holes(eye: &Eye, rng: &mut Rng) -> Arc<Scene> {
    const CELL: u32 = 4;
    let pixel = Eye::pixel();
    let half = 0.5 * f64::from(CELL) * pixel;
    let at = |index: u32, side: u32| (f64::from(index * CELL) + 0.5 * f64::from(CELL) - 0.5 * f64::from(side)) * pixel;
    let cells = (0..SIZE[1] / CELL).flat_map(|row| (0..SIZE[0] / CELL).map(move |column| [column, row]));
    let wall: Vec<_> = cells
        .filter(|_| rng.between(0, 12) > 0)
        .flat_map(|[column, row]| eye.rectangle([at(column, SIZE[0]), at(row, SIZE[1]), DISTANCE], [half; 2]))
        .collect();
    let mut meshes = vec![triangle_soup(wall)];
    meshes.extend((0..400).map(|_| {
        let [right, up] = SIZE.map(|side| rng.real(-0.5, 0.5) * f64::from(side) * pixel);
        let sides = [0, 1].map(|_| 0.25 * pixel * libm::exp2(rng.real(0.0, 5.0)));
        triangle_soup(eye.rectangle([right, up, DISTANCE * rng.real(1.01, 1.1)], sides))
    }));
    scene_of_meshes(&meshes)
}

fn culled_behind_holes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(0x401e);
    let turned = DMat3::from_euler(EulerRot::YXZ, 0.7, -0.5, 0.4);
    let pins = PinnedOptions::of(Culling::TwoPass).with(context.quick_option());
    let accuracy = AccuracyRequest { pins, ..AccuracyRequest::default() };
    let (mut hidden, mut drawn) = (0, 0);
    for (scale, axes) in [(1e-3, turned), (1.0, DMat3::IDENTITY), (1.0, turned.transpose()), (1e3, turned)] {
        let eye = Eye { axes, scale };
        let scene = wall_with_holes(&eye, &mut rng);
        for step in 0..5 {
            // The first picture has no other to hide behind.
            let aside = [0, 1].map(|_| rng.real(-2.0, 2.0) * Eye::pixel());
            let what = format!("{scale} m, step {step}");
            let culled = context.exact_next(&scene, &eye.view(&scene, aside), &Stack::default(), &accuracy, &what)?;
            (hidden, drawn) = (hidden + culled.hidden, drawn + culled.drawn);
        }
    }
    check!(hidden > 300 && drawn > 1000, "{hidden} meshlets were hidden, and {drawn} drawn");
    Ok(())
}
