//! Promise: particles fly as their definition says, on every option and however a frame was
//! reached; their discs are decided in integers; mistakes in the pass are found; and who has none
//! pays nothing. The second half needs an adapter.

use std::sync::Arc;

use glam::DVec3;
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{CurlNoise, ParticleStorage},
    effects::{
        Effect,
        particles::{self, EFFECT, Particles},
        read,
    },
    frame::{AdapterPicture, Geometry, ParticleReadback, ParticleState, SnappedVertex},
    gpu::{Capture, Gpu, Renderer},
    measure::{Budget, ErrorReport as Measured},
    oracle::{self, OrientedTriangle, SampleTests},
    plan::AccuracyRequest,
    preset::{
        Clock, PinnedOptions, Preset,
        animation::{Easing, Keyframe, Track},
    },
    scene::{Scene, camera::Camera, view::View},
};

use crate::common::*;

mod flow;

const SIZE: [u32; 2] = [96, 72];

/// A preset of the chamber with particles, some of their fields set.
fn preset_file(fields: &[(&str, &[f64])]) -> Preset {
    let mut preset = Preset::default();
    let words = &mut preset.stack.enable(&EFFECT).words;
    for (name, value) in [("count", &[500.0][..]), ("radius_m", &[0.03])]
        .iter()
        .chain(fields)
    {
        let field = EFFECT
            .field(name)
            .unwrap_or_else(|| panic!("no field {name}"));
        field
            .set(words, value)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    preset
}

fn at(preset: &Preset, frame: u32) -> Preset {
    let rate: Particles = preset.stack.params(&EFFECT.name).expect("particles");
    let clock = Clock {
        time_s: f64::from(frame) / f64::from(rate.rate),
        ..preset.clock
    };
    Preset {
        clock,
        ..preset.clone()
    }
}

fn on(curl: CurlNoise, state: ParticleStorage) -> AccuracyRequest {
    request(PinnedOptions::of(curl).with(state))
}

fn particle_options() -> impl Iterator<Item = (CurlNoise, ParticleStorage)> {
    CurlNoise::ALL
        .iter()
        .flat_map(|&curl| ParticleStorage::ALL.iter().map(move |&state| (curl, state)))
}

/// The swarm of a frame.
fn flown(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    preset: &Preset,
    frame: u32,
    accuracy: &AccuracyRequest,
) -> (Capture, ParticleReadback) {
    let preset = at(preset, frame);
    let capture = renderer.captured(
        scene,
        &preset.view(scene, SIZE),
        &preset.evaluated_stack(),
        accuracy,
    );
    let particle_readback = capture
        .geometry
        .particle_readback
        .clone()
        .expect("particles");
    (capture, particle_readback)
}

fn measured(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    preset: &Preset,
    frame: u32,
    accuracy: &AccuracyRequest,
) -> (Capture, Measured) {
    let preset = at(preset, frame);
    let (capture, verdict) = renderer.judged(
        scene,
        &preset.view(scene, SIZE),
        &preset.evaluated_stack(),
        accuracy,
    );
    (capture, verdict.report)
}

fn every_step_is_within_its_bound_with_every_option(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let preset_files: [&[(&str, &[f64])]; 5] = [
        &[],
        &[
            ("octaves", &[6.0]),
            ("persistence", &[0.9]),
            ("swirl_m", &[0.2]),
            ("speed_mps", &[3.0]),
            ("seed", &[77.0]),
        ],
        &[
            ("drag", &[0.0]),
            ("attraction", &[12.0]),
            ("attractor_m", &[0.05]),
            ("attractor", &[0.3, -0.2, 0.1]),
        ],
        &[
            ("lifetime_s", &[0.1]),
            ("lifetime_variation", &[1.0]),
            ("rate", &[30.0]),
            ("evolve", &[3.0]),
        ],
        &[
            ("room_m", &[0.6]),
            ("half_axes", &[0.3, 0.9, 0.6]),
            ("speed_mps", &[4.0]),
            ("center", &[40.0, -3.0, 7.0]),
        ],
    ];
    for (number, fields) in reach.of(2, preset_files.iter().enumerate()) {
        // Of four options each look meets two.
        for (curl, state) in particle_options().skip(number % 2).step_by(2) {
            for frame in [0, 1, 13, 40] {
                let (_, accuracy) = measured(
                    &mut renderer,
                    &scene,
                    &preset_file(fields),
                    frame,
                    &on(curl, state),
                );
                let what = format!(
                    "look {number}, frame {frame}, {} {}",
                    curl.name(),
                    state.name()
                );
                accuracy
                    .within(&Budget::default())
                    .unwrap_or_else(|why| panic!("{what}: {why}"));
                assert_eq!(
                    (accuracy.particles, accuracy.particles_outside_bound),
                    (500, 0),
                    "{what}"
                );
            }
        }
    }
}

fn a_frame_is_the_same_however_it_was_reached(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let scene = scene("chamber");
    for (curl, state) in reach.of(1, particle_options()) {
        let accuracy = on(curl, state);
        let preset = preset_file(&[("lifetime_s", &[0.4]), ("count", &[333.0])]);
        let fresh = |gpu: &Arc<Gpu>| Renderer::new(gpu.clone());
        let (jumped, reference) = flown(&mut fresh(&gpu), &scene, &preset, 45, &accuracy);
        assert!(reference.after.iter().any(|flight| flight.births > 1));
        // Played frame by frame, drawn twice here and there, jumped ahead, and gone back to.
        let mut renderer = fresh(&gpu);
        for frame in (0..=45).flat_map(|frame| vec![frame; 1 + usize::from(frame % 7 == 0)]) {
            flown(&mut renderer, &scene, &preset, frame, &accuracy);
        }
        for (way, frames) in [
            ("played", &[45][..]),
            ("again", &[45]),
            ("scrubbed", &[60, 45]),
            ("from the start", &[0, 1, 44, 45]),
        ] {
            let mut last = None;
            for &frame in frames {
                last = Some(flown(&mut renderer, &scene, &preset, frame, &accuracy));
            }
            let (capture, particle_readback) = last.expect("frames");
            assert!(
                particle_readback == reference,
                "{way}, {} {}: the particles differ",
                curl.name(),
                state.name()
            );
            assert!(
                capture.frame == jumped.frame,
                "{way}, {} {}: the picture differs",
                curl.name(),
                state.name()
            );
        }
        // Another preset between leaves no trace.
        flown(
            &mut renderer,
            &scene,
            &preset_file(&[("count", &[70.0]), ("seed", &[9.0])]),
            12,
            &accuracy,
        );
        assert!(flown(&mut renderer, &scene, &preset, 45, &accuracy).1 == reference);
        let other = flown(
            &mut renderer,
            &scene,
            &preset_file(&[
                ("lifetime_s", &[0.4]),
                ("count", &[333.0]),
                ("seed", &[2.0]),
            ]),
            45,
            &accuracy,
        )
        .1;
        assert!(other != reference, "the seed changes nothing");
    }
}

#[test]
fn none_few_and_odd_numbers_of_particles_are_drawn() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let bare = renderer.captured(
        &scene,
        &Preset::default().view(&scene, SIZE),
        &stack(&[]),
        &unpinned(),
    );
    for count in [0u32, 1, 2, 63, 65, 257] {
        let preset = at(
            &preset_file(&[("count", &[f64::from(count)]), ("radius_m", &[0.1])]),
            20,
        );
        let view = preset.view(&scene, SIZE);
        let (capture, verdict) =
            renderer.judged(&scene, &view, &preset.evaluated_stack(), &unpinned());
        exactness(&verdict.report).unwrap_or_else(|why| panic!("{count}: {why}"));
        let particle_readback = capture
            .geometry
            .particle_readback
            .as_ref()
            .map_or(0, |particle_readback| particle_readback.after.len() as u32);
        assert_eq!(
            (particle_readback, verdict.report.particles),
            (count, count.into())
        );
        let first = scene.triangle_count() as u32;
        let shown = capture
            .frame
            .triangle_id
            .iter()
            .filter(|&&triangle_id| triangle_id != u32::MAX && triangle_id >= first)
            .count();
        assert!(
            count < 60 || shown > 20,
            "{count}: {shown} pixels show particles"
        );
        assert!(
            count > 0
                || capture.frame.triangle_id
                    == captured_of(&mut renderer, &scene, &view).frame.triangle_id,
            "none is as without"
        );
    }
    assert!(bare.geometry.particle_readback.is_none());
}

fn captured_of(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View) -> Capture {
    renderer.captured(scene, view, &stack(&[]), &unpinned())
}

fn lives_end_and_begin_again_inside_the_room(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let preset = preset_file(&[
        ("lifetime_s", &[0.25]),
        ("room_m", &[0.8]),
        ("half_axes", &[0.4, 0.4, 0.4]),
        ("speed_mps", &[5.0]),
    ]);
    let p: Particles = preset.stack.params(&EFFECT.name).expect("particles");
    let [longest, _] = particles::life_steps(&p);
    assert_eq!(longest, 15);
    for (curl, state) in reach.of(1, particle_options()) {
        let particle_readback = flown(&mut renderer, &scene, &preset, 100, &on(curl, state)).1;
        let held = |flight: &ParticleState| flight.position.iter().all(|at| at.abs() <= 0.8 + 1e-5);
        assert!(particle_readback.after.iter().all(|flight| held(flight)
            && flight.age < longest
            && flight.births >= 100 / longest - 1));
        let reborn = particle_readback
            .after
            .iter()
            .filter(|flight| flight.age == 0)
            .count();
        assert!(
            (10..200).contains(&reborn),
            "{reborn} of 500 were born in this very step"
        );
        let ball = |flight: &ParticleState| {
            flight.position.iter().map(|at| at * at).sum::<f32>().sqrt() <= 0.4 + 1e-4
        };
        assert!(
            particle_readback
                .after
                .iter()
                .filter(|flight| flight.age == 0)
                .all(ball)
        );
    }
}

fn for_a_second_particles_follow_the_reference_and_rough_options_drift(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let preset = preset_file(&[
        ("lifetime_s", &[30.0]),
        ("lifetime_variation", &[0.1]),
        ("room_m", &[4.0]),
    ]);
    let drift = |renderer: &mut Renderer, frame: u32, curl: CurlNoise, state: ParticleStorage| {
        let (_, accuracy) = measured(renderer, &scene, &preset, frame, &on(curl, state));
        eprintln!(
            "{:10} {:7} frame {frame:3}: {:.5} px at most, {:.1e} m on average, {} of {} beyond a pixel",
            curl.name(),
            state.name(),
            accuracy.max_divergence_px,
            accuracy.mean_divergence_m,
            accuracy.particles_diverged,
            accuracy.particles
        );
        accuracy
    };
    let mut last = 0.0;
    for frame in reach.of(4, [0, 30, 60, 120, 240, 480]) {
        let accuracy = drift(
            &mut renderer,
            frame,
            CurlNoise::Analytic,
            ParticleStorage::Float32,
        );
        assert!(accuracy.mean_divergence_m >= last, "chaos does not heal");
        last = accuracy.mean_divergence_m;
        assert!(
            frame > 60 || accuracy.max_divergence_px < 0.1,
            "frame {frame}: {} px",
            accuracy.max_divergence_px
        );
    }
    let exact = drift(
        &mut renderer,
        60,
        CurlNoise::Analytic,
        ParticleStorage::Float32,
    )
    .mean_divergence_m;
    for (curl, state) in particle_options()
        .filter(|options| *options != (CurlNoise::Analytic, ParticleStorage::Float32))
    {
        let rough = drift(&mut renderer, 60, curl, state).mean_divergence_m;
        assert!(
            rough > 10.0 * exact && rough < 0.05,
            "{} {}: {rough} m, where {exact} m are due to rounding",
            curl.name(),
            state.name()
        );
    }
}

fn discs_of_every_size_are_the_oracle_s_with_every_option_and_tuning(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    // Less than a pixel, ordinary, larger than a tile, and as large as the picture with the eye
    // among them.
    for (size, effects) in reach.of(
        2,
        [
            (0.004, &[][..]),
            (0.03, &["xray"]),
            (0.5, &["dissolve"]),
            (3.0, &["overdraw"]),
            (9.0, &[]),
        ],
    ) {
        let mut preset = at(
            &preset_file(&[
                ("radius_m", &[size]),
                ("count", &[60.0]),
                ("half_axes", &[3.0, 3.0, 3.0]),
                ("room_m", &[6.0]),
            ]),
            25,
        );
        for name in effects {
            preset.stack.enable(Effect::find(name).expect("an effect"));
        }
        if size > 1.0 {
            preset.camera = Some(Camera {
                eye: DVec3::new(0.2, 0.1, 1.0),
                ..Camera::default()
            });
        }
        let (view, stack) = (preset.view(&scene, SIZE), preset.evaluated_stack());
        let mut first: Option<Capture> = None;
        let ways = tunings()
            .into_iter()
            .zip(options(&renderer).into_iter().cycle());
        for (tuning, option) in reach.of(2, ways) {
            renderer.set_tuning(tuning);
            let what = format!("size {size}, {} {tuning:?}", option.name());
            let (capture, _) = renderer.exact(&scene, &view, &stack, &pinned(option), &what);
            let first = first.get_or_insert_with(|| capture.clone());
            assert!(
                capture.frame.triangle_id == first.frame.triangle_id
                    && capture.frame.depth_key == first.frame.depth_key,
                "{what}"
            );
        }
        let cut = first.expect("an option").frame.counters.clipped;
        assert!(size < 9.0 || cut > 0, "nothing is cut by the near plane");
    }
}

#[test]
fn what_fills_boxes_or_draws_corners_shows_no_discs() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    for name in ["boxes", "points"] {
        let mut preset = at(&preset_file(&[("count", &[60.0])]), 10);
        preset.stack.enable(Effect::find(name).expect("an effect"));
        renderer.exact(
            &scene,
            &preset.view(&scene, SIZE),
            &preset.evaluated_stack(),
            &unpinned(),
            name,
        );
    }
}

#[test]
fn keys_lead_the_attractor_and_a_frame_of_them_is_the_same_however_it_was_reached() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let mut preset = preset_file(&[
        ("attraction", &[9.0]),
        ("drag", &[1.0]),
        ("lifetime_s", &[9.0]),
    ]);
    let key = |time_s: f64, x: f64| Keyframe {
        time_s,
        value: vec![x, 0.0, 0.0],
        easing: Easing::Linear,
    };
    let field = EFFECT.field("attractor").expect("an attractor");
    preset
        .animation
        .put(Track::new(&EFFECT, field, vec![key(0.0, -2.0), key(0.5, 2.0)]).expect("sound keys"));
    let particle_timeline = at(&preset, 40).particle_timeline().expect("particles");
    let x = |step: u32| read::<Particles>(particle_timeline.words(step)).attractor[0];
    assert_eq!((particle_timeline.len(), particle_timeline.frame), (40, 40));
    assert!(
        (1..40).all(|step| x(step) < x(step + 1)) && x(30) < 1.0 && x(40) > x(30),
        "the attraction follows behind"
    );
    let accuracy = AccuracyRequest::default();
    let (jumped, reference) = flown(&mut renderer, &scene, &preset, 40, &accuracy);
    for frame in [0, 5, 6, 39] {
        let (_, measured) = measured(&mut renderer, &scene, &preset, frame, &accuracy);
        measured
            .within(&Budget::default())
            .unwrap_or_else(|why| panic!("frame {frame}: {why}"));
    }
    let (again, particle_readback) = flown(&mut renderer, &scene, &preset, 40, &accuracy);
    assert!(particle_readback == reference && again.frame == jumped.frame);
    // What a bench draws is the same picture.
    let posed = at(&preset, 40).evaluated();
    assert_eq!(
        posed.particle_timeline(),
        at(&preset, 40).particle_timeline()
    );
}

#[test]
fn too_many_particles_are_refused_with_a_sentence() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("chamber");
    let most = renderer.gpu().caps.max_storage_binding_bytes;
    let preset = preset_file(&[("count", &[4e6])]);
    renderer
        .set_scene(&scene)
        .block_on()
        .expect("a builtin fits");
    let drawn = renderer
        .draw_complete(
            &preset.view(&scene, [8, 8]),
            &preset.evaluated_stack(),
            &unpinned(),
        )
        .block_on();
    if most < 4_000_000 * 72 {
        let sentence = drawn.expect_err("it does not fit").to_string();
        assert!(sentence.contains("vertex_bytes"), "{sentence}");
    }
    // What was there before is still drawn.
    let few = at(&preset_file(&[]), 3);
    renderer.exact(
        &scene,
        &few.view(&scene, SIZE),
        &few.evaluated_stack(),
        &unpinned(),
        "after a refusal",
    );
}

fn a_mistake_in_the_pass_is_found(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let scene = scene("chamber");
    let preset = preset_file(&[
        ("lifetime_s", &[0.3]),
        ("attraction", &[2.0]),
        ("radius_m", &[0.1]),
    ]);
    for (right, wrong) in reach.of(
        2,
        [
            ("(t - 1.0) * (t - 1.0)", "(t - 1.0) * t"),
            (
                "(frame_number & 1u) * particle_step.count + id);\n    particle_states",
                "id);\n    particle_states",
            ),
            ("vec2f(0.0, 2.0)", "vec2f(0.0, 1.99)"),
            ("2u * areas.x", "areas.x"),
        ],
    ) {
        let mut renderer = Mistaken::new(&gpu, right, wrong);
        let is_found = [0, 1, 18].into_iter().any(|frame| {
            let preset = at(&preset, frame);
            renderer
                .set_scene(&scene)
                .block_on()
                .expect("a builtin fits");
            let (view, stack) = (preset.view(&scene, SIZE), preset.evaluated_stack());
            let Ok(capture) = renderer.capture(&view, &stack, &unpinned()).block_on() else {
                return true;
            };
            let verdict = oracle::judge(
                &scene,
                &view,
                &stack,
                &AdapterPicture {
                    previous: None,
                    ..capture.picture()
                },
            );
            verdict
                .expect("it can be judged")
                .report
                .within(&Budget::default())
                .is_err()
        });
        assert!(is_found, "{wrong:?} for {right:?} goes unnoticed");
    }
}

few_and_all!(
    every_step_is_within_its_bound_with_every_option,
    a_frame_is_the_same_however_it_was_reached,
    lives_end_and_begin_again_inside_the_room,
    for_a_second_particles_follow_the_reference_and_rough_options_drift,
    discs_of_every_size_are_the_oracle_s_with_every_option_and_tuning,
    a_mistake_in_the_pass_is_found,
);
