//! Where the bytes of a model come from: a source in memory, or one outside, from which large
//! buffers are read to where they belong.

use std::{borrow::Cow, cell::OnceCell, ops::Range};

use super::error::LoadError;
use crate::work::checkpoint;

/// Bytes that are read or copied between two looks at whether loading was canceled.
pub const PART_BYTES: usize = 4 << 20;

/// A model file: bytes in memory, or elsewhere, of which only what is needed is read.
pub trait Source {
    /// Its size, bytes.
    fn size(&self) -> u64;

    /// Appends the bytes of `range`, which lies inside.
    ///
    /// # Errors
    /// They cannot be read.
    fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError>;

    /// All of them, where they lie in memory.
    fn in_memory(&self) -> Option<&[u8]> {
        None
    }
}

impl Source for &[u8] {
    fn size(&self) -> u64 {
        self.len() as u64
    }

    fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
        let checkpoint = checkpoint();
        for part in self[range.start as usize..range.end as usize].chunks(PART_BYTES) {
            bytes.extend_from_slice(part);
            checkpoint.pass()?;
        }
        Ok(())
    }

    fn in_memory(&self) -> Option<&[u8]> {
        Some(self)
    }
}

/// The bytes of a buffer.
pub enum Bytes<'a> {
    Memory(Cow<'a, [u8]>),
    Outside(OutsideBytes<'a>),
}

impl<'a> Bytes<'a> {
    /// Those of a range that lies inside of `source`.
    pub fn of(source: &'a dyn Source, range: Range<u64>) -> Self {
        match source.in_memory() {
            Some(bytes) => Self::Memory(Cow::Borrowed(
                &bytes[range.start as usize..range.end as usize],
            )),
            None => Self::Outside(OutsideBytes {
                source,
                range,
                whole: OnceCell::new(),
            }),
        }
    }

    pub fn len(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::Outside(bytes) => bytes.range.end - bytes.range.start,
        }
    }

    /// All of them, in memory from then on.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn all(&self) -> Result<&[u8], LoadError> {
        match self {
            Self::Memory(bytes) => Ok(bytes),
            Self::Outside(bytes) => bytes.all(),
        }
    }

    /// Appends those of `range`, which lies inside.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
        match self {
            Self::Memory(all) => (&**all).append_to(bytes, range),
            Self::Outside(outside) => match outside.whole.get() {
                Some(all) => all.as_slice().append_to(bytes, range),
                None => outside.source.append_to(
                    bytes,
                    outside.range.start + range.start..outside.range.start + range.end,
                ),
            },
        }
    }
}

/// A range of a source that is not in memory.
pub struct OutsideBytes<'a> {
    source: &'a dyn Source,
    range: Range<u64>,
    whole: OnceCell<Vec<u8>>,
}

impl OutsideBytes<'_> {
    fn all(&self) -> Result<&[u8], LoadError> {
        if let Some(bytes) = self.whole.get() {
            return Ok(bytes);
        }
        let mut bytes = Vec::new();
        reserve(&mut bytes, self.range.end - self.range.start)?;
        self.source.append_to(&mut bytes, self.range.clone())?;
        Ok(self.whole.get_or_init(|| bytes))
    }
}

/// Makes room for exactly so many more bytes.
///
/// # Errors
/// The system has no memory for them.
pub fn reserve(bytes: &mut Vec<u8>, more: u64) -> Result<(), LoadError> {
    bytes
        .try_reserve_exact(more as usize)
        .map_err(|_| LoadError::new(format!("the system has no memory for its {more} bytes")))
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Counts the bytes that are read from it.
    struct Counted(Vec<u8>, Cell<u64>);

    impl Source for Counted {
        fn size(&self) -> u64 {
            self.0.len() as u64
        }

        fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
            self.1.set(self.1.get() + range.end - range.start);
            self.0.as_slice().append_to(bytes, range)
        }
    }

    #[test]
    fn bytes_outside_are_read_when_they_are_needed_and_then_kept() {
        let source = Counted((0..232).map(|byte| byte as u8).collect(), Cell::new(0));
        let there = Bytes::of(&source, 32..232);
        let mut bytes = vec![7];
        there.append_to(&mut bytes, 20..25).expect("it can be read");
        assert_eq!((bytes, source.1.get()), (vec![7, 52, 53, 54, 55, 56], 5));
        assert_eq!(there.all(), Ok(&source.0[32..]));
        let mut bytes = Vec::new();
        there
            .append_to(&mut bytes, 198..200)
            .expect("it is in memory");
        assert_eq!(
            (bytes, there.len(), source.1.get()),
            (vec![230, 231], 200, 205)
        );
    }
}
