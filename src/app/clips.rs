//! Clips: which movement of the scene plays, how fast, and which second one is blended in.

use eframe::egui::{self, ComboBox, Ui};

use super::{App, inspector::folder, theme};
use crate::scene::{Scene, rig::Clip};

/// Clips that are offered under the timeline; the menu has all.
const MOST_BUTTONS: usize = 5;

impl App {
    /// A folder for a scene that has clips; nothing for others.
    pub(super) fn clips_ui(&mut self, ui: &mut Ui) {
        let Some(scene) = self.scene_loader.shown.as_ref().map(|(_, scene)| scene.clone()).filter(|scene| !scene.rig.clips.is_empty())
        else {
            return;
        };
        folder(ui, "Clips", true, |ui| {
            clip_ui(ui, "scene.clip", "at rest", &scene, &mut self.preset_file.preset.playback.clip);
            let Some(clip) = scene.rig.clip(&self.preset_file.preset.playback.clip) else { return };
            self.key_ui(ui, "scene.clip_speed");
            self.hold_ui(ui, &scene.rig.clips[clip]);
            if scene.rig.clips.len() > 1 {
                clip_ui(ui, "scene.second_clip", "no second clip", &scene, &mut self.preset_file.preset.playback.second_clip);
            }
            if !self.preset_file.preset.playback.second_clip.is_empty() {
                self.key_ui(ui, "scene.clip_blend");
            }
        });
    }

    /// Under the timeline of a scene that has clips: what plays, or which may; false for a scene without.
    pub(super) fn clips_hint_ui(&mut self, ui: &mut Ui) -> bool {
        let Some(scene) = self.scene_loader.shown.as_ref().map(|(_, scene)| scene.clone()).filter(|scene| !scene.rig.clips.is_empty())
        else {
            return false;
        };
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            if let Some(clip) = scene.rig.clip(&self.preset_file.preset.playback.clip) {
                let Clip { name, duration_s, .. } = &scene.rig.clips[clip];
                let words = format!("{name} plays, {duration_s:.2} s long. Clips, at the right, holds a moment of it or mixes in another.");
                ui.add(egui::Label::new(theme::weak(words)).truncate());
                return;
            }
            ui.label(theme::weak("This scene is at rest. Play"));
            for (place, clip) in scene.rig.clips.iter().enumerate().take(MOST_BUTTONS) {
                let id = id_of(&scene, place);
                let button = ui.button(&id).on_hover_text(format!("{:.2} s; the timeline spans it", clip.duration_s));
                if button.accessible_name(format!("Play {id}")).clicked() {
                    self.preset_file.preset.playback.clip = id;
                    if clip.duration_s > 0.0 {
                        self.preset_file.preset.clock.range_s = [0.0, clip.duration_s];
                    }
                    if !self.playback.playing {
                        self.play_or_pause();
                    }
                }
            }
            if let Some(more) = scene.rig.clips.len().checked_sub(MOST_BUTTONS + 1) {
                ui.label(theme::weak(format!("or one of {} more, under Clips at the right", more + 1)));
            }
        });
        true
    }

    /// Holds a moment of the clip, or lets it go with the clock, whose range may span it.
    fn hold_ui(&mut self, ui: &mut Ui, clip: &Clip) {
        let preset = &mut self.preset_file.preset;
        let (duration_s, speed) = (clip.duration_s, preset.playback.speed);
        ui.horizontal(|ui| {
            ui.set_min_height(theme::ROW);
            ui.add_space(theme::GAP);
            let mut is_held = preset.playback.clip_time_s.is_some();
            let hold = ui.checkbox(&mut is_held, "Hold").on_hover_text("Shows one moment of the clip, whatever the clock says");
            if hold.accessible_name("Hold the clip").clicked() {
                let now_s = preset.clock.time_s * speed;
                let now_s = if duration_s > 0.0 { now_s.rem_euclid(duration_s) } else { 0.0 };
                preset.playback.clip_time_s = is_held.then_some(now_s);
            }
            if let Some(clip_time_s) = &mut preset.playback.clip_time_s {
                let slider = egui::Slider::new(clip_time_s, 0.0..=duration_s).suffix(" s").fixed_decimals(2);
                ui.add(slider).on_hover_text("UndoState of the clip").accessible_name("scene.pose_s");
                return;
            }
            let wanted_s = [0.0, if speed == 0.0 { 0.0 } else { duration_s / speed.abs() }];
            if wanted_s[1] > 0.0 && preset.clock.range_s != wanted_s {
                let button = ui.button("Clock spans the clip").on_hover_text(format!("The timeline runs from 0 to {:.2} s", wanted_s[1]));
                if button.clicked() {
                    preset.clock.range_s = wanted_s;
                }
            } else {
                ui.label(theme::weak(format!("{duration_s:.2} s")));
            }
        });
    }
}

/// What a preset calls a clip: of those with one name, later ones go by their place.
fn id_of(scene: &Scene, place: usize) -> String {
    let name = &scene.rig.clips[place].name;
    if scene.rig.clip(name) == Some(place) { name.clone() } else { format!("#{place}") }
}

/// A menu of the scene's clips; `none` stands for the empty name.
fn clip_ui(ui: &mut Ui, name: &str, none: &str, scene: &Scene, chosen: &mut String) {
    let shown = if chosen.is_empty() { none.to_owned() } else { chosen.clone() };
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        let menu = ComboBox::from_id_salt(name).selected_text(shown).width(ui.available_width() - theme::GAP);
        let menu = menu.show_ui(ui, |ui| {
            ui.selectable_value(chosen, String::new(), none);
            for (place, clip) in scene.rig.clips.iter().enumerate() {
                let id = id_of(scene, place);
                ui.selectable_value(chosen, id.clone(), id).on_hover_text(format!(
                    "{:.2} s, {} channels",
                    clip.duration_s,
                    clip.channels.len()
                ));
            }
        });
        menu.response.accessible_name(name);
    });
}
