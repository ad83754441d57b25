//! Promise: what an effect is given follows the preset: the clock, the picture and the camera; it is
//! no parameter, and what has the clock moves.

use rasterlab::{
    effect_files::read,
    effects::{EnabledEffect, hooks::Surface},
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
}

fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    s.color = vec4f(p.rate * p.time_s, p.part, f32(p.frame), f32(p.width) + f32(p.height) / 1000.0);
    s.normal = p.forward.xyz;
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
        let seen = shade(Surface::example(glam::DVec3::ONE, 0), &enabled.words);
        let [red, green, blue, alpha] = seen.color.to_array();
        assert_eq!([red, green, blue], expected, "at {time_s} s");
        assert!((alpha - 320.24).abs() < 1e-6, "{alpha}");
        let forward = preset.view(&scene, [320, 240]).forward;
        assert!((seen.normal - forward).length() < 1e-6);
    }
}
