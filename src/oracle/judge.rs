//! The judgement: an adapter's frame held against the oracle, stage by stage, each stage from the adapter's own input.
//!
//! Vertices are judged from the matrix bits with a forward error bound, coverage and triangle ids from the adapter's snapped
//! vertices and pieces, colours from the adapter's triangle ids; so one fault is counted once, where it happened. Last, the whole
//! picture is held against the oracle's own, where only what a snapped vertex explains may differ.

use rayon::prelude::*;

use super::{
    coverage::{Coverage, Sample, cover_with, triangles},
    decide::{decide, wrong},
    deform,
    dots::{self, dot_strengths},
    empty,
    faults::{Manner, faults},
    finish::{Seen, bytes},
    frame,
    layers::{Layered, Scenery, layered},
    light,
    moved::{Corner, VertexEvaluator},
    order, particles,
    project::{Clip, half_size, project_as},
    rules::SampleTests,
    steps::Answers,
    whole::EndToEnd,
};
use crate::{
    effects::Stack,
    frame::{Counters, Frame, Geometry, NO_TRIANGLE, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    measure::{ErrorReport, Verdict, compare},
    scene::{
        Scene,
        draw::{Draw, DrawError, draws},
        view::View,
    },
};

/// Relative spacing of f32.
pub(super) const ULP: f64 = 1.0 / (1 << 23) as f64;

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
    // The adapter's grid, the origin of its places and the pixels that it draws are promises of its options, not faults.
    let view = &view.scaled(geometry.scale).with_grid(geometry.subpixel_bits, geometry.is_relative);
    let stack = &stack.scaled(geometry.scale);
    if view.pixels() == 0 {
        draws(scene, view)?;
        return Ok(Verdict { expected: empty(view), ..Verdict::default() });
    }
    let scene = &*particles::dressed(scene, view, stack, geometry.particle_readback.as_ref());
    let draws = draws(scene, view)?;
    assert_eq!([adapter.triangle_id.len(), adapter.key.len(), adapter.color.len()], [view.pixels(); 3], "the frame has another size");
    let mut own = project_as(geometry.exact, scene, &draws, view, stack);
    own.sample_setups = decide(scene, &draws, view, stack, &own);
    let records = |geometry: &Geometry| (geometry.vertices.len(), geometry.has_unshared_vertices);
    assert_eq!(records(geometry), records(&own), "the geometry is of another scene or stack");

    assert_eq!(geometry.light.is_some(), stack.light().is_some(), "the light has a map, or there is neither");
    let (given, counters) = triangles(scene, &draws, geometry);
    // Where the hardware chooses among samples, everything that is covered may be drawn.
    let is_free = order::is_free(stack);
    let rules = SampleTests::of(stack, geometry).masked(scene, &draws, stack);
    let rules = if is_free { rules } else { rules.ordered(stack, &given, view) };
    let coverage = cover_with(&rules, &given, view, Some(&adapter.triangle_id));
    let dots = dot_strengths(view, stack, &geometry.dots, &adapter.key);
    let seen = Seen { triangle_ids: &adapter.triangle_id, keys: &adapter.key, dots: &dots, previous };
    let scenery = Scenery {
        scene,
        draws: &draws,
        view,
        geometry,
        rules: &rules,
        triangles: &given,
        triangle_ids: &adapter.triangle_id,
        keys: &adapter.key,
    };
    let layered = layered(&scenery, &coverage, stack);
    let answers = match &layered {
        Some(layered) => Answers::between(&draws, view, stack, &seen, layered),
        None => Answers::of(scene, &draws, view, stack, &seen, geometry),
    };
    let step_band = answers.band();
    let vertices = match geometry.exact.vertices {
        true => geometry.vertices.iter().zip(&own.vertices).map(|(adapter, own)| strict_fault(adapter, own)).collect(),
        false if geometry.is_rough => geometry.vertices.iter().zip(&own.vertices).map(|(adapter, own)| rough_fault(adapter, own)).collect(),
        false => vertex_faults(scene, &draws, view, stack, geometry, &own),
    };

    let mut accuracy = ErrorReport { pixels: view.pixels() as u64, ..Default::default() };
    let cut = is_free.then(|| order::cut(stack, &rules, &given, view)).flatten();
    match cut {
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
    let manner = Manner { is_racing: stack.is_racing(), is_chosen: cut.is_some() };
    let mut faults = faults((scene, &draws, geometry), &coverage, adapter, layers, &colors, manner);
    accuracy.step_band_pixels = step_band.iter().filter(|is_band| **is_band).count() as u64;
    judge_counters(&mut accuracy, &counters, adapter);
    judge_vertices(&mut accuracy, &vertices);
    judge_particles(&mut accuracy, view, stack, geometry);
    deform::judge(&mut accuracy, scene, &draws, view, &geometry.deformed);
    dots::judge(&mut accuracy, (scene, &draws, view, stack), &geometry.dots, [&adapter.dots, &dots])?;
    // Of rough places, fronts travel roughly.
    accuracy.sample_setups_wrong = if geometry.is_rough { 0 } else { wrong(scene, &draws, view, stack, geometry) };
    if let Some(map) = &geometry.light {
        light::judge(&mut accuracy, scene, view, stack, map)?;
    }
    EndToEnd { scene, draws: &draws, view, stack, own: &own, adapter: geometry, cut: rules.cut(), vertices: &vertices }.judge(
        &mut accuracy,
        &coverage,
        adapter,
    );

    let triangle_ids = coverage.triangle_ids();
    let (colors, counted) = match layered {
        Some(layered) => (answers.middle(), layered.counted),
        None if triangle_ids == adapter.triangle_id => (colors, Vec::new()),
        None => {
            let dots = &dot_strengths(view, stack, &geometry.dots, &coverage.keys());
            let seen = Seen { triangle_ids: &triangle_ids, keys: &coverage.keys(), dots, previous };
            (Answers::of(scene, &draws, view, stack, &seen, geometry).nearest(&adapter.color), Vec::new())
        }
    };
    faults.compare_again(&adapter.color, &colors);
    Ok(Verdict { accuracy, expected: frame(view, &coverage, colors, counted, counters), step_band, faults })
}

/// Is the adapter's triangle id right, exactly or as one of the two answers of the depth band?
pub(super) fn triangle_is_right(sample: &Sample, triangle_id: u32) -> bool {
    triangle_id == sample.triangle_id || sample.is_band() && sample.claim_is_possible()
}

fn judge_samples(accuracy: &mut ErrorReport, coverage: &Coverage, adapter: &Frame, layers: Option<&[u32]>, is_racing: bool) {
    for (i, sample) in coverage.samples.iter().enumerate() {
        let (triangle_id, key) = (adapter.triangle_id[i], adapter.key[i]);
        let hits = layers.map_or(u32::from(triangle_id != NO_TRIANGLE), |layers| layers[i]);
        let reference = if layers.is_some() { sample.layers } else { sample.layers.min(1) };
        accuracy.holes += u64::from(reference.saturating_sub(hits));
        accuracy.double_hits += u64::from(hits.saturating_sub(reference));
        accuracy.depth_band_pixels += u64::from(sample.is_band());
        accuracy.depth_without_id += u64::from(triangle_id == NO_TRIANGLE && key != 0);
        // Where layers race, any that covers the sample may win, and the key may be another's.
        let is_contested = is_racing && sample.layers > 1 && sample.claimed.is_some();
        accuracy.race_pixels += u64::from(is_contested && !triangle_is_right(sample, triangle_id));
        let is_wrong = !is_contested && !triangle_is_right(sample, triangle_id);
        accuracy.wrong_triangles += u64::from(is_wrong);
        accuracy.wrong_nearest += u64::from(is_wrong && sample.claimed.is_some());
        let is_judged = !is_contested && !adapter.depth_keys_are_approximate;
        accuracy.key_outside_bound += u64::from(is_judged && sample.claimed.is_some_and(|bound| !key_fits(key, bound)));
    }
}

/// Where the hardware chooses: an triangle id must cover its sample, and as many samples are drawn as the limit says.
fn judge_choice(accuracy: &mut ErrorReport, coverage: &Coverage, adapter: &Frame, layers: Option<&[u32]>, limit: u64) {
    for (i, sample) in coverage.samples.iter().enumerate() {
        let (triangle_id, key) = (adapter.triangle_id[i], adapter.key[i]);
        accuracy.double_hits += layers.map_or(0, |layers| u64::from(layers[i].saturating_sub(sample.layers)));
        accuracy.wrong_triangles += u64::from(triangle_id != NO_TRIANGLE && sample.claimed.is_none());
        accuracy.depth_without_id += u64::from(triangle_id == NO_TRIANGLE && key != 0);
        accuracy.key_outside_bound +=
            u64::from(!adapter.depth_keys_are_approximate && sample.claimed.is_some_and(|bound| !key_fits(key, bound)));
    }
    let drawn: Option<u64> = layers.map(|layers| layers.iter().map(|&count| u64::from(count)).sum());
    accuracy.holes += drawn.map_or(0, |drawn| drawn.abs_diff(limit));
}

/// Does a float key lie in the interval? A depth too small for a normal f32 has the least key, 1.
pub(super) fn key_fits(key: u32, [low, high]: [f64; 2]) -> bool {
    let depth = f64::from(f32::from_bits(key));
    (low..=high).contains(&depth) && key != 0 || key == 1 && low < f64::from(f32::MIN_POSITIVE)
}

/// Judges counts of layers.
fn judge_layers(accuracy: &mut ErrorReport, reference: &Layered, adapter: &Frame) {
    assert_eq!(adapter.counted.len(), reference.counted.len(), "the counts have another size");
    let is_wrong = |(count, [least, most]): &(&u32, &[u64; 2])| !(*least..=*most).contains(&u64::from(**count));
    accuracy.layer_counts_wrong = adapter.counted.iter().zip(&reference.count_bounds).filter(is_wrong).count() as u64;
    accuracy.overflow += u64::from(adapter.counters.full_pixels);
    accuracy.ambiguous_layer_pixels = reference.bounds.iter().filter(|ends| bytes(ends[0]) != bytes(ends[1])).count() as u64;
}

fn judge_colors(accuracy: &mut ErrorReport, expected: &[[u8; 4]], adapter: &Frame) {
    let delta = compare::pictures(expected, &adapter.color, 0);
    accuracy.max_color_delta = delta.max_delta;
    accuracy.rms_color_delta = delta.rms;
}

fn judge_counters(accuracy: &mut ErrorReport, reference: &Counters, adapter: &Frame) {
    let counted = |c: &Counters| [c.rejected_nonfinite, c.rejected_range, c.degenerate];
    accuracy.counters_wrong = counted(reference).iter().zip(counted(&adapter.counters)).filter(|(a, b)| *a != b).count() as u64;
    accuracy.overflow += u64::from(adapter.counters.overflow);
    accuracy.depth_without_id = accuracy.depth_without_id.max(adapter.counters.depth_without_id.into());
}

fn judge_particles(accuracy: &mut ErrorReport, view: &View, stack: &Stack, geometry: &Geometry) {
    let Some(particle_readback) = &geometry.particle_readback else { return };
    let judged = particles::judged(view, stack, particle_readback);
    accuracy.particles = judged.len() as u64;
    accuracy.particles_outside_bound = judged.iter().filter(|one| one.is_outside).count() as u64;
    accuracy.particles_diverged = judged.iter().filter(|one| one.astray_px > 1.0).count() as u64;
    accuracy.max_divergence_px = judged.iter().map(|one| one.astray_px).fold(0.0, f64::max);
    accuracy.mean_divergence_m = judged.iter().map(|one| one.astray_m).sum::<f64>() / judged.len().max(1) as f64;
}

/// What the judgement of one vertex found.
#[derive(Clone, Copy, Default)]
pub(super) struct VertexFault {
    /// Rounding may have moved it anywhere, or to the other side of a plane: counted, not judged.
    pub is_ill_conditioned: bool,
    /// Larger of the two distances, in units.
    pub delta: u32,
    pub snap_is_outside: bool,
    pub attribute_is_outside: bool,
    /// How far the outline of a cut triangle may move because effects err at this corner, in units.
    pub wander: f64,
}

pub(super) fn judge_vertices(accuracy: &mut ErrorReport, faults: &[VertexFault]) {
    for fault in faults {
        accuracy.vertices += 1;
        accuracy.ill_conditioned += u64::from(fault.is_ill_conditioned);
        accuracy.snap_outside_bound += u64::from(fault.snap_is_outside);
        accuracy.attribute_outside_bound += u64::from(fault.attribute_is_outside);
        accuracy.snap_over_one_unit += u64::from(fault.delta > 1);
        accuracy.max_snap_delta = accuracy.max_snap_delta.max(fault.delta);
    }
}

pub(super) fn vertex_faults(
    scene: &Scene,
    draws: &[Draw],
    view: &View,
    stack: &Stack,
    adapter: &Geometry,
    own: &Geometry,
) -> Vec<VertexFault> {
    let of_draw = |draw: &Draw| {
        let vertex_evaluator = VertexEvaluator::new(scene, draw, view, stack);
        let fault = |(i, corner)| {
            let at = vertex_evaluator.first_record() + i;
            vertex_fault(&vertex_evaluator, view, corner, &adapter.vertices[at], &own.vertices[at])
        };
        vertex_evaluator.corners().into_par_iter().enumerate().map(fault).collect::<Vec<_>>()
    };
    draws.iter().flat_map(of_draw).collect()
}

/// Holds one record against its twin, bit by bit.
fn strict_fault(adapter: &SnappedVertex, own: &SnappedVertex) -> VertexFault {
    let bits = |v: &SnappedVertex| [v.depth.to_bits(), v.inv_w.to_bits()];
    let delta = if own.flags == 0 { adapter.x.abs_diff(own.x).max(adapter.y.abs_diff(own.y)) } else { 0 };
    let snap_is_outside = adapter.flags != own.flags || delta > 0;
    VertexFault { delta, snap_is_outside, attribute_is_outside: bits(adapter) != bits(own), ..Default::default() }
}

/// How far one record lies from its twin, whose place has more bits.
fn rough_fault(adapter: &SnappedVertex, own: &SnappedVertex) -> VertexFault {
    let is_placed = adapter.flags == 0 && own.flags == 0;
    let delta = if is_placed { adapter.x.abs_diff(own.x).max(adapter.y.abs_diff(own.y)) } else { 0 };
    // What is refused is refused in any number of bits.
    let refused = |v: &SnappedVertex| (v.flags & vertex_flags::REJECTED != 0, v.flags & vertex_flags::NONFINITE != 0);
    VertexFault { delta, snap_is_outside: refused(adapter) != refused(own), ..Default::default() }
}

/// How far a float renderer may place every record from [`super::project_moved`], in units and before it rounds; none
/// where rounding may move it anywhere.
pub fn snap_bounds(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack) -> Vec<Option<[f64; 2]>> {
    let of_draw = |draw: &Draw| {
        let vertex_evaluator = VertexEvaluator::new(scene, draw, view, stack);
        let bound = |corner| snap_bound(&vertex_evaluator.clip(corner).ok()?, vertex_evaluator.clip_errors(corner).1, view);
        vertex_evaluator.corners().into_iter().map(bound).collect::<Vec<_>>()
    };
    draws.iter().flat_map(of_draw).collect()
}

/// Bound of a snapped position, given those of its clip coordinates; none where w is not known to a sixteenth.
pub(super) fn snap_bound(clip: &Clip, [ex, ey, _, ew]: [f64; 4], view: &View) -> Option<[f64; 2]> {
    let w = clip.w.abs();
    let [half_x, half_y] = half_size(view).map(f64::from);
    let bound = |half: f64, e: f64, c: f64| half * (e / w + (ew / w + 4.5 * ULP) * (c / w).abs());
    (ew <= w / 16.0).then(|| [bound(half_x, ex, clip.x), bound(half_y, ey, clip.y)])
}

/// Holds one record against the reference by a forward error bound that covers every rounding, order and fusion WGSL allows.
fn vertex_fault(
    vertex_evaluator: &VertexEvaluator,
    view: &View,
    corner: Corner,
    adapter: &SnappedVertex,
    own: &SnappedVertex,
) -> VertexFault {
    let Ok(clip) = vertex_evaluator.clip(corner) else {
        let is_nonfinite = |v: &SnappedVertex| v.flags & vertex_flags::NONFINITE != 0;
        let is_rejected_alike = adapter.flags & vertex_flags::REJECTED != 0 && is_nonfinite(adapter) == is_nonfinite(own);
        return VertexFault { snap_is_outside: !is_rejected_alike, ..Default::default() };
    };
    let ([_, _, sz, sw], errors) = vertex_evaluator.clip_errors(corner);
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
        vertex_evaluator.wander(corner, nearest) * half_size(view).map(f64::from).into_iter().fold(0.0, f64::max)
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
