//! Dots: where every one of them lies, how strong it is, and what of each pixel it covers; and the judgement of those that an
//! adapter placed.

use rayon::prelude::*;

use super::{
    judge::{ULP, snap_bound},
    moved::{Corner, VertexEvaluator},
    project::{Clip, snap_inside},
};
use crate::{
    effects::{
        Stack,
        dots::{Dots, FULL, LineSource, MAX_DOTS},
    },
    frame::{SnappedVertex, vertex_flags},
    math::{GUARD_BAND, SUBPIXEL_BITS, rounded_columns},
    measure::ErrorReport,
    scene::{
        Scene,
        draw::{Draw, DrawError},
        lines::{Lines, Segment, SegmentEnds},
        view::View,
    },
};

/// A point in clip space, and how far a float renderer may be from it, per coordinate.
#[derive(Clone, Copy)]
struct Bounded {
    at: [f64; 4],
    error: [f64; 4],
}

/// All dots of a picture.
struct Strings<'a> {
    movers: Vec<VertexEvaluator<'a>>,
    lines: Lines,
    clip_from_scene: [[f64; 4]; 4],
    /// Segment of every dot, and which share of it lies before the dot.
    dots: Vec<(u32, f64)>,
}

impl<'a> Strings<'a> {
    fn new(scene: &'a Scene, draws: &'a [Draw], view: &'a View, stack: &'a Stack, dots: &Dots) -> Result<Self, DrawError> {
        let lines = match LineSource::of(dots.lines) {
            LineSource::Edges => Lines::edges(scene, None)?,
            LineSource::Creases => Lines::edges(scene, Some(dots.crease_deg.into()))?,
            LineSource::Polyline => Lines::polyline(&view.scene_state.polyline),
        };
        let count = |line: &[Segment]| line.last().map_or(0, |last| dots.count(last.start_m + last.length_m));
        let all: u64 = lines.each().map(|(_, line)| count(line)).sum();
        if all > MAX_DOTS {
            return Err(DrawError::TooMany { what: "dots", count: all, limit: MAX_DOTS });
        }
        let mut placed = Vec::with_capacity(all as usize);
        for (first, line) in lines.each() {
            placed.extend((0..count(line)).map(|dot| {
                let at_m = dot as f64 * f64::from(dots.spacing_m);
                let segment = line.partition_point(|segment| segment.start_m <= at_m) - 1;
                let share = (at_m - line[segment].start_m) / line[segment].length_m;
                ((first + segment) as u32, share.min(1.0))
            }));
        }
        let clip_from_scene =
            rounded_columns(&(view.clip_from_world * view.scene_state.world_from_scene)).map(|column| column.map(f64::from));
        let movers = draws.iter().map(|draw| VertexEvaluator::new(scene, draw, view, stack)).collect();
        Ok(Self { movers, lines, clip_from_scene, dots: placed })
    }

    /// Both ends of every segment; none where one of them was refused.
    fn ends(&self, has_errors: bool) -> Vec<Option<[Bounded; 2]>> {
        let edge = |vertex_evaluator: &VertexEvaluator, corner: Corner| {
            let Clip { x, y, z, w } = vertex_evaluator.clip(corner).ok()?;
            Some(Bounded { at: [x, y, z, w], error: if has_errors { vertex_evaluator.clip_errors(corner).1 } else { [0.0; 4] } })
        };
        let of = |segment: &Segment| match segment.ends {
            SegmentEnds::Edge { draw, vertices: [a, b], triangle } => {
                let vertex_evaluator = &self.movers[draw as usize];
                Some([edge(vertex_evaluator, Corner { vertex: a, triangle })?, edge(vertex_evaluator, Corner { vertex: b, triangle })?])
            }
            SegmentEnds::Points(points) => Some(points.map(|point| self.point(point))),
        };
        self.lines.segments.par_iter().map(of).collect()
    }

    fn point(&self, [x, y, z]: [f32; 3]) -> Bounded {
        let terms = [0, 1, 2, 3].map(|row| {
            let m = |column: usize| self.clip_from_scene[column][row];
            [m(0) * f64::from(x), m(1) * f64::from(y), m(2) * f64::from(z), m(3)]
        });
        Bounded {
            at: terms.map(|row| row.iter().sum()),
            error: terms.map(|row| 4.0 * ULP * row.iter().map(|term| term.abs()).sum::<f64>()),
        }
    }
}

/// Between two points; nowhere where there are none.
fn between(ends: &Option<[Bounded; 2]>, share: f64) -> Option<Bounded> {
    let [a, b] = ends.as_ref()?;
    let mix = |a: f64, b: f64| a + (b - a) * share;
    let lane = |r: usize| mix(a.at[r], b.at[r]);
    // Both ends' errors, those of the share and of mixing.
    let error = |r: usize| mix(a.error[r], b.error[r]) + 8.0 * ULP * (a.at[r].abs() + b.at[r].abs());
    Some(Bounded { at: [0, 1, 2, 3].map(lane), error: [0, 1, 2, 3].map(error) })
}

/// The grid of dots is that of 1/256 px, whatever triangles snap to.
fn grid(view: &View) -> View {
    view.with_grid(SUBPIXEL_BITS, view.precision.is_relative)
}

fn snapped(dot: &Option<Bounded>, view: &View) -> SnappedVertex {
    match dot.map(|dot| dot.at) {
        Some([x, y, z, w]) if z <= w && w > 0.0 && z >= 0.0 => snap_inside(&Clip { x, y, z, w }, view),
        _ => SnappedVertex { flags: vertex_flags::NEAR, ..SnappedVertex::default() },
    }
}

/// The record of every dot; none without dots.
///
/// # Errors
/// When there are too many.
pub fn dot_records(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack) -> Result<Vec<SnappedVertex>, DrawError> {
    let Some(dots) = stack.dots() else { return Ok(Vec::new()) };
    let strings = Strings::new(scene, draws, view, stack, &dots)?;
    let (ends, grid) = (strings.ends(false), grid(view));
    Ok(strings.dots.par_iter().map(|&(segment, share)| snapped(&between(&ends[segment as usize], share), &grid)).collect())
}

/// Strength of the strongest dot on every pixel, given the records of all dots and the nearest depth keys; empty without dots.
pub fn dot_strengths(view: &View, stack: &Stack, records: &[SnappedVertex], keys: &[u32]) -> Vec<u32> {
    let Some(dots) = stack.dots() else { return Vec::new() };
    let (fade_from, reach) = (dots.fade_from(view), i64::from(dots.radius()) + 128);
    let mut strengths = vec![0; view.pixels()];
    for (number, record) in records.iter().enumerate() {
        let strength = dots.strength(number as u32, record.inv_w.to_bits(), fade_from);
        if record.flags != 0 || strength == 0 {
            continue;
        }
        let (x, y) = (i64::from(record.x), i64::from(record.y));
        // A pixel more on each side than a dot reaches.
        let pixels = |at: i64, side: u32| ((at - reach) / 256 - 1).max(0)..=((at + reach) / 256 + 1).min(i64::from(side) - 1);
        for py in pixels(y, view.height) {
            for px in pixels(x, view.width) {
                let (dx, dy) = ((256 * px + 128).abs_diff(x), (256 * py + 128).abs_diff(y));
                let at = py as usize * view.width as usize + px as usize;
                let is_seen = keys[at] == 0 || u64::from(record.depth.to_bits()) + u64::from(dots.bias_steps()) >= u64::from(keys[at]);
                let share = if is_seen { FULL } else { dots.hidden_share() };
                let covered = strength * dots.cover(dx * dx + dy * dy) / FULL;
                strengths[at] = strengths[at].max(covered * share / FULL);
            }
        }
    }
    strengths
}

/// Holds the dots that an adapter placed against the reference and its bound, and the strengths on its pixels, which are
/// integers, against what follows from its own records.
///
/// # Errors
/// When there are too many.
pub(super) fn judge(
    accuracy: &mut ErrorReport,
    (scene, draws, view, stack): (&Scene, &[Draw], &View, &Stack),
    records: &[SnappedVertex],
    [strengths, expected]: [&[u32]; 2],
) -> Result<(), DrawError> {
    let Some(dots) = stack.dots() else { return Ok(()) };
    let strings = Strings::new(scene, draws, view, stack, &dots)?;
    assert_eq!(records.len(), strings.dots.len(), "the dots are of another scene");
    let (ends, grid) = (strings.ends(true), grid(view));
    let is_outside = |(record, &(segment, share)): (&SnappedVertex, &(u32, f64))| {
        let dot = between(&ends[segment as usize], share);
        !is_within(record, &dot, &snapped(&dot, &grid), &grid)
    };
    accuracy.dots = records.len() as u64;
    accuracy.dots_outside_bound = records.par_iter().zip(&strings.dots).filter(|pair| is_outside(*pair)).count() as u64;
    accuracy.dot_pixels_wrong = strengths.iter().zip(expected).filter(|(a, b)| a != b).count() as u64;
    accuracy.dot_pixels_wrong += strengths.len().abs_diff(expected.len()) as u64;
    Ok(())
}

/// Does a record lie as near to its reference as rounding allows? What rounding may carry anywhere always does.
fn is_within(record: &SnappedVertex, dot: &Option<Bounded>, own: &SnappedVertex, view: &View) -> bool {
    let Some(Bounded { at: [x, y, z, w], error }) = *dot else { return record.flags == own.flags };
    let [_, _, ez, ew] = error;
    let clip = Clip { x, y, z, w };
    let is_doubtful = (w - z).abs() <= ez + ew || z.abs() <= ez && z != 0.0 || w <= ew && w > -ew;
    let is_kept = (record.flags | own.flags) & vertex_flags::NEAR == 0;
    let Some(bounds) = snap_bound(&clip, error, view).filter(|_| w > 0.0) else {
        // Where w is hardly known, what the near plane keeps may lie anywhere before the eye.
        let is_before = record.inv_w > 0.0 && (0.0..=1.0 + 8.0 * ULP).contains(&f64::from(record.depth));
        return is_doubtful || if is_kept { is_before } else { record.flags == own.flags };
    };
    let [bound_x, bound_y] = bounds.map(|bound| if bound < 1.0 { 1.0 } else { (1.0 + bound).floor() });
    if record.flags != own.flags {
        let reference = placed_freely(&clip, view);
        let is_at_guard = [(reference[0], bound_x), (reference[1], bound_y)]
            .into_iter()
            .any(|(at, bound)| (at.abs() - f64::from(GUARD_BAND)).abs() <= bound + 1.0);
        return is_doubtful || is_kept && is_at_guard;
    }
    if own.flags & vertex_flags::NEAR != 0 {
        return true;
    }
    let w_error = (ew + ULP * w) / w + 4.5 * ULP;
    let depth_error = (ez + ULP * z.abs()) / w + (z / w).abs() * w_error + f64::from(f32::MIN_POSITIVE);
    let is_near = own.flags != 0 || f64::from(record.x.abs_diff(own.x)) <= bound_x && f64::from(record.y.abs_diff(own.y)) <= bound_y;
    is_near && (f64::from(record.inv_w) * w - 1.0).abs() <= w_error && (f64::from(record.depth) - z / w).abs() <= depth_error
}

/// Where a point lies in units, however far outside.
fn placed_freely(clip: &Clip, view: &View) -> [f64; 2] {
    let [half_x, half_y] = [view.width, view.height].map(|pixels| 128.0 * f64::from(pixels));
    [half_x + clip.x / clip.w * half_x, half_y - clip.y / clip.w * half_y]
}
