//! Picking: a click on the model sets a point parameter, or adds a part to those that an effect
//! changes.

use egui::{Rect, Response};
use glam::DVec2;

use super::{
    layout::{fit_aspect, whole_size},
    points::PointSpace,
};
use crate::{
    app::{
        picture::command::Picking,
        shell::{
            command::{Commands, Edit},
            log::Level,
            state::State,
        },
    },
    params::Stored as _,
    scene::{
        Scene,
        parts::{PartPattern, names_of},
        pick,
        view::View,
    },
};

/// Sets what is picked to what lies under a click. The picture of the preset is in `side`.
pub fn pick(
    response: &Response,
    side: Rect,
    picking: &Picking,
    state: &State,
    commands: &Commands,
) {
    let clicked = response
        .interact_pointer_pos()
        .filter(|_| response.clicked());
    let Some((at, scene)) = clicked.zip(state.session.scene()) else {
        return;
    };
    let size = whole_size(response.rect);
    // Side by side the picture is smaller, with nothing to click on around it.
    let shown = fit_aspect(side, size);
    if !shown.contains(at) {
        return;
    }
    let uv = (at - shown.min) / shown.size();
    let uv = DVec2::new(uv.x.into(), uv.y.into());
    match edit(
        picking,
        state,
        scene,
        &state.session.view_at(scene, size),
        uv,
    ) {
        Some(edit) => {
            commands.run(|app| app.state.picture.picking = None);
            commands.edit(edit);
        }
        None => commands.notify(
            Level::Info,
            "There is no triangle under this click. Nothing was changed.",
        ),
    }
}

/// The change that a click at `uv` makes; none where there is no triangle.
fn edit(picking: &Picking, state: &State, scene: &Scene, view: &View, uv: DVec2) -> Option<Edit> {
    match picking {
        Picking::Point(parameter) => {
            let point = pick::pick(scene, view, uv)?;
            let value = PointSpace::of(&parameter.0, &state.session, view).value(point);
            Some(Edit::Parameter(parameter.clone(), value.to_value()))
        }
        Picking::Part(effect, kind) => {
            let instance = &scene.instances[pick::pick_instance(scene, view, uv)?];
            let pattern = PartPattern::of_name(*kind, names_of(scene, instance, *kind).first()?);
            let on = &state.session.preset().stack.get(&effect.name)?.on;
            Some(Edit::Scope(effect.clone(), on.with(&pattern, true)))
        }
    }
}
