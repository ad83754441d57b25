//! Promise: at the ends of every parameter and of what the rasterizer hands on, built-in effects
//! make numbers of numbers, in f64 and f32, and no division, logarithm, root or power of theirs
//! meets the edge beyond which adapters differ. Needs no adapter.

use std::{fmt::Debug, sync::Arc};

use glam::{DVec2, DVec3};
use rasterlab::{
    effect_files::evaluated_in,
    effects::{
        EFFECTS, Effect,
        hooks::{Finish, Hooks, Picture, Pixel, Surface, Vertex},
    },
    evaluator::Precision,
    params::ValueType,
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

use super::effect_inputs::{direction, whole};

/// Inputs of each effect.
const TRIES: usize = 6000;
/// Of the picture whose pixels are finished.
const SIDE: u32 = 8;

fn one_of<T: Copy>(rng: &mut Rng, all: &[T]) -> T {
    all[whole(rng, all.len() as u32) as usize]
}

/// Each parameter at its default or at an end of what is taken or of its slider.
fn parameters(rng: &mut Rng, effect: &Effect) -> Vec<u32> {
    let mut words = effect.defaults.clone();
    for field in &effect.fields {
        let is_choice = |choices: u32, rng: &mut Rng| vec![f64::from(whole(rng, choices))];
        let components: Vec<f64> = match &field.value_type {
            ValueType::Choice(choices) => is_choice(choices.len() as u32, rng),
            kind => {
                let ends = [field.hard, field.soft].concat();
                (0..kind.components()).map(|_| one_of(rng, &ends)).collect()
            }
        };
        // Some combinations are refused, as a direction of length zero is.
        if whole(rng, 3) > 0 {
            let _ = field.set(&mut words, &components);
        }
    }
    words
}

/// Unit vectors that lie along axes and along each other, or anywhere.
fn unit(rng: &mut Rng, others: &[DVec3]) -> DVec3 {
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let all = [&axes[..], &[direction(rng)], others].concat();
    one_of(rng, &all).as_vec3().as_dvec3()
}

fn vector(rng: &mut Rng, ends: &[f64]) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| one_of(rng, ends)))
}

const PLACES: [f64; 5] = [0.0, -1.0, 1.0, 1e6, -1e6];
const COLORS: [f64; 5] = [0.0, 1e-6, 0.5, 1.0, 1e4];
const PARTS: [f64; 3] = [0.0, 0.5, 1.0];

fn surface(rng: &mut Rng) -> Surface {
    let normal = unit(rng, &[]);
    let across = normal.any_orthonormal_vector();
    let barycentrics = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::new(0.5, 0.5, 0.0),
        DVec3::ONE / 3.0,
    ];
    let depth_m = one_of(rng, &[1e-3, 1.0, 1e6]);
    Surface {
        color: vector(rng, &COLORS).extend(one_of(rng, &PARTS)),
        glow: vector(rng, &COLORS),
        position: vector(rng, &PLACES),
        normal,
        flat_normal: unit(rng, &[normal, across]),
        view: unit(rng, &[normal, -normal, across]),
        center: vector(rng, &PLACES),
        center_screen: vector(rng, &[-1e4, 0.0, 0.5, 1.0, 1e4]).truncate(),
        screen: vector(rng, &PARTS).truncate(),
        pixel: vector(rng, &[0.5, 8191.5]).truncate(),
        barycentrics: one_of(rng, &barycentrics),
        edge_distance_px: vector(rng, &[0.0, 0.5, 1e5]),
        depth_m,
        pixel_size_m: one_of(rng, &[1e-7, 0.01, 1e3]),
        flat_depth_m: one_of(rng, &[1e-3, depth_m, 1e6]),
        depth_range_m: one_of(rng, &[[depth_m, depth_m], [1e-3, 1e6], [1.0, 1.0]]).into(),
        triangle_id: one_of(rng, &[0, 1, u32::MAX - 1]),
        rank: one_of(rng, &PARTS),
        lit: one_of(rng, &PARTS),
        finish: Finish {
            specular: vector(rng, &PARTS).extend(one_of(rng, &PARTS)),
            metallic: one_of(rng, &PARTS),
            roughness: one_of(rng, &PARTS),
            occlusion: one_of(rng, &PARTS),
        },
        passed: DVec3::ZERO,
        step_offset: 0.0,
    }
}

fn vertex(rng: &mut Rng) -> Vertex {
    let [position, center] = [0; 2].map(|_| vector(rng, &PLACES));
    let anywhere = direction(rng).as_vec3().as_dvec3();
    let normal = one_of(rng, &[DVec3::ZERO, anywhere]);
    Vertex {
        position,
        offset: vector(rng, &[0.0, 1e-3, -10.0]),
        normal,
        flat_normal: one_of(rng, &[DVec3::ZERO, normal]),
        center,
        arm: one_of(rng, &[DVec3::ZERO, position - center]),
        center_screen: one_of(rng, &[DVec2::ZERO, DVec2::splat(0.5), DVec2::splat(1e4)]),
        triangle: one_of(rng, &[0, u32::MAX - 1]),
        cell_px: 0,
    }
}

fn pixel(rng: &mut Rng) -> Pixel {
    Pixel {
        color: vector(rng, &PARTS).extend(one_of(rng, &PARTS)),
        x: whole(rng, SIDE),
        y: whole(rng, SIDE),
        step_offset: 0.0,
    }
}

/// Calls the function with every input, and says which effect made what is not finite of what.
fn hold<T: Copy + Debug>(
    effect: &Arc<Effect>,
    make: fn(&mut Rng) -> T,
    function: &dyn Fn(&mut [T], &[u32]),
    floats: fn(&T) -> Vec<f64>,
    faults: &mut Vec<String>,
) {
    let mut rng = Rng(29);
    for _ in 0..TRIES {
        let (words, given) = (parameters(&mut rng, effect), make(&mut rng));
        let mut all = [given];
        function(&mut all, &words);
        if !floats(&all[0]).iter().all(|value| value.is_finite()) {
            let values = effect
                .fields
                .iter()
                .map(|field| (&field.name, field.get(&words)));
            let values: Vec<_> = values.collect();
            faults.push(format!(
                "{}: {given:?} with {values:?} becomes {:?}",
                effect.name, all[0]
            ));
            return;
        }
    }
}

#[test]
fn effects_make_numbers_of_numbers_at_every_end() {
    let mut rng = Rng(31);
    let keys: Vec<u32> = (0..SIDE * SIDE)
        .map(|_| one_of(&mut rng, &[0, 1, 1 << 30, u32::MAX]))
        .collect();
    let triangle_ids: Vec<u32> = keys
        .iter()
        .map(|key| if *key == 0 { u32::MAX } else { key & 3 })
        .collect();
    let picture = Picture {
        width: SIDE,
        height: SIDE,
        triangle_ids: &triangle_ids,
        keys: &keys,
        draws: &[0, 2],
        previous: None,
        background: &[[0, 128, 255, 255]; SIDE as usize],
    };
    let mut faults = Vec::new();
    let mut held = 0;
    for effect in EFFECTS.iter() {
        for precision in [Precision::Double, Precision::Strict] {
            let hooks: Hooks = evaluated_in(&Library::Embedded, effect, precision)
                .unwrap_or_else(|error| panic!("{}: {error}", effect.name));
            if let Some(shade) = &hooks.surface {
                held += 1;
                hold(effect, surface, &**shade, of_surface, &mut faults);
            }
            if let Some(hook) = &hooks.image {
                held += 1;
                let finish = |all: &mut [Pixel], words: &[u32]| (hook.finish)(all, &picture, words);
                hold(
                    effect,
                    pixel,
                    &finish,
                    |q| q.color.to_array().into(),
                    &mut faults,
                );
            }
            if let Some(hook) = &hooks.vertex {
                held += 1;
                hold(effect, vertex, &*hook.moved, of_vertex, &mut faults);
            }
        }
    }
    assert!(held > 30, "{held}");
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

fn of_surface(s: &Surface) -> Vec<f64> {
    let vectors = [s.glow, s.position, s.normal, s.flat_normal].map(|v| v.to_array());
    [&s.color.to_array()[..], vectors.as_flattened()].concat()
}

fn of_vertex(v: &Vertex) -> Vec<f64> {
    [v.position, v.offset, v.normal]
        .map(|v| v.to_array())
        .as_flattened()
        .to_vec()
}
