//! Shared lines, as they are pasted.

use rasterlab::{preset::SceneSource, preset_file};

use super::{Outcome, Target, preset};
use crate::{guard::Limit, views};

pub const TARGET: Target = Target {
    name: "share",
    about: "shared and pasted lines",
    views: &[views::SHARED_TOML, views::SHARED_TOML],
    limit: Limit::new(5, 256),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let line = String::from_utf8_lossy(bytes);
    preset_file::is_effect_text(&line);
    let read = preset_file::from_line(&line);
    // The text of a newer schema stays as it is.
    if let Ok(preset_file) = &read
        && !preset_file.read_only
    {
        let line = preset_file::to_line(preset_file);
        let again = preset_file::from_line(&line)
            .unwrap_or_else(|error| panic!("the line made of it is refused: {error}"));
        // A line names a model by its whole path, which is outside of any folder; one whose model was
        // held back has none.
        let (mut again, own) = (
            again.with_outside_model().preset,
            preset_file.preset.clone(),
        );
        assert_eq!(
            matches!(again.scene, SceneSource::File(_)),
            matches!(own.scene, SceneSource::File(_))
        );
        if let SceneSource::File(_) = own.scene {
            again.scene = own.scene.clone();
        }
        assert_eq!(format!("{again:?}"), format!("{own:?}"));
    }
    preset::opens(read)
}
