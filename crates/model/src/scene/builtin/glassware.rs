//! Things of glass whose layers lie behind one another: sunglasses, a block with a notch, and
//! cylinders that cross.

use std::f64::consts::TAU;

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    painted::globe_mesh,
    query::{BuiltinError, Values},
};
use crate::scene::{
    material::Material,
    mesh_builder::{MeshBuilder, Ring},
    model::{Instance, Scene},
};

/// Adds a mesh with a material of its own, of the same name.
pub fn add(scene: &mut Scene, name: &str, mesh: MeshBuilder, material: Material, place: DMat4) {
    scene.materials.push(Material {
        name: name.into(),
        ..material
    });
    let primitive = mesh.append(scene, name, scene.materials.len() - 1);
    scene.instances.push(Instance::fixed(primitive, place));
}

/// Glass of a linear color, which covers a fraction of what lies behind each of its walls.
fn glass(color: [f32; 3], covers: f32) -> Material {
    let [red, green, blue] = color;
    Material {
        base_color: [red, green, blue, covers],
        is_blended: true,
        double_sided: true,
        roughness: 0.06,
        ..Material::default()
    }
}

/// Clear glass that lets a fraction of the light through each of its walls, which takes away all but a
/// linear color, less strongly.
fn transmitting(color: [f32; 3], fraction: f32) -> Material {
    Material {
        transmission: fraction,
        attenuation: color.map(|channel| libm::sqrtf(libm::sqrtf(channel))),
        double_sided: true,
        roughness: 0.06,
        ..Material::default()
    }
}

fn lacquer(color: [f32; 3], roughness: f32) -> Material {
    let [red, green, blue] = color;
    Material {
        base_color: [red, green, blue, 1.0],
        roughness,
        ..Material::default()
    }
}

/// At a place, stretched along the axes.
fn transform_of(at: [f64; 3], scale: [f64; 3]) -> DMat4 {
    DMat4::from_translation(at.into()) * DMat4::from_scale(scale.into())
}

/// A turn about the horizontal axis that tips what lies behind down.
fn tipped(radians: f64) -> DMat4 {
    let (sin, cos) = libm::sincos(radians);
    DMat4::from_cols(
        DVec4::X,
        DVec4::new(0.0, cos, -sin, 0.0),
        DVec4::new(0.0, sin, cos, 0.0),
        DVec4::W,
    )
}

/// A ring of radius 1 about the axis z, `thickness` thick.
fn torus(tess: u32, thickness: f64) -> MeshBuilder {
    let (along, round) = (8 * tess, 2 * tess + 2);
    let mut mesh = MeshBuilder::default();
    let turns = |i: u32, of: u32| libm::sincos(TAU * f64::from(i) / f64::from(of));
    let rings: Vec<Ring> = (0..along)
        .map(|i| {
            let (sin, cos) = turns(i, along);
            let out = DVec3::new(cos, sin, 0.0);
            mesh.ring(round, |mesh, j| {
                let (s, c) = turns(j, round);
                let normal = out * c - DVec3::Z * s;
                mesh.vertex(out + normal * (0.5 * thickness), normal);
            })
        })
        .collect();
    for (i, &ring) in rings.iter().enumerate() {
        mesh.band(ring, rings[(i + 1) % rings.len()]);
    }
    mesh
}

/// Pairs of tinted sunglasses behind one another, and colored balls between them.
pub fn sunglasses(values: &Values) -> Result<Scene, BuiltinError> {
    const TINTS: [[f32; 3]; 3] = [[0.10, 0.035, 0.01], [0.01, 0.06, 0.035], [0.03, 0.02, 0.11]];
    const BALLS: [[f32; 3]; 4] = [
        [0.85, 0.1, 0.06],
        [0.9, 0.62, 0.06],
        [0.08, 0.42, 0.2],
        [0.05, 0.2, 0.65],
    ];
    const PITCH_M: f64 = 2.3;
    let (pairs, tess) = (values.whole("pairs"), values.whole("tess"));
    let mut scene = Scene::default();
    let ball = || globe_mesh(tess);
    let frame = lacquer([0.012, 0.011, 0.012], 0.25);
    for pair in 0..pairs {
        let back = f64::from(pair);
        let aside = 0.55 * (back - 0.5 * f64::from(pairs - 1));
        // The arms reach the floor behind.
        let stand = DMat4::from_translation(DVec3::new(aside, 0.0, -PITCH_M * back)) * tipped(0.34);
        let mut part = |name: &str, mesh: MeshBuilder, material: &Material, at, scale| {
            let name = format!("{name} {}", pair + 1);
            let place = stand * transform_of(at, scale);
            add(&mut scene, &name, mesh, material.clone(), place);
        };
        let tint = glass(TINTS[pair as usize % TINTS.len()], 0.5);
        for (side, x) in [("left", -0.62), ("right", 0.62)] {
            let name = |what: &str| format!("{side} {what}");
            part(
                &name("lens"),
                ball(),
                &tint,
                [x, 0.47, 0.0],
                [0.5, 0.41, 0.06],
            );
            let rim = torus(2 * tess, 0.12);
            part(&name("rim"), rim, &frame, [x, 0.47, 0.0], [0.51, 0.42, 0.6]);
            let arm = [1.9 * x, 0.6, -0.78];
            part(&name("arm"), ball(), &frame, arm, [0.035, 0.055, 0.86]);
        }
        part(
            "bridge",
            ball(),
            &frame,
            [0.0, 0.58, 0.0],
            [0.16, 0.045, 0.045],
        );
        for (at, color) in BALLS.into_iter().enumerate() {
            let x = 0.56 * (at as f64 - 1.5) + aside;
            let z = -PITCH_M * back - 0.8 - 0.3 * f64::from(at as u32 % 2);
            let place = transform_of([x, 0.25, z], [0.25; 3]);
            let name = format!("ball {}", BALLS.len() * pair as usize + at + 1);
            add(&mut scene, &name, ball(), lacquer(color, 0.3), place);
        }
    }
    Ok(scene)
}

/// A block of glass that is concave, because a notch is cut into it from above; a ball lies in the
/// notch, others stand behind the block.
pub fn notch(values: &Values) -> Result<Scene, BuiltinError> {
    // Half the width, the height, and half the depth of the block; half the width of the notch at
    // the top; the radius of the ball in it.
    let [width, height, half] = [1.0, 1.2, 0.55];
    const NOTCH_M: f64 = 0.42;
    const BALL_M: f64 = 0.22;
    let depth = values.get("depth") * height;
    let bottom = DVec2::new(0.0, height - depth);
    // Counter-clockwise, seen from the front; from the bottom of the notch all of it can be seen.
    let outline = [
        bottom,
        DVec2::new(-NOTCH_M, height),
        DVec2::new(-width, height),
        DVec2::new(-width, 0.0),
        DVec2::new(width, 0.0),
        DVec2::new(width, height),
        DVec2::new(NOTCH_M, height),
    ];
    let mut mesh = MeshBuilder::default();
    let at = |corner: DVec2, z: f64| corner.extend(z);
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        flat(
            &mut mesh,
            &[at(a, half), at(a, -half), at(b, -half), at(b, half)],
        );
    }
    flat(&mut mesh, &outline.map(|corner| at(corner, half)));
    let mut behind = outline.map(|corner| at(corner, -half));
    behind[1..].reverse();
    flat(&mut mesh, &behind);
    let mut scene = Scene::default();
    add(
        &mut scene,
        "block",
        mesh,
        glass([0.16, 0.42, 0.36], 0.24),
        DMat4::IDENTITY,
    );
    // A ball touches both walls of the notch where its middle is this high above the bottom.
    let rest = bottom.y + BALL_M * libm::hypot(NOTCH_M, depth) / NOTCH_M;
    let balls = [
        ("ball", [0.85, 0.16, 0.05], [0.0, rest, 0.0], BALL_M),
        ("left post", [0.9, 0.6, 0.08], [-0.62, 0.4, -1.25], 0.4),
        ("right post", [0.06, 0.18, 0.6], [0.6, 0.55, -1.4], 0.55),
    ];
    for (name, color, at, radius) in balls {
        add(
            &mut scene,
            name,
            globe_mesh(8),
            lacquer(color, 0.3),
            transform_of(at, [radius; 3]),
        );
    }
    Ok(scene)
}

/// A flat face whose corners can all be seen from the first, counter-clockwise from the outside.
fn flat(mesh: &mut MeshBuilder, corners: &[DVec3]) {
    let [a, .., b, c] = *corners else { return };
    let normal = (b - a).cross(c - a);
    let vertices: Vec<u32> = corners.iter().map(|&at| mesh.vertex(at, normal)).collect();
    for pair in vertices[1..].windows(2) {
        mesh.triangle([vertices[0], pair[0], pair[1]]);
    }
}

/// Two tubes of glass with thick walls that cross in the middle, so that neither is in front, and a
/// rod that goes through one of them. Their walls cover what lies behind, or let a fraction of the light
/// through.
pub fn crossing(values: &Values) -> Result<Scene, BuiltinError> {
    let (tess, clear) = (values.whole("tess"), values.get("clear") as f32);
    let mut scene = Scene::default();
    let tilted = |turns: f64| {
        let (sin, cos) = libm::sincos(TAU * turns);
        DMat4::from_translation(DVec3::Y)
            * DMat4::from_cols(
                DVec4::new(cos, sin, 0.0, 0.0),
                DVec4::new(-sin, cos, 0.0, 0.0),
                DVec4::Z,
                DVec4::W,
            )
    };
    let tubes = [
        ("amber tube", [0.62, 0.24, 0.03], 0.125),
        ("blue tube", [0.04, 0.2, 0.5], -0.125),
    ];
    for (name, color, turns) in tubes {
        let mesh = tube(tess, [0.34, 0.42], 1.25);
        let material = match clear > 0.0 {
            true => transmitting(color, clear),
            false => glass(color, 0.3),
        };
        add(&mut scene, name, mesh, material, tilted(turns));
    }
    let rod = tube(tess, [0.05, 0.13], 1.4);
    add(
        &mut scene,
        "rod",
        rod,
        lacquer([0.7, 0.66, 0.6], 0.3),
        tilted(0.125),
    );
    Ok(scene)
}

/// A closed wall between two radii about the axis x, `half` long to either side.
fn tube(tess: u32, [inner, outer]: [f64; 2], half: f64) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let mut ring = |radius: f64, x: f64, normal: DVec2| {
        mesh.ring(tess, |mesh, i| {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(tess));
            let out = DVec3::new(0.0, cos, sin);
            mesh.vertex(
                DVec3::X * x + out * radius,
                DVec3::X * normal.x + out * normal.y,
            );
        })
    };
    let (out, along) = (DVec2::Y, DVec2::X);
    // Outside, at one end, inside and at the other end.
    let faces = [
        [ring(outer, -half, out), ring(outer, half, out)],
        [ring(outer, half, along), ring(inner, half, along)],
        [ring(inner, half, -out), ring(inner, -half, -out)],
        [ring(inner, -half, -along), ring(outer, -half, -along)],
    ];
    for [from, to] in faces {
        mesh.band(from, to);
    }
    mesh
}
