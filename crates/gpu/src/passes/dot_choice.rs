//! Which dots may show, chosen by the CPU.

use glam::{DMat4, DVec3, DVec4};

use crate::{
    effects::dots::Dots,
    layout::records::DotRunRecord,
    scene::{
        Scene,
        lines::{Lines, SegmentEnds},
        view::View,
    },
};

/// Rounding of a float renderer's clip coordinates, as a share of the magnitudes that they are
/// summed from.
const ROUNDING: f64 = 1e-5;

/// Rounding of its 1/w, in steps of the bits.
const STEPS: u32 = 256;

/// Runs that follow one another on their lines and share a box.
const BLOCK: usize = 32;

/// The runs of dots with boxes around them, of which the CPU asks for the dots that may show. It
/// keeps a few too many, never one too few.
pub struct DotBoxes {
    /// Lowest and highest corner of every [`BLOCK`] of runs.
    boxes: Vec<[DVec3; 2]>,
    /// First and last dot of every run, in the scene before it is spun.
    ends: Vec<[DVec3; 2]>,
}

/// The planes of a view in the scene, positive inside.
struct Planes([DVec4; 6]);

/// How far rounding may carry the distance of a point from a plane.
fn error_bound(plane: &DVec4, point: DVec3) -> f64 {
    ROUNDING * plane.abs().dot(point.abs().extend(1.0))
}

impl Planes {
    fn new(clip_from_scene: &DMat4, dots: &Dots, view: &View) -> Self {
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_scene.row(row));
        // Room beyond the picture for a dot's edge, in half pictures.
        let [margin_x, margin_y] = [view.width, view.height]
            .map(|pixels| 1.0 + f64::from(dots.radius() + 512) / f64::from(128 * pixels.max(1)));
        Self([
            w * margin_x - x,
            w * margin_x + x,
            w * margin_y - y,
            w * margin_y + y,
            w - z,
            z,
        ])
    }

    /// May a point between these corners lie inside?
    fn may_hold(&self, [low, high]: [DVec3; 2]) -> bool {
        self.0.iter().all(|plane| {
            // The corner that lies farthest inside.
            let normal = plane.truncate();
            let corner = DVec3::select(normal.cmpge(DVec3::ZERO), high, low);
            normal.dot(corner) + plane.w >= -error_bound(plane, corner)
        })
    }
}

impl DotBoxes {
    /// The boxes of lines that stay where they are.
    pub fn new(scene: &Scene, lines: &Lines, dot_runs: &[DotRunRecord]) -> Self {
        let place = |draw: u32, vertex: u32| {
            let instance = &scene.instances[draw as usize];
            let position = scene.primitives[instance.primitive]
                .position(scene, vertex)
                .map(f64::from);
            instance.world_from_object.transform_point3(position.into())
        };
        let ends_of = |dot_run: &DotRunRecord| {
            let [begin, end] = match lines.segments[dot_run.segment as usize].ends {
                SegmentEnds::Edge { draw, vertices, .. } => {
                    vertices.map(|vertex| place(draw, vertex))
                }
                SegmentEnds::Points(points) => {
                    points.map(|point| DVec3::from(point.map(f64::from)))
                }
            };
            let at = |place: u32| {
                begin
                    + (end - begin)
                        * (f64::from(dot_run.start) + f64::from(place) * f64::from(dot_run.step))
            };
            [at(0), at(dot_run.count - 1)]
        };
        let ends: Vec<[DVec3; 2]> = dot_runs.iter().map(ends_of).collect();
        let boxes = ends.chunks(BLOCK).map(|block| {
            let points = || block.iter().flatten().copied();
            let [low, high] = [DVec3::min, DVec3::max].map(|end| points().reduce(end));
            [low.unwrap_or_default(), high.unwrap_or_default()]
        });
        Self {
            boxes: boxes.collect(),
            ends,
        }
    }

    /// DotRun and place of every dot that may show.
    pub fn choose(&self, dot_runs: &[DotRunRecord], dots: &Dots, view: &View) -> Vec<[u32; 2]> {
        let clip_from_scene = view.clip_from_world * view.scene_state.world_from_scene;
        let planes = Planes::new(&clip_from_scene, dots, view);
        let (fade_from, row) = (dots.fade_from(view), clip_from_scene.row(3));
        // The level below which dots have surely faded at a point.
        let level = |point: DVec3| {
            let w = row.truncate().dot(point) + row.w - error_bound(&row, point);
            let inv_w = if w > 0.0 {
                ((1.0 / w) as f32).to_bits().saturating_add(STEPS)
            } else {
                u32::MAX
            };
            let halved =
                (i64::from(fade_from) - i64::from(inv_w)).clamp(0, i64::from(dots.levels) << 23);
            (halved >> 23) as u32
        };
        let mut chosen = Vec::new();
        let blocks = self.boxes.iter().zip(self.ends.chunks(BLOCK)).zip(0..);
        let runs = blocks
            .filter(|((corners, _), _)| planes.may_hold(**corners))
            .flat_map(|((_, ends), block)| (block * BLOCK..).zip(ends));
        for (index, &[a, b]) in runs.filter(|(_, [a, b])| planes.may_hold([a.min(*b), a.max(*b)])) {
            let dot_run = &dot_runs[index];
            let stride = 1u32 << level(a).min(level(b));
            let first = dot_run.first.next_multiple_of(stride) - dot_run.first;
            for place in (first..dot_run.count).step_by(stride as usize) {
                let at = a + (b - a) * (f64::from(place) / f64::from(dot_run.count.max(2) - 1));
                let number = dot_run.first + place;
                if (number == 0 || number.trailing_zeros() >= level(at)) && planes.may_hold([at; 2])
                {
                    chosen.push([index as u32, place]);
                }
            }
        }
        chosen
    }
}
