//! Perturbation: shading at the edge of what f32 may do.
//!
//! Where a color has a step, a value that f64 puts on one side may lie on the other in f32; where a
//! texture or a shadow map is looked up, f32 may meet the neighboring texel. The oracle shades a
//! picture again with every such quantity moved by its error bound; answers between those pictures
//! are right (`docs/exactness.md` §9). The bounds themselves stand where the quantity is computed.

use glam::{DVec3, DVec4};

/// By how much a picture differs from the straight one, in error bounds. Zero draws the picture
/// itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Perturbation {
    /// Added to every value that decides a step of color; its sign also moves shadow map lookups.
    pub color_step: f64,
    pub texture: TexturePerturbation,
    pub place: PlacePerturbation,
    /// The other side of the triangle is seen.
    pub is_turned: bool,
    pub interpolated: InterpolatedPerturbation,
}

/// Offset of the place of a sample: in x, y and z of world space, and along the ray of its pixel,
/// each in roundings of the distances from which the place is computed.
pub type PlacePerturbation = [f64; 4];

/// Offsets of what is interpolated from corners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterpolatedPerturbation {
    /// Added to the unit normal, world space.
    pub normal: DVec3,
    /// Added to the unit normal of the triangle's plane.
    pub plane: DVec3,
    /// Of the depth, as a fraction of it.
    pub depth: f64,
    /// Added to the color that the corners' mix, which stays between theirs.
    pub color: DVec4,
    /// Added to the distances from the edges, in pixels.
    pub edge_distance_px: DVec3,
}

/// Offset of texture lookups: across, down, and in the level of detail, each in error bounds.
pub type TexturePerturbation = [f64; 3];
