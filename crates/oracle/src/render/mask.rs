//! Alpha masks: which samples the alpha of a material's texture leaves out (`docs/exactness.md`
//! §7), tested in integers from texture coordinates of the corners in 1/256 of a texel. Of a
//! clipped triangle a float renderer computes these coordinates, within the
//! bound of [`super::super::bounds::mask`].

use glam::{DVec2, DVec3};

use super::{
    snap::ClipPosition,
    triangles::OrientedTriangle,
    vertex::{Corner, VertexEvaluator},
};
use crate::{
    effects::{Stack, hooks::Shape},
    frame::SnappedVertex,
    scene::{
        Primitive, Scene,
        texture::{Filter, Texture, Wrap, texcoord},
        view::View,
    },
};

/// Records per triangle and clipped triangle: x and y of three corners, and the number of the
/// material plus 1; 0 there without a mask.
pub const RECORDS: usize = 2;

/// Returns true if masks may leave samples of this scene out. Boxes and points have no mask.
pub fn is_masked(scene: &Scene, stack: &Stack) -> bool {
    stack.shape() == Shape::Triangles && scene.is_masked()
}

/// A primitive's texture whose alpha decides, and the smallest alpha that is drawn.
fn masked<'a>(scene: &'a Scene, primitive: &Primitive) -> Option<(&'a Texture, u32)> {
    let material = &scene.materials[primitive.material];
    material
        .base_texture
        .as_ref()
        .zip(material.alpha_threshold())
}

/// Texture coordinates of the corners of a triangle or clipped triangle in the mask's image, 1/256
/// texel.
pub struct MaskCoords {
    pub corners: [DVec2; 3],
    /// For a clipped triangle, how its coordinates follow from its parent.
    pub clipped: Option<ClippedCoords>,
}

/// The parent of a clipped triangle, whose coordinates are interpolated in homogeneous space.
pub struct ClippedCoords {
    /// Coordinates of the parent's corners.
    pub parent: [DVec2; 3],
    /// x, y and w of the parent's corners in clip space.
    pub homogeneous: [DVec3; 3],
    /// The clipped triangle's corners in normalized device coordinates, with z = 1.
    pub points: [DVec3; 3],
}

impl MaskCoords {
    /// Coordinates of a whole triangle, or of a clipped one with these records; none without a
    /// mask.
    pub fn of(
        evaluator: &VertexEvaluator,
        view: &View,
        corners: [Corner; 3],
        clipped: Option<&[SnappedVertex; 3]>,
    ) -> Option<Self> {
        let scene = evaluator.scene;
        let primitive = &scene.primitives[evaluator.draw.primitive];
        let (texture, _) = masked(scene, primitive)?;
        let texcoords = primitive.texcoords[0].as_ref()?;
        let size = scene.images[texture.image].size();
        let units = |corner: Corner| {
            texture.units(
                size,
                texcoord(texcoords, &scene.vertex_bytes, corner.vertex),
            )
        };
        let parent = corners.map(|corner| DVec2::from(units(corner).map(f64::from)));
        let Some(records) = clipped else {
            return Some(Self {
                corners: parent,
                clipped: None,
            });
        };
        let homogeneous = corners.map(|corner| {
            let ClipPosition { x, y, w, .. } = evaluator
                .clip(corner)
                .expect("a triangle that is clipped has no rejected corner");
            DVec3::new(x, y, w)
        });
        let clipped = ClippedCoords {
            parent,
            homogeneous,
            points: records.map(|record| ndc(&record, view)),
        };
        Some(Self {
            corners: clipped.points.map(|point| clipped.at(point)),
            clipped: Some(clipped),
        })
    }

    /// The coordinates rounded to whole units, and the material of `primitive`.
    pub fn records(&self, primitive: usize) -> [[u32; 4]; RECORDS] {
        let word = |v: f64| v.round_ties_even() as i32 as u32;
        let [a, b, c] = self.corners.map(|at| [word(at.x), word(at.y)]);
        [
            [a[0], a[1], b[0], b[1]],
            [c[0], c[1], primitive as u32 + 1, 0],
        ]
    }
}

impl ClippedCoords {
    /// Weights of the parent's corners at a point, and their sum.
    pub fn weights(&self, point: DVec3) -> ([f64; 3], f64) {
        let v = &self.homogeneous;
        let weights =
            [(1, 2), (2, 0), (0, 1)].map(|(i, j): (usize, usize)| point.dot(v[i].cross(v[j])));
        (weights, weights.iter().sum())
    }

    fn at(&self, point: DVec3) -> DVec2 {
        let (weights, sum) = self.weights(point);
        (0..3).map(|k| self.parent[k] * (weights[k] / sum)).sum()
    }
}

/// A snapped position in normalized device coordinates, with z = 1.
fn ndc(record: &SnappedVertex, view: &View) -> DVec3 {
    let unit = f64::from(view.units_per_pixel());
    let ndc = |at: i32, pixels: u32| f64::from(at) / unit / f64::from(pixels) * 2.0 - 1.0;
    DVec3::new(ndc(record.x, view.width), -ndc(record.y, view.height), 1.0)
}

/// Returns true if the mask leaves a covered sample, given the doubled areas `parts` opposite the
/// corners in the order of the file and the entry's [`MaskCoords::records`].
pub fn is_drawn(
    scene: &Scene,
    primitive: &Primitive,
    triangle: &OrientedTriangle,
    parts: [u32; 3],
    records: &[[u32; 4]],
) -> bool {
    let Some((texture, threshold)) = masked(scene, primitive) else {
        return true;
    };
    let [first, last] = records else { return true };
    let weights = weights(
        parts,
        triangle.in_file_order(triangle.corners.map(|corner| corner.inv_w)),
    );
    let at = [[first[0], first[2], last[0]], [first[1], first[3], last[1]]]
        .map(|words| mean(weights, words.map(|word| word as i32)));
    let level = &scene.images[texture.image].levels[0];
    let side = |at: i64, axis: usize| {
        let side = i64::from(level.size[axis]);
        match texture.wrap[axis] {
            Wrap::Repeat => at.rem_euclid(side),
            Wrap::Clamp => at.clamp(0, side - 1),
            Wrap::Mirrored => (at.rem_euclid(2 * side)).min(2 * side - 1 - at.rem_euclid(2 * side)),
        }
    };
    let alpha = |x: i64, y: i64| {
        u64::from(level.texels[(side(y, 1) * i64::from(level.size[0]) + side(x, 0)) as usize][3])
    };
    let alpha_at = match texture.mag_filter {
        Filter::Nearest => alpha(at[0].div_euclid(256), at[1].div_euclid(256)) << 16,
        Filter::Linear => {
            // A texel's value lies at its center.
            let [(x, right), (y, down)] = at.map(|at| {
                (
                    (at - 128).div_euclid(256),
                    (at - 128).rem_euclid(256) as u64,
                )
            });
            let row = |y: i64| alpha(x, y) * (256 - right) + alpha(x + 1, y) * right;
            row(y) * (256 - down) + row(y + 1) * down
        }
    };
    alpha_at >= u64::from(threshold)
}

/// Perspective-correct weights of the corners: areas, scaled to 31 bits in all, times 1/w in fixed
/// point under the exponent of the nearest corner; the upper 32 bits of each product.
fn weights(parts: [u32; 3], inv_w: [f32; 3]) -> [u64; 3] {
    let parts = parts.map(u64::from);
    let sum = parts.iter().sum::<u64>().max(1);
    let scale = 1u64 << (31 - sum.ilog2() - 1);
    let exponent = |v: f32| v.to_bits() >> 23;
    let nearest = inv_w.iter().copied().map(exponent).max().unwrap_or(0);
    [0, 1, 2].map(|k| {
        let significand = u64::from(inv_w[k].to_bits() & 0x7f_ffff | 0x80_0000) << 8;
        let fixed = significand
            .checked_shr(nearest - exponent(inv_w[k]))
            .filter(|_| nearest - exponent(inv_w[k]) < 32)
            .unwrap_or(0);
        (parts[k] * scale * fixed) >> 32
    })
}

/// The weighted mean, rounded down.
fn mean(weights: [u64; 3], values: [i32; 3]) -> i64 {
    let sum = weights.iter().sum::<u64>().max(1);
    let least = i64::from(values.into_iter().min().unwrap_or(0));
    let above: u128 = (0..3)
        .map(|k| u128::from(weights[k]) * (i64::from(values[k]) - least) as u128)
        .sum();
    least + (above / u128::from(sum)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_the_perspective_one_to_a_unit() {
        // Half way on the screen between w = 1 and w = 3 lies a quarter of the way in space.
        let halves = weights([500, 500, 0], [1.0, 1.0 / 3.0, 0.7]);
        assert_eq!(
            mean(halves, [0, 1 << 20, 77]),
            (1 << 18) - 1 + i64::from(mean(halves, [0, 1 << 20, 77]) == 1 << 18)
        );
        assert_eq!(mean(weights([1, 0, 0], [1.0; 3]), [-5, 9, 9]), -5);
        assert_eq!(mean(weights([1, 1, 2], [0.5; 3]), [-4, 4, 8]), 4);
        assert_eq!(
            mean(weights([0, 0, 0], [0.5; 3]), [-4, 4, 8]),
            -4,
            "no weight at all"
        );
    }
}
