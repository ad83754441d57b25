//! Preset files: what loads is written and loads again the same.

use rasterlab::{
    effect_files::Catalog,
    preset_file::{self, EffectValues, PresetError, PresetFile},
};

use super::{Outcome, Target, assert_told_with_place};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "preset",
    about: "presets, and values of an effect, as TOML",
    views: &[],
    limit: Limit::new(5, 256),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Err("it is no UTF-8".into());
    };
    let outcome = opens(preset_file::parse(text, "fuzz"));
    let catalog = Catalog::default();
    match EffectValues::parse(text, "fuzz", &catalog) {
        Ok(values) => {
            let written = values.to_text(&catalog);
            let again = EffectValues::parse(&written, "fuzz", &catalog)
                .unwrap_or_else(|error| panic!("written values are refused: {error}\n{written}"));
            assert_eq!(format!("{:?}", again), format!("{values:?}"), "{written}");
        }
        Err(error) => assert_told_with_place(&error.to_string()),
    }
    outcome
}

/// What is read also comes back, with the model that it may name outside of its folder.
pub fn opens(read: Result<PresetFile, PresetError>) -> Outcome {
    let preset_file = read.map_err(|error| error.to_string())?;
    // The text of a newer schema stays as it is, with the path as it was written.
    if !(preset_file.read_only && preset_file.outside_model.is_some()) {
        comes_back(&preset_file.with_outside_model());
    }
    Ok(())
}

/// What was read is written, and read again as the same.
pub fn comes_back(preset_file: &PresetFile) {
    preset_file
        .remarks()
        .iter()
        .for_each(|remark| assert_told_with_place(remark));
    let preset = &preset_file.preset;
    for time_s in [-1e9, 0.0, 0.3, 1e300] {
        assert!(preset.stack_at(time_s).0.len() == preset.stack.0.len());
    }
    let text = preset_file::to_toml(preset_file);
    let again = preset_file::parse(&text, &preset_file.id)
        .unwrap_or_else(|error| panic!("the written preset is refused: {error}\n{text}"));
    assert_eq!(
        format!("{:?}", again.preset),
        format!("{preset:?}"),
        "the written preset differs\n{text}"
    );
    assert_eq!(
        preset_file::to_toml(&again),
        text,
        "it is written differently the second time"
    );
    // The same state on a text of its own, without what the file had.
    let mut fresh = PresetFile::new("fuzz", preset.clone());
    fresh.effects = preset_file.effects.clone();
    if fresh.check_savable().is_ok() {
        let shared = preset_file::to_shared_toml(&fresh);
        let again = preset_file::parse(&shared, "fuzz").unwrap_or_else(|error| {
            panic!("the preset written anew is refused: {error}\n{shared}")
        });
        assert_eq!(
            format!("{:?}", again.preset),
            format!("{preset:?}"),
            "the preset written anew differs\n{shared}"
        );
    }
}
