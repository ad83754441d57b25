//! Gallery: every available preset. Folders are searched in order and the first preset of an id
//! wins.

use std::{
    path::{Path, PathBuf},
    sync::LazyLock,
};

use etcetera::base_strategy::{BaseStrategy as _, choose_native_strategy};
use include_dir::{Dir, File, include_dir};

use super::{
    error::PresetError,
    file::{PresetFile, stem},
    formats::ModelFormat,
    load::{load_with, parse_file},
    picture::load_picture,
};
use crate::{effect_files::Catalog, host::disk, params::likeness, preset::SceneSource};

/// The most presets that an error suggests.
const MAX_NEAR: usize = 3;

/// The presets inside the binary.
pub static BUILTIN_DIR: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../../presets");

/// The id of the look of a model that is opened without another.
pub const PLAIN: &str = "plain";

/// The preset of that look, as it is inside the binary.
pub fn plain() -> &'static PresetFile {
    static FILE: LazyLock<PresetFile> = LazyLock::new(|| {
        let file = BUILTIN_DIR.get_file(format!("{PLAIN}.toml"));
        let entry = file.map(builtin_entry).expect("the gallery has it");
        entry
            .preset_file
            .expect("it is valid, as every preset of the gallery")
    });
    &FILE
}

/// Where a preset was found, in order of precedence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// `--presets DIR`.
    Chosen,
    /// `presets/` beside the program.
    Beside,
    /// The folder of the user.
    User,
    /// Inside the program.
    Builtin,
}

/// A preset of the gallery, or why it cannot be read.
#[derive(Clone, Debug)]
pub struct GalleryEntry {
    pub id: String,
    pub origin: Origin,
    /// None when built in.
    pub path: Option<PathBuf>,
    pub preset_file: Result<PresetFile, PresetError>,
    /// Where other presets of the same id are, which this one hides.
    pub shadows: Vec<Origin>,
}

impl GalleryEntry {
    /// The name that the preset shows; its id where it has none or cannot be read.
    pub fn title(&self) -> &str {
        self.preset_file
            .as_ref()
            .map_or(&self.id, |preset_file| preset_file.title())
    }

    /// Is `what` its id or its name, in any case of letters?
    fn is_called(&self, what: &str) -> bool {
        let what = what.to_lowercase();
        [&self.id, self.title()]
            .iter()
            .any(|name| name.to_lowercase() == what)
    }
}

/// Where presets and effects are looked for, beside the built-in ones.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    /// The user's own folder, `rasterlab` in the configuration folder of the system: `presets`,
    /// `effects`, `effect-values` and `favorites.toml` are in it. None: the user has no
    /// presets, and nothing is kept.
    pub user: Option<PathBuf>,
    /// `--presets DIR`.
    pub presets: Option<PathBuf>,
    /// Folders of effects: the user's, `--effects DIR`, then those of dropped files. A later one
    /// wins.
    pub effect_folders: Vec<PathBuf>,
    /// The effects in these folders.
    pub effects: Catalog,
}

impl Folders {
    /// These folders, and the effects in the user's own folder and beside the user's presets.
    pub fn new(presets: Option<PathBuf>, effects: &Path) -> Self {
        let beside_own = user_folder().map(|presets| presets.join("effects"));
        let effect_folders: Vec<PathBuf> = user_effects_folder()
            .into_iter()
            .chain(beside_own)
            .chain([effects.to_owned()])
            .collect();
        let user = user_folder().and_then(|presets| presets.parent().map(Path::to_owned));
        Self {
            user,
            presets,
            effects: Catalog::of_folders(effect_folders.iter().map(PathBuf::as_path)),
            effect_folders,
        }
    }
}

impl Folders {
    /// The folder of the user's own presets.
    pub fn user_presets(&self) -> Option<PathBuf> {
        Some(self.user.as_ref()?.join("presets"))
    }

    /// The folder of saved values of effects.
    pub fn effect_values(&self) -> Option<PathBuf> {
        Some(self.user.as_ref()?.join("effect-values"))
    }
}

/// The folder of the user's effects: `effects` beside [`user_folder`].
pub fn user_effects_folder() -> Option<PathBuf> {
    Some(user_folder()?.with_file_name("effects"))
}

/// Every preset, sorted by id.
pub fn gallery(folders: &Folders) -> Vec<GalleryEntry> {
    let mut entries: Vec<GalleryEntry> = Vec::new();
    let on_disk = preset_folders(folders)
        .into_iter()
        .flat_map(|(origin, folder)| folder_entries(origin, &folder, &folders.effects));
    let built_in = BUILTIN_DIR
        .files()
        .filter(|file| has_extension(file.path(), "toml"))
        .map(builtin_entry);
    for entry in on_disk.chain(built_in) {
        match entries.iter_mut().find(|winner| winner.id == entry.id) {
            Some(winner) => winner.shadows.push(entry.origin),
            None => entries.push(entry),
        }
    }
    entries.sort_by(|a, b| a.id.cmp(&b.id));
    entries
}

fn folder_entries(origin: Origin, folder: &Path, effects: &Catalog) -> Vec<GalleryEntry> {
    let files = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let preset_files = files.filter(|path| has_extension(path, "toml") && path.is_file());
    preset_files
        .map(|path| GalleryEntry {
            id: stem(&path),
            origin,
            preset_file: load_with(&path, effects),
            path: Some(path),
            shadows: Vec::new(),
        })
        .collect()
}

fn builtin_entry(file: &File<'_>) -> GalleryEntry {
    let (id, name) = (
        stem(file.path()),
        format!("presets/{}", file.path().display()),
    );
    let text = file.contents_utf8().unwrap_or_default();
    let preset_file = parse_file(text, &id, &name).map(|preset_file| PresetFile {
        read_only: true,
        ..preset_file
    });
    GalleryEntry {
        id,
        origin: Origin::Builtin,
        path: None,
        preset_file,
        shadows: Vec::new(),
    }
}

/// The folders of presets on disk, in order of precedence.
fn preset_folders(folders: &Folders) -> Vec<(Origin, PathBuf)> {
    let beside = std::env::current_exe()
        .ok()
        .and_then(|exe| Some(exe.parent()?.join("presets")));
    let folders = [
        (Origin::Chosen, folders.presets.clone()),
        (Origin::Beside, beside),
        (Origin::User, folders.user_presets()),
    ];
    folders
        .into_iter()
        .filter_map(|(origin, folder)| Some((origin, folder?)))
        .collect()
}

/// The folder of the user's presets: `rasterlab/presets` in the configuration folder of the system.
pub fn user_folder() -> Option<PathBuf> {
    let system = choose_native_strategy().ok()?;
    // On macOS, *Preferences* is for files of the system's own format.
    let config = if cfg!(target_os = "macos") {
        system.data_dir()
    } else {
        system.config_dir()
    };
    Some(config.join("rasterlab/presets"))
}

/// Opens what a person names: a preset of the gallery by its id, or by its id or name in other
/// letters; a `.toml` file; a PNG saved by rasterlab; a model; or `builtin:QUERY`.
pub fn open(what: &str, folders: &Folders) -> Result<PresetFile, PresetError> {
    if let Some(query) = what.strip_prefix("builtin:") {
        let name = query.split('?').next().unwrap_or(query);
        return Ok(PresetFile {
            effects: folders.effects.clone(),
            ..PresetFile::of_scene(name, SceneSource::Builtin(query.into()))
        });
    }
    let path = Path::new(what);
    if has_extension(path, "toml") {
        return load_with(path, &folders.effects);
    }
    if has_extension(path, "png") {
        return load_picture(path);
    }
    if ModelFormat::of(path).is_some() {
        let absolute = disk::absolute(path).map_err(|e| PresetError::Read {
            file: what.into(),
            reason: e.to_string(),
        })?;
        return Ok(PresetFile {
            effects: folders.effects.clone(),
            ..PresetFile::of_scene(&stem(path), SceneSource::File(absolute))
        });
    }
    if let Some(found) = by_id(what, folders) {
        return found;
    }
    let entries = gallery(folders);
    // An entry may have exactly this id: a file whose extension is written in capitals, for
    // instance.
    let exact = entries.iter().find(|entry| entry.id == what);
    let named: Vec<&GalleryEntry> = exact.map_or_else(
        || {
            entries
                .iter()
                .filter(|entry| entry.is_called(what))
                .collect()
        },
        |entry| vec![entry],
    );
    match named[..] {
        [] => {}
        [entry] => return by_id(&entry.id, folders).unwrap_or_else(|| entry.preset_file.clone()),
        _ => {
            let ids: Vec<&str> = named.iter().map(|entry| entry.id.as_str()).collect();
            return Err(PresetError::Ambiguous {
                name: what.into(),
                ids: ids.join(", "),
            });
        }
    }
    if disk::exists(path) {
        let models = ModelFormat::names(" and ");
        let reason = format!(
            "rasterlab opens .toml files, .png pictures that it has saved, and models in {models} files"
        );
        return Err(PresetError::NotOurs {
            what: what.into(),
            reason,
        });
    }
    Err(PresetError::NoPreset {
        what: what.into(),
        hint: near_presets(what, &entries),
    })
}

/// `; did you mean "facet" (Half cut)?`: the presets whose ids or names are nearest to `what`; empty
/// where none is near.
fn near_presets(what: &str, entries: &[GalleryEntry]) -> String {
    let near = entries.iter().filter_map(|entry| {
        let names = [&entry.id, entry.title()].into_iter();
        Some((
            names
                .filter_map(|name| likeness(what, name))
                .max_by(f64::total_cmp)?,
            entry,
        ))
    });
    let mut near: Vec<(f64, &GalleryEntry)> = near.collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    let described = |(_, entry): &(f64, &GalleryEntry)| match entry.title() {
        title if title == entry.id => format!("{:?}", entry.id),
        title => format!("{:?} ({title})", entry.id),
    };
    let near: Vec<String> = near.iter().take(MAX_NEAR).map(described).collect();
    match near.is_empty() {
        true => String::new(),
        false => format!("; did you mean {}?", near.join(" or ")),
    }
}

/// The preset called `id`, read from the first place that has it; no other preset is read.
fn by_id(id: &str, folders: &Folders) -> Option<Result<PresetFile, PresetError>> {
    if Path::new(id).file_name().is_none_or(|name| name != id) {
        return None;
    }
    let file = format!("{id}.toml");
    let on_disk = preset_folders(folders)
        .into_iter()
        .map(|(_, folder)| folder.join(&file))
        .find(|path| path.is_file());
    if let Some(path) = on_disk {
        return Some(load_with(&path, &folders.effects));
    }
    let built_in = builtin_entry(BUILTIN_DIR.get_file(&file)?).preset_file;
    Some(built_in.map(|opened| PresetFile {
        effects: opened.effects.joined(&folders.effects),
        ..opened
    }))
}

fn has_extension(path: &Path, expected: &str) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(expected))
}
