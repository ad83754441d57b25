//! Promise: a preset hides parts of its scene or shows some alone, and what is left is drawn as if
//! the rest were not there.

use rasterlab::{
    oracle,
    preset::Preset,
    preset_file,
    scene::{
        Scene,
        parts::{Part, parts},
    },
};

fn still_life(keys: &str) -> Preset {
    let text = format!(
        "schema = 2\nname = \"x\"\n[scene]\nbuiltin = \"still-life\"\n{keys}\n[effects.triangle_id]\n"
    );
    preset_file::parse(&text, "x").expect("a preset").preset
}

fn names(scene: &Scene) -> Vec<String> {
    parts(scene)
        .iter()
        .map(|part| part.pattern().to_string())
        .collect()
}

#[test]
fn hidden_parts_are_gone_and_others_stay() {
    let scene = |keys: &str| preset_file::load_scene(&still_life(keys), None).expect("a scene");
    let whole = scene("");
    let is_some = |part: &&Part| part.triangles < whole.triangle_count();
    let some = parts(&whole);
    let part = some.iter().find(is_some).expect("several parts");
    let part = part.pattern().to_string();
    let without = scene(&format!("hidden = [{part:?}]"));
    let alone = scene(&format!("only = [{part:?}]"));
    assert!(!names(&without).contains(&part) && names(&alone).contains(&part));
    assert_eq!(
        without.triangle_count() + alone.triangle_count(),
        whole.triangle_count()
    );
    // What is both hidden and shown alone leaves nothing, which is told.
    let nothing = still_life(&format!("only = [{part:?}]\nhidden = [{part:?}]"));
    let error = preset_file::load_scene(&nothing, None)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("scene.only and scene.hidden leave"),
        "{error}"
    );
}

#[test]
fn what_is_left_is_drawn_as_if_the_rest_were_not_there() {
    let whole = preset_file::load_scene(&still_life(""), None).expect("a scene");
    let size = [64, 48];
    // The camera is that of the whole scene.
    let draw = |preset: &Preset| {
        let scene = preset_file::load_scene(preset, None).expect("a scene");
        let preset = Preset {
            camera: Some(still_life("").camera_for(&whole, 64.0 / 48.0)),
            ..preset.clone()
        };
        oracle::render(
            &scene,
            &preset.view(&scene, size),
            &preset.stack_on(&scene, size),
        )
        .expect("it draws")
    };
    let complete = draw(&still_life(""));
    let mut seen = vec![0u32; complete.depth_key.len()];
    for part in parts(&whole)
        .iter()
        .filter(|part| part.kind.name() == "node" && part.depth == 0)
    {
        let alone = draw(&still_life(&format!(
            "only = [{:?}]",
            part.pattern().to_string()
        )));
        seen.iter_mut()
            .zip(&alone.depth_key)
            .for_each(|(seen, key)| *seen = (*seen).max(*key));
    }
    assert_eq!(
        seen, complete.depth_key,
        "the nearest of the parts, each drawn alone"
    );
}

#[test]
fn parts_are_written_and_read_back_and_faulty_patterns_told() {
    let preset = still_life("hidden = [\"mesh:Cup*\", \"node:Lamp\"]");
    let text = preset_file::to_toml(&preset_file::PresetFile::new("x", preset.clone()));
    assert!(
        text.contains("hidden = [\"mesh:Cup*\", \"node:Lamp\"]"),
        "{text}"
    );
    assert_eq!(
        preset_file::parse(&text, "x")
            .expect("its own text")
            .preset
            .parts,
        preset.parts
    );
}
