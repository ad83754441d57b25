//! Clipping in homogeneous space (Sutherland and Hodgman 1974): near plane, then the four sides of the guard band.
//!
//! Every cut edge is interpolated from its inside to its outside end, so neighbours that share it find the same point,
//! and the coordinate that a plane fixes is set, not computed.

use rayon::prelude::*;

use super::{
    coverage::corner_records,
    moved,
    project::{Clip, half_size, snap_inside},
};
use crate::{
    frame::{ClippedTriangle, Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{Scene, draw::Draw, view::View},
};

/// The planes in the order of clipping, each by its vertex flag.
const PLANES: [u32; 5] =
    [vertex_flags::NEAR, vertex_flags::GUARD[0], vertex_flags::GUARD[1], vertex_flags::GUARD[2], vertex_flags::GUARD[3]];

/// Must a triangle with these corner flags be cut? Not when a corner is rejected, and not when all lie beyond one plane.
pub(super) fn is_cut(flags: [u32; 3]) -> bool {
    let any = flags[0] | flags[1] | flags[2];
    let all = flags[0] & flags[1] & flags[2];
    any & vertex_flags::REJECTED == 0 && any & vertex_flags::CLIPPED != 0 && all & vertex_flags::CLIPPED == 0
}

/// A point in clip space, in one arithmetic or another.
pub(super) trait Point: Copy + Send + Sync {
    /// Is it on the inner side of `plane`, or on it?
    fn is_inside(&self, plane: u32, view: &View) -> bool;

    /// Where the edge from this inside point to `outside` meets `plane`; `on` has the flags of all planes there.
    fn cut(&self, outside: &Self, plane: u32, on: u32, view: &View) -> Self;

    /// Record of a point that planes with the flags `on` made, but for the coordinates that these fix.
    fn snapped(&self, on: u32, view: &View) -> SnappedVertex;
}

/// ClippedTriangles of all cut triangles of a draw, in triangle order, each triangle as a fan from its first remaining corner; `clip`
/// places a corner.
pub(super) fn pieces<P: Point>(
    scene: &Scene,
    draw: &Draw,
    view: &View,
    geometry: &Geometry,
    clip: impl Fn(moved::Corner) -> P + Sync,
) -> Vec<ClippedTriangle> {
    let primitive = &scene.primitives[draw.primitive];
    let cut = |t: u32| {
        let records = corner_records(scene, draw, geometry, draw.first_triangle + t);
        if !is_cut(records.map(|r| r.flags)) {
            return Vec::new();
        }
        let indices = primitive.corners(scene, t);
        let corner = |i: usize| Corner {
            clip: clip(moved::Corner { vertex: indices[i], triangle: t }),
            on: 0,
            record: Some(records[i]),
            leads_along_edge: true,
        };
        let polygon: Vec<(SnappedVertex, bool)> =
            clipped([0, 1, 2].map(corner), view).iter().map(|corner| (corner.snapped(view), corner.leads_along_edge)).collect();
        let piece = |i: usize| {
            let [(a, a_leads), (b, b_leads), (c, c_leads)] = [polygon[0], polygon[i], polygon[i + 1]];
            // Inside the polygon run the diagonals of the fan.
            let outline = [b_leads, i + 2 == polygon.len() && c_leads, i == 1 && a_leads];
            let outline = (0..3).fold(0, |bits, k| bits | u32::from(outline[k]) << k);
            ClippedTriangle { parent: draw.first_triangle + t, corners: [a, b, c], outline }
        };
        (1..polygon.len().saturating_sub(1)).map(piece).collect()
    };
    (0..primitive.triangle_count()).into_par_iter().flat_map_iter(cut).collect()
}

#[derive(Clone, Copy)]
struct Corner<P> {
    clip: P,
    /// Flags of the planes that this corner was cut by and so lies on exactly.
    on: u32,
    /// The vertex itself; none for a corner that clipping made.
    record: Option<SnappedVertex>,
    /// The polygon's edge that begins here lies on an edge of the triangle, not on a plane.
    leads_along_edge: bool,
}

fn clipped<P: Point>(triangle: [Corner<P>; 3], view: &View) -> Vec<Corner<P>> {
    PLANES.into_iter().fold(triangle.to_vec(), |polygon, plane| {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, a) in polygon.iter().enumerate() {
            let b = &polygon[(i + 1) % polygon.len()];
            let (a_inside, b_inside) = (a.is_inside(plane, view), b.is_inside(plane, view));
            if a_inside {
                kept.push(*a);
            }
            match (a_inside, b_inside) {
                (true, false) => kept.push(a.cut(b, plane, view)),
                // Coming back inside, the outline goes on along the same edge.
                (false, true) => kept.push(Corner { leads_along_edge: a.leads_along_edge, ..b.cut(a, plane, view) }),
                _ => {}
            }
        }
        kept
    })
}

impl<P: Point> Corner<P> {
    /// Vertices go by their flags, which every triangle at the vertex shares.
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        match self.record {
            Some(record) => record.flags & plane == 0,
            None => self.on & plane != 0 || self.clip.is_inside(plane, view),
        }
    }

    /// Where the edge from this inside corner to `outside` meets `plane`.
    fn cut(&self, outside: &Self, plane: u32, view: &View) -> Self {
        let on = self.on & outside.on | plane;
        Self { clip: self.clip.cut(&outside.clip, plane, on, view), on, record: None, leads_along_edge: false }
    }

    /// The record of this corner of a clipped polygon, inside the guard band and ready to be drawn.
    fn snapped(&self, view: &View) -> SnappedVertex {
        if let Some(record) = self.record {
            return record;
        }
        let mut v = self.clip.snapped(self.on, view);
        let [left, right, top, bottom] = vertex_flags::GUARD.map(|side| self.on & side != 0);
        let place = |at: i32, low: bool, high: bool| match (low, high) {
            (true, _) => -GUARD_BAND,
            (_, true) => GUARD_BAND,
            _ => at.clamp(-GUARD_BAND, GUARD_BAND),
        };
        (v.x, v.y, v.flags) = (place(v.x, left, right), place(v.y, top, bottom), 0);
        v
    }
}

impl Point for Clip {
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        distance(self, plane, view) >= 0.0
    }

    fn cut(&self, outside: &Self, plane: u32, on: u32, view: &View) -> Self {
        let (from, to) = (distance(self, plane, view), distance(outside, plane, view));
        let t = if from > to { (from / (from - to)).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + t * (b - a);
        let mut clip = Self { x: mix(self.x, outside.x), y: mix(self.y, outside.y), z: mix(self.z, outside.z), w: mix(self.w, outside.w) };
        if on & vertex_flags::NEAR != 0 {
            clip.z = clip.w;
        }
        clip
    }

    fn snapped(&self, _on: u32, view: &View) -> SnappedVertex {
        snap_inside(self, view)
    }
}

/// Signed distance to the inside of `plane`, in units that differ from plane to plane; right for w > 0.
///
/// The sides: X = half + half·x/w stays within ±[`GUARD_BAND`] iff half·x lies between -(guard + half)·w and
/// (guard - half)·w; Y runs downwards.
fn distance(p: &Clip, plane: u32, view: &View) -> f64 {
    let [half_x, half_y] = half_size(view).map(f64::from);
    let guard = f64::from(GUARD_BAND);
    let [left, right, top, _bottom] = vertex_flags::GUARD;
    match plane {
        vertex_flags::NEAR => p.w - p.z,
        side if side == left => (guard + half_x) * p.w + half_x * p.x,
        side if side == right => (guard - half_x) * p.w - half_x * p.x,
        side if side == top => (guard + half_y) * p.w - half_y * p.y,
        _ => (guard - half_y) * p.w + half_y * p.y,
    }
}
