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

/// Every line is a text that is refused, with ¶ for its line breaks after `head`, and behind ⇒ words
/// of the refusal; those that begin with its place are the whole of it.
fn all_refused(head: &str, cases: &str) {
    for case in cases.trim().lines() {
        let (text, wanted) = case.split_once(" ⇒ ").expect("an arrow");
        let said = refusal(&format!("{head}{}\n", text.trim().replace('¶', "\n")));
        let is_whole = wanted.starts_with("preset.toml:");
        assert!(
            said == wanted || !is_whole && said.contains(wanted),
            "{case}\n{said}"
        );
        assert!(!said.contains('\n'), "{said}");
    }
}

/// Every line of `wanted` is in one of the texts.
fn all_told(texts: &[String], wanted: &str) {
    for wanted in wanted.trim().lines() {
        let is_told = texts.iter().any(|text| text.contains(wanted));
        assert!(is_told, "{wanted:?} is not among\n{}", texts.join("\n"));
    }
}

/// Names of the enabled effects in their order.
fn stack_names(preset_file: &PresetFile) -> Vec<&str> {
    let stack = &preset_file.preset.stack.0;
    stack
        .iter()
        .map(|enabled| enabled.effect.name.as_str())
        .collect()
}

/// Sets values; each line is a path, =, and a value.
fn set_all(preset_file: &mut PresetFile, lines: &str) {
    for line in lines.trim().lines() {
        let (path, value) = line.split_once('=').expect("a value");
        preset_file::set(preset_file, path, value).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Each line is a path, =, a value that is refused, and behind ⇒ words of the refusal.
fn all_unset(preset_file: &PresetFile, lines: &str) {
    for line in lines.trim().lines() {
        let (set, wanted) = line.split_once(" ⇒ ").expect("an arrow");
        let (path, value) = set.split_once('=').expect("a value");
        let mut changed = preset_file.clone();
        let error = preset_file::set(&mut changed, path, value)
            .expect_err(line)
            .to_string();
        assert!(
            error.contains(wanted) && !error.contains('\n'),
            "{line}\n{error}"
        );
        assert_eq!(
            changed.preset, preset_file.preset,
            "a refused value changes nothing"
        );
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
