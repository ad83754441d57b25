//! Deforms: the records that the skin pass reads to mix morph targets and to follow joints.

use std::{collections::HashMap, ops::Range};

use super::attributes::{AttributeLayout, format_word};
use crate::{
    layout::records::{DeformRecord, MorphTargetRecord},
    scene::{
        Accessor, Scene, deformation::Influences, draw::Draw, joint_transforms::JointTransforms,
    },
};

/// Everything that the skin pass reads besides the attributes.
#[derive(Default)]
pub struct Deforms {
    pub records: Vec<DeformRecord>,
    pub morph_targets: Vec<MorphTargetRecord>,
    /// Three vectors for each joint, or five for one as dual quaternion.
    pub joints: Vec<[f32; 4]>,
}

/// Which of all vertices that may be deformed are deformed for a picture.
pub fn deformed_ranges(scene: &Scene, draws: &[Draw]) -> Vec<Range<u32>> {
    let deformed = draws.iter().filter(|draw| draw.deform.is_some());
    deformed
        .map(|draw| {
            draw.first_deformable
                ..draw.first_deformable + scene.primitives[draw.primitive].vertex_count()
        })
        .collect()
}

impl Deforms {
    /// Of those draws that are deformed; one record at least, since no binding is empty.
    pub fn of<'a>(
        scene: &Scene,
        attributes: &AttributeLayout,
        draws: impl Iterator<Item = &'a Draw>,
    ) -> Self {
        let mut deforms = Self::default();
        let mut known = HashMap::new();
        draws.for_each(|draw| deforms.add(scene, attributes, draw, &mut known));
        if deforms.records.is_empty() {
            deforms.records.push(DeformRecord::default());
        }
        deforms
    }

    fn add(
        &mut self,
        scene: &Scene,
        attributes: &AttributeLayout,
        draw: &Draw,
        known: &mut HashMap<*const u8, u32>,
    ) {
        let Some(deform) = &draw.deform else { return };
        let primitive = &scene.primitives[draw.primitive];
        let mut record = DeformRecord {
            first: draw.first_deformable,
            count: primitive.vertex_count(),
            target_word: attributes.deformed_vertex(draw.first_deformable) as u32 / 4,
            position_offset: primitive.positions.offset,
            position_stride: primitive.positions.stride,
            position_format: format_word(&primitive.positions),
            normal_offset: primitive.normals.offset,
            normal_stride: primitive.normals.stride,
            normal_format: format_word(&primitive.normals),
            first_shape: self.morph_targets.len() as u32,
            ..DeformRecord::default()
        };
        if let Some(joint_transforms) = &deform.joint_transforms {
            record.first_joint = self.joints_of(joint_transforms, known);
            record.joint_count = joint_transforms.len() as u32;
            let sets = &primitive.deformation.influences;
            record.sets = sets.len() as u32;
            let each =
                |pick: fn(&Influences) -> u32| [0, 1].map(|set| sets.get(set).map_or(0, pick));
            (record.joints_offset, record.weights_offset) = (
                each(|set| set.joints.offset),
                each(|set| set.weights.offset),
            );
            (record.joints_stride, record.weights_stride) = (
                each(|set| set.joints.stride),
                each(|set| set.weights.stride),
            );
            (record.joints_format, record.weights_format) = (
                each(|set| format_word(&set.joints)),
                each(|set| format_word(&set.weights)),
            );
        }
        let morph_targets = deform
            .weights
            .iter()
            .zip(&primitive.deformation.morph_targets)
            .filter(|(weight, _)| **weight != 0.0);
        self.morph_targets
            .extend(morph_targets.map(|(&weight, shape)| {
                let part = |accessor: Option<&Accessor>| {
                    accessor.map_or([0; 3], |a| [a.offset, a.stride, format_word(a)])
                };
                let (
                    [position_offset, position_stride, position_format],
                    [normal_offset, normal_stride, normal_format],
                ) = (part(shape.positions.as_ref()), part(shape.normals.as_ref()));
                MorphTargetRecord {
                    weight,
                    position_offset,
                    position_stride,
                    position_format,
                    normal_offset,
                    normal_stride,
                    normal_format,
                    spare: 0,
                }
            }));
        record.shape_count = self.morph_targets.len() as u32 - record.first_shape;
        self.records.push(record);
    }

    /// Index of the first joint of these transforms, which draws of one skin share.
    fn joints_of(
        &mut self,
        joint_transforms: &JointTransforms,
        known: &mut HashMap<*const u8, u32>,
    ) -> u32 {
        let (bytes, vectors): (&[u8], usize) = match joint_transforms {
            JointTransforms::Linear(joints) => (bytemuck::cast_slice(joints), 3),
            JointTransforms::Dual(joints) => (bytemuck::cast_slice(joints), 5),
        };
        let joints = &mut self.joints;
        *known.entry(bytes.as_ptr()).or_insert_with(|| {
            let first = joints.len() / vectors;
            joints.extend(bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(bytes));
            first as u32
        })
    }
}
