//! The judgement: an adapter's frame held against the oracle, stage by stage, each stage from the adapter's own input.
//!
//! Vertices are judged from the matrix bits with a forward error bound, coverage and owners from the adapter's snapped
//! vertices and pieces, colours from the adapter's owners; so one fault is counted once, where it happened. Last, the whole
//! picture is held against the oracle's own, where only what a snapped vertex explains may differ.

use rayon::prelude::*;

use super::{
    coverage::{Coverage, Sample, corner_places, corner_records, cover_by, draw_of, triangles},
    decide::{decide, wrong},
    empty,
    finish::{Seen, bytes},
    frame,
    layers::{Layered, Scenery, layered},
    moved::{Corner, Mover},
    order,
    project::{Clip, half_size, project_moved},
    rules::Rules,
    steps::Answers,
};
use crate::{
    effects::Stack,
    frame::{Counters, Frame, Geometry, NO_OWNER, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    measure::{Accuracy, Verdict, compare},
    scene::{
        Scene,
        camera::View,
        draw::{Draw, DrawError, draws},
    },
};

/// Relative spacing of f32.
const ULP: f64 = 1.0 / (1 << 23) as f64;

/// Judges `frame`, the first picture of its kind, as [`judge_after`] does.
///
/// # Errors
/// As [`judge_after`].
pub fn judge(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    adapter: &Frame,
    geometry: &Geometry,
    layers: Option<&[u32]>,
) -> Result<Verdict, DrawError> {
    judge_after(scene, view, stack, adapter, geometry, layers, None)
}

/// Judges `frame`, which an adapter drew of `scene` through `geometry`, with the number of hits per sample in `layers`
/// where it counts them, and `previous` the adapter's own picture before it. Images have the size of `view`, and `geometry`
/// has a record per vertex of every draw.
///
/// # Errors
/// When a placement or the number of triangles exceeds what the arithmetic holds.
///
/// # Panics
/// When an image or the geometry has another size than the view and the scene say.
pub fn judge_after(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    adapter: &Frame,
    geometry: &Geometry,
    layers: Option<&[u32]>,
    previous: Option<&[[u8; 4]]>,
) -> Result<Verdict, DrawError> {
    let draws = draws(scene, view)?;
    if view.pixels() == 0 {
        return Ok(Verdict { accuracy: Accuracy::default(), expected: empty(view), step_band: Vec::new() });
    }
    assert_eq!([adapter.owner.len(), adapter.key.len(), adapter.color.len()], [view.pixels(); 3], "the frame has another size");
    let mut own = project_moved(scene, &draws, view, stack);
    own.decisions = decide(scene, &draws, view, stack, &own);
    let records = |geometry: &Geometry| (geometry.vertices.len(), geometry.has_own_corners);
    assert_eq!(records(geometry), records(&own), "the geometry is of another scene or stack");

    let (given, counters) = triangles(scene, &draws, geometry);
    // Where the hardware chooses among samples, everything that is covered may be drawn.
    let is_free = order::is_free(stack);
    let rules = Rules::of(stack, geometry);
    let rules = if is_free { rules } else { rules.ordered(stack, &given, view) };
    let coverage = cover_by(&rules, &given, view, Some(&adapter.owner));
    let seen = Seen { owners: &adapter.owner, keys: &adapter.key, previous };
    let scenery =
        Scenery { scene, draws: &draws, view, geometry, rules: &rules, triangles: &given, owners: &adapter.owner, keys: &adapter.key };
    let layered = layered(&scenery, &coverage, stack);
    let answers = match &layered {
        Some(layered) => Answers::between(&draws, view, stack, &seen, layered),
        None => Answers::of(scene, &draws, view, stack, &seen, geometry),
    };
    let step_band = answers.band();
    let vertices = vertex_faults(scene, &draws, view, stack, geometry, &own);

    let mut accuracy = Accuracy { pixels: view.pixels() as u64, ..Default::default() };
    match is_free.then(|| order::cut(stack, &rules, &given, view)).flatten() {
        Some(cut) => judge_choice(&mut accuracy, &coverage, adapter, layers, cut.limit),
        _ => judge_samples(&mut accuracy, &coverage, adapter, layers, stack.is_racing()),
    }
    if let Some(layered) = &layered
        && !is_free
    {
        judge_layers(&mut accuracy, layered, adapter);
    }
    // Which layers it chose, only the hardware knows.
    let colors = if is_free && layered.is_some() { adapter.color.clone() } else { answers.nearest(&adapter.color) };
    judge_colors(&mut accuracy, &colors, adapter);
    accuracy.step_band_pixels = step_band.iter().filter(|is_band| **is_band).count() as u64;
    judge_counters(&mut accuracy, &counters, adapter);
    judge_vertices(&mut accuracy, &vertices);
    accuracy.decisions_wrong = wrong(scene, &draws, view, stack, geometry);
    Whole { scene, draws: &draws, view, stack, own: &own, adapter: geometry, cut: rules.cut(), vertices: &vertices }.judge(
        &mut accuracy,
        &coverage,
        adapter,
    );

    let owners = coverage.owners();
    let (colors, counted) = match layered {
        Some(layered) => (answers.middle(), layered.counted),
        None if owners == adapter.owner => (colors, Vec::new()),
        None => {
            let seen = Seen { owners: &owners, keys: &coverage.keys(), previous };
            (Answers::of(scene, &draws, view, stack, &seen, geometry).nearest(&adapter.color), Vec::new())
        }
    };
    Ok(Verdict { accuracy, expected: frame(view, &coverage, colors, counted, counters), step_band })
}

/// Is the adapter's owner right, exactly or as one of the two answers of the depth band?
fn owner_is_right(sample: &Sample, owner: u32) -> bool {
    owner == sample.owner || sample.is_band() && sample.claim_is_possible()
}

fn judge_samples(accuracy: &mut Accuracy, coverage: &Coverage, adapter: &Frame, layers: Option<&[u32]>, is_racing: bool) {
    for (i, sample) in coverage.samples.iter().enumerate() {
        let (owner, key) = (adapter.owner[i], adapter.key[i]);
        let hits = layers.map_or(u32::from(owner != NO_OWNER), |layers| layers[i]);
        let truth = if layers.is_some() { sample.layers } else { sample.layers.min(1) };
        accuracy.holes += u64::from(truth.saturating_sub(hits));
        accuracy.double_hits += u64::from(hits.saturating_sub(truth));
        accuracy.band_pixels += u64::from(sample.is_band());
        accuracy.orphans += u64::from(owner == NO_OWNER && key != 0);
        // Where layers race, any that covers the sample may win, and the key may be another's.
        let is_contested = is_racing && sample.layers > 1 && sample.claimed.is_some();
        accuracy.race_pixels += u64::from(is_contested && !owner_is_right(sample, owner));
        accuracy.owner_mismatch += u64::from(!is_contested && !owner_is_right(sample, owner));
        accuracy.key_outside_bound += u64::from(!is_contested && sample.claimed.is_some_and(|bound| !key_fits(key, bound)));
    }
}

/// Where the hardware chooses: an owner must cover its sample, and as many samples are drawn as the limit says.
fn judge_choice(accuracy: &mut Accuracy, coverage: &Coverage, adapter: &Frame, layers: Option<&[u32]>, limit: u64) {
    for (i, sample) in coverage.samples.iter().enumerate() {
        let (owner, key) = (adapter.owner[i], adapter.key[i]);
        accuracy.double_hits += layers.map_or(0, |layers| u64::from(layers[i].saturating_sub(sample.layers)));
        accuracy.owner_mismatch += u64::from(owner != NO_OWNER && sample.claimed.is_none());
        accuracy.orphans += u64::from(owner == NO_OWNER && key != 0);
        accuracy.key_outside_bound += u64::from(sample.claimed.is_some_and(|bound| !key_fits(key, bound)));
    }
    let drawn: Option<u64> = layers.map(|layers| layers.iter().map(|&count| u64::from(count)).sum());
    accuracy.holes += drawn.map_or(0, |drawn| drawn.abs_diff(limit));
}

/// Does a float key lie in the interval? A depth too small for a normal f32 has the least key, 1.
fn key_fits(key: u32, [low, high]: [f64; 2]) -> bool {
    let depth = f64::from(f32::from_bits(key));
    (low..=high).contains(&depth) && key != 0 || key == 1 && low < f64::from(f32::MIN_POSITIVE)
}

/// Judges counts of layers.
fn judge_layers(accuracy: &mut Accuracy, truth: &Layered, adapter: &Frame) {
    assert_eq!(adapter.counted.len(), truth.counted.len(), "the counts have another size");
    let is_wrong = |(count, [least, most]): &(&u32, &[u64; 2])| !(*least..=*most).contains(&u64::from(**count));
    accuracy.counts_wrong = adapter.counted.iter().zip(&truth.count_bounds).filter(is_wrong).count() as u64;
    accuracy.overflow += u64::from(adapter.counters.full_pixels);
    accuracy.open_pixels = truth.bounds.iter().filter(|ends| bytes(ends[0]) != bytes(ends[1])).count() as u64;
}

fn judge_colors(accuracy: &mut Accuracy, expected: &[[u8; 4]], adapter: &Frame) {
    let delta = compare::pictures(expected, &adapter.color, 0);
    accuracy.max_colour_delta = delta.max_delta;
    accuracy.rms_colour_delta = delta.rms;
}

fn judge_counters(accuracy: &mut Accuracy, truth: &Counters, adapter: &Frame) {
    let counted = |c: &Counters| [c.rejected_nonfinite, c.rejected_range, c.degenerate];
    accuracy.counters_wrong = counted(truth).iter().zip(counted(&adapter.counters)).filter(|(a, b)| *a != b).count() as u64;
    accuracy.overflow += u64::from(adapter.counters.overflow);
    accuracy.orphans = accuracy.orphans.max(adapter.counters.orphans.into());
}

/// What the judgement of one vertex found.
#[derive(Clone, Copy, Default)]
struct VertexFault {
    /// Rounding may have moved it anywhere, or to the other side of a plane: counted, not judged.
    is_ill_conditioned: bool,
    /// Larger of the two distances, in units of 1/256 px.
    delta: u32,
    snap_is_outside: bool,
    attribute_is_outside: bool,
    /// How far the outline of a cut triangle may move because effects err at this corner, in units of 1/256 px.
    wander: f64,
}

fn judge_vertices(accuracy: &mut Accuracy, faults: &[VertexFault]) {
    for fault in faults {
        accuracy.vertices += 1;
        accuracy.ill_conditioned += u64::from(fault.is_ill_conditioned);
        accuracy.snap_outside_bound += u64::from(fault.snap_is_outside);
        accuracy.attribute_outside_bound += u64::from(fault.attribute_is_outside);
        accuracy.snap_over_one_unit += u64::from(fault.delta > 1);
        accuracy.max_snap_delta = accuracy.max_snap_delta.max(fault.delta);
    }
}

fn vertex_faults(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, adapter: &Geometry, own: &Geometry) -> Vec<VertexFault> {
    let of_draw = |draw: &Draw| {
        let mover = Mover::new(scene, draw, view, stack);
        let fault = |(i, corner)| {
            let at = mover.first_record() + i;
            vertex_fault(&mover, view, corner, &adapter.vertices[at], &own.vertices[at])
        };
        mover.corners().into_par_iter().enumerate().map(fault).collect::<Vec<_>>()
    };
    draws.iter().flat_map(of_draw).collect()
}

/// How far a float renderer may place every record from [`project_moved`], in units of 1/256 px and before it rounds; none
/// where rounding may move it anywhere.
pub fn snap_bounds(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack) -> Vec<Option<[f64; 2]>> {
    let of_draw = |draw: &Draw| {
        let mover = Mover::new(scene, draw, view, stack);
        let bound = |corner| snap_bound(&mover.clip(corner).ok()?, mover.clip_errors(corner).1, view);
        mover.corners().into_iter().map(bound).collect::<Vec<_>>()
    };
    draws.iter().flat_map(of_draw).collect()
}

/// Bound of a snapped position, given those of its clip coordinates; none where w is not known to a sixteenth.
fn snap_bound(clip: &Clip, [ex, ey, _, ew]: [f64; 4], view: &View) -> Option<[f64; 2]> {
    let w = clip.w.abs();
    let [half_x, half_y] = half_size(view).map(f64::from);
    let bound = |half: f64, e: f64, c: f64| half * (e / w + (ew / w + 4.5 * ULP) * (c / w).abs());
    (ew <= w / 16.0).then(|| [bound(half_x, ex, clip.x), bound(half_y, ey, clip.y)])
}

/// Holds one record against the truth by a forward error bound that covers every rounding, order and fusion WGSL allows.
fn vertex_fault(mover: &Mover, view: &View, corner: Corner, adapter: &SnappedVertex, own: &SnappedVertex) -> VertexFault {
    let Ok(clip) = mover.clip(corner) else {
        let is_nonfinite = |v: &SnappedVertex| v.flags & vertex_flags::NONFINITE != 0;
        let is_rejected_alike = adapter.flags & vertex_flags::REJECTED != 0 && is_nonfinite(adapter) == is_nonfinite(own);
        return VertexFault { snap_is_outside: !is_rejected_alike, ..Default::default() };
    };
    let ([_, _, sz, sw], errors) = mover.clip_errors(corner);
    let [_, _, ez, ew] = errors;
    let w = clip.w.abs();
    let Some(bounds) = snap_bound(&clip, errors, view) else {
        return VertexFault { is_ill_conditioned: true, ..Default::default() };
    };
    if (clip.w - clip.z).abs() <= ez + ew && adapter.flags != own.flags {
        return VertexFault { is_ill_conditioned: true, ..Default::default() };
    }
    let [bound_x, bound_y] = bounds.map(|bound| if bound < 1.0 { 1.0 } else { (1.0 + bound).floor() });
    if adapter.flags != own.flags {
        let is_near_guard = |at: i32, bound: f64| f64::from(at.abs().abs_diff(GUARD_BAND)) <= bound + 1.0;
        let differs = adapter.flags ^ own.flags;
        let [left, right, top, bottom] = vertex_flags::GUARD;
        let x_explains = differs & (left | right) == 0 || is_near_guard(own.x, bound_x);
        let y_explains = differs & (top | bottom) == 0 || is_near_guard(own.y, bound_y);
        let is_explained = differs & (vertex_flags::REJECTED | vertex_flags::NEAR) == 0 && x_explains && y_explains;
        return VertexFault { is_ill_conditioned: is_explained, snap_is_outside: !is_explained, ..Default::default() };
    }
    let wander = || {
        let nearest = if view.linear_depth_m.is_some() { 1.0 } else { clip.z.abs() };
        mover.wander(corner, nearest) * half_size(view).map(f64::from).into_iter().fold(0.0, f64::max)
    };
    if own.flags & vertex_flags::NEAR != 0 {
        return VertexFault { wander: wander(), ..Default::default() };
    }
    let w_error = (ew + ULP * sw) / w + 4.5 * ULP;
    let depth_error = (ez + ULP * sz) / w + (clip.z / w).abs() * w_error + f64::from(f32::MIN_POSITIVE);
    let attribute_is_outside =
        !((f64::from(adapter.inv_w) * clip.w - 1.0).abs() <= w_error && (f64::from(adapter.depth) - clip.z / clip.w).abs() <= depth_error);
    if own.flags != 0 {
        return VertexFault { attribute_is_outside, wander: wander(), ..Default::default() };
    }
    let (dx, dy) = (adapter.x.abs_diff(own.x), adapter.y.abs_diff(own.y));
    let snap_is_outside = f64::from(dx) > bound_x || f64::from(dy) > bound_y;
    VertexFault { delta: dx.max(dy), snap_is_outside, attribute_is_outside, ..Default::default() }
}

/// The adapter's picture against the oracle's own, from the matrix bits on.
struct Whole<'a> {
    scene: &'a Scene,
    draws: &'a [Draw],
    view: &'a View,
    stack: &'a Stack,
    own: &'a Geometry,
    adapter: &'a Geometry,
    /// Where the adapter's draw order stops.
    cut: Option<order::Cut>,
    vertices: &'a [VertexFault],
}

impl Whole<'_> {
    fn judge(&self, accuracy: &mut Accuracy, coverage: &Coverage, adapter: &Frame) {
        let (triangles, _) = triangles(self.scene, self.draws, self.own);
        if order::is_free(self.stack) {
            return;
        }
        let rules = Rules::of(self.stack, self.own).ordered(self.stack, &triangles, self.view);
        let own = cover_by(&rules, &triangles, self.view, Some(&adapter.owner));
        // A sample more or less before it moves the place where a draw order stops.
        let stops = [self.cut, rules.cut()].map(|cut| cut.map(|cut| cut.straddler));
        let is_near_stop = |owner: u32| match stops {
            [Some(a), Some(b)] if self.cut != rules.cut() => (a.min(b)..=a.max(b)).contains(&owner),
            _ => false,
        };
        for (pixel, (truth, sample)) in own.samples.iter().zip(&coverage.samples).enumerate() {
            let owner = adapter.owner[pixel];
            // An owner that is wrong even for the adapter's own geometry has been counted as such.
            if owner_is_right(truth, owner) || !owner_is_right(sample, owner) {
                continue;
            }
            if is_near_stop(owner) || is_near_stop(truth.owner) || self.snap_explains(truth.owner, owner, pixel) {
                accuracy.explained_by_snap += 1;
            } else {
                accuracy.unexplained += 1;
            }
        }
    }

    /// May two owners change places at a pixel because vertices moved? Either an outline passed over the sample, or the
    /// two surfaces cross there.
    fn snap_explains(&self, a: u32, b: u32, pixel: usize) -> bool {
        let at = Place::of(self.view, pixel);
        let outlines: Vec<Outline> = [a, b].into_iter().filter_map(|owner| self.outline(owner)).collect();
        if outlines.iter().any(|outline| outline.may_pass(&at)) {
            return true;
        }
        // Sample effects measure inside of triangles: there a moved corner or another decision may tell otherwise.
        let tells = |owner: u32| self.outline(owner).is_some_and(|outline| outline.reach > 0.0) || self.decides_otherwise(owner);
        if self.stack.each(|hooks| hooks.sample).next().is_some() && [a, b].into_iter().any(tells) {
            return true;
        }
        let depths: Option<Vec<[f64; 2]>> = outlines.iter().map(|outline| outline.depths(&at)).collect();
        matches!(depths.as_deref(), Some([a, b]) if a[0] <= b[1] && b[0] <= a[1])
    }

    /// Did sample effects settle something else about this triangle than the oracle does?
    fn decides_otherwise(&self, owner: u32) -> bool {
        let deciding = self.stack.each(|hooks| hooks.sample.filter(|hook| hook.decides)).count();
        let of =
            |geometry: &Geometry| geometry.decisions.get(owner as usize * deciding..(owner as usize + 1) * deciding).map(<[_]>::to_vec);
        of(self.adapter) != of(self.own)
    }

    /// Where an owner is drawn and how far that may move: as far as its corners did, or a pixel where it is cut and what
    /// effects err by at its corners.
    fn outline(&self, owner: u32) -> Option<Outline> {
        let draw = draw_of(self.scene, self.draws, owner)?;
        let records = corner_records(self.scene, draw, self.own, owner);
        let faults = corner_places(self.scene, draw, self.own, owner).map(|at| self.vertices[at]);
        let is_whole = records.iter().all(|record| record.flags == 0);
        let moved = f64::from(faults.iter().map(|fault| fault.delta).max().unwrap_or(0));
        let reach = match faults.iter().any(|fault| fault.is_ill_conditioned) {
            true => f64::INFINITY,
            false if is_whole => 1.5 * moved,
            false => faults.iter().map(|fault| 1.5 * fault.wander).fold(256.0, f64::max),
        };
        // Own pieces stand sorted by parent.
        let pieces = &self.own.pieces;
        let cut = &pieces[pieces.partition_point(|p| p.parent < owner)..pieces.partition_point(|p| p.parent <= owner)];
        Some(Outline { triangles: if is_whole { vec![records] } else { cut.iter().map(|piece| piece.corners).collect() }, reach })
    }
}

/// One owner on the screen: itself, or its pieces.
struct Outline {
    triangles: Vec<[SnappedVertex; 3]>,
    /// How far an edge may have moved, in units of 1/256 px; more than the distance of its ends in either axis.
    reach: f64,
}

impl Outline {
    fn may_pass(&self, at: &Place) -> bool {
        self.reach == f64::INFINITY || self.reach > 0.0 && self.triangles.iter().any(|corners| at.border(corners) <= self.reach)
    }

    /// Depths that the surface may have at a sample; none more than a pixel away from it.
    fn depths(&self, at: &Place) -> Option<[f64; 2]> {
        let each = self.triangles.iter().filter_map(|corners| at.depths(corners, self.reach.clamp(2.0, 256.0)));
        each.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

/// The sample of a pixel, in units of 1/256 px.
struct Place {
    x: f64,
    y: f64,
}

impl Place {
    fn of(view: &View, pixel: usize) -> Self {
        let width = view.width as usize;
        let unit = |k: usize| (256 * k + 128) as f64;
        Self { x: unit(pixel % width), y: unit(pixel / width) }
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

    /// Depth of the plane through three corners here, give or take `reach` units of movement and the error of a float
    /// key; none where the triangle is more than a pixel away.
    fn depths(&self, corners: &[SnappedVertex; 3], reach: f64) -> Option<[f64; 2]> {
        let [a, b, c] = corners.map(|v| [f64::from(v.x), f64::from(v.y), f64::from(v.depth)]);
        let edge = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (self.y - p[1]) - (q[1] - p[1]) * (self.x - p[0]);
        let weights = [edge(b, c), edge(c, a), edge(a, b)];
        let area: f64 = weights.iter().sum();
        let covers = weights.iter().all(|weight| weight * area >= 0.0);
        if area == 0.0 || !covers && self.border(corners) > 256.0 {
            return None;
        }
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let slope_x = (u[2] * v[1] - v[2] * u[1]) / area;
        let slope_y = (v[2] * u[0] - u[2] * v[0]) / area;
        let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let depth = a[2] + slope_x * (self.x - a[0]) + slope_y * (self.y - a[1]);
        let slack = reach * (slope_x.abs() + slope_y.abs()) + 64.0 * ULP * depth.abs();
        Some([(depth - slack).max(low).min(high), (depth + slack).min(high).max(low)])
    }
}
