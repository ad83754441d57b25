//! What both drawings with the adapter's own rasterizer share: targets, a depth test by which the
//! larger depth wins, a pipeline.

use crate::device::Gpu;

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A picture of a format that can be copied, and its depth buffer.
pub fn targets(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
) -> [wgpu::Texture; 2] {
    let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
    [
        (format, attachment | wgpu::TextureUsages::COPY_SRC),
        (DEPTH, attachment),
    ]
    .map(|(format, usage)| {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("hardware"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    })
}

/// A color target that begins with one value.
pub fn cleared(
    view: &wgpu::TextureView,
    value: wgpu::Color,
) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations {
        load: wgpu::LoadOp::Clear(value),
        store: wgpu::StoreOp::Store,
    };
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops,
    }
}

/// A depth target that begins with the farthest depth.
pub fn cleared_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations {
        load: wgpu::LoadOp::Clear(0.0),
        store: wgpu::StoreOp::Store,
    });
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops,
        stencil_ops: None,
    }
}

/// An ordinary render pipeline over lists of triangles or points.
pub struct HardwarePipeline<'a> {
    pub label: &'a str,
    pub module: &'a wgpu::ShaderModule,
    /// Entry points of the vertex and the fragment stage.
    pub entries: [&'a str; 2],
    /// None: as the shaders have it.
    pub layout: Option<&'a wgpu::PipelineLayout>,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub topology: wgpu::PrimitiveTopology,
    pub cull_mode: Option<wgpu::Face>,
    /// The winding of front faces, y up.
    pub front_face: wgpu::FrontFace,
    pub format: wgpu::TextureFormat,
}

/// A module of WGSL for pipelines.
pub fn module(gpu: &Gpu, label: &str, text: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(text.into());
    gpu.device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source,
        })
}

impl HardwarePipeline<'_> {
    pub fn build(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let label = Some(self.label);
        let [vertex, fragment] = self.entries;
        gpu.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label,
                layout: self.layout,
                vertex: wgpu::VertexState {
                    module: self.module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: self.buffers,
                },
                primitive: wgpu::PrimitiveState {
                    topology: self.topology,
                    cull_mode: self.cull_mode,
                    front_face: self.front_face,
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: self.module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(self.format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}
