//! Compressed models: the buffer views and accessors that compressed data becomes.

use std::collections::HashMap;

use super::{
    buffers::Buffers,
    document::Part,
    draco::{CompressedPrimitive, Decoded},
    error::LoadError,
    limits::Limits,
    meshopt::CompressedView,
};
use crate::scene::accessor::ComponentType;

/// Extensions of compressed data that this loader decodes.
pub const MESHOPT: &str = "EXT_meshopt_compression";
pub const DRACO: &str = "KHR_draco_mesh_compression";

/// What was compressed, or why it cannot be decoded.
#[derive(Default)]
pub struct DecodedData {
    /// By the indices of buffer views.
    pub views: HashMap<usize, Part<Vec<u8>>>,
    /// Packed elements, by the indices of accessors without views.
    pub accessors: HashMap<usize, Part<Vec<u8>>>,
}

impl DecodedData {
    /// Decodes everything that is compressed.
    ///
    /// # Errors
    /// More than the limits allow.
    pub fn of(buffers: &Buffers) -> Result<Self, LoadError> {
        let mut decoder = Decoder {
            buffers,
            data: Self::default(),
            bytes: 0,
        };
        for (index, view) in buffers.document.views.iter().enumerate() {
            if let Ok(view) = view
                && let Some(compressed) = &view.meshopt
            {
                let decoded = decoder.meshopt(view.length, compressed);
                let decoded = part(decoded, format_args!("bufferView {index}: {MESHOPT}"))?;
                decoder.data.views.insert(index, decoded);
            }
        }
        for (mesh, about) in buffers.document.meshes.iter().enumerate() {
            for (at, primitive) in about.sound() {
                if let Some(compressed) = &primitive.draco {
                    let missing = decoder.missing(primitive.accessors());
                    let done = decoder.draco(primitive, compressed);
                    let place = format_args!("mesh {mesh} primitive {at}: {DRACO}");
                    if let Err(reason) = part(done, place)? {
                        for accessor in missing {
                            let decoded = &mut decoder.data.accessors;
                            decoded.entry(accessor).or_insert(Err(reason.clone()));
                        }
                    }
                }
            }
        }
        Ok(decoder.data)
    }
}

/// The outcome for a part of the model.
fn part<T>(done: Result<T, LoadError>, place: std::fmt::Arguments) -> Result<Part<T>, LoadError> {
    match done {
        Ok(done) => Ok(Ok(done)),
        Err(error) => error.within(place).of_part().map(Err),
    }
}

struct Decoder<'a> {
    buffers: &'a Buffers<'a>,
    data: DecodedData,
    /// Size of all decoded data.
    bytes: u64,
}

impl Decoder<'_> {
    /// Counts decoded bytes before they are allocated.
    fn count(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.bytes = self.bytes.saturating_add(bytes);
        let limits = &self.buffers.limits;
        let Limits {
            buffer_bytes,
            total_bytes,
            ..
        } = *limits;
        if bytes > buffer_bytes {
            return Err(limits.exceeded(format_args!("it unpacks to {bytes} bytes"), buffer_bytes));
        }
        if self.bytes > total_bytes {
            let what = format_args!(
                "it unpacks to {bytes} bytes, {} with those before",
                self.bytes
            );
            return Err(limits.exceeded(what, total_bytes));
        }
        Ok(())
    }

    fn meshopt(&mut self, stated: u64, view: &CompressedView) -> Result<Vec<u8>, LoadError> {
        self.count(view.decoded_bytes().unwrap_or(u64::MAX))?;
        if view.decoded_bytes() != Some(stated) {
            return Err(LoadError::new(format!(
                "{} elements of {} bytes are not the {stated} bytes of the view",
                view.count, view.byte_stride
            )));
        }
        let bytes = self
            .buffers
            .part(view.buffer, view.byte_offset, view.byte_length)?;
        view.decode(bytes)
    }

    /// Those of `accessors` that have no bytes yet.
    fn missing(&self, accessors: impl Iterator<Item = usize>) -> Vec<usize> {
        let known = &self.buffers.document.accessors;
        let is_missing = |accessor: &usize| {
            let is_empty =
                |about: &super::document::Accessor| about.view.is_none() && about.sparse.is_none();
            known[*accessor].as_ref().is_ok_and(is_empty)
                && !matches!(self.data.accessors.get(accessor), Some(Ok(_)))
        };
        accessors.filter(is_missing).collect()
    }

    fn draco(
        &mut self,
        primitive: &super::document::Primitive,
        about: &CompressedPrimitive,
    ) -> Result<(), LoadError> {
        let missing = self.missing(primitive.accessors());
        // Where the file has the uncompressed data too, or another primitive of the same data was
        // decoded, nothing is missing.
        if missing.is_empty() {
            return Ok(());
        }
        let packed = self.buffers.view(about.buffer_view)?;
        // The data is decoded again for every primitive that names it.
        self.count(packed.len() as u64)?;
        let decoded = Decoded::of(packed, &self.buffers.limits)?;
        self.count(4 * (decoded.vertices() + decoded.indices()) as u64)?;
        for (name, &accessor) in &primitive.attributes {
            let Some(&id) = about
                .attributes
                .get(name)
                .filter(|_| missing.contains(&accessor))
            else {
                continue;
            };
            let (component_type, components) = self
                .format(accessor, decoded.vertices())
                .map_err(|error| error.within(name))?;
            let size = u64::from(component_type.bytes() * components);
            self.count(decoded.vertices() as u64 * size)?;
            let bytes = decoded
                .attribute_bytes(id, component_type, components)
                .map_err(|error| error.within(name))?;
            self.data.accessors.insert(accessor, Ok(bytes));
        }
        let indices = primitive
            .indices
            .ok_or_else(|| LoadError::new("the primitive has no indices"))?;
        if missing.contains(&indices) {
            let (component_type, _) = self
                .format(indices, decoded.indices())
                .map_err(|error| error.within("indices"))?;
            self.count(decoded.indices() as u64 * u64::from(component_type.bytes()))?;
            let bytes = decoded.index_bytes(component_type)?;
            self.data.accessors.insert(indices, Ok(bytes));
        }
        Ok(())
    }

    /// The format of an accessor that has as many elements as the decoded data.
    fn format(&self, accessor: usize, elements: usize) -> Result<(ComponentType, u32), LoadError> {
        let about = self.buffers.document.accessors[accessor]
            .as_ref()
            .map_err(LoadError::new)?;
        if about.count != elements as u64 {
            return Err(LoadError::new(format!(
                "accessor {accessor} has {} elements, and the Draco data {elements}",
                about.count
            )));
        }
        Ok((about.component_type, about.components))
    }
}
