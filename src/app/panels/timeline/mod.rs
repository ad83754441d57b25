//! Timeline: play, step, scrub, loop and speed, and below them the keyframes of every animated
//! parameter.

mod hints;
mod ruler;
mod span;
mod tracks;

use std::collections::BTreeSet;

use egui::{self, Align, DragValue, Layout, Rect, Ui, pos2, vec2};

use self::span::Span;
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::apply::keyframe,
        editing::{command::KeyframeEdit, key_id::KeyId, session::Session},
        shell::{
            action::Action,
            command::{Commands, Edit},
            state::State,
        },
        widgets::{
            icons::{Icon, icon_button, toggle_button},
            panel::at_right,
            theme,
        },
    },
    params::Value,
    preset::{
        Clock,
        animation::{Easing, Track, steps},
        settings::Setting,
    },
};

/// Width of the column with names and values, points.
const GUTTER: f32 = 236.0;
const RULER: f32 = 22.0;
/// Most of the window's height that tracks take before they scroll.
const MAX_TRACKS: f32 = 172.0;
const TRANSPORT: f32 = 28.0;

/// Play, step, scrub, loop and speed, and below them the keyframes of every animated parameter.
#[derive(Default)]
pub struct Timeline {
    pub selected: Option<KeyId>,
    /// Tracks whose curve is shown, by path.
    open: BTreeSet<String>,
    /// What is shown from left to right, seconds. Fixed while a button is down, so that a drag
    /// does not change its own scale.
    span_s: Option<[f64; 2]>,
    /// Time of the dragged keyframe when the drag began, seconds.
    grabbed_s: Option<f64>,
}

/// Tracks of the enabled effects.
fn animated_tracks(session: &Session) -> Vec<&Track> {
    let preset = session.preset();
    preset
        .animation
        .tracks()
        .iter()
        .filter(|track| preset.stack.get(&track.effect().name).is_some())
        .collect()
}

impl Timeline {
    /// Height of the whole panel, points.
    pub fn height(&self, session: &Session) -> f32 {
        let heights = animated_tracks(session)
            .into_iter()
            .map(|track| tracks::height(self.open.contains(&track.path())))
            .sum::<f32>();
        let tracks = if heights == 0.0 {
            tracks::TRACK
        } else {
            heights.min(MAX_TRACKS)
        };
        // Margins, the line above, and the gaps between the three.
        12.0 + 1.0 + TRANSPORT + RULER + tracks + 2.0 * theme::HALF
    }

    /// Time and easing of the selected keyframe.
    fn selection_ui(&self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(key) = &self.selected else { return };
        let Some((track, index)) = key.find(state.session.preset()) else {
            return;
        };
        let (easing, is_stepped) = (track.keys()[index].easing, steps(track.field()));
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.separator();
        ui.add(egui::Label::new(theme::strong(key.path())).truncate());
        let mut time_s = key.time_s;
        let drag = DragValue::new(&mut time_s)
            .speed(0.01)
            .max_decimals(3)
            .suffix(" s")
            .update_while_editing(false);
        let response = ui
            .add_sized([72.0, theme::ROW - 2.0], drag)
            .accessible_name("Key time")
            .on_hover_text("Time of this key");
        if response.changed() {
            let edit = KeyframeEdit::Move(key.clone(), time_s);
            commands.run(|app| keyframe(app, edit));
        }
        let mut chosen = easing;
        ui.add_enabled_ui(!is_stepped, |ui| {
            egui::ComboBox::from_id_salt("easing")
                .selected_text(easing.name())
                .width(74.0)
                .show_ui(ui, |ui| {
                    for easing in Easing::ALL {
                        ui.selectable_value(&mut chosen, easing, easing.name())
                            .on_hover_text(easing.about());
                    }
                })
                .response
                .accessible_name("Key easing")
                .on_hover_text("How the value moves to the next key")
                .on_disabled_hover_text(
                    "A whole number or a choice keeps its value until the next key",
                )
        });
        if chosen != easing {
            let edit = KeyframeEdit::Ease(key.clone(), chosen);
            commands.step(|app| keyframe(app, edit));
        }
        if icon_button(ui, Icon::Cross, "Remove the key (Delete)").clicked() {
            commands.perform(Action::RemoveKey);
        }
    }
}

impl Panel for Timeline {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let session = &state.session;
        ui.spacing_mut().item_spacing.y = theme::HALF;
        self.selected = self
            .selected
            .take()
            .filter(|key| key.find(session.preset()).is_some());
        ui.horizontal(|ui| {
            ui.set_height(TRANSPORT);
            transport_ui(ui, session, commands);
            time_ui(ui, session, commands);
            at_right(ui, |ui| {
                // A phone has no room for it.
                if ui.available_width() >= RANGE {
                    range_ui(ui, session, commands);
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    self.selection_ui(ui, state, commands)
                });
            });
        });
        let tracks = animated_tracks(session);
        if self.span_s.is_none() || !ui.input(|i| i.pointer.any_down()) {
            self.span_s = Some(span::extent(session.preset().clock.range_s, &tracks));
        }
        let (rect, _) =
            ui.allocate_exact_size(vec2(ui.available_width(), RULER), egui::Sense::hover());
        let left = rect.left() + GUTTER.min(rect.width() * 0.4);
        let rail = Rect::from_min_max(pos2(left, rect.top()), rect.max);
        let span = Span::new(
            self.span_s.unwrap_or([0.0, 1.0]),
            rail.shrink2(vec2(10.0, 0.0)),
        );
        ruler::ruler_ui(ui, rail, &span, session, commands);
        let below = ui.available_rect_before_wrap();
        if tracks.is_empty() {
            hints::hint_ui(ui, session, commands);
        } else {
            ui.spacing_mut().item_spacing.y = 0.0;
            let scroll = egui::ScrollArea::vertical()
                .id_salt("tracks")
                .auto_shrink([false, true])
                .min_scrolled_height(tracks::TRACK)
                .max_height(MAX_TRACKS);
            let mut view = tracks::Tracks {
                session,
                commands,
                span: &span,
                open: &mut self.open,
                selected: &mut self.selected,
                grabbed_s: &mut self.grabbed_s,
            };
            scroll.show(ui, |ui| {
                tracks.iter().for_each(|track| view.track_ui(ui, track))
            });
        }
        let under = if tracks.is_empty() {
            rail
        } else {
            Rect::from_min_max(pos2(left, below.top()), below.max)
        };
        ruler::playhead_ui(ui, rail.union(under), &span, session.shown_time_s());
    }
}

/// Back, step, play, step, loop, speed.
fn transport_ui(ui: &mut Ui, session: &Session, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 2.0;
    let play = if session.playback.playing {
        Icon::Pause
    } else {
        Icon::Play
    };
    for (icon, action) in [
        (Icon::ToStart, Action::Rewind),
        (Icon::StepBack, Action::StepBack),
        (play, Action::Play),
        (Icon::StepForward, Action::StepForward),
    ] {
        if icon_button(ui, icon, &action.hint()).clicked() {
            commands.perform(action);
        }
    }
    let clock = session.preset().clock;
    let hint = if clock.is_looping {
        "Loop: on. Playing starts again at the end"
    } else {
        "Loop: off. Playing stops at the end"
    };
    if toggle_button(ui, Icon::Loop, clock.is_looping, "Loop")
        .on_hover_text(hint)
        .clicked()
    {
        commands.edit(Edit::Clock(Clock {
            is_looping: !clock.is_looping,
            ..clock
        }));
    }
    ui.add_space(theme::HALF);
    clock_value(ui, session, commands, ("clock.speed", 0), |drag| {
        drag.speed(0.01).max_decimals(2).suffix(" ×")
    });
    ui.add_space(theme::GAP);
}

/// The time that is shown, and the way back to the preset's own.
fn time_ui(ui: &mut Ui, session: &Session, commands: &Commands) {
    let mut now_s = session.shown_time_s();
    let drag = DragValue::new(&mut now_s)
        .speed(0.01)
        .fixed_decimals(3)
        .suffix(" s")
        .update_while_editing(false);
    let response = ui
        .add_sized([96.0, theme::ROW], drag)
        .accessible_name("Time")
        .on_hover_text("The time that is shown");
    if response.changed() {
        let time_s = now_s;
        commands.run(move |app| app.state.session.playback.show(time_s));
    }
    if session.is_off_its_time() {
        ui.spacing_mut().item_spacing.x = 2.0;
        let own_s = session.preset().clock.time_s;
        if ui
            .small_button("Keep")
            .on_hover_text("Make this the preset's own time, which saved pictures show")
            .clicked()
        {
            commands.run(|app| app.state.session.keep_shown_time());
        }
        if ui
            .small_button("Back")
            .on_hover_text(format!("Show the preset's own time, {own_s:.3} s"))
            .clicked()
        {
            commands.run(|app| app.state.session.show_own_time());
        }
    }
}

/// Width of the range that plays, points.
const RANGE: f32 = 240.0;

/// The range that plays, at the right end.
fn range_ui(ui: &mut Ui, session: &Session, commands: &Commands) {
    ui.spacing_mut().item_spacing.x = 6.0;
    for (component, word) in [(1, "to"), (0, "from")] {
        clock_value(
            ui,
            session,
            commands,
            ("clock.range_s", component),
            |drag| drag.speed(0.02).max_decimals(3).suffix(" s"),
        );
        ui.label(theme::weak(word));
    }
}

/// One number of a setting of the clock.
fn clock_value(
    ui: &mut Ui,
    session: &Session,
    commands: &Commands,
    (path, component): (&str, usize),
    styled: impl FnOnce(DragValue<'_>) -> DragValue<'_>,
) {
    let Some(setting) = Setting::find(path) else {
        return;
    };
    let Some(Value::Numbers(mut numbers)) = setting.get(session.preset()) else {
        return;
    };
    let name = match setting.value_type.component_names().get(component) {
        Some(component) => format!("{path} {component}"),
        None => path.to_owned(),
    };
    let [low, high] = setting.hard;
    let drag = styled(
        DragValue::new(&mut numbers[component])
            .range(low..=high)
            .update_while_editing(false),
    );
    let response = ui
        .add_sized([72.0, theme::ROW - 2.0], drag)
        .accessible_name(name)
        .on_hover_text(&setting.doc);
    if response.changed() {
        commands.edit(Edit::Setting(setting, Value::Numbers(numbers)));
    }
}
