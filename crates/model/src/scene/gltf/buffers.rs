//! Buffers: the bytes of a model, its accessors after all bounds checks, and how both are copied
//! into a scene.

use std::{borrow::Cow, collections::HashMap, ops::Range};

use super::{
    compression::DecodedData,
    document::{self, Document, Sparse},
    error::{LoadError, ReadFile},
    limits::Limits,
    notes::Notes,
    other_file,
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
    pub document: &'a Document,
    /// Messages to the user.
    pub notes: &'a Notes,
    /// The bytes of each buffer, or why there are none.
    bytes: Vec<Result<Bytes<'a>, String>>,
    /// What was compressed.
    decoded: DecodedData,
    /// What the model may have.
    pub limits: Limits,
    /// What its images may have once they are decoded: they are compressed too well for their
    /// bytes to tell.
    pub image_limits: Limits,
    /// Bytes that the model may still read from files.
    pub left: u64,
}

/// An accessor that has passed all checks.
#[derive(Clone, Copy)]
pub struct Layout {
    /// `offset` counts from the first byte of its buffer view.
    pub accessor: Accessor,
    /// Where its elements lie. `None`: all elements are zero except sparse ones.
    pub view: Option<Source>,
    /// Elements cannot be read where they lie: some are replaced by sparse values, or lie at
    /// places that their type does not allow.
    is_packed: bool,
}

impl<'a> Buffers<'a> {
    /// Reads every buffer, and decodes what is compressed. A buffer without a URI is the binary
    /// chunk of a GLB, or has no bytes because all its views are compressed. What cannot be read
    /// costs only the parts that use it. `file` is the size of the model file.
    ///
    /// # Errors
    /// The files together exceed their limit, or loading was canceled.
    pub fn read(
        document: &'a Document,
        mut binary: Option<Bytes<'a>>,
        (file, budget): (u64, MemoryBudget),
        read: &mut ReadFile,
        notes: &'a Notes,
    ) -> Result<Self, LoadError> {
        let limits = Limits::of_files(budget);
        let mut left = limits.total_bytes;
        let mut bytes = Vec::with_capacity(document.buffers.len());
        for (index, buffer) in document.buffers.iter().enumerate() {
            let binary = binary.take().filter(|_| index == 0);
            let content = match buffer {
                Err(reason) => Err(LoadError::new(reason)),
                Ok(buffer) => match (&buffer.uri, binary) {
                    (Some(uri), _) => uri::resolve(uri, left.min(limits.file_bytes), read)
                        .map(|bytes| Bytes::Memory(Cow::Owned(bytes))),
                    (None, Some(binary)) => Ok(binary),
                    (None, None) if buffer.is_fallback => Ok(Bytes::Memory(Cow::Borrowed(&[]))),
                    (None, None) => Err(LoadError::new(
                        "it has no URI, and the file has no binary chunk for it",
                    )),
                },
            };
            let content = match content {
                Ok(content) => Ok(content),
                Err(error) => Err(error.within(format_args!("buffer {index}")).of_part()?),
            };
            if let Ok(content @ Bytes::Memory(Cow::Owned(_))) = &content {
                left -= content.len();
            }
            bytes.push(content);
        }
        let mut buffers = Self {
            document,
            notes,
            bytes,
            decoded: DecodedData::default(),
            limits: Limits::of_model(budget, file + (limits.total_bytes - left)),
            image_limits: limits,
            left,
        };
        buffers.decoded = DecodedData::of(&buffers)?;
        Ok(buffers)
    }

    /// The bytes of a buffer view. Fails if it does not exist or exceeds its buffer, or cannot be
    /// read.
    pub fn view(&self, index: usize) -> Result<&[u8], LoadError> {
        if let Some(decoded) = self.decoded.views.get(&index) {
            return decoded.as_deref().map_err(LoadError::new);
        }
        let (bytes, range) = self.range(index)?;
        Ok(&bytes.all()?[range.start as usize..range.end as usize])
    }

    /// `length` bytes of a buffer, from byte `start`.
    pub fn part(&self, buffer: usize, start: u64, length: u64) -> Result<&[u8], LoadError> {
        let bytes = self.buffer(buffer)?.all()?;
        let end = start
            .checked_add(length)
            .filter(|&end| end <= bytes.len() as u64);
        let part = end.map(|end| &bytes[start as usize..end as usize]);
        part.ok_or_else(|| {
            LoadError::new(format!(
                "{length} bytes from byte {start} exceed buffer {buffer}, which has {} bytes",
                bytes.len()
            ))
        })
    }

    fn buffer(&self, index: usize) -> Result<&Bytes<'a>, LoadError> {
        match self.bytes.get(index) {
            Some(bytes) => bytes.as_ref().map_err(LoadError::new),
            None => Err(LoadError::new(format!("buffer {index} does not exist"))),
        }
    }

    /// The bytes where an accessor's elements lie.
    fn source(&self, source: Source) -> Result<&[u8], LoadError> {
        match source {
            Source::View(index) => self.view(index),
            Source::Accessor(index) => match self.decoded.accessors.get(&index) {
                Some(decoded) => decoded.as_deref().map_err(LoadError::new),
                None => Err(LoadError::new(format!(
                    "accessor {index} is not compressed"
                ))),
            },
        }
    }

    /// Length of a buffer view, which is not read. Fails as [`Self::view`] does.
    pub fn view_length(&self, index: usize) -> Result<u64, LoadError> {
        match self.decoded.views.get(&index) {
            Some(decoded) => Ok(decoded.as_ref().map_err(LoadError::new)?.len() as u64),
            None => self.range(index).map(|(_, range)| range.end - range.start),
        }
    }

    /// The buffer of a view that is not compressed, and the range of its bytes there.
    fn range(&self, index: usize) -> Result<(&Bytes<'a>, Range<u64>), LoadError> {
        let view = match self.document.views.get(index) {
            Some(view) => view.as_ref().map_err(|reason| {
                LoadError::new(reason).within(format_args!("bufferView {index}"))
            })?,
            None => return Err(LoadError::new(format!("bufferView {index} does not exist"))),
        };
        let (bytes, start) = (self.buffer(view.buffer)?, view.offset);
        let stated = match &self.document.buffers[view.buffer] {
            Ok(buffer) => buffer.length,
            Err(_) => 0,
        };
        let there = bytes.len();
        if stated > there {
            let what = bytes.all().ok().and_then(other_file::named);
            let what = what.map_or(String::new(), |what| format!("; {what}"));
            self.notes.cut_off(format!(
                "buffer {}: byteLength is {stated}, but the buffer has only {there} bytes{what}",
                view.buffer
            ));
        }
        let length = stated.min(there);
        let end = start.checked_add(view.length).filter(|&end| end <= length);
        let end = end.ok_or_else(|| {
            LoadError::new(format!(
                "bufferView {index} ({} bytes from byte {start}) exceeds buffer {}, which has {length} bytes",
                view.length, view.buffer
            ))
        })?;
        Ok((bytes, start..end))
    }

    /// Appends what a source holds at a multiple of 4 bytes and pads to one; returns the offset.
    fn append_source(&self, source: Source, bytes: &mut Vec<u8>) -> Result<u32, LoadError> {
        let view = match source {
            Source::View(view) if !self.decoded.views.contains_key(&view) => view,
            _ => return append(&self.limits, bytes, self.source(source)?),
        };
        let (from, range) = self.range(view)?;
        let start = make_room(&self.limits, bytes, (range.end - range.start) as usize)?;
        from.append_to(bytes, range)?;
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        Ok(start)
    }

    /// Checks an accessor and its buffer view, in 64-bit arithmetic.
    pub fn layout(&self, index: usize) -> Result<Layout, LoadError> {
        let accessor = match self.document.accessors.get(index) {
            Some(accessor) => accessor.as_ref().map_err(LoadError::new),
            None => return Err(LoadError::new(format!("accessor {index} does not exist"))),
        };
        accessor
            .and_then(|accessor| self.checked(index, accessor))
            .map_err(|error| error.within(format_args!("accessor {index}")))
    }

    fn checked(&self, index: usize, accessor: &document::Accessor) -> Result<Layout, LoadError> {
        let (size, element) = (
            u64::from(accessor.component_type.bytes()),
            accessor.element_bytes(),
        );
        let (count, mut offset) = (accessor.count, accessor.offset);
        // Checked before any allocation: an accessor without a view can claim any count without
        // having bytes.
        if count == 0 {
            return Err(LoadError::new("count is 0; it must be at least 1"));
        }
        if count > 3 * self.limits.triangles {
            return Err(self
                .limits
                .exceeded(format_args!("count is {count}"), 3 * self.limits.triangles));
        }
        let (mut stride, mut is_packed) = (element, accessor.sparse.is_some());
        let view = if self.decoded.accessors.contains_key(&index) {
            offset = 0;
            Some(Source::Accessor(index))
        } else {
            accessor.view.map(Source::View)
        };
        let length = match view {
            None => None,
            Some(Source::Accessor(_)) => Some(count * element),
            Some(Source::View(at)) => {
                let length = self.view_length(at)?;
                let from = self.document.views[at].as_ref().ok();
                stride = from.and_then(|view| view.stride).unwrap_or(element);
                if stride < element {
                    return Err(LoadError::new(format!(
                        "byteStride is {stride}; it must be at least {element}"
                    )));
                }
                let start = from.map_or(0, |view| view.offset).wrapping_add(offset);
                if offset % size != 0 || start % size != 0 || stride % size != 0 {
                    self.notes.fault(|| {
                        format!(
                            "accessor {index}: byteOffset {offset}, that of its bufferView and byteStride {stride} must be multiples of the component size, {size}; its elements are copied"
                        )
                    });
                    is_packed = true;
                }
                Some(length)
            }
        };
        if let Some(length) = length {
            let end = (count - 1)
                .checked_mul(stride)
                .and_then(|last| last.checked_add(offset)?.checked_add(element));
            if end.is_none_or(|end| end > length) {
                let from = accessor.view.unwrap_or_default();
                return Err(LoadError::new(format!(
                    "{count} elements of {stride} bytes from byte {offset} exceed bufferView {from}, which has {length} bytes"
                )));
            }
        }
        // A sparse accessor may lie in a view that is larger than what 32 bits address; all others
        // are copied with their view.
        let (Ok(offset), Ok(stride)) = (u32::try_from(offset), u32::try_from(stride)) else {
            return Err(LoadError::new(format!(
                "byteOffset {offset} exceeds 32 bits; put the elements into a bufferView of their own"
            )));
        };
        Ok(Layout {
            accessor: Accessor {
                offset,
                stride,
                component_type: accessor.component_type,
                components: accessor.components,
                normalized: accessor.normalized,
                count: count as u32,
            },
            view,
            is_packed: is_packed || view.is_none(),
        })
    }

    /// The packed elements of an accessor: those of its buffer view, or zeros, with the sparse
    /// values applied.
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
        if let Some(source) = layout.view {
            let from = self.source(source)?;
            for (i, to) in bytes.chunks_exact_mut(element).enumerate() {
                let at = offset as usize + i * stride as usize;
                to.copy_from_slice(&from[at..at + element]);
            }
        }
        if let Some(sparse) = self.document.accessors[index]
            .as_ref()
            .ok()
            .and_then(|accessor| accessor.sparse.as_ref())
        {
            self.overlay(sparse, element, &mut bytes)
                .map_err(|error| error.within(format_args!("accessor {index} sparse")))?;
        }
        Ok(bytes)
    }

    fn overlay(&self, sparse: &Sparse, element: usize, bytes: &mut [u8]) -> Result<(), LoadError> {
        let (count, width) = (sparse.count, sparse.index_type);
        let elements = (bytes.len() / element) as u64;
        if count == 0 || count > elements {
            return Err(LoadError::new(format!(
                "count is {count}; allowed: 1 to {elements}"
            )));
        }
        let part = |what: &str, (view, offset): (usize, u64), size: u64| {
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
        let indices = part("indices", sparse.indices, width.bytes().into())?;
        let values = part("values", sparse.values, element as u64)?;
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
    pub buffers: &'a Buffers<'a>,
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
pub enum Source {
    /// A buffer view.
    View(usize),
    /// The packed elements of an accessor.
    Accessor(usize),
}

impl<'a> SceneWriter<'a> {
    /// Adds to `scene`.
    pub fn new(buffers: &'a Buffers<'a>, scene: Scene) -> Self {
        let is_quantized = buffers
            .document
            .extensions_used
            .iter()
            .chain(&buffers.document.extensions_required)
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
            false,
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
        let is_apart = accessor.stride != accessor.component_type.bytes();
        if is_apart {
            self.buffers.notes.fault(|| {
                format!("accessor {index}: indices must not have a byteStride; they are copied")
            });
        }
        copy(
            self.buffers,
            index,
            &mut self.index_offsets,
            &mut self.scene.index_bytes,
            is_apart,
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

    /// Appends coordinates that the file does not have.
    pub fn append_pairs(&mut self, pairs: &[[f32; 2]]) -> Result<Accessor, LoadError> {
        self.append_floats(2, pairs.as_flattened())
    }

    /// Appends so many floats for each vertex.
    pub fn append_floats(&mut self, each: u32, values: &[f32]) -> Result<Accessor, LoadError> {
        let bytes = &mut self.scene.vertex_bytes;
        let offset = append(&self.buffers.limits, bytes, bytemuck::cast_slice(values))?;
        Ok(Accessor::packed_f32(
            offset as usize,
            each,
            values.len() / each as usize,
        ))
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

/// Copies the buffer view of an accessor, or its packed elements, unless that was done before.
fn copy(
    buffers: &Buffers,
    index: usize,
    offsets: &mut HashMap<Source, u32>,
    bytes: &mut Vec<u8>,
    pack: bool,
) -> Result<Accessor, LoadError> {
    let layout = buffers.layout(index)?;
    let accessor = layout.accessor;
    let (source, copied) = match layout.view {
        Some(source) if !layout.is_packed && !pack => (source, accessor),
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
            let start = match layout.view {
                Some(view) if view == source && !layout.is_packed => {
                    buffers.append_source(source, bytes)?
                }
                _ => append(
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
pub fn make_room(limits: &Limits, bytes: &mut Vec<u8>, more: usize) -> Result<u32, LoadError> {
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
///
/// # Errors
/// There would be too many bytes, or loading was canceled.
pub fn append(limits: &Limits, bytes: &mut Vec<u8>, more: &[u8]) -> Result<u32, LoadError> {
    let start = make_room(limits, bytes, more.len())?;
    let checkpoint = checkpoint();
    for part in more.chunks(PART_BYTES) {
        bytes.extend_from_slice(part);
        checkpoint.pass()?;
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    Ok(start)
}
