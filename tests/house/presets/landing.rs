//! Promise: a preset that lands on another scene keeps all that belongs to that scene, brings all
//! that belongs to its look, and becomes a new preset without a file.

use rasterlab::{
    preset::{
        Preset, SceneSource,
        settings::{SECTIONS, Setting},
    },
    preset_file::{self, Folders},
    scene::parts::scope_masks,
};
use rasterlab_fuzz::stress::scenes::for_seeds;

use super::{round_trip::any_preset, *};

/// Does the setting belong to the scene? The rule as a person would write it down.
fn is_of_scene(setting: &Setting) -> bool {
    match (setting.section, setting.name.as_str()) {
        ("scene", "polyline" | "unit" | "room" | "surroundings") => false,
        ("scene" | "camera", _) | ("output", "size") => true,
        _ => false,
    }
}

#[test]
fn every_key_comes_from_the_scene_or_from_the_look() {
    for_seeds(200, |rng| {
        let (look, own) = (any_preset(rng), any_preset(rng));
        let landed = look.applied_to(&own);
        let sections = SECTIONS.iter().filter(|section| section.name != "test");
        for setting in sections.flat_map(|section| section.settings.iter()) {
            if setting.path() == "output.reference_height_px" {
                continue;
            }
            let from = if is_of_scene(setting) { &own } else { &look };
            assert_eq!(
                setting.get(&landed),
                setting.get(from),
                "{}",
                setting.path()
            );
        }
        assert_eq!(
            (&landed.stack, &landed.animation),
            (&look.stack, &look.animation)
        );
        // Lengths in pixels keep the part of the picture that they fill.
        let [scale, before] = [&landed, &look].map(|preset| preset.output.length_scale(100.0));
        assert!(
            scale == before || look.output.size[1] == 0,
            "{scale} {before}"
        );
        assert_eq!(landed.test, None);
        // Landing again changes nothing, and so does landing on itself.
        assert_eq!(bits(&landed.applied_to(&own)), bits(&landed));
        let itself = look.applied_to(&look);
        assert_eq!(bits(&itself), bits(&Preset { test: None, ..look }));
    });
}

/// A preset of the gallery on a model that is named by a relative path.
fn hatch_on_fox() -> (PresetFile, PresetFile) {
    let look = preset_file::open("hatch", &Folders::default()).expect("a built-in preset");
    let mut own = PresetFile::of_scene("fox", SceneSource::File("models/fox.glb".into()));
    own.path = Some("/somewhere/mine.toml".into());
    own.look = None;
    own.preset.room = 2.0;
    (look, own)
}

#[test]
fn what_has_landed_is_a_new_preset_that_reads_back() {
    let (look, own) = hatch_on_fox();
    let landed = look.landed_on(&own, None);
    assert_eq!(
        (landed.path.as_deref(), landed.read_only, landed.id.as_str()),
        (None, false, "hatch-fox")
    );
    assert!(
        landed.title().contains(look.title()) && landed.title().contains("fox"),
        "{}",
        landed.title()
    );
    assert_eq!(
        landed.preset.scene,
        SceneSource::File("/somewhere/models/fox.glb".into()),
        "it does not lie beside the other preset"
    );
    assert!(
        landed.is_look_of("hatch", None) && landed.look_id() == "hatch" && landed.has_own_scene()
    );

    let text = preset_file::to_toml(&landed);
    let back = parse(&text);
    assert_eq!(bits(&back.preset), bits(&landed.preset), "{text}");
    let folder = tempfile::tempdir().unwrap();
    let mut saved = landed.clone();
    preset_file::save(&mut saved, &folder.path().join("mine.toml")).expect("it is saved");
    assert!(
        !saved.is_look_of("hatch", None) && saved.id == "mine",
        "it is a preset of its own now"
    );
}

#[test]
fn the_look_keeps_its_name_from_scene_to_scene() {
    let (look, own) = hatch_on_fox();
    let on_fox = look.landed_on(&own, None);
    let knot =
        preset_file::open("builtin:knot?tess=3", &Folders::default()).expect("a built-in scene");
    let on_knot = on_fox.landed_on(&knot, None);
    assert_eq!(
        (on_knot.id.as_str(), on_knot.title()),
        ("hatch-knot", format!("{} on knot", look.title()).as_str())
    );
    let plain = own.landed_on(&knot, None);
    assert_eq!(
        (plain.look_id(), plain.title()),
        ("fox", "fox on knot"),
        "a preset of the person's own is a look"
    );
    let bare =
        PresetFile::of_scene("fox", SceneSource::File("fox.glb".into())).landed_on(&knot, None);
    assert!(bare.is_plain(), "{}", bare.title());
}

#[test]
fn only_models_and_chosen_scenes_are_the_persons_own() {
    assert!(
        !preset_file::open("hatch", &Folders::default())
            .expect("a preset")
            .has_own_scene()
    );
    assert!(
        preset_file::open("builtin:knot", &Folders::default())
            .expect("a scene")
            .has_own_scene()
    );
    assert!(parse("schema = 2\n[scene]\npath = \"fox.glb\"\n").has_own_scene());
}

#[test]
fn a_clip_that_stays_behind_is_named_once() {
    let look =
        parse("schema = 2\n[scene]\nbuiltin = \"walker\"\nclip = \"Walk\"\n[effects.hatch]\n");
    let (_, own) = hatch_on_fox();
    let landed = look.landed_on(&own, None);
    assert_eq!(landed.warnings.len(), 1, "{:?}", landed.warnings);
    assert!(
        landed.warnings[0].contains("clip \"Walk\" was left out")
            && landed.preset.playback.clip.is_empty()
    );
    let mut playing = own.clone();
    playing.preset.playback.clip = "Run".into();
    let landed = look.landed_on(&playing, None);
    assert!(landed.warnings.is_empty() && landed.preset.playback.clip == "Run");
}

#[test]
fn an_effect_without_its_parts_acts_on_the_model_and_not_on_its_ground() {
    let look = parse(
        "schema = 2\n[scene]\nbuiltin = \"knot\"\n[ground]\nsize = 3.0\n\
         [effects.explode]\non = [\"node:nowhere\"]\n\
         [effects.lambert]\non = [\"node:ground\", \"node:nowhere\"]\n",
    );
    for query in ["still-life?tess=1", "teapot?tess=2", "walker?tess=1"] {
        let own =
            preset_file::open(&format!("builtin:{query}"), &Folders::default()).expect("a scene");
        let bare = rasterlab::scene::builtin::build(query).expect("a scene");
        let mut landed = look.landed_on(&own, None);
        landed.map_missing_parts(&bare);
        assert_eq!(landed.warnings.len(), 2, "{:?}", landed.warnings);
        let scene = preset_file::load_scene(&landed.preset, None).expect("a scene");
        assert_eq!(scene.grounds, 1, "{query}");
        let model = scene.instances.len() - 1;
        for enabled in &landed.preset.stack.0 {
            let masks = scope_masks(&scene, std::slice::from_ref(&enabled.on));
            for (index, mask) in masks.iter().enumerate() {
                let is_on_model = enabled.effect.name == "explode";
                assert_eq!(
                    *mask != 0,
                    is_on_model == (index < model),
                    "{query}: {} on instance {index}",
                    enabled.effect.name
                );
            }
        }
    }
}
