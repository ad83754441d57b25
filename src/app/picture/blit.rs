//! Blit: copies the renderer's texture to the window, texel by texel.
//!
//! egui can show a texture too, but on a software adapter its general shader takes longer than the
//! whole rasterizer.

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
    return texel_of(textureLoad(picture, vec2i(min(in.uv * size, size - 1.0)), 0).rgb);
}

fn texel_of(color: vec3f) -> vec4f {
    if TO_LINEAR {
        return vec4f(select(pow((color + 0.055) / 1.055, vec3f(2.4)), color / 12.92, color <= vec3f(0.04045)), 1.0);
    }
    return vec4f(color, 1.0);
}";

/// The difference of two pictures, channel by channel, times a gain.
const DIFFERENCE: &str = "
@group(0) @binding(1) var other: texture_2d<f32>;
@group(0) @binding(2) var<uniform> gain: vec4f;

@fragment
fn differing(in: Corner) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(picture));
    let at = vec2i(min(in.uv * size, size - 1.0));
    let last = vec2i(textureDimensions(other)) - 1;
    let apart = abs(textureLoad(picture, at, 0).rgb - textureLoad(other, min(at, last), 0).rgb);
    return texel_of(min(apart * gain.x, vec3f(1.0)));
}";

/// The pipelines, made once per window.
#[derive(Clone)]
pub struct Blitter {
    pipeline: wgpu::RenderPipeline,
    difference: wgpu::RenderPipeline,
}

impl Blitter {
    pub fn new(window: &egui_wgpu::RenderState) -> Self {
        let device = &window.device;
        let source = wgpu::ShaderSource::Wgsl(format!("{SHADER}{DIFFERENCE}").into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("blit"),
            source,
        });
        // The texture holds sRGB bytes, and an sRGB window would encode them again.
        let to_linear = f64::from(u8::from(window.target_format.is_srgb()));
        let made = |entry: &str| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
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
                    entry_point: Some(entry),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("TO_LINEAR", to_linear)],
                        ..Default::default()
                    },
                    targets: &[Some(window.target_format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            pipeline: made("texel"),
            difference: made("differing"),
        }
    }

    /// A blit of `view`.
    pub fn blit(&self, device: &wgpu::Device, view: &wgpu::TextureView) -> Blit {
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(view),
            }],
        });
        Blit {
            pipeline: self.pipeline.clone(),
            binding,
        }
    }

    /// A blit of the difference of two views, times `gain`.
    pub fn difference(
        &self,
        device: &wgpu::Device,
        [a, b]: [&wgpu::TextureView; 2],
        gain: u8,
    ) -> Blit {
        let contents = bytemuck::bytes_of(&[f32::from(gain), 0.0, 0.0, 0.0]).to_vec();
        let uniform = wgpu::util::BufferInitDescriptor {
            label: Some("gain"),
            contents: &contents,
            usage: wgpu::BufferUsages::UNIFORM,
        };
        let gain = wgpu::util::DeviceExt::create_buffer_init(device, &uniform);
        let view = |binding, view| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        };
        let entries = [
            view(0, a),
            view(1, b),
            wgpu::BindGroupEntry {
                binding: 2,
                resource: gain.as_entire_binding(),
            },
        ];
        let layout = self.difference.get_bind_group_layout(0);
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("difference"),
            layout: &layout,
            entries: &entries,
        });
        Blit {
            pipeline: self.difference.clone(),
            binding,
        }
    }
}

/// A picture that can be drawn anywhere in the window.
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
    fn paint(
        &self,
        _: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _: &egui_wgpu::CallbackResources,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.binding, &[]);
        pass.draw(0..3, 0..1);
    }
}
