//! A preset file on the way to another.

use super::file::{PresetFile, normalized};
use crate::{preset::SceneSource, scene::Scene};

/// The scene with the path of its model made absolute, so that names from two folders can be compared.
fn scene_of(preset_file: &PresetFile) -> SceneSource {
    match preset_file.scene_source() {
        SceneSource::File(model) => SceneSource::File(normalized(&model).unwrap_or(model)),
        builtin => builtin,
    }
}

impl PresetFile {
    /// The preset `by` of the way to `other`, 0 to 1; see
    /// [`Preset::toward`](crate::preset::Preset::toward). `scene` is that of this one.
    pub fn toward(&self, other: &Self, by: f64, scene: &Scene) -> Result<Self, String> {
        if scene_of(self) != scene_of(other) {
            return Err(format!(
                "{} shows the scene {} and {} shows {}; a preset goes toward another one on the same scene, \
                 so give both one",
                self.id,
                self.scene_name(),
                other.id,
                other.scene_name()
            ));
        }
        let nearer = if by < 0.5 { self } else { other };
        Ok(Self {
            id: self.id.clone(),
            preset: self.preset.toward(&other.preset, by, scene),
            ..nearer.clone()
        })
    }
}
