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
use crate::legible::text_of;
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

/// Most options of a texture, and words that may be values of an unknown one.
const MOST_OPTIONS: usize = 16;

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

/// A texture as a line describes it.
struct Map {
    /// Names that its file may have, the likeliest first: what follows an unknown option
    /// may begin with its values.
    names: Vec<String>,
    /// Texture coordinates are multiplied by the scale and moved by the offset, with v up.
    scale: [f32; 2],
    offset: [f32; 2],
}

/// A material as its file describes it.
#[derive(Default)]
struct Description {
    name: String,
    color: Option<[f32; 3]>,
    emission: Option<[f32; 3]>,
    /// Below 1 light passes through it.
    opacity: Option<f32>,
    base_map: Option<Map>,
    emission_map: Option<Map>,
    opacity_map: Option<Map>,
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
    // A space behind a backslash is part of a name.
    const SPACE: &str = "\0";
    let joined = line.replace("\\ ", SPACE);
    let names: Vec<&str> = joined.split_ascii_whitespace().collect();
    if whole.is_ok() || names.len() < 2 {
        return Ok(vec![(line.to_owned(), whole)]);
    }
    let each = |name: &&str| {
        let name = name.replace(SPACE, " ");
        let file = read(&name)?;
        Ok((name, file))
    };
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
        let text = text_of(&line);
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
            "tr" => about.opacity = number(rest).map(|through: f32| 1.0 - through),
            "map_kd" => about.base_map = Map::read(rest),
            "map_ke" => about.emission_map = Map::read(rest),
            "map_d" | "map_tr" => about.opacity_map = Map::read(rest),
            other if OTHER_MAPS.contains(&other) => {
                left_out.insert(other.to_owned());
            }
            _ => {}
        }
    }
    Ok(found)
}

impl Map {
    /// The texture that a line names behind its options.
    fn read(line: &str) -> Option<Self> {
        let mut map = Self {
            names: Vec::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
        };
        let (mut rest, mut is_known) = (line, true);
        for _ in 0..MOST_OPTIONS {
            let (word, behind) = split(rest);
            if let Some((name, values)) = OPTIONS.iter().find(|(name, _)| *name == word) {
                rest = map.option(name, *values, behind);
            } else if word.len() > 1 && word.starts_with('-') && !behind.is_empty() {
                // Its values are unknown too: up to the next option, if there is one.
                let next = OPTIONS
                    .iter()
                    .filter_map(|(name, _)| behind.find(&format!(" {name} ")));
                rest = behind[next.min().unwrap_or(0)..].trim_ascii_start();
                is_known = false;
            } else {
                break;
            }
        }
        // Messages name the shortest, and the line itself is the least likely.
        let words: Vec<&str> = rest.rsplitn(MOST_OPTIONS, ' ').collect();
        let ends = (1..words.len()).map(|count| {
            let length: usize = words[..count].iter().map(|word| word.len() + 1).sum();
            &rest[rest.len() + 1 - length..]
        });
        let values = ends.filter(|_| !is_known);
        let names = values.chain([rest, line].into_iter().take(if is_known { 1 } else { 2 }));
        map.names = names
            .map(|name| name.trim_matches('"').to_owned())
            .filter(|name| !name.is_empty())
            .collect();
        (!map.names.is_empty()).then_some(map)
    }

    /// Takes the values of an option; returns what is behind them.
    fn option<'a>(&mut self, name: &str, most: usize, mut rest: &'a str) -> &'a str {
        for value in 0..most {
            let (word, behind) = split(rest);
            let given = number::<f32>(word);
            // Of several values all but the first may be missing.
            if value > 0 && given.is_none() {
                break;
            }
            match (name, given) {
                ("-s", Some(given)) if value < 2 => self.scale[value] = given,
                ("-o", Some(given)) if value < 2 => self.offset[value] = given,
                _ => {}
            }
            rest = behind;
        }
        rest
    }

    /// The map from texture coordinates whose v points down, as they are stored.
    fn image_from_texcoord(&self) -> [[f32; 3]; 2] {
        let ([wide, high], [right, up]) = (self.scale, self.offset);
        [[wide, 0.0, right], [0.0, high, 1.0 - high - up]]
    }
}

impl Description {
    fn material(
        &self,
        beside: &mut Beside,
        findings: &mut Findings,
    ) -> Result<Material, LoadError> {
        let place = format!("material {}", quoted(&self.name));
        let mut texture = |map: &Option<Map>, key: &str| {
            let Some(map) = map else {
                return Ok::<_, LoadError>(None);
            };
            let place = format!("{place}: {key}");
            let found = beside.texture(&self.folder, &map.names, &place)?;
            Ok(found.map(|plain| Texture {
                image_from_texcoord: map.image_from_texcoord(),
                ..plain
            }))
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
            .filter(|_| {
                let [opacity, base] = [&self.opacity_map, &self.base_map]
                    .map(|map| map.as_ref().map(|map| &map.names));
                opacity == base
            })
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
        // Writers leave black beside a map, which all viewers show.
        let is_left = base_texture.is_some() && self.color == Some([0.0; 3]);
        let color = self.color.filter(|_| !is_left).unwrap_or([1.0; 3]);
        let [r, g, b] = colors::linear(color).map(|v| v.min(1.0));
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
