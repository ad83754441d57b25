//! Shapes: sphere, trefoil knot, cube wall and chamber.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec3};

use super::query::{BuiltinError, Values};
use crate::scene::{
    memory::MemoryBudget,
    mesh_builder::{MeshBuilder, Ring},
};
use crate::{
    math::hash_unit,
    scene::{
        material::Material,
        model::{Instance, Scene},
    },
};

/// Waves of the bumpy sphere: direction times frequency, and amplitude.
const WAVES: [(DVec3, f64, f64); 4] = [
    (DVec3::new(3.1, 1.7, -2.2), 0.4, 0.055),
    (DVec3::new(-2.4, 4.3, 1.9), 1.3, 0.05),
    (DVec3::new(5.6, -1.8, 5.1), 2.1, 0.032),
    (DVec3::new(-6.7, -7.9, 8.1), 0.7, 0.021),
];

/// A closed sphere of radius about 1 with the given even number of triangles, nearly equilateral
/// before the bumps.
///
/// Rings of latitude share the vertices in proportion to their length. A closed mesh of V vertices
/// has 2V - 4 triangles (Euler). Two vertices are the poles, so the rings have V - 2 = triangles /
/// 2 vertices.
pub fn sphere(values: &Values) -> Result<Scene, BuiltinError> {
    let on_rings = values.whole("triangles") / 2;
    // Two triangles for each vertex: twelve bytes each of indices, and 24 of attributes.
    let (bytes, budget) = (48 * u64::from(on_rings), MemoryBudget::of_process());
    if bytes > budget.decoded() {
        let most = budget.decoded() / 24;
        return Err(BuiltinError(format!(
            "sphere: {} triangles; allowed: at most {most} {}",
            2 * on_rings,
            budget.remedy()
        )));
    }
    // Rows of equilateral triangles of height h cover the sphere when h^2 = 4 pi sqrt(3) /
    // triangles.
    let height = (TAU * 3.0f64.sqrt() / f64::from(on_rings)).sqrt();
    let step = PI / (PI / height).round().max(4.0);
    let rings = (PI / step).round() as u32 - 1;
    // Sum of the lengths sin(k * step) of the first i rings.
    let length = |i: u32| {
        libm::sin(0.5 * step * f64::from(i)) * libm::sin(0.5 * step * f64::from(i + 1))
            / libm::sin(0.5 * step)
    };
    let mut mesh = MeshBuilder::with_capacity(on_rings as usize + 2, 2 * on_rings as usize);
    let mut below = mesh.ring(1, |mesh, _| bump(mesh, DVec3::NEG_Y));
    let mut given = 0;
    for i in 1..=rings {
        let upto = (f64::from(on_rings) * length(i) / length(rings)).round() as u32;
        let count = upto.saturating_sub(given).max(3);
        given += count;
        let (sin, cos) = libm::sincos(step * f64::from(i));
        let ring = mesh.ring(count, |mesh, j| {
            let (s, c) = libm::sincos(TAU * f64::from(j) / f64::from(count));
            bump(mesh, DVec3::new(sin * s, -cos, sin * c));
        });
        mesh.band(below, ring);
        below = ring;
    }
    let top = mesh.ring(1, |mesh, _| bump(mesh, DVec3::Y));
    mesh.band(below, top);
    Ok(single_mesh_scene(
        mesh,
        "sphere",
        Material {
            name: "clay".into(),
            base_color: [0.42, 0.47, 0.52, 1.0],
            ..Material::default()
        },
    ))
}

/// The surface over direction `d` (a unit vector): radius r(d) = 1 + waves, normal from the
/// gradient of |p| - r(p / |p|).
fn bump(mesh: &mut MeshBuilder, d: DVec3) {
    let (mut radius, mut slope) = (1.0, DVec3::ZERO);
    for (wave, phase, amplitude) in WAVES {
        let (sin, cos) = libm::sincos(wave.dot(d) + phase);
        radius += amplitude * sin;
        slope += wave * (amplitude * cos);
    }
    let tangential = slope - d * slope.dot(d);
    mesh.vertex(d * radius, d - tangential / radius);
}

/// A trefoil: a tube around the curve that winds twice around the axis of a torus and three times
/// around its core.
pub fn knot(values: &Values) -> Result<Scene, BuiltinError> {
    const CORE_M: f64 = 0.8;
    const RING_M: f64 = 0.36;
    const TUBE_M: f64 = 0.2;
    const TONES: [[f64; 3]; 2] = [[0.86, 0.55, 0.16], [0.05, 0.22, 0.33]];
    let tess = values.whole("tess");
    let (along, round) = (24 * tess, 2 * tess);
    let mut mesh =
        MeshBuilder::with_capacity((along * round) as usize, (2 * along * round) as usize);
    let rings: Vec<Ring> = (0..along)
        .map(|i| {
            let turn = TAU * f64::from(i) / f64::from(along);
            let ((s2, c2), (s3, c3)) = (libm::sincos(2.0 * turn), libm::sincos(3.0 * turn));
            let reach = CORE_M + RING_M * c3;
            let center = DVec3::new(reach * c2, reach * s2, RING_M * s3);
            let drift = -3.0 * RING_M * s3;
            let tangent = DVec3::new(
                drift * c2 - 2.0 * reach * s2,
                drift * s2 + 2.0 * reach * c2,
                3.0 * RING_M * c3,
            )
            .normalize();
            // The normal of the torus is perpendicular to every curve on it, and closes after one
            // turn.
            let out = DVec3::new(c3 * c2, c3 * s2, s3);
            let side = tangent.cross(out);
            mesh.ring(round, |mesh, j| {
                let (sin, cos) = libm::sincos(TAU * f64::from(j) / f64::from(round));
                let normal = out * cos + side * sin;
                let stripe = 0.5
                    + 0.5
                        * (libm::sin(TAU * f64::from(j) / f64::from(round) + 9.0 * turn) * 6.0)
                            .clamp(-1.0, 1.0);
                let color =
                    std::array::from_fn(|c| TONES[0][c] + (TONES[1][c] - TONES[0][c]) * stripe);
                mesh.colored_vertex(center + normal * TUBE_M, normal, color);
            })
        })
        .collect();
    for (i, &ring) in rings.iter().enumerate() {
        mesh.band(ring, rings[(i + 1) % rings.len()]);
    }
    Ok(single_mesh_scene(
        mesh,
        "knot",
        Material {
            name: "enamel".into(),
            ..Material::default()
        },
    ))
}

/// Instances of one cube at depths that follow a wave. Its six primitives differ only in material.
pub fn cube_wall(values: &Values) -> Result<Scene, BuiltinError> {
    const PALETTE: [(&str, [f32; 3]); 6] = [
        ("coral", [0.82, 0.17, 0.10]),
        ("amber", [0.85, 0.45, 0.07]),
        ("sand", [0.76, 0.64, 0.42]),
        ("teal", [0.04, 0.36, 0.36]),
        ("ink", [0.03, 0.08, 0.20]),
        ("chalk", [0.80, 0.80, 0.76]),
    ];
    let (columns, rows, seed) = (
        values.whole("columns"),
        values.whole("rows"),
        values.whole("seed"),
    );
    let mut scene = Scene::default();
    let first = cube().append(&mut scene, "cube", 0);
    for (material, (name, [r, g, b])) in PALETTE.into_iter().enumerate() {
        scene.materials.push(Material {
            name: name.into(),
            base_color: [r, g, b, 1.0],
            ..Material::default()
        });
        if material > 0 {
            let mut primitive = scene.primitives[first].clone();
            primitive.material = material;
            scene.primitives.push(primitive);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let chance = |salt: u32| {
                hash_unit(
                    (row * columns + column).wrapping_mul(4).wrapping_add(salt)
                        ^ crate::math::hash(seed),
                )
            };
            let (x, y) = (
                f64::from(column) - 0.5 * f64::from(columns - 1),
                f64::from(row) - 0.5 * f64::from(rows - 1),
            );
            let z =
                0.7 * libm::sin(0.55 * x + 0.8) * libm::cos(0.6 * y) + 0.9 * chance(0) * chance(1);
            // Colors change gradually across the wall; random numbers mix neighbors.
            let tone = (f64::from(column) / f64::from(columns) * 4.0 + 2.0 * chance(2)) as usize
                % PALETTE.len();
            let placement = DMat4::from_translation(DVec3::new(x, y, z))
                * DMat4::from_scale(DVec3::new(0.47, 0.47, 0.9));
            scene
                .instances
                .push(Instance::fixed(first + tone, placement));
        }
    }
    Ok(scene)
}

/// The cube from -1 to 1 with flat faces.
fn cube() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (out, u) = (DVec3::AXES[axis] * side, DVec3::AXES[(axis + 1) % 3]);
            let v = out.cross(u);
            let corners =
                [-u - v, u - v, u + v, v - u].map(|corner| mesh.vertex(out + corner, out));
            mesh.triangle([corners[0], corners[1], corners[2]]);
            mesh.triangle([corners[0], corners[2], corners[3]]);
        }
    }
    mesh
}

/// A cube seen from the inside, with the lightest floor.
pub fn chamber(values: &Values) -> Result<Scene, BuiltinError> {
    const TONES: [[f64; 3]; 3] = [
        [0.012, 0.012, 0.02],
        [0.024, 0.024, 0.032],
        [0.008, 0.012, 0.02],
    ];
    let half = values.get("half");
    let mut mesh = MeshBuilder::default();
    for (axis, tone) in TONES.into_iter().enumerate() {
        for side in [-1.0, 1.0] {
            let (inward, u) = (DVec3::AXES[axis] * -side, DVec3::AXES[(axis + 1) % 3]);
            let v = inward.cross(u);
            mesh.quad(
                [-u - v, u - v, u + v, v - u].map(|corner| (corner - inward) * half),
                tone,
            );
        }
    }
    Ok(single_mesh_scene(
        mesh,
        "chamber",
        Material {
            name: "plaster".into(),
            ..Material::default()
        },
    ))
}

/// A scene of one mesh with an identity transform.
pub fn single_mesh_scene(mesh: MeshBuilder, name: &str, material: Material) -> Scene {
    let mut scene = Scene {
        materials: vec![material],
        ..Scene::default()
    };
    let primitive = mesh.append(&mut scene, name, 0);
    scene
        .instances
        .push(Instance::fixed(primitive, DMat4::IDENTITY));
    scene
}
