//! Buffers: the bytes of a model, its accessors after all bounds checks, and how both are copied
//! into a scene.

use std::{borrow::Cow, collections::HashMap, ops::Range};

use gltf::json::{self, validation::Checked};

use super::{
    compression::{Compression, DecodedViews},
    document,
    element::{component_of, lanes_of},
    error::{LoadError, ReadFile},
    limits::Limits,
    source::{Bytes, PART_BYTES, reserve},
    uri,
};
use crate::{
    scene::{
        accessor::{Accessor, ComponentType},
        memory::MemoryBudget,
        model::Scene,
    },
    work::checkpoint,
};

/// All buffers.
pub struct Buffers<'a> {
    /// The parsed JSON.
    pub root: &'a json::Root,
    bytes: Vec<Bytes<'a>>,
    /// The buffer views that were compressed.
    decoded: DecodedViews,
    /// What the model may have.
    pub limits: Limits,
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
    /// Some elements are replaced by sparse values.
    pub is_sparse: bool,
}

impl<'a> Buffers<'a> {
    /// Reads every buffer, and decodes what is compressed. A buffer without a URI is the binary
    /// chunk of a GLB, or has no bytes because all its views are compressed. `file` is the size
    /// of the model file.
    pub fn read(
        root: &'a mut json::Root,
        mut binary: Option<Bytes<'a>>,
        compression: &Compression,
        (file, budget): (u64, MemoryBudget),
        read: &mut ReadFile,
    ) -> Result<Self, LoadError> {
        let limits = Limits::of_files(budget);
        let mut left = limits.total_bytes;
        let mut bytes = Vec::with_capacity(root.buffers.len());
        for (index, buffer) in root.buffers.iter().enumerate() {
            if buffer.uri.is_none() && compression.is_fallback(index) {
                bytes.push(Bytes::Memory(Cow::Borrowed(&[])));
                continue;
            }
            let content = match (&buffer.uri, binary.take().filter(|_| index == 0)) {
                (Some(uri), _) => uri::resolve(uri, left.min(limits.file_bytes), read)
                    .map(|bytes| Bytes::Memory(Cow::Owned(bytes))),
                (None, Some(binary)) => Ok(binary),
                (None, None) => Err(LoadError::new(
                    "it has no URI, and the file has no binary chunk for it",
                )),
            };
            let content = content.map_err(|error| error.within(format!("buffer {index}")))?;
            if buffer.byte_length.0 > content.len() {
                let reason = format!(
                    "byteLength is {}, but the buffer has only {} bytes",
                    buffer.byte_length.0,
                    content.len()
                );
                return Err(LoadError::new(reason).within(format!("buffer {index}")));
            }
            if matches!(content, Bytes::Memory(Cow::Owned(_))) {
                left -= content.len();
            }
            bytes.push(content);
        }
        let limits = Limits::of_model(budget, file + (limits.total_bytes - left));
        let decoded = match compression.is_none() {
            true => DecodedViews::new(),
            false => compression.decode(
                root,
                &bytes
                    .iter()
                    .map(Bytes::all)
                    .collect::<Result<Vec<_>, _>>()?,
                &limits,
            )?,
        };
        Ok(Self {
            root,
            bytes,
            decoded,
            limits,
            left,
        })
    }

    /// The bytes of a buffer view. Fails if it does not exist or exceeds its buffer, or cannot be
    /// read.
    pub fn view(&self, index: usize) -> Result<&[u8], LoadError> {
        if let Some(decoded) = self.decoded.get(&index) {
            return Ok(decoded);
        }
        let (buffer, range) = self.range(index)?;
        Ok(&self.bytes[buffer].all()?[range.start as usize..range.end as usize])
    }

    /// Length of a buffer view, which is not read. Fails as [`Self::view`] does.
    pub fn view_length(&self, index: usize) -> Result<u64, LoadError> {
        match self.decoded.get(&index) {
            Some(decoded) => Ok(decoded.len() as u64),
            None => self.range(index).map(|(_, range)| range.end - range.start),
        }
    }

    /// The buffer of a view that is not compressed, and the range of its bytes there.
    fn range(&self, index: usize) -> Result<(usize, Range<u64>), LoadError> {
        let view = self
            .root
            .buffer_views
            .get(index)
            .ok_or_else(|| LoadError::new(format!("bufferView {index} does not exist")))?;
        let (buffer, start) = (view.buffer.value(), view.byte_offset.unwrap_or_default().0);
        let length = self.root.buffers.get(buffer).map_or(0, |b| b.byte_length.0);
        let there = self.bytes.get(buffer).map_or(0, Bytes::len);
        let end = start
            .checked_add(view.byte_length.0)
            .filter(|&end| end <= length && end <= there);
        let end = end.ok_or_else(|| {
            LoadError::new(format!(
                "bufferView {index} ({} bytes from byte {start}) exceeds buffer {buffer}, which has {length} bytes",
                view.byte_length.0
            ))
        })?;
        Ok((buffer, start..end))
    }

    /// Appends a buffer view at a multiple of 4 bytes and pads to one; returns the offset.
    fn append_view(&self, index: usize, bytes: &mut Vec<u8>) -> Result<u32, LoadError> {
        if let Some(decoded) = self.decoded.get(&index) {
            return append(&self.limits, bytes, decoded);
        }
        let (buffer, range) = self.range(index)?;
        let start = make_room(&self.limits, bytes, (range.end - range.start) as usize)?;
        self.bytes[buffer].append_to(bytes, range)?;
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        Ok(start)
    }

    /// Checks an accessor and its buffer view, in 64-bit arithmetic.
    pub fn layout(&self, index: usize) -> Result<Layout, LoadError> {
        let accessor = self
            .root
            .accessors
            .get(index)
            .ok_or_else(|| LoadError::new(format!("accessor {index} does not exist")))?;
        self.checked(accessor)
            .map_err(|error| error.within(format!("accessor {index}")))
    }

    fn checked(&self, accessor: &json::Accessor) -> Result<Layout, LoadError> {
        let (Checked::Valid(component_type), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(LoadError::new(
                "its type or componentType is not one of glTF 2.0",
            ));
        };
        let (component_type, components) = (component_of(component_type.0), lanes_of(kind));
        let (size, element) = (
            u64::from(component_type.bytes()),
            u64::from(component_type.bytes() * components),
        );
        let (count, offset) = (accessor.count.0, accessor.byte_offset.unwrap_or_default().0);
        // Checked before any allocation: a sparse accessor can claim any count without having
        // bytes.
        if count == 0 {
            return Err(LoadError::new("count is 0; it must be at least 1"));
        }
        if count > 3 * self.limits.triangles {
            return Err(self
                .limits
                .exceeded(format_args!("count is {count}"), 3 * self.limits.triangles));
        }
        let mut stride = element;
        if let Some(index) = accessor.buffer_view {
            let view = &self.root.buffer_views[index.value()];
            stride = view.byte_stride.map_or(element, |stride| stride.0 as u64);
            if stride < element || stride % size != 0 {
                return Err(LoadError::new(format!(
                    "byteStride is {stride}; it must be a multiple of {size} and at least {element}"
                )));
            }
            let start = view.byte_offset.unwrap_or_default().0.checked_add(offset);
            if offset % size != 0 || start.is_none_or(|start| start % size != 0) {
                return Err(LoadError::new(format!(
                    "byteOffset {offset}, added to that of its bufferView, must be a multiple of the component size, {size}"
                )));
            }
            let length = self.view_length(index.value())?;
            let end = (count - 1)
                .checked_mul(stride)
                .and_then(|last| last.checked_add(offset)?.checked_add(element));
            if end.is_none_or(|end| end > length) {
                let reason = format!(
                    "{count} elements of {stride} bytes from byte {offset} exceed bufferView {index}, which has {length} bytes"
                );
                return Err(LoadError::new(reason));
            }
        } else if accessor.sparse.is_none() {
            return Err(LoadError::new(
                "has neither a bufferView nor sparse values; add one of them",
            ));
        }
        // A sparse accessor may lie in a view that is larger than what 32 bits address; all others
        // are copied with their view.
        let (Ok(offset), Ok(stride)) = (u32::try_from(offset), u32::try_from(stride)) else {
            return Err(LoadError::new(format!(
                "byteOffset {offset} exceeds 32 bits; put the elements into a bufferView of their own"
            )));
        };
        let accessor_in_view = Accessor {
            offset,
            stride,
            component_type,
            components,
            normalized: accessor.normalized,
            count: count as u32,
        };
        Ok(Layout {
            accessor: accessor_in_view,
            view: accessor.buffer_view.map(|view| view.value()),
            is_sparse: accessor.sparse.is_some(),
        })
    }

    /// The packed elements of an accessor: its buffer view, or zeros, with the sparse values
    /// applied.
    pub fn materialized(&self, index: usize, layout: &Layout) -> Result<Vec<u8>, LoadError> {
        let Accessor {
            offset,
            stride,
            component_type,
            components,
            count,
            ..
        } = layout.accessor;
        let element = (component_type.bytes() * components) as usize;
        let needed = u64::from(count) * element as u64;
        if needed > self.limits.buffer_bytes {
            return Err(self.limits.exceeded(
                format_args!("accessor {index}: its elements take {needed} bytes"),
                self.limits.buffer_bytes,
            ));
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
            self.overlay(sparse, element, &mut bytes)
                .map_err(|error| error.within(format!("accessor {index} sparse")))?;
        }
        Ok(bytes)
    }

    fn overlay(
        &self,
        sparse: &json::accessor::sparse::Sparse,
        element: usize,
        bytes: &mut [u8],
    ) -> Result<(), LoadError> {
        let Checked::Valid(json::accessor::IndexComponentType(width)) =
            sparse.indices.component_type
        else {
            return Err(LoadError::new(
                "the componentType of its indices is not one of glTF 2.0",
            ));
        };
        let (count, width) = (sparse.count.0, component_of(width));
        let elements = (bytes.len() / element) as u64;
        if count == 0 || count > elements {
            return Err(LoadError::new(format!(
                "count is {count}; allowed: 1 to {elements}"
            )));
        }
        let part = |what: &str, view: usize, offset: u64, size: u64| {
            let bytes = self.view(view)?;
            let end = offset
                .checked_add(count * size)
                .filter(|&end| end <= bytes.len() as u64);
            end.map(|end| &bytes[offset as usize..end as usize])
                .ok_or_else(|| {
                    LoadError::new(format!(
                        "its {count} {what} exceed bufferView {view}, which has {} bytes",
                        bytes.len()
                    ))
                })
        };
        let indices = part(
            "indices",
            sparse.indices.buffer_view.value(),
            sparse.indices.byte_offset.0,
            width.bytes().into(),
        )?;
        let values = part(
            "values",
            sparse.values.buffer_view.value(),
            sparse.values.byte_offset.0,
            element as u64,
        )?;
        let reader = Accessor {
            offset: 0,
            stride: width.bytes(),
            component_type: width,
            components: 1,
            normalized: false,
            count: count as u32,
        };
        let mut previous = -1;
        for (i, value) in values.chunks_exact(element).enumerate() {
            let at = reader.integer(indices, i as u32, 0);
            if at <= previous || at >= elements as i64 {
                return Err(LoadError::new(format!(
                    "index {at} is out of order or too large; indices must increase and stay below {elements}"
                )));
            }
            bytes[at as usize * element..][..element].copy_from_slice(value);
            previous = at;
        }
        Ok(())
    }
}

/// A component type, and whether integers are normalized.
pub type Format = (ComponentType, bool);

/// The formats of most attributes.
pub const FLOAT: &[Format] = &[(ComponentType::F32, false)];
/// The formats of colors and of texture coordinates.
pub const FLOAT_OR_UNORM: &[Format] = &[
    (ComponentType::F32, false),
    (ComponentType::U8, true),
    (ComponentType::U16, true),
];
/// The formats of positions and texture coordinates under KHR_mesh_quantization.
pub const QUANTIZED: &[Format] = &[
    (ComponentType::F32, false),
    (ComponentType::I8, false),
    (ComponentType::I8, true),
    (ComponentType::U8, false),
    (ComponentType::U8, true),
    (ComponentType::I16, false),
    (ComponentType::I16, true),
    (ComponentType::U16, false),
    (ComponentType::U16, true),
];
/// The formats of normals under KHR_mesh_quantization.
pub const QUANTIZED_NORMALS: &[Format] = &[
    (ComponentType::F32, false),
    (ComponentType::I8, true),
    (ComponentType::I16, true),
];

/// A scene under construction that receives bytes of the file, each buffer view and each sparse
/// accessor once.
pub struct SceneWriter<'a> {
    buffers: &'a Buffers<'a>,
    /// What has been read so far.
    pub scene: Scene,
    /// The file declares KHR_mesh_quantization: attributes may be small integers.
    pub is_quantized: bool,
    /// Where copied bytes begin in `Scene::vertex_bytes`.
    vertex_offsets: HashMap<Source, u32>,
    /// Where copied bytes begin in `Scene::index_bytes`.
    index_offsets: HashMap<Source, u32>,
}

/// A source of bytes that several primitives may share.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Source {
    View(usize),
    Accessor(usize),
}

impl<'a> SceneWriter<'a> {
    /// Adds to `scene`.
    pub fn new(buffers: &'a Buffers<'a>, scene: Scene) -> Self {
        let is_quantized = buffers
            .root
            .extensions_used
            .iter()
            .any(|name| name == document::QUANTIZATION);
        Self {
            buffers,
            scene,
            is_quantized,
            vertex_offsets: HashMap::new(),
            index_offsets: HashMap::new(),
        }
    }

    /// An accessor of the file after all checks; its offset counts from its buffer view.
    pub fn accessor(&self, index: usize) -> Result<Accessor, LoadError> {
        Ok(self.buffers.layout(index)?.accessor)
    }

    /// Copies an attribute of `count` vertices if its number of components and its format are
    /// allowed.
    pub fn attribute(
        &mut self,
        index: usize,
        count: u32,
        components: &[u32],
        formats: &[Format],
    ) -> Result<Accessor, LoadError> {
        let accessor = self.accessor(index)?;
        if !components.contains(&accessor.components)
            || !formats.contains(&(accessor.component_type, accessor.normalized))
        {
            return Err(wrong_type(index, &accessor));
        }
        if accessor.count != count {
            return Err(LoadError::new(format!(
                "accessor {index} has {} elements, but the primitive has {count} vertices",
                accessor.count
            )));
        }
        self.copy_attribute(index)
    }

    /// Copies an attribute that was checked before.
    pub fn copy_attribute(&mut self, index: usize) -> Result<Accessor, LoadError> {
        copy(
            self.buffers,
            index,
            &mut self.vertex_offsets,
            &mut self.scene.vertex_bytes,
        )
    }

    /// Copies an index list.
    pub fn indices(&mut self, index: usize) -> Result<Accessor, LoadError> {
        let accessor = self.accessor(index)?;
        let is_index = matches!(
            accessor.component_type,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        ) && accessor.components == 1
            && !accessor.normalized;
        if !is_index {
            return Err(wrong_type(index, &accessor));
        }
        if accessor.stride != accessor.component_type.bytes() {
            return Err(LoadError::new(format!(
                "the bufferView of accessor {index} has a byteStride; indices must not have one"
            )));
        }
        copy(
            self.buffers,
            index,
            &mut self.index_offsets,
            &mut self.scene.index_bytes,
        )
    }

    /// Appends an attribute that the file does not have.
    pub fn append_vectors(
        &mut self,
        count: usize,
        vectors: impl Iterator<Item = [f32; 3]>,
    ) -> Result<Accessor, LoadError> {
        let bytes = &mut self.scene.vertex_bytes;
        let offset = make_room(&self.buffers.limits, bytes, 12 * count)?;
        vectors
            .take(count)
            .for_each(|vector| bytes.extend_from_slice(bytemuck::bytes_of(&vector)));
        Ok(Accessor::packed_f32(offset as usize, 3, count))
    }
}

fn wrong_type(index: usize, accessor: &Accessor) -> LoadError {
    let normalized = if accessor.normalized {
        " normalized"
    } else {
        ""
    };
    let format = format!(
        "{} x {:?}{normalized}",
        accessor.components, accessor.component_type
    );
    LoadError::new(format!(
        "accessor {index} has the type {format}, which glTF does not allow for it"
    ))
}

/// Copies the buffer view of an accessor, or its sparse elements, unless that was done before.
fn copy(
    buffers: &Buffers,
    index: usize,
    offsets: &mut HashMap<Source, u32>,
    bytes: &mut Vec<u8>,
) -> Result<Accessor, LoadError> {
    let layout = buffers.layout(index)?;
    let accessor = layout.accessor;
    let (source, copied) = match layout.view {
        Some(view) if !layout.is_sparse => (Source::View(view), accessor),
        _ => (
            Source::Accessor(index),
            Accessor {
                offset: 0,
                stride: accessor.component_type.bytes() * accessor.components,
                ..accessor
            },
        ),
    };
    let start = match offsets.get(&source) {
        Some(&start) => start,
        None => {
            let start = match source {
                Source::View(view) => buffers.append_view(view, bytes)?,
                Source::Accessor(_) => append(
                    &buffers.limits,
                    bytes,
                    &buffers.materialized(index, &layout)?,
                )?,
            };
            offsets.insert(source, start);
            start
        }
    };
    Ok(Accessor {
        offset: start + copied.offset,
        ..copied
    })
}

/// Makes room for so many bytes, padded to a multiple of 4; returns the offset.
fn make_room(limits: &Limits, bytes: &mut Vec<u8>, more: usize) -> Result<u32, LoadError> {
    let total = bytes.len() as u64 + more.next_multiple_of(4) as u64;
    if total > limits.buffer_bytes {
        return Err(limits.exceeded(
            format_args!("the model needs {total} bytes or more in one buffer"),
            limits.buffer_bytes,
        ));
    }
    // Exactly, since what doubling reserves would count as well. Small pieces are many, as a rule.
    if more >= PART_BYTES {
        reserve(bytes, total - bytes.len() as u64)?;
    }
    Ok(bytes.len() as u32)
}

/// Appends at a multiple of 4 bytes and pads to one; returns the offset.
fn append(limits: &Limits, bytes: &mut Vec<u8>, more: &[u8]) -> Result<u32, LoadError> {
    let start = make_room(limits, bytes, more.len())?;
    let checkpoint = checkpoint();
    for part in more.chunks(PART_BYTES) {
        bytes.extend_from_slice(part);
        checkpoint.pass()?;
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    Ok(start)
}
