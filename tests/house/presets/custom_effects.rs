//! Promise: a preset may use effects of files, several instances of one effect, and bring the
//! effects that it shares.

use rasterlab::{
    effect_files::{Catalog, Hook, template},
    preset_file::{from_line, parse_with, to_line, to_toml},
};

use super::*;

/// A catalog with the effect `ink`.
fn catalog() -> Catalog {
    let mut catalog = Catalog::default();
    catalog
        .add_text("ink", &template("ink", Hook::Surface))
        .unwrap();
    catalog
}

#[test]
fn a_value_outside_the_range_of_a_file_is_refused_with_its_line() {
    let text = "schema = 2\n[effects.ink]\namount = 7.0\n";
    let error = parse_with(text, "mine", "mine.toml", &catalog())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("mine.toml:3")
            && error.contains("effects.ink.amount")
            && error.contains("takes 0 to 1, not 7"),
        "{error}"
    );
}

#[test]
fn what_cannot_be_an_instance_is_refused() {
    let wrong = |table: &str| {
        parse_with(
            &format!("schema = 2\n{table}\n"),
            "mine",
            "mine.toml",
            &catalog(),
        )
        .unwrap_err()
        .to_string()
    };
    for (table, reason) in [
        ("[effects.a]\neffect = \"toom\"", "did you mean"),
        ("[effects.a]\neffect = \"shadow\"", "only once"),
        ("[effects.a]\neffect = \"xray\"", "only once"),
        ("[effects.a]\neffect = 3", "must name an effect"),
        ("[effects.facet]\neffect = \"toon\"", "built-in"),
        ("[effects.ink]\neffect = \"toon\"", "effect file"),
        ("[effects.A-b]\neffect = \"toon\"", "small letter"),
    ] {
        let error = wrong(table);
        assert!(
            error.contains(reason) && error.contains("mine.toml:"),
            "{table}: {error}"
        );
    }
}

#[test]
fn a_shared_preset_brings_its_effects_and_says_so() {
    let text = "schema = 2\n[effects.ink]\namount = 0.25\n";
    let preset_file = parse_with(text, "mine", "mine.toml", &catalog()).unwrap();
    let back = from_line(&to_line(&preset_file)).unwrap();
    assert_eq!(back.brought_effects, ["ink"]);
    assert!(
        back.remarks()
            .iter()
            .any(|remark| remark.contains("brings the effect ink")),
        "{:?}",
        back.remarks()
    );
    let [before, after] = [&preset_file, &back].map(|file| &file.preset.stack.0[0]);
    assert_eq!(
        (&before.words, &before.effect.source),
        (&after.words, &after.effect.source)
    );
    // One that is known with the same text is nothing new.
    let known = parse_with(&to_toml(&back), "mine", "mine.toml", &catalog()).unwrap();
    assert!(known.brought_effects.is_empty());
}

#[test]
fn without_its_file_the_tables_of_an_effect_are_kept_with_a_warning() {
    let text = "schema = 2\n\n[effects.ink]\namount = 0.25\n";
    let unknown = parse(text);
    all_told(&unknown.warnings, "effects.ink");
    assert_eq!(to_toml(&unknown), text);
}
