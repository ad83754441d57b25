//! Hair: a head under blended strips, each an image of strands, in deep stacks.

use glam::{DMat4, DVec3};

use super::{
    glassware::add,
    painted::globe_mesh,
    query::{BuiltinError, Values},
};
use crate::scene::mesh_builder::MeshBuilder;
use crate::{
    math::{cos_turns, hash, hash_unit, sin_turns, srgb_byte},
    scene::{
        material::Material,
        model::Scene,
        texture::{Image, Texture, Wrap},
    },
};

/// Half axes of the skull, which lies about the origin and looks along z.
const SKULL_M: DVec3 = DVec3::new(0.74, 0.95, 0.86);
const SEGMENTS: u32 = 8;
/// Length of a segment of a strip, and half its width.
const SEGMENT_M: f64 = 0.27;
const HALF_WIDTH_M: f64 = 0.15;

/// `cards` strips of hair on a bust.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (cards, seed) = (values.whole("cards"), values.whole("seed"));
    let mut scene = Scene::default();
    let skin = [0.56, 0.31, 0.2, 1.0];
    let cloth = [0.05, 0.09, 0.13, 1.0];
    let at = DVec3::new;
    for (name, color, place, half) in [
        ("skull", [0.07, 0.03, 0.012, 1.0], DVec3::ZERO, SKULL_M),
        ("face", skin, at(0.0, -0.3, 0.26), at(0.6, 0.8, 0.68)),
        ("nose", skin, at(0.0, -0.2, 0.88), at(0.09, 0.2, 0.13)),
        ("neck", skin, at(0.0, -1.1, -0.08), at(0.34, 0.7, 0.34)),
        (
            "shoulders",
            cloth,
            at(0.0, -1.75, -0.1),
            at(1.35, 0.45, 0.55),
        ),
    ] {
        let material = Material {
            base_color: color,
            roughness: 0.55,
            ..Material::default()
        };
        let place = DMat4::from_translation(place) * DMat4::from_scale(half);
        add(&mut scene, name, globe_mesh(10), material, place);
    }
    scene.images.push(strands().with_mipmaps());
    let mut mesh = MeshBuilder::default();
    for card in 0..cards {
        let unit = |salt: u32| hash_unit(hash(seed) ^ hash(8 * card + salt));
        add_card(
            &mut mesh,
            (f64::from(card) + 0.5) / f64::from(cards),
            card,
            unit,
        );
    }
    let material = Material {
        base_texture: Some(Texture {
            wrap: [Wrap::Clamp; 2],
            ..Texture::plain(0)
        }),
        is_blended: true,
        double_sided: true,
        roughness: 0.4,
        ..Material::default()
    };
    add(&mut scene, "hair", mesh, material, DMat4::IDENTITY);
    Ok(scene)
}

/// A strip that grows out of the scalp, at a part of the way from the crown to the hairline, and
/// falls along the skull and beside it.
fn add_card(mesh: &mut MeshBuilder, part: f64, card: u32, unit: impl Fn(u32) -> f64) {
    // A sunflower spiral over the cap of the skull, which leans back from the face.
    let height = 1.0 - 1.15 * part;
    let turn = f64::from(card) * 0.381_966_011_250_105 + 0.04 * unit(0);
    let flat = (1.0 - height * height).max(0.0).sqrt();
    let cap = DVec3::new(flat * sin_turns(turn), height, flat * cos_turns(turn));
    let root = (cap + DVec3::new(0.0, 0.1, -0.5)).normalize();
    let lift = 1.03 + 0.16 * unit(1);
    let mut at = root * SKULL_M * lift;
    let out = (root / SKULL_M).normalize();
    let mut way = DVec3::new(
        0.9 * out.x + 0.5 * (unit(2) - 0.5),
        -0.25 + 0.3 * unit(5),
        0.5 * out.z - 0.35 + 0.4 * (unit(3) - 0.5),
    )
    .normalize();
    // An image shows several tufts; a strip shows one of them.
    let tuft = f64::from(card % TUFTS) / f64::from(TUFTS);
    let mut last: Option<[u32; 2]> = None;
    for segment in 0..=SEGMENTS {
        let out = (at / (SKULL_M * SKULL_M)).normalize();
        let across = way.cross(out).normalize_or(DVec3::X);
        let way_down = f64::from(segment) / f64::from(SEGMENTS);
        let half = HALF_WIDTH_M * (1.0 - 0.5 * way_down * way_down);
        let pair = [-1.0, 1.0].map(|side: f64| {
            let u = tuft + (0.5 + 0.5 * side) / f64::from(TUFTS);
            mesh.textured_vertex(at + across * (side * half), out, [u, way_down])
        });
        if let Some([a, b]) = last.replace(pair) {
            mesh.triangle([a, b, pair[1]]);
            mesh.triangle([a, pair[1], pair[0]]);
        }
        at += way * (SEGMENT_M * (0.75 + 0.5 * unit(4)));
        let inside = (at / SKULL_M).length();
        if inside < lift {
            at *= lift / inside;
        }
        way = (way + DVec3::NEG_Y * 0.5).normalize_or(DVec3::NEG_Y);
    }
}

/// Tufts side by side in the image.
const TUFTS: u32 = 4;

/// Tufts of strands, each strand with a tone and a length of its own; alpha falls off at its sides
/// and its tip.
fn strands() -> Image {
    const STRANDS: u32 = 9;
    let [width, height] = [128, 64];
    let texel = |x: u32, y: u32| {
        let down = (f64::from(y) + 0.5) / f64::from(height);
        let place = (f64::from(x) + 0.5) / f64::from(width) * f64::from(TUFTS * STRANDS);
        let strand = place as u32;
        let aside = 2.0 * (place - f64::from(strand)) - 1.0;
        let length = 0.6 + 0.4 * hash_unit(3 * strand);
        // Strands at the edge of a tuft are short, so that it ends in a point.
        let edge = (f64::from(strand % STRANDS) + 0.5) / f64::from(STRANDS) * 2.0 - 1.0;
        let left = (1.0 - down / (length * (1.0 - 0.35 * edge * edge))).max(0.0);
        let alpha = (1.0 - aside * aside) * (4.0 * left).min(1.0) * (1.0 - 0.5 * edge.abs());
        let tone = 0.55 + 0.75 * hash_unit(3 * strand + 1) + 0.5 * down;
        let [red, green, blue] = [0.2, 0.085, 0.03].map(|channel| srgb_byte(channel * tone));
        [red, green, blue, (alpha * 255.0 + 0.5) as u8]
    };
    Image::new(
        "strands",
        [width, height],
        (0..height)
            .flat_map(|y| (0..width).map(move |x| texel(x, y)))
            .collect(),
    )
}
