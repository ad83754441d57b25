//! Clipping in homogeneous space in f64 (Sutherland and Hodgman 1974): near plane, then the four sides of the guard band.
//!
//! Every cut edge is interpolated from its inside to its outside end, so neighbours that share it find the same point,
//! and the coordinate that a plane fixes is set, not computed.

use rayon::prelude::*;

use super::{
    coverage::corner_records,
    moved::{self, Mover},
    project::{Clip, half_size, snap_inside},
};
use crate::{
    frame::{Geometry, Piece, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{Scene, camera::View},
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

/// Pieces of all cut triangles of a draw, in triangle order, each triangle as a fan from its first remaining corner.
pub(super) fn pieces(scene: &Scene, mover: &Mover, view: &View, geometry: &Geometry) -> Vec<Piece> {
    let draw = mover.draw;
    let primitive = &scene.primitives[draw.primitive];
    let cut = |t: u32| {
        let records = corner_records(scene, draw, geometry, draw.first_triangle + t);
        if !is_cut(records.map(|r| r.flags)) {
            return Vec::new();
        }
        let indices = primitive.corners(scene, t);
        let corner = |i: usize| {
            let clip = mover.clip(moved::Corner { vertex: indices[i], triangle: t }).expect("a cut triangle has no rejected corner");
            Corner { clip, on: 0, record: Some(records[i]), leads_along_edge: true }
        };
        let polygon: Vec<(SnappedVertex, bool)> =
            clipped([0, 1, 2].map(corner), view).iter().map(|corner| (corner.snapped(view), corner.leads_along_edge)).collect();
        let piece = |i: usize| {
            let [(a, a_leads), (b, b_leads), (c, c_leads)] = [polygon[0], polygon[i], polygon[i + 1]];
            // Inside the polygon run the diagonals of the fan.
            let outline = [b_leads, i + 2 == polygon.len() && c_leads, i == 1 && a_leads];
            let outline = (0..3).fold(0, |bits, k| bits | u32::from(outline[k]) << k);
            Piece { parent: draw.first_triangle + t, corners: [a, b, c], outline }
        };
        (1..polygon.len().saturating_sub(1)).map(piece).collect()
    };
    (0..primitive.triangle_count()).into_par_iter().flat_map_iter(cut).collect()
}

#[derive(Clone, Copy)]
struct Corner {
    clip: Clip,
    /// Flags of the planes that this corner was cut by and so lies on exactly.
    on: u32,
    /// The vertex itself; none for a corner that clipping made.
    record: Option<SnappedVertex>,
    /// The polygon's edge that begins here lies on an edge of the triangle, not on a plane.
    leads_along_edge: bool,
}

fn clipped(triangle: [Corner; 3], view: &View) -> Vec<Corner> {
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

impl Corner {
    /// Vertices go by their flags, which every triangle at the vertex shares.
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        match self.record {
            Some(record) => record.flags & plane == 0,
            None => self.on & plane != 0 || distance(&self.clip, plane, view) >= 0.0,
        }
    }

    /// Where the edge from this inside corner to `outside` meets `plane`.
    fn cut(&self, outside: &Self, plane: u32, view: &View) -> Self {
        let (from, to) = (distance(&self.clip, plane, view), distance(&outside.clip, plane, view));
        let t = if from > to { (from / (from - to)).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + t * (b - a);
        let (a, b) = (&self.clip, &outside.clip);
        let mut clip = Clip { x: mix(a.x, b.x), y: mix(a.y, b.y), z: mix(a.z, b.z), w: mix(a.w, b.w) };
        let on = self.on & outside.on | plane;
        if on & vertex_flags::NEAR != 0 {
            clip.z = clip.w;
        }
        Self { clip, on, record: None, leads_along_edge: false }
    }

    /// The record of this corner of a clipped polygon, inside the guard band and ready to be drawn.
    fn snapped(&self, view: &View) -> SnappedVertex {
        if let Some(record) = self.record {
            return record;
        }
        let mut v = snap_inside(&self.clip, view);
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
