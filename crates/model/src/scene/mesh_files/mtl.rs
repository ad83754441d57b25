//! Materials of OBJ: MTL files.

use std::{
    collections::{BTreeSet, HashMap, HashSet},
    path::{Path, PathBuf},
};

use super::{
    beside::{self, Beside},
    colors,
    findings::Findings,
    stream::{Stream, number, numbers, split},
};
use crate::scene::{
    gltf::{
        LoadError,
        error::{part_name, quoted},
        notes::Notes,
        other_file,
    },
    material::Material,
    texture::Texture,
};

/// Most material files of a line.
const MOST_FILES: usize = 64;

/// Options of textures, with the most values that follow them.
const OPTIONS: &[(&str, usize)] = &[
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

/// Maps of what is not shaded.
const OTHER_MAPS: &[&str] = &[
    "map_bump", "bump", "norm", "disp", "decal", "refl", "map_ka", "map_ks", "map_ns", "map_pr",
    "map_pm", "map_ps", "map_norm",
];

/// A material as its file describes it.
#[derive(Default)]
struct Description {
    name: String,
    color: Option<[f32; 3]>,
    emission: Option<[f32; 3]>,
    /// Below 1 light passes through it.
    opacity: Option<f32>,
    base_map: Option<String>,
    emission_map: Option<String>,
    opacity_map: Option<String>,
    /// The folder of its file.
    folder: PathBuf,
}

/// The materials that faces use, by their names.
#[derive(Default)]
pub struct Library {
    pub materials: Vec<Material>,
    pub by_name: HashMap<String, usize>,
    /// A file is missing, so that it is no wonder if materials are.
    pub is_incomplete: bool,
}

/// Reads the material files that `lines` of an OBJ name, and the images of the materials in `used`.
pub fn read(
    lines: &[String],
    mut used: HashSet<String>,
    beside: &mut Beside,
    notes: &Notes,
) -> Result<Library, LoadError> {
    let (mut library, mut findings) = (Library::default(), Findings::default());
    let mut left_out = BTreeSet::new();
    for line in lines {
        for (name, file) in files(line, beside)? {
            let bytes = match file {
                Ok(bytes) => bytes,
                Err(reason) => {
                    library.is_incomplete = true;
                    notes.fault(|| format!("{reason}; its materials are missing"));
                    continue;
                }
            };
            for about in descriptions(&name, &bytes, &mut used, &mut findings, &mut left_out)? {
                let material = about.material(beside, &mut findings)?;
                library.by_name.insert(about.name, library.materials.len());
                library.materials.push(material);
            }
        }
    }
    findings.tell(notes);
    if !left_out.is_empty() {
        let names: Vec<String> = left_out.into_iter().collect();
        notes.add(|| format!("these are not drawn: {}", names.join(", ")));
    }
    Ok(library)
}

/// The files that a line names: it is one name with spaces, or several names.
type Files = Vec<(String, Result<Vec<u8>, String>)>;

fn files(line: &str, beside: &mut Beside) -> Result<Files, LoadError> {
    let mut read = |name: &str| {
        Ok::<_, LoadError>(match beside.file(Path::new(""), name) {
            Ok(bytes) => Ok(bytes),
            Err(error) => Err(error.within("material file").of_part()?),
        })
    };
    let whole = read(line)?;
    let names: Vec<&str> = line.split_ascii_whitespace().collect();
    if whole.is_ok() || names.len() < 2 {
        return Ok(vec![(line.to_owned(), whole)]);
    }
    let each = |name: &&str| Ok((name.to_string(), read(name)?));
    names.iter().take(MOST_FILES).map(each).collect()
}

/// The first of each of the `wanted` materials of a file, in order; they are no longer wanted.
fn descriptions(
    file: &str,
    bytes: &[u8],
    wanted: &mut HashSet<String>,
    findings: &mut Findings,
    left_out: &mut BTreeSet<String>,
) -> Result<Vec<Description>, LoadError> {
    let mut found: Vec<Description> = Vec::new();
    if let Some(what) = other_file::named(bytes) {
        findings.fault("its materials are missing", || {
            format!("material file {}: {what}", quoted(file))
        });
        return Ok(found);
    }
    let path = beside::path(Path::new(""), file).unwrap_or_default();
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut stream, mut line, mut is_wanted) = (Stream::new(&bytes), Vec::new(), false);
    while stream.line(&mut line)? {
        let text = String::from_utf8_lossy(&line);
        let (keyword, rest) = split(&text);
        if keyword == "newmtl" {
            is_wanted = wanted.remove(rest);
            if is_wanted {
                found.push(Description {
                    name: rest.to_owned(),
                    folder: folder.to_owned(),
                    ..Description::default()
                });
            }
            continue;
        }
        let Some(about) = found.last_mut().filter(|_| is_wanted) else {
            continue;
        };
        let keyword = keyword.to_ascii_lowercase();
        let mut color = |to: &mut Option<[f32; 3]>| {
            let mut tokens = rest.split_ascii_whitespace();
            let first = tokens.clone().next().and_then(number);
            // One number stands for three.
            match numbers(&mut tokens).or(first.map(|value| [value; 3])) {
                Some(color) => *to = Some(color),
                None => findings.fault("the default is used", || {
                    format!(
                        "material file {} line {}: {} is no color of three numbers",
                        quoted(file),
                        stream.line,
                        quoted(rest)
                    )
                }),
            }
        };
        match keyword.as_str() {
            "kd" => color(&mut about.color),
            "ke" => color(&mut about.emission),
            "d" => about.opacity = rest.split_ascii_whitespace().find_map(number),
            "tr" => about.opacity = number(rest).map(|through| 1.0 - through),
            "map_kd" => about.base_map = image_name(rest),
            "map_ke" => about.emission_map = image_name(rest),
            "map_d" | "map_tr" => about.opacity_map = image_name(rest),
            other if OTHER_MAPS.contains(&other) => {
                left_out.insert(other.to_owned());
            }
            _ => {}
        }
    }
    Ok(found)
}

/// The file of a texture, behind its options.
fn image_name(rest: &str) -> Option<String> {
    let mut rest = rest;
    loop {
        let (word, behind) = split(rest);
        let Some((_, values)) = OPTIONS.iter().find(|(name, _)| *name == word) else {
            break;
        };
        rest = behind;
        for value in 0..*values {
            let (word, behind) = split(rest);
            // Of several values all but the first may be missing.
            if value > 0 && number(word).is_none() {
                break;
            }
            rest = behind;
        }
    }
    let name = rest.trim_matches('"');
    (!name.is_empty()).then(|| name.to_owned())
}

impl Description {
    fn material(
        &self,
        beside: &mut Beside,
        findings: &mut Findings,
    ) -> Result<Material, LoadError> {
        let place = format!("material {}", quoted(&self.name));
        let mut texture = |map: &Option<String>, key: &str| match map {
            Some(name) => beside.texture(&self.folder, name, &format!("{place}: {key}")),
            None => Ok(None),
        };
        let base_texture = texture(&self.base_map, "map_Kd")?;
        let emission_texture = texture(&self.emission_map, "map_Ke")?;
        let has_holes = |texture: &&Texture| {
            let texels = &beside.images[texture.image].levels[0].texels;
            texels.iter().any(|texel| texel[3] < 128)
        };
        // A map that is its own mask.
        let masking = base_texture
            .as_ref()
            .filter(|_| self.opacity_map == self.base_map)
            .filter(has_holes);
        let is_translucent = self.opacity.is_some_and(|opacity| opacity < 1.0);
        if masking.is_some() {
            let mask = "it is masked where the alpha of its map_Kd is below one half";
            findings.note(mask, || format!("{place}: blending is not supported"));
        } else if is_translucent || self.opacity_map.is_some() {
            findings.note("the material is opaque", || {
                format!("{place}: blending is not supported")
            });
        }
        let alpha_cutoff = masking.map(|_| 0.5);
        let [r, g, b] = colors::linear(self.color.unwrap_or([1.0; 3])).map(|v| v.min(1.0));
        // A map alone glows as it is.
        let emission = match (self.emission, &emission_texture) {
            (None | Some([0.0, 0.0, 0.0]), Some(_)) => [1.0; 3],
            (emission, _) => emission.unwrap_or_default(),
        };
        Ok(Material {
            name: part_name("material", 0, Some(&self.name)),
            base_color: [r, g, b, 1.0],
            emission: colors::linear(emission),
            base_texture,
            emission_texture,
            alpha_cutoff,
            // The format does not say which side of a face is its front.
            double_sided: true,
            ..Material::default()
        })
    }
}
