//! Finishes: balls in rows, from metal behind to glaze in front, rougher from left to right. Lights
//! may hang over them.

use std::f64::consts::PI;

use glam::{DMat4, DVec3};

use super::query::{BuiltinError, Values};
use crate::scene::{
    material::Material,
    mesh_builder::{MeshBuilder, Ring},
    model::{Instance, Scene},
    punctual::{LightKind, SceneLight},
};

/// Radius of a ball, meters.
const RADIUS_M: f64 = 0.45;
/// Distances between the middles of neighbors in a row, and between rows, meters.
const PITCH_M: [f64; 2] = [1.05, 1.15];

/// Linear base colors of the rows, from metallic 0 to 1.
const COLORS: [DVec3; 3] = [
    DVec3::new(0.02, 0.19, 0.24),
    DVec3::new(0.60, 0.13, 0.07),
    DVec3::new(1.0, 0.72, 0.31),
];

/// Builds the scene `finishes`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (tess, columns, rows) = (
        values.whole("tess"),
        values.whole("columns"),
        values.whole("rows"),
    );
    let half = DVec3::new(
        PITCH_M[0] * f64::from(columns),
        0.0,
        PITCH_M[1] * f64::from(rows),
    ) * 0.5;
    let lights = (0..values.whole("lamps")).map(|index| light(index, half));
    let mut scene = Scene {
        lights: lights.collect(),
        ..Scene::default()
    };
    for row in 0..rows {
        let metallic = fraction(rows - 1 - row, rows);
        for column in 0..columns {
            let roughness = fraction(column, columns);
            scene.materials.push(Material {
                name: format!("metallic {metallic:.2}, roughness {roughness:.2}"),
                base_color: color(metallic).as_vec3().extend(1.0).to_array(),
                metallic: metallic as f32,
                roughness: roughness as f32,
                ..Material::default()
            });
            let material = scene.materials.len() - 1;
            let primitive =
                ball(tess).append(&mut scene, &format!("ball {column} {row}"), material);
            let from_middle = |index: u32, count: u32| f64::from(2 * index + 1) - f64::from(count);
            let place = DVec3::new(
                0.5 * PITCH_M[0] * from_middle(column, columns),
                RADIUS_M,
                0.5 * PITCH_M[1] * from_middle(row, rows),
            );
            scene
                .instances
                .push(Instance::fixed(primitive, DMat4::from_translation(place)));
        }
    }
    Ok(scene)
}

/// Linear colors of lights, by turns.
const LIGHT_COLORS: [DVec3; 4] = [
    DVec3::new(1.0, 0.42, 0.1),
    DVec3::new(0.3, 0.62, 1.0),
    DVec3::new(0.55, 0.6, 0.9),
    DVec3::new(1.0, 0.2, 0.42),
];

/// Lights spiral outwards over the rows, which reach this far: by turns a point low between the
/// balls, a spot that shines down, and a light from far away.
fn light(index: u32, half: DVec3) -> SceneLight {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let (sin, cos) = libm::sincos(f64::from(index) * GOLDEN_ANGLE);
    let aside = DVec3::new(sin, 0.0, cos) * half * (0.35 + 0.04 * f64::from(index));
    let (kind, intensity, range_m, place) = match index % 3 {
        0 => (LightKind::Point, 5.0, Some(5.0), aside + DVec3::Y),
        1 => {
            let (inner, outer) = (0.2, 0.42);
            let kind = LightKind::Spot { inner, outer };
            (kind, 60.0, None, aside + 3.4 * DVec3::Y)
        }
        _ => (LightKind::Directional, 0.5, None, DVec3::ZERO),
    };
    let toward = match kind {
        LightKind::Directional => DVec3::new(sin, 1.2, cos),
        LightKind::Point | LightKind::Spot { .. } => DVec3::Y,
    };
    SceneLight {
        name: format!("lamp {index}"),
        kind,
        light: (LIGHT_COLORS[index as usize % LIGHT_COLORS.len()] * intensity).to_array(),
        range_m,
        // Of its axes only the third counts.
        world_from_light: DMat4::from_cols(
            DVec3::X.extend(0.0),
            DVec3::Z.extend(0.0),
            toward.extend(0.0),
            place.extend(1.0),
        ),
        node: None,
    }
}

/// The place of one among `count`, from 0 to 1.
fn fraction(index: u32, count: u32) -> f64 {
    f64::from(index) / f64::from((count - 1).max(1))
}

fn color(metallic: f64) -> DVec3 {
    let [glaze, lacquer, gold] = COLORS;
    if metallic < 0.5 {
        glaze.lerp(lacquer, 2.0 * metallic)
    } else {
        lacquer.lerp(gold, 2.0 * metallic - 1.0)
    }
}

/// A closed ball about the origin.
fn ball(tess: u32) -> MeshBuilder {
    let (rings, around) = (2 * tess, 4 * tess);
    let mut mesh = MeshBuilder::default();
    let mut below: Option<Ring> = None;
    for i in 0..=rings {
        let (sin, cos) = libm::sincos(PI * f64::from(i) / f64::from(rings));
        let is_pole = i == 0 || i == rings;
        let ring = mesh.ring(if is_pole { 1 } else { around }, |mesh, j| {
            let (s, c) = libm::sincos(2.0 * PI * f64::from(j) / f64::from(around));
            let out = if is_pole {
                DVec3::Y * -cos
            } else {
                DVec3::new(sin * s, -cos, sin * c)
            };
            mesh.vertex(out * RADIUS_M, out);
        });
        if let Some(below) = below.replace(ring) {
            mesh.band(below, ring);
        }
    }
    mesh
}
