//! Promise: every form that the standard allows loads, and a fault that every viewer tolerates
//! loads with one message.

use std::time::Instant;

use image::ImageFormat;
use rasterlab::scene::gltf::limits;
use serde_json::{Value, json};

use super::model::*;

#[test]
fn extras_may_be_any_json_wherever_they_stand() {
    for extras in [
        "null",
        "1",
        "\"text\"",
        "[1,{\"extras\":2}]",
        "{\"a\":{\"b\":[]}}",
    ] {
        for place in [
            "",
            "/asset",
            "/nodes/0",
            "/scenes/0",
            "/meshes/0",
            "P",
            "/accessors/0",
            "/bufferViews/0",
        ] {
            let scene = Model::square()
                .set(&format!("{place}/extras {extras}"))
                .silent();
            assert_eq!(triangles(&scene), square(), "{place}: {extras}");
        }
    }
}

#[test]
fn a_scene_may_be_empty() {
    for scenes in ["[{}]", "[{\"name\":\"empty\"}]"] {
        let scene = Model::square().set(&format!("/scenes {scenes}")).scene();
        assert_eq!(
            scene.notes,
            ["nothing to draw: the scene shows no triangles"]
        );
    }
}

#[test]
fn a_texture_without_an_image_is_not_drawn_and_said_so() {
    let model = Model::textured().set("M/emissiveTexture {\"index\":0}");
    for texture in [
        "{}",
        "{\"sampler\":0}",
        "{\"extensions\":{\"KHR_texture_basisu\":{\"source\":0}}}",
    ] {
        let scene = model.clone().set(&format!("/textures/0 {texture}")).scene();
        let material = &scene.materials[0];
        assert!(
            scene.images.is_empty()
                && material.base_texture.is_none()
                && material.emission_texture.is_none()
        );
        let wanted = "material \"paper\": baseColorTexture: texture 0 has no image that can be read; it is not drawn";
        assert_eq!(scene.notes, [wanted]);
        assert_eq!(scene.faults, [""; 0]);
    }
    // The other texture is drawn as before.
    let two = model.set("/textures [{\"source\":0},{}]\nM/emissiveTexture {\"index\":1}");
    let material = two.scene().materials[0].clone();
    assert!(material.base_texture.is_some() && material.emission_texture.is_none());
}

#[test]
fn a_scene_root_that_is_also_a_child_is_drawn_once_where_its_parent_places_it() {
    let model = Model::square()
        .set(r#"/nodes [{"mesh":0,"name":"leaf"},{"children":[0],"translation":[0,2,0]}]"#);
    let moved: Vec<_> = square()
        .into_iter()
        .map(|triangle| triangle.map(|[x, y, z]| [x, y + 2.0, z]))
        .collect();
    for roots in ["[0]", "[1,0]", "[0,1]", "[1]"] {
        let scene = model
            .clone()
            .set(&format!("/scenes/0/nodes {roots}"))
            .scene();
        assert_eq!(triangles(&scene), moved, "{roots}");
        let wanted = "scene 0 must list root nodes only, but node \"leaf\" has a parent; each is drawn once, where its parent places it";
        let wanted = if roots == "[1]" {
            vec![]
        } else {
            vec![wanted.to_owned()]
        };
        assert_eq!((&scene.notes, &scene.faults), (&wanted, &wanted), "{roots}");
    }
    // A line of nodes that are all listed: one message, and one instance.
    let mut line: Vec<Value> = (1..200).map(|i| json!({ "children": [i] })).collect();
    line.push(json!({ "mesh": 0 }));
    let all: Vec<usize> = (0..200).rev().collect();
    let scene = Model::square()
        .with("/nodes", line)
        .with("/scenes/0/nodes", all)
        .scene();
    assert_eq!(
        (scene.instances.len(), scene.notes.len()),
        (1, 1),
        "{:?}",
        scene.notes
    );
    assert_noted(&scene, "and 198 more nodes have parents");
}

#[test]
fn webp_images_are_read_with_and_without_the_extension() {
    let png = Model::textured().scene().images[0].levels[0].texels.clone();
    let webp = Model::textured()
        .showing(&encoded(ImageFormat::WebP))
        .set("/images/0/mimeType \"image/webp\"");
    assert_eq!(webp.scene().images[0].levels[0].texels, png);
    let extended =
        webp.set(r#"/textures/0 {"sampler":0,"extensions":{"EXT_texture_webp":{"source":0}}}"#);
    for list in ["/extensionsUsed", "/extensionsRequired"] {
        let scene = extended
            .clone()
            .set(&format!("{list} [\"EXT_texture_webp\"]"))
            .silent();
        assert_eq!(scene.images[0].levels[0].texels, png);
    }
    let mut cut = encoded(ImageFormat::WebP);
    cut.truncate(cut.len() - 4);
    Model::textured()
        .showing(&cut)
        .dropped("cannot decode the image");
}

#[test]
fn many_messages_are_never_built() {
    let parse = |names: String| {
        load(
            format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extensionsUsed\":[{names}]}}")
                .as_bytes(),
        )
    };
    let names: Vec<String> = (0..2_000_000).map(|i| format!("\"x{i}\"")).collect();
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    let scene = parse(names.join(",")).unwrap();
    assert_eq!(scene.notes.len(), limits::NOTES);
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
    let error = parse(vec!["\"\""; limits::JSON_VALUES + 2].join(",")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the JSON has 10000002 values; allowed: at most 10000000"
    );
}
