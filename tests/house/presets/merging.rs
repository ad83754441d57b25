//! Promise: a preset that was changed here and in its file is merged key by key, and nothing of
//! either side is lost unsaid.

use rasterlab::preset_file::merge;

use super::*;

const BASE: &str = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\namount = 0.25\n[effects.lambert]\n[effects.outline]\n\
    [animation.facet]\nfront = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n";

/// The preset with these texts replaced.
fn changed(changes: &[(&str, &str)]) -> Preset {
    let mut text = BASE.to_owned();
    for (before, after) in changes {
        assert!(text.contains(before), "{before}");
        text = text.replace(before, after);
    }
    parse(&text).preset
}

fn number(preset: &Preset, effect: &str, field: &str) -> f64 {
    values(preset, effect, field)[0]
}

#[test]
fn changes_of_different_keys_are_all_kept() {
    let base = changed(&[]);
    let mine = changed(&[
        ("amount = 0.25", "amount = 0.5"),
        ("[effects.outline]\n", ""),
        ("Mine", "Ours"),
    ]);
    let theirs = changed(&[
        (
            "builtin = \"teapot\"",
            "builtin = \"knot\"\nspin_deg_per_s = 30.0",
        ),
        ("value = 1.0", "value = 0.75"),
        (
            "[effects.lambert]",
            "[effects.lambert]\non = [\"mesh:Pot*\"]\n[effects.posterize]\nlevels = 7",
        ),
    ]);
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
    let scope = |preset: &Preset| {
        preset
            .stack
            .get("lambert")
            .map(|lambert| lambert.on.clone())
    };
    assert_eq!(scope(&got), scope(&theirs));
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
    let base = changed(&[]);
    let [mine, theirs] = [("0.5", "Ours"), ("0.75", "Theirs")].map(|(number, name)| {
        let [amount, value] = ["amount", "value"].map(|key| format!("{key} = {number}"));
        changed(&[
            ("amount = 0.25", &amount),
            ("value = 1.0", &value),
            ("Mine", name),
        ])
    });
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
    let base = changed(&[]);
    let animation = &BASE[BASE.find("[animation").expect("a table")..];
    let theirs = changed(&[(animation, ""), ("[effects.facet]\namount = 0.25\n", "")]);
    let untouched = merge(&base, &changed(&[("Mine", "Ours")]), &theirs);
    assert!(untouched.preset.stack.get("facet").is_none() && untouched.conflicts.is_empty());
    let touched = merge(&base, &changed(&[("0.25", "0.5")]), &theirs);
    assert_eq!(number(&touched.preset, "facet", "amount"), 0.5);
    assert_eq!(touched.conflicts, ["effects.facet"]);
}
