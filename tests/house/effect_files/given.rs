//! Promise: what an effect is given follows the preset: the clock, the picture and the camera; it is
//! no parameter, and what has the clock moves. What it says of its reach holds, and what is said of
//! its errors in f32.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rasterlab::{
    effect_files::{evaluated_in, read},
    effects::{
        Effect, EnabledEffect, Stack,
        hooks::{ErrorBound, Surface, Vertex},
    },
    evaluator::Precision,
    preset::{Clock, Preset, SceneSource},
    preset_file::load_scene,
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

use super::super::effect_inputs::{direction, parameters, vector};

const TEXT: &str = "// Ink: what it is given, as colors.
struct Ink {
    @given(frame) frame: u32,
    @range(0, 2, 1) rate: f32,
    @given(seconds) time_s: f32,
    @given(loop) part: f32,
    @given(height) height: u32,
    @given(forward) forward: vec4f,
    @given(width) width: u32,
    @given(pointer) pointer: vec4f,
}

fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    s.color = vec4f(p.rate * p.time_s, p.part, f32(p.frame), f32(p.width) + f32(p.height) / 1000.0);
    s.normal = p.forward.xyz;
    s.position = p.pointer.xyz;
    return s;
}
";

#[test]
fn an_effect_is_given_the_clock_the_picture_and_the_camera() {
    let effect = read("ink.wgsl", "ink", TEXT).unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<&str> = effect
        .fields
        .iter()
        .map(|field| field.name.as_str())
        .collect();
    assert_eq!(names, ["rate"], "what is given has no slider and no key");
    let mut preset = Preset {
        scene: SceneSource::Builtin("knot?tess=6".into()),
        ..Preset::default()
    };
    assert!(!preset.is_moving());
    preset.stack.0.push(EnabledEffect::new(&effect));
    assert!(preset.is_moving(), "it is drawn again while the clock runs");
    let scene = load_scene(&preset, None).expect("a built-in scene");
    for (time_s, expected) in [(2.0, [2.0, 0.25, 60.0]), (5.0, [5.0, 1.0, 240.0])] {
        preset.clock = Clock {
            time_s,
            range_s: [1.0, 5.0],
            ..Clock::default()
        };
        let stack = preset.stack_on(&scene, [320, 240]);
        let enabled = &stack.0[0];
        let shade = enabled.effect.hooks.surface.as_ref().expect("it is on");
        let mut all = [Surface::example(DVec3::ONE, 0)];
        shade(&mut all, &enabled.words);
        let [seen] = all;
        let [red, green, blue, alpha] = seen.color.to_array();
        assert_eq!([red, green, blue], expected, "at {time_s} s");
        assert!((alpha - 320.24).abs() < 1e-6, "{alpha}");
        let forward = preset.view(&scene, [320, 240]).forward;
        assert!((seen.normal - forward).length() < 1e-6);
        let middle = DVec3::new(160.0, 120.0, 0.0);
        assert_eq!(seen.position, middle, "no pointer is over a picture");
    }
}

#[test]
fn a_vertex_moves_no_farther_than_the_reach_that_its_effect_states() {
    let text = |reach: &str| {
        format!(
            "struct Ink {{
    @range(0, 1, 0.5) @unit(m) amplitude_m: f32,
    @range(0, 99, 7) @unit(m) wavelength_m: f32,
}}
fn ink(vertex: Vertex, p: Ink) -> Vertex {{
    var v = vertex;
    v.offset += vec3f(0.0, p.wavelength_m, 0.0);
    return v;
}}
{reach}"
        )
    };
    let cases = [
        ("", 7.5, 7.0),
        (
            "@reach fn far(p: Ink) -> f32 { return p.amplitude_m; }",
            0.5,
            0.5,
        ),
        (
            "@reach fn far(p: Ink) -> f32 { return 3.0 * p.amplitude_m; }",
            1.5,
            1.5,
        ),
        (
            "@reach fn far(p: Ink) -> f32 { return -p.amplitude_m; }",
            0.0,
            0.0,
        ),
        (
            "@reach fn far(p: Ink) -> f32 { return p.wavelength_m * 1e30; }",
            0.0,
            0.0,
        ),
    ];
    for (reach, expected_m, moved_m) in cases {
        let effect =
            read("ink.wgsl", "ink", &text(reach)).unwrap_or_else(|error| panic!("{error}"));
        let mut stack = Stack::default();
        stack.enable(&effect);
        assert_eq!(stack.max_displacement_m(1.0), expected_m, "{reach}");
        let vertex = Vertex {
            position: DVec3::X,
            offset: DVec3::ZERO,
            normal: DVec3::Y,
            flat_normal: DVec3::ZERO,
            center: DVec3::X,
            arm: DVec3::ZERO,
            center_screen: DVec2::ZERO,
            triangle: 0,
            cell_px: 0,
        };
        let moved = stack.moved(vertex, 0).offset;
        assert!(
            (moved - DVec3::Y * moved_m).length() < 1e-9,
            "{reach}: {moved}"
        );
    }
}

/// A corner of a model of this radius about the origin.
fn corner(rng: &mut Rng, radius_m: f64) -> Vertex {
    let position = direction(rng) * rng.real(0.0, radius_m);
    let center = direction(rng) * rng.real(0.0, radius_m);
    Vertex {
        position,
        offset: DVec3::ZERO,
        normal: direction(rng),
        flat_normal: direction(rng),
        center,
        arm: position - center,
        center_screen: vector(rng, 0.0, 1.0).truncate(),
        triangle: rng.next_u32() >> 8,
        cell_px: 0,
    }
}

/// Effects on the vertex hook: those that move vertices, and one that leaves long normals and goes
/// beyond its meters.
fn moving() -> Vec<Arc<Effect>> {
    let text = "struct Ink { @range(0, 2, 1) @unit(m) far_m: f32, @range(0, 9, 7) long: f32 }
fn ink(vertex: Vertex, p: Ink) -> Vertex {
    var v = vertex;
    v.normal *= p.long;
    v.offset += v.normal * p.far_m;
    return v;
}
";
    let ink = read("ink.wgsl", "ink", text).unwrap_or_else(|error| panic!("{error}"));
    let built_in = ["explode", "inflate", "wobble"].map(|name| Effect::named(name).clone());
    built_in.into_iter().chain([ink]).collect()
}

#[test]
fn no_stack_of_effects_moves_a_vertex_farther_than_it_says() {
    let effects = moving();
    let mut rng = Rng(5);
    let mut largest = 0.0f64;
    for turn in 0..2000 {
        let mut stack = Stack::default();
        for _ in 0..1 + turn % 3 {
            let effect = &effects[rng.next_u32() as usize % effects.len()];
            let mut enabled = EnabledEffect::new(effect);
            enabled.words = parameters(&mut rng, effect, turn);
            stack.0.push(enabled);
        }
        let radius_m = rng.real(0.1, 4.0);
        let reach_m = stack.max_displacement_m(radius_m);
        for _ in 0..8 {
            let moved_m = stack.moved(corner(&mut rng, radius_m), 0).offset.length();
            let names: Vec<&str> = stack.0.iter().map(|one| one.effect.name.as_str()).collect();
            // Normals and sines are as long as f32 and a polynomial make them.
            assert!(
                moved_m <= 1.0001 * reach_m + 1e-9,
                "{names:?}: {moved_m} m, and {reach_m} are said"
            );
            largest = largest.max(moved_m / reach_m.max(1e-9));
        }
    }
    assert!(largest > 0.99, "only {largest} of what is said is used");
}

/// Inputs are wrong by as much as they may be, in the directions that together do most, and f32
/// computes with them.
#[test]
fn an_error_in_f32_stays_within_the_bound_whatever_its_inputs_err_by() {
    let mut rng = Rng(17);
    for effect in &moving()[..3] {
        let in_f32 = evaluated_in(&Library::Embedded, effect, Precision::Single)
            .unwrap_or_else(|error| panic!("{error}"));
        let [exact, in_f32] =
            [&effect.hooks, &in_f32].map(|hooks| hooks.vertex.clone().expect("it moves vertices"));
        for turn in 0..300 {
            let words = parameters(&mut rng, effect, turn);
            let here = corner(&mut rng, 2.0);
            // Inputs are no f32 here.
            let rounding = 1e-6;
            // Of one input alone, and of all.
            let size = |member: usize| match turn % 8 {
                7 => 1e-6,
                one if one == member => 1e-4,
                _ => 0.0,
            };
            let bound = ErrorBound {
                position_m: size(0),
                normal: size(1),
                flat_normal: size(2),
                center_m: size(3),
                arm_m: size(4),
                center_screen: size(5),
                ..ErrorBound::default()
            };
            let said = (exact.error_bound)(&here, bound, &words);
            let mut all = [here];
            (exact.moved)(&mut all, &words);
            for _ in 0..64 {
                let mut away = |by: f64| {
                    let sign = |rng: &mut Rng| if rng.real(0.0, 1.0) < 0.5 { by } else { -by };
                    DVec3::new(sign(&mut rng), sign(&mut rng), sign(&mut rng))
                };
                let mut others = [Vertex {
                    position: here.position + away(bound.position_m),
                    normal: here.normal + away(bound.normal),
                    flat_normal: here.flat_normal + away(bound.flat_normal),
                    center: here.center + away(bound.center_m),
                    arm: here.arm + away(bound.arm_m),
                    center_screen: here.center_screen + away(bound.center_screen).truncate(),
                    ..here
                }];
                (in_f32.moved)(&mut others, &words);
                let apart = others[0].offset - all[0].offset;
                let aside = match said.along_m == DVec3::ZERO {
                    true => DVec3::ZERO,
                    false => apart.reject_from(said.along_m),
                };
                let is_within = apart.abs().max_element() <= said.offset_m + rounding
                    && aside.abs().max_element() <= said.aside_m() + rounding;
                assert!(
                    is_within,
                    "{} {turn}: {apart} of {said:?} with {bound:?} at {here:?}, {words:?}",
                    effect.name
                );
                let normal = (others[0].normal - all[0].normal).abs().max_element();
                assert!(
                    normal <= said.normal + rounding,
                    "{} {turn}: {normal} of {said:?}",
                    effect.name
                );
            }
        }
    }
}
