//! Promise: the WGSL of every built-in effect, evaluated in f64, says what its function in Rust
//! says: integers and booleans exactly, floats within 1e-9, over random inputs and parameters.
//! Needs no adapter.

use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3};
use rasterlab::{
    effect_files::{duplicate, evaluated, read},
    effects::{
        EFFECTS, Effect,
        hooks::{
            Finish, Hooks, Image, ImageAt, Lens, PassInput, Picture, Pixel, Sample, Signs, Surface,
            SurfaceFunction, TriangleSetup, Vertex,
        },
    },
    params::ValueType,
    scene::{Bounds, camera::Camera, view::View},
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

/// Largest difference, relative to the largest component, or to 1.
const TOLERANCE: f64 = 1e-9;

/// Effects whose text and function are meant to differ by more, and why.
const LOOSER: &[(&str, f64, &str)] = &[
    (
        "explode",
        1e-7,
        "lib/angle has a polynomial for the sine, within 3.4e-9 of it, which is multiplied by the arm",
    ),
    (
        "wobble",
        1e-6,
        "lib/angle has a polynomial for the sine, within 3.4e-9 of it, which is multiplied by the slope",
    ),
    (
        "studio",
        1e-6,
        "lib/angle has a polynomial for the sine, within 3.4e-9 of it, which turns a lamp as narrow as a tenth of a radian",
    ),
    (
        "hatch",
        5e-6,
        "lib/angle has a series for the direction, within 2^-24 of it, which is multiplied by the position in spacings",
    ),
    (
        "halftone",
        1e-5,
        "lib/angle has a series for the direction and a polynomial for the cosine, which are multiplied by the position in cells",
    ),
    (
        "crt",
        1e-6,
        "lib/angle has a polynomial for the cosine, within 3.4e-9 of it",
    ),
];

/// Random inputs of each effect.
const TRIES: usize = 3000;

fn tolerance(effect: &Effect) -> f64 {
    LOOSER
        .iter()
        .find(|(name, ..)| *name == effect.name)
        .map_or(TOLERANCE, |(_, bound, _)| *bound)
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    f64::from((low + (high - low) * rng.real(0.0, 1.0)) as f32)
}

fn whole(rng: &mut Rng, below: u32) -> u32 {
    (rng.real(0.0, 1.0) * f64::from(below)) as u32
}

fn vector(rng: &mut Rng, low: f64, high: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| between(rng, low, high)))
}

fn direction(rng: &mut Rng) -> DVec3 {
    vector(rng, -1.0, 1.0).try_normalize().unwrap_or(DVec3::Y)
}

/// Defaults, then ends of ranges, then anything between.
fn parameters(rng: &mut Rng, effect: &Effect, turn: usize) -> Vec<u32> {
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
        field
            .set(&mut words, &components)
            .unwrap_or_else(|error| panic!("{}.{}: {error}", effect.name, field.name));
    }
    words
}

/// Without anything special about it.
pub fn plain_surface() -> Surface {
    surface(&mut Rng(1))
}

fn surface(rng: &mut Rng) -> Surface {
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

/// Both sides' floats, all of them within the effect's tolerance.
fn same(effect: &Effect, what: &str, given: &[f64], expected: &[f64], case: &dyn std::fmt::Debug) {
    let scale = expected
        .iter()
        .fold(1.0, |scale: f64, value| scale.max(value.abs()));
    for (given, expected) in given.iter().zip(expected) {
        let is_same = (given - expected).abs() <= tolerance(effect) * scale
            || given.is_nan() && expected.is_nan()
            || given == expected;
        assert!(
            is_same,
            "{}: {what}: WGSL {given}, Rust {expected}, {:e} apart\n{case:?}",
            effect.name,
            (given - expected).abs()
        );
    }
}

/// Runs every effect that has the hook, and gathers what fails.
fn each_effect(
    has: impl Fn(&Hooks) -> bool,
    compare: impl Fn(&Arc<Effect>, &Hooks) + std::panic::RefUnwindSafe,
) {
    let mut faults = Vec::new();
    let mut compared = 0;
    for effect in EFFECTS.iter().filter(|&effect| has(&effect.hooks)).cloned() {
        let hooks = evaluated(&Library::Embedded, &effect)
            .unwrap_or_else(|error| panic!("{}: {error}", effect.name));
        let run = std::panic::AssertUnwindSafe(|| compare(&effect, &hooks));
        if let Err(panic) = std::panic::catch_unwind(run) {
            faults.push(panic.downcast_ref::<String>().cloned().unwrap_or_default());
        }
        compared += 1;
    }
    assert!(compared > 2);
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

#[test]
fn surface_functions_agree() {
    each_effect(
        |hooks| hooks.surface.is_some(),
        |effect, hooks| {
            let mut rng = Rng(11);
            for turn in 0..TRIES {
                let (words, s) = (parameters(&mut rng, effect, turn), surface(&mut rng));
                let of = |hooks: &Hooks| {
                    let mut all = [s];
                    hooks.surface.as_ref().expect("it is on the hook")(&mut all, &words);
                    all[0]
                };
                let (given, expected) = (of(hooks), of(&effect.hooks));
                let floats = |s: &Surface| {
                    let vectors = [
                        s.glow,
                        s.position,
                        s.normal,
                        s.flat_normal,
                        s.view,
                        s.center,
                        s.barycentrics,
                        s.edge_distance_px,
                    ];
                    let mut all = s.color.to_array().to_vec();
                    all.extend(vectors.iter().flat_map(|v| v.to_array()));
                    all.extend(
                        [s.center_screen, s.screen, s.depth_range_m]
                            .iter()
                            .flat_map(|v| v.to_array()),
                    );
                    all.extend([s.depth_m, s.pixel_size_m, s.flat_depth_m, s.rank, s.lit]);
                    all.extend(s.finish.specular.to_array());
                    all.extend([s.finish.metallic, s.finish.roughness, s.finish.occlusion]);
                    all
                };
                same(
                    effect,
                    "surface",
                    &floats(&given),
                    &floats(&expected),
                    &(words, s),
                );
                assert_eq!(given.triangle_id, expected.triangle_id, "{}", effect.name);
            }
        },
    );
}

#[test]
fn vertex_functions_agree() {
    each_effect(
        |hooks| hooks.vertex.is_some(),
        |effect, hooks| {
            let mut rng = Rng(12);
            for turn in 0..TRIES {
                let words = parameters(&mut rng, effect, turn);
                let center = vector(&mut rng, -3.0, 3.0);
                let arm = vector(&mut rng, -1.0, 1.0);
                let v = Vertex {
                    position: center + arm,
                    offset: if turn % 2 == 0 {
                        DVec3::ZERO
                    } else {
                        vector(&mut rng, -1.0, 1.0)
                    },
                    normal: if turn % 7 == 0 {
                        DVec3::ZERO
                    } else {
                        direction(&mut rng)
                    },
                    flat_normal: direction(&mut rng),
                    center,
                    arm,
                    center_screen: vector(&mut rng, 0.0, 1.0).truncate(),
                    triangle: whole(&mut rng, 1 << 20),
                    cell_px: whole(&mut rng, 3),
                };
                let of = |hooks: &Hooks| {
                    let mut all = [v];
                    (hooks.vertex.as_ref().expect("it is on the hook").moved)(&mut all, &words);
                    all[0]
                };
                let (given, expected) = (of(hooks), of(&effect.hooks));
                same(
                    effect,
                    "offset",
                    &given.offset.to_array(),
                    &expected.offset.to_array(),
                    &(&words, v),
                );
                same(
                    effect,
                    "normal",
                    &given.normal.to_array(),
                    &expected.normal.to_array(),
                    &(&words, v),
                );
                assert_eq!(given.cell_px, expected.cell_px, "{}", effect.name);
            }
        },
    );
}

#[test]
fn sample_functions_agree() {
    each_effect(
        |hooks| hooks.sample.is_some(),
        |effect, hooks| {
            let mut rng = Rng(13);
            let mut drawn = [0, 0];
            for turn in 0..TRIES {
                let words = parameters(&mut rng, effect, turn);
                let reach = if turn % 5 == 0 { 40_000.0 } else { 6_000.0 };
                let corner = |rng: &mut Rng| {
                    [
                        between(rng, -500.0, reach) as i32,
                        between(rng, -500.0, reach) as i32,
                    ]
                };
                let setup = TriangleSetup {
                    triangle: whole(&mut rng, 1 << 20),
                    corners: std::array::from_fn(|_| corner(&mut rng)),
                    outline: whole(&mut rng, 8),
                    size: [1 + whole(&mut rng, 200), 1 + whole(&mut rng, 200)],
                    center: vector(&mut rng, -3.0, 3.0),
                    center_error_m: 0.0,
                    center_screen: vector(&mut rng, 0.0, 1.0).truncate(),
                };
                let of = |hooks: &Hooks| {
                    let hook = hooks.sample.as_ref().expect("it is on the hook");
                    if hook.has_setup {
                        (hook.sample_setup)(&setup, &words, None)
                    } else {
                        [0; 4]
                    }
                };
                let (given, expected) = (of(hooks), of(&effect.hooks));
                assert_eq!(
                    given, expected,
                    "{}: setup of {setup:?} with {words:?}",
                    effect.name
                );
                for _ in 0..4 {
                    let areas = std::array::from_fn(|_| whole(&mut rng, 1 << 29));
                    let (x, y) = (whole(&mut rng, 200), whole(&mut rng, 200));
                    let sample = Sample {
                        x,
                        y,
                        triangle: setup.triangle,
                        areas,
                        setup: expected,
                    };
                    let of = |hooks: &Hooks| {
                        let mut drawn = [true];
                        (hooks.sample.as_ref().expect("it is on the hook").is_drawn)(
                            &[sample],
                            &words,
                            &mut drawn,
                        );
                        drawn[0]
                    };
                    let (given, expected) = (of(hooks), of(&effect.hooks));
                    assert_eq!(
                        given, expected,
                        "{}: {sample:?} with {words:?}",
                        effect.name
                    );
                    drawn[usize::from(expected)] += 1;
                }
            }
            assert!(
                drawn[0] > 100 && drawn[1] > 100,
                "{}: {drawn:?}",
                effect.name
            );
        },
    );
}

#[test]
fn image_functions_agree() {
    each_effect(
        |hooks| hooks.image.is_some(),
        |effect, hooks| {
            let mut rng = Rng(14);
            let (width, height) = (12_u32, 9_u32);
            let pixels = (width * height) as usize;
            for turn in 0..TRIES / 20 {
                let words = parameters(&mut rng, effect, turn);
                let triangle_ids: Vec<u32> = (0..pixels)
                    .map(|_| {
                        if rng.real(0.0, 1.0) < 0.4 {
                            u32::MAX
                        } else {
                            whole(&mut rng, 60)
                        }
                    })
                    .collect();
                let key = |id: &u32, rng: &mut Rng| {
                    if *id == u32::MAX {
                        0
                    } else {
                        1 + whole(rng, 0x3f80_0000)
                    }
                };
                let keys: Vec<u32> = triangle_ids.iter().map(|id| key(id, &mut rng)).collect();
                let previous: Vec<[u8; 4]> = (0..pixels)
                    .map(|_| std::array::from_fn(|_| whole(&mut rng, 256) as u8))
                    .collect();
                let background: Vec<[u8; 4]> = (0..height)
                    .map(|y| [3 + 9 * y as u8, 77, 200 - 7 * y as u8, 255])
                    .collect();
                let picture = Picture {
                    width,
                    height,
                    triangle_ids: &triangle_ids,
                    keys: &keys,
                    draws: &[0, 20, 40],
                    previous: (turn % 3 != 0).then_some(&previous),
                    background: &background,
                };
                for index in 0..width * height {
                    let color = if rng.real(0.0, 1.0) < 0.2 {
                        picture.background(index / width)
                    } else {
                        vector(&mut rng, 0.0, 1.0).extend(1.0)
                    };
                    let q = Pixel {
                        color,
                        x: index % width,
                        y: index / width,
                        step_offset: 0.0,
                    };
                    let of = |hooks: &Hooks| {
                        let mut all = [q];
                        (hooks.image.as_ref().expect("it is on the hook").finish)(
                            &mut all, &picture, &words,
                        );
                        all[0]
                    };
                    let (given, expected) = (of(hooks), of(&effect.hooks));
                    same(
                        effect,
                        "color",
                        &given.color.to_array(),
                        &expected.color.to_array(),
                        &(&words, q),
                    );
                    assert_eq!(
                        (given.x, given.y),
                        (expected.x, expected.y),
                        "{}",
                        effect.name
                    );
                }
            }
        },
    );
}

#[test]
fn image_passes_agree() {
    each_effect(
        |hooks| hooks.passes.is_some(),
        |effect, hooks| {
            let mut rng = Rng(15);
            let size = [9_u32, 7];
            let pixels = (size[0] * size[1]) as usize;
            let bounds = Bounds {
                min: DVec3::splat(-1.0),
                max: DVec3::ONE,
            };
            let (camera, background) = (Camera::default(), [0.0; 4]);
            let lens = Lens::of(&View::new(
                &camera,
                size[0],
                size[1],
                &bounds,
                DMat4::IDENTITY,
                background,
            ));
            for turn in 0..TRIES / 1000 {
                let words = parameters(&mut rng, effect, turn);
                let triangle_ids: Vec<u32> = (0..pixels)
                    .map(|i| {
                        if i % 7 < 2 {
                            u32::MAX
                        } else {
                            whole(&mut rng, 60)
                        }
                    })
                    .collect();
                let keys: Vec<u32> = triangle_ids
                    .iter()
                    .map(|&id| match id {
                        u32::MAX => 0,
                        _ => (0.05 + 0.01 * rng.real(0.0, 1.0) as f32).to_bits(),
                    })
                    .collect();
                let picture = Picture {
                    width: size[0],
                    height: size[1],
                    triangle_ids: &triangle_ids,
                    keys: &keys,
                    draws: &[0, 20, 40],
                    previous: None,
                    background: &[],
                };
                let mut image = |size: [u32; 2]| Image {
                    size,
                    colors: (0..size[0] * size[1])
                        .map(|_| vector(&mut rng, 0.0, 1.0).extend(1.0))
                        .collect(),
                };
                let passes = &hooks.passes.as_ref().expect("it has passes").passes;
                let source = image(size);
                let mut last = source.clone();
                for (index, pass) in passes.iter().enumerate() {
                    let input = PassInput {
                        picture: &picture,
                        lens,
                        source: &source,
                        last: &last,
                        kept: None,
                        signs: Signs::None,
                        panorama: None,
                    };
                    let size = pass.size(size);
                    for i in 0..size[0] * size[1] {
                        let at = ImageAt {
                            x: i64::from(i % size[0]),
                            y: i64::from(i / size[0]),
                            size,
                            scale: pass.scale,
                            step_offset: 0.0,
                            input: &input,
                        };
                        let of = |hooks: &Hooks| {
                            let hook = hooks.passes.as_ref().expect("it has passes");
                            (hook.run)(index, &[at], &words)[0].to_array()
                        };
                        let (given, expected) = (of(hooks), of(&effect.hooks));
                        same(effect, &pass.name, &given, &expected, &(&words, i));
                    }
                    last = image(size);
                }
            }
        },
    );
}

#[test]
fn a_duplicate_of_an_effect_is_read_and_says_the_same() {
    let (mut duplicates, mut refusals) = (0, Vec::new());
    for effect in EFFECTS.iter().cloned() {
        let text = match duplicate(&effect, "my_own") {
            Ok(text) => text,
            Err(reason) => {
                refusals.push(format!("{} {reason}", effect.name));
                continue;
            }
        };
        let mine = read("my_own.wgsl", "my_own", &text)
            .unwrap_or_else(|error| panic!("{}: {error}\n{text}", effect.name));
        duplicates += 1;
        assert_eq!(mine.fields.len(), effect.fields.len(), "{}", effect.name);
        let (Some(expected), Some(given)) = (&effect.hooks.surface, &mine.hooks.surface) else {
            continue;
        };
        let mut rng = Rng(7);
        for turn in 0..300 {
            let words = parameters(&mut rng, &effect, turn);
            let mut own_words = mine.defaults.clone();
            for field in &mine.fields {
                let same = effect
                    .field(&field.name)
                    .unwrap_or_else(|| panic!("{}.{}", effect.name, field.name));
                field
                    .set(&mut own_words, &same.get(&words))
                    .unwrap_or_else(|error| panic!("{}.{}: {error}", effect.name, field.name));
            }
            if turn == 0 {
                assert_eq!(own_words, mine.defaults, "{}: the defaults", effect.name);
            }
            let input = surface(&mut rng);
            let of = |function: &SurfaceFunction, words: &[u32]| {
                let mut all = [input];
                function(&mut all, words);
                all[0]
            };
            let [given, expected] = [of(&**given, &own_words), of(&**expected, &words)];
            same(
                &effect,
                "color",
                &given.color.to_array(),
                &expected.color.to_array(),
                &input,
            );
            same(
                &effect,
                "normal",
                &given.normal.to_array(),
                &expected.normal.to_array(),
                &input,
            );
        }
    }
    assert!(duplicates >= 12, "{duplicates} duplicates; {refusals:#?}");
}
