//! Shared lines, as they are pasted.

use rasterlab::preset_file;

use super::{Outcome, Target, preset};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "share",
    about: "shared and pasted lines",
    views: &[views::SHARED_TOML, views::SHARED_TOML],
    words: preset::WORDS,
    limit: Limit::new(5, 256),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let line = String::from_utf8_lossy(bytes);
    preset_file::is_effect_text(&line);
    let read = preset_file::from_line(&line);
    if let Ok(preset_file) = &read {
        let line = preset_file::to_line(preset_file);
        let again = preset_file::from_line(&line)
            .unwrap_or_else(|error| panic!("the line made of it is refused: {error}"));
        assert_eq!(
            format!("{:?}", again.preset),
            format!("{:?}", preset_file.preset)
        );
    }
    preset::opens(read)
}
