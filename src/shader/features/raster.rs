//! Raster features: coverage, depth, framebuffer, size classes, tiles, draw order and sample tests.

use super::feature::{Feature, Part, flag, word_if};
use crate::{
    accuracy::{AXES, AxisOption, Coverage, DepthFormat, SampleCounter, Visibility},
    effects::{draw_order, hooks::Shape},
    scene::needs::Needs,
    shader::{
        key::{Fetch, FramebufferLayout, KernelKey},
        pass::{Pass, RasterPhase, TriangleSource},
    },
};

/// Features that every frame has.
pub(super) const BASIS: &[Feature] = &[FETCH, COVERAGE, FRAMEBUFFER, SMALL_PATH, OTHER_OPTIONS, DEPTH];

pub(super) const FEATURES: &[Feature] =
    &[QUEUES, MEDIUM_PATH, LARGE_PATH, BINS, TILE_LIST, SHAPE, SAMPLE_SETUPS, DRAW_ORDER, COUNTERS, SAMPLE_EFFECTS];

const FETCH: Feature = Feature {
    label: |key| if key.vertices.fetch == Fetch::Direct { "fetch=direct".into() } else { "fetch=indexed".into() },
    ..Feature::NONE
};

const COVERAGE: Feature = Feature {
    label: |key| format!("coverage={}", key.options.coverage.name()),
    variants: &[
        ("coverage", |key, _| match key.samples.shape {
            Shape::Boxes => "boxes",
            _ if key.options.coverage.is_float() => "float",
            _ => "fixed",
        }),
        ("blocks", |key, _| if key.options.coverage.is_float() { "float" } else { "rebased" }),
    ],
    constants: &[
        ("IS_TOP_LEFT", |key, _| flag(key.options.coverage != Coverage::Float)),
        ("SUBPIXEL_BITS", |key, _| key.options.coverage.subpixel_bits().into()),
    ],
    ..Feature::NONE
};

const FRAMEBUFFER: Feature = Feature {
    label: |key| match key.options.visibility {
        Visibility::Packed32 => format!("visibility=packed32/{}", key.framebuffer.triangle_id_bits),
        other => format!("visibility={}", other.name()),
    },
    variants: &[("owner", framebuffer_layout), ("sums", framebuffer_layout)],
    constants: &[
        ("EARLY_LOAD", |key, _| flag(key.work.early_load)),
        ("ID_BITS", |key, _| key.framebuffer.triangle_id_bits.into()),
        ("DEPTH_KEY_BITS", |key, _| key.depth_key_range().0.into()),
        ("MIN_DEPTH_KEY", |key, _| key.depth_key_range().1.into()),
    ],
    ..Feature::NONE
};

fn framebuffer_layout(key: &KernelKey, _: Pass) -> &'static str {
    match key.framebuffer_layout() {
        FramebufferLayout::Split32 => "split32",
        FramebufferLayout::Packed32 => "packed32",
        FramebufferLayout::Packed64 => "packed64",
    }
}

/// What a raster pass does with a sample.
pub(super) fn visibility_stem(pass: Pass) -> Option<&'static str> {
    Some(match pass.phase()? {
        RasterPhase::Packed => "packed64",
        RasterPhase::Packed32 => "packed32",
        RasterPhase::Depth => "split32_depth",
        RasterPhase::TriangleId => "split32_owner",
        RasterPhase::Count => "count",
        RasterPhase::CountSamples => "tally",
        RasterPhase::BoundaryTriangle => "straddle",
        RasterPhase::Sum => "sum",
        RasterPhase::Race => "race",
        RasterPhase::BinCount | RasterPhase::BinFill | RasterPhase::Tiles => return None,
    })
}

const SMALL_PATH: Feature = Feature {
    label: |key| format!("small={}", key.paths.max_small_samples),
    constants: &[
        ("MAX_SMALL_SAMPLES", |key, _| key.paths.max_small_samples.into()),
        ("MAX_SMALL_SIDE", |key, _| key.paths.max_small_side.into()),
    ],
    ..Feature::NONE
};

/// Options of the axes that have no label of their own.
const OTHER_OPTIONS: Feature = Feature {
    label: |key| {
        let is_other = |axis: &str| ![Coverage::AXIS, Visibility::AXIS].iter().any(|labelled| AXES[*labelled].name == axis);
        let others = key.options.non_default().filter(|(axis, _)| is_other(axis.name));
        others.map(|(axis, option)| format!("{}={option}", axis.name)).collect::<Vec<_>>().join(" ")
    },
    ..Feature::NONE
};

const DEPTH: Feature = Feature {
    variants: &[("depth", |key, _| key.options.depth.name()), ("keys", depth_keys), ("block_keys", depth_keys), ("cell_keys", depth_keys)],
    ..Feature::NONE
};

fn depth_keys(key: &KernelKey, _: Pass) -> &'static str {
    if key.options.depth == DepthFormat::Integer { "integer" } else { "float" }
}

const QUEUES: Feature = Feature { variants: &[("queues", |key, _| if key.has_queues() { "kept" } else { "none" })], ..Feature::NONE };

const MEDIUM_PATH: Feature = Feature {
    label: |key| word_if(key.paths.has_medium, "medium"),
    part: Some(Part { name: "raster_medium", is_used: |key| key.paths.has_medium, why_omitted: largest_triangle }),
    ..Feature::NONE
};

const LARGE_PATH: Feature = Feature {
    label: |key| word_if(key.paths.has_large, "large"),
    part: Some(Part { name: "tile_large, raster_large", is_used: |key| key.paths.has_large, why_omitted: largest_triangle }),
    constants: &[("HAS_LARGE", |key, _| flag(key.paths.has_large))],
    ..Feature::NONE
};

fn largest_triangle(needs: &Needs) -> String {
    format!("no triangle exceeds {:.1} px", needs.largest_px)
}

const BINS: Feature = Feature {
    variants: &[
        ("walk", walk),
        ("discs", walk),
        ("bins", |_, pass| if pass.phase() == Some(RasterPhase::BinFill) { "fill" } else { "count" }),
        ("cells", |key, _| match key.samples.shape {
            Shape::Points => "points",
            Shape::Triangles if key.paths.has_large => "all",
            Shape::Triangles | Shape::Boxes => "small",
        }),
    ],
    constants: &[
        ("IS_LARGE", |_, pass| flag(matches!(pass, Pass::BinLarge(_)))),
        ("MAX_LIST_ENTRIES", |key, _| key.work.max_list_entries.into()),
    ],
    ..Feature::NONE
};

fn walk(_: &KernelKey, pass: Pass) -> &'static str {
    if pass.phase().is_some_and(RasterPhase::is_bin) { "tiles" } else { "samples" }
}

/// The list of the tiles that a triangle touches, which the resolve then visits.
const TILE_LIST: Feature = Feature {
    variants: &[
        ("marks", |key, pass| {
            use RasterPhase::{BoundaryTriangle, Count, CountSamples, Sum, TriangleId};
            let is_repeated = matches!(pass.phase(), Some(TriangleId | Count | Sum | CountSamples | BoundaryTriangle));
            if key.work.listed_tiles && !is_repeated { "kept" } else { "none" }
        }),
        ("pixels", |key, _| if key.work.listed_tiles { "listed" } else { "all" }),
    ],
    constants: &[("IS_BRANCHLESS", |key, _| flag(key.work.listed_tiles)), ("TILE_SIDE", |key, _| key.tile_side().into())],
    ..Feature::NONE
};

const SHAPE: Feature = Feature {
    label: |key| match key.samples.shape {
        Shape::Triangles => String::new(),
        Shape::Boxes => "shape=boxes".into(),
        Shape::Points => "shape=points".into(),
    },
    constants: &[
        ("SHAPE", |key, _| (key.samples.shape as u32).into()),
        ("INVOCATIONS_PER_TRIANGLE", |key, pass| {
            if pass.phase().is_some_and(RasterPhase::is_bin) { 1.0 } else { key.work.invocations_per_triangle.into() }
        }),
    ],
    ..Feature::NONE
};

const SAMPLE_SETUPS: Feature = Feature {
    part: Some(Part {
        name: "sample setup",
        is_used: |key| key.sample_setups() > 0,
        why_omitted: |_| "neither effects nor masks need anything per triangle".into(),
    }),
    variants: &[("records", |_, pass| if matches!(pass, Pass::SampleSetup(_) | Pass::OrderRanks) { "write" } else { "read" })],
    constants: &[
        ("IS_CLIPPED_TRIANGLES", |_, pass| flag(pass == Pass::SampleSetup(TriangleSource::ClippedTriangles))),
        ("SAMPLE_SETUPS", |key, _| key.sample_setups().into()),
    ],
    ..Feature::NONE
};

const DRAW_ORDER: Feature = Feature {
    label: |key| match key.samples.draw_order {
        None => String::new(),
        Some(draw_order::Mode::Submission) => "order=submission".into(),
        Some(draw_order::Mode::Scheduler) => "order=scheduler".into(),
    },
    part: Some(Part {
        name: "draw order",
        is_used: |key| key.samples.draw_order.is_some(),
        why_omitted: |_| "every sample is drawn".into(),
    }),
    variants: &[("order", order), ("ranks", |key, _| if key.samples.draw_order.is_some() { "kept" } else { "none" })],
    constants: &[("TESTS_EVERY_SAMPLE", |key, _| flag(key.samples.draw_order == Some(draw_order::Mode::Scheduler)))],
};

/// Counting phases count every sample; of two passes over the same samples, only the first takes numbers from the counter.
fn order(key: &KernelKey, pass: Pass) -> &'static str {
    use draw_order::Mode::{Scheduler, Submission};
    match (key.samples.draw_order, pass.phase()) {
        (_, Some(RasterPhase::BoundaryTriangle)) => "straddler",
        (None, _) | (_, Some(RasterPhase::CountSamples)) | (Some(Scheduler), Some(RasterPhase::TriangleId)) => "free",
        _ if key.options.sample_counter == SampleCounter::Racy => "racy",
        (Some(Submission), _) => "submission",
        (Some(Scheduler), _) => "scheduler",
    }
}

const COUNTERS: Feature = Feature {
    constants: &[
        ("IS_FIRST_VISIT", |key, pass| flag(key.is_first_visit(pass))),
        ("USES_SECOND_COUNTER", |key, pass| flag(key.uses_second_counter(pass))),
    ],
    ..Feature::NONE
};

const SAMPLE_EFFECTS: Feature = Feature {
    part: Some(Part {
        name: "sample effects",
        is_used: KernelKey::has_sample_effects,
        why_omitted: |_| "no effect discards samples".into(),
    }),
    variants: &[
        ("samples", |key, _| if key.has_sample_effects() { "hooked" } else { "all" }),
        ("mask", |key, pass| match (key.samples.has_mask, pass) {
            (false, _) => "none",
            (true, Pass::SampleSetup(_)) => "settled",
            (true, _) => "asked",
        }),
    ],
    ..Feature::NONE
};
