//! Promise: textures, samplers, images and materials of a file load as the standard defines them,
//! or are refused with a message.

use base64::{Engine, prelude::BASE64_STANDARD};
use glam::DVec3;
use image::ImageFormat;
use rasterlab::{
    host,
    preset::{ClipPlayback, Clock, Preset},
    scene::{
        camera::Camera,
        gltf::limits,
        model::Instance,
        texture::{Filter, MipFilter, Texture, Wrap},
    },
};
use serde_json::{Value, json};

use super::model::*;

pub const BASE: &str = "/materials/0/pbrMetallicRoughness/baseColorTexture";

#[test]
fn images_come_as_png_or_jpeg_from_bytes_uris_and_files() {
    let texels = vec![[255, 0, 0, 255], [0, 200, 0, 100]];
    let scene = Model::textured().scene();
    assert_eq!(
        (scene.images.len(), &scene.images[0].levels[0].texels),
        (1, &texels)
    );
    assert_eq!(
        scene.images[0].levels.len(),
        2,
        "an open sampler mixes copies"
    );
    assert_eq!(
        Model::textured()
            .with("/samplers/0/minFilter", json!(9729))
            .scene()
            .images[0]
            .levels
            .len(),
        1,
        "no sampler asks for copies"
    );

    let jpeg = Model::textured()
        .showing(&encoded(ImageFormat::Jpeg))
        .with("/images/0/mimeType", json!("image/jpeg"))
        .scene();
    assert_eq!(jpeg.images[0].size(), [2, 1]);
    assert!(jpeg.notes.is_empty(), "{:?}", jpeg.notes);
    let misnamed = Model::textured()
        .showing(&encoded(ImageFormat::Jpeg))
        .scene();
    assert!(misnamed.notes.iter().any(|note| {
        note.contains("image \"flag\" is image/jpeg, although the file declares \"image/png\"")
    }));

    let data = format!(
        "data:image/png;base64,{}",
        BASE64_STANDARD.encode(encoded(ImageFormat::Png))
    );
    let data = Model::textured()
        .with("/images/0", json!({ "uri": data }))
        .scene();
    assert_eq!(data.images[0].levels[0].texels, texels);

    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("inside")).expect("a folder");
    for place in ["flag.png", "inside/flag one.png"] {
        std::fs::write(folder.path().join(place), encoded(ImageFormat::Png)).expect("written");
    }
    let load = |uri: &str| {
        let model = Model::textured().with("/images/0", json!({ "uri": uri }));
        std::fs::write(folder.path().join("inside/model.glb"), model.glb()).expect("written");
        host::model::load(&folder.path().join("inside/model.glb"))
    };
    assert_eq!(
        load("flag%20one.png")
            .expect("it lies beside the model")
            .images[0]
            .levels[0]
            .texels,
        texels
    );
    for (uri, sentence) in [
        (
            "../flag.png",
            "image 0: URI \"../flag.png\" leads out of the model's folder",
        ),
        ("http://example.org/flag.png", "has a scheme"),
        ("none.png", "image 0: \"none.png\": cannot read the file"),
    ] {
        let faults = load(uri).expect(uri).faults;
        assert!(faults[0].contains(sentence), "{faults:?}");
    }
}

#[test]
fn only_images_that_something_drawn_looks_up_are_read() {
    let broken = Model::textured().with("/images/0", json!({ "uri": "../../etc/passwd" }));
    broken.dropped("leads out of the model's folder");
    let unused = broken
        .with(
            "/meshes/0/primitives/0",
            json!({ "attributes": { "POSITION": 0 }, "indices": 2 }),
        )
        .scene();
    assert_eq!((unused.images.len(), unused.triangle_count()), (0, 2));
    let twice = Model::textured()
        .with("/materials/0/emissiveTexture", json!({ "index": 0 }))
        .with("/materials/0/emissiveFactor", json!([1, 1, 1]));
    assert_eq!(twice.scene().images.len(), 1, "an image is stored once");
    let dark = Model::textured()
        .with("/materials/0/emissiveTexture", json!({ "index": 0 }))
        .material();
    assert_eq!(
        dark.emission_texture, None,
        "what does not shine needs no image"
    );
}

#[test]
fn samplers_keep_their_wraps_and_filters() {
    let plain = Model::textured().texture();
    assert_eq!(plain, Texture::plain(0));
    let all = Model::textured()
        .with(
            "/samplers/0",
            json!({ "wrapS": 33648, "wrapT": 33071, "magFilter": 9728, "minFilter": 9985 }),
        )
        .texture();
    let wrap = [Wrap::Mirrored, Wrap::Clamp];
    assert_eq!(
        all,
        Texture {
            wrap,
            mag_filter: Filter::Nearest,
            min_filter: Filter::Linear,
            mip_filter: MipFilter::Nearest,
            ..plain
        }
    );
    for (filter, min_filter, mip_filter) in [
        (9728, Filter::Nearest, MipFilter::Unused),
        (9729, Filter::Linear, MipFilter::Unused),
        (9984, Filter::Nearest, MipFilter::Nearest),
        (9986, Filter::Nearest, MipFilter::Mixed),
        (9987, Filter::Linear, MipFilter::Mixed),
    ] {
        let texture = Model::textured()
            .with("/samplers/0/minFilter", json!(filter))
            .texture();
        assert_eq!(
            (texture.min_filter, texture.mip_filter),
            (min_filter, mip_filter),
            "{filter}"
        );
    }
    assert_eq!(
        Model::textured()
            .with("/textures/0", json!({ "source": 0 }))
            .texture(),
        plain,
        "no sampler"
    );
}

#[test]
fn transforms_scale_turn_and_move_and_may_name_another_set() {
    let mut model = Model::textured();
    let other = model.accessor(
        &le([0u16, 0, 65535, 0, 65535, 65535, 0, 65535].map(u16::to_le_bytes)),
        U16,
        "VEC2",
        4,
    );
    model.json["accessors"][other]["normalized"] = json!(true);
    let model = model.with("/meshes/0/primitives/0/attributes/TEXCOORD_3", json!(other));
    let transform = json!({ "offset": [0.25, -1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 3 });
    let model = model.with(
        &format!("{BASE}/extensions"),
        json!({ "KHR_texture_transform": transform }),
    );
    let texture = model.texture();
    assert_eq!(texture.set, 3);
    // A quarter turn, counterclockwise with v down, takes u to -v and v to u.
    for (stored, placed) in [
        ([0.0, 0.0], [0.25, -1.0]),
        ([1.0, 0.0], [0.25, -3.0]),
        ([0.0, 1.0], [3.25, -1.0]),
    ] {
        let place = texture.image_coordinates(stored.into());
        assert!(
            place.abs_diff_eq(placed.into(), 1e-6),
            "{stored:?}: {place}"
        );
    }
    assert_eq!(
        model.scene().primitives[0].texcoords[0].map(|texcoords| texcoords.normalized),
        Some(true)
    );
    let named = Model::textured().with(&format!("{BASE}/texCoord"), json!(0));
    assert_eq!(named.texture(), Texture::plain(0));
}

#[test]
fn coordinates_come_in_every_width_of_the_standard_and_quantized_ones_where_the_file_says_so() {
    let sets = [
        (U8, true, vec![0, 0, 255, 0, 255, 255, 0, 255]),
        (
            U16,
            true,
            le([0u16, 0, 65535, 0, 65535, 65535, 0, 65535].map(u16::to_le_bytes)),
        ),
        (
            I16,
            false,
            le([0i16, 0, 1, 0, 1, 1, 0, 1].map(i16::to_le_bytes)),
        ),
    ];
    for (component, normalized, bytes) in sets {
        let mut model = Model::textured();
        let texcoords = model.accessor(&bytes, component, "VEC2", 4);
        model.json["accessors"][texcoords]["normalized"] = json!(normalized);
        let mut model = model.with(
            "/meshes/0/primitives/0/attributes/TEXCOORD_0",
            json!(texcoords),
        );
        if component == I16 {
            model.dropped("mesh \"X\" primitive 0 TEXCOORD_0: accessor 3 has the type 2 x I16, which glTF does not allow for it");
            model = model
                .with("/extensionsRequired", json!(["KHR_mesh_quantization"]))
                .with("/extensionsUsed", json!(["KHR_mesh_quantization"]));
        }
        let scene = model.scene();
        let texcoords = scene.primitives[0].texcoords[0].expect("coordinates");
        let corner = |vertex| {
            [0, 1].map(|component| texcoords.value(&scene.vertex_bytes, vertex, component))
        };
        assert_eq!(
            [0, 1, 2, 3].map(corner),
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            "{component}"
        );
    }
}

#[test]
fn materials_shine_and_stay_unlit_as_the_file_says() {
    let shining = Model::textured()
        .with("/materials/0/emissiveFactor", json!([1, 0.5, 0]))
        .with(
            "/materials/0/extensions",
            json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4 } }),
        )
        .with(
            "/extensionsUsed",
            json!(["KHR_materials_emissive_strength"]),
        );
    assert_eq!(shining.material().emission, [4.0, 2.0, 0.0]);
    assert!(
        shining.scene().notes.is_empty(),
        "{:?}",
        shining.scene().notes
    );
    let unlit = shining
        .with(
            "/materials/0/extensions",
            json!({ "KHR_materials_unlit": {} }),
        )
        .material();
    assert!(unlit.unlit && unlit.emission == [0.0; 3] && unlit.base_texture.is_some());
}

#[test]
fn materials_reflect_as_the_file_says() {
    let of = |extensions: Value| {
        let model = Model::textured()
            .with("/materials/0/extensions", extensions)
            .with(
                "/materials/0/pbrMetallicRoughness",
                json!({ "metallicFactor": 0.25, "roughnessFactor": 0.75 }),
            );
        let material = model.material();
        (material.metallic, material.roughness, material.specular)
    };
    assert_eq!(of(json!({})), (0.25, 0.75, [0.04, 0.04, 0.04, 1.0]));
    let glass = json!({ "KHR_materials_ior": { "ior": 3 } });
    assert_eq!(of(glass).2, [0.25, 0.25, 0.25, 1.0]);
    let tinted = json!({
        "KHR_materials_ior": { "ior": 3 },
        "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 2, 8] },
    });
    assert_eq!(of(tinted).2, [0.125, 0.25, 0.5, 0.5]);
    let older = json!({
        "KHR_materials_pbrSpecularGlossiness": { "specularFactor": [0.5, 0.25, 1], "glossinessFactor": 0.25 },
    });
    assert_eq!(of(older), (0.0, 0.75, [0.5, 0.25, 1.0, 1.0]));
    let silent = Model::textured().without("/materials/0/pbrMetallicRoughness");
    let silent = silent.material();
    assert_eq!(
        (silent.metallic, silent.roughness),
        (1.0, 1.0),
        "the standard's defaults"
    );
}

#[test]
fn materials_let_light_through_as_the_file_says() {
    let of = |extensions: Value| {
        let material = Model::textured()
            .with("/materials/0/extensions", extensions)
            .material();
        (material.transmission, material.attenuation)
    };
    assert_eq!(of(json!({})), (0.0, [1.0; 3]));
    let thin = json!({ "KHR_materials_transmission": { "transmissionFactor": 0.75 } });
    assert_eq!(of(thin), (0.75, [1.0; 3]));
    // Twice as thick as the distance in which the color is left: its square.
    let thick = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 3, "attenuationDistance": 1.5, "attenuationColor": [0.5, 1, 0] },
    });
    assert_eq!(of(thick.clone()), (1.0, [0.25, 1.0, 0.0]));
    // A node that doubles its mesh doubles the thickness, too; its neighbor shows the mesh as it is.
    let scene = Model::textured()
        .with("/materials/0/extensions", thick)
        .with("/nodes", json!([{ "mesh": 0 }, { "mesh": 0, "scale": [2, 2, 2] }, { "mesh": 0, "scale": [-2, 2, 2] }]))
        .with("/scenes/0/nodes", json!([0, 1, 2]))
        .scene();
    let attenuation = |instance: &Instance| {
        let primitive = &scene.primitives[instance.primitive];
        scene.materials[primitive.material].attenuation
    };
    let of_nodes: Vec<[f32; 3]> = scene.instances.iter().map(attenuation).collect();
    assert_eq!(
        of_nodes,
        [[0.25, 1.0, 0.0], [0.0625, 1.0, 0.0], [0.0625, 1.0, 0.0]]
    );
    assert_eq!(scene.primitives.len(), 2, "nodes of one scale share one");
    let endless =
        json!({ "KHR_materials_volume": { "thicknessFactor": 3, "attenuationColor": [0, 0, 0] } });
    assert_eq!(of(endless), (0.0, [1.0; 3]), "no distance absorbs nothing");
    let refused = Model::textured().with(
        "/materials/0/extensions",
        json!({ "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0 } }),
    );
    assert_eq!(refused.material().attenuation, [1.0; 3]);
}

#[test]
fn alpha_modes_say_what_is_cut_out() {
    let with_mode = |mode: &str| Model::textured().with("/materials/0/alphaMode", json!(mode));
    assert_eq!(
        Model::textured().material().alpha_cutoff,
        None,
        "an opaque material ignores alpha"
    );
    assert_eq!(with_mode("MASK").material().alpha_cutoff, Some(0.5));
    let faint = with_mode("MASK")
        .with("/materials/0/alphaCutoff", json!(0.25))
        .with(
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([1, 1, 1, 0.5]),
        );
    let faint = faint.material();
    assert_eq!(
        (faint.alpha_cutoff, faint.base_color[3]),
        (Some(0.5), 1.0),
        "what is left is opaque"
    );
    assert_eq!(
        with_mode("MASK")
            .with("/materials/0/alphaCutoff", json!(0))
            .material()
            .alpha_cutoff,
        None
    );
    with_mode("MASK")
        .with("/materials/0/alphaCutoff", json!(-0.1))
        .dropped("material \"paper\": its alphaCutoff is -0.1; it must be at least 0");
    with_mode("TRANSLUCENT")
        .dropped("its alphaMode is \"TRANSLUCENT\"; it must be one of OPAQUE, MASK, BLEND");

    // What blends keeps its alpha, and discards nothing.
    let blended = with_mode("BLEND")
        .with(
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([1, 1, 1, 0.25]),
        )
        .scene();
    let material = &blended.materials[0];
    assert_eq!(
        (
            material.is_blended,
            material.alpha_cutoff,
            material.base_color[3],
            material.base_texture.is_some()
        ),
        (true, None, 0.25, true)
    );
    assert!(blended.notes.is_empty(), "{:?}", blended.notes);
    assert!(!with_mode("OPAQUE").material().is_blended);

    let plain = |alpha: f64| {
        let model = with_mode("MASK").with(
            "/materials/0/pbrMetallicRoughness",
            json!({ "baseColorFactor": [1, 1, 1, alpha] }),
        );
        model.scene()
    };
    assert_eq!(
        (
            plain(0.6).triangle_count(),
            plain(0.6).materials[0].base_color[3]
        ),
        (2, 1.0)
    );
    let nothing = plain(0.4);
    assert!(
        nothing.triangle_count() == 0
            && nothing.notes[0].contains("is skipped: the alpha of its material"),
        "{:?}",
        nothing.notes
    );
}

#[test]
fn textures_that_do_not_fit_are_left_out_by_name() {
    let at = |place: &str, value: Value| Model::textured().with(place, value);
    at(&format!("{BASE}/index"), json!(9)).dropped(
        "material \"paper\": baseColorTexture: its index is 9, but there are only 1 textures",
    );
    at("/textures/0/source", json!(9))
        .dropped("texture 0: its source is 9, but there are only 1 images");
    at("/textures/0/sampler", json!(9))
        .dropped("texture 0: its sampler is 9, but there are only 1 samplers");
    for key in ["wrapS", "magFilter", "minFilter"] {
        let scene = at(&format!("/samplers/0/{key}"), json!(1)).scene();
        assert_eq!(scene.materials[0].base_texture, Some(Texture::plain(0)));
        assert!(
            scene.notes[0].starts_with(&format!("sampler 0: its {key} is 1; it must be one of"))
                && scene.faults.is_empty(),
            "{:?}",
            scene.notes
        );
    }
    at("/images/0", json!({})).dropped("image 0: it has neither a URI nor a bufferView");
    at("/images/0/uri", json!("flag.png"))
        .dropped("image \"flag\": it has both a URI and a bufferView");
    at("/images/0/bufferView", json!(99)).dropped("bufferView");
    at("/bufferViews/3/byteLength", json!(100_000)).dropped("image \"flag\": bufferView 3");
    at(
        &format!("{BASE}/extensions"),
        json!({ "KHR_texture_transform": { "scale": [1e39, 1] } }),
    )
    .dropped("baseColorTexture: its scale is [1e+39,1]; it must be numbers below 3.4e38");
    at(
        "/materials/0/extensions",
        json!({ "KHR_materials_emissive_strength": { "emissiveStrength": -1 } }),
    )
    .dropped("material \"paper\": its emissiveStrength is -1; it must be at least 0");
    let basis = at("/extensionsRequired", json!(["KHR_texture_basisu"])).scene();
    assert_eq!(
        (basis.notes, basis.faults),
        (vec!["it requires the extension \"KHR_texture_basisu\", which is not supported; what does not need it is drawn".to_owned()], vec![])
    );
}

#[test]
fn images_that_are_none_are_left_out_by_name() {
    let place = "material \"paper\": baseColorTexture: image \"flag\": ";
    let png = encoded(ImageFormat::Png);
    Model::textured()
        .showing(b"RIFF....WEBP")
        .dropped(&format!("{place}cannot decode the image"));
    Model::textured()
        .showing(&[])
        .dropped("it is neither PNG, JPEG nor WebP");
    for length in [8, 20, 40, png.len() - 16] {
        Model::textured()
            .showing(&png[..length])
            .dropped(&format!("{place}cannot decode the image"));
    }
    let mut flipped = png.clone();
    flipped[20] ^= 64;
    Model::textured()
        .showing(&flipped)
        .dropped("image \"flag\": ");
    let jpeg = encoded(ImageFormat::Jpeg);
    Model::textured()
        .showing(&jpeg[..60])
        .dropped(&format!("{place}cannot decode the image"));
}

/// A PNG of one color: a few bytes for any size.
fn blank(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a header");
    writer
        .write_image_data(&vec![0; width.div_ceil(8) as usize * height as usize])
        .expect("texels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn an_image_cannot_ask_for_more_than_the_budget() {
    let bomb = blank(60_000, 60_000 / 50);
    assert!(bomb.len() < 100_000, "{} bytes", bomb.len());
    Model::textured()
        .showing(&bomb)
        .dropped("image \"flag\": it has 60000 x 1200 texels; allowed: 1 to 32768 along each side");
    let side = limits::IMAGE_SIDE;
    assert_eq!(
        Model::textured()
            .showing(&blank(side, 16))
            .with("/samplers/0/minFilter", json!(9729))
            .scene()
            .images[0]
            .size(),
        [side, 16]
    );
    // Two of the largest fit, a third does not; its header is enough to know.
    let mut model = Model::textured();
    let largest = model.view(&blank(side, side));
    for place in 0..3 {
        let image = model.push("images", json!({ "bufferView": largest, "mimeType": "image/png", "name": format!("large {place}") }));
        let texture = model.push("textures", json!({ "source": image, "sampler": 0 }));
        let material = model.push(
            "materials",
            json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }),
        );
        let primitive = json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": material });
        model.json["meshes"][0]["primitives"]
            .as_array_mut()
            .expect("a list")
            .push(primitive);
    }
    let model = model.with("/samplers/0/minFilter", json!(9729));
    model.refused("image \"large 1\": with it the decoded images have 536870920 bytes; allowed: at most 536870912");
}

#[test]
fn coordinates_that_do_not_fit_are_left_out_by_name() {
    let place = "mesh \"X\" primitive 0 TEXCOORD_0: ";
    Model::textured()
        .with(
            "/meshes/0/primitives/0/attributes",
            json!({ "POSITION": 0 }),
        )
        .dropped(&format!(
            "{place}it is missing, although a texture of the material uses it"
        ));
    Model::textured()
        .with(&format!("{BASE}/texCoord"), json!(2))
        .dropped("mesh \"X\" primitive 0 TEXCOORD_2: it is missing");
    for (values, sentence) in [
        (
            [0.0, 0.0, f32::NAN, 0.0, 1.0, 1.0, 0.0, 1.0],
            "vertex 1 has a value that is not finite",
        ),
        (
            [0.0, 0.0, 1.0, 0.0, 1.0, f32::INFINITY, 0.0, 1.0],
            "vertex 2 has a value that is not finite",
        ),
        (
            [0.0, 0.0, 1e6, 0.0, 1.0, 1.0, 0.0, 1.0],
            "vertex 1 has the image coordinates 1000000 0; allowed: magnitudes up to 65536; the texture is left out",
        ),
    ] {
        let mut model = Model::textured();
        let texcoords = model.accessor(&le_floats(&values), F32, "VEC2", 4);
        model
            .with(
                "/meshes/0/primitives/0/attributes/TEXCOORD_0",
                json!(texcoords),
            )
            .left_out(&format!("{place}{sentence}"));
    }
    let mut short = Model::textured();
    let texcoords = short.accessor(&le_floats(&[0.0; 6]), F32, "VEC2", 3);
    short
        .with(
            "/meshes/0/primitives/0/attributes/TEXCOORD_0",
            json!(texcoords),
        )
        .dropped("accessor 3 has 3 elements, but the primitive has 4 vertices");
    Model::textured()
        .with("/accessors/1/type", json!("SCALAR"))
        .dropped(place);
    Model::textured()
        .with("/accessors/1/componentType", json!(U16))
        .dropped(place);
}

#[test]
fn cameras_of_a_file_are_chosen_by_name_and_go_with_their_nodes() {
    let mut model = Model::textured();
    let (times, places) = (
        model.accessor(&le_floats(&[0.0, 2.0]), F32, "SCALAR", 2),
        le_floats(&[0.0, 0.0, 5.0, 4.0, 0.0, 5.0]),
    );
    (
        model.json["accessors"][times]["min"],
        model.json["accessors"][times]["max"],
    ) = (json!([0]), json!([2]));
    let places = model.accessor(&places, F32, "VEC3", 2);
    let lens = json!({ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } });
    let model = model
        .with("/cameras", json!([lens.clone(), lens]))
        .with("/nodes", json!([{ "mesh": 0 }, { "children": [2] }, { "camera": 0, "name": "chase", "translation": [0, 1, 0] }, { "camera": 1, "name": "still", "translation": [0, 0, 9] }]))
        .with("/scenes/0/nodes", json!([0, 1, 3]))
        .with(
            "/animations",
            json!([{ "name": "Drive", "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }], "samplers": [{ "input": times, "output": places }] }]),
        );
    let scene = model.scene();
    let names: Vec<&str> = scene
        .cameras
        .iter()
        .map(|camera| camera.name.as_str())
        .collect();
    assert_eq!(names, ["chase", "still"]);
    let eye = |camera: &str, clip: &str, time_s: f64| {
        let play = ClipPlayback {
            clip: clip.into(),
            ..ClipPlayback::default()
        };
        let preset = Preset {
            scene_camera: camera.into(),
            playback: play,
            clock: Clock {
                time_s,
                ..Clock::default()
            },
            ..Preset::default()
        };
        preset
            .check(&scene)
            .unwrap_or_else(|error| panic!("{error}"));
        let view = preset.view(&scene, [64, 48]);
        (view.eye, view.forward)
    };
    assert_eq!(
        eye("", "", 0.5).0,
        DVec3::new(0.0, 1.0, 0.0),
        "at rest its node stands in its parent's place"
    );
    assert_eq!(
        eye("", "Drive", 0.5),
        (DVec3::new(1.0, 1.0, 5.0), DVec3::NEG_Z),
        "the first, unasked"
    );
    assert_eq!(eye("chase", "Drive", 1.5).0, DVec3::new(3.0, 1.0, 5.0));
    assert_eq!(eye("#1", "Drive", 1.5).0, DVec3::new(0.0, 0.0, 9.0));
    assert_eq!(eye("still", "", 0.0).0, DVec3::new(0.0, 0.0, 9.0));
    let lost = Preset {
        scene_camera: "crane".into(),
        ..Preset::default()
    };
    assert_eq!(
        lost.check(&scene).unwrap_err().to_string(),
        "scene.camera: the scene has no camera \"crane\"; it has \"chase\", \"still\""
    );
    let own = Camera {
        eye: DVec3::splat(7.0),
        ..Camera::default()
    };
    let own = Preset {
        scene_camera: "still".into(),
        camera: Some(own),
        ..Preset::default()
    };
    assert_eq!(
        own.view(&scene, [64, 48]).eye,
        DVec3::splat(7.0),
        "a preset's own camera comes first"
    );
}
