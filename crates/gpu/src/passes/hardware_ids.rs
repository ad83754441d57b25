//! The adapter's own rasterizer as a second opinion: the triangle id of every pixel, from positions
//! that were snapped before.

use crate::{
    device::{Gpu, error::RenderError},
    frame::NO_TRIANGLE,
    layout::{BufferId, frame_layout::color_stride},
    resources::{
        buffers::{self, Buffers},
        hardware_pipeline::{HardwarePipeline, cleared, cleared_depth, module, targets},
    },
    shader::{library::Library, link::LinkError},
};

const SHADER: &str = "baselines/hardware_ids";

/// Draws loose triangles, three corners each in normalized device coordinates and a depth of which
/// the larger is nearer, with an ordinary render pipeline. Gives the number of the nearest triangle
/// on each pixel, row-major, or [`NO_TRIANGLE`]; of equal depths the first.
pub async fn triangle_ids(
    gpu: &Gpu,
    library: &Library,
    size: [u32; 2],
    corners: &[[f32; 3]],
) -> Result<Vec<u32>, RenderError> {
    let format = wgpu::TextureFormat::R32Uint;
    let mut held = Buffers::default();
    held.fill(gpu, BufferId::Corners, bytemuck::cast_slice(corners))
        .await?;
    let text = library.text(SHADER).ok_or_else(|| LinkError::Missing {
        user: "the program".into(),
        name: SHADER.into(),
    })?;
    let attributes = [wgpu::VertexAttribute {
        format: wgpu::VertexFormat::Float32x3,
        offset: 0,
        shader_location: 0,
    }];
    let corner = wgpu::VertexBufferLayout {
        array_stride: 12,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let pipeline = HardwarePipeline {
        label: SHADER,
        module: &module(gpu, SHADER, &text),
        entries: ["ids_vertex", "ids_fragment"],
        layout: None,
        buffers: &[Some(corner)],
        topology: wgpu::PrimitiveTopology::TriangleList,
        cull_mode: None,
        front_face: wgpu::FrontFace::Ccw,
        format,
    };
    let pipeline = pipeline.build(gpu);
    let [ids, depth] = targets(gpu, size, format);
    let views = [&ids, &depth].map(|texture| texture.create_view(&Default::default()));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let nothing = wgpu::Color {
            r: f64::from(NO_TRIANGLE),
            ..wgpu::Color::TRANSPARENT
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hardware ids"),
            color_attachments: &[Some(cleared(&views[0], nothing))],
            depth_stencil_attachment: Some(cleared_depth(&views[1])),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_vertex_buffer(0, held.get(BufferId::Corners)?.slice(..));
        pass.draw(0..corners.len() as u32, 0..1);
    }
    let row = 4 * color_stride(size[0]);
    held.ensure(
        gpu,
        BufferId::TriangleIds,
        u64::from(row) * u64::from(size[1]),
    )
    .await?;
    let copy = held.get(BufferId::TriangleIds)?;
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(row),
        rows_per_image: None,
    };
    encoder.copy_texture_to_buffer(
        ids.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: copy,
            layout,
        },
        ids.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    Ok(buffers::read_picture(gpu, copy, size)
        .await?
        .into_iter()
        .map(u32::from_le_bytes)
        .collect())
}
