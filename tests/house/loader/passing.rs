//! Promise: textures of transmission and thickness say where light passes and what is left of it,
//! and morph targets move colors and texture coordinates as the weights at rest say.

use glam::DVec3;
use image::{ImageBuffer, ImageFormat, Rgba};
use rasterlab::{
    effects::hooks::{Finish, Surface, Transmission},
    preset::Preset,
    scene::Scene,
};
use serde_json::json;

use super::model::*;

/// Four texels in a row.
fn row(texels: [[u8; 4]; 4]) -> Vec<u8> {
    let picture = ImageBuffer::<Rgba<u8>, _>::from_raw(4, 1, texels.concat()).expect("texels");
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .expect("it is encoded");
    bytes.into_inner()
}

/// A glass square that shows one image, and whose light passes by another.
fn glass(color: &[u8], passing: &[u8], absorbs: bool) -> Model {
    let mut model = Model::textured().showing(color);
    let view = model.view(passing);
    let image = model.push(
        "images",
        json!({ "bufferView": view, "mimeType": "image/png" }),
    );
    let texture = model.push("textures", json!({ "source": image, "sampler": 0 }));
    let mut extensions = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1, "transmissionTexture": { "index": texture } },
    });
    if absorbs {
        extensions["KHR_materials_volume"] = json!({
            "thicknessFactor": 2, "attenuationDistance": 1, "attenuationColor": [0.5, 1, 1], "thicknessTexture": { "index": texture },
        });
    }
    model.with("/materials/0/extensions", extensions)
}

/// Which of the light behind it passes a texel of the base texture, as a picture says it.
fn passed(scene: &Scene, texel: usize) -> DVec3 {
    let material = &scene.materials[scene.primitives[0].material];
    let image = &scene.images[material.base_texture.expect("a texture").image];
    let [r, g, b, alpha] = image.levels[0].texels[texel].map(|byte| f64::from(byte) / 255.0);
    let color = DVec3::new(r, g, b).map(rasterlab::math::linear_light);
    let plain = Surface::example(DVec3::ZERO, 0);
    let surface = Surface {
        color: color.extend(alpha),
        glow: DVec3::ZERO,
        finish: Finish {
            metallic: 0.0,
            ..plain.finish
        },
        ..plain
    };
    Transmission::of(material)
        .expect("it transmits")
        .through(surface)
        .passed
}

#[test]
fn light_passes_where_the_textures_let_it() {
    let white = [255; 4];
    let color = row([white, white, [0, 255, 255, 0], [0, 255, 255, 128]]);
    // Red lets light through; green is how thick it is.
    let passing = row([
        [255, 0, 9, 255],
        [0, 255, 9, 255],
        [255, 255, 9, 255],
        [51, 0, 9, 255],
    ]);
    let clear = glass(&color, &passing, false).scene();
    assert_eq!(clear.notes, [""; 0]);
    for (texel, expected) in [[1.0, 1.0, 1.0], [0.0; 3], [0.0, 1.0, 1.0], [0.0, 0.2, 0.2]]
        .into_iter()
        .enumerate()
    {
        assert!(
            (passed(&clear, texel) - DVec3::from(expected)).length() < 1e-9,
            "{texel}"
        );
    }
    let thick = glass(&row([white; 4]), &passing, true).scene();
    for (texel, expected) in [[1.0, 1.0, 1.0], [0.0; 3], [0.25, 1.0, 1.0]]
        .into_iter()
        .enumerate()
    {
        let given = passed(&thick, texel);
        assert!(
            (given - DVec3::from(expected)).length() < 0.01,
            "{texel}: {given}"
        );
    }
    // Its alpha is needed where it blends.
    let blended = glass(&color, &passing, false)
        .with("/materials/0/alphaMode", json!("BLEND"))
        .scene();
    assert_eq!(blended.notes.len(), 1, "{:?}", blended.notes);
}

#[test]
fn morph_targets_move_colors_and_texture_coordinates() {
    let mut model = Model::textured();
    let given: Vec<f32> = (0..12).map(|i| i as f32 / 16.0).collect();
    let more = [0.25; 12];
    let (colors, by) = (model.floats("VEC3", &given), model.floats("VEC3", &more));
    let along = model.floats("VEC2", &[0.5; 8]);
    let place = "/meshes/0/primitives/0";
    let model = model
        .with(&format!("{place}/attributes/COLOR_0"), json!(colors))
        .with(
            &format!("{place}/targets"),
            json!([{ "COLOR_0": by, "TEXCOORD_0": along }]),
        )
        .with("/meshes/0/weights", json!([2]));
    let values = |scene: &Scene| {
        let shown = &scene.primitives[scene.instances[0].primitive];
        let value = |of: rasterlab::scene::Accessor, i: u32| of.value(&scene.vertex_bytes, i, 1);
        let texcoords = shown.texcoords[0].expect("coordinates");
        [value(shown.colors.expect("colors"), 1), value(texcoords, 3)]
    };
    let scene = model.scene();
    assert_eq!((values(&scene), scene.notes.len()), ([0.75, 2.0], 0));
    // What a node says counts, and a color stays one.
    let bright = model.clone().with("/nodes/0/weights", json!([9]));
    assert_eq!(values(&bright.scene()), [1.0, 5.5]);
    assert_eq!(
        values(&model.with("/nodes/0/weights", json!([0])).scene()),
        [0.25, 1.0]
    );
    assert!(Preset::default().pose(&scene).is_some());
}
