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
                let image = self.decoded(about, &name);
                (name, image)
            }
            Err(reason) => (format!("image {index}"), Err(LoadError::new(reason))),
        };
        let in_scene = match image {
            Ok(image) => {
                self.images
                    .push(if is_data { image.of_data() } else { image });
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
        self.bytes += 4 * texels.len() as u64;
        Ok(Image::new(name, size, texels))
    }
}

/// The alpha of the base texture below which nothing is drawn. Masks of vertices are found with the
/// primitives.
fn alpha_cutoff(about: &document::Material, has_base: bool) -> Option<f32> {
    (about.alpha_mode == AlphaMode::Mask && about.alpha_cutoff > 0.0 && has_base)
        .then(|| (about.alpha_cutoff / about.plain.base_color[3]).min(2.0))
}
