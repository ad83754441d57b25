//! Promise: any preset survives a round trip through its text to the bit.

use std::sync::Arc;

use rasterlab::{
    effects::{EFFECTS, Effect, Stack},
    params::ValueType,
    preset::{
        AccuracyRequest, Animation, Bookmark, ClipPlayback, Clock, GoldenTest, LengthUnit, Output,
        PinnedOptions, Preset, SceneSource, Tier, Visibility,
        animation::{Easing, Keyframe, Track, steps},
    },
    preset_file::{self, PresetFile},
    scene::{
        Ground, GroundShape,
        camera::{Camera, MIN_NEAR_M, Projection},
        parts::{Scope, ShownParts},
        up::UpAxis,
    },
};
use rasterlab_fuzz::stress::{
    random,
    scenes::{Rng, for_seeds},
};

use super::*;

/// Any value that a key of this range may have, with a taste for its ends.
fn within(rng: &mut Rng, low: f64, high: f64) -> f64 {
    match rng.between(0, 5) {
        0 => low,
        1 => high,
        2 => 0.0f64.clamp(low, high),
        3 => (-0.0f64).max(low),
        _ => rng.real(low, high),
    }
}

fn vector(rng: &mut Rng) -> [f64; 3] {
    [0; 3].map(|_| within(rng, -1e9, 1e9))
}

fn color(rng: &mut Rng) -> [f32; 4] {
    [0; 4].map(|_| within(rng, 0.0, 1.0) as f32)
}

fn coin(rng: &mut Rng) -> bool {
    rng.between(0, 2) == 0
}

fn index(rng: &mut Rng, length: usize) -> usize {
    rng.between(0, length as i32) as usize
}

/// Text of at most so many characters, none of which controls: half of them ASCII.
fn text(rng: &mut Rng, most: i32) -> String {
    let length = rng.between(0, most + 1);
    let mut one = || match coin(rng) {
        true => rng.between(0x20, 0x7f),
        false => rng.between(0xa0, 0x11_0000),
    };
    (0..length)
        .filter_map(|_| char::from_u32(one().cast_unsigned()))
        .collect()
}

/// Fills every field with values drawn from its hard range.
fn filled(effect: &Arc<Effect>, mut state: u32) -> Vec<u32> {
    let mut words = effect.defaults.clone();
    for field in &effect.fields {
        let lanes: Vec<f64> = (0..field.value_type.components())
            .map(|_| {
                state = rasterlab::math::hash(state.wrapping_add(0x9e37_79b9));
                let [low, high] = field.hard;
                let value = low + (high - low) * f64::from(state) / f64::from(u32::MAX);
                match field.value_type {
                    ValueType::F32 | ValueType::Color | ValueType::Point
                        if state.is_multiple_of(7) && (low..=high).contains(&-0.0) =>
                    {
                        -0.0
                    }
                    ValueType::F32 | ValueType::Color | ValueType::Point => {
                        f64::from(value as f32).clamp(low, high)
                    }
                    _ => value.round(),
                }
            })
            .collect();
        field.set(&mut words, &lanes).unwrap();
    }
    words
}

fn any_camera(rng: &mut Rng) -> Camera {
    Camera {
        eye: vector(rng).into(),
        target: vector(rng).into(),
        up: vector(rng).into(),
        projection: if coin(rng) {
            Projection::Orthographic {
                height_m: within(rng, 1e-6, 1e9),
            }
        } else {
            Projection::Perspective {
                fov_y_deg: within(rng, 1.0, 179.0),
            }
        },
        near_m: within(rng, MIN_NEAR_M, 1e6),
    }
}

/// Keys on parameters of the enabled effects.
fn animated(rng: &mut Rng, stack: &Stack) -> Animation {
    let mut animation = Animation::default();
    for _ in 0..rng.between(0, 5).min(5 * stack.0.len() as i32) {
        let effect = &stack.0[index(rng, stack.0.len())].effect;
        if effect.fields.is_empty() {
            continue;
        }
        let field = &effect.fields[index(rng, effect.fields.len())];
        let mut frames: Vec<Keyframe> = Vec::new();
        for _ in 0..rng.between(1, 6) {
            let (time_s, words) = (within(rng, -1e9, 1e9), filled(effect, rng.next_u32()));
            let easing = if steps(field) {
                Easing::Hold
            } else {
                Easing::ALL[index(rng, Easing::ALL.len())]
            };
            if !frames.iter().any(|frame| frame.time_s == time_s) {
                frames.push(Keyframe {
                    time_s,
                    value: field.get(&words),
                    easing,
                });
            }
        }
        animation.put(Track::new(effect, field, frames).expect("sound keys"));
    }
    animation
}

fn any_playback(rng: &mut Rng) -> ClipPlayback {
    ClipPlayback {
        clip: text(rng, 20),
        speed: within(rng, -100.0, 100.0),
        clip_time_s: coin(rng).then(|| within(rng, 0.0, 1e9)),
        second_clip: text(rng, 20),
        blend: within(rng, 0.0, 1.0),
    }
}

fn any_ground(rng: &mut Rng) -> Ground {
    let shapes = [GroundShape::Square, GroundShape::Disc];
    Ground {
        shape: shapes[index(rng, 2)],
        size: within(rng, 0.1, 1000.0),
        color: color(rng),
        cells: rng.between(1, 129).cast_unsigned(),
    }
}

pub fn any_preset(rng: &mut Rng) -> Preset {
    let mut stack = Stack::default();
    for _ in 0..rng.between(0, 6) {
        let effect = &EFFECTS[index(rng, EFFECTS.len())];
        // A preset has no two effects in one slot.
        if stack.conflict_with(effect).is_none() {
            stack.enable(effect).words = filled(effect, rng.next_u32());
        }
    }
    let patterns: Vec<String> = (0..rng.between(0, 4))
        .map(|_| {
            let kind = ["material", "node", "mesh"][index(rng, 3)];
            format!("{kind}:{}?", text(rng, 19))
        })
        .collect();
    let scope = |from: usize| {
        let patterns = patterns.iter().skip(from);
        Scope::new(patterns.map(|pattern| pattern.parse().expect("a pattern")))
    };
    for (at, enabled) in stack.0.iter_mut().enumerate() {
        if enabled.effect.has_scope() {
            enabled.on = scope(at);
        }
    }
    if coin(rng) {
        stack.0.reverse();
    }
    let scenes = [
        SceneSource::Builtin("knot?tess=8".into()),
        SceneSource::File("a b/fox.glb".into()),
        Preset::default().scene,
    ];
    let camera = coin(rng).then(|| any_camera(rng));
    let bookmarks = camera.iter().map(|&camera| Bookmark {
        name: "from \"above\"".into(),
        camera,
    });
    Preset {
        surroundings: ["", "hall.hdr"][index(rng, 2)].into(),
        name: text(rng, 40),
        about: text(rng, 40),
        tags: (0..rng.between(0, 4))
            .map(|_| text(rng, 12) + " \"\\#'")
            .collect(),
        scene: scenes[index(rng, 3)].clone(),
        parts: ShownParts {
            only: scope(2),
            hidden: scope(1),
            up: UpAxis::ALL[index(rng, UpAxis::ALL.len())],
            variant: ["", "night and day"][index(rng, 2)].into(),
        },
        room: [0.0, within(rng, 1.0, 100.0)][index(rng, 2)],
        ground: coin(rng).then(|| any_ground(rng)),
        spin_deg_per_s: within(rng, -1e6, 1e6),
        playback: any_playback(rng),
        polyline: (0..3 * rng.between(0, 2))
            .map(|at| [within(rng, -1e9, 1e9) as f32, -0.0, at as f32])
            .collect(),
        origin: Preset::default().origin,
        unit: [LengthUnit::Meter, LengthUnit::Scene][index(rng, 2)],
        bookmarks: bookmarks.collect(),
        camera,
        scene_camera: ["", "from above"][index(rng, 2)].into(),
        clock: Clock {
            time_s: within(rng, -1e9, 1e9),
            range_s: [within(rng, -1e9, 0.0), within(rng, 1e-3, 1e9)],
            is_looping: coin(rng),
            speed: within(rng, 0.01, 100.0),
        },
        animation: animated(rng, &stack),
        stack,
        accuracy: AccuracyRequest {
            tier: Tier::ALL[index(rng, 4)],
            pins: match index(rng, 4) {
                pinned @ 0..2 => PinnedOptions::of(Visibility::EXACT[pinned]),
                _ => PinnedOptions::default(),
            },
            ..AccuracyRequest::default()
        },
        output: Output {
            size: [0; 2].map(|_| rng.between(0, 16_385).cast_unsigned()),
            background: color(rng),
            background_bottom: coin(rng).then(|| color(rng)),
            reference_height_px: (index(rng, 3) == 0).then_some(240),
        },
        test: coin(rng).then(|| GoldenTest {
            max_channel: rng.next_u32() as u8,
            max_pixels: rng.next_u32(),
            max_wrong_triangles: 0,
            why: format!("because {}", text(rng, 40)),
            ..GoldenTest::default()
        }),
    }
}

fn read_back(text: &str) -> PresetFile {
    preset_file::parse(text, "any").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn a_round_trip_keeps_every_bit() {
    for_seeds(300, |rng| {
        let preset = any_preset(rng);
        let text = preset_file::to_toml(&PresetFile::new("any", preset.clone()));
        let back = read_back(&text);
        assert_eq!(bits(&back.preset), bits(&preset), "{text}");
        assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        assert_eq!(preset_file::to_toml(&back), text);
    });
}

#[test]
fn any_preset_can_be_patched_into_any_other() {
    for_seeds(300, |rng| {
        let before = PresetFile::new("any", any_preset(rng));
        let mut preset_file = parse(&preset_file::to_toml(&before));
        preset_file.preset = any_preset(rng);
        let text = preset_file::to_toml(&preset_file);
        let back = read_back(&text);
        assert_eq!(bits(&back.preset), bits(&preset_file.preset), "{text}");
    });
}

#[test]
fn whatever_the_time_every_value_stays_inside_its_hard_range() {
    for_seeds(300, |rng| {
        let preset = any_preset(rng);
        let time_s = rng.real(-1.0, 1.0) * 10f64.powi(rng.between(-300, 300));
        for enabled in preset.stack_at(time_s).0 {
            for field in &enabled.effect.fields {
                let [low, high] = field.hard.map(|bound| bound as f32);
                let lanes = field.get(&enabled.words);
                let is_float = matches!(
                    field.value_type,
                    ValueType::F32 | ValueType::Color | ValueType::Point
                );
                let inside = |lane: &f64| !is_float || (low..=high).contains(&(*lane as f32));
                let name = (&enabled.effect.name, &field.name);
                assert!(lanes.iter().all(inside), "{name:?} {lanes:?} at {time_s}");
            }
        }
    });
}

#[test]
fn a_parameter_survives_whatever_its_bits() {
    for_seeds(300, |rng| {
        let value = f32::from_bits(rng.next_u32());
        let value = if value.is_finite() { value } else { 1.0 };
        let written = format!("schema = 2\n[effects.facet]\namount = {value:?}\n");
        match preset_file::parse(&written, "any") {
            Ok(read) => {
                let facet = read.preset.stack.get("facet").expect("it is enabled");
                let field = facet.effect.field("amount").expect("a parameter");
                let [kept, written] = [field.get(&facet.words)[0], f64::from(value)];
                assert_eq!(kept.to_bits(), written.to_bits());
            }
            Err(error) => assert!(!(0.0..=1.0).contains(&value), "{error}"),
        }
    });
}

#[test]
fn every_random_preset_is_one_that_a_file_may_hold() {
    for seed in 0..60 {
        let random = PresetFile::new("random", random::preset(seed));
        let text = preset_file::to_toml(&random);
        let read = preset_file::parse(&text, "random")
            .unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        assert_eq!(read.preset, random.preset, "seed {seed}\n{text}");
        assert!(read.warnings.is_empty(), "seed {seed}: {:?}", read.warnings);
    }
}
