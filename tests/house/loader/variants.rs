//! Promise: a variant of KHR_materials_variants shows each primitive with the material that the
//! variant gives it, exactly as if the file gave it that material alone; faulty mappings cost
//! themselves, and an unknown name is one sentence with those that are there.

use std::fs;

use rasterlab::{
    oracle,
    preset::{Preset, SceneSource},
    preset_file,
    scene::{Scene, gltf::load_variant, memory::MemoryBudget, parts::ShownParts},
};
use serde_json::{Value, json};

use super::model::*;

const MAPPINGS: &str = "/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings";

/// A square in three materials; the last of them shows a picture, and blends.
fn shoe() -> Model {
    let mut model = Model::textured();
    let color = |r: f32, g: f32, b: f32| json!({ "baseColorFactor": [r, g, b, 1] });
    for (name, material) in [
        (
            "coal",
            json!({ "pbrMetallicRoughness": color(0.1, 0.1, 0.1) }),
        ),
        (
            "rose",
            json!({ "pbrMetallicRoughness": color(0.9, 0.1, 0.3), "doubleSided": true }),
        ),
    ] {
        let mut material = material;
        material["name"] = json!(name);
        model.push("materials", material);
    }
    let extension = |value: Value| json!({ "KHR_materials_variants": value });
    let names =
        json!({ "variants": [{ "name": "night" }, { "name": "day" }, {}, { "name": "day" }] });
    let mappings = json!({ "mappings": [
        { "material": 1, "variants": [0] },
        { "material": 2, "variants": [1, 3] },
    ] });
    model
        .with("/extensions", extension(names))
        .with("/extensionsUsed", json!(["KHR_materials_variants"]))
        .with("/extensionsRequired", json!(["KHR_materials_variants"]))
        .with("/meshes/0/primitives/0/extensions", extension(mappings))
}

fn shown(model: &Model, variant: &str) -> Scene {
    let bytes = model.glb();
    let scene = load_variant(
        &bytes.as_slice(),
        MemoryBudget::LEAST,
        variant,
        &mut |_, _| unreachable!("it has no other files"),
    )
    .expect("it loads");
    assert_sound(&scene);
    scene
}

fn picture(scene: &Scene) -> Vec<[u8; 4]> {
    let (preset, size) = (Preset::default(), [24, 16]);
    let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
    oracle::render(scene, &view, &stack)
        .expect("it draws")
        .color
}

#[test]
fn each_variant_is_drawn_as_if_its_material_were_the_only_one() {
    let mut pictures = Vec::new();
    for (variant, material) in [
        ("", 0),
        ("night", 1),
        ("day", 2),
        ("#3", 2),
        ("variant 2", 0),
    ] {
        let scene = shown(&shoe(), variant);
        assert_eq!(scene.variants, ["night", "day", "variant 2", "day"]);
        assert_eq!(
            (scene.notes.len(), scene.faults.len()),
            (0, 0),
            "{:?}",
            scene.notes
        );
        let alone = shoe()
            .without("/meshes/0/primitives/0/extensions")
            .with("/meshes/0/primitives/0/material", json!(material))
            .scene();
        assert_eq!(scene.primitives, alone.primitives, "{variant}");
        assert_eq!(
            scene.images.len(),
            usize::from(material == 0),
            "{variant}: no other image is read"
        );
        let drawn = picture(&scene);
        assert!(drawn == picture(&alone), "{variant}");
        pictures.push(drawn);
    }
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2] && pictures[0] != pictures[2]);
    assert!(pictures[2] == pictures[3] && pictures[0] == pictures[4]);
}

#[test]
fn faulty_mappings_are_left_out_and_the_others_hold() {
    let place = "mesh \"X\" primitive 0 KHR_materials_variants mapping";
    let good = json!({ "material": 2, "variants": [1] });
    for (mapping, sentence) in [
        (
            json!({ "material": 9, "variants": [0] }),
            "0: its material is 9, but there are only 3 materials",
        ),
        (json!({ "variants": [0] }), "0: it has no material"),
        (
            json!({ "material": 1, "variants": [7] }),
            "0: its variants list 7, but there are only 4 variants",
        ),
        (
            json!({ "material": 1, "variants": 0 }),
            "0: its variants is 0; it must be a list",
        ),
        (json!([1]), "0: it is [1]; it must be an object"),
    ] {
        let model = shoe().with(MAPPINGS, json!([mapping, good]));
        model.dropped(&format!("{place} {sentence}"));
        assert_eq!(shown(&model, "night").faults.len(), 1);
        let material = |variant: &str| {
            let scene = shown(&model, variant);
            scene.materials[scene.primitives[0].material].name.clone()
        };
        assert_eq!(
            ["night", "day"].map(material),
            ["paper", "rose"],
            "{mapping}"
        );
    }
    let twice = json!([{ "material": 1, "variants": [1] }, good]);
    let twice = shoe().with(MAPPINGS, twice);
    twice.dropped(&format!(
        "{place} 1: variant 1 has a material of an earlier mapping"
    ));
    let scene = shown(&twice, "day");
    assert_eq!(scene.materials[scene.primitives[0].material].name, "coal");
    let absent = shoe().without("/extensions").with(MAPPINGS, json!(7));
    absent.dropped("mesh \"X\" primitive 0: its mappings is 7; it must be a list");
    assert!(absent.scene().variants.is_empty());
}

#[test]
fn a_preset_names_a_variant_and_is_told_of_those_that_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shoe.glb");
    fs::write(&path, shoe().glb()).unwrap();
    let load = |path: &std::path::Path, variant: &str| {
        let preset = Preset {
            scene: SceneSource::File(path.to_owned()),
            parts: ShownParts {
                variant: variant.into(),
                ..ShownParts::default()
            },
            ..Preset::default()
        };
        preset_file::load_scene(&preset, None).map_err(|error| error.to_string())
    };
    let scene = load(&path, "night").expect("it is there");
    assert_eq!(scene.materials[scene.primitives[0].material].name, "coal");
    let unknown = load(&path, "dusk").expect_err("it is not there");
    assert_eq!(
        unknown,
        "scene.variant: the scene has no variant \"dusk\"; it has \"night\", \"day\", \"variant 2\", \"day\""
    );
    let plain = folder.path().join("plain.glb");
    fs::write(&plain, Model::square().glb()).unwrap();
    let none = load(&plain, "dusk").expect_err("it has none");
    assert_eq!(
        none,
        "scene.variant: the scene has no variant \"dusk\"; it has no variants"
    );
}
