//! The records of a view's draws: whole ones, or where many instances show few primitives, records
//! of what each alone has, and one shape for each primitive.

use glam::DMat3;
use rayon::prelude::*;

use super::{
    attributes::{AttributeLayout, DEFORMED_BYTES, PLACEMENT_WORDS, format_word},
    packing::PackedBox,
};
use crate::{
    layout::records::{DrawRecord, DrawShapeRecord, InstancedDrawRecord},
    math::rounded_columns,
    scene::{
        Accessor, Scene,
        draw::{Draw, MANY_DRAWS},
        model::MOST_SHAPES,
    },
    shader::key::POINT_BLOCK,
};

/// See the module's first lines.
pub enum DrawRecords {
    /// Everything about every draw, one record at least.
    Whole(Vec<DrawRecord>),
    Instanced {
        draws: Vec<InstancedDrawRecord>,
        /// By the index of the primitive; [`MOST_SHAPES`].
        shapes: Vec<DrawShapeRecord>,
    },
}

impl DrawRecords {
    /// The records that `whole` makes of the draws.
    pub fn whole(draws: &[Draw], whole: impl Fn(&Draw) -> DrawRecord + Sync) -> Self {
        let mut records = of_each(draws, whole);
        // A binding holds an element at least, even where nothing is to be drawn.
        records.resize(draws.len().max(1), DrawRecord::default());
        Self::Whole(records)
    }

    /// The same in parts. Draws of one primitive agree in what becomes its shape.
    pub fn instanced(
        draws: &[Draw],
        attributes: &AttributeLayout,
        whole: impl Fn(&Draw) -> DrawRecord,
    ) -> Self {
        let mut shown = [None; MOST_SHAPES];
        draws
            .iter()
            .for_each(|draw| shown[draw.primitive] = Some(draw));
        let first_placement = (attributes.first_placement() / 4) as u32;
        let shape = |draw: Option<&Draw>| {
            draw.map_or_else(DrawShapeRecord::default, |draw| {
                shape_of(&whole(draw), first_placement)
            })
        };
        Self::Instanced {
            draws: of_each(draws, instanced_record),
            shapes: shown.map(shape).to_vec(),
        }
    }

    /// Numbers points and their blocks, and returns how many there are. With `projects_points` vertex
    /// records are those of other draws alone.
    pub fn number_points(
        &mut self,
        scene: &Scene,
        draws: &[Draw],
        projects_points: bool,
    ) -> PointCounts {
        let mut before = PointCounts::default();
        let Self::Whole(records) = self else {
            return before;
        };
        for (record, draw) in records.iter_mut().zip(draws) {
            let primitive = &scene.primitives[draw.primitive];
            (record.first_point, record.first_block) = (before.points, before.blocks);
            record.first_vertex -= before.unwritten;
            if primitive.is_points() {
                before.points += primitive.triangle_count();
                before.blocks += primitive.triangle_count().div_ceil(POINT_BLOCK);
                before.unwritten += u32::from(projects_points) * primitive.vertex_count();
            }
        }
        before
    }

    /// The bytes of the buffer of draws.
    pub fn draws(&self) -> &[u8] {
        match self {
            Self::Whole(records) => bytemuck::cast_slice(records),
            Self::Instanced { draws, .. } => bytemuck::cast_slice(draws),
        }
    }

    /// The bytes of the table of shapes; none where draws share none.
    pub fn shapes(&self) -> &[u8] {
        match self {
            Self::Whole(_) => &[],
            Self::Instanced { shapes, .. } => bytemuck::cast_slice(shapes),
        }
    }
}

/// Points of all draws, their blocks, and vertices of which no pass writes a record.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointCounts {
    pub points: u32,
    pub blocks: u32,
    pub unwritten: u32,
}

/// The matrices of an instance, as `shaders/variants/draw_records.wgsl` reads them.
pub type Placement = [f32; PLACEMENT_WORDS];

/// The matrices of every draw.
pub fn placements(draws: &[Draw]) -> Vec<Placement> {
    of_each(draws, placement)
}

fn of_each<T: Send>(draws: &[Draw], make: impl Fn(&Draw) -> T + Sync) -> Vec<T> {
    draws
        .par_iter()
        .with_min_len(MANY_DRAWS)
        .map(&make)
        .collect()
}

fn instanced_record(draw: &Draw) -> InstancedDrawRecord {
    InstancedDrawRecord {
        clip_from_object: draw.clip_from_object,
        first_vertex: draw.first_vertex,
        first_triangle: draw.first_triangle,
        flags: draw_flags(draw),
        scopes: draw.scopes,
    }
}

/// Columns to the world, then columns for normals, without their fourth rows.
fn placement(draw: &Draw) -> Placement {
    let world = rounded_columns(&draw.world_from_object);
    let [x, y, z, _] = normal_from_object(draw);
    let mut words = [0.0; PLACEMENT_WORDS];
    let columns = world.iter().chain([&x, &y, &z]);
    for (three, column) in words.chunks_exact_mut(3).zip(columns) {
        three.copy_from_slice(&column[..3]);
    }
    words
}

fn shape_of(record: &DrawRecord, first_placement: u32) -> DrawShapeRecord {
    DrawShapeRecord {
        base_color: record.base_color,
        origin: record.origin,
        step: record.step,
        vertex_count: record.vertex_count,
        topology: record.topology,
        index_offset: record.index_offset,
        index_format: record.index_format,
        position_offset: record.position_offset,
        position_stride: record.position_stride,
        position_format: record.position_format,
        normal_offset: record.normal_offset,
        normal_stride: record.normal_stride,
        normal_format: record.normal_format,
        color_offset: record.color_offset,
        color_stride: record.color_stride,
        color_format: record.color_format,
        first_placement,
        spare_0: 0,
        spare_1: 0,
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

const fn flag(is_set: bool, bit: u32) -> u32 {
    if is_set { bit } else { 0 }
}

/// The flags of a draw that shows no particles.
const fn draw_flags(draw: &Draw) -> u32 {
    flag(draw.double_sided, DOUBLE_SIDED)
        | flag(draw.mirrored, MIRRORED)
        | flag(draw.is_uneven, UNEVEN)
        | flag(draw.is_faceted, FACETED)
        | flag(draw.is_glass, GLASS)
        | (draw.primitive as u32) << PRIMITIVE_SHIFT
}

impl DrawRecord {
    /// The record of a draw whose attributes lie as `attributes` says.
    pub fn new(draw: &Draw, scene: &Scene, attributes: &AttributeLayout) -> Self {
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
            flags: draw_flags(draw) | flag(scene.particle_discs == Some(draw.primitive), PARTICLES),
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
            point_radius_px: draw.point_radius_px,
            first_point: 0,
            first_block: 0,
        }
    }
}

impl DrawRecord {
    /// The same with positions in steps of a box, which begin `first` bytes into the attributes.
    pub fn packed(self, packed: &PackedBox, first: u32) -> Self {
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
