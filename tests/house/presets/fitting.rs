//! Promise: lengths and points of a preset are fitted to the scene: on a model of another size at
//! another place it draws the same picture, up to the camera, whether it counts in meters or in the
//! unit of the scene.

use glam::{DMat4, DVec3};
use rasterlab::{
    frame::Frame,
    oracle,
    params::Measure,
    preset::{Fit, LengthUnit, Preset},
    scene::{Bounds, Scene, builtin},
};

use super::*;

const SIZE: [u32; 2] = [64, 48];

/// Effects with lengths and points, each with a camera of its own.
const LOOKS: &[(&str, &str)] = &[
    (
        "explode",
        "[effects.explode]\npattern = \"radial\"\ncenter = [0.3, 0.2, 0.5]\nradius_m = 1.25\nwidth_m = 0.5\namount_m = 0.4\n",
    ),
    ("inflate", "[effects.inflate]\namount_m = 0.12\n"),
    (
        "wobble",
        "[effects.wobble]\namplitude_m = 0.2\nwavelength_m = 0.9\nphase_turns = 0.2\n",
    ),
    (
        "fog",
        "[effects.fog]\ndensity = 0.9\nstart_m = 4.1\nfalloff = 1.7\nlevel_m = -0.2\n",
    ),
    (
        "hatch",
        "[effects.hatch]\nspace = \"surface\"\nspacing_m = 0.5\n",
    ),
    (
        "dots",
        "[effects.dots]\nlines = \"polyline\"\nspacing_m = 0.07\nsize_px = 3.0\n",
    ),
    ("depth", "[effects.depth]\nfit = false\nscale = 0.15\n"),
    (
        "keyframes",
        "[effects.facet]\npattern = \"radial\"\n[clock]\ntime_s = 0.75\n[animation.facet]\nradius_m = [{ time_s = 0, value = 0.1 }, { time_s = 2, value = 3.5 }]\n\
         center = [{ time_s = 0, value = [1.0, 0.0, 0.0] }, { time_s = 1, value = [0.0, 1.0, 0.5] }]\nwidth_m = [{ time_s = 0, value = 0.4 }]\n",
    ),
    (
        "particles",
        "[effects.particles]\ncount = 300\ncenter = [0.1, 0.2, 0.3]\nattractor = [1.0, 0.0, 0.0]\nattraction = 3.0\nradius_m = 0.06\n[clock]\ntime_s = 0.5\n",
    ),
];

fn look(effects: &str) -> Preset {
    let text = format!(
        "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\npolyline = \"1.5 0 1.5; -1.5 0.5 1.5; 0 1.5 0\"\n\
         [camera]\neye = [1.5, 1.2, 6.5]\ntarget = [0.0, 0.1, 0.0]\nnear_m = 0.125\n[effects.lambert]\n{effects}"
    );
    parse(&text).preset
}

fn knot() -> Scene {
    builtin::build("knot?tess=4").expect("a built-in scene")
}

/// `scene`, `times` as large and then moved.
fn placed(times: f64, moved: DVec3) -> Scene {
    let mut scene = knot();
    let matrix = DMat4::from_translation(moved) * DMat4::from_scale(DVec3::splat(times));
    scene
        .instances
        .iter_mut()
        .for_each(|instance| instance.world_from_object = matrix * instance.world_from_object);
    scene
}

/// The preset with its camera at the same place of the scene.
fn with_camera(preset: &Preset, times: f64, moved: DVec3) -> Preset {
    let camera = preset.camera.map(|mut camera| {
        (camera.eye, camera.target) = (camera.eye * times + moved, camera.target * times + moved);
        camera.near_m *= times;
        camera
    });
    Preset {
        camera,
        ..preset.clone()
    }
}

fn drawn(preset: &Preset, scene: &Scene) -> Frame {
    oracle::render_scaled(scene, &preset.moments(scene, SIZE), 1.0).expect("it is drawn")
}

/// Pixels whose colors differ by more than `channel` of 255.
fn different(a: &Frame, b: &Frame, channel: u8) -> usize {
    a.color
        .iter()
        .zip(&b.color)
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > channel))
        .count()
}

#[test]
fn a_preset_on_a_scaled_model_draws_the_same_picture() {
    for (name, effects) in LOOKS {
        let preset = look(effects);
        let before = drawn(&preset, &knot());
        for times in [0.25, 4.0] {
            let scene = placed(times, DVec3::ZERO);
            let fit = Fit::between(&knot().bounds(), &scene.bounds()).expect("both have an extent");
            let (fitted, warnings) = preset.fitted(&fit);
            assert!(warnings.is_empty(), "{name}: {warnings:?}");
            let after = drawn(&with_camera(&fitted, times, DVec3::ZERO), &scene);
            assert_eq!(after.triangle_id, before.triangle_id, "{name} at {times}");
            assert_eq!(after.color, before.color, "{name} at {times}");
            let unfitted = drawn(&with_camera(&preset, times, DVec3::ZERO), &scene);
            assert!(
                different(&unfitted, &before, 8) > 20,
                "{name} at {times}: the lengths do not matter, so this test shows nothing"
            );
        }
    }
}

#[test]
fn a_preset_on_a_model_elsewhere_draws_the_same_picture_up_to_rounding() {
    // Waves, hatches and flows are patterns of the world; they fit in size and stay where they are.
    for (name, effects) in LOOKS
        .iter()
        .filter(|(name, _)| !["wobble", "hatch", "particles"].contains(name))
    {
        let preset = look(effects);
        let (times, moved) = (3.7, DVec3::new(5.0, -2.0, 1.0));
        let scene = placed(times, moved);
        let fit = Fit::between(&knot().bounds(), &scene.bounds()).expect("both have an extent");
        let after = drawn(&with_camera(&preset.fitted(&fit).0, times, moved), &scene);
        let before = drawn(&preset, &knot());
        let wrong = different(&after, &before, 8);
        assert!(
            wrong < 30,
            "{name}: {wrong} of {} pixels differ",
            before.color.len()
        );
    }
}

#[test]
fn a_preset_in_the_unit_of_the_scene_fits_every_scene() {
    for (name, effects) in LOOKS {
        let preset = look(effects);
        let to_unit = Fit::of_scene_unit(&knot().bounds())
            .expect("it has an extent")
            .inverse();
        let in_radii = Preset {
            unit: LengthUnit::Scene,
            ..preset.fitted(&to_unit).0
        };
        let before = drawn(&preset, &knot());
        let there = drawn(&in_radii, &knot());
        let wrong = different(&there, &before, 8);
        assert!(
            wrong < 30,
            "{name}: {wrong} pixels differ where the unit alone is another"
        );
        // The same values on a larger model, without any fitting.
        let larger = drawn(
            &with_camera(&in_radii, 4.0, DVec3::ZERO),
            &placed(4.0, DVec3::ZERO),
        );
        assert_eq!(larger.color, there.color, "{name}");
    }
}

#[test]
fn a_room_does_not_count_for_the_unit_of_the_scene() {
    let preset = Preset {
        unit: LengthUnit::Scene,
        ..look("[effects.inflate]\namount_m = 0.25\n")
    };
    let amount = |scene: &Scene| {
        let stack = preset.stack_on(scene, preset.output.size);
        values(
            &Preset {
                stack,
                ..preset.clone()
            },
            "inflate",
            "amount_m",
        )[0]
    };
    for query in ["knot?tess=4", "tentacle?tess=3"] {
        let scene = || builtin::build(query).expect("a built-in scene");
        assert_eq!(amount(&scene().in_room(3.0)), amount(&scene()), "{query}");
        assert!(
            (amount(&scene()) - 0.25 * scene().bounds().radius()).abs() < 1e-6,
            "{query}"
        );
    }
}

fn around(center: DVec3, half: f64) -> Bounds {
    Bounds {
        min: center - half,
        max: center + half,
    }
}

#[test]
fn every_kind_of_length_is_fitted_by_its_unit() {
    let fit = Fit::between(
        &around(DVec3::new(1.0, 2.0, 3.0), 1.0),
        &around(DVec3::new(10.0, 20.0, 30.0), 2.0),
    );
    let fit = fit.expect("a fit");
    let preset = look(
        "[effects.fog]\ndensity = 1.0\nstart_m = 3.0\nlevel_m = 2.5\n[effects.particles]\nhalf_axes = [1.0, 2.0, 3.0]\ncenter = [2.0, 2.0, 3.0]\nspeed_mps = 0.5\n\
         attraction = 4.0\nlifetime_s = 2.0\n[effects.hatch]\nspacing_px = 5.0\nspacing_m = 0.5\n[animation.fog]\nstart_m = [{ time_s = 0, value = 1.0 }]\n",
    );
    let fitted = preset.fitted(&fit).0;
    for (effect, field, wanted) in [
        ("fog", "density", vec![0.5]),
        ("fog", "start_m", vec![6.0]),
        ("fog", "level_m", vec![21.0]),
        ("particles", "half_axes", vec![2.0, 4.0, 6.0]),
        ("particles", "center", vec![12.0, 20.0, 30.0]),
        ("particles", "speed_mps", vec![1.0]),
        ("particles", "attraction", vec![8.0]),
        ("particles", "lifetime_s", vec![2.0]),
        ("hatch", "spacing_px", vec![5.0]),
        // It counts only where the lines lie on the surface.
        ("hatch", "spacing_m", vec![0.5]),
    ] {
        assert_eq!(values(&fitted, effect, field), wanted, "{effect}.{field}");
    }
    let keys = fitted
        .animation
        .get("fog", "start_m")
        .expect("it is animated")
        .keys();
    assert_eq!(keys[0].value, [2.0]);
    assert_eq!(fitted.polyline[0], [11.0, 16.0, 27.0]);
    assert_eq!(fitted.fitted(&fit.inverse()).0, preset, "the way back");
}

#[test]
fn a_length_that_its_range_does_not_allow_is_kept_inside_and_named() {
    let bounds = |half: f64| around(DVec3::ZERO, half);
    let fit = Fit::between(&bounds(1.0), &bounds(1e5)).expect("a fit");
    let preset = look(
        "[effects.explode]\namount_m = 0.5\n[effects.fog]\nstart_m = 2.0\n[animation.fog]\nlevel_m = [{ time_s = 0, value = 20.0 }, { time_s = 1, value = 30.0 }]\n",
    );
    let (fitted, warnings) = preset.fitted(&fit);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings[0].starts_with("explode.amount_m: ")
            && warnings[0].ends_with("kept within -1000 to 1000"),
        "{warnings:?}"
    );
    assert!(warnings[1].starts_with("fog.level_m: "), "{warnings:?}");
    let file = preset_file::to_toml(&PresetFile::new("large", fitted.clone()));
    assert_eq!(
        bits(&parse(&file).preset),
        bits(&fitted),
        "a file may have every value\n{file}"
    );
    assert_eq!(
        Fit::between(&bounds(0.0), &bounds(1.0)),
        None,
        "a point has no size to compare with"
    );
}

#[test]
fn parameters_of_the_built_in_effects_know_what_they_measure() {
    let of = |path: &str| {
        let (effect, field) = path.split_once('.').expect("a path");
        rasterlab::effects::Effect::find(effect)
            .and_then(|effect| effect.field(field))
            .expect("a field")
            .measure()
    };
    for (path, wanted) in [
        ("facet.center", Measure::Point),
        ("facet.radius_m", Measure::Length),
        ("fog.level_m", Measure::Height),
        ("fog.density", Measure::PerDepth),
        ("wobble.direction", Measure::None),
        ("particles.half_axes", Measure::Length),
        ("particles.attractor", Measure::Point),
        ("outline.width_px", Measure::None),
    ] {
        assert_eq!(of(path), wanted, "{path}");
    }
}
