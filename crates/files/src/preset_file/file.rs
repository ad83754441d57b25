//! An open preset: the state with the file it came from.

use std::{
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use toml_edit::{DocumentMut, Item, Table};

use super::{
    atomic::{Existing, write_atomically},
    error::{Position, PresetError},
    gallery::{PLAIN, plain},
    look::Look,
    write,
};
use crate::{
    effect_files::Catalog,
    effects::Effect,
    host::{disk, stays_inside},
    preset::{Preset, SceneSource},
    scene::{Scene, UpAxis},
};

/// The id of a preset that was pasted.
pub(super) const PASTED: &str = "pasted";

/// The table that holds the texts of effects that a shared preset brings.
pub(super) const EFFECT_FILES: &str = "effect_files";

/// Longest name of a preset, whether it is typed or made, characters.
pub const MAX_NAME: usize = 100;

/// A preset with its file and the text that it was read from.
#[derive(Clone, Debug)]
pub struct PresetFile {
    /// File stem.
    pub id: String,
    /// None for built-in, pasted and new presets.
    pub path: Option<PathBuf>,
    pub preset: Preset,
    /// What the reader warns of, each with its line.
    pub warnings: Vec<String>,
    /// The effects that it may use.
    pub effects: Catalog,
    /// Names of the effects whose text came inside the preset: code that its reader has not seen
    /// yet.
    pub brought_effects: Vec<String>,
    /// The model that a picture or a pasted line names outside of its folder, as an absolute path.
    /// Nothing of it is read, and `preset` shows the default scene, until
    /// [`PresetFile::with_outside_model`].
    pub outside_model: Option<PathBuf>,
    /// The person chose the scene: a model or built-in scene was opened.
    pub chose_scene: bool,
    /// The preset whose look has landed on the scene of another.
    pub look: Option<Look>,
    /// Built in, or written by a newer program.
    pub read_only: bool,
    /// Written by a newer program: parts of it may be unknown here, so it is never written back.
    pub(super) is_newer: bool,
    /// The text, with comments and unknown keys.
    pub(super) document: DocumentMut,
    /// The state that `document` describes.
    pub(super) saved: Preset,
}

impl PresetFile {
    /// A preset without a file.
    pub fn new(id: &str, preset: Preset) -> Self {
        Self {
            id: id.into(),
            path: None,
            preset,
            warnings: Vec::new(),
            effects: Catalog::default(),
            brought_effects: Vec::new(),
            outside_model: None,
            chose_scene: false,
            look: None,
            read_only: false,
            is_newer: false,
            document: DocumentMut::new(),
            saved: Preset::default(),
        }
    }

    /// The preset of a model or built-in scene that was chosen, in the plain look. What it leaves open
    /// is found when its scene has loaded: see [`PresetFile::settle`].
    pub fn of_scene(id: &str, scene: SceneSource) -> Self {
        let plain = plain();
        let mut preset = Preset {
            name: id.into(),
            about: String::new(),
            tags: Vec::new(),
            test: None,
            ..plain.preset.clone()
        };
        preset.parts.up = match scene {
            SceneSource::File(_) => UpAxis::Auto,
            SceneSource::Builtin(_) => UpAxis::Y,
        };
        preset.scene = scene;
        Self {
            chose_scene: true,
            look: Some(Look::of(plain)),
            ..Self::new(id, preset)
        }
    }

    /// Does it show its scene in the plain look, as it came?
    pub fn is_plain(&self) -> bool {
        let is_plain = |look: &Look| look.path.is_none() && look.id == PLAIN;
        self.path.is_none() && self.look.as_ref().is_some_and(is_plain)
    }

    /// Is something open that its scene tells?
    pub fn is_unsettled(&self) -> bool {
        self.preset.parts.up == UpAxis::Auto || self.is_plain()
    }

    /// Takes from its scene, which has loaded, the axis that is up, and in the plain look what suits a
    /// cloud of points and, if it `may_dim` them, the strength that lights which are far too strong are
    /// dimmed to.
    pub fn settle(&mut self, scene: &Scene, may_dim: bool) {
        self.preset.parts.up = self.preset.parts.up.or(scene.up);
        if self.is_plain() {
            self.preset.suit_cloud(scene);
            if may_dim {
                self.preset.dim_lights(scene);
            }
        }
    }

    /// Did it, or its look, come as a text, so that no file has it?
    pub fn is_pasted(&self) -> bool {
        self.path.is_none() && self.look.as_ref().map_or(&self.id, |look| &look.id) == PASTED
    }

    /// The name, or the id of a preset without a name.
    pub fn title(&self) -> &str {
        if self.preset.name.is_empty() {
            &self.id
        } else {
            &self.preset.name
        }
    }

    /// What a person should know after opening it: warnings, and the code that it brings.
    pub fn remarks(&self) -> Vec<String> {
        let lines = |name: &str| {
            self.effects
                .find(name)
                .ok()
                .flatten()
                .and_then(|effect| effect.source.as_ref())
                .map_or(0, |source| source.written.lines().count())
        };
        let brought = self.brought_effects.iter().map(|name| {
            format!(
                "the preset brings the effect {name}, {} lines of WGSL",
                lines(name)
            )
        });
        self.warnings.iter().cloned().chain(brought).collect()
    }

    /// The effects whose text came inside the preset.
    pub fn brought(&self) -> impl Iterator<Item = &Arc<Effect>> {
        self.brought_effects
            .iter()
            .filter_map(|name| self.effects.find(name).ok().flatten())
    }

    /// The preset without the effects that it brings, their instances, keyframes and texts.
    #[must_use]
    pub fn without_brought(mut self) -> Self {
        let brought = std::mem::take(&mut self.brought_effects);
        let is_brought = |effect: &Effect| {
            brought.iter().any(|name| {
                effect.name == *name || effect.base.as_ref().is_some_and(|base| base.name == *name)
            })
        };
        let used: Vec<String> = self
            .preset
            .stack
            .0
            .iter()
            .map(|enabled| &enabled.effect)
            .filter(|effect| is_brought(effect))
            .map(|effect| effect.name.clone())
            .collect();
        for name in used {
            self.preset.disable(&name);
        }
        self.effects = self.effects.without(&brought);
        self.document.remove(EFFECT_FILES);
        self
    }

    /// Would saving change the file?
    pub fn is_modified(&self) -> bool {
        self.preset != self.saved
    }

    pub fn strict(self) -> Result<Self, PresetError> {
        if self.warnings.is_empty() {
            Ok(self)
        } else {
            Err(PresetError::Strict(self.warnings))
        }
    }

    /// Could a file hold the changes? A picture or a copy then gives this preset back.
    ///
    /// # Errors
    /// A changed preset of a newer schema, effects that exclude each other, or a test budget that
    /// no file may state.
    pub fn check_savable(&self) -> Result<(), PresetError> {
        if self.is_newer && self.is_modified() {
            let reason = "its schema is newer than this program, so its changes cannot be saved; draw it as it is, or use --bare";
            return Err(PresetError::ReadOnly {
                id: self.id.clone(),
                reason: reason.into(),
            });
        }
        self.check_values()
    }

    /// The rules that hold between values, which a file is checked for when it is read.
    ///
    /// # Errors
    /// As [`PresetFile::check_savable`], except for a newer schema.
    pub fn check_values(&self) -> Result<(), PresetError> {
        let at = Position {
            file: self.id.clone(),
            line: None,
        };
        self.preset
            .stack
            .check()
            .map_err(|conflict| PresetError::value(at.clone(), "effects", conflict.to_string()))?;
        self.preset
            .check_budget()
            .map_err(|[key, reason]| PresetError::value(at, key, reason))
    }

    /// Makes it a preset of its own that is about to be saved to `path`: with this name, or that of
    /// the file, and without what described and tested the preset that it comes from.
    pub fn make_new(&mut self, name: Option<&str>, path: &Path) {
        let name = name.map(str::trim).filter(|name| !name.is_empty());
        let name = name.map_or_else(|| stem(path), str::to_owned);
        let preset = &mut self.preset;
        preset.name = name.chars().take(MAX_NAME).collect();
        preset.about.clear();
        preset.tags.clear();
        preset.test = None;
    }

    /// The preset with the model that it names outside of its folder, which the person has allowed.
    #[must_use]
    pub fn with_outside_model(mut self) -> Self {
        if let Some(model) = self.outside_model.take() {
            self.preset.scene = SceneSource::File(model);
        }
        self
    }

    /// The preset without its model where that lies outside of its folder, which is noted.
    #[must_use]
    pub(super) fn held_to_folder(mut self) -> Self {
        if let SceneSource::File(model) = &self.preset.scene
            && !stays_inside(model)
        {
            self.outside_model = Some(
                normalized(&model_path(model, self.path.as_deref()))
                    .unwrap_or_else(|| model.clone()),
            );
            self.preset.scene = Preset::default().scene;
        }
        self
    }

    /// The preset as a picture saved at `picture` holds it: a relative model path starts at the
    /// folder of the picture.
    #[must_use]
    pub fn for_picture(&self, picture: &Path) -> Self {
        let mut moved = self.clone();
        if let SceneSource::File(model) = &self.preset.scene {
            moved.preset.scene = SceneSource::File(rebase(model, self.path.as_deref(), picture));
        }
        moved
    }

    /// Does the text have a table for this effect, known or not?
    pub(super) fn has_effect_table(&self, name: &str) -> bool {
        self.document
            .get("effects")
            .and_then(|effects| effects.get(name))
            .is_some()
    }
}

/// The preset as TOML: the text that it came from with the differences written in; the same bytes
/// where nothing changed.
pub fn to_toml(preset_file: &PresetFile) -> String {
    let mut document = preset_file.document.clone();
    if !preset_file.is_newer {
        write::patch(
            &mut document,
            &preset_file.effects,
            &preset_file.saved,
            &preset_file.preset,
        );
    }
    document.to_string()
}

/// The preset as TOML with the effects of files and the picture of surroundings that it uses, so that
/// it can be opened elsewhere.
pub fn to_shared_toml(preset_file: &PresetFile) -> String {
    let sources = preset_file
        .preset
        .stack
        .0
        .iter()
        .filter_map(|enabled| enabled.effect.source.as_ref());
    let mut shared = preset_file.clone();
    shared.preset.surroundings = preset_file.shared_surroundings();
    let mut document: DocumentMut = match to_toml(&shared).parse() {
        Ok(document) => document,
        Err(_) => return to_toml(&shared),
    };
    let mut table = Table::new();
    for source in sources {
        table.insert(&source.stem, toml_edit::value(source.shared().into_owned()));
    }
    match table.is_empty() {
        true => drop(document.remove(EFFECT_FILES)),
        false => drop(document.insert(EFFECT_FILES, Item::Table(table))),
    }
    document.to_string()
}

/// Writes the preset to `path`, whole or not at all, and makes that its file. A file that has this
/// text already is not written. A relative model path is rewritten so that it still leads to the
/// model, and the picture of surroundings is put beside the preset.
///
/// # Errors
/// The preset has a newer schema, or the file cannot be written; then `preset_file` stays as it is.
pub fn save(preset_file: &mut PresetFile, path: &Path) -> Result<(), PresetError> {
    if preset_file.is_newer {
        return Err(PresetError::ReadOnly {
            id: preset_file.id.clone(),
            reason: "its schema is newer than this program".into(),
        });
    }
    let mut next = preset_file.clone();
    if let SceneSource::File(model) = &preset_file.preset.scene {
        next.preset.scene = SceneSource::File(rebase(model, preset_file.path.as_deref(), path));
    }
    next.preset.surroundings = preset_file.surroundings_beside(path);
    let text = to_toml(&next);
    let is_there = preset_file.path.as_deref() == Some(path)
        && std::fs::read(path).is_ok_and(|there| there == text.as_bytes());
    if !is_there {
        write_atomically(path, text.as_bytes(), Existing::Replace)?;
    }
    next.document = text
        .parse()
        .map_err(|e: toml_edit::TomlError| PresetError::Write {
            file: path.display().to_string(),
            reason: e.to_string(),
        })?;
    next.saved = next.preset.clone();
    (next.id, next.path, next.read_only, next.look) =
        (stem(path), Some(path.to_owned()), false, None);
    *preset_file = next;
    Ok(())
}

/// The id of a preset at `path`.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "preset".into(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// The path of a model, for a preset at `preset_path` (or in the current folder).
pub(super) fn model_path(model: &Path, preset_path: Option<&Path>) -> PathBuf {
    preset_path
        .and_then(Path::parent)
        .unwrap_or(Path::new(""))
        .join(model)
}

/// The path from the root, without `.` and `..`; none where the current folder is unknown. Links
/// are not followed, and nothing is read.
pub fn normalized(path: &Path) -> Option<PathBuf> {
    let mut normalized = PathBuf::new();
    for part in disk::absolute(path).ok()?.components() {
        match part {
            Component::ParentDir => drop(normalized.pop()),
            Component::CurDir => {}
            part => normalized.push(part),
        }
    }
    Some(normalized)
}

/// `model` relative to the folder of `to`, when it was relative to the folder of `from`.
fn rebase(model: &Path, from: Option<&Path>, to: &Path) -> PathBuf {
    let folder = normalized(to).and_then(|to| to.parent().map(Path::to_owned));
    let (Some(model_path), Some(folder)) = (normalized(&model_path(model, from)), folder) else {
        return model.to_owned();
    };
    let (model_parts, folder_parts): (Vec<_>, Vec<_>) = (
        model_path.components().collect(),
        folder.components().collect(),
    );
    let shared = model_parts
        .iter()
        .zip(&folder_parts)
        .take_while(|(a, b)| a == b)
        .count();
    if shared == 0 {
        return model_path; // Another drive: there is no relative path.
    }
    let up = std::iter::repeat_n("..", folder_parts.len() - shared).collect::<PathBuf>();
    let relative = up.join(model_parts[shared..].iter().collect::<PathBuf>());
    // Forward slashes read the same on every system.
    PathBuf::from(
        relative
            .to_string_lossy()
            .replace(std::path::MAIN_SEPARATOR, "/"),
    )
}
