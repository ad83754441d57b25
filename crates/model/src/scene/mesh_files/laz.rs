//! LAZ: points of LAS in compressed chunks, which the crate `laz` unpacks one after another.

use std::io::{self, Cursor, Read};

use laz::{
    LazItem, LazItemRecordBuilder, LazItemType, LazVlr,
    record::{
        LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor,
    },
};

use super::stream::Stream;
use crate::scene::gltf::{LoadError, Source};

/// Bytes before what a record of the header's list says.
const RECORD_HEAD: usize = 54;

/// Most bytes of a point beside those of its format: each takes tables of its own.
const MOST_EXTRA: usize = 256;

/// How the points of a file are compressed.
pub struct Packing {
    items: Vec<LazItem>,
    /// Points of a chunk; none where chunks say it.
    chunk: Option<u64>,
    /// A table follows the chunks, and its place stands before them.
    has_table: bool,
    /// Bytes of a point.
    stride: usize,
    /// Parts of a chunk that are compressed for themselves; 0 where a chunk is one.
    layers: usize,
}

impl Packing {
    /// Reads it from the list of records between `list` and `end`, for points of a format with so
    /// many bytes, `extra` beside those of the format.
    ///
    /// # Errors
    /// It is not there, or not as the format asks; the file cannot be read.
    pub fn of(
        model: &dyn Source,
        [list, end]: [u64; 2],
        format: u8,
        [stride, extra]: [usize; 2],
    ) -> Result<Self, LoadError> {
        let damaged = |_| {
            LoadError::new(
                "it does not say how its points are compressed; fetch or export it again",
            )
        };
        if extra > MOST_EXTRA {
            return Err(LoadError::new(format_args!(
                "its compressed points have {extra} bytes beside those of their format; allowed: at most {MOST_EXTRA}"
            )));
        }
        let record = find(model, list, end)?.unwrap_or_default();
        let vlr = LazVlr::from_buffer(&record).map_err(damaged)?;
        let wanted = LazItemRecordBuilder::default_for_point_format_id(format, extra as u16)
            .map_err(damaged)?;
        let items = vlr.items();
        let is_layered = format >= 6;
        let is_as_wanted = items.len() == wanted.len()
            && items.iter().zip(&wanted).all(|(item, wanted)| {
                item.item_type() == wanted.item_type()
                    && item.size() == wanted.size()
                    && (item.version() > 2) == is_layered
            });
        let is_known = match is_layered {
            true => layered(Cursor::new(&[]), items).is_ok(),
            false => pointwise(io::empty(), items).is_ok(),
        };
        if !is_as_wanted || !is_known {
            return Err(LoadError::new(format_args!(
                "its points of the format {format} are compressed in a way that is not read; unpack it to LAS"
            )));
        }
        let of_item = |item: &LazItem| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(bytes) => bytes.into(),
            _ => 1,
        };
        // The kind of compression stands first: 1 is a single chunk.
        let has_table = record[..2] != [1, 0];
        let chunk = match (has_table, vlr.uses_variable_size_chunks()) {
            (false, _) => Some(u64::MAX),
            (true, false) => Some(vlr.chunk_size().into()),
            (true, true) => None,
        };
        if !is_layered && chunk.is_none() {
            return Err(LoadError::new(
                "its compressed chunks differ in size, which is read of the formats from 6 up; unpack it to LAS",
            ));
        }
        Ok(Self {
            chunk,
            has_table,
            stride,
            layers: match is_layered {
                true => items.iter().map(of_item).sum(),
                false => 0,
            },
            items: items.clone(),
        })
    }

    /// Visits the points, of which there should be `count`, from where the stream is; returns how many
    /// there are before the file ends or is damaged.
    pub fn each(
        &self,
        stream: &mut Stream,
        count: u64,
        visit: &mut dyn FnMut(&[u8]) -> Result<(), LoadError>,
    ) -> Result<u64, LoadError> {
        if self.has_table {
            stream.skip(8)?;
        }
        let (mut read, mut bytes) = (0, Vec::new());
        let mut point = vec![0; self.stride];
        while read < count {
            let mut points = count - read;
            let unpacked = if self.layers > 0 {
                let Some(in_chunk) = self.chunk(stream, &mut bytes)? else {
                    break;
                };
                points = points.min(in_chunk);
                match layered(Cursor::new(bytes.as_slice()), &self.items) {
                    Ok(mut chunk) => unpack(&mut chunk, points, &mut point, visit)?,
                    Err(_) => break,
                }
            } else {
                points = points.min(self.chunk.unwrap_or(points));
                let Some(head) = stream.peek(self.stride + CODE)? else {
                    break;
                };
                if !is_code(&head[self.stride..]) {
                    break;
                }
                let mut source = Packed {
                    stream,
                    error: None,
                };
                let unpacked = match pointwise(&mut source, &self.items) {
                    Ok(mut chunk) => unpack(&mut chunk, points, &mut point, visit)?,
                    Err(_) => break,
                };
                if let Some(error) = source.error {
                    return Err(error);
                }
                unpacked
            };
            read += unpacked;
            if unpacked < points {
                break;
            }
        }
        Ok(read)
    }

    /// Reads a chunk of layers; returns how many points it states, none where it is cut off or
    /// damaged.
    fn chunk(&self, stream: &mut Stream, chunk: &mut Vec<u8>) -> Result<Option<u64>, LoadError> {
        chunk.clear();
        let Some(head) = stream.bytes(self.stride + 4 + 4 * self.layers)? else {
            return Ok(None);
        };
        chunk.extend_from_slice(head);
        let words = head[self.stride..].chunks_exact(4);
        let mut words = words.map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        let points = words.next().unwrap_or(0);
        let sizes: Vec<u64> = words.map(u64::from).collect();
        let whole: u64 = sizes.iter().sum();
        if points == 0 || whole > stream.left() {
            return Ok(None);
        }
        for size in sizes.into_iter().filter(|&size| size > 0) {
            match stream.bytes(size as usize)? {
                Some(layer) if is_code(layer) => chunk.extend_from_slice(layer),
                _ => return Ok(None),
            }
        }
        Ok(Some(points.into()))
    }
}

/// Bytes with which a code begins.
const CODE: usize = 4;

/// Can a code begin so? It is a number below 1 in binary, and this would be 1, at which no decoder
/// arrives.
fn is_code(bytes: &[u8]) -> bool {
    bytes.len() >= CODE && bytes[..CODE] != [0xff; CODE]
}

fn layered<'a>(
    bytes: Cursor<&'a [u8]>,
    items: &Vec<LazItem>,
) -> laz::Result<LayeredPointRecordDecompressor<'a, Cursor<&'a [u8]>>> {
    let mut chunk = LayeredPointRecordDecompressor::new(bytes);
    chunk.set_fields_from(items)?;
    Ok(chunk)
}

fn pointwise<'a, R: Read + 'a>(
    bytes: R,
    items: &Vec<LazItem>,
) -> laz::Result<SequentialPointRecordDecompressor<'a, R>> {
    let mut chunk = SequentialPointRecordDecompressor::new(bytes);
    chunk.set_fields_from(items)?;
    Ok(chunk)
}

/// Visits so many points of a chunk; returns how many could be unpacked.
fn unpack<R>(
    chunk: &mut impl RecordDecompressor<R>,
    points: u64,
    point: &mut [u8],
    visit: &mut dyn FnMut(&[u8]) -> Result<(), LoadError>,
) -> Result<u64, LoadError> {
    for unpacked in 0..points {
        if chunk.decompress_next(point).is_err() {
            return Ok(unpacked);
        }
        visit(point)?;
    }
    Ok(points)
}

/// What the record of the list says that tells of the compression; none where it is not there.
fn find(model: &dyn Source, list: u64, end: u64) -> Result<Option<Vec<u8>>, LoadError> {
    let mut stream = Stream::new(model);
    if !stream.skip(list)? {
        return Ok(None);
    }
    let mut at = list;
    while at + RECORD_HEAD as u64 <= end {
        let Some(head) = stream.bytes(RECORD_HEAD)? else {
            break;
        };
        let u16_at = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
        let (id, length) = (u16_at(18), u16_at(20));
        let is_it = id == LazVlr::RECORD_ID && head[2..18].starts_with(LazVlr::USER_ID.as_bytes());
        match stream.bytes(length.into())? {
            Some(said) if is_it => return Ok(Some(said.to_vec())),
            Some(_) => at += RECORD_HEAD as u64 + u64::from(length),
            None => break,
        }
    }
    Ok(None)
}

/// Bytes of a model for a decoder, which asks for one after another.
struct Packed<'a, 'b> {
    stream: &'a mut Stream<'b>,
    /// Why it could not be read.
    error: Option<LoadError>,
}

impl Read for Packed<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = (buffer.len() as u64).min(self.stream.left()) as usize;
        match self.stream.bytes(count) {
            Ok(bytes) => {
                let bytes = bytes.unwrap_or_default();
                buffer[..bytes.len()].copy_from_slice(bytes);
                Ok(bytes.len())
            }
            Err(error) => {
                self.error = Some(error);
                Err(io::ErrorKind::Other.into())
            }
        }
    }
}
