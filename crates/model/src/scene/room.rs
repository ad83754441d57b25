//! A room: six walls around a scene, visible from the inside. They receive light and shadows and
//! cast no shadow.

use glam::{DMat4, DVec3};

use super::{
    bounds::Bounds,
    material::Material,
    mesh_builder::MeshBuilder,
    model::{Instance, Scene},
};

/// Quads along each side of a wall, so that effects meet triangles of medium size.
const CELLS: u32 = 8;

/// Distance of the floor below the scene, as a fraction of the scene's height, so that nothing lies
/// in the floor's plane.
const GAP: f64 = 1e-3;

impl Scene {
    /// Adds a room whose width is `times` the width of the scene, or its height where that is more.
    /// The room stands still while the scene spins about its vertical [axis](Scene::axis).
    #[must_use]
    pub fn in_room(mut self, times: f64) -> Self {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return self;
        }
        let axis = self.axis();
        let reach = |corner: DVec3| libm::hypot(corner.x - axis.x, corner.z - axis.z);
        let height = bounds.max.y - bounds.min.y;
        let widest = bounds.corners().map(reach).into_iter().fold(1e-6, f64::max);
        let half = times * widest.max(0.5 * height);
        let height = height.max(1e-3 * half);
        let floor = bounds.min.y - GAP * height;
        let ceiling = floor + (2.0 * half).min(height * (1.0 + times)).max(height * 1.1);
        let room = Bounds {
            min: axis + DVec3::new(-half, floor, -half),
            max: axis + DVec3::new(half, ceiling, half),
        };
        let origin = Self::mesh_origin(&bounds, room.center(), half);
        let half_size = (room.max - room.min) * 0.5;
        self.materials.push(Material {
            name: "plaster".into(),
            base_color: [0.62, 0.6, 0.57, 1.0],
            ..Material::default()
        });
        let material = self.materials.len() - 1;
        let primitive =
            walls(room.center() - origin, half_size).append(&mut self, "room", material);
        let named_node = Some(self.add_named_node("room"));
        self.instances.push(Instance {
            named_node,
            ..Instance::fixed(primitive, DMat4::from_translation(origin))
        });
        self.walls += 1;
        self.content = self.content.or(Some(bounds));
        if !self.rig.is_empty() {
            self.rig.motion_bounds.include(room.min);
            self.rig.motion_bounds.include(room.max);
        }
        self
    }

    /// The instances that cast shadows: all but ground and walls.
    pub fn shadow_casters(&self) -> &[Instance] {
        &self.instances[..self.instances.len() - self.walls - self.grounds]
    }
}

/// Six walls about a center whose front faces point inwards.
fn walls(center: DVec3, half: DVec3) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let inward = DVec3::AXES[axis] * -side;
            let (u, v) = (
                DVec3::AXES[(axis + 1) % 3],
                inward.cross(DVec3::AXES[(axis + 1) % 3]),
            );
            let at = |i: u32, j: u32| {
                let fraction = |k: u32| 2.0 * f64::from(k) / f64::from(CELLS) - 1.0;
                center + (u * fraction(i) + v * fraction(j) - inward) * half
            };
            let row = |mesh: &mut MeshBuilder, j: u32| {
                (0..=CELLS)
                    .map(|i| mesh.vertex(at(i, j), inward))
                    .collect::<Vec<_>>()
            };
            let rows: Vec<Vec<u32>> = (0..=CELLS).map(|j| row(&mut mesh, j)).collect();
            for (below, above) in rows.iter().zip(&rows[1..]) {
                for i in 0..CELLS as usize {
                    mesh.triangle([below[i], below[i + 1], above[i + 1]]);
                    mesh.triangle([below[i], above[i + 1], above[i]]);
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{builtin, model::Primitive};

    fn room_of(scene: &Scene) -> &Primitive {
        &scene.primitives[scene.instances.last().unwrap().primitive]
    }

    #[test]
    fn walls_enclose_the_scene_however_it_is_turned_and_look_inwards() {
        for query in ["teapot?tess=2", "cube-wall", "tentacle?tess=2"] {
            let alone = builtin::build(query).unwrap();
            let scene = builtin::build(query).unwrap().in_room(1.5);
            assert_eq!(scene.shadow_casters(), alone.instances);
            let room = room_of(&scene);
            for corner in alone.bounds().corners() {
                for turn in 0..12 {
                    let turned = crate::math::rotation_y(f64::from(turn)).transform_point3(corner);
                    assert!(
                        turned.cmpgt(room.bounds.min).all() && turned.cmplt(room.bounds.max).all(),
                        "{query}: {turned}"
                    );
                }
            }
            let at = |vertex: u32| glam::Vec3::from(room.position(&scene, vertex)).as_dvec3();
            for triangle in 0..room.triangle_count() {
                let [a, b, c] = room.corners(&scene, triangle).map(at);
                let normal = (b - a).cross(c - a);
                assert!(
                    normal.dot(room.bounds.center() - a) > 0.0,
                    "{query}: triangle {triangle} looks outwards"
                );
            }
        }
    }

    #[test]
    fn nothing_needs_no_room() {
        assert_eq!(Scene::default().in_room(2.0), Scene::default());
    }
}
