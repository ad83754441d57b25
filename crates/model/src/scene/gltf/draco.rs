//! KHR_draco_mesh_compression: vertices and indices of a primitive, decoded by the crate
//! `draco-core`.

use std::collections::BTreeMap;

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex,
};
use serde::Deserialize;

use super::{error::LoadError, limits::Limits};
use crate::scene::accessor::ComponentType;

/// A compressed primitive.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CompressedPrimitive {
    pub buffer_view: usize,
    /// The id in the compressed data of each attribute, by its name.
    pub attributes: BTreeMap<String, u32>,
}

/// A decoded primitive.
pub struct Decoded(Mesh);

impl Decoded {
    /// Decodes a stream within `limits`.
    ///
    /// # Errors
    /// The stream is malformed, or holds more than a model may.
    pub fn of(bytes: &[u8], limits: &Limits) -> Result<Self, LoadError> {
        let allowed = DecodeLimits::default()
            .with_max_points(limits.vertices)
            .with_max_faces(limits.triangles)
            .with_max_decoded_bytes(limits.buffer_bytes);
        let mut mesh = Mesh::new();
        let decoded = MeshDecoder::new().decode(
            &mut DecoderBuffer::new(bytes).with_limits(allowed),
            &mut mesh,
        );
        decoded.map_err(|error| {
            LoadError::new(format!(
                "its Draco data cannot be decoded: {}",
                error.to_string().replace('\n', " ")
            ))
        })?;
        Ok(Self(mesh))
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.0.num_points()
    }

    /// Number of indices: three for each triangle.
    pub fn indices(&self) -> usize {
        3 * self.0.num_faces()
    }

    /// The indices as integers of a type.
    ///
    /// # Errors
    /// One does not fit the type.
    pub fn index_bytes(&self, component_type: ComponentType) -> Result<Vec<u8>, LoadError> {
        let mut bytes = Vec::with_capacity(self.indices() * component_type.bytes() as usize);
        for corner in self.0.faces().iter().flatten() {
            let index = corner.0;
            let too_large = || {
                LoadError::new(format!(
                    "its Draco data has index {index}, which does not fit the type of its accessor"
                ))
            };
            match component_type {
                ComponentType::U8 => bytes.push(u8::try_from(index).map_err(|_| too_large())?),
                ComponentType::U16 => {
                    bytes.extend(u16::try_from(index).map_err(|_| too_large())?.to_le_bytes())
                }
                _ => bytes.extend(index.to_le_bytes()),
            }
        }
        Ok(bytes)
    }

    /// The packed values of attribute `id` for every vertex.
    ///
    /// # Errors
    /// There is no such attribute, it has another type, or a vertex has no value.
    pub fn attribute_bytes(
        &self,
        id: u32,
        component_type: ComponentType,
        components: u32,
    ) -> Result<Vec<u8>, LoadError> {
        let attribute = self
            .0
            .attribute_by_unique_id(id)
            .ok_or_else(|| LoadError::new(format!("its Draco data has no attribute {id}")))?;
        let lanes = u32::from(attribute.num_components());
        if component_of(attribute.data_type()) != Some(component_type) || lanes != components {
            return Err(LoadError::new(format!(
                "its Draco data has {lanes} x {:?} for attribute {id}, and its accessor {components} x {component_type:?}",
                attribute.data_type()
            )));
        }
        let element = (component_type.bytes() * components) as usize;
        let mut bytes = Vec::with_capacity(self.vertices() * element);
        for vertex in 0..self.vertices() {
            let value = value(attribute, vertex, element);
            bytes.extend(value.ok_or_else(|| {
                LoadError::new(format!(
                    "its Draco data has no value for vertex {vertex} of attribute {id}"
                ))
            })?);
        }
        Ok(bytes)
    }
}

/// The bytes of a vertex.
fn value(attribute: &PointAttribute, vertex: usize, element: usize) -> Option<&[u8]> {
    let entry = attribute.mapped_index(PointIndex(vertex as u32)).0 as usize;
    let start = entry.checked_mul(usize::try_from(attribute.byte_stride()).ok()?)?;
    attribute
        .buffer()
        .data()
        .get(start..start.checked_add(element)?)
}

fn component_of(data_type: DataType) -> Option<ComponentType> {
    match data_type {
        DataType::Int8 => Some(ComponentType::I8),
        DataType::Uint8 => Some(ComponentType::U8),
        DataType::Int16 => Some(ComponentType::I16),
        DataType::Uint16 => Some(ComponentType::U16),
        DataType::Uint32 => Some(ComponentType::U32),
        DataType::Float32 => Some(ComponentType::F32),
        _ => None,
    }
}
