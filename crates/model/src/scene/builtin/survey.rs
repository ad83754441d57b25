//! Survey: points on the surfaces of the town, as a scanner sees them, in classes.

use glam::{DMat4, DVec3};

use super::{
    build as build_scene,
    query::{BuiltinError, Values},
};
use crate::{
    math::{hash, hash_unit},
    scene::{
        material::Material,
        model::{Instance, Scene},
        point_cloud::PointCloud,
    },
};

/// The classes, and the parts of the town that belong to each.
const CLASSES: [(&str, &[&str]); 4] = [
    ("water", &["sea"]),
    ("ground", &["hill"]),
    ("vegetation", &["trees"]),
    ("building", &["house", "tower", "boats"]),
];

/// How far points lie from the surface at most, meters.
const NOISE_M: f64 = 0.012;

/// Builds the scene `survey`: as many points on a square meter of each class.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (points, seed) = (values.whole("points"), values.whole("seed"));
    let town = build_scene(&format!(
        "town?houses={}&seed={seed}",
        values.whole("houses")
    ))?;
    let triangles: Vec<Triangle> = (0..town.primitives.len())
        .flat_map(|primitive| Triangle::all(&town, primitive))
        .collect();
    let area: f64 = triangles.iter().map(Triangle::area).sum();
    let mut clouds: [PointCloud; CLASSES.len()] = Default::default();
    let (mut before, mut made) = (0.0, 0);
    for triangle in &triangles {
        before += triangle.area();
        let until = (before / area * f64::from(points)).round() as u32;
        for point in made..until {
            let chance = |salt: u32| hash_unit(hash(seed) ^ hash(8 * point + salt));
            triangle.add(&mut clouds[triangle.class], chance);
        }
        made = until;
    }
    let mut scene = Scene {
        materials: vec![Material {
            name: "points".into(),
            ..Material::default()
        }],
        ..Scene::default()
    };
    for (cloud, (class, _)) in clouds.into_iter().zip(CLASSES) {
        let primitive = cloud.append(&mut scene, class, 0);
        scene
            .instances
            .push(Instance::fixed(primitive, DMat4::IDENTITY));
    }
    Ok(scene)
}

/// A triangle of the town.
struct Triangle {
    corners: [DVec3; 3],
    color: DVec3,
    class: usize,
}

impl Triangle {
    fn all(town: &Scene, primitive: usize) -> Vec<Self> {
        let primitive = &town.primitives[primitive];
        let has = |(_, parts): &(&str, &[&str])| parts.contains(&primitive.mesh.as_str());
        let (Some(class), Some(colors)) = (CLASSES.iter().position(has), primitive.colors) else {
            return Vec::new();
        };
        let place = |vertex| DVec3::from(primitive.position(town, vertex).map(f64::from));
        (0..primitive.triangle_count())
            .map(|triangle| {
                let corners = primitive.corners(town, triangle);
                Self {
                    corners: corners.map(place),
                    color: DVec3::from(colors.vector(&town.vertex_bytes, corners[0])),
                    class,
                }
            })
            .collect()
    }

    fn across(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    fn area(&self) -> f64 {
        0.5 * self.across().length()
    }

    /// Adds a point somewhere on it.
    fn add(&self, cloud: &mut PointCloud, chance: impl Fn(u32) -> f64) {
        let [a, b, c] = self.corners;
        let (u, v) = (chance(0), chance(1));
        let [u, v] = if u + v > 1.0 {
            [1.0 - u, 1.0 - v]
        } else {
            [u, v]
        };
        let normal = self.across().normalize_or(DVec3::Y);
        let place = a + (b - a) * u + (c - a) * v + normal * (NOISE_M * (2.0 * chance(2) - 1.0));
        cloud.positions.push(place.as_vec3().to_array());
        cloud.normals.push(normal.as_vec3().to_array());
        let shade = 0.9 + 0.2 * chance(3);
        let [r, g, b] = (self.color * shade)
            .to_array()
            .map(|channel| (channel.clamp(0.0, 1.0) * 65_535.0).round() as u16);
        cloud.colors.push([r, g, b, u16::MAX]);
    }
}
