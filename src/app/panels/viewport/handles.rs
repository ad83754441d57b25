//! Handles in the picture: each stands where an effect has a point, like the center of a pattern,
//! and a drag moves that point.

use egui::{self, CursorIcon, Pos2, Rect, Sense, Ui, Vec2, vec2};
use glam::{DVec2, DVec3};

use super::{
    layout::whole_size,
    points::{PointSpace, facing_point, seen_at},
};
use crate::{
    app::{
        shell::{
            command::{Commands, Edit, Parameter},
            state::State,
        },
        widgets::{panel::describe, theme},
    },
    params::{Measure, Stored as _},
    scene::{Scene, pick, view::View},
};

/// Radius of a handle, and of the area that takes the pointer, points.
const RADIUS: f32 = 6.0;
const REACH: f32 = 10.0;

/// Smallest side of a picture that has handles, points.
const SMALLEST: f32 = 120.0;

/// The handles of all points that the effects shown have, over the picture at `at`, which is drawn
/// for all of `rect`.
pub fn handles_ui(ui: &mut Ui, state: &State, commands: &Commands, rect: Rect, at: Rect) {
    let session = &state.session;
    let Some(scene) = session
        .scene()
        .filter(|_| at.width().min(at.height()) >= SMALLEST)
    else {
        return;
    };
    let view = session.view_at(scene, whole_size(rect));
    for enabled in &session.visible_stack().0 {
        let effect = &enabled.effect;
        let points = effect.fields.iter().filter(|field| {
            field.measure() == Measure::Point && field.is_shown(&effect.fields, &enabled.words)
        });
        let space = PointSpace::of(effect, session, &view);
        for field in points {
            let Some([x, y, z]) = session
                .shown_value(effect, field)
                .and_then(|value| <[f64; 3]>::try_from(value).ok())
            else {
                continue;
            };
            let Some(uv) = seen_at(&view, space.world(DVec3::new(x, y, z))) else {
                continue;
            };
            let center = at.min + vec2(uv.x as f32, uv.y as f32) * at.size();
            if at.contains(center) {
                let handle = Handle {
                    parameter: (effect.clone(), field.clone()),
                    world: space.world(DVec3::new(x, y, z)),
                    center,
                };
                handle.show(ui, commands, (scene, &view, &space), at);
            }
        }
    }
}

/// A point of an effect in the picture.
struct Handle {
    parameter: Parameter,
    /// Meters.
    world: DVec3,
    center: Pos2,
}

impl Handle {
    fn show(
        &self,
        ui: &mut Ui,
        commands: &Commands,
        (scene, view, space): (&Scene, &View, &PointSpace),
        at: Rect,
    ) {
        let (effect, field) = &self.parameter;
        let name = format!("{}.{}", effect.name, field.name);
        let area = Rect::from_center_size(self.center, Vec2::splat(2.0 * REACH));
        let response = ui
            .interact(area, egui::Id::unique(("handle", &name)), Sense::drag())
            .on_hover_cursor(CursorIcon::Grab);
        describe(&response, egui::Role::Slider, format!("Handle {name}"));
        let is_active = response.hovered() || response.dragged();
        // A handle is in the way of looking: it shows while the pointer is over the picture.
        if is_active || ui.rect_contains_pointer(at) {
            paint(ui, at, self.center, is_active);
        }
        if response.drag_delta() != Vec2::ZERO {
            let on_model = ui.input(|i| i.modifiers.shift);
            let place = response
                .interact_pointer_pos()
                .filter(|_| on_model)
                .unwrap_or(self.center + response.drag_delta());
            let uv = (place - at.min) / at.size();
            let uv = DVec2::new(uv.x.into(), uv.y.into());
            let point = if on_model {
                pick::pick(scene, view, uv)
            } else {
                facing_point(view, self.world, uv)
            };
            if let Some(point) = point {
                let [low, high] = field.hard;
                let value = space
                    .value(point)
                    .clamp(DVec3::splat(low), DVec3::splat(high));
                commands.edit(Edit::Parameter(self.parameter.clone(), value.to_value()));
            }
        }
        response.on_hover_text(format!(
            "{name}\nDrag to move it across the view, with Shift to put it on the model"
        ));
    }
}

/// A ring with a dot, which can be seen on any picture.
fn paint(ui: &Ui, at: Rect, center: Pos2, is_active: bool) {
    let painter = ui.painter_at(at);
    let ink = if is_active {
        theme::accent()
    } else {
        theme::text_strong()
    };
    painter.circle_stroke(center, RADIUS, (4.0, theme::view()));
    painter.circle_stroke(center, RADIUS, (2.0, ink));
    painter.circle_filled(center, 2.5, theme::view());
    painter.circle_filled(center, 1.5, ink);
}
