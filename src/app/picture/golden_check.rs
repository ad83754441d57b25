//! The golden of the open preset: whether the oracle still draws it after a file of the preset was
//! reloaded.

use std::path::PathBuf;

#[cfg(not(target_arch = "wasm32"))]
pub use native::check;

use crate::{app::editing::session::FileId, measure::compare::pictures};

/// How the oracle's picture differs from the golden.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenCheck {
    /// The preset that was drawn, as its file has it.
    pub file: FileId,
    pub golden: PathBuf,
    pub outcome: Outcome,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Same,
    Differs {
        pixels: u64,
        /// Largest difference of a channel, of 255.
        largest: u8,
    },
    /// In a sentence for people.
    Failed(String),
}

impl GoldenCheck {
    /// The words of the badge.
    pub fn text(&self) -> String {
        match &self.outcome {
            Outcome::Same => "golden: same".into(),
            Outcome::Differs { pixels: 1, largest } => {
                format!("golden: 1 pixel differs, by {largest} of 255")
            }
            Outcome::Differs { pixels, largest } => {
                format!("golden: {pixels} pixels differ, largest {largest} of 255")
            }
            Outcome::Failed(_) => "golden: not compared".into(),
        }
    }

    /// The explanation of the badge.
    pub fn hint(&self) -> String {
        let golden = self.golden.display();
        match &self.outcome {
            Outcome::Failed(reason) => format!("{golden}: {reason}"),
            _ => format!(
                "After the reload the oracle drew the preset as its file has it and compared every pixel with {golden}. \
                 Judge > Review of goldens shows both and takes the new one."
            ),
        }
    }
}

/// Do golden and preset have as many pixels?
///
/// # Errors
/// They have not: in words.
pub fn check_size(golden: [u32; 2], preset: [u32; 2]) -> Result<(), String> {
    if golden == preset {
        return Ok(());
    }
    let [[a, b], [c, d]] = [golden, preset];
    Err(format!(
        "the golden has {a}x{b} pixels and the preset {c}x{d}"
    ))
}

/// How the oracle's picture differs from the golden.
pub fn difference(golden: &[[u8; 4]], drawn: &[[u8; 4]]) -> Outcome {
    let delta = pictures(golden, drawn, 0);
    match delta.pixels_over_tolerance {
        0 => Outcome::Same,
        pixels => Outcome::Differs {
            pixels,
            largest: delta.max_delta,
        },
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::path::Path;

    use super::{FileId, GoldenCheck, Outcome, check_size, difference};
    use crate::{
        oracle,
        preset_file::{self, PresetFile, golden_folder, golden_paths},
    };

    /// Draws the golden of a preset again and compares it with the stored one; none if the preset has
    /// no golden.
    pub fn check(preset_file: &PresetFile) -> Option<GoldenCheck> {
        preset_file.preset.test.as_ref()?;
        let [golden, _] = golden_paths(&golden_folder(preset_file), &preset_file.id);
        if !golden.is_file() {
            return None;
        }
        let outcome = compare_golden(preset_file, &golden).unwrap_or_else(Outcome::Failed);
        Some(GoldenCheck {
            file: FileId::of(preset_file),
            golden,
            outcome,
        })
    }

    fn compare_golden(preset_file: &PresetFile, golden: &Path) -> Result<Outcome, String> {
        let (expected, size) =
            preset_file::png_pixels(golden).map_err(|error| error.to_string())?;
        let preset = &preset_file.preset;
        check_size(size, preset.output.size)?;
        let scene = preset_file::load_scene(preset, preset_file.path.as_deref())
            .map_err(|error| error.to_string())?;
        let moments = preset.moments(&scene, size);
        let frame = oracle::render_scaled(&scene, &moments, preset.accuracy.scale().factor())
            .map_err(|error| error.to_string())?;
        Ok(difference(&expected, &frame.color))
    }
}
