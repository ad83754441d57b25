//! Recording: the passes of a view with their pipelines, bindings and dispatch sizes, recorded one
//! after another. What does not change from frame to frame is kept in a [`CommandList`].

use std::{ops::Range, sync::Arc};

use crate::{
    device::{
        Gpu,
        error::RenderError,
        pipeline_store::{Pipeline, PipelineStore},
        preparations::Preparation,
        timer::Timer,
    },
    layout::{
        BufferId, ResourceId, TextureId,
        dispatch::Dispatch,
        frame_layout::{FrameLayout, IMAGE_BUFFERS},
        records::CounterRecord,
    },
    plan::Tuning,
    resources::{
        buffers::{BufferNote, Buffers, next_revision},
        pipelines::Pipelines,
        textures::WordTexture,
    },
    scene_data::scene_resources::SceneResources,
    shader::{key::KernelKey, pass::Pass},
};

/// What all scenes and views share.
pub struct Device {
    pub gpu: Arc<Gpu>,
    pub pipelines: Pipelines,
    /// None where the adapter has no timestamps.
    pub timer: Option<Timer>,
    pub tuning: Tuning,
}

/// Where passes find what they bind: the first of these that has it.
#[derive(Clone, Default)]
pub struct Resources<'a> {
    pub buffers: Vec<&'a Buffers>,
    pub textures: Vec<(TextureId, &'a WordTexture)>,
    /// The buffers of a light, whose depth keys are the shadow map.
    pub light: Option<&'a Buffers>,
    /// Buffers that stand in for others: what a kernel calls the first is the second.
    pub stand_ins: Vec<(BufferId, BufferId)>,
}

impl<'a> Resources<'a> {
    fn get(&self, id: ResourceId) -> Result<wgpu::BindingResource<'a>, RenderError> {
        let found = match id {
            ResourceId::Buffer(BufferId::ShadowMapKeys) => self.light.map(|light| {
                light
                    .get(BufferId::DepthKeys)
                    .map(wgpu::Buffer::as_entire_binding)
            }),
            ResourceId::Buffer(id) => {
                let stand_in = self.stand_ins.iter().find(|(name, _)| *name == id);
                let id = stand_in.map_or(id, |(_, held)| *held);
                self.buffers
                    .iter()
                    .find(|buffers| buffers.has(id))
                    .map(|buffers| buffers.get(id).map(wgpu::Buffer::as_entire_binding))
            }
            ResourceId::Texture(id) => {
                let texture = self.textures.iter().find(|(other, _)| *other == id);
                texture.map(|(_, texture)| Ok(wgpu::BindingResource::TextureView(&texture.view)))
            }
        };
        found.unwrap_or(Err(RenderError::NoResource { name: id.name() }))
    }

    /// What every view of a scene shares.
    pub fn of_scene(scene: &'a SceneResources) -> Self {
        let atlas = scene
            .material_atlas
            .iter()
            .map(|atlas| (TextureId::MaterialAtlas, atlas));
        let files = scene.image_files.iter();
        let files = files.map(|files| (TextureId::ImageFiles, &files.texture));
        Self {
            buffers: vec![&scene.buffers],
            textures: atlas.chain(files).collect(),
            light: None,
            stand_ins: Vec::new(),
        }
    }

    /// The same, with `first` before all others.
    pub fn with<'b>(&self, first: &'b Buffers) -> Resources<'b>
    where
        'a: 'b,
    {
        let buffers = std::iter::once(first)
            .chain(self.buffers.iter().copied())
            .collect();
        Resources {
            buffers,
            textures: self.textures.clone(),
            light: self.light,
            stand_ins: Vec::new(),
        }
    }

    /// The same for one pass: the pictures that image passes read and write change places from
    /// pass to pass, and what is scaled is what the last of them wrote.
    fn of_pass(&self, key: &KernelKey, pass: Pass) -> Self {
        let stand_ins = match (pass, key.image_step(pass)) {
            (Pass::ImageBegin, _) => vec![(BufferId::ImageTarget, IMAGE_BUFFERS[0])],
            (_, Some(step)) => {
                let target = step.target.map(|slot| (BufferId::ImageTarget, slot));
                let read = [
                    (BufferId::ImageSource, step.source),
                    (BufferId::ImageBefore, step.last),
                ];
                let all = read.into_iter().chain(target);
                all.map(|(name, slot)| (name, IMAGE_BUFFERS[slot]))
                    .collect()
            }
            (Pass::Scale, None) if key.has_passes() => {
                vec![(BufferId::Color, BufferId::Finished)]
            }
            _ => Vec::new(),
        };
        Self {
            stand_ins,
            ..self.clone()
        }
    }

    /// Every buffer and texture, for `explain`.
    pub fn notes(&self) -> Vec<BufferNote> {
        let texture = |(id, texture): &(TextureId, &WordTexture)| BufferNote {
            name: id.name().into(),
            bytes: texture.bytes(),
            why: id.purpose().into(),
        };
        self.buffers
            .iter()
            .flat_map(|buffers| buffers.notes())
            .chain(self.textures.iter().map(texture))
            .collect()
    }

    /// A bind group for a pipeline.
    pub fn bind_group(
        &self,
        gpu: &Gpu,
        pipeline: &Pipeline,
    ) -> Result<wgpu::BindGroup, RenderError> {
        let entry = |&(binding, id): &(u32, ResourceId)| {
            Ok(wgpu::BindGroupEntry {
                binding,
                resource: self.get(id)?,
            })
        };
        let entries: Vec<_> = pipeline
            .bindings
            .iter()
            .map(entry)
            .collect::<Result<_, RenderError>>()?;
        let descriptor = wgpu::BindGroupDescriptor {
            label: Some(&pipeline.label),
            layout: &pipeline.layout,
            entries: &entries,
        };
        gpu.prepared.count(Preparation::BindGroup);
        Ok(gpu.device.create_bind_group(&descriptor))
    }

    fn revisions(&self) -> Vec<u64> {
        let buffers = self
            .buffers
            .iter()
            .copied()
            .chain(self.light)
            .map(|buffers| buffers.revision());
        buffers
            .chain(self.textures.iter().map(|(_, texture)| texture.revision))
            .collect()
    }
}

/// A pass, ready to be recorded.
struct Command {
    pass: Pass,
    label: String,
    pipeline: Arc<Pipeline>,
    group: wgpu::BindGroup,
}

impl Command {
    fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        dispatch: Dispatch,
        buffers: &Buffers,
    ) -> Result<(), RenderError> {
        pass.set_pipeline(&self.pipeline.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        match dispatch {
            Dispatch::Direct { groups: [x, y] } => pass.dispatch_workgroups(x, y, 1),
            Dispatch::Indirect { buffer, offset } => {
                pass.dispatch_workgroups_indirect(buffers.get(buffer)?, offset)
            }
        }
        Ok(())
    }
}

/// Passes with their pipelines and bind groups, for as long as neither the key nor a resource
/// changes.
pub struct CommandList {
    key: KernelKey,
    passes: Vec<Pass>,
    revisions: Vec<u64>,
    commands: Vec<Command>,
    /// No two lists have the same.
    pub revision: u64,
}

/// How the passes of a list are timed.
pub struct Timing<'a> {
    pub timer: Option<&'a mut Timer>,
    /// The frame ends with the last pass.
    pub ends_frame: bool,
}

/// How many workgroups the passes of a frame take.
pub struct DispatchSizes<'a> {
    pub layout: &'a FrameLayout,
    /// What the queues of the newest finished picture held, where one is known.
    pub demand: Option<&'a CounterRecord>,
    /// Holds the sizes of indirect dispatches.
    pub buffers: &'a Buffers,
}

impl DispatchSizes<'_> {
    fn of(&self, key: &KernelKey, pass: Pass) -> Dispatch {
        self.layout.dispatch(key, pass, self.demand)
    }
}

impl CommandList {
    /// Compiles pipelines that are missing, and binds what each pass reads and writes. `prefix`
    /// begins the label of every pass.
    pub async fn new(
        device: &mut Device,
        key: &KernelKey,
        passes: Vec<Pass>,
        prefix: &str,
        resources: &Resources<'_>,
    ) -> Result<Self, RenderError> {
        let Device { gpu, pipelines, .. } = device;
        pipelines.prepare(gpu, key, &passes).await?;
        let mut commands = Vec::with_capacity(passes.len());
        for &pass in &passes {
            let pipeline = pipelines.get(gpu, key, pass).await?;
            let group = resources.of_pass(key, pass).bind_group(gpu, &pipeline)?;
            commands.push(Command {
                pass,
                label: format!("{prefix}{}", key.label_of(pass)),
                pipeline,
                group,
            });
        }
        Ok(Self {
            key: key.clone(),
            passes,
            revisions: resources.revisions(),
            commands,
            revision: next_revision(),
        })
    }

    /// Is it still the list for these passes and resources?
    pub fn is_for(&self, key: &KernelKey, passes: &[Pass], resources: &Resources<'_>) -> bool {
        self.revisions == resources.revisions() && self.passes == passes && self.key == *key
    }

    /// Number of its passes.
    pub fn len(&self) -> usize {
        self.commands.len()
    }

    /// Notes that its pipelines are in use.
    pub fn mark(&self, store: &PipelineStore) {
        self.commands
            .iter()
            .for_each(|command| store.mark(&command.pipeline));
    }

    /// Records a part of the list. `sizes` says how many workgroups each takes.
    pub fn record(
        &self,
        part: Range<usize>,
        encoder: &mut wgpu::CommandEncoder,
        sizes: &DispatchSizes<'_>,
        mut timing: Timing<'_>,
    ) -> Result<(), RenderError> {
        if timing.timer.as_ref().is_none_or(|timer| timer.is_whole()) {
            return self.record_in_one(part, encoder, sizes, timing);
        }
        let last = part.end;
        for (i, command) in part.clone().zip(&self.commands[part]) {
            let is_last = timing.ends_frame && i + 1 == last;
            let label = Some(command.label.as_str());
            let timestamp_writes = timing
                .timer
                .as_mut()
                .and_then(|timer| timer.compute(&command.label, is_last));
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label,
                timestamp_writes,
            });
            command.dispatch(&mut pass, sizes.of(&self.key, command.pass), sizes.buffers)?;
        }
        Ok(())
    }

    /// The same as a single compute pass of wgpu, which costs less; its dispatches cannot be timed
    /// one by one.
    fn record_in_one(
        &self,
        part: Range<usize>,
        encoder: &mut wgpu::CommandEncoder,
        sizes: &DispatchSizes<'_>,
        mut timing: Timing<'_>,
    ) -> Result<(), RenderError> {
        if part.is_empty() {
            return Ok(());
        }
        let timestamp_writes = timing
            .timer
            .as_mut()
            .and_then(|timer| timer.compute("passes", timing.ends_frame));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("passes"),
            timestamp_writes,
        });
        for command in &self.commands[part] {
            pass.push_debug_group(&command.label);
            command.dispatch(&mut pass, sizes.of(&self.key, command.pass), sizes.buffers)?;
            pass.pop_debug_group();
        }
        Ok(())
    }
}
