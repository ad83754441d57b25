//! Materials: colors, textures with their samplers and transforms, and the images that they use.
//!
//! Only images that a visible primitive uses are decoded, within [`limits`] and only at the size in
//! their header.

use std::{
    collections::{BTreeSet, HashMap},
    io::Cursor,
};

use gltf::json::{
    self,
    material::AlphaMode,
    mesh::Mode,
    texture::{MagFilter, MinFilter, WrappingMode},
    validation::Checked,
};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::{
    buffers::Buffers,
    error::{LoadError, ReadFile, called, part_name, quoted},
    limits,
    notes::Notes,
    uri,
};
use crate::scene::{
    material::Material,
    texture::{Filter, Image, MipFilter, Texture, Wrap},
};

/// Supported material extensions.
pub const EXTENSIONS: [&str; 3] = [
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
];

/// Largest emissive strength: the largest finite f16.
const BRIGHTEST: f32 = 65_504.0;

/// Reads every material, and the images of those on `shown` nodes. `notes` receives messages about
/// what is drawn differently.
pub fn read(
    buffers: &mut Buffers,
    shown: &[usize],
    read: &mut ReadFile,
    notes: &mut Notes,
) -> Result<(Vec<Material>, Vec<Image>), LoadError> {
    let root = buffers.root;
    let used = used(root, shown);
    let mut reader = Reader {
        buffers,
        read,
        images: Vec::new(),
        known: HashMap::new(),
        bytes: 0,
        notes,
    };
    let material = |(index, about): (usize, &json::Material)| {
        let name = called("material", index, about.name.as_deref());
        let material = Material {
            name: part_name("material", index, about.name.as_deref()),
            base_color: about
                .pbr_metallic_roughness
                .base_color_factor
                .0
                .map(|channel| channel.clamp(0.0, 1.0)),
            double_sided: about.double_sided,
            ..Material::default()
        };
        if !used.contains(&index) {
            return Ok(material);
        }
        reader
            .material(material, about)
            .map_err(|error| error.within(name))
    };
    let materials = root
        .materials
        .iter()
        .enumerate()
        .map(material)
        .collect::<Result<_, _>>()?;
    let images = reader.images;
    Ok((materials, images))
}

/// Checks the sources of all images, even of unused ones.
pub fn check_images(buffers: &Buffers) -> Result<(), LoadError> {
    for (index, image) in buffers.root.images.iter().enumerate() {
        let in_image =
            |error: LoadError| error.within(called("image", index, image.name.as_deref()));
        match (image.buffer_view, &image.uri) {
            (Some(view), _) => drop(buffers.view_length(view.value()).map_err(in_image)?),
            (None, None) => {
                return Err(in_image(LoadError::new(
                    "it has neither a URI nor a bufferView",
                )));
            }
            (None, Some(_)) => {}
        }
    }
    Ok(())
}

/// Materials of the triangles that the scene shows.
fn used(root: &json::Root, shown: &[usize]) -> BTreeSet<usize> {
    let meshes = shown
        .iter()
        .filter_map(|&node| root.nodes[node].mesh)
        .map(|mesh| &root.meshes[mesh.value()]);
    let is_drawn = |mode: &Checked<Mode>| {
        matches!(
            mode,
            Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
        )
    };
    let primitives = meshes
        .flat_map(|mesh| &mesh.primitives)
        .filter(|primitive| is_drawn(&primitive.mode));
    primitives
        .filter_map(|primitive| primitive.material)
        .map(|material| material.value())
        .collect()
}

/// Returns true if alpha masking discards all of it.
pub fn is_invisible(about: &json::Material) -> bool {
    let alpha = about.pbr_metallic_roughness.base_color_factor.0[3];
    let alpha_cutoff = about
        .alpha_cutoff
        .map_or(0.5, |alpha_cutoff| alpha_cutoff.0);
    let is_masked = about.alpha_mode == Checked::Valid(AlphaMode::Mask);
    is_masked && about.pbr_metallic_roughness.base_color_texture.is_none() && alpha < alpha_cutoff
}

struct Reader<'a, 'b, 'c> {
    buffers: &'a mut Buffers<'b>,
    read: &'a mut ReadFile<'c>,
    images: Vec<Image>,
    /// Index of each decoded image, by its index in the file.
    known: HashMap<usize, usize>,
    /// Decoded size of all images so far.
    bytes: u64,
    notes: &'a mut Notes,
}

impl Reader<'_, '_, '_> {
    /// `plain` with its textures, emission and alpha cutoff.
    fn material(&mut self, plain: Material, about: &json::Material) -> Result<Material, LoadError> {
        let base = about.pbr_metallic_roughness.base_color_texture.as_ref();
        let base_texture = base
            .map(|info| {
                self.texture(info)
                    .map_err(|error| error.within("baseColorTexture"))
            })
            .transpose()?;
        let plain = self.masked(
            Material {
                base_texture,
                ..plain
            },
            about,
        )?;
        let extensions = about.extensions.as_ref();
        if extensions.is_some_and(|extensions| extensions.unlit.is_some()) {
            return Ok(Material {
                unlit: true,
                ..plain
            });
        }
        let strength = extensions
            .and_then(|extensions| extensions.emissive_strength.as_ref())
            .map_or(1.0, |s| s.emissive_strength.0);
        if !(0.0..=BRIGHTEST).contains(&strength) {
            return Err(LoadError::new(format!(
                "emissiveStrength is {strength}; allowed: 0 to {BRIGHTEST}"
            )));
        }
        let emission = about
            .emissive_factor
            .0
            .map(|channel| channel.clamp(0.0, 1.0) * strength);
        let glow = about
            .emissive_texture
            .as_ref()
            .filter(|_| emission != [0.0; 3]);
        let emission_texture = glow
            .map(|info| {
                self.texture(info)
                    .map_err(|error| error.within("emissiveTexture"))
            })
            .transpose()?;
        Ok(Material {
            emission,
            emission_texture,
            ..plain
        })
    }

    /// Adds the alpha cutoff of MASK and BLEND materials. What is drawn of them is opaque.
    fn masked(&mut self, plain: Material, about: &json::Material) -> Result<Material, LoadError> {
        let name = quoted(&plain.name);
        let alpha = plain.base_color[3];
        let opaque = Material {
            base_color: [
                plain.base_color[0],
                plain.base_color[1],
                plain.base_color[2],
                1.0,
            ],
            ..plain.clone()
        };
        match about.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                let alpha_cutoff = about
                    .alpha_cutoff
                    .map_or(0.5, |alpha_cutoff| alpha_cutoff.0);
                if !(alpha_cutoff >= 0.0 && alpha_cutoff.is_finite()) {
                    return Err(LoadError::new(format!(
                        "alphaCutoff is {alpha_cutoff}; it must be finite and at least 0"
                    )));
                }
                let alpha_cutoff = (alpha_cutoff > 0.0 && opaque.base_texture.is_some())
                    .then(|| (alpha_cutoff / alpha).min(2.0));
                Ok(Material {
                    alpha_cutoff,
                    ..opaque
                })
            }
            Checked::Valid(AlphaMode::Blend) => {
                let texels = opaque
                    .base_texture
                    .map(|texture| &self.images[texture.image].levels[0].texels);
                let has_holes =
                    texels.is_some_and(|texels| texels.iter().any(|texel| texel[3] < 128));
                let instead = if has_holes {
                    "masked where its alpha is below one half"
                } else {
                    "opaque"
                };
                self.notes.add(|| {
                    format!("material {name}: blending is not supported; the material is {instead}")
                });
                Ok(Material {
                    alpha_cutoff: has_holes.then_some(0.5),
                    ..opaque
                })
            }
            _ => Ok(plain),
        }
    }

    fn texture(&mut self, info: &json::texture::Info) -> Result<Texture, LoadError> {
        let (root, index) = (self.buffers.root, info.index.value());
        let texture = &root.textures[index];
        let sampler = texture
            .sampler
            .map(|sampler| &root.samplers[sampler.value()]);
        let wrap =
            |pick: fn(&json::texture::Sampler) -> Checked<WrappingMode>| match sampler.map(pick) {
                None | Some(Checked::Valid(WrappingMode::Repeat)) => Ok(Wrap::Repeat),
                Some(Checked::Valid(WrappingMode::MirroredRepeat)) => Ok(Wrap::Mirrored),
                Some(Checked::Valid(WrappingMode::ClampToEdge)) => Ok(Wrap::Clamp),
                Some(Checked::Invalid) => Err(LoadError::new(
                    "the wrap mode of its sampler is not one of glTF 2.0",
                )),
            };
        let wrap = [
            wrap(|sampler| sampler.wrap_s)?,
            wrap(|sampler| sampler.wrap_t)?,
        ];
        let unknown = || LoadError::new("a filter of its sampler is not one of glTF 2.0");
        // The default where the file specifies no filter: linear.
        let mag_filter = match sampler.and_then(|sampler| sampler.mag_filter) {
            None | Some(Checked::Valid(MagFilter::Linear)) => Filter::Linear,
            Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
            Some(Checked::Invalid) => return Err(unknown()),
        };
        let (min_filter, mip_filter) = match sampler.and_then(|sampler| sampler.min_filter) {
            None | Some(Checked::Valid(MinFilter::LinearMipmapLinear)) => {
                (Filter::Linear, MipFilter::Mixed)
            }
            Some(Checked::Valid(MinFilter::Nearest)) => (Filter::Nearest, MipFilter::Unused),
            Some(Checked::Valid(MinFilter::Linear)) => (Filter::Linear, MipFilter::Unused),
            Some(Checked::Valid(MinFilter::NearestMipmapNearest)) => {
                (Filter::Nearest, MipFilter::Nearest)
            }
            Some(Checked::Valid(MinFilter::LinearMipmapNearest)) => {
                (Filter::Linear, MipFilter::Nearest)
            }
            Some(Checked::Valid(MinFilter::NearestMipmapLinear)) => {
                (Filter::Nearest, MipFilter::Mixed)
            }
            Some(Checked::Invalid) => return Err(unknown()),
        };
        let (image_from_texcoord, set) = transform(info)?;
        let image = self.image(texture.source.value())?;
        if mip_filter != MipFilter::Unused && self.images[image].levels.len() == 1 {
            let plain = std::mem::replace(
                &mut self.images[image],
                Image::new("", [1, 1], vec![[0; 4]]),
            );
            self.images[image] = plain.with_mipmaps();
        }
        Ok(Texture {
            image,
            wrap,
            mag_filter,
            min_filter,
            mip_filter,
            set,
            image_from_texcoord,
        })
    }

    /// The index of an image, which is decoded on its first use.
    fn image(&mut self, index: usize) -> Result<usize, LoadError> {
        if let Some(&in_image) = self.known.get(&index) {
            return Ok(in_image);
        }
        let about = &self.buffers.root.images[index];
        let name = called("image", index, about.name.as_deref());
        let image = self
            .decoded(about, &name)
            .map_err(|error| error.within(&name))?;
        self.images.push(image);
        self.known.insert(index, self.images.len() - 1);
        Ok(self.images.len() - 1)
    }

    fn decoded(&mut self, about: &json::Image, name: &str) -> Result<Image, LoadError> {
        let bytes = match (about.buffer_view, &about.uri) {
            (Some(view), None) => self.buffers.view(view.value())?.to_vec(),
            (None, Some(uri)) => {
                let bytes = uri::resolve(
                    uri,
                    self.buffers.left.min(self.buffers.limits.file_bytes),
                    self.read,
                )?;
                self.buffers.left -= bytes.len() as u64;
                bytes
            }
            (Some(_), Some(_)) => {
                return Err(LoadError::new(
                    "it has both a URI and a bufferView; remove one of them",
                ));
            }
            (None, None) => return Err(LoadError::new("it has neither a URI nor a bufferView")),
        };
        let format = match &bytes[..] {
            [0x89, b'P', b'N', b'G', ..] => ImageFormat::Png,
            [0xff, 0xd8, 0xff, ..] => ImageFormat::Jpeg,
            [
                b'R',
                b'I',
                b'F',
                b'F',
                _,
                _,
                _,
                _,
                b'W',
                b'E',
                b'B',
                b'P',
                ..,
            ] => ImageFormat::WebP,
            _ => {
                return Err(LoadError::new(
                    "it is neither PNG, JPEG nor WebP; convert it to one of them",
                ));
            }
        };
        if let Some(kind) = about
            .mime_type
            .as_ref()
            .map(|kind| kind.0.as_str())
            .filter(|kind| *kind != format.to_mime_type())
        {
            self.notes.add(|| {
                format!(
                    "{name} is {}, although the file declares {}",
                    format.to_mime_type(),
                    quoted(kind)
                )
            });
        }
        let (size, texels) = decode(&bytes, format, limits::IMAGES_BYTES - self.bytes)?;
        self.bytes += 4 * texels.len() as u64;
        Ok(Image::new(name, size, texels))
    }
}

/// The map from stored texture coordinates to image coordinates, and the set of coordinates that it
/// uses.
///
/// KHR_texture_transform: scaled, then rotated, then translated. The rotation is counterclockwise
/// in an image whose v axis points down, as the extension's text and test model define it; the
/// formula next to the text rotates the other way.
fn transform(info: &json::texture::Info) -> Result<([[f32; 3]; 2], u32), LoadError> {
    let Some(given) = info
        .extensions
        .as_ref()
        .and_then(|extensions| extensions.texture_transform.as_ref())
    else {
        return Ok(([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], info.tex_coord));
    };
    let [[x, y], [wide, high]] = [given.offset.0, given.scale.0].map(|pair| pair.map(f64::from));
    let (sin, cos) = libm::sincos(given.rotation.0.into());
    let rows = [[cos * wide, sin * high, x], [-sin * wide, cos * high, y]]
        .map(|row| row.map(|v| v as f32));
    if rows.as_flattened().iter().any(|v| !v.is_finite()) {
        return Err(LoadError::new(
            "KHR_texture_transform has a value that is not finite",
        ));
    }
    Ok((rows, given.tex_coord.unwrap_or(info.tex_coord)))
}

/// Decodes an image. Its header is checked against the limits before anything is decoded.
fn decode(
    bytes: &[u8],
    format: ImageFormat,
    left: u64,
) -> Result<([u32; 2], Vec<[u8; 4]>), LoadError> {
    let failed = |error: image::ImageError| {
        LoadError::new(format!(
            "cannot decode the image: {}",
            error.to_string().replace('\n', " ")
        ))
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut most = Limits::default();
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
        let all = limits::IMAGES_BYTES - left + decoded;
        return Err(LoadError::new(format!(
            "with it the decoded images have {all} bytes; allowed: at most {}",
            limits::IMAGES_BYTES
        )));
    }
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(failed)?
        .into_rgba8();
    Ok((
        [width, height],
        bytemuck::pod_collect_to_vec(pixels.as_raw()),
    ))
}
