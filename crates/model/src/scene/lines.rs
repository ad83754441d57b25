//! Lines: the curves along which dots are placed. Either the edges of the meshes, each once and
//! joined into chains, or the polyline of a preset.
//!
//! Lengths are measured in the world with the scene in its rest pose, so a dot keeps its position
//! on an edge that moves.

use std::collections::{HashMap, hash_map::Entry};

use glam::{DMat4, DVec3};

use super::{
    draw::DrawError,
    model::{Primitive, Scene},
    pose::Pose,
};

/// Cosine of the sharpest turn between consecutive edges of a chain: 60 degrees.
const MIN_TURN_COSINE: f64 = 0.5;

/// The most triangles whose edges are collected; beyond, it would take minutes and gigabytes.
const MAX_EDGE_TRIANGLES: u64 = 1 << 23;

/// The end points of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SegmentEnds {
    /// Two vertices of a triangle; both indices count within the draw.
    Edge {
        draw: u32,
        vertices: [u32; 2],
        triangle: u32,
    },
    /// Two points in the scene, before its spin.
    Points([[f32; 3]; 2]),
}

/// A straight segment of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it begins and ends.
    pub ends: SegmentEnds,
    /// Distance of its start from the start of its line, meters.
    pub start_m: f64,
    /// Its length in meters, above 0.
    pub length_m: f64,
}

/// All lines, in an order that is the same on every machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// The segments of all lines, line after line.
    pub segments: Vec<Segment>,
    /// Index of the first segment of each line.
    pub first_segments: Vec<u32>,
}

impl Lines {
    /// Each line as the index of its first segment and its segments.
    pub fn each(&self) -> impl Iterator<Item = (usize, &[Segment])> {
        let ends = self
            .first_segments
            .iter()
            .skip(1)
            .map(|&first| first as usize)
            .chain([self.segments.len()]);
        self.first_segments
            .iter()
            .zip(ends)
            .map(|(&first, end)| (first as usize, &self.segments[first as usize..end]))
    }

    /// The total length of all lines, meters.
    pub fn length_m(&self) -> f64 {
        self.each()
            .filter_map(|(_, line)| line.last())
            .map(|last| last.start_m + last.length_m)
            .sum()
    }

    /// One line through `points`. Repeated points add no segment.
    pub fn polyline(points: &[[f32; 3]]) -> Self {
        let mut lines = Self::default();
        let position = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        lines.push_line(points.windows(2).map(|pair| {
            (
                SegmentEnds::Points([pair[0], pair[1]]),
                (position(pair[1]) - position(pair[0])).length(),
            )
        }));
        lines
    }

    /// The edges of every instance, each once however many triangles share it. With `crease_deg`
    /// only edges whose two faces meet at that angle or more, and edges that do not belong to
    /// exactly two faces.
    /// Errors: if the scene has more than 2^23 triangles.
    pub fn edges(scene: &Scene, crease_deg: Option<f64>) -> Result<Self, DrawError> {
        let count = scene.triangle_count();
        if count > MAX_EDGE_TRIANGLES {
            return Err(DrawError::TooMany {
                what: "triangles with dots along their edges",
                count,
                limit: MAX_EDGE_TRIANGLES,
            });
        }
        let pose = Pose::at_rest(scene);
        let mut known: HashMap<usize, Vec<Chain>> = HashMap::new();
        let mut lines = Self::default();
        // Particle discs and points have no edges.
        let meshes = scene.instances.iter().enumerate().filter(|(_, instance)| {
            let primitive = instance.primitive;
            scene.particle_discs != Some(primitive) && !scene.primitives[primitive].is_points()
        });
        for (draw, instance) in meshes {
            let chains = known.entry(instance.primitive).or_insert_with(|| {
                chains(scene, &scene.primitives[instance.primitive], crease_deg)
            });
            let position = pose.as_ref().map_or(instance.world_from_object, |pose| {
                pose.instance_transform(draw)
            });
            // The first joint gives the scale of a skinned mesh.
            let joint_transforms = pose
                .as_ref()
                .and_then(|pose| pose.deform(draw))
                .and_then(|deform| deform.joint_transforms.as_ref());
            let position = position
                * joint_transforms
                    .filter(|joint_transforms| !joint_transforms.is_empty())
                    .map_or(DMat4::IDENTITY, |joint_transforms| {
                        joint_transforms.matrix(0)
                    });
            for chain in chains.iter() {
                lines.push_line(chain.iter().map(|edge| {
                    let ends = SegmentEnds::Edge {
                        draw: draw as u32,
                        vertices: edge.vertices,
                        triangle: edge.triangle,
                    };
                    (ends, position.transform_vector3(edge.direction).length())
                }));
            }
        }
        Ok(lines)
    }

    /// Adds a line. Segments whose length is 0 or not finite are left out.
    fn push_line(&mut self, segments: impl Iterator<Item = (SegmentEnds, f64)>) {
        let (first, mut start_m) = (self.segments.len(), 0.0);
        for (ends, length_m) in
            segments.filter(|(_, length_m)| length_m.is_finite() && *length_m > 0.0)
        {
            self.segments.push(Segment {
                ends,
                start_m,
                length_m,
            });
            start_m += length_m;
        }
        if self.segments.len() > first {
            self.first_segments.push(first as u32);
        }
    }
}

/// Connected edges in order.
type Chain = Vec<DirectedEdge>;

/// An edge with the direction in which its chain runs.
#[derive(Clone, Copy, Debug)]
struct DirectedEdge {
    /// Start and end, within the primitive.
    vertices: [u32; 2],
    triangle: u32,
    /// From the first vertex to the second, object space.
    direction: DVec3,
}

/// An edge with what is known of its faces. Vertices with equal positions count as one, even if
/// their indices differ.
struct Edge {
    edge: DirectedEdge,
    /// Identifiers of the positions of its ends.
    position_ids: [u32; 2],
    faces: u32,
    normal: DVec3,
    /// The smallest cosine between the normal of the first face and those of the others.
    min_cosine: f64,
}

/// The edges of a mesh, joined into chains that turn as little as possible.
fn chains(scene: &Scene, primitive: &Primitive, crease_deg: Option<f64>) -> Vec<Chain> {
    let mut edges = edges(scene, primitive);
    if let Some(degrees) = crease_deg {
        let most = libm::cos(degrees.to_radians());
        edges.retain(|edge| edge.faces != 2 || edge.min_cosine <= most);
    }
    let mut at: HashMap<u32, Vec<u32>> = HashMap::new();
    for (i, edge) in edges.iter().enumerate() {
        edge.position_ids
            .iter()
            .for_each(|position| at.entry(*position).or_default().push(i as u32));
    }
    let mut is_used = vec![false; edges.len()];
    let mut chains = Vec::new();
    for first in 0..edges.len() {
        if is_used[first] {
            continue;
        }
        is_used[first] = true;
        let mut chain = vec![edges[first].edge];
        // Extend at the end, reverse, extend at the other end, reverse.
        for end in [1, 0] {
            let (mut position, mut direction) = (
                edges[first].position_ids[end],
                edges[first].edge.direction * if end == 1 { 1.0 } else { -1.0 },
            );
            while let Some((next, edge)) =
                straightest(&edges, &at[&position], &is_used, position, direction)
            {
                is_used[next] = true;
                position =
                    edges[next].position_ids[usize::from(edges[next].position_ids[0] == position)];
                direction = edge.direction;
                chain.push(edge);
            }
            chain = chain
                .into_iter()
                .rev()
                .map(DirectedEdge::reversed)
                .collect();
        }
        chains.push(chain);
    }
    chains
}

/// Of the unused edges at a position, the one that continues with the smallest turn.
fn straightest(
    edges: &[Edge],
    at: &[u32],
    is_used: &[bool],
    position: u32,
    direction: DVec3,
) -> Option<(usize, DirectedEdge)> {
    let mut best: Option<(f64, usize, DirectedEdge)> = None;
    for &i in at {
        let i = i as usize;
        if is_used[i] {
            continue;
        }
        let edge = if edges[i].position_ids[0] == position {
            edges[i].edge
        } else {
            edges[i].edge.reversed()
        };
        let cosine = direction.dot(edge.direction) / (direction.length() * edge.direction.length());
        if cosine > best.as_ref().map_or(MIN_TURN_COSINE, |best| best.0) {
            best = Some((cosine, i, edge));
        }
    }
    best.map(|(_, i, edge)| (i, edge))
}

impl DirectedEdge {
    fn reversed(self) -> Self {
        let [a, b] = self.vertices;
        Self {
            vertices: [b, a],
            direction: -self.direction,
            ..self
        }
    }
}

/// Every edge between two different positions, in the order in which triangles first use it.
fn edges(scene: &Scene, primitive: &Primitive) -> Vec<Edge> {
    let mut position_ids: HashMap<[u32; 3], u32> = HashMap::new();
    let positions: Vec<[f32; 3]> = (0..primitive.vertex_count())
        .map(|vertex| primitive.position(scene, vertex))
        .collect();
    let position_id_of: Vec<u32> = positions
        .iter()
        .map(|p| {
            let next = position_ids.len() as u32;
            // Adding 0 turns -0 into 0.
            *position_ids
                .entry(p.map(|component| (component + 0.0).to_bits()))
                .or_insert(next)
        })
        .collect();
    let mut at: HashMap<[u32; 2], usize> = HashMap::new();
    let mut edges: Vec<Edge> = Vec::new();
    for triangle in 0..primitive.triangle_count() {
        let corners = primitive.corners(scene, triangle);
        let [a, b, c] =
            corners.map(|corner| DVec3::from(positions[corner as usize].map(f64::from)));
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            continue;
        }
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for side in 0..3 {
            let vertices = [corners[side], corners[(side + 1) % 3]];
            let ends = vertices.map(|vertex| position_id_of[vertex as usize]);
            if ends[0] == ends[1] {
                continue;
            }
            match at.entry([ends[0].min(ends[1]), ends[0].max(ends[1])]) {
                Entry::Vacant(entry) => {
                    entry.insert(edges.len());
                    let direction = [b - a, c - b, a - c][side];
                    edges.push(Edge {
                        edge: DirectedEdge {
                            vertices,
                            triangle,
                            direction,
                        },
                        position_ids: ends,
                        faces: 1,
                        normal,
                        min_cosine: 1.0,
                    });
                }
                Entry::Occupied(entry) => {
                    let edge = &mut edges[*entry.get()];
                    edge.faces += 1;
                    edge.min_cosine = edge.min_cosine.min(edge.normal.dot(normal));
                }
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scene::builtin;

    /// Positions of both ends, the smaller first.
    fn ends(scene: &Scene, segment: &Segment) -> [[u32; 3]; 2] {
        let SegmentEnds::Edge { draw, vertices, .. } = segment.ends else {
            panic!("an edge")
        };
        let primitive = &scene.primitives[scene.instances[draw as usize].primitive];
        let mut ends = vertices.map(|vertex| {
            primitive
                .position(scene, vertex)
                .map(|component| (component + 0.0).to_bits())
        });
        ends.sort_unstable();
        ends
    }

    #[test]
    fn every_edge_of_a_closed_mesh_is_walked_once() {
        for query in ["sphere?triangles=2000", "knot?tess=4"] {
            let scene = builtin::build(query).expect("a scene");
            let lines = Lines::edges(&scene, None).expect("few triangles");
            // Each triangle has three edges and shares each with one neighbor.
            assert_eq!(
                lines.segments.len() as u64,
                scene.triangle_count() * 3 / 2,
                "{query}"
            );
            let all: BTreeSet<_> = lines
                .segments
                .iter()
                .map(|segment| ends(&scene, segment))
                .collect();
            assert_eq!(
                all.len(),
                lines.segments.len(),
                "{query}: an edge is walked twice"
            );
            assert!(
                lines.first_segments.len() * 3 < lines.segments.len(),
                "{query}: {} walks",
                lines.first_segments.len()
            );
        }
    }

    #[test]
    fn a_walk_goes_from_end_to_end() {
        let scene = builtin::build("knot?tess=4").expect("a scene");
        let position = |vertex: u32| {
            scene.primitives[0]
                .position(&scene, vertex)
                .map(|component| (component + 0.0).to_bits())
        };
        for (_, line) in Lines::edges(&scene, None).expect("few triangles").each() {
            let mut length_m = 0.0;
            for (i, segment) in line.iter().enumerate() {
                assert_eq!(segment.start_m, length_m);
                length_m += segment.length_m;
                if let (
                    SegmentEnds::Edge { vertices: a, .. },
                    Some(SegmentEnds::Edge { vertices: b, .. }),
                ) = (segment.ends, line.get(i + 1).map(|next| next.ends))
                {
                    assert_eq!(position(a[1]), position(b[0]));
                }
            }
        }
    }

    #[test]
    fn creases_of_cubes_are_their_twelve_edges() {
        let scene = builtin::build("cube-wall?columns=3&rows=2").expect("a scene");
        let edges = |crease_deg| {
            Lines::edges(&scene, crease_deg)
                .expect("few triangles")
                .segments
                .len()
        };
        assert_eq!(edges(Some(30.0)), 6 * 12, "diagonals lie in a face");
        assert_eq!((edges(None), edges(Some(180.0))), (6 * 18, 0));
    }

    #[test]
    fn too_many_triangles_are_refused_with_their_number() {
        let mut scene = builtin::build("sphere?triangles=5000").expect("a scene");
        scene.instances = vec![scene.instances[0].clone(); 1680];
        let error = Lines::edges(&scene, None)
            .expect_err("too many")
            .to_string();
        assert!(
            error.contains(&scene.triangle_count().to_string())
                && error.contains(&MAX_EDGE_TRIANGLES.to_string()),
            "{error}"
        );
    }

    #[test]
    fn a_polyline_leaves_out_what_has_no_length() {
        let lines = Lines::polyline(&[[0.0; 3], [0.0; 3], [3.0, 4.0, 0.0], [3.0, 4.0, 2.0]]);
        assert_eq!(
            (
                lines.segments.len(),
                lines.first_segments.as_slice(),
                lines.length_m()
            ),
            (2, &[0][..], 7.0)
        );
        assert_eq!(Lines::polyline(&[[1.0; 3]]), Lines::default());
        assert_eq!(
            Lines::polyline(&[[0.0; 3], [f32::NAN; 3], [1.0; 3]])
                .segments
                .len(),
            0
        );
    }
}
