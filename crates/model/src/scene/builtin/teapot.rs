//! The Utah teapot (M. Newell, 1975) from its 32 bicubic Bézier patches.
//!
//! Newell's 306 control points are stored as what they describe: profiles revolved around the axis
//! in four quarter arcs of kappa 0.56, and two tubes mirrored in the plane y = 0 (z is up in the
//! data). Neighboring patches therefore share their vertices, and the poles of lid and bottom have
//! exact normals. The knob's published value 0.45 is 0.448 here, so that its rings have the same
//! shape as all others.

use glam::{DVec2, DVec3};

use super::{
    query::{BuiltinError, Values},
    shapes::single_mesh_scene,
};
use crate::scene::mesh_builder::{MeshBuilder, Ring};
use crate::scene::{material::Material, model::Scene};

#[rustfmt::skip]
/// Control points (radius, height), end to end: 3 per patch and one more. Rim, body (twice) and bottom.
const POT: [[f64; 2]; 13] = [
    [1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4],
    [1.75, 1.875], [2.0, 1.35], [2.0, 0.9],
    [2.0, 0.45], [1.5, 0.225], [1.5, 0.15],
    [1.5, 0.075], [1.425, 0.0], [0.0, 0.0],
];
/// Knob and lid.
const LID: [[f64; 2]; 7] = [
    [0.0, 3.15],
    [0.8, 3.15],
    [0.0, 2.85],
    [0.2, 2.7],
    [0.4, 2.55],
    [1.3, 2.55],
    [1.3, 2.4],
];

/// Control sections of a tube, end to end: from (x, z) at y = 0 over the half width y to another
/// (x, z) at y = 0.
struct Section {
    from: DVec2,
    to: DVec2,
    half_width: f64,
}

const fn section(from: [f64; 2], to: [f64; 2], half_width: f64) -> Section {
    Section {
        from: DVec2::from_array(from),
        to: DVec2::from_array(to),
        half_width,
    }
}

const HANDLE: [Section; 7] = [
    section([-1.6, 2.025], [-1.5, 2.25], 0.3),
    section([-2.3, 2.025], [-2.5, 2.25], 0.3),
    section([-2.7, 2.025], [-3.0, 2.25], 0.3),
    section([-2.7, 1.8], [-3.0, 1.8], 0.3),
    section([-2.7, 1.575], [-3.0, 1.35], 0.3),
    section([-2.5, 1.125], [-2.65, 0.9375], 0.3),
    section([-2.0, 0.9], [-1.9, 0.6], 0.3),
];
const SPOUT: [Section; 7] = [
    section([1.7, 1.425], [1.7, 0.6], 0.66),
    section([2.6, 1.425], [3.1, 0.825], 0.66),
    section([2.3, 2.1], [2.4, 2.025], 0.25),
    section([2.7, 2.4], [3.3, 2.4], 0.25),
    section([2.8, 2.475], [3.525, 2.49375], 0.25),
    section([2.9, 2.475], [3.45, 2.5125], 0.15),
    section([2.8, 2.4], [3.2, 2.4], 0.15),
];

/// Handle length of a Bézier quarter arc in Newell's data (a true circle needs 0.5523).
const KAPPA: f64 = 0.56;
/// Meters per unit of the data; the pot becomes 2.6 m wide.
const SCALE: f64 = 0.4;
/// Middle of the data's box.
const CENTER: DVec3 = DVec3::new(0.217, 0.0, 1.575);

/// Builds the scene `teapot`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let tess = values.whole("tess");
    let side = tess as usize;
    let mut mesh = MeshBuilder::with_capacity(36 * side * side, 64 * side * side);
    revolve(&mut mesh, &POT, tess);
    revolve(&mut mesh, &LID, tess);
    tube(&mut mesh, &HANDLE, tess);
    tube(&mut mesh, &SPOUT, tess);
    let glaze = Material {
        name: "glaze".into(),
        base_color: [0.61, 0.235, 0.095, 1.0],
        double_sided: true,
        ..Material::default()
    };
    Ok(single_mesh_scene(mesh, "teapot", glaze))
}

/// Revolves a profile, given from top to bottom, around the axis.
fn revolve(mesh: &mut MeshBuilder, profile: &[[f64; 2]], tess: u32) {
    let mut above: Option<Ring> = None;
    for row in 0..=(profile.len() as u32 - 1) / 3 * tess {
        let (point, slopes) = curve(profile.len(), row, tess, |i| {
            DVec3::new(profile[i][0], 0.0, profile[i][1])
        });
        let columns = if point.x == 0.0 { 1 } else { 4 * tess };
        let ring = mesh.ring(columns, |mesh, column| {
            let (arc, along) = arc(column, tess);
            let position = DVec3::new(point.x * arc.x, point.x * arc.y, point.z);
            // The derivative around the axis omits its factor, the radius, so that poles have a
            // normal too.
            let normal = slopes
                .iter()
                .map(|d| {
                    DVec3::new(d.x * arc.x, d.x * arc.y, d.z)
                        .cross(along.extend(0.0))
                        .normalize_or_zero()
                })
                .sum();
            add_vertex(mesh, position, normal);
        });
        if let Some(above) = above.replace(ring) {
            mesh.band(ring, above);
        }
    }
}

/// Sweeps control sections; the other half is the mirror image.
fn tube(mesh: &mut MeshBuilder, sections: &[Section], tess: u32) {
    // A tube of two columns would be flat.
    let half = tess.max(2);
    let mut before: Option<Ring> = None;
    for row in 0..=(sections.len() as u32 - 1) / 3 * tess {
        let ring = mesh.ring(2 * half, |mesh, column| {
            let (mirror, step) = if column <= half {
                (1.0, column)
            } else {
                (-1.0, 2 * half - column)
            };
            let v = f64::from(step) / f64::from(half);
            let across = |s: &Section, weights: [f64; 4]| {
                let flat = s.from * (weights[0] + weights[1]) + s.to * (weights[2] + weights[3]);
                DVec3::new(
                    flat.x,
                    -mirror * s.half_width * (weights[1] + weights[2]),
                    flat.y,
                )
            };
            let (position, along) = curve(sections.len(), row, tess, |i| {
                across(&sections[i], bernstein(v))
            });
            let (round, _) = curve(sections.len(), row, tess, |i| {
                across(&sections[i], bernstein_slope(v)) * mirror
            });
            add_vertex(
                mesh,
                position,
                along
                    .iter()
                    .map(|d| round.cross(*d).normalize_or_zero())
                    .sum(),
            );
        });
        if let Some(before) = before.replace(ring) {
            mesh.band(before, ring);
        }
    }
}

/// A point of the data, with z up, as a vertex with y up.
fn add_vertex(mesh: &mut MeshBuilder, p: DVec3, n: DVec3) {
    let p = (p - CENTER) * SCALE;
    mesh.vertex(DVec3::new(p.x, p.z, -p.y), DVec3::new(n.x, n.z, -n.y));
}

/// Row `row` of a chain of cubic curves: the point, and the derivatives of the one or two curves
/// that meet there.
fn curve(len: usize, row: u32, tess: u32, control: impl Fn(usize) -> DVec3) -> (DVec3, Vec<DVec3>) {
    let last = len / 3 - 1;
    let (patch, step) = ((row / tess) as usize, row % tess);
    let sum = |patch: usize, weights: [f64; 4]| {
        (0..4)
            .map(|i| control(3 * patch + i) * weights[i])
            .sum::<DVec3>()
    };
    let (patch, t) = if patch > last {
        (last, 1.0)
    } else {
        (patch, f64::from(step) / f64::from(tess))
    };
    let mut slopes = vec![sum(patch, bernstein_slope(t))];
    if step == 0 && patch > 0 && t == 0.0 {
        slopes.push(sum(patch - 1, bernstein_slope(1.0)));
    }
    (sum(patch, bernstein(t)), slopes)
}

/// Column `column` of the unit circle of four Bézier quarters: the point and its derivative.
fn arc(column: u32, tess: u32) -> (DVec2, DVec2) {
    const QUARTER: [DVec2; 4] = [
        DVec2::new(1.0, 0.0),
        DVec2::new(1.0, KAPPA),
        DVec2::new(KAPPA, 1.0),
        DVec2::new(0.0, 1.0),
    ];
    let s = f64::from(column % tess) / f64::from(tess);
    let sum = |weights: [f64; 4]| (0..4).map(|i| QUARTER[i] * weights[i]).sum::<DVec2>();
    let turn = |v: DVec2| (0..column / tess).fold(v, |v, _| v.perp());
    (turn(sum(bernstein(s))), turn(sum(bernstein_slope(s))))
}

fn bernstein(t: f64) -> [f64; 4] {
    let u = 1.0 - t;
    [u * u * u, 3.0 * t * u * u, 3.0 * t * t * u, t * t * t]
}

fn bernstein_slope(t: f64) -> [f64; 4] {
    let u = 1.0 - t;
    [
        -3.0 * u * u,
        3.0 * u * (u - 2.0 * t),
        3.0 * t * (2.0 * u - t),
        3.0 * t * t,
    ]
}
