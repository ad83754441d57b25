//! The pointer on the particles: Ctrl and a drag move their attractor.

use egui::{PointerButton, Response};
use glam::{DVec2, DVec3};

use super::{
    layout::whole_size,
    points::{PointSpace, facing_point},
};
use crate::{
    app::{
        editing::session::Session,
        shell::command::{Commands, Edit},
    },
    effects::particles::EFFECT,
    params::Stored as _,
};

/// While Ctrl (Cmd on macOS) is down, a drag moves the attractor in the plane through it that faces
/// the viewer. Returns true while it does.
pub fn attract(response: &Response, session: &Session, commands: &Commands) -> bool {
    let command = response.ctx.input(|i| i.modifiers.command);
    let is_on = command
        && response.dragged_by(PointerButton::Primary)
        && session.visible_stack().particle_settings().is_some();
    let (Some(field), Some(scene), true) = (EFFECT.field("attractor"), session.scene(), is_on)
    else {
        return false;
    };
    let Some((at, value)) = response
        .interact_pointer_pos()
        .zip(session.shown_value(&EFFECT, field))
    else {
        return true;
    };
    let view = session.view_at(scene, whole_size(response.rect));
    let uv = (at - response.rect.min) / response.rect.size();
    let space = PointSpace::of(&EFFECT, session, &view);
    let through = space.world(DVec3::new(value[0], value[1], value[2]));
    if let Some(point) = facing_point(&view, through, DVec2::new(uv.x.into(), uv.y.into())) {
        let [low, high] = field.hard;
        let point = space
            .value(point)
            .clamp(DVec3::splat(low), DVec3::splat(high));
        commands.edit(Edit::Parameter(
            (EFFECT.clone(), field.clone()),
            point.to_value(),
        ));
    }
    true
}
