//! The adapter's own rasterizer as a witness: the triangle id of every pixel, from positions that were snapped before.

use super::{
    Gpu, RenderError, Renderer,
    buffers::{self, Buffers},
    uniforms::color_stride,
};
use crate::shader::{library::Library, link::LinkError};

const SHADER: &str = "baselines/hardware_ids";

impl Renderer {
    /// Draws loose triangles, three corners each in normalized device coordinates and a depth of which the larger is nearer,
    /// with an ordinary render pipeline. Gives the number of the nearest triangle on each pixel, row-major, or
    /// [`crate::frame::NO_TRIANGLE`]; of equal depths the first.
    ///
    /// # Errors
    /// When the corners take more than a buffer holds, or the device is lost.
    pub fn hardware_ids(&self, [width, height]: [u32; 2], corners: &[[f32; 3]]) -> Result<Vec<u32>, RenderError> {
        let gpu = &*self.gpu;
        let mut held = Buffers::default();
        held.fill(gpu, "corners", bytemuck::cast_slice(corners), wgpu::BufferUsages::VERTEX, "positions")?;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let target = |format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("hardware triangle ids"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let triangle_ids = target(wgpu::TextureFormat::R32Uint, attachment | wgpu::TextureUsages::COPY_SRC);
        let depth = target(wgpu::TextureFormat::Depth32Float, attachment).create_view(&Default::default());
        let view = triangle_ids.create_view(&Default::default());
        let pipeline = pipeline(gpu, self.pipelines.library())?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let nobody = wgpu::Color { r: f64::from(crate::frame::NO_TRIANGLE), ..wgpu::Color::TRANSPARENT };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("hardware triangle ids"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(nobody), store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&pipeline);
            pass.set_vertex_buffer(0, held.get("corners").slice(..));
            pass.draw(0..corners.len() as u32, 0..1);
        }
        let rows = 4 * u64::from(color_stride(width));
        held.ensure(gpu, "triangle_ids", rows * u64::from(height), wgpu::BufferUsages::empty(), "the picture")?;
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(rows as u32), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: held.get("triangle_ids"), layout };
        encoder.copy_texture_to_buffer(triangle_ids.as_image_copy(), to, size);
        gpu.queue.submit([encoder.finish()]);
        let pixels = buffers::read_picture(gpu, held.get("triangle_ids"), [width, height])?;
        Ok(pixels.into_iter().map(u32::from_le_bytes).collect())
    }
}

fn pipeline(gpu: &Gpu, library: &Library) -> Result<wgpu::RenderPipeline, RenderError> {
    let text = library.text(SHADER).ok_or_else(|| LinkError::Missing { user: "the program".into(), name: SHADER.into() })?;
    let module =
        gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(SHADER), source: wgpu::ShaderSource::Wgsl(text) });
    let attributes = [wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 }];
    let corner = wgpu::VertexBufferLayout { array_stride: 12, step_mode: wgpu::VertexStepMode::Vertex, attributes: &attributes };
    Ok(gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(SHADER),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("ids_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(corner)],
        },
        primitive: wgpu::PrimitiveState::default(),
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
            entry_point: Some("ids_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::TextureFormat::R32Uint.into())],
        }),
        multiview_mask: None,
        cache: None,
    }))
}
