//! A ground: a flat mesh that the scene stands on. It turns with the scene, receives light and
//! shadows, and casts no shadow, so that the shadow map stays as fine as without it.

use glam::{DMat4, DVec3};

use super::{
    bounds::Bounds,
    material::Material,
    mesh_builder::{MeshBuilder, Ring},
    model::{Instance, Scene},
};
use crate::math::{cos_turns, sin_turns};

/// Distance of the ground below the scene, as a fraction of the scene's height, so that nothing
/// lies in its plane. The floor of a room lies deeper.
const GAP: f64 = 5e-4;

/// Most cells from the center to the edge.
pub const MAX_CELLS: u32 = 128;

/// Outline of a ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundShape {
    #[default]
    Disc,
    Square,
}

impl GroundShape {
    pub const ALL: [Self; 2] = [Self::Disc, Self::Square];
    /// The words in files.
    pub const WORDS: &[&str] = &["disc", "square"];
}

/// What a scene stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    pub shape: GroundShape,
    /// From the center to the edge, in radii of the scene's box, above 0.
    pub size: f64,
    /// Linear RGBA.
    pub color: [f32; 4],
    /// Rings of a disc, or squares from the center to an edge; 1 to [`MAX_CELLS`].
    pub cells: u32,
}

impl Default for Ground {
    fn default() -> Self {
        Self {
            shape: GroundShape::Disc,
            size: 2.0,
            color: [0.5, 0.5, 0.5, 1.0],
            cells: 12,
        }
    }
}

impl Scene {
    /// Adds a ground below the lowest point of the scene at rest, under the center of its box. Triangles of the
    /// scene keep their ids, and [`Scene::bounds`] stays the box of the scene alone.
    #[must_use]
    pub fn on_ground(mut self, ground: &Ground) -> Self {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return self;
        }
        let height = (bounds.max.y - bounds.min.y).max(1e-3 * bounds.radius());
        // A clip may reach below the pose at rest, whose feet stand on the ground.
        let lowest = if self.rig.is_empty() {
            bounds.min.y
        } else {
            let points = self.framing_points(None);
            let at_rest = points.iter().map(|point| point.y).reduce(f64::min);
            at_rest.unwrap_or(bounds.min.y)
        };
        let center = bounds.center().with_y(lowest - GAP * height);
        let reach = ground.size * bounds.radius().max(1e-6);
        self.materials.push(Material {
            name: "ground".into(),
            base_color: ground.color,
            ..Material::default()
        });
        let material = self.materials.len() - 1;
        let origin = Self::mesh_origin(&self.content_bounds(), center, reach);
        let primitive = mesh(ground, center - origin, reach).append(&mut self, "ground", material);
        let named_node = Some(self.add_named_node("ground"));
        // Walls stay last.
        let index = self.instances.len() - self.walls;
        self.instances.insert(
            index,
            Instance {
                named_node,
                ..Instance::fixed(primitive, DMat4::from_translation(origin))
            },
        );
        self.grounds += 1;
        self
    }

    /// The scene without its grounds; triangles of the others keep their ids.
    #[must_use]
    pub fn without_ground(mut self) -> Self {
        let end = self.instances.len() - self.walls;
        self.instances.drain(end - self.grounds..end);
        self.grounds = 0;
        self
    }

    /// The grounds among the instances.
    pub fn ground_instances(&self) -> &[Instance] {
        let end = self.instances.len() - self.walls;
        &self.instances[end - self.grounds..end]
    }

    /// [`Scene::bounds`] and the ground.
    pub fn bounds_with_ground(&self) -> Bounds {
        let mut bounds = self.bounds();
        bounds.include_transformed(
            &DMat4::IDENTITY,
            &self.bounds_of(self.ground_instances()),
            0.0,
        );
        bounds
    }
}

fn mesh(ground: &Ground, center: DVec3, reach: f64) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let cells = ground.cells.clamp(1, MAX_CELLS);
    match ground.shape {
        GroundShape::Disc => disc(&mut mesh, center, reach, cells),
        GroundShape::Square => square(&mut mesh, center, reach, cells),
    }
    mesh
}

/// Rings of six more triangles each, so that all triangles are about as large.
fn disc(mesh: &mut MeshBuilder, center: DVec3, reach: f64, rings: u32) {
    let mut inner = Ring {
        first: mesh.vertex(center, DVec3::Y),
        count: 1,
    };
    for ring in 1..=rings {
        let (count, radius) = (6 * ring, reach * f64::from(ring) / f64::from(rings));
        let outer = mesh.ring(count, |mesh, i| {
            let turns = f64::from(i) / f64::from(count);
            let aside = DVec3::new(cos_turns(turns), 0.0, -sin_turns(turns));
            mesh.vertex(center + aside * radius, DVec3::Y);
        });
        mesh.band(outer, inner);
        inner = outer;
    }
}

fn square(mesh: &mut MeshBuilder, center: DVec3, reach: f64, cells: u32) {
    let side = 2 * cells;
    let at = |i: u32| reach * (f64::from(i) / f64::from(cells) - 1.0);
    let row = |mesh: &mut MeshBuilder, j: u32| {
        (0..=side)
            .map(|i| mesh.vertex(center + DVec3::new(at(i), 0.0, -at(j)), DVec3::Y))
            .collect::<Vec<_>>()
    };
    let rows: Vec<Vec<u32>> = (0..=side).map(|j| row(mesh, j)).collect();
    for (near, far) in rows.iter().zip(&rows[1..]) {
        for i in 0..side as usize {
            mesh.triangle([near[i], near[i + 1], far[i + 1]]);
            mesh.triangle([near[i], far[i + 1], far[i]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn grounds() -> impl Iterator<Item = Ground> {
        let sizes = [(0.1, 1), (2.0, 12), (1000.0, 3)];
        GroundShape::ALL.into_iter().flat_map(move |shape| {
            sizes.map(|(size, cells)| Ground {
                shape,
                size,
                cells,
                ..Ground::default()
            })
        })
    }

    #[test]
    fn a_ground_lies_under_the_scene_looks_up_and_is_as_large_as_it_says() {
        for query in [
            "teapot?tess=2",
            "cube-wall",
            "tentacle?tess=2",
            "walker?tess=1",
        ] {
            let alone = builtin::build(query).unwrap();
            let model = alone.bounds();
            for ground in grounds() {
                let scene = alone.clone().on_ground(&ground);
                let [instance] = scene.ground_instances() else {
                    panic!("{query}: one ground")
                };
                let mesh = &scene.primitives[instance.primitive];
                let per_cell = match ground.shape {
                    GroundShape::Disc => 6,
                    GroundShape::Square => 8,
                };
                assert_eq!(
                    mesh.triangle_count(),
                    per_cell * ground.cells * ground.cells
                );
                let at_rest = alone.framing_points(None);
                let lowest = if alone.rig.is_empty() {
                    model.min.y
                } else {
                    at_rest.iter().map(|p| p.y).fold(f64::INFINITY, f64::min)
                };
                let gap = lowest - mesh.bounds.max.y;
                assert!(
                    mesh.bounds.min.y == mesh.bounds.max.y
                        && gap > 0.0
                        && gap < 1e-3 * model.radius(),
                    "{query}: {gap}"
                );
                let reach = ground.size * model.radius();
                for (low, high) in [
                    (mesh.bounds.min.x, mesh.bounds.max.x),
                    (mesh.bounds.min.z, mesh.bounds.max.z),
                ] {
                    // The widest part of a disc's polygon of 6 * cells corners may lie between two
                    // of them.
                    let least = match ground.shape {
                        GroundShape::Disc => cos_turns(0.5 / f64::from(6 * ground.cells)),
                        GroundShape::Square => 1.0,
                    };
                    let width = (high - low) / (2.0 * reach);
                    assert!(
                        (least - 1e-3..1.0 + 1e-3).contains(&width),
                        "{query}: {width}"
                    );
                }
                let at = |vertex: u32| glam::Vec3::from(mesh.position(&scene, vertex)).as_dvec3();
                let mut area = 0.0;
                for triangle in 0..mesh.triangle_count() {
                    let [a, b, c] = mesh.corners(&scene, triangle).map(at);
                    let normal = (b - a).cross(c - a);
                    assert!(normal.y > 0.0, "{query}: triangle {triangle} looks down");
                    area += normal.y / 2.0;
                }
                let expected = match ground.shape {
                    // A polygon of 6 * cells corners.
                    GroundShape::Disc => {
                        3.0 * f64::from(ground.cells)
                            * reach
                            * reach
                            * sin_turns(1.0 / f64::from(6 * ground.cells))
                    }
                    GroundShape::Square => 4.0 * reach * reach,
                };
                assert!(
                    (area / expected - 1.0).abs() < 1e-3,
                    "{query}: {area} of {expected}: no hole, nothing twice"
                );
            }
        }
    }

    #[test]
    fn box_shadow_casters_and_triangle_ids_are_those_of_the_scene_alone() {
        let ground = Ground {
            size: 5.0,
            ..Ground::default()
        };
        for query in ["teapot?tess=2", "tentacle?tess=2", "walker?tess=1"] {
            let alone = builtin::build(query).unwrap();
            let scene = alone.clone().on_ground(&ground);
            assert_eq!(
                (scene.bounds(), scene.content_bounds()),
                (alone.bounds(), alone.bounds()),
                "{query}"
            );
            assert!(scene.bounds_with_ground().radius() > 3.0 * alone.bounds().radius());
            assert_eq!(scene.shadow_casters(), alone.instances, "{query}");
            assert_eq!(
                scene.instances[..alone.instances.len()],
                alone.instances,
                "{query}"
            );
            // In a room too.
            let inside = alone.clone().on_ground(&ground).in_room(2.0);
            assert_eq!(
                (inside.content_bounds(), inside.shadow_casters()),
                (alone.bounds(), &alone.instances[..]),
                "{query}"
            );
            let floor = inside.primitives[inside.instances.last().unwrap().primitive]
                .bounds
                .min
                .y;
            assert!(
                floor < inside.bounds_of(inside.ground_instances()).min.y,
                "{query}: the ground lies on the floor"
            );
        }
    }

    #[test]
    fn nothing_needs_no_ground() {
        assert_eq!(
            Scene::default().on_ground(&Ground::default()),
            Scene::default()
        );
    }
}
