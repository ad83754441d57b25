//! Plan errors: why no kernel can draw a picture as it was asked for.

use crate::effects::Conflict;

/// Why no kernel can draw a picture as it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    #[error(
        "visibility packed64 needs 64-bit atomics, which this adapter lacks; use split32 or leave it out"
    )]
    NoInt64Atomics,
    #[error(
        "visibility packed32 keeps triangle and depth in 32 bits, at most 2^24 triangles, and this scene has {triangles}; use split32"
    )]
    TooManyTriangles { triangles: u64 },
    #[error(
        "coverage {option} cannot draw the effect {effect}, which measures triangles in 1/256 px; use fixed8, float or float-top-left"
    )]
    SubpixelGrid {
        option: &'static str,
        effect: String,
    },
    #[error(
        "xray_sums {option} counts all layers alike, and this xray weighs them; use four32, or weight = \"equal\""
    )]
    XrayWeights { option: &'static str },
    #[error("coverage fixed12 draws pictures of at most 2047 px a side, and this one has {}x{}; use fixed8", size[0], size[1])]
    PictureTooLarge { size: [u32; 2] },
    #[error(
        "depth {option} stores no distances, so xray cannot count within a window; use reversed, or reach = \"all\""
    )]
    XrayWindow { option: &'static str },
    #[error("dot_culling cpu searches a tree of fixed lines, but {what}; use gpu")]
    MovingLines { what: String },
    #[error(
        "vertex_transform strict needs integers in every decision, but {what}; remove that, or use another option"
    )]
    NotStrict { what: String },
    #[error("position_format {option} packs meshes that keep their shape, but {what}; use stored")]
    PackedDeformation {
        option: &'static str,
        what: &'static str,
    },
    #[error("depth integer divides exact edges, which coverage {option} does not have; use fixed8")]
    FloatCoverage { option: &'static str },
    #[error(
        "shader_checks trusted is for the shaders inside this program, and the effect {effect} comes from a file, whose indices nobody has \
         checked; use checked"
    )]
    UncheckedEffect { effect: String },
    #[error(transparent)]
    Conflict(#[from] Conflict),
}
