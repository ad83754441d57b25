//! Promise: every preset of `presets/extremes` is exact with every option and work distribution,
//! the cases that need code meet their expectations, and the judge of both can fail. Needs an
//! adapter. `RASTERLAB_SEED=n` changes the random cases; a failure names the case and the seed that
//! draw it again.

use std::{collections::BTreeSet, fs, path::Path};

use rasterlab::{
    extremes,
    gpu::Renderer,
    preset_file::{self, Folders},
};
use rasterlab_fuzz::stress::{self, Outcome, Report};

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
    let Report {
        outcome,
        notes,
        seed,
        ..
    } = case(name).run(&mut renderer, seed());
    for note in notes.iter().map(String::as_str).chain(outcome.why()) {
        eprintln!("case {name}: {}: {note}", outcome.word());
    }
    let again = seed
        .map(|seed| format!(" (RASTERLAB_SEED={seed})"))
        .unwrap_or_default();
    assert!(!outcome.is_failure(), "case {name}: {outcome:?}{again}");
}

/// Draws every second preset with every option and with every way to share out the work; or each
/// with one of these, in turn.
fn check_presets(half: usize, reach: Reach) {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/extremes");
    let mut faults = Vec::new();
    let names = extremes::names(None).into_iter().enumerate();
    for (turn, name) in names.skip(half).step_by(2) {
        let path = folder.join(format!("{name}.toml"));
        let preset_file = preset_file::open(&path.to_string_lossy(), &Folders::default())
            .unwrap_or_else(|error| panic!("{error}"));
        faults.extend(preset_file.warnings.iter().cloned());
        let preset = &preset_file.preset;
        let test = preset.test.clone().unwrap_or_default();
        let scene = preset_file::load_scene(preset, preset_file.path.as_deref())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        if !test.refused.is_empty() {
            continue;
        }
        // A million triangles show no more with another tuning.
        let tunings = match scene.triangle_count() {
            ..100_000 => tunings().to_vec(),
            _ => vec![renderer.gpu().caps.tuning()],
        };
        let mut ways: Vec<_> = options(&renderer)
            .into_iter()
            .flat_map(|option| tunings.iter().map(move |tuning| (option, *tuning)))
            .collect();
        if reach == Reach::Few {
            ways = vec![ways[turn % ways.len()]];
        }
        let mut first = None;
        for (option, tuning) in ways {
            renderer.set_tuning(tuning);
            let mut accuracy = preset.accuracy;
            accuracy.pins = accuracy.pins.with(option);
            let (capture, verdict) = judged_preset(&mut renderer, &scene, preset, &accuracy);
            let over = test.pixels_over_tolerance(&verdict, &capture.frame);
            let mut of_picture = test.faults(&verdict.report, over, false);
            of_picture.extend(test.count_faults(&capture.frame, capture.layers.as_deref()));
            let ids = capture.frame.triangle_id;
            if preset.stack.is_repeatable() && *first.get_or_insert_with(|| ids.clone()) != ids {
                of_picture.push("other triangles than in the first picture".into());
            }
            let what = format!("{name}, {}, {tuning:?}", option.name());
            faults.extend(of_picture.iter().map(|fault| format!("{what}: {fault}")));
        }
        let default = renderer.gpu().caps.tuning();
        renderer.set_tuning(default);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn presets_are_exact_first_half(reach: Reach) {
    check_presets(0, reach);
}

fn presets_are_exact_second_half(reach: Reach) {
    check_presets(1, reach);
}

few_and_all!(presets_are_exact_first_half, presets_are_exact_second_half);

#[test]
fn every_case_of_the_program_is_what_its_test_says() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let cases = extremes::Cases::unpack().expect("a folder for temporary files");
    for (name, is_stopped) in [
        ("d3d-rectangle", false),
        ("too-many-layers-of-glass", false),
        ("sizes", true),
    ] {
        let outcome = cases.run(name, &mut renderer, &|_| !is_stopped).outcome;
        match (name, outcome) {
            ("d3d-rectangle", extremes::Outcome::Passed)
            | ("too-many-layers-of-glass", extremes::Outcome::Refused(_))
            | ("sizes", extremes::Outcome::Stopped) => {}
            (_, outcome) => panic!("{name}: {outcome:?}"),
        }
    }
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
    case_3_d3d_snap = "d3d-snap",
    case_4_translation = "translation",
    case_12_non_finite_positions = "non-finite-positions",
    case_12_non_finite_attributes = "non-finite-attributes",
    case_17_degenerate_triangles = "degenerate-triangles",
    case_18_workgroups_direct = "workgroups-direct",
    case_19_queues = "queues",
    case_19_clipped_in_turns = "clipped-in-turns",
    case_20_empty_pictures = "empty-pictures",
    case_20_picture_too_large = "picture-too-large",
    case_22_shuffled_triangles = "shuffled-triangles",
    case_24_mirrored_transforms = "mirrored-transforms",
    case_30_skins_beside_other_meshes = "skins-beside-other-meshes",
    case_30_culled_skins = "culled-skins",
    case_32_hardware_cross_check = "hardware-cross-check",
    case_34_slivers_at_the_border = "slivers-at-the-border",
    case_34_culled_behind_holes = "culled-behind-holes",
    case_37_written_sample = "written-sample",
}

/// Sweeps over many or very large pictures, which take most of the time of all cases together:
/// `rasterlab-fuzz cases` draws them, as a step of the continuous integration.
const SWEEPS: &[&str] = &[
    "near-plane-sweep",
    "xray-at-5k",
    "glass-at-4k",
    "binding-too-large",
    "resizing",
    "hundred-equal-frames",
    "draw-order-over-32-bits",
    "scheduler-order-over-32-bits",
    "ten-million-triangles",
    "thousand-full-screen-triangles",
    "parameters-at-range-ends",
    "all-effects-at-range-ends",
    "culled-cameras",
    "near-ties",
    "near-misses",
    "workgroups-indirect",
    "strict-rows",
    "written-corpus",
    "every-pair",
];

/// Drawn by hand before a release.
const BY_HAND: &[&str] = &["million-instances"];

#[test]
fn every_case_that_needs_code_is_tested_here_or_is_a_sweep_of_the_continuous_integration() {
    let tested: BTreeSet<&str> = TESTED
        .iter()
        .chain(SWEEPS)
        .chain(BY_HAND)
        .copied()
        .collect();
    let listed: BTreeSet<&str> = stress::cases().iter().map(|case| case.name).collect();
    assert_eq!(tested, listed);
    let steps = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(".ci/full"))
        .expect(".ci/full can be read");
    let line = steps
        .lines()
        .find_map(|line| line.split_once("rasterlab-fuzz -- cases "));
    let names = line.map(|(_, names)| names.split(',').collect::<Vec<_>>());
    assert_eq!(
        names.as_deref(),
        Some(SWEEPS),
        "the cases that .ci/full draws"
    );
}

#[test]
fn another_seed_gives_other_cases_and_is_named() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let [first, second] = [1, 0xffff_0000].map(|seed| case("near-ties").run(&mut renderer, seed));
    assert_eq!([first.seed, second.seed], [Some(1), Some(0xffff_0000)]);
    assert_eq!([&first.outcome, &second.outcome], [&Outcome::Passed; 2]);
    assert_eq!(
        case("d3d-snap").run(&mut renderer, 1).seed,
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
        "size-class-borders",
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
    let presets = extremes::Cases::unpack().expect("a folder for temporary files");
    let mut blind = Vec::new();
    for (what, from, to, name) in MUTANTS {
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        let why = if extremes::names(None).contains(name) {
            let report = presets.run(name, &mut wrong, &|_| true);
            report
                .outcome
                .is_failure()
                .then(|| report.outcome.why().unwrap_or_default().to_owned())
        } else {
            let report = case(name).run(&mut wrong, 0);
            report
                .outcome
                .is_failure()
                .then(|| report.outcome.why().unwrap_or_default().to_owned())
        };
        eprintln!("{what}: {}", why.as_deref().unwrap_or("not seen"));
        if why.is_none_or(|why| why.contains("the program panicked")) {
            blind.push(format!("{name} does not see: {what}"));
        }
    }
    assert!(blind.is_empty(), "{}", blind.join("\n"));
}
