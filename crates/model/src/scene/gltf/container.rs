//! Containers: the JSON and the binary chunk of a GLB, or the JSON of a `.gltf` file.

use std::borrow::Cow;

use super::{
    error::LoadError,
    notes::Notes,
    other_file,
    source::{Bytes, Source, reserve},
};
use crate::legible::group_digits;

/// The JSON and, of a GLB, the binary chunk.
///
/// # Errors
/// The file is another one, or has no whole JSON.
pub fn split<'a>(
    model: &'a dyn Source,
    notes: &Notes,
) -> Result<(Bytes<'a>, Option<Bytes<'a>>), LoadError> {
    let size = model.size();
    let mut head = Vec::new();
    model.append_to(&mut head, 0..size.min(12))?;
    if head.starts_with(b"glTF") {
        return split_glb(model, &head, notes);
    }
    let read = head.len() as u64;
    model.append_to(&mut head, read..size.min(200))?;
    if let Some(what) = other_file::named(&head) {
        return Err(LoadError::new(format!("it is not a glTF file: {what}")));
    }
    if model.in_memory().is_some() {
        return Ok((Bytes::of(model, 0..size), None));
    }
    let read = head.len() as u64;
    reserve(&mut head, size - read)?;
    model.append_to(&mut head, read..size)?;
    Ok((Bytes::Memory(Cow::Owned(head)), None))
}

/// The chunks of a GLB whose first bytes are `head`.
fn split_glb<'a>(
    model: &'a dyn Source,
    head: &[u8],
    notes: &Notes,
) -> Result<(Bytes<'a>, Option<Bytes<'a>>), LoadError> {
    let size = model.size();
    if size < 12 {
        return Err(LoadError::new(format!(
            "the GLB header has {size} of 12 bytes; the file is truncated"
        )));
    }
    let (version, length) = (word(&head[4..]), u64::from(word(&head[8..])));
    if version != 2 {
        return Err(LoadError::new(format!(
            "GLB version {version} is not supported; export as version 2"
        )));
    }
    let (mut at, mut json, mut binary, mut short) = (12, None, None, None);
    while at + 8 <= size && binary.is_none() {
        let mut head = Vec::new();
        model.append_to(&mut head, at..at + 8)?;
        let (start, mut bytes) = (at + 8, u64::from(word(&head)));
        let is_json = json.is_none();
        if bytes > size - start {
            let sentence = format!(
                "a GLB chunk states {bytes} bytes, but only {} follow; the file is truncated",
                size - start
            );
            if is_json {
                return Err(LoadError::new(sentence));
            }
            short = Some(sentence);
            bytes = size - start;
        }
        at = start + bytes;
        let part = Bytes::of(model, start..at);
        match (&head[4..], is_json) {
            (b"JSON", true) => json = Some(part),
            (_, true) => return Err(LoadError::new("the first GLB chunk is not JSON")),
            (b"BIN\0", false) => binary = Some(part),
            // Chunks of unknown types are to be ignored.
            _ => {}
        }
        // Chunks begin at multiples of 4 bytes; not every writer pads them.
        if !at.is_multiple_of(4) && at < size {
            let padded = at.next_multiple_of(4);
            let mut kind = Vec::new();
            model.append_to(&mut kind, at..(at + 8).min(size))?;
            if !kind.ends_with(b"BIN\0") {
                at = padded;
            }
        }
    }
    let json =
        json.ok_or_else(|| LoadError::new("the GLB has no chunk of JSON; it is truncated"))?;
    if length > size && (short.is_some() || binary.is_none()) {
        let [there, stated] = [size, length].map(group_digits);
        notes.cut_off(format!(
            "the file is cut off after {there} of {stated} bytes"
        ));
        // What the missing chunk would hold is missing with it.
        binary = binary.or(Some(Bytes::Memory(Cow::Borrowed(&[]))));
    } else if length != size {
        notes.fault(|| format!("the GLB header states {length} bytes, but the file has {size}"));
    }
    if let Some(sentence) = short.filter(|_| !notes.is_cut_off()) {
        notes.fault(|| sentence);
    }
    Ok((json, binary))
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

/// The text of the JSON: UTF-8 without the byte order mark and the padding that some writers add.
pub fn text<'a>(json: &'a [u8], notes: &Notes) -> Cow<'a, str> {
    let mut plain = json;
    if let Some(rest) = plain.strip_prefix(b"\xef\xbb\xbf") {
        notes.fault(|| "the JSON begins with a byte order mark; it is ignored");
        plain = rest;
    }
    let padding = plain.iter().rev().take_while(|&&byte| byte == 0).count();
    if padding > 0 {
        notes.fault(
            || "the JSON is padded with NUL; spaces are required, and the padding is ignored",
        );
        plain = &plain[..plain.len() - padding];
    }
    if let Ok(text) = std::str::from_utf8(plain) {
        return text.into();
    }
    notes.fault(|| "the JSON has bytes that are not UTF-8; their characters are replaced");
    // By those of their numbers, so that names stay distinct.
    let mut text = String::with_capacity(plain.len());
    for chunk in plain.utf8_chunks() {
        text.push_str(chunk.valid());
        text.extend(chunk.invalid().iter().copied().map(char::from));
    }
    text.into()
}
