//! The strict options: a vertex stage in f32 with one order of operations, and depth keys as quotients of integers. What an
//! adapter computes in u32 must be this, to the bit.
//!
//! Places are taken from the draw's origin, x - o; then x_c = ((m0·x + m1·y) + m2·z) + m3, the others alike; X = 128 W + round((x_c · 1/w) · 128 W), Y likewise and downwards; depth
//! = z_c · 1/w. A vertex is inside the near plane iff z_c <= w_c and w_c > 0. Clipping is that of [`super::clip`]:
//! distances w - z and (guard ± 128 W)·w ± 128 W·x, t = d_in / (d_in - d_out) held to [0, 1], in + (out - in)·t.

use rayon::prelude::*;

use super::{
    clip::{self, Point},
    coverage::{cover_with, triangles},
    decide::decide,
    deform::place,
    flushed::{difference, operand, product, quotient, round, sum},
    project::{half_size, placed},
    rules::SampleTests,
};
use crate::{
    effects::Stack,
    frame::{Exactness, Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{
        ComponentType, Scene,
        draw::{Draw, DrawError, draws},
        view::View,
    },
};

/// The nearest that a near plane may be: no visible w is smaller.
const LEAST_W: f32 = 1.0 / (1 << 20) as f32;

/// Triangle id and depth key of every pixel, as every adapter must find them; `stack` must move no vertices.
///
/// # Errors
/// When a placement or the number of triangles exceeds what the arithmetic holds.
pub fn strict_frame(scene: &Scene, view: &View, stack: &Stack) -> Result<(Vec<u32>, Vec<u32>), DrawError> {
    let draws = draws(scene, view)?;
    let mut geometry = project_strict(scene, &draws, view);
    geometry.exact.keys = true;
    geometry.sample_setups = decide(scene, &draws, view, stack, &geometry);
    let (triangles, _) = triangles(scene, &draws, &geometry);
    let rules = SampleTests::of(stack, &geometry).masked(scene, &draws, stack).ordered(stack, &triangles, view);
    let coverage = cover_with(&rules, &triangles, view, None);
    Ok((coverage.triangle_ids(), coverage.keys()))
}

/// The records and pieces of a scene in which nothing moves or bends.
pub fn project_strict(scene: &Scene, draws: &[Draw], view: &View) -> Geometry {
    let record = |draw: &Draw, vertex| match position(scene, draw, vertex) {
        Ok(clip) if clip.z <= clip.w && clip.w > 0.0 => clip.record(view),
        Ok(_) => SnappedVertex { flags: vertex_flags::NEAR, ..Default::default() },
        Err(flags) => SnappedVertex { flags, ..Default::default() },
    };
    let records = |draw: &Draw| {
        let vertices = 0..scene.primitives[draw.primitive].vertex_count();
        vertices.into_par_iter().map(|vertex| record(draw, vertex)).collect::<Vec<_>>()
    };
    let exact = Exactness { vertices: true, keys: false };
    let vertices = draws.iter().flat_map(records).collect();
    let mut geometry = Geometry { vertices, exact, subpixel_bits: view.precision.subpixel_bits, ..Geometry::default() };
    let pieces = |draw: &Draw| {
        let clip = |corner: super::moved::Corner| position(scene, draw, corner.vertex).expect("a cut triangle has no rejected corner");
        clip::pieces(scene, draw, view, &geometry, clip)
    };
    geometry.pieces = draws.iter().flat_map(pieces).collect();
    geometry
}

/// Homogeneous clip-space position.
#[derive(Clone, Copy)]
struct Clip {
    x: f32,
    y: f32,
    z: f32,
    w: f32,
}

/// Clip-space position of a vertex of `draw`, or the flags of all lanes that were refused.
fn position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<Clip, u32> {
    let primitive = &scene.primitives[draw.primitive];
    place(scene, draw, vertex)?;
    let lane = |lane: u32| match primitive.positions.component_type {
        ComponentType::F32 => operand(f32::from_bits(primitive.positions.f32_bits(&scene.vertex_bytes, vertex, lane))),
        _ => primitive.positions.value(&scene.vertex_bytes, vertex, lane) as f32,
    };
    // From the origin on; from 0, nothing changes.
    let [x, y, z] = [0, 1, 2].map(|axis| difference(lane(axis), draw.origin[axis as usize]));
    let row = |r: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|column| draw.clip_from_object[column][r]);
        sum(sum(sum(product(a, x), product(b, y)), product(c, z)), d)
    };
    Ok(Clip { x: row(0), y: row(1), z: row(2), w: row(3) })
}

impl Clip {
    fn record(&self, view: &View) -> SnappedVertex {
        let [half_x, half_y] = half_size(view);
        let inv_w = quotient(1.0, self.w);
        let offset = |c: f32, half: i32| round(product(product(c, inv_w), half as f32));
        placed(half_x + offset(self.x, half_x), half_y - offset(self.y, half_y), product(self.z, inv_w), inv_w)
    }

    /// Signed distance to the inside of a plane.
    fn distance(&self, plane: u32, view: &View) -> f32 {
        let [half_x, half_y] = half_size(view);
        let [left, right, top, _bottom] = vertex_flags::GUARD;
        // Integers below 2^24 are floats.
        let side = |reach: i32, along: f32| sum(product(reach as f32, self.w), along);
        let (x, y) = (product(self.x, half_x as f32), product(self.y, half_y as f32));
        match plane {
            vertex_flags::NEAR => difference(self.w, self.z),
            plane if plane == left => side(GUARD_BAND + half_x, x),
            plane if plane == right => side(GUARD_BAND - half_x, -x),
            plane if plane == top => side(GUARD_BAND + half_y, -y),
            _ => side(GUARD_BAND - half_y, y),
        }
    }
}

impl Point for Clip {
    fn is_inside(&self, plane: u32, view: &View) -> bool {
        self.distance(plane, view) >= 0.0
    }

    fn cut(&self, outside: &Self, plane: u32, _on: u32, view: &View) -> Self {
        let from = self.distance(plane, view);
        let apart = difference(from, outside.distance(plane, view));
        let t = if apart > 0.0 { quotient(from, apart).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f32, b: f32| sum(a, product(difference(b, a), t));
        let mut clip = Self { x: mix(self.x, outside.x), y: mix(self.y, outside.y), z: mix(self.z, outside.z), w: mix(self.w, outside.w) };
        // On the near plane w is z, and whichever changes less along the edge is the more exact.
        if plane == vertex_flags::NEAR && difference(outside.z, self.z).abs() < difference(outside.w, self.w).abs() {
            clip.w = clip.z;
        }
        clip
    }

    fn snapped(&self, on: u32, view: &View) -> SnappedVertex {
        let record = Self { w: self.w.max(LEAST_W), ..*self }.record(view);
        let depth = if on & vertex_flags::NEAR != 0 { 1.0 } else { record.depth.clamp(0.0, 1.0) };
        SnappedVertex { depth, ..record }
    }
}

/// Depth key at a sample of a triangle, from its corners' depths and the doubled areas opposite them: canonical, whatever
/// the order of the corners and the size of the triangle.
pub(super) fn integer_key(depths: [f32; 3], weights: [i64; 3]) -> u32 {
    // What is below every normal float, or below 0, is 0.
    let exponents = depths.map(|depth| if depth >= f32::MIN_POSITIVE { depth.to_bits() >> 23 } else { 0 });
    let largest = exponents[0].max(exponents[1]).max(exponents[2]);
    // Fixed point: the leading bit of the nearest corner's is bit 31.
    let places = [0, 1, 2].map(|i| match (exponents[i], largest - exponents[i]) {
        (0, _) | (_, 32..) => 0,
        (_, shift) => u128::from(depths[i].to_bits() & 0x7f_ffff | 0x80_0000) << 8 >> shift,
    });
    let bits = 64 - weights.iter().sum::<i64>().leading_zeros();
    let weights = weights.map(|weight| weight as u128 >> bits.saturating_sub(31));
    let quotient = (0..3).map(|i| weights[i] * places[i]).sum::<u128>() / weights.iter().sum::<u128>();
    let quotient = u32::try_from(quotient).expect("a mean of 32 bits");
    match largest.checked_sub(quotient.leading_zeros()) {
        Some(exponent @ 1..) if quotient > 0 => exponent << 23 | quotient << quotient.leading_zeros() >> 8 & 0x7f_ffff,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_the_bits_of_depths_that_all_corners_share() {
        for depth in [1.0f32, 0.3, 1e-20, f32::MIN_POSITIVE] {
            assert_eq!(integer_key([depth; 3], [7, 0, 5]), depth.to_bits(), "{depth}");
            assert_eq!(integer_key([depth; 3], [1 << 47, 3, (1 << 47) - 9]), depth.to_bits(), "{depth}");
        }
        assert_eq!(integer_key([0.5, 0.25, 0.0], [0, 0, 3]), 1);
        assert_eq!(integer_key([f32::MIN_POSITIVE / 2.0; 3], [1, 1, 1]), 1);
    }

    #[test]
    fn keys_lie_between_the_corners_and_follow_the_true_depth() {
        let mut word = 1u32;
        let mut dice = || {
            word = crate::math::hash(word);
            word
        };
        for _ in 0..20_000 {
            let depths = [0, 1, 2].map(|_| f32::from_bits(0x3a00_0000 + dice() % 0x0200_0000));
            let shift = dice() % 46;
            let weights = [0, 1, 2].map(|_| (i64::from(dice()) << 16 | i64::from(dice() & 0xffff)) >> shift);
            if weights.iter().sum::<i64>() == 0 {
                continue;
            }
            let key = integer_key(depths, weights);
            let low = depths.iter().copied().fold(1.0, f32::min);
            let high = depths.iter().copied().fold(0.0, f32::max);
            assert!((low.to_bits()..=high.to_bits()).contains(&key), "{depths:?} {weights:?}");
            let reference: f64 = (0..3).map(|i| f64::from(depths[i]) * weights[i] as f64).sum::<f64>() / weights.iter().sum::<i64>() as f64;
            assert!((f64::from(f32::from_bits(key)) / reference - 1.0).abs() < 12.0 * f64::from(f32::EPSILON), "{depths:?} {weights:?}");
        }
    }
}
