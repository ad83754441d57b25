//! What bends meshes for the hardware baseline.

use std::sync::Arc;

use crate::{
    device::{Gpu, error::RenderError, pipeline_store::Pipeline, timer::Timer},
    layout::{BufferId, dispatch::fold_groups},
    passes::recording::Resources,
    resources::{buffers::Buffers, pipelines::Pipelines},
    scene_data::deforms::Deforms,
    shader::{key::KernelKey, library::Library, pass::Pass},
};

/// The kernel that bends meshes, which our own frames run too.
pub struct DeformPass {
    pipeline: Arc<Pipeline>,
    group: wgpu::BindGroup,
    groups: [u32; 2],
}

impl DeformPass {
    pub async fn new(
        gpu: &Gpu,
        key: &KernelKey,
        buffers: &mut Buffers,
        deforms: &Deforms,
        deformable: u32,
    ) -> Result<Self, RenderError> {
        buffers
            .fill(
                gpu,
                BufferId::Deforms,
                bytemuck::cast_slice(&deforms.records),
            )
            .await?;
        buffers
            .fill(gpu, BufferId::Joints, bytemuck::cast_slice(&deforms.joints))
            .await?;
        buffers
            .fill(
                gpu,
                BufferId::MorphTargets,
                bytemuck::cast_slice(&deforms.morph_targets),
            )
            .await?;
        let pipeline = Pipelines::new(Library::of_process())
            .get(gpu, key, Pass::Skin)
            .await?;
        let group = Resources {
            buffers: vec![buffers],
            textures: Vec::new(),
            light: None,
            stand_ins: Vec::new(),
        }
        .bind_group(gpu, &pipeline)?;
        Ok(Self {
            pipeline,
            group,
            groups: fold_groups(deformable.div_ceil(key.work.group_size)),
        })
    }

    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&mut Timer>) {
        let label = &self.pipeline.label;
        let timestamp_writes = timer.and_then(|timer| timer.compute(label, false));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes,
        });
        pass.set_pipeline(&self.pipeline.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        let [x, y] = self.groups;
        pass.dispatch_workgroups(x, y, 1);
    }
}
