//! The hardware baseline: ordinary render pipelines that draw the same buffers, kept as a
//! yardstick.

use std::ops::Range;

use super::{
    deform::DeformPass,
    geometry::{COMPONENTS, Fetched, HardwareGeometry, STREAMS},
    materials::HardwareMaterials,
};
use crate::{
    device::{Gpu, error::RenderError, timer::Timer},
    effects::Stack,
    layout::{
        BufferId, ResourceId,
        frame_layout::color_stride,
        records::{DrawRecord, FrameUniform},
    },
    resources::{
        buffers::{self, Buffers},
        hardware_pipeline::{self, HardwarePipeline},
        pipelines::layout_entry,
    },
    scene::{Scene, draw::Draw, view::View},
    scene_data::{
        attributes::AttributeLayout,
        deforms::{Deforms, deformed_ranges},
        meshlets::is_outside,
    },
    shader::{
        glue::uniform_bytes,
        key::{KernelKey, VertexInputs},
        library::Library,
        link,
        pass::Pass,
        reflect,
        specialize::specialized,
    },
};

/// Vertex buffers of a material that is a base color and nothing else: position and normal.
const PLAIN_STREAMS: usize = 2;

/// What makes a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Recipe {
    strides: [u64; STREAMS],
    /// Colors are stored as 16 bits a channel, and not as floats.
    has_short_colors: bool,
    is_points: bool,
    double_sided: bool,
    mirrored: bool,
    /// None: a base color and nothing else.
    paint: Option<Paint>,
}

/// What the fragments of a material need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Paint {
    has_base_image: bool,
    has_emission_image: bool,
    unlit: bool,
    masked: bool,
}

/// One indexed or plain draw call.
struct Call {
    /// Index of its pipeline.
    pipeline: usize,
    /// Index of the material that it binds, if it binds one.
    material: Option<usize>,
    fetched: Fetched,
    vertices: u32,
    /// The draws that it draws, as instances.
    instances: Range<u32>,
}

/// The exhibit, set up for one scene and view.
pub struct Hardware {
    size: [u32; 2],
    buffers: Buffers,
    deform: Option<DeformPass>,
    /// Opaque ones first.
    pipelines: Vec<(wgpu::RenderPipeline, Recipe)>,
    group: wgpu::BindGroup,
    materials: Option<HardwareMaterials>,
    calls: Vec<Call>,
    /// The first triangle of every draw, in the order of the calls.
    order: Vec<u32>,
    deform_count: u32,
    color: wgpu::Texture,
    depth: wgpu::Texture,
}

impl Hardware {
    /// None, with the reason, where the baseline cannot draw the scene or the stack.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        view: &View,
        stack: &Stack,
        key: &KernelKey,
    ) -> Result<Result<Self, String>, RenderError> {
        if let Some(reason) = obstacle(gpu, scene, stack) {
            return Ok(Err(reason));
        }
        let mut draws = stack.draws(scene, view)?;
        let attributes = AttributeLayout::new(scene, None);
        let deforms = Deforms::of(
            scene,
            &attributes,
            draws.iter().filter(|draw| !is_outside(draw, scene)),
        );
        let deformable = deformed_ranges(scene, &draws)
            .last()
            .map_or(0, |range| range.end);
        let geometry = HardwareGeometry::new(scene, attributes);
        let recipes = sort(scene, &geometry, &mut draws);
        let records: Vec<DrawRecord> = draws
            .iter()
            .map(|draw| DrawRecord::new(draw, scene, &attributes))
            .collect();
        let counts = FrameUniform {
            draw_count: draws.len() as u32,
            deform_count: deforms.records.len() as u32,
            ..FrameUniform::of_view(view)
        };
        let mut buffers = Buffers::default();
        buffers
            .fill(gpu, BufferId::Frame, bytemuck::bytes_of(&counts))
            .await?;
        buffers
            .fill(gpu, BufferId::Draws, bytemuck::cast_slice(&records))
            .await?;
        buffers
            .fill(gpu, BufferId::Effects, &uniform_bytes(&stack.0))
            .await?;
        upload(gpu, &mut buffers, scene, &geometry).await?;
        let deform = if deformable > 0 {
            Some(DeformPass::new(gpu, key, &mut buffers, &deforms, deformable).await?)
        } else {
            None
        };
        let is_painted = recipes.iter().any(|recipe| recipe.paint.is_some());
        let materials = if is_painted {
            Some(HardwareMaterials::new(gpu, scene).await?)
        } else {
            None
        };
        let (pipelines, group) = pipelines(gpu, key, &buffers, materials.as_ref(), recipes)?;
        let calls = calls(scene, &geometry, &draws, &pipelines);
        let size = [view.width, view.height];
        let [color, depth] = hardware_pipeline::targets(gpu, size, wgpu::TextureFormat::Rgba8Unorm);
        Ok(Ok(Self {
            size,
            buffers,
            deform,
            pipelines,
            group,
            materials,
            calls,
            order: draws.iter().map(|draw| draw.first_triangle).collect(),
            deform_count: counts.deform_count,
            color,
            depth,
        }))
    }

    /// Looks at the same scene, with the same stack, from elsewhere; the size stays.
    pub async fn look(
        &self,
        gpu: &Gpu,
        scene: &Scene,
        view: &View,
        stack: &Stack,
    ) -> Result<(), RenderError> {
        let mut draws = stack.draws(scene, view)?;
        draws.sort_by_cached_key(|draw| {
            let is_it = |first: &u32| *first == draw.first_triangle;
            self.order.iter().position(is_it)
        });
        let attributes = AttributeLayout::new(scene, None);
        let records: Vec<DrawRecord> = draws
            .iter()
            .map(|draw| DrawRecord::new(draw, scene, &attributes))
            .collect();
        let frame = FrameUniform {
            draw_count: draws.len() as u32,
            deform_count: self.deform_count,
            ..FrameUniform::of_view(view)
        };
        let frame = bytemuck::bytes_of(&frame);
        let buffers = &self.buffers;
        buffers.write_at(gpu, BufferId::Frame, 0, frame).await?;
        let records = bytemuck::cast_slice(&records);
        buffers.write_at(gpu, BufferId::Draws, 0, records).await
    }

    /// Number of draw calls in a frame.
    pub fn call_count(&self) -> usize {
        self.calls.len()
    }

    /// What it draws into: gamma-encoded bytes, which may be copied from.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.color
    }

    /// Records one frame.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timer: Option<&mut Timer>,
    ) -> Result<(), RenderError> {
        if let Some(deform) = &self.deform {
            deform.record(encoder, timer.as_deref_mut());
        }
        let view = self.color.create_view(&Default::default());
        let timestamp_writes = timer.and_then(|timer| timer.render("hardware", true));
        let depth = self.depth.create_view(&Default::default());
        let color = hardware_pipeline::cleared(&view, wgpu::Color::TRANSPARENT);
        let depth_stencil_attachment = Some(hardware_pipeline::cleared_depth(&depth));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hardware"),
            color_attachments: &[Some(color)],
            depth_stencil_attachment,
            timestamp_writes,
            ..Default::default()
        });
        pass.set_bind_group(0, &self.group, &[]);
        let attributes = self.buffers.get(BufferId::VertexBytes)?;
        let (mut pipeline, mut material) = (None, None);
        for call in &self.calls {
            let (chosen, recipe) = &self.pipelines[call.pipeline];
            if pipeline.replace(call.pipeline) != Some(call.pipeline) {
                pass.set_pipeline(chosen);
            }
            if let (Some(materials), Some(needed)) = (&self.materials, call.material)
                && material.replace(needed) != Some(needed)
            {
                pass.set_bind_group(1, &materials.groups[needed], &[]);
            }
            for (stream, slot) in call.fetched.streams[..recipe.streams()].iter().zip(0..) {
                pass.set_vertex_buffer(slot, attributes.slice(stream.offset..));
            }
            match &call.fetched.indices {
                None => pass.draw(0..call.vertices, call.instances.clone()),
                Some((format, bytes, count)) => {
                    pass.set_index_buffer(
                        self.buffers.get(BufferId::IndexBytes)?.slice(bytes.clone()),
                        *format,
                    );
                    pass.draw_indexed(0..*count, 0, call.instances.clone());
                }
            }
        }
        Ok(())
    }

    /// Draws once and reads the picture back, row-major; alpha is 0 where nothing was drawn.
    pub async fn picture(&self, gpu: &Gpu) -> Result<Vec<[u8; 4]>, RenderError> {
        let [width, height] = self.size;
        let mut held = Buffers::default();
        held.ensure(
            gpu,
            BufferId::Color,
            4 * u64::from(color_stride(width)) * u64::from(height),
        )
        .await?;
        let buffer = held.get(BufferId::Color)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.record(&mut encoder, None)?;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * color_stride(width)),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.color.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer, layout },
            self.color.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        buffers::read_picture(gpu, buffer, self.size).await
    }
}

/// Why the baseline cannot draw this.
fn obstacle(gpu: &Gpu, scene: &Scene, stack: &Stack) -> Option<String> {
    let limit = gpu.caps.max_texture_side;
    let is_wide = |side: &u32| *side > limit;
    let reason = match () {
        () if stack.moves() => "an effect moves vertices, which it does not",
        () if stack.dots().is_some() => "an effect strings dots, which it does not",
        () if stack.light().is_some() => "an effect asks for shadows, which it does not draw",
        () if stack.reads_finish() => {
            "an effect asks how materials reflect, which it does not know"
        }
        () if stack.reads_normals() && scene.has_normal_maps() => {
            "textures turn normals, which it does not know"
        }
        () if scene.primitives.is_empty() => "the scene is empty",
        () => {
            let image = scene
                .images
                .iter()
                .find(|image| image.size().iter().any(is_wide))?;
            return Some(format!(
                "{} has {:?} texels, and textures of this adapter end at {limit} a side",
                image.name,
                image.size()
            ));
        }
    };
    Some(reason.into())
}

/// Uploads attributes and index lists, with copies of those that cannot be fetched as they are.
async fn upload(
    gpu: &Gpu,
    buffers: &mut Buffers,
    scene: &Scene,
    geometry: &HardwareGeometry,
) -> Result<(), RenderError> {
    let copies: &[u8] = bytemuck::cast_slice(&geometry.vertex_copies);
    buffers
        .ensure(
            gpu,
            BufferId::VertexBytes,
            geometry.first_copy() + copies.len() as u64,
        )
        .await?;
    buffers
        .write_at(gpu, BufferId::VertexBytes, 0, &scene.vertex_bytes)
        .await?;
    buffers
        .write_at(gpu, BufferId::VertexBytes, geometry.first_copy(), copies)
        .await?;
    let copies: &[u8] = bytemuck::cast_slice(&geometry.index_copies);
    buffers
        .ensure(
            gpu,
            BufferId::IndexBytes,
            geometry.first_index_copy + copies.len() as u64,
        )
        .await?;
    buffers
        .write_at(gpu, BufferId::IndexBytes, 0, &scene.index_bytes)
        .await?;
    buffers
        .write_at(gpu, BufferId::IndexBytes, geometry.first_index_copy, copies)
        .await
}

impl Recipe {
    fn of(draw: &Draw, scene: &Scene, geometry: &HardwareGeometry) -> Self {
        let primitive = &scene.primitives[draw.primitive];
        let material = &scene.materials[primitive.material];
        let paint = (!material.is_plain() || primitive.colors.is_some()).then(|| Paint {
            has_base_image: material.base_texture.is_some(),
            has_emission_image: material.emission_texture.is_some(),
            unlit: material.unlit,
            masked: material.alpha_threshold().is_some(),
        });
        let streams = geometry.of_draw(draw).streams;
        let mut strides = streams.map(|stream| stream.stride);
        let recipe = Self {
            strides,
            has_short_colors: streams[STREAMS - 1].is_short,
            is_points: primitive.is_points(),
            double_sided: draw.double_sided,
            mirrored: draw.mirrored,
            paint,
        };
        // What is not bound makes no difference.
        strides[recipe.streams()..].fill(0);
        Self { strides, ..recipe }
    }

    /// Vertex buffers that it reads.
    const fn streams(&self) -> usize {
        if self.paint.is_some() {
            STREAMS
        } else {
            PLAIN_STREAMS
        }
    }

    /// The material that a draw binds. A base color alone is read from its record.
    fn material(&self, draw: &Draw, scene: &Scene) -> Option<usize> {
        self.paint
            .map(|_| scene.primitives[draw.primitive].material)
    }

    fn is_masked(&self) -> bool {
        self.paint.is_some_and(|paint| paint.masked)
    }
}

/// Finds the pipelines that a scene takes, and brings its draws into the order in which an engine
/// draws them: opaque ones first, then by pipeline, material and mesh; else as they were.
fn sort(scene: &Scene, geometry: &HardwareGeometry, draws: &mut [Draw]) -> Vec<Recipe> {
    let mut recipes: Vec<Recipe> = Vec::new();
    for draw in draws.iter() {
        let recipe = Recipe::of(draw, scene, geometry);
        if !recipes.contains(&recipe) {
            recipes.push(recipe);
        }
    }
    recipes.sort_by_key(Recipe::is_masked);
    draws.sort_by_cached_key(|draw| {
        let recipe = Recipe::of(draw, scene, geometry);
        (
            recipes.iter().position(|other| *other == recipe),
            recipe.material(draw, scene),
            draw.primitive,
        )
    });
    recipes
}

/// One call for neighbors that differ only in their records.
fn calls(
    scene: &Scene,
    geometry: &HardwareGeometry,
    draws: &[Draw],
    pipelines: &[(wgpu::RenderPipeline, Recipe)],
) -> Vec<Call> {
    let mut calls: Vec<Call> = Vec::new();
    for (draw, instance) in draws.iter().zip(0..) {
        let primitive = &scene.primitives[draw.primitive];
        let recipe = Recipe::of(draw, scene, geometry);
        let pipeline = pipelines
            .iter()
            .position(|(_, other)| *other == recipe)
            .expect("every draw has a pipeline");
        let fetched = geometry.of_draw(draw);
        let (material, vertices, instances) = (
            recipe.material(draw, scene),
            primitive.vertex_count(),
            instance..instance + 1,
        );
        match calls.last_mut() {
            Some(last)
                if last.pipeline == pipeline
                    && last.material == material
                    && last.vertices == vertices
                    && last.fetched == fetched =>
            {
                last.instances.end += 1;
            }
            _ => calls.push(Call {
                pipeline,
                material,
                fetched,
                vertices,
                instances,
            }),
        }
    }
    calls
}

/// The pipelines of all recipes, and what all of them bind.
#[allow(
    clippy::type_complexity,
    reason = "two results, named in the line above"
)]
fn pipelines(
    gpu: &Gpu,
    key: &KernelKey,
    buffers: &Buffers,
    materials: Option<&HardwareMaterials>,
    recipes: Vec<Recipe>,
) -> Result<(Vec<(wgpu::RenderPipeline, Recipe)>, wgpu::BindGroup), RenderError> {
    // Every draw is an instance of a storage buffer here, with a whole record.
    let vertices = VertexInputs {
        is_single_draw: false,
        is_instanced: false,
        ..key.vertices.clone()
    };
    let key = KernelKey {
        vertices,
        ..key.clone()
    };
    let linked = link::link(
        &Library::of_process(),
        "baselines/hardware",
        &key,
        &key.variants(Pass::Resolve),
    )?;
    let reflected = reflect::reflect(&linked, gpu.caps.int64_atomics)?;
    let mut bindings = reflected.bindings("hardware_vertex");
    bindings.extend(reflected.bindings("hardware_fragment"));
    bindings.sort_by_key(|binding| binding.index);
    bindings.dedup();
    let label = Some("hardware");
    let entries: Vec<_> = bindings
        .iter()
        .map(|binding| layout_entry(binding, wgpu::ShaderStages::VERTEX_FRAGMENT))
        .collect();
    let layout = gpu
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label,
            entries: &entries,
        });
    let resource = |name: &str| match ResourceId::of_binding(name) {
        Some(ResourceId::Buffer(id)) => buffers.get(id),
        _ => Err(RenderError::Pipeline {
            label: "hardware".into(),
            reason: format!("it binds {name}, which is no buffer"),
        }),
    };
    let entries = bindings.iter().map(|binding| {
        Ok(wgpu::BindGroupEntry {
            binding: binding.index,
            resource: resource(&binding.name)?.as_entire_binding(),
        })
    });
    let entries: Vec<_> = entries.collect::<Result<_, RenderError>>()?;
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label,
        layout: &layout,
        entries: &entries,
    });
    let pipeline_layout = |material: Option<&wgpu::BindGroupLayout>| {
        let groups: Vec<_> = std::iter::once(&layout).chain(material).map(Some).collect();
        gpu.device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label,
                bind_group_layouts: &groups,
                ..Default::default()
            })
    };
    let (plain, painted) = (
        pipeline_layout(None),
        pipeline_layout(materials.map(|materials| &materials.layout)),
    );
    let overrides = reflected.overrides();
    let build = |recipe: Recipe| {
        let text = specialized(&linked, &overrides, &recipe.constants())?;
        let module = hardware_pipeline::module(gpu, "hardware", &text);
        let layout = if recipe.paint.is_some() {
            &painted
        } else {
            &plain
        };
        Ok((recipe.pipeline(gpu, &module, layout), recipe))
    };
    let built: Result<_, RenderError> = recipes.into_iter().map(build).collect();
    Ok((built?, group))
}

impl Recipe {
    /// Values of the shader's overrides.
    fn constants(&self) -> Vec<(&'static str, f64)> {
        let Some(paint) = self.paint else {
            return Vec::new();
        };
        let flags = [
            ("HAS_BASE_IMAGE", paint.has_base_image),
            ("HAS_EMISSION_IMAGE", paint.has_emission_image),
            ("IS_UNLIT", paint.unlit),
        ];
        flags
            .map(|(name, is_set)| (name, f64::from(u8::from(is_set))))
            .to_vec()
    }

    fn pipeline(
        &self,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        layout: &wgpu::PipelineLayout,
    ) -> wgpu::RenderPipeline {
        let attribute = |slot: usize| {
            let format = match COMPONENTS[slot] {
                4 if self.has_short_colors => wgpu::VertexFormat::Unorm16x4,
                2 => wgpu::VertexFormat::Float32x2,
                3 => wgpu::VertexFormat::Float32x3,
                _ => wgpu::VertexFormat::Float32x4,
            };
            [wgpu::VertexAttribute {
                format,
                offset: 0,
                shader_location: slot as u32,
            }]
        };
        let attributes: [_; STREAMS] = std::array::from_fn(attribute);
        let buffer = |slot: usize| {
            let step_mode = wgpu::VertexStepMode::Vertex;
            Some(wgpu::VertexBufferLayout {
                array_stride: self.strides[slot],
                step_mode,
                attributes: &attributes[slot],
            })
        };
        let buffers: Vec<_> = (0..self.streams()).map(buffer).collect();
        let entries = match self.paint {
            None => ["hardware_vertex", "hardware_fragment"],
            Some(Paint { masked: true, .. }) => ["hardware_painted_vertex", "hardware_masked"],
            Some(_) => ["hardware_painted_vertex", "hardware_painted"],
        };
        let pipeline = HardwarePipeline {
            label: "hardware",
            module,
            entries,
            layout: Some(layout),
            buffers: &buffers,
            topology: match self.is_points {
                true => wgpu::PrimitiveTopology::PointList,
                false => wgpu::PrimitiveTopology::TriangleList,
            },
            cull_mode: (!self.double_sided).then_some(wgpu::Face::Back),
            front_face: if self.mirrored {
                wgpu::FrontFace::Cw
            } else {
                wgpu::FrontFace::Ccw
            },
            format: wgpu::TextureFormat::Rgba8Unorm,
        };
        pipeline.build(gpu)
    }
}
