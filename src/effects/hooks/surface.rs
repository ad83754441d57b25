//! The surface hook: what colour is it?

use glam::{DVec2, DVec3, DVec4};

use crate::params::Params;

/// What the rasterizer knows about a visible sample; a surface effect changes it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Linear RGBA so far; begins as the material's base colour times the vertex colour and the texture, and what it emits.
    pub color: DVec4,
    /// The part of the colour that no light changes: what the material emits, or all of it where it is unlit. An effect that
    /// paints over the colour leaves as much less of this.
    pub glow: DVec3,
    /// World space, metres: on the ray of its pixel as far as `depth_m` says, whichever way corners have snapped.
    pub position: DVec3,
    /// Unit, towards the viewer's side: interpolated, then whatever earlier effects made of it.
    pub normal: DVec3,
    /// Unit normal of the triangle's plane, towards the same side.
    pub flat_normal: DVec3,
    /// Unit vector from the sample to the eye.
    pub view: DVec3,
    /// Mean of the triangle's corners, world space.
    pub center: DVec3,
    /// Where that mean stands in the picture: 0 left and top, 1 right and bottom.
    pub center_screen: DVec2,
    /// Where the sample stands in the picture.
    pub screen: DVec2,
    /// The same in pixels, right and down.
    pub pixel: DVec2,
    /// Shares of the three corners at the sample, measured on the screen: 1 at the corner, 0 on the opposite edge. Of a
    /// triangle that was clipped, measured on its plane.
    pub barycentrics: DVec3,
    /// Distance of the sample from the edge opposite each corner, pixels.
    pub edge_distance_px: DVec3,
    /// Distance from the eye along the viewing direction, metres.
    pub depth_m: f64,
    /// Side of a pixel at the sample's depth, metres, across the view.
    pub pixel_size_m: f64,
    /// Mean of `depth_m` over the triangle's corners.
    pub flat_depth_m: f64,
    /// Nearest and farthest `depth_m` of the scene's box.
    pub depth_range_m: DVec2,
    /// Global triangle id.
    pub triangle_id: u32,
    /// Share of all samples that were drawn before the triangle id's first, where a draw order is kept; else 0.
    pub rank: f64,
    /// Share of the light that arrives, 0 to 1, where an effect asks for it; else 0.
    pub lit: f64,
    /// Added to whatever decides a step of colour; 0 but for a judge, who finds out with it which pixels lie so close to
    /// a step that either answer is right.
    pub nudge: f64,
}

/// The f64 side of an effect on the surface hook.
pub trait SurfaceEffect: Params {
    fn apply(surface: Surface, params: &Self) -> Surface;
}
