//! How the last film was exported; the next one begins with that.

use crate::{accuracy::RenderScale, app::film::Format};

/// How the last film was exported.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSettings {
    pub format: Format,
    /// Width and height, pixels; none: as the picture is shown.
    pub size: Option<[u32; 2]>,
    pub fps: f64,
    /// Drawn per shown pixel; none: as the preset has it.
    pub scale: Option<RenderScale>,
    /// Begin and end, seconds, and the preset that they belong to; none: the whole timeline.
    pub range_s: Option<(String, [f64; 2])>,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self { format: Format::Apng, size: None, fps: 30.0, scale: None, range_s: None }
    }
}

impl FilmSettings {
    /// Longest side, pixels: that of an exported picture.
    pub const MAX_SIDE: u32 = 8192;

    /// Largest number of frames per second that the window offers.
    pub const MAX_FPS: f64 = 240.0;

    /// The names of the formats in the settings file.
    pub fn formats() -> [(&'static str, Format); 5] {
        Format::ALL.map(|format| (format.word(), format))
    }

    /// The names of anti-aliasing in the settings file.
    pub const SCALES: [(&'static str, Option<RenderScale>); 4] =
        [("preset", None), ("off", Some(RenderScale::Full)), ("2x2", Some(RenderScale::Double)), ("4x4", Some(RenderScale::Quadruple))];
}
