//! Shots: PNG pictures that say which look, version, adapter and driver made them, and give the look back.

use std::{io::Cursor, path::Path};

use super::{Look, PresetError, parse_file, read::MAX_BYTES, read_capped, to_toml};
use crate::frame::Frame;

const LOOK: &str = "rasterlab look";

/// Longest PNG that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 28;

/// Who made a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the adapter, or `cpu`.
    pub adapter: String,
    pub driver: String,
}

/// The picture as a PNG that restores `look` when it is opened or dropped.
pub fn png_with_look(frame: &Frame, look: &Look, provenance: &Provenance) -> Result<Vec<u8>, PresetError> {
    let Provenance { adapter, driver } = provenance;
    let software = format!("rasterlab {}", env!("CARGO_PKG_VERSION"));
    let toml = to_toml(look);
    encode(
        &frame.color,
        [frame.width, frame.height],
        &[("Software", &software), ("rasterlab adapter", adapter), ("rasterlab driver", driver), (LOOK, &toml)],
    )
}

/// The bare picture: `size` is width and height, `color` row-major RGBA.
pub fn png_bytes(color: &[[u8; 4]], size: [u32; 2]) -> Result<Vec<u8>, PresetError> {
    encode(color, size, &[])
}

fn encode(color: &[[u8; 4]], [width, height]: [u32; 2], texts: &[(&str, &str)]) -> Result<Vec<u8>, PresetError> {
    let failed = |reason: String| PresetError::Write { file: "PNG".into(), reason };
    if width == 0 || height == 0 {
        return Err(failed(format!("a picture of {width}x{height} pixels has none, and PNG cannot hold it")));
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).into(), (*text).into()).map_err(|e| failed(e.to_string()))?;
    }
    let mut writer = encoder.write_header().map_err(|e| failed(e.to_string()))?;
    writer.write_image_data(bytemuck::cast_slice(color)).map_err(|e| failed(e.to_string()))?;
    writer.finish().map_err(|e| failed(e.to_string()))?;
    Ok(bytes)
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

/// The look inside a picture of ours; `file` is its name for people.
pub fn look_from_png(bytes: &[u8], file: &str) -> Result<Look, PresetError> {
    let not_ours = |reason: String| PresetError::NotOurs { what: file.into(), reason };
    let limits = png::Limits { bytes: 16 << 20 };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Text stands before the pixels, so the header is all that is read.
    let info = decoder.read_header_info().map(|_| ()).and_then(|()| decoder.read_info());
    let reader = info.map_err(|e| not_ours(format!("it is no readable PNG ({e})")))?;
    let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == LOOK);
    let mut chunk = chunk.ok_or_else(|| not_ours("it was not saved by rasterlab, or bare".into()))?.clone();
    chunk.decompress_text_with_limit(MAX_BYTES).map_err(|_| not_ours("its look is longer than 1 MiB or garbled".into()))?;
    let toml = chunk.get_text().map_err(|e| not_ours(e.to_string()))?;
    parse_file(&toml, "shot", file)
}
