//! Promise: packed positions and positions relative to the eye put corners where they say, and the
//! planner chooses and refuses them where it must. Needs an adapter.

use super::*;

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

few_and_all!(positions_relative_to_the_eye_lose_no_precision_far_away,);
