//! Pictures that are opened for their preset, compared, or found where a frame should be.

use std::{fs, path::PathBuf, sync::OnceLock};

use rasterlab::preset_file;

use super::{Outcome, Target, assert_told, preset};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "picture",
    about: "PNG files with a preset in their text, and frames of films",
    views: &[views::PNG_CHUNKS, views::PNG_TEXT, views::PNG_TEXT],
    limit: Limit::new(10, 2560),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let outcome = preset::opens(preset_file::preset_from_png(bytes, "fuzz.png"));
    let path = path();
    fs::write(path, bytes).expect("the temporary folder can be written");
    match preset_file::png_pixels(path) {
        Ok((pixels, [width, height])) => {
            assert_eq!(pixels.len() as u64, u64::from(width) * u64::from(height))
        }
        Err(error) => assert_told(&error.to_string()),
    }
    if let Err(error) = preset_file::frame_status(path, [8, 6], "cafe") {
        assert_told(&error.to_string());
    }
    outcome
}

/// A file of this process, which every input takes.
fn path() -> &'static PathBuf {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        std::env::temp_dir().join(format!("rasterlab-fuzz-{}.png", std::process::id()))
    })
}
