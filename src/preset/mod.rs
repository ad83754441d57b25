//! Looks: TOML files that hold a whole [`Session`], sparse, versioned and keyed by name.
//!
//! Presence of `[effects.NAME]` enables an effect; `stack` is only order. Comments and unknown keys are kept and
//! written back. Every value is finite and inside its hard range after loading, or the file is refused with a line.

mod error;
pub mod form;
mod gallery;
pub mod keys;
pub mod migrate;
mod read;
pub mod schema;
mod share;
mod shot;
mod write;

use std::{
    io::Write as _,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use toml_edit::{DocumentMut, Value};

pub use error::{Place, PresetError};
pub use gallery::{BUILTIN_DIR, GalleryEntry, Origin, gallery, open, user_folder};
pub use share::{from_line, to_line};
pub use shot::{Provenance, look_from_png, png_bytes, png_pixels, png_with_look};

use crate::{
    effects::{EFFECTS, Effect},
    params::Field,
    scene::{self, Scene},
    session::{SceneSource, Session},
};
use form::{Form, Plain, did_you_mean};
use keys::{KEYS, Key, Section};

/// An open look: a session with the file it came from.
#[derive(Clone, Debug)]
pub struct Look {
    /// File stem.
    pub id: String,
    /// None for built-in, pasted and new looks.
    pub path: Option<PathBuf>,
    pub session: Session,
    /// What the reader found odd, each with its line.
    pub warnings: Vec<String>,
    /// Built in, or written by a newer program.
    pub read_only: bool,
    /// Written by a newer program: it may mean more than we understand, so it is never written back.
    is_newer: bool,
    /// The text as it was, with comments and unknown keys.
    document: DocumentMut,
    /// What `document` says.
    saved: Session,
}

impl Look {
    /// A look without a file.
    pub fn new(id: &str, session: Session) -> Self {
        Self {
            id: id.into(),
            path: None,
            session,
            warnings: Vec::new(),
            read_only: false,
            is_newer: false,
            document: DocumentMut::new(),
            saved: Session::default(),
        }
    }

    /// The default look on a model or builtin scene: daylight, nothing else.
    pub fn of_scene(id: &str, scene: SceneSource) -> Self {
        let mut session = Session { name: id.into(), scene, ..Session::default() };
        session.stack.enable(&crate::effects::lambert::EFFECT);
        Self::new(id, session)
    }

    /// Shown to people: the name, or the id of a nameless look.
    pub fn title(&self) -> &str {
        if self.session.name.is_empty() { &self.id } else { &self.session.name }
    }

    /// Would saving change the file?
    pub fn is_modified(&self) -> bool {
        self.session != self.saved
    }

    /// Fails if the reader had warnings.
    pub fn strict(self) -> Result<Self, PresetError> {
        if self.warnings.is_empty() { Ok(self) } else { Err(PresetError::Strict(self.warnings)) }
    }
}

/// Reads the text of a look called `id`; errors and warnings name `<id>.toml`.
pub fn parse(text: &str, id: &str) -> Result<Look, PresetError> {
    parse_file(text, id, &format!("{id}.toml"))
}

/// Reads the text of a look that people know as `file`.
pub fn parse_file(text: &str, id: &str, file: &str) -> Result<Look, PresetError> {
    let document = read::document(text, file)?;
    let read::Reading { session, warnings, is_newer } = read::read(&document, file)?;
    let schema = document.get("schema").and_then(|item| item.as_integer()).unwrap_or(migrate::CURRENT);
    let document = if schema < migrate::CURRENT { migrate::migrate(document.into_mut(), schema) } else { document.into_mut() };
    Ok(Look { id: id.into(), path: None, saved: session.clone(), session, warnings, read_only: is_newer, is_newer, document })
}

/// Reads a look from a `.toml` file.
pub fn load(path: &Path) -> Result<Look, PresetError> {
    let file = path.display().to_string();
    let bytes = read_capped(path, read::MAX_BYTES as u64)?;
    let text = String::from_utf8(bytes).map_err(|_| PresetError::Read { file: file.clone(), reason: "it is not UTF-8 text".into() })?;
    let look = parse_file(&text, &stem(path), &file)?;
    Ok(Look { path: Some(path.to_owned()), ..look })
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
    path.file_stem().map_or_else(|| "look".into(), |stem| stem.to_string_lossy().into_owned())
}

/// The look as TOML: the text it came from, with the differences written in. Byte for byte the file if nothing changed.
pub fn to_toml(look: &Look) -> String {
    let mut document = look.document.clone();
    if !look.is_newer {
        write::patch(&mut document, &look.saved, &look.session);
    }
    document.to_string()
}

/// Writes the look to `path`, whole or not at all, and makes that its file. An unmodified file is left alone.
/// A relative model path is rewritten so that it still leads to the model.
pub fn save(look: &mut Look, path: &Path) -> Result<(), PresetError> {
    if look.is_newer {
        return Err(PresetError::ReadOnly { id: look.id.clone(), reason: "its schema is newer than this program".into() });
    }
    let mut next = look.clone();
    if let SceneSource::File(model) = &look.session.scene {
        next.session.scene = SceneSource::File(rebase(model, look.path.as_deref(), path));
    }
    let text = to_toml(&next);
    if look.path.as_deref() != Some(path) || text != look.document.to_string() {
        write_atomically(path, text.as_bytes())?;
    }
    next.document =
        text.parse().map_err(|e: toml_edit::TomlError| PresetError::Write { file: path.display().to_string(), reason: e.to_string() })?;
    next.saved = next.session.clone();
    (next.id, next.path, next.read_only) = (stem(path), Some(path.to_owned()), false);
    *look = next;
    Ok(())
}

/// Writes beside `path`, then renames, so that a reader sees the old file or the new one.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), PresetError> {
    let failed = |reason: String| PresetError::Write { file: path.display().to_string(), reason };
    // Through a link, so that the link stays one.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let there = std::fs::metadata(&target).ok();
    if there.as_ref().is_some_and(|m| m.permissions().readonly()) {
        return Err(failed("the file is read-only".into()));
    }
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".rasterlab-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(|e| failed(e.to_string()))?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(|e| failed(e.to_string()))?;
    if let Some(there) = there {
        std::fs::set_permissions(file.path(), there.permissions()).map_err(|e| failed(e.to_string()))?;
    }
    file.persist(&target).map_err(|e| failed(e.error.to_string()))?;
    Ok(())
}

/// Where a model lies, for a look at `look_path` (or in the current folder).
fn model_path(model: &Path, look_path: Option<&Path>) -> PathBuf {
    look_path.and_then(Path::parent).unwrap_or(Path::new("")).join(model)
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

/// A scene that a look names and that cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    Builtin(#[from] scene::builtin::BuiltinError),
    #[error("the look names {path}, which is not there")]
    Absent { path: String },
    #[error(transparent)]
    Model(#[from] scene::gltf::LoadError),
}

/// Builds or loads the scene of a look; a relative model path starts at the folder of `look_path`.
pub fn load_scene(session: &Session, look_path: Option<&Path>) -> Result<Arc<Scene>, SceneError> {
    match &session.scene {
        SceneSource::Builtin(query) => Ok(Arc::new(scene::builtin::build(query)?)),
        SceneSource::File(model) => {
            let path = model_path(model, look_path);
            if !path.exists() {
                return Err(SceneError::Absent { path: path.display().to_string() });
            }
            Ok(Arc::new(scene::gltf::load(&path)?))
        }
    }
}

/// A parameter's value in its form.
fn get(field: &Field, words: &[u32]) -> Plain {
    Plain::Numbers(field.get(words))
}

/// Writes a parameter; the error completes a sentence that begins with its key.
fn put(field: &Field, words: &mut [u32], plain: &Plain) -> Result<(), String> {
    let Plain::Numbers(lanes) = plain else { unreachable!("parameters are numbers") };
    field.set(words, lanes).map_err(|e| e.to_string().trim_start_matches(field.name).trim_start().to_owned())
}

/// Where a `--set` or `--unset` path leads.
enum Target {
    Effect(&'static Effect),
    Field(&'static Effect, &'static Field),
    Key(&'static Key),
    Section(&'static Section),
    Stack,
}

fn target(path: &str) -> Result<Target, String> {
    if path == "stack" {
        return Ok(Target::Stack);
    }
    if let Some(key) = Key::find(path) {
        return Ok(Target::Key(key));
    }
    if let Some(section) = Section::find(path) {
        return Ok(Target::Section(section));
    }
    let short = path.strip_prefix("effects.").unwrap_or(path);
    let (name, field) = short.split_once('.').map_or((short, None), |(name, field)| (name, Some(field)));
    match (Effect::find(name), field) {
        (Some(effect), None) => Ok(Target::Effect(effect)),
        (Some(effect), Some(field)) => match effect.field(field) {
            Some(field) => Ok(Target::Field(effect, field)),
            None => Err(format!("is unknown{}", did_you_mean(field, effect.fields.iter().map(|field| field.name)))),
        },
        (None, _) => {
            let keys = KEYS.iter().map(Key::path);
            let fields = EFFECTS.iter().flat_map(|e| e.fields.iter().map(move |f| format!("{}.{}", e.name, f.name)));
            let known: Vec<String> = keys.chain(fields).chain(EFFECTS.iter().map(|e| e.name.to_owned())).collect();
            Err(format!("is unknown{}", did_you_mean(short, known.iter().map(String::as_str))))
        }
    }
}

/// A value as typed on a command line: TOML, or a number such as `.4`, or a bare word.
fn typed(value: &str) -> Value {
    let value = value.trim();
    value.parse().unwrap_or_else(|_| match value.parse::<f64>() {
        Ok(number) if number.is_finite() => number.into(),
        _ => value.into(),
    })
}

/// Changes one key, as `--set path=value` does: `effects.` is optional, setting a parameter enables its effect, and an
/// effect or section with an empty value is enabled with defaults. Same ranges and errors as in a file.
pub fn set(look: &mut Look, path: &str, value: &str) -> Result<(), PresetError> {
    let written = if value.is_empty() { format!("--set {path}") } else { format!("--set {path}={value}") };
    let wrong = |reason: String| PresetError::value(Place { file: written.clone(), line: None }, path, reason);
    let session = &mut look.session;
    match target(path).map_err(wrong)? {
        Target::Effect(effect) if value.is_empty() => drop(session.stack.enable(effect)),
        Target::Section(section) if value.is_empty() => section.enter(session),
        Target::Effect(_) | Target::Section(_) => return Err(wrong("takes no value; name one of its keys".into())),
        Target::Field(effect, field) => {
            let plain = read::read_value(&Form::of(field), &typed(value)).map_err(wrong)?;
            put(field, &mut session.stack.enable(effect).words, &plain).map_err(wrong)?;
        }
        Target::Key(key) => {
            // A name that looks like a number is still a name.
            let value =
                Some(typed(value)).filter(|typed| typed.is_str() || !matches!(key.form, Form::Text { .. })).unwrap_or_else(|| value.into());
            let plain = read::read_value(&key.form, &value).map_err(wrong)?;
            (key.set)(session, plain);
        }
        Target::Stack => {
            // The reader knows the rules of this key, so it goes the way of a file.
            let mut text: DocumentMut = to_toml(look).parse().map_err(|e: toml_edit::TomlError| wrong(e.message().into()))?;
            text.insert("stack", toml_edit::Item::Value(typed(value)));
            let reread = parse_file(&text.to_string(), &look.id, &written).map_err(|error| match error {
                PresetError::Value { key, reason, .. } => PresetError::value(Place { file: written.clone(), line: None }, key, reason),
                other => other,
            })?;
            look.session.stack = reread.session.stack;
        }
    }
    Ok(())
}

/// Puts one key back to its default, as `--unset path` does; an effect or section is taken out.
pub fn unset(look: &mut Look, path: &str) -> Result<(), PresetError> {
    let place = Place { file: format!("--unset {path}"), line: None };
    let session = &mut look.session;
    match target(path).map_err(|reason| PresetError::value(place, path, reason))? {
        Target::Effect(effect) => session.stack.disable(effect.name),
        Target::Field(effect, field) => {
            if let Some(enabled) = session.stack.get_mut(effect.name) {
                field.copy(&(effect.defaults)(), &mut enabled.words);
            }
        }
        Target::Key(key) => reset(session, key),
        Target::Section(section) => match section.name {
            "camera" => session.camera = None,
            "test" => session.test = None,
            name => KEYS.iter().filter(|key| key.section == name).for_each(|key| reset(session, key)),
        },
        Target::Stack => session.stack.0.sort_by_key(|enabled| enabled.effect.rank()),
    }
    Ok(())
}

/// Gives `key` its default; one that has none hands over to its rival.
fn reset(session: &mut Session, key: &Key) {
    if (key.get)(session).is_none() {
        return;
    }
    let baseline = Section::baseline(session);
    let rival = key.rival.and_then(|name| Key::within(key.section, name));
    for key in [Some(key), rival].into_iter().flatten() {
        if let Some(default) = (key.get)(&baseline) {
            (key.set)(session, default);
            return;
        }
    }
}
