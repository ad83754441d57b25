//! The strict vertex stage: f32 with one order of operations, which an adapter computes in u32 and
//! must match to the bit (`docs/exactness.md` §10).
//!
//! Positions are relative to the draw's origin, x - o. Then x_c = ((m0·x + m1·y) + m2·z) + m3, and
//! y_c, z_c, w_c alike; X = 128 W + round((x_c · 1/w) · 128 W), Y likewise and downwards; depth =
//! z_c · 1/w. A vertex is inside the near plane iff z_c <= w_c and w_c > 0. Clipping is that of
//! [`super::clip`] with the distances w - z and (guard ± 128 W)·w ± 128 W·x, t = d_in / (d_in -
//! d_out) clamped to [0, 1], and in + (out - in)·t.

use rayon::prelude::*;

use super::{
    super::{
        arithmetic::ftz::{difference, operand, product, quotient, round, sum},
        shot::Shot,
    },
    clip::{self, Point},
    deform,
    snap::{half_size, with_guard_flags},
    vertex::Corner,
};
use crate::{
    frame::{BitExact, Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{ComponentType, Scene, draw::Draw, view::View},
};

/// The smallest near distance that is allowed: no visible w is smaller.
const LEAST_W: f32 = 1.0 / (1 << 20) as f32;

/// Records and clipped triangles of a scene that no effect moves and nothing deforms.
pub fn project_strict(shot: &Shot) -> Geometry {
    let Shot {
        scene, draws, view, ..
    } = *shot;
    let record = |draw: &Draw, vertex| match position(scene, draw, vertex) {
        Ok(point) if point.z <= point.w && point.w > 0.0 => point.record(view),
        Ok(_) => SnappedVertex {
            flags: vertex_flags::NEAR,
            ..Default::default()
        },
        Err(flags) => SnappedVertex {
            flags,
            ..Default::default()
        },
    };
    let records = |draw: &Draw| {
        let vertices = 0..scene.primitives[draw.primitive].vertex_count();
        vertices
            .into_par_iter()
            .map(|vertex| record(draw, vertex))
            .collect::<Vec<_>>()
    };
    let exact = BitExact {
        vertices: true,
        depth_keys: false,
    };
    let vertices = draws.par_iter().flat_map(records).collect();
    let mut geometry = Geometry {
        vertices,
        bit_exact: exact,
        subpixel_bits: view.precision.subpixel_bits,
        ..Geometry::default()
    };
    let clipped = |draw: &Draw| {
        let position = |corner: Corner| {
            position(scene, draw, corner.vertex)
                .expect("a triangle that is clipped has no rejected corner")
        };
        clip::clipped_triangles(shot, draw, &geometry, position)
    };
    geometry.clipped_triangles = draws.par_iter().flat_map(clipped).collect();
    geometry
}

/// Homogeneous clip-space position.
#[derive(Clone, Copy)]
struct StrictPosition {
    x: f32,
    y: f32,
    z: f32,
    w: f32,
}

/// Clip-space position of a vertex of `draw`, or the flags of all components that were refused.
fn position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<StrictPosition, u32> {
    let primitive = &scene.primitives[draw.primitive];
    // Refuses what every renderer refuses.
    deform::position(scene, draw, vertex)?;
    let component = |axis: u32| match primitive.positions.component_type {
        ComponentType::F32 => operand(f32::from_bits(primitive.positions.f32_bits(
            &scene.vertex_bytes,
            vertex,
            axis,
        ))),
        _ => primitive.positions.value(&scene.vertex_bytes, vertex, axis) as f32,
    };
    // An origin of 0 changes nothing.
    let [x, y, z] = [0, 1, 2].map(|axis| difference(component(axis), draw.origin[axis as usize]));
    let row = |r: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|column| draw.clip_from_object[column][r]);
        sum(sum(sum(product(a, x), product(b, y)), product(c, z)), d)
    };
    Ok(StrictPosition {
        x: row(0),
        y: row(1),
        z: row(2),
        w: row(3),
    })
}

impl StrictPosition {
    fn record(&self, view: &View) -> SnappedVertex {
        let [half_x, half_y] = half_size(view);
        let inv_w = quotient(1.0, self.w);
        let offset = |c: f32, half: i32| round(product(product(c, inv_w), half as f32));
        with_guard_flags(
            half_x + offset(self.x, half_x),
            half_y - offset(self.y, half_y),
            product(self.z, inv_w),
            inv_w,
        )
    }

    /// Signed distance to the inside of a plane.
    fn distance(&self, plane: u32, view: &View) -> f32 {
        let [half_x, half_y] = half_size(view);
        let [left, right, top, _bottom] = vertex_flags::GUARD;
        // Integers below 2^24 are exact in f32.
        let side = |reach: i32, along: f32| sum(product(reach as f32, self.w), along);
        let (x, y) = (
            product(self.x, half_x as f32),
            product(self.y, half_y as f32),
        );
        match plane {
            vertex_flags::NEAR => difference(self.w, self.z),
            plane if plane == left => side(GUARD_BAND + half_x, x),
            plane if plane == right => side(GUARD_BAND - half_x, -x),
            plane if plane == top => side(GUARD_BAND + half_y, -y),
            _ => side(GUARD_BAND - half_y, y),
        }
    }
}

impl Point for StrictPosition {
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        self.distance(plane, view) >= 0.0
    }

    fn cut(&self, outside: &Self, plane: u32, _on: u32, view: &View) -> Self {
        let from = self.distance(plane, view);
        let span = difference(from, outside.distance(plane, view));
        let t = if span > 0.0 {
            quotient(from, span).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mix = |a: f32, b: f32| sum(a, product(difference(b, a), t));
        let mut point = Self {
            x: mix(self.x, outside.x),
            y: mix(self.y, outside.y),
            z: mix(self.z, outside.z),
            w: mix(self.w, outside.w),
        };
        // On the near plane w equals z; the one that changes less along the edge is more exact.
        if plane == vertex_flags::NEAR
            && difference(outside.z, self.z).abs() < difference(outside.w, self.w).abs()
        {
            point.w = point.z;
        }
        point
    }

    fn snapped(&self, on: u32, view: &View) -> SnappedVertex {
        let record = Self {
            w: self.w.max(LEAST_W),
            ..*self
        }
        .record(view);
        let depth = if on & vertex_flags::NEAR != 0 {
            1.0
        } else {
            record.depth.clamp(0.0, 1.0)
        };
        SnappedVertex { depth, ..record }
    }
}
