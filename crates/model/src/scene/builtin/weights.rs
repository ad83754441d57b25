//! Skinning weights: which joints influence each vertex, with integer weights of a constant sum.

use glam::DVec3;

use crate::scene::{
    accessor::{Accessor, ComponentType},
    bounds::Bounds,
    deformation::Influences,
    model::Scene,
};

/// A joint and its weight; the weights of a vertex sum to 65,535.
pub type JointWeight = (u8, u16);

/// Rounds weights that sum to about 1 to integers that sum to 65,535, largest first. The largest
/// absorbs the rounding error.
pub fn to_integers(joint_weights: &[(u8, f64)]) -> Vec<JointWeight> {
    let mut rounded: Vec<JointWeight> = joint_weights
        .iter()
        .map(|&(joint, fraction)| (joint, (fraction.clamp(0.0, 1.0) * 65_535.0).round() as u16))
        .collect();
    rounded.sort_by_key(|&(joint, weight)| (std::cmp::Reverse(weight), joint));
    let sum: i32 = rounded.iter().map(|&(_, weight)| i32::from(weight)).sum();
    rounded[0].1 = (i32::from(rounded[0].1) + 65_535 - sum) as u16;
    rounded
}

/// Appends joint indices and weights to a primitive: `sets` sets of four per vertex, `joints`
/// joints in all.
pub fn append(
    scene: &mut Scene,
    primitive: usize,
    joints: usize,
    sets: usize,
    joint_weights: &[Vec<JointWeight>],
) {
    let mut bounds = vec![Bounds::EMPTY; joints];
    let (mut numbers, mut weights) = (vec![Vec::<u8>::new(); sets], vec![Vec::<u16>::new(); sets]);
    for (vertex, joint_weights) in joint_weights.iter().enumerate() {
        let position = DVec3::from(
            scene.primitives[primitive]
                .position(scene, vertex as u32)
                .map(f64::from),
        );
        for slot in 0..4 * sets {
            let (joint, weight) = joint_weights.get(slot).copied().unwrap_or((0, 0));
            numbers[slot / 4].push(joint);
            weights[slot / 4].push(weight);
            if weight > 0 {
                bounds[usize::from(joint)].include(position);
            }
        }
    }
    let mut append = |bytes: &[u8]| {
        let at = scene.vertex_bytes.len() as u32;
        scene.vertex_bytes.extend_from_slice(bytes);
        scene
            .vertex_bytes
            .resize(scene.vertex_bytes.len().next_multiple_of(4), 0);
        at
    };
    let accessor = |offset, component_type: ComponentType, normalized| Accessor {
        offset,
        stride: 4 * component_type.bytes(),
        component_type,
        components: 4,
        normalized,
        count: joint_weights.len() as u32,
    };
    let influences = numbers
        .iter()
        .zip(&weights)
        .map(|(numbers, weights)| Influences {
            joints: accessor(append(numbers), ComponentType::U8, false),
            weights: accessor(
                append(bytemuck::cast_slice(weights)),
                ComponentType::U16,
                true,
            ),
        })
        .collect();
    let deformation = &mut scene.primitives[primitive].deformation;
    (deformation.influences, deformation.joint_bounds) = (influences, bounds);
}
