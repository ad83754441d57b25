//! The bytes of a model in their order, as lines or as records, of which few are in memory at once.

use std::str::FromStr;

use crate::scene::{
    bounds::MAX_PLACE,
    gltf::{LoadError, PART_BYTES, Source},
};

/// A place in a model, up to which it was read.
pub struct Stream<'a> {
    source: &'a dyn Source,
    /// Where the bytes behind those of `buffer` begin.
    unread: u64,
    buffer: Vec<u8>,
    /// Where the next byte lies in `buffer`.
    next: usize,
    /// The number of lines that were read.
    pub line: u64,
}

impl<'a> Stream<'a> {
    /// The beginning of a model.
    pub fn new(source: &'a dyn Source) -> Self {
        Self {
            source,
            unread: 0,
            buffer: Vec::new(),
            next: 0,
            line: 0,
        }
    }

    /// Bytes of the model that are left.
    pub fn left(&self) -> u64 {
        self.source.size() - self.unread + (self.buffer.len() - self.next) as u64
    }

    /// Appends the next part of the model to the buffer; false at its end.
    fn fill(&mut self) -> Result<bool, LoadError> {
        let end = (self.unread + PART_BYTES as u64).min(self.source.size());
        if end == self.unread {
            return Ok(false);
        }
        self.buffer.drain(..self.next);
        self.next = 0;
        self.source.append_to(&mut self.buffer, self.unread..end)?;
        self.unread = end;
        Ok(true)
    }

    /// The next `count` bytes; none where fewer are left.
    ///
    /// # Errors
    /// They cannot be read, or loading was canceled.
    pub fn bytes(&mut self, count: usize) -> Result<Option<&[u8]>, LoadError> {
        while self.buffer.len() - self.next < count {
            if !self.fill()? {
                return Ok(None);
            }
        }
        let start = self.next;
        self.next += count;
        Ok(Some(&self.buffer[start..self.next]))
    }

    /// [`Self::bytes`], which are read again.
    pub fn peek(&mut self, count: usize) -> Result<Option<&[u8]>, LoadError> {
        if self.bytes(count)?.is_none() {
            return Ok(None);
        }
        self.next -= count;
        Ok(Some(&self.buffer[self.next..self.next + count]))
    }

    /// Passes over `count` bytes; false where fewer are left.
    pub fn skip(&mut self, mut count: u64) -> Result<bool, LoadError> {
        if count > self.left() {
            return Ok(false);
        }
        while count > 0 {
            let part = count.min(PART_BYTES as u64);
            self.bytes(part as usize)?;
            count -= part;
        }
        Ok(true)
    }

    /// Replaces `line` by the next line without its end, which is that of any system; false where
    /// none is left.
    pub fn line(&mut self, line: &mut Vec<u8>) -> Result<bool, LoadError> {
        line.clear();
        if self.left() == 0 {
            return Ok(false);
        }
        if self.line == 0 && self.bytes(3)?.is_some_and(|bytes| bytes != b"\xef\xbb\xbf") {
            self.next -= 3;
        }
        self.line += 1;
        loop {
            let rest = &self.buffer[self.next..];
            let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let length = end.unwrap_or(rest.len());
            line.extend_from_slice(&rest[..length]);
            let ended = end.map(|end| rest[end]);
            self.next += length + usize::from(ended.is_some());
            if let Some(byte) = ended {
                let more = self.next < self.buffer.len() || self.fill()?;
                if byte == b'\r' && more && self.buffer[self.next] == b'\n' {
                    self.next += 1;
                }
                return Ok(true);
            }
            if !self.fill()? {
                return Ok(true);
            }
        }
    }
}

/// A number that a place may have, also one with a decimal comma.
pub fn number<T: FromStr + Copy + Into<f64>>(token: &str) -> Option<T> {
    let read = |text: &str| text.parse::<T>().ok();
    let value = read(token).or_else(|| read(&token.replacen(',', ".", 1)));
    value.filter(|&value| value.into().abs() < MAX_PLACE)
}

/// The first numbers of a line; none where one is missing or is no [`number`].
pub fn numbers<'a, T: FromStr + Copy + Default + Into<f64>, const N: usize>(
    mut tokens: impl Iterator<Item = &'a str>,
) -> Option<[T; N]> {
    let mut values = [T::default(); N];
    for value in &mut values {
        *value = number(tokens.next()?)?;
    }
    Some(values)
}

/// The first word of a line, and the rest of it without white space around.
pub fn split(line: &str) -> (&str, &str) {
    // Of ASCII alone: bytes of other encodings look like other spaces.
    let line = line.trim_matches(|c: char| c.is_ascii_whitespace());
    match line.split_once(|c: char| c.is_ascii_whitespace()) {
        Some((keyword, rest)) => (keyword, rest.trim_ascii_start()),
        None => (line, ""),
    }
}
