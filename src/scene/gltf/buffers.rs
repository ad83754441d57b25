//! Buffers: the bytes of a model, and accessors proven to lie inside them.

use std::borrow::Cow;

use gltf::json::{
    self,
    accessor::{ComponentType, Type},
    validation::Checked,
};

use super::{LoadError, ReadFile, limits, uri};
use crate::scene::{Accessor, Component};

/// All buffers, in memory.
pub struct Buffers<'a> {
    pub root: &'a json::Root,
    bytes: Vec<Cow<'a, [u8]>>,
    /// Of the budget for all files of the model.
    pub left: u64,
}

/// Where the elements of an accessor lie, after all checks.
#[derive(Clone, Copy)]
pub struct Layout {
    /// As it lies in its view: `offset` counts from the view's first byte.
    pub accessor: Accessor,
    /// None: all elements are zero, but for a sparse overlay.
    pub view: Option<usize>,
    pub is_sparse: bool,
}

impl<'a> Buffers<'a> {
    /// Reads every buffer; a buffer without URI is the binary chunk.
    pub fn read(root: &'a json::Root, binary: Option<&'a [u8]>, read: &mut ReadFile) -> Result<Self, LoadError> {
        let mut left = limits::TOTAL_BYTES;
        let mut bytes = Vec::with_capacity(root.buffers.len());
        for (index, buffer) in root.buffers.iter().enumerate() {
            let content = match (&buffer.uri, binary) {
                (Some(uri), _) => uri::resolve(uri, left.min(limits::FILE_BYTES), read).map(Cow::Owned),
                (None, Some(binary)) if index == 0 => Ok(Cow::Borrowed(binary)),
                (None, _) => Err(LoadError::new("has neither a URI nor a binary chunk")),
            };
            let content: Cow<[u8]> = content.map_err(|error| error.within(format!("buffer {index}")))?;
            if buffer.byte_length.0 > content.len() as u64 {
                let reason = format!("byteLength is {}, but only {} bytes are there", buffer.byte_length.0, content.len());
                return Err(LoadError::new(reason).within(format!("buffer {index}")));
            }
            if matches!(content, Cow::Owned(_)) {
                left -= content.len() as u64;
            }
            bytes.push(content);
        }
        Ok(Self { root, bytes, left })
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize) -> Result<&[u8], LoadError> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| LoadError::new(format!("bufferView {index} does not exist")))?;
        let (buffer, start) = (view.buffer.value(), view.byte_offset.unwrap_or_default().0);
        let length = self.root.buffers.get(buffer).map_or(0, |b| b.byte_length.0);
        let bytes = self.bytes.get(buffer).map_or(&[][..], |bytes| bytes);
        let end = start.checked_add(view.byte_length.0).filter(|&end| end <= length && end <= bytes.len() as u64);
        let end = end.ok_or_else(|| {
            LoadError::new(format!(
                "bufferView {index} ({} bytes from {start}) ends past buffer {buffer} ({length} bytes)",
                view.byte_length.0
            ))
        })?;
        Ok(&bytes[start as usize..end as usize])
    }

    /// Checks an accessor in itself and against its view, in 64 bits.
    pub fn layout(&self, index: usize) -> Result<Layout, LoadError> {
        let accessor = self.root.accessors.get(index).ok_or_else(|| LoadError::new(format!("accessor {index} does not exist")))?;
        self.checked(accessor).map_err(|error| error.within(format!("accessor {index}")))
    }

    fn checked(&self, accessor: &json::Accessor) -> Result<Layout, LoadError> {
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(LoadError::new("its type is unknown"));
        };
        let (component, components) = (component_of(component.0), lanes_of(kind));
        let (size, element) = (u64::from(component.bytes()), u64::from(component.bytes() * components));
        let (count, offset) = (accessor.count.0, accessor.byte_offset.unwrap_or_default().0);
        // Before anything is allocated: a sparse accessor needs no bytes to claim any count.
        if count == 0 || count > 3 * limits::TRIANGLES {
            return Err(LoadError::new(format!("count {count} lies outside 1..={}", 3 * limits::TRIANGLES)));
        }
        let mut stride = element;
        if let Some(index) = accessor.buffer_view {
            let view = &self.root.buffer_views[index.value()];
            stride = view.byte_stride.map_or(element, |stride| stride.0 as u64);
            if stride < element || stride % size != 0 {
                return Err(LoadError::new(format!("byteStride {stride} must be a multiple of {size} and at least {element}")));
            }
            let start = view.byte_offset.unwrap_or_default().0.checked_add(offset);
            if offset % size != 0 || start.is_none_or(|start| start % size != 0) {
                return Err(LoadError::new(format!("byteOffset {offset} does not align with its components of {size} bytes")));
            }
            let length = self.view(index.value())?.len() as u64;
            let end = (count - 1).checked_mul(stride).and_then(|last| last.checked_add(offset)?.checked_add(element));
            if end.is_none_or(|end| end > length) {
                let reason = format!("{count} elements of {stride} bytes from {offset} end past bufferView {index} ({length} bytes)");
                return Err(LoadError::new(reason));
            }
        } else if accessor.sparse.is_none() {
            return Err(LoadError::new("has no bufferView, which is not supported"));
        }
        let accessor_in_view = Accessor {
            offset: offset as u32,
            stride: stride as u32,
            component,
            components,
            normalized: accessor.normalized,
            count: count as u32,
        };
        Ok(Layout { accessor: accessor_in_view, view: accessor.buffer_view.map(|view| view.value()), is_sparse: accessor.sparse.is_some() })
    }

    /// Elements of a sparse accessor, packed: the base or zeros, with the overlay in place.
    pub fn materialized(&self, index: usize, layout: &Layout) -> Result<Vec<u8>, LoadError> {
        let Accessor { offset, stride, component, components, count, .. } = layout.accessor;
        let element = (component.bytes() * components) as usize;
        if u64::from(count) * element as u64 > limits::BINDING_BYTES {
            return Err(LoadError::new(format!("accessor {index}: {count} elements exceed {} bytes", limits::BINDING_BYTES)));
        }
        let mut bytes = vec![0; element * count as usize];
        if let Some(view) = layout.view {
            let from = self.view(view)?;
            for (i, to) in bytes.chunks_exact_mut(element).enumerate() {
                let at = offset as usize + i * stride as usize;
                to.copy_from_slice(&from[at..at + element]);
            }
        }
        if let Some(sparse) = &self.root.accessors[index].sparse {
            self.overlay(sparse, element, &mut bytes).map_err(|error| error.within(format!("accessor {index} sparse")))?;
        }
        Ok(bytes)
    }

    fn overlay(&self, sparse: &json::accessor::sparse::Sparse, element: usize, bytes: &mut [u8]) -> Result<(), LoadError> {
        let Checked::Valid(json::accessor::IndexComponentType(width)) = sparse.indices.component_type else {
            return Err(LoadError::new("its index type is unknown"));
        };
        let (count, width) = (sparse.count.0, component_of(width));
        let elements = (bytes.len() / element) as u64;
        if count == 0 || count > elements {
            return Err(LoadError::new(format!("count {count} lies outside 1..={elements}")));
        }
        let part = |what: &str, view: usize, offset: u64, size: u64| {
            let bytes = self.view(view)?;
            let end = offset.checked_add(count * size).filter(|&end| end <= bytes.len() as u64);
            end.map(|end| &bytes[offset as usize..end as usize])
                .ok_or_else(|| LoadError::new(format!("its {count} {what} end past bufferView {view} ({} bytes)", bytes.len())))
        };
        let indices = part("indices", sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, width.bytes().into())?;
        let values = part("values", sparse.values.buffer_view.value(), sparse.values.byte_offset.0, element as u64)?;
        let reader = Accessor { offset: 0, stride: width.bytes(), component: width, components: 1, normalized: false, count: count as u32 };
        let mut previous = -1;
        for (i, value) in values.chunks_exact(element).enumerate() {
            let at = reader.integer(indices, i as u32, 0);
            if at <= previous || at >= elements as i64 {
                return Err(LoadError::new(format!("index {at} must rise and stay below {elements}")));
            }
            bytes[at as usize * element..][..element].copy_from_slice(value);
            previous = at;
        }
        Ok(())
    }
}

fn component_of(kind: ComponentType) -> Component {
    match kind {
        ComponentType::I8 => Component::I8,
        ComponentType::U8 => Component::U8,
        ComponentType::I16 => Component::I16,
        ComponentType::U16 => Component::U16,
        ComponentType::U32 => Component::U32,
        ComponentType::F32 => Component::F32,
    }
}

/// Numbers per element; columns of small matrices are padded, but none of those is read.
fn lanes_of(kind: Type) -> u32 {
    kind.multiplicity() as u32
}
