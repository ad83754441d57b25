//! Meshlets: clusters of a mesh's triangles that can be culled as a whole, with bounds that are
//! conservative after rounding.
//!
//! A meshlet lists triangles by their index in the primitive, so triangle ids and their order do
//! not change. Clusters grow from a seed over shared vertices, which keeps them round. Seeds are
//! taken in Morton order (Morton 1966), which keeps left-over and unconnected triangles together.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    accessor::ComponentType,
    bounds::Bounds,
    draw::MAX_MAGNITUDE,
    model::{Primitive, Scene},
};

/// The most triangles of a meshlet.
pub const MESHLET_TRIANGLES: usize = 64;

/// A cluster of triangles with its bounds, in object space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meshlet {
    /// Its range of [`Meshlets::triangles`].
    pub first_triangle: u32,
    pub triangle_count: u32,
    /// Its range of [`Meshlets::vertices`].
    pub first_vertex: u32,
    pub vertex_count: u32,
    /// Center and half extents of a box of all drawable triangles, rounded outwards.
    pub center: [f32; 3],
    pub half: [f32; 3],
    /// Axis of a cone that contains the normals of all triangles.
    pub axis: [f32; 3],
    /// Cosine of the cone's half angle, rounded down, and its sine, rounded up.
    pub cos: f32,
    pub sin: f32,
    /// The smallest altitude of a triangle, rounded down. 0 where the cone cannot cull: a triangle
    /// has no area, or two face away from each other.
    pub altitude: f32,
}

/// The meshlets of a primitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meshlets {
    /// All meshlets.
    pub list: Vec<Meshlet>,
    /// Triangle indices within the primitive; each occurs once.
    pub triangles: Vec<u32>,
    /// Vertex indices within the primitive, each once per meshlet.
    pub vertices: Vec<u32>,
}

impl Meshlets {
    /// Divides a primitive into meshlets.
    pub fn of(scene: &Scene, primitive: &Primitive) -> Self {
        let last = primitive.vertex_count().max(1) - 1;
        let corners: Vec<[u32; 3]> = (0..primitive.triangle_count())
            .into_par_iter()
            .map(|t| primitive.corners(scene, t).map(|vertex| vertex.min(last)))
            .collect();
        let positions: Vec<[f32; 3]> = (0..primitive.vertex_count())
            .into_par_iter()
            .map(|vertex| primitive.position(scene, vertex))
            .collect();
        let builder = Builder {
            positions: &positions,
            corners: &corners,
            is_exact: primitive.positions.component_type == ComponentType::F32,
        };
        let mut meshlets = Self::default();
        let mut stamps = vec![u32::MAX; positions.len()];
        for cluster in builder.clusters(&primitive.bounds) {
            builder.finish(cluster, &mut meshlets, &mut stamps);
        }
        meshlets
    }
}

/// Returns true if a vertex can be drawn: the same test as in the projection.
fn is_drawable(position: [f32; 3]) -> bool {
    position.iter().all(|v| f64::from(v.abs()) < MAX_MAGNITUDE)
}

fn to_f64(position: [f32; 3]) -> DVec3 {
    position.map(f64::from).into()
}

/// The smallest f32 that is not below `value`.
pub fn rounded_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value {
        near.next_up()
    } else {
        near
    }
}

/// Center and half extents of a box, grown by `margin` times its coordinates and rounded outwards.
pub fn center_and_half(bounds: &Bounds, fraction: f64) -> ([f32; 3], [f32; 3]) {
    if bounds.is_empty() {
        return ([0.0; 3], [0.0; 3]);
    }
    // Coordinates beyond this limit are not drawn.
    let limit = DVec3::splat(MAX_MAGNITUDE);
    let (min, max) = (
        bounds.min.clamp(-limit, limit),
        bounds.max.clamp(-limit, limit),
    );
    let center = ((min + max) * 0.5).as_vec3();
    let middle = center.as_dvec3();
    let half = (max - middle).max(middle - min) + min.abs().max(max.abs()) * (fraction + 1e-15);
    (center.into(), half.to_array().map(rounded_up))
}

struct Builder<'a> {
    positions: &'a [[f32; 3]],
    corners: &'a [[u32; 3]],
    /// Positions are stored as f32; integers are normalized on reading, with rounding.
    is_exact: bool,
}

impl Builder<'_> {
    /// All triangles, divided into clusters of at most [`MESHLET_TRIANGLES`].
    fn clusters(&self, bounds: &Bounds) -> Vec<Vec<u32>> {
        let (first_triangles, triangles_around) = self.triangles_around();
        let mut is_taken = vec![false; self.corners.len()];
        let mut clusters = Vec::with_capacity(self.corners.len() / 48 + 1);
        let (mut cluster, mut grown) = (Vec::with_capacity(MESHLET_TRIANGLES), 0);
        for seed in self.morton_order(bounds) {
            if is_taken[seed as usize] {
                continue;
            }
            if cluster.len() == MESHLET_TRIANGLES
                || cluster.len() >= MESHLET_TRIANGLES / 4 && self.is_far(&cluster, seed)
            {
                clusters.push(std::mem::replace(
                    &mut cluster,
                    Vec::with_capacity(MESHLET_TRIANGLES),
                ));
                grown = 0;
            }
            is_taken[seed as usize] = true;
            cluster.push(seed);
            // Breadth-first: the cluster is its own queue.
            while grown < cluster.len() {
                for vertex in self.corners[cluster[grown] as usize] {
                    let [first, end] = [vertex, vertex + 1]
                        .map(|vertex| first_triangles[vertex as usize] as usize);
                    for &neighbor in &triangles_around[first..end] {
                        if cluster.len() < MESHLET_TRIANGLES && !is_taken[neighbor as usize] {
                            is_taken[neighbor as usize] = true;
                            cluster.push(neighbor);
                        }
                    }
                }
                grown += 1;
            }
        }
        if !cluster.is_empty() {
            clusters.push(cluster);
        }
        clusters
    }

    /// The triangles around each vertex: the first index of each vertex's list, and all lists
    /// concatenated.
    fn triangles_around(&self) -> (Vec<u32>, Vec<u32>) {
        let mut first_triangles = vec![0u32; self.positions.len() + 2];
        self.corners
            .iter()
            .flatten()
            .for_each(|&vertex| first_triangles[vertex as usize + 2] += 1);
        for vertex in 2..first_triangles.len() {
            first_triangles[vertex] += first_triangles[vertex - 1];
        }
        let mut triangles_around = vec![0u32; 3 * self.corners.len()];
        for (triangle, corners) in self.corners.iter().enumerate() {
            for &vertex in corners {
                let slot = &mut first_triangles[vertex as usize + 1];
                triangles_around[*slot as usize] = triangle as u32;
                *slot += 1;
            }
        }
        (first_triangles, triangles_around)
    }

    /// Triangles in Morton order of their first corner, by 21 bits of each coordinate.
    fn morton_order(&self, bounds: &Bounds) -> impl Iterator<Item = u32> {
        let sides = (bounds.max - bounds.min).max(DVec3::splat(f64::MIN_POSITIVE));
        let mut order: Vec<(u64, u32)> = self
            .corners
            .par_iter()
            .enumerate()
            .map(|(triangle, corners)| {
                let position = (to_f64(self.positions[corners[0] as usize]) - bounds.min) / sides
                    * f64::from((1 << 21) - 1);
                // NaN becomes 0.
                let bits = [position.x, position.y, position.z].map(|v| spread_bits(v as u64));
                (bits[0] | bits[1] << 1 | bits[2] << 2, triangle as u32)
            })
            .collect();
        order.par_sort_unstable();
        order.into_iter().map(|(_, triangle)| triangle)
    }

    /// Returns true if a triangle is farther from the cluster than the cluster is wide.
    fn is_far(&self, cluster: &[u32], triangle: u32) -> bool {
        let mut hull = Bounds::EMPTY;
        cluster
            .iter()
            .flat_map(|&t| self.corners[t as usize])
            .for_each(|vertex| hull.include(to_f64(self.positions[vertex as usize])));
        let position = to_f64(self.positions[self.corners[triangle as usize][0] as usize]);
        (position.clamp(hull.min, hull.max) - position).length() > 2.0 * hull.radius()
    }

    /// Computes the bounds of a cluster and appends it.
    fn finish(&self, mut cluster: Vec<u32>, meshlets: &mut Meshlets, stamps: &mut [u32]) {
        cluster.sort_unstable();
        let (number, first_vertex) = (meshlets.list.len() as u32, meshlets.vertices.len() as u32);
        let mut bounds = Bounds::EMPTY;
        let mut faces = Faces::default();
        for corners in cluster
            .iter()
            .map(|&triangle| self.corners[triangle as usize])
        {
            for vertex in corners {
                if stamps[vertex as usize] != number {
                    stamps[vertex as usize] = number;
                    meshlets.vertices.push(vertex);
                }
            }
            let positions = corners.map(|vertex| self.positions[vertex as usize]);
            if positions.into_iter().all(is_drawable) {
                positions
                    .into_iter()
                    .for_each(|position| bounds.include(to_f64(position)));
                faces.add(positions);
            }
        }
        let (center, half) = center_and_half(
            &bounds,
            if self.is_exact {
                0.0
            } else {
                1.0 / f64::from(1 << 20)
            },
        );
        let (axis, cos, sin, altitude) = faces.cone();
        meshlets.list.push(Meshlet {
            first_triangle: meshlets.triangles.len() as u32,
            triangle_count: cluster.len() as u32,
            first_vertex,
            vertex_count: meshlets.vertices.len() as u32 - first_vertex,
            center,
            half,
            axis,
            cos,
            sin,
            altitude,
        });
        meshlets.triangles.append(&mut cluster);
    }
}

/// Moves each of the 21 low bits to every third position.
fn spread_bits(v: u64) -> u64 {
    let v = v & 0x1f_ffff;
    let v = (v | v << 32) & 0x001f_0000_0000_ffff;
    let v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    let v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    let v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// The normals of a cluster's triangles.
#[derive(Default)]
struct Faces {
    normals: Vec<DVec3>,
    altitude: Option<f64>,
}

impl Faces {
    fn add(&mut self, positions: [[f32; 3]; 3]) {
        // A triangle with two equal corners never has an area.
        if positions[0] == positions[1]
            || positions[1] == positions[2]
            || positions[2] == positions[0]
        {
            return;
        }
        let [a, b, c] = positions.map(to_f64);
        let doubled = (b - a).cross(c - a);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let altitude = doubled.length() / longest;
        self.altitude = Some(self.altitude.unwrap_or(f64::INFINITY).min(altitude));
        self.normals.push(doubled.normalize_or_zero());
    }

    /// Axis of the normal cone, cosine and sine of its half angle, and the smallest altitude.
    fn cone(&self) -> ([f32; 3], f32, f32, f32) {
        const NONE: ([f32; 3], f32, f32, f32) = ([0.0; 3], 0.0, 1.0, 0.0);
        let axis = self
            .normals
            .iter()
            .sum::<DVec3>()
            .normalize_or_zero()
            .as_vec3();
        let exact = axis.as_dvec3().normalize_or_zero();
        let least = self
            .normals
            .iter()
            .map(|normal| normal.dot(exact))
            .fold(1.0, f64::min)
            - 1e-6;
        let altitude = self.altitude.unwrap_or(0.0) * (1.0 - 1e-6);
        // Smaller altitudes could underflow in products.
        if self.normals.is_empty() || least <= 0.0 || altitude < 1e-18 {
            return NONE;
        }
        (
            axis.into(),
            (least as f32).next_down(),
            rounded_up((1.0 - least * least).max(0.0).sqrt()),
            (altitude as f32).next_down(),
        )
    }
}
