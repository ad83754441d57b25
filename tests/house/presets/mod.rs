//! Promise: presets survive a round trip to the bit, keep unknown keys, and refuse harmful values.

mod bookmarks;
mod custom_effects;
mod fitting;
mod landing;
mod merging;
mod refused;
mod round_trip;
mod saving;
mod scopes;
mod sharing;
mod shown_parts;
mod surroundings;
mod text;

use std::path::{Path, PathBuf};

use rasterlab::{
    preset::Preset,
    preset_file::{self, PresetFile},
};

fn parse(text: &str) -> PresetFile {
    preset_file::parse(text, "preset").unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str) -> String {
    match preset_file::parse(text, "preset") {
        Err(error) => error.to_string(),
        Ok(_) => panic!("this should have been refused:\n{text}"),
    }
}

/// Everything in a preset as bits and words, so that -0.0 and 0.0 differ.
fn bits(preset: &Preset) -> String {
    format!("{preset:?}")
}

fn preset_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let files = std::fs::read_dir(folder)
        .expect("presets/ is there")
        .map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect()
}
