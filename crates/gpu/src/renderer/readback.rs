//! Readback: what a view drew, from the device to plain data.

use crate::{
    accuracy::{DepthFormat, PositionFormat, Transparency, VertexTransform, XraySums},
    device::{Gpu, error::RenderError},
    effects::hooks::Layers,
    frame::{BitExact, Geometry, GlassHit, GlassLayers, KeptPass, ShadowMap},
    layout::{
        BufferId, ClearedBy,
        frame_layout::Region,
        glass::{LAYER_WORDS, layer_word},
        queues::recorded_capacities,
        records::{ClippedTriangleRecord, CounterRecord, DepthAndId, VertexRecord},
    },
    passes::{
        particles::ParticleSimulation,
        recording::{CommandList, Device, DispatchSizes, Resources, Timing},
        shadow_pass::ShadowPass,
        view_resources::{PreparedFrame, ViewResources},
    },
    resources::buffers,
    scene_data::scene_resources::SceneResources,
    shader::{
        key::{FramebufferLayout, KernelKey},
        pass::RasterPhase,
    },
};

/// Everything that a view is read back from.
pub struct Readback<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a SceneResources,
    pub view: &'a ViewResources,
}

impl Readback<'_> {
    fn frame(&self) -> Result<&PreparedFrame, RenderError> {
        self.view.frame()
    }

    /// Elements of a buffer from the beginning.
    async fn elements<T: bytemuck::Pod>(
        &self,
        id: BufferId,
        count: u64,
    ) -> Result<Vec<T>, RenderError> {
        let bytes = buffers::read(
            self.gpu,
            self.view.buffers.get(id)?,
            count * size_of::<T>() as u64,
        )
        .await?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Elements of a region; none where the frame has no such region.
    async fn region<T: bytemuck::Pod>(&self, region: Region) -> Result<Vec<T>, RenderError> {
        let Some(span) = self.frame()?.layout.region(region) else {
            return Ok(Vec::new());
        };
        let bytes = buffers::read(
            self.gpu,
            self.view.buffers.get(span.buffer)?,
            span.bytes.end,
        )
        .await?;
        Ok(bytemuck::pod_collect_to_vec(
            &bytes[span.bytes.start as usize..],
        ))
    }

    fn pixels(&self) -> Result<u64, RenderError> {
        Ok(self.frame()?.view.pixels() as u64)
    }

    /// Triangle id and depth key of every pixel.
    pub async fn visibility(&self) -> Result<(Vec<u32>, Vec<u32>), RenderError> {
        let key = &self.frame()?.plan.key;
        Ok(match key.framebuffer_layout() {
            FramebufferLayout::Split32 => {
                let complemented: Vec<u32> =
                    self.elements(BufferId::TriangleIds, self.pixels()?).await?;
                (
                    complemented.into_iter().map(|id| !id).collect(),
                    self.region(Region::Nearest).await?,
                )
            }
            FramebufferLayout::Packed32 => self
                .region::<u32>(Region::Nearest)
                .await?
                .into_iter()
                .map(|word| key.unpack(word))
                .unzip(),
            FramebufferLayout::Packed64 => {
                let pairs: Vec<DepthAndId> = self.region(Region::Nearest).await?;
                pairs
                    .into_iter()
                    .map(|pair| (!pair.complemented_id, pair.depth_key))
                    .unzip()
            }
        })
    }

    /// Weights or number of layers per pixel, as the effect in the visibility slot has them; empty
    /// without one.
    pub async fn layer_sums(&self) -> Result<Vec<u32>, RenderError> {
        let key = &self.frame()?.plan.key;
        match key.framebuffer.layers {
            Some(Layers::Xray { .. }) => {
                let words: Vec<u32> = self.region(Region::XraySums).await?;
                Ok(words
                    .chunks_exact(key.sum_words() as usize)
                    .map(|words| xray_weight(key, words))
                    .collect())
            }
            Some(Layers::Overdraw) => self.elements(BufferId::LayerCounts, self.pixels()?).await,
            Some(Layers::Glass | Layers::Race) | None => Ok(Vec::new()),
        }
    }

    /// The layers of glass of every pixel; empty without glass, where bands of pixels were drawn
    /// one after another, of which only the last is left, and where lists are not sorted.
    pub async fn glass(&self) -> Result<GlassLayers, RenderError> {
        let key = &self.frame()?.plan.key;
        let mut lists = GlassLayers::default();
        let is_sorted = key.options.transparency != Transparency::Weighted;
        if key.framebuffer.glass_bands != 1 || !is_sorted {
            return Ok(lists);
        }
        let heads: Vec<u32> = self.region(Region::GlassHeads).await?;
        let opaque: Vec<u32> = self.region(Region::GlassOpaque).await?;
        let nodes: Vec<u32> = self.region(Region::GlassLayers).await?;
        for (head, opaque) in heads.into_iter().zip(opaque) {
            let mut link = head;
            while let Some(layer) = (link as usize)
                .checked_sub(1)
                .filter(|layer| layer_word(*layer, LAYER_WORDS - 1) < nodes.len())
                .filter(|_| lists.layers.len() * LAYER_WORDS < nodes.len())
            {
                lists.layers.push(GlassHit {
                    triangle_id: nodes[layer_word(layer, 1)],
                    depth_key: key.depth_bits(nodes[layer_word(layer, 0)]),
                });
                link = nodes[layer_word(layer, 2)];
            }
            lists.end_pixel(!opaque);
        }
        Ok(lists)
    }

    /// Strength of the strongest dot per pixel; empty without dots.
    pub async fn dot_strengths(&self) -> Result<Vec<u32>, RenderError> {
        self.region(Region::DotStrengths).await
    }

    /// The picture, or what is shown of it: gamma-encoded, row-major.
    pub async fn picture(&self, id: BufferId, size: [u32; 2]) -> Result<Vec<[u8; 4]>, RenderError> {
        buffers::read_picture(self.gpu, self.view.buffers.get(id)?, size).await
    }

    /// What the kept pass of an effect read and wrote, `size` pixels of its own.
    pub async fn kept(&self, size: [u32; 2]) -> Result<KeptPass, RenderError> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        Ok(KeptPass {
            before: self.elements(BufferId::ImageKeptBefore, pixels).await?,
            after: self.elements(BufferId::ImageKept, pixels).await?,
        })
    }

    /// The triangles that clipping made, each with its slot in the buffer; by parent and position
    /// in its fan, since the order of the slots is left to the hardware.
    async fn clipped_triangles(&self) -> Result<Vec<(usize, ClippedTriangleRecord)>, RenderError> {
        let frame = self.frame()?;
        if !frame.plan.key.paths.has_clipping {
            return Ok(Vec::new());
        }
        let counters: Vec<CounterRecord> = self.elements(BufferId::Counters, 1).await?;
        let demand = counters
            .first()
            .map_or(0, |counters| counters.clipped_triangles);
        let room = frame.layout.capacities.clipped_triangles;
        let records: Vec<ClippedTriangleRecord> = self
            .elements(BufferId::ClippedTriangles, demand.min(room).into())
            .await?;
        let mut records: Vec<_> = records.into_iter().enumerate().collect();
        records.sort_by_key(|(_, record)| record.fan());
        Ok(records)
    }

    /// Snapped vertices, clipped triangles and setups of the frame.
    pub async fn geometry(
        &self,
        particles: Option<&ParticleSimulation>,
    ) -> Result<Geometry, RenderError> {
        let frame = self.frame()?;
        let (key, scene) = (&frame.plan.key, self.scene.scene());
        let clipped = self.clipped_triangles().await?;
        let triangles = frame.layout.scene.triangles as usize;
        // By id, then the clipped triangles in their order.
        let setups: Vec<[u32; 4]> = self.region(Region::SampleSetups).await?;
        let per_triangle = key.sample_setups() as usize;
        let entries = (0..triangles).chain(clipped.iter().map(|(slot, _)| triangles + slot));
        let vertices: Vec<VertexRecord> = self.region(Region::VertexRecords).await?;
        let particle_readback = match particles {
            Some(particles) => particles.read(self.gpu, self.scene, key).await?,
            None => None,
        };
        let options = &key.options;
        Ok(Geometry {
            vertices: vertices.into_iter().map(VertexRecord::snapped).collect(),
            sample_setups: entries
                .flat_map(|entry| &setups[entry * per_triangle..][..per_triangle])
                .copied()
                .collect(),
            clipped_triangles: clipped
                .iter()
                .map(|(_, record)| record.triangle())
                .collect(),
            has_unshared_vertices: key.unshares_vertices(),
            subpixel_bits: options.coverage.subpixel_bits(),
            scale: options.render_scale.factor(),
            is_relative: options.position_format == PositionFormat::Relative,
            packed_bits: options.position_format.packed_bits(),
            dots: Vec::new(),
            bit_exact: BitExact {
                vertices: options.vertex_transform == VertexTransform::Strict,
                depth_keys: options.depth == DepthFormat::Integer,
            },
            particle_readback,
            particle_discs: scene.particle_disc_ids(),
            deformed: self.deformed().await?,
            shadow_map: None,
        })
    }

    /// Position and normal of every vertex that the skin pass deformed.
    async fn deformed(&self) -> Result<Vec<[f32; 6]>, RenderError> {
        let ranges = self.view.deformed();
        let (Some(end), attributes) = (
            ranges.last().map(|range| range.end),
            self.scene.attributes(),
        ) else {
            return Ok(Vec::new());
        };
        let bytes = buffers::read(
            self.gpu,
            self.scene.buffers.get(BufferId::VertexBytes)?,
            attributes.deformed_vertex(end),
        )
        .await?;
        let all: Vec<[f32; 6]> =
            bytemuck::pod_collect_to_vec(&bytes[attributes.deformed_vertex(0) as usize..]);
        Ok(ranges
            .iter()
            .flat_map(|range| &all[range.start as usize..range.end as usize])
            .copied()
            .collect())
    }
}

/// The shadow map, and the scene as the light sees it.
pub async fn shadow_map(
    gpu: &Gpu,
    scene: &SceneResources,
    shadow: &ShadowPass,
) -> Result<ShadowMap, RenderError> {
    let readback = Readback {
        gpu,
        scene,
        view: &shadow.resources,
    };
    Ok(ShadowMap {
        depth_keys: readback.region(Region::Nearest).await?,
        geometry: readback.geometry(None).await?,
    })
}

/// Runs the raster passes of a view once more into a counter per pixel; returns layers per pixel.
/// None where a queue overflowed, which a view drawn from lists of tiles does not have until now:
/// it has grown, draw the view again.
pub async fn count_layers(
    device: &mut Device,
    view: &mut ViewResources,
    others: &Resources<'_>,
) -> Result<Option<Vec<u32>>, RenderError> {
    let PreparedFrame { plan, view: of, .. } = view.frame()?;
    let (key, pixels): (KernelKey, _) = (plan.key.clone(), of.pixels() as u64);
    let bytes = pixels * size_of::<u32>() as u64;
    view.buffers
        .ensure_for(
            &device.gpu,
            BufferId::LayerCounts,
            bytes,
            "layers per pixel, only while verifying",
        )
        .await?;
    let passes = key.passes(&[key.order_phases(), &[RasterPhase::Count]].concat());
    let commands = CommandList::new(device, &key, passes, "", &others.with(&view.buffers)).await?;
    let mut encoder = device
        .gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("count layers"),
        });
    view.clear(&mut encoder, |occasion| {
        occasion == ClearedBy::PictureAndCount
    })?;
    encoder.clear_buffer(
        view.buffers.get(BufferId::LayerCounts)?,
        0,
        Some(bytes.next_multiple_of(4)),
    );
    let layout = &view.frame()?.layout;
    let sizes = DispatchSizes {
        layout,
        demand: view.demand.as_ref(),
        buffers: &view.buffers,
    };
    commands.record(
        0..commands.len(),
        &mut encoder,
        &sizes,
        Timing {
            timer: None,
            ends_frame: true,
        },
    )?;
    device.gpu.queue.submit([encoder.finish()]);
    let layers =
        buffers::read(&device.gpu, view.buffers.get(BufferId::LayerCounts)?, bytes).await?;
    let counters = buffers::read(
        &device.gpu,
        view.buffers.get(BufferId::Counters)?,
        size_of::<CounterRecord>() as u64,
    )
    .await?;
    view.buffers.keep(|id| id != BufferId::LayerCounts);
    let demand: CounterRecord = bytemuck::pod_read_unaligned(&counters);
    let is_complete = demand
        .counters(&recorded_capacities(&key, &view.capacities))
        .overflow
        == 0
        || !view.grow_queues(&demand);
    Ok(is_complete.then(|| bytemuck::pod_collect_to_vec(&layers)))
}

/// Weight of all layers of a pixel, as `shaders/variants/xray_buffer` adds it up.
fn xray_weight(key: &KernelKey, words: &[u32]) -> u32 {
    match (key.options.xray_sums, words) {
        (_, [_, last]) if key.framebuffer.has_one64_sums => last >> 25,
        (XraySums::Packed16, [_, last]) => last >> 16,
        (XraySums::Three8, [first, ..]) => first >> 20,
        (XraySums::Four32, [.., last]) => *last,
        _ => 0,
    }
}
