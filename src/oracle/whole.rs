//! The whole: an adapter's picture against the oracle's own, where only what a snapped vertex explains may differ.

use super::{
    coverage::{Coverage, corner_places, corner_records, cover_with, draw_of, triangles},
    judge::{ULP, VertexFault, triangle_is_right},
    order,
    rules::SampleTests,
};
use crate::{
    effects::{Stack, hooks::Shape},
    frame::{Exactness, Frame, Geometry, SnappedVertex},
    measure::ErrorReport,
    scene::{Scene, draw::Draw, view::View},
};

/// The adapter's picture against the oracle's own, from the matrix bits on.
pub(super) struct EndToEnd<'a> {
    pub scene: &'a Scene,
    pub draws: &'a [Draw],
    pub view: &'a View,
    pub stack: &'a Stack,
    pub own: &'a Geometry,
    pub adapter: &'a Geometry,
    /// Where the adapter's draw order stops.
    pub cut: Option<order::Cut>,
    pub vertices: &'a [VertexFault],
}

impl EndToEnd<'_> {
    pub fn judge(&self, accuracy: &mut ErrorReport, coverage: &Coverage, adapter: &Frame) {
        let (triangles, _) = triangles(self.scene, self.draws, self.own);
        if order::is_free(self.stack) {
            return;
        }
        let rules =
            SampleTests::of(self.stack, self.own).masked(self.scene, self.draws, self.stack).ordered(self.stack, &triangles, self.view);
        let own = cover_with(&rules, &triangles, self.view, Some(&adapter.triangle_id));
        // A sample more or less before it moves the place where a draw order stops.
        let stops = [self.cut, rules.cut()].map(|cut| cut.map(|cut| cut.straddler));
        let is_near_stop = |triangle_id: u32| match stops {
            [Some(a), Some(b)] if self.cut != rules.cut() => (a.min(b)..=a.max(b)).contains(&triangle_id),
            _ => false,
        };
        for (pixel, (reference, sample)) in own.samples.iter().zip(&coverage.samples).enumerate() {
            let triangle_id = adapter.triangle_id[pixel];
            let is_right = triangle_is_right(reference, triangle_id) && (!self.is_strict() || adapter.key[pixel] == reference.key);
            // An triangle id that is wrong even for the adapter's own geometry has been counted as such.
            if is_right || !triangle_is_right(sample, triangle_id) {
                continue;
            }
            let may_move = || {
                self.adapter.is_rough
                    || is_near_stop(triangle_id)
                    || is_near_stop(reference.triangle_id)
                    || self.snap_explains(reference.triangle_id, triangle_id, pixel)
            };
            if !self.is_strict() && may_move() {
                accuracy.explained_by_snap += 1;
            } else {
                accuracy.unexplained += 1;
            }
        }
    }

    /// Records and keys are the same everywhere, so there is nothing to explain.
    fn is_strict(&self) -> bool {
        self.own.exact == Exactness { vertices: true, keys: true }
    }

    /// May two triangle ids change places at a pixel because vertices moved? Either an outline passed over the sample, or the
    /// two surfaces cross there.
    fn snap_explains(&self, a: u32, b: u32, pixel: usize) -> bool {
        let at = Place::of(self.view, pixel);
        let outlines: Vec<Outline> = [a, b].into_iter().filter_map(|triangle_id| self.outline(triangle_id)).collect();
        if outlines.iter().any(|outline| outline.may_pass(&at)) {
            return true;
        }
        // Sample effects measure inside of triangles: there a moved corner or another decision may tell otherwise.
        let tells =
            |triangle_id: u32| self.outline(triangle_id).is_some_and(|outline| outline.reach > 0.0) || self.decides_otherwise(triangle_id);
        if self.stack.each(|hooks| hooks.sample).next().is_some() && [a, b].into_iter().any(tells) {
            return true;
        }
        let depths: Option<Vec<[f64; 2]>> = outlines.iter().map(|outline| outline.depths(&at)).collect();
        matches!(depths.as_deref(), Some([a, b]) if a[0] <= b[1] && b[0] <= a[1])
    }

    /// Did sample effects settle something else about this triangle than the oracle does?
    fn decides_otherwise(&self, triangle_id: u32) -> bool {
        let deciding = self.stack.each(|hooks| hooks.sample.filter(|hook| hook.has_setup)).count();
        let of = |geometry: &Geometry| {
            geometry.sample_setups.get(triangle_id as usize * deciding..(triangle_id as usize + 1) * deciding).map(<[_]>::to_vec)
        };
        of(self.adapter) != of(self.own)
    }

    /// Where an triangle id is drawn and how far that may move: as far as its corners did, or a pixel where it is cut and what
    /// effects err by at its corners.
    fn outline(&self, triangle_id: u32) -> Option<Outline> {
        let draw = draw_of(self.scene, self.draws, triangle_id)?;
        let records = corner_records(self.scene, draw, self.own, triangle_id);
        let faults = corner_places(self.scene, draw, self.own, triangle_id).map(|at| self.vertices[at]);
        let is_whole = records.iter().all(|record| record.flags == 0);
        let moved = f64::from(faults.iter().map(|fault| fault.delta).max().unwrap_or(0));
        let reach = match faults.iter().any(|fault| fault.is_ill_conditioned) {
            true => f64::INFINITY,
            false if is_whole => 1.5 * moved,
            false => faults.iter().map(|fault| 1.5 * fault.wander).fold(f64::from(self.view.units_per_pixel()), f64::max),
        };
        // Own pieces stand sorted by parent.
        let pieces = &self.own.pieces;
        let cut = &pieces[pieces.partition_point(|p| p.parent < triangle_id)..pieces.partition_point(|p| p.parent <= triangle_id)];
        let is_disc = self.stack.shape() == Shape::Triangles && self.own.particle_discs.contains(&triangle_id);
        Some(Outline { is_disc, triangles: if is_whole { vec![records] } else { cut.iter().map(|piece| piece.corners).collect() }, reach })
    }
}

/// One triangle id on the screen: itself, or its pieces.
struct Outline {
    triangles: Vec<[SnappedVertex; 3]>,
    /// Of which only the disc that touches its sides is drawn.
    is_disc: bool,
    /// How far an edge may have moved, in units; more than the distance of its ends in either axis.
    reach: f64,
}

impl Outline {
    fn may_pass(&self, at: &Place) -> bool {
        let is_near = |corners| at.border(corners) <= self.reach || self.is_disc && at.is_near_rim(corners, self.reach);
        self.reach == f64::INFINITY || self.reach > 0.0 && self.triangles.iter().any(is_near)
    }

    /// Depths that the surface may have at a sample; none more than a pixel away from it.
    fn depths(&self, at: &Place) -> Option<[f64; 2]> {
        let each = self.triangles.iter().filter_map(|corners| at.depths(corners, self.reach.clamp(2.0, at.unit)));
        each.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

/// The sample of a pixel, in units.
struct Place {
    x: f64,
    y: f64,
    /// Units in a pixel.
    unit: f64,
}

impl Place {
    fn of(view: &View, pixel: usize) -> Self {
        let width = view.width as usize;
        let unit = f64::from(view.units_per_pixel());
        let sample = |k: usize| (k as f64 + 0.5) * unit;
        Self { x: sample(pixel % width), y: sample(pixel / width), unit }
    }

    /// Distance to the segment between two corners.
    fn distance(&self, from: &SnappedVertex, to: &SnappedVertex) -> f64 {
        let (dx, dy) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
        let (px, py) = (self.x - f64::from(from.x), self.y - f64::from(from.y));
        let length = dx * dx + dy * dy;
        let t = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
        libm::hypot(px - t * dx, py - t * dy)
    }

    /// Distance to the nearest edge of a triangle.
    fn border(&self, [a, b, c]: &[SnappedVertex; 3]) -> f64 {
        self.distance(a, b).min(self.distance(b, c)).min(self.distance(c, a))
    }

    /// May the rim of the ellipse that touches the sides in their middles pass over this point, once it is moved by `reach` units?
    /// Its points are means of the corners, so they move no farther than these do.
    fn is_near_rim(&self, [a, b, c]: &[SnappedVertex; 3], reach: f64) -> bool {
        let [a, b, c] = [a, b, c].map(|v| [f64::from(v.x), f64::from(v.y)]);
        let edge = |p: [f64; 2], q: [f64; 2], at: [f64; 2]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
        let area = edge(a, b, c);
        let is_inside = |at: [f64; 2]| {
            let shares = [edge(b, c, at), edge(c, a, at), edge(a, b, at)];
            2.0 * shares.iter().map(|share| share * share).sum::<f64>() <= area * area
        };
        let here = [self.x, self.y];
        let middle = [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let around = (0..16).map(|k| libm::sincos(f64::from(k) * std::f64::consts::TAU / 16.0));
        let is_inside_here = is_inside(here);
        libm::hypot(here[0] - middle[0], here[1] - middle[1]) <= reach
            || around.into_iter().any(|(sin, cos)| is_inside([here[0] + reach * cos, here[1] + reach * sin]) != is_inside_here)
    }

    /// Depth of the plane through three corners here, give or take `reach` units of movement and the error of a float
    /// key; none where the triangle is more than a pixel away.
    fn depths(&self, corners: &[SnappedVertex; 3], reach: f64) -> Option<[f64; 2]> {
        let [a, b, c] = corners.map(|v| [f64::from(v.x), f64::from(v.y), f64::from(v.depth)]);
        let edge = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (self.y - p[1]) - (q[1] - p[1]) * (self.x - p[0]);
        let weights = [edge(b, c), edge(c, a), edge(a, b)];
        let area: f64 = weights.iter().sum();
        let covers = weights.iter().all(|weight| weight * area >= 0.0);
        if area == 0.0 || !covers && self.border(corners) > self.unit {
            return None;
        }
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let slope_x = (u[2] * v[1] - v[2] * u[1]) / area;
        let slope_y = (v[2] * u[0] - u[2] * v[0]) / area;
        let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let depth = a[2] + slope_x * (self.x - a[0]) + slope_y * (self.y - a[1]);
        let error_bound = reach * (slope_x.abs() + slope_y.abs()) + 64.0 * ULP * depth.abs();
        Some([(depth - error_bound).max(low).min(high), (depth + error_bound).min(high).max(low)])
    }
}
