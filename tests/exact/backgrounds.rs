//! Promise: the rows of a background gradient are the bytes of linear light, the same on the
//! adapter and in the oracle, and everything that shows or reads the background reads that of its
//! row. Needs an adapter.

use rasterlab::{
    accuracy::{PinnedOptions, RenderScale},
    effects::Stack,
    frame::NO_TRIANGLE,
    gpu::Renderer,
    measure::compare::pictures,
    oracle,
    plan::{AccuracyRequest, Tier, Tuning},
    preset::{Clock, Output, Preset},
    scene::{Background, view::View},
};
use rasterlab_fuzz::stress::culling::walk;

use crate::common::*;

const SIZE: [u32; 2] = [96, 72];
const GRADIENT: Background = Background {
    top: [0.9, 0.02, 0.1, 1.0],
    bottom: [0.01, 0.6, 0.1, 0.2],
};

/// The bytes of a row, from the standard's formula (IEC 61966-2-1).
fn row(y: u32, height: u32) -> [u8; 4] {
    let t = f64::from(2 * y + 1) / f64::from(2 * height);
    let mixed =
        |c: usize| f64::from(GRADIENT.top[c]) * (1.0 - t) + f64::from(GRADIENT.bottom[c]) * t;
    let encode = |light: f64| {
        if light <= 0.003_130_8 {
            12.92 * light
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
    };
    [
        encode(mixed(0)),
        encode(mixed(1)),
        encode(mixed(2)),
        mixed(3),
    ]
    .map(|value| (255.0 * value).round() as u8)
}

fn view_of(scene: &rasterlab::scene::Scene, background: Background) -> View {
    View {
        background,
        ..view(scene, SIZE)
    }
}

fn with(names: &[&str], set: &[(&str, &str, f64)]) -> Stack {
    let mut stack = stack(names);
    for &(effect, field, value) in set {
        let enabled = stack
            .0
            .iter_mut()
            .find(|enabled| enabled.effect.name == effect)
            .expect("it is enabled");
        enabled
            .effect
            .field(field)
            .expect("a field")
            .set(&mut enabled.words, &[value])
            .expect("it is allowed");
    }
    stack
}

#[test]
fn empty_pixels_are_the_bytes_of_their_row_with_every_option_and_tuning() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=4");
    let view = view_of(&scene, GRADIENT);
    for (tuning, option) in tunings()
        .into_iter()
        .zip(options(&renderer).into_iter().cycle())
    {
        renderer.set_tuning(tuning);
        let (capture, _) = renderer.exact(
            &scene,
            &view,
            &stack(&["lambert"]),
            &pinned(option),
            option.name(),
        );
        let empty: Vec<usize> = (0..view.pixels())
            .filter(|&i| capture.frame.triangle_id[i] == NO_TRIANGLE)
            .collect();
        assert!(
            empty.len() > 1000 && empty.len() < view.pixels(),
            "{}",
            empty.len()
        );
        for i in empty {
            let y = i as u32 / SIZE[0];
            assert_eq!(
                capture.frame.color[i],
                row(y, SIZE[1]),
                "row {y} with {} and {tuning:?}",
                option.name()
            );
        }
    }
}

/// Where the resolve visits listed tiles, the others keep what they show. A model that moves,
/// another size, another background and effects that visit every pixel must leave nothing of the
/// pictures before.
fn tiles_that_a_model_leaves_show_the_background_again(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let tuning = Tuning {
        listed_tiles: true,
        ..gpu.caps.tuning()
    };
    let fresh = || {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_tuning(tuning);
        renderer
    };
    let scenes = [
        scene("teapot?tess=4"),
        scene("cube-wall?columns=4&rows=3"),
        scene("sphere?triangles=200"),
    ];
    let stacks = [
        stack(&["lambert"]),
        stack(&["lambert", "outline"]),
        stack(&["xray"]),
        stack(&["lambert", "dots"]),
        stack(&["overdraw"]),
    ];
    let backgrounds = [Background::from([0.0, 0.2, 0.4, 1.0]), GRADIENT];
    let mut rng = Rng(36);
    let mut renderer = fresh();
    let (mut left, mut before) = (0, Vec::new());
    for turn in reach.of(24, 0..60) {
        // Most pictures differ from the one before by the camera alone.
        let [at, which, behind] = [turn / 20, turn / 3, turn / 7];
        let (scene, stack) = (
            &scenes[at % 3],
            &stacks[if turn % 3 == 0 { which % 5 } else { 0 }],
        );
        let size = if turn % 11 == 10 { [65, 63] } else { SIZE };
        let moved = walk(scene, &mut rng, 1, size).remove(0);
        let view = View {
            background: backgrounds[behind % 2],
            ..moved
        };
        let drawn = renderer.captured(scene, &view, stack, &unpinned()).frame;
        let alone = captured(&mut fresh(), scene, &view, stack, &unpinned()).frame;
        assert!(
            drawn.color == alone.color,
            "turn {turn}: another picture than that of a renderer that drew nothing before"
        );
        let covered: Vec<bool> = drawn
            .triangle_id
            .iter()
            .map(|id| *id != NO_TRIANGLE)
            .collect();
        if covered.len() == before.len() {
            left += std::iter::zip(&before, &covered)
                .filter(|(before, now)| **before && !**now)
                .count();
        }
        before = covered;
    }
    assert!(left > 1000, "models left only {left} pixels");
}

/// A background of one color needs no rows: the buffers and the picture are those without a
/// gradient.
#[test]
fn a_gradient_between_equal_colors_is_one_color() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=4");
    let color = [0.3, 0.2, 0.05, 1.0];
    let output = Output {
        background: color,
        background_bottom: Some(color),
        ..Output::default()
    };
    assert_eq!(output.backdrop(), Background::from(color));
    let mut draw = |background: Background| {
        let capture = renderer.captured(
            &scene,
            &view_of(&scene, background),
            &stack(&["xray"]),
            &split32(),
        );
        capture.frame.color
    };
    let plain = draw(output.backdrop());
    assert_ne!(draw(GRADIENT), plain);
    assert_eq!(draw(color.into()), plain, "and comes back after a gradient");
}

/// Every effect that reads the background, or finishes pixels on it.
fn readers() -> Vec<Stack> {
    vec![
        with(&["xray"], &[("xray", "opacity", 0.4)]),
        stack(&["overdraw"]),
        with(&["lambert", "dots"], &[("dots", "show_model", 0.0)]),
        stack(&["lambert", "dots"]),
        stack(&["lambert", "outline"]),
        with(&["lambert", "posterize"], &[("posterize", "levels", 4.0)]),
        with(&["lambert", "dither"], &[("dither", "levels", 4.0)]),
        stack(&["fog", "lambert"]),
    ]
}

fn what_reads_the_background_reads_that_of_its_row(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=8");
    let view = view_of(&scene, GRADIENT);
    for listed in reach.of(1, [true, false]) {
        renderer.set_tuning(
            tunings()
                .into_iter()
                .find(|tuning| tuning.listed_tiles == listed)
                .expect("a tuning"),
        );
        for stack in reach.of(4, readers()) {
            let names: Vec<&str> = stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.as_str())
                .collect();
            renderer.exact(
                &scene,
                &view,
                &stack,
                &split32(),
                &format!("{names:?}, listed tiles: {listed}"),
            );
        }
    }
}

fn spinning() -> Preset {
    let stack = with(
        &["lambert", "smear"],
        &[
            ("smear", "fade", 0.3),
            ("smear", "frames", 4.0),
            ("smear", "step_s", 0.1),
        ],
    );
    let clock = Clock {
        time_s: 0.7,
        ..Clock::default()
    };
    let mut preset = Preset {
        spin_deg_per_s: 90.0,
        clock,
        stack,
        ..Preset::default()
    };
    preset.output = Output {
        size: SIZE,
        background: GRADIENT.top,
        background_bottom: Some(GRADIENT.bottom),
        reference_height_px: None,
    };
    preset
}

fn trails_start_from_the_gradient_and_fade_to_it(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let reference =
        oracle::render_sequence(&scene, &spinning().moments(&scene, SIZE)).expect("it is drawn");
    let trail = |i: &usize| {
        reference.triangle_id[*i] == NO_TRIANGLE
            && reference.color[*i] != row(*i as u32 / SIZE[0], SIZE[1])
    };
    assert!((0..reference.color.len()).filter(trail).count() > 200);
    for option in reach.options(&renderer) {
        let (capture, verdict) = renderer.judged_preset(&scene, &spinning(), &pinned(option));
        exactness(&verdict.report).unwrap_or_else(|why| panic!("{}: {why}", option.name()));
        let far = pictures(&capture.frame.color, &reference.color, 1);
        assert!(far.pixels_over_tolerance <= 2, "{}: {far:?}", option.name());
    }
}

#[test]
fn anti_aliasing_averages_rows_of_the_larger_picture() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=4");
    let view = view_of(&scene, GRADIENT);
    // A mean is weighted by opacity, so it may leave the row of the shown picture by a little.
    for (scale, rows, tolerance) in [
        (RenderScale::Double, SIZE[1], 6),
        (RenderScale::Quadruple, SIZE[1], 6),
        (RenderScale::Half, SIZE[1] / 2, 1),
    ] {
        let accuracy = AccuracyRequest {
            tier: Tier::Strict,
            pins: PinnedOptions::of(scale),
            ..AccuracyRequest::default()
        };
        let (capture, verdict) = renderer.judged(&scene, &view, &stack(&["lambert"]), &accuracy);
        assert!(
            verdict.report.max_color_delta <= 1,
            "{scale:?}: {:?}",
            verdict.report
        );
        let shown = &capture.shown.as_ref().expect("it is scaled").color;
        for (actual, expected) in [
            (shown[0], row(0, rows)),
            (shown[shown.len() - 1], row(rows - 1, rows)),
        ] {
            assert!(
                (0..4).all(|c| actual[c].abs_diff(expected[c]) <= tolerance),
                "{scale:?}: {actual:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn a_kernel_that_reads_another_row_is_caught() {
    let Some(healthy) = loan() else { return };
    let gpu = healthy.gpu().clone();
    let scene = scene("knot?tess=8");
    let view = view_of(&scene, GRADIENT);
    let mutants = [
        ("frame.background_first + y", "frame.background_first"),
        (
            "background = background_of_row(pixel.y);\n    var encoded",
            "background = background_of_row(pixel.x);\n    var encoded",
        ),
    ];
    for (from, to) in mutants {
        let mut wrong = Mistaken::new(&gpu, from, to);
        for stack in [
            stack(&["lambert"]),
            with(&["xray"], &[("xray", "opacity", 0.4)]),
        ] {
            let (_, verdict) = wrong.judged(&scene, &view, &stack, &split32());
            assert!(
                verdict.report.max_color_delta > 1,
                "{to:?}: {:?}",
                verdict.report
            );
        }
    }
}

/// A list that leaves out tiles: of the picture before, of this one, or of the background that
/// effects finish.
#[test]
fn a_list_that_forgets_tiles_is_caught() {
    let Some(gpu) = gpu() else { return };
    let scene = scene("teapot?tess=4");
    let tuning = Tuning {
        listed_tiles: true,
        ..gpu.caps.tuning()
    };
    let behind = |view: View| View {
        background: GRADIENT,
        ..view
    };
    let views: Vec<View> = [view(&scene, SIZE)]
        .into_iter()
        .chain(walk(&scene, &mut Rng(3), 6, SIZE))
        .map(behind)
        .collect();
    let pictures = |mut renderer: Renderer, stack: &Stack| -> Vec<Vec<[u8; 4]>> {
        renderer.set_tuning(tuning);
        views
            .iter()
            .map(|view| {
                renderer
                    .captured(&scene, view, stack, &unpinned())
                    .frame
                    .color
            })
            .collect()
    };
    let stack = stack(&["lambert"]);
    let library = mutated(
        "TILE_DRAWN_BEFORE, mark == TILE_DRAWN",
        "0u, mark == TILE_DRAWN",
    );
    let wrong = pictures(
        Renderer::with_library(gpu.clone(), library.shaders()),
        &stack,
    );
    assert!(
        wrong != pictures(Renderer::new(gpu), &stack),
        "tiles of the picture before are not missed"
    );
}

few_and_all!(
    tiles_that_a_model_leaves_show_the_background_again,
    what_reads_the_background_reads_that_of_its_row,
    trails_start_from_the_gradient_and_fade_to_it,
);
