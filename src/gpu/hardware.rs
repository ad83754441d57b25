//! The hardware baseline: an ordinary render pipeline that draws the same buffers, kept as a yardstick.

use super::{Gpu, RenderError, buffers::Buffers, pipelines::layout_entry, timer::Timer, uniforms::*};
use crate::{
    effects::Stack,
    scene::{ComponentType, Primitive, Scene, Topology, draw::draws, view::View},
    shader::{glue::uniform_bytes, key::KernelKey, library::Library, link, reflect},
};

/// One indexed or plain draw call.
struct Call {
    instance: u32,
    vertices: u32,
    position_offset: u64,
    normal_offset: u64,
    /// Format, byte range and count of its indices.
    indices: Option<(wgpu::IndexFormat, std::ops::Range<u64>, u32)>,
}

/// The exhibit, set up for one scene and view.
pub struct Hardware {
    buffers: Buffers,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    calls: Vec<Call>,
    color: wgpu::Texture,
    depth: wgpu::TextureView,
}

impl Hardware {
    /// None, with the reason, where a fixed-function pipeline cannot read the scene's bytes as they are.
    pub fn new(gpu: &Gpu, scene: &Scene, view: &View, stack: &Stack, key: &KernelKey) -> Result<Result<Self, String>, RenderError> {
        if let Some(reason) = scene.primitives.iter().find_map(obstacle) {
            return Ok(Err(reason));
        }
        if scene.primitives.iter().any(|p| !scene.materials[p.material].is_plain()) {
            return Ok(Err("a material looks up an image, shines or is unlit, which it does not know".into()));
        }
        if stack.moves() {
            return Ok(Err("an effect moves vertices, which it does not".into()));
        }
        if stack.dots().is_some() {
            return Ok(Err("an effect strings dots, which it does not".into()));
        }
        if stack.light().is_some() {
            return Ok(Err("an effect asks for shadows, which it does not draw".into()));
        }
        if scene.deformable_vertex_count() > 0 {
            return Ok(Err("meshes bend, which takes a pass that it does not have".into()));
        }
        let strides = |p: &Primitive| (p.positions.stride, p.normals.stride, scene.materials[p.material].double_sided);
        let Some(first) = scene.primitives.first() else { return Ok(Err("the scene is empty".into())) };
        if scene.primitives.iter().any(|p| strides(p) != strides(first)) {
            return Ok(Err("the primitives differ in stride or sidedness, which takes several pipelines".into()));
        }
        let draws = draws(scene, view)?;
        let records: Vec<DrawRecord> = draws.iter().map(|draw| DrawRecord::new(draw, scene)).collect();
        let uniform = FrameUniform::new(view, scene, draws.len(), &Capacities::default());
        let parameters = uniform_bytes(&stack.0);
        let storage = wgpu::BufferUsages::STORAGE;
        let mut buffers = Buffers::default();
        buffers.fill(gpu, "frame", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM, "viewpoint")?;
        buffers.fill(gpu, "draws", bytemuck::cast_slice(&records), storage, "matrices")?;
        buffers.fill(gpu, "effects", &parameters, wgpu::BufferUsages::UNIFORM, "parameters")?;
        buffers.fill(gpu, "vertex_bytes", &scene.vertex_bytes, wgpu::BufferUsages::VERTEX, "attributes")?;
        buffers.fill(gpu, "index_bytes", &scene.index_bytes, wgpu::BufferUsages::INDEX, "indices")?;
        let calls = draws.iter().zip(0..).map(|(draw, instance)| call(&scene.primitives[draw.primitive], instance)).collect();
        let (pipeline, layout, names) = pipeline(gpu, key, strides(first))?;
        let entries: Vec<_> = names
            .iter()
            .map(|binding| wgpu::BindGroupEntry { binding: binding.index, resource: buffers.get(&binding.name).as_entire_binding() })
            .collect();
        let group =
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("hardware"), layout: &layout, entries: &entries });
        let target = |format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("hardware"),
                size: wgpu::Extent3d { width: view.width, height: view.height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let depth = target(wgpu::TextureFormat::Depth32Float, attachment).create_view(&Default::default());
        let color = target(wgpu::TextureFormat::Rgba8Unorm, attachment | wgpu::TextureUsages::COPY_SRC);
        Ok(Ok(Self { buffers, pipeline, group, calls, color, depth }))
    }

    /// Records one frame.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&mut Timer>) {
        let view = self.color.create_view(&Default::default());
        let timestamp_writes = timer.and_then(|timer| timer.render("hardware", true));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hardware"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        let attributes = self.buffers.get("vertex_bytes");
        for call in &self.calls {
            pass.set_vertex_buffer(0, attributes.slice(call.position_offset..));
            pass.set_vertex_buffer(1, attributes.slice(call.normal_offset..));
            let instances = call.instance..call.instance + 1;
            match &call.indices {
                None => pass.draw(0..call.vertices, instances),
                Some((format, bytes, count)) => {
                    pass.set_index_buffer(self.buffers.get("index_bytes").slice(bytes.clone()), *format);
                    pass.draw_indexed(0..*count, 0, instances);
                }
            }
        }
    }

    /// Copies the picture to a buffer, rows `color_stride` apart; alpha is 0 where nothing was drawn.
    pub fn copy_color(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer) {
        let size = self.color.size();
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * color_stride(size.width)), rows_per_image: None };
        encoder.copy_texture_to_buffer(self.color.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer: to, layout }, size);
    }
}

/// Why a fixed-function pipeline cannot read this primitive.
fn obstacle(p: &Primitive) -> Option<String> {
    let reason = match () {
        () if p.topology != Topology::List => "is no triangle list",
        () if p.positions.component_type != ComponentType::F32 || p.normals.component_type != ComponentType::F32 => {
            "has attributes that are not f32"
        }
        () if p.indices.is_some_and(|i| i.component_type == ComponentType::U8) => "has u8 indices",
        () if p.colors.is_some() => "has vertex colours",
        () => return None,
    };
    Some(format!("{} {reason}", p.name))
}

fn call(p: &Primitive, instance: u32) -> Call {
    let indices = p.indices.map(|i| {
        let format = if i.component_type == ComponentType::U16 { wgpu::IndexFormat::Uint16 } else { wgpu::IndexFormat::Uint32 };
        (format, u64::from(i.offset)..u64::from(i.offset) + u64::from(i.count) * u64::from(i.component_type.bytes()), i.count)
    });
    Call {
        instance,
        vertices: p.vertex_count(),
        position_offset: p.positions.offset.into(),
        normal_offset: p.normals.offset.into(),
        indices,
    }
}

type Built = (wgpu::RenderPipeline, wgpu::BindGroupLayout, Vec<reflect::Binding>);

fn pipeline(gpu: &Gpu, key: &KernelKey, (position_stride, normal_stride, double_sided): (u32, u32, bool)) -> Result<Built, RenderError> {
    let linked = link::link(
        &Library::from_env(),
        "baselines/hardware",
        key,
        &[("draws", "slots/draws/many".into()), ("image", "slots/image/none".into())],
    )?;
    let reflected = reflect::reflect(&linked, gpu.caps.int64_atomics)?;
    let mut bindings = reflected.bindings("hardware_vertex");
    bindings.extend(reflected.bindings("hardware_fragment"));
    bindings.sort_by_key(|binding| binding.index);
    bindings.dedup();
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("hardware"),
        source: wgpu::ShaderSource::Wgsl(linked.text.into()),
    });
    let entries: Vec<_> = bindings.iter().map(|binding| layout_entry(binding, wgpu::ShaderStages::VERTEX_FRAGMENT)).collect();
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("hardware"), entries: &entries });
    let attribute = |location| [wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: location }];
    let (positions, normals) = (attribute(0), attribute(1));
    let buffer = |stride: u32, attributes| wgpu::VertexBufferLayout {
        array_stride: stride.into(),
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes,
    };
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("hardware"),
        layout: Some(&gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("hardware"),
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        })),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("hardware_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(buffer(position_stride, &positions)), Some(buffer(normal_stride, &normals))],
        },
        primitive: wgpu::PrimitiveState { cull_mode: (!double_sided).then_some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("hardware_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    Ok((pipeline, layout, bindings))
}
