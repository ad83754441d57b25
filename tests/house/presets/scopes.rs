//! Promise: the key `on` of an effect is read, written, shared and changed like any other value,
//! and what it cannot mean is refused in one sentence.

use rasterlab::{
    effect_files::{Catalog, Hook, template},
    effects::{Conflict, EFFECTS, Effect},
    preset_file::{from_line, parse_with, to_line, to_toml},
    scene::{builtin, parts::MAX_SCOPES},
};

use super::*;

/// The scope of an effect as a text.
fn on(preset_file: &PresetFile, effect: &str) -> String {
    preset_file
        .preset
        .stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is off"))
        .on
        .to_string()
}

#[test]
fn a_scope_survives_the_text_and_the_line() {
    let text = "schema = 2\n\n[effects.toon]\n# the glass alone\non = [\"material:Lens*\", \"node:Body\", \"mesh:a b: c?\"] # and the body\nsteps = 2\n\n[effects.skin]\neffect = \"toon\"\non = [\"node:Skin\"]\n";
    let preset_file = parse(text);
    assert!(
        preset_file.warnings.is_empty(),
        "{:?}",
        preset_file.warnings
    );
    assert_eq!(
        on(&preset_file, "toon"),
        "material:Lens*, node:Body, mesh:a b: c?"
    );
    assert_eq!(on(&preset_file, "skin"), "node:Skin");
    assert_eq!(to_toml(&preset_file), text);
    let back = from_line(&to_line(&preset_file)).expect("a line of ours");
    assert_eq!(bits(&back.preset), bits(&preset_file.preset));
    // Written anew, without the text.
    let mut fresh = PresetFile::new("fresh", preset_file.preset.clone());
    fresh.effects = preset_file.effects.clone();
    let again = parse(&to_toml(&fresh));
    assert_eq!(bits(&again.preset), bits(&preset_file.preset));
}

#[test]
fn a_scope_has_at_most_so_many_patterns() {
    let long = format!(
        "schema = 2\n[effects.toon]\non = [{}]\n",
        "\"mesh:x\", ".repeat(33)
    );
    assert!(refusal(&long).contains("has 33 patterns; at most 32 are allowed"));
}

#[test]
fn only_effects_on_draws_take_a_scope() {
    let taking: Vec<&str> = EFFECTS
        .iter()
        .filter(|effect| effect.has_scope())
        .map(|effect| effect.name.as_str())
        .collect();
    for name in [
        "explode",
        "inflate",
        "wobble",
        "dissolve",
        "stipple",
        "facet",
        "lambert",
        "shadow",
        "toon",
        "hatch",
        "wireframe",
        "fog",
    ] {
        assert!(taking.contains(&name), "{name}");
    }
    for effect in EFFECTS.iter().filter(|effect| !effect.has_scope()) {
        let error = refusal(&format!(
            "schema = 2\n[effects.{}]\non = [\"node:x\"]\n",
            effect.name
        ));
        assert!(
            error.contains("cannot be set, because") && error.contains(&effect.name),
            "{error}"
        );
        // The whole scene is what it acts on anyway.
        parse(&format!("schema = 2\n[effects.{}]\non = []\n", effect.name));
    }
    for name in [
        "boxes",
        "xray",
        "outline",
        "dots",
        "particles",
        "draw_order",
    ] {
        assert!(!taking.contains(&name), "{name}");
    }
}

#[test]
fn an_effect_of_a_file_takes_a_scope_and_keeps_it_when_its_text_changes() {
    let mut catalog = Catalog::default();
    catalog
        .add_text("ink", &template("ink", Hook::Surface))
        .unwrap();
    let mut preset_file = parse_with(
        "schema = 2\n[effects.ink]\non = \"mesh:x\"\n",
        "mine",
        "mine.toml",
        &catalog,
    )
    .unwrap_or_else(|error| panic!("{error}"));
    let old = preset_file
        .preset
        .stack
        .get("ink")
        .expect("it is on")
        .effect
        .clone();
    let mut edited = Catalog::default();
    edited
        .add_text(
            "ink",
            &format!("{}\n// edited\n", template("ink", Hook::Surface)),
        )
        .unwrap();
    let new = edited.find("ink").unwrap().expect("it is there").clone();
    assert_ne!(old, new);
    preset_file.preset.rebind(&[(old, new.clone())]);
    assert_eq!(on(&preset_file, "ink"), "mesh:x");
    // Edited into an effect on pixels, it has none.
    edited
        .add_text("ink", &template("ink", Hook::Pixel))
        .unwrap();
    preset_file.preset.rebind(&[(
        new,
        edited.find("ink").unwrap().expect("it is there").clone(),
    )]);
    assert_eq!(on(&preset_file, "ink"), "whole scene");
}

#[test]
fn as_many_effects_have_a_scope_as_a_draw_has_bits() {
    let table = |i: usize| format!("[effects.e{i}]\neffect = \"toon\"\non = \"node:x\"\n");
    let text: String = (0..MAX_SCOPES).map(table).collect();
    let mut full = parse(&format!("schema = 2\n{text}"));
    assert_eq!(full.preset.stack.check(), Ok(()));
    let error = refusal(&format!("schema = 2\n{text}{}", table(MAX_SCOPES)));
    assert!(
        error.contains("33 effects are limited to parts of the scene, but at most 32 can be"),
        "{error}"
    );
    let before = full.preset.clone();
    let error = preset_file::set(&mut full, "fog.on", "node:x")
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("at most 32 can be") && full.preset == before,
        "{error}"
    );
    // One more without a scope is fine.
    preset_file::set(&mut full, "fog", "").unwrap();
    assert!(matches!(
        full.preset.stack.check(),
        Ok(()) | Err(Conflict::Slot { .. } | Conflict::GlassInOrder { .. })
    ));
}

#[test]
fn a_pattern_that_matches_nothing_names_the_parts_that_there_are() {
    let scene = builtin::build("cube-wall").expect("a scene").in_room(1.5);
    let missing = |text: &str| {
        parse(&format!("schema = 2\n[effects.toon]\non = {text}\n"))
            .preset
            .missing_parts(&scene)
    };
    assert_eq!(
        missing("[\"material:coral\", \"mesh:cube\", \"node:cube 1*\", \"node:room\"]"),
        [""; 0]
    );
    let [warning] = &missing("[\"material:coral\", \"material:choral\"]")[..] else {
        panic!("one warning")
    };
    assert!(
        warning.starts_with("effects.toon.on: the scene has no material that matches \"choral\"; its materials are \"amber\""),
        "{warning}"
    );
    assert!(warning.contains("did you mean \"coral\"?"), "{warning}");
    let [warning] = &missing("\"node:Body\"")[..] else {
        panic!("one warning")
    };
    assert!(warning.contains("\"cube 11\" and 149 more"), "{warning}");
    // Particles join the scene when it is drawn.
    let particles = |extra: &str| {
        parse(&format!(
            "schema = 2\n{extra}[effects.toon]\non = \"mesh:particles\"\n"
        ))
        .preset
        .missing_parts(&scene)
    };
    assert_eq!(particles("[effects.particles]\n"), [""; 0]);
    assert_eq!(particles("").len(), 1);
}

#[test]
fn disabled_and_enabled_anew_an_effect_is_on_the_whole_scene() {
    let mut preset_file = parse("schema = 2\n[effects.toon]\non = \"node:x\"\n");
    preset_file.preset.disable("toon");
    preset_file
        .preset
        .stack
        .enable(Effect::find("toon").expect("a listed effect"));
    assert_eq!(on(&preset_file, "toon"), "whole scene");
    assert!(!to_toml(&preset_file).contains("node:x"));
}
