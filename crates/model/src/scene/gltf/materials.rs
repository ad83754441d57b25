//! Materials: colors, textures with their samplers and transforms, and the images that they use.
//!
//! Only images that a visible primitive uses are decoded, within [`limits`] and only at the size in
//! their header.

use std::{
    collections::{BTreeSet, HashMap},
    io::Cursor,
};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits as DecoderLimits};

use super::{
    buffers::Buffers,
    document::{self, AlphaMode, Document, ImageSource, TextureUse},
    error::{LoadError, ReadFile, called, part_name, quoted},
    limits::{self, Limits},
    notes::Notes,
    other_file, uri,
};
use crate::scene::{
    material::Material,
    texture::{Image, MipFilter, Texture},
};

/// Supported material extensions.
pub const EXTENSIONS: [&str; 6] = [
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_pbrSpecularGlossiness",
];

/// Reads every material, and the images of those on `shown` nodes. A texture that cannot be read is
/// left out.
///
/// # Errors
/// The images exceed their limits.
pub fn read(
    buffers: &mut Buffers,
    shown: &[usize],
    read: &mut ReadFile,
) -> Result<(Vec<Material>, Vec<Image>), LoadError> {
    let document = buffers.document;
    let used = used(document, shown);
    let mut reader = Reader {
        notes: buffers.notes,
        buffers,
        read,
        images: Vec::new(),
        known: HashMap::new(),
        bytes: 0,
    };
    let mut materials = Vec::with_capacity(document.materials.len());
    for (index, about) in document.materials.iter().enumerate() {
        let [r, g, b, _] = about.base_color;
        let plain = Material {
            name: part_name("material", index, about.name.as_deref()),
            // What is drawn is opaque.
            base_color: [r, g, b, 1.0],
            metallic: about.metallic,
            roughness: about.roughness,
            specular: about.specular,
            emission: about.emission,
            double_sided: about.double_sided,
            unlit: about.unlit,
            ..Material::default()
        };
        materials.push(match used.contains(&index) {
            true => {
                let name = called("material", index, about.name.as_deref());
                reader.material(plain, about, &name)?
            }
            false => plain,
        });
    }
    let images = reader.images;
    Ok((materials, images))
}

/// Materials of the triangles that the scene shows.
fn used(document: &Document, shown: &[usize]) -> BTreeSet<usize> {
    let meshes = shown.iter().filter_map(|&node| document.nodes[node].mesh);
    let primitives = meshes.flat_map(|mesh| document.meshes[mesh].sound());
    primitives
        .filter(|(_, primitive)| primitive.topology.is_some())
        .filter_map(|(_, primitive)| primitive.material)
        .collect()
}

struct Reader<'a, 'b, 'c> {
    buffers: &'a mut Buffers<'b>,
    notes: &'b Notes,
    read: &'a mut ReadFile<'c>,
    images: Vec<Image>,
    /// Index of each decoded image, by its index in the file; none of one that cannot be read.
    known: HashMap<usize, Option<usize>>,
    /// Decoded size of all images so far.
    bytes: u64,
}

impl Reader<'_, '_, '_> {
    /// `plain` with its textures and the alpha cutoff of its image.
    fn material(
        &mut self,
        plain: Material,
        about: &document::Material,
        name: &str,
    ) -> Result<Material, LoadError> {
        let mut texture = |about: &Option<TextureUse>, key: &str| match about {
            Some(about) => self.texture(about, format_args!("{name}: {key}")),
            None => Ok(None),
        };
        let base_texture = texture(&about.base_texture, "baseColorTexture")?;
        let emission_texture = texture(&about.emission_texture, "emissiveTexture")?;
        let alpha_cutoff = self.alpha_cutoff(about, base_texture.as_ref(), name);
        Ok(Material {
            base_texture,
            emission_texture,
            alpha_cutoff,
            ..plain
        })
    }

    /// The alpha of the base texture below which nothing is drawn. Masks of vertices are found with
    /// the primitives.
    fn alpha_cutoff(
        &self,
        about: &document::Material,
        base: Option<&Texture>,
        name: &str,
    ) -> Option<f32> {
        match about.alpha_mode {
            AlphaMode::Opaque => None,
            AlphaMode::Mask => (about.alpha_cutoff > 0.0 && base.is_some())
                .then(|| (about.alpha_cutoff / about.base_color[3]).min(2.0)),
            AlphaMode::Blend => {
                let texels = base.map(|texture| &self.images[texture.image].levels[0].texels);
                let has_holes =
                    texels.is_some_and(|texels| texels.iter().any(|texel| texel[3] < 128));
                let instead = if has_holes {
                    "masked where its alpha is below one half"
                } else {
                    "opaque"
                };
                self.notes.add(|| {
                    format!("{name}: blending is not supported; the material is {instead}")
                });
                has_holes.then_some(0.5)
            }
        }
    }

    /// The texture of a material, which messages call `place`; none if it cannot be read.
    fn texture(
        &mut self,
        about: &TextureUse,
        place: std::fmt::Arguments,
    ) -> Result<Option<Texture>, LoadError> {
        let texture = match &self.buffers.document.textures[about.texture] {
            Ok(texture) => texture,
            Err(reason) => {
                let index = about.texture;
                self.notes
                    .fault(|| format!("{place}: texture {index}: {reason}; it is left out"));
                return Ok(None);
            }
        };
        let Some(source) = texture.image else {
            let index = about.texture;
            self.notes.add(|| {
                format!("{place}: texture {index} has no image that can be read; it is not drawn")
            });
            return Ok(None);
        };
        let Some(image) = self.image(source, place)? else {
            return Ok(None);
        };
        let sampler = texture.sampler;
        if sampler.mip_filter != MipFilter::Unused && self.images[image].levels.len() == 1 {
            let plain = std::mem::replace(
                &mut self.images[image],
                Image::new("", [1, 1], vec![[0; 4]]),
            );
            self.images[image] = plain.with_mipmaps();
        }
        Ok(Some(Texture {
            image,
            wrap: sampler.wrap,
            mag_filter: sampler.mag_filter,
            min_filter: sampler.min_filter,
            mip_filter: sampler.mip_filter,
            set: about.set,
            image_from_texcoord: about.image_from_texcoord,
        }))
    }

    /// The index of an image, which is decoded on its first use; none if it cannot be read.
    fn image(
        &mut self,
        index: usize,
        place: std::fmt::Arguments,
    ) -> Result<Option<usize>, LoadError> {
        if let Some(&in_scene) = self.known.get(&index) {
            return Ok(in_scene);
        }
        let (name, image) = match &self.buffers.document.images[index] {
            Ok(about) => {
                let name = called("image", index, about.name.as_deref());
                let image = self.decoded(about, &name);
                (name, image)
            }
            Err(reason) => (format!("image {index}"), Err(LoadError::new(reason))),
        };
        let in_scene = match image {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let reason = error.within(format_args!("{place}: {name}")).of_part()?;
                self.notes.fault(|| format!("{reason}; it is left out"));
                None
            }
        };
        self.known.insert(index, in_scene);
        Ok(in_scene)
    }

    fn decoded(&mut self, about: &document::Image, name: &str) -> Result<Image, LoadError> {
        let bytes = match &about.from {
            ImageSource::View(view) => self.buffers.view(*view)?.to_vec(),
            ImageSource::Uri(uri) => {
                let most = self.buffers.left.min(self.buffers.limits.file_bytes);
                let bytes = uri::resolve(uri, most, self.read)?;
                self.buffers.left -= bytes.len() as u64;
                bytes
            }
        };
        let format = match &bytes[..] {
            [0x89, b'P', b'N', b'G', ..] => ImageFormat::Png,
            [0xff, 0xd8, 0xff, ..] => ImageFormat::Jpeg,
            bytes if bytes.starts_with(b"RIFF") && bytes[4..].get(4..8) == Some(b"WEBP") => {
                ImageFormat::WebP
            }
            other => {
                let what =
                    other_file::named(other).map_or(String::new(), |what| format!("{what}; "));
                return Err(LoadError::new(format!(
                    "{what}it is neither PNG, JPEG nor WebP; convert it to one of them"
                )));
            }
        };
        if let Some(kind) = about
            .mime_type
            .as_deref()
            .filter(|kind| *kind != format.to_mime_type())
        {
            self.notes.fault(|| {
                format!(
                    "{name} is {}, although the file declares {}",
                    format.to_mime_type(),
                    quoted(kind)
                )
            });
        }
        let (size, texels) = decode(&bytes, format, &self.buffers.image_limits, self.bytes)?;
        self.bytes += 4 * texels.len() as u64;
        Ok(Image::new(name, size, texels))
    }
}

/// Decodes an image, besides others of `taken` bytes. Its header is checked against the limits
/// before anything is decoded.
fn decode(
    bytes: &[u8],
    format: ImageFormat,
    allowed: &Limits,
    taken: u64,
) -> Result<([u32; 2], Vec<[u8; 4]>), LoadError> {
    let failed = |error: image::ImageError| {
        LoadError::new(format!(
            "cannot decode the image: {}",
            error.to_string().replace('\n', " ")
        ))
    };
    let left = allowed.total_bytes - taken;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut most = DecoderLimits::default();
    // Up to eight bytes per texel while it is decoded, and as much again for the decoder.
    most.max_alloc = Some(4 * left.max(1 << 20));
    reader.limits(most);
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let side = limits::IMAGE_SIDE;
    if width == 0 || height == 0 || width.max(height) > side {
        return Err(LoadError::new(format!(
            "it has {width} x {height} texels; allowed: 1 to {side} along each side"
        )));
    }
    let decoded = 4 * u64::from(width) * u64::from(height);
    if decoded > left {
        return Err(allowed.exceeded(
            format_args!("with it the decoded images have {} bytes", taken + decoded),
            allowed.total_bytes,
        ));
    }
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(failed)?
        .into_rgba8();
    Ok((
        [width, height],
        bytemuck::pod_collect_to_vec(pixels.as_raw()),
    ))
}
