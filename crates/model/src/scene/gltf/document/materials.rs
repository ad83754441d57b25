//! Materials, textures, samplers and images.

use ::gltf::json::{
    self, extensions,
    material::VALID_ALPHA_MODES,
    texture::{Info, MagFilter, MinFilter, WrappingMode},
    texture::{VALID_MAG_FILTERS, VALID_MIN_FILTERS, VALID_WRAPPING_MODES},
};
use serde_json::Value;

use super::{
    AlphaMode, Image, ImageSource, Material, Part, Sampler, Texture, TextureUse,
    element::Element,
    read::{Lists, WEBP},
};
use crate::scene::{
    self,
    texture::{Filter, MipFilter, Wrap},
};

/// Largest emissive strength: the largest finite f16.
const BRIGHTEST: f32 = 65_504.0;

pub fn image(lists: &Lists, mut part: Element) -> Part<Image> {
    lists.check(
        &part.json,
        "bufferView",
        ("buffer views", lists.views.len()),
    )?;
    let image: json::Image = part.read(&["bufferView", "uri"])?;
    if image.buffer_view.is_some() && image.uri.is_some() {
        lists.notes.fault(|| {
            format!(
                "{}: it has both a URI and a bufferView; the bufferView is used",
                part.name
            )
        });
    }
    Ok(Image {
        name: image.name,
        from: match (image.buffer_view, image.uri) {
            (Some(view), _) => ImageSource::View(view.value()),
            (None, Some(uri)) => ImageSource::Uri(uri),
            (None, None) => return Err("it has neither a URI nor a bufferView".into()),
        },
        mime_type: image.mime_type.map(|kind| kind.0),
    })
}

pub fn texture(lists: &Lists, mut part: Element) -> Part<Texture> {
    let images = ("images", lists.images.len());
    lists.check(&part.json, "source", images)?;
    let mut image = None;
    if let Some(webp) = part.object(&["extensions", WEBP]) {
        lists.check(webp, "source", images)?;
        image = webp.get("source").and_then(Value::as_u64);
    }
    part.drop_index("sampler", ("samplers", lists.samplers.len()));
    let is_there = part.json.contains_key("source");
    let texture: json::Texture = part.read(&["source"])?;
    Ok(Texture {
        // What a texture of another format falls back to is the source.
        image: match is_there {
            true => Some(texture.source.value()),
            false => image.map(|image| image as usize),
        },
        sampler: match texture.sampler {
            Some(at) => sampler(lists, at.value()),
            None => Sampler::PLAIN,
        },
    })
}

impl Sampler {
    /// The default.
    const PLAIN: Self = Self {
        wrap: [Wrap::Repeat; 2],
        mag_filter: Filter::Linear,
        min_filter: Filter::Linear,
        mip_filter: MipFilter::Mixed,
    };
}

fn sampler(lists: &Lists, index: usize) -> Sampler {
    let plain = Sampler::PLAIN;
    let Some(mut part) = lists.element("sampler", index, &lists.samplers[index]) else {
        return plain;
    };
    part.is_free = true;
    let Some(sampler): Option<json::texture::Sampler> = lists.read(&mut part) else {
        return plain;
    };
    let wrap = |key: &str, mode| match part.lenient(part.known(key, mode, VALID_WRAPPING_MODES)) {
        Some(WrappingMode::Repeat) | None => Wrap::Repeat,
        Some(WrappingMode::MirroredRepeat) => Wrap::Mirrored,
        Some(WrappingMode::ClampToEdge) => Wrap::Clamp,
    };
    let wrap = [wrap("wrapS", sampler.wrap_s), wrap("wrapT", sampler.wrap_t)];
    let mag = sampler
        .mag_filter
        .and_then(|filter| part.lenient(part.known("magFilter", filter, VALID_MAG_FILTERS)));
    let min = sampler
        .min_filter
        .and_then(|filter| part.lenient(part.known("minFilter", filter, VALID_MIN_FILTERS)));
    let (min_filter, mip_filter) = match min {
        None => (plain.min_filter, plain.mip_filter),
        Some(MinFilter::Nearest) => (Filter::Nearest, MipFilter::Unused),
        Some(MinFilter::Linear) => (Filter::Linear, MipFilter::Unused),
        Some(MinFilter::NearestMipmapNearest) => (Filter::Nearest, MipFilter::Nearest),
        Some(MinFilter::LinearMipmapNearest) => (Filter::Linear, MipFilter::Nearest),
        Some(MinFilter::NearestMipmapLinear) => (Filter::Nearest, MipFilter::Mixed),
        Some(MinFilter::LinearMipmapLinear) => (Filter::Linear, MipFilter::Mixed),
    };
    Sampler {
        wrap,
        mag_filter: match mag {
            Some(MagFilter::Nearest) => Filter::Nearest,
            Some(MagFilter::Linear) | None => Filter::Linear,
        },
        min_filter,
        mip_filter,
    }
}

/// Where materials have textures.
const TEXTURES: [&[&str]; 8] = [
    &["pbrMetallicRoughness", "baseColorTexture"],
    &["pbrMetallicRoughness", "metallicRoughnessTexture"],
    &["normalTexture"],
    &["occlusionTexture"],
    &["emissiveTexture"],
    &[
        "extensions",
        "KHR_materials_pbrSpecularGlossiness",
        "diffuseTexture",
    ],
    &[
        "extensions",
        "KHR_materials_transmission",
        "transmissionTexture",
    ],
    &["extensions", "KHR_materials_volume", "thicknessTexture"],
];

/// Material `index`; a plain one where it is no object.
pub fn material(lists: &Lists, index: usize, value: &Value) -> Material {
    let mut part = lists.element("material", index, value);
    if let Some(part) = &mut part {
        for path in TEXTURES {
            let count = ("textures", lists.textures.len());
            if let Some(texture) = part.object(path)
                && let Err(reason) = lists.check(texture, "index", count)
            {
                part.fault(format_args!("{}: {reason}", path[path.len() - 1]));
                part.remove(path);
            }
        }
    }
    // The crate does not know of transforms of these two.
    let [occlusion, normal] = ["occlusionTexture", "normalTexture"].map(|key| {
        let part = part.as_ref()?;
        let name = format!("{}: {key}", part.name);
        let given = part.json.get(key)?.clone();
        let mut info = part.lenient(
            Element::of(lists.notes, name, &given).map_err(|_| part.wrong(key, "an object")),
        )?;
        Some(texture_use(&lists.read(&mut info)?))
    });
    let read: Option<json::Material> = part.as_mut().and_then(|part| lists.read(part));
    let read = read.unwrap_or_default();
    let reader = Reader { lists, part };
    let mut material = Material {
        name: read.name.clone(),
        plain: scene::material::Material {
            double_sided: read.double_sided,
            ..scene::material::Material::default()
        },
        textures: Default::default(),
        alpha_mode: AlphaMode::Opaque,
        alpha_cutoff: 0.5,
        has_more: false,
        passing: [None, None],
    };
    if let Some(part) = &reader.part {
        let mode = part.known("alphaMode", read.alpha_mode, VALID_ALPHA_MODES);
        material.alpha_mode = part.lenient(mode).unwrap_or_default();
    }
    if let Some(cutoff) = read.alpha_cutoff {
        match cutoff.0 {
            cutoff @ ..0.0 => reader.fault(&format_args!(
                "its alphaCutoff is {cutoff}; it must be at least 0"
            )),
            cutoff => material.alpha_cutoff = cutoff,
        }
    }
    let extensions = read.extensions.unwrap_or_default();
    let is_unlit = extensions.unlit.is_some();
    material.plain.unlit = is_unlit;
    reader.base(&read.pbr_metallic_roughness, &extensions, &mut material);
    reader.reflection(&read.pbr_metallic_roughness, &extensions, &mut material);
    if is_unlit {
        return material;
    }
    reader.transmission(&extensions, &mut material);
    material.textures[3..].clone_from_slice(&[occlusion, normal]);
    let plain = &mut material.plain;
    plain.occlusion_strength =
        (read.occlusion_texture).map_or(1.0, |given| given.strength.0.clamp(0.0, 1.0));
    plain.normal_scale = read.normal_texture.map_or(1.0, |given| given.scale);
    plain.emission = reader.emission(read.emissive_factor.0, &extensions);
    if plain.emission != [0.0; 3] {
        material.textures[1] = read.emissive_texture.as_ref().map(texture_use);
    }
    if extensions.pbr_specular_glossiness.is_none() {
        let given = &read.pbr_metallic_roughness.metallic_roughness_texture;
        material.textures[2] = given.as_ref().map(texture_use);
    }
    material
}

struct Reader<'a, 'b> {
    lists: &'b Lists<'a>,
    /// Its JSON; none of a plain one.
    part: Option<Element<'b>>,
}

fn unit<const N: usize>(color: [f32; N]) -> [f32; N] {
    color.map(|channel| channel.clamp(0.0, 1.0))
}

impl Reader<'_, '_> {
    fn fault(&self, reason: &dyn std::fmt::Display) {
        if let Some(part) = &self.part {
            part.fault(reason);
        }
    }

    /// The base color: that of the metallic-roughness model, or the diffuse color of the
    /// specular-glossiness model.
    fn base(
        &self,
        usual: &json::material::PbrMetallicRoughness,
        extensions: &extensions::material::Material,
        material: &mut Material,
    ) {
        let (color, texture) = match &extensions.pbr_specular_glossiness {
            Some(older) => {
                material.has_more = older.specular_glossiness_texture.is_some();
                (older.diffuse_factor.0, &older.diffuse_texture)
            }
            None => (usual.base_color_factor.0, &usual.base_color_texture),
        };
        material.plain.base_color = unit(color);
        material.textures[0] = texture.as_ref().map(texture_use);
    }

    /// How the material reflects: the metallic-roughness model with KHR_materials_ior and
    /// KHR_materials_specular, or the specular-glossiness model.
    fn reflection(
        &self,
        usual: &json::material::PbrMetallicRoughness,
        extensions: &extensions::material::Material,
        material: &mut Material,
    ) {
        let plain = &mut material.plain;
        if let Some(older) = &extensions.pbr_specular_glossiness {
            let [red, green, blue] = unit(older.specular_factor.0);
            plain.metallic = 0.0;
            plain.roughness = 1.0 - older.glossiness_factor.0.clamp(0.0, 1.0);
            plain.specular = [red, green, blue, 1.0];
            return;
        }
        plain.metallic = usual.metallic_factor.0.clamp(0.0, 1.0);
        plain.roughness = usual.roughness_factor.0.clamp(0.0, 1.0);
        let straight = match extensions.ior.as_ref().map_or(1.5, |given| given.ior.0) {
            // As a material of the specular-glossiness model, whose Fresnel term is 1.
            0.0 => 1.0,
            index if index < 1.0 => {
                self.fault(&format_args!(
                    "its ior is {index}; it must be 0 or at least 1"
                ));
                0.04
            }
            // Fresnel: ((n - 1) / (n + 1))².
            index => {
                let root = (f64::from(index) - 1.0) / (f64::from(index) + 1.0);
                (root * root) as f32
            }
        };
        let specular = extensions.specular.clone().unwrap_or_default();
        let factor = specular.specular_factor.0.clamp(0.0, 1.0);
        let tint = specular.specular_color_factor.0;
        let [red, green, blue] = tint.map(|tint| (straight * tint).clamp(0.0, 1.0) * factor);
        plain.specular = [red, green, blue, factor];
        material.has_more |=
            specular.specular_texture.is_some() || specular.specular_color_texture.is_some();
    }

    /// What passes through: KHR_materials_transmission, and of KHR_materials_volume what is absorbed
    /// behind the whole thickness, by the law of Beer and Lambert.
    fn transmission(&self, extensions: &extensions::material::Material, material: &mut Material) {
        if let Some(given) = &extensions.transmission {
            material.plain.transmission = given.transmission_factor.0.clamp(0.0, 1.0);
            material.passing[0] = given.transmission_texture.as_ref().map(texture_use);
        }
        if let Some(volume) = &extensions.volume {
            let thickness = volume.thickness_factor.0.max(0.0);
            let distance = volume.attenuation_distance.0;
            if distance > 0.0 {
                let distances = f64::from(thickness) / f64::from(distance);
                material.plain.attenuation = unit(volume.attenuation_color.0)
                    .map(|channel| libm::pow(channel.into(), distances) as f32);
            } else {
                self.fault(&format_args!(
                    "its attenuationDistance is {distance}; it must be above 0"
                ));
            }
            material.passing[1] = volume.thickness_texture.as_ref().map(texture_use);
        }
    }

    fn emission(&self, factor: [f32; 3], extensions: &extensions::material::Material) -> [f32; 3] {
        let given = extensions.emissive_strength.clone().unwrap_or_default();
        let strength = match given.emissive_strength.0 {
            strength @ ..0.0 => {
                self.fault(&format_args!(
                    "its emissiveStrength is {strength}; it must be at least 0"
                ));
                1.0
            }
            strength @ BRIGHTEST.. => {
                let name = self.part.as_ref().map_or("", |part| &part.name);
                self.lists.notes.add(|| {
                    format!("{name}: its emissiveStrength {strength} is drawn as {BRIGHTEST}")
                });
                BRIGHTEST
            }
            strength => strength,
        };
        unit(factor).map(|channel| channel * strength)
    }
}

/// The use of a texture, with KHR_texture_transform: scaled, then rotated, then translated. The
/// rotation is counterclockwise in an image whose v axis points down, as the extension's text and
/// test model define it; the formula next to the text rotates the other way.
fn texture_use(info: &Info) -> TextureUse {
    let mut used = TextureUse {
        texture: info.index.value(),
        set: info.tex_coord,
        image_from_texcoord: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    let extensions = info.extensions.as_ref();
    if let Some(given) = extensions.and_then(|all| all.texture_transform.as_ref()) {
        used.set = given.tex_coord.unwrap_or(used.set);
        let pair = |pair: [f32; 2]| pair.map(f64::from);
        let ([x, y], [wide, high]) = (pair(given.offset.0), pair(given.scale.0));
        let (sin, cos) = libm::sincos(given.rotation.0.into());
        used.image_from_texcoord = [[cos * wide, sin * high, x], [-sin * wide, cos * high, y]]
            .map(|row| row.map(|v| v as f32));
    }
    used
}
