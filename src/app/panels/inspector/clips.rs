//! The folder of the clips: which clip of the scene plays, how fast, and which second one is
//! blended in.

use egui::{self, Ui};

use super::rows::{folder, setting_ui};
use crate::{
    app::{
        shell::{
            command::{Commands, Edit},
            state::State,
        },
        widgets::{form::menu_ui, panel::row, theme},
    },
    preset::{ClipPlayback, Clock},
    scene::{Scene, rig::Clip},
};

/// Nothing for a scene without clips.
pub fn clips_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let Some(scene) = state
        .session
        .scene()
        .filter(|scene| !scene.rig.clips.is_empty())
    else {
        return;
    };
    let preset = state.session.preset();
    let mut play = preset.playback.clone();
    folder(ui, "Clips", true, |ui| {
        clip_ui(ui, "scene.clip", "at rest", scene, &mut play.clip);
        let Some(clip) = scene.rig.clip(&play.clip) else {
            return;
        };
        setting_ui(ui, state, commands, "scene.clip_speed");
        hold_ui(
            ui,
            commands,
            &scene.rig.clips[clip],
            &preset.clock,
            &mut play,
        );
        if scene.rig.clips.len() > 1 {
            clip_ui(
                ui,
                "scene.second_clip",
                "no second clip",
                scene,
                &mut play.second_clip,
            );
        }
        if !play.second_clip.is_empty() {
            setting_ui(ui, state, commands, "scene.clip_blend");
        }
    });
    if play != preset.playback {
        commands.edit(Edit::Play(play));
    }
}

/// Holds a time of the clip, or lets the clip follow the clock, whose range may span it.
fn hold_ui(ui: &mut Ui, commands: &Commands, clip: &Clip, clock: &Clock, play: &mut ClipPlayback) {
    let (duration_s, speed) = (clip.duration_s, play.speed);
    row(ui, |ui| {
        let mut is_held = play.clip_time_s.is_some();
        let hold = ui
            .checkbox(&mut is_held, "Hold")
            .on_hover_text("Show one time of the clip, whatever the clock shows");
        if hold.accessible_name("Hold the clip").clicked() {
            let now_s = clock.time_s * speed;
            let now_s = if duration_s > 0.0 {
                now_s.rem_euclid(duration_s)
            } else {
                0.0
            };
            play.clip_time_s = is_held.then_some(now_s);
        }
        if let Some(clip_time_s) = &mut play.clip_time_s {
            let slider = egui::Slider::new(clip_time_s, 0.0..=duration_s)
                .suffix(" s")
                .fixed_decimals(2);
            ui.add(slider)
                .on_hover_text("Time of the clip")
                .accessible_name("scene.pose_s");
            return;
        }
        let whole_s = match speed == 0.0 {
            true => 0.0,
            false => duration_s / speed.abs(),
        };
        let range_s = [0.0, whole_s];
        if range_s[1] > 0.0 && clock.range_s != range_s {
            let button = ui
                .button("Clock spans the clip")
                .on_hover_text(format!("The timeline runs from 0 to {:.2} s", range_s[1]));
            if button.clicked() {
                commands.edit(Edit::Clock(Clock { range_s, ..*clock }));
            }
        } else {
            ui.label(theme::weak(format!("{duration_s:.2} s")));
        }
    });
}

/// A menu of the scene's clips; `none` is the label of the empty name.
fn clip_ui(ui: &mut Ui, name: &str, none: &str, scene: &Scene, chosen: &mut String) {
    let now = match chosen.as_str() {
        "" => none.to_owned(),
        name => name.to_owned(),
    };
    let clips = scene.rig.clips.iter().enumerate().map(|(index, clip)| {
        let id = crate::app::files::scene_loader::clip_id(scene, index);
        let about = format!("{:.2} s, {} channels", clip.duration_s, clip.channels.len());
        (id.clone(), id, about)
    });
    let none = [(String::new(), none.to_owned(), String::new())];
    row(ui, |ui| {
        let width = ui.available_width() - theme::GAP;
        let offers = none.into_iter().chain(clips);
        if let (Some(clip), _) = menu_ui(ui, name, (now, width), Some(chosen), offers) {
            *chosen = clip;
        }
    });
}
