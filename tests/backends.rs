//! Promise: every visibility backend, every size class and every order of the triangles gives the same picture, every
//! time. Needs an adapter.

mod common;

use std::sync::Arc;

use common::*;
use rasterlab::{
    frame::{Frame, NO_OWNER},
    gpu::{Capture, Renderer},
    ladder::Visibility,
    measure::compare,
    plan::Tuning,
    scene::{Scene, builtin::BUILTINS, camera::View},
};

const SIZE: [u32; 2] = [256, 192];

/// Every image of `a` is that of `b`, bit for bit.
fn assert_same(a: &Frame, b: &Frame, what: &str) {
    let owners = compare::owners(&a.owner, &b.owner);
    assert_eq!(owners.different, 0, "{what}: owners differ, first {:?}", owners.offenders.first());
    let keys = compare::owners(&a.key, &b.key);
    assert_eq!(keys.different, 0, "{what}: keys differ, first {:?}", keys.offenders.first());
    let colors = compare::pictures(&a.color, &b.color, 0);
    assert_eq!(colors.pixels_beyond, 0, "{what}: colours differ, first {:?}", colors.offenders.first());
}

/// The hall from inside: clipping, and triangles of every class.
fn hall() -> (Arc<Scene>, View) {
    let scene = scene("near");
    let view = view(&scene, SIZE);
    (scene, view)
}

/// Small triangles walk alone, middling ones get a workgroup, as on a GPU.
const GRAPHICS_CARD: Tuning =
    Tuning { small_samples: 32, small_side: 32, list_group: 256, listed_tiles: false, early_load: false, specialized: true };

fn is_drawn_by(renderer: &Renderer, stems: &[&str]) {
    let passes = renderer.key().expect("something was drawn").frame();
    for stem in stems {
        assert!(passes.iter().any(|pass| pass.stem() == *stem), "the scene does not use {stem}");
    }
}

#[test]
fn the_scenes_of_these_tests_include_every_builtin() {
    for builtin in BUILTINS {
        assert!(SCENES.iter().any(|query| query.split('?').next() == Some(builtin.name)), "{} is not tested", builtin.name);
    }
}

#[test]
fn split32_and_packed64_give_the_same_owners_and_keys() {
    let Some(mut renderer) = renderer() else { return };
    if !renderer.gpu().caps.int64_atomics {
        eprintln!("NOT RUN: this adapter has no 64-bit atomics, so there is no packed64 to compare split32 with");
        return;
    }
    for query in SCENES {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        for tuning in [renderer.gpu().caps.tuning(), GRAPHICS_CARD] {
            renderer.set_tuning(tuning);
            let [split, packed] =
                Visibility::EXACT.map(|rung| captured(&mut renderer, &scene, &view, &stack(&["facet", "lambert"]), &pinned(rung)));
            assert!(split.frame.covered() > 0, "{query} shows nothing");
            assert_same(&split.frame, &packed.frame, query);
            assert_eq!(split.geometry, packed.geometry, "{query}: geometry");
            assert_eq!(split.layers, packed.layers, "{query}: layers");
        }
    }
}

#[test]
fn a_hundred_frames_are_equal_to_the_bit() {
    let Some(mut renderer) = renderer() else { return };
    let (scene, _) = hall();
    let view = view(&scene, [160, 120]);
    renderer.set_tuning(GRAPHICS_CARD);
    for rung in rungs(&renderer) {
        let mut draw = || -> Capture { captured(&mut renderer, &scene, &view, &stack(&["facet", "lambert"]), &pinned(rung)) };
        let first = draw();
        assert!(first.frame.counters.clipped > 0 && !first.geometry.pieces.is_empty(), "nothing was clipped");
        for frame in 2..=100 {
            let again = draw();
            let what = format!("{} frame {frame}", rung.name());
            assert_same(&again.frame, &first.frame, &what);
            assert_eq!(again.geometry, first.geometry, "{what}: geometry");
            assert_eq!(again.layers, first.layers, "{what}: layers");
            assert_eq!(again.frame.counters, first.frame.counters, "{what}: counters");
        }
        is_drawn_by(&renderer, &["project", "raster_small", "args", "clip", "tile_large", "raster_medium", "raster_large", "resolve"]);
    }
}

/// The same triangles in another order, and for each its place in the order before.
fn shuffled(scene: &Scene, seed: u32) -> (Arc<Scene>, Vec<u32>) {
    let mut scene = scene.clone();
    assert_eq!(scene.instances.len(), 1, "ids of one draw are shuffled");
    let indices = scene.primitives[0].indices.expect("builtins are indexed");
    assert_eq!((indices.stride, indices.offset), (4, 0));
    let triangles: Vec<[u8; 12]> = scene.index_bytes.as_chunks().0.to_vec();
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut dice = Dice(seed);
    for i in (1..order.len()).rev() {
        order.swap(i, dice.between(0, i as i32 + 1) as usize);
    }
    scene.index_bytes = order.iter().flat_map(|&t| triangles[t as usize]).collect();
    (Arc::new(scene), order)
}

#[test]
fn shuffled_triangles_own_the_pixels_they_owned_before() {
    let Some(mut renderer) = renderer() else { return };
    renderer.set_tuning(GRAPHICS_CARD);
    for query in ["sphere?triangles=5000", "sphere?triangles=200", "knot?tess=6", "grid?cell=1", "sizes"] {
        let still = scene(query);
        let view = view(&still, SIZE);
        for rung in rungs(&renderer) {
            let before = captured(&mut renderer, &still, &view, &stack(&[]), &pinned(rung)).frame;
            for seed in 1..=3 {
                let (mixed, order) = shuffled(&still, seed);
                assert!(order.iter().enumerate().filter(|(i, t)| *i as u32 != **t).count() > order.len() / 2, "hardly shuffled");
                let after = captured(&mut renderer, &mixed, &view, &stack(&[]), &pinned(rung)).frame;
                let by_old_id = |&owner: &u32| if owner == NO_OWNER { NO_OWNER } else { order[owner as usize] };
                let owners: Vec<u32> = after.owner.iter().map(by_old_id).collect();
                assert_same(&Frame { owner: owners, ..after }, &before, &format!("{query} {}, shuffle {seed}", rung.name()));
            }
        }
    }
}

/// Coplanar layers have equal keys, since every key is held between the corner depths: the smaller id wins, whatever
/// the order in which triangles come.
#[test]
fn equal_keys_go_to_the_smaller_id() {
    let Some(mut renderer) = renderer() else { return };
    let still = scene("stack?layers=12");
    let view = view(&still, SIZE);
    for tuning in tunings() {
        renderer.set_tuning(tuning);
        for rung in rungs(&renderer) {
            for scene in [still.clone(), shuffled(&still, 5).0, shuffled(&still, 6).0] {
                let (capture, verdict) = judged(&mut renderer, &scene, &view, &stack(&[]), &pinned(rung));
                let layers = capture.layers.as_deref().expect("layers are counted");
                assert!(layers.iter().filter(|&&layers| layers > 4).count() > 1000, "layers hardly overlap");
                let owners = compare::owners(&capture.frame.owner, &verdict.expected.owner);
                assert_eq!(owners.different, 0, "{} {tuning:?}: {:?}", rung.name(), owners.offenders.first());
            }
        }
    }
}

#[test]
fn size_classes_and_listed_tiles_do_not_show() {
    let Some(mut renderer) = renderer() else { return };
    for query in SCENES {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        for rung in rungs(&renderer) {
            let mut first: Option<Capture> = None;
            for tuning in tunings() {
                renderer.set_tuning(tuning);
                let capture = captured(&mut renderer, &scene, &view, &stack(&["facet", "depth", "lambert"]), &pinned(rung));
                let first = first.get_or_insert_with(|| capture.clone());
                let what = format!("{query} {} {tuning:?}", rung.name());
                assert_same(&capture.frame, &first.frame, &what);
                assert_eq!(capture.layers, first.layers, "{what}: layers");
                assert_eq!(capture.frame.counters, first.frame.counters, "{what}: counters");
            }
        }
    }
}

#[test]
fn the_early_load_does_not_show() {
    let Some(mut renderer) = renderer() else { return };
    for query in ["near", "stack?layers=60&gap=0.5", "sizes"] {
        let scene = scene(query);
        let view = view(&scene, SIZE);
        let [with, without] = [true, false].map(|early_load| {
            renderer.set_tuning(Tuning { early_load, ..GRAPHICS_CARD });
            captured(&mut renderer, &scene, &view, &stack(&["lambert"]), &pinned(Visibility::Split32))
        });
        assert_same(&with.frame, &without.frame, query);
    }
}
