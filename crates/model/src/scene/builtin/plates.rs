//! Plates: flat meshes measured in pixels, for counting holes and double hits.
//!
//! One meter is one pixel: the camera is orthographic and `height_m` high, so cells have their size
//! only in a picture of `height` (and `width`) pixels. The origin is the center of the picture, x
//! points right, y up. With even sizes pixel centers lie on odd multiples of half a meter.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    query::{BuiltinError, MAX_TRIANGLES, Values},
    shapes::single_mesh_scene,
};
use crate::scene::mesh_builder::MeshBuilder;
use crate::{
    math::{UNITS_PER_PIXEL, hash, hash_unit},
    scene::{
        camera::{Camera, Projection},
        material::Material,
        model::{Scene, SceneCamera},
    },
};

/// Height in pixels of the picture for plates that do not specify one.
pub const PICTURE_PX: f64 = 256.0;

/// A camera for which one meter is one pixel in a picture `height_px` high, `distance_m` in front
/// of the origin.
pub fn pixel_camera(height_px: f64, distance_m: f64) -> SceneCamera {
    let pose = Camera {
        eye: DVec3::Z * distance_m,
        target: DVec3::ZERO,
        up: DVec3::Y,
        projection: Projection::Orthographic {
            height_m: height_px,
        },
        near_m: 0.01,
    };
    SceneCamera {
        name: "pixels".into(),
        pose,
        node: None,
    }
}

/// The same scale on the plane z = 0 in perspective; w is equal at all vertices.
fn perspective_camera(height_px: f64) -> SceneCamera {
    let fov_y_deg = 2.0 * libm::atan(0.5).to_degrees();
    let pose = Camera {
        projection: Projection::Perspective { fov_y_deg },
        ..pixel_camera(height_px, height_px).pose
    };
    SceneCamera {
        name: "pixels in perspective".into(),
        pose,
        node: None,
    }
}

fn plate_material() -> Material {
    Material {
        name: "plate".into(),
        base_color: [0.8, 0.8, 0.8, 1.0],
        double_sided: true,
        ..Material::default()
    }
}

/// A jittered grid that extends beyond a `width` x `height` picture on all sides, so each sample is
/// covered exactly once.
///
/// It cannot fold: if every vertex of a cell of side c moves by at most a in x and in y, the
/// smallest oriented area is ((c - 2a)^2 - (2a)^2) / 2, which is positive for a < c/4. The snap
/// (half a unit) and the lattice (half a step) count towards a; the jitter uses four fifths of the
/// rest.
pub fn grid(values: &Values) -> Result<Scene, BuiltinError> {
    let (cell, seed, lattice) = (
        values.get("cell"),
        values.whole("seed"),
        values.get("lattice"),
    );
    let (width, height) = (values.get("width"), values.get("height"));
    let (columns, rows) = (
        (width / cell).ceil() as u64 + 4,
        (height / cell).ceil() as u64 + 4,
    );
    let triangles = 2 * columns * rows;
    if triangles > MAX_TRIANGLES {
        return Err(BuiltinError(format!(
            "grid: cell={cell} on {width}x{height} px makes {triangles} triangles; allowed: at most {MAX_TRIANGLES}. Increase cell"
        )));
    }
    let lattice_step = if lattice > 0.0 { 1.0 / lattice } else { 0.0 };
    let max_jitter = 0.25 * cell - 0.5 * lattice_step - 0.5 / f64::from(UNITS_PER_PIXEL);
    if max_jitter <= 0.0 {
        return Err(BuiltinError(format!(
            "grid: lattice={lattice} is too coarse for cell={cell}, cells would fold; lattice must be above {:.1}",
            2.1 / cell
        )));
    }
    let mut mesh =
        MeshBuilder::with_capacity(((columns + 1) * (rows + 1)) as usize, triangles as usize);
    for row in 0..=rows {
        for column in 0..=columns {
            let salt = hash(hash(seed) ^ (row as u32)).wrapping_add(2 * column as u32);
            let jittered = |at: u64, count: u64, salt: u32| {
                let straight = (at as f64 - 0.5 * count as f64) * cell;
                let moved = straight + 0.8 * max_jitter * (2.0 * hash_unit(salt) - 1.0);
                if lattice > 0.0 {
                    (moved * lattice).round() / lattice
                } else {
                    moved
                }
            };
            mesh.vertex(
                DVec3::new(
                    jittered(column, columns, salt),
                    jittered(row, rows, salt + 1),
                    0.0,
                ),
                DVec3::Z,
            );
        }
    }
    let stride = columns as u32 + 1;
    for row in 0..rows as u32 {
        for column in 0..columns as u32 {
            let (a, b) = (row * stride + column, (row + 1) * stride + column);
            // Diagonals alternate, so that edges have all directions.
            let quad = if (row ^ column) & 1 == 0 {
                [[a, a + 1, b + 1], [a, b + 1, b]]
            } else {
                [[a, a + 1, b], [a + 1, b + 1, b]]
            };
            quad.into_iter().for_each(|t| mesh.triangle(t));
        }
    }
    let mut scene = single_mesh_scene(mesh, "grid", plate_material());
    scene.cameras = vec![pixel_camera(height, 100.0), perspective_camera(height)];
    Ok(scene)
}

/// `n` triangles around the sample to the right of and above the center of the picture.
pub fn fan(values: &Values) -> Result<Scene, BuiltinError> {
    let (n, radius, seed) = (
        values.whole("n"),
        values.get("radius"),
        values.whole("seed"),
    );
    // Three units of rim per triangle: with fewer than two the snap could reorder the vertices of
    // the rim.
    let most = TAU * radius * f64::from(UNITS_PER_PIXEL) / 3.0;
    if f64::from(n) > most {
        return Err(BuiltinError(format!(
            "fan: n={n} triangles would fold after the snap at radius={radius}; allowed: at most {}",
            most.floor()
        )));
    }
    let mut mesh = MeshBuilder::with_capacity(n as usize + 1, n as usize);
    let sample = DVec3::new(0.5, 0.5, 0.0);
    let start = hash_unit(hash(seed));
    let center = mesh.ring(1, |mesh, _| {
        mesh.vertex(sample, DVec3::Z);
    });
    let rim = mesh.ring(n, |mesh, i| {
        let (sin, cos) = libm::sincos(TAU * (f64::from(i) + start) / f64::from(n));
        mesh.vertex(sample + DVec3::new(cos, sin, 0.0) * radius, DVec3::Z);
    });
    mesh.band(rim, center);
    let mut scene = single_mesh_scene(mesh, "fan", plate_material());
    scene.cameras = vec![pixel_camera(PICTURE_PX, 100.0)];
    Ok(scene)
}
