//! Materials, textures, samplers and images.

use serde_json::Value;

use super::{
    super::error::called,
    AlphaMode, Image, ImageSource, Material, Part, Sampler, Texture, TextureUse,
    fields::{Field, Lenient, Object, needed},
    read::{Lists, WEBP},
};
use crate::scene::texture::{Filter, MipFilter, Wrap};

/// Largest emissive strength: the largest finite f16.
const BRIGHTEST: f32 = 65_504.0;

const WRAPS: [(u64, Wrap); 3] = [
    (10497, Wrap::Repeat),
    (33648, Wrap::Mirrored),
    (33071, Wrap::Clamp),
];

const MAG_FILTERS: [(u64, Filter); 2] = [(9728, Filter::Nearest), (9729, Filter::Linear)];

const MIN_FILTERS: [(u64, (Filter, MipFilter)); 6] = [
    (9728, (Filter::Nearest, MipFilter::Unused)),
    (9729, (Filter::Linear, MipFilter::Unused)),
    (9984, (Filter::Nearest, MipFilter::Nearest)),
    (9985, (Filter::Linear, MipFilter::Nearest)),
    (9986, (Filter::Nearest, MipFilter::Mixed)),
    (9987, (Filter::Linear, MipFilter::Mixed)),
];

const ALPHA_MODES: [(&str, AlphaMode); 3] = [
    ("OPAQUE", AlphaMode::Opaque),
    ("MASK", AlphaMode::Mask),
    ("BLEND", AlphaMode::Blend),
];

pub fn image(lists: &Lists, index: usize, part: Object) -> Part<Image> {
    let lenient = lists.lenient("image", index, part);
    let view = part.index("bufferView", "buffer views", lists.views.len())?;
    let uri = part.text("uri")?;
    if view.is_some() && uri.is_some() {
        lists.notes.fault(|| {
            format!(
                "{}: it has both a URI and a bufferView; the bufferView is used",
                lenient.name
            )
        });
    }
    let from = match (view, uri) {
        (Some(view), _) => ImageSource::View(view),
        (None, Some(uri)) => ImageSource::Uri(uri.to_owned()),
        (None, None) => return Err("it has neither a URI nor a bufferView".into()),
    };
    Ok(Image {
        name: part.text("name").ok().flatten().map(str::to_owned),
        from,
        mime_type: lenient.field(part.text("mimeType")).map(str::to_owned),
    })
}

pub fn texture(lists: &Lists, index: usize, part: Object) -> Part<Texture> {
    let lenient = lists.lenient("texture", index, part);
    let images = lists.images.len();
    let webp = match part.extension(WEBP)? {
        Some(extension) => extension.index("source", "images", images)?,
        None => None,
    };
    // What a texture of another format falls back to is the source.
    let image = part.index("source", "images", images)?.or(webp);
    let at = lenient.field(part.index("sampler", "samplers", lists.samplers.len()));
    Ok(Texture {
        image,
        sampler: match at {
            Some(at) => sampler(lists, at),
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
    let Some(part) = lists.object("sampler", index, &lists.samplers[index]) else {
        return Sampler::PLAIN;
    };
    let name = called("sampler", index, part.text("name").ok().flatten());
    // Unknown numbers leave the choice to us: nothing breaks the standard.
    let known = |name: &str, field: Field<Wrap>| {
        field.unwrap_or_else(|reason| {
            lists
                .notes
                .add(|| format!("{name}: {reason}; the default is used"));
            None
        })
    };
    let plain = Sampler::PLAIN;
    let wrap = |key: &str| known(&name, part.choice(key, &WRAPS)).unwrap_or(Wrap::Repeat);
    let mag_filter = part.choice("magFilter", &MAG_FILTERS);
    let min_filter = part.choice("minFilter", &MIN_FILTERS);
    for reason in [mag_filter.as_ref().err(), min_filter.as_ref().err()]
        .into_iter()
        .flatten()
    {
        lists
            .notes
            .add(|| format!("{name}: {reason}; the default is used"));
    }
    let (min_filter, mip_filter) = min_filter
        .ok()
        .flatten()
        .unwrap_or((plain.min_filter, plain.mip_filter));
    Sampler {
        wrap: [wrap("wrapS"), wrap("wrapT")],
        mag_filter: mag_filter.ok().flatten().unwrap_or(plain.mag_filter),
        min_filter,
        mip_filter,
    }
}

/// Material `index`; a plain one where it is no object.
pub fn material(lists: &Lists, index: usize, value: &Value) -> Material {
    let mut material = Material {
        name: None,
        base_color: [1.0; 4],
        base_texture: None,
        metallic: 1.0,
        roughness: 1.0,
        specular: [0.04, 0.04, 0.04, 1.0],
        transmission: 0.0,
        attenuation: [1.0; 3],
        emission: [0.0; 3],
        emission_texture: None,
        finish_texture: None,
        occlusion_texture: None,
        occlusion_strength: 1.0,
        normal_texture: None,
        normal_scale: 1.0,
        alpha_mode: AlphaMode::Opaque,
        alpha_cutoff: 0.5,
        double_sided: false,
        unlit: false,
        has_more: false,
        has_more_transmission: false,
    };
    let Some(part) = lists.object("material", index, value) else {
        return material;
    };
    let lenient = lists.lenient("material", index, part);
    let reader = Reader { lists, lenient };
    material.name = part.text("name").ok().flatten().map(str::to_owned);
    material.unlit = reader
        .lenient
        .field(part.extension("KHR_materials_unlit"))
        .is_some();
    reader.base(part, &mut material);
    reader.reflection(part, &mut material);
    let mode = part.word("alphaMode", &ALPHA_MODES);
    material.alpha_mode = reader.lenient.field(mode).unwrap_or_default();
    let cutoff = reader.lenient.field(part.number("alphaCutoff"));
    if let Some(cutoff) = cutoff {
        if cutoff < 0.0 {
            let reason = format_args!("its alphaCutoff is {cutoff}; it must be at least 0");
            reader.lenient.fault(reason);
        } else {
            material.alpha_cutoff = cutoff;
        }
    }
    material.double_sided = reader
        .lenient
        .field(part.flag("doubleSided"))
        .unwrap_or(false);
    if !material.unlit {
        reader.transmission(part, &mut material);
        reader.emission(part, &mut material);
        reader.relief(part, &mut material);
    }
    material
}

struct Reader<'a, 'b> {
    lists: &'b Lists<'a>,
    lenient: Lenient<'a>,
}

impl Reader<'_, '_> {
    /// The base color: that of the metallic-roughness model, or the diffuse color of the
    /// specular-glossiness model.
    fn base(&self, part: Object, material: &mut Material) {
        let usual = self.lenient.field(part.object("pbrMetallicRoughness"));
        let older = part.extension("KHR_materials_pbrSpecularGlossiness");
        let older = self.lenient.field(older);
        let (source, factor, texture) = match (usual, older) {
            (_, Some(older)) => (older, "diffuseFactor", "diffuseTexture"),
            (Some(usual), None) => (usual, "baseColorFactor", "baseColorTexture"),
            (None, None) => return,
        };
        if let Some(color) = self.lenient.field(source.vector::<4>(factor)) {
            material.base_color = color.map(|channel| channel.clamp(0.0, 1.0));
        }
        material.base_texture = self.texture_use(source, texture);
        material.has_more = source.value("specularGlossinessTexture").is_some();
    }

    /// How the material reflects: the metallic-roughness model with KHR_materials_ior and
    /// KHR_materials_specular, or the specular-glossiness model.
    fn reflection(&self, part: Object, material: &mut Material) {
        let extension = |name: &str| self.lenient.field(part.extension(name));
        if let Some(older) = extension("KHR_materials_pbrSpecularGlossiness") {
            let [red, green, blue] = self
                .lenient
                .field(older.vector::<3>("specularFactor"))
                .unwrap_or([1.0; 3])
                .map(|channel| channel.clamp(0.0, 1.0));
            material.metallic = 0.0;
            material.roughness = 1.0 - self.fraction(older, "glossinessFactor");
            material.specular = [red, green, blue, 1.0];
            return;
        }
        if let Some(usual) = self.lenient.field(part.object("pbrMetallicRoughness")) {
            material.metallic = self.fraction(usual, "metallicFactor");
            material.roughness = self.fraction(usual, "roughnessFactor");
            if !material.unlit {
                material.finish_texture = self.texture_use(usual, "metallicRoughnessTexture");
            }
        }
        let given = extension("KHR_materials_ior");
        let given = given.and_then(|given| self.lenient.field(given.number("ior")));
        let straight = match given.unwrap_or(1.5) {
            // As a material of the specular-glossiness model, whose Fresnel term is 1.
            0.0 => 1.0,
            index if index < 1.0 => {
                let reason = format_args!("its ior is {index}; it must be 0 or at least 1");
                self.lenient.fault(reason);
                0.04
            }
            // Fresnel: ((n - 1) / (n + 1))².
            index => {
                let root = (f64::from(index) - 1.0) / (f64::from(index) + 1.0);
                (root * root) as f32
            }
        };
        let specular = extension("KHR_materials_specular");
        let factor = specular.map_or(1.0, |given| self.fraction(given, "specularFactor"));
        let tint = specular
            .and_then(|given| self.lenient.field(given.vector::<3>("specularColorFactor")))
            .unwrap_or([1.0; 3]);
        let [red, green, blue] = tint.map(|tint| (straight * tint).clamp(0.0, 1.0) * factor);
        material.specular = [red, green, blue, factor];
        let textures = ["specularTexture", "specularColorTexture"];
        material.has_more |=
            specular.is_some_and(|given| textures.iter().any(|key| given.value(key).is_some()));
    }

    /// What passes through: KHR_materials_transmission, and of KHR_materials_volume what is absorbed
    /// behind the whole thickness, by the law of Beer and Lambert.
    fn transmission(&self, part: Object, material: &mut Material) {
        let extension = |name: &str| self.lenient.field(part.extension(name));
        let number = |part: Object, key: &str| self.lenient.field(part.number(key));
        let mut has_texture = false;
        if let Some(given) = extension("KHR_materials_transmission") {
            let factor = number(given, "transmissionFactor").unwrap_or(0.0);
            material.transmission = factor.clamp(0.0, 1.0);
            has_texture |= given.value("transmissionTexture").is_some();
        }
        if let Some(volume) = extension("KHR_materials_volume") {
            let thickness = number(volume, "thicknessFactor").unwrap_or(0.0).max(0.0);
            let distance = number(volume, "attenuationDistance").unwrap_or(f32::INFINITY);
            let color = self.lenient.field(volume.vector::<3>("attenuationColor"));
            let color = color
                .unwrap_or([1.0; 3])
                .map(|channel| channel.clamp(0.0, 1.0));
            if distance > 0.0 {
                let distances = f64::from(thickness) / f64::from(distance);
                material.attenuation =
                    color.map(|channel| libm::pow(channel.into(), distances) as f32);
            } else {
                let reason =
                    format_args!("its attenuationDistance is {distance}; it must be above 0");
                self.lenient.fault(reason);
            }
            has_texture |= volume.value("thicknessTexture").is_some();
        }
        material.has_more_transmission = has_texture && material.transmission > 0.0;
    }

    /// A factor from 0 to 1, by default 1.
    fn fraction(&self, part: Object, key: &str) -> f32 {
        let given = self.lenient.field(part.number(key));
        given.unwrap_or(1.0).clamp(0.0, 1.0)
    }

    fn emission(&self, part: Object, material: &mut Material) {
        let extension = part.extension("KHR_materials_emissive_strength");
        let strength = self
            .lenient
            .field(extension)
            .and_then(|extension| self.lenient.field(extension.number("emissiveStrength")))
            .unwrap_or(1.0);
        let strength = match strength {
            ..0.0 => {
                self.lenient.fault(format_args!(
                    "its emissiveStrength is {strength}; it must be at least 0"
                ));
                1.0
            }
            BRIGHTEST.. => {
                self.lists.notes.add(|| {
                    format!(
                        "{}: its emissiveStrength {strength} is drawn as {BRIGHTEST}",
                        self.lenient.name
                    )
                });
                BRIGHTEST
            }
            _ => strength,
        };
        let factor = self.lenient.field(part.vector::<3>("emissiveFactor"));
        material.emission = factor
            .unwrap_or([0.0; 3])
            .map(|channel| channel.clamp(0.0, 1.0) * strength);
        if material.emission != [0.0; 3] {
            material.emission_texture = self.texture_use(part, "emissiveTexture");
        }
    }

    /// Where it is shut off from light, and where its normals point.
    fn relief(&self, part: Object, material: &mut Material) {
        let factor = |key: &str, factor: &str| {
            let info = self.lenient.field(part.object(key))?;
            self.lenient.field(info.number(factor))
        };
        material.occlusion_texture = self.texture_use(part, "occlusionTexture");
        material.occlusion_strength = factor("occlusionTexture", "strength")
            .unwrap_or(1.0)
            .clamp(0.0, 1.0);
        material.normal_texture = self.texture_use(part, "normalTexture");
        material.normal_scale = factor("normalTexture", "scale").unwrap_or(1.0);
    }

    /// The use of a texture, under a key of an object.
    fn texture_use(&self, part: Object, key: &str) -> Option<TextureUse> {
        let info = self.lenient.field(part.object(key))?;
        let lenient = Lenient {
            notes: self.lists.notes,
            name: format!("{}: {key}", self.lenient.name),
        };
        let textures = self.lists.textures.len();
        let texture =
            lenient.field(needed("index", info.index("index", "textures", textures)).map(Some))?;
        let set = lenient.field(info.integer("texCoord")).unwrap_or(0);
        let mut used = TextureUse {
            texture,
            set: u32::try_from(set).unwrap_or(u32::MAX),
            image_from_texcoord: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        };
        if let Some(given) = lenient.field(info.extension("KHR_texture_transform")) {
            if let Some(set) = lenient.field(given.integer("texCoord")) {
                used.set = u32::try_from(set).unwrap_or(u32::MAX);
            }
            used.image_from_texcoord = transform(&lenient, given);
        }
        Some(used)
    }
}

/// KHR_texture_transform: scaled, then rotated, then translated. The rotation is counterclockwise
/// in an image whose v axis points down, as the extension's text and test model define it; the
/// formula next to the text rotates the other way.
fn transform(lenient: &Lenient, given: Object) -> [[f32; 3]; 2] {
    let pair = |key: &str, default: f64| {
        lenient
            .field(given.vector::<2>(key))
            .map_or([default; 2], |pair| pair.map(f64::from))
    };
    let ([x, y], [wide, high]) = (pair("offset", 0.0), pair("scale", 1.0));
    let rotation = lenient.field(given.number("rotation")).unwrap_or(0.0);
    let (sin, cos) = libm::sincos(rotation.into());
    [[cos * wide, sin * high, x], [-sin * wide, cos * high, y]].map(|row| row.map(|v| v as f32))
}
