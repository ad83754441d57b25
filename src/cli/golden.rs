//! Goldens: the oracle's stored picture of a preset, and a JSON sidecar with the hashes of its
//! inputs and buffers.
//!
//! Only the oracle draws them; the picture of any adapter may be compared with them.

use serde_json::{Value, json};

use super::error::CliError;
use crate::{
    frame::Frame,
    oracle,
    preset_file::{self, Fnv, PresetFile, hex, preset_hash, scene_hash},
    scene::Scene,
};

/// Largest golden, pixels.
pub const MAX_SIZE: [u32; 2] = [320, 240];
/// Largest golden, bytes.
pub const MAX_BYTES: usize = 64 << 10;

/// A golden as it is stored.
pub struct Golden {
    pub frame: Frame,
    pub png: Vec<u8>,
    pub sidecar: String,
}

/// Draws the golden of a preset.
///
/// # Errors
/// A preset without `[test]` has none; a golden is at most 320x240 pixels and 64 KiB.
pub fn draw(preset_file: &PresetFile, scene: &Scene) -> Result<Golden, CliError> {
    let preset = &preset_file.preset;
    let [width, height] = preset.output.size;
    if preset.test.is_none() {
        return Err(CliError::usage(format!(
            "{}: the preset has no [test] table, so it has no golden; add [test]",
            preset_file.id
        )));
    }
    if width > MAX_SIZE[0] || height > MAX_SIZE[1] {
        return Err(CliError::usage(format!(
            "{}: output.size is {width}x{height}; a golden has at most 320x240 pixels",
            preset_file.id
        )));
    }
    let moments = preset.moments(scene, preset.output.size);
    let frame = oracle::render_scaled(scene, &moments, preset.accuracy.scale().factor())?;
    let png = preset_file::png_bytes(&frame.color, preset.output.size)?;
    if png.len() > MAX_BYTES {
        return Err(CliError::usage(format!(
            "{}: the golden has {} bytes; at most {MAX_BYTES} are allowed",
            preset_file.id,
            png.len()
        )));
    }
    let sidecar = format!("{:#}\n", sidecar(preset_file, scene, &frame));
    Ok(Golden {
        frame,
        png,
        sidecar,
    })
}

fn sidecar(preset_file: &PresetFile, scene: &Scene, frame: &Frame) -> Value {
    let words = |words: &[u32]| hex(Fnv::new().words(words));
    json!({
        "schema": 2,
        "preset": preset_file.id,
        "preset_hash": hex(preset_hash(&preset_file.preset)),
        "scene_hash": hex(scene_hash(scene)),
        "oracle": env!("CARGO_PKG_VERSION"),
        "size": [frame.width, frame.height],
        "covered": frame.covered(),
        "counters": frame.counters,
        "digests": { "triangle_id": words(&frame.triangle_id), "depth_key": words(&frame.depth_key) },
    })
}
