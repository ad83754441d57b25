//! Promise: every option of the accuracy axes draws, errs as it says, and no more; those that
//! promise exactness keep it. Needs an adapter.

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{
        Clipping, Coverage, Culling, DepthFormat, Parameters, Perspective, PinnedOptions,
        PositionFormat, RenderScale, SampleCounter, ShaderChecks, VertexTransform, XraySums,
    },
    gpu::{Capture, RenderError, Renderer},
    measure::{Verdict, compare},
    oracle,
    plan::{AccuracyRequest, PlanError, Tier},
    scene::{Scene, camera::Camera, view::View},
};

use crate::common::*;

mod positions;

fn verdict(
    renderer: &mut Renderer,
    query: &str,
    size: [u32; 2],
    pins: PinnedOptions,
) -> (Capture, Verdict) {
    let scene = scene(query);
    let view = view(&scene, size);
    renderer.judged(&scene, &view, &stack(&["lambert"]), &request(pins))
}

/// Pixels whose triangle id is not that of the oracle's picture on its finest grid.
fn wrong_pixels(
    renderer: &mut Renderer,
    scene: &std::sync::Arc<Scene>,
    view: &View,
    pins: PinnedOptions,
) -> u64 {
    let reference = oracle::render_finest(scene, view, &stack(&[])).expect("a scene that fits");
    let capture = renderer.captured(scene, view, &stack(&[]), &request(pins));
    compare::triangle_ids(&capture.frame.triangle_id, &reference.triangle_id).different
}

fn exact_grids_are_exact_given_their_own_corners(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    for coverage in reach.of(1, [Coverage::Fixed12, Coverage::Fixed4]) {
        for visibility in reach.options(&renderer) {
            for query in ["sphere?triangles=200", "grid?cell=0.4", "sizes", "near"] {
                let (_, verdict) = verdict(
                    &mut renderer,
                    query,
                    [200, 150],
                    PinnedOptions::of(coverage).with(visibility),
                );
                let a = &verdict.report;
                let faults = [
                    a.wrong_triangles,
                    a.holes,
                    a.double_hits,
                    a.depth_without_id,
                    a.overflow,
                    a.key_outside_bound,
                    a.snap_outside_bound,
                ];
                assert_eq!(
                    faults,
                    [0; 7],
                    "{query} on {} {}: {a:?}",
                    coverage.name(),
                    visibility.name()
                );
                assert!(
                    a.max_color_delta <= 1,
                    "{query} on {}: {a:?}",
                    coverage.name()
                );
            }
        }
    }
}

#[test]
fn a_finer_grid_is_nearer_the_truth() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("sphere?triangles=20000");
    let view = view(&scene, [320, 240]);
    let [coarse, usual, fine] = [Coverage::Fixed4, Coverage::Fixed8, Coverage::Fixed12]
        .map(|option| wrong_pixels(&mut renderer, &scene, &view, PinnedOptions::of(option)));
    assert!(
        coarse > 4 * usual && usual > 4 * fine.max(1),
        "wrong pixels: {coarse} {usual} {fine}"
    );
}

#[test]
fn float_edges_leave_doubles_and_the_top_left_rule_mends_most() {
    let Some(mut renderer) = loan() else { return };
    // Corners on 1/2 px: every other sample lies on an edge.
    let query = "grid?cell=4&lattice=2&width=256&height=256";
    let errors = |renderer: &mut Renderer, option: Coverage| {
        let accuracy = verdict(renderer, query, [256, 256], PinnedOptions::of(option))
            .1
            .report;
        (accuracy.holes, accuracy.double_hits)
    };
    let [float, top_left, fixed] = [Coverage::Float, Coverage::FloatTopLeft, Coverage::Fixed8]
        .map(|option| errors(&mut renderer, option));
    assert_eq!((fixed, top_left), ((0, 0), (0, 0)));
    assert!(
        float.1 > 2000,
        "{float:?}: every sample on an edge is drawn twice"
    );
}

#[test]
fn few_bits_of_depth_confuse_layers_that_lie_close() {
    let Some(mut renderer) = loan() else { return };
    // Two plates, the nearer one by half a step of 16 bits and the later one in order.
    let plate = |depth: f32| ([[0, 0], [64 * 256, 0], [0, 64 * 256]], depth);
    let scene = scene_of_meshes(&[triangle_soup_in_units(&[plate(0.5), plate(0.500_004)])]);
    let wrong = [
        DepthFormat::Ndc16,
        DepthFormat::Log16,
        DepthFormat::Log24,
        DepthFormat::Standard,
        DepthFormat::Reversed,
    ]
    .map(|depth| {
        renderer
            .judged(&scene, &pixel_view(64, 64), &stack(&[]), &pin(depth))
            .1
            .report
            .wrong_nearest
    });
    assert!(
        wrong[0] > 1000 && wrong[1] == wrong[0],
        "16 bits tell the plates apart: {wrong:?}"
    );
    assert_eq!(wrong[2..], [0; 3], "24 bits and more confuse the plates");
}

#[test]
fn affine_attributes_bend_where_a_triangle_runs_into_depth() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("cube-wall");
    let view = view(&scene, [200, 150]);
    let depth = |renderer: &mut Renderer, option: Perspective| {
        renderer.captured(&scene, &view, &stack(&["depth"]), &pin(option))
    };
    let (exact, affine) = (
        depth(&mut renderer, Perspective::Exact),
        depth(&mut renderer, Perspective::Affine),
    );
    assert_eq!(
        exact.frame.triangle_id, affine.frame.triangle_id,
        "perspective decides nothing"
    );
    assert!(compare::pictures(&exact.frame.color, &affine.frame.color, 0).max_delta > 0);
}

#[test]
fn what_is_dropped_instead_of_clipped_is_counted_and_missing() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("near");
    let view = view(&scene, [160, 120]);
    let covered = |renderer: &mut Renderer, option: Clipping| {
        let capture = renderer.captured(&scene, &view, &stack(&[]), &pin(option));
        (capture.frame.covered(), capture.frame.counters.dropped)
    };
    let [drop, near, exact] = [Clipping::Drop, Clipping::Near, Clipping::Exact]
        .map(|option| covered(&mut renderer, option));
    assert!(
        drop.0 <= near.0 && near.0 < exact.0,
        "{drop:?} {near:?} {exact:?}"
    );
    assert!(
        drop.1 >= near.1 && near.1 > 0 && exact.1 == 0,
        "{drop:?} {near:?} {exact:?}"
    );
}

#[test]
fn racy_counting_draws_no_fewer_samples_and_prefix_sums_draw_exactly() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [160, 120]);
    let mut drawn = |option: SampleCounter| {
        renderer.set_scene(&scene).block_on().unwrap();
        renderer
            .draw(&view, &stack(&["draw_order"]), &pin(option))
            .block_on()
            .unwrap();
        let order = renderer
            .finish()
            .block_on()
            .unwrap()
            .order
            .expect("a draw order is kept");
        (order.drawn, order.limit)
    };
    let (prefix, racy) = (drawn(SampleCounter::Prefix), drawn(SampleCounter::Racy));
    assert_eq!(prefix.0, prefix.1);
    assert!(racy.0 >= racy.1, "{racy:?}");
}

fn narrow_sums_of_layers_err_by_steps_of_8_bits_and_say_when_they_are_full(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let xray = stack(&["xray", "lambert"]);
    let scene = scene("knot?tess=8");
    let view = view(&scene, [120, 90]);
    let wide = renderer.captured(&scene, &view, &xray, &unpinned()).frame;
    for sums in [XraySums::Packed16, XraySums::Three8] {
        for visibility in reach.options(&renderer) {
            let pins = PinnedOptions::of(sums).with(visibility);
            let narrow = renderer
                .captured(&scene, &view, &xray, &request(pins))
                .frame;
            assert_eq!(
                narrow.layer_sums,
                wide.layer_sums,
                "{}: layers",
                pins.words()
            );
            let delta = compare::pictures(&narrow.color, &wide.color, 8);
            assert!(
                delta.max_delta > 0 && delta.pixels_over_tolerance == 0,
                "{}: {delta:?}",
                pins.words()
            );
        }
    }
    // 300 sheets behind one another are more than 257, and fewer than 4,095.
    let sheets: Vec<_> = (0..300)
        .map(|i| {
            (
                [[0, 0], [64 * 256, 0], [0, 64 * 256]],
                0.1 + 0.001 * i as f32,
            )
        })
        .collect();
    let deep = scene_of_meshes(&[triangle_soup_in_units(&sheets)]);
    let view = pixel_view(16, 16);
    renderer.captured(&deep, &view, &xray, &pin(XraySums::Three8));
    let full = renderer
        .capture(&view, &xray, &pin(XraySums::Packed16))
        .block_on()
        .expect_err("257 layers fit");
    assert!(matches!(full, RenderError::FullSums(256)), "{full}");
}

#[test]
fn baked_parameters_and_trusted_shaders_change_no_pixel() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    let view = view(&scene, [160, 120]);
    let stack = stack(&["dissolve", "fog", "outline"]);
    let usual = renderer.captured(&scene, &view, &stack, &unpinned());
    for pins in [
        PinnedOptions::of(Parameters::Baked),
        PinnedOptions::of(ShaderChecks::Trusted),
    ] {
        let other = renderer.captured(&scene, &view, &stack, &request(pins));
        assert_eq!(
            usual.frame.triangle_id,
            other.frame.triangle_id,
            "{}",
            pins.words()
        );
        assert!(
            compare::pictures(&usual.frame.color, &other.frame.color, 1).pixels_over_tolerance == 0,
            "{}",
            pins.words()
        );
    }
}

fn normals_that_a_vertex_effect_turns_are_right_without_checks(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let view = view(&scene, [96, 72]);
    for effects in reach.of(
        1,
        [
            &["wobble", "lambert"][..],
            &["explode", "lambert"],
            &["inflate", "facet", "lambert"],
        ],
    ) {
        renderer.exact(
            &scene,
            &view,
            &stack(effects),
            &pin(ShaderChecks::Trusted),
            &effects.join(", "),
        );
    }
}

#[test]
fn baking_leaves_the_uniform_out() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    let view = view(&scene, [64, 48]);
    let buffers = |renderer: &mut Renderer, pins: PinnedOptions| {
        renderer.captured(&scene, &view, &stack(&["fog"]), &request(pins));
        renderer
            .explain()
            .buffers
            .iter()
            .map(|buffer| buffer.name.clone())
            .collect::<Vec<_>>()
    };
    assert!(buffers(&mut renderer, PinnedOptions::default()).contains(&"effects".to_owned()));
    assert!(
        !buffers(&mut renderer, PinnedOptions::of(Parameters::Baked))
            .contains(&"effects".to_owned())
    );
}

#[test]
fn a_float_viewport_changes_few_triangle_ids() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("sphere?triangles=20000");
    let view = view(&scene, [320, 240]);
    let [viewport, snapped] = [VertexTransform::Viewport, VertexTransform::Snapped]
        .map(|option| wrong_pixels(&mut renderer, &scene, &view, PinnedOptions::of(option)));
    assert!(viewport <= 2 * snapped + 20, "{viewport} against {snapped}");
}

#[test]
fn scaled_pictures_are_exact_in_their_own_pixels_and_shown_at_the_size_that_was_asked_for() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    // Neither side is a multiple of four.
    let (size, view) = ([161, 122], view(&scene, [161, 122]));
    let effects = stack(&["lambert", "outline"]);
    for option in RenderScale::ALL.iter().copied() {
        let (capture, verdict) = renderer.judged(&scene, &view, &effects, &pin(option));
        assert_eq!(exactness(&verdict.report), Ok(()), "{}", option.name());
        let drawn = &capture.frame;
        let side = |side: u32| (f64::from(side) * option.factor()).ceil() as u32;
        assert_eq!(
            [drawn.width, drawn.height],
            size.map(side),
            "{}",
            option.name()
        );
        let has_pass = renderer
            .explain()
            .passes
            .iter()
            .any(|pass| pass.name == "scale");
        let has_buffers = ["shown", "scaling"].map(|name| {
            renderer
                .explain()
                .buffers
                .iter()
                .any(|buffer| buffer.name == name)
        });
        assert_eq!(
            (has_pass, has_buffers, capture.shown.is_some()),
            (option != RenderScale::Full, [has_pass; 2], has_pass),
            "{}",
            option.name()
        );
        let Some(shown) = &capture.shown else {
            continue;
        };
        assert_eq!(
            (
                [shown.width, shown.height],
                shown.color.len(),
                shown.triangle_id.len()
            ),
            (size, view.pixels(), view.pixels())
        );
        let right = oracle::resampled(&drawn.color, [drawn.width, drawn.height], size);
        assert_eq!(
            compare::pictures(&shown.color, &right, 1).pixels_over_tolerance,
            0,
            "{}: the pass against the oracle's",
            option.name()
        );
        // The oracle alone shows the same, except where corners snap differently.
        let golden =
            oracle::render_scaled(&scene, &[(view.clone(), effects.clone())], option.factor())
                .expect("a scene that fits");
        let beyond = compare::pictures(&shown.color, &golden.color, 1).pixels_over_tolerance;
        assert!(
            beyond * 200 < view.pixels() as u64,
            "{}: {beyond} pixels are not the golden's",
            option.name()
        );
    }
}

#[test]
fn more_samples_come_nearer_to_eight_by_eight() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    let view = view(&scene, [96, 72]);
    let lit = stack(&["lambert"]);
    let factors: Vec<f64> = RenderScale::ALL
        .iter()
        .map(|option| option.factor())
        .collect();
    let references = oracle::references(&scene, &view, &lit, &factors).expect("a scene that fits");
    let smooth = references.smooth.expect("sizes are compared");
    let rms: Vec<f64> = RenderScale::ALL
        .iter()
        .map(|option| {
            let picture = renderer
                .captured(&scene, &view, &lit, &pin(*option))
                .into_shown();
            compare::pictures(&picture.color, &smooth, 0).rms
        })
        .collect();
    eprintln!("RMS against 8 x 8 samples, quarter to quadruple: {rms:.2?}");
    assert!(
        rms.windows(2).all(|pair| pair[1] < 0.9 * pair[0]),
        "{rms:?}"
    );
    assert!(rms[4] < 2.0, "{rms:?}");
}

#[test]
fn a_scale_that_the_adapter_cannot_hold_says_what_it_would_draw() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=4");
    let side = renderer.gpu().caps.max_texture_side;
    renderer.set_scene(&scene).block_on().unwrap();
    let wide = pixel_view(side, 8);
    let refused = renderer
        .capture(&wide, &stack(&[]), &pin(RenderScale::Double))
        .block_on()
        .expect_err("twice the widest");
    let sentence = format!(
        "scale double draws {0}x16 pixels for a picture of {side}x8, and the picture is {0} x 16; this adapter's textures end at {side} pixels a \
         side; take a smaller scale",
        2 * side
    );
    assert!(refused.is_unsupported(), "{refused}");
    assert_eq!(refused.to_string(), sentence);
    renderer.captured(
        &scene,
        &pixel_view(16, 8),
        &stack(&[]),
        &pin(RenderScale::Double),
    );
}

/// The planner's estimate from some triangles, compared with what the queues of the frame counted.
fn predicted_sizes_are_those_that_the_queues_count(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    // Every path is taken, as on a card.
    let tuning = rasterlab::plan::Tuning {
        max_small_samples: 32,
        max_small_side: 32,
        specialized: false,
        ..gpu.caps.tuning()
    };
    for (query, looked_at_all) in reach.of(
        2,
        [
            ("teapot?tess=8", false),
            ("sphere?triangles=200", true),
            ("sphere?triangles=20000", false),
            ("knot?tess=4", true),
            ("cube-wall", true),
        ],
    ) {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_tuning(tuning);
        let scene = scene(query);
        renderer.captured(&scene, &view(&scene, [640, 480]), &stack(&[]), &unpinned());
        let sizes = renderer.explain().sizes.expect("a picture was drawn");
        assert_eq!(sizes.triangles, scene.triangle_count());
        assert_eq!(
            u64::from(sizes.sampled) == sizes.triangles,
            looked_at_all,
            "{query}: {sizes:?}"
        );
        assert_eq!(sizes.prediction_holds, Some(true), "{query}: {sizes:?}");
        assert_eq!(
            sizes.bins.iter().map(|(_, count)| count).sum::<u32>(),
            sizes.seen,
            "{query}"
        );
    }
}

#[test]
fn what_no_kernel_can_draw_is_one_sentence() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    renderer.set_scene(&scene).block_on().unwrap();
    let mut refused = |size: [u32; 2], names: &[&str], pins: PinnedOptions| {
        let view = view(&scene, size);
        renderer
            .capture(&view, &stack(names), &request(pins))
            .block_on()
            .expect_err("it cannot be drawn")
    };
    let coarse = refused([64, 48], &["dissolve"], PinnedOptions::of(Coverage::Fixed4));
    assert!(
        matches!(&coarse, RenderError::Plan(PlanError::SubpixelGrid { effect, .. }) if effect == "dissolve"),
        "{coarse}"
    );
    let wide = refused([2048, 16], &[], PinnedOptions::of(Coverage::Fixed12));
    assert_eq!(
        wide.to_string(),
        "coverage fixed12 draws pictures of at most 2047 px a side, and this one has 2048x16; use fixed8"
    );
}

#[test]
fn the_finest_grid_fits_the_picture() {
    let scene = scene("teapot?tess=2");
    let bits = |size| oracle::finest_bits(&view(&scene, size));
    assert_eq!(
        [
            bits([320, 240]),
            bits([2047, 2047]),
            bits([2048, 16]),
            bits([4096, 16]),
            bits([16_384, 16])
        ],
        [12, 12, 11, 10, 8]
    );
}

few_and_all!(
    exact_grids_are_exact_given_their_own_corners,
    narrow_sums_of_layers_err_by_steps_of_8_bits_and_say_when_they_are_full,
    normals_that_a_vertex_effect_turns_are_right_without_checks,
    predicted_sizes_are_those_that_the_queues_count,
);
