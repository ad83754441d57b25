//! Nebula: points in a volume, denser where clouds of them are, each in the color of its clouds.

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use super::query::{BuiltinError, Values};
use crate::{
    math::{hash, hash_unit},
    scene::{
        material::Material,
        model::{Instance, Scene},
        point_cloud::PointCloud,
    },
};

/// Clouds, and the width of the volume in which they lie, meters.
const CLOUDS: u32 = 48;
const WIDTH_M: f64 = 6.0;

/// Colors of a cloud, by how far along the volume it lies: linear.
const COLORS: [DVec3; 3] = [
    DVec3::new(0.05, 0.14, 0.62),
    DVec3::new(0.66, 0.09, 0.30),
    DVec3::new(1.0, 0.55, 0.14),
];

/// Builds the scene `nebula`.
///
/// # Errors
/// None; builders share a type.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (points, seed) = (values.whole("points"), values.whole("seed"));
    let height = values.get("height");
    let cloud = |cloud| Cloud::of(seed, cloud, height);
    let clouds: Vec<Cloud> = (0..CLOUDS).map(cloud).collect();
    let (positions, colors) = (0..points)
        .into_par_iter()
        .map(|point| {
            let chance = |salt: u32| hash_unit(hash(seed ^ 0x9e37_79b9) ^ hash(8 * point + salt));
            let cloud = &clouds[(f64::from(CLOUDS) * chance(0)) as usize % clouds.len()];
            cloud.point(chance)
        })
        .unzip();
    let cloud = PointCloud {
        positions,
        colors,
        normals: Vec::new(),
    };
    let mut scene = Scene {
        materials: vec![Material {
            name: "points".into(),
            unlit: true,
            ..Material::default()
        }],
        ..Scene::default()
    };
    let primitive = cloud.append(&mut scene, "nebula", 0);
    scene
        .instances
        .push(Instance::fixed(primitive, DMat4::IDENTITY));
    Ok(scene)
}

/// A ball that fades outward.
struct Cloud {
    middle: DVec3,
    reach: DVec3,
    color: DVec3,
}

impl Cloud {
    /// Of a spiral arm, with something of chance.
    fn of(seed: u32, cloud: u32, height: f64) -> Self {
        let chance = |salt: u32| hash_unit(hash(seed) ^ hash(16 * cloud + salt));
        let along = (f64::from(cloud) + chance(0)) / f64::from(CLOUDS);
        let (angle, out) = (9.0 * along, WIDTH_M * (0.06 + 0.44 * along));
        let flat = DVec3::new(1.0, height, 1.0);
        let aside = DVec3::new(chance(1), chance(2), chance(3)) - 0.5;
        let middle = DVec3::new(out * angle.cos(), 0.0, out * angle.sin()) + aside * flat;
        let [near, far] =
            [(2.0 * along) as usize, (2.0 * along) as usize + 1].map(|k| COLORS[k.min(2)]);
        Self {
            middle,
            reach: flat * (0.35 + 0.75 * chance(4)),
            color: far.lerp(near, (2.0 * along).fract().mul_add(-1.0, 1.0)),
        }
    }

    /// A point in it and its color.
    fn point(&self, chance: impl Fn(u32) -> f64) -> ([f32; 3], [u16; 4]) {
        // The sum of several even ones is dense in the middle.
        let axis = |salt: u32| chance(salt) + chance(salt + 1) - 1.0;
        let place = self.middle + self.reach * DVec3::new(axis(1), axis(3), axis(5));
        let shade = 0.45 + 0.9 * chance(7).powi(3);
        let [r, g, b] = (self.color * shade)
            .to_array()
            .map(|channel| (channel.clamp(0.0, 1.0) * 65_535.0).round() as u16);
        (place.as_vec3().to_array(), [r, g, b, u16::MAX])
    }
}
