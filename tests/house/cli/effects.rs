//! Promise: an effect of one's own is one file: written by a command, switched on by its name,
//! judged, and refused in one sentence.

use super::*;

#[test]
fn a_new_effect_of_every_hook_is_drawn_and_judged_without_a_driver() {
    for hook in ["surface", "vertex", "sample", "pixel"] {
        let place = Place::new();
        let transcript = r#"
            $ new-effect ink --hook HOOK
            >= effects/ink.wgsl\n
            $ render builtin:knot CPU64x48 -o plain.png
            $ render builtin:knot CPU64x48 -o inked.png --set ink
            $ verify builtin:knot CPU64x48 --set ink --json
            /results/0/judged_by_own_text/0 "ink"
        "#;
        place.play(&transcript.replace("HOOK", hook));
        assert_ne!(
            place.pixels("plain.png"),
            place.pixels("inked.png"),
            "{hook}: the effect changes the picture"
        );
    }
}

#[test]
fn a_faulty_effect_is_one_sentence_with_its_line_and_a_caret() {
    let place = Place::new();
    place.play("$ new-effect ink --hook surface");
    let text = String::from_utf8(place.read("effects/ink.wgsl")).unwrap();
    place.put("effects/ink.wgsl", text.replace("s.normal", "s.norml"));
    let line = text
        .lines()
        .position(|line| line.contains("s.normal"))
        .unwrap()
        + 1;
    place.play(&format!(
        "$2 render teapot CPU --set ink -o x.png
        ! effects/ink.wgsl:{line}: && norml && ^^^^^
        # Presets that do not use it are not disturbed.
        $ render builtin:knot CPU32x24 -o y.png"
    ));
}

#[test]
fn effects_are_found_beside_the_preset_and_in_a_chosen_folder() {
    let (place, elsewhere) = (Place::new(), Place::new());
    let preset = r#"schema = 2\n[scene]\nbuiltin = "knot"\n[effects.ink]\namount = 0.9\n"#;
    place.play(&format!(
        "$ new-effect ink --hook pixel\n@ mine.toml {preset}"
    ));
    let transcript = r"
        $ render HERE/mine.toml CPU32x24 --strict -o a.png
        # Nothing is found elsewhere.
        $2 render builtin:knot CPU32x24 --set ink -o b.png
        $ render builtin:knot CPU32x24 --set ink -o b.png --effects HERE/effects
        # The picture brings the effect, and says so.
        $ check b.png
        $ render b.png CPU32x24 -o c.png
        ! brings the effect ink
    ";
    elsewhere.play(&transcript.replace("HERE", &place.at("").display().to_string()));
}
