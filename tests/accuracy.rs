//! Promise: the GPU is within each stated tolerance of the oracle. Needs an adapter.

mod common;

use common::*;

const SCENES: &[&str] = &[
    "teapot?tess=8",
    "sphere?triangles=5000",
    "sphere?triangles=200",
    "knot?tess=24",
    "cube-wall",
    "grid?cell=1",
    "grid?cell=0.4",
    "fan?n=13",
    "sizes",
    "slivers",
    "stack",
    "near",
];

#[test]
fn every_builtin_scene_is_within_tolerance_on_every_rung() {
    let Some(mut renderer) = renderer() else { return };
    let mut failures = Vec::new();
    for query in SCENES {
        let scene = scene(query);
        let view = view(&scene, [320, 240]);
        for rung in rungs(&renderer) {
            let (capture, verdict) = judged(&mut renderer, &scene, &view, &stack(&["facet", "lambert"]), &pinned(rung));
            eprintln!("{query} {}: {:?} {:?}", rung.name(), verdict.accuracy, capture.frame.counters);
            let a = &verdict.accuracy;
            let is_exact =
                a.owner_mismatch + a.holes + a.double_hits + a.orphans + a.overflow + a.key_outside_bound + a.snap_outside_bound == 0;
            if !is_exact || a.max_colour_delta > 1 {
                failures.push(format!("{query} {}", rung.name()));
            }
        }
    }
    assert_eq!(failures, Vec::<String>::new());
}
