//! Frames of a sequence that are there already: whether a file is finished, cut off, or somebody
//! else's.
//!
//! Nothing is decoded: the checksums of a PNG's chunks say whether every byte is as it was written,
//! so that a file of any stated size is judged in constant memory.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::Path,
};

use flate2::Crc;

use super::{atomic::is_taken, error::PresetError};

/// Keyword of the text that says what drew a picture.
pub(super) const ADAPTER: &str = "rasterlab adapter";
/// Keyword of the hash of everything that decides the picture: a frame of a sequence is finished
/// when it has the right one.
pub(super) const FINGERPRINT: &str = "rasterlab frame";

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Our texts stand in front of the pixels; a damaged file is searched this far for them, bytes.
const HEAD: u64 = 1 << 20;

/// Longest text that is looked at, bytes. Those that recognize a frame are much shorter.
const MAX_TEXT: u32 = 1 << 16;

/// Whether a file is a certain frame or animation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameStatus {
    /// There is nothing of this name.
    Absent,
    /// An empty file, or a frame of ours that is cut off or damaged.
    Unfinished,
    /// Complete and undamaged, of the right size, with the right fingerprint.
    Finished {
        /// Name of the adapter that drew it, or `cpu`.
        adapter: String,
    },
    /// Something else, which is not ours to overwrite.
    Other,
}

/// Is the file at `path` the picture with this `size` (width, height) and `fingerprint`? A pipe or
/// device is never opened.
pub fn frame_status(
    path: &Path,
    size: [u32; 2],
    fingerprint: &str,
) -> Result<FrameStatus, PresetError> {
    if !is_taken(path) {
        return Ok(FrameStatus::Absent);
    }
    match std::fs::metadata(path) {
        Ok(about) if about.is_file() && about.len() == 0 => return Ok(FrameStatus::Unfinished),
        Ok(about) if about.is_file() => {}
        _ => return Ok(FrameStatus::Other),
    }
    let failed = |error: io::Error| PresetError::Read {
        file: path.display().to_string(),
        reason: error.to_string(),
    };
    let chunks = File::open(path)
        .and_then(|file| chunks(BufReader::new(file)))
        .map_err(failed)?;
    Ok(match chunks {
        Chunks::Intact(texts) => match texts.is_frame(size, fingerprint) {
            true => FrameStatus::Finished {
                adapter: texts.adapter.unwrap_or_default(),
            },
            false => FrameStatus::Other,
        },
        Chunks::NoPng | Chunks::Trailed => FrameStatus::Other,
        Chunks::Damaged => match has_mark(path, fingerprint).map_err(failed)? {
            true => FrameStatus::Unfinished,
            false => FrameStatus::Other,
        },
    })
}

/// Is this the beginning of a PNG that is cut off, or in which a checksum is wrong?
pub(super) fn is_damaged(bytes: &[u8]) -> bool {
    matches!(chunks(bytes), Ok(Chunks::Damaged))
}

/// Is a damaged file a frame of ours? A flipped bit hits either the name of the mark or the
/// fingerprint itself, and not both.
fn has_mark(path: &Path, fingerprint: &str) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    let has = |mark: &[u8]| head.windows(mark.len()).any(|bytes| bytes == mark);
    Ok(has(FINGERPRINT.as_bytes()) || has(fingerprint.as_bytes()))
}

/// What the chunks of a file say.
enum Chunks {
    NoPng,
    /// Every checksum is right, and nothing follows the end.
    Intact(Texts),
    /// Intact, but bytes follow the end.
    Trailed,
    Damaged,
}

/// What recognizes a frame.
#[derive(Default)]
struct Texts {
    /// Width and height, pixels.
    size: [u32; 2],
    fingerprint: Option<String>,
    adapter: Option<String>,
    /// Frames that an animation announces, and that it has.
    announced: u32,
    frames: u32,
}

impl Texts {
    fn is_frame(&self, size: [u32; 2], fingerprint: &str) -> bool {
        self.fingerprint.as_deref() == Some(fingerprint)
            && self.size == size
            && self.announced == self.frames
    }

    /// Takes what a chunk says; `head` are its first bytes.
    fn take(&mut self, name: [u8; 4], head: &[u8]) {
        let word = |at: usize| {
            head.get(at..at + 4).map_or(0, |bytes| {
                u32::from_be_bytes(bytes.try_into().unwrap_or_default())
            })
        };
        match &name {
            b"IHDR" => self.size = [word(0), word(4)],
            b"acTL" => self.announced = word(0),
            b"fcTL" => self.frames += 1,
            b"iTXt" => {
                let Some((keyword, text)) = text(head) else {
                    return;
                };
                match keyword {
                    FINGERPRINT => self.fingerprint = Some(text.into()),
                    ADAPTER => self.adapter = Some(text.into()),
                    _ => {}
                }
            }
            _ => {}
        }
    }
}

/// Keyword and text of an iTXt chunk that is not compressed, as ours are.
fn text(chunk: &[u8]) -> Option<(&str, &str)> {
    let (keyword, rest) = std::str::from_utf8(chunk).ok()?.split_once('\0')?;
    let rest = rest.strip_prefix("\0\0")?;
    let (_language, rest) = rest.split_once('\0')?;
    let (_translated, text) = rest.split_once('\0')?;
    Some((keyword, text))
}

/// Reads a PNG to its end and compares the checksum of every chunk.
fn chunks(mut file: impl Read) -> io::Result<Chunks> {
    let mut signature = Vec::new();
    file.by_ref()
        .take(SIGNATURE.len() as u64)
        .read_to_end(&mut signature)?;
    if signature != SIGNATURE {
        return Ok(Chunks::NoPng);
    }
    let mut texts = Texts::default();
    loop {
        let Some(length) = word(&mut file)? else {
            return Ok(Chunks::Damaged);
        };
        let Some(name) = word(&mut file)?.map(u32::to_be_bytes) else {
            return Ok(Chunks::Damaged);
        };
        let mut crc = Crc::new();
        crc.update(&name);
        let mut head = Vec::new();
        file.by_ref()
            .take(u64::from(length.min(MAX_TEXT)))
            .read_to_end(&mut head)?;
        crc.update(&head);
        let mut left = u64::from(length) - head.len() as u64;
        let mut block = [0; 1 << 14];
        while left > 0 {
            let read = file.by_ref().take(left).read(&mut block)?;
            if read == 0 {
                return Ok(Chunks::Damaged);
            }
            crc.update(&block[..read]);
            left -= read as u64;
        }
        if word(&mut file)? != Some(crc.sum()) {
            return Ok(Chunks::Damaged);
        }
        texts.take(name, &head);
        if &name == b"IEND" {
            let is_end = file.read(&mut [0])? == 0;
            return Ok(if is_end {
                Chunks::Intact(texts)
            } else {
                Chunks::Trailed
            });
        }
    }
}

/// The next four bytes, if the file has as many.
fn word(file: &mut impl Read) -> io::Result<Option<u32>> {
    let mut bytes = Vec::new();
    file.take(4).read_to_end(&mut bytes)?;
    Ok(bytes.try_into().ok().map(u32::from_be_bytes))
}
