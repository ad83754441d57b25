//! Still life: a jug, a bottle, a bowl of oranges, pears and a lemon on a round table; each a
//! closed surface.

use std::f64::consts::TAU;

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::query::{BuiltinError, Values};
use crate::scene::mesh_builder::{MeshBuilder, Ring};
use crate::{
    math::{cos_turns, rotation_y, sin_turns},
    scene::{
        material::Material,
        model::{Instance, Scene},
    },
};

/// An outline that is turned about the vertical axis: radius and height of its control points, from
/// pole to pole.
type Outline = &'static [[f64; 2]];

const TABLE: Outline = &[
    [0.0, -0.16],
    [1.5, -0.16],
    [1.78, -0.15],
    [1.86, -0.09],
    [1.86, -0.05],
    [1.8, 0.0],
    [1.6, 0.0],
    [0.8, 0.0],
    [0.0, 0.0],
];
const JUG: Outline = &[
    [0.0, 0.0],
    [0.24, 0.0],
    [0.27, 0.02],
    [0.27, 0.07],
    [0.44, 0.26],
    [0.46, 0.56],
    [0.30, 0.80],
    [0.19, 0.93],
    [0.20, 1.06],
    [0.29, 1.20],
    [0.29, 1.23],
    [0.26, 1.22],
    [0.17, 1.06],
    [0.16, 0.90],
    [0.1, 0.84],
    [0.0, 0.84],
];
const BOTTLE: Outline = &[
    [0.0, 0.0],
    [0.19, 0.0],
    [0.22, 0.02],
    [0.23, 0.10],
    [0.23, 0.72],
    [0.21, 0.92],
    [0.09, 1.06],
    [0.065, 1.22],
    [0.065, 1.40],
    [0.085, 1.41],
    [0.085, 1.47],
    [0.06, 1.48],
    [0.04, 1.47],
    [0.0, 1.47],
];
const BOWL: Outline = &[
    [0.0, 0.0],
    [0.20, 0.0],
    [0.22, 0.01],
    [0.21, 0.06],
    [0.40, 0.10],
    [0.54, 0.24],
    [0.58, 0.37],
    [0.57, 0.39],
    [0.55, 0.37],
    [0.50, 0.25],
    [0.36, 0.13],
    [0.15, 0.09],
    [0.0, 0.09],
];
const ORANGE: Outline = &[
    [0.0, 0.0],
    [0.09, 0.0],
    [0.18, 0.06],
    [0.19, 0.16],
    [0.17, 0.28],
    [0.08, 0.325],
    [0.03, 0.31],
    [0.0, 0.31],
];
const PEAR: Outline = &[
    [0.0, 0.01],
    [0.09, 0.0],
    [0.21, 0.06],
    [0.22, 0.19],
    [0.15, 0.32],
    [0.09, 0.42],
    [0.075, 0.50],
    [0.02, 0.525],
    [0.012, 0.55],
    [0.016, 0.66],
    [0.01, 0.67],
    [0.0, 0.67],
];
const LEMON: Outline = &[
    [0.0, -0.26],
    [0.035, -0.25],
    [0.05, -0.21],
    [0.15, -0.13],
    [0.165, 0.0],
    [0.15, 0.13],
    [0.05, 0.20],
    [0.035, 0.23],
    [0.0, 0.235],
];

/// The handle of the jug, in its plane: a closed tube that begins and ends inside the wall.
const HANDLE: [[f64; 2]; 6] = [
    [-0.36, 0.62],
    [-0.58, 0.60],
    [-0.72, 0.88],
    [-0.60, 1.20],
    [-0.42, 1.14],
    [-0.17, 1.06],
];
const HANDLE_RADIUS_M: f64 = 0.042;

const GLAZE: [DVec3; 3] = [
    DVec3::new(0.02, 0.20, 0.26),
    DVec3::new(0.80, 0.72, 0.55),
    DVec3::new(0.55, 0.20, 0.07),
];

/// Builds the scene `still-life`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let tess = values.whole("tess");
    let mut scene = Scene {
        materials: vec![Material {
            name: "glaze".into(),
            ..Material::default()
        }],
        ..Scene::default()
    };
    let mut add = |name: &str, mesh: MeshBuilder, places: &[DMat4]| {
        let primitive = mesh.append(&mut scene, name, 0);
        scene.instances.extend(
            places
                .iter()
                .map(|place| Instance::fixed(primitive, *place)),
        );
    };
    let at = |x: f64, y: f64, z: f64| DMat4::from_translation(DVec3::new(x, y, z));
    add(
        "table",
        turn_outline(TABLE, 2 * tess, &|_| DVec3::new(0.62, 0.50, 0.36)),
        &[at(0.0, 0.0, 0.0)],
    );
    add(
        "bottle",
        turn_outline(BOTTLE, tess, &|p| {
            if p.y > 1.39 {
                GLAZE[1]
            } else {
                DVec3::new(0.03, 0.10, 0.05)
            }
        }),
        &[at(0.08, 0.0, -0.62)],
    );
    let jug_at = at(-0.62, 0.0, -0.2) * rotation_y(0.5);
    add("jug", turn_outline(JUG, tess, &jug_color), &[jug_at]);
    add("handle", tube(tess), &[jug_at]);
    let bowl_color = |p: DVec3| {
        if libm::hypot(p.x, p.z) < 0.56 && p.y > 0.085 + 0.3 * (p.x * p.x + p.z * p.z) {
            GLAZE[0]
        } else {
            GLAZE[1]
        }
    };
    add(
        "bowl",
        turn_outline(BOWL, tess, &bowl_color),
        &[at(0.66, 0.0, 0.02)],
    );
    let oranges = [
        at(0.50, 0.17, 0.17),
        at(0.86, 0.17, 0.11) * rotation_y(1.0),
        at(0.66, 0.18, -0.22),
        at(0.67, 0.41, 0.02),
    ];
    add(
        "orange",
        turn_outline(ORANGE, tess, &|_| DVec3::new(0.88, 0.30, 0.02)),
        &oranges,
    );
    let pears = [
        at(-0.16, 0.0, 0.56),
        at(-0.72, 0.19, 0.66) * rotation_y(-2.6) * rotation_z(1.32),
    ];
    add("pear", turn_outline(PEAR, tess, &pear_color), &pears);
    add(
        "lemon",
        turn_outline(LEMON, tess, &|_| DVec3::new(0.90, 0.66, 0.05)),
        &[at(0.34, 0.163, 0.83) * rotation_y(0.7) * rotation_z(1.6)],
    );
    Ok(scene)
}

/// Teal above and below, cream with a rust line around the belly.
fn jug_color(p: DVec3) -> DVec3 {
    let from_belly = (p.y - 0.5).abs();
    if from_belly < 0.15 && libm::hypot(p.x, p.z) > 0.3 {
        GLAZE[1]
    } else if from_belly < 0.19 {
        GLAZE[2]
    } else {
        GLAZE[0]
    }
}

/// Green and yellow, with a red cheek and a brown stalk.
fn pear_color(p: DVec3) -> DVec3 {
    if p.y > 0.535 {
        return DVec3::new(0.12, 0.06, 0.02);
    }
    let cheek = ((p.x + 0.4 * p.z) / 0.2).clamp(0.0, 1.0);
    DVec3::new(0.55, 0.52, 0.06).lerp(DVec3::new(0.70, 0.16, 0.04), cheek * cheek)
}

/// Rotation about +z by `radians`, with the same bits on every machine.
fn rotation_z(radians: f64) -> DMat4 {
    let (sin, cos) = libm::sincos(radians);
    DMat4::from_cols(
        DVec4::new(cos, sin, 0.0, 0.0),
        DVec4::new(-sin, cos, 0.0, 0.0),
        DVec4::Z,
        DVec4::W,
    )
}

/// The quadratic B-spline through both ends of a control polygon: `steps` points and tangents per
/// inner control point.
fn spline(points: &[[f64; 2]], steps: u32) -> Vec<[DVec2; 2]> {
    let at = |i: usize| DVec2::from_array(points[i]);
    let last = points.len() - 1;
    let mut curve = Vec::new();
    for i in 1..last {
        let from = if i == 1 {
            at(0)
        } else {
            at(i - 1).midpoint(at(i))
        };
        let to = if i + 1 == last {
            at(last)
        } else {
            at(i).midpoint(at(i + 1))
        };
        let end = if i + 1 == last { steps + 1 } else { steps };
        curve.extend((0..end).map(|step| {
            let t = f64::from(step) / f64::from(steps);
            let (a, b) = (from.lerp(at(i), t), at(i).lerp(to, t));
            [a.lerp(b, t), b - a]
        }));
    }
    curve
}

/// The closed surface that an outline sweeps about the vertical axis. It is a fan around each pole.
fn turn_outline(outline: Outline, tess: u32, color: &dyn Fn(DVec3) -> DVec3) -> MeshBuilder {
    let (curve, around) = (spline(outline, tess), 8 * tess);
    let mut mesh = MeshBuilder::with_capacity(
        curve.len() * around as usize,
        2 * curve.len() * around as usize,
    );
    let mut below: Option<Ring> = None;
    for (i, [point, tangent]) in curve.iter().enumerate() {
        let pole = if i == 0 {
            Some(DVec3::NEG_Y)
        } else {
            (i + 1 == curve.len()).then_some(DVec3::Y)
        };
        let ring = mesh.ring(if pole.is_some() { 1 } else { around }, |mesh, j| {
            let turn = f64::from(j) / f64::from(around);
            let out = DVec3::new(sin_turns(turn), 0.0, cos_turns(turn));
            let position = if pole.is_some() {
                DVec3::Y * point.y
            } else {
                out * point.x + DVec3::Y * point.y
            };
            mesh.colored_vertex(
                position,
                pole.unwrap_or(out * tangent.y - DVec3::Y * tangent.x),
                color(position).to_array(),
            );
        });
        if let Some(below) = below.replace(ring) {
            mesh.band(below, ring);
        }
    }
    mesh
}

/// The handle: a tube of constant radius with a cap at each end.
fn tube(tess: u32) -> MeshBuilder {
    let (curve, around) = (spline(&HANDLE, 2 * tess), 2 * tess + 4);
    let mut mesh = MeshBuilder::default();
    let flat = |v: DVec2| DVec3::new(v.x, v.y, 0.0);
    let cap = |mesh: &mut MeshBuilder, at: DVec3, out: DVec3| {
        mesh.ring(1, |mesh, _| {
            mesh.colored_vertex(at, out, GLAZE[0].to_array());
        })
    };
    let ends = [curve[0], curve[curve.len() - 1]]
        .map(|[point, tangent]| [flat(point), flat(tangent).normalize()]);
    let mut below = cap(
        &mut mesh,
        ends[0][0] - ends[0][1] * (0.5 * HANDLE_RADIUS_M),
        -ends[0][1],
    );
    for [point, tangent] in curve {
        let across = flat(tangent).normalize().cross(DVec3::Z);
        let ring = mesh.ring(around, |mesh, j| {
            let (sin, cos) = libm::sincos(TAU * f64::from(j) / f64::from(around));
            let normal = DVec3::Z * cos + across * sin;
            mesh.colored_vertex(
                flat(point) + normal * HANDLE_RADIUS_M,
                normal,
                GLAZE[0].to_array(),
            );
        });
        mesh.band(below, ring);
        below = ring;
    }
    let end = cap(
        &mut mesh,
        ends[1][0] + ends[1][1] * (0.5 * HANDLE_RADIUS_M),
        ends[1][1],
    );
    mesh.band(below, end);
    mesh
}
