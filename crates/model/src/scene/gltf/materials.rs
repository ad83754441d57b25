//! Materials: colors, textures with their samplers and transforms, and the images that they use.
//!
//! Only images that a visible primitive uses are decoded.

use std::collections::{BTreeSet, HashMap};

use super::{
    buffers::Buffers,
    document::{self, AlphaMode, Document, ImageSource, TextureUse},
    error::{LoadError, ReadFile, called, part_name, quoted},
    images,
    notes::Notes,
    uri,
};
use crate::math::{linear_light, srgb};
use crate::scene::{
    material::{Material, TEXTURE_SLOTS, TextureSlot},
    texture::{Image, MipFilter, Texture},
};

/// Supported material extensions.
pub const EXTENSIONS: [&str; 8] = [
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_volume",
];

/// What messages call the textures, in the order of [`TextureSlot`].
const TEXTURE_KEYS: [&str; TEXTURE_SLOTS] = [
    "baseColorTexture",
    "emissiveTexture",
    "metallicRoughnessTexture",
    "occlusionTexture",
    "normalTexture",
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
        let is_blended = about.alpha_mode == AlphaMode::Blend;
        let mut plain = Material {
            name: part_name("material", index, about.name.as_deref()),
            is_blended,
            ..about.plain.clone()
        };
        // A material that does not blend is opaque: the alpha of its color is ignored.
        if !is_blended {
            plain.base_color[3] = 1.0;
        }
        materials.push(match used.contains(&index) {
            true => {
                let name = called("material", index, about.name.as_deref());
                let material = reader.material(plain, about, &name)?;
                reader.passing(material, about, &name)?
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
        .filter_map(|(_, primitive)| primitive.material)
        .collect()
}

struct Reader<'a, 'b, 'c> {
    buffers: &'a mut Buffers<'b>,
    notes: &'b Notes,
    read: &'a mut ReadFile<'c>,
    images: Vec<Image>,
    /// Index of each decoded image, by its index in the file and whether its texels are data; none
    /// of one that cannot be read.
    known: HashMap<(usize, bool), Option<usize>>,
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
        let mut textures = [None; TEXTURE_SLOTS];
        for (slot, key) in TextureSlot::ALL.into_iter().zip(TEXTURE_KEYS) {
            if let Some(about) = &about.textures[slot as usize] {
                let place = format_args!("{name}: {key}");
                textures[slot as usize] = self.texture(about, slot.is_data(), place)?;
            }
        }
        let [base, emission, finish, occlusion, normal] = textures;
        Ok(Material {
            base_texture: base,
            emission_texture: emission,
            finish_texture: finish,
            occlusion_texture: occlusion,
            normal_texture: normal,
            alpha_cutoff: alpha_cutoff(about, base.is_some()),
            ..plain
        })
    }

    /// `material` with its textures of transmission and thickness in those of its color, whose alpha an
    /// opaque material does not need otherwise.
    fn passing(
        &mut self,
        material: Material,
        about: &document::Material,
        name: &str,
    ) -> Result<Material, LoadError> {
        const KEYS: [&str; 2] = ["transmissionTexture", "thicknessTexture"];
        let mut given = [None, None];
        if !material.transmits() || about.passing.iter().all(Option::is_none) {
            return Ok(material);
        }
        for ((given, about), key) in given.iter_mut().zip(&about.passing).zip(KEYS) {
            if let Some(about) = about {
                *given = self.texture(about, true, format_args!("{name}: {key}"))?;
            }
        }
        let all = [material.base_texture, given[0], given[1]];
        let Some(lead) = all.into_iter().flatten().next() else {
            return Ok(material);
        };
        let place = |texture: &Texture| (texture.set, texture.image_from_texcoord, texture.wrap);
        let is_together = all
            .iter()
            .flatten()
            .all(|texture| place(texture) == place(&lead));
        let images =
            all.map(|texture| texture.map(|texture| &self.images[texture.image].levels[0]));
        let size = [0, 1].map(|axis| {
            let sides = images.iter().flatten().map(|level| level.size[axis]);
            sides.max().unwrap_or(1)
        });
        let bytes = 4 * u64::from(size[0]) * u64::from(size[1]);
        let has_room = self.bytes + bytes <= self.buffers.image_limits.total_bytes;
        if !is_together || !has_room || material.is_blended || material.alpha_cutoff.is_some() {
            self.notes.add(|| {
                format!(
                    "{name}: its textures of transmission and thickness are not drawn: they are only with the coordinates of those of its color, in an opaque material"
                )
            });
            return Ok(material);
        }
        let texel = |image: usize, x: u32, y: u32| {
            images[image].map(|level| {
                let [x, y] = [(x, 0), (y, 1)].map(|(at, axis)| {
                    (u64::from(at) * u64::from(level.size[axis]) / u64::from(size[axis])) as usize
                });
                level.texels[y * level.size[0] as usize + x]
            })
        };
        let tint = |byte: u8, channel: usize, part: [f64; 2]| {
            let left = libm::pow(material.attenuation[channel].into(), part[1]);
            // What scatters its color does not pass the thickness.
            let kept = 1.0 + part[0] * f64::from(material.transmission) * (left - 1.0);
            (srgb(linear_light(f64::from(byte) / 255.0) * kept) * 255.0).round() as u8
        };
        let mut texels = Vec::with_capacity(bytes as usize / 4);
        for at in 0..size[0] * size[1] {
            let (x, y) = (at % size[0], at / size[0]);
            let passed = texel(1, x, y).map_or(255, |texel| texel[0]);
            let mut color = texel(0, x, y).unwrap_or([255; 4]);
            if let Some(thickness) = texel(2, x, y) {
                let part = [passed, thickness[1]].map(|byte| f64::from(byte) / 255.0);
                (0..3).for_each(|channel| color[channel] = tint(color[channel], channel, part));
            }
            color[3] = passed;
            texels.push(color);
        }
        let attenuation = if given[1].is_some() {
            [1.0; 3]
        } else {
            material.attenuation
        };
        self.bytes += bytes;
        self.images
            .push(Image::new(name, size, texels).with_mipmaps());
        Ok(Material {
            base_texture: Some(Texture {
                image: self.images.len() - 1,
                ..lead
            }),
            transmits_by_alpha: true,
            attenuation,
            ..material
        })
    }

    /// The texture of a material, which messages call `place`; none if it cannot be read.
    fn texture(
        &mut self,
        about: &TextureUse,
        is_data: bool,
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
        let Some(image) = self.image(source, is_data, place)? else {
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
        is_data: bool,
        place: std::fmt::Arguments,
    ) -> Result<Option<usize>, LoadError> {
        if let Some(&in_scene) = self.known.get(&(index, is_data)) {
            return Ok(in_scene);
        }
        let (name, image) = match &self.buffers.document.images[index] {
            Ok(about) => {
                let name = called("image", index, about.name.as_deref());
                let image = self.decoded(about, &name, is_data);
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
        self.known.insert((index, is_data), in_scene);
        Ok(in_scene)
    }

    fn decoded(
        &mut self,
        about: &document::Image,
        name: &str,
        is_data: bool,
    ) -> Result<Image, LoadError> {
        let bytes = match &about.from {
            ImageSource::View(view) => self.buffers.view(*view)?.to_vec(),
            ImageSource::Uri(uri) => {
                let most = self.buffers.left.min(self.buffers.limits.file_bytes);
                let bytes = uri::resolve(uri, most, self.read)?;
                self.buffers.left -= bytes.len() as u64;
                bytes
            }
        };
        let format = images::format_of(&bytes)?;
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
        let (size, texels) =
            images::decode(&bytes, format, &self.buffers.image_limits, self.bytes)?;
        let image = Image::new(name, size, texels);
        let (image, note) = images::fitted(if is_data { image.of_data() } else { image });
        self.notes.extend(note);
        self.bytes += image.bytes();
        Ok(image)
    }
}

/// The alpha of the base texture below which nothing is drawn. Masks of vertices are found with the
/// primitives.
fn alpha_cutoff(about: &document::Material, has_base: bool) -> Option<f32> {
    (about.alpha_mode == AlphaMode::Mask && about.alpha_cutoff > 0.0 && has_base)
        .then(|| (about.alpha_cutoff / about.plain.base_color[3]).min(2.0))
}
