//! Golf balls: round meshes whose dimples are a texture of normals, with textures of wear.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    painted::{around, globe_mesh},
    query::{BuiltinError, Values},
};
use crate::scene::{
    material::Material,
    model::{Instance, Scene},
    texture::{Image, Texture},
};

/// Radius of a ball, meters.
const RADIUS_M: f64 = 0.5;
/// Distance between the middles of neighbors, meters.
const PITCH_M: f64 = 1.12;

const DIMPLES: u32 = 332;
/// Angle from the middle of a dimple to its rim.
const DIMPLE_RADIUS: f64 = 0.094;
/// Its depth, as a fraction of the radius of the ball.
const DIMPLE_DEPTH: f64 = 0.022;

/// Texels around a ball and from pole to pole.
const SIZE: [u32; 2] = [512, 256];

/// The images of a scene, in order.
const NORMALS: usize = 0;
const WEAR: usize = 1;

/// Builds the scene `golf`.
pub fn build(values: &Values) -> Result<Scene, BuiltinError> {
    let dimples = dimples();
    let mut scene = Scene {
        images: vec![
            image("dimples", |at| normal_at(&dimples, at)),
            image("wear", |at| wear_at(&dimples, at)),
        ],
        ..Scene::default()
    };
    // Base color, metallic, roughness, whether it is worn, how deep the dimples are.
    let balls = [
        ("lacquer", [0.82, 0.81, 0.78], 0.0, 0.34, false, 1.0),
        ("brass", [0.86, 0.61, 0.26], 1.0, 1.0, true, 1.0),
        ("rubber", [0.5, 0.05, 0.035], 0.0, 0.75, false, 0.45),
    ];
    for (index, (name, [red, green, blue], metallic, roughness, is_worn, depth)) in
        balls.into_iter().enumerate()
    {
        let texture = |image: usize| Texture { image, ..around() };
        scene.materials.push(Material {
            name: name.into(),
            base_color: [red, green, blue, 1.0],
            metallic,
            roughness,
            finish_texture: is_worn.then(|| texture(WEAR)),
            occlusion_texture: Some(texture(WEAR)),
            normal_texture: Some(texture(NORMALS)),
            normal_scale: depth,
            ..Material::default()
        });
        let primitive = globe_mesh(values.whole("tess")).append(&mut scene, name, index);
        let place = DVec3::new(PITCH_M * (index as f64 - 1.0), RADIUS_M, 0.0);
        scene.instances.push(Instance::fixed(
            primitive,
            DMat4::from_translation(place) * leaning() * DMat4::from_scale(DVec3::splat(RADIUS_M)),
        ));
    }
    Ok(scene)
}

/// Turns the upper pole towards the viewer.
fn leaning() -> DMat4 {
    let (sin, cos) = libm::sincos(0.5);
    DMat4::from_cols(
        DVec4::X,
        DVec4::new(0.0, cos, sin, 0.0),
        DVec4::new(0.0, -sin, cos, 0.0),
        DVec4::W,
    )
}

/// Middles of the dimples, unit vectors: as even as a spiral makes them.
fn dimples() -> Vec<DVec3> {
    let golden = PI * (3.0 - 5f64.sqrt());
    let middle = |i: u32| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(DIMPLES);
        let (sin, cos) = libm::sincos(golden * f64::from(i));
        let across = (1.0 - y * y).sqrt();
        DVec3::new(across * sin, y, across * cos)
    };
    (0..DIMPLES).map(middle).collect()
}

/// An image of data whose texels follow from their places in it, 0 to 1 across and down.
fn image(name: &str, texel: impl Fn(DVec2) -> DVec3) -> Image {
    let [width, height] = SIZE;
    let byte = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let texels = (0..width * height).map(|at| {
        let (x, y) = (f64::from(at % width) + 0.5, f64::from(at / width) + 0.5);
        let [red, green, blue] = texel(DVec2::new(x / f64::from(width), y / f64::from(height)))
            .to_array()
            .map(byte);
        [red, green, blue, 255]
    });
    Image::new(name, SIZE, texels.collect())
        .of_data()
        .with_mipmaps()
}

/// The directions on a ball at a place in its image: to the right in it, upwards in it and outward.
fn frame(at: DVec2) -> [DVec3; 3] {
    let (sin_u, cos_u) = libm::sincos(TAU * at.x);
    let (sin_v, cos_v) = libm::sincos(PI * at.y);
    [
        DVec3::new(cos_u, 0.0, -sin_u),
        DVec3::new(-cos_v * sin_u, sin_v, -cos_v * cos_u),
        DVec3::new(sin_v * sin_u, cos_v, sin_v * cos_u),
    ]
}

/// The middle of the nearest dimple, and the distance from it as a fraction of its radius.
fn nearest(dimples: &[DVec3], out: DVec3) -> (DVec3, f64) {
    // The spiral goes down evenly, and no dimple is farther than this.
    const FARTHEST: f64 = 0.2;
    let place = |y: f64| (f64::from(DIMPLES) * 0.5 * (1.0 - y)).clamp(0.0, f64::from(DIMPLES));
    let near = place(out.y + FARTHEST) as usize..place(out.y - FARTHEST).ceil() as usize;
    let middle = dimples[near]
        .iter()
        .copied()
        .max_by(|a, b| a.dot(out).total_cmp(&b.dot(out)))
        .unwrap_or(out);
    (middle, (middle - out).length() / DIMPLE_RADIUS)
}

/// The normal of the dimples as a color: 0 to 1 for -1 to 1. A dimple is a paraboloid.
fn normal_at(dimples: &[DVec3], at: DVec2) -> DVec3 {
    let [right, up, out] = frame(at);
    let (middle, distance) = nearest(dimples, out);
    let slope = match distance {
        ..1.0 => 2.0 * DIMPLE_DEPTH / DIMPLE_RADIUS * distance,
        _ => 0.0,
    };
    let inward = (middle - out).normalize_or_zero();
    // The surface rises away from the middle, so its normal leans towards it.
    let normal = DVec3::new(slope * inward.dot(right), slope * inward.dot(up), 1.0).normalize();
    0.5 * normal + 0.5
}

/// Occlusion, roughness and metallic: dimples are shut off from light, and lacquer stays in them
/// and in patches around the ball.
fn wear_at(dimples: &[DVec3], at: DVec2) -> DVec3 {
    let [.., out] = frame(at);
    let (_, distance) = nearest(dimples, out);
    let depth = (1.0 - distance * distance).max(0.0);
    let patches = libm::sin(3.0 * out.x + 4.0 * out.y + 1.0)
        + libm::sin(5.0 * out.z - 3.0 * out.y)
        + libm::sin(7.0 * out.x - 6.0 * out.z + 2.0);
    // 0: bare metal, 1: lacquer.
    let lacquer = (0.5 + 1.6 * (0.35 * patches + depth - 0.45)).clamp(0.0, 1.0);
    DVec3::new(1.0 - 0.45 * depth, 0.22 + 0.4 * lacquer, 1.0 - lacquer)
}
