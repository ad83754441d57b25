//! Extremes: triangle sizes, slivers, coplanar layers, and geometry that crosses every clipping
//! plane.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{
    plates::{PICTURE_PX, pixel_camera},
    query::{BuiltinError, Values},
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

/// A saturated color for each number; consecutive numbers differ clearly.
fn hue(i: u32) -> [f64; 3] {
    let turn = f64::from(i) * 0.618_033_988_75;
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| 0.42 + 0.36 * libm::cos(TAU * (turn + shift)))
}

fn painted() -> Material {
    Material {
        name: "painted".into(),
        double_sided: true,
        ..Material::default()
    }
}

/// A hall along z around the camera. Rings stand across it, one of them in the near plane. Four
/// walls of two triangles each extend `reach` meters in every direction and cross the near plane.
/// Planks leave the guard band on each side.
pub fn near(values: &Values) -> Result<Scene, BuiltinError> {
    const HALF_WIDTH_M: f64 = 1.6;
    const NEAR_M: f64 = 0.05;
    let reach = values.get("reach");
    let mut mesh = MeshBuilder::default();
    for (side, color) in [
        [0.16, 0.17, 0.2],
        [0.34, 0.31, 0.27],
        [0.13, 0.2, 0.24],
        [0.42, 0.4, 0.36],
    ]
    .into_iter()
    .enumerate()
    {
        let (sin, cos) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][side];
        let inward = DVec3::new(cos, sin, 0.0);
        let across = DVec3::Z.cross(inward) * reach;
        let (middle, along) = (-inward * HALF_WIDTH_M, DVec3::Z * reach);
        // Counter-clockwise seen from inside: across x along points inward, as z x n x z = n.
        mesh.quad(
            [
                middle - across - along,
                middle + across - along,
                middle + across + along,
                middle - across + along,
            ],
            color,
        );
    }
    for i in 0..32 {
        hoop(&mut mesh, 2.5 - NEAR_M - 1.25 * f64::from(i), hue(i));
    }
    // Planks across the hall: their ends are in front of the eye and far beyond the guard band.
    for (i, at) in [-0.8, 0.8].into_iter().enumerate() {
        let (low, high) = (at - 0.06, at + 0.06);
        let level = [[-reach, low], [reach, low], [reach, high], [-reach, high]];
        mesh.quad(
            level.map(|[x, y]| DVec3::new(x, y, -3.1)),
            hue(40 + i as u32),
        );
        mesh.quad(
            level.map(|[y, x]| DVec3::new(-x, y, -4.35)),
            hue(42 + i as u32),
        );
    }
    // A rail just below the eye: the near plane cuts it in view.
    mesh.quad(
        [[-0.01, 0.5], [0.01, 0.5], [0.01, -2.5], [-0.01, -2.5]]
            .map(|[x, z]| DVec3::new(x, -0.035, z)),
        [0.85, 0.6, 0.1],
    );
    let pose = Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y_deg: 75.0 },
        near_m: NEAR_M,
    };
    let mut scene = single_mesh_scene(mesh, "hall", painted());
    scene.cameras = vec![SceneCamera {
        name: "inside".into(),
        pose,
        node: None,
    }];
    Ok(scene)
}

/// A closed ring of square cross-section around the z axis.
fn hoop(mesh: &mut MeshBuilder, z: f64, color: [f64; 3]) {
    const SEGMENTS: u32 = 48;
    /// (radius, depth) of the corners of the cross-section, and the outward normal of the face that
    /// follows.
    const SECTION: [([f64; 2], [f64; 2]); 4] = [
        ([1.2, 0.15], [-1.0, 0.0]),
        ([1.2, -0.15], [0.0, -1.0]),
        ([1.45, -0.15], [1.0, 0.0]),
        ([1.45, 0.15], [0.0, 1.0]),
    ];
    for face in 0..4 {
        let (_, out) = SECTION[face];
        let edge = |mesh: &mut MeshBuilder, [radius, depth]: [f64; 2]| {
            mesh.ring(SEGMENTS, |mesh, i| {
                let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(SEGMENTS));
                mesh.colored_vertex(
                    DVec3::new(radius * cos, radius * sin, z + depth),
                    DVec3::new(out[0] * cos, out[0] * sin, out[1]),
                    color,
                );
            })
        };
        let (from, to) = (
            edge(mesh, SECTION[face].0),
            edge(mesh, SECTION[(face + 1) % 4].0),
        );
        mesh.band(from, to);
    }
}

/// Triangles of nine sizes, a meter apart in depth. Small ones are scattered over the picture; one
/// edge of each large one crosses it.
pub fn sizes(values: &Values) -> Result<Scene, BuiltinError> {
    const COPIES: [u32; 9] = [512, 512, 256, 256, 96, 10, 3, 2, 2];
    let seed = hash(values.whole("seed"));
    let mut mesh = MeshBuilder::default();
    let mut chance = seed;
    let mut next = || {
        chance = chance.wrapping_add(0x9e37_79b9);
        hash_unit(chance)
    };
    for (step, copies) in COPIES.into_iter().enumerate() {
        let side = libm::pow(10.0, step as f64 - 3.0);
        for copy in 0..copies {
            let (sin, cos) = libm::sincos(TAU * next());
            let offset = DVec2::new(next() - 0.5, next() - 0.5) * PICTURE_PX;
            // 0.2887 is the distance from the center of an equilateral triangle of side 1 to its
            // sides.
            let middle = if side > PICTURE_PX {
                0.5 * offset + DVec2::new(sin, -cos) * (0.2887 * side)
            } else {
                offset
            };
            let corner = |x: f64, y: f64| {
                let turned = DVec2::new(cos * x - sin * y, sin * x + cos * y);
                (middle + turned * side).extend(-(step as f64) - 1e-3 * f64::from(copy))
            };
            mesh.facet(
                [
                    corner(-0.5, -0.2887),
                    corner(0.5, -0.2887),
                    corner(0.0, 0.5774),
                ],
                hue(step as u32),
            );
        }
    }
    let mut scene = single_mesh_scene(mesh, "sizes", painted());
    scene.cameras = vec![pixel_camera(PICTURE_PX, 100.0)];
    Ok(scene)
}

/// Needles from near the center outwards; heights cycle through 1 to 8 units.
pub fn slivers(values: &Values) -> Result<Scene, BuiltinError> {
    let (n, length) = (values.whole("n"), values.get("length"));
    let mut mesh = MeshBuilder::with_capacity(3 * n as usize, n as usize);
    for i in 0..n {
        let (sin, cos) = libm::sincos(TAU * (f64::from(i) + 0.37) / f64::from(n));
        let (along, across) = (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0));
        let height = f64::from(1 + i % 8) / f64::from(UNITS_PER_PIXEL);
        let root = along * (0.05 * length);
        let corners = [
            root,
            root + along * length - across * (0.5 * height),
            root + along * length + across * (0.5 * height),
        ];
        mesh.facet(corners, hue(i));
    }
    let mut scene = single_mesh_scene(mesh, "slivers", painted());
    scene.cameras = vec![pixel_camera(PICTURE_PX, 100.0)];
    Ok(scene)
}

/// Rotated squares, smallest and nearest first.
pub fn stack(values: &Values) -> Result<Scene, BuiltinError> {
    let (layers, gap) = (values.whole("layers"), values.get("gap"));
    let mut mesh = MeshBuilder::with_capacity(4 * layers as usize, 2 * layers as usize);
    for layer in 0..layers {
        // Later layers are larger, so each shows a rim behind the previous ones.
        let half = PICTURE_PX * (0.12 + 0.3 * f64::from(layer + 1) / f64::from(layers));
        let z = -gap * f64::from(layer);
        let turn = TAU * 0.618_033_988_75 * f64::from(layer);
        let corners = [0.0, 0.25, 0.5, 0.75].map(|quarter| {
            let (sin, cos) = libm::sincos(turn + TAU * quarter);
            DVec3::new(half * cos, half * sin, z)
        });
        mesh.quad(corners, hue(layer));
    }
    let mut scene = single_mesh_scene(mesh, "stack", painted());
    scene.cameras = vec![pixel_camera(PICTURE_PX, 100.0)];
    Ok(scene)
}
