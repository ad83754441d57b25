//! Where the bytes of a model are: in memory, or still in its file, from where large buffers are read to where they belong.
//!
//! Files are read, not mapped: one that another program cuts short while it is mapped would end the program.

use std::{
    borrow::Cow,
    cell::{Cell, OnceCell},
    fs,
    io::{self, Read, Seek, SeekFrom},
    ops::Range,
    path::Path,
};

use super::{
    error::LoadError,
    limits::{self, Limits},
};
use crate::work::checkpoint;

/// Bytes that are read or copied between two looks at whether loading was canceled.
pub const PART_BYTES: usize = 4 << 20;

/// The bytes of a buffer.
pub enum Bytes<'a> {
    Memory(Cow<'a, [u8]>),
    File(&'a FilePart),
}

impl Bytes<'_> {
    pub fn len(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::File(part) => part.length,
        }
    }

    /// All of them, in memory from then on.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn all(&self) -> Result<&[u8], LoadError> {
        match self {
            Self::Memory(bytes) => Ok(bytes),
            Self::File(part) => part.all(),
        }
    }

    /// Appends those of `range`, which lies inside.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
        let known = match self {
            Self::Memory(all) => &**all,
            Self::File(part) => match part.whole.get() {
                Some(all) => all,
                None => return part.read(bytes, range),
            },
        };
        let checkpoint = checkpoint();
        for part in known[range.start as usize..range.end as usize].chunks(PART_BYTES) {
            bytes.extend_from_slice(part);
            checkpoint.pass()?;
        }
        Ok(())
    }
}

/// A range of bytes of a file.
pub struct FilePart {
    file: fs::File,
    start: u64,
    length: u64,
    whole: OnceCell<Vec<u8>>,
    /// Bytes that were read.
    read: Cell<u64>,
}

impl FilePart {
    /// Bytes that nobody has read.
    pub fn unread(&self) -> u64 {
        self.length.saturating_sub(self.read.get())
    }

    fn all(&self) -> Result<&[u8], LoadError> {
        if self.whole.get().is_none() {
            let mut bytes = Vec::new();
            reserve(&mut bytes, self.length)?;
            self.read(&mut bytes, 0..self.length)?;
            return Ok(self.whole.get_or_init(|| bytes));
        }
        Ok(self.whole.get().map_or(&[][..], |bytes| bytes))
    }

    fn read(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(self.start + range.start)).map_err(failed)?;
        let (mut left, checkpoint) = (range.end - range.start, checkpoint());
        while left > 0 {
            let read = file.take(left.min(PART_BYTES as u64)).read_to_end(bytes).map_err(failed)? as u64;
            if read == 0 {
                return Err(LoadError::new("the file has become shorter while it was read; load it again"));
            }
            left -= read;
            self.read.set(self.read.get() + read);
            checkpoint.advance(read)?;
        }
        Ok(())
    }
}

fn failed(error: io::Error) -> LoadError {
    LoadError::new(format!("cannot read the file: {error}"))
}

/// Makes room for exactly so many more bytes.
///
/// # Errors
/// The system has no memory for them.
pub fn reserve(bytes: &mut Vec<u8>, more: u64) -> Result<(), LoadError> {
    bytes.try_reserve_exact(more as usize).map_err(|_| LoadError::new(format!("the system has no memory for its {more} bytes")))
}

/// Opens a regular file of at most `most` bytes and counts them as expected. Pipes, devices and folders are refused before they are opened.
///
/// # Errors
/// It is no such file.
fn open_regular(path: &Path, most: u64, limits: &Limits) -> Result<(fs::File, u64), LoadError> {
    let about = fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err(LoadError::new("it is not a regular file"));
    }
    if about.len() > most {
        return Err(limits.exceeded(format_args!("it has {} bytes", about.len()), most));
    }
    let file = fs::File::open(path).map_err(failed)?;
    checkpoint().expect(about.len());
    Ok((file, about.len()))
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// It is no such file, or cannot be read.
pub fn read_regular(path: &Path, most: u64, limits: &Limits) -> Result<Vec<u8>, LoadError> {
    let (file, length) = open_regular(path, most, limits)?;
    read_all(file, length, most, limits)
}

fn read_all(mut file: fs::File, length: u64, most: u64, limits: &Limits) -> Result<Vec<u8>, LoadError> {
    let (mut bytes, checkpoint) = (Vec::new(), checkpoint());
    reserve(&mut bytes, length)?;
    // The file may grow while it is read.
    while bytes.len() as u64 <= most {
        let read = file.by_ref().take(PART_BYTES as u64).read_to_end(&mut bytes).map_err(failed)?;
        checkpoint.advance(read as u64)?;
        if read == 0 {
            return Ok(bytes);
        }
    }
    Err(limits.exceeded(format_args!("it has {} bytes", bytes.len()), most))
}

/// A model file.
pub enum ModelFile {
    /// A GLB in good order: its JSON, its binary chunk, and its size.
    Glb { json: Vec<u8>, binary: FilePart, size: u64 },
    /// Anything else, in memory.
    Whole(Vec<u8>),
}

impl ModelFile {
    /// Opens a model file, and reads what is no binary chunk.
    ///
    /// # Errors
    /// It is no regular file of at most `most` bytes, or cannot be read.
    pub fn open(path: &Path, most: u64, limits: &Limits) -> Result<Self, LoadError> {
        let (mut file, size) = open_regular(path, most, limits)?;
        if let Some((json, start, length)) = glb(&mut file, size).map_err(failed)? {
            checkpoint().advance(size - length)?;
            let binary = FilePart { file, start, length, whole: OnceCell::new(), read: Cell::new(0) };
            return Ok(Self::Glb { json, binary, size });
        }
        file.rewind().map_err(failed)?;
        read_all(file, size, most, limits).map(Self::Whole)
    }
}

/// The JSON of a GLB of `size` bytes, and the first byte and the length of its binary chunk; none unless the file is one in good order.
fn glb(file: &mut fs::File, size: u64) -> io::Result<Option<(Vec<u8>, u64, u64)>> {
    let word = |bytes: &[u8]| u64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let (mut head, mut chunk) = ([0; 20], [0; 8]);
    if size < 28 {
        return Ok(None);
    }
    file.read_exact(&mut head)?;
    let (end, json_length) = (word(&head[8..12]), word(&head[12..16]));
    let is_glb = head.starts_with(b"glTF\x02\0\0\0") && &head[16..20] == b"JSON" && end <= size;
    let start = 28 + json_length;
    if !is_glb || start > end || json_length > limits::JSON_BYTES {
        return Ok(None);
    }
    let mut json = vec![0; json_length as usize];
    file.read_exact(&mut json)?;
    file.read_exact(&mut chunk)?;
    let length = word(&chunk[..4]);
    Ok((&chunk[4..] == b"BIN\0" && length <= end - start).then_some((json, start, length)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::memory::MemoryBudget;

    fn glb_of(json: &[u8], binary: &[u8]) -> Vec<u8> {
        let words = |words: [u32; 2]| words.map(u32::to_le_bytes).concat();
        let length = |bytes: &[u8]| bytes.len() as u32;
        let mut glb = [b"glTF".to_vec(), words([2, 28 + length(json) + length(binary)]), length(json).to_le_bytes().to_vec()].concat();
        glb.extend([b"JSON", json, &length(binary).to_le_bytes(), b"BIN\0", binary].concat());
        glb
    }

    fn opened(path: &Path) -> ModelFile {
        ModelFile::open(path, 1 << 20, &Limits::of_files(MemoryBudget::LEAST)).expect("a regular file")
    }

    #[test]
    fn the_binary_chunk_of_a_glb_is_read_from_its_file_when_it_is_needed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.glb");
        let binary: Vec<u8> = (0..200).collect();
        fs::write(&path, glb_of(b"{}  ", &binary)).expect("a file");
        let ModelFile::Glb { json, binary: part, size } = opened(&path) else { panic!("it is a GLB in good order") };
        assert_eq!((json.as_slice(), size, part.unread()), (&b"{}  "[..], 232, 200));
        let (mut bytes, there) = (vec![7], Bytes::File(&part));
        there.append_to(&mut bytes, 20..25).expect("it can be read");
        assert_eq!((bytes, part.unread()), (vec![7, 20, 21, 22, 23, 24], 195));
        assert_eq!(there.all(), Ok(&binary[..]));
        let mut bytes = Vec::new();
        there.append_to(&mut bytes, 198..200).expect("it is in memory");
        assert_eq!((bytes, there.len(), part.unread()), (vec![198, 199], 200, 0));
    }

    #[test]
    fn a_file_that_becomes_shorter_while_it_is_read_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.glb");
        fs::write(&path, glb_of(b"{}  ", &[1; 200])).expect("a file");
        let ModelFile::Glb { binary, .. } = opened(&path) else { panic!("it is a GLB in good order") };
        fs::File::options().write(true).open(&path).and_then(|file| file.set_len(100)).expect("it can be cut");
        let shorter = Err(LoadError::new("the file has become shorter while it was read; load it again"));
        assert_eq!(Bytes::File(&binary).append_to(&mut Vec::new(), 50..150), shorter);
        assert_eq!(Bytes::File(&binary).all().map(drop), shorter);
    }

    #[test]
    fn what_is_no_glb_in_good_order_is_read_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model");
        let good = glb_of(b"{}  ", &[1; 8]);
        let patched = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            bytes
        };
        let wrong =
            [patched(0, b'x'), patched(4, 1), patched(8, 255), patched(12, 255), patched(16, b'x'), patched(24, 9), patched(28, b'x')];
        for bytes in wrong.into_iter().chain([good[..27].to_vec(), b"{}".to_vec(), Vec::new()]) {
            fs::write(&path, &bytes).expect("a file");
            let ModelFile::Whole(read) = opened(&path) else { panic!("it was taken for a GLB: {bytes:?}") };
            assert_eq!(read, bytes);
        }
    }
}
