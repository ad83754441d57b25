//! Mesh builder: collects vertices and triangles and appends them to the byte buffers of a scene.

use glam::DVec3;

use crate::scene::{
    accessor::{Accessor, ComponentType},
    bounds::Bounds,
    material::TEXTURE_SLOTS,
    model::{Primitive, Scene, Topology},
    tangents,
};

/// A mesh under construction. Triangles are counter-clockwise seen from the outside, as in glTF.
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    /// Linear RGBA; empty, or one per vertex.
    colors: Vec<[u8; 4]>,
    /// Texture coordinates, for every texture; empty, or one per vertex.
    texcoords: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

/// A closed loop of consecutive vertices. One vertex is a pole.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Index of its first vertex.
    pub first: u32,
    /// The number of its vertices.
    pub count: u32,
}

impl MeshBuilder {
    /// An empty mesh with reserved capacity.
    pub fn with_capacity(vertices: usize, triangles: usize) -> Self {
        Self {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            colors: Vec::new(),
            texcoords: Vec::new(),
            indices: Vec::with_capacity(3 * triangles),
        }
    }

    /// Adds a vertex and returns its index. `normal` is normalized; it must not be zero.
    pub fn vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position.as_vec3().into());
        self.normals
            .push(normal.normalize_or(DVec3::Y).as_vec3().into());
        self.positions.len() as u32 - 1
    }

    /// Adds a vertex with a linear color, each channel in [0, 1]. Either all vertices of a mesh
    /// have a color, or none.
    pub fn colored_vertex(&mut self, position: DVec3, normal: DVec3, color: [f64; 3]) -> u32 {
        let byte = |channel: f64| (channel.clamp(0.0, 1.0) * 255.0).round() as u8;
        self.colors
            .push([byte(color[0]), byte(color[1]), byte(color[2]), 255]);
        self.vertex(position, normal)
    }

    /// Adds a vertex with texture coordinates: 0 at the left and top edges of the image, 1 at the
    /// right and bottom ones. Either all vertices of a mesh have them, or none.
    pub fn textured_vertex(&mut self, position: DVec3, normal: DVec3, texcoords: [f64; 2]) -> u32 {
        self.texcoords.push(texcoords.map(|v| v as f32));
        self.vertex(position, normal)
    }

    /// Adds a triangle of existing vertices.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        self.indices.extend(corners);
    }

    /// Adds a flat triangle with three new vertices.
    pub fn facet(&mut self, corners: [DVec3; 3], color: [f64; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let corners = corners.map(|p| self.colored_vertex(p, normal, color));
        self.triangle(corners);
    }

    /// Adds a flat quadrilateral with four new vertices, counter-clockwise from the outside.
    pub fn quad(&mut self, corners: [DVec3; 4], color: [f64; 3]) {
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
        let [a, b, c, d] = corners.map(|p| self.colored_vertex(p, normal, color));
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Adds a closed loop of `count` vertices.
    pub fn ring(&mut self, count: u32, mut vertex: impl FnMut(&mut Self, u32)) -> Ring {
        let first = self.positions.len() as u32;
        (0..count).for_each(|i| vertex(self, i));
        Ring { first, count }
    }

    /// Triangulates the band between two loops, `upper` above `lower`, both counter-clockwise seen
    /// from above. Their counts may differ. A pole makes a fan, so no triangle is degenerate.
    pub fn band(&mut self, lower: Ring, upper: Ring) {
        let (mut i, mut j) = (0, 0);
        let last = |ring: Ring| if ring.count == 1 { 0 } else { ring.count };
        let at = |ring: Ring, i: u32| ring.first + if i == ring.count { 0 } else { i };
        while i < last(lower) || j < last(upper) {
            let (a, b) = (at(lower, i), at(upper, j));
            // Advance on the loop whose next edge has its midpoint further back: this keeps the
            // diagonals short.
            let behind = u64::from(2 * i + 1) * u64::from(upper.count)
                <= u64::from(2 * j + 1) * u64::from(lower.count);
            if j == last(upper) || (i < last(lower) && behind) {
                i += 1;
                self.triangle([a, at(lower, i), b]);
            } else {
                j += 1;
                self.triangle([a, at(upper, j), b]);
            }
        }
    }

    /// Appends the mesh to `scene` as a primitive and returns its index.
    pub fn append(self, scene: &mut Scene, name: &str, material: usize) -> usize {
        let Self {
            positions,
            normals,
            colors,
            texcoords,
            indices,
        } = self;
        let (bounds, longest_edge) = (bounds(&positions), longest_edge(&positions, &indices));
        let start = scene.vertex_bytes.len();
        scene
            .vertex_bytes
            .reserve_exact(positions.len() * if colors.is_empty() { 24 } else { 28 });
        scene
            .vertex_bytes
            .extend_from_slice(bytemuck::cast_slice(&positions));
        let normals_at = scene.vertex_bytes.len();
        scene
            .vertex_bytes
            .extend_from_slice(bytemuck::cast_slice(&normals));
        let colors_at = scene.vertex_bytes.len();
        scene
            .vertex_bytes
            .extend_from_slice(bytemuck::cast_slice(&colors));
        let coords_at = scene.vertex_bytes.len();
        scene
            .vertex_bytes
            .extend_from_slice(bytemuck::cast_slice(&texcoords));
        let indices_at = scene.index_bytes.len();
        scene
            .index_bytes
            .extend_from_slice(bytemuck::cast_slice(&indices));
        let byte_color = Accessor {
            offset: colors_at as u32,
            stride: 4,
            component_type: ComponentType::U8,
            components: 4,
            normalized: true,
            count: colors.len() as u32,
        };
        scene.primitives.push(Primitive {
            name: name.into(),
            mesh: name.into(),
            topology: Topology::List,
            indices: Some(Accessor {
                offset: indices_at as u32,
                stride: 4,
                component_type: ComponentType::U32,
                components: 1,
                normalized: false,
                count: indices.len() as u32,
            }),
            positions: Accessor::packed_f32(start, 3, positions.len()),
            normals: Accessor::packed_f32(normals_at, 3, normals.len()),
            colors: (!colors.is_empty()).then_some(byte_color),
            texcoords: [(!texcoords.is_empty()).then_some(Accessor::packed_f32(
                coords_at,
                2,
                texcoords.len(),
            )); TEXTURE_SLOTS],
            tangents: None,
            material,
            bounds,
            longest_edge,
            is_faceted: false,
            normals_agree: false,
            deformation: Default::default(),
        });
        let index = scene.primitives.len() - 1;
        // The scene of canceled work is thrown away.
        scene.primitives[index].normals_agree = scene.primitives[index]
            .normals_agree(scene)
            .unwrap_or_default();
        let normal_map = scene.materials.get(material).and_then(|m| m.normal_texture);
        if let Some(texture) = normal_map {
            tangents::add(scene, index, &texture);
        }
        index
    }
}

fn bounds(positions: &[[f32; 3]]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    positions
        .iter()
        .for_each(|&p| bounds.include(p.map(f64::from).into()));
    bounds
}

fn longest_edge(positions: &[[f32; 3]], indices: &[u32]) -> f64 {
    let at = |i: u32| DVec3::from(positions[i as usize].map(f64::from));
    let edge = |&[a, b, c]: &[u32; 3]| {
        let (a, b, c) = (at(a), at(b), at(c));
        a.distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a))
    };
    indices
        .as_chunks()
        .0
        .iter()
        .map(edge)
        .fold(0.0, f64::max)
        .sqrt()
}
