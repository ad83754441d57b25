//! Field: a lattice of randomly rotated bumpy spheres seen from its center; most are outside the
//! picture or occluded.

use glam::{DMat4, DQuat, DVec3};

use super::{
    query::{BuiltinError, MAX_TRIANGLES, Values},
    shapes,
};
use crate::{
    math::{hash, hash_unit},
    scene::{
        camera::{Camera, Projection},
        material::Material,
        model::{Instance, Scene, SceneCamera},
    },
};

/// Distance between neighbors, meters; spheres have a radius of about 1.
const SPACING_M: f64 = 2.4;

/// Builds the scene `field`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    const TONES: [(&str, [f32; 3]); 5] = [
        ("clay", [0.42, 0.47, 0.52]),
        ("rust", [0.58, 0.16, 0.06]),
        ("moss", [0.16, 0.30, 0.08]),
        ("sand", [0.76, 0.60, 0.34]),
        ("slate", [0.06, 0.14, 0.24]),
    ];
    let (count, seed) = (values.whole("count"), values.whole("seed"));
    let triangles = u64::from(values.whole("triangles")) * u64::from(count);
    if triangles > MAX_TRIANGLES {
        return Err(BuiltinError(format!(
            "field: {triangles} triangles in all; allowed: at most {MAX_TRIANGLES}. Lower count or triangles"
        )));
    }
    let mut scene = shapes::sphere(values)?;
    scene.instances.clear();
    scene.materials.clear();
    for (material, (name, [r, g, b])) in TONES.into_iter().enumerate() {
        scene.materials.push(Material {
            name: name.into(),
            base_color: [r, g, b, 1.0],
            ..Material::default()
        });
        if material > 0 {
            let primitive = scene.primitives[0].clone();
            scene.primitives.push(primitive);
        }
        scene.primitives[material].material = material;
    }
    // The smallest cube that contains them all, filled plane by plane. An even side leaves a gap at
    // the center.
    let side = (1..).find(|side: &u32| side.pow(3) >= count).unwrap_or(1);
    let middle = 0.5 * f64::from(side - 1);
    for i in 0..count {
        let chance = |salt: u32| hash_unit(i.wrapping_mul(8).wrapping_add(salt) ^ hash(seed));
        let position = [i % side, i / side % side, i / (side * side)]
            .map(|at| (f64::from(at) - middle) * SPACING_M);
        let axis =
            DVec3::new(chance(0) - 0.5, chance(1) - 0.5, chance(2) - 0.5).normalize_or(DVec3::Y);
        let (sin, cos) = libm::sincos(chance(3) * std::f64::consts::PI);
        let turn = DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos);
        let scale = DVec3::splat(0.7 + 0.3 * chance(4));
        let placement = DMat4::from_scale_rotation_translation(scale, turn, position.into());
        let tone = (chance(5) * TONES.len() as f64) as usize;
        scene.instances.push(Instance::fixed(tone, placement));
    }
    let eye = if side % 2 == 0 {
        DVec3::ZERO
    } else {
        DVec3::splat(0.5 * SPACING_M)
    };
    let pose = Camera {
        eye,
        target: eye + DVec3::new(0.35, 0.1, -1.0),
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y_deg: 50.0 },
        near_m: 0.05,
    };
    scene.cameras = vec![SceneCamera {
        name: "inside".into(),
        pose,
        node: None,
    }];
    Ok(scene)
}
