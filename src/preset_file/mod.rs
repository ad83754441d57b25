//! Presets: TOML files that hold a whole [`Preset`], sparse, versioned and keyed by name.
//!
//! Presence of `[effects.NAME]` enables an effect; `stack` is only order. Comments and unknown keys are kept and
//! written back. Every value is finite and inside its hard range after loading, or the file is refused with a line.

mod animation;
mod atomic;
mod error;
pub mod form;
mod gallery;
pub mod keys;
pub mod migrate;
mod path;
mod pins;
mod polyline;
mod read;
mod rules;
pub mod schema;
mod share;
mod shot;
mod write;

use std::{
    io::Write as _,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use toml_edit::DocumentMut;

pub use atomic::{AtomicFile, sweep};
pub use error::{Place, PresetError};
pub use gallery::{BUILTIN_DIR, GalleryEntry, Origin, gallery, open, user_folder};
pub use path::{set, unset};
pub use share::{from_line, to_line};
pub use shot::{Film, Provenance, Reel, Standing, png_bytes, png_of_frame, png_pixels, png_with_preset, preset_from_png, standing};

use crate::{
    params::Field,
    preset::{Preset, SceneSource},
    scene::{self, Scene},
};
use form::Value;

/// An open preset: a session with the file it came from.
#[derive(Clone, Debug)]
pub struct PresetFile {
    /// File stem.
    pub id: String,
    /// None for built-in, pasted and new presets.
    pub path: Option<PathBuf>,
    pub preset: Preset,
    /// What the reader found odd, each with its line.
    pub warnings: Vec<String>,
    /// Built in, or written by a newer program.
    pub read_only: bool,
    /// Written by a newer program: it may mean more than we understand, so it is never written back.
    is_newer: bool,
    /// The text as it was, with comments and unknown keys.
    document: DocumentMut,
    /// What `document` says.
    saved: Preset,
}

impl PresetFile {
    /// A preset without a file.
    pub fn new(id: &str, preset: Preset) -> Self {
        Self {
            id: id.into(),
            path: None,
            preset,
            warnings: Vec::new(),
            read_only: false,
            is_newer: false,
            document: DocumentMut::new(),
            saved: Preset::default(),
        }
    }

    /// The default preset on a model or builtin scene: daylight, nothing else.
    pub fn of_scene(id: &str, scene: SceneSource) -> Self {
        let mut preset = Preset { name: id.into(), scene, ..Preset::default() };
        preset.stack.enable(&crate::effects::lambert::EFFECT);
        Self::new(id, preset)
    }

    /// Shown to people: the name, or the id of a nameless preset.
    pub fn title(&self) -> &str {
        if self.preset.name.is_empty() { &self.id } else { &self.preset.name }
    }

    /// Would saving change the file?
    pub fn is_modified(&self) -> bool {
        self.preset != self.saved
    }

    /// Fails if the reader had warnings.
    pub fn strict(self) -> Result<Self, PresetError> {
        if self.warnings.is_empty() { Ok(self) } else { Err(PresetError::Strict(self.warnings)) }
    }
}

/// Reads the text of a preset called `id`; errors and warnings name `<id>.toml`.
pub fn parse(text: &str, id: &str) -> Result<PresetFile, PresetError> {
    parse_file(text, id, &format!("{id}.toml"))
}

/// Reads the text of a preset that people know as `file`.
pub fn parse_file(text: &str, id: &str, file: &str) -> Result<PresetFile, PresetError> {
    let document = read::document(text, file)?;
    let read::Reading { preset, warnings, is_newer } = read::read(&document, file)?;
    let schema = document.get("schema").and_then(|item| item.as_integer()).unwrap_or(migrate::CURRENT);
    let document = if schema < migrate::CURRENT { migrate::migrate(document.into_mut(), schema) } else { document.into_mut() };
    Ok(PresetFile { id: id.into(), path: None, saved: preset.clone(), preset, warnings, read_only: is_newer, is_newer, document })
}

/// Reads a preset from a `.toml` file.
pub fn load(path: &Path) -> Result<PresetFile, PresetError> {
    let file = path.display().to_string();
    let bytes = read_capped(path, read::MAX_BYTES as u64)?;
    let text = String::from_utf8(bytes).map_err(|_| PresetError::Read { file: file.clone(), reason: "it is not UTF-8 text".into() })?;
    let preset_file = parse_file(&text, &stem(path), &file)?;
    Ok(PresetFile { path: Some(path.to_owned()), ..preset_file })
}

fn read_capped(path: &Path, most: u64) -> Result<Vec<u8>, PresetError> {
    use std::io::Read as _;
    let failed = |reason: String| PresetError::Read { file: path.display().to_string(), reason };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|e| failed(e.to_string()))?;
    file.take(most + 1).read_to_end(&mut bytes).map_err(|e| failed(e.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(failed(format!("it is longer than {most} bytes")));
    }
    Ok(bytes)
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "preset".into(), |stem| stem.to_string_lossy().into_owned())
}

/// The preset as TOML: the text it came from, with the differences written in. Byte for byte the file if nothing changed.
pub fn to_toml(preset_file: &PresetFile) -> String {
    let mut document = preset_file.document.clone();
    if !preset_file.is_newer {
        write::patch(&mut document, &preset_file.saved, &preset_file.preset);
    }
    document.to_string()
}

/// Writes the preset to `path`, whole or not at all, and makes that its file. An unmodified file is left alone.
/// A relative model path is rewritten so that it still leads to the model.
pub fn save(preset_file: &mut PresetFile, path: &Path) -> Result<(), PresetError> {
    if preset_file.is_newer {
        return Err(PresetError::ReadOnly { id: preset_file.id.clone(), reason: "its schema is newer than this program".into() });
    }
    let mut next = preset_file.clone();
    if let SceneSource::File(model) = &preset_file.preset.scene {
        next.preset.scene = SceneSource::File(rebase(model, preset_file.path.as_deref(), path));
    }
    let text = to_toml(&next);
    if preset_file.path.as_deref() != Some(path) || text != preset_file.document.to_string() {
        write_atomically(path, text.as_bytes())?;
    }
    next.document =
        text.parse().map_err(|e: toml_edit::TomlError| PresetError::Write { file: path.display().to_string(), reason: e.to_string() })?;
    next.saved = next.preset.clone();
    (next.id, next.path, next.read_only) = (stem(path), Some(path.to_owned()), false);
    *preset_file = next;
    Ok(())
}

/// Writes beside `path`, then renames, so that a reader sees the old file or the new one.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), PresetError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|e| file.failed(e))?;
    file.commit()
}

/// Where a model lies, for a look at `preset_path` (or in the current folder).
fn model_path(model: &Path, preset_path: Option<&Path>) -> PathBuf {
    preset_path.and_then(Path::parent).unwrap_or(Path::new("")).join(model)
}

/// `model` as seen from the folder of `to`, when it was written for the folder of `from`.
fn rebase(model: &Path, from: Option<&Path>, to: &Path) -> PathBuf {
    let tidy = |path: &Path| -> Option<PathBuf> {
        let mut tidy = PathBuf::new();
        for part in std::path::absolute(path).ok()?.components() {
            match part {
                Component::ParentDir => drop(tidy.pop()),
                Component::CurDir => {}
                part => tidy.push(part),
            }
        }
        Some(tidy)
    };
    let (Some(model_at), Some(folder)) = (tidy(&model_path(model, from)), tidy(to).and_then(|to| to.parent().map(Path::to_owned))) else {
        return model.to_owned();
    };
    let (there, here): (Vec<_>, Vec<_>) = (model_at.components().collect(), folder.components().collect());
    let shared = there.iter().zip(&here).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return model_at; // Another drive: no relative way.
    }
    let up = std::iter::repeat_n("..", here.len() - shared).collect::<PathBuf>();
    let relative = up.join(there[shared..].iter().collect::<PathBuf>());
    // Forward slashes read the same on every system.
    PathBuf::from(relative.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/"))
}

/// A scene that a preset names and that cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    Builtin(#[from] scene::builtin::BuiltinError),
    #[error("the preset names {path}, which is not there")]
    Absent { path: String },
    #[error(transparent)]
    Model(#[from] scene::gltf::LoadError),
    #[error(transparent)]
    Absence(#[from] crate::preset::MissingInScene),
}

/// Builds or loads the scene of a preset; a relative model path starts at the folder of `preset_path`.
pub fn load_scene(preset: &Preset, preset_path: Option<&Path>) -> Result<Arc<Scene>, SceneError> {
    let scene = match &preset.scene {
        SceneSource::Builtin(query) => scene::builtin::build(query)?,
        SceneSource::File(model) => {
            let path = model_path(model, preset_path);
            if !path.exists() {
                return Err(SceneError::Absent { path: path.display().to_string() });
            }
            scene::gltf::load(&path)?
        }
    };
    preset.check(&scene)?;
    Ok(Arc::new(if preset.room > 0.0 { scene.in_room(preset.room) } else { scene }))
}

/// A parameter's value in its form.
fn get(field: &Field, words: &[u32]) -> Value {
    Value::Numbers(field.get(words))
}

/// Writes a parameter; the error completes a sentence that begins with its key.
fn put(field: &Field, words: &mut [u32], plain: &Value) -> Result<(), String> {
    let Value::Numbers(lanes) = plain else { unreachable!("parameters are numbers") };
    field.set(words, lanes).map_err(|e| e.to_string().trim_start_matches(field.name).trim_start().to_owned())
}
