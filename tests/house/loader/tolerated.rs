//! Promise: every form that the standard allows loads, and a fault that every viewer tolerates
//! loads with one message.

use std::time::Instant;

use image::ImageFormat;
use rasterlab::scene::gltf::{self, limits};
use serde_json::{Value, json};

use super::model::*;

#[test]
fn extras_may_be_any_json_wherever_they_stand() {
    for extras in [
        json!(null),
        json!(1),
        json!("text"),
        json!([1, { "extras": 2 }]),
        json!({ "a": { "b": [] } }),
    ] {
        for place in [
            "",
            "/asset",
            "/nodes/0",
            "/scenes/0",
            "/meshes/0",
            "/meshes/0/primitives/0",
            "/accessors/0",
            "/bufferViews/0",
        ] {
            let model = Model::square().with(&format!("{place}/extras"), extras.clone());
            let scene = model.scene();
            assert_eq!(
                (triangles(&scene), scene.notes.len()),
                (square(), 0),
                "{place}: {extras}"
            );
        }
    }
}

#[test]
fn a_scene_may_be_empty() {
    for scenes in [json!([{}]), json!([{ "name": "empty" }])] {
        let scene = Model::square().with("/scenes", scenes).scene();
        assert_eq!(
            scene.notes,
            ["nothing to draw: the scene shows no triangles"]
        );
    }
}

#[test]
fn a_texture_without_an_image_is_not_drawn_and_said_so() {
    let unknown = json!({ "KHR_texture_basisu": { "source": 0 } });
    for texture in [
        json!({}),
        json!({ "sampler": 0 }),
        json!({ "extensions": unknown }),
    ] {
        let model = Model::textured()
            .with("/textures/0", texture)
            .with("/materials/0/emissiveTexture", json!({ "index": 0 }));
        let scene = model.scene();
        assert!(
            scene.images.is_empty()
                && scene.materials[0].base_texture.is_none()
                && scene.materials[0].emission_texture.is_none()
        );
        assert_eq!(
            scene.notes,
            [
                "material \"paper\": baseColorTexture: texture 0 has no image that can be read; it is not drawn"
            ]
        );
        assert_eq!(scene.faults, [""; 0]);
    }
    // The other texture is drawn as before.
    let two = Model::textured()
        .with("/textures", json!([{ "source": 0 }, {}]))
        .with("/materials/0/emissiveTexture", json!({ "index": 1 }));
    let material = two.scene().materials[0].clone();
    assert!(material.base_texture.is_some() && material.emission_texture.is_none());
}

#[test]
fn a_scene_root_that_is_also_a_child_is_drawn_once_where_its_parent_places_it() {
    let nodes =
        json!([{ "mesh": 0, "name": "leaf" }, { "children": [0], "translation": [0, 2, 0] }]);
    let moved: Vec<_> = square()
        .into_iter()
        .map(|triangle| triangle.map(|[x, y, z]| [x, y + 2.0, z]))
        .collect();
    for roots in [json!([0]), json!([1, 0]), json!([0, 1])] {
        let scene = Model::square()
            .with("/nodes", nodes.clone())
            .with("/scenes/0/nodes", roots.clone())
            .scene();
        assert_eq!(triangles(&scene), moved, "{roots}");
        let wanted = "scene 0 must list root nodes only, but node \"leaf\" has a parent; each is drawn once, where its parent places it";
        assert_eq!(
            (scene.notes.as_slice(), scene.faults.as_slice()),
            (&[wanted.to_owned()][..], &[wanted.to_owned()][..]),
            "{roots}"
        );
    }
    let legal = Model::square()
        .with("/nodes", nodes)
        .with("/scenes/0/nodes", json!([1]))
        .scene();
    assert!(legal.faults.is_empty() && triangles(&legal) == moved);
    // A line of nodes that are all listed: one message, and one instance.
    let line: Vec<Value> = (0..200)
        .map(|i| {
            if i < 199 {
                json!({ "children": [i + 1] })
            } else {
                json!({ "mesh": 0 })
            }
        })
        .collect();
    let all: Vec<usize> = (0..200).rev().collect();
    let scene = Model::square()
        .with("/nodes", json!(line))
        .with("/scenes/0/nodes", json!(all))
        .scene();
    assert_eq!(
        (scene.instances.len(), scene.notes.len()),
        (1, 1),
        "{:?}",
        scene.notes
    );
    assert!(
        scene.notes[0].contains("and 198 more nodes have parents"),
        "{:?}",
        scene.notes
    );
}

#[test]
fn webp_images_are_read_with_and_without_the_extension() {
    let png = Model::textured().scene().images[0].levels[0].texels.clone();
    let webp = || {
        Model::textured()
            .showing(&encoded(ImageFormat::WebP))
            .with("/images/0/mimeType", json!("image/webp"))
    };
    assert_eq!(webp().scene().images[0].levels[0].texels, png);
    let extension = json!({ "sampler": 0, "extensions": { "EXT_texture_webp": { "source": 0 } } });
    for list in ["/extensionsUsed", "/extensionsRequired"] {
        let scene = webp()
            .with("/textures/0", extension.clone())
            .with(list, json!(["EXT_texture_webp"]))
            .scene();
        assert_eq!(
            (&scene.images[0].levels[0].texels, scene.notes.len()),
            (&png, 0)
        );
    }
    let mut cut = encoded(ImageFormat::WebP);
    cut.truncate(cut.len() - 4);
    Model::textured()
        .showing(&cut)
        .dropped("cannot decode the image");
}

#[test]
fn many_messages_are_never_built() {
    let parse = |json: String| gltf::load(json.as_bytes(), &mut |_, _| unreachable!());
    let names: Vec<String> = (0..2_000_000).map(|i| format!("\"x{i}\"")).collect();
    let names = names.join(",");
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    let scene = parse(format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"extensionsUsed\":[{names}]}}"
    ))
    .unwrap();
    assert_eq!(scene.notes.len(), limits::NOTES);
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
    let names = vec!["\"\""; limits::JSON_VALUES + 2].join(",");
    let error = parse(format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"extensionsUsed\":[{names}]}}"
    ))
    .unwrap_err()
    .to_string();
    assert_eq!(
        error,
        "the JSON has 10000002 values; allowed: at most 10000000"
    );
}
