//! Texels: what the resolve knows of materials that are more than a base color, in one texture that
//! costs no storage buffer.
//!
//! The texture is used as a row of words (`WordTexture::of_words`): sRGB decoded, a word per byte; a
//! record per primitive; behind the records, for each primitive, what light passes through it, how it
//! reflects and the maps that effects read, each where a kernel needs it; where the vertices of masked
//! ones lie in their images; then where the levels of each image that is looked up begin, and the levels of all these
//! images, a texel a word. Mirrors of `shaders/lib/material_atlas.wgsl`.

use std::mem::size_of;

use super::attributes::format_word;
use crate::{
    device::{Gpu, error::RenderError},
    effects::hooks::{Finish, Transmission},
    layout::{
        TextureId,
        records::{FinishRecord, LookupRecord, MapsRecord, MaterialRecord, TransmissionRecord},
    },
    math::linear_light,
    resources::textures::WordTexture,
    scene::{Primitive, Scene, material::TextureSlot, texture::texcoord},
    shader::key::SurfaceInputs,
};

/// Words of a primitive's record: its paint, and how base color and emission are looked up.
pub const RECORD_WORDS: usize = (size_of::<MaterialRecord>() + 2 * size_of::<LookupRecord>()) / 4;

/// Bits of [`MaterialRecord::flags`].
const BASE_TEXTURE: u32 = 1;
const EMISSION_TEXTURE: u32 = 2;
const UNLIT: u32 = 4;
const MASKED: u32 = 8;
/// The word of the primitive's finish, from this bit on.
const FINISH_SHIFT: u32 = 4;

/// The words that the bits above that count.
const MAX_FINISH_WORD: usize = 1 << (32 - FINISH_SHIFT);
/// Words of a primitive's finish.
const FINISH_WORDS: usize = size_of::<FinishRecord>() / 4;
/// Words of what passes through a primitive, before its finish.
const TRANSMISSION_WORDS: usize = size_of::<TransmissionRecord>() / 4;

/// The textures behind a finish, where an effect reads any: in order.
const MAP_SLOTS: [TextureSlot; 3] = [
    TextureSlot::Finish,
    TextureSlot::Occlusion,
    TextureSlot::Normal,
];

/// Words of the maps of a primitive, behind its finish.
const MAPS_WORDS: usize =
    (size_of::<MapsRecord>() + MAP_SLOTS.len() * size_of::<LookupRecord>()) / 4;

/// What an atlas tells beside colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AtlasContents {
    /// How materials reflect.
    pub has_finish: bool,
    /// What passes through them.
    pub has_transmission: bool,
    /// By their textures, too.
    pub has_finish_maps: bool,
    /// How textures turn normals.
    pub has_normal_maps: bool,
}

impl AtlasContents {
    /// What these inputs look up; none if they need no atlas.
    pub fn of(inputs: &SurfaceInputs) -> Option<Self> {
        (inputs.has_material_atlas || inputs.has_finish).then_some(Self {
            has_finish: inputs.has_finish,
            has_transmission: inputs.has_transmission,
            has_finish_maps: inputs.has_finish_maps,
            has_normal_maps: inputs.has_normal_maps,
        })
    }

    /// Is all that `other` tells here, too?
    pub fn includes(self, other: Self) -> bool {
        (self.has_finish || !other.has_finish)
            && (self.has_transmission || !other.has_transmission)
            && (self.has_finish_maps || !other.has_finish_maps)
            && (self.has_normal_maps || !other.has_normal_maps)
    }

    /// Is the texture in a slot looked up?
    fn has(self, slot: TextureSlot) -> bool {
        match slot {
            TextureSlot::Base | TextureSlot::Emission => true,
            TextureSlot::Finish | TextureSlot::Occlusion => self.has_finish_maps,
            TextureSlot::Normal => self.has_normal_maps,
        }
    }

    /// Words of a primitive behind its record.
    fn words(self) -> usize {
        let reflected = match (
            self.has_finish,
            self.has_finish_maps || self.has_normal_maps,
        ) {
            (false, false) => 0,
            (true, false) => FINISH_WORDS,
            (_, true) => FINISH_WORDS + MAPS_WORDS,
        };
        self.transmission_words() + reflected
    }

    /// Words of a primitive before its finish.
    fn transmission_words(self) -> usize {
        if self.has_transmission {
            TRANSMISSION_WORDS
        } else {
            0
        }
    }
}

/// Uploads what the materials of `scene` need, with these contents.
pub async fn upload(
    gpu: &Gpu,
    scene: &Scene,
    contents: AtlasContents,
) -> Result<WordTexture, RenderError> {
    let id = TextureId::MaterialAtlas;
    let before_images = 256 + (RECORD_WORDS + contents.words()) * scene.primitives.len();
    if contents.words() > 0 && before_images >= MAX_FINISH_WORD {
        return Err(RenderError::TooLarge {
            buffer: id.name(),
            bytes: 4 * before_images as u64,
            limit: 4 * MAX_FINISH_WORD as u64,
        });
    }
    WordTexture::of_words(gpu, id, words(scene, contents)).await
}

/// Everything, word after word.
fn words(scene: &Scene, contents: AtlasContents) -> Vec<u32> {
    let mut words: Vec<u32> = (0..256)
        .map(|byte| (linear_light(f64::from(byte) / 255.0) as f32).to_bits())
        .collect();
    // A record at least, even where nothing is to be drawn.
    let records = scene.primitives.len().max(1);
    let first_finish = words.len() + RECORD_WORDS * records;
    let finish_words = contents.words();
    let mut first = first_finish + finish_words * records;
    let finish_at = |index: usize| match finish_words {
        0 => 0,
        words => {
            let finish = first_finish + words * index + contents.transmission_words();
            (finish as u32) << FINISH_SHIFT
        }
    };
    let corners = corners(scene, &mut first);
    let lists = Lists::of(scene, contents, first as u32);
    let lookup = |primitive: &Primitive, slot: TextureSlot| {
        let texture = scene.materials[primitive.material].texture(slot);
        match (texture, primitive.texcoords[slot as usize]) {
            (Some(texture), Some(texcoords)) if contents.has(slot) => {
                let image = &scene.images[texture.image];
                let [width, height] = image.size();
                let [across, down] = texture.wrap.map(|wrap| wrap as u32);
                let filters = (texture.mag_filter as u32) << 4 | (texture.min_filter as u32) << 5;
                let mip_filter =
                    (texture.mip_filter as u32) << 6 | (image.levels.len() as u32) << 8;
                let [[u_per_u, u_per_v, u_offset], [v_per_u, v_per_v, v_offset]] =
                    texture.image_from_texcoord;
                LookupRecord {
                    levels: lists.places[texture.image],
                    size: width | height << 16,
                    sampling: across | down << 2 | filters | mip_filter,
                    format: format_word(&texcoords),
                    offset: texcoords.offset,
                    stride: texcoords.stride,
                    u_per_u,
                    u_per_v,
                    u_offset,
                    v_per_u,
                    v_per_v,
                    v_offset,
                }
            }
            _ => LookupRecord::default(),
        }
    };
    for (index, (primitive, corners)) in scene.primitives.iter().zip(&corners).enumerate() {
        let material = &scene.materials[primitive.material];
        let [base, glow, ..] = material.textures();
        let flag = |is_there: bool, bit: u32| if is_there { bit } else { 0 };
        let textures = flag(base.is_some(), BASE_TEXTURE) | flag(glow.is_some(), EMISSION_TEXTURE);
        let flags = textures
            | flag(material.unlit, UNLIT)
            | flag(material.alpha_threshold().is_some(), MASKED)
            | finish_at(index);
        let [red, green, blue] = material.emission;
        let (alpha_threshold, first_corner) =
            (material.alpha_threshold().unwrap_or(0), corners.first);
        words.extend_from_slice(bytemuck::cast_slice(&[MaterialRecord {
            flags,
            red,
            green,
            blue,
            alpha_threshold,
            first_corner,
        }]));
        let slots = [TextureSlot::Base, TextureSlot::Emission];
        let lookups = slots.map(|slot| lookup(primitive, slot));
        words.extend_from_slice(bytemuck::cast_slice(&lookups));
    }
    words.resize(first_finish, 0);
    if finish_words > 0 {
        for primitive in &scene.primitives {
            if contents.has_transmission {
                words.extend_from_slice(bytemuck::cast_slice(&[transmission(primitive, scene)]));
            }
            words.extend_from_slice(bytemuck::cast_slice(&[finish(primitive, scene)]));
            if contents.has_finish_maps || contents.has_normal_maps {
                words.extend_from_slice(bytemuck::cast_slice(&[maps(primitive, scene, contents)]));
                let lookups = MAP_SLOTS.map(|slot| lookup(primitive, slot));
                words.extend_from_slice(bytemuck::cast_slice(&lookups));
            }
        }
        words.resize(first_finish + finish_words * records, 0);
    }
    words.extend(corners.iter().flat_map(|corners| &corners.words));
    words.extend(&lists.words);
    let used = used_images(scene, contents);
    let images = scene
        .images
        .iter()
        .zip(used)
        .filter(|(_, is_used)| *is_used);
    for level in images.flat_map(|(image, _)| &image.levels) {
        words.extend(level.texels.iter().map(|&texel| u32::from_le_bytes(texel)));
    }
    words
}

/// How a primitive reflects.
fn finish(primitive: &Primitive, scene: &Scene) -> FinishRecord {
    let finish = Finish::from(&scene.materials[primitive.material]);
    let [red, green, blue, grazing] = finish.specular.as_vec4().to_array();
    FinishRecord {
        red,
        green,
        blue,
        grazing,
        metallic: finish.metallic as f32,
        roughness: finish.roughness as f32,
    }
}

/// What passes through a primitive.
fn transmission(primitive: &Primitive, scene: &Scene) -> TransmissionRecord {
    let known = Transmission::of(&scene.materials[primitive.material]);
    known.map_or(TransmissionRecord::default(), |transmission| {
        let [red, green, blue] = transmission.attenuated.as_vec3().to_array();
        TransmissionRecord {
            red,
            green,
            blue,
            amount: transmission.amount as f32,
            is_opaque: match transmission.is_by_alpha {
                true => 2,
                false => transmission.is_opaque.into(),
            },
        }
    })
}

/// Which maps of a primitive are looked up, bit k for the slot k of [`MAP_SLOTS`], and by which
/// factors.
fn maps(primitive: &Primitive, scene: &Scene, contents: AtlasContents) -> MapsRecord {
    let material = &scene.materials[primitive.material];
    let bit = |(slot, bit): (TextureSlot, u32)| {
        let is_seen = slot == TextureSlot::Normal || material.has_finish_maps();
        let is_there = material.texture(slot).is_some() && is_seen && contents.has(slot);
        u32::from(is_there) << bit
    };
    MapsRecord {
        flags: MAP_SLOTS.into_iter().zip(0..).map(bit).sum(),
        occlusion_strength: material.occlusion_strength,
        normal_scale: material.normal_scale,
        tangents: primitive.tangents.map_or(0, |tangents| tangents.offset),
    }
}

/// For each image of the scene, whether a texture that is looked up shows it.
fn used_images(scene: &Scene, contents: AtlasContents) -> Vec<bool> {
    let mut used = vec![false; scene.images.len()];
    let slots = || {
        TextureSlot::ALL
            .into_iter()
            .filter(move |slot| contents.has(*slot))
    };
    let textures = scene
        .materials
        .iter()
        .flat_map(|material| slots().filter_map(move |slot| material.texture(slot)));
    textures.for_each(|texture| used[texture.image] = true);
    used
}

/// Where the levels of the images that are looked up begin, an image after another.
struct Lists {
    /// Word of each image's list.
    places: Vec<u32>,
    words: Vec<u32>,
}

impl Lists {
    /// From word `first` on, with the levels right behind.
    fn of(scene: &Scene, contents: AtlasContents, first: u32) -> Self {
        let used = used_images(scene, contents);
        let images = || scene.images.iter().zip(&used);
        let mut level_word = first
            + images()
                .filter(|(_, is_used)| **is_used)
                .map(|(image, _)| image.levels.len() as u32)
                .sum::<u32>();
        let (mut places, mut words) = (Vec::new(), Vec::new());
        for (image, is_used) in images() {
            places.push(first + words.len() as u32);
            for level in image.levels.iter().filter(|_| *is_used) {
                words.push(level_word);
                level_word += level.texels.len() as u32;
            }
        }
        Self { places, words }
    }
}

/// Where the vertices of a primitive with a mask lie in its image; no words for others.
struct Corners {
    first: u32,
    words: Vec<u32>,
}

/// Those of all primitives, from word `first` on, which moves behind them.
fn corners(scene: &Scene, first: &mut usize) -> Vec<Corners> {
    let of_primitive = |primitive: &Primitive| {
        let material = &scene.materials[primitive.material];
        let masked = material
            .base_texture
            .as_ref()
            .filter(|_| material.alpha_threshold().is_some())
            .zip(primitive.texcoords[0]);
        let words = masked.map_or(Vec::new(), |(texture, texcoords)| {
            let size = scene.images[texture.image].size();
            let units = |vertex| {
                texture
                    .units(size, texcoord(&texcoords, &scene.vertex_bytes, vertex))
                    .map(|v| v as u32)
            };
            (0..primitive.vertex_count()).flat_map(units).collect()
        });
        let corners = Corners {
            first: *first as u32,
            words,
        };
        *first += corners.words.len();
        corners
    };
    scene.primitives.iter().map(of_primitive).collect()
}
