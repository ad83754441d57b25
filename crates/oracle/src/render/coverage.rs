//! What covers each sample: exact integer coverage, and the depth that chooses among triangles
//! (`docs/exactness.md` §3 and §6).
//!
//! Every pixel of a triangle's bounding box is evaluated on its own, so nothing depends on the
//! order of evaluation.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    super::arithmetic::{
        depth_key::{depth_key, integer_key},
        edge::{edge, owns},
    },
    sample_rules::SampleTests,
    triangles::OrientedTriangle,
};
use crate::{
    effects::hooks::Shape,
    frame::{NO_TRIANGLE, SnappedVertex},
    scene::view::View,
    work::{Canceled, checkpoint},
};

/// What is visible at the sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Nearest triangle, the smaller id at equal keys; [`NO_TRIANGLE`] without one.
    pub triangle_id: u32,
    /// Bits of its depth rounded to f32, at least 1; 0 without a triangle.
    pub depth_key: u32,
    /// Drawn triangles that cover the sample, in front or behind.
    pub layers: u32,
}

impl Sample {
    pub const EMPTY: Self = Self {
        triangle_id: NO_TRIANGLE,
        depth_key: 0,
        layers: 0,
    };

    /// Adds a triangle that covers the sample; returns true if it is the nearest so far.
    pub fn add(&mut self, id: u32, depth: f64) -> bool {
        self.layers += 1;
        let key = depth_key(depth);
        let is_nearest = key > self.depth_key || key == self.depth_key && id < self.triangle_id;
        if is_nearest {
            (self.triangle_id, self.depth_key) = (id, key);
        }
        is_nearest
    }
}

/// One [`Sample`] per pixel, row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    pub samples: Vec<Sample>,
}

impl Coverage {
    pub fn triangle_ids(&self) -> Vec<u32> {
        self.samples
            .iter()
            .map(|sample| sample.triangle_id)
            .collect()
    }

    pub fn depth_keys(&self) -> Vec<u32> {
        self.samples.iter().map(|sample| sample.depth_key).collect()
    }

    pub fn layers(&self) -> Vec<u32> {
        self.samples.iter().map(|sample| sample.layers).collect()
    }
}

/// Finds what covers every sample of `view`.
pub fn cover(triangles: &[OrientedTriangle], view: &View) -> Result<Coverage, Canceled> {
    cover_with(&SampleTests::default(), triangles, view)
}

/// The same, where `tests` may leave samples out.
pub fn cover_with(
    tests: &SampleTests,
    triangles: &[OrientedTriangle],
    view: &View,
) -> Result<Coverage, Canceled> {
    let mut samples = vec![Sample::EMPTY; view.pixels()];
    scatter(tests, triangles, view, &mut samples, |triangle| {
        move |sample: &mut Sample, _, _, hit: Hit| _ = sample.add(triangle.id, hit.depth)
    })?;
    Ok(Coverage { samples })
}

/// The nearest depth at every sample of `view`; negative infinity where nothing is.
pub fn nearest_depths(
    tests: &SampleTests,
    triangles: &[OrientedTriangle],
    view: &View,
) -> Result<Vec<f64>, Canceled> {
    let mut depths = vec![f64::NEG_INFINITY; view.pixels()];
    scatter(tests, triangles, view, &mut depths, |_| {
        |depth: &mut f64, _, _, hit: Hit| *depth = depth.max(hit.depth)
    })?;
    Ok(depths)
}

/// Where a triangle covers a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub depth: f64,
    /// The depth is interpolated, so that f32 renderers round it; other depths are exact.
    pub is_interpolated: bool,
}

/// An edge of a triangle wound clockwise, seen from a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeAtSample {
    /// Twice the area of edge and sample, square sub-pixel units; positive on the inner side.
    pub value: i64,
    /// From its first end to its second, sub-pixel units.
    pub along: [i32; 2],
}

impl EdgeAtSample {
    /// Does the sample lie on the inner side, or on an edge that owns what lies on it?
    pub fn is_inside(&self) -> bool {
        owns(self.value, self.along[0], self.along[1])
    }
}

/// Visits every drawn sample of `view`, triangle by triangle, with the cell of its pixel; `visitor`
/// makes the visitor of a triangle. Parallel by bands of rows, so a triangle may have several
/// visitors, each sample one visit.
pub fn scatter<'a, T: Send, V: FnMut(&mut T, usize, usize, Hit)>(
    tests: &SampleTests,
    triangles: &'a [OrientedTriangle],
    view: &View,
    cells: &mut [T],
    visitor: impl Fn(&'a OrientedTriangle) -> V + Sync,
) -> Result<(), Canceled> {
    scatter_rows(tests, triangles, view, cells, |triangle| {
        let mut visit = visitor(triangle);
        move |cells: &mut [T], y: usize, hits: &[(usize, Hit)]| {
            for &(x, hit) in hits {
                visit(&mut cells[x], x, y, hit);
            }
        }
    })
}

/// The same, with all samples of a triangle in a row of pixels at once: their columns, from left to
/// right, and the cells of the row.
pub fn scatter_rows<'a, T: Send, V: FnMut(&mut [T], usize, &[(usize, Hit)])>(
    tests: &SampleTests,
    triangles: &'a [OrientedTriangle],
    view: &View,
    cells: &mut [T],
    visitor: impl Fn(&'a OrientedTriangle) -> V + Sync,
) -> Result<(), Canceled> {
    const ROWS: usize = 8;
    let (width, height) = (view.width as usize, view.height as usize);
    if cells.is_empty() {
        return Ok(());
    }
    let mut bands: Vec<Vec<&'a OrientedTriangle>> = vec![Vec::new(); height.div_ceil(ROWS)];
    for triangle in triangles {
        let (_, rows) = triangle.bounds(view, tests);
        if !rows.is_empty() {
            bands[rows.start / ROWS..=(rows.end - 1) / ROWS]
                .iter_mut()
                .for_each(|band| band.push(triangle));
        }
    }
    let checkpoint = checkpoint();
    cells
        .par_chunks_mut(ROWS * width)
        .zip(bands)
        .enumerate()
        .try_for_each(|(band, (cells, triangles))| {
            let first_row = band * ROWS;
            let mut drawn = Vec::new();
            for triangle in triangles {
                checkpoint.pass()?;
                let (columns, rows) = triangle.bounds(view, tests);
                let mut visit = visitor(triangle);
                for y in rows.start.max(first_row)..rows.end.min(first_row + ROWS) {
                    drawn.clear();
                    if tests.are_simple() {
                        let hit = |x: usize| Some((x, triangle.at(x, y, tests)?));
                        drawn.extend(columns.clone().filter_map(hit));
                    } else {
                        let (row, hits): (Vec<_>, Vec<_>) = columns
                            .clone()
                            .filter_map(|x| {
                                let edges = triangle.edges(x, y, tests.unit);
                                let hit = triangle.covers(x, y, &edges, tests)?;
                                Some(((x as u32, edges.map(|edge| edge.value)), hit))
                            })
                            .unzip();
                        let left_out = tests.left_out_in_row(triangle, y as u32, &row);
                        let all = row.iter().zip(hits).zip(left_out);
                        drawn.extend(all.filter_map(|(((x, _), hit), left_out)| {
                            left_out.is_none().then_some((*x as usize, hit))
                        }));
                    }
                    visit(&mut cells[(y - first_row) * width..][..width], y, &drawn);
                }
            }
            Ok(())
        })
}

impl OrientedTriangle {
    /// Columns and rows of the pixels whose samples may be covered, within the view. None for a
    /// clipped triangle if corners are drawn as points.
    pub fn bounds(&self, view: &View, tests: &SampleTests) -> (Range<usize>, Range<usize>) {
        if tests.shape == Shape::Points && self.is_clipped() {
            return (0..0, 0..0);
        }
        // Samples lie at the centers of pixels.
        let unit = tests.unit;
        let range = |at: [i32; 3], pixels: u32| {
            let [low, high] =
                [at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2])].map(i64::from);
            let first = (low - tests.radius + unit / 2 - 1).div_euclid(unit).max(0);
            let end =
                ((high + tests.radius - unit / 2).div_euclid(unit) + 1).min(i64::from(pixels));
            first as usize..end.max(first) as usize
        };
        (
            range(self.corners.map(|c| c.x), view.width),
            range(self.corners.map(|c| c.y), view.height),
        )
    }

    /// The triangle at the center of a pixel; none if it is not drawn there.
    pub fn at(&self, x: usize, y: usize, tests: &SampleTests) -> Option<Hit> {
        let edges = self.edges(x, y, tests.unit);
        let hit = self.covers(x, y, &edges, tests)?;
        tests
            .is_drawn(self, x as u32, y as u32, edges.map(|edge| edge.value))
            .then_some(hit)
    }

    /// The edges opposite the corners, at the center of a pixel of `unit` sub-pixel units.
    pub fn edges(&self, x: usize, y: usize, unit: i64) -> [EdgeAtSample; 3] {
        let [a, b, c] = &self.corners;
        let center = |k: usize| unit * k as i64 + unit / 2;
        let [px, py] = [center(x), center(y)];
        let opposite = |from: &SnappedVertex, to: &SnappedVertex| EdgeAtSample {
            value: edge(from, to, px, py),
            along: [to.x - from.x, to.y - from.y],
        };
        // Written out: where size counts, compilers call a closure for every element of a `map`.
        [opposite(b, c), opposite(c, a), opposite(a, b)]
    }

    /// What the triangle has at the center of a pixel with these edges; none if it does not cover
    /// it. Sample tests may still leave it out.
    pub fn covers(
        &self,
        x: usize,
        y: usize,
        edges: &[EdgeAtSample; 3],
        tests: &SampleTests,
    ) -> Option<Hit> {
        let center = |k: usize| tests.unit * k as i64 + tests.unit / 2;
        let [px, py] = [center(x), center(y)];
        let exact = |depth: f32| Hit {
            depth: depth.into(),
            is_interpolated: false,
        };
        if let Some((point, shown)) = self.point {
            return shown
                .covers(point, [px, py], tests.unit)
                .then(|| exact(self.corners[0].depth));
        }
        match tests.shape {
            Shape::Triangles => {
                if !edges.iter().all(EdgeAtSample::is_inside) {
                    return None;
                }
                let weights = edges.map(|edge| edge.value);
                Some(if tests.has_integer_keys {
                    // The key holds the bits of a float.
                    exact(f32::from_bits(integer_key(
                        self.corners.map(|corner| corner.depth),
                        weights,
                    )))
                } else {
                    Hit {
                        depth: self.depth(weights),
                        is_interpolated: true,
                    }
                })
            }
            Shape::Boxes => self.fills_box(px, py).then(|| {
                exact(
                    self.corners
                        .iter()
                        .fold(0.0, |nearest, c| c.depth.max(nearest)),
                )
            }),
            Shape::Points => self
                .corner_under(px, py, tests.radius)
                .map(|k| exact(self.corners[k].depth)),
        }
    }

    /// Returns true in the bounding box, including its left and top borders and excluding the right
    /// and bottom ones.
    fn fills_box(&self, x: i64, y: i64) -> bool {
        let within = |at: [i32; 3], p: i64| {
            at.iter().any(|&k| i64::from(k) <= p) && at.iter().any(|&k| p < i64::from(k))
        };
        within(self.corners.map(|c| c.x), x) && within(self.corners.map(|c| c.y), y)
    }

    /// The nearest corner whose disc contains a point; of equally near ones the first in the order
    /// of the file.
    pub fn corner_under(&self, x: i64, y: i64, radius: i64) -> Option<usize> {
        let contains = |corner: &SnappedVertex| {
            let (dx, dy) = (x - i64::from(corner.x), y - i64::from(corner.y));
            dx * dx + dy * dy <= radius * radius
        };
        let under = self
            .in_file_order([0, 1, 2])
            .into_iter()
            .filter(|&k| contains(&self.corners[k]));
        under.reduce(|nearest, k| {
            if self.corners[k].depth > self.corners[nearest].depth {
                k
            } else {
                nearest
            }
        })
    }

    /// Depth is linear on the screen: corner depths weighted by the doubled areas opposite them,
    /// clamped to their range.
    fn depth(&self, weights: [i64; 3]) -> f64 {
        let z = self.corners.map(|corner| f64::from(corner.depth));
        let [low, high] = self.depth_range();
        let [e0, e1, e2] = weights.map(|e| e as f64);
        ((e0 * z[0] + e1 * z[1] + e2 * z[2]) / (e0 + e1 + e2))
            .max(low)
            .min(high)
    }

    /// Smallest and largest depth of the corners.
    pub fn depth_range(&self) -> [f64; 2] {
        let z = self.corners.map(|corner| f64::from(corner.depth));
        [z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2])]
    }
}
