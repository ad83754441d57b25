//! Clipping in homogeneous space (Sutherland and Hodgman 1974): the near plane, then the four sides
//! of the guard band (`docs/exactness.md` §2).
//!
//! Every cut edge is interpolated from its inside to its outside end, so triangles that share the
//! edge find the same point, and the coordinate that a plane fixes is set, not computed.

use rayon::prelude::*;

use super::{
    super::{arithmetic::edge::doubled_area, shot::Shot},
    snap::{ClipPosition, half_size, snap_inside},
    vertex,
};
use crate::{
    effects::hooks::Shape,
    frame::{ClippedTriangle, Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{draw::Draw, view::View},
};

/// The planes in the order of clipping, each by its vertex flag.
const PLANES: [u32; 5] = [
    vertex_flags::NEAR,
    vertex_flags::GUARD[0],
    vertex_flags::GUARD[1],
    vertex_flags::GUARD[2],
    vertex_flags::GUARD[3],
];

/// Returns true if a triangle with these corner flags must be clipped: no corner is rejected, one
/// is beyond a plane, and they are not all beyond the same one.
pub fn is_cut(flags: [u32; 3]) -> bool {
    let any = flags[0] | flags[1] | flags[2];
    let all = flags[0] & flags[1] & flags[2];
    any & vertex_flags::REJECTED == 0
        && any & vertex_flags::CLIPPED != 0
        && all & vertex_flags::CLIPPED == 0
}

/// A point in clip space, in f64 or in f32 with a fixed order of operations.
pub trait Point: Copy + Send + Sync {
    /// Returns true on `plane` and on its inner side.
    fn is_inside(&self, plane: u32, view: &View) -> bool;

    /// Where the edge from this inside point to `outside` meets `plane`; `on` has the flags of all
    /// planes at that point.
    fn cut(&self, outside: &Self, plane: u32, on: u32, view: &View) -> Self;

    /// The record of an intersection with the planes `on`, except for the coordinates that these
    /// planes fix.
    fn snapped(&self, on: u32, view: &View) -> SnappedVertex;
}

/// Triangles that clipping makes of a draw, by rising parent; each polygon is a fan from its first
/// corner. `position` evaluates corners.
pub fn clipped_triangles<P: Point>(
    shot: &Shot,
    draw: &Draw,
    geometry: &Geometry,
    position: impl Fn(vertex::Corner) -> P + Sync,
) -> Vec<ClippedTriangle> {
    let primitive = &shot.scene.primitives[draw.primitive];
    let fan = |triangle: u32| {
        let parent = draw.first_triangle + triangle;
        let records = shot.corner_records(draw, geometry, parent);
        if !is_cut(records.map(|r| r.flags)) {
            return Vec::new();
        }
        let vertices = primitive.corners(shot.scene, triangle);
        let corner = |i: usize| Corner {
            point: position(vertex::Corner {
                vertex: vertices[i],
                triangle,
            }),
            on: 0,
            record: Some(records[i]),
            leads_along_edge: true,
        };
        let fan = fan(
            parent,
            &polygon([0, 1, 2].map(corner), shot.view),
            shot.view,
        );
        match shot.stack.shape() {
            Shape::Boxes => bounding_box(&fan).into_iter().collect(),
            Shape::Triangles | Shape::Points => fan,
        }
    };
    (0..primitive.triangle_count())
        .into_par_iter()
        // Of small meshes there may be millions.
        .with_min_len(256)
        .flat_map_iter(fan)
        .collect()
}

/// A triangle with the bounding box of a fan, at the depth of its nearest corner, so that a box
/// draws every sample once; none if the fan has no area.
fn bounding_box(fan: &[ClippedTriangle]) -> Option<ClippedTriangle> {
    let area: i64 = fan.iter().map(|t| doubled_area(&t.corners)).sum();
    let corners = || fan.iter().flat_map(|t| t.corners);
    let (low_x, high_x) = (corners().map(|c| c.x).min()?, corners().map(|c| c.x).max()?);
    let (low_y, high_y) = (corners().map(|c| c.y).min()?, corners().map(|c| c.y).max()?);
    let at = |x: i32, y: i32| SnappedVertex {
        x,
        y,
        depth: corners().map(|c| c.depth).fold(0.0, f32::max),
        inv_w: corners().map(|c| c.inv_w).fold(0.0, f32::max),
        flags: 0,
    };
    let mut corners = [at(low_x, low_y), at(high_x, low_y), at(low_x, high_y)];
    if area < 0 {
        corners.swap(1, 2);
    }
    (area != 0).then_some(ClippedTriangle {
        parent: fan[0].parent,
        corners,
        outline: 0,
    })
}

/// The triangles of a convex polygon.
fn fan<P: Point>(parent: u32, polygon: &[Corner<P>], view: &View) -> Vec<ClippedTriangle> {
    let corners: Vec<(SnappedVertex, bool)> = polygon
        .iter()
        .map(|corner| (corner.snapped(view), corner.leads_along_edge))
        .collect();
    let triangle = |i: usize| {
        let [(a, a_leads), (b, b_leads), (c, c_leads)] = [corners[0], corners[i], corners[i + 1]];
        // The other edges are diagonals of the fan.
        let outline = [
            b_leads,
            i + 2 == corners.len() && c_leads,
            i == 1 && a_leads,
        ];
        let outline = (0..3).fold(0, |bits, k| bits | u32::from(outline[k]) << k);
        ClippedTriangle {
            parent,
            corners: [a, b, c],
            outline,
        }
    };
    (1..corners.len().saturating_sub(1)).map(triangle).collect()
}

#[derive(Clone, Copy)]
struct Corner<P> {
    point: P,
    /// Flags of the planes that made this corner and on which it lies exactly.
    on: u32,
    /// The vertex itself; none for a corner that clipping made.
    record: Option<SnappedVertex>,
    /// The polygon's edge that begins here lies on an edge of the triangle, not on a plane.
    leads_along_edge: bool,
}

/// The part of a triangle inside all planes.
fn polygon<P: Point>(triangle: [Corner<P>; 3], view: &View) -> Vec<Corner<P>> {
    PLANES
        .into_iter()
        .fold(triangle.to_vec(), |polygon, plane| {
            let mut inside = Vec::with_capacity(polygon.len() + 1);
            for (i, a) in polygon.iter().enumerate() {
                let b = &polygon[(i + 1) % polygon.len()];
                let (a_is_inside, b_is_inside) =
                    (a.is_inside(plane, view), b.is_inside(plane, view));
                if a_is_inside {
                    inside.push(*a);
                }
                match (a_is_inside, b_is_inside) {
                    (true, false) => inside.push(a.cut(b, plane, view)),
                    // Back inside, the outline continues along the same edge.
                    (false, true) => inside.push(Corner {
                        leads_along_edge: a.leads_along_edge,
                        ..b.cut(a, plane, view)
                    }),
                    _ => {}
                }
            }
            inside
        })
}

impl<P: Point> Corner<P> {
    /// A vertex is classified by its flags, which all triangles at the vertex share.
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        match self.record {
            Some(record) => record.flags & plane == 0,
            None => self.on & plane != 0 || self.point.is_inside(plane, view),
        }
    }

    /// Where the edge from this inside corner to `outside` meets `plane`.
    fn cut(&self, outside: &Self, plane: u32, view: &View) -> Self {
        let on = self.on & outside.on | plane;
        Self {
            point: self.point.cut(&outside.point, plane, on, view),
            on,
            record: None,
            leads_along_edge: false,
        }
    }

    /// The record of this corner of a clipped polygon, inside the guard band and ready to be drawn.
    fn snapped(&self, view: &View) -> SnappedVertex {
        if let Some(record) = self.record {
            return record;
        }
        let mut v = self.point.snapped(self.on, view);
        let [left, right, top, bottom] = vertex_flags::GUARD.map(|side| self.on & side != 0);
        let coordinate = |at: i32, low: bool, high: bool| match (low, high) {
            (true, _) => -GUARD_BAND,
            (_, true) => GUARD_BAND,
            _ => at.clamp(-GUARD_BAND, GUARD_BAND),
        };
        (v.x, v.y, v.flags) = (
            coordinate(v.x, left, right),
            coordinate(v.y, top, bottom),
            0,
        );
        v
    }
}

impl Point for ClipPosition {
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        distance(self, plane, view) >= 0.0
    }

    fn cut(&self, outside: &Self, plane: u32, on: u32, view: &View) -> Self {
        let (from, to) = (distance(self, plane, view), distance(outside, plane, view));
        let t = if from > to {
            (from / (from - to)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mix = |a: f64, b: f64| a + t * (b - a);
        let mut point = Self {
            x: mix(self.x, outside.x),
            y: mix(self.y, outside.y),
            z: mix(self.z, outside.z),
            w: mix(self.w, outside.w),
        };
        if on & vertex_flags::NEAR != 0 {
            point.z = point.w;
        }
        point
    }

    fn snapped(&self, _on: u32, view: &View) -> SnappedVertex {
        snap_inside(self, view)
    }
}

/// Signed distance to the inside of `plane`, in units that differ from plane to plane; correct for
/// w > 0.
///
/// The sides: X = half + half·x/w stays within ±[`GUARD_BAND`] iff half·x lies between -(guard +
/// half)·w and (guard - half)·w; Y runs downwards.
fn distance(p: &ClipPosition, plane: u32, view: &View) -> f64 {
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
