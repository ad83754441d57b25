//! The pointer on the particles: Ctrl and a drag move their attractor.

use eframe::egui::{PointerButton, Response};
use glam::DVec3;

use super::layout::whole_size;
use crate::{
    app::{
        command::{Commands, Edit},
        session::Session,
    },
    effects::particles::EFFECT,
    params::Stored as _,
    scene::view::View,
};

/// While Ctrl (Cmd on macOS) is down, a drag moves the attractor in the plane through it that faces the viewer. Returns true
/// while it does.
pub fn attract(response: &Response, session: &Session, commands: &Commands) -> bool {
    let command = response.ctx.input(|i| i.modifiers.command);
    let is_on = command && response.dragged_by(PointerButton::Primary) && session.visible_stack().particle_settings().is_some();
    let (Some(field), Some(scene), true) = (EFFECT.field("attractor"), session.scene(), is_on) else { return false };
    let Some((at, value)) = response.interact_pointer_pos().zip(session.shown_value(&EFFECT, field)) else { return true };
    let view = session.view_at(scene, whole_size(response.rect));
    let uv = (at - response.rect.min) / response.rect.size();
    let ndc = [2.0 * f64::from(uv.x) - 1.0, 1.0 - 2.0 * f64::from(uv.y)];
    let (fit, through) = (session.unit_fit(), DVec3::new(value[0], value[1], value[2]));
    let through = fit.map_or(through, |fit| fit.point(through));
    if let Some(point) = facing_point(&view, through, ndc) {
        let point = fit.map_or(point, |fit| fit.inverse().point(point));
        let [low, high] = field.hard;
        let point = point.clamp(DVec3::splat(low), DVec3::splat(high));
        commands.edit(Edit::Parameter((&EFFECT, field), point.to_value()));
    }
    true
}

/// Where the ray through `ndc` meets the plane through `through` that faces the viewer; both points in scene space.
/// None if the plane is not in front of the camera.
fn facing_point(view: &View, through: DVec3, ndc: [f64; 2]) -> Option<DVec3> {
    let through = view.scene_state.world_from_scene.transform_point3(through);
    let depth = (through - view.eye).dot(view.forward);
    let offset = view.ndc_axes[0] * ndc[0] + view.ndc_axes[1] * ndc[1];
    let point = match view.linear_depth_m {
        None if depth <= 0.0 => return None,
        None => view.eye + (view.forward + offset) * depth,
        Some(_) => view.eye + offset + view.forward * depth,
    };
    Some(view.scene_state.world_from_scene.inverse().transform_point3(point)).filter(|point| point.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        Bounds,
        camera::{Camera, Projection},
    };

    #[test]
    fn the_ray_through_a_projected_point_returns_that_point() {
        for projection in [Projection::Perspective { fov_y_deg: 50.0 }, Projection::Orthographic { height_m: 3.0 }] {
            let camera = Camera { eye: DVec3::new(1.0, 2.0, 5.0), target: DVec3::new(0.2, 0.0, 0.0), projection, ..Camera::default() };
            let bounds = Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE };
            let view = View::new(&camera, 300, 200, &bounds, crate::math::rotation_y(0.7), [0.0; 4]);
            let through = DVec3::new(0.3, -0.4, 0.1);
            let clip = view.clip_from_world * view.scene_state.world_from_scene * through.extend(1.0);
            let point = facing_point(&view, through, [clip.x / clip.w, clip.y / clip.w]).expect("in front of the eye");
            assert!(point.distance(through) < 1e-9, "{projection:?}: {point}");
        }
    }
}
