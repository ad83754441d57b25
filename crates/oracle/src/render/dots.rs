//! Dots along lines: where each one lies, how strong it is, and which part of each pixel it covers
//! (`docs/exactness.md` §7).

use rayon::prelude::*;

use super::{
    super::shot::Shot,
    snap::{ClipPosition, snap_inside},
    vertex::{Corner, VertexEvaluator},
};
use crate::{
    effects::{
        Stack,
        dots::{Dots, FULL, LineSource, MAX_DOTS},
    },
    frame::{SnappedVertex, vertex_flags},
    math::{SUBPIXEL_BITS, rounded_columns},
    scene::{
        draw::DrawError,
        lines::{Lines, Segment, SegmentEnds},
        view::View,
    },
};

/// A dot on a segment of a line.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    pub segment: u32,
    /// Where it lies on the segment, from 0 to 1.
    pub fraction: f64,
}

/// All lines and dots of a picture.
pub struct DotPlacement<'a> {
    pub evaluators: Vec<VertexEvaluator<'a>>,
    pub lines: Lines,
    /// Rounded to f32 once.
    pub clip_from_scene: [[f64; 4]; 4],
    pub dots: Vec<Dot>,
}

impl<'a> DotPlacement<'a> {
    /// Errors: [`DrawError::TooMany`] for more than [`MAX_DOTS`] dots.
    pub fn new(shot: &Shot<'a>, dots: &Dots) -> Result<Self, DrawError> {
        let Shot {
            scene,
            draws,
            view,
            stack,
        } = *shot;
        let lines = match LineSource::of(dots.lines) {
            LineSource::Edges => Lines::edges(scene, None)?,
            LineSource::Creases => Lines::edges(scene, Some(dots.crease_deg.into()))?,
            LineSource::Polyline => Lines::polyline(&view.scene_state.polyline),
        };
        let row = |line: &[Segment]| {
            line.last()
                .map(|last| dots.row(last.start_m + last.length_m))
        };
        let all = lines.each().fold(0u64, |sum, (_, line)| {
            sum.saturating_add(row(line).map_or(0, |row| row.count()))
        });
        if all > MAX_DOTS {
            return Err(DrawError::TooMany {
                what: "dots",
                count: all,
                limit: MAX_DOTS,
            });
        }
        let mut placed = Vec::with_capacity(all as usize);
        for (first, line) in lines.each() {
            let Some(row) = row(line) else { continue };
            placed.extend((0..row.count()).map(|dot| {
                let at_m = row.place_m(dot);
                let segment = line.partition_point(|segment| segment.start_m <= at_m) - 1;
                let fraction = (at_m - line[segment].start_m) / line[segment].length_m;
                Dot {
                    segment: (first + segment) as u32,
                    fraction: fraction.min(1.0),
                }
            }));
        }
        let clip_from_scene =
            rounded_columns(&(view.clip_from_world * view.scene_state.world_from_scene))
                .map(|column| column.map(f64::from));
        let evaluators = draws
            .iter()
            .map(|draw| VertexEvaluator::new(scene, draw, view, stack))
            .collect();
        Ok(Self {
            evaluators,
            lines,
            clip_from_scene,
            dots: placed,
        })
    }

    /// Both ends of every segment; none if one of them is refused.
    fn ends(&self) -> Vec<Option<[ClipPosition; 2]>> {
        let of = |segment: &Segment| match segment.ends {
            SegmentEnds::Edge {
                draw,
                vertices,
                triangle,
            } => {
                let [a, b] = vertices.map(|vertex| {
                    self.evaluators[draw as usize]
                        .clip(Corner { vertex, triangle })
                        .ok()
                });
                a.zip(b).map(|(a, b)| [a, b])
            }
            SegmentEnds::Points(points) => Some(points.map(|point| self.point(point))),
        };
        self.lines.segments.par_iter().map(of).collect()
    }

    /// A point of a polyline in clip space.
    fn point(&self, point: [f32; 3]) -> ClipPosition {
        let [x, y, z, w] = self.point_terms(point).map(|terms| terms.iter().sum());
        ClipPosition { x, y, z, w }
    }

    /// The terms of its coordinates.
    pub fn point_terms(&self, [x, y, z]: [f32; 3]) -> [[f64; 4]; 4] {
        [0, 1, 2, 3].map(|row| {
            let m = |column: usize| self.clip_from_scene[column][row];
            [
                m(0) * f64::from(x),
                m(1) * f64::from(y),
                m(2) * f64::from(z),
                m(3),
            ]
        })
    }

    /// Every dot in clip space; none if an end of its segment is refused.
    pub fn positions(&self) -> Vec<Option<ClipPosition>> {
        let ends = self.ends();
        self.dots
            .par_iter()
            .map(|dot| {
                ends[dot.segment as usize]
                    .as_ref()
                    .map(|ends| between(ends, dot.fraction))
            })
            .collect()
    }
}

/// A point between two.
fn between([a, b]: &[ClipPosition; 2], fraction: f64) -> ClipPosition {
    let mix = |a: f64, b: f64| a + (b - a) * fraction;
    ClipPosition {
        x: mix(a.x, b.x),
        y: mix(a.y, b.y),
        z: mix(a.z, b.z),
        w: mix(a.w, b.w),
    }
}

/// The view with the grid of dots, which is that of 1/256 px even if triangles snap to another.
pub fn dot_grid(view: &View) -> View {
    view.with_grid(SUBPIXEL_BITS, view.precision.is_relative)
}

/// The record of a dot.
pub fn snapped(dot: Option<&ClipPosition>, grid: &View) -> SnappedVertex {
    match dot {
        Some(dot) if dot.z <= dot.w && dot.w > 0.0 && dot.z >= 0.0 => snap_inside(dot, grid),
        _ => SnappedVertex {
            flags: vertex_flags::NEAR,
            ..SnappedVertex::default()
        },
    }
}

/// The record of every dot; empty without dots.
/// Errors: [`DrawError::TooMany`] for more than [`MAX_DOTS`] dots.
pub fn dot_records(shot: &Shot) -> Result<Vec<SnappedVertex>, DrawError> {
    let Some(dots) = shot.stack.dots() else {
        return Ok(Vec::new());
    };
    let grid = dot_grid(shot.view);
    Ok(DotPlacement::new(shot, &dots)?
        .positions()
        .par_iter()
        .map(|dot| snapped(dot.as_ref(), &grid))
        .collect())
}

/// Strength of the strongest dot on every pixel, given the records of all dots and the nearest
/// depth keys; empty without dots.
pub fn dot_strengths(
    view: &View,
    stack: &Stack,
    records: &[SnappedVertex],
    keys: &[u32],
) -> Vec<u32> {
    let Some(dots) = stack.dots() else {
        return Vec::new();
    };
    let (fade_from, reach) = (dots.fade_from(view), i64::from(dots.radius()) + 128);
    let mut strengths = vec![0; view.pixels()];
    for (number, record) in records.iter().enumerate() {
        let strength = dots.strength(number as u32, record.inv_w.to_bits(), fade_from);
        if record.flags != 0 || strength == 0 {
            continue;
        }
        let (x, y) = (i64::from(record.x), i64::from(record.y));
        // One pixel more on each side than a dot reaches.
        let pixels = |at: i64, side: u32| {
            ((at - reach) / 256 - 1).max(0)..=((at + reach) / 256 + 1).min(i64::from(side) - 1)
        };
        for py in pixels(y, view.height) {
            for px in pixels(x, view.width) {
                let (dx, dy) = ((256 * px + 128).abs_diff(x), (256 * py + 128).abs_diff(y));
                let at = py as usize * view.width as usize + px as usize;
                let is_seen = keys[at] == 0
                    || u64::from(record.depth.to_bits()) + u64::from(dots.bias_steps())
                        >= u64::from(keys[at]);
                let opacity = if is_seen { FULL } else { dots.hidden_share() };
                let covered = strength * dots.cover(dx * dx + dy * dy) / FULL;
                strengths[at] = strengths[at].max(covered * opacity / FULL);
            }
        }
    }
    strengths
}
