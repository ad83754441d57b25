//! Raster features: coverage, depth, framebuffer, size classes, tiles, draw order and sample tests.

use super::feature::{Feature, NO_STEP, Part, flag, step_if, variant_if, word_if};
use crate::{
    accuracy::{AXES, AxisOption, Coverage, DepthFormat, SampleCounter, Visibility},
    effects::{draw_order, hooks::Shape},
    math::SMALL_EXTENT,
    scene::needs::Needs,
    shader::{
        key::{Fetch, FramebufferLayout, KernelKey, POINT_BLOCK, WorkSharing},
        pass::{Pass, RasterPhase, TriangleSource},
    },
};

/// Features that every frame has.
pub(super) const BASIS: &[Feature] = &[
    FETCH,
    COVERAGE,
    FRAMEBUFFER,
    SMALL_PATH,
    OTHER_OPTIONS,
    DEPTH,
];

pub(super) const FEATURES: &[Feature] = &[
    CLEARS,
    HIDDEN_BLOCKS,
    QUEUES,
    MEDIUM_PATH,
    LARGE_PATH,
    TILE_LIST,
    SHAPE,
    SAMPLE_SETUPS,
    DRAW_ORDER,
    COUNTERS,
    SAMPLE_EFFECTS,
];

const FETCH: Feature = Feature {
    label: |key| {
        if key.vertices.fetch == Fetch::Direct {
            "fetch=direct".into()
        } else {
            "fetch=indexed".into()
        }
    },
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
        ("large_edges", |key, _| {
            if key.options.coverage.is_float() {
                "float"
            } else {
                "rebased"
            }
        }),
    ],
    constants: &[
        ("IS_TOP_LEFT", |key, _| {
            flag(key.options.coverage != Coverage::Float)
        }),
        ("SUBPIXEL_BITS", |key, _| {
            key.options.coverage.subpixel_bits().into()
        }),
        ("SMALL_EXTENT", |_, _| SMALL_EXTENT.into()),
    ],
    ..Feature::NONE
};

const FRAMEBUFFER: Feature = Feature {
    label: |key| match key.options.visibility {
        Visibility::Packed32 => format!("visibility=packed32/{}", key.framebuffer.triangle_id_bits),
        other => format!("visibility={}", other.name()),
    },
    variants: &[
        ("framebuffer_write", framebuffer_write),
        ("framebuffer_read", framebuffer_read),
        ("xray_buffer", xray_buffer),
        ("glass_buffer", framebuffer_layout),
        ("glass_front", framebuffer_layout),
    ],
    constants: &[
        ("FINDS_NEAREST", |_, pass| {
            flag(pass.phase() == Some(RasterPhase::NearestAndSum))
        }),
        ("EARLY_LOAD", |key, _| flag(key.work.early_load)),
        ("EXCHANGES_MAXIMUM", |key, _| {
            flag(key.work.exchanges_maximum)
        }),
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

/// How a pass reads the finished pixels.
fn framebuffer_read(key: &KernelKey, pass: Pass) -> &'static str {
    let is_wide = key.work.wide_loads
        && pass.resolves()
        && key.framebuffer_layout() == FramebufferLayout::Packed64;
    if is_wide {
        "packed64_wide"
    } else {
        framebuffer_layout(key, pass)
    }
}

/// Where the sums of an x-ray are added up.
fn xray_buffer(key: &KernelKey, pass: Pass) -> &'static str {
    if key.work.paired_sums {
        "packed64_pairs"
    } else {
        framebuffer_layout(key, pass)
    }
}

/// What a raster pass does with a sample.
fn framebuffer_write(_: &KernelKey, pass: Pass) -> &'static str {
    match pass.phase() {
        Some(RasterPhase::Packed) => "packed64",
        Some(RasterPhase::Packed32) => "packed32",
        Some(RasterPhase::Depth) => "depth",
        Some(RasterPhase::TriangleId) => "triangle_id",
        Some(RasterPhase::Count) => "layers",
        Some(RasterPhase::CountSamples) => "sample_counts",
        Some(RasterPhase::BoundaryTriangle) => "boundary_samples",
        Some(RasterPhase::Sum | RasterPhase::NearestAndSum) => "xray",
        Some(RasterPhase::Glass) => "glass",
        Some(RasterPhase::Race) => "race",
        None => NO_STEP,
    }
}

/// Neighboring triangles that a workgroup takes at once: those of a vector of eight invocations, or
/// all that it takes.
fn triangle_run(work: &WorkSharing) -> u32 {
    const VECTOR: u32 = 8;
    if work.interleaves_triangles && work.group_size.is_multiple_of(VECTOR) {
        VECTOR
    } else {
        work.group_size
    }
}

/// Most candidate samples of a disc that one invocation walks, at least.
const SMALL_DISC_SAMPLES: u32 = 144;

const SMALL_PATH: Feature = Feature {
    label: |key| format!("small={}", key.paths.max_small_samples),
    constants: &[
        ("MAX_SMALL_SAMPLES", |key, pass| match pass {
            // A workgroup for each disc costs more.
            Pass::RasterCloud(_) => key.paths.max_small_samples.max(SMALL_DISC_SAMPLES).into(),
            _ => key.paths.max_small_samples.into(),
        }),
        ("MAX_SMALL_SIDE", |key, _| key.paths.max_small_side.into()),
        ("TRIANGLE_RUN", |key, _| triangle_run(&key.work).into()),
        ("LISTS_SAMPLES", |key, pass| {
            let is_shaded = matches!(
                pass.phase(),
                Some(RasterPhase::Sum | RasterPhase::NearestAndSum | RasterPhase::Glass)
            );
            flag(
                is_shaded
                    && key.paths.max_small_samples <= u32::BITS
                    && !key.options.coverage.is_float(),
            )
        }),
    ],
    ..Feature::NONE
};

/// Options of the axes that have no label of their own.
const OTHER_OPTIONS: Feature = Feature {
    label: |key| {
        let is_other = |axis: &str| {
            ![Coverage::AXIS, Visibility::AXIS]
                .iter()
                .any(|labeled| AXES[*labeled].name == axis)
        };
        let others = key
            .options
            .non_default()
            .filter(|(axis, _)| is_other(axis.name));
        others
            .map(|(axis, option)| format!("{}={option}", axis.name))
            .collect::<Vec<_>>()
            .join(" ")
    },
    ..Feature::NONE
};

const DEPTH: Feature = Feature {
    variants: &[
        ("depth", depth_interpolation),
        ("large_depth", depth_interpolation),
    ],
    constants: &[
        // As variants/depth numbers them; integer depth has the keys of reversed depth.
        ("DEPTH_FORMAT", |key, _| match key.options.depth {
            DepthFormat::Reversed | DepthFormat::Integer => 0.0,
            DepthFormat::Standard => 1.0,
            DepthFormat::Ndc16 => 2.0,
            DepthFormat::Log16 | DepthFormat::Log24 => 3.0,
        }),
        ("DEPTH_LOG_STEP", |key, _| key.depth_log_step().into()),
    ],
    ..Feature::NONE
};

fn depth_interpolation(key: &KernelKey, _: Pass) -> &'static str {
    if key.options.depth == DepthFormat::Integer {
        "integer"
    } else {
        "float"
    }
}

/// What the first pass clears beside its own work.
const CLEARS: Feature = Feature {
    variants: &[
        ("clear_step", |key, _| {
            step_if(key.work.clears_in_passes, "counters")
        }),
        ("clear_step", |key, _| match key.framebuffer_layout() {
            _ if !key.work.clears_in_passes => NO_STEP,
            FramebufferLayout::Split32 if key.view.is_light => "depth",
            FramebufferLayout::Split32 => "split32",
            FramebufferLayout::Packed32 => "packed32",
            FramebufferLayout::Packed64 => "packed64",
        }),
        ("clear_step", |key, _| {
            step_if(key.work.clears_order, "sample_counts")
        }),
        ("clear_step", |key, _| {
            step_if(
                key.work.clears_order
                    && key.samples.draw_order == Some(draw_order::Mode::Submission),
                "boundary_samples",
            )
        }),
    ],
    constants: &[("HAS_SURPLUS", |key, _| flag(key.work.clears_in_passes))],
    ..Feature::NONE
};

const HIDDEN_BLOCKS: Feature = Feature {
    constants: &[
        ("HIDES_BLOCKS", |key, pass| {
            let keeps_keys = matches!(
                pass.phase(),
                Some(RasterPhase::Packed | RasterPhase::Depth | RasterPhase::TriangleId)
            );
            flag(key.hides_blocks() && keeps_keys)
        }),
        ("RAISES_BLOCKS", |_, pass| {
            flag(pass.phase() != Some(RasterPhase::TriangleId))
        }),
        ("MARKS_ENTRIES", |key, pass| {
            flag(key.hides_blocks() && pass.phase() == Some(RasterPhase::Depth))
        }),
        ("SKIPS_HIDDEN_ENTRIES", |key, pass| {
            flag(key.hides_blocks() && pass.phase() == Some(RasterPhase::TriangleId))
        }),
    ],
    ..Feature::NONE
};

const QUEUES: Feature = Feature {
    constants: &[("HAS_QUEUES", |key, _| flag(key.has_queues()))],
    ..Feature::NONE
};

const MEDIUM_PATH: Feature = Feature {
    label: |key| word_if(key.paths.has_medium, "medium"),
    part: Some(Part {
        name: "raster_medium",
        is_used: |key| key.paths.has_medium,
        why_omitted: largest_triangle,
    }),
    variants: &[("medium_boxes", |key, _| {
        variant_if(key.shares_entries(), "shared")
    })],
    constants: &[("DRAWS_MEDIUM", |key, _| flag(key.paths.has_medium))],
};

const LARGE_PATH: Feature = Feature {
    label: |key| word_if(key.paths.has_large, "large"),
    part: Some(Part {
        name: "tile_large, raster_large",
        is_used: |key| key.paths.has_large,
        why_omitted: largest_triangle,
    }),
    variants: &[
        ("large_tiles", |key, _| {
            variant_if(key.shares_entries(), "shared")
        }),
        ("divide_step", |key, pass| {
            step_if(
                key.divides_in_medium() && key.is_first_visit(pass),
                "large_queue",
            )
        }),
    ],
    constants: &[
        ("HAS_LARGE", |key, _| flag(key.paths.has_large)),
        ("DRAWS_LARGE", |key, _| flag(key.paths.has_large)),
    ],
};

fn largest_triangle(needs: &Needs) -> String {
    format!("no triangle exceeds {:.1} px", needs.largest_px)
}

/// The list of the tiles that a triangle touches, which the resolve then visits.
const TILE_LIST: Feature = Feature {
    variants: &[("mark_tiles", |key, pass| {
        use RasterPhase::{BoundaryTriangle, Count, CountSamples, Glass, Sum, TriangleId};
        let is_repeated = matches!(
            pass.phase(),
            Some(TriangleId | Count | Sum | Glass | CountSamples | BoundaryTriangle)
        );
        step_if(key.work.listed_tiles && !is_repeated, "marked")
    })],
    constants: &[
        ("IS_BRANCHLESS", |key, _| flag(key.work.listed_tiles)),
        ("LISTS_BACKGROUND", |key, _| flag(key.lists_background())),
        ("HAS_DOT_STRENGTHS", |key, _| {
            flag(key.effects.dots.is_some())
        }),
        ("TILE_SIDE", |key, _| key.tile_side().into()),
    ],
    ..Feature::NONE
};

const SHAPE: Feature = Feature {
    label: |key| match key.samples.shape {
        Shape::Triangles => word_if(key.samples.has_points, "points"),
        Shape::Boxes => "shape=boxes".into(),
        Shape::Points => "shape=points".into(),
    },
    variants: &[("points", |key, _| match key.samples.shape {
        _ if !key.samples.has_points => "default",
        Shape::Points => "corners",
        Shape::Triangles | Shape::Boxes => "spread",
    })],
    constants: &[
        ("SHAPE", |key, _| (key.samples.shape as u32).into()),
        ("POINT_BLOCK", |_, _| POINT_BLOCK.into()),
        ("HAS_BLOCK_BOXES", |key, _| {
            flag(!key.moves() && key.options.position_format.packed_bits().is_none())
        }),
        ("ONLY_PIXELS", |key, _| {
            flag(key.paths.only_pixels && !key.moves())
        }),
        ("SHOWS_DISCS", |key, _| {
            flag(key.samples.shape == Shape::Triangles)
        }),
        ("INVOCATIONS_PER_TRIANGLE", |key, _| {
            key.work.invocations_per_triangle.into()
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
    variants: &[("setup_step", |key, _| {
        step_if(key.samples.has_mask, "alpha_mask")
    })],
    constants: &[
        ("IS_CLIPPED_TRIANGLES", |_, pass| {
            flag(pass == Pass::SampleSetup(TriangleSource::ClippedTriangles))
        }),
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
    constants: &[
        ("TESTS_EVERY_SAMPLE", |key, _| {
            flag(key.samples.draw_order == Some(draw_order::Mode::Scheduler))
        }),
        ("HAS_RANKS", |key, _| flag(key.samples.draw_order.is_some())),
        // As variants/sample_test numbers them.
        ("ORDER_TEST", |key, pass| match order(key, pass) {
            None | Some(OrderTest::Submission) => 0.0,
            Some(OrderTest::Scheduler) => 1.0,
            Some(OrderTest::Racy) => 2.0,
        }),
    ],
    ..Feature::NONE
};

/// How a pass decides which samples come first.
enum OrderTest {
    Submission,
    Scheduler,
    Racy,
}

/// The test of a pass, if it has one. Counting phases count every sample, and the boundary
/// triangle's are marked by its id; of two passes over the same samples, only the first
/// takes numbers from the counter.
fn order(key: &KernelKey, pass: Pass) -> Option<OrderTest> {
    use draw_order::Mode::{Scheduler, Submission};
    match (key.samples.draw_order, pass.phase()) {
        (None, _)
        | (_, Some(RasterPhase::CountSamples | RasterPhase::BoundaryTriangle))
        | (Some(Scheduler), Some(RasterPhase::TriangleId)) => None,
        _ if key.options.sample_counter == SampleCounter::Racy => Some(OrderTest::Racy),
        (Some(Submission), _) => Some(OrderTest::Submission),
        (Some(Scheduler), _) => Some(OrderTest::Scheduler),
    }
}

const COUNTERS: Feature = Feature {
    constants: &[
        ("IS_FIRST_VISIT", |key, pass| flag(key.is_first_visit(pass))),
        ("USES_SECOND_COUNTER", |key, pass| {
            flag(key.uses_second_counter(pass))
        }),
    ],
    ..Feature::NONE
};

/// Does a pass draw what is opaque alone?
fn leaves_out_glass(key: &KernelKey, pass: Pass) -> bool {
    use RasterPhase::{Depth, Packed, Packed32, Race, TriangleId};
    key.has_glass()
        && matches!(
            pass.phase(),
            Some(Depth | TriangleId | Packed | Packed32 | Race)
        )
}

const SAMPLE_EFFECTS: Feature = Feature {
    part: Some(Part {
        name: "sample effects",
        is_used: KernelKey::has_sample_effects,
        why_omitted: |_| "no effect discards samples".into(),
    }),
    // In the order in which they are called.
    variants: &[
        ("sample_test", |key, pass| {
            step_if(leaves_out_glass(key, pass), "opaque")
        }),
        ("sample_test", |key, _| {
            step_if(key.has_sample_effects(), "effects")
        }),
        ("sample_test", |key, _| {
            step_if(key.has_discs(), "particle_disc")
        }),
        ("sample_test", |key, pass| {
            let tests_discs = !matches!(pass, Pass::RasterCloud(_));
            step_if(
                key.samples.has_points && key.samples.shape == Shape::Triangles && tests_discs,
                "point",
            )
        }),
        ("sample_test", |key, _| {
            step_if(key.samples.has_mask, "alpha_mask")
        }),
        ("sample_test", |key, pass| {
            step_if(order(key, pass).is_some(), "draw_order")
        }),
    ],
    ..Feature::NONE
};
