//! The hardware baseline: an ordinary render pipeline that draws the same buffers, kept as a yardstick.

use super::{
    attributes::AttributeLayout,
    buffers::{Buffers, color_stride},
    device::Gpu,
    error::RenderError,
    hardware_pipeline::{self, HardwarePipeline},
    pipelines::layout_entry,
    records::{DrawRecord, FrameUniform},
    resource_id::{BufferId, ResourceId},
    timer::Timer,
};
use crate::{
    effects::Stack,
    scene::{ComponentType, Primitive, Scene, Topology, view::View},
    shader::{
        glue::uniform_bytes,
        key::{KernelKey, VertexInputs},
        library::Library,
        link,
        pass::Pass,
        reflect,
    },
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
    depth: wgpu::Texture,
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
        let draws = stack.draws(scene, view)?;
        let attributes = AttributeLayout::new(scene, None);
        let records: Vec<DrawRecord> = draws.iter().map(|draw| DrawRecord::new(draw, scene, &attributes)).collect();
        let uniform = FrameUniform { draw_count: draws.len() as u32, ..FrameUniform::of_view(view) };
        let parameters = uniform_bytes(&stack.0);
        let mut buffers = Buffers::default();
        buffers.fill(gpu, BufferId::Frame, bytemuck::bytes_of(&uniform))?;
        buffers.fill(gpu, BufferId::Draws, bytemuck::cast_slice(&records))?;
        buffers.fill(gpu, BufferId::Effects, &parameters)?;
        buffers.fill(gpu, BufferId::VertexBytes, &scene.vertex_bytes)?;
        buffers.fill(gpu, BufferId::IndexBytes, &scene.index_bytes)?;
        let calls = draws.iter().zip(0..).map(|(draw, instance)| call(&scene.primitives[draw.primitive], instance)).collect();
        let (pipeline, group) = pipeline(gpu, key, &buffers, strides(first))?;
        let [color, depth] = hardware_pipeline::targets(gpu, [view.width, view.height], wgpu::TextureFormat::Rgba8Unorm);
        Ok(Ok(Self { buffers, pipeline, group, calls, color, depth }))
    }

    /// Records one frame.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&mut Timer>) -> Result<(), RenderError> {
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
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        let attributes = self.buffers.get(BufferId::VertexBytes)?;
        for call in &self.calls {
            pass.set_vertex_buffer(0, attributes.slice(call.position_offset..));
            pass.set_vertex_buffer(1, attributes.slice(call.normal_offset..));
            let instances = call.instance..call.instance + 1;
            match &call.indices {
                None => pass.draw(0..call.vertices, instances),
                Some((format, bytes, count)) => {
                    pass.set_index_buffer(self.buffers.get(BufferId::IndexBytes)?.slice(bytes.clone()), *format);
                    pass.draw_indexed(0..*count, 0, instances);
                }
            }
        }
        Ok(())
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
        () if p.colors.is_some() => "has vertex colors",
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

fn pipeline(
    gpu: &Gpu,
    key: &KernelKey,
    buffers: &Buffers,
    (position_stride, normal_stride, double_sided): (u32, u32, bool),
) -> Result<(wgpu::RenderPipeline, wgpu::BindGroup), RenderError> {
    // Every draw is an instance of a storage buffer here.
    let vertices = VertexInputs { is_single_draw: false, ..key.vertices.clone() };
    let key = KernelKey { vertices, ..key.clone() };
    let linked = link::link(&Library::from_env(), "baselines/hardware", &key, &key.variants(Pass::Resolve))?;
    let reflected = reflect::reflect(&linked, gpu.caps.int64_atomics)?;
    let mut bindings = reflected.bindings("hardware_vertex");
    bindings.extend(reflected.bindings("hardware_fragment"));
    bindings.sort_by_key(|binding| binding.index);
    bindings.dedup();
    let label = Some("hardware");
    let entries: Vec<_> = bindings.iter().map(|binding| layout_entry(binding, wgpu::ShaderStages::VERTEX_FRAGMENT)).collect();
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
    let resource = |name: &str| match ResourceId::of_binding(name) {
        Some(ResourceId::Buffer(id)) => buffers.get(id),
        _ => Err(RenderError::Pipeline { label: "hardware".into(), reason: format!("it binds {name}, which is no buffer") }),
    };
    let entries = bindings
        .iter()
        .map(|binding| Ok(wgpu::BindGroupEntry { binding: binding.index, resource: resource(&binding.name)?.as_entire_binding() }));
    let entries: Vec<_> = entries.collect::<Result<_, RenderError>>()?;
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout: &layout, entries: &entries });
    let bind_group_layouts = [Some(&layout)];
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &bind_group_layouts,
        ..Default::default()
    });
    let attribute = |location| [wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: location }];
    let (positions, normals) = (attribute(0), attribute(1));
    let buffer = |stride: u32, attributes| wgpu::VertexBufferLayout {
        array_stride: stride.into(),
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes,
    };
    let pipeline = HardwarePipeline {
        label: "hardware",
        text: &linked.text,
        entries: ["hardware_vertex", "hardware_fragment"],
        layout: Some(&layout),
        buffers: &[Some(buffer(position_stride, &positions)), Some(buffer(normal_stride, &normals))],
        cull_mode: (!double_sided).then_some(wgpu::Face::Back),
        format: wgpu::TextureFormat::Rgba8Unorm,
    };
    Ok((pipeline.build(gpu), group))
}
