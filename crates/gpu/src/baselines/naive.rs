//! The naive baseline: the beginner's compute rasterizer that many start from, kept as a yardstick
//! with its defects.

use std::sync::Arc;

use crate::{
    device::{Gpu, error::RenderError, pipeline_store::Pipeline, timer::Timer},
    layout::{BufferId, dispatch::fold_groups, frame_layout::color_stride, records::NaiveUniform},
    math::rounded_columns,
    passes::recording::Resources,
    resources::{
        buffers::{self, Buffers},
        pipelines::Pipelines,
    },
    scene::{Scene, draw::draws, view::View},
    shader::{key::KernelKey, library::Library},
};
use glam::DMat4;

/// Whether the picture lies where the others' do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewport {
    /// As its author wrote it: one quadrant of clip space fills the picture.
    AsWritten,
    /// The missing half is folded into the matrix, so that holes can be counted pixel by pixel.
    Folded,
}

/// The exhibit, set up for one scene and view.
pub struct Naive {
    size: [u32; 2],
    buffers: Buffers,
    passes: Vec<(Arc<Pipeline>, wgpu::BindGroup, [u32; 2])>,
}

impl Naive {
    /// De-indexes the whole scene into world space, as the original does with its one mesh.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        view: &View,
        key: &KernelKey,
        viewport: Viewport,
    ) -> Result<Self, RenderError> {
        let corners = world_corners(scene, view)?;
        let half = match viewport {
            Viewport::AsWritten => DMat4::IDENTITY,
            // x' = (x + w) / 2 and y' = (w - y) / 2, so that x'/w runs from 0 to 1, downwards.
            Viewport::Folded => DMat4::from_cols_array(&[
                0.5, 0., 0., 0., 0., -0.5, 0., 0., 0., 0., 1., 0., 0.5, 0.5, 0., 1.,
            ]),
        };
        let uniform = NaiveUniform {
            clip_from_object: rounded_columns(&(half * view.clip_from_world)),
            size: [view.width, view.height],
            corner_count: (corners.len() / 3) as u32,
            stride: color_stride(view.width),
        };
        let pixels = view.pixels() as u64;
        let mut buffers = Buffers::default();
        buffers
            .fill(gpu, BufferId::NaiveFrame, bytemuck::bytes_of(&uniform))
            .await?;
        buffers
            .fill(gpu, BufferId::Corners, bytemuck::cast_slice(&corners))
            .await?;
        buffers.ensure(gpu, BufferId::Channels, 12 * pixels).await?;
        buffers
            .ensure(
                gpu,
                BufferId::Color,
                4 * u64::from(uniform.stride) * u64::from(view.height),
            )
            .await?;
        let mut pipelines = Pipelines::new(Library::of_process());
        let mut build = async |entry: &str, groups: [u32; 2]| {
            let pipeline = pipelines
                .build(gpu, "baselines/naive", entry, entry, key, &[], &[])
                .await?;
            let resources = Resources {
                buffers: vec![&buffers],
                textures: Vec::new(),
                light: None,
                stand_ins: Vec::new(),
            };
            let group = resources.bind_group(gpu, &pipeline)?;
            Ok::<_, RenderError>((pipeline, group, groups))
        };
        let passes = vec![
            build(
                "naive_clear",
                fold_groups((3 * view.width * view.height).div_ceil(256)),
            )
            .await?,
            build(
                "naive_raster",
                fold_groups((uniform.corner_count / 3).div_ceil(256)),
            )
            .await?,
            build(
                "naive_resolve",
                [view.width.div_ceil(8), view.height.div_ceil(8)],
            )
            .await?,
        ];
        Ok(Self {
            size: uniform.size,
            buffers,
            passes,
        })
    }

    /// Records one frame.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, mut timer: Option<&mut Timer>) {
        for (i, (pipeline, group, [x, y])) in self.passes.iter().enumerate() {
            let is_last = i + 1 == self.passes.len();
            let timestamp_writes = timer
                .as_mut()
                .and_then(|timer| timer.compute(&pipeline.label, is_last));
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(&pipeline.label),
                timestamp_writes,
            });
            pass.set_pipeline(&pipeline.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(*x, *y, 1);
        }
    }

    /// Draws once and reads the picture back, row-major; alpha is 0 where nothing was drawn.
    pub async fn picture(&self, gpu: &Gpu) -> Result<Vec<[u8; 4]>, RenderError> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.record(&mut encoder, None);
        gpu.queue.submit([encoder.finish()]);
        buffers::read_picture(gpu, self.buffers.get(BufferId::Color)?, self.size).await
    }
}

fn world_corners(scene: &Scene, view: &View) -> Result<Vec<f32>, RenderError> {
    let mut corners = Vec::new();
    for draw in draws(scene, view)? {
        let primitive = &scene.primitives[draw.primitive];
        for triangle in 0..primitive.triangle_count() {
            for vertex in primitive.corners(scene, triangle) {
                let position = match &draw.deform {
                    Some(deform) => deform.position(scene, primitive, vertex),
                    None => glam::Vec3::from(primitive.position(scene, vertex)).as_dvec3(),
                };
                corners.extend(
                    draw.world_from_object
                        .transform_point3(position)
                        .as_vec3()
                        .to_array(),
                );
            }
        }
    }
    Ok(corners)
}
