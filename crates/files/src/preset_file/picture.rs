//! Pictures: PNG files that hold the preset, version, adapter and driver that made them, and that
//! restore the preset.

use std::{
    io::{Cursor, Write},
    path::Path,
};

use super::{
    error::PresetError,
    file::{PresetFile, stem, to_shared_toml},
    frame_status::{ADAPTER, FINGERPRINT, is_damaged},
    gallery::plain,
    load::{MAX_BYTES, parse_file, read_capped},
    look::Look,
};
use crate::{frame::Frame, host::stays_inside, params::legible_line, preset::SceneSource};

const PRESET: &str = "rasterlab preset";

/// Longest PNG that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 28;

/// What drew a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the adapter, or `cpu`.
    pub adapter: String,
    pub driver: String,
}

/// The picture as a PNG that restores the preset when it is opened or dropped.
pub fn png_with_preset(
    frame: &Frame,
    preset_file: &PresetFile,
    provenance: &Provenance,
) -> Result<Vec<u8>, PresetError> {
    encode(
        &frame.color,
        [frame.width, frame.height],
        &texts(preset_file, provenance, None)?,
    )
}

/// The picture as one frame of a sequence: as [`png_with_preset`], and with the `fingerprint` that
/// recognizes it.
pub fn png_of_frame(
    frame: &Frame,
    preset_file: &PresetFile,
    provenance: &Provenance,
    fingerprint: &str,
) -> Result<Vec<u8>, PresetError> {
    encode(
        &frame.color,
        [frame.width, frame.height],
        &texts(preset_file, provenance, Some(fingerprint))?,
    )
}

/// The texts that a picture carries.
pub(super) fn texts(
    preset_file: &PresetFile,
    provenance: &Provenance,
    fingerprint: Option<&str>,
) -> Result<Vec<(&'static str, String)>, PresetError> {
    preset_file.check_savable()?;
    let Provenance { adapter, driver } = provenance;
    let software = format!("rasterlab {}", env!("CARGO_PKG_VERSION"));
    let fingerprint = fingerprint.map(|fingerprint| (FINGERPRINT, fingerprint.to_owned()));
    let made_by = [
        ("Software", software),
        (ADAPTER, adapter.clone()),
        ("rasterlab driver", driver.clone()),
    ];
    Ok(made_by
        .into_iter()
        .chain(fingerprint)
        .chain([(PRESET, to_shared_toml(preset_file))])
        .collect())
}

/// The picture without texts: `size` is width and height, `color` row-major RGBA.
pub fn png_bytes(color: &[[u8; 4]], size: [u32; 2]) -> Result<Vec<u8>, PresetError> {
    encode(color, size, &[])
}

pub(super) fn failed(reason: impl ToString) -> PresetError {
    PresetError::Write {
        file: "PNG".into(),
        reason: reason.to_string(),
    }
}

fn encode(
    color: &[[u8; 4]],
    size: [u32; 2],
    texts: &[(&str, String)],
) -> Result<Vec<u8>, PresetError> {
    let mut bytes = Vec::new();
    let mut writer = encoder(&mut bytes, size, texts)?
        .write_header()
        .map_err(failed)?;
    writer
        .write_image_data(bytemuck::cast_slice(color))
        .map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

pub(super) fn encoder<W: Write>(
    to: W,
    [width, height]: [u32; 2],
    texts: &[(&str, String)],
) -> Result<png::Encoder<'static, W>, PresetError> {
    if width == 0 || height == 0 {
        return Err(failed(format!(
            "the size is {width}x{height}; PNG cannot hold a picture without pixels"
        )));
    }
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    for (keyword, text) in texts {
        encoder
            .add_itxt_chunk((*keyword).into(), text.clone())
            .map_err(failed)?;
    }
    Ok(encoder)
}

/// Pixels of any PNG as row-major RGBA, with width and height; at most 16,384 pixels a side.
pub fn png_pixels(path: &Path) -> Result<(Vec<[u8; 4]>, [u32; 2]), PresetError> {
    pixels_of_png(
        &read_capped(path, MAX_FILE_BYTES)?,
        &path.display().to_string(),
    )
}

/// [`png_pixels`] of the bytes of a file, which errors call `file`.
pub fn pixels_of_png(bytes: &[u8], file: &str) -> Result<(Vec<[u8; 4]>, [u32; 2]), PresetError> {
    let failed = |reason: String| PresetError::Read {
        file: file.into(),
        reason,
    };
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(16_384), Some(16_384));
    limits.max_alloc = Some(2 << 30);
    reader.limits(limits);
    let picture = reader
        .decode()
        .map_err(|e| failed(e.to_string()))?
        .into_rgba8();
    let size = [picture.width(), picture.height()];
    Ok((bytemuck::pod_collect_to_vec(picture.as_raw()), size))
}

/// Reads the preset of the picture at `path`. A picture may come from anyone: a model outside of
/// its folder is not its scene before [`PresetFile::with_outside_model`], and one of the same name
/// beside the picture is taken instead.
pub fn load_picture(path: &Path) -> Result<PresetFile, PresetError> {
    let file = path.display().to_string();
    let mut preset_file = PresetFile {
        id: stem(path),
        path: Some(path.to_owned()),
        read_only: true,
        ..preset_from_png(&read_capped(path, MAX_FILE_BYTES)?, &file)?
    }
    .held_to_folder();
    // A picture names no look: the plain one is known by what it does.
    let (own, plain) = (&preset_file.preset, plain());
    let is_plain = own.stack == plain.preset.stack
        && own.animation == plain.preset.animation
        && own.ground == plain.preset.ground
        && own.room == plain.preset.room;
    preset_file.look = is_plain.then(|| Look::of(plain));
    let beside = preset_file
        .outside_model
        .as_deref()
        .and_then(|model| Some((model, Path::new(model.file_name()?))))
        .filter(|(_, name)| stays_inside(name) && path.with_file_name(name).is_file());
    if let Some((model, name)) = beside {
        preset_file.warnings.push(format!(
            "{file}: its model {} lies elsewhere; {} beside the picture is used",
            legible_line(&model.to_string_lossy()),
            name.display()
        ));
        preset_file.preset.scene = SceneSource::File(name.to_owned());
        preset_file.outside_model = None;
    }
    Ok(preset_file)
}

/// The preset inside a picture that rasterlab saved; `file` is what errors call it.
pub fn preset_from_png(bytes: &[u8], file: &str) -> Result<PresetFile, PresetError> {
    let not_ours = |reason: String| PresetError::NotOurs {
        what: file.into(),
        reason,
    };
    let limits = png::Limits { bytes: 16 << 20 };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Texts come before the pixels, so only the header is read.
    let info = decoder
        .read_header_info()
        .map(|_| ())
        .and_then(|()| decoder.read_info());
    let reader = info.map_err(|e| not_ours(format!("it is no readable PNG ({e})")))?;
    let chunk = reader
        .info()
        .utf8_text
        .iter()
        .find(|chunk| chunk.keyword == PRESET);
    let absent = || match is_damaged(bytes) {
        true => not_ours("the file is damaged: it is cut off, or a checksum is wrong".into()),
        false => not_ours("it was not saved by rasterlab, or saved with --bare".into()),
    };
    let mut chunk = chunk.ok_or_else(absent)?.clone();
    chunk
        .decompress_text_with_limit(MAX_BYTES)
        .map_err(|_| not_ours("its preset is longer than 1 MiB or garbled".into()))?;
    let toml = chunk.get_text().map_err(|e| not_ours(e.to_string()))?;
    parse_file(&toml, "picture", file)
}
