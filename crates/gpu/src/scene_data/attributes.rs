//! The layout of `vertex_bytes`: attributes as the file has them, then vertices that joints and
//! morph targets deform, then packed positions, then the matrices of instances, then the boxes of
//! blocks of points.

use super::{packing, point_boxes};
use crate::scene::{Accessor, Scene};

/// Bytes of a deformed vertex: position and normal, three floats each.
pub const DEFORMED_BYTES: u32 = 24;

/// Words of an instance's matrices: `PLACEMENT_WORDS` of `shaders/variants/draw_records.wgsl`.
pub const PLACEMENT_WORDS: usize = 21;

/// Bytes of each part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AttributeLayout {
    file: u64,
    deformed: u64,
    packed: u64,
    placements: u64,
    boxes: u64,
    /// Bits per axis of packed positions, where there are any.
    pub packed_bits: Option<u32>,
}

impl AttributeLayout {
    /// The layout of a scene with positions packed to so many bits per axis, if any.
    pub fn new(scene: &Scene, packed_bits: Option<u32>) -> Self {
        Self {
            file: scene.vertex_bytes.len() as u64,
            deformed: u64::from(DEFORMED_BYTES) * scene.deformable_vertex_count(),
            packed: packed_bits.map_or(0, |bits| packing::bytes_of(scene, bits)),
            placements: if scene.is_instanced() {
                (size_of::<[f32; PLACEMENT_WORDS]>() * scene.instances.len()) as u64
            } else {
                0
            },
            boxes: point_boxes::bytes_of(scene),
            packed_bits,
        }
    }

    /// Bytes in all.
    pub const fn bytes(&self) -> u64 {
        self.first_box() + self.boxes
    }

    /// First byte of the boxes of blocks of points.
    pub const fn first_box(&self) -> u64 {
        (self.first_placement() + self.placements).next_multiple_of(4)
    }

    /// First byte of a vertex that may be deformed, by its index among all of those.
    pub const fn deformed_vertex(&self, index: u32) -> u64 {
        self.file + DEFORMED_BYTES as u64 * index as u64
    }

    /// First byte of the packed positions.
    pub const fn first_packed(&self) -> u64 {
        self.file + self.deformed
    }

    /// First byte of the matrices of instances.
    pub const fn first_placement(&self) -> u64 {
        self.first_packed() + self.packed
    }

    /// Are there matrices of instances?
    pub const fn has_placements(&self) -> bool {
        self.placements > 0
    }

    /// What the buffer holds, for `explain`.
    pub const fn purpose(&self) -> &'static str {
        match (self.deformed, self.packed_bits) {
            _ if self.has_placements() => {
                "attributes as the file has them, then matrices of instances, 84 bytes each"
            }
            (0, None) => "attributes as the file has them",
            (0, Some(10)) => "attributes as the file has them, then packed positions, 4 bytes each",
            (0, Some(_)) => "attributes as the file has them, then packed positions, 8 bytes each",
            _ => "attributes as the file has them, then deformed vertices, 24 bytes each",
        }
    }
}

/// Component type in bits 0 to 2, normalized in bit 3 (`shaders/lib/attributes.wgsl`), number of
/// components from bit 8.
pub fn format_word(accessor: &Accessor) -> u32 {
    (accessor.component_type as u32 - 5120)
        | u32::from(accessor.normalized) << 3
        | accessor.components << 8
}
