//! Panes: blended sheets that cross each other round a post, before and behind opaque things, so no
//! order of whole sheets is right.

use std::f64::consts::TAU;

use glam::{DMat4, DVec3};

use super::query::{BuiltinError, Values};
use crate::scene::mesh_builder::MeshBuilder;
use crate::{
    math::{cos_turns, sin_turns, srgb_byte},
    scene::{
        material::Material,
        model::{Instance, Scene},
        texture::{Image, Texture},
    },
};

const HEIGHT_M: f64 = 1.5;
/// Half the width of a sheet.
const REACH_M: f64 = 1.1;

/// `sheets` sheets that cross in the middle. The last has holes: the alpha of its image.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let sheets = values.whole("sheets");
    let mut scene = Scene::default();
    let mut add = |name: String, mesh: MeshBuilder, material: Material| {
        scene.materials.push(Material {
            name: name.clone(),
            double_sided: true,
            ..material
        });
        let material = scene.materials.len() - 1;
        let primitive = mesh.append(&mut scene, &name, material);
        scene
            .instances
            .push(Instance::fixed(primitive, DMat4::IDENTITY));
    };
    add("floor".into(), floor(), Material::default());
    for (post, color) in [[0.85, 0.2, 0.08], [0.9, 0.65, 0.1], [0.1, 0.3, 0.6]]
        .into_iter()
        .enumerate()
    {
        let turn = (post as f64 + 0.4) / 3.0;
        let center = DVec3::new(cos_turns(turn), 0.0, sin_turns(turn)) * (0.55 * REACH_M);
        add(
            format!("post {}", post + 1),
            pillar(center, 0.13, 0.4 + 0.35 * post as f64, color),
            Material::default(),
        );
    }
    for sheet in 0..sheets {
        let part = f64::from(sheet) / f64::from(sheets);
        let hue = |shift: f64| (0.55 + 0.45 * libm::cos(TAU * (part + shift))) as f32;
        let is_last = sheet + 1 == sheets;
        let alpha = 0.35 + 0.4 * (f64::from(sheet) * 0.618).fract() as f32;
        let material = Material {
            base_color: [hue(0.0), hue(0.33), hue(0.67), alpha],
            base_texture: is_last.then(|| Texture::plain(0)),
            is_blended: true,
            ..Material::default()
        };
        add(
            format!("sheet {}", sheet + 1),
            pane(0.5 * part, is_last),
            material,
        );
    }
    scene.images.push(holes().with_mipmaps());
    Ok(scene)
}

/// An upright sheet through the axis, turned by a part of a whole turn.
fn pane(turn: f64, is_textured: bool) -> MeshBuilder {
    let along = DVec3::new(cos_turns(turn), 0.0, sin_turns(turn)) * REACH_M;
    let normal = DVec3::new(-sin_turns(turn), 0.0, cos_turns(turn));
    let mut mesh = MeshBuilder::default();
    let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)].map(|(side, up)| {
        let position = along * side + DVec3::Y * (0.02 + up * HEIGHT_M);
        if is_textured {
            mesh.textured_vertex(position, normal, [1.5 * side + 1.5, 2.0 - 2.0 * up])
        } else {
            mesh.vertex(position, normal)
        }
    });
    mesh.triangle([corners[0], corners[1], corners[2]]);
    mesh.triangle([corners[0], corners[2], corners[3]]);
    mesh
}

/// A square box that stands on the floor.
fn pillar(center: DVec3, half: f64, height: f64, color: [f64; 3]) -> MeshBuilder {
    let at = |x: f64, y: f64, z: f64| center + DVec3::new(x * half, y * height, z * half);
    let mut mesh = MeshBuilder::default();
    let ring = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    for i in 0..4 {
        let ((x0, z0), (x1, z1)) = (ring[i], ring[(i + 1) % 4]);
        mesh.quad(
            [
                at(x0, 0.0, z0),
                at(x1, 0.0, z1),
                at(x1, 1.0, z1),
                at(x0, 1.0, z0),
            ],
            color,
        );
    }
    mesh.quad(ring.map(|(x, z)| at(x, 1.0, z)), color);
    mesh
}

/// A chequered floor.
fn floor() -> MeshBuilder {
    const TILES: i32 = 6;
    let side = 3.0 / f64::from(TILES);
    let mut mesh = MeshBuilder::default();
    for (row, column) in (0..TILES).flat_map(|row| (0..TILES).map(move |column| (row, column))) {
        let corner = |x: i32, z: i32| {
            DVec3::new(
                side * f64::from(x - TILES / 2),
                0.0,
                side * f64::from(z - TILES / 2),
            )
        };
        let tone = if (row + column) % 2 == 0 { 0.62 } else { 0.2 };
        mesh.quad(
            [
                corner(column, row),
                corner(column, row + 1),
                corner(column + 1, row + 1),
                corner(column + 1, row),
            ],
            [tone, tone, tone * 0.95],
        );
    }
    mesh
}

/// White, with a soft round hole.
fn holes() -> Image {
    const SIDE: u32 = 32;
    let texel = |x: u32, y: u32| {
        let [u, v] = [x, y].map(|k| (f64::from(k) + 0.5) / f64::from(SIDE) - 0.5);
        let alpha = ((libm::hypot(u, v) - 0.22) / 0.1).clamp(0.0, 1.0);
        let white = srgb_byte(0.95);
        [white, white, white, (alpha * 255.0 + 0.5) as u8]
    };
    Image::new(
        "holes",
        [SIDE; 2],
        (0..SIDE)
            .flat_map(|y| (0..SIDE).map(move |x| texel(x, y)))
            .collect(),
    )
}
