//! Meshes a set of capsules as one closed surface by naive surface nets (Gibson 1998), with weights
//! that blend across joints.
//!
//! The capsules are tapered and joined by a polynomial smooth minimum. The ground plane cuts them,
//! so soles are flat.

use glam::{DMat3, DVec3};

use crate::scene::builtin::weights::{self, JointWeight};

/// A tapered capsule that follows a joint.
#[derive(Clone, Copy, Debug)]
pub struct Bone {
    /// Index of the joint that moves it.
    pub joint: usize,
    /// End points of its axis in the rest pose, meters.
    pub ends: [DVec3; 2],
    /// Radii at its ends, meters.
    pub radii: [f64; 2],
    /// Radius of the smooth blend into the capsules before it, meters.
    pub blend: f64,
    /// It is a foot: no other joint influences its sole.
    pub is_foot: bool,
}

/// All capsules, with a minimum radius that the mesh resolution can show.
pub struct CapsuleBody {
    pub bones: Vec<Bone>,
    /// Smallest radius, meters.
    pub min_radius: f64,
}

/// A surface mesh; triangles are counter-clockwise seen from the outside.
pub struct Surface {
    /// Position and normal of every vertex.
    pub vertices: Vec<[DVec3; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

/// Weights blend over this fraction of a limb's radius.
const WEIGHT_BLEND: f64 = 0.8;
const SOLE_M: f64 = 0.15;
/// Upper bound of the slope of the distance field, which tapering makes steeper than 1.
const MAX_SHADOW_SLOPE: f64 = 1.25;
/// Upper bound of the bulge of the blends, meters.
const MAX_BULGE_M: f64 = 0.05;

impl CapsuleBody {
    /// Approximate signed distance to the surface of a capsule, and its radius there.
    fn distance(&self, bone: &Bone, p: DVec3) -> (f64, f64) {
        let axis = bone.ends[1] - bone.ends[0];
        let fraction = ((p - bone.ends[0]).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
        let radius =
            (bone.radii[0] + (bone.radii[1] - bone.radii[0]) * fraction).max(self.min_radius);
        (
            (p - bone.ends[0] - axis * fraction).length() - radius,
            radius,
        )
    }

    /// The distance field of the whole body; negative inside.
    fn field(&self, p: DVec3) -> f64 {
        let mut nearest = f64::INFINITY;
        for bone in &self.bones {
            let (distance, _) = self.distance(bone, p);
            let both = (bone.blend - (nearest - distance).abs()).max(0.0);
            nearest = nearest.min(distance) - both * both / (4.0 * bone.blend);
        }
        nearest.max(-p.y)
    }

    fn slope(&self, p: DVec3) -> DVec3 {
        const STEP: f64 = 1e-4;
        let along = |axis: DVec3| self.field(p + axis * STEP) - self.field(p - axis * STEP);
        DVec3::from_array(DVec3::AXES.map(along)) / (2.0 * STEP)
    }

    /// The surface on a grid of cells of this size: a vertex in every cell that it crosses, a quad
    /// around every edge that it crosses.
    pub fn surface(&self, cell: f64) -> Surface {
        let ends = || {
            self.bones.iter().flat_map(|bone| {
                bone.ends
                    .map(|end| (end, bone.radii[0].max(bone.radii[1]).max(self.min_radius)))
            })
        };
        let most = |pick: &dyn Fn(DVec3, f64) -> f64| {
            ends()
                .map(|(end, radius)| pick(end, radius))
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let cells = |length: f64| ((length + MAX_BULGE_M) / cell).ceil() + 1.0;
        // The ground plane and the plane of symmetry pass through the centers of cells.
        let (behind, aside) = (
            cells(most(&|end, radius| radius - end.x)),
            cells(most(&|end, radius| radius + end.z.abs())),
        );
        let low = DVec3::new(-behind, -1.0, -aside) - 0.5;
        let tall = [
            cells(most(&|end, radius| end.x + radius)) + behind,
            cells(most(&|end, radius| end.y + radius)) + 1.0,
            2.0 * aside,
        ];
        let [wide, high, deep] = tall.map(|count| count as usize + 2);
        let steps = [1, wide, wide * high];
        let corner = |at: usize| {
            DVec3::new(
                (at % wide) as f64,
                (at / wide % high) as f64,
                (at / steps[2]) as f64,
            )
        };
        let mut values = vec![f64::INFINITY; steps[2] * deep];
        for row in (0..values.len()).step_by(wide) {
            let mut at = row;
            while at < row + wide {
                values[at] = self.field((low + corner(at)) * cell);
                // Skip corners that are certainly more than a cell outside.
                at += (values[at] / (MAX_SHADOW_SLOPE * cell)).max(1.0) as usize;
            }
        }
        fill_pinches(&mut values, steps);
        let mut surface = Surface {
            vertices: Vec::new(),
            triangles: Vec::new(),
        };
        let mut vertex_in = vec![u32::MAX; values.len()];
        let last = values.len() - steps.iter().sum::<usize>();
        for (at, vertex) in vertex_in.iter_mut().enumerate().take(last) {
            if let Some(middle) = crossing(&values, at, steps) {
                *vertex = surface.vertices.len() as u32;
                surface
                    .vertices
                    .push(self.on_surface((low + corner(at)) * cell, middle, cell));
            }
        }
        for at in steps[2] + steps[1] + 1..values.len() - steps[2] {
            for axis in 0..3 {
                let (inside, beyond) = (values[at] < 0.0, values[at + steps[axis]] < 0.0);
                if inside == beyond {
                    continue;
                }
                let (u, v) = (steps[(axis + 1) % 3], steps[(axis + 2) % 3]);
                let mut round = [at - u - v, at - v, at, at - u].map(|at| vertex_in[at]);
                if beyond {
                    round.reverse();
                }
                surface.quadrilateral(round);
            }
        }
        surface
    }

    /// Moves a vertex onto the surface by Newton steps, clamped to its cell so that neighbors stay
    /// apart.
    fn on_surface(&self, corner: DVec3, middle: DVec3, cell: f64) -> [DVec3; 2] {
        let mut p = corner + middle * cell;
        for _ in 0..4 {
            let slope = self.slope(p);
            p -= slope * (self.field(p) / slope.length_squared().max(0.25));
            p = p.clamp(corner + 0.05 * cell, corner + 0.95 * cell);
        }
        p.y = p.y.max(0.0);
        [p, self.slope(p)]
    }

    /// The up to four joints that influence a point of the surface: the nearest ones, weighted by
    /// distance.
    pub fn joint_weights(&self, p: DVec3) -> Vec<JointWeight> {
        let joints = self
            .bones
            .iter()
            .map(|bone| bone.joint + 1)
            .max()
            .unwrap_or(0);
        let nearest = self
            .bones
            .iter()
            .map(|bone| self.distance(bone, p).0)
            .fold(f64::INFINITY, f64::min);
        let mut joint_weights: Vec<(u8, f64)> =
            (0..joints).map(|joint| (joint as u8, 0.0)).collect();
        let above = (p.y / SOLE_M).min(1.0);
        for bone in &self.bones {
            let (distance, radius) = self.distance(bone, p);
            let near = (1.0 - (distance - nearest) / (WEIGHT_BLEND * radius)).max(0.0);
            let weight = near * near * if bone.is_foot { 1.0 } else { above * above };
            let slot = &mut joint_weights[bone.joint].1;
            *slot = slot.max(weight);
        }
        joint_weights.sort_by(|a, b| b.1.total_cmp(&a.1));
        // Subtracting the fifth weight makes it fade out smoothly.
        let fifth = joint_weights
            .get(4)
            .map_or(0.0, |joint_weights| joint_weights.1);
        joint_weights.truncate(4);
        joint_weights
            .iter_mut()
            .for_each(|joint_weights| joint_weights.1 -= fifth);
        let sum: f64 = joint_weights
            .iter()
            .map(|joint_weights| joint_weights.1)
            .sum();
        joint_weights
            .iter_mut()
            .for_each(|joint_weights| joint_weights.1 /= sum);
        joint_weights.retain(|joint_weights| joint_weights.1 > 0.0);
        weights::to_integers(&joint_weights)
    }
}

/// Flips grid corners where inside and outside alternate around a face, which would pinch the
/// surface to a line.
fn fill_pinches(values: &mut [f64], steps: [usize; 3]) {
    let mut is_pinched = true;
    while std::mem::take(&mut is_pinched) {
        for (at, axis) in (0..values.len() - steps[1] - steps[2])
            .flat_map(|at| (0..3).map(move |axis| (at, axis)))
        {
            let (u, v) = (steps[(axis + 1) % 3], steps[(axis + 2) % 3]);
            let round = [at, at + u, at + u + v, at + v];
            let [a, b, c, d] = round.map(|corner| values[corner] < 0.0);
            if a == c && b == d && a != b {
                let outside = round.into_iter().filter(|&corner| values[corner] >= 0.0);
                let nearer = outside
                    .min_by(|&a, &b| values[a].total_cmp(&values[b]))
                    .expect("two corners are outside");
                values[nearer] = -values[nearer].max(1e-9);
                is_pinched = true;
            }
        }
    }
}

/// The mean of the crossings on the edges of a cell, in units of the cell.
fn crossing(values: &[f64], at: usize, steps: [usize; 3]) -> Option<DVec3> {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for [along_u, along_v] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let from = at + along_u * steps[u] + along_v * steps[v];
            let [a, b] = [values[from], values[from + steps[axis]]];
            if (a < 0.0) != (b < 0.0) {
                // A skipped corner is far outside.
                let fraction = if a.is_finite() { a / (a - b) } else { 1.0 };
                let [x, y, z] = [DVec3::AXES[axis], DVec3::AXES[u], DVec3::AXES[v]];
                sum += DMat3::from_cols(x, y, z)
                    * DVec3::new(fraction, along_u as f64, along_v as f64);
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum / count)
}

impl Surface {
    /// Adds a quad as two triangles that share its shorter diagonal.
    fn quadrilateral(&mut self, [a, b, c, d]: [u32; 4]) {
        let apart = |a: u32, b: u32| {
            self.vertices[a as usize][0].distance_squared(self.vertices[b as usize][0])
        };
        let halves = if apart(a, c) <= apart(b, d) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        };
        self.triangles.extend(halves);
    }
}
