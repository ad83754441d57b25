//! Presets that commands name, with the changes of `--set` and `--unset`.

use super::{args::Common, error::CliError, files, streams::Streams};
use crate::preset_file::{self, GalleryEntry, PresetFile};

/// Opens a preset and applies `--unset`, then `--set`.
pub fn open(common: &Common, what: &str) -> Result<PresetFile, CliError> {
    let mut preset_file = if what == "-" {
        preset_file::parse_with(&files::stdin_text()?, "stdin", "stdin", &common.folders().effects)?
    } else {
        preset_file::open(what, &common.folders())?
    };
    if common.strict {
        preset_file = preset_file.strict()?;
    }
    for path in &common.unset {
        preset_file::unset(&mut preset_file, path)?;
    }
    for set in &common.set {
        let (path, value) = set.split_once('=').unwrap_or((set, ""));
        preset_file::set(&mut preset_file, path.trim(), value)?;
    }
    if !(common.set.is_empty() && common.unset.is_empty()) {
        preset_file.check_values()?;
    }
    Ok(preset_file)
}

/// The named presets, or every preset of the gallery that has a golden.
pub fn presets(common: &Common, names: &[String], streams: &Streams) -> Result<Vec<PresetFile>, CliError> {
    let preset_files: Vec<PresetFile> = if names.is_empty() {
        let entries = preset_file::gallery(&common.folders());
        let preset_files = entries.iter().map(|entry| open(common, &gallery_name(entry))).collect::<Result<Vec<_>, _>>()?;
        preset_files.into_iter().filter(|preset_file| preset_file.preset.test.is_some()).collect()
    } else {
        names.iter().map(|name| open(common, name)).collect::<Result<_, _>>()?
    };
    preset_files.iter().flat_map(PresetFile::remarks).for_each(|remark| streams.note(&remark));
    Ok(preset_files)
}

/// The path of a preset on disk, or the id of a built-in one.
pub fn gallery_name(entry: &GalleryEntry) -> String {
    entry.path.as_ref().map_or_else(|| entry.id.clone(), |path| path.to_string_lossy().into_owned())
}
