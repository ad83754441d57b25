//! A tree of dot_runs in space: what the CPU asks which dots may show. It keeps a few too many,
//! never one too few.

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

/// A box around dot runs: a few, or those of the nodes behind it up to `end`.
struct Node {
    corners: [DVec3; 2],
    dot_runs: Vec<u32>,
    end: usize,
}

/// Adds a node, and those of its halves.
fn grow(nodes: &mut Vec<Node>, ends: &[[DVec3; 2]], dot_runs: &mut [u32]) {
    let of = |dot_run: &u32| ends[*dot_run as usize];
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let corners = dot_runs
        .iter()
        .flat_map(of)
        .fold(none, |[low, high], at| [low.min(at), high.max(at)]);
    let (at, middle) = (nodes.len(), dot_runs.len() / 2);
    let few = if middle < 4 {
        dot_runs.to_vec()
    } else {
        Vec::new()
    };
    nodes.push(Node {
        corners,
        dot_runs: few,
        end: 0,
    });
    if middle >= 4 {
        let axis = (corners[1] - corners[0]).max_position();
        let place = |dot_run: &u32| of(dot_run)[0][axis];
        dot_runs.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
        let (left, right) = dot_runs.split_at_mut(middle);
        grow(nodes, ends, left);
        grow(nodes, ends, right);
    }
    nodes[at].end = nodes.len();
}

/// A tree of dot runs in space, which the CPU asks for the dots that may show. It keeps a few too
/// many, never one too few.
pub struct DotTree {
    nodes: Vec<Node>,
    /// First and last dot of every stretch, in the scene before it is spun.
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

impl DotTree {
    /// The tree of lines that stay where they are.
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
        let mut nodes = Vec::new();
        let mut order: Vec<u32> = (0..ends.len() as u32).collect();
        grow(&mut nodes, &ends, &mut order);
        Self { nodes, ends }
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
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !planes.may_hold(node.corners) {
                at = node.end;
                continue;
            }
            at += 1;
            for &number in &node.dot_runs {
                let (dot_run, [a, b]) = (&dot_runs[number as usize], self.ends[number as usize]);
                let stride = 1u32 << level(a).min(level(b));
                let first = dot_run.first.next_multiple_of(stride) - dot_run.first;
                for place in (first..dot_run.count).step_by(stride as usize) {
                    let at = a + (b - a) * (f64::from(place) / f64::from(dot_run.count.max(2) - 1));
                    let dot = dot_run.first + place;
                    if (dot == 0 || dot.trailing_zeros() >= level(at)) && planes.may_hold([at, at])
                    {
                        chosen.push([number, place]);
                    }
                }
            }
        }
        chosen
    }
}
