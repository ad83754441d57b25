//! Promise: x-ray, overdraw and race do what they say with all the samples of a pixel: sums that no
//! order shows, counts that are exact, overflow that is never silent, and a race that loses no more
//! than it may. Needs an adapter but for the first.

use std::sync::Arc;

use glam::DVec3;
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::Visibility,
    effects::{Effect, Stack, hooks::Layers, xray},
    gpu::{RenderError, Renderer},
    measure::ErrorReport as Errors,
    oracle,
    plan::Tuning,
    preset_file,
    scene::{Scene, view::View},
};

use crate::common::*;

/// A stack of effects with values: `"xray.weight=facing"`, or a name alone.
fn with(values: &[&str]) -> Stack {
    let mut preset_file = preset_file::parse("schema = 2\n", "test").expect("an empty look");
    for value in values {
        let (path, value) = value.split_once('=').unwrap_or((value, ""));
        preset_file::set(&mut preset_file, path, value).unwrap_or_else(|error| panic!("{error}"));
    }
    preset_file.preset.stack
}

/// Position, normal, color.
type Corner = ([f32; 3], [f32; 3], [f32; 4]);

/// Triangles all over a picture of `side` pixels, each with its own colors, normals and depths.
fn soup(seed: u32, count: usize, side: i32, darkest: f64) -> Vec<[Corner; 3]> {
    let mut rng = Rng(seed);
    let corner = |rng: &mut Rng| {
        let at = [
            rng.between(-2000, 256 * side + 2000),
            rng.between(-2000, 256 * side + 2000),
        ];
        let position = [
            at[0] as f32 / 256.0,
            at[1] as f32 / 256.0,
            rng.real(0.05, 0.95) as f32,
        ];
        let normal = DVec3::new(
            rng.real(-1.0, 1.0),
            rng.real(-1.0, 1.0),
            rng.real(-1.0, 1.0),
        )
        .normalize_or(DVec3::Z);
        let mut channel = || (darkest * rng.real(0.02, 1.0)) as f32;
        (
            position,
            normal.as_vec3().to_array(),
            [channel(), channel(), channel(), 1.0],
        )
    };
    (0..count)
        .map(|_| [corner(&mut rng), corner(&mut rng), corner(&mut rng)])
        .collect()
}

fn scene_from(triangles: &[[Corner; 3]]) -> Arc<Scene> {
    let corners = || triangles.iter().flatten();
    scene_of_meshes(&[SimpleMesh {
        positions: corners().map(|corner| corner.0).collect(),
        normals: corners().map(|corner| corner.1).collect(),
        colors: corners().map(|corner| corner.2).collect(),
        ..SimpleMesh::default()
    }])
}

/// `count` layers that cover every pixel, half of them of one color and half of another, from six
/// vertices.
fn pile(count: u32) -> Arc<Scene> {
    let corners = |depth: f32| {
        [
            [-4.0, -4.0, depth],
            [40.0, -4.0, depth],
            [-4.0, 40.0, depth],
        ]
    };
    let colors = [[1.0, 0.0, 0.25, 1.0], [0.0, 1.0, 0.25, 1.0]];
    scene_of_meshes(&[SimpleMesh {
        positions: [corners(0.5), corners(0.25)].concat(),
        colors: colors.iter().flat_map(|color| [*color; 3]).collect(),
        indices: (0..count)
            .flat_map(|layer| [0, 1, 2].map(|corner| 3 * (layer % 2) + corner))
            .collect(),
        ..SimpleMesh::default()
    }])
}

fn shuffled<T>(rng: &mut Rng, mut list: Vec<T>) -> Vec<T> {
    for last in (1..list.len()).rev() {
        let other = rng.between(0, last as i32 + 1) as usize;
        list.swap(last, other);
    }
    list
}

// -------- two in one slot

#[test]
fn two_effects_in_one_slot_are_refused_in_one_sentence_that_names_both() {
    let sentence =
        "xray and overdraw both take the visibility slot of the rasterizer; switch one of them off";
    let text = "schema = 2\n[effects.overdraw]\nfull = 4\n[effects.xray]\n";
    let error = preset_file::parse(text, "both")
        .expect_err("two effects in one slot")
        .to_string();
    assert_eq!(error, format!("both.toml:2: effects {sentence}"));

    let mut preset_file =
        preset_file::parse("schema = 2\n[effects.xray]\n", "one").expect("one effect");
    for (path, value) in [("overdraw", ""), ("overdraw.max_layers", "4")] {
        let error = preset_file::set(&mut preset_file, path, value)
            .expect_err("a second effect")
            .to_string();
        assert_eq!(error, format!("--set: effects {sentence}"), "{path}");
    }
    assert!(
        preset_file.preset.stack.get("overdraw").is_none(),
        "nothing was switched on"
    );
    preset_file::unset(&mut preset_file, "xray").expect("it is on");
    preset_file::set(&mut preset_file, "overdraw", "").expect("now the slot is free");

    let error = stack(&["xray", "race"])
        .check()
        .expect_err("two effects in one slot")
        .to_string();
    assert_eq!(
        error,
        "xray and race both take the visibility slot of the rasterizer; switch one of them off"
    );
}

// -------- x-ray

fn the_average_is_bit_equal_in_any_order_on_every_run_option_and_tuning(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let triangles = soup(1, 300, 64, 1.0);
    let (view, stack) = (pixel_view(64, 64), with(&["lambert", "xray.weight=facing"]));
    let draw = |renderer: &mut Renderer, scene: &Arc<Scene>, option| {
        let frame = renderer
            .captured(scene, &view, &stack, &pinned(option))
            .frame;
        (frame.color, frame.layer_sums)
    };
    let scene = scene_from(&triangles);
    let first = draw(&mut renderer, &scene, Visibility::Split32);
    assert!(
        first.1.iter().filter(|&&weight| weight > 20).count() > 1000,
        "many layers"
    );
    for run in reach.of(4, 0..20) {
        assert!(
            draw(&mut renderer, &scene, Visibility::Split32) == first,
            "run {run}"
        );
    }
    let mut rng = Rng(7);
    for option in reach.options(&renderer) {
        for tuning in reach.of(2, tunings()) {
            renderer.set_tuning(tuning);
            let scene = scene_from(&shuffled(&mut rng, triangles.clone()));
            assert!(
                draw(&mut renderer, &scene, option) == first,
                "shuffled, {} {tuning:?}",
                option.name()
            );
        }
    }
}

#[test]
fn more_layers_than_any_sum_holds_are_a_sentence_and_a_mark_never_silent() {
    let Some(mut renderer) = loan() else { return };
    let view = pixel_view(2, 2);
    let count = xray::capacity(8) / xray::FULL_WEIGHT + 2;
    let scene = pile(count);
    let stack = with(&["xray.weight=facing"]);
    renderer.set_scene(&scene).block_on().expect("it fits");
    match renderer.capture(&view, &stack, &unpinned()).block_on() {
        Err(error @ RenderError::FullSums(4)) => {
            let text = error.to_string();
            assert!(
                text.starts_with(
                    "4 pixels have more layers than the x-ray's sums hold even with 8 bits"
                ),
                "{text}"
            );
        }
        other => panic!(
            "{:?} of {count} layers",
            other.map(|capture| capture.frame.color)
        ),
    }
    // Asynchronously, as a window draws: with 8 bits it overflows, and the counters say so.
    renderer
        .draw(&view, &stack, &unpinned())
        .block_on()
        .expect("a frame");
    let report = renderer.finish().block_on().expect("stats");
    assert_eq!((report.counters.full_pixels, report.redraw), (4, false));
    // One layer fewer than too many is right.
    let scene = pile(count - 2);
    let (capture, _) = renderer.exact(&scene, &view, &stack, &unpinned(), "as many as fit");
    assert_eq!(
        capture.frame.layer_sums,
        vec![(count - 2) * xray::FULL_WEIGHT; 4]
    );
}

fn windows_weights_and_opacities_are_the_oracles(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let flat = (scene_from(&soup(3, 120, 48, 0.6)), pixel_view(48, 48));
    let knot = scene("knot?tess=6");
    let deep = (knot.clone(), view(&knot, [120, 90]));
    let hall = scene("near");
    let cut = (hall.clone(), view(&hall, [96, 72]));
    let options = reach.options(&renderer);
    let windows = [
        "xray.layers=all",
        "xray.layers=window,xray.window=0",
        "xray.layers=window,xray.window=30",
        "xray.layers=window,xray.window=500",
    ];
    let weights = reach.of(2, ["facing", "near", "equal", "grazing"]);
    for (turn, weight) in weights.into_iter().enumerate() {
        for (i, window) in windows.iter().enumerate() {
            let weight = format!("xray.weight={weight}");
            let mut values = vec![
                "lambert",
                weight.as_str(),
                ["xray.opacity=1", "xray.opacity=0.3"][i % 2],
            ];
            values.extend(window.split(','));
            let stack = with(&values);
            // Every weight meets every window, and both meet every scene.
            let (what, (scene, view)) =
                [("soup", &flat), ("knot", &deep), ("hall", &cut)][(i + turn) % 3];
            let what = format!("{what} {values:?}");
            let (_, verdict) = renderer.exact(
                scene,
                view,
                &stack,
                &pinned(options[i % options.len()]),
                &what,
            );
            let a = &verdict.report;
            // A pixel is open where a boundary between two bytes lies within its bound. In the
            // hall, many of whose triangles are cut by the near plane, that is one
            // pixel in ten (708 of 6,912 at most); a vacuous bound opens all.
            assert!(
                a.ambiguous_layer_pixels <= a.pixels / 8,
                "{what}: {} of {} pixels are open",
                a.ambiguous_layer_pixels,
                a.pixels
            );
        }
    }
    // A window of nothing is the front alone, for everything behind it.
    let (scene, view) = &deep;
    let bare = renderer
        .captured(scene, view, &with(&["normals"]), &unpinned())
        .frame;
    let front = renderer
        .captured(
            scene,
            view,
            &with(&["normals", "xray.layers=window", "xray.window=0"]),
            &unpinned(),
        )
        .frame;
    assert_eq!(front.triangle_id, bare.triangle_id);
    let delta = rasterlab::measure::compare::pictures(&front.color, &bare.color, 1);
    assert!(
        delta.pixels_over_tolerance < 8,
        "{} pixels",
        delta.pixels_over_tolerance
    );
}

// -------- race

fn a_race_is_exact_where_one_layer_covers_and_elsewhere_a_covering_triangle_wins(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let lonely = scene("grid?cell=1");
    let view_of = |scene: &Arc<Scene>| view(scene, [160, 120]);
    let (capture, verdict) = renderer.exact(
        &lonely,
        &view_of(&lonely),
        &stack(&["race"]),
        &unpinned(),
        "one layer",
    );
    let alone = renderer
        .captured(&lonely, &view_of(&lonely), &stack(&[]), &unpinned())
        .frame;
    assert_eq!(
        (verdict.report.race_pixels, &capture.frame.triangle_id),
        (0, &alone.triangle_id)
    );

    let crowded = scene_from(&soup(5, 400, 64, 1.0));
    let view = pixel_view(64, 64);
    for tuning in reach.of(1, tunings()) {
        renderer.set_tuning(tuning);
        for delay in [0, 4] {
            let stack = with(&["race", &format!("race.delay={delay}")]);
            let (_, verdict) =
                renderer.exact(&crowded, &view, &stack, &unpinned(), &format!("{tuning:?}"));
            eprintln!(
                "delay {delay}, {tuning:?}: {} of {} pixels lost",
                verdict.report.race_pixels, verdict.report.pixels
            );
        }
    }
}

#[test]
fn the_judge_counts_what_a_race_lost_and_refuses_what_it_cannot_lose() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene_from(&soup(5, 60, 32, 1.0));
    let (view, plain, racing) = (pixel_view(32, 32), stack(&[]), stack(&["race"]));
    let capture = renderer.captured(&scene, &view, &plain, &unpinned());
    let judge = |frame: &rasterlab::frame::Frame, stack: &Stack| {
        oracle::judge(
            &scene,
            &view,
            stack,
            &rasterlab::frame::AdapterPicture {
                frame,
                previous: None,
                ..capture.picture()
            },
        )
        .expect("it fits")
        .report
    };
    // Another triangle of the same pixel: what is drawn once the triangle id is gone.
    let pixel = capture
        .layers
        .as_ref()
        .expect("counted")
        .iter()
        .position(|&layers| layers > 3)
        .expect("a crowded pixel");
    let covering: Vec<u32> = (0..60)
        .filter(|&id| id != capture.frame.triangle_id[pixel])
        .filter(|&id| {
            let mut claim = capture.frame.triangle_id.clone();
            claim[pixel] = id;
            let frame = rasterlab::frame::Frame {
                triangle_id: claim,
                ..capture.frame.clone()
            };
            judge(&frame, &racing).wrong_triangles == 0
        })
        .collect();
    let layers = capture.layers.as_ref().expect("counted")[pixel];
    assert_eq!(
        covering.len() as u32,
        layers - 1,
        "the others that cover the sample, and none that does not"
    );
    let mut lost = capture.frame.clone();
    lost.triangle_id[pixel] = covering[0];
    assert_eq!(
        (
            judge(&lost, &racing).race_pixels,
            judge(&lost, &racing).wrong_triangles
        ),
        (1, 0)
    );
    assert_eq!(
        (
            judge(&lost, &plain).race_pixels,
            judge(&lost, &plain).wrong_triangles
        ),
        (0, 1),
        "nobody else may lose"
    );
}

// -------- work that is not there

#[test]
fn without_these_effects_there_is_no_pass_no_buffer_and_no_text_of_theirs() {
    let Some(gpu) = gpu() else { return };
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [64, 48]);
    let explained = |names: &[&str], option| {
        let mut renderer = Renderer::new(gpu.clone());
        renderer
            .set_scene(&scene)
            .block_on()
            .expect("a builtin fits");
        renderer
            .draw_complete(&view, &stack(names), &pinned(option))
            .block_on()
            .expect("a builtin is drawn");
        renderer.explain()
    };
    let pixels = view.pixels() as u64;
    let option = Visibility::Split32;
    let plain = explained(&["lambert"], option);
    let bytes = |explanation: &rasterlab::gpu::Explanation, name: &str| {
        explanation
            .buffers
            .iter()
            .find(|b| b.name == name)
            .map(|b| b.bytes)
    };
    let passes = |explanation: &rasterlab::gpu::Explanation| {
        explanation
            .passes
            .iter()
            .map(|pass| pass.name.clone())
            .collect::<Vec<_>>()
    };
    assert!(
        passes(&plain).iter().all(|pass| !["sum", "count", "race"]
            .iter()
            .any(|phase| pass.ends_with(phase))),
        "{:?}",
        passes(&plain)
    );
    assert_eq!(
        (bytes(&plain, "layers"), bytes(&plain, "depth_keys")),
        (None, Some(4 * pixels))
    );
    assert!(plain.reasons.iter().all(|note| note.name != "layers"));

    let sums = explained(&["lambert", "xray"], option);
    assert!(
        passes(&sums).contains(&"raster_small sum".to_owned())
            && sums.key.contains("layers=xray/16"),
        "{}",
        sums.key
    );
    assert_eq!(
        (bytes(&sums, "layers"), bytes(&sums, "depth_keys")),
        (None, Some(20 * pixels)),
        "16 bytes per pixel more"
    );
    let heat = explained(&["lambert", "overdraw"], option);
    assert!(
        passes(&heat).contains(&"raster_small count".to_owned())
            && heat.key.contains("layers=overdraw")
    );
    assert_eq!(bytes(&heat, "layers"), Some(4 * pixels));
    let race = explained(&["lambert", "race"], option);
    assert_eq!(
        passes(&race)
            .iter()
            .filter(|pass| pass.starts_with("raster"))
            .collect::<Vec<_>>(),
        ["raster_small race"]
    );
    assert!(race.key.contains("visibility=race") && bytes(&race, "depth_keys").is_none());
}

// -------- mutants

type Figure = (&'static str, fn(&Errors) -> u64);

const COUNTS: Figure = ("layer_counts_wrong", |e| e.layer_counts_wrong);
const COLORS: Figure = ("max_color_delta", |e| {
    u64::from(e.max_color_delta.saturating_sub(1))
});
const TRIANGLE_IDS: Figure = ("wrong_triangles", |e| e.wrong_triangles);

struct Mutant {
    what: &'static str,
    from: &'static str,
    to: &'static str,
    stack: Stack,
    shown_by: Figure,
}

fn mutants() -> Vec<Mutant> {
    let mutant = |what, from, to, values: &[&str], shown_by| Mutant {
        what,
        from,
        to,
        stack: with(values),
        shown_by,
    };
    vec![
        mutant(
            "sums of 8 bits",
            "* f32(whole))) * weight",
            "* 255.0)) * (whole / 255u) * weight",
            &["xray"],
            COLORS,
        ),
        mutant(
            "count 1 for a merged group",
            "xray_buffer_add(pixel, layer)",
            "xray_buffer_add(pixel, select(layer, vec4u(layer.xyz, 0u), pixel % 32u == 31u))",
            &["xray"],
            COUNTS,
        ),
        mutant(
            "weights of 7 bits",
            "clamp(fraction * 255.0, 1.0, 255.0)",
            "2.0 * clamp(fraction * 127.0, 1.0, 127.0)",
            &["xray.weight=facing"],
            COUNTS,
        ),
        mutant(
            "a layer is counted twice",
            "atomicAdd(&layers[pixel], 1u);",
            "atomicAdd(&layers[pixel], select(1u, 2u, id == 7u));",
            &["overdraw"],
            COUNTS,
        ),
        mutant(
            "heat one stop too warm",
            "p.palette * 9u + first]",
            "p.palette * 9u + first + 1u]",
            &["overdraw"],
            COLORS,
        ),
        mutant(
            "a race that stores another's triangle id",
            "depth_and_id[2u * pixel] = ~id;",
            "depth_and_id[2u * pixel] = ~(id + 1u);",
            &["race"],
            TRIANGLE_IDS,
        ),
    ]
}

fn layers_with_a_mistake_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    // Dark, because steps of linear light are widest there.
    let (scene, view): (Arc<Scene>, View) =
        (scene_from(&soup(11, 60, 48, 0.08)), pixel_view(48, 48));
    let tuning = Tuning {
        specialized: true,
        ..healthy.gpu().caps.tuning()
    };
    let mut failures = Vec::new();
    for Mutant {
        what,
        from,
        to,
        stack,
        shown_by: (figure, shown_by),
    } in reach.of(3, mutants())
    {
        healthy.exact(
            &scene,
            &view,
            &stack,
            &split32(),
            &format!("without the mistake: {what}"),
        );
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        wrong.set_tuning(tuning);
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &split32());
        eprintln!(
            "{what}: {}",
            exactness(&verdict.report).err().unwrap_or_default()
        );
        if exactness(&verdict.report).is_ok() || shown_by(&verdict.report) == 0 {
            failures.push(format!(
                "{what} does not show in {figure}: {:?}",
                verdict.report
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn a_card_lists_the_covered_samples_of_a_small_box_and_draws_each_of_them(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    // No box has more than the 32 pixels of the picture.
    let (scene, view, stack) = (
        scene_from(&soup(5, 120, 7, 0.08)),
        pixel_view(8, 4),
        with(&["xray"]),
    );
    let usual = renderer.gpu().caps.tuning();
    let card = Tuning {
        max_small_samples: 32,
        max_small_side: 32,
        specialized: true,
        ..usual
    };
    for option in reach.options(&renderer) {
        let whole = renderer
            .captured(&scene, &view, &stack, &pinned(option))
            .frame;
        renderer.set_tuning(card);
        let (listed, _) = renderer.exact(&scene, &view, &stack, &pinned(option), option.name());
        renderer.set_tuning(usual);
        assert_eq!(
            (&listed.frame.color, &listed.frame.layer_sums),
            (&whole.color, &whole.layer_sums),
            "{}",
            option.name()
        );
    }
}

#[test]
fn every_effect_of_the_slot_is_known_to_the_planner() {
    let of = |name: &str| stack(&[name]).layers(1000);
    let slot = |effect: &&std::sync::Arc<Effect>| {
        effect.hooks.slot == Some(rasterlab::effects::hooks::Slot::Visibility)
    };
    for effect in rasterlab::effects::EFFECTS.iter().filter(slot) {
        assert_eq!(
            of(&effect.name).map(Layers::name),
            Some(effect.name.as_str())
        );
    }
}

few_and_all!(
    the_average_is_bit_equal_in_any_order_on_every_run_option_and_tuning,
    windows_weights_and_opacities_are_the_oracles,
    a_race_is_exact_where_one_layer_covers_and_elsewhere_a_covering_triangle_wins,
    layers_with_a_mistake_are_caught,
    a_card_lists_the_covered_samples_of_a_small_box_and_draws_each_of_them,
);
