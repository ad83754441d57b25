//! Textured scenes: procedural images on a globe, and on panels that cover every way of sampling.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec3, DVec4};

use super::{
    query::{BuiltinError, Values},
    shapes::single_mesh_scene,
};
use crate::scene::mesh_builder::MeshBuilder;
use crate::{
    math::{hash, rotation_y, srgb_byte},
    scene::{
        material::Material,
        model::{Instance, Scene},
        texture::{Filter, Image, MipFilter, Texture, Wrap},
    },
};

/// A globe with a grid of colors: the hue changes with longitude, and every second cell is pale.
pub fn globe(values: &Values) -> Result<Scene, BuiltinError> {
    let map = Material {
        name: "map".into(),
        base_texture: Some(around()),
        ..Material::default()
    };
    let mesh = globe_mesh(values.whole("tess"));
    let mut scene = single_mesh_scene(mesh, "globe", map);
    scene.images.push(color_grid(256, 128, 16).with_mipmaps());
    Ok(scene)
}

/// The first image, around a globe.
pub fn around() -> Texture {
    Texture {
        wrap: [Wrap::Repeat, Wrap::Clamp],
        ..Texture::plain(0)
    }
}

/// A ball of radius 1 about the origin, whose image goes once around it, from +z towards +x, and from
/// the upper pole to the lower one.
pub fn globe_mesh(tess: u32) -> MeshBuilder {
    let (columns, rows) = (4 * tess, 2 * tess);
    let mut mesh = MeshBuilder::with_capacity(
        ((columns + 1) * (rows + 1)) as usize,
        (2 * columns * (rows - 1)) as usize,
    );
    for row in 0..=rows {
        let (sin_v, cos_v) = libm::sincos(PI * f64::from(row) / f64::from(rows));
        for column in 0..=columns {
            let (sin_u, cos_u) =
                libm::sincos(TAU * f64::from(column % columns) / f64::from(columns));
            // Each triangle at a pole has its own vertex, at the center of its part of the texture.
            let aside = if row == 0 || row == rows { 0.5 } else { 0.0 };
            let normal = match row {
                0 => DVec3::Y,
                row if row == rows => DVec3::NEG_Y,
                _ => DVec3::new(sin_v * sin_u, cos_v, sin_v * cos_u),
            };
            let texcoords = [
                (f64::from(column) + aside) / f64::from(columns),
                f64::from(row) / f64::from(rows),
            ];
            mesh.textured_vertex(normal, normal, texcoords);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let (above, below) = (
                row * (columns + 1) + column,
                (row + 1) * (columns + 1) + column,
            );
            if row > 0 {
                mesh.triangle([above, below, above + 1]);
            }
            if row + 1 < rows {
                mesh.triangle([above + 1, below, below + 1]);
            }
        }
    }
    mesh
}

/// Cells of all hues, alternately light and dark, with thin lines between them.
fn color_grid(width: u32, height: u32, cell: u32) -> Image {
    let texel = |x: u32, y: u32| {
        let turn = f64::from(x / cell) / f64::from(width / cell);
        let light = 0.75 - 0.5 * f64::from(y / cell) / f64::from(height / cell);
        let is_pale = (x / cell + y / cell).is_multiple_of(2);
        let is_line = x.is_multiple_of(cell) || y.is_multiple_of(cell);
        let channel = |shift: f64| {
            let hue = 0.5 + 0.5 * libm::cos(TAU * (turn - shift));
            let color = light * (0.08 + 0.92 * hue * hue);
            srgb_byte(if is_line {
                0.01
            } else if is_pale {
                0.55 + 0.3 * color
            } else {
                color
            })
        };
        [channel(0.02), channel(0.37), channel(0.66), 255]
    };
    Image::new(
        "color grid",
        [width, height],
        (0..height)
            .flat_map(|y| (0..width).map(move |x| texel(x, y)))
            .collect(),
    )
}

/// An image of odd size without any symmetry: an arrow to the right on two colors.
fn arrow() -> Image {
    const ROWS: [&[u8; 11]; 7] = [
        b".....#.....",
        b".....##....",
        b"########...",
        b".....##..oo",
        b"+++++#...oo",
        b"+++++++++++",
        b"...........",
    ];
    let tone = |mark: &u8| match mark {
        b'#' => [222, 74, 38, 255],
        b'o' => [28, 96, 140, 255],
        b'+' => [236, 190, 96, 255],
        _ => [244, 240, 226, 255],
    };
    Image::new(
        "arrow",
        [11, 7],
        ROWS.iter().flat_map(|row| row.iter().map(tone)).collect(),
    )
}

/// Gravel: every texel has a random gray, so that wrong scales are visible.
fn gravel() -> Image {
    let texel = |at: u32| {
        let gray = 70 + (hash(at) % 120) as u8;
        [gray, gray - 12, gray - 30, 255]
    };
    Image::new("gravel", [64, 64], (0..64 * 64).map(texel).collect())
}

/// Windows at night: an emission texture with dark and bright parts.
fn windows() -> Image {
    let texel = |x: u32, y: u32| {
        let is_pane = x % 8 > 1 && y % 8 > 2 && !hash(y / 8 * 4 + x / 8).is_multiple_of(3);
        if is_pane {
            [255, 214, 130, 255]
        } else {
            [0, 0, 0, 255]
        }
    };
    Image::new(
        "windows",
        [32, 32],
        (0..32)
            .flat_map(|y| (0..32).map(move |x| texel(x, y)))
            .collect(),
    )
}

/// A panel with its image.
struct Panel {
    material: Material,
    /// Texture coordinates at its left and right, top and bottom edges.
    span: [[f64; 2]; 2],
}

/// Panels in two rows above a ground that extends to the horizon, each with another way of
/// sampling.
pub fn panels(values: &Values) -> Result<Scene, BuiltinError> {
    let mut scene = Scene {
        images: vec![
            arrow().with_mipmaps(),
            gravel().with_mipmaps(),
            windows().with_mipmaps(),
        ],
        ..Scene::default()
    };
    let repeats = values.get("repeats");
    for (index, Panel { material, span }) in panel_list(repeats).into_iter().enumerate() {
        let is_ground = index == 6;
        let mut mesh = MeshBuilder::with_capacity(4, 2);
        let [[left, right], [top, bottom]] = span;
        for (x, y, u, v) in [
            (-1.0, -1.0, left, bottom),
            (1.0, -1.0, right, bottom),
            (1.0, 1.0, right, top),
            (-1.0, 1.0, left, top),
        ] {
            mesh.textured_vertex(DVec3::new(x, y, 0.0), DVec3::Z, [u, v]);
        }
        mesh.triangle([0, 1, 2]);
        mesh.triangle([0, 2, 3]);
        let name = material.name.clone();
        scene.materials.push(material);
        let primitive = mesh.append(&mut scene, &name, index);
        let world_from_object = if is_ground {
            // Rotated to face up.
            DMat4::from_cols(
                DVec4::X * 6.0,
                DVec4::NEG_Z * 6.0,
                DVec4::Y,
                DVec4::new(0.0, -2.3, -3.0, 1.0),
            )
        } else {
            let (column, row) = ((index % 3) as f64, (index / 3) as f64);
            DMat4::from_translation(DVec3::new(2.3 * (column - 1.0), 1.15 - 2.3 * row, 0.0))
                * rotation_y(0.35 * (1.0 - column))
        };
        scene
            .instances
            .push(Instance::fixed(primitive, world_from_object));
    }
    Ok(scene)
}

/// The six panels and the ground.
fn panel_list(repeats: f64) -> Vec<Panel> {
    let paper = |name: &str, texture: Texture| Material {
        name: name.into(),
        base_texture: Some(texture),
        double_sided: true,
        ..Material::default()
    };
    let crisp = Texture {
        mag_filter: Filter::Nearest,
        min_filter: Filter::Nearest,
        mip_filter: MipFilter::Unused,
        ..Texture::plain(0)
    };
    let around = [[-0.7, 1.9], [-0.6, 1.7]];
    // Rotated by a sixth of a turn, and half as large.
    let (sin, cos) = libm::sincos(TAU / 6.0);
    let turned = [[2.0 * cos, 2.0 * sin, 0.15], [-2.0 * sin, 2.0 * cos, 0.4]]
        .map(|row| row.map(|v| v as f32));
    vec![
        Panel {
            material: paper("repeated, nearest", crisp),
            span: around,
        },
        Panel {
            material: paper(
                "mirrored across, clamped down",
                Texture {
                    wrap: [Wrap::Mirrored, Wrap::Clamp],
                    ..Texture::plain(0)
                },
            ),
            span: around,
        },
        Panel {
            material: paper(
                "clamped across, mirrored down, nearest",
                Texture {
                    wrap: [Wrap::Clamp, Wrap::Mirrored],
                    mip_filter: MipFilter::Nearest,
                    ..crisp
                },
            ),
            span: around,
        },
        Panel {
            material: paper(
                "turned",
                Texture {
                    image_from_texcoord: turned,
                    ..Texture::plain(0)
                },
            ),
            span: [[0.0, 1.0], [0.0, 1.0]],
        },
        Panel {
            material: Material {
                base_color: [0.05, 0.09, 0.16, 1.0],
                base_texture: None,
                emission: [1.0, 1.0, 1.0],
                emission_texture: Some(Texture {
                    mag_filter: Filter::Nearest,
                    ..Texture::plain(2)
                }),
                ..paper("shining", crisp)
            },
            span: [[0.0, 1.0], [0.0, 1.0]],
        },
        Panel {
            material: Material {
                unlit: true,
                ..paper("unlit", Texture::plain(0))
            },
            span: [[0.0, 1.0], [0.0, 1.0]],
        },
        Panel {
            material: paper("ground", Texture::plain(1)),
            span: [[0.0, repeats], [0.0, repeats]],
        },
    ]
}
