//! Elements of accessors: what their types are called here.

use gltf::json::accessor::{ComponentType as JsonComponentType, Type};

use crate::scene::accessor::ComponentType;

pub fn component_of(kind: JsonComponentType) -> ComponentType {
    match kind {
        JsonComponentType::I8 => ComponentType::I8,
        JsonComponentType::U8 => ComponentType::U8,
        JsonComponentType::I16 => ComponentType::I16,
        JsonComponentType::U16 => ComponentType::U16,
        JsonComponentType::U32 => ComponentType::U32,
        JsonComponentType::F32 => ComponentType::F32,
    }
}

/// Components per element. Padding between the columns of small matrices is not counted; no such
/// matrix is read.
pub fn lanes_of(kind: Type) -> u32 {
    kind.multiplicity() as u32
}
