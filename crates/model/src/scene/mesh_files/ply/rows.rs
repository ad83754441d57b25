//! The rows of the elements of PLY.

use super::header::{Element, Encoding, Number};
use crate::scene::{
    gltf::LoadError,
    mesh_files::{builder::Room, stream::Stream},
};

/// Reads rows, one after the other.
pub struct Rows<'a> {
    pub stream: Stream<'a>,
    pub encoding: Encoding,
    /// The values of each property of the row that was read.
    values: Vec<Vec<f64>>,
    line: Vec<u8>,
    /// Values of the longest list.
    widest: usize,
}

/// What became of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Read {
    Whole,
    /// Values are missing.
    Broken,
    /// The file ends before it does.
    Ended,
}

impl<'a> Rows<'a> {
    /// The rows that follow.
    pub fn new(stream: Stream<'a>, encoding: Encoding) -> Self {
        Self {
            stream,
            encoding,
            values: Vec::new(),
            line: Vec::new(),
            widest: 0,
        }
    }

    /// The value of a property of the row that was read; NaN if it has none.
    pub fn value(&self, property: Option<usize>) -> f64 {
        self.list(property).first().copied().unwrap_or(f64::NAN)
    }

    /// All values of a property of the row that was read.
    pub fn list(&self, property: Option<usize>) -> &[f64] {
        property
            .and_then(|property| self.values.get(property))
            .map_or(&[], Vec::as_slice)
    }

    /// Passes over all rows of an element.
    ///
    /// # Errors
    /// They cannot be read, or loading was canceled.
    pub fn skip(&mut self, element: &Element, room: &mut Room) -> Result<(), LoadError> {
        let is_fixed = element.properties.iter().all(|one| one.count.is_none());
        if is_fixed && self.encoding != Encoding::Text {
            let row: usize = element
                .properties
                .iter()
                .map(|one| one.number.bytes())
                .sum();
            let bytes = element.count.saturating_mul(row as u64);
            let there = bytes.min(self.stream.left());
            self.stream.skip(there)?;
            return Ok(());
        }
        for _ in 0..element.count {
            if self.read(element, room)? == Read::Ended {
                break;
            }
        }
        Ok(())
    }

    /// Reads a row.
    ///
    /// # Errors
    /// There is no room for it, it cannot be read, or loading was canceled.
    pub fn read(&mut self, element: &Element, room: &mut Room) -> Result<Read, LoadError> {
        self.values.resize_with(element.properties.len(), Vec::new);
        self.values.iter_mut().for_each(Vec::clear);
        // Of rows without bytes a file has any number.
        if element.properties.is_empty() {
            return Ok(Read::Ended);
        }
        match self.encoding {
            Encoding::Text => self.text(element, room),
            encoding => self.binary(element, encoding == Encoding::BigEndian, room),
        }
    }

    fn text(&mut self, element: &Element, room: &mut Room) -> Result<Read, LoadError> {
        loop {
            if !self.stream.line(&mut self.line)? {
                return Ok(Read::Ended);
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        let text = String::from_utf8_lossy(&self.line);
        let mut words = text.split_ascii_whitespace();
        let read = |word: &str| word.parse::<f64>().unwrap_or(f64::NAN);
        for (property, values) in element.properties.iter().zip(&mut self.values) {
            let count = match property.count {
                Some(_) => words.next().map_or(f64::NAN, read),
                None => 1.0,
            };
            if count.is_nan() {
                return Ok(Read::Broken);
            }
            let count = count as usize;
            values.extend(words.by_ref().take(count).map(read));
            widen(&mut self.widest, values.len(), room)?;
            if values.len() < count {
                return Ok(Read::Broken);
            }
        }
        Ok(Read::Whole)
    }

    fn binary(
        &mut self,
        element: &Element,
        is_big: bool,
        room: &mut Room,
    ) -> Result<Read, LoadError> {
        for (property, values) in element.properties.iter().zip(&mut self.values) {
            let count = match property.count {
                Some(number) => match self.stream.bytes(number.bytes())? {
                    Some(bytes) => decoded(bytes, number, is_big) as u64,
                    None => return Ok(Read::Ended),
                },
                None => 1,
            };
            let size = property.number.bytes();
            if count.saturating_mul(size as u64) > self.stream.left() {
                return Ok(Read::Ended);
            }
            widen(&mut self.widest, count as usize, room)?;
            if let Some(bytes) = self.stream.bytes(count as usize * size)? {
                let each = bytes.chunks_exact(size);
                values.extend(each.map(|bytes| decoded(bytes, property.number, is_big)));
            }
        }
        Ok(Read::Whole)
    }
}

/// Counts the bytes of a list that is longer than all before.
fn widen(widest: &mut usize, count: usize, room: &mut Room) -> Result<(), LoadError> {
    if count > *widest {
        room.take((count - *widest) * 2 * size_of::<f64>())?;
        *widest = count;
    }
    Ok(())
}

fn decoded(bytes: &[u8], number: Number, is_big: bool) -> f64 {
    let mut word = [0; 8];
    let word = &mut word[..bytes.len()];
    word.copy_from_slice(bytes);
    if is_big {
        word.reverse();
    }
    match (number, word) {
        (Number::I8, &mut [a]) => f64::from(a as i8),
        (Number::U8, &mut [a]) => f64::from(a),
        (Number::I16, &mut [a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (Number::U16, &mut [a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (Number::I32, &mut [a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
        (Number::U32, &mut [a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (Number::F32, &mut [a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        (_, word) => f64::from_le_bytes(word.try_into().unwrap_or_default()),
    }
}
