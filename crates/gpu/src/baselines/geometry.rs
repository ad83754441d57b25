//! What the hardware baseline fetches: attributes and index lists where the file has them, and
//! copies of those that a fixed-function pipeline cannot read, made once, as an engine makes them
//! when it loads a model.

use std::ops::Range;

use crate::{
    scene::{Accessor, ComponentType, Primitive, Scene, Topology, draw::Draw},
    scene_data::attributes::{AttributeLayout, DEFORMED_BYTES},
};

/// Vertex buffers, each with one attribute: position, normal, texture coordinates of base color and
/// emission, color.
pub const STREAMS: usize = 5;

/// Components of each, all f32, but colors that are stored as 16 bits a channel.
pub const COMPONENTS: [u32; STREAMS] = [3, 3, 2, 2, 4];

/// A vertex buffer: where it begins in `vertex_bytes`, and bytes from one vertex to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    pub offset: u64,
    pub stride: u64,
    /// It has four normalized components of 16 bits, and not floats.
    pub is_short: bool,
}

/// An index list: its format, its bytes in `index_bytes`, and its length.
pub type Indices = (wgpu::IndexFormat, Range<u64>, u32);

/// What a primitive is drawn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Fetched {
    pub streams: [Stream; STREAMS],
    /// None: its vertices in order.
    pub indices: Option<Indices>,
}

/// All primitives of a scene, and copies of what cannot be fetched as it is.
pub struct HardwareGeometry {
    attributes: AttributeLayout,
    pub primitives: Vec<Fetched>,
    /// Behind the attributes and the deformed vertices in `vertex_bytes`: four ones, then copied
    /// attributes.
    pub vertex_copies: Vec<f32>,
    /// From byte [`Self::first_index_copy`] of `index_bytes` on.
    pub index_copies: Vec<u32>,
    pub first_index_copy: u64,
}

impl HardwareGeometry {
    pub fn new(scene: &Scene, attributes: AttributeLayout) -> Self {
        let first_index_copy = scene.index_bytes.len().next_multiple_of(4) as u64;
        let mut geometry = Self {
            attributes,
            primitives: Vec::new(),
            vertex_copies: vec![1.0; 4],
            index_copies: Vec::new(),
            first_index_copy,
        };
        for primitive in &scene.primitives {
            let [base, emission, ..] = primitive.texcoords;
            let accessors = [
                Some(primitive.positions),
                Some(primitive.normals),
                base,
                emission,
                primitive.colors,
            ];
            let mut streams = [geometry.ones(); STREAMS];
            for ((stream, accessor), components) in
                streams.iter_mut().zip(accessors).zip(COMPONENTS)
            {
                let Some(accessor) = accessor else { continue };
                *stream = in_place(&accessor, components)
                    .unwrap_or_else(|| geometry.copy(scene, &accessor, components));
            }
            let indices = geometry.indices(scene, primitive);
            geometry.primitives.push(Fetched { streams, indices });
        }
        geometry
    }

    /// First byte of the copies in `vertex_bytes`.
    pub const fn first_copy(&self) -> u64 {
        self.attributes.bytes().next_multiple_of(4)
    }

    /// What a draw is drawn from: a deformed one from the vertices that the skin pass writes.
    pub fn of_draw(&self, draw: &Draw) -> Fetched {
        let mut fetched = self.primitives[draw.primitive].clone();
        if draw.deform.is_some() {
            let first = self.attributes.deformed_vertex(draw.first_deformable);
            for (stream, offset) in fetched
                .streams
                .iter_mut()
                .zip([first, first + u64::from(DEFORMED_BYTES / 2)])
            {
                *stream = Stream {
                    offset,
                    stride: DEFORMED_BYTES.into(),
                    is_short: false,
                };
            }
        }
        fetched
    }

    /// An attribute that a primitive lacks: every vertex reads the same four ones.
    const fn ones(&self) -> Stream {
        Stream {
            offset: self.first_copy(),
            stride: 0,
            is_short: false,
        }
    }

    /// Copies an attribute as f32, with ones for components that it lacks.
    fn copy(&mut self, scene: &Scene, accessor: &Accessor, components: u32) -> Stream {
        let offset = self.first_copy() + 4 * self.vertex_copies.len() as u64;
        let value = |vertex, component| match component < accessor.components {
            true => accessor.value(&scene.vertex_bytes, vertex, component) as f32,
            false => 1.0,
        };
        self.vertex_copies.extend(
            (0..accessor.count)
                .flat_map(|vertex| (0..components).map(move |component| (vertex, component)))
                .map(|(v, c)| value(v, c)),
        );
        Stream {
            offset,
            stride: u64::from(4 * components),
            is_short: false,
        }
    }

    /// The index list of a primitive. Lists of u8, strips and fans become triangle lists of u32.
    fn indices(&mut self, scene: &Scene, primitive: &Primitive) -> Option<Indices> {
        if primitive.is_points() && primitive.indices.is_none() {
            return None;
        }
        if primitive.topology == Topology::List {
            let indices = primitive.indices?;
            let format = match indices.component_type {
                ComponentType::U16 => Some(wgpu::IndexFormat::Uint16),
                ComponentType::U32 => Some(wgpu::IndexFormat::Uint32),
                _ => None,
            };
            let bytes = indices.component_type.bytes();
            if let Some(format) = format.filter(|_| indices.offset.is_multiple_of(bytes)) {
                let first = u64::from(indices.offset);
                return Some((
                    format,
                    first..first + u64::from(indices.count) * u64::from(bytes),
                    indices.count,
                ));
            }
        }
        let first = self.first_index_copy + 4 * self.index_copies.len() as u64;
        let last = primitive.vertex_count().saturating_sub(1);
        // All corners of a point are one.
        let corners_of_each = if primitive.is_points() { 1 } else { 3 };
        let corners = (0..primitive.triangle_count())
            .flat_map(|t| {
                primitive
                    .corners(scene, t)
                    .into_iter()
                    .take(corners_of_each)
            })
            .map(|corner| corner.min(last));
        self.index_copies.extend(corners);
        let end = self.first_index_copy + 4 * self.index_copies.len() as u64;
        Some((
            wgpu::IndexFormat::Uint32,
            first..end,
            ((end - first) / 4) as u32,
        ))
    }
}

/// An attribute where the file has it, if a vertex buffer can lie there.
fn in_place(accessor: &Accessor, components: u32) -> Option<Stream> {
    // The largest that every adapter takes.
    const MAX_STRIDE: u32 = 2048;
    // Colors of clouds have a fourth component, which they do not use.
    let is_short = accessor.component_type == ComponentType::U16
        && accessor.normalized
        && (components, accessor.stride) == (4, 8);
    let has_floats =
        accessor.component_type == ComponentType::F32 && accessor.components == components;
    let has_room = |stride: u32| stride == 0 || (4 * components..=MAX_STRIDE).contains(&stride);
    let is_fetched = is_short || has_floats && has_room(accessor.stride);
    let is_aligned = accessor.stride.is_multiple_of(4) && accessor.offset.is_multiple_of(4);
    (is_fetched && is_aligned).then(|| Stream {
        offset: accessor.offset.into(),
        stride: accessor.stride.into(),
        is_short,
    })
}
