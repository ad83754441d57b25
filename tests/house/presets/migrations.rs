//! Promise: a preset of every older schema loads, and is written in the newest one.

use rasterlab::{
    accuracy::Visibility,
    preset::Preset,
    preset_file::{self, PresetFile},
};

use super::*;

/// A preset of schema 1 with every key and word that schema 2 renames, and the same in schema 2.
const SCHEMA_1: &str = include_str!("../migrations/schema-1.toml");
const SCHEMA_2: &str = include_str!("../migrations/schema-2.toml");
/// The same for an effect that excludes another of the first fixture.
const FIXTURES: [(&str, &str); 2] =
    [(SCHEMA_1, SCHEMA_2), (include_str!("../migrations/overdraw-1.toml"), include_str!("../migrations/overdraw-2.toml"))];

#[test]
fn a_preset_of_schema_1_loads_and_is_written_as_schema_2_with_its_comments() {
    for (before, after) in FIXTURES {
        let (old, new) = (parse(before), parse(after));
        assert_eq!((&old.warnings, &new.warnings), (&Vec::new(), &Vec::new()));
        assert_eq!(bits(&old.preset), bits(&new.preset));
        assert_eq!(preset_file::to_toml(&old), after);
        assert!(!old.is_modified(), "a migration is no edit");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.toml");
        std::fs::write(&path, before).unwrap();
        let migrated = preset_file::migrated(&path).unwrap();
        assert_eq!((migrated.from, migrated.before.as_str(), migrated.after.as_str()), (1, before, after));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), before, "loading never rewrites a file");
    }
}

#[test]
fn the_fixtures_have_every_key_and_word_that_a_migration_renames() {
    let has_key = |text: &str, owner: &str, key: &str| {
        let document: toml_edit::DocumentMut = text.parse().unwrap();
        let tables = [document.get(owner), document.get("effects").and_then(|effects| effects.get(owner))];
        tables.into_iter().flatten().any(|table| table.get(key).is_some())
    };
    for (owner, old, new) in preset_file::migrate::RENAMED_KEYS {
        let is_there = FIXTURES.iter().any(|(before, after)| has_key(before, owner, old) && has_key(after, owner, new));
        assert!(is_there, "{owner}.{old} -> {new} is missing in the fixtures");
    }
    for (.., old, new) in preset_file::migrate::RENAMED_WORDS {
        assert!(SCHEMA_1.contains(&format!("\"{old}\"")) && SCHEMA_2.contains(&format!("\"{new}\"")), "{old} -> {new}");
    }
}

#[test]
fn errors_of_an_older_schema_name_the_line_of_its_file() {
    assert_eq!(refusal("schema = 1\n\n[clock] # time\nloops = false\nspeed = 0\n"), "preset.toml:5: clock.speed 0 lies outside 0.01..=100");
    assert_eq!(
        refusal("schema = 1\n[accuracy]\ntaps = \"2\"\n"),
        "preset.toml:3: accuracy.shadow_taps \"2\" is not one of planned, 1, 9, 25"
    );
}

#[test]
fn a_line_and_a_picture_of_schema_1_load() {
    use base64::Engine as _;
    use std::io::Write as _;
    let mut deflate = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    deflate.write_all(SCHEMA_1.as_bytes()).unwrap();
    let line = format!("rasterlab1:{}", base64::engine::general_purpose::STANDARD.encode(deflate.finish().unwrap()));
    assert_eq!(preset_file::from_line(&line).unwrap().preset, parse(SCHEMA_2).preset);
    // As schema 1 wrote it: under another keyword.
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.add_itxt_chunk("rasterlab look".into(), SCHEMA_1.into()).unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0; 4]).unwrap();
    writer.finish().unwrap();
    assert_eq!(preset_file::preset_from_png(&bytes, "old.png").unwrap().preset, parse(SCHEMA_2).preset);
}

#[test]
fn set_with_a_name_of_an_older_schema_suggests_the_new_one() {
    let mut preset_file = PresetFile::new("new", Preset::default());
    for (path, value, wanted) in [
        ("accuracy.vertices", "packed16", "accuracy.vertices is unknown; did you mean \"accuracy.position_format\"?"),
        ("accuracy.taps", "9", "did you mean \"accuracy.shadow_taps\"?"),
        ("accuracy.render_scale", "whole", "did you mean \"full\"?"),
        ("clock.loops", "true", "did you mean \"clock.loop\"?"),
    ] {
        let error = preset_file::set(&mut preset_file, path, value).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    assert_eq!(preset_file.preset, Preset::default());
}

/// Pictures of the tiled rasterizer were those of split32, which is faster on every adapter that was measured.
#[test]
fn a_withdrawn_word_becomes_the_one_that_draws_the_same() {
    for schema in 1..=2 {
        let text = format!("schema = {schema}\n\n[accuracy]\nvisibility = \"tiled\" # by tiles\n");
        let loaded = parse(&text);
        assert_eq!(loaded.preset.accuracy.pins.option::<Visibility>(), Some(Visibility::Split32));
        assert_eq!(loaded.warnings, Vec::<String>::new());
        assert_eq!(preset_file::to_toml(&loaded), "schema = 2\n\n[accuracy]\nvisibility = \"split32\" # by tiles\n");
    }
}
