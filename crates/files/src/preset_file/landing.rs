//! Landing: a preset whose look is put on the scene of another becomes a new preset, without a
//! file.

use std::path::Path;

use super::{
    file::{MAX_NAME, PresetFile, model_path, stem},
    look::Look,
};
use crate::{
    host::disk,
    preset::{FRAMING_DIRECTION, Fit, LengthUnit, Preset, SceneSource},
    scene::{Bounds, Scene, camera::Camera},
};

impl PresetFile {
    /// Is the scene the person's own, so that presets land on it: a model, or a built-in scene that
    /// was chosen?
    pub fn has_own_scene(&self) -> bool {
        self.chose_scene || matches!(self.preset.scene, SceneSource::File(_))
    }

    /// The scene with the path of a model as it is read: not relative to the folder of the preset.
    pub fn scene_source(&self) -> SceneSource {
        match &self.preset.scene {
            SceneSource::File(model) => SceneSource::File(model_path(model, self.path.as_deref())),
            builtin => builtin.clone(),
        }
    }

    /// Name of the scene for people: the model's file without its extension, or the built-in scene
    /// without parameters.
    pub fn scene_name(&self) -> String {
        match &self.preset.scene {
            SceneSource::File(model) => stem(model),
            SceneSource::Builtin(query) => query.split('?').next().unwrap_or(query).to_owned(),
        }
    }

    /// Must the boxes of both scenes be known to put this look on another scene?
    pub fn needs_fit(&self) -> bool {
        self.preset.unit == LengthUnit::Meter && self.preset.has_lengths()
    }

    /// The fit from the box of this preset's scene to that of `own`, and from what its camera sees
    /// to what the other sees; none where a box has no extent. Where `scene`, that of `own`, is
    /// known, its box is that of what its camera frames ([`Preset::subject_bounds`]); where it is
    /// not, its camera is taken to frame the box, from farther away than it frames the shape.
    pub fn fit_to(
        &self,
        own: &Self,
        [from, to]: [&Bounds; 2],
        scene: Option<&Scene>,
    ) -> Option<Fit> {
        let aspect = |preset: &Preset| {
            let [width, height] = preset.output.size.map(|side| f64::from(side.max(1)));
            width / height
        };
        let camera = |preset: &Preset, bounds: &Bounds| {
            preset.camera.unwrap_or_else(|| {
                Camera::around(
                    &bounds.corners(),
                    FRAMING_DIRECTION,
                    preset.frame(aspect(preset)),
                )
            })
        };
        let own_camera = scene.map_or_else(
            || camera(&own.preset, to),
            |scene| own.preset.camera_for(scene, aspect(&own.preset)),
        );
        let framed = scene.map(|scene| own.preset.subject_bounds(scene));
        let to = framed.as_ref().unwrap_or(to);
        let cameras = [camera(&self.preset, from), own_camera];
        Fit::between(from, to).map(|fit| fit.with_cameras((&cameras[0], from), (&cameras[1], to)))
    }

    /// This look on the scene of `own`, as a new preset without a file. `fit` leads from the box of
    /// this scene to that of `own`; without it lengths and points stay as they are. The
    /// warnings of the new preset say what was left out or could not be fitted.
    #[must_use]
    pub fn landed_on(&self, own: &Self, fit: Option<&Fit>) -> Self {
        let fit = fit.filter(|_| self.needs_fit());
        let (fitted, mut warnings) = fit.map_or_else(
            || (self.preset.clone(), Vec::new()),
            |fit| self.preset.fitted(fit),
        );
        warnings.extend(self.preset.left_out_on(&own.preset));
        let mut preset = fitted.applied_to(&own.preset);
        if let SceneSource::File(model) = own.scene_source() {
            preset.scene = SceneSource::File(disk::absolute(&model).unwrap_or(model));
        }
        preset.surroundings = self.shared_surroundings();
        let look = self.origin();
        let model = own.scene_name();
        let (id, name) = match &look {
            Some(look) => (
                format!("{}-{model}", look.id),
                format!("{} on {model}", look.title),
            ),
            None => (model.clone(), own.title().to_owned()),
        };
        preset.name = name.chars().take(MAX_NAME).collect();
        let warnings = warnings
            .into_iter()
            .map(|warning| format!("{}: {warning}", preset.name))
            .collect();
        Self {
            warnings,
            effects: self.effects.clone(),
            brought_effects: self.brought_effects.clone(),
            chose_scene: true,
            look,
            ..Self::new(&file_name(&id), preset)
        }
    }

    /// Lets effects that were limited to parts which `scene` does not have act on all of it; the
    /// warnings say so.
    pub fn map_missing_parts(&mut self, scene: &Scene) {
        let title = self.title().to_owned();
        let notes = self.preset.map_missing_parts(scene);
        self.warnings
            .extend(notes.into_iter().map(|note| format!("{title}: {note}")));
    }

    /// The preset that the look comes from; none where it is only the default look of a scene.
    fn origin(&self) -> Option<Look> {
        self.look
            .clone()
            .or_else(|| (!self.chose_scene || self.path.is_some()).then(|| Look::of(self)))
    }

    /// Does the preset lie at `path`, or is it the built-in one called `id`? A look that has landed
    /// counts as its preset.
    pub fn is_look_of(&self, id: &str, path: Option<&Path>) -> bool {
        match &self.look {
            Some(look) => look.id == id && is_same_file(look.path.as_deref(), path),
            None => self.id == id && is_same_file(self.path.as_deref(), path),
        }
    }

    /// The id by which the gallery knows the look.
    pub fn look_id(&self) -> &str {
        self.look.as_ref().map_or(&self.id, |look| &look.id)
    }
}

/// Are two presets the same file? The path of one may be relative.
fn is_same_file(a: Option<&Path>, b: Option<&Path>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => {
            a == b || disk::absolute(a).is_ok_and(|a| disk::absolute(b).is_ok_and(|b| a == b))
        }
        (a, b) => a == b,
    }
}

/// A name without characters that a file name could not have.
fn file_name(name: &str) -> String {
    let kept = name.chars().map(|c| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '-'
        }
    });
    kept.take(MAX_NAME).collect()
}
