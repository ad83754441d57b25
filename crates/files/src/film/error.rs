//! Why a film is not drawn.

use crate::preset_file::PresetError;

/// Why a film is not drawn, each a sentence. What the reader can do about an existing file depends
/// on where it is said.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// Times or frames that no film has.
    #[error("{0}")]
    Times(String),
    /// It cannot go toward another preset.
    #[error("{0}")]
    Toward(String),
    #[error("{file} exists")]
    Exists { file: String },
    /// Files under the names of frames that are no frames of this film.
    #[error("{first} exists and is no frame of this preset{}", if *.more == 0 { String::new() } else { format!(", as do {more} more files") })]
    NotOurs { first: String, more: usize },
    #[error("{folder} cannot be created: {reason}")]
    Folder { folder: String, reason: String },
    #[error("{file}: the name of a video ends with .mp4, .webm or .gif")]
    NoContainer { file: String },
    #[error(
        "ffmpeg is not installed, so {file} cannot be written; install it (on Debian and Ubuntu: sudo apt install ffmpeg), or choose PNG frames or an animated PNG, which need no other program"
    )]
    NoFfmpeg { file: String },
    #[error("{file}: the size is {}x{}, but the sides of an MP4 are even; {}x{} is one that fits, and WebM and GIF take any", size[0], size[1], size[0].next_multiple_of(2), size[1].next_multiple_of(2))]
    OddSize { file: String, size: [u32; 2] },
    #[error("{file}: ffmpeg failed: {reason}")]
    Ffmpeg { file: String, reason: String },
    /// The person stopped it.
    #[error("the film was stopped")]
    Stopped,
    #[error(transparent)]
    Preset(PresetError),
}

impl From<PresetError> for FilmError {
    fn from(error: PresetError) -> Self {
        match error {
            PresetError::Exists { file } => Self::Exists { file },
            error => Self::Preset(error),
        }
    }
}
