//! Sharing: a preset as one line of text, `rasterlab1:` + base64(deflate(TOML)). No server, no
//! account.

use std::io::{Read as _, Write as _};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use flate2::{Compression, read::DeflateDecoder, write::DeflateEncoder};

use super::{
    error::PresetError,
    file::{PASTED, PresetFile, normalized, to_shared_toml},
    load::{MAX_BYTES, parse_file},
};
use crate::preset::SceneSource;

const PREFIX: &str = "rasterlab1:";

/// The preset as one line. It has no folder, so it names a model by its whole path.
pub fn to_line(preset_file: &PresetFile) -> String {
    let mut shared = preset_file.clone();
    if let SceneSource::File(model) = shared.scene_source() {
        shared.preset.scene = SceneSource::File(normalized(&model).unwrap_or(model));
    }
    let mut deflate = DeflateEncoder::new(Vec::new(), Compression::best());
    deflate
        .write_all(to_shared_toml(&shared).as_bytes())
        .expect("memory takes all bytes");
    format!(
        "{PREFIX}{}",
        STANDARD.encode(deflate.finish().expect("memory takes all bytes"))
    )
}

/// Is a text that someone pastes meant as a preset: a shared line, or the text of a preset's file?
pub fn is_preset_text(text: &str) -> bool {
    text.trim_start().starts_with(PREFIX) || is_file_text(text)
}

/// Has it a key or a heading as files of presets do?
fn is_file_text(text: &str) -> bool {
    let has_key = text.lines().map(str::trim_start).any(|line| {
        let heading = line.strip_prefix('[').and_then(|name| name.chars().next());
        line.starts_with("schema") || heading.is_some_and(|c| c.is_ascii_lowercase())
    });
    has_key && !text.contains(PREFIX)
}

/// Is `pasted`, which was read from `text`, a look alone: the text of a file that names no scene? A shared line leaves
/// out a scene that is the default.
pub fn is_look_text(text: &str, pasted: &PresetFile) -> bool {
    is_file_text(text) && !pasted.document.contains_key("scene")
}

/// Reads a pasted line, the link of a page that carries one, or the text of a preset's file; white space from a mail or
/// chat is forgiven. A model outside of the current folder is not its scene before [`PresetFile::with_outside_model`].
pub fn from_line(line: &str) -> Result<PresetFile, PresetError> {
    let not_ours = |reason: &str| PresetError::NotOurs {
        what: "the pasted text".into(),
        reason: reason.into(),
    };
    if is_file_text(line) {
        return Ok(parse_file(line, PASTED, "the pasted text")?.held_to_folder());
    }
    // A link to a page carries the line after its address, and what its picture is after the line.
    let line = line.rsplit_once('#').map_or(line, |(_, line)| line);
    let line = line.split_once(';').map_or(line, |(line, _)| line);
    let packed = line.trim().strip_prefix(PREFIX).ok_or_else(|| {
        not_ours("it neither begins with rasterlab1: nor is the text of a preset")
    })?;
    let packed: String = packed
        .chars()
        .filter(|c| !c.is_whitespace())
        .take(MAX_BYTES * 2)
        .collect();
    let deflated = STANDARD
        .decode(packed)
        .map_err(|_| not_ours("it is cut off or garbled"))?;
    let mut toml = Vec::new();
    let inflate = DeflateDecoder::new(deflated.as_slice());
    inflate
        .take(MAX_BYTES as u64 + 1)
        .read_to_end(&mut toml)
        .map_err(|_| not_ours("it is cut off or garbled"))?;
    if toml.len() > MAX_BYTES {
        return Err(not_ours("it unpacks to more than 1 MiB"));
    }
    let toml = String::from_utf8(toml).map_err(|_| not_ours("it is not text"))?;
    Ok(parse_file(&toml, PASTED, "the pasted text")?.held_to_folder())
}
