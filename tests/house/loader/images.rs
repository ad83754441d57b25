//! Promise: images of a file are read from bytes, URIs and files where something drawn looks them up,
//! within a budget; what is none is left out by name.

use base64::{Engine, prelude::BASE64_STANDARD};
use image::ImageFormat;
use rasterlab::{host, scene::gltf::limits};
use serde_json::json;

use super::model::*;

/// A PNG of one color: a few bytes for any size.
fn blank(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a header");
    let texels = vec![0; width.div_ceil(8) as usize * height as usize];
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn images_come_as_png_or_jpeg_from_bytes_uris_and_files() {
    let texels = vec![[255, 0, 0, 255], [0, 200, 0, 100]];
    let levels = |model: &Model| model.scene().images[0].levels.clone();
    let scene = Model::textured().scene();
    assert_eq!(
        (scene.images.len(), &scene.images[0].levels[0].texels),
        (1, &texels)
    );
    assert_eq!(
        levels(&Model::textured()).len(),
        2,
        "an open sampler mixes copies"
    );
    let plain = Model::textured().set("/samplers/0/minFilter 9729");
    assert_eq!(levels(&plain).len(), 1, "no sampler asks for copies");
    let jpeg = Model::textured().showing(&encoded(ImageFormat::Jpeg));
    jpeg.play("? image \"flag\" is image/jpeg, although the file declares \"image/png\"");
    assert_eq!(
        jpeg.set("/images/0/mimeType \"image/jpeg\"")
            .silent()
            .images[0]
            .size(),
        [2, 1]
    );

    let png = encoded(ImageFormat::Png);
    let showing = |uri: &str| Model::textured().with("/images/0", json!({ "uri": uri }));
    let data = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&png));
    assert_eq!(levels(&showing(&data))[0].texels, texels);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("inside")).expect("a folder");
    for place in ["flag.png", "inside/flag one.png"] {
        std::fs::write(at(place), &png).expect("written");
    }
    let load = |uri: &str| {
        std::fs::write(at("inside/model.glb"), showing(uri).glb()).expect("written");
        host::model::load(&at("inside/model.glb")).expect(uri)
    };
    assert_eq!(load("flag%20one.png").images[0].levels[0].texels, texels);
    for (uri, sentence) in [
        (
            "../flag.png",
            "image 0: URI \"../flag.png\" leads out of the model's folder",
        ),
        ("http://example.org/flag.png", "has a scheme"),
        ("none.png", "image 0: \"none.png\": cannot read the file"),
    ] {
        let faults = load(uri).faults;
        assert!(faults[0].contains(sentence), "{faults:?}");
    }
}

#[test]
fn images_that_are_none_are_left_out_by_name() {
    let [png, jpeg] = [ImageFormat::Png, ImageFormat::Jpeg].map(encoded);
    let mut flipped = png.clone();
    flipped[20] ^= 64;
    let cut = [8, 20, 40, png.len() - 16].map(|length| &png[..length]);
    for bytes in [&b"RIFF....WEBP"[..], &jpeg[..60]].into_iter().chain(cut) {
        let place = "material \"paper\": baseColorTexture: image \"flag\": cannot decode the image";
        Model::textured().showing(bytes).dropped(place);
    }
    Model::textured()
        .showing(&[])
        .dropped("it is neither PNG, JPEG nor WebP");
    Model::textured()
        .showing(&flipped)
        .dropped("image \"flag\": ");
}

#[test]
fn an_image_cannot_ask_for_more_than_the_budget() {
    let bomb = blank(60_000, 60_000 / 50);
    assert!(bomb.len() < 100_000, "{} bytes", bomb.len());
    Model::textured()
        .showing(&bomb)
        .dropped("image \"flag\": it has 60000 x 1200 texels; allowed: 1 to 32768 along each side");
    let side = limits::IMAGE_SIDE;
    let plain = Model::textured().set("/samplers/0/minFilter 9729");
    assert_eq!(
        plain.clone().showing(&blank(side, 16)).scene().images[0].size(),
        [side, 16]
    );
    // Two of the largest fit, a third does not; its header is enough to know.
    let mut model = plain;
    let largest = model.view(&blank(side, side));
    for place in 0..3 {
        let name = format!("large {place}");
        let image = model.push(
            "images",
            json!({ "bufferView": largest, "mimeType": "image/png", "name": name }),
        );
        let texture = model.push("textures", json!({ "source": image, "sampler": 0 }));
        let shown = json!({ "baseColorTexture": { "index": texture } });
        let material = model.push("materials", json!({ "pbrMetallicRoughness": shown }));
        model.primitive(json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": material }));
    }
    model.refused("image \"large 1\": with it the decoded images have 536870920 bytes; allowed: at most 536870912");
}
