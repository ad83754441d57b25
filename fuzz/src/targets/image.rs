//! Images that models show: PNG, JPEG and WebP.

use rasterlab::scene::texture::Level;
use serde_json::json;

use super::{Outcome, Target, model};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "image",
    about: "PNG, JPEG and WebP images of models",
    views: &[views::PNG_CHUNKS],
    limit: Limit::new(20, 2048),
    check,
};

fn check(image: &[u8]) -> Outcome {
    let formats: [(&str, &[u8]); 2] = [("image/jpeg", b"\xff\xd8"), ("image/webp", b"RIFF")];
    let format = formats
        .iter()
        .find(|(_, begin)| image.starts_with(begin))
        .map_or("image/png", |(format, _)| format);
    let scene = model::read(&showing(image, format)).map_err(|error| error.to_string())?;
    let is_whole =
        |level: &Level| level.texels.len() == level.size[0] as usize * level.size[1] as usize;
    assert!(
        scene
            .images
            .iter()
            .all(|image| image.levels.iter().all(is_whole)),
        "a level lacks texels"
    );
    Ok(())
}

/// A model of one triangle with this image.
fn showing(image: &[u8], format: &str) -> Vec<u8> {
    let extension = if format == "image/webp" {
        json!(["EXT_texture_webp"])
    } else {
        json!([])
    };
    let texture = if format == "image/webp" {
        json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } })
    } else {
        json!({ "source": 0 })
    };
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let coordinates = [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0];
    let numbers: Vec<u8> = corners
        .iter()
        .chain(&coordinates)
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let json = json!({
        "asset": { "version": "2.0" }, "buffers": [{ "byteLength": numbers.len() + image.len() }], "extensionsUsed": extension,
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 24 }, { "buffer": 0, "byteOffset": 60, "byteLength": image.len().max(1) },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 3 },
        ],
        "images": [{ "bufferView": 2, "mimeType": format }], "textures": [texture],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
    });
    crate::views::joined(json.to_string().as_bytes(), &[&numbers, image].concat())
}
