//! Compressed models: what the extensions say, and the buffer views that they become.

use std::collections::HashMap;

use gltf::json::{
    self, Index,
    validation::{Checked, USize64},
};
use serde::Deserialize;

use super::{
    draco::{CompressedPrimitive, Decoded},
    element::{component_of, lanes_of},
    error::LoadError,
    limits::Limits,
    meshopt::CompressedView,
};
use crate::scene::accessor::ComponentType;

/// Extensions of compressed data that this loader decodes.
pub const MESHOPT: &str = "EXT_meshopt_compression";
pub const DRACO: &str = "KHR_draco_mesh_compression";

/// The parts of the JSON that the crate `gltf` does not read.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Compression {
    #[serde(default)]
    buffers: Vec<Entry<BufferExtensions>>,
    #[serde(default)]
    buffer_views: Vec<Entry<ViewExtensions>>,
    #[serde(default)]
    meshes: Vec<MeshEntry>,
}

#[derive(Debug, Deserialize)]
struct Entry<T> {
    extensions: Option<T>,
}

#[derive(Debug, Deserialize)]
struct MeshEntry {
    #[serde(default)]
    primitives: Vec<Entry<PrimitiveExtensions>>,
}

#[derive(Debug, Deserialize)]
struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    meshopt: Option<Fallback>,
}

#[derive(Debug, Deserialize)]
struct Fallback {
    #[serde(default)]
    fallback: bool,
}

#[derive(Debug, Deserialize)]
struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    meshopt: Option<CompressedView>,
}

#[derive(Debug, Deserialize)]
struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<CompressedPrimitive>,
}

/// Decoded buffer views, by index.
pub type DecodedViews = HashMap<usize, Vec<u8>>;

impl Compression {
    /// What the JSON says about compression; nothing if it names no such extension.
    ///
    /// # Errors
    /// An extension lacks a property, or has one of another type.
    pub fn of(json: &[u8]) -> Result<Self, LoadError> {
        let is_named = [MESHOPT, DRACO]
            .iter()
            .any(|name| json.windows(name.len()).any(|part| part == name.as_bytes()));
        if !is_named {
            return Ok(Self::default());
        }
        serde_json::from_slice(json)
            .map_err(|error| LoadError::new(format!("malformed compression extension: {error}")))
    }

    /// Is nothing compressed?
    pub fn is_none(&self) -> bool {
        self.buffers.is_empty() && self.buffer_views.is_empty() && self.meshes.is_empty()
    }

    /// Does this buffer have no bytes, because its views are compressed?
    pub fn is_fallback(&self, buffer: usize) -> bool {
        let extension = self
            .buffers
            .get(buffer)
            .and_then(|buffer| buffer.extensions.as_ref()?.meshopt.as_ref());
        extension.is_some_and(|extension| extension.fallback)
    }

    /// Decodes everything that is compressed. Accessors without bytes receive buffer views, which
    /// are added to `root`.
    ///
    /// # Errors
    /// Malformed data, or more than `limits` allow.
    pub fn decode(
        &self,
        root: &mut json::Root,
        buffers: &[impl AsRef<[u8]>],
        limits: &Limits,
    ) -> Result<DecodedViews, LoadError> {
        let mut decoded = Views {
            root,
            buffers,
            limits,
            views: HashMap::new(),
            bytes: 0,
        };
        for (index, view) in self.buffer_views.iter().enumerate() {
            if let Some(view) = view
                .extensions
                .as_ref()
                .and_then(|extensions| extensions.meshopt.as_ref())
            {
                decoded
                    .meshopt(index, view)
                    .map_err(|error| error.within(format!("bufferView {index}: {MESHOPT}")))?;
            }
        }
        for (mesh, entry) in self.meshes.iter().enumerate() {
            for (primitive, entry) in entry.primitives.iter().enumerate() {
                if let Some(about) = entry
                    .extensions
                    .as_ref()
                    .and_then(|extensions| extensions.draco.as_ref())
                {
                    let in_primitive = |error: LoadError| {
                        error.within(format!("mesh {mesh} primitive {primitive}: {DRACO}"))
                    };
                    decoded
                        .draco([mesh, primitive], about)
                        .map_err(in_primitive)?;
                }
            }
        }
        Ok(decoded.views)
    }
}

struct Views<'a, T> {
    root: &'a mut json::Root,
    buffers: &'a [T],
    limits: &'a Limits,
    views: DecodedViews,
    /// Size of all decoded views.
    bytes: u64,
}

impl<T: AsRef<[u8]>> Views<'_, T> {
    fn part(&self, buffer: usize, start: u64, length: u64) -> Result<&[u8], LoadError> {
        let bytes = self.buffers.get(buffer).map_or(&[][..], AsRef::as_ref);
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

    /// Counts decoded bytes before they are allocated.
    fn count(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.bytes = self.bytes.saturating_add(bytes);
        let Limits {
            buffer_bytes,
            total_bytes,
            ..
        } = *self.limits;
        if bytes > buffer_bytes {
            return Err(self
                .limits
                .exceeded(format_args!("it unpacks to {bytes} bytes"), buffer_bytes));
        }
        if self.bytes > total_bytes {
            let what = format_args!(
                "it unpacks to {bytes} bytes, {} with those before",
                self.bytes
            );
            return Err(self.limits.exceeded(what, total_bytes));
        }
        Ok(())
    }

    fn meshopt(&mut self, index: usize, view: &CompressedView) -> Result<(), LoadError> {
        self.count(view.decoded_bytes().unwrap_or(u64::MAX))?;
        let stated = self
            .root
            .buffer_views
            .get(index)
            .map_or(0, |view| view.byte_length.0);
        if view.decoded_bytes() != Some(stated) {
            return Err(LoadError::new(format!(
                "{} elements of {} bytes are not the {stated} bytes of the view",
                view.count, view.byte_stride
            )));
        }
        let bytes = view.decode(self.part(view.buffer, view.byte_offset, view.byte_length)?)?;
        self.views.insert(index, bytes);
        Ok(())
    }

    fn draco(
        &mut self,
        [mesh, primitive]: [usize; 2],
        about: &CompressedPrimitive,
    ) -> Result<(), LoadError> {
        let known = &self.root.meshes[mesh].primitives[primitive];
        let named =
            |(semantic, accessor): (&Checked<json::mesh::Semantic>, &Index<json::Accessor>)| {
                match semantic {
                    Checked::Valid(semantic) => Some((semantic.to_string(), accessor.value())),
                    Checked::Invalid => None,
                }
            };
        let attributes: Vec<(String, usize)> = known.attributes.iter().filter_map(named).collect();
        let indices = known.indices.map(|indices| indices.value());
        let is_empty = |&accessor: &usize| self.root.accessors[accessor].buffer_view.is_none();
        // Where the file has the uncompressed data too, or another primitive of the same data was
        // decoded, nothing is missing.
        if !attributes
            .iter()
            .map(|(_, accessor)| accessor)
            .chain(&indices)
            .any(is_empty)
        {
            return Ok(());
        }
        let view = self.root.buffer_views.get(about.buffer_view);
        let view = view.ok_or_else(|| {
            LoadError::new(format!("bufferView {} does not exist", about.buffer_view))
        })?;
        let (buffer, start, length) = (
            view.buffer.value(),
            view.byte_offset.unwrap_or_default().0,
            view.byte_length.0,
        );
        // The data is decoded again for every primitive that names it.
        self.count(length)?;
        let decoded = Decoded::of(self.part(buffer, start, length)?, self.limits)?;
        self.count(4 * (decoded.vertices() + decoded.indices()) as u64)?;
        for (name, accessor) in attributes {
            let Some(&id) = about
                .attributes
                .get(&name)
                .filter(|_| self.root.accessors[accessor].buffer_view.is_none())
            else {
                continue;
            };
            let (component_type, components) = self
                .format(accessor, decoded.vertices())
                .map_err(|error| error.within(&name))?;
            let size = u64::from(component_type.bytes() * components);
            self.count(decoded.vertices() as u64 * size)?;
            let bytes = decoded
                .attribute_bytes(id, component_type, components)
                .map_err(|error| error.within(&name))?;
            self.fill(accessor, about.buffer_view, bytes);
        }
        let indices = indices.ok_or_else(|| LoadError::new("the primitive has no indices"))?;
        if self.root.accessors[indices].buffer_view.is_none() {
            let (component_type, _) = self
                .format(indices, decoded.indices())
                .map_err(|error| error.within("indices"))?;
            self.count(decoded.indices() as u64 * u64::from(component_type.bytes()))?;
            self.fill(
                indices,
                about.buffer_view,
                decoded.index_bytes(component_type)?,
            );
        }
        Ok(())
    }

    /// The format of an accessor that has as many elements as the decoded data.
    fn format(&self, accessor: usize, elements: usize) -> Result<(ComponentType, u32), LoadError> {
        let about = &self.root.accessors[accessor];
        if about.count.0 != elements as u64 {
            return Err(LoadError::new(format!(
                "accessor {accessor} has {} elements, and the Draco data {elements}",
                about.count.0
            )));
        }
        match (about.component_type, about.type_) {
            (Checked::Valid(component_type), Checked::Valid(kind)) => {
                Ok((component_of(component_type.0), lanes_of(kind)))
            }
            _ => Err(LoadError::new(
                "its type or componentType is not one of glTF 2.0",
            )),
        }
    }

    /// Gives an accessor a buffer view of its own with these bytes.
    fn fill(&mut self, accessor: usize, compressed: usize, bytes: Vec<u8>) {
        let view = json::buffer::View {
            byte_length: USize64(bytes.len() as u64),
            byte_offset: None,
            byte_stride: None,
            target: None,
            ..self.root.buffer_views[compressed].clone()
        };
        let index = self.root.push(view);
        let about = &mut self.root.accessors[accessor];
        (about.buffer_view, about.byte_offset) = (Some(index), None);
        self.views.insert(index.value(), bytes);
    }
}
