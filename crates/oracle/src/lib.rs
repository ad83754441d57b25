//! The oracle: an exact CPU renderer that judges adapters and makes the golden images.
//!
//! Coverage and triangle ids are computed in i64 and i128, afresh at every pixel of a triangle's
//! bounding box; projection, clipping, depth and shading are f64. The oracle runs no kernel text,
//! planner or GPU layout, no SIMD math in a comparison that decides, and no math function of the
//! platform; both sides use `math`, `scene` and effect parameters. Work is parallel by rows and
//! triangles; no result depends on the order of threads.
//!
//! Imports run one way, from each of these to those before it:
//!
//! * `arithmetic`, `perturbation`, `point`, `shot`: exact arithmetic, and what a picture shows
//! * `budget`: how much memory a picture may take, and how many positions
//! * `render`: draws exact pictures
//! * `bounds`: how far an f32 renderer may be from them
//! * `judge`: compares an adapter's picture with both
//! * `probe`: tells why a sample shows what it shows
//!
//! [`project`] deforms, moves, projects and snaps vertices and clips triangles; [`triangles`]
//! assembles and orients them; [`sample_setups`] computes what sample effects test against;
//! [`cover_with`] finds the nearest triangle of each sample; [`shade`] colors it; [`judge`]
//! compares a frame that an adapter drew with all of that. The arithmetic is specified in
//! `docs/exactness.md`.

mod arithmetic;
mod bounds;
mod budget;
mod judge;
mod perturbation;
mod point;
mod probe;
mod probe_text;
mod render;
mod shot;

pub use arithmetic::{depth_key::depth_bound, edge::owns, ftz};
pub use bounds::{
    coverage::{BoundedCoverage, BoundedSample, cover_claims},
    vertex::snap_bounds,
};
pub use budget::{VARIABLE as MEMORY_VARIABLE, choose_memory};
pub use judge::{
    picture::{JUDGE_STAGES, judge},
    shadow::shadow_errors,
};
pub use probe::{Outcome, ProbedSample, ProbedTriangle, probe};
pub use render::{
    coverage::{Coverage, EdgeAtSample, Sample, cover, cover_with},
    deform::volume,
    dots::{dot_records, dot_strengths},
    draw_order::limited,
    particles,
    picture::{
        render, render_next, render_rows, render_sequence, render_with_geometry, strict_frame,
    },
    project::project,
    references::{
        finest_bits, project_finest, references, render_finest, render_reference, render_scaled,
        render_scaled_row,
    },
    resample::resampled,
    resolve::{ResolveInput, shade},
    sample_rules::{DrawLimit, SampleTests},
    sample_setup::sample_setups,
    shadow::shadow_map,
    strict::project_strict,
    triangles::{OrientedTriangle, triangles},
    work_limits::{can_draw_sequence, can_judge},
};
pub use shot::Shot;

use rasterlab_model::{effects, frame, math, measure, scene, work};
