//! Findings of `check`: the result of one preset.

use super::error::Exit;
use crate::{measure::compare::PictureDelta, preset_file::Position};

/// The result of one preset.
pub struct Finding {
    pub preset: String,
    pub exit: Exit,
    /// One sentence each; empty where the preset passes.
    pub problems: Vec<String>,
    pub warnings: Vec<String>,
    pub position: Option<Position>,
    pub drawn: Option<Drawn>,
}

/// A picture with its golden.
pub struct Drawn {
    pub size: [u32; 2],
    pub expected: Vec<[u8; 4]>,
    pub actual: Vec<[u8; 4]>,
    pub delta: PictureDelta,
}
