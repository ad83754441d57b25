//! Index lists that the file does not have, as of lines whose corners are each joined to the next.

use super::{
    buffers::{SceneWriter, append, make_room},
    document::Chain,
    error::LoadError,
};
use crate::scene::accessor::{Accessor, ComponentType};

impl SceneWriter<'_> {
    /// Appends the index list of the segments of a line through these corners, or through so many
    /// vertices in order.
    pub fn joined(
        &mut self,
        corners: Option<Accessor>,
        vertices: u32,
        chain: Chain,
    ) -> Result<Accessor, LoadError> {
        let count = corners.map_or(vertices, |corners| corners.count);
        let segments = match chain {
            Chain::Open => count.saturating_sub(1),
            Chain::Closed => count,
        };
        let bytes = &mut self.scene.index_bytes;
        let offset = make_room(&self.buffers.limits, bytes, 8 * segments as usize)?;
        for corner in (0..segments).flat_map(|at| [at, (at + 1) % count]) {
            let index = match corners {
                Some(corners) => corners.integer(bytes, corner, 0) as u32,
                None => corner,
            };
            bytes.extend_from_slice(&index.to_le_bytes());
        }
        Ok(list(offset, 2 * segments))
    }

    /// Appends an index list.
    pub fn append_indices(&mut self, indices: &[u32]) -> Result<Accessor, LoadError> {
        let (limits, bytes) = (&self.buffers.limits, &mut self.scene.index_bytes);
        let offset = append(limits, bytes, bytemuck::cast_slice(indices))?;
        Ok(list(offset, indices.len() as u32))
    }
}

fn list(offset: u32, count: u32) -> Accessor {
    Accessor {
        offset,
        stride: 4,
        component_type: ComponentType::U32,
        components: 1,
        normalized: false,
        count,
    }
}
