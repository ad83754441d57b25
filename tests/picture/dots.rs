//! Promise: three ways of choosing dots give one picture, the oracle's; the pattern thins without a
//! jump; no number of dots is lost or too many. Needs an adapter.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{DotCulling, PinnedOptions, Visibility},
    effects::{
        Effect, Stack,
        dots::{Dots, FULL, MAX_DOTS},
        read,
    },
    frame::SnappedVertex,
    gpu::{Capture, RenderError, Renderer},
    oracle,
    plan::{AccuracyRequest, Tuning},
    preset::{Preset, SceneSource},
    scene::{Scene, draw::draws, view::View},
};

use crate::common::*;

const WAYS: [DotCulling; 3] = [DotCulling::Brute, DotCulling::Cpu, DotCulling::Gpu];

/// Dots with these values, and other effects.
fn dotted(values: &[(&str, f64)], others: &[&str]) -> Stack {
    let mut stack = stack(others);
    let enabled = stack.enable(Effect::find("dots").expect("a listed effect"));
    for (name, value) in values {
        let field = enabled
            .effect
            .field(name)
            .unwrap_or_else(|| panic!("dots has no {name}"));
        let lanes = vec![*value; field.value_type.components()];
        field
            .set(&mut enabled.words, &lanes)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    stack
}

fn on(way: DotCulling) -> AccuracyRequest {
    request(PinnedOptions::of(way))
}

/// One picture by all three ways, judged, and found to be one.
fn three_ways(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    what: &str,
) -> Capture {
    let [brute, cpu, gpu] = WAYS.map(|way| {
        renderer
            .exact(
                scene,
                view,
                stack,
                &on(way),
                &format!("{what}, {}", way.name()),
            )
            .0
    });
    for (way, other) in [("cpu", &cpu), ("gpu", &gpu)] {
        assert!(
            brute.frame.dots == other.frame.dots,
            "{what}: {way} shows other dots than brute force"
        );
        assert!(
            brute.frame.color == other.frame.color,
            "{what}: {way} draws another picture than brute force"
        );
    }
    // With few runs of dots to a workgroup, as on a card.
    let usual = renderer.gpu().caps.tuning();
    renderer.set_tuning(Tuning {
        dot_groups: 1024,
        ..usual
    });
    let divided = renderer.captured(scene, view, stack, &on(DotCulling::Gpu));
    renderer.set_tuning(usual);
    assert!(
        brute.frame.dots == divided.frame.dots,
        "{what}: among more workgroups other dots are shown"
    );
    gpu
}

/// `polyline` seen from the front, 1 m a pixel.
fn flat(points: &[[f32; 3]], size: [u32; 2]) -> (Arc<Scene>, View) {
    let scene = scene("stack?layers=1");
    let preset = Preset {
        scene: SceneSource::Builtin("stack".into()),
        polyline: points.into(),
        ..Preset::default()
    };
    let view = preset.view(&scene, size);
    (scene, view)
}

fn three_ways_of_choosing_dots_give_the_oracle_s_picture(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let cases: [(&str, &[(&str, f64)]); 7] = [
        ("teapot?tess=8", &[("spacing_m", 0.02)]),
        (
            "knot?tess=6",
            &[
                ("spacing_m", 0.004),
                ("min_gap_px", 3.0),
                ("fade", 0.25),
                ("show_model", 0.0),
            ],
        ),
        (
            "cube-wall",
            &[
                ("lines", 1.0),
                ("spacing_m", 0.05),
                ("size_px", 5.0),
                ("hidden_opacity", 0.0),
            ],
        ),
        (
            "near",
            &[("spacing_m", 5.0), ("levels", 24.0), ("min_gap_px", 20.0)],
        ),
        (
            "grid?cell=4",
            &[("spacing_m", 1.5), ("levels", 0.0), ("size_px", 1.0)],
        ),
        ("slivers", &[("spacing_m", 3.0)]),
        (
            "teapot?tess=4",
            &[
                ("spacing_m", 0.01),
                ("dash_m", 0.07),
                ("gap_m", 0.05),
                ("min_gap_px", 1.0),
            ],
        ),
    ];
    for (query, values) in reach.of(2, cases) {
        let scene = scene(query);
        let capture = three_ways(
            &mut renderer,
            &scene,
            &view(&scene, [200, 150]),
            &dotted(values, &["lambert"]),
            query,
        );
        let shown = capture
            .frame
            .dots
            .iter()
            .filter(|strength| **strength > 0)
            .count();
        assert!(shown > 200, "{query}: {shown} pixels have dots");
    }
}

fn close_views_leave_most_lines_out_and_no_dot(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=12");
    for (eye, target) in reach.of(
        1,
        [
            ([0.2, 0.1, 0.6], [1.0, 0.3, 0.0]),
            ([0.0, 0.0, 0.0], [0.4, 1.0, 0.1]),
            ([3.0, 0.2, 0.0], [0.0, 0.0, 0.0]),
        ],
    ) {
        let camera = rasterlab::scene::camera::Camera {
            eye: eye.into(),
            target: target.into(),
            ..Default::default()
        };
        let view = camera_view(&scene, &camera, [160, 120]);
        three_ways(
            &mut renderer,
            &scene,
            &view,
            &dotted(&[("spacing_m", 0.003), ("min_gap_px", 2.0)], &[]),
            &format!("from {eye:?}"),
        );
    }
}

fn every_backend_of_visibility_hides_the_same_dots(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("cube-wall");
    let (view, stack) = (
        view(&scene, [160, 120]),
        dotted(&[("spacing_m", 0.03)], &[]),
    );
    let pictures: Vec<Capture> = reach
        .of(2, options(&renderer))
        .into_iter()
        .map(|option| {
            renderer
                .exact(&scene, &view, &stack, &pinned(option), option.name())
                .0
        })
        .collect();
    assert!(
        pictures
            .windows(2)
            .all(|pair| pair[0].frame.dots == pair[1].frame.dots
                && pair[0].frame.color == pair[1].frame.color)
    );
}

#[test]
fn dots_go_with_joints_and_effects_and_under_every_other() {
    let Some(mut renderer) = loan() else { return };
    let deformed = Preset {
        scene: SceneSource::Builtin("tentacle?tess=3".into()),
        ..Preset::default()
    };
    let deformed = Preset {
        playback: rasterlab::preset::ClipPlayback {
            clip: "Curl".into(),
            clip_time_s: Some(0.7),
            ..Default::default()
        },
        ..deformed
    };
    let tentacle = scene("tentacle?tess=3");
    let view_of = deformed.view(&tentacle, [160, 120]);
    renderer.exact(
        &tentacle,
        &view_of,
        &dotted(&[("spacing_m", 0.03)], &[]),
        &unpinned(),
        "tentacle",
    );

    let teapot = scene("teapot?tess=4");
    let stack = dotted(&[("spacing_m", 0.05)], &["explode", "outline", "posterize"]);
    renderer.exact(
        &teapot,
        &view(&teapot, [160, 120]),
        &stack,
        &unpinned(),
        "with other effects",
    );
}

#[test]
fn a_tree_of_lines_refuses_lines_that_move() {
    let Some(mut renderer) = loan() else { return };
    for (query, others, word) in [
        ("tentacle?tess=2", &[][..], "clips"),
        ("teapot?tess=2", &["wobble"][..], "the effect wobble"),
    ] {
        let scene = scene(query);
        renderer.set_scene(&scene).block_on().expect("it fits");
        let error = renderer
            .capture(
                &view(&scene, [32, 24]),
                &dotted(&[], others),
                &on(DotCulling::Cpu),
            )
            .block_on()
            .expect_err(query);
        assert!(
            error.is_unsupported()
                && error.to_string().contains(word)
                && error.to_string().contains("use gpu"),
            "{error}"
        );
    }
}

fn no_number_of_dots_is_lost(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    // A line along the middle of the picture: so many meters hold so many dots.
    for count in reach.of(3, [1u64, 65, 4097, 2, 63, 64, 4096]) {
        let length = (count - 1).max(1) as f32;
        let (scene, view) = flat(&[[0.0; 3], [length, 0.0, 0.0]], [64, 48]);
        let spacing = if count == 1 {
            1.5
        } else {
            f64::from(length) / (count - 1) as f64
        };
        let stack = dotted(
            &[("lines", 2.0), ("levels", 0.0), ("spacing_m", spacing)],
            &[],
        );
        let capture = three_ways(
            &mut renderer,
            &scene,
            &view,
            &stack,
            &format!("{count} dots"),
        );
        assert_eq!(capture.geometry.dots.len() as u64, count);
    }
    let (scene, view) = flat(&[], [64, 48]);
    let capture = three_ways(
        &mut renderer,
        &scene,
        &view,
        &dotted(&[("lines", 2.0)], &[]),
        "no polyline",
    );
    assert!(
        capture.geometry.dots.is_empty()
            && capture.frame.dots.iter().all(|strength| *strength == 0)
    );
    let bare = renderer.captured(&scene, &view, &stack(&[]), &unpinned());
    assert!(
        bare.frame.color == capture.frame.color,
        "no dots are no change"
    );
}

/// Half as many dots again as the workgroups of one dimension draw, so that their loss would show;
/// all of them in view, so that the list is as full as it can be.
#[test]
#[ignore = "slow: .ci/full"]
fn dots_beyond_65_535_workgroups_are_all_drawn() {
    let Some(mut renderer) = loan() else { return };
    let spacing = 2e-5f32;
    let count = 65_535 * 96;
    let length = (count as f64 - 0.5) * f64::from(spacing);
    let (scene, view) = flat(&[[0.0; 3], [length as f32, 0.0, 0.0]], [64, 48]);
    let stack = dotted(
        &[
            ("lines", 2.0),
            ("levels", 0.0),
            ("spacing_m", spacing.into()),
            ("size_px", 1.0),
        ],
        &[],
    );
    let [brute, gpu] = [DotCulling::Brute, DotCulling::Gpu]
        .map(|way| renderer.captured(&scene, &view, &stack, &on(way)));
    assert_eq!(brute.geometry.dots.len(), count);
    let in_view = |dot: &SnappedVertex| {
        dot.flags == 0 && (0..64 * 256).contains(&dot.x) && (0..48 * 256).contains(&dot.y)
    };
    assert!(
        brute.geometry.dots.iter().all(in_view),
        "{count}: some dots lie outside the view"
    );
    let expected =
        oracle::dot_strengths(&view, &stack, &brute.geometry.dots, &brute.frame.depth_key);
    assert!(
        brute.frame.dots == expected && gpu.frame.dots == expected,
        "{count}: not the dots that there are"
    );
}

#[test]
fn more_dots_than_fit_are_refused_with_their_number() {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = flat(&[[0.0; 3], [1e6, 0.0, 0.0]], [32, 24]);
    renderer.set_scene(&scene).block_on().expect("it fits");
    let stack = dotted(&[("lines", 2.0), ("spacing_m", 0.01)], &[]);
    let refused = [
        renderer
            .capture(&view, &stack, &unpinned())
            .block_on()
            .err()
            .map(|error: RenderError| error.to_string()),
        oracle::render(&scene, &view, &stack)
            .err()
            .map(|error| error.to_string()),
    ];
    for refused in refused {
        let refused = refused.expect("too many dots");
        assert!(
            refused.contains("dots") && refused.contains(&MAX_DOTS.to_string()),
            "{refused}"
        );
    }
    // And the renderer goes on.
    renderer.captured(
        &scene,
        &view,
        &dotted(&[("lines", 2.0), ("spacing_m", 1000.0)], &[]),
        &unpinned(),
    );
}

// -------- levels

fn parameters(values: &[(&str, f64)]) -> Dots {
    read(&dotted(values, &[]).get("dots").expect("just enabled").words)
}

#[test]
fn a_coarser_level_is_a_part_of_the_finer_one() {
    let dots = parameters(&[("levels", 24.0), ("fade", 0.5)]);
    let from = 1.0f32.to_bits();
    for halvings in 0..23u32 {
        for part in [0, 1, 1 << 22, (1 << 23) - 1] {
            let (near, far) = (
                from - (halvings << 23) - part,
                from - ((halvings + 1) << 23) - part,
            );
            for number in (0..5000).chain([1 << 22, 1 << 23, 3 << 20]) {
                let (strong, weak) = (
                    dots.strength(number, near, from),
                    dots.strength(number, far, from),
                );
                assert!(
                    weak <= strong,
                    "dot {number} comes back {halvings} halvings away"
                );
                let level = if number == 0 {
                    31
                } else {
                    number.trailing_zeros()
                };
                let stands = |wanted: u32, strength: u32| match level.cmp(&wanted) {
                    std::cmp::Ordering::Less => strength == 0,
                    std::cmp::Ordering::Equal => strength > 0 || part > 1 << 22,
                    std::cmp::Ordering::Greater => strength == FULL,
                };
                assert!(
                    stands(halvings, strong) && stands(halvings + 1, weak),
                    "dot {number}, {halvings} halvings and {part}"
                );
            }
        }
    }
}

#[test]
fn strength_changes_with_distance_by_no_more_than_it_must() {
    for fade in [1.0, 0.3, 0.0625] {
        let dots = parameters(&[("levels", 24.0), ("fade", fade)]);
        let from = 1.0f32.to_bits();
        // A 4,096th of an octave at a time: a strength fades from all to nothing in `fade` octaves.
        let most = (f64::from(FULL) / 4096.0 / fade).ceil() as u32 + 1;
        for number in [0, 1, 2, 3, 4, 8, 12, 1024, 1 << 20] {
            let mut before = FULL;
            for step in 0..23 * 4096 {
                let strength = dots.strength(number, from - step * 2048, from);
                assert!(
                    strength <= before && before - strength <= most,
                    "fade {fade}, dot {number}, step {step}: {before} to {strength}"
                );
                before = strength;
            }
        }
    }
    let all = parameters(&[("levels", 0.0)]);
    assert!(
        (0..100).all(|number| all.strength(number, 1e-6f32.to_bits(), 1.0f32.to_bits()) == FULL),
        "0 levels thin nothing"
    );
}

#[test]
fn a_dot_covers_its_area() {
    for size in [1.0, 1.5, 2.5, 8.0, 33.0] {
        let dots = parameters(&[("size_px", size)]);
        let covered = |cx: i64, cy: i64| -> u64 {
            let samples = (-20..20)
                .flat_map(|y| (-20..20).map(move |x| (256 * x + 128 - cx, 256 * y + 128 - cy)));
            samples
                .map(|(dx, dy): (i64, i64)| u64::from(dots.cover((dx * dx + dy * dy) as u64)))
                .sum()
        };
        // Samples are few; a dot is on average what it should be, wherever its middle lies.
        let all: u64 = (0..256)
            .step_by(16)
            .flat_map(|cy| (0..256).step_by(16).map(move |cx| (cx, cy)))
            .map(|(cx, cy)| covered(cx, cy))
            .sum();
        let (area, reference) = (
            all as f64 / 256.0 / f64::from(FULL),
            std::f64::consts::PI * size * size / 4.0,
        );
        assert!(
            (area - reference).abs() < 0.01 * reference + 0.1,
            "{size} px: {area} of {reference}"
        );
    }
}

/// Largest change of the mean strength from one picture to the next, as a fraction of the first,
/// from 3 m away to 6 m in so many steps: the gap halves once, everywhere at the same time.
fn largest_jump(fade: f64, steps: u32) -> f64 {
    // A zigzag, so that dots lie in all ways to the pixels.
    let zigzag: Vec<[f32; 3]> = (0..20u8)
        .map(|i| {
            [
                if i % 2 == 0 { -0.6 } else { 0.6 },
                f32::from(i) * 0.067 - 0.6,
                0.0,
            ]
        })
        .collect();
    let values = [
        ("lines", 2.0),
        ("spacing_m", 0.04),
        ("min_gap_px", 4.0),
        ("size_px", 2.0),
        ("show_model", 0.0),
        ("hidden_opacity", 1.0),
        ("fade", fade),
    ];
    let (scene, stack) = (scene("stack?layers=1"), dotted(&values, &[]));
    let mean = |step: u32| {
        let eye = [0.0, 0.0, 3.0 * (f64::from(step) / f64::from(steps)).exp2()].into();
        let camera = rasterlab::scene::camera::Camera {
            eye,
            target: [0.0; 3].into(),
            ..Default::default()
        };
        let mut view = camera_view(&scene, &camera, [160, 120]);
        view.scene_state.polyline = zigzag.as_slice().into();
        let records = oracle::dot_records(&oracle::Shot::new(
            &scene,
            &draws(&scene, &view).expect("it fits"),
            &view,
            &stack,
        ))
        .expect("they fit");
        let strengths = oracle::dot_strengths(&view, &stack, &records, &vec![0; view.pixels()]);
        strengths.iter().map(|s| f64::from(*s)).sum::<f64>()
            / strengths.len() as f64
            / f64::from(FULL)
    };
    let means: Vec<f64> = (0..=steps).map(mean).collect();
    assert!(
        means[0] > 0.02 && means[steps as usize] < 0.7 * means[0],
        "nothing thins: {} to {}",
        means[0],
        means[steps as usize]
    );
    means
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs() / means[0])
        .fold(0.0, f64::max)
}

#[test]
fn moving_away_never_jumps() {
    // What is continuous changes in proportion to the step.
    let (coarse, fine) = (largest_jump(1.0, 16), largest_jump(1.0, 256));
    println!("largest change of the mean strength: {coarse:.4} in 16 steps, {fine:.4} in 256");
    assert!(
        fine < 0.01 && fine < coarse / 4.0,
        "in 16 steps by {coarse}, in 256 by {fine}"
    );
    // Dots that fade in a sixteenth of the time are the jump that this would show.
    let hasty = largest_jump(0.0625, 256);
    assert!(
        hasty > 2.0 * fine,
        "hasty fading jumps by {hasty}, slow by {fine}"
    );
}

// -------- mutants

fn every_mistake_in_the_dots_shows(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let scene = scene("cube-wall");
    let view = view(&scene, [160, 120]);
    let stack = dotted(
        &[
            ("lines", 1.0),
            ("spacing_m", 0.03),
            ("min_gap_px", 8.0),
            ("size_px", 3.0),
        ],
        &["lambert"],
    );
    let mistakes = [
        (
            "vec4f(f32(index) * r.step)",
            "vec4f(f32(index + 1u) * r.step)",
        ),
        (
            "let shown_level = halved >> DOTS_STEPS;",
            "let shown_level = (halved >> DOTS_STEPS) + 1u;",
        ),
        ("atomicMax(&color[", "atomicAdd(&color["),
        ("let stride = 1u << level;", "let stride = 2u << level;"),
        ("(dot_count + 63u) / 64u", "dot_count / 64u"),
        (
            "strength * dot_frame.ink.a",
            "strength * strength * dot_frame.ink.a",
        ),
    ];
    let right = captured(
        &mut Renderer::new(gpu.clone()),
        &scene,
        &view,
        &stack,
        &unpinned(),
    );
    assert!(
        right
            .frame
            .dots
            .iter()
            .any(|strength| (1..FULL).contains(strength))
    );
    for (from, to) in reach.of(3, mistakes) {
        let wrong = mutated(from, to);
        let mut renderer = Renderer::with_library(gpu.clone(), wrong.shaders());
        let (_, verdict) = renderer.judged(&scene, &view, &stack, &unpinned());
        assert!(
            exactness(&verdict.report).is_err(),
            "{from:?} as {to:?} passes"
        );
    }
    assert!(options(&Renderer::new(gpu)).contains(&Visibility::Split32));
}

few_and_all!(
    three_ways_of_choosing_dots_give_the_oracle_s_picture,
    close_views_leave_most_lines_out_and_no_dot,
    every_backend_of_visibility_hides_the_same_dots,
    every_mistake_in_the_dots_shows,
    no_number_of_dots_is_lost,
);
