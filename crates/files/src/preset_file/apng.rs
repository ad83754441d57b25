//! Animated PNG (APNG) files of many frames.

use std::{io::BufWriter, path::Path};

use super::{
    atomic::Existing,
    error::PresetError,
    file::PresetFile,
    picture::{Provenance, encoder, failed, texts},
};

#[cfg(not(target_arch = "wasm32"))]
use super::atomic::AtomicFile;
#[cfg(target_arch = "wasm32")]
use super::in_memory::InMemory as AtomicFile;

/// What is written to while the file is not yet there under its name.
#[cfg(not(target_arch = "wasm32"))]
type Handle = std::fs::File;
#[cfg(target_arch = "wasm32")]
type Handle = AtomicFile;

/// Size and timing of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnimationOptions {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Number of frames, at least 1.
    pub frames: u32,
    /// How long each frame stays: a fraction of seconds, numerator and denominator.
    pub delay_s: [u16; 2],
    /// Starts again after its end; otherwise it stops there.
    pub is_looping: bool,
    /// The picture that is pushed first is no frame: it is the default picture, which programs that
    /// do not know animations show. Without one they show the first frame.
    pub has_still: bool,
}

/// An animated PNG that is being written. The file appears when it is finished, and otherwise not
/// at all.
pub struct AnimatedPng {
    writer: png::Writer<BufWriter<Handle>>,
    /// The file that `writer` writes to.
    file: AtomicFile,
}

impl AnimatedPng {
    /// Begins an animation of `options.frames` frames at `path`.
    pub fn begin(
        path: &Path,
        options: &AnimationOptions,
        preset_file: &PresetFile,
        provenance: &Provenance,
        fingerprint: &str,
        existing: Existing,
    ) -> Result<Self, PresetError> {
        let file = AtomicFile::create(path, existing)?;
        let handle = file.handle().map_err(|e| file.failed(e))?;
        let mut encoder = encoder(
            BufWriter::new(handle),
            options.size,
            &texts(preset_file, provenance, Some(fingerprint))?,
        )?;
        encoder
            .set_animated(options.frames, if options.is_looping { 0 } else { 1 })
            .map_err(failed)?;
        let [numerator, denominator] = options.delay_s;
        encoder
            .set_frame_delay(numerator, denominator)
            .map_err(failed)?;
        encoder.set_sep_def_img(options.has_still).map_err(failed)?;
        encoder.validate_sequence(true);
        Ok(Self {
            writer: encoder.write_header().map_err(failed)?,
            file,
        })
    }

    /// Adds the next frame, or first the default picture if there is one; row-major RGBA.
    pub fn push(&mut self, color: &[[u8; 4]]) -> Result<(), PresetError> {
        self.writer
            .write_image_data(bytemuck::cast_slice(color))
            .map_err(|e| self.file.failed(e))
    }

    /// Ends the animation after its last frame.
    pub fn finish(self) -> Result<(), PresetError> {
        let Self { writer, file } = self;
        writer.finish().map_err(|e| file.failed(e))?;
        file.commit()
    }
}
