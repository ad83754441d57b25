//! Shots: PNG pictures that say which preset, version, adapter and driver made them, and give the preset back; and films
//! of many such pictures.

use std::{
    fs::File,
    io::{BufWriter, Cursor, Write},
    path::Path,
};

use super::{AtomicFile, PresetError, PresetFile, parse_file, read::MAX_BYTES, read_capped, to_toml};
use crate::frame::Frame;

const PRESET: &str = "rasterlab look";
const ADAPTER: &str = "rasterlab adapter";
/// What decided the picture, as a hash: a frame of a sequence is finished when it has the right one.
const MARK: &str = "rasterlab frame";
/// The end of every whole PNG: the empty chunk IEND and its checksum.
const END: [u8; 12] = [0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82];

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
pub fn png_with_preset(frame: &Frame, preset_file: &PresetFile, provenance: &Provenance) -> Result<Vec<u8>, PresetError> {
    encode(&frame.color, [frame.width, frame.height], &texts(preset_file, provenance, None))
}

/// The picture as one frame of a sequence: as [`png_with_preset`], and with `mark` to know it again.
pub fn png_of_frame(frame: &Frame, preset_file: &PresetFile, provenance: &Provenance, mark: &str) -> Result<Vec<u8>, PresetError> {
    encode(&frame.color, [frame.width, frame.height], &texts(preset_file, provenance, Some(mark)))
}

/// What a picture says about itself.
fn texts(preset_file: &PresetFile, provenance: &Provenance, mark: Option<&str>) -> Vec<(&'static str, String)> {
    let Provenance { adapter, driver } = provenance;
    let software = format!("rasterlab {}", env!("CARGO_PKG_VERSION"));
    let mark = mark.map(|mark| (MARK, mark.to_owned()));
    let made_by = [("Software", software), (ADAPTER, adapter.clone()), ("rasterlab driver", driver.clone())];
    made_by.into_iter().chain(mark).chain([(PRESET, to_toml(preset_file))]).collect()
}

/// The bare picture: `size` is width and height, `color` row-major RGBA.
pub fn png_bytes(color: &[[u8; 4]], size: [u32; 2]) -> Result<Vec<u8>, PresetError> {
    encode(color, size, &[])
}

fn failed(reason: impl ToString) -> PresetError {
    PresetError::Write { file: "PNG".into(), reason: reason.to_string() }
}

fn encode(color: &[[u8; 4]], size: [u32; 2], texts: &[(&str, String)]) -> Result<Vec<u8>, PresetError> {
    let mut bytes = Vec::new();
    let mut writer = encoder(&mut bytes, size, texts)?.write_header().map_err(failed)?;
    writer.write_image_data(bytemuck::cast_slice(color)).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

fn encoder<W: Write>(to: W, [width, height]: [u32; 2], texts: &[(&str, String)]) -> Result<png::Encoder<'static, W>, PresetError> {
    if width == 0 || height == 0 {
        return Err(failed(format!("a picture of {width}x{height} pixels has none, and PNG cannot hold it")));
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

/// How a film runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reel {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Number of frames, at least 1.
    pub frames: u32,
    /// How long each frame stays: a fraction of seconds, numerator and denominator.
    pub delay_s: [u16; 2],
    /// Begins again after its end; otherwise it stops there.
    pub loops: bool,
}

/// An animated PNG (APNG) in the making. It appears under its name when it is finished, and otherwise not at all.
pub struct Film {
    writer: png::Writer<BufWriter<File>>,
    /// What `writer` writes to.
    file: AtomicFile,
}

impl Film {
    /// Begins a film of `reel.frames` frames at `path`.
    pub fn begin(path: &Path, reel: &Reel, preset_file: &PresetFile, provenance: &Provenance, mark: &str) -> Result<Self, PresetError> {
        let file = AtomicFile::create(path)?;
        let handle = file.handle().map_err(|e| file.failed(e))?;
        let mut encoder = encoder(BufWriter::new(handle), reel.size, &texts(preset_file, provenance, Some(mark)))?;
        encoder.set_animated(reel.frames, if reel.loops { 0 } else { 1 }).map_err(failed)?;
        let [numerator, denominator] = reel.delay_s;
        encoder.set_frame_delay(numerator, denominator).map_err(failed)?;
        encoder.validate_sequence(true);
        Ok(Self { writer: encoder.write_header().map_err(failed)?, file })
    }

    /// Adds the next frame, row-major RGBA.
    pub fn push(&mut self, color: &[[u8; 4]]) -> Result<(), PresetError> {
        self.writer.write_image_data(bytemuck::cast_slice(color)).map_err(|e| self.file.failed(e))
    }

    /// Ends the film after its last frame.
    pub fn finish(self) -> Result<(), PresetError> {
        let Self { writer, file } = self;
        writer.finish().map_err(|e| file.failed(e))?;
        file.commit()
    }
}

/// Whether a file is the frame or film that is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    /// There is no such file, or it is empty, or a PNG that breaks off.
    Absent,
    /// Whole, of the right size, with the right mark.
    Finished {
        /// Name of the adapter that drew it, or `cpu`.
        adapter: String,
    },
    /// Whole, but something else.
    Other,
}

/// Is the picture at `path` the one of `size` with this `mark`? Decodes it to the end, since a header alone promises nothing.
pub fn standing(path: &Path, size: [u32; 2], mark: &str) -> Result<Standing, PresetError> {
    if !path.exists() {
        return Ok(Standing::Absent);
    }
    let bytes = read_capped(path, MAX_FILE_BYTES)?;
    let is_png = bytes.starts_with(b"\x89PNG\r\n\x1a\n");
    if bytes.is_empty() || (is_png && !bytes.ends_with(&END)) {
        return Ok(Standing::Absent);
    }
    if !is_png {
        return Ok(Standing::Other);
    }
    let Ok(mut reader) = png::Decoder::new_with_limits(Cursor::new(&bytes), png::Limits { bytes: 2 << 30 }).read_info() else {
        return Ok(Standing::Absent);
    };
    let text = |reader: &png::Reader<_>, keyword: &str| {
        let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == keyword)?;
        chunk.get_text().ok()
    };
    let is_wanted = text(&reader, MARK).as_deref() == Some(mark) && [reader.info().width, reader.info().height] == size;
    let adapter = text(&reader, ADAPTER).unwrap_or_default();
    let frames = reader.info().animation_control().map_or(1, |control| control.num_frames);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let is_whole = (0..frames).all(|_| reader.next_frame(&mut pixels).is_ok());
    Ok(match (is_whole, is_wanted) {
        (false, _) => Standing::Absent,
        (true, true) => Standing::Finished { adapter },
        (true, false) => Standing::Other,
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

/// The preset inside a picture of ours; `file` is its name for people.
pub fn preset_from_png(bytes: &[u8], file: &str) -> Result<PresetFile, PresetError> {
    let not_ours = |reason: String| PresetError::NotOurs { what: file.into(), reason };
    let limits = png::Limits { bytes: 16 << 20 };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Text stands before the pixels, so the header is all that is read.
    let info = decoder.read_header_info().map(|_| ()).and_then(|()| decoder.read_info());
    let reader = info.map_err(|e| not_ours(format!("it is no readable PNG ({e})")))?;
    let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == PRESET);
    let mut chunk = chunk.ok_or_else(|| not_ours("it was not saved by rasterlab, or bare".into()))?.clone();
    chunk.decompress_text_with_limit(MAX_BYTES).map_err(|_| not_ours("its preset is longer than 1 MiB or garbled".into()))?;
    let toml = chunk.get_text().map_err(|e| not_ours(e.to_string()))?;
    parse_file(&toml, "shot", file)
}
