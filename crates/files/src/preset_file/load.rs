//! Loading: bytes to text, text of any schema to a preset.

use std::{io::Read as _, path::Path};

use toml_edit::Document;

use super::{
    error::{Position, PresetError},
    file::{PresetFile, stem},
    migrate, read, reader,
};
use crate::{effect_files::Catalog, params::legible_line};

/// Longest preset that is read, bytes.
pub const MAX_BYTES: usize = 1 << 20;

/// Reads the text of a preset called `id`; errors and warnings name `<id>.toml`.
///
/// # Errors
/// As [`parse_file`].
pub fn parse(text: &str, id: &str) -> Result<PresetFile, PresetError> {
    parse_file(text, id, &format!("{id}.toml"))
}

/// Reads the text of a preset; `file` is what errors and warnings call it. Text of an older schema is migrated.
///
/// # Errors
/// No TOML, or a value that is not allowed, with its line.
pub fn parse_file(text: &str, id: &str, file: &str) -> Result<PresetFile, PresetError> {
    parse_with(text, id, file, &Catalog::default())
}

/// [`parse_file`] for a preset that may use the effects of `catalog`.
///
/// # Errors
/// As [`parse_file`], or an effect whose file is faulty.
pub fn parse_with(text: &str, id: &str, file: &str, catalog: &Catalog) -> Result<PresetFile, PresetError> {
    let original = document(text, file)?;
    let mut warnings = Vec::new();
    let schema = schema(&original, file, &mut warnings)?;
    // A migration changes names inside their lines, so the lines of the migrated text are those of the file.
    let current = if migrate::is_outdated(original.as_table(), schema) {
        document(&migrate::migrate(original.into_mut(), schema).to_string(), file)?
    } else {
        original
    };
    let read = read::read(&current, file, catalog)?;
    warnings.extend(read.warnings);
    let (preset, is_newer) = (read.preset, schema > migrate::CURRENT);
    let document = current.into_mut();
    Ok(PresetFile {
        id: id.into(),
        path: None,
        saved: preset.clone(),
        preset,
        warnings,
        read_only: is_newer,
        is_newer,
        document,
        effects: read.catalog,
        brought_effects: read.brought_effects,
        chose_scene: false,
        look: None,
    })
}

/// Reads a preset from a `.toml` file.
///
/// # Errors
/// The file cannot be read, or as [`parse_file`].
pub fn load(path: &Path) -> Result<PresetFile, PresetError> {
    load_with(path, &Catalog::default())
}

/// [`load`] for a preset that may use the effects of `catalog`, and those in the folder `effects` beside it.
///
/// # Errors
/// As [`load`], or an effect whose file is faulty.
pub fn load_with(path: &Path, catalog: &Catalog) -> Result<PresetFile, PresetError> {
    let mut catalog = catalog.clone();
    catalog.add_folder(&path.with_file_name("effects"));
    let preset_file = parse_with(&read_text(path)?, &stem(path), &path.display().to_string(), &catalog)?;
    Ok(PresetFile { path: Some(path.to_owned()), ..preset_file })
}

/// A preset's text as the current schema has it.
pub struct Migrated {
    /// The schema of the file.
    pub from: i64,
    pub before: String,
    pub after: String,
}

/// The text of the file at `path`, migrated to the current schema; it must be a preset that loads.
///
/// # Errors
/// As [`load`].
pub fn migrated(path: &Path) -> Result<Migrated, PresetError> {
    let (before, file) = (read_text(path)?, path.display().to_string());
    parse_file(&before, &stem(path), &file)?;
    let document = document(&before, &file)?;
    let from = schema(&document, &file, &mut Vec::new())?;
    let is_outdated = migrate::is_outdated(document.as_table(), from);
    let after = if is_outdated { migrate::migrate(document.into_mut(), from).to_string() } else { before.clone() };
    Ok(Migrated { from, before, after })
}

/// The text of a preset file, or of another file of at most [`MAX_BYTES`].
pub(super) fn read_text(path: &Path) -> Result<String, PresetError> {
    let bytes = read_capped(path, MAX_BYTES as u64)?;
    String::from_utf8(bytes).map_err(|_| PresetError::Read { file: path.display().to_string(), reason: "it is not UTF-8 text".into() })
}

/// The bytes of a regular file of at most `max_bytes`.
pub(super) fn read_capped(path: &Path, max_bytes: u64) -> Result<Vec<u8>, PresetError> {
    let failed = |reason: String| PresetError::Read { file: path.display().to_string(), reason };
    // A pipe would wait for its other end when it is opened.
    if !std::fs::metadata(path).map_err(|e| failed(e.to_string()))?.is_file() {
        return Err(failed("it is not a regular file".into()));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|e| failed(e.to_string()))?;
    file.take(max_bytes + 1).read_to_end(&mut bytes).map_err(|e| failed(e.to_string()))?;
    if bytes.len() as u64 > max_bytes {
        return Err(failed(format!("it is longer than {max_bytes} bytes")));
    }
    Ok(bytes)
}

/// Parses TOML; a syntax error has its line.
fn document(text: &str, file: &str) -> Result<Document<String>, PresetError> {
    let at = |line| Position { file: file.into(), line };
    if text.len() > MAX_BYTES {
        return Err(PresetError::Syntax { at: at(None), reason: format!("is longer than {MAX_BYTES} bytes") });
    }
    Document::parse(text.to_owned()).map_err(|error| {
        let line = error.span().map(|span| reader::line_of(text, span.start));
        PresetError::Syntax { at: at(line), reason: legible_line(&error.message().trim().replace('\n', ", ")) }
    })
}

/// The schema that a document states; a missing one is taken for the current one.
fn schema(document: &Document<String>, file: &str, warnings: &mut Vec<String>) -> Result<i64, PresetError> {
    let Some(item) = document.get("schema") else {
        warnings.push(format!("{file}: schema is missing; write schema = {} on the first line", migrate::CURRENT));
        return Ok(migrate::CURRENT);
    };
    let at = reader::position(document.as_table(), "schema", file, document.raw());
    match item.as_integer() {
        Some(schema) if schema >= 1 => {
            if schema > migrate::CURRENT {
                let newest = migrate::CURRENT;
                warnings
                    .push(format!("{at}: schema {schema} is newer than {newest}, the newest that this program knows; opened read-only"));
            }
            Ok(schema)
        }
        _ => Err(PresetError::value(at, "schema", "must be a whole number from 1 up")),
    }
}
