//! Canvases of a page, on which pictures are shown without being read back.

use super::adapter::Gpu;

/// A canvas.
pub struct Canvas {
    surface: wgpu::Surface<'static>,
    /// Pixels; 0 before the first picture.
    size: [u32; 2],
}

impl Canvas {
    pub fn new(canvas: web_sys::HtmlCanvasElement) -> Result<Self, wgpu::CreateSurfaceError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        descriptor.backends = wgpu::Backends::BROWSER_WEBGPU;
        let target = wgpu::SurfaceTarget::Canvas(canvas);
        Ok(Self {
            surface: wgpu::Instance::new(descriptor).create_surface(target)?,
            size: [0; 2],
        })
    }

    /// Shows a picture of a finished frame: copies the texture to that of the canvas, which the browser takes
    /// when the task of the page ends.
    pub fn show(&mut self, gpu: &Gpu, picture: &wgpu::Texture) {
        let size = [picture.width(), picture.height()];
        if self.size != size {
            self.size = size;
            self.surface.configure(&gpu.device, &self.configuration());
        }
        let (wgpu::CurrentSurfaceTexture::Success(shown)
        | wgpu::CurrentSurfaceTexture::Suboptimal(shown)) = self.surface.get_current_texture()
        else {
            return;
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_texture(
            picture.as_image_copy(),
            shown.texture.as_image_copy(),
            picture.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(shown);
    }

    fn configuration(&self) -> wgpu::SurfaceConfiguration {
        let [width, height] = self.size;
        wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::COPY_DST,
            format: wgpu::TextureFormat::Rgba8Unorm,
            width,
            height,
            present_mode: wgpu::PresentMode::Fifo,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Opaque,
            view_formats: Vec::new(),
            color_space: Default::default(),
        }
    }
}
