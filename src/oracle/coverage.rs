//! Who owns each sample: exact integer coverage and the depth that decides between triangle ids.
//!
//! A sample on an edge belongs to the side onto which it falls when moved by an infinitesimal step to the right and a far
//! smaller one down: the top-left rule, stated without a bias. Every pixel of a triangle's box is evaluated afresh.

use std::ops::Range;

use rayon::prelude::*;

use super::{clip::is_cut, rules::SampleTests, strict::integer_key};
use crate::{
    effects::hooks::Shape,
    frame::{ClippedTriangle, Counters, Geometry, NO_TRIANGLE, SnappedVertex, vertex_flags},
    math::SMALL_EXTENT,
    scene::{
        Scene,
        draw::{Draw, totals},
        view::View,
    },
};

/// A triangle to be drawn, wound clockwise on screen (positive doubled area with y down).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedTriangle {
    /// Global triangle id; a piece has its parent's.
    pub id: u32,
    pub corners: [SnappedVertex; 3],
    /// Place among all triangles and, behind them, pieces.
    pub entry: usize,
    /// The last two corners were exchanged to wind it clockwise.
    pub is_turned: bool,
}

impl OrientedTriangle {
    /// A whole triangle whose corners run clockwise as they are.
    pub fn clockwise(id: u32, corners: [SnappedVertex; 3]) -> Self {
        Self { id, corners, entry: id as usize, is_turned: false }
    }
}

/// What lies on the sample of one pixel.
///
/// A float depth key may lie anywhere in the interval [low, high] round the f64 depth: its relative bound
/// ([`depth_bound`]), cut to the depths of the triangle's corners, to which every renderer clamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Nearest triangle, the smaller id at equal keys; [`NO_TRIANGLE`] without one.
    pub triangle_id: u32,
    /// Bits of the triangle id's depth rounded to f32, at least 1; 0 without an triangle id.
    pub key: u32,
    /// Drawn triangles and pieces that cover the sample, in front or behind.
    pub layers: u32,
    /// Interval of the triangle id's depth.
    pub interval: [f64; 2],
    /// Largest high end among the other triangle ids.
    pub rival: f64,
    /// Largest low end of all: what reaches less far is certainly hidden.
    pub floor: f64,
    /// Interval of the triangle id that somebody claims for this pixel, if it covers the sample.
    pub claimed: Option<[f64; 2]>,
}

impl Sample {
    const EMPTY: Self = Self {
        triangle_id: NO_TRIANGLE,
        key: 0,
        layers: 0,
        interval: [f64::NEG_INFINITY; 2],
        rival: f64::NEG_INFINITY,
        floor: f64::NEG_INFINITY,
        claimed: None,
    };

    /// Do two triangle ids lie so close that a float key may prefer either?
    pub fn is_band(&self) -> bool {
        self.layers > 1 && self.rival > self.interval[0]
    }

    /// May the claimed triangle id be in front? It must cover the sample and reach past whatever certainly does.
    pub fn claim_is_possible(&self) -> bool {
        self.claimed.is_some_and(|[_, high]| high >= self.floor)
    }

    fn add(&mut self, id: u32, depth: f64, interval: [f64; 2], claim: u32) {
        self.layers += 1;
        self.floor = self.floor.max(interval[0]);
        if id == claim {
            self.claimed = Some(interval);
        }
        let key = depth_key(depth);
        let wins = key > self.key || key == self.key && id < self.triangle_id;
        let loser = if wins { self.interval[1] } else { interval[1] };
        if id != self.triangle_id {
            self.rival = self.rival.max(loser);
        }
        if wins {
            (self.triangle_id, self.key, self.interval) = (id, key, interval);
        }
    }
}

/// One [`Sample`] per pixel, row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage {
    pub samples: Vec<Sample>,
}

impl Coverage {
    pub fn triangle_ids(&self) -> Vec<u32> {
        self.samples.iter().map(|sample| sample.triangle_id).collect()
    }

    pub fn keys(&self) -> Vec<u32> {
        self.samples.iter().map(|sample| sample.key).collect()
    }

    pub fn layers(&self) -> Vec<u32> {
        self.samples.iter().map(|sample| sample.layers).collect()
    }
}

/// Twice the area of a snapped triangle; positive when it runs clockwise on screen.
pub(super) fn doubled_area([a, b, c]: &[SnappedVertex; 3]) -> i64 {
    edge(a, b, i64::from(c.x), i64::from(c.y))
}

/// Twice the area of (a, b, point): positive on the inner side of an edge of a clockwise triangle.
fn edge(a: &SnappedVertex, b: &SnappedVertex, x: i64, y: i64) -> i64 {
    let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(i64::from);
    (bx - ax) * (y - ay) - (by - ay) * (x - ax)
}

/// Draw with triangle `id`; draws without triangles have none. None when there is no such triangle.
pub(super) fn draw_of<'a>(scene: &Scene, draws: &'a [Draw], id: u32) -> Option<&'a Draw> {
    let draw = &draws[..draws.partition_point(|draw| draw.first_triangle <= id)].last()?;
    (id - draw.first_triangle < scene.primitives[draw.primitive].triangle_count()).then_some(draw)
}

/// Corner records of triangle `id` of `draw`, in the order of the file.
pub(super) fn corner_records(scene: &Scene, draw: &Draw, geometry: &Geometry, id: u32) -> [SnappedVertex; 3] {
    corner_places(scene, draw, geometry, id).map(|at| geometry.vertices[at])
}

/// Where the corner records of triangle `id` of `draw` stand.
pub(super) fn corner_places(scene: &Scene, draw: &Draw, geometry: &Geometry, id: u32) -> [usize; 3] {
    if geometry.has_unshared_vertices {
        return [0, 1, 2].map(|k| 3 * id as usize + k);
    }
    let corners = scene.primitives[draw.primitive].corners(scene, id - draw.first_triangle);
    corners.map(|corner| (draw.first_vertex + corner) as usize)
}

/// The triangles and pieces to be drawn, with a count of those that are not.
///
/// Decided from the records alone. Cut parents are replaced by their pieces; a piece that has no area or runs against
/// the sum of its parent's pieces is a fold.
pub fn triangles(scene: &Scene, draws: &[Draw], geometry: &Geometry) -> (Vec<OrientedTriangle>, Counters) {
    const CHUNK: u32 = 1 << 16;
    let mut pieces: Vec<(usize, &ClippedTriangle)> = geometry.pieces.iter().enumerate().collect();
    pieces.sort_by_key(|(_, piece)| piece.parent);
    let whole = totals(scene, draws)[1] as usize;
    let mut drawn = Vec::new();
    let mut counters = Counters::default();
    for draw in draws {
        let ids = draw.first_triangle..draw.first_triangle + scene.primitives[draw.primitive].triangle_count();
        let starts: Vec<u32> = ids.clone().step_by(CHUNK as usize).collect();
        let chunk = |start: u32| {
            let mut assembly = Assembly { scene, draw, geometry, pieces: &pieces, whole, drawn: Vec::new(), counters: Counters::default() };
            (start..ids.end.min(start.saturating_add(CHUNK))).for_each(|id| assembly.triangle(id));
            (assembly.drawn, assembly.counters)
        };
        for (triangles, counts) in starts.into_par_iter().map(chunk).collect::<Vec<_>>() {
            drawn.extend(triangles);
            counters.rejected_nonfinite += counts.rejected_nonfinite;
            counters.rejected_range += counts.rejected_range;
            counters.degenerate += counts.degenerate;
            counters.clipped += counts.clipped;
            counters.flipped_clips += counts.flipped_clips;
        }
    }
    (drawn, counters)
}

/// Assembly of a run of triangles of one draw.
struct Assembly<'a> {
    scene: &'a Scene,
    draw: &'a Draw,
    geometry: &'a Geometry,
    /// Sorted by parent, each with its place in the geometry.
    pieces: &'a [(usize, &'a ClippedTriangle)],
    /// Triangles of the scene, before the pieces among the entries.
    whole: usize,
    drawn: Vec<OrientedTriangle>,
    counters: Counters,
}

impl Assembly<'_> {
    fn triangle(&mut self, id: u32) {
        let corners = corner_records(self.scene, self.draw, self.geometry, id);
        let flags = corners.map(|corner| corner.flags);
        let any = flags[0] | flags[1] | flags[2];
        if any & vertex_flags::NONFINITE != 0 {
            self.counters.rejected_nonfinite += 1;
        } else if any & vertex_flags::OUT_OF_RANGE != 0 {
            self.counters.rejected_range += 1;
        } else if is_cut(flags) {
            self.counters.clipped += 1;
            self.fan(id);
        } else if any == 0 {
            match doubled_area(&corners) {
                0 => self.counters.degenerate += 1,
                area => self.oriented(id, id as usize, corners, area),
            }
        }
    }

    fn fan(&mut self, parent: u32) {
        let from = self.pieces.partition_point(|(_, piece)| piece.parent < parent);
        let fan = self.pieces[from..].iter().take_while(|(_, piece)| piece.parent == parent);
        let areas: Vec<_> = fan.map(|(place, piece)| (self.whole + place, piece.corners, doubled_area(&piece.corners))).collect();
        let facing = areas.iter().map(|(_, _, area)| area).sum::<i64>().signum();
        for (entry, corners, area) in areas {
            if area == 0 || area.signum() != facing {
                self.counters.flipped_clips += 1;
            } else {
                self.oriented(parent, entry, corners, area);
            }
        }
    }

    /// Keeps a triangle unless it shows the back of a single-sided material, turned clockwise.
    fn oriented(&mut self, id: u32, entry: usize, mut corners: [SnappedVertex; 3], area: i64) {
        if is_back(area, self.draw) && !self.draw.double_sided {
            return;
        }
        if area < 0 {
            corners.swap(1, 2);
        }
        self.drawn.push(OrientedTriangle { id, corners, entry, is_turned: area < 0 });
    }
}

/// The front of a glTF triangle runs counterclockwise on screen, unless its placement mirrors it.
pub(super) fn is_back(area: i64, draw: &Draw) -> bool {
    (area > 0) != draw.mirrored
}

/// Finds what lies on every sample of `view`; `claims`, if given, names an triangle id per pixel to be examined.
pub fn cover(triangles: &[OrientedTriangle], view: &View, claims: Option<&[u32]>) -> Coverage {
    cover_with(&SampleTests::default(), triangles, view, claims)
}

/// The same, where `rules` may leave samples out.
pub fn cover_with(rules: &SampleTests, triangles: &[OrientedTriangle], view: &View, claims: Option<&[u32]>) -> Coverage {
    let mut samples = vec![Sample::EMPTY; view.pixels()];
    scatter(rules, triangles, view, &mut samples, |triangle| {
        move |sample: &mut Sample, x: usize, y: usize, Hit { depth, interval }: Hit| {
            let claim = claims.map_or(NO_TRIANGLE, |claims| claims[y * view.width as usize + x]);
            sample.add(triangle.id, depth, interval, claim);
        }
    });
    Coverage { samples }
}

/// The nearest that covers a sample, by depth alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub depth: f64,
    /// Between which depths the key of a float renderer lies.
    pub interval: [f64; 2],
}

/// Finds the nearest depth on every sample of `view`; infinitely far where nothing is.
pub(super) fn cover_depths(rules: &SampleTests, triangles: &[OrientedTriangle], view: &View) -> Vec<Nearest> {
    let mut cells = vec![Nearest { depth: f64::NEG_INFINITY, interval: [f64::NEG_INFINITY; 2] }; view.pixels()];
    scatter(rules, triangles, view, &mut cells, |_| {
        |cell: &mut Nearest, _, _, hit: Hit| {
            cell.depth = cell.depth.max(hit.depth);
            // Whichever reaches farthest may be in front.
            cell.interval = [0, 1].map(|end| cell.interval[end].max(hit.interval[end]));
        }
    });
    cells
}

/// Where a triangle meets a sample: its depth, and the interval of float keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub depth: f64,
    pub interval: [f64; 2],
}

/// Visits every drawn sample of `view`, triangle by triangle, with the cell of its pixel; `visitor` makes a visit of each
/// triangle. Parallel by bands of rows, so a triangle may be visited more than once, each sample by one visit alone.
pub(super) fn scatter<'a, T: Send, V: FnMut(&mut T, usize, usize, Hit)>(
    rules: &SampleTests,
    triangles: &'a [OrientedTriangle],
    view: &View,
    cells: &mut [T],
    visitor: impl Fn(&'a OrientedTriangle) -> V + Sync,
) {
    const ROWS: usize = 8;
    let (width, height) = (view.width as usize, view.height as usize);
    if cells.is_empty() {
        return;
    }
    let mut bands = vec![Vec::new(); height.div_ceil(ROWS)];
    for triangle in triangles {
        let (_, rows) = triangle.bounds(view, rules);
        if !rows.is_empty() {
            bands[rows.start / ROWS..=(rows.end - 1) / ROWS]
                .iter_mut()
                .for_each(|band: &mut Vec<&'a OrientedTriangle>| band.push(triangle));
        }
    }
    cells.par_chunks_mut(ROWS * width).zip(bands).enumerate().for_each(|(band, (cells, triangles))| {
        let first_row = band * ROWS;
        for triangle in triangles {
            let (columns, rows) = triangle.bounds(view, rules);
            let mut visit = visitor(triangle);
            for y in rows.start.max(first_row)..rows.end.min(first_row + ROWS) {
                for x in columns.clone() {
                    let Some((depth, interval)) = triangle.at(x, y, rules) else { continue };
                    visit(&mut cells[(y - first_row) * width + x], x, y, Hit { depth, interval });
                }
            }
        }
    });
}

impl OrientedTriangle {
    /// Columns and rows of the pixels whose samples may be covered, within the view; none for a piece where corners are drawn.
    pub(super) fn bounds(&self, view: &View, rules: &SampleTests) -> (Range<usize>, Range<usize>) {
        if rules.shape == Shape::Points && self.entry != self.id as usize {
            return (0..0, 0..0);
        }
        // Pixel k has its sample in its middle.
        let unit = rules.unit;
        let range = |at: [i32; 3], pixels: u32| {
            let [low, high] = [at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2])].map(i64::from);
            let first = (low - rules.radius + unit / 2 - 1).div_euclid(unit).max(0);
            let end = ((high + rules.radius - unit / 2).div_euclid(unit) + 1).min(i64::from(pixels));
            first as usize..end.max(first) as usize
        };
        (range(self.corners.map(|c| c.x), view.width), range(self.corners.map(|c| c.y), view.height))
    }

    /// Depth of this triangle at the centre of a pixel, with the interval of float keys; none when nothing is drawn there.
    pub(super) fn at(&self, x: usize, y: usize, rules: &SampleTests) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = &self.corners;
        let [px, py] = [x, y].map(|k| rules.unit * k as i64 + rules.unit / 2);
        let opposite = [(b, c), (c, a), (a, b)];
        let weights = opposite.map(|(from, to)| edge(from, to, px, py));
        let exact = |depth: f32| (f64::from(depth), [f64::from(depth); 2]);
        let found = match rules.shape {
            Shape::Triangles => {
                let inside = |i: usize| owns(weights[i], opposite[i].1.x - opposite[i].0.x, opposite[i].1.y - opposite[i].0.y);
                let is_inside = inside(0) && inside(1) && inside(2);
                let depths = self.corners.map(|corner| corner.depth);
                // A key reads as a float that has it for bits.
                let integer = || exact(f32::from_bits(integer_key(depths, weights)));
                is_inside.then(|| if rules.integer_keys { integer() } else { self.depth(weights) })?
            }
            Shape::Boxes => self.fills_box(px, py).then(|| exact(self.corners.iter().fold(0.0, |nearest, c| c.depth.max(nearest))))?,
            Shape::Points => exact(self.corners[self.corner_under(px, py, rules.radius)?].depth),
        };
        rules.is_drawn(self, x as u32, y as u32, weights).then_some(found)
    }

    /// Is a point in the bounding box, left and top borders with it, right and bottom ones without?
    fn fills_box(&self, x: i64, y: i64) -> bool {
        let within = |at: [i32; 3], p: i64| at.iter().any(|&k| i64::from(k) <= p) && at.iter().any(|&k| p < i64::from(k));
        within(self.corners.map(|c| c.x), x) && within(self.corners.map(|c| c.y), y)
    }

    /// The nearest corner whose disc contains a point; of equally near ones the first in the order of the file.
    pub(super) fn corner_under(&self, x: i64, y: i64, radius: i64) -> Option<usize> {
        let contains = |corner: &SnappedVertex| {
            let (dx, dy) = (x - i64::from(corner.x), y - i64::from(corner.y));
            dx * dx + dy * dy <= radius * radius
        };
        let in_file_order = if self.is_turned { [0, 2, 1] } else { [0, 1, 2] };
        let under = in_file_order.into_iter().filter(|&k| contains(&self.corners[k]));
        under.reduce(|nearest, k| if self.corners[k].depth > self.corners[nearest].depth { k } else { nearest })
    }

    /// Depth is linear on screen: corner depths weighted by the doubled areas of the opposite parts, clamped to them.
    fn depth(&self, weights: [i64; 3]) -> (f64, [f64; 2]) {
        let z = self.corners.map(|corner| f64::from(corner.depth));
        let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        let [e0, e1, e2] = weights.map(|e| e as f64);
        let depth = ((e0 * z[0] + e1 * z[1] + e2 * z[2]) / (e0 + e1 + e2)).max(low).min(high);
        let error_bound = depth.abs() * depth_bound(&self.corners);
        (depth, [(depth - error_bound).max(low), (depth + error_bound).min(high)])
    }
}

/// Is a sample on the inner side of a directed edge (dx, dy), of which it is `e` away (doubled area, in units)?
///
/// It is moved by 2^-30 to the right and 2^-60 down, which no integer distance can outweigh: |e| < 2^63, |dx|, |dy| < 2^29.
pub fn owns(e: i64, dx: i32, dy: i32) -> bool {
    (i128::from(e) << 60) - (i128::from(dy) << 30) + i128::from(dx) > 0
}

/// Relative bound of a float depth key against the true depth: 8 or 12 steps of 2^-23, by the extent of the triangle.
pub fn depth_bound(corners: &[SnappedVertex; 3]) -> f64 {
    let extent = |at: [i32; 3]| at[0].max(at[1]).max(at[2]) - at[0].min(at[1]).min(at[2]);
    let is_small = extent(corners.map(|c| c.x)) <= SMALL_EXTENT && extent(corners.map(|c| c.y)) <= SMALL_EXTENT;
    (if is_small { 8.0 } else { 12.0 }) / f64::from(1 << 23)
}

/// Bits of a depth rounded to f32, which order as the depths do; at least 1, because 0 is an empty pixel.
pub(super) fn depth_key(depth: f64) -> u32 {
    if depth > 0.0 { (depth as f32).to_bits().max(1) } else { 1 }
}
