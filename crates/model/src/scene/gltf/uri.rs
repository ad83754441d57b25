//! URIs: decodes `data:`, passes plain relative paths to the reader, and refuses everything else.

use std::path::PathBuf;

use base64::{
    Engine,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use super::error::{LoadError, ReadFile, quoted};
use crate::legible::text_of;

/// Real files often omit the padding, or leave bits in the last character.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The bytes that `uri` refers to, at most `most`.
pub fn resolve(uri: &str, most: u64, read: &mut ReadFile) -> Result<Vec<u8>, LoadError> {
    let bytes = match data_of(uri) {
        Some(data) => decode(data)?,
        None => read(&relative(uri)?, most).map_err(|error| error.within(quoted(uri)))?,
    };
    if bytes.len() as u64 > most {
        return Err(LoadError::end(format!(
            "it has {} bytes, but only {most} of the limit for all files of a model are left",
            bytes.len()
        )));
    }
    Ok(bytes)
}

/// What follows the scheme of a data URI; schemes have no case.
fn data_of(uri: &str) -> Option<&str> {
    let (scheme, rest) = uri.trim_start().split_once(':')?;
    scheme.eq_ignore_ascii_case("data").then_some(rest)
}

fn decode(data: &str) -> Result<Vec<u8>, LoadError> {
    let (kind, payload) = data
        .split_once(',')
        .ok_or_else(|| LoadError::new("its data URI has no comma"))?;
    let malformed = || LoadError::new("its data URI is malformed: a % stands before no two digits");
    let mut bytes = match payload.contains('%') {
        true => percent_decoded(payload).ok_or_else(malformed)?,
        false => payload.as_bytes().to_vec(),
    };
    if !kind.to_ascii_lowercase().trim_end().ends_with(";base64") {
        return Ok(bytes);
    }
    bytes.retain(|byte| !byte.is_ascii_whitespace());
    // Some writers use the letters of URLs.
    bytes.iter_mut().for_each(|byte| match byte {
        b'-' => *byte = b'+',
        b'_' => *byte = b'/',
        _ => {}
    });
    BASE64
        .decode(&bytes)
        .map_err(|error| LoadError::new(format!("its data URI is malformed: {error}")))
}

/// A path inside the model's folder, after percent-decoding.
pub fn relative(uri: &str) -> Result<PathBuf, LoadError> {
    let refused = |reason: &str| LoadError::new(format!("URI {} {reason}", quoted(uri)));
    let decoded = percent_decoded(uri).ok_or_else(|| refused("is not percent-encoded UTF-8"))?;
    let decoded = text_of(&decoded);
    inside(&decoded).map_err(refused)
}

/// A path inside the model's folder: no scheme, no root and no `..` that leads out.
///
/// # Errors
/// It is none: the end of a sentence that begins with the path.
pub fn inside(path: &str) -> Result<PathBuf, &'static str> {
    const LEADS_OUT: &str = "leads out of the model's folder; copy the file there";
    if path.contains('\0') {
        return Err("contains a NUL");
    }
    // Writers on Windows leave its separators.
    let path = path.replace('\\', "/");
    // A colon before the first slash ends a scheme or a drive letter.
    if path
        .split('/')
        .next()
        .is_some_and(|first| first.contains(':'))
    {
        return Err("has a scheme; only data: URIs and relative paths are supported");
    }
    if path.starts_with('/') {
        return Err(LEADS_OUT);
    }
    let mut parts = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop().ok_or(LEADS_OUT)?),
            name => parts.push(name),
        }
    }
    match parts.is_empty() {
        true => Err("names no file"),
        false => Ok(parts.iter().collect()),
    }
}

fn percent_decoded(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(if byte == b'%' {
            let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
            (16 * digit(rest.next())? + digit(rest.next())?) as u8
        } else {
            byte
        });
    }
    Some(bytes)
}
