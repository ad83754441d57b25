//! Draw data: what a view's passes read about every instance, computed on the CPU when the scene,
//! the viewpoint or the format of the positions change.

use std::{ops::Range, sync::Arc};

use glam::DMat3;
use rayon::prelude::*;

use super::{
    attributes::{AttributeLayout, DEFORMED_BYTES, format_word},
    deforms::{Deforms, deformed_ranges},
    frame_layout::SceneCounts,
    meshlets::{MeshletBuffers, is_outside},
    packing::PackedBox,
    records::{DrawRecord, InstanceRecord},
};
use crate::{
    effects::glass::GlassDraws,
    math::rounded_columns,
    scene::{
        Accessor, Scene,
        draw::{Draw, MANY_DRAWS, totals},
        parts::Scope,
        view::View,
    },
};

/// What draw data follow from; equal inputs give equal data.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawInputs {
    pub view: View,
    pub attributes: AttributeLayout,
    /// Meshlets are culled, so every instance needs its record.
    pub culls: bool,
    /// Draws outside the picture are deformed too.
    pub deforms_offscreen: bool,
    /// Scopes of the stack.
    pub scopes: Vec<Scope>,
    /// Which draws are glass.
    pub glass: GlassDraws,
}

/// What a view's passes read about every instance, computed on the CPU when the scene, the
/// viewpoint or the position format changes.
pub struct DrawData {
    scene: Arc<Scene>,
    inputs: DrawInputs,
    pub records: Vec<DrawRecord>,
    pub deforms: Deforms,
    /// Which of all vertices that may be deformed are deformed.
    pub deformed: Vec<Range<u32>>,
    pub instances: Vec<InstanceRecord>,
    pub counts: SceneCounts,
}

impl DrawData {
    /// Of the draws of `scene` as the view has them. `boxes` are those of packed positions, one per
    /// primitive.
    pub fn new(
        scene: &Arc<Scene>,
        draws: &[Draw],
        inputs: DrawInputs,
        boxes: &[PackedBox],
        meshlets: Option<&MeshletBuffers>,
    ) -> Self {
        let attributes = &inputs.attributes;
        let record = |draw: &Draw| {
            let record = DrawRecord::new(draw, scene, attributes);
            boxes.get(draw.primitive).map_or(record, |packed| {
                record.packed(packed, attributes.first_packed() as u32)
            })
        };
        let mut records: Vec<DrawRecord> = draws
            .par_iter()
            .with_min_len(MANY_DRAWS)
            .map(record)
            .collect();
        // A binding holds an element at least, even where nothing is to be drawn.
        records.resize(draws.len().max(1), DrawRecord::default());
        // Nothing outside the picture is drawn, so it need not be deformed, unless its shadow may
        // fall into the picture.
        let is_deformed = |draw: &&Draw| {
            draw.deform.is_some() && (inputs.deforms_offscreen || !is_outside(draw, scene))
        };
        let deforms = Deforms::of(scene, attributes, draws.iter().filter(is_deformed));
        let deformed = deformed_ranges(scene, draws);
        let instances = meshlets.map_or_else(Vec::new, |meshlets| {
            meshlets.instances(scene, draws, &inputs.view)
        });
        let [vertices, triangles] = totals(scene, draws);
        let counts = SceneCounts {
            vertices,
            triangles,
            draws: draws.len() as u64,
            deformable: deformed.last().map_or(0, |range| range.end),
            deforms: deforms.records.len() as u64,
            joint_vectors: deforms.joints.len() as u64,
            morph_targets: deforms.morph_targets.len() as u64,
            particles: 0,
            ..meshlets.map_or_else(SceneCounts::default, MeshletBuffers::counts)
        };
        Self {
            scene: scene.clone(),
            inputs,
            records,
            deforms,
            deformed,
            instances,
            counts,
        }
    }

    /// Would these inputs give the same data?
    pub fn is_of(&self, scene: &Arc<Scene>, inputs: &DrawInputs) -> bool {
        Arc::ptr_eq(&self.scene, scene) && self.inputs == *inputs
    }
}

// Bits of [`DrawRecord::flags`]; above them is the number of the primitive.
const DOUBLE_SIDED: u32 = 1;
const MIRRORED: u32 = 2;
const PARTICLES: u32 = 4;
const UNEVEN: u32 = 8;
const FACETED: u32 = 16;
const GLASS: u32 = 32;
const PRIMITIVE_SHIFT: u32 = 8;

impl DrawRecord {
    /// The record of a draw whose attributes lie as `attributes` says.
    pub fn new(draw: &Draw, scene: &Scene, attributes: &AttributeLayout) -> Self {
        let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        let [x, y, z] = draw.origin;
        let primitive = &scene.primitives[draw.primitive];
        let material = &scene.materials[primitive.material];
        let [red, green, blue, alpha] = material.base_color;
        let is_opaque = material.is_blended && !draw.is_glass;
        let color = primitive.colors.map(|colors| Accessor {
            components: if is_opaque { 3 } else { colors.components },
            ..colors
        });
        let color = color.as_ref();
        let deformed = |part: usize| {
            let offset = attributes.deformed_vertex(draw.first_deformable) as usize + 12 * part;
            Accessor {
                stride: DEFORMED_BYTES,
                ..Accessor::packed_f32(offset, 3, primitive.vertex_count() as usize)
            }
        };
        let [positions, normals] = if draw.deform.is_some() {
            [deformed(0), deformed(1)]
        } else {
            [primitive.positions, primitive.normals]
        };
        Self {
            clip_from_object: draw.clip_from_object,
            world_from_object: rounded_columns(&draw.world_from_object),
            normal_from_object: normal_from_object(draw),
            base_color: [red, green, blue, if is_opaque { 1.0 } else { alpha }],
            origin: [x, y, z, 0.0],
            step: [0.0; 4],
            first_vertex: draw.first_vertex,
            vertex_count: primitive.vertex_count(),
            first_triangle: draw.first_triangle,
            flags: flag(draw.double_sided, DOUBLE_SIDED)
                | flag(draw.mirrored, MIRRORED)
                | flag(draw.is_uneven, UNEVEN)
                | flag(draw.is_faceted, FACETED)
                | flag(draw.is_glass, GLASS)
                | flag(scene.particle_discs == Some(draw.primitive), PARTICLES)
                | (draw.primitive as u32) << PRIMITIVE_SHIFT,
            topology: primitive.topology as u32,
            index_offset: primitive.indices.map_or(0, |i| i.offset),
            index_format: primitive.indices.map_or(0, |i| i.component_type.bytes()),
            position_offset: positions.offset,
            position_stride: positions.stride,
            position_format: format_word(&positions),
            normal_offset: normals.offset,
            normal_stride: normals.stride,
            normal_format: format_word(&normals),
            color_offset: color.map_or(0, |c| c.offset),
            color_stride: color.map_or(0, |c| c.stride),
            color_format: color.map_or(0, format_word),
            scopes: draw.scopes,
            spare_0: 0,
            spare_1: 0,
            spare_2: 0,
        }
    }
}

impl DrawRecord {
    /// The same with positions in steps of a box, which begin `first` bytes into the attributes.
    fn packed(self, packed: &PackedBox, first: u32) -> Self {
        let wide = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        Self {
            origin: wide(packed.origin),
            step: wide(packed.step),
            position_offset: first + 4 * packed.first_word,
            ..self
        }
    }
}

/// Cofactors of the placement, in the direction of its inverse transpose, scaled so that the
/// largest entry is 1.
fn normal_from_object(draw: &Draw) -> [[f32; 4]; 4] {
    let m = DMat3::from_mat4(draw.world_from_object);
    let mut cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    if draw.mirrored {
        cofactors *= -1.0;
    }
    let largest = cofactors
        .to_cols_array()
        .iter()
        .fold(0.0, |max: f64, v| max.max(v.abs()));
    if largest > 0.0 {
        cofactors *= 1.0 / largest;
    }
    rounded_columns(&glam::DMat4::from_mat3(cofactors))
}
