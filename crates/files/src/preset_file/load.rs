//! Loading: bytes to text, text to a preset.

use std::{io::Read as _, path::Path};

use toml_edit::Document;

use super::{
    error::{Position, PresetError},
    file::{PresetFile, stem},
    migrate, read, reader,
};
use crate::{effect_files::Catalog, host::disk, params::legible_line};

/// Longest preset that is read, bytes.
pub const MAX_BYTES: usize = 1 << 20;

/// Reads the text of a preset called `id`; errors and warnings name `<id>.toml`.
pub fn parse(text: &str, id: &str) -> Result<PresetFile, PresetError> {
    parse_file(text, id, &format!("{id}.toml"))
}

/// Reads the text of a preset; `file` is what errors and warnings call it.
pub fn parse_file(text: &str, id: &str, file: &str) -> Result<PresetFile, PresetError> {
    parse_with(text, id, file, &Catalog::default())
}

/// [`parse_file`] for a preset that may use the effects of `catalog`.
pub fn parse_with(
    text: &str,
    id: &str,
    file: &str,
    catalog: &Catalog,
) -> Result<PresetFile, PresetError> {
    let mut warnings = Vec::new();
    let (current, is_newer) = migrate::migrate(document(text, file)?, file, &mut warnings)?;
    let read = read::read(&current, file, catalog)?;
    warnings.extend(read.warnings);
    let (preset, document) = (read.preset, current.into_mut());
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
        outside_model: None,
        chose_scene: false,
        look: None,
    })
}

/// Reads a preset from a `.toml` file.
pub fn load(path: &Path) -> Result<PresetFile, PresetError> {
    load_with(path, &Catalog::default())
}

/// [`load`] for a preset that may use the effects of `catalog`, and those in the folder `effects`
/// beside it.
pub fn load_with(path: &Path, catalog: &Catalog) -> Result<PresetFile, PresetError> {
    let mut catalog = catalog.clone();
    catalog.add_folder(&path.with_file_name("effects"));
    let preset_file = parse_with(
        &read_text(path)?,
        &stem(path),
        &path.display().to_string(),
        &catalog,
    )?;
    Ok(PresetFile {
        path: Some(path.to_owned()),
        ..preset_file
    })
}

/// The text of a preset file, or of another file of at most [`MAX_BYTES`].
pub(super) fn read_text(path: &Path) -> Result<String, PresetError> {
    let bytes = read_capped(path, MAX_BYTES as u64)?;
    String::from_utf8(bytes).map_err(|_| PresetError::Read {
        file: path.display().to_string(),
        reason: "it is not UTF-8 text".into(),
    })
}

/// The bytes of a regular file of at most `max_bytes`.
pub(super) fn read_capped(path: &Path, max_bytes: u64) -> Result<Vec<u8>, PresetError> {
    let failed = |reason: String| PresetError::Read {
        file: path.display().to_string(),
        reason,
    };
    // A pipe would wait for its other end when it is opened.
    let size = disk::size_of(path).map_err(|e| failed(e.to_string()))?;
    if size.is_none() {
        return Err(failed("it is not a regular file".into()));
    }
    let mut bytes = Vec::new();
    let file = disk::open(path).map_err(|e| failed(e.to_string()))?;
    file.take(max_bytes + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| failed(e.to_string()))?;
    if bytes.len() as u64 > max_bytes {
        return Err(failed(format!("it is longer than {max_bytes} bytes")));
    }
    Ok(bytes)
}

/// Parses TOML; a syntax error has its line.
fn document(text: &str, file: &str) -> Result<Document<String>, PresetError> {
    let at = |line| Position {
        file: file.into(),
        line,
    };
    if text.len() > MAX_BYTES {
        return Err(PresetError::Syntax {
            at: at(None),
            reason: format!("is longer than {MAX_BYTES} bytes"),
        });
    }
    Document::parse(text.to_owned()).map_err(|error| {
        let line = error.span().map(|span| reader::line_of(text, span.start));
        PresetError::Syntax {
            at: at(line),
            reason: legible_line(&error.message().trim().replace('\n', ", ")),
        }
    })
}
