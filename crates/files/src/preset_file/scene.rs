//! The scene of a preset, built or loaded.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    file::model_path,
    formats::{MODEL_FORMATS, ModelFormat},
    surroundings,
};
use crate::{
    host::disk,
    params::legible_line,
    preset::{MissingInScene, Preset, SceneSource},
    scene::{Bounds, Scene, UpAxis, builtin, gltf, parts::ShownParts},
};

/// Why the scene of a preset is not available.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    Builtin(#[from] builtin::BuiltinError),
    #[error("the model {path} does not exist")]
    Absent { path: String },
    #[error(transparent)]
    Model(#[from] gltf::LoadError),
    #[error("scene.only and scene.hidden leave no part of the scene; show some part of it")]
    NothingShown,
    #[error("{file}, the picture of scene.surroundings, {reason}")]
    Surroundings { file: String, reason: String },
    #[error(transparent)]
    Missing(#[from] MissingInScene),
}

/// Builds or loads the scene of a preset: the parts that it shows, its ground, its room and the picture
/// of its surroundings; relative paths start at the folder of `preset_path`.
pub fn load_scene(preset: &Preset, preset_path: Option<&Path>) -> Result<Arc<Scene>, SceneError> {
    load_scene_beside(preset, [preset_path; 2])
}

/// [`load_scene`], with one path of the preset for its model and one for its picture.
pub fn load_scene_beside(
    preset: &Preset,
    [for_model, for_picture]: [Option<&Path>; 2],
) -> Result<Arc<Scene>, SceneError> {
    let surroundings = surroundings::load(&preset.surroundings, for_picture);
    let surroundings = surroundings.map_err(|reason| SceneError::Surroundings {
        file: legible_line(surroundings::shown(&preset.surroundings)),
        reason,
    })?;
    let mut scene = load_source(&preset.scene, &preset.parts, for_model)?;
    if let Some(surroundings) = surroundings {
        scene.panorama = Some(surroundings.panorama);
        scene.notes.extend(surroundings.note);
    }
    preset.check(&scene)?;
    let has_parts = !scene.instances.is_empty();
    let scene = scene.showing(&preset.parts);
    if has_parts && scene.instances.is_empty() {
        return Err(SceneError::NothingShown);
    }
    let scene = preset.ground.iter().fold(scene, Scene::on_ground);
    Ok(Arc::new(if preset.room > 0.0 {
        scene.in_room(preset.room)
    } else {
        scene
    }))
}

/// The box that lengths of a scene are measured by ([`Scene::subject_bounds`]), without ground and
/// room. The scene is built or loaded for that.
pub fn scene_bounds(
    source: &SceneSource,
    up: UpAxis,
    preset_path: Option<&Path>,
) -> Result<Bounds, SceneError> {
    let shown = ShownParts {
        up,
        ..ShownParts::default()
    };
    Ok(load_source(source, &shown, preset_path)?.subject_bounds(None))
}

/// Is the model of the preset there, if it has one?
///
/// # Errors
/// It is not.
pub fn check_model(preset: &Preset, preset_path: Option<&Path>) -> Result<(), SceneError> {
    match &preset.scene {
        SceneSource::Builtin(_) => Ok(()),
        SceneSource::File(model) => found(model, preset_path).map(drop),
    }
}

/// The path of a model that is there.
fn found(model: &Path, preset_path: Option<&Path>) -> Result<PathBuf, SceneError> {
    let path = model_path(model, preset_path);
    match disk::exists(&path) {
        true => Ok(path),
        false => Err(SceneError::Absent {
            path: path.display().to_string(),
        }),
    }
}

/// The whole scene of a source, with the variant and the axis up that `shown` names.
fn load_source(
    source: &SceneSource,
    ShownParts { variant, up, .. }: &ShownParts,
    preset_path: Option<&Path>,
) -> Result<Scene, SceneError> {
    match source {
        SceneSource::Builtin(query) => Ok(builtin::build(query)?.turned_up(up.or(UpAxis::Y))),
        SceneSource::File(model) => {
            let path = found(model, preset_path)?;
            // What has another extension is loaded too, if it is one by its content.
            let format = ModelFormat::of(&path).unwrap_or(&MODEL_FORMATS[0]);
            let mut scene = format.load_variant(&path, variant)?;
            if *up != UpAxis::Auto {
                return Ok(scene.turned_up(*up).counted());
            }
            let up = format.guess_up(&scene);
            if up != UpAxis::Y {
                let up = up.word();
                scene.notes.push(format!(
                    "its {up} axis is taken to be up, as its format, its names or how it stands suggest; set scene.up if another is"
                ));
            }
            Ok(scene.turned_up(up).counted())
        }
    }
}
