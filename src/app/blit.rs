//! Blit: puts the renderer's texture on the window as it is, texel by texel.
//!
//! egui can show a texture too, but its general shader costs a software adapter more than the whole rasterizer does.

use eframe::{egui, egui_wgpu, wgpu};

const SHADER: &str = "
struct Corner { @builtin(position) position: vec4f, @location(0) uv: vec2f }

@vertex
fn corner(@builtin(vertex_index) i: u32) -> Corner {
    let uv = vec2f(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Corner(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

@group(0) @binding(0) var picture: texture_2d<f32>;
override TO_LINEAR: bool;

@fragment
fn texel(in: Corner) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(picture));
    let color = textureLoad(picture, vec2i(min(in.uv * size, size - 1.0)), 0).rgb;
    if TO_LINEAR {
        return vec4f(select(pow((color + 0.055) / 1.055, vec3f(2.4)), color / 12.92, color <= vec3f(0.04045)), 1.0);
    }
    return vec4f(color, 1.0);
}";

/// The pipeline, made once per window.
#[derive(Clone)]
pub struct Blitter {
    pipeline: wgpu::RenderPipeline,
}

impl Blitter {
    pub fn new(window: &egui_wgpu::RenderState) -> Self {
        let device = &window.device;
        let module = device
            .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("blit"), source: wgpu::ShaderSource::Wgsl(SHADER.into()) });
        // An sRGB window would encode bytes that are encoded already.
        let to_linear = f64::from(u8::from(window.target_format.is_srgb()));
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("blit"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("texel"),
                compilation_options: wgpu::PipelineCompilationOptions { constants: &[("TO_LINEAR", to_linear)], ..Default::default() },
                targets: &[Some(window.target_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// What shows `view`, again and again.
    pub fn blit(&self, device: &wgpu::Device, view: &wgpu::TextureView) -> Blit {
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) }],
        });
        Blit { pipeline: self.pipeline.clone(), binding }
    }
}

/// A picture, ready to be put anywhere in the window.
#[derive(Clone)]
pub struct Blit {
    pipeline: wgpu::RenderPipeline,
    binding: wgpu::BindGroup,
}

impl Blit {
    /// The picture filling `rect`.
    pub fn shape(&self, rect: egui::Rect) -> egui::Shape {
        egui_wgpu::Callback::new_paint_callback(rect, self.clone()).into()
    }
}

impl egui_wgpu::CallbackTrait for Blit {
    fn paint(&self, _: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &egui_wgpu::CallbackResources) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.binding, &[]);
        pass.draw(0..3, 0..1);
    }
}
