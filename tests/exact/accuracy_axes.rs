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

/// Largest distance of a captured corner from its position on the oracle's finest grid, in pixels.
fn moved_px(capture: &Capture, scene: &Scene, view: &View) -> f64 {
    let reference = oracle::project_finest(scene, view, &stack(&[])).expect("a scene that fits");
    let px = |at: i32, bits: u32| f64::from(at) / f64::from(1 << bits);
    let (ours, theirs) = (capture.geometry.subpixel_bits, reference.subpixel_bits);
    let twins = capture
        .geometry
        .vertices
        .iter()
        .zip(&reference.vertices)
        .filter(|(a, b)| a.flags | b.flags == 0);
    twins
        .map(|(a, b)| (px(a.x, ours) - px(b.x, theirs)).hypot(px(a.y, ours) - px(b.y, theirs)))
        .fold(0.0, f64::max)
}

#[test]
fn packed_positions_move_corners_by_half_a_step_at_most() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("teapot?tess=8");
    let view = view(&scene, [320, 240]);
    let mut of = |option: PositionFormat| {
        let (capture, verdict) = renderer.judged(&scene, &view, &stack(&["lambert"]), &pin(option));
        // Given its own corners, every option covers and compares as exactly as any.
        let a = &verdict.report;
        assert_eq!(
            [
                a.wrong_triangles,
                a.holes,
                a.double_hits,
                a.depth_without_id,
                a.key_outside_bound,
                a.snap_outside_bound
            ],
            [0; 6],
            "{option:?}: {a:?}"
        );
        assert_eq!(a.unexplained, 0, "{option:?}: {a:?}");
        moved_px(&capture, &scene, &view)
    };
    let [packed10, packed16, stored, relative] = [
        PositionFormat::Packed10,
        PositionFormat::Packed16,
        PositionFormat::Stored,
        PositionFormat::Relative,
    ]
    .map(&mut of);
    // The teapot is some 300 px wide: a step of its box is 0.3 px, or 0.005.
    assert!((0.05..0.3).contains(&packed10), "{packed10} px");
    assert!(
        packed16 < packed10 / 8.0 && packed16 < 0.01,
        "{packed16} px"
    );
    assert!(
        stored <= 1.1 / 256.0 && relative <= 1.1 / 256.0,
        "{stored} {relative} px"
    );
}

#[test]
fn neighbors_in_boxes_of_their_own_crack_when_they_are_packed() {
    let Some(mut renderer) = loan() else { return };
    // Two sheets that share a jagged border, the upper one much higher than the lower one.
    let border = |i: u32| {
        [
            i as f32 * 2.0 - 4.0,
            128.0 + (rasterlab::math::hash(i) % 2048) as f32 / 128.0,
        ]
    };
    let sheet = |far: f32| {
        let quad = |i: u32| {
            let ([a, b], [x0, x1]) = ([border(i), border(i + 1)], [border(i)[0], border(i + 1)[0]]);
            [
                [a[0], a[1]],
                [b[0], b[1]],
                [x0, far],
                [b[0], b[1]],
                [x1, far],
                [x0, far],
            ]
            .map(|[x, y]| [x, y, 0.5])
        };
        rasterlab_fuzz::stress::scenes::triangle_soup((0..136).flat_map(quad))
    };
    let scene = scene_of_meshes(&[sheet(-1000.0), sheet(300.0)]);
    let view = pixel_view(256, 256);
    let mut empty = |option: PositionFormat| {
        let frame = renderer
            .captured(&scene, &view, &stack(&[]), &pin(option))
            .frame;
        frame
            .triangle_id
            .iter()
            .filter(|triangle_id| **triangle_id == u32::MAX)
            .count()
    };
    let [packed10, packed16, stored, relative] = [
        PositionFormat::Packed10,
        PositionFormat::Packed16,
        PositionFormat::Stored,
        PositionFormat::Relative,
    ]
    .map(&mut empty);
    assert!(
        packed10 > 10 && packed16 * 8 < packed10,
        "{packed10} and {packed16} pixels in the cracks"
    );
    assert_eq!(
        (stored, relative),
        (0, 0),
        "places that are shared stay shared"
    );
}

/// A knot whose vertices lie far away, and what sees it from near by.
fn modelled_far_away(offset: f64, size: [u32; 2]) -> (std::sync::Arc<Scene>, View) {
    let knot = scene("knot?tess=6");
    let (mesh, at) = (
        &knot.primitives[0],
        glam::DVec3::new(offset, -offset, 0.5 * offset),
    );
    let place = |vertex| {
        (glam::DVec3::from_array(mesh.position(&knot, vertex).map(f64::from)) + at)
            .as_vec3()
            .to_array()
    };
    let part = rasterlab_fuzz::stress::scenes::SimpleMesh {
        positions: (0..mesh.vertex_count()).map(place).collect(),
        indices: (0..mesh.triangle_count())
            .flat_map(|triangle| mesh.corners(&knot, triangle))
            .collect(),
        ..Default::default()
    };
    let scene = scene_of_meshes(&[part]);
    let camera = Camera {
        eye: at + glam::DVec3::new(1.0, 1.0, 4.0),
        target: at,
        ..Camera::default()
    };
    let view = rasterlab_fuzz::stress::scenes::camera_view(&scene, &camera, size);
    (scene, view)
}

fn positions_relative_to_the_eye_lose_no_precision_far_away(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = modelled_far_away(1e5, [320, 240]);
    for visibility in reach.options(&renderer) {
        let mut of = |option: PositionFormat| {
            let (capture, verdict) = renderer.judged(
                &scene,
                &view,
                &stack(&[]),
                &request(PinnedOptions::of(option).with(visibility)),
            );
            assert_eq!(
                exactness(&verdict.report),
                Ok(()),
                "{option:?} on {}",
                visibility.name()
            );
            (
                moved_px(&capture, &scene, &view),
                verdict.report.max_snap_delta,
            )
        };
        let [stored, relative] = [PositionFormat::Stored, PositionFormat::Relative].map(&mut of);
        assert!(stored.0 > 0.1, "{stored:?}");
        assert!(relative.0 <= 1.1 / 256.0 && relative.1 <= 1, "{relative:?}");
    }
}

#[test]
fn the_planner_takes_the_eye_out_where_a_scene_lies_far_away() {
    let Some(mut renderer) = loan() else { return };
    let mut planned = |scene: &std::sync::Arc<Scene>, view: &View| {
        renderer.captured(scene, view, &stack(&[]), &unpinned());
        let why = renderer
            .explain()
            .reasons
            .into_iter()
            .find(|note| note.name == "position_format")
            .expect("a reason for every axis")
            .why;
        (
            renderer
                .key()
                .expect("something was drawn")
                .options
                .position_format,
            why,
        )
    };
    let near = scene("knot?tess=6");
    let (option, why) = planned(&near, &view(&near, [320, 240]));
    assert!(
        option == PositionFormat::Stored && why.starts_with("stored: "),
        "{why}"
    );
    let (scene, view) = modelled_far_away(1e5, [320, 240]);
    let (option, why) = planned(&scene, &view);
    assert!(
        option == PositionFormat::Relative && why.starts_with("relative: so far from the origin"),
        "{why}"
    );
}

#[test]
fn culling_is_left_out_where_packed_positions_leave_its_bounds() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [160, 120]);
    let all = renderer.captured(&scene, &view, &stack(&[]), &pin(PositionFormat::Relative));
    for (option, culling) in [
        (PositionFormat::Packed10, Culling::None),
        (PositionFormat::Packed16, Culling::None),
        (PositionFormat::Relative, Culling::Frustum),
    ] {
        let capture = renderer.captured(
            &scene,
            &view,
            &stack(&[]),
            &request(PinnedOptions::of(option).with(Culling::Frustum)),
        );
        let options = renderer.key().expect("something was drawn").options;
        assert_eq!(
            (options.position_format, options.culling),
            (option, culling)
        );
        assert!(
            option != PositionFormat::Relative
                || capture.frame.triangle_id == all.frame.triangle_id
        );
    }
}

#[test]
fn strict_vertices_subtract_the_eye_to_the_bit_and_refuse_packed_positions() {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = modelled_far_away(1e6, [96, 72]);
    let strict = |option: PositionFormat| AccuracyRequest {
        tier: Tier::Strict,
        ..pin(option)
    };
    let capture = renderer.captured(
        &scene,
        &view,
        &stack(&[]),
        &strict(PositionFormat::Relative),
    );
    let reference = oracle::strict_frame(
        &scene,
        &view.with_grid(view.precision.subpixel_bits, true),
        &stack(&[]),
    )
    .expect("a scene that fits");
    assert_eq!(
        (capture.frame.triangle_id, capture.frame.depth_key),
        reference
    );
    for (option, name) in [
        (PositionFormat::Packed10, "packed10"),
        (PositionFormat::Packed16, "packed16"),
    ] {
        let refused = renderer
            .capture(&view, &stack(&[]), &strict(option))
            .block_on()
            .expect_err("floats unpack");
        let sentence = format!(
            "vertex_transform strict needs integers in every decision, but position_format {name} unpacks positions in floats; remove that, or use \
             another option"
        );
        assert_eq!(refused.to_string(), sentence);
    }
}

#[test]
fn packed_positions_take_their_bytes_only_while_they_are_used() {
    let Some(gpu) = gpu() else { return };
    let mut renderer = Renderer::new(gpu);
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [64, 48]);
    let mut bytes = |option: PositionFormat| {
        renderer.captured(&scene, &view, &stack(&[]), &pin(option));
        let note = renderer
            .explain()
            .buffers
            .into_iter()
            .find(|buffer| buffer.name == "vertex_bytes")
            .expect("attributes");
        (
            note.bytes - scene.vertex_bytes.len() as u64,
            note.why.contains("packed positions"),
        )
    };
    let room = |bytes: u64| bytes..bytes + 16;
    let vertices = scene.vertex_count();
    let [stored, packed10, packed16, again] = [
        PositionFormat::Stored,
        PositionFormat::Packed10,
        PositionFormat::Packed16,
        PositionFormat::Stored,
    ]
    .map(&mut bytes);
    assert!(room(0).contains(&stored.0) && !stored.1, "{stored:?}");
    assert!(
        room(4 * vertices).contains(&packed10.0) && packed10.1,
        "{packed10:?} of {vertices} vertices"
    );
    assert!(
        room(8 * vertices).contains(&packed16.0) && packed16.1,
        "{packed16:?} of {vertices} vertices"
    );
    assert_eq!(again, stored);
}

#[test]
fn packed_positions_refuse_what_stored_ones_refuse_and_deformed_meshes() {
    let Some(mut renderer) = loan() else { return };
    let good = [[4.0, 4.0, 0.25], [60.0, 8.0, 0.5], [8.0, 60.0, 0.75f32]];
    let mut positions = good.to_vec();
    for (corner, value) in [(0, f32::NAN), (1, f32::INFINITY), (2, f32::MAX)] {
        let mut corners = good;
        corners[corner][corner] = value;
        positions.extend(corners);
    }
    let scene = scene_of_meshes(&[rasterlab_fuzz::stress::scenes::triangle_soup(positions)]);
    for option in [PositionFormat::Packed10, PositionFormat::Packed16] {
        let (capture, verdict) =
            renderer.judged(&scene, &pixel_view(64, 64), &stack(&[]), &pin(option));
        let counters = capture.frame.counters;
        assert_eq!(
            (counters.rejected_nonfinite, counters.rejected_range),
            (2, 1),
            "{option:?}"
        );
        assert_eq!(
            (
                verdict.report.snap_outside_bound,
                verdict.report.counters_wrong
            ),
            (0, 0),
            "{option:?}"
        );
        assert!(capture.frame.covered() > 1000, "{option:?}");
    }
    let soft = self::scene("tentacle?tess=2");
    renderer.set_scene(&soft).block_on().unwrap();
    let refused = renderer
        .capture(
            &view(&soft, [64, 48]),
            &stack(&[]),
            &pin(PositionFormat::Packed10),
        )
        .block_on()
        .expect_err("its skin bends");
    assert!(
        refused.is_unsupported()
            && refused
                .to_string()
                .starts_with("position_format packed10 packs meshes that keep their shape"),
        "{refused}"
    );
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
    positions_relative_to_the_eye_lose_no_precision_far_away,
);
