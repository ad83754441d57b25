//! Picking: a click on the model sets a point parameter.

use eframe::egui::{Rect, Response};
use glam::DVec2;

use super::layout::{fitted, whole_size};
use crate::{
    app::{
        command::{Command, Commands, Edit, Parameter, ViewCommand},
        log::Level,
        state::State,
    },
    params::Stored as _,
    scene::pick,
};

/// Sets `parameter` to the point of the model under a click. The picture of the preset is in `side`.
pub fn pick(response: &Response, side: Rect, parameter: Parameter, state: &State, commands: &Commands) {
    let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
    let Some((at, scene)) = clicked.zip(state.session.scene()) else { return };
    let size = whole_size(response.rect);
    // Side by side the picture is smaller, with nothing to click on around it.
    let shown = fitted(side, size);
    if !shown.contains(at) {
        return;
    }
    let uv = (at - shown.min) / shown.size();
    match pick::pick(scene, &state.session.view_at(scene, size), DVec2::new(uv.x.into(), uv.y.into())) {
        Some(point) => {
            commands.send(Command::View(ViewCommand::Pick(None)));
            commands.edit(Edit::Parameter(parameter, point.to_value()));
        }
        None => commands.send(Command::Notify(Level::Info, "There is no triangle under this click. The point was not changed.".into())),
    }
}
