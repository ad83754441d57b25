//! Mirrors of the WGSL structs that are filled from Rust: same members, same order, compared by naga in `tests/house/layout.rs`.

use glam::DMat3;

use super::{
    deforms::{DEFORMED_BYTES, deformed_offset},
    packing::PackedBox,
};
use crate::{
    frame::{Counters, CullingStats, OrderStats},
    math::{rounded_columns, srgb_byte},
    scene::{Accessor, Scene, draw::Draw, view::View},
};

/// Name and byte offset of every member, for the layout test.
pub trait GpuRecord {
    /// Name of the WGSL struct.
    const WGSL: &'static str;
    const MEMBERS: &'static [(&'static str, usize)];
}

macro_rules! gpu_record {
    ($(#[$meta:meta])* pub struct $name:ident = $wgsl:literal { $(pub $member:ident : $ty:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct $name { $(pub $member: $ty,)* }

        impl GpuRecord for $name {
            const WGSL: &'static str = $wgsl;
            const MEMBERS: &'static [(&'static str, usize)] = &[$((stringify!($member), std::mem::offset_of!($name, $member))),*];
        }
    };
}

pub(super) use gpu_record;

gpu_record! {
    /// One picture: size, viewpoint, capacities. Each member is explained in `shaders/common/frame.wgsl`.
    pub struct FrameUniform = "Frame" {
        pub background: [f32; 4],
        pub eye: [f32; 4],
        pub forward: [f32; 4],
        pub ndc_x: [f32; 4],
        pub ndc_y: [f32; 4],
        pub clip_from_world: [[f32; 4]; 4],
        pub picture_from_world: [[f32; 4]; 4],
        pub center: [f32; 2],
        pub depth_range_m: [f32; 2],
        pub linear_depth_m: [f32; 2],
        pub size: [u32; 2],
        pub stride: u32,
        pub vertex_count: u32,
        pub triangle_count: u32,
        pub draw_count: u32,
        pub clip_capacity: u32,
        pub clipped_triangle_capacity: u32,
        pub medium_capacity: u32,
        pub large_capacity: u32,
        pub tile_capacity: u32,
        pub bin_capacity: u32,
        pub medium_first: u32,
        pub large_first: u32,
        pub tile_first: u32,
        pub point_radius: u32,
        pub first_rank: u32,
        pub deform_count: u32,
    }
}

gpu_record! {
    /// One draw. Each member is explained in `shaders/common/draws.wgsl`.
    pub struct DrawRecord = "Draw" {
        pub clip_from_object: [[f32; 4]; 4],
        pub world_from_object: [[f32; 4]; 4],
        pub normal_from_object: [[f32; 4]; 4],
        pub base_color: [f32; 4],
        pub origin: [f32; 4],
        pub step: [f32; 4],
        pub first_vertex: u32,
        pub vertex_count: u32,
        pub first_triangle: u32,
        pub flags: u32,
        pub topology: u32,
        pub index_offset: u32,
        pub index_format: u32,
        pub position_offset: u32,
        pub position_stride: u32,
        pub position_format: u32,
        pub normal_offset: u32,
        pub normal_stride: u32,
        pub normal_format: u32,
        pub color_offset: u32,
        pub color_stride: u32,
        pub color_format: u32,
    }
}

gpu_record! {
    /// Demand of the queues and what was not drawn. Each member is explained in `shaders/common/counters.wgsl`.
    pub struct CounterRecord = "Counters" {
        pub clip: u32,
        pub medium: u32,
        pub large: u32,
        pub tiles: u32,
        pub pieces: u32,
        pub rejected_nonfinite: u32,
        pub rejected_range: u32,
        pub degenerate: u32,
        pub flipped_clips: u32,
        pub depth_without_id: u32,
        pub marked_tiles: u32,
        pub next_sample_index: u32,
        pub next_sample_index_again: u32,
        pub bins: u32,
        pub full_pixels: u32,
        pub dropped: u32,
        pub visible_meshlets: u32,
        pub outside: u32,
        pub backfacing: u32,
        pub hidden: u32,
        pub visible_meshlets_done: u32,
        pub clip_done: u32,
        pub medium_done: u32,
        pub large_done: u32,
        pub tiles_done: u32,
        pub longest_list: u32,
        pub spare_0: u32,
        pub spare_1: u32,
    }
}

gpu_record! {
    /// Where the drawing stops. Each member is explained in `shaders/common/order.wgsl`.
    pub struct OrderRecord = "Order" {
        pub straddler: u32,
        pub cut: u32,
        pub limit_hi: u32,
        pub limit_lo: u32,
        pub total_hi: u32,
        pub total_lo: u32,
        pub before_hi: u32,
        pub before_lo: u32,
        pub drawn_hi: u32,
        pub drawn_lo: u32,
        pub spare_0: u32,
        pub spare_1: u32,
    }
}

impl OrderRecord {
    /// As the rest of the program says it; `tickets` tells how many samples asked where the hardware chose.
    pub fn stats(&self, is_chosen: bool, next_sample_index: u32) -> OrderStats {
        let wide = |hi: u32, lo: u32| u64::from(hi) << 32 | u64::from(lo);
        let limit = wide(self.limit_hi, self.limit_lo);
        let drawn = if is_chosen { limit.min(next_sample_index.into()) } else { wide(self.drawn_hi, self.drawn_lo) };
        OrderStats { drawn, limit, covered: wide(self.total_hi, self.total_lo), is_chosen }
    }
}

gpu_record! {
    /// What is shown of a picture that is drawn at another size. Each member is explained in `shaders/passes/scale.wgsl`.
    pub struct ScalingUniform = "Scaling" {
        pub size: [u32; 2],
        pub stride: u32,
        pub spare: u32,
    }
}

gpu_record! {
    /// What takes places to the shadow map. Each member is explained in `shaders/slots/light/mapped.wgsl`.
    pub struct LightUniform = "Light" {
        pub column: [f32; 4],
        pub row: [f32; 4],
        pub depth: [f32; 4],
        pub texel_m: f32,
        pub depth_range_m: f32,
        pub side: u32,
        pub spare: u32,
    }
}

impl LightUniform {
    /// Of a light's view.
    pub fn new(view: &View) -> Self {
        let half = f64::from(view.width) * 0.5;
        let row = |i: usize| view.clip_from_world.row(i);
        let rounded = |row: glam::DVec4| row.to_array().map(|v| v as f32);
        // Half a picture is one unit of normalized device coordinates, whose y points up.
        let [column, down, depth] = [(row(0) + row(3)) * half, (row(3) - row(1)) * half, row(2)];
        Self {
            column: rounded(column),
            row: rounded(down),
            depth: rounded(depth),
            texel_m: (1.0 / column.truncate().length()) as f32,
            depth_range_m: (1.0 / depth.truncate().length()) as f32,
            side: view.width,
            spare: 0,
        }
    }
}

/// Entries that fit each queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacities {
    pub clip: u32,
    pub pieces: u32,
    pub medium: u32,
    pub large: u32,
    pub tiles: u32,
    /// Entries on the lists of all tiles of a picture that is drawn tile by tile.
    pub bins: u32,
    /// Entries of the longest such list that are walked: as many dispatches as that takes, at least one.
    pub listed: u32,
}

impl Capacities {
    /// Words of the queue buffer: clip, medium and large one word an entry, tiles two.
    pub fn queue_words(&self) -> u64 {
        u64::from(self.clip) + u64::from(self.medium) + u64::from(self.large) + 2 * u64::from(self.tiles)
    }

    /// Room for an entry everywhere: no binding may be empty.
    pub fn at_least_one(self) -> Self {
        let Self { clip, pieces, medium, large, tiles, bins, listed } = self;
        let [clip, pieces, medium, large, tiles, bins] = [clip, pieces, medium, large, tiles, bins].map(|capacity| capacity.max(1));
        Self { clip, pieces, medium, large, tiles, bins, listed }
    }

    /// Grows whatever the demand exceeded, by powers of two, the lists of tiles by a quarter; true if anything grew.
    pub fn grow(&mut self, demand: &CounterRecord) -> bool {
        let pairs = [
            (&mut self.clip, demand.clip),
            (&mut self.pieces, demand.pieces),
            (&mut self.medium, demand.medium),
            (&mut self.large, demand.large),
            (&mut self.tiles, demand.tiles),
            (&mut self.listed, demand.longest_list),
        ];
        let mut grew = false;
        for (capacity, demand) in pairs {
            if demand > *capacity {
                *capacity = demand.checked_next_power_of_two().unwrap_or(u32::MAX);
                grew = true;
            }
        }
        if demand.bins > self.bins {
            self.bins = demand.bins.saturating_add(demand.bins / 4);
            grew = true;
        }
        grew
    }
}

/// Pixels from one row of the colour buffer to the next: rows begin at multiples of 256 bytes, as texture copies demand.
pub fn color_stride(width: u32) -> u32 {
    width.next_multiple_of(64)
}

impl FrameUniform {
    pub fn new(view: &View, scene: &Scene, draw_count: usize, capacities: &Capacities) -> Self {
        let is_perspective = view.linear_depth_m.is_none();
        let [r, g, b, alpha] = view.background;
        let encoded = [r, g, b].map(|c| f32::from(srgb_byte(f64::from(c))) / 255.0);
        let wide = |v: glam::DVec3, w: f32| [v.x as f32, v.y as f32, v.z as f32, w];
        Self {
            background: [encoded[0], encoded[1], encoded[2], alpha],
            eye: wide(view.eye, f32::from(u8::from(is_perspective))),
            forward: wide(view.forward, 0.0),
            ndc_x: wide(view.ndc_axes[0], 0.0),
            ndc_y: wide(view.ndc_axes[1], 0.0),
            clip_from_world: rounded_columns(&view.clip_from_world),
            picture_from_world: rounded_columns(&view.picture_from_world.unwrap_or(view.clip_from_world)),
            center: [view.width, view.height].map(|pixels| (pixels as i32 * view.units_per_pixel() / 2) as f32),
            depth_range_m: view.scene_range_m.map(|d| d as f32),
            linear_depth_m: view.linear_depth_m.unwrap_or_default().map(|d| d as f32),
            size: [view.width, view.height],
            stride: color_stride(view.width),
            vertex_count: scene.vertex_count() as u32,
            triangle_count: scene.triangle_count() as u32,
            draw_count: draw_count as u32,
            clip_capacity: capacities.clip,
            clipped_triangle_capacity: capacities.pieces,
            medium_capacity: capacities.medium,
            large_capacity: capacities.large,
            tile_capacity: capacities.tiles,
            bin_capacity: capacities.bins,
            medium_first: capacities.clip,
            large_first: capacities.clip + capacities.medium,
            tile_first: capacities.clip + capacities.medium + capacities.large,
            point_radius: 0,
            first_rank: 0,
            deform_count: 0,
        }
    }
}

/// Component type in bits 0 to 2, normalized in bit 3 (`shaders/common/pull.wgsl`), lanes from bit 8.
pub fn format_word(accessor: &Accessor) -> u32 {
    (accessor.component_type as u32 - 5120) | u32::from(accessor.normalized) << 3 | accessor.components << 8
}

impl DrawRecord {
    pub fn new(draw: &Draw, scene: &Scene) -> Self {
        let [x, y, z] = draw.origin;
        let primitive = &scene.primitives[draw.primitive];
        let material = &scene.materials[primitive.material];
        let color = primitive.colors.as_ref();
        let deformed = |part: usize| {
            let offset = deformed_offset(draw, scene) as usize + 12 * part;
            Accessor { stride: DEFORMED_BYTES, ..Accessor::packed_f32(offset, 3, primitive.vertex_count() as usize) }
        };
        let [positions, normals] =
            if draw.deform.is_some() { [deformed(0), deformed(1)] } else { [primitive.positions, primitive.normals] };
        Self {
            clip_from_object: draw.clip_from_object,
            world_from_object: rounded_columns(&draw.world_from_object),
            normal_from_object: normal_from_object(draw),
            base_color: material.base_color,
            origin: [x, y, z, 0.0],
            step: [0.0; 4],
            first_vertex: draw.first_vertex,
            vertex_count: primitive.vertex_count(),
            first_triangle: draw.first_triangle,
            flags: u32::from(draw.double_sided)
                | u32::from(draw.mirrored) << 1
                | u32::from(scene.particle_discs == Some(draw.primitive)) << 2
                | (draw.primitive as u32) << 8,
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
        }
    }
}

impl DrawRecord {
    /// With its positions in steps of a box, which begin `first` bytes into the attributes.
    pub fn packed(self, packed: &PackedBox, first: u32) -> Self {
        let wide = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        Self { origin: wide(packed.origin), step: wide(packed.step), position_offset: first + 4 * packed.first_word, ..self }
    }
}

/// Cofactors of the placement, in the direction of its inverse transpose, scaled so that the largest entry is 1.
fn normal_from_object(draw: &Draw) -> [[f32; 4]; 4] {
    let m = DMat3::from_mat4(draw.world_from_object);
    let mut cofactors = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    if draw.mirrored {
        cofactors *= -1.0;
    }
    let largest = cofactors.to_cols_array().iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    if largest > 0.0 {
        cofactors *= 1.0 / largest;
    }
    rounded_columns(&glam::DMat4::from_mat3(cofactors))
}

impl CounterRecord {
    /// What culling left and left out.
    pub fn culled(&self) -> CullingStats {
        let Self { visible_meshlets: drawn, outside, backfacing, hidden, .. } = *self;
        CullingStats { drawn, outside, backfacing, hidden }
    }

    /// As the rest of the program counts; `overflow` is demand beyond `capacities`.
    pub fn counters(&self, capacities: &Capacities) -> Counters {
        let beyond = [
            self.clip.saturating_sub(capacities.clip),
            self.pieces.saturating_sub(capacities.pieces),
            self.medium.saturating_sub(capacities.medium),
            self.large.saturating_sub(capacities.large),
            self.tiles.saturating_sub(capacities.tiles),
            // Both may lose the same entries.
            self.bins.saturating_sub(capacities.bins).max(self.longest_list.saturating_sub(capacities.listed)),
        ];
        Counters {
            rejected_nonfinite: self.rejected_nonfinite,
            rejected_range: self.rejected_range,
            degenerate: self.degenerate,
            clipped: self.clip,
            flipped_clips: self.flipped_clips,
            overflow: beyond.iter().fold(0, |sum: u32, b| sum.saturating_add(*b)),
            depth_without_id: self.depth_without_id,
            full_pixels: self.full_pixels,
            dropped: self.dropped,
        }
    }
}
