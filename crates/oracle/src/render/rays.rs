//! Shadow rays: whether anything blocks the way from a sample to a directional light, in f64. This
//! is the reference that shadow maps are measured against. Triangles are neither snapped nor culled
//! by facing; a bounding volume hierarchy finds them.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{super::shot::Shot, vertex::VertexEvaluator};
use crate::scene::{draw::Draw, shadow_resolution::ShadowResolution};

/// A triangle that casts a shadow.
struct Caster {
    corners: [DVec3; 3],
    id: u32,
}

impl Caster {
    fn center(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }
}

/// A bounding box; its first child is the next node.
struct Node {
    low: DVec3,
    high: DVec3,
    /// Triangles of a leaf; empty for other nodes.
    leaf: Range<u32>,
    /// Index of the second child.
    second: u32,
}

/// Everything that casts shadows.
pub struct Rays {
    casters: Vec<Caster>,
    nodes: Vec<Node>,
    /// Unit vector towards the light.
    toward: DVec3,
    /// Hits nearer than this are on the surface where the ray begins.
    min_distance_m: f64,
}

/// Triangles in a leaf.
const LEAF: usize = 4;

impl Rays {
    /// The shadow casters for the light of the shot's stack; none without a light, or with a matrix
    /// that is out of range.
    pub fn of(shot: &Shot) -> Option<Self> {
        let Shot {
            scene, view, stack, ..
        } = *shot;
        let toward = stack.light()?.toward();
        let light_view = stack.light_view(scene, &view.with_shadow(ShadowResolution::default()))?;
        let draws = stack.draws(scene, &light_view).ok()?;
        let mut casters: Vec<Caster> = draws
            .par_iter()
            .filter(|draw| !draw.is_glass)
            .flat_map(|draw| casters(shot, draw))
            .collect();
        let radius = scene.bounds_of(scene.shadow_casters()).radius().max(1e-9);
        let mut nodes = Vec::new();
        if !casters.is_empty() {
            let all = 0..casters.len();
            build(&mut casters, all, &mut nodes);
        }
        Some(Self {
            casters,
            nodes,
            toward,
            min_distance_m: 1e-7 * radius,
        })
    }

    /// Returns true if light reaches `origin`, a point on the triangle `id`.
    pub fn reach(&self, origin: DVec3, id: u32) -> bool {
        let inverse = self.toward.recip();
        let mut pending = vec![0u32];
        while let Some(at) = pending.pop() {
            let Some(node) = self.nodes.get(at as usize) else {
                continue;
            };
            let (a, b) = (
                (node.low - origin) * inverse,
                (node.high - origin) * inverse,
            );
            // A ray parallel to an axis makes NaN on the faces of that axis; min and max ignore it.
            let enters = [a.x.min(b.x), a.y.min(b.y), a.z.min(b.z)]
                .into_iter()
                .fold(0.0, f64::max);
            let leaves = [a.x.max(b.x), a.y.max(b.y), a.z.max(b.z)]
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            if enters > leaves * (1.0 + 1e-12) {
                continue;
            }
            if node.leaf.is_empty() {
                pending.extend([at + 1, node.second]);
                continue;
            }
            let casters = &self.casters[node.leaf.start as usize..node.leaf.end as usize];
            if casters
                .iter()
                .any(|caster| caster.id != id && self.meets(origin, caster))
            {
                return false;
            }
        }
        true
    }

    /// Returns true if the ray meets a triangle (Möller and Trumbore 1997).
    fn meets(&self, origin: DVec3, caster: &Caster) -> bool {
        let [a, b, c] = caster.corners;
        let (ab, ac) = (b - a, c - a);
        let p = self.toward.cross(ac);
        let det = ab.dot(p);
        if det == 0.0 {
            return false;
        }
        let from = origin - a;
        let u = from.dot(p) / det;
        let q = from.cross(ab);
        let v = self.toward.dot(q) / det;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / det > self.min_distance_m
    }
}

/// Triangles of a draw after all vertex effects, except those with a rejected corner.
fn casters(shot: &Shot, draw: &Draw) -> Vec<Caster> {
    let Shot {
        scene, view, stack, ..
    } = *shot;
    let evaluator = VertexEvaluator::new(scene, draw, view, stack);
    let primitive = &scene.primitives[draw.primitive];
    let caster = |triangle: u32| {
        let corners = evaluator.triangle_corners(triangle);
        if corners
            .iter()
            .any(|corner| evaluator.clip(*corner).is_err())
        {
            return None;
        }
        let corners = corners.map(|corner| {
            let moved = evaluator.moved(corner);
            evaluator.unmoved(corner).position + moved.offset
        });
        Some(Caster {
            corners,
            id: draw.first_triangle + triangle,
        })
    };
    (0..primitive.triangle_count())
        .into_par_iter()
        .filter_map(caster)
        .collect()
}

/// Splits a run of triangles at the median along the longest side of their centers' bounding box
/// until it fits a leaf.
fn build(casters: &mut [Caster], run: Range<usize>, nodes: &mut Vec<Node>) {
    let bounds = |points: &mut dyn Iterator<Item = DVec3>| {
        points.fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), point| (low.min(point), high.max(point)),
        )
    };
    let (low, high) = bounds(
        &mut casters[run.clone()]
            .iter()
            .flat_map(|caster| caster.corners),
    );
    let (first, last) = bounds(&mut casters[run.clone()].iter().map(Caster::center));
    let sides = last - first;
    let at = nodes.len();
    let is_leaf = run.len() <= LEAF || sides.max_element() <= 0.0;
    let leaf = if is_leaf {
        run.start as u32..run.end as u32
    } else {
        0..0
    };
    nodes.push(Node {
        low,
        high,
        leaf,
        second: 0,
    });
    if is_leaf {
        return;
    }
    let axis = (0..3)
        .max_by(|&a, &b| sides[a].total_cmp(&sides[b]))
        .expect("three axes");
    let half = run.len() / 2;
    casters[run.clone()]
        .select_nth_unstable_by(half, |a, b| a.center()[axis].total_cmp(&b.center()[axis]));
    build(casters, run.start..run.start + half, nodes);
    nodes[at].second = nodes.len() as u32;
    build(casters, run.start + half..run.end, nodes);
}
