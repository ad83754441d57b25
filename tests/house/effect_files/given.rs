//! Promise: what an effect is given follows the preset: the clock, the picture and the camera; it is
//! no parameter, and what has the clock moves. What it says of its reach holds.

use glam::{DVec2, DVec3};
use rasterlab::{
    effect_files::read,
    effects::{
        EnabledEffect, Stack,
        hooks::{Surface, Vertex},
    },
    preset::{Clock, Preset, SceneSource},
    preset_file::load_scene,
};

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
