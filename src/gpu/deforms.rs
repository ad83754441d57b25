//! Deforms: records for the pass that mixes shapes and follows joints. Mirrors of the structs in `shaders/common/bends.wgsl` and
//! `shaders/slots/shapes/kept.wgsl`.

use std::{collections::HashMap, ops::Range};

use super::uniforms::{GpuRecord, format_word, gpu_record};
use crate::scene::{Accessor, Scene, deformation::Influences, draw::Draw, joint_transforms::JointTransforms};

gpu_record! {
    /// One draw that bends. Each member is explained in `shaders/common/bends.wgsl`.
    pub struct DeformRecord = "Deform" {
        pub first: u32,
        pub count: u32,
        pub target_word: u32,
        pub position_offset: u32,
        pub position_stride: u32,
        pub position_format: u32,
        pub normal_offset: u32,
        pub normal_stride: u32,
        pub normal_format: u32,
        pub first_joint: u32,
        pub joints_offset: [u32; 2],
        pub joints_stride: [u32; 2],
        pub joints_format: [u32; 2],
        pub weights_offset: [u32; 2],
        pub weights_stride: [u32; 2],
        pub weights_format: [u32; 2],
        pub sets: u32,
        pub joint_count: u32,
        pub first_shape: u32,
        pub shape_count: u32,
    }
}

gpu_record! {
    /// One shape of one draw. Each member is explained in `shaders/slots/shapes/kept.wgsl`.
    pub struct ShapeRecord = "Shape" {
        pub weight: f32,
        pub position_offset: u32,
        pub position_stride: u32,
        pub position_format: u32,
        pub normal_offset: u32,
        pub normal_stride: u32,
        pub normal_format: u32,
        pub spare: u32,
    }
}

/// Bytes of a bent vertex: position and normal, three floats each.
pub const DEFORMED_BYTES: u32 = 24;

/// Everything that the pass reads besides the scene's bytes.
#[derive(Default)]
pub struct Deforms {
    pub records: Vec<DeformRecord>,
    pub morph_targets: Vec<ShapeRecord>,
    /// Joints: three vectors each, or five as dual quaternions.
    pub joints: Vec<[f32; 4]>,
}

/// Where the bent vertices of a draw begin, in bytes.
pub fn deformed_offset(draw: &Draw, scene: &Scene) -> u32 {
    scene.vertex_bytes.len() as u32 + DEFORMED_BYTES * draw.first_deformable
}

/// Which vertices, of all that may bend, a picture bends.
pub fn deformed_ranges(scene: &Scene, draws: &[Draw]) -> Vec<Range<u32>> {
    let deformed = draws.iter().filter(|draw| draw.deform.is_some());
    deformed.map(|draw| draw.first_deformable..draw.first_deformable + scene.primitives[draw.primitive].vertex_count()).collect()
}

impl Deforms {
    /// Of those draws that bend; one record at least, since no binding is empty.
    pub fn of<'a>(scene: &Scene, draws: impl Iterator<Item = &'a Draw>) -> Self {
        let mut deforms = Self::default();
        let mut known = HashMap::new();
        draws.for_each(|draw| deforms.take(scene, draw, &mut known));
        if deforms.records.is_empty() {
            deforms.records.push(DeformRecord::default());
        }
        deforms
    }

    fn take(&mut self, scene: &Scene, draw: &Draw, known: &mut HashMap<*const u8, u32>) {
        let Some(deform) = &draw.deform else { return };
        let primitive = &scene.primitives[draw.primitive];
        let mut record = DeformRecord {
            first: draw.first_deformable,
            count: primitive.vertex_count(),
            target_word: deformed_offset(draw, scene) / 4,
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
            let each = |pick: fn(&Influences) -> u32| [0, 1].map(|set| sets.get(set).map_or(0, pick));
            (record.joints_offset, record.weights_offset) = (each(|set| set.joints.offset), each(|set| set.weights.offset));
            (record.joints_stride, record.weights_stride) = (each(|set| set.joints.stride), each(|set| set.weights.stride));
            (record.joints_format, record.weights_format) = (each(|set| format_word(&set.joints)), each(|set| format_word(&set.weights)));
        }
        let morph_targets = deform.weights.iter().zip(&primitive.deformation.morph_targets).filter(|(weight, _)| **weight != 0.0);
        self.morph_targets.extend(morph_targets.map(|(&weight, shape)| {
            let part = |accessor: Option<&Accessor>| accessor.map_or([0; 3], |a| [a.offset, a.stride, format_word(a)]);
            let ([position_offset, position_stride, position_format], [normal_offset, normal_stride, normal_format]) =
                (part(shape.positions.as_ref()), part(shape.normals.as_ref()));
            ShapeRecord { weight, position_offset, position_stride, position_format, normal_offset, normal_stride, normal_format, spare: 0 }
        }));
        record.shape_count = self.morph_targets.len() as u32 - record.first_shape;
        self.records.push(record);
    }

    /// Place of the first joint of a palette, which draws of one skin share.
    fn joints_of(&mut self, joint_transforms: &JointTransforms, known: &mut HashMap<*const u8, u32>) -> u32 {
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
