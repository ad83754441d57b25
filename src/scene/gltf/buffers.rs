//! Buffers: the bytes of a model, and its accessors after all bounds checks.

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
    /// Bytes that the model may still read from files.
    pub left: u64,
}

/// An accessor that has passed all checks.
#[derive(Clone, Copy)]
pub struct Layout {
    /// `offset` counts from the first byte of its buffer view.
    pub accessor: Accessor,
    /// The buffer view. `None`: all elements are zero except sparse ones.
    pub view: Option<usize>,
    pub is_sparse: bool,
}

impl<'a> Buffers<'a> {
    /// Reads every buffer. A buffer without a URI is the binary chunk of a GLB.
    pub fn read(root: &'a json::Root, binary: Option<&'a [u8]>, read: &mut ReadFile) -> Result<Self, LoadError> {
        let mut left = limits::TOTAL_BYTES;
        let mut bytes = Vec::with_capacity(root.buffers.len());
        for (index, buffer) in root.buffers.iter().enumerate() {
            let content = match (&buffer.uri, binary) {
                (Some(uri), _) => uri::resolve(uri, left.min(limits::FILE_BYTES), read).map(Cow::Owned),
                (None, Some(binary)) if index == 0 => Ok(Cow::Borrowed(binary)),
                (None, _) => Err(LoadError::new("it has no URI, and the file has no binary chunk for it")),
            };
            let content: Cow<[u8]> = content.map_err(|error| error.within(format!("buffer {index}")))?;
            if buffer.byte_length.0 > content.len() as u64 {
                let reason = format!("byteLength is {}, but the buffer has only {} bytes", buffer.byte_length.0, content.len());
                return Err(LoadError::new(reason).within(format!("buffer {index}")));
            }
            if matches!(content, Cow::Owned(_)) {
                left -= content.len() as u64;
            }
            bytes.push(content);
        }
        Ok(Self { root, bytes, left })
    }

    /// The bytes of a buffer view. Fails if it does not exist or exceeds its buffer.
    pub fn view(&self, index: usize) -> Result<&[u8], LoadError> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| LoadError::new(format!("bufferView {index} does not exist")))?;
        let (buffer, start) = (view.buffer.value(), view.byte_offset.unwrap_or_default().0);
        let length = self.root.buffers.get(buffer).map_or(0, |b| b.byte_length.0);
        let bytes = self.bytes.get(buffer).map_or(&[][..], |bytes| bytes);
        let end = start.checked_add(view.byte_length.0).filter(|&end| end <= length && end <= bytes.len() as u64);
        let end = end.ok_or_else(|| {
            LoadError::new(format!(
                "bufferView {index} ({} bytes from byte {start}) exceeds buffer {buffer}, which has {length} bytes",
                view.byte_length.0
            ))
        })?;
        Ok(&bytes[start as usize..end as usize])
    }

    /// Checks an accessor and its buffer view, in 64-bit arithmetic.
    pub fn layout(&self, index: usize) -> Result<Layout, LoadError> {
        let accessor = self.root.accessors.get(index).ok_or_else(|| LoadError::new(format!("accessor {index} does not exist")))?;
        self.checked(accessor).map_err(|error| error.within(format!("accessor {index}")))
    }

    fn checked(&self, accessor: &json::Accessor) -> Result<Layout, LoadError> {
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(LoadError::new("its type or componentType is not one of glTF 2.0"));
        };
        let (component, components) = (component_of(component.0), lanes_of(kind));
        let (size, element) = (u64::from(component.bytes()), u64::from(component.bytes() * components));
        let (count, offset) = (accessor.count.0, accessor.byte_offset.unwrap_or_default().0);
        // Checked before any allocation: a sparse accessor can claim any count without having bytes.
        if count == 0 || count > 3 * limits::TRIANGLES {
            return Err(LoadError::new(format!("count is {count}; allowed: 1 to {}", 3 * limits::TRIANGLES)));
        }
        let mut stride = element;
        if let Some(index) = accessor.buffer_view {
            let view = &self.root.buffer_views[index.value()];
            stride = view.byte_stride.map_or(element, |stride| stride.0 as u64);
            if stride < element || stride % size != 0 {
                return Err(LoadError::new(format!("byteStride is {stride}; it must be a multiple of {size} and at least {element}")));
            }
            let start = view.byte_offset.unwrap_or_default().0.checked_add(offset);
            if offset % size != 0 || start.is_none_or(|start| start % size != 0) {
                return Err(LoadError::new(format!("byteOffset {offset}, added to that of its bufferView, must be a multiple of the component size, {size}")));
            }
            let length = self.view(index.value())?.len() as u64;
            let end = (count - 1).checked_mul(stride).and_then(|last| last.checked_add(offset)?.checked_add(element));
            if end.is_none_or(|end| end > length) {
                let reason = format!("{count} elements of {stride} bytes from byte {offset} exceed bufferView {index}, which has {length} bytes");
                return Err(LoadError::new(reason));
            }
        } else if accessor.sparse.is_none() {
            return Err(LoadError::new("has neither a bufferView nor sparse values; add one of them"));
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

    /// The packed elements of an accessor: its buffer view, or zeros, with the sparse values applied.
    pub fn materialized(&self, index: usize, layout: &Layout) -> Result<Vec<u8>, LoadError> {
        let Accessor { offset, stride, component, components, count, .. } = layout.accessor;
        let element = (component.bytes() * components) as usize;
        if u64::from(count) * element as u64 > limits::BINDING_BYTES {
            return Err(LoadError::new(format!("accessor {index}: {count} elements exceed the limit of {} bytes", limits::BINDING_BYTES)));
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
            return Err(LoadError::new("the componentType of its indices is not one of glTF 2.0"));
        };
        let (count, width) = (sparse.count.0, component_of(width));
        let elements = (bytes.len() / element) as u64;
        if count == 0 || count > elements {
            return Err(LoadError::new(format!("count is {count}; allowed: 1 to {elements}")));
        }
        let part = |what: &str, view: usize, offset: u64, size: u64| {
            let bytes = self.view(view)?;
            let end = offset.checked_add(count * size).filter(|&end| end <= bytes.len() as u64);
            end.map(|end| &bytes[offset as usize..end as usize])
                .ok_or_else(|| LoadError::new(format!("its {count} {what} exceed bufferView {view}, which has {} bytes", bytes.len())))
        };
        let indices = part("indices", sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, width.bytes().into())?;
        let values = part("values", sparse.values.buffer_view.value(), sparse.values.byte_offset.0, element as u64)?;
        let reader = Accessor { offset: 0, stride: width.bytes(), component: width, components: 1, normalized: false, count: count as u32 };
        let mut previous = -1;
        for (i, value) in values.chunks_exact(element).enumerate() {
            let at = reader.integer(indices, i as u32, 0);
            if at <= previous || at >= elements as i64 {
                return Err(LoadError::new(format!("index {at} is out of order or too large; indices must increase and stay below {elements}")));
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

/// Components per element. Padding between the columns of small matrices is not counted; no such matrix is read.
fn lanes_of(kind: Type) -> u32 {
    kind.multiplicity() as u32
}
