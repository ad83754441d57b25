//! Pictures: PNG files that hold the preset, version, adapter and driver that made them, and that restore the preset.

use std::{
    io::{Cursor, Write},
    path::Path,
};

use super::{
    error::PresetError,
    file::{PresetFile, to_shared_toml},
    load::{MAX_BYTES, parse_file, read_capped},
};
use crate::frame::Frame;

const PRESET: &str = "rasterlab preset";
/// The keyword of the preset in pictures of schema 1.
const PRESET_BEFORE: &str = "rasterlab look";
const ADAPTER: &str = "rasterlab adapter";
/// Hash of everything that decides the picture: a frame of a sequence is finished when it has the right one.
const FINGERPRINT: &str = "rasterlab frame";
/// The end of every complete PNG: the empty chunk IEND and its checksum.
const END: [u8; 12] = [0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82];

/// Longest PNG that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 28;

/// What drew a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the adapter, or `cpu`.
    pub adapter: String,
    pub driver: String,
}

/// The picture as a PNG that restores the preset when it is opened or dropped.
pub fn png_with_preset(frame: &Frame, preset_file: &PresetFile, provenance: &Provenance) -> Result<Vec<u8>, PresetError> {
    encode(&frame.color, [frame.width, frame.height], &texts(preset_file, provenance, None))
}

/// The picture as one frame of a sequence: as [`png_with_preset`], and with the `fingerprint` that recognizes it.
pub fn png_of_frame(frame: &Frame, preset_file: &PresetFile, provenance: &Provenance, fingerprint: &str) -> Result<Vec<u8>, PresetError> {
    encode(&frame.color, [frame.width, frame.height], &texts(preset_file, provenance, Some(fingerprint)))
}

/// The texts that a picture carries.
pub(super) fn texts(preset_file: &PresetFile, provenance: &Provenance, fingerprint: Option<&str>) -> Vec<(&'static str, String)> {
    let Provenance { adapter, driver } = provenance;
    let software = format!("rasterlab {}", env!("CARGO_PKG_VERSION"));
    let fingerprint = fingerprint.map(|fingerprint| (FINGERPRINT, fingerprint.to_owned()));
    let made_by = [("Software", software), (ADAPTER, adapter.clone()), ("rasterlab driver", driver.clone())];
    made_by.into_iter().chain(fingerprint).chain([(PRESET, to_shared_toml(preset_file))]).collect()
}

/// The picture without texts: `size` is width and height, `color` row-major RGBA.
pub fn png_bytes(color: &[[u8; 4]], size: [u32; 2]) -> Result<Vec<u8>, PresetError> {
    encode(color, size, &[])
}

pub(super) fn failed(reason: impl ToString) -> PresetError {
    PresetError::Write { file: "PNG".into(), reason: reason.to_string() }
}

fn encode(color: &[[u8; 4]], size: [u32; 2], texts: &[(&str, String)]) -> Result<Vec<u8>, PresetError> {
    let mut bytes = Vec::new();
    let mut writer = encoder(&mut bytes, size, texts)?.write_header().map_err(failed)?;
    writer.write_image_data(bytemuck::cast_slice(color)).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

pub(super) fn encoder<W: Write>(
    to: W,
    [width, height]: [u32; 2],
    texts: &[(&str, String)],
) -> Result<png::Encoder<'static, W>, PresetError> {
    if width == 0 || height == 0 {
        return Err(failed(format!("the size is {width}x{height}; PNG cannot hold a picture without pixels")));
    }
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).into(), text.clone()).map_err(failed)?;
    }
    Ok(encoder)
}

/// Whether a file is a certain frame or animation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameStatus {
    /// There is no such file, or it is empty, or a PNG that is cut off.
    Absent,
    /// Complete, of the right size, with the right fingerprint.
    Finished {
        /// Name of the adapter that drew it, or `cpu`.
        adapter: String,
    },
    /// Complete, but something else.
    Other,
}

/// Is the picture at `path` complete, of this `size` and with this `fingerprint`? Decodes it to the end, since a file with a
/// correct header may be cut off.
///
/// # Errors
/// The file cannot be read.
pub fn frame_status(path: &Path, size: [u32; 2], fingerprint: &str) -> Result<FrameStatus, PresetError> {
    if !path.exists() {
        return Ok(FrameStatus::Absent);
    }
    let bytes = read_capped(path, MAX_FILE_BYTES)?;
    let is_png = bytes.starts_with(b"\x89PNG\r\n\x1a\n");
    if bytes.is_empty() || (is_png && !bytes.ends_with(&END)) {
        return Ok(FrameStatus::Absent);
    }
    if !is_png {
        return Ok(FrameStatus::Other);
    }
    let Ok(mut reader) = png::Decoder::new_with_limits(Cursor::new(&bytes), png::Limits { bytes: 2 << 30 }).read_info() else {
        return Ok(FrameStatus::Absent);
    };
    let text = |reader: &png::Reader<_>, keyword: &str| {
        let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == keyword)?;
        chunk.get_text().ok()
    };
    let is_expected = text(&reader, FINGERPRINT).as_deref() == Some(fingerprint) && [reader.info().width, reader.info().height] == size;
    let adapter = text(&reader, ADAPTER).unwrap_or_default();
    let frames = reader.info().animation_control().map_or(1, |control| control.num_frames);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let is_complete = (0..frames).all(|_| reader.next_frame(&mut pixels).is_ok());
    Ok(match (is_complete, is_expected) {
        (false, _) => FrameStatus::Absent,
        (true, true) => FrameStatus::Finished { adapter },
        (true, false) => FrameStatus::Other,
    })
}

/// Pixels of any PNG as row-major RGBA, with width and height; at most 16,384 pixels a side.
pub fn png_pixels(path: &Path) -> Result<(Vec<[u8; 4]>, [u32; 2]), PresetError> {
    let failed = |reason: String| PresetError::Read { file: path.display().to_string(), reason };
    let bytes = read_capped(path, MAX_FILE_BYTES)?;
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(16_384), Some(16_384));
    limits.max_alloc = Some(2 << 30);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| failed(e.to_string()))?.into_rgba8();
    let size = [picture.width(), picture.height()];
    Ok((bytemuck::pod_collect_to_vec(picture.as_raw()), size))
}

/// The preset inside a picture that rasterlab saved; `file` is what errors call it.
///
/// # Errors
/// No readable PNG, or one without a preset.
pub fn preset_from_png(bytes: &[u8], file: &str) -> Result<PresetFile, PresetError> {
    let not_ours = |reason: String| PresetError::NotOurs { what: file.into(), reason };
    let limits = png::Limits { bytes: 16 << 20 };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Texts come before the pixels, so only the header is read.
    let info = decoder.read_header_info().map(|_| ()).and_then(|()| decoder.read_info());
    let reader = info.map_err(|e| not_ours(format!("it is no readable PNG ({e})")))?;
    let chunk = reader.info().utf8_text.iter().find(|chunk| [PRESET, PRESET_BEFORE].contains(&chunk.keyword.as_str()));
    let mut chunk = chunk.ok_or_else(|| not_ours("it was not saved by rasterlab, or saved with --bare".into()))?.clone();
    chunk.decompress_text_with_limit(MAX_BYTES).map_err(|_| not_ours("its preset is longer than 1 MiB or garbled".into()))?;
    let toml = chunk.get_text().map_err(|e| not_ours(e.to_string()))?;
    parse_file(&toml, "picture", file)
}
