//! Promise: any preset survives a round trip through its text to the bit.

use std::sync::Arc;

use proptest::prelude::*;
use rasterlab::{
    effects::{EFFECTS, Effect},
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
    },
};

use super::*;

fn finite_f32() -> impl Strategy<Value = f32> {
    any::<u32>()
        .prop_map(f32::from_bits)
        .prop_filter("finite", |v| v.is_finite())
}

/// Any value that a key of this range may have, with a taste for its ends.
fn within(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(low),
        Just(high),
        low..=high,
        Just(0.0f64.clamp(low, high)),
        Just((-0.0f64).max(low))
    ]
}

fn any_effect() -> impl Strategy<Value = (usize, u64)> {
    (0..EFFECTS.len(), any::<u64>())
}

/// Fills every field with values drawn from its hard range.
fn filled(effect: &Arc<Effect>, seed: u64) -> Vec<u32> {
    let mut words = effect.defaults.clone();
    let mut state = seed as u32;
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

prop_compose! {
    fn any_camera()(
        eye in prop::array::uniform3(within(-1e9, 1e9)),
        target in prop::array::uniform3(within(-1e9, 1e9)),
        up in prop::array::uniform3(within(-1e9, 1e9)),
        fov in prop::option::of(within(1.0, 179.0)),
        height in within(1e-6, 1e9),
        near_m in within(MIN_NEAR_M, 1e6),
    ) -> Camera {
        let projection = fov.map_or(Projection::Orthographic { height_m: height }, |fov_y_deg| Projection::Perspective { fov_y_deg });
        Camera { eye: eye.into(), target: target.into(), up: up.into(), projection, near_m }
    }
}

prop_compose! {
    fn any_clock()(time_s in within(-1e9, 1e9), from in within(-1e9, 0.0), to in within(1e-3, 1e9), is_looping in any::<bool>(), speed in within(0.01, 100.0)) -> Clock {
        Clock { time_s, range_s: [from, to], is_looping, speed }
    }
}

/// Time, seed of the value, easing.
type AnyKeyframe = (f64, u64, usize);

fn any_keyframes() -> impl Strategy<Value = Vec<AnyKeyframe>> {
    prop::collection::vec(
        (within(-1e9, 1e9), any::<u64>(), 0..Easing::ALL.len()),
        1..6,
    )
}

/// Keys on parameters of the enabled effects.
fn animated(
    stack: &rasterlab::effects::Stack,
    tracks: Vec<(prop::sample::Index, prop::sample::Index, Vec<AnyKeyframe>)>,
) -> Animation {
    let mut animation = Animation::default();
    for (effect, field, keys) in tracks.into_iter().filter(|_| !stack.0.is_empty()) {
        let effect = &stack.0[effect.index(stack.0.len())].effect;
        if effect.fields.is_empty() {
            continue;
        }
        let field = &effect.fields[field.index(effect.fields.len())];
        let mut frames: Vec<Keyframe> = Vec::new();
        for (time_s, seed, easing) in keys {
            let easing = if steps(field) {
                Easing::Hold
            } else {
                Easing::ALL[easing]
            };
            if !frames.iter().any(|frame| frame.time_s == time_s) {
                frames.push(Keyframe {
                    time_s,
                    value: field.get(&filled(effect, seed)),
                    easing,
                });
            }
        }
        animation.put(Track::new(effect, field, frames).expect("sound keys"));
    }
    animation
}

prop_compose! {
    fn any_playback()(
        names in prop::array::uniform2("[^\\p{Cc}]{0,20}"),
        speed in within(-100.0, 100.0),
        clip_time_s in prop::option::of(within(0.0, 1e9)),
        blend in within(0.0, 1.0),
    ) -> ClipPlayback {
        let [clip, second_clip] = names;
        ClipPlayback { clip, speed, clip_time_s, second_clip, blend }
    }
}

prop_compose! {
    fn any_ground()(
        is_square in any::<bool>(),
        size in within(0.1, 1000.0),
        color in prop::array::uniform4(0.0..=1.0f32),
        cells in 1..=128u32,
    ) -> Ground {
        Ground { shape: if is_square { GroundShape::Square } else { GroundShape::Disc }, size, color, cells }
    }
}

prop_compose! {
    pub fn any_preset()(
        texts in prop::array::uniform3("[^\\p{Cc}]{0,40}"),
        tags in prop::collection::vec("[a-z \"\\\\#']{0,12}", 0..4),
        scene in prop_oneof![Just(SceneSource::Builtin("knot?tess=8".into())), Just(SceneSource::File("a b/fox.glb".into())), Just(Preset::default().scene)],
        room in prop_oneof![Just(0.0), within(1.0, 100.0)],
        spin_deg_per_s in within(-1e6, 1e6),
        ground in prop::option::of(any_ground()),
        playback in any_playback(),
        camera in prop::option::of(any_camera()),
        clock in any_clock(),
        tracks in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any_keyframes()), 0..5),
        effects in prop::collection::vec(any_effect(), 0..6),
        patterns in prop::collection::vec("(material|node|mesh):[^\\p{Cc}]{1,20}", 0..4),
        reversed in any::<bool>(),
        tier in 0..4usize,
        visibility in prop::option::of(0..2usize),
        size in prop::array::uniform2(0..=16_384u32),
        background in prop::array::uniform4(0.0..=1.0f32),
        background_bottom in prop::option::of(prop::array::uniform4(0.0..=1.0f32)),
        test in prop::option::of((any::<u8>(), any::<u32>())),
    ) -> Preset {
        let [name, about, why] = texts;
        let mut stack = rasterlab::effects::Stack::default();
        for (index, seed) in effects {
            // A preset has no two effects in one slot.
            if stack.conflict_with(&EFFECTS[index]).is_none() {
                stack.enable(&EFFECTS[index]).words = filled(&EFFECTS[index], seed);
            }
        }
        for (index, enabled) in stack.0.iter_mut().enumerate().filter(|(_, enabled)| enabled.effect.has_scope()) {
            enabled.on = Scope::new(patterns.iter().skip(index).map(|pattern| pattern.parse().expect("a pattern")));
        }
        if reversed {
            stack.0.reverse();
        }
        let scope = |from: usize| Scope::new(patterns.iter().skip(from).map(|pattern| pattern.parse().expect("a pattern")));
        let variant = if size[1] % 2 == 0 { "night and day".into() } else { String::new() };
        let parts = ShownParts { only: scope(2), hidden: scope(1), variant };
        Preset {
            surroundings: if reversed { "hall.hdr".into() } else { String::new() },
            name, about, tags, scene, parts, room, ground, spin_deg_per_s, playback, camera,
            polyline: if reversed { [[background[0], -background[1], 1.0], [1e9, background[2], 1e-9], [0.0; 3]].into() } else { [].into() },
            unit: if size[0] % 2 == 0 { LengthUnit::Meter } else { LengthUnit::Scene },
            bookmarks: camera.iter().map(|&camera| Bookmark { name: "from \"above\"".into(), camera }).collect(),
            scene_camera: if reversed { "from above".into() } else { String::new() },
            clock,
            animation: animated(&stack, tracks),
            stack,
            accuracy: AccuracyRequest { tier: Tier::ALL[tier], pins: visibility.map_or(PinnedOptions::default(), |i| PinnedOptions::of(Visibility::EXACT[i])), ..AccuracyRequest::default() },
            output: Output { size, background, background_bottom, reference_height_px: (size[1] % 3 == 1).then_some(240) },
            test: test.map(|(max_channel, max_pixels)| GoldenTest { max_channel, max_pixels, max_wrong_triangles: 0, why: format!("because {why}"), ..GoldenTest::default() }),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_round_trip_keeps_every_bit(preset in any_preset()) {
        let text = preset_file::to_toml(&PresetFile::new("any", preset.clone()));
        let back = preset_file::parse(&text, "any").map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(bits(&back.preset), bits(&preset), "{}", text);
        prop_assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        prop_assert_eq!(preset_file::to_toml(&back), text);
    }

    #[test]
    fn any_preset_can_be_patched_into_any_other(before in any_preset(), after in any_preset()) {
        let mut preset_file = parse(&preset_file::to_toml(&PresetFile::new("any", before)));
        preset_file.preset = after.clone();
        let text = preset_file::to_toml(&preset_file);
        let back = preset_file::parse(&text, "any").map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(bits(&back.preset), bits(&after), "{}", text);
    }

    #[test]
    fn whatever_the_time_every_value_stays_inside_its_hard_range(preset in any_preset(), time_s in any::<f64>()) {
        for enabled in preset.stack_at(time_s).0 {
            for field in &enabled.effect.fields {
                let [low, high] = field.hard.map(|bound| bound as f32);
                let lanes = field.get(&enabled.words);
                let inside = |lane: &f64| !matches!(field.value_type, ValueType::F32 | ValueType::Color | ValueType::Point) || (low..=high).contains(&(*lane as f32));
                prop_assert!(lanes.iter().all(inside), "{}.{} {lanes:?}", enabled.effect.name, field.name);
            }
        }
    }

    #[test]
    fn a_parameter_survives_whatever_its_bits(value in finite_f32()) {
        let written = format!("schema = 2\n[effects.facet]\namount = {value:?}\n");
        match preset_file::parse(&written, "any") {
            Ok(preset_file) => prop_assert_eq!(preset_file.preset.stack.get("facet").unwrap().effect.field("amount").unwrap().get(&preset_file.preset.stack.0[0].words)[0].to_bits(), f64::from(value).to_bits()),
            Err(error) => prop_assert!(!(0.0..=1.0).contains(&value), "{error}"),
        }
    }
}

#[test]
fn every_random_preset_is_one_that_a_file_may_hold() {
    for seed in 0..60 {
        let random = PresetFile::new("random", rasterlab_fuzz::stress::random::preset(seed));
        let text = preset_file::to_toml(&random);
        let read = preset_file::parse(&text, "random")
            .unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        assert_eq!(read.preset, random.preset, "seed {seed}\n{text}");
        assert!(read.warnings.is_empty(), "seed {seed}: {:?}", read.warnings);
    }
}
