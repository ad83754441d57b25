//! Promise: every visibility backend, every size class and every order of the triangles gives the
//! same picture, every time. Needs an adapter.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::Visibility,
    effects::{Stack, dots},
    frame::NO_TRIANGLE,
    gpu::{Capture, Renderer},
    measure::compare,
    oracle,
    plan::{AccuracyRequest, Tuning},
    scene::{Scene, draw::draws, view::View},
};

use crate::common::*;

const SIZE: [u32; 2] = [256, 192];

/// Builtins with their own views.
fn scenes_with_views(queries: &[&str]) -> Vec<(Arc<Scene>, View)> {
    let with_view = |query: &&str| {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        (scene, view)
    };
    queries.iter().map(with_view).collect()
}

/// The hall from inside: clipping, and triangles of every class.
fn hall() -> (Arc<Scene>, View) {
    let scene = scene("near");
    let view = view(&scene, SIZE);
    (scene, view)
}

fn every_exact_backend_gives_the_same_triangle_ids_and_depth_keys(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let options = reach.of(2, options(&renderer));
    assert!(options.len() > 1, "there is nothing to compare with");
    let scenes = scenes_with_views(&[
        "knot?tess=24",
        "globe?tess=6",
        "leaves?n=40",
        "sizes",
        "near",
        "tentacle?tess=3",
    ]);
    let stack = stack(&["facet", "lambert"]);
    renderer.set_tuning(GRAPHICS_CARD);
    // All scenes share the kernels of an option.
    let mut draw = |(scene, view): &(Arc<Scene>, View), option| {
        renderer.captured(scene, view, &stack, &pinned(option))
    };
    let split: Vec<Capture> = scenes
        .iter()
        .map(|scene| draw(scene, Visibility::Split32))
        .collect();
    for &option in &options[1..] {
        for (scene, split) in scenes.iter().zip(&split) {
            assert!(split.frame.covered() > 0, "{} shows nothing", scene.0.name);
            let other = draw(scene, option);
            let what = format!("{} {}", scene.0.name, option.name());
            assert_same(&other.frame, &split.frame, &what);
            assert_eq!(other.geometry, split.geometry, "{what}: geometry");
            assert_eq!(other.layers, split.layers, "{what}: layers");
        }
    }
}

#[test]
fn a_picture_is_the_same_whatever_the_queues_of_the_one_before_held() {
    let Some(mut renderer) = loan() else { return };
    // Every triangle whose box has more than one pixel waits in a queue.
    let tuning = Tuning {
        max_small_samples: 1,
        max_small_side: 1,
        queue_groups: 8192,
        ..GRAPHICS_CARD
    };
    let (scene, stack, request) = (
        scene("sphere?triangles=20000"),
        stack(&["lambert"]),
        AccuracyRequest::default(),
    );
    let [far, near] = [[4, 4], [480, 360]].map(|size| view(&scene, size));
    renderer.set_tuning(tuning);
    renderer.set_scene(&scene).block_on().expect("it fits");
    let mut queued = |view: &View| {
        let frame = renderer
            .capture(view, &stack, &request)
            .block_on()
            .expect("it draws")
            .frame;
        let sizes = renderer.explain().sizes.expect("something was drawn");
        (sizes.counted.expect("the queues are counted")[0], frame)
    };
    // The first picture knows of none before it.
    let (all, first) = queued(&near);
    let (few, _) = queued(&far);
    let (after_few, second) = queued(&near);
    let (after_all, third) = queued(&near);
    assert!(
        few < 500 && all > 4000,
        "{few} and {all} triangles are queued"
    );
    assert_eq!([after_few, after_all], [all; 2]);
    assert_same(&second, &first, "after a picture with empty queues");
    assert_same(&third, &first, "after the same picture");
}

#[test]
fn a_picture_of_large_triangles_is_the_same_after_one_with_more_and_one_with_fewer_of_them() {
    let Some(mut renderer) = loan() else { return };
    let ((scene, view), stack) = (hall(), stack(&["lambert"]));
    // The same hall from afar has few large triangles or none.
    let far = crate::common::view(&scene, [16, 12]);
    let fresh = renderer.captured(&scene, &view, &stack, &unpinned()).frame;
    for tuning in [
        GRAPHICS_CARD,
        Tuning {
            queue_groups: 0,
            ..GRAPHICS_CARD
        },
        Tuning {
            queue_groups: 8192,
            ..GRAPHICS_CARD
        },
    ] {
        renderer.set_tuning(tuning);
        renderer.set_scene(&scene).block_on().expect("it fits");
        for (turn, view) in [&view, &far, &view, &far, &view].into_iter().enumerate() {
            let frame = renderer
                .capture(view, &stack, &unpinned())
                .block_on()
                .expect("it draws")
                .frame;
            if turn % 2 == 0 {
                assert_same(&frame, &fresh, &format!("turn {turn}, {tuning:?}"));
            }
        }
    }
}

/// A float key as packed32 keeps it among so many triangles: all depths below 2^-31 are one, and
/// the bits that the id needs are cut off below.
fn cut_key(key: u32, triangles: u64) -> u32 {
    const LEAST: u32 = 0x3000_0000;
    let id_bits = 64 - triangles.leading_zeros();
    let lost = (28 + id_bits).saturating_sub(32);
    if key == 0 {
        0
    } else {
        LEAST + ((key.max(LEAST) - LEAST) >> lost << lost)
    }
}

fn packed32_loses_depth_and_nothing_else(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let mut lost = 0;
    for query in reach.of(
        6,
        [
            "knot?tess=24",
            "field?count=27&triangles=200",
            "grid?cell=0.4",
            "sizes",
            "stack",
            "near",
        ],
    ) {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        let reference = renderer
            .captured(&scene, &view, &stack(&[]), &split32())
            .frame;
        let (capture, verdict) =
            renderer.judged(&scene, &view, &stack(&[]), &pinned(Visibility::Packed32));
        let (frame, errors) = (&capture.frame, &verdict.report);
        assert_eq!(
            [errors.holes, errors.double_hits, errors.depth_without_id],
            [0; 3],
            "{query}"
        );
        assert_eq!(
            errors.wrong_triangles, errors.wrong_nearest,
            "{query}: a triangle id does not cover its pixel"
        );
        let cut: Vec<u32> = reference
            .depth_key
            .iter()
            .map(|&key| cut_key(key, scene.triangle_count()))
            .collect();
        let keys = compare::triangle_ids(&frame.depth_key, &cut);
        assert_eq!(
            keys.different,
            0,
            "{query}: keys, first {:?}",
            keys.mismatches.first()
        );
        // Another triangle id than the nearest is one that a step of the key cannot tell from it:
        // as deep when cut, and smaller.
        let (draws, geometry) = (
            draws(&scene, &view).expect("a builtin fits"),
            &capture.geometry,
        );
        let plain = stack(&[]);
        let (triangles, _) =
            oracle::triangles(&oracle::Shot::new(&scene, &draws, &view, &plain), geometry)
                .expect("nobody cancels it");
        let claimed = oracle::cover_claims(
            &oracle::SampleTests::default(),
            &triangles,
            &view,
            &frame.triangle_id,
        )
        .expect("nobody cancels it");
        for (pixel, sample) in claimed.samples.iter().enumerate() {
            if frame.triangle_id[pixel] != reference.triangle_id[pixel] {
                let [_, high] = sample
                    .claimed
                    .unwrap_or_else(|| panic!("{query}: pixel {pixel}"));
                assert!(
                    high >= f64::from(f32::from_bits(cut[pixel])),
                    "{query}: pixel {pixel} shows what is farther by a step"
                );
                assert!(
                    frame.triangle_id[pixel] < reference.triangle_id[pixel],
                    "{query}: pixel {pixel} shows the larger id"
                );
                lost += 1;
            }
        }
    }
    assert!(lost > 0, "no scene is so dense that the cut shows");
}

#[test]
fn a_race_may_lose_the_nearest_and_nothing_else() {
    let Some(mut renderer) = loan() else { return };
    for query in ["sphere?triangles=5000", "stack?layers=40", "near", "sizes"] {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        let reference = renderer.captured(&scene, &view, &stack(&[]), &split32());
        let (capture, verdict) =
            renderer.judged(&scene, &view, &stack(&[]), &pinned(Visibility::Race));
        let errors = &verdict.report;
        assert_eq!(
            [errors.holes, errors.double_hits, errors.depth_without_id],
            [0; 3],
            "{query}"
        );
        assert_eq!(
            errors.wrong_triangles, errors.wrong_nearest,
            "{query}: a triangle id does not cover its pixel"
        );
        let layers = capture.layers.as_deref().expect("layers are counted");
        for pixel in (0..layers.len()).filter(|&pixel| layers[pixel] < 2) {
            let [here, there] = [&capture.frame, &reference.frame]
                .map(|frame| (frame.triangle_id[pixel], frame.depth_key[pixel]));
            assert_eq!(here, there, "{query}: pixel {pixel} has no rival");
        }
    }
}

/// Returns true if drawing `stack` is refused.
fn is_refused(renderer: &mut Renderer, view: &View, stack: &Stack) -> bool {
    renderer.draw(view, stack, &unpinned()).block_on().is_err()
}

#[test]
fn a_refused_frame_leaves_the_next_one_whole() {
    let Some(mut renderer) = loan() else { return };
    let (scene, first) = hall();
    let other = view(&scene, [160, 90]);
    let accuracy = AccuracyRequest::default();
    renderer.exact(&scene, &first, &Stack::default(), &accuracy, "before");
    let mut dense = Stack::default();
    let dots = dense.enable(&dots::EFFECT);
    let spacing = dots.effect.field("spacing_m").expect("dots have a spacing");
    spacing
        .set(&mut dots.words, &[1e-5])
        .expect("inside the range");
    assert!(
        is_refused(&mut renderer, &other, &dense),
        "so many dots are drawn"
    );
    renderer.exact(
        &scene,
        &other,
        &Stack::default(),
        &accuracy,
        "after a refused frame of the same view",
    );
}

#[test]
fn the_early_load_does_not_show() {
    let Some(mut renderer) = loan() else { return };
    for query in ["near", "stack?layers=60&gap=0.5", "sizes"] {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        let [with, without] = [true, false].map(|early_load| {
            renderer.set_tuning(Tuning {
                early_load,
                ..GRAPHICS_CARD
            });
            renderer.captured(&scene, &view, &stack(&["lambert"]), &split32())
        });
        assert_same(&with.frame, &without.frame, query);
    }
}

fn blocks_that_hide_what_lies_behind_do_not_show(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    for query in [
        "near",
        "stack?layers=60&gap=0.5",
        "sizes",
        "sphere?triangles=200",
    ] {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        for option in reach.options(&renderer) {
            let [with, without] = [true, false].map(|hides_blocks| {
                renderer.set_tuning(Tuning {
                    hides_blocks,
                    ..GRAPHICS_CARD
                });
                renderer.captured(&scene, &view, &stack(&["lambert"]), &pinned(option))
            });
            let what = format!("{query} {}", option.name());
            assert_same(&with.frame, &without.frame, &what);
            assert_eq!(with.layers, without.layers, "{what}: layers");
        }
    }
}

/// A picture that fills every pixel, then one that leaves most empty; buffers that a pass clears
/// are as empty as those that are cleared before it.
fn a_picture_begins_with_nothing_of_the_one_before(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (full, empty) = (hall(), scene("sphere?triangles=200"));
    let aside = view(&empty, SIZE);
    for option in reach.options(&renderer) {
        let [cleared_by_passes, cleared_before] = [true, false].map(|clears_in_passes| {
            renderer.set_tuning(Tuning {
                clears_in_passes,
                ..GRAPHICS_CARD
            });
            renderer.captured(&full.0, &full.1, &stack(&[]), &pinned(option));
            renderer.captured(&empty, &aside, &stack(&[]), &pinned(option))
        });
        assert!(
            cleared_before.frame.triangle_id.contains(&NO_TRIANGLE),
            "no pixel is empty"
        );
        assert_same(
            &cleared_by_passes.frame,
            &cleared_before.frame,
            option.name(),
        );
        assert_eq!(
            cleared_by_passes.frame.counters,
            cleared_before.frame.counters,
            "{}: counters",
            option.name()
        );
    }
}

few_and_all!(
    every_exact_backend_gives_the_same_triangle_ids_and_depth_keys,
    blocks_that_hide_what_lies_behind_do_not_show,
    a_picture_begins_with_nothing_of_the_one_before,
    packed32_loses_depth_and_nothing_else,
);
