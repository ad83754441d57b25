//! Town: houses on a hill in the sea, with a tower, trees, boats and windows that can be lit.

use std::f64::consts::TAU;

use glam::{DMat4, DVec3};

use super::query::{BuiltinError, Values};
use crate::scene::mesh_builder::{MeshBuilder, Ring};
use crate::{
    math::{cos_turns, hash, hash_unit, rotation_y, sin_turns},
    scene::{
        material::Material,
        model::{Instance, Scene},
    },
};

const WALLS: [[f64; 3]; 5] = [
    [0.82, 0.72, 0.52],
    [0.85, 0.52, 0.26],
    [0.78, 0.36, 0.24],
    [0.86, 0.82, 0.74],
    [0.80, 0.62, 0.36],
];
const ROOFS: [[f64; 3]; 3] = [[0.56, 0.13, 0.05], [0.62, 0.19, 0.07], [0.42, 0.09, 0.05]];
const PANE: [f64; 3] = [0.035, 0.05, 0.075];
const STONE: [f64; 3] = [0.70, 0.62, 0.50];
/// Turns from one house to the next on the spiral.
const GOLDEN_TURNS: f64 = 0.381_966_011_250_105;

/// Builds the scene `town`. Draws follow the order in which such a town is built: sea, hill, houses
/// from the shore up, the tower, trees, boats, and the windows last.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (houses, seed, lights) = (
        values.whole("houses"),
        values.whole("seed"),
        values.get("lights"),
    );
    let hill = Hill::of(houses);
    let chance = |house: u32, salt: u32| hash_unit(hash(seed) ^ hash(64 * house + salt));
    let pane = Material {
        name: "pane".into(),
        emission: [1.0, 0.62, 0.22].map(|v| (v * lights) as f32),
        ..Material::default()
    };
    let mut scene = Scene {
        materials: vec![
            Material {
                name: "paint".into(),
                ..Material::default()
            },
            pane,
        ],
        ..Scene::default()
    };
    let mut add = |mesh: MeshBuilder, name: &str, material: usize| {
        let primitive = mesh.append(&mut scene, name, material);
        scene
            .instances
            .push(Instance::fixed(primitive, DMat4::IDENTITY));
    };
    add(hill.sea(), "sea", 0);
    add(hill.ground(), "hill", 0);
    let mut windows = MeshBuilder::default();
    let places: Vec<House> = (0..houses)
        .map(|house| House::of(&hill, house, houses, |salt| chance(house, salt)))
        .collect();
    for place in &places {
        let mut mesh = MeshBuilder::default();
        place.append(&mut mesh, &mut windows);
        add(mesh, "house", 0);
    }
    let mut tower = MeshBuilder::default();
    append_tower(&mut tower, &mut windows, hill.height(0.0, 0.0));
    add(tower, "tower", 0);
    let mut trees = MeshBuilder::default();
    for tree in 0..houses {
        let along = (f64::from(tree) + 0.5 + chance(tree, 60)) / f64::from(houses + 1);
        let turn = GOLDEN_TURNS * (f64::from(tree) + 0.5);
        let [x, z] = hill.at(0.2 + 0.72 * along.sqrt(), turn);
        let is_free = places
            .iter()
            .all(|house| libm::hypot(house.at.x - x, house.at.z - z) > 0.52)
            && libm::hypot(x, z) > 1.3;
        if is_free || tree == 0 {
            append_tree(
                &mut trees,
                DVec3::new(x, hill.height(x, z), z),
                0.75 + 0.5 * chance(tree, 61),
            );
        }
    }
    add(trees, "trees", 0);
    let mut boats = MeshBuilder::default();
    for boat in 0..4 {
        let turn = 0.14 + 0.27 * f64::from(boat) + 0.08 * chance(boat, 62);
        let [x, z] = hill.at(1.24 + 0.14 * chance(boat, 63), turn);
        append_boat(
            &mut boats,
            DMat4::from_translation(DVec3::new(x, 0.0, z)) * rotation_y(TAU * chance(boat, 59)),
        );
    }
    add(boats, "boats", 0);
    add(windows, "windows", 1);
    Ok(scene)
}

/// The hill: a dome with a beach and a shore that is not round.
struct Hill {
    radius: f64,
    height: f64,
}

impl Hill {
    fn of(houses: u32) -> Self {
        let radius = 0.72 * f64::from(houses).sqrt() + 1.7;
        Self {
            radius,
            height: 0.46 * radius,
        }
    }

    /// Distance of the shore in a direction.
    fn shore(&self, turn: f64) -> f64 {
        self.radius
            * (1.0
                + 0.06 * sin_turns(2.0 * turn + 0.1)
                + 0.035 * sin_turns(3.0 * turn + 0.4)
                + 0.015 * sin_turns(7.0 * turn))
    }

    /// The point at a fraction of the way to the shore.
    fn at(&self, fraction: f64, turn: f64) -> [f64; 2] {
        let reach = fraction * self.shore(turn);
        [reach * sin_turns(turn), reach * cos_turns(turn)]
    }

    /// Height of the ground, from the sea.
    fn height(&self, x: f64, z: f64) -> f64 {
        let fraction = libm::hypot(x, z) / self.shore(libm::atan2(x, z) / TAU);
        let dome = 1.0 - smooth(0.08, 0.96, fraction);
        self.height * dome * (0.82 + 0.18 * dome) + 0.16 - 0.5 * smooth(0.86, 1.14, fraction)
    }

    fn ground(&self) -> MeshBuilder {
        const SAND: DVec3 = DVec3::new(0.82, 0.64, 0.38);
        const GRASS: DVec3 = DVec3::new(0.20, 0.30, 0.07);
        const STRAW: DVec3 = DVec3::new(0.44, 0.40, 0.13);
        let mut mesh = MeshBuilder::default();
        let vertex = |mesh: &mut MeshBuilder, fraction: f64, turn: f64| {
            let [x, z] = self.at(fraction, turn);
            let (y, step) = (self.height(x, z), 0.02);
            let slope =
                |dx: f64, dz: f64| self.height(x + dx, z + dz) - self.height(x - dx, z - dz);
            let normal = DVec3::new(-slope(step, 0.0), 2.0 * step, -slope(0.0, step));
            let color = SAND.lerp(
                GRASS.lerp(STRAW, smooth(0.3, 1.0, y / self.height)),
                smooth(0.16, 0.34, y),
            );
            mesh.colored_vertex(DVec3::new(x, y, z), normal, color.to_array());
        };
        let rings = 14;
        let mut below = mesh.ring(48, |mesh, i| vertex(mesh, 1.16, f64::from(i) / 48.0));
        for ring in (1..rings).rev() {
            let count = if ring > 4 { 48 } else { 24 };
            let above = mesh.ring(count, |mesh, i| {
                vertex(
                    mesh,
                    1.16 * f64::from(ring) / f64::from(rings),
                    f64::from(i) / f64::from(count),
                )
            });
            mesh.band(below, above);
            below = above;
        }
        let top = mesh.ring(1, |mesh, _| vertex(mesh, 0.0, 0.0));
        mesh.band(below, top);
        mesh
    }

    /// A round slab of water: pale at the shore.
    fn sea(&self) -> MeshBuilder {
        const SHALLOW: DVec3 = DVec3::new(0.10, 0.44, 0.42);
        const DEEP: DVec3 = DVec3::new(0.012, 0.13, 0.20);
        const RINGS: u32 = 10;
        let (radius, low) = (1.62 * self.radius, -0.09 * self.radius);
        let mut mesh = MeshBuilder::default();
        let circle = |mesh: &mut MeshBuilder, fraction: f64, y: f64, up: f64| -> Ring {
            let color = DEEP
                .lerp(SHALLOW, 1.0 - smooth(0.98, 1.4, 1.62 * fraction))
                .to_array();
            mesh.ring(if fraction == 0.0 { 1 } else { 48 }, |mesh, i| {
                let turn = f64::from(i) / 48.0;
                let out = DVec3::new(sin_turns(turn), 0.0, cos_turns(turn));
                mesh.colored_vertex(
                    out * (radius * fraction) + DVec3::Y * y,
                    if up == 0.0 { out } else { DVec3::Y * up },
                    color,
                );
            })
        };
        for [[inner, y, up], [outer, to, to_up]] in [
            [[0.0, low, -1.0], [1.0, low, -1.0]],
            [[1.0, low, 0.0], [1.0, 0.0, 0.0]],
        ] {
            let (from, to) = (
                circle(&mut mesh, inner, y, up),
                circle(&mut mesh, outer, to, to_up),
            );
            mesh.band(from, to);
        }
        let mut outer = circle(&mut mesh, 1.0, 0.0, 1.0);
        for ring in (0..RINGS).rev() {
            let inner = circle(&mut mesh, f64::from(ring) / f64::from(RINGS), 0.0, 1.0);
            mesh.band(outer, inner);
            outer = inner;
        }
        mesh
    }
}

/// 0 below `low`, 1 above `high`, without a kink.
fn smooth(low: f64, high: f64, v: f64) -> f64 {
    let t = ((v - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A house: where it stands, and its shape in its own frame, with the ridge along x.
struct House {
    at: DVec3,
    frame: DMat4,
    half: [f64; 2],
    eaves: f64,
    ridge: f64,
    wall: [f64; 3],
    roof: [f64; 3],
    has_chimney: bool,
}

impl House {
    /// The house number `index`: on a spiral from the shore to the top.
    fn of(hill: &Hill, index: u32, of: u32, chance: impl Fn(u32) -> f64) -> Self {
        let inwards = 1.0 - (f64::from(index) + 0.5) / f64::from(of);
        let turn = GOLDEN_TURNS * f64::from(index) + 0.02 * chance(0);
        let [x, z] = hill.at((0.05 + 0.62 * inwards).sqrt(), turn);
        let at = DVec3::new(x, hill.height(x, z), z);
        let eaves = 0.42 + 0.3 * chance(1) + 0.3 * (1.0 - inwards);
        let facing =
            turn * TAU + if chance(2) < 0.3 { 0.25 * TAU } else { 0.0 } + 0.3 * (chance(3) - 0.5);
        let pick = |of: usize, salt: u32| ((of as f64 * chance(salt)) as usize).min(of - 1);
        Self {
            at,
            frame: DMat4::from_translation(at) * rotation_y(facing),
            half: [0.3 + 0.14 * chance(4), 0.25 + 0.08 * chance(5)],
            eaves,
            ridge: eaves + 0.2 + 0.1 * chance(6),
            wall: WALLS[pick(WALLS.len(), 7)],
            roof: ROOFS[pick(ROOFS.len(), 8)],
            has_chimney: chance(9) < 0.6,
        }
    }

    fn append(&self, mesh: &mut MeshBuilder, windows: &mut MeshBuilder) {
        let ([x, z], top, ridge) = (self.half, self.eaves, self.ridge);
        let at = |x: f64, y: f64, z: f64| self.frame.transform_point3(DVec3::new(x, y, z));
        block(mesh, &self.frame, [-x, -0.7, -z], [x, top, z], self.wall);
        for side in [-1.0, 1.0] {
            mesh.facet(
                [
                    at(side * x, top, side * z),
                    at(side * x, top, -side * z),
                    at(side * x, ridge, 0.0),
                ],
                self.wall,
            );
        }
        // Two slabs that overhang.
        let (over, thick) = (0.07, 0.055);
        let slope = (ridge - top) / z;
        for side in [-1.0, 1.0] {
            let rim = |along: f64, z: f64, up: f64| {
                at(along * (x + over), ridge - slope * z + up, side * z)
            };
            let corner = |up: f64| {
                let loop_ = [
                    rim(-1.0, 0.0, up),
                    rim(-1.0, z + over, up),
                    rim(1.0, z + over, up),
                    rim(1.0, 0.0, up),
                ];
                if side > 0.0 {
                    loop_
                } else {
                    [loop_[3], loop_[2], loop_[1], loop_[0]]
                }
            };
            slab(mesh, corner(0.0), corner(thick), self.roof);
        }
        if self.has_chimney {
            block(
                mesh,
                &self.frame,
                [0.35 * x, top, -0.45 * z],
                [0.35 * x + 0.1, ridge + 0.14, -0.45 * z + 0.1],
                STONE,
            );
        }
        let floors = if top > 0.72 { 2 } else { 1 };
        for (out, half, deep) in [(0.0, x, z), (0.5, x, z), (0.25, z, x), (0.75, z, x)] {
            let wall = self.frame * rotation_y(out * TAU);
            for floor in 0..floors {
                let y = (f64::from(floor) + 0.58) * top / f64::from(floors);
                [-0.42, 0.42].iter().for_each(|along| {
                    pane(
                        windows,
                        &wall,
                        [along * half, y, deep + 0.012],
                        [0.055, 0.085],
                    )
                });
            }
        }
    }
}

/// A bell tower with a spire.
fn append_tower(mesh: &mut MeshBuilder, windows: &mut MeshBuilder, ground: f64) {
    let frame = DMat4::from_translation(DVec3::Y * ground) * rotation_y(0.35);
    let at = |x: f64, y: f64, z: f64| frame.transform_point3(DVec3::new(x, y, z));
    block(
        mesh,
        &frame,
        [-0.42, -0.8, -0.42],
        [0.42, 2.35, 0.42],
        WALLS[3],
    );
    block(mesh, &frame, [-0.5, 2.35, -0.5], [0.5, 2.47, 0.5], STONE);
    block(
        mesh,
        &frame,
        [-0.36, 2.47, -0.36],
        [0.36, 3.05, 0.36],
        WALLS[3],
    );
    let (eaves, tip) = (3.05, at(0.0, 4.55, 0.0));
    for turn in 0..4 {
        let (sin, cos) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][turn];
        let rim = |u: f64| at(0.48 * (cos * u + sin), eaves, 0.48 * (cos - sin * u));
        mesh.facet([rim(-1.0), rim(1.0), tip], ROOFS[0]);
        let wall = frame * rotation_y(0.25 * turn as f64 * TAU);
        pane(windows, &wall, [0.0, 2.76, 0.372], [0.13, 0.19]);
        pane(windows, &wall, [0.0, 1.55, 0.432], [0.07, 0.16]);
    }
    mesh.quad(
        [
            at(-0.48, eaves, -0.48),
            at(0.48, eaves, -0.48),
            at(0.48, eaves, 0.48),
            at(-0.48, eaves, 0.48),
        ],
        STONE,
    );
}

/// A cypress.
fn append_tree(mesh: &mut MeshBuilder, at: DVec3, size: f64) {
    const GREEN: [f64; 3] = [0.035, 0.11, 0.045];
    let circle = |mesh: &mut MeshBuilder, reach: f64, y: f64, up: f64| -> Ring {
        mesh.ring(7, |mesh, i| {
            let turn = f64::from(i) / 7.0;
            let out = DVec3::new(sin_turns(turn), 0.0, cos_turns(turn));
            mesh.colored_vertex(
                at + (out * reach + DVec3::Y * y) * size,
                out + DVec3::Y * up,
                GREEN,
            );
        })
    };
    let bottom = mesh.ring(1, |mesh, _| {
        mesh.colored_vertex(at, DVec3::NEG_Y, GREEN);
    });
    let low = circle(mesh, 0.15, 0.12, -0.4);
    let wide = circle(mesh, 0.19, 0.45, 0.1);
    let high = circle(mesh, 0.12, 0.95, 0.3);
    let top = mesh.ring(1, |mesh, _| {
        mesh.colored_vertex(at + DVec3::Y * 1.4 * size, DVec3::Y, GREEN);
    });
    [(bottom, low), (low, wide), (wide, high), (high, top)]
        .into_iter()
        .for_each(|(below, above)| mesh.band(below, above));
}

/// A boat with one sail, in the plane of its keel.
fn append_boat(mesh: &mut MeshBuilder, frame: DMat4) {
    const HULL: [f64; 3] = [0.62, 0.10, 0.05];
    const SAIL: [f64; 3] = [0.92, 0.88, 0.78];
    let at = |x: f64, y: f64, z: f64| frame.transform_point3(DVec3::new(x, y, z));
    let deck = [
        at(-0.32, 0.13, 0.13),
        at(0.16, 0.13, 0.15),
        at(0.5, 0.17, 0.0),
        at(0.16, 0.13, -0.15),
        at(-0.32, 0.13, -0.13),
    ];
    let keel = [
        at(-0.26, -0.05, 0.08),
        at(0.14, -0.05, 0.09),
        at(0.36, -0.05, 0.0),
        at(0.14, -0.05, -0.09),
        at(-0.26, -0.05, -0.08),
    ];
    for i in 0..5 {
        let next = (i + 1) % 5;
        mesh.quad([keel[i], keel[next], deck[next], deck[i]], HULL);
    }
    mesh.facet([deck[0], deck[1], deck[4]], STONE);
    mesh.quad([deck[1], deck[2], deck[3], deck[4]], STONE);
    let [mast, boom, bow] = [
        at(0.08, 1.05, 0.0),
        at(-0.34, 0.24, 0.1),
        at(0.08, 0.24, 0.0),
    ];
    mesh.facet([boom, bow, mast], SAIL);
    mesh.facet([bow, boom, mast], SAIL);
}

/// A box in a frame.
fn block(
    mesh: &mut MeshBuilder,
    frame: &DMat4,
    [x0, y0, z0]: [f64; 3],
    [x1, y1, z1]: [f64; 3],
    color: [f64; 3],
) {
    let floor = |y: f64| {
        [[x0, z0], [x0, z1], [x1, z1], [x1, z0]]
            .map(|[x, z]| frame.transform_point3(DVec3::new(x, y, z)))
    };
    slab(mesh, floor(y0), floor(y1), color);
}

/// A solid between two quadrilaterals, both counter-clockwise seen from above.
fn slab(mesh: &mut MeshBuilder, below: [DVec3; 4], above: [DVec3; 4], color: [f64; 3]) {
    for i in 0..4 {
        let next = (i + 1) % 4;
        mesh.quad([below[i], below[next], above[next], above[i]], color);
    }
    mesh.quad(above, color);
    mesh.quad([below[3], below[2], below[1], below[0]], color);
}

/// An upright window that looks along z of `wall`.
fn pane(mesh: &mut MeshBuilder, wall: &DMat4, [x, y, z]: [f64; 3], [half, tall]: [f64; 2]) {
    let corners = [[-half, -tall], [half, -tall], [half, tall], [-half, tall]];
    mesh.quad(
        corners.map(|[u, v]| wall.transform_point3(DVec3::new(x + u, y + v, z))),
        PANE,
    );
}
