//! What the timeline says while nothing is animated: how to animate a value, or which clips the
//! scene has.

use egui::{self, Label, Ui, vec2};

use super::tracks::TRACK;
use crate::{
    app::{
        editing::session::Session,
        files::scene_loader::clip_id,
        shell::action::Action,
        shell::command::{Commands, Edit},
        widgets::{icons::paint_diamond, theme},
    },
    preset::Clock,
    scene::{Scene, rig::Clip},
};

/// Most clips with a button of their own. The inspector's menu has all.
const MAX_BUTTONS: usize = 5;

pub fn hint_ui(ui: &mut Ui, session: &Session, commands: &Commands) {
    if let Some(scene) = session.scene().filter(|scene| !scene.rig.clips.is_empty()) {
        return clips_ui(ui, scene, session, commands);
    }
    let (before, after) = if session.preset().stack.0.is_empty() {
        (
            "Nothing is animated. Enable an effect on the right; the",
            "beside each of its values sets a key at this time.",
        )
    } else {
        (
            "Nothing is animated. The",
            "beside a value sets a key at this time. Set another key at another time, and the value moves.",
        )
    };
    ui.horizontal(|ui| {
        ui.set_height(TRACK);
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.label(theme::weak(before));
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, TRACK), egui::Sense::hover());
        paint_diamond(
            ui.painter(),
            rect.center(),
            4.5,
            egui::Color32::TRANSPARENT,
            theme::text(),
        );
        ui.add(Label::new(theme::weak(after)).truncate());
    });
}

/// The clip that plays, or buttons that play one.
fn clips_ui(ui: &mut Ui, scene: &Scene, session: &Session, commands: &Commands) {
    let preset = session.preset();
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if let Some(clip) = scene.rig.clip(&preset.playback.clip) {
            let Clip { name, duration_s, .. } = &scene.rig.clips[clip];
            let text = format!("{name} plays; it is {duration_s:.2} s long. Hold or blend it in the folder Clips on the right.");
            ui.add(Label::new(theme::weak(text)).truncate());
            return;
        }
        ui.label(theme::weak("This scene is at rest. Play"));
        for (index, clip) in scene.rig.clips.iter().enumerate().take(MAX_BUTTONS) {
            let id = clip_id(scene, index);
            let button = ui.button(&id).on_hover_text(format!("{:.2} s. The timeline will span the clip.", clip.duration_s));
            if button.accessible_name(format!("Play {id}")).clicked() {
                let mut play = preset.playback.clone();
                play.clip = id;
                commands.edit(Edit::Play(play));
                if clip.duration_s > 0.0 {
                    commands.edit(Edit::Clock(Clock { range_s: [0.0, clip.duration_s], ..preset.clock }));
                }
                if !session.playback.playing {
                    commands.perform(Action::Play);
                }
            }
        }
        if scene.rig.clips.len() > MAX_BUTTONS {
            let count = scene.rig.clips.len() - MAX_BUTTONS;
            ui.label(theme::weak(format!("or one of {count} more, in the folder Clips on the right")));
        }
    });
}
