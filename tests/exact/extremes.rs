//! Promise: every extreme case of the table meets its expectation, and the judge of every kind of
//! case can fail. Needs an adapter. `RASTERLAB_SEED=n` changes the random cases; a failure names
//! the case and the seed that draw it again.

use std::{cell::Cell, collections::BTreeSet, fs, path::Path};

use rasterlab::{
    gpu::Renderer,
    stress::{self, Outcome, Report},
};

use crate::common::*;

fn seed() -> u32 {
    std::env::var("RASTERLAB_SEED").map_or(0, |seed| {
        seed.parse().expect("RASTERLAB_SEED is a whole number")
    })
}

fn case(name: &str) -> &'static stress::Case {
    stress::cases()
        .into_iter()
        .find(|case| case.name == name)
        .unwrap_or_else(|| panic!("no case {name}"))
}

/// Runs one case. A skipped case is no failure, but is reported.
fn check(name: &str) {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let report = case(name).run(&mut renderer, seed(), &|_| true);
    let Report {
        number,
        outcome,
        notes,
        ..
    } = &report;
    for note in notes.iter().map(String::as_str).chain(outcome.why()) {
        eprintln!("case {number}, {name}: {}: {note}", outcome.word());
    }
    let again = report
        .seed
        .map(|seed| format!(" (RASTERLAB_SEED={seed})"))
        .unwrap_or_default();
    assert!(
        !outcome.is_failure() && *outcome != Outcome::Stopped,
        "case {number}, {name}: {outcome:?}{again}"
    );
}

macro_rules! cases {
    ($($test:ident = $name:literal,)*) => {
        $(#[test]
        fn $test() {
            check($name);
        })*

        const TESTED: &[&str] = &[$($name),*];
    };
}

cases! {
    case_1_rotated_quads = "rotated-quads",
    case_1_clipped_quads = "clipped-quads",
    case_1_quads_beyond_the_guard_band = "quads-beyond-the-guard-band",
    case_2_fan_around_a_sample = "fan-around-a-sample",
    case_3_d3d_rectangle = "d3d-rectangle",
    case_3_d3d_four_triangles = "d3d-four-triangles",
    case_3_d3d_snap = "d3d-snap",
    case_4_translation = "translation",
    case_5_sizes = "sizes",
    case_6_dense_grids = "dense-grids",
    case_7_slivers = "slivers",
    case_8_size_class_borders = "size-class-borders",
    case_8_edges_beside_axes = "edges-beside-axes",
    case_9_guard_band = "guard-band",
    case_9_clipped_needles = "clipped-needles",
    case_10_w_around_zero = "w-around-zero",
    case_12_non_finite_positions = "non-finite-positions",
    case_12_non_finite_attributes = "non-finite-attributes",
    case_12_normals_along_axes = "normals-along-axes",
    case_13_depth_range = "depth-range",
    case_14_scales_and_offsets = "scales-and-offsets",
    case_14_relative_positions = "relative-positions",
    case_15_coplanar_layers = "coplanar-layers",
    case_17_degenerate_triangles = "degenerate-triangles",
    case_18_workgroups_direct = "workgroups-direct",
    case_19_queues = "queues",
    case_19_clipped_in_turns = "clipped-in-turns",
    case_20_empty_pictures = "empty-pictures",
    case_20_odd_picture_sizes = "odd-picture-sizes",
    case_20_picture_too_large = "picture-too-large",
    case_21_device_lost = "device-lost",
    case_22_shuffled_triangles = "shuffled-triangles",
    case_24_mirrored_transforms = "mirrored-transforms",
    case_25_fill_outside_its_range = "fill-outside-its-range",
    case_28_w_ratios = "w-ratios",
    case_29_after_a_day = "after-a-day",
    case_30_unusual_skins = "unusual-skins",
    case_30_rotations_of_any_length = "rotations-of-any-length",
    case_30_skins_beside_other_meshes = "skins-beside-other-meshes",
    case_30_culled_skins = "culled-skins",
    case_30_invalid_skins = "invalid-skins",
    case_32_hardware_cross_check = "hardware-cross-check",
    case_34_slivers_at_the_border = "slivers-at-the-border",
    case_34_culled_behind_holes = "culled-behind-holes",
    case_36_every_pair = "every-pair",
    case_37_written_sample = "written-sample",
}

/// Sweeps over many or very large pictures, which take most of the time of all cases together:
/// `rasterlab stress` draws them, as a step of the continuous integration.
const SWEEPS: &[&str] = &[
    "near-plane-sweep",
    "largest-pictures",
    "xray-at-5k",
    "glass-at-4k",
    "binding-too-large",
    "resizing",
    "hundred-equal-frames",
    "draw-order-over-32-bits",
    "scheduler-order-over-32-bits",
    "million-triangles",
    "ten-million-triangles",
    "thousand-full-screen-triangles",
    "parameters-at-range-ends",
    "all-effects-at-range-ends",
    "culled-walk",
    "culled-cameras",
    "played-particles",
    "draw-limit",
    "near-ties",
    "near-misses",
    "fill",
    "workgroups-indirect",
    "layers-on-one-pixel",
    "layers-of-glass-on-one-pixel",
    "strict-rows",
    "written-corpus",
];

/// Drawn by hand before a release, since lavapipe compiles kernels for each of their pictures: some
/// 1,200 of scenes by effects alone. The gallery shows every scene and is judged with every option,
/// and `every-pair` draws each pair of a scene and an effect or an axis that differ in their kernels.
const BY_HAND: &[&str] = &[
    "scenes-by-effects",
    "scenes-by-options",
    "scenes-by-axes",
    "million-instances",
];

#[test]
fn every_case_of_the_table_is_tested_here_or_is_a_sweep_of_the_continuous_integration() {
    let tested: BTreeSet<&str> = TESTED
        .iter()
        .chain(SWEEPS)
        .chain(BY_HAND)
        .copied()
        .collect();
    let listed: BTreeSet<&str> = stress::cases().iter().map(|case| case.name).collect();
    assert_eq!(tested, listed);
    assert_eq!(
        TESTED.len() + SWEEPS.len() + BY_HAND.len(),
        listed.len(),
        "a case is tested twice"
    );
    let steps = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(".ci/full"))
        .expect(".ci/full can be read");
    let names: String = steps
        .lines()
        .filter_map(|line| {
            line.strip_prefix("sweeps=")
                .or(line.strip_prefix("sweeps+="))
        })
        .collect();
    assert_eq!(
        names.split(',').collect::<Vec<_>>(),
        SWEEPS,
        "the cases that .ci/full draws"
    );
    assert!(
        steps
            .lines()
            .any(|line| line == "\"$lab\" stress --filter \"$sweeps\""),
        "no step of .ci/full draws them"
    );
}

#[test]
fn a_case_can_be_stopped_between_pictures() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let heard = Cell::new(0);
    let report = case("sizes").run(&mut renderer, 0, &|what| {
        assert!(what.contains("px"), "{what}");
        heard.set(heard.get() + 1);
        heard.get() < 3
    });
    assert_eq!(
        (report.outcome, heard.get(), report.counts.pictures),
        (Outcome::Stopped, 3, 3)
    );
    assert_eq!(
        case("d3d-rectangle")
            .run(&mut renderer, 0, &|_| true)
            .outcome,
        Outcome::Passed,
        "the next case is not affected"
    );
}

#[test]
fn a_panic_in_a_case_is_a_failure_of_that_case_alone() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let report = case("sizes").run(&mut renderer, 0, &|_| panic!("the listener fails"));
    assert_eq!(
        report.outcome,
        Outcome::Failed("the program panicked: the listener fails".into())
    );
    assert_eq!(
        case("d3d-rectangle")
            .run(&mut renderer, 0, &|_| true)
            .outcome,
        Outcome::Passed
    );
}

#[test]
fn another_seed_gives_other_cases_and_is_named() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let [first, second] =
        [1, 0xffff_0000].map(|seed| case("near-ties").run(&mut renderer, seed, &|_| true));
    assert_eq!([first.seed, second.seed], [Some(1), Some(0xffff_0000)]);
    assert_eq!([&first.outcome, &second.outcome], [&Outcome::Passed; 2]);
    assert_eq!(
        case("d3d-rectangle").run(&mut renderer, 1, &|_| true).seed,
        None,
        "a case without random numbers reports no seed"
    );
}

/// The mistake, the text that it replaces, the replacement, and the case that must find it.
const MUTANTS: &[(&str, &str, &str, &str)] = &[
    (
        "half of a tile is skipped",
        "block < 16",
        "block < 8",
        "slivers",
    ),
    (
        "65,535 groups at most",
        "return Dispatch(min(groups, 65535u), (groups + 65534u) / 65535u, 1u);",
        "return Dispatch(min(groups, 65535u), 1u, 1u);",
        "workgroups-indirect",
    ),
    (
        "a box that is too small",
        "abs(s0) * h.x + abs(s1) * h.y",
        "abs(s0) * h.x - abs(s1) * h.y",
        "slivers-at-the-border",
    ),
    (
        "another triangle's name",
        "corner / 3u",
        "corner / 3u + 1u",
        "hardware-cross-check",
    ),
];

#[test]
fn the_judge_of_every_kind_of_case_can_fail() {
    let Some(healthy) = renderer() else { return };
    let mut blind = Vec::new();
    for (what, from, to, name) in MUTANTS {
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        let report = case(name).run(&mut wrong, 0, &|_| true);
        eprintln!("{what}: {}", report.outcome.why().unwrap_or("not seen"));
        let has_panicked = report
            .outcome
            .why()
            .is_some_and(|why| why.contains("the program panicked"));
        if !report.outcome.is_failure() || has_panicked {
            blind.push(format!("{name} does not see: {what}"));
        }
    }
    assert!(blind.is_empty(), "{}", blind.join("\n"));
}
