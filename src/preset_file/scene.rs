//! The scene of a preset, built or loaded.

use std::{path::Path, sync::Arc};

use super::file::model_path;
use crate::{
    preset::{MissingInScene, Preset, SceneSource},
    scene::{Scene, builtin, gltf},
};

/// Why the scene of a preset is not available.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    Builtin(#[from] builtin::BuiltinError),
    #[error("the model {path} of the preset does not exist")]
    Absent { path: String },
    #[error(transparent)]
    Model(#[from] gltf::LoadError),
    #[error(transparent)]
    Missing(#[from] MissingInScene),
}

/// Builds or loads the scene of a preset; a relative model path starts at the folder of `preset_path`.
///
/// # Errors
/// No such built-in scene or model, a model that cannot be read, or a clip or camera that the scene does not have.
pub fn load_scene(preset: &Preset, preset_path: Option<&Path>) -> Result<Arc<Scene>, SceneError> {
    let scene = match &preset.scene {
        SceneSource::Builtin(query) => builtin::build(query)?,
        SceneSource::File(model) => {
            let path = model_path(model, preset_path);
            if !path.exists() {
                return Err(SceneError::Absent { path: path.display().to_string() });
            }
            gltf::load(&path)?
        }
    };
    preset.check(&scene)?;
    Ok(Arc::new(if preset.room > 0.0 { scene.in_room(preset.room) } else { scene }))
}
