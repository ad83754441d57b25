//! Rays: whether anything stands between a sample and a directional light, in f64 and without a map: the reference that shadow
//! maps are measured against. Triangles as they are, before any snap, in a hierarchy of boxes; a light sees them from both sides.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    light::Place,
    moved::{Corner, VertexEvaluator},
};
use crate::{
    effects::Stack,
    scene::{
        Scene,
        draw::{Draw, draws},
        shadow_resolution::ShadowResolution,
        view::View,
    },
};

/// A triangle in the way.
struct Caster {
    corners: [DVec3; 3],
    id: u32,
}

impl Caster {
    fn center(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }
}

/// A box round triangles; its first child follows it.
struct Node {
    low: DVec3,
    high: DVec3,
    /// Of a leaf, its triangles; otherwise empty.
    leaf: std::ops::Range<u32>,
    second: u32,
}

/// All that casts shadows.
pub(super) struct Rays {
    casters: Vec<Caster>,
    nodes: Vec<Node>,
    toward: DVec3,
    /// What lies nearer than this is where the ray begins.
    least_m: f64,
}

/// Triangles in a leaf.
const LEAF: usize = 4;

impl Rays {
    /// What stands in the way of the light of `stack`; none where there is no light, or a matrix that does not hold.
    pub fn of(scene: &Scene, view: &View, stack: &Stack) -> Option<Self> {
        let toward = stack.light()?.toward();
        let seen = stack.light_view(scene, &view.with_shadow(ShadowResolution::default()))?;
        let draws = draws(scene, &seen).ok()?;
        let mut casters: Vec<Caster> = draws.iter().flat_map(|draw| casters(scene, draw, view, stack)).collect();
        let radius = scene.bounds_of(scene.shadow_casters()).radius().max(1e-9);
        let mut nodes = Vec::new();
        if !casters.is_empty() {
            let all = 0..casters.len();
            build(&mut casters, all, &mut nodes);
        }
        Some(Self { casters, nodes, toward, least_m: 1e-7 * radius })
    }

    /// Does light reach a sample of the triangle `triangle id`?
    pub fn reach(&self, place: &Place, triangle_id: u32) -> bool {
        let (origin, inverse) = (place.surface, self.toward.recip());
        let mut waiting = vec![0u32];
        while let Some(at) = waiting.pop() {
            let Some(node) = self.nodes.get(at as usize) else { continue };
            let (a, b) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            // An axis along which the ray does not run makes NaN where it grazes the box; min and max pass it over.
            let enters = [a.x.min(b.x), a.y.min(b.y), a.z.min(b.z)].into_iter().fold(0.0, f64::max);
            let leaves = [a.x.max(b.x), a.y.max(b.y), a.z.max(b.z)].into_iter().fold(f64::INFINITY, f64::min);
            if enters > leaves * (1.0 + 1e-12) {
                continue;
            }
            if node.leaf.is_empty() {
                waiting.extend([at + 1, node.second]);
                continue;
            }
            let casters = &self.casters[node.leaf.start as usize..node.leaf.end as usize];
            if casters.iter().any(|caster| caster.id != triangle_id && self.meets(origin, caster)) {
                return false;
            }
        }
        true
    }

    /// Does the ray meet a triangle (Möller and Trumbore 1997)?
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
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / det > self.least_m
    }
}

/// Triangles of a draw where its effects leave them; those with a corner that was refused are none.
fn casters(scene: &Scene, draw: &Draw, view: &View, stack: &Stack) -> Vec<Caster> {
    let vertex_evaluator = VertexEvaluator::new(scene, draw, view, stack);
    let primitive = &scene.primitives[draw.primitive];
    let caster = |triangle: u32| {
        let corners = primitive.corners(scene, triangle).map(|vertex| Corner { vertex, triangle });
        if corners.iter().any(|corner| vertex_evaluator.clip(*corner).is_err()) {
            return None;
        }
        let corners = corners.map(|corner| {
            let moved = vertex_evaluator.moved(corner);
            vertex_evaluator.still(corner).position + moved.offset
        });
        Some(Caster { corners, id: draw.first_triangle + triangle })
    };
    (0..primitive.triangle_count()).into_par_iter().filter_map(caster).collect()
}

/// Halves a run of triangles along the longest side of their centres' box until few are left.
fn build(casters: &mut [Caster], run: std::ops::Range<usize>, nodes: &mut Vec<Node>) {
    let bounds = |points: &mut dyn Iterator<Item = DVec3>| {
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| (low.min(point), high.max(point)))
    };
    let (low, high) = bounds(&mut casters[run.clone()].iter().flat_map(|caster| caster.corners));
    let (first, last) = bounds(&mut casters[run.clone()].iter().map(Caster::center));
    let sides = last - first;
    let at = nodes.len();
    let is_leaf = run.len() <= LEAF || sides.max_element() <= 0.0;
    let leaf = if is_leaf { run.start as u32..run.end as u32 } else { 0..0 };
    nodes.push(Node { low, high, leaf, second: 0 });
    if is_leaf {
        return;
    }
    let axis = (0..3).max_by(|&a, &b| sides[a].total_cmp(&sides[b])).expect("three axes");
    let half = run.len() / 2;
    casters[run.clone()].select_nth_unstable_by(half, |a, b| a.center()[axis].total_cmp(&b.center()[axis]));
    build(casters, run.start..run.start + half, nodes);
    nodes[at].second = nodes.len() as u32;
    build(casters, run.start + half..run.end, nodes);
}
