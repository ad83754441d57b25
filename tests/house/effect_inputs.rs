//! Random inputs of effects: numbers, parameters and surfaces.

use glam::{DVec2, DVec3};
use rasterlab::{
    effects::{
        Effect,
        hooks::{Finish, Surface},
    },
    params::ValueType,
};
use rasterlab_fuzz::stress::scenes::Rng;

pub fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    f64::from((low + (high - low) * rng.real(0.0, 1.0)) as f32)
}

pub fn whole(rng: &mut Rng, below: u32) -> u32 {
    (rng.real(0.0, 1.0) * f64::from(below)) as u32
}

pub fn vector(rng: &mut Rng, low: f64, high: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| between(rng, low, high)))
}

pub fn direction(rng: &mut Rng) -> DVec3 {
    vector(rng, -1.0, 1.0).try_normalize().unwrap_or(DVec3::Y)
}

/// Defaults, then ends of ranges, then anything between.
pub fn parameters(rng: &mut Rng, effect: &Effect, turn: usize) -> Vec<u32> {
    let mut words = effect.defaults.clone();
    for field in &effect.fields {
        if turn == 0 || rng.real(0.0, 1.0) < 0.3 {
            continue;
        }
        let [low, high] = field.soft;
        let mut number = || match (rng.real(0.0, 1.0) * 8.0) as u32 {
            0 => low,
            1 => high,
            _ => between(rng, low, high),
        };
        let mut components: Vec<f64> = (0..field.value_type.components())
            .map(|_| number())
            .collect();
        if !field.value_type.is_continuous() {
            components
                .iter_mut()
                .for_each(|number| *number = number.round());
        }
        if let ValueType::Choice(choices) = &field.value_type {
            components = vec![f64::from(whole(rng, choices.len() as u32))];
        }
        let set = field.set(&mut words, &components);
        set.unwrap_or_else(|error| panic!("{}.{}: {error}", effect.name, field.name));
    }
    words
}

pub fn surface(rng: &mut Rng) -> Surface {
    let barycentrics = vector(rng, 0.0, 1.0);
    let nearest = between(rng, 0.1, 5.0);
    Surface {
        color: vector(rng, 0.0, 1.5).extend(1.0),
        glow: vector(rng, 0.0, 0.5),
        position: vector(rng, -3.0, 3.0),
        normal: direction(rng),
        flat_normal: direction(rng),
        view: direction(rng),
        center: vector(rng, -3.0, 3.0),
        center_screen: vector(rng, 0.0, 1.0).truncate(),
        screen: vector(rng, 0.0, 1.0).truncate(),
        pixel: vector(rng, 0.0, 2000.0).truncate(),
        barycentrics: barycentrics / barycentrics.element_sum().max(1e-6),
        edge_distance_px: vector(rng, 0.0, 20.0),
        depth_m: between(rng, nearest, nearest + 20.0),
        pixel_size_m: between(rng, 1e-4, 1e-2),
        flat_depth_m: between(rng, nearest, nearest + 20.0),
        depth_range_m: DVec2::new(nearest, nearest + between(rng, 0.1, 30.0)),
        triangle_id: whole(rng, 1 << 20),
        rank: rng.real(0.0, 1.0),
        lit: rng.real(0.0, 1.0),
        finish: Finish {
            specular: vector(rng, 0.0, 1.0).extend(rng.real(0.0, 1.0)),
            metallic: rng.real(0.0, 1.0),
            roughness: rng.real(0.0, 1.0),
            occlusion: rng.real(0.0, 1.0),
        },
        passed: DVec3::ZERO,
        step_offset: 0.0,
    }
}
