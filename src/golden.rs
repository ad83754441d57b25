//! Goldens: the oracle's stored picture of a preset, and a JSON sidecar with the hashes of its
//! inputs and buffers.
//!
//! Only the oracle draws them; the picture of any adapter may be compared with them.

use std::path::Path;

use serde_json::{Value, json};

use crate::{
    frame::Frame,
    measure::compare::{PictureDelta, pictures},
    oracle,
    preset_file::{
        self, Existing, Fnv, PresetFile, golden_folder, golden_paths, hex, preset_hash, scene_hash,
        write_atomically,
    },
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
/// In a sentence: a preset without `[test]` has none; a golden is at most 320x240 pixels and 64 KiB;
/// the picture cannot be drawn.
pub fn draw(preset_file: &PresetFile, scene: &Scene) -> Result<Golden, String> {
    let (id, preset) = (&preset_file.id, &preset_file.preset);
    let [width, height] = preset.output.size;
    if preset.test.is_none() {
        return Err(format!(
            "{id}: the preset has no [test] table, so it has no golden; add [test]"
        ));
    }
    if width > MAX_SIZE[0] || height > MAX_SIZE[1] {
        return Err(format!(
            "{id}: output.size is {width}x{height}; a golden has at most 320x240 pixels"
        ));
    }
    let moments = preset.moments(scene, preset.output.size);
    let frame = oracle::render_scaled(scene, &moments, preset.accuracy.scale().factor())
        .map_err(|error| format!("{id}: {error}"))?;
    let png = preset_file::png_bytes(&frame.color, preset.output.size)
        .map_err(|error| format!("{id}: {error}"))?;
    if png.len() > MAX_BYTES {
        return Err(format!(
            "{id}: the golden has {} bytes; at most {MAX_BYTES} are allowed",
            png.len()
        ));
    }
    let sidecar = format!("{:#}\n", sidecar(preset_file, scene, &frame));
    Ok(Golden {
        frame,
        png,
        sidecar,
    })
}

/// Does the preset have a golden, or is it one of a file that should?
pub fn has_golden(preset_file: &PresetFile) -> bool {
    let stored = || {
        let [png, _] = golden_paths(&golden_folder(preset_file), &preset_file.id);
        png.exists()
    };
    preset_file.preset.test.is_some() && (preset_file.path.is_some() || stored())
}

/// How a golden differs from the one that is stored.
pub struct Change {
    /// Colors and size of the stored picture; none if it is missing or cannot be read.
    pub stored: Option<(Vec<[u8; 4]>, [u32; 2])>,
    /// The difference from a stored picture of the same size.
    pub delta: Option<PictureDelta>,
    /// The stored sidecar; null if it is missing or cannot be read.
    pub sidecar: Value,
    has_same_sidecar: bool,
}

impl Change {
    /// Compares the golden of the preset `id` with the one in `folder`.
    pub fn of(golden: &Golden, folder: &Path, id: &str) -> Self {
        let [png, sidecar] = golden_paths(folder, id);
        let size = [golden.frame.width, golden.frame.height];
        let stored = preset_file::png_pixels(&png).ok();
        let delta = stored
            .as_ref()
            .filter(|(_, stored_size)| *stored_size == size)
            .map(|(color, _)| pictures(color, &golden.frame.color, 0));
        let sidecar = std::fs::read_to_string(&sidecar).unwrap_or_default();
        Self {
            stored,
            delta,
            has_same_sidecar: sidecar == golden.sidecar,
            sidecar: serde_json::from_str(&sidecar).unwrap_or_default(),
        }
    }

    /// Every pixel is the stored one.
    pub fn has_same_picture(&self) -> bool {
        self.delta
            .as_ref()
            .is_some_and(|delta| delta.pixels_over_tolerance == 0)
    }

    /// Neither the picture nor the sidecar differs.
    pub fn is_none(&self) -> bool {
        self.has_same_picture() && self.has_same_sidecar
    }
}

/// `12 of 76800 pixels differ, at most by 3 of 255, RMS 0.0123, the first at 10,20`.
pub fn difference_text(delta: &PictureDelta, [width, height]: [u32; 2]) -> String {
    let first = delta.mismatches.first().map_or(String::new(), |first| {
        let [x, y] = first.pixel(width);
        format!(", the first at {x},{y}")
    });
    format!(
        "{} of {} pixels differ, at most by {} of 255, RMS {:.4}{first}",
        delta.pixels_over_tolerance,
        u64::from(width) * u64::from(height),
        delta.max_delta,
        delta.rms
    )
}

/// Writes the golden of the preset `id` into `folder`, which is made if it is missing.
///
/// # Errors
/// A file cannot be written: in a sentence.
pub fn store(golden: &Golden, folder: &Path, id: &str) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let [png, sidecar] = golden_paths(folder, id);
    for (path, bytes) in [(png, &golden.png[..]), (sidecar, golden.sidecar.as_bytes())] {
        write_atomically(&path, bytes, Existing::Replace).map_err(|error| error.to_string())?;
    }
    Ok(())
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
