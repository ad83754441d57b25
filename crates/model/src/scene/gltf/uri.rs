//! URIs: decodes `data:`, passes plain relative paths to the reader, and refuses everything else.

use std::path::{Component, Path, PathBuf};

use base64::{
    Engine,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use super::error::{LoadError, ReadFile, quoted};

/// Real files often omit the padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes that `uri` refers to, at most `most`.
pub fn resolve(uri: &str, most: u64, read: &mut ReadFile) -> Result<Vec<u8>, LoadError> {
    let bytes = match uri.strip_prefix("data:") {
        Some(data) => decode(data)?,
        None => read(&relative(uri)?, most).map_err(|error| error.within(quoted(uri)))?,
    };
    if bytes.len() as u64 > most {
        return Err(LoadError::new(format!(
            "it has {} bytes, but only {most} of the limit for all files of a model are left",
            bytes.len()
        )));
    }
    Ok(bytes)
}

fn decode(data: &str) -> Result<Vec<u8>, LoadError> {
    let (kind, payload) = data
        .split_once(',')
        .ok_or_else(|| LoadError::new("its data URI has no comma"))?;
    if !kind.ends_with(";base64") {
        return Err(LoadError::new("its data URI is not base64"));
    }
    BASE64
        .decode(payload)
        .map_err(|error| LoadError::new(format!("its data URI is malformed: {error}")))
}

/// A path inside the model's folder: no scheme, no root and no `..` after percent-decoding.
pub fn relative(uri: &str) -> Result<PathBuf, LoadError> {
    let refused = |reason: &str| LoadError::new(format!("URI {} {reason}", quoted(uri)));
    let decoded = percent_decoded(uri).ok_or_else(|| refused("is not percent-encoded UTF-8"))?;
    if decoded.contains(['\0', '\\']) {
        return Err(refused("contains a NUL or a backslash"));
    }
    // A colon before the first slash ends a scheme or a drive letter.
    if decoded
        .split('/')
        .next()
        .is_some_and(|first| first.contains(':'))
    {
        return Err(refused(
            "has a scheme; only data: URIs and relative paths are supported",
        ));
    }
    let path = Path::new(&decoded);
    if !path
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
    {
        return Err(refused(
            "leads out of the model's folder; copy the file there",
        ));
    }
    if path.file_name().is_none() {
        return Err(refused("names no file"));
    }
    Ok(path.into())
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(if byte == b'%' {
            let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
            (16 * digit(rest.next())? + digit(rest.next())?) as u8
        } else {
            byte
        });
    }
    String::from_utf8(bytes).ok()
}
