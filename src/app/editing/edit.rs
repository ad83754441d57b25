//! Edits of the preset: each variant of [`Edit`] is carried out here.

use std::sync::Arc;

use glam::DVec3;

use super::{first_values::first_words, session::Session};
use crate::{
    app::shell::command::{Edit, Parameter},
    effects::Effect,
    params::Value,
    preset::{Preset, SceneSource},
    preset_file,
    scene::{camera::Camera, camera_moves},
};

impl Session {
    /// Gives a parameter a value: an animated one at the time shown, any other at all times.
    ///
    /// # Errors
    /// In a sentence that names the parameter.
    pub fn set_parameter(
        &mut self,
        (effect, field): Parameter,
        value: &Value,
    ) -> Result<(), String> {
        if self
            .preset()
            .animation
            .get(&effect.name, &field.name)
            .is_some()
        {
            self.playback.playing = false; // Otherwise every frame would set a keyframe.
            return self.set_keyframe((effect, field), value.components());
        }
        let Some(enabled) = self.preset_mut().stack.get_mut(&effect.name) else {
            return Ok(());
        };
        field
            .set_value(&mut enabled.words, value)
            .map_err(|error| format!("{}.{}: {error}", effect.name, field.name))
    }

    /// Changes the preset. A value that breaks its setting's rule is ignored.
    ///
    /// # Errors
    /// In a sentence for people.
    pub fn edit(&mut self, edit: Edit) -> Result<(), String> {
        let preset = &mut self.preset_file.preset;
        match edit {
            Edit::Setting(setting, value) => {
                let before_s = preset.clock.time_s;
                // While the user types, a value may break a rule; then the preset keeps the last
                // valid one.
                drop(setting.set(preset, &value));
                if preset.clock.time_s != before_s {
                    self.playback.show_own();
                }
            }
            Edit::Parameter(parameter, value) => return self.set_parameter(parameter, &value),
            Edit::Enable(effect) => self.enable(&effect),
            Edit::Disable(effect) => self.disable(&effect.name),
            Edit::Scope(effect, on) => preset
                .stack
                .limit(&effect, on)
                .map_err(|conflict| conflict.to_string())?,
            Edit::Replace(other, effect) => {
                self.disable(&other);
                self.enable(&effect);
            }
            Edit::Rebind(old, new) => {
                preset.rebind(&[(old.clone(), new.clone())]);
                if self.muted.remove(&old.name) {
                    self.muted.insert(new.name.clone());
                }
            }
            Edit::Swap(a, b) if a.max(b) < preset.stack.0.len() => preset.stack.0.swap(a, b),
            Edit::Swap(..) => {}
            Edit::Move(from, to) => preset.stack.move_effect(from, to),
            Edit::EnableAt(effect, index) => {
                if let Some(conflict) = preset.stack.conflict_with(&effect) {
                    return Err(conflict.to_string());
                }
                let before = preset.stack.0.len();
                self.enable(&effect);
                let preset = self.preset_mut();
                let from = preset
                    .stack
                    .0
                    .iter()
                    .position(|enabled| enabled.effect == effect)
                    .unwrap_or(index);
                // A new effect in front of the index moves it by one.
                let moved = usize::from(preset.stack.0.len() > before && from < index);
                preset.stack.move_effect(from, index + moved);
            }
            Edit::Parts(parts) => preset.parts = parts,
            Edit::BuiltinQuery(query) => preset.scene = SceneSource::Builtin(query),
            Edit::SceneCamera(name) => {
                preset.scene_camera = name;
                preset.camera = None;
            }
            Edit::Play(play) => preset.playback = play,
            Edit::Clock(clock) => preset.clock = clock,
            Edit::Camera(camera) => preset.camera = camera,
            Edit::AddBookmark => {
                if let Some(camera) = self.camera() {
                    return self.preset_mut().add_bookmark(camera);
                }
            }
            Edit::RenameBookmark(from, to) => return preset.rename_bookmark(&from, &to),
            Edit::RemoveBookmark(name) => preset.bookmarks.retain(|mark| mark.name != name),
            Edit::NextBookmark => {
                let next = preset.next_bookmark();
                preset.camera = next.or(preset.camera);
            }
            Edit::FrameScene => {
                if let Some(camera) = self.camera().map(|camera| self.framed(&camera)) {
                    self.preset_mut().camera = Some(camera);
                }
            }
            Edit::LookAlong(direction) => {
                self.move_camera(|camera| camera_moves::look_along(camera, direction));
                return self.edit(Edit::FrameScene);
            }
            Edit::ToggleOrthographic => self.move_camera(camera_moves::toggle_orthographic),
        }
        Ok(())
    }

    /// Puts an effect into the stack, with values that show. One that is there stays as it is.
    fn enable(&mut self, effect: &Arc<Effect>) {
        if self.preset().stack.get(&effect.name).is_some() {
            return;
        }
        let bounds = self.scene().map(|scene| scene.content_bounds());
        let words = first_words(effect, self.preset().unit, bounds);
        self.preset_mut().stack.enable(effect).words = words;
    }

    /// Takes an effect out of the stack, with its keys.
    fn disable(&mut self, name: &str) {
        self.preset_mut().disable(name);
        self.muted.remove(name);
    }

    /// Disables every muted effect.
    pub fn drop_muted(&mut self) {
        for name in std::mem::take(&mut self.muted) {
            self.preset_mut().disable(&name);
        }
    }

    fn move_camera(&mut self, change: impl FnOnce(&mut Camera)) {
        if let Some(mut camera) = self.camera() {
            change(&mut camera);
            if camera_moves::is_finite(&camera) {
                self.preset_mut().camera = Some(camera);
            }
        }
    }

    /// `camera` moved along its own direction so that the whole scene shows.
    pub fn framed(&self, camera: &Camera) -> Camera {
        let Some(scene) = self.scene() else {
            return *camera;
        };
        let preset = self.shown_preset();
        // What is framed turns with the scene's spin.
        let state = preset.view(scene, [1, 1]).scene_state;
        let points: Vec<DVec3> = preset
            .framing_points(scene)
            .into_iter()
            .map(|point| state.world_from_scene.transform_point3(point) + state.origin)
            .collect();
        camera_moves::framing(
            camera,
            &points,
            preset.frame(super::session::aspect(preset.output.size)),
        )
    }

    /// Gives every parameter of the enabled effects that is neither locked nor animated a random
    /// value. Returns the seed of the random numbers; none if no effect is enabled.
    pub fn randomize(&mut self) -> Option<u32> {
        let Preset {
            stack, animation, ..
        } = &mut self.preset_file.preset;
        if stack.0.is_empty() {
            return None;
        }
        Some(self.randomizer.randomize(stack, |effect, field| {
            animation.get(&effect.name, &field.name).is_some()
        }))
    }

    /// Goes back to the values that a seed gave. Returns false if they are not known any more.
    pub fn recall_seed(&mut self, seed: u32) -> bool {
        self.randomizer
            .recall(&mut self.preset_file.preset.stack, seed)
    }

    /// Resets all parameters of an effect, or all settings of a table, by its name.
    ///
    /// # Errors
    /// In a sentence for people.
    pub fn reset_group(&mut self, group: &str) -> Result<(), String> {
        match self.preset_file.effects.find(group) {
            Ok(Some(effect)) => {
                let defaults = effect.defaults.clone();
                let Preset {
                    animation, stack, ..
                } = self.preset_mut();
                animation.remove_effect(group);
                if let Some(enabled) = stack.get_mut(group) {
                    enabled.words = defaults;
                }
                Ok(())
            }
            _ => self.reset(group),
        }
    }

    /// Resets one value, by its path.
    ///
    /// # Errors
    /// In a sentence for people.
    pub fn reset(&mut self, path: &str) -> Result<(), String> {
        let before_s = self.preset().clock.time_s;
        let outcome =
            preset_file::unset(&mut self.preset_file, path).map_err(|error| error.to_string());
        if self.preset().clock.time_s != before_s {
            self.playback.show_own();
        }
        outcome
    }
}
