//! Leaves: quadrilaterals masked by the alpha of an image, scattered over a crown.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    query::{BuiltinError, Values},
    shapes::single_mesh_scene,
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

/// Length of a leaf, meters.
const LENGTH_M: f64 = 0.62;

/// `n` leaves on a crown about 2 m across, each with its own vertices.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let (leaves, seed) = (values.whole("n"), values.whole("seed"));
    let mut mesh = MeshBuilder::with_capacity(4 * leaves as usize, 2 * leaves as usize);
    for leaf in 0..leaves {
        let unit = |salt: u32| hash_unit(hash(seed) ^ hash(8 * leaf + salt));
        // On a sunflower spiral over the sphere, slightly inside it, pointing out and down.
        let height = 1.0 - 2.0 * (f64::from(leaf) + 0.5) / f64::from(leaves);
        let turn = f64::from(leaf) * 0.381_966_011_250_105 + 0.05 * unit(0);
        let flat = (1.0 - height * height).max(0.0).sqrt();
        let out = DVec3::new(flat * sin_turns(turn), height, flat * cos_turns(turn));
        let stem = out * (0.62 + 0.3 * unit(1));
        let along =
            (out + DVec3::new(unit(2) - 0.5, -0.7 * unit(3), unit(4) - 0.5)).normalize_or(DVec3::Y);
        let across = along
            .cross(DVec3::new(unit(5) - 0.5, 1.0, unit(6) - 0.5))
            .normalize_or(DVec3::X);
        let normal = across.cross(along);
        let width = 0.34 * LENGTH_M;
        let corner =
            |side: f64, way: f64| stem + across * (side * width) + along * (way * LENGTH_M);
        let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)];
        let [a, b, c, d] = corners.map(|(side, way)| {
            mesh.textured_vertex(corner(side, way), normal, [0.5 + 0.5 * side, 1.0 - way])
        });
        mesh.triangle([a, b, c]);
        mesh.triangle([a, c, d]);
    }
    let texture = Texture {
        wrap: [Wrap::Clamp; 2],
        ..Texture::plain(0)
    };
    let leaf = Material {
        name: "leaf".into(),
        base_texture: Some(texture),
        alpha_cutoff: Some(0.5),
        double_sided: true,
        ..Material::default()
    };
    let mut scene = single_mesh_scene(mesh, "leaves", leaf);
    scene.images.push(leaf_image(40, 60).with_mipmaps());
    Ok(scene)
}

/// A serrated leaf with veins and a stem; alpha falls off over one or two texels at its outline.
fn leaf_image(width: u32, height: u32) -> Image {
    let texel = |x: u32, y: u32| {
        let across = (f64::from(x) + 0.5) / f64::from(width) * 2.0 - 1.0;
        let way = 1.0 - (f64::from(y) + 0.5) / f64::from(height);
        let blade = (way - 0.16) / 0.82;
        let teeth = 0.05 * (1.0 - 2.0 * (9.0 * blade - (9.0 * blade).floor()));
        let reach = if (0.0..1.0).contains(&blade) {
            0.86 * libm::sin(0.5 * TAU * libm::pow(blade, 0.75)) + teeth
        } else {
            0.0
        };
        let stem = if way < 0.3 { 0.08 } else { 0.0 };
        let inside = (reach.max(stem) - across.abs()) * f64::from(width) * 0.5;
        let vein = across.abs() < 0.05
            || ((blade * 6.0 - across.abs() * 1.6).rem_euclid(1.0) < 0.16 && across.abs() < reach);
        let ripe = 0.35 + 0.65 * way;
        let color = if vein {
            [0.62, 0.42, 0.08]
        } else {
            [0.75 * ripe, 0.26 * (1.3 - ripe), 0.03]
        };
        let [r, g, b] = color.map(srgb_byte);
        [
            r,
            g,
            b,
            ((inside * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0 + 0.5) as u8,
        ]
    };
    Image::new(
        "leaf",
        [width, height],
        (0..height)
            .flat_map(|y| (0..width).map(move |x| texel(x, y)))
            .collect(),
    )
}
