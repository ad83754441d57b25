//! Hashes that recognize what a picture was made from: presets and scenes.

use super::file::{PresetFile, to_toml};
use crate::{
    preset::{Clock, Preset},
    scene::{Accessor, Scene, material::Material},
};

/// Hash of everything that decides the picture, without names, comments, budgets and values at
/// other times.
pub fn preset_hash(preset: &Preset) -> Fnv {
    let clock = Clock {
        time_s: preset.clock.time_s,
        ..Clock::default()
    };
    let picture = Preset {
        name: String::new(),
        about: String::new(),
        tags: Vec::new(),
        bookmarks: Vec::new(),
        test: None,
        clock,
        ..preset.evaluated()
    };
    Fnv::new().bytes(to_toml(&PresetFile::new("", picture)).as_bytes())
}

/// Hash of a scene's bytes, accessors, materials, placements, lights and surroundings.
pub fn scene_hash(scene: &Scene) -> Fnv {
    let mut hash = Fnv::new()
        .bytes(&scene.vertex_bytes)
        .bytes(&scene.index_bytes);
    for primitive in &scene.primitives {
        let mut accessor = |a: &Accessor| {
            let words = [
                a.offset,
                a.stride,
                a.component_type as u32,
                a.components,
                a.normalized.into(),
                a.count,
            ];
            hash = hash.words(&words);
        };
        [
            Some(&primitive.positions),
            Some(&primitive.normals),
            primitive.colors.as_ref(),
            primitive.indices.as_ref(),
        ]
        .into_iter()
        .flatten()
        .for_each(&mut accessor);
        let deformation = &primitive.deformation;
        deformation
            .influences
            .iter()
            .for_each(|set| [set.joints, set.weights].iter().for_each(&mut accessor));
        deformation.morph_targets.iter().for_each(|shape| {
            shape
                .positions
                .iter()
                .chain(&shape.normals)
                .for_each(&mut accessor)
        });
        hash = hash.words(&[primitive.topology as u32, primitive.material as u32]);
        if primitive.is_faceted {
            hash = hash.words(&[1]);
        }
    }
    for material in &scene.materials {
        hash = hash
            .words(&material.base_color.map(f32::to_bits))
            .words(&[material.double_sided.into()]);
        if material.is_blended {
            hash = hash.words(&[1]);
        }
        if material.transmits() {
            hash = hash
                .words(&[material.transmission.to_bits()])
                .words(&material.attenuation.map(f32::to_bits));
        }
        let [finish, usual] = [material, &Material::default()]
            .map(|material| (material.metallic, material.roughness, material.specular));
        if finish != usual {
            let (metallic, roughness, specular) = finish;
            hash = hash
                .words(&[metallic, roughness].map(f32::to_bits))
                .words(&specular.map(f32::to_bits));
        }
    }
    for instance in &scene.instances {
        hash = hash.words(&[instance.primitive as u32]);
        hash = instance
            .world_from_object
            .to_cols_array()
            .iter()
            .fold(hash, |hash, v| hash.bytes(&v.to_bits().to_le_bytes()));
    }
    for light in &scene.lights {
        let placed = light.placed(&light.world_from_light);
        let numbers = [placed.light, placed.position, placed.toward].concat();
        let rest = [placed.inverse_range, placed.cone[0], placed.cone[1]];
        let bits = numbers.into_iter().chain(rest).map(f32::to_bits);
        hash = hash.words(&bits.collect::<Vec<_>>());
        hash = hash.words(&[
            u32::from(placed.has_position),
            light.node.map_or(u32::MAX, |node| node as u32),
        ]);
    }
    if let Some(panorama) = &scene.panorama {
        hash = hash.words(panorama.words());
    }
    if scene.rig.is_empty() {
        hash
    } else {
        rig_hash(hash, scene)
    }
}

/// Hash of nodes, skins, clips and the nodes of instances; only clips are named by presets.
fn rig_hash(mut hash: Fnv, scene: &Scene) -> Fnv {
    let matrix = |hash: Fnv, m: &glam::DMat4| {
        m.to_cols_array()
            .iter()
            .fold(hash, |hash, v| hash.bytes(&v.to_bits().to_le_bytes()))
    };
    let floats = |hash: Fnv, values: &[f32]| {
        values
            .iter()
            .fold(hash, |hash, v| hash.words(&[v.to_bits()]))
    };
    let place = |place: Option<usize>| place.map_or(u32::MAX, |place| place as u32);
    for node in &scene.rig.nodes {
        hash = floats(
            matrix(hash.words(&[place(node.parent)]), &node.rest.matrix()),
            &node.weights,
        );
    }
    for skin in &scene.rig.skins {
        hash = skin
            .joints
            .iter()
            .fold(hash, |hash, &joint| hash.words(&[joint as u32]));
        hash = skin.joint_from_mesh.iter().fold(hash, matrix);
    }
    for sampler in &scene.rig.samplers {
        hash = floats(
            floats(
                hash.words(&[sampler.interpolation as u32, sampler.components as u32]),
                &sampler.times,
            ),
            &sampler.values,
        );
    }
    for clip in &scene.rig.clips {
        hash = hash.bytes(clip.name.as_bytes());
        hash = clip.channels.iter().fold(hash, |hash, c| {
            hash.words(&[c.node as u32, c.property as u32, c.sampler as u32])
        });
    }
    hash = scene.instances.iter().fold(hash, |hash, instance| {
        let hash = hash.words(&[place(instance.node), place(instance.skin)]);
        match instance.placement {
            Some(placement) => hash.words(&[placement as u32]),
            None => hash,
        }
    });
    scene.rig.placements.iter().fold(hash, matrix)
}

/// As 16 hexadecimal digits.
pub fn hex(hash: Fnv) -> String {
    format!("{:016x}", hash.0)
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo): detects accidental changes, not deliberate ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(pub u64);

impl Fnv {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub fn bytes(self, bytes: &[u8]) -> Self {
        Self(bytes.iter().fold(self.0, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        }))
    }

    /// Little-endian.
    pub fn words(self, words: &[u32]) -> Self {
        words
            .iter()
            .fold(self, |hash, word| hash.bytes(&word.to_le_bytes()))
    }
}

impl Default for Fnv {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_gives_its_published_values() {
        let hash = |text: &str| Fnv::new().bytes(text.as_bytes()).0;
        assert_eq!(
            [hash(""), hash("a"), hash("foobar")],
            [
                0xcbf2_9ce4_8422_2325,
                0xaf63_dc4c_8601_ec8c,
                0x8594_4171_f739_67e8
            ]
        );
    }

    #[test]
    fn a_name_does_not_change_the_hash_and_a_color_does() {
        let plain = Preset::default();
        let named = Preset {
            name: "x".into(),
            ..plain.clone()
        };
        let mut tinted = plain.clone();
        tinted.output.background[0] += 0.001;
        assert_eq!(preset_hash(&plain), preset_hash(&named));
        assert_ne!(preset_hash(&plain), preset_hash(&tinted));
    }
}
