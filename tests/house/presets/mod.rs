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
    effect_files::{Catalog, Hook, template},
    preset::Preset,
    preset_file::{self, PresetFile, parse_with},
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

/// The numbers of a parameter.
fn values(preset: &Preset, effect: &str, field: &str) -> Vec<f64> {
    let enabled = preset
        .stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is not enabled"));
    enabled
        .effect
        .field(field)
        .expect("a parameter")
        .get(&enabled.words)
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

/// Plays a transcript on a preset, `schema = 2` at first, with the effect ink of a file; ¶ ends a
/// line of it.
///
/// - `@ TEXT` reads another one, without a warning;
/// - `set PATH=VALUE` and `unset PATH` change it, `! PATH=VALUE ⇒ WORDS` is refused and changes
///   nothing;
/// - `= TEXT` is what is written, `> TEXT` and `>- TEXT` stand in it or do not, and what is written
///   is read as the same;
/// - `& TEXT` is read as the same preset; `stack NAMES`, `moves` and `still` say what it is.
fn play(transcript: &str) {
    let mut catalog = Catalog::default();
    catalog
        .add_text("ink", &template("ink", Hook::Surface))
        .unwrap();
    let read = |text: &str| {
        let file = parse_with(text, "preset", "preset.toml", &catalog);
        file.unwrap_or_else(|error| panic!("{error}\n{text}"))
    };
    let mut file = PresetFile::new("new", Preset::default());
    for line in transcript.lines().filter(|line| !line.is_empty()) {
        let (mark, text) = line.split_once(' ').unwrap_or((line, ""));
        let text = text.replace('¶', "\n");
        let written = preset_file::to_toml(&file);
        let told = || format!("{line}\n{written}");
        assert_eq!(
            bits(&read(&written).preset),
            bits(&file.preset),
            "{}",
            told()
        );
        match mark {
            "@" => file = read(&text),
            "set" => {
                let (path, value) = text.split_once('=').expect("a value");
                preset_file::set(&mut file, path, value).unwrap_or_else(|error| panic!("{error}"));
            }
            "unset" => preset_file::unset(&mut file, &text).unwrap(),
            "!" => {
                let (set, wanted) = text.split_once(" ⇒ ").expect("an arrow");
                let (path, value) = set.split_once('=').expect("a value");
                let before = file.preset.clone();
                let error = preset_file::set(&mut file, path, value)
                    .expect_err(line)
                    .to_string();
                assert!(
                    error.contains(wanted) && !error.contains('\n'),
                    "{line}\n{error}"
                );
                assert_eq!(file.preset, before, "a refused value changes nothing");
            }
            "=" => assert_eq!(written, text, "{line}"),
            ">" => assert!(written.contains(&text), "{}", told()),
            ">-" => assert!(!written.contains(&text), "{}", told()),
            "&" => assert_eq!(bits(&file.preset), bits(&read(&text).preset), "{}", told()),
            "stack" => assert_eq!(stack_names(&file).join(" "), text, "{}", told()),
            "moves" => assert!(file.preset.is_moving(), "{}", told()),
            "still" => assert!(
                file.preset.animation.is_empty() && !file.preset.is_moving(),
                "{}",
                told()
            ),
            "#" => {}
            _ => panic!("the transcript has no meaning: {line}"),
        }
        assert_eq!(
            file.warnings
                .iter()
                .filter(|warning| !["later", "future"]
                    .iter()
                    .any(|word| warning.contains(word)))
                .count(),
            0,
            "{:?}",
            file.warnings
        );
    }
}

#[test]
fn presets_change_as_the_transcripts_say() {
    for part in include_str!("transcripts.txt").split("=== ").skip(1) {
        play(part.split_once('\n').expect("a title and a transcript").1);
    }
}
