//! Promise: an effect of one's own is one file: written by a command, switched on by its name,
//! judged, and refused in one sentence.

use rasterlab::{cli::gallery, effects::EFFECTS, host, preset_file::schema};

use super::{super::shader_parts, *};

/// An effect that is not built in.
const PLASMA: &str = include_str!("../../picture/ported/plasma.wgsl");

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

/// Run by the next test in a separate process, whose environment names the folder of shaders.
#[test]
#[ignore = "run by an_effect_is_added_with_its_file_and_its_preset"]
fn child_whose_shaders_have_one_effect_more() {
    host::shaders::choose(None).expect("the parent's folder");
    let names: Vec<&str> = EFFECTS.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names.last(), Some(&"plasma"), "{names:?}");
    let schema = schema::schema();
    let speed = &schema["properties"]["effects"]["properties"]["plasma"]["properties"]["speed"];
    let told = speed["description"].as_str().unwrap_or_default();
    assert!(told.contains("Turns of color in a second"), "{speed}");
    let table = gallery::table();
    assert!(table.contains("<b>plasma</b> <sub>surface</sub><br>sums of waves as colors"));
}

#[test]
fn an_effect_is_added_with_its_file_and_its_preset() {
    let (place, shaders) = (Place::new(), shader_parts::copied());
    let folder = shaders.path().display();
    let file = shaders.path().join("effects/plasma.wgsl");
    fs::write(&file, PLASMA).expect("one effect more");
    place.play(&format!(
        "$ bless plasma --shaders {folder}
        > plasma: new && its preset is created, too
        + presets/plasma.toml
        $ list effects --shaders {folder}
        > plasma && Turns of color in a second
        $ render presets/plasma.toml CPU24x18 --shaders {folder} --set plasma.scale=1 -o a.png
        $ render presets/plasma.toml CPU24x18 --shaders {folder} --set plasma.scale=8 -o b.png
        !~ a.png b.png
        $ check presets/plasma.toml --shaders {folder}
        $2 check --strict presets/plasma.toml"
    ));
    let child = Command::new(std::env::current_exe().expect("this test"))
        .args([
            "--exact",
            "cli::effects::child_whose_shaders_have_one_effect_more",
            "--ignored",
        ])
        .env("RASTERLAB_SHADERS", shaders.path())
        .output();
    let child = finished(child.expect("the child starts"));
    assert_eq!(child.code, 0, "{}{}", child.out, child.err);
    // A faulty one is told before anything is drawn.
    for (from, to, told) in [
        ("@range(0.0, 2.0, 0.25)", "@rang(0.0, 2.0, 0.25)", "rang"),
        ("s.screen", "s.scren", "scren"),
    ] {
        fs::write(&file, PLASMA.replace(from, to)).expect("a faulty effect");
        place.play(&format!(
            "$2 list effects --shaders {folder}\n! shaders/effects/plasma.wgsl && {told}"
        ));
    }
}
