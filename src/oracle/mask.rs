//! Masks: which samples the alpha of a material's image leaves out. Decided in integers, from the corners' places in the image
//! in 1/256 of a texel; of what clipping left, a float renderer places the corners, and is held to a bound.

use glam::{DVec2, DVec3};

use super::{
    coverage::OrientedTriangle,
    moved::{Corner, VertexEvaluator},
    surface::cross_terms,
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

/// Records per triangle and piece: x and y of three corners, and 1 + what tells the material; 0 there without a mask.
pub(super) const RECORDS: usize = 2;

/// Are samples of this scene left out by a mask? Boxes and discs have none.
pub(super) fn is_there(scene: &Scene, stack: &Stack) -> bool {
    stack.shape() == Shape::Triangles && scene.is_masked()
}

/// A primitive's texture whose alpha decides, and the least alpha that is drawn.
fn masked<'a>(scene: &'a Scene, primitive: &Primitive) -> Option<(&'a Texture, u32)> {
    let material = &scene.materials[primitive.material];
    material.base_texture.as_ref().zip(material.alpha_threshold())
}

/// Where corners lie in the image, each with a bound of a float renderer's error.
pub(super) struct Places([(DVec2, DVec2); 3]);

impl Places {
    /// Of a whole triangle, or of a piece with these records; none where nothing is masked.
    pub fn of(
        vertex_evaluator: &VertexEvaluator,
        scene: &Scene,
        view: &View,
        corners: [Corner; 3],
        piece: Option<&[SnappedVertex; 3]>,
    ) -> Option<Self> {
        let primitive = &scene.primitives[vertex_evaluator.draw.primitive];
        let (texture, _) = masked(scene, primitive)?;
        let texcoords = primitive.texcoords[0].as_ref()?;
        let size = scene.images[texture.image].size();
        let whole =
            corners.map(|corner| DVec2::from(texture.units(size, texcoord(texcoords, &scene.vertex_bytes, corner.vertex)).map(f64::from)));
        let Some(records) = piece else { return Some(Self(whole.map(|place| (place, DVec2::ZERO)))) };
        let clip = corners.map(|corner| vertex_evaluator.clip(corner).expect("positions have passed the gate"));
        let v = clip.map(|p| DVec3::new(p.x, p.y, p.w));
        let lines = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| v[i].cross(v[j]));
        let terms = cross_terms(&v);
        Some(Self(records.map(|record| {
            let unit = f64::from(view.units_per_pixel());
            let ndc = |at: i32, pixels: u32| f64::from(at) / unit / f64::from(pixels) * 2.0 - 1.0;
            let p = DVec3::new(ndc(record.x, view.width), -ndc(record.y, view.height), 1.0);
            let shares = lines.map(|line| p.dot(line));
            let sum: f64 = shares.iter().sum();
            let place = (0..3).map(|k| whole[k] * (shares[k] / sum)).sum::<DVec2>();
            // A share errs by some roundings of the terms of its line, themselves sums of products that were moved and rounded.
            let errors = terms.map(|terms| p.abs().dot(terms) / f64::from(1 << 18));
            let error = (0..3).map(|k| (whole[k] - place).abs() * errors[k]).sum::<DVec2>();
            let left = sum.abs() - errors.iter().sum::<f64>();
            let far = (whole[1] - whole[0]).abs().max((whole[2] - whole[0]).abs()) / f64::from(1 << 20);
            (place, if left > 0.0 { error / left + far + 1.0 } else { DVec2::INFINITY })
        })))
    }

    /// The records as this judge has them; `primitive` tells the material.
    pub fn records(&self, primitive: usize) -> [[u32; 4]; RECORDS] {
        let word = |v: f64| v.round_ties_even() as i32 as u32;
        let [a, b, c] = self.0.map(|(place, _)| [word(place.x), word(place.y)]);
        [[a[0], a[1], b[0], b[1]], [c[0], c[1], primitive as u32 + 1, 0]]
    }

    /// Do an adapter's records lie within the bounds?
    pub fn allow(&self, given: &[[u32; 4]]) -> bool {
        let [first, last] = given else { return false };
        let corners = [[first[0], first[1]], [first[2], first[3]], [last[0], last[1]]];
        corners.iter().zip(&self.0).all(|(given, (place, bound))| {
            let away = (DVec2::from(given.map(|word| f64::from(word as i32))) - place).abs();
            away.cmple(*bound).all() && last[2] != 0
        })
    }
}

/// Is a covered sample drawn, given the doubled areas `parts` opposite the corners in the order of the file?
pub(super) fn is_drawn(scene: &Scene, primitive: &Primitive, triangle: &OrientedTriangle, parts: [u32; 3], settled: &[[u32; 4]]) -> bool {
    let Some((texture, least)) = masked(scene, primitive) else { return true };
    let [first, last] = settled else { return true };
    let mut inverse = triangle.corners.map(|corner| corner.inv_w);
    if triangle.is_turned {
        inverse.swap(1, 2);
    }
    let weights = weights(parts, inverse);
    let place = [[first[0], first[2], last[0]], [first[1], first[3], last[1]]].map(|words| mean(weights, words.map(|word| word as i32)));
    let level = &scene.images[texture.image].levels[0];
    let side = |at: i64, axis: usize| {
        let side = i64::from(level.size[axis]);
        match texture.wrap[axis] {
            Wrap::Repeat => at.rem_euclid(side),
            Wrap::Clamp => at.clamp(0, side - 1),
            Wrap::Mirrored => (at.rem_euclid(2 * side)).min(2 * side - 1 - at.rem_euclid(2 * side)),
        }
    };
    let alpha = |x: i64, y: i64| u64::from(level.texels[(side(y, 1) * i64::from(level.size[0]) + side(x, 0)) as usize][3]);
    let reached = match texture.mag_filter {
        Filter::Nearest => alpha(place[0].div_euclid(256), place[1].div_euclid(256)) << 16,
        Filter::Linear => {
            // The middle of a texel is its value.
            let [(x, right), (y, down)] = place.map(|at| ((at - 128).div_euclid(256), (at - 128).rem_euclid(256) as u64));
            let row = |y: i64| alpha(x, y) * (256 - right) + alpha(x + 1, y) * right;
            row(y) * (256 - down) + row(y + 1) * down
        }
    };
    reached >= u64::from(least)
}

/// Shares of the corners in perspective: parts, spread to 31 bits in all, times 1/w as fixed point under the nearest one's
/// exponent, of which the upper 32 bits are kept.
fn weights(parts: [u32; 3], inverse: [f32; 3]) -> [u64; 3] {
    let parts = parts.map(u64::from);
    let sum = parts.iter().sum::<u64>().max(1);
    let spread = 1u64 << (31 - sum.ilog2() - 1);
    let exponent = |v: f32| v.to_bits() >> 23;
    let nearest = inverse.iter().copied().map(exponent).max().unwrap_or(0);
    [0, 1, 2].map(|k| {
        let significand = u64::from(inverse[k].to_bits() & 0x7f_ffff | 0x80_0000) << 8;
        let fixed = significand.checked_shr(nearest - exponent(inverse[k])).filter(|_| nearest - exponent(inverse[k]) < 32).unwrap_or(0);
        (parts[k] * spread * fixed) >> 32
    })
}

/// The weighted mean, rounded down.
fn mean(weights: [u64; 3], values: [i32; 3]) -> i64 {
    let sum = weights.iter().sum::<u64>().max(1);
    let least = i64::from(values.into_iter().min().unwrap_or(0));
    let above: u128 = (0..3).map(|k| u128::from(weights[k]) * (i64::from(values[k]) - least) as u128).sum();
    least + (above / u128::from(sum)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_the_perspective_one_to_a_unit() {
        // Half way on the screen between w = 1 and w = 3 lies a quarter of the way in space.
        let shares = weights([500, 500, 0], [1.0, 1.0 / 3.0, 0.7]);
        assert_eq!(mean(shares, [0, 1 << 20, 77]), (1 << 18) - 1 + i64::from(mean(shares, [0, 1 << 20, 77]) == 1 << 18));
        assert_eq!(mean(weights([1, 0, 0], [1.0; 3]), [-5, 9, 9]), -5);
        assert_eq!(mean(weights([1, 1, 2], [0.5; 3]), [-4, 4, 8]), 4);
        assert_eq!(mean(weights([0, 0, 0], [0.5; 3]), [-4, 4, 8]), -4, "no share at all");
    }
}
