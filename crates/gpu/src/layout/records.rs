//! Every struct that Rust and the kernels share, with the same members in the same order on both
//! sides. `tests/house/layout.rs` compares all of [`RECORDS`] with what naga reads from the
//! shaders: names, offsets, types and sizes. What a member means is explained beside the WGSL
//! struct of the name in quotes.

use super::gpu_record::{GpuRecord, RecordLayout, WgslType, gpu_record};
use crate::{
    effects::particles::Particles,
    frame::{ClippedTriangle, OrderStats, SnappedVertex},
    scene::punctual::{MAX_LIGHTS, PlacedLight},
};

gpu_record! {
    /// One picture: size, viewpoint, capacities. Each member is explained in `shaders/lib/frame.wgsl`.
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
        pub medium_first: u32,
        pub large_first: u32,
        pub tile_first: u32,
        pub point_radius: u32,
        pub first_rank: u32,
        pub deform_count: u32,
        pub background_first: u32,
        pub point_count: u32,
        pub first_box: u32,
        pub spare_0: u32,
        pub spare_1: u32,
    }
}

gpu_record! {
    /// One draw. Each member is explained in `shaders/lib/triangle.wgsl`.
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
        pub scopes: u32,
        pub point_radius_px: f32,
        pub first_point: u32,
        pub first_block: u32,
    }
}

gpu_record! {
    /// One draw of an instanced scene. Each member is explained in `shaders/lib/triangle.wgsl`.
    pub struct InstancedDrawRecord = "InstancedDraw" {
        pub clip_from_object: [[f32; 4]; 4],
        pub first_vertex: u32,
        pub first_triangle: u32,
        pub flags: u32,
        pub scopes: u32,
    }
}

gpu_record! {
    /// What all instances of a primitive share. Each member is explained in `shaders/lib/triangle.wgsl`.
    pub struct DrawShapeRecord = "DrawShape" {
        pub base_color: [f32; 4],
        pub origin: [f32; 4],
        pub step: [f32; 4],
        pub vertex_count: u32,
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
        pub first_placement: u32,
        pub spare_0: u32,
        pub spare_1: u32,
    }
}

gpu_record! {
    /// Demand of the queues and what was not drawn. Each member is explained in `shaders/lib/frame.wgsl`.
    pub struct CounterRecord = "Counters" {
        pub clip: u32,
        pub medium: u32,
        pub large: u32,
        pub tiles: u32,
        pub clipped_triangles: u32,
        pub rejected_nonfinite: u32,
        pub rejected_range: u32,
        pub degenerate: u32,
        pub flipped_clips: u32,
        pub depth_without_id: u32,
        pub marked_tiles: u32,
        pub next_sample_index: u32,
        pub next_sample_index_again: u32,
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
        pub listed_dots: u32,
        pub background_tiles: u32,
        pub spare_0: u32,
        pub spare_1: u32,
    }
}

gpu_record! {
    /// Where the drawing stops. Each member is explained in `shaders/lib/order.wgsl`.
    pub struct OrderRecord = "Order" {
        pub boundary_triangle: u32,
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

gpu_record! {
    /// What is shown of a picture that is drawn at another size. Each member is explained in `shaders/stages/shade/scale.wgsl`.
    pub struct ScalingUniform = "Scaling" {
        pub size: [u32; 2],
        pub stride: u32,
        pub spare: u32,
    }
}

gpu_record! {
    /// One light that comes with the scene. Each member is explained in `shaders/lib/punctual.wgsl`.
    pub struct PunctualLightRecord = "PunctualLight" {
        pub light: [f32; 4],
        pub position: [f32; 4],
        pub toward: [f32; 4],
        pub cone: [f32; 2],
        pub spare: [f32; 2],
    }
}

/// All lights of a picture.
pub type PunctualLights = [PunctualLightRecord; MAX_LIGHTS];

/// The records of the first [`MAX_LIGHTS`] lights; zeros behind them.
pub fn punctual_lights(lights: &[PlacedLight]) -> PunctualLights {
    let with = |[x, y, z]: [f32; 3], w| [x, y, z, w];
    let mut records = PunctualLights::default();
    for (record, light) in records.iter_mut().zip(lights) {
        *record = PunctualLightRecord {
            light: with(light.light, f32::from(u8::from(light.has_position))),
            position: with(light.position, light.inverse_range),
            toward: with(light.toward, 0.0),
            cone: light.cone,
            spare: [0.0; 2],
        };
    }
    records
}

gpu_record! {
    /// One material of the hardware baseline. Each member is explained in `shaders/baselines/hardware.wgsl`.
    pub struct HardwareMaterial = "HardwareMaterial" {
        pub base_u: [f32; 4],
        pub base_v: [f32; 4],
        pub emission_u: [f32; 4],
        pub emission_v: [f32; 4],
        pub emission: [f32; 4],
    }
}

gpu_record! {
    /// The transform from positions to the shadow map. Each member is explained in `shaders/variants/shade_step.wgsl`.
    pub struct ShadowMapUniform = "ShadowMapView" {
        pub column: [f32; 4],
        pub row: [f32; 4],
        pub depth: [f32; 4],
        pub texel_m: f32,
        pub range_m: f32,
        pub side: u32,
        pub spare: u32,
    }
}

gpu_record! {
    /// One deformed draw. Each member is explained in `shaders/lib/deform.wgsl`.
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
    /// One morph target of one draw. Each member is explained in `shaders/variants/morph_targets.wgsl`.
    pub struct MorphTargetRecord = "MorphTarget" {
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

gpu_record! {
    /// One meshlet. Each member is explained in `shaders/lib/meshlets.wgsl`.
    pub struct MeshletRecord = "Meshlet" {
        pub center: [f32; 4],
        pub half: [f32; 4],
        pub axis: [f32; 4],
        pub first_triangle: u32,
        pub first_vertex: u32,
        pub triangles: u32,
        pub vertices: u32,
    }
}

gpu_record! {
    /// One draw, for culling. Each member is explained in `shaders/lib/meshlets.wgsl`.
    pub struct InstanceRecord = "Instance" {
        pub eye: [f32; 4],
        pub center: [f32; 4],
        pub half: [f32; 4],
        pub first: u32,
        pub first_meshlet: u32,
        pub flags: u32,
        pub spare: u32,
    }
}

gpu_record! {
    /// The culling uniform. Each member is explained in `shaders/lib/meshlets.wgsl`.
    pub struct CullingUniform = "Culling" {
        pub meshlet_count: u32,
        pub first_visible: u32,
        pub hiz_width: u32,
        pub hiz_first_block: u32,
    }
}

gpu_record! {
    /// The uniform of the passes over dots. Each member is explained in `shaders/lib/dots.wgsl`.
    pub struct DotFrame = "DotFrame" {
        pub clip_from_scene: [[f32; 4]; 4],
        pub ink: [f32; 4],
        pub center: [f32; 2],
        pub dots: u32,
        pub dot_runs: u32,
        pub segments: u32,
        pub fade_from: u32,
        pub fade_rate: u32,
        pub levels: u32,
        pub radius: u32,
        pub bias: u32,
        pub hidden: u32,
        pub model: u32,
        pub first_probed: u32,
        pub zero: u32,
    }
}

gpu_record! {
    /// Consecutive dots of one segment. Each member is explained in `shaders/lib/dots.wgsl`.
    pub struct DotRunRecord = "DotRun" {
        pub segment: u32,
        pub first: u32,
        pub count: u32,
        pub start: f32,
        pub step: f32,
    }
}

gpu_record! {
    /// Which steps to take. Each member is explained in `shaders/lib/particle.wgsl`.
    pub struct ParticleStepUniform = "ParticleStep" {
        pub right: [f32; 4],
        pub up: [f32; 4],
        pub toward: [f32; 4],
        pub count: u32,
        pub first_frame: u32,
        pub last_frame: u32,
        pub steps: u32,
        pub target_word: u32,
        pub is_fresh: u32,
    }
}

gpu_record! {
    /// The parameters of one step. Each member is explained in `shaders/lib/particle.wgsl`.
    pub struct StepParams = "StepParams" {
        pub p: Particles,
        pub life_steps: u32,
        pub life_chance: u32,
        pub step_s: f32,
        pub spare: u32,
    }
}

gpu_record! {
    /// How a texture is looked up. Each member is explained in `shaders/lib/material_atlas.wgsl`.
    pub struct LookupRecord = "Lookup" {
        pub levels: u32,
        pub size: u32,
        pub sampling: u32,
        pub format: u32,
        pub offset: u32,
        pub stride: u32,
        pub u_per_u: f32,
        pub u_per_v: f32,
        pub u_offset: f32,
        pub v_per_u: f32,
        pub v_per_v: f32,
        pub v_offset: f32,
    }
}

gpu_record! {
    /// The material of one primitive. Each member is explained in `shaders/lib/material_atlas.wgsl`.
    pub struct MaterialRecord = "Material" {
        pub flags: u32,
        pub red: f32,
        pub green: f32,
        pub blue: f32,
        pub alpha_threshold: u32,
        pub first_corner: u32,
    }
}

gpu_record! {
    /// How one primitive reflects. Each member is explained in `shaders/lib/finish_atlas.wgsl`.
    pub struct FinishRecord = "FinishRecord" {
        pub red: f32,
        pub green: f32,
        pub blue: f32,
        pub grazing: f32,
        pub metallic: f32,
        pub roughness: f32,
    }
}

gpu_record! {
    /// What passes through one primitive. Each member is explained in `shaders/lib/transmission.wgsl`.
    pub struct TransmissionRecord = "TransmissionRecord" {
        pub red: f32,
        pub green: f32,
        pub blue: f32,
        pub amount: f32,
        pub is_opaque: u32,
    }
}

gpu_record! {
    /// The textures of one primitive that are no colors. Each member is explained in
    /// `shaders/lib/map_atlas.wgsl`.
    pub struct MapsRecord = "Maps" {
        pub flags: u32,
        pub occlusion_strength: f32,
        pub normal_scale: f32,
        pub tangents: u32,
    }
}

gpu_record! {
    /// Workgroups of an indirect dispatch.
    pub struct DispatchSize = "Dispatch" {
        pub x: u32,
        pub y: u32,
        pub z: u32,
    }
}

gpu_record! {
    /// Indirect dispatches of a frame, written on the device.
    pub struct DispatchArgs = "Args" {
        pub clip: DispatchSize,
        pub medium: DispatchSize,
        pub large: DispatchSize,
        pub tiles: DispatchSize,
        pub resolve: DispatchSize,
        pub clipped_triangles: DispatchSize,
        pub meshlets: DispatchSize,
        pub background: DispatchSize,
    }
}

gpu_record! {
    /// A triangle that clipping made.
    pub struct ClippedTriangleRecord = "ClippedTriangle" {
        pub a: [u32; 4],
        pub b: [u32; 4],
        pub c: [u32; 4],
        pub parent: [u32; 4],
    }
}

gpu_record! {
    /// Both ends of a line segment that carries dots.
    pub struct DotPoints = "DotPoints" {
        pub begin: [f32; 4],
        pub end: [f32; 4],
    }
}

gpu_record! {
    /// What the naive baseline is told.
    pub struct NaiveUniform = "Naive" {
        pub clip_from_object: [[f32; 4]; 4],
        pub size: [u32; 2],
        pub corner_count: u32,
        pub stride: u32,
    }
}

impl WgslType for Particles {
    const NAME: &'static str = "Particles";
}

/// Every struct that is shared.
pub const RECORDS: &[RecordLayout] = &[
    FrameUniform::LAYOUT,
    DrawRecord::LAYOUT,
    InstancedDrawRecord::LAYOUT,
    DrawShapeRecord::LAYOUT,
    CounterRecord::LAYOUT,
    OrderRecord::LAYOUT,
    ScalingUniform::LAYOUT,
    ShadowMapUniform::LAYOUT,
    PunctualLightRecord::LAYOUT,
    DeformRecord::LAYOUT,
    MorphTargetRecord::LAYOUT,
    MeshletRecord::LAYOUT,
    InstanceRecord::LAYOUT,
    CullingUniform::LAYOUT,
    DotFrame::LAYOUT,
    DotRunRecord::LAYOUT,
    DotPoints::LAYOUT,
    ParticleStepUniform::LAYOUT,
    StepParams::LAYOUT,
    LookupRecord::LAYOUT,
    MaterialRecord::LAYOUT,
    FinishRecord::LAYOUT,
    TransmissionRecord::LAYOUT,
    MapsRecord::LAYOUT,
    HardwareMaterial::LAYOUT,
    DispatchSize::LAYOUT,
    DispatchArgs::LAYOUT,
    ClippedTriangleRecord::LAYOUT,
    NaiveUniform::LAYOUT,
];

/// A projected vertex or dot as the kernels store it, a `vec4u` of `shaders/lib/triangle.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct VertexRecord {
    /// Column in units of the grid, 24 bits with a sign, above 8 bits of flags.
    pub x_and_flags: u32,
    /// Row in units of the grid, 24 bits with a sign, above 8 bits that are 0.
    pub y: u32,
    pub depth: f32,
    pub inv_w: f32,
}

impl VertexRecord {
    pub fn snapped(self) -> SnappedVertex {
        let Self {
            x_and_flags,
            y,
            depth,
            inv_w,
        } = self;
        SnappedVertex {
            x: x_and_flags as i32 >> 8,
            y: y as i32 >> 8,
            depth,
            inv_w,
            flags: x_and_flags & 255,
        }
    }
}

impl ClippedTriangleRecord {
    /// Id of the triangle that was clipped, and position in the fan that was made of it.
    pub fn fan(&self) -> (u32, u32) {
        let [parent, _, position, _] = self.parent;
        (parent, position)
    }

    pub fn triangle(&self) -> ClippedTriangle {
        let [parent, _, _, outline] = self.parent;
        let corners = [self.a, self.b, self.c]
            .map(|corner| bytemuck::cast::<_, VertexRecord>(corner).snapped());
        ClippedTriangle {
            parent,
            corners,
            outline,
        }
    }
}

/// Depth key and triangle id of a pixel where both are stored side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct DepthAndId {
    /// All bits flipped, so that the smaller id wins among equal depths.
    pub complemented_id: u32,
    pub depth_key: u32,
}

impl OrderRecord {
    /// As statistics; `next_sample_index` is how many samples were numbered where the hardware
    /// chose.
    pub fn stats(&self, is_chosen: bool, next_sample_index: u32) -> OrderStats {
        let wide = |hi: u32, lo: u32| u64::from(hi) << 32 | u64::from(lo);
        let limit = wide(self.limit_hi, self.limit_lo);
        let drawn = if is_chosen {
            limit.min(next_sample_index.into())
        } else {
            wide(self.drawn_hi, self.drawn_lo)
        };
        OrderStats {
            drawn,
            limit,
            covered: wide(self.total_hi, self.total_lo),
            is_scheduler_order: is_chosen,
        }
    }
}
