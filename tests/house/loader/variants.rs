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

use super::model::*;

const MAPPINGS: &str = "P/extensions/KHR_materials_variants/mappings";

/// A square in three materials; the last of them shows a picture, and blends.
fn shoe() -> Model {
    Model::textured().set(
        r#"
        /materials [{"name":"paper","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},{"name":"coal","pbrMetallicRoughness":{"baseColorFactor":[0.1,0.1,0.1,1]}},{"name":"rose","pbrMetallicRoughness":{"baseColorFactor":[0.9,0.1,0.3,1]},"doubleSided":true}]
        /extensions {"KHR_materials_variants":{"variants":[{"name":"night"},{"name":"day"},{},{"name":"day"}]}}
        /extensionsUsed ["KHR_materials_variants"]
        /extensionsRequired ["KHR_materials_variants"]
        P/extensions {"KHR_materials_variants":{"mappings":[{"material":1,"variants":[0]},{"material":2,"variants":[1,3]}]}}
        "#,
    )
}

fn load_as(model: &Model, variant: &str) -> Scene {
    let bytes = model.glb();
    let loaded = load_variant(
        &bytes.as_slice(),
        MemoryBudget::LEAST,
        variant,
        &mut |_, _| unreachable!("it has no other files"),
    );
    let scene = loaded.expect("it loads");
    assert_sound(&scene);
    scene
}

/// The name of the material that is shown.
fn material(scene: &Scene) -> &str {
    &scene.materials[scene.primitives[0].material].name
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
        let scene = load_as(&shoe(), variant);
        assert_eq!(scene.variants, ["night", "day", "variant 2", "day"]);
        assert_eq!((&scene.notes, &scene.faults), (&vec![], &vec![]));
        let alone = shoe()
            .without("P/extensions")
            .with("P/material", material)
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
    let [plain, night, day, third, unmapped] = &pictures[..] else {
        unreachable!()
    };
    assert!(plain != night && night != day && plain != day);
    assert!(day == third && plain == unmapped);
}

#[test]
fn faulty_mappings_are_left_out_and_the_others_hold() {
    let place = "mesh \"X\" primitive 0 KHR_materials_variants mapping";
    let good = r#"{"material":2,"variants":[1]}"#;
    let with = |mapping: &str| shoe().set(&format!("{MAPPINGS} [{mapping},{good}]"));
    for (mapping, sentence) in [
        (
            r#"{"material":9,"variants":[0]}"#,
            "0: its material is 9, but there are only 3 materials",
        ),
        (r#"{"variants":[0]}"#, "0: it has no material"),
        (
            r#"{"material":1,"variants":[7]}"#,
            "0: its variants list 7, but there are only 4 variants",
        ),
        (
            r#"{"material":1,"variants":0}"#,
            "0: its variants is 0; it must be a list",
        ),
        ("[1]", "0: it is [1]; it must be an object"),
    ] {
        let model = with(mapping);
        model.dropped(&format!("{place} {sentence}"));
        let [night, day] = ["night", "day"].map(|variant| load_as(&model, variant));
        assert_eq!(
            (material(&night), material(&day), night.faults.len()),
            ("paper", "rose", 1),
            "{mapping}"
        );
    }
    let twice = with(r#"{"material":1,"variants":[1]}"#);
    twice.dropped(&format!(
        "{place} 1: variant 1 has a material of an earlier mapping"
    ));
    assert_eq!(material(&load_as(&twice, "day")), "coal");
    let absent = shoe().without("/extensions").with(MAPPINGS, 7);
    let scene = absent.dropped("mesh \"X\" primitive 0: its mappings is 7; it must be a list");
    assert!(scene.variants.is_empty());
}

#[test]
fn a_preset_names_a_variant_and_is_told_of_those_that_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let load = |model: &Model, variant: &str| {
        let path = folder.path().join("model.glb");
        fs::write(&path, model.glb()).unwrap();
        let parts = ShownParts {
            variant: variant.into(),
            ..ShownParts::default()
        };
        let preset = Preset {
            scene: SceneSource::File(path),
            parts,
            ..Preset::default()
        };
        preset_file::load_scene(&preset, None).map_err(|error| error.to_string())
    };
    assert_eq!(
        material(&load(&shoe(), "night").expect("it is there")),
        "coal"
    );
    for (model, wanted) in [
        (shoe(), "it has \"night\", \"day\", \"variant 2\", \"day\""),
        (Model::square(), "it has no variants"),
    ] {
        let unknown = load(&model, "dusk").expect_err("it is not there");
        assert_eq!(
            unknown,
            format!("scene.variant: the scene has no variant \"dusk\"; {wanted}")
        );
    }
}
