//! Values of flags that are read from text. What cannot be read is said with what can be written.

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, StringValueParser, TypedValueParser};

use crate::{
    film::{Turntable, read_rate},
    preset::{NAMED_SIZES, named_size},
};

/// The name of a file to write, or a template of names, without the blanks around it.
pub fn name() -> impl TypedValueParser<Value = String> {
    StringValueParser::new().map(|name| name.trim().to_owned())
}

/// [`name`] as a path, which need not be text.
pub fn path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| {
        path.to_str()
            .map_or(path.clone(), |name| name.trim().into())
    })
}

/// `30..60`, `..60`, `30..`.
pub fn frames(text: &str) -> Result<[Option<u32>; 2], String> {
    let wrong = || {
        format!(
            "{text:?} is no range of frames; write A..B, A.. or ..B with whole numbers, B excluded, for instance 0..60"
        )
    };
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let end = |end: &str| {
        if end.is_empty() {
            Ok(None)
        } else {
            end.parse().map(Some).map_err(|_| wrong())
        }
    };
    match [end(from)?, end(to)?] {
        [Some(from), Some(to)] if from >= to => {
            Err(format!("{text} has no frame: {from} is not before {to}"))
        }
        ends => Ok(ends),
    }
}

/// `camera` or `scene`.
pub fn turntable(text: &str) -> Result<Turntable, String> {
    match text {
        "camera" => Ok(Turntable::Camera),
        "scene" => Ok(Turntable::Scene),
        _ => Err(format!("{text:?} cannot turn; write camera or scene")),
    }
}

/// A number from 0 to 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|fraction| (0.0..=1.0).contains(fraction))
        .ok_or_else(|| format!("{text:?} is no number from 0 to 1"))
}

/// `30`, `29.97` or `30000/1001`.
pub fn rate(text: &str) -> Result<f64, String> {
    read_rate(text).ok_or_else(|| {
        format!("{text:?} is no rate; write a number of frames a second or a fraction, for instance 30 or 30000/1001")
    })
}

/// `1920x1080`, or the name of a size.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    if let Some(size) = named_size(text) {
        return Ok(size);
    }
    let wrong = || {
        let names: Vec<&str> = NAMED_SIZES.iter().map(|(name, _)| *name).collect();
        format!(
            "{text:?} is no size; write WIDTHxHEIGHT, each 1 to 16384, for instance 1920x1080, or one of {}",
            names.join(", ")
        )
    };
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |side: &str| {
        side.parse()
            .ok()
            .filter(|side| (1..=16_384).contains(side))
            .ok_or_else(wrong)
    };
    Ok([side(width)?, side(height)?])
}
