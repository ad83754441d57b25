//! Materials of the hardware baseline: images as textures of the adapter with all their mip levels,
//! and samplers that filter them as the file says.

use wgpu::util::{BufferInitDescriptor, DeviceExt};

use crate::{
    device::{Gpu, error::RenderError},
    layout::records::HardwareMaterial,
    scene::{
        Material, Scene,
        texture::{Filter, Image, Level, MipFilter, Texture, Wrap},
    },
};

/// Whole numbers of [`Material::alpha_threshold`] between alpha 0 and 1.
const THRESHOLD_STEPS: f64 = 255.0 * 65_536.0;

/// The bind groups of all materials of a scene.
pub struct HardwareMaterials {
    pub layout: wgpu::BindGroupLayout,
    pub groups: Vec<wgpu::BindGroup>,
}

impl HardwareMaterials {
    pub async fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let layout = layout(gpu);
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        // Bound where a material has no image, and in place of images of data; nothing reads it.
        let white = Level {
            size: [1, 1],
            texels: vec![[255; 4]],
        };
        let none = upload(gpu, &[white]);
        let view = |image: &Image| match image.is_data {
            true => none.clone(),
            false => upload(gpu, &image.levels),
        };
        let views: Vec<wgpu::TextureView> = scene.images.iter().map(view).collect();
        let groups = scene
            .materials
            .iter()
            .map(|material| group(gpu, &layout, material, &views, &none))
            .collect();
        if scope.pop().await.is_some() {
            let bytes = scene.images.iter().map(Image::bytes).sum();
            return Err(RenderError::OutOfMemory {
                buffer: "images of the hardware baseline",
                bytes,
            });
        }
        Ok(Self { layout, groups })
    }
}

fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let entry = |(ty, binding)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let entries: Vec<_> = [uniform, texture, sampler, texture, sampler]
        .into_iter()
        .zip(0..)
        .map(entry)
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("hardware material"),
            entries: &entries,
        })
}

/// A texture with its levels, the largest first, decoded from sRGB before it is filtered.
fn upload(gpu: &Gpu, levels: &[Level]) -> wgpu::TextureView {
    let extent = |[width, height]: [u32; 2]| wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("hardware image"),
        size: extent(levels[0].size),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, mip_level) in levels.iter().zip(0..) {
        let target = wgpu::TexelCopyTextureInfo {
            mip_level,
            ..texture.as_image_copy()
        };
        let rows = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * level.size[0]),
            rows_per_image: None,
        };
        gpu.queue.write_texture(
            target,
            bytemuck::cast_slice(&level.texels),
            rows,
            extent(level.size),
        );
    }
    texture.create_view(&Default::default())
}

fn sampler(gpu: &Gpu, texture: Option<&Texture>) -> wgpu::Sampler {
    let Some(texture) = texture else {
        return gpu.device.create_sampler(&Default::default());
    };
    let [address_mode_u, address_mode_v] = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirrored => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    let filter = |filter| match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    };
    let (mipmap_filter, lod_max_clamp) = match texture.mip_filter {
        // At a clamp of 0 an adapter would always magnify.
        MipFilter::Unused => (wgpu::MipmapFilterMode::Nearest, 0.25),
        MipFilter::Nearest => (wgpu::MipmapFilterMode::Nearest, 32.0),
        MipFilter::Mixed => (wgpu::MipmapFilterMode::Linear, 32.0),
    };
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("hardware image"),
        address_mode_u,
        address_mode_v,
        mag_filter: filter(texture.mag_filter),
        min_filter: filter(texture.min_filter),
        mipmap_filter,
        lod_max_clamp,
        ..Default::default()
    })
}

fn record(material: &Material) -> HardwareMaterial {
    let rows = |texture: Option<&Texture>| {
        texture.map_or([[0.0; 4]; 2], |texture| {
            texture
                .image_from_texcoord
                .map(|[u, v, offset]| [u, v, offset, 0.0])
        })
    };
    let ([base_u, base_v], [emission_u, emission_v]) = (
        rows(material.base_texture.as_ref()),
        rows(material.emission_texture.as_ref()),
    );
    let [red, green, blue] = material.emission;
    // Half a unit less, so that an alpha which a sampler rounds to the threshold passes.
    let least_alpha = material.alpha_threshold().map_or(0.0, |threshold| {
        (f64::from(threshold) - 0.5) / THRESHOLD_STEPS
    }) as f32;
    HardwareMaterial {
        base_u,
        base_v,
        emission_u,
        emission_v,
        emission: [red, green, blue, least_alpha],
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    material: &Material,
    views: &[wgpu::TextureView],
    none: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let label = Some("hardware material");
    let contents = record(material);
    let uniform = BufferInitDescriptor {
        label,
        contents: bytemuck::bytes_of(&contents),
        usage: wgpu::BufferUsages::UNIFORM,
    };
    let uniform = gpu.device.create_buffer_init(&uniform);
    let [base, emission, ..] = material.textures();
    let view = |texture: Option<&Texture>| {
        wgpu::BindingResource::TextureView(texture.map_or(none, |texture| &views[texture.image]))
    };
    let samplers = [base, emission].map(|texture| sampler(gpu, texture));
    let resources = [
        uniform.as_entire_binding(),
        view(base),
        wgpu::BindingResource::Sampler(&samplers[0]),
        view(emission),
        wgpu::BindingResource::Sampler(&samplers[1]),
    ];
    let entries: Vec<_> = resources
        .into_iter()
        .zip(0..)
        .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label,
        layout,
        entries: &entries,
    })
}
