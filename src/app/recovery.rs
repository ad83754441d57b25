//! The preset that the window opens with, and saving it when the device is lost.

use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::log::{Level, Log};
use crate::{
    preset::SceneSource,
    preset_file::{self, Folders, PresetFile},
};

/// The preset of a window that was opened without one; it plays. A software driver draws it fast enough for that.
pub const FIRST_PRESET: &str = "facet-random";

/// The preset to begin with: one that is open already, or `open`. If it cannot be opened, the error is logged and the teapot is
/// shown.
pub fn first_preset(opened: Option<PresetFile>, open: Option<&str>, folders: &Folders, log: &mut Log) -> PresetFile {
    let what = open.unwrap_or(FIRST_PRESET);
    match opened.map_or_else(|| preset_file::open(what, folders), Ok) {
        Ok(mut preset_file) => {
            preset_file.remarks().into_iter().for_each(|remark| log.add(Level::Warning, remark));
            // A recovered preset is not saved to the recovery file: Save asks for another.
            preset_file.read_only |= preset_file.path.is_some() && preset_file.path == recovery_path();
            preset_file
        }
        Err(error) => {
            if open.is_some() {
                log.notify(Level::Error, error.to_string(), 0.0);
            }
            // The user did not choose this scene, so presets bring their own.
            let mut fallback = PresetFile::of_scene("teapot", SceneSource::Builtin("teapot".into()));
            fallback.chose_scene = false;
            fallback
        }
    }
}

/// The file that the preset is saved to when the device is lost.
pub fn recovery_path() -> Option<PathBuf> {
    Some(preset_file::user_folder()?.parent()?.join("recovery.toml"))
}

/// Saves the preset for the next start. Returns in words whether that worked.
pub fn write_recovery(preset_file: &PresetFile) -> String {
    let written = || -> anyhow::Result<PathBuf> {
        let path = recovery_path().context("there is no folder for it")?;
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        preset_file::save(&mut preset_file.clone(), &path)?;
        Ok(path)
    };
    match written() {
        Ok(path) => format!("the preset is saved in {}", path.display()),
        Err(error) => format!("the preset could not be saved: {error:#}"),
    }
}
