//! What culling may only just hide: meshes behind a wall with holes.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, EulerRot};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    scenes::{Rng, SimpleMesh, scene_of_meshes, triangle_soup},
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
        (self.axes * DVec3::new(right, up, -ahead) * self.scale)
            .as_vec3()
            .to_array()
    }

    /// Two triangles in a plane across the view, with this center and these half sides.
    fn rectangle(&self, [right, up, ahead]: [f64; 3], [a, b]: [f64; 2]) -> [[f32; 3]; 6] {
        [[-a, -b], [-a, b], [a, b], [-a, -b], [a, b], [a, -b]]
            .map(|[x, y]| self.point([right + x, up + y, ahead]))
    }

    /// From a place beside the origin, units.
    fn view(&self, scene: &Scene, aside: [f64; 2]) -> View {
        let eye = self.axes * DVec3::new(aside[0], aside[1], 0.0) * self.scale;
        let projection = Projection::Perspective {
            fov_y_deg: FOV_Y_DEG,
        };
        let camera = Camera {
            eye,
            target: eye - self.axes.z_axis * self.scale,
            up: self.axes.y_axis,
            projection,
            near_m: 0.1 * self.scale,
        };
        View::new(
            &camera,
            SIZE[0],
            SIZE[1],
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        )
    }
}

/// Side of a square of the wall, pixels.
const CELL: u32 = 4;
/// Squares of the wall across and up.
const CELLS: [u32; 2] = [SIZE[0] / CELL, SIZE[1] / CELL];

/// A wall over the whole picture, of squares of which some are missing: column and row, counted
/// from the lower left, tell which.
fn wall(eye: &Eye, mut is_there: impl FnMut([u32; 2]) -> bool) -> SimpleMesh {
    let pixel = Eye::pixel();
    let half = 0.5 * f64::from(CELL) * pixel;
    let at = |index: u32, side: u32| {
        (f64::from(index * CELL) + 0.5 * f64::from(CELL) - 0.5 * f64::from(side)) * pixel
    };
    let cells = (0..CELLS[1]).flat_map(|row| (0..CELLS[0]).map(move |column| [column, row]));
    let squares = cells
        .filter(|cell| is_there(*cell))
        .flat_map(|[column, row]| {
            eye.rectangle([at(column, SIZE[0]), at(row, SIZE[1]), DISTANCE], [half; 2])
        });
    triangle_soup(squares.collect::<Vec<_>>())
}

/// A wall with one hole in a tile of 8x8 pixels of the upper left block of 64x64, and behind it one
/// mesh that is wider than a block and shows through the hole alone: whether it is hidden is asked
/// of whole blocks.
fn wall_with_a_hole(eye: &Eye, tile: u32) -> Arc<Scene> {
    let hole = [tile % 8 * 8 / CELL, CELLS[1] - 1 - tile / 8 * 8 / CELL];
    let pixel = Eye::pixel();
    // From the left border to pixel 100, and from the upper one to pixel 62.
    let center = [
        (50.0 - 0.5 * f64::from(SIZE[0])) * pixel,
        (0.5 * f64::from(SIZE[1]) - 31.0) * pixel,
        DISTANCE * 1.001,
    ];
    let behind = triangle_soup(eye.rectangle(center, [50.0 * pixel, 31.0 * pixel]));
    scene_of_meshes(&[wall(eye, |cell| cell != hole), behind])
}

/// A wall of squares of four pixels, one in twelve of which is missing, and rectangles of half a
/// pixel to sixteen pixels behind it, each a mesh of its own.
fn wall_with_holes(eye: &Eye, rng: &mut Rng) -> Arc<Scene> {
    let pixel = Eye::pixel();
    let mut meshes = vec![wall(eye, |_| rng.between(0, 12) > 0)];
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
    let accuracy = AccuracyRequest {
        pins,
        ..AccuracyRequest::default()
    };
    let (mut hidden, mut drawn) = (0, 0);
    for (scale, axes) in [
        (1e-3, turned),
        (1.0, DMat3::IDENTITY),
        (1.0, turned.transpose()),
        (1e3, turned),
    ] {
        let eye = Eye { axes, scale };
        let scene = wall_with_holes(&eye, &mut rng);
        for step in 0..5 {
            // The first picture has no other to hide behind.
            let aside = [0, 1].map(|_| rng.real(-2.0, 2.0) * Eye::pixel());
            let what = format!("{scale} m, step {step}");
            let culled = context.exact_next(
                &scene,
                &eye.view(&scene, aside),
                &Stack::default(),
                &accuracy,
                &what,
            )?;
            (hidden, drawn) = (hidden + culled.hidden, drawn + culled.drawn);
        }
    }
    // Tiles that halves of a block end and begin with.
    let eye = Eye {
        axes: DMat3::IDENTITY,
        scale: 1.0,
    };
    for tile in [0, 1, 2, 3, 6, 7, 14, 15, 30, 31, 32, 33, 62, 63] {
        let scene = wall_with_a_hole(&eye, tile);
        // The second picture decides what the third one draws first.
        for step in 0..3 {
            let what = format!("a hole in tile {tile}, step {step}");
            let culled = context.exact_next(
                &scene,
                &eye.view(&scene, [0.0; 2]),
                &Stack::default(),
                &accuracy,
                &what,
            )?;
            (hidden, drawn) = (hidden + culled.hidden, drawn + culled.drawn);
        }
    }
    check!(
        hidden > 300 && drawn > 1000,
        "{hidden} meshlets were hidden, and {drawn} drawn"
    );
    Ok(())
}
