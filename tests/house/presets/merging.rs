//! Promise: a preset that was changed here and in its file is merged key by key, and nothing of
//! either side is lost unsaid.

use rasterlab::{
    preset::Preset,
    preset_file::{merge, parse},
};

const BASE: &str = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n[effects.lambert]\n[effects.outline]\n\
    [animation.facet]\nfront = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n";

fn preset(text: &str) -> Preset {
    parse(text, "mine")
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .preset
}

fn number(preset: &Preset, effect: &str, field: &str) -> f64 {
    let enabled = preset
        .stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is not enabled"));
    enabled
        .effect
        .field(field)
        .expect("a parameter")
        .get(&enabled.words)[0]
}

#[test]
fn changes_of_different_keys_are_all_kept() {
    let base = preset(BASE);
    let mine = preset(
        &BASE
            .replace("amount = 0.25", "amount = 0.5")
            .replace("[effects.outline]\n", "")
            .replace("Mine", "Ours"),
    );
    let theirs = preset(
        &BASE
            .replace(
                "builtin = \"teapot\"",
                "builtin = \"knot\"\nspin_deg_per_s = 30.0",
            )
            .replace(
                "[effects.lambert]",
                "[effects.lambert]\n[effects.posterize]\nlevels = 7",
            )
            .replace("value = 1.0", "value = 0.75")
            .replace(
                "[effects.lambert]",
                "[effects.lambert]\non = [\"mesh:Pot*\"]",
            ),
    );
    let merged = merge(&base, &mine, &theirs);
    assert_eq!(merged.conflicts, [""; 0]);
    let got = merged.preset;
    assert_eq!(
        (got.name.as_str(), got.spin_deg_per_s, &got.scene),
        ("Ours", 30.0, &theirs.scene)
    );
    assert_eq!(
        (
            number(&got, "facet", "amount"),
            number(&got, "posterize", "levels")
        ),
        (0.5, 7.0)
    );
    assert_eq!(
        got.stack.get("lambert").map(|lambert| &lambert.on),
        theirs.stack.get("lambert").map(|lambert| &lambert.on)
    );
    assert!(
        got.stack.get("outline").is_none(),
        "an effect that was removed here is back"
    );
    assert_eq!(
        got.animation.get("facet", "front"),
        theirs.animation.get("facet", "front")
    );
    // The other way round the same changes give the same preset.
    assert_eq!(merge(&base, &theirs, &mine).preset, got);
}

#[test]
fn a_key_that_both_have_changed_keeps_mine_and_is_named() {
    let base = preset(BASE);
    let mine = preset(
        &BASE
            .replace("amount = 0.25", "amount = 0.5")
            .replace("value = 1.0", "value = 0.5")
            .replace("Mine", "Ours"),
    );
    let theirs = preset(
        &BASE
            .replace("amount = 0.25", "amount = 0.75")
            .replace("value = 1.0", "value = 0.25")
            .replace("Mine", "Theirs"),
    );
    let merged = merge(&base, &mine, &theirs);
    assert_eq!(
        merged.conflicts,
        ["animation.facet.front", "facet.amount", "name"]
    );
    assert_eq!(merged.preset, mine);
    // What is the same on both sides is no conflict.
    assert_eq!(merge(&base, &mine, &mine).conflicts, [""; 0]);
}

#[test]
fn an_effect_that_they_removed_comes_back_only_if_i_changed_it() {
    let base = preset(BASE);
    let theirs = preset(
        &BASE[..BASE.find("[animation").expect("a table")]
            .replace("[effects.facet]\namount = 0.25\n", ""),
    );
    let untouched = merge(&base, &preset(&BASE.replace("Mine", "Ours")), &theirs);
    assert!(untouched.preset.stack.get("facet").is_none() && untouched.conflicts.is_empty());
    let touched = merge(&base, &preset(&BASE.replace("0.25", "0.5")), &theirs);
    assert_eq!(
        (
            number(&touched.preset, "facet", "amount"),
            touched.conflicts
        ),
        (0.5, vec!["effects.facet".to_owned()])
    );
}
