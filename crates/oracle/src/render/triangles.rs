//! Triangle assembly: which triangles and clipped triangles are drawn, oriented clockwise
//! (`docs/exactness.md` §3).

use rayon::prelude::*;

use super::{
    super::{arithmetic::edge::doubled_area, point::Shown, shot::Shot},
    clip::is_cut,
};
use crate::{
    effects::hooks::Shape,
    frame::{ClippedTriangle, Counters, Geometry, SnappedVertex, vertex_flags},
    scene::draw::{Draw, totals},
    work::{Canceled, checkpoint},
};

/// A triangle to be drawn, wound clockwise on the screen (positive doubled area with y down).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedTriangle {
    /// Global triangle id; a clipped triangle has its parent's.
    pub id: u32,
    pub corners: [SnappedVertex; 3],
    /// Index among all triangles followed by all clipped triangles.
    pub entry: usize,
    /// The last two corners were exchanged to wind the triangle clockwise.
    pub is_turned: bool,
    /// It is the triangle about a point: where that lies, and what of it is shown.
    pub point: Option<([i64; 2], Shown)>,
}

impl OrientedTriangle {
    /// A whole triangle whose corners already run clockwise.
    pub fn clockwise(id: u32, corners: [SnappedVertex; 3]) -> Self {
        Self {
            id,
            corners,
            entry: id as usize,
            is_turned: false,
            point: None,
        }
    }

    /// Returns true for a triangle that clipping made.
    pub fn is_clipped(&self) -> bool {
        self.entry != self.id as usize
    }

    /// Values of the corners in the order of the file, given those of the oriented corners; the
    /// same the other way round.
    pub fn in_file_order<T>(&self, mut corners: [T; 3]) -> [T; 3] {
        if self.is_turned {
            corners.swap(1, 2);
        }
        corners
    }
}

/// The triangles and clipped triangles to be drawn, and counts of those that are not, decided from
/// the records alone.
///
/// Clipped triangles replace their parent. One that has no area, or that runs against the sum of
/// its parent's clipped triangles, flipped in the snap and is dropped.
pub fn triangles(
    shot: &Shot,
    geometry: &Geometry,
) -> Result<(Vec<OrientedTriangle>, Counters), Canceled> {
    const CHUNK: u32 = 1 << 16;
    let mut clipped: Vec<(usize, &ClippedTriangle)> =
        geometry.clipped_triangles.iter().enumerate().collect();
    clipped.sort_by_key(|(_, triangle)| triangle.parent);
    let clipped_entries = totals(shot.scene, shot.draws)[1] as usize;
    let mut drawn = Vec::new();
    let mut counters = Counters::default();
    let checkpoint = checkpoint();
    for draw in shot.draws {
        let ids = draw.first_triangle
            ..draw.first_triangle + shot.scene.primitives[draw.primitive].triangle_count();
        let starts: Vec<u32> = ids.clone().step_by(CHUNK as usize).collect();
        let chunk = |start: u32| {
            checkpoint.pass()?;
            let (drawn, counters) = (Vec::new(), Counters::default());
            let mut assembly = Assembly {
                shot,
                draw,
                geometry,
                clipped: &clipped,
                clipped_entries,
                drawn,
                counters,
            };
            (start..ids.end.min(start.saturating_add(CHUNK))).for_each(|id| assembly.triangle(id));
            Ok((assembly.drawn, assembly.counters))
        };
        for (triangles, counts) in starts
            .into_par_iter()
            .map(chunk)
            .collect::<Result<Vec<_>, Canceled>>()?
        {
            drawn.extend(triangles);
            counters.rejected_nonfinite += counts.rejected_nonfinite;
            counters.rejected_range += counts.rejected_range;
            counters.degenerate += counts.degenerate;
            counters.clipped += counts.clipped;
            counters.flipped_clips += counts.flipped_clips;
        }
    }
    Ok((drawn, counters))
}

/// Assembly of a run of triangles of one draw.
struct Assembly<'a> {
    shot: &'a Shot<'a>,
    draw: &'a Draw,
    geometry: &'a Geometry,
    /// Sorted by parent, each with its index in the geometry.
    clipped: &'a [(usize, &'a ClippedTriangle)],
    /// Entry of the first clipped triangle: the number of triangles of the scene.
    clipped_entries: usize,
    drawn: Vec<OrientedTriangle>,
    counters: Counters,
}

impl Assembly<'_> {
    fn triangle(&mut self, id: u32) {
        let corners = self.shot.corner_records(self.draw, self.geometry, id);
        let flags = corners.map(|corner| corner.flags);
        let any = flags[0] | flags[1] | flags[2];
        if any & vertex_flags::NONFINITE != 0 {
            self.counters.rejected_nonfinite += 1;
        } else if any & vertex_flags::OUT_OF_RANGE != 0 {
            self.counters.rejected_range += 1;
        } else if is_cut(flags) {
            self.counters.clipped += 1;
            self.clipped(id);
        } else if any == 0 {
            match doubled_area(&corners) {
                // A point or line whose corners an effect draws shows its front.
                0 if self.shot.draws_corners(self.draw) => {
                    let area = if self.draw.mirrored { 1 } else { -1 };
                    self.oriented(id, id as usize, corners, area);
                }
                0 => self.counters.degenerate += 1,
                area => self.oriented(id, id as usize, corners, area),
            }
        }
    }

    /// [`OrientedTriangle::point`]. A box is filled as that of any triangle.
    fn point(&self, id: u32) -> Option<([i64; 2], Shown)> {
        let Shot { stack, .. } = self.shot;
        if !self.shot.draws_points(self.draw) || stack.shape() != Shape::Triangles {
            return None;
        }
        let [index, ..] = self.shot.corner_indices(self.draw, self.geometry, id);
        let record = &self.geometry.vertices[index];
        let shown = Shown::of(record, self.draw, self.geometry.subpixel_bits);
        Some(([record.x.into(), record.y.into()], shown))
    }

    /// Draws the clipped triangles of `parent`.
    fn clipped(&mut self, parent: u32) {
        let from = self
            .clipped
            .partition_point(|(_, triangle)| triangle.parent < parent);
        let fan = self.clipped[from..]
            .iter()
            .take_while(|(_, triangle)| triangle.parent == parent);
        let areas: Vec<_> = fan
            .map(|(index, triangle)| {
                (
                    self.clipped_entries + index,
                    triangle.corners,
                    doubled_area(&triangle.corners),
                )
            })
            .collect();
        let facing = areas.iter().map(|(_, _, area)| area).sum::<i64>().signum();
        for (entry, corners, area) in areas {
            if area == 0 || area.signum() != facing {
                self.counters.flipped_clips += 1;
            } else {
                self.oriented(parent, entry, corners, area);
            }
        }
    }

    /// Draws a triangle, wound clockwise, unless it shows the back of a single-sided material, or
    /// glass to a light, which passes through it.
    fn oriented(&mut self, id: u32, entry: usize, corners: [SnappedVertex; 3], area: i64) {
        let passes_light = self.shot.view.is_light() && self.draw.is_glass;
        if passes_light || is_back(area, self.draw) && !self.draw.double_sided {
            return;
        }
        let mut triangle = OrientedTriangle {
            id,
            corners,
            entry,
            is_turned: area < 0,
            point: self.point(id),
        };
        triangle.corners = triangle.in_file_order(corners);
        self.drawn.push(triangle);
    }
}

/// Returns true for the back of a triangle. The front of a glTF triangle runs counterclockwise on
/// the screen, unless its transform mirrors it.
pub fn is_back(area: i64, draw: &Draw) -> bool {
    (area > 0) != draw.mirrored
}
