//! Pointer, wheel and fly keys on the camera.

use egui::{Key, PointerButton, Response, Ui, Vec2};

use crate::{
    app::editing::session::Session,
    scene::{camera::Camera, camera_moves},
};

/// Radians that a drag over one point turns the camera by.
const TURN_PER_POINT: f64 = 0.008;

/// How much closer one point of the wheel moves, as a logarithm.
const ZOOM_PER_POINT: f64 = 0.0022;

/// Part of the scene's radius that the camera flies in a second.
const FLY_PER_S: f64 = 0.9;

/// The camera of a frame, while it is being moved.
struct Moving {
    camera: Camera,
    is_moved: bool,
}

impl Moving {
    /// Changes the camera, unless the result is not finite.
    fn change(&mut self, change: impl FnOnce(&mut Camera)) {
        let mut camera = self.camera;
        change(&mut camera);
        if camera_moves::is_finite(&camera) {
            (self.camera, self.is_moved) = (camera, true);
        }
    }
}

/// The camera as pointer, wheel and keys moved it; none if they did not. `widening` is
/// [`Session::widening`].
pub fn navigate(ui: &Ui, response: &Response, session: &Session, widening: f64) -> Option<Camera> {
    let mut moving = Moving {
        camera: session.camera()?,
        is_moved: false,
    };
    let drag = response.drag_delta();
    let (right, down) = (f64::from(drag.x), f64::from(drag.y));
    let height = f64::from(response.rect.height().max(1.0)) / widening;
    let shift = ui.input(|i| i.modifiers.shift);
    // Two fingers pan here and zoom below; the first of them is a pointer that drags, too.
    let fingers = ui.input(|i| i.multi_touch());
    if let Some(fingers) = fingers.filter(|_| response.is_pointer_button_down_on()) {
        let [right, down] = fingers.translation_delta.into();
        moving
            .change(|c| camera_moves::pan(c, f64::from(right) / height, f64::from(down) / height));
    } else if drag != Vec2::ZERO {
        let pans = response.dragged_by(PointerButton::Middle)
            || (response.dragged_by(PointerButton::Primary) && shift);
        if pans {
            moving.change(|c| camera_moves::pan(c, right / height, down / height));
        } else if response.dragged_by(PointerButton::Primary) {
            moving
                .change(|c| camera_moves::orbit(c, right * TURN_PER_POINT, down * TURN_PER_POINT));
        } else if response.dragged_by(PointerButton::Secondary) {
            moving.change(|c| {
                camera_moves::turn(c, right * TURN_PER_POINT * 0.5, down * TURN_PER_POINT * 0.5)
            });
        }
    }
    let secondary_is_down =
        response.is_pointer_button_down_on() && ui.input(|i| i.pointer.secondary_down());
    if response.dragged_by(PointerButton::Secondary) || secondary_is_down {
        fly(ui, session, &mut moving);
    }
    if response.contains_pointer() && !ui.ctx().any_popup_open() {
        let (scroll, pinch) = ui.input(|i| {
            (
                f64::from(i.smooth_scroll_delta().y),
                f64::from(i.zoom_delta()),
            )
        });
        if scroll != 0.0 || pinch != 1.0 {
            moving.change(|c| {
                camera_moves::zoom(c, (-scroll * ZOOM_PER_POINT).exp() / pinch.clamp(0.2, 5.0))
            });
        }
    }
    if response.double_clicked() {
        moving.change(|c| *c = session.framed(c));
    }
    moving.is_moved.then_some(moving.camera)
}

/// W A S D Q E, while the right button is down.
fn fly(ui: &Ui, session: &Session, moving: &mut Moving) {
    let axis = |plus: Key, minus: Key| {
        ui.input(|i| f64::from(u8::from(i.key_down(plus))) - f64::from(u8::from(i.key_down(minus))))
    };
    let (x, y, z) = (
        axis(Key::D, Key::A),
        axis(Key::E, Key::Q),
        axis(Key::W, Key::S),
    );
    if (x, y, z) == (0.0, 0.0, 0.0) {
        return;
    }
    let radius = session
        .scene()
        .map_or(1.0, |scene| scene.bounds().radius())
        .max(1e-3);
    let step = radius * FLY_PER_S * f64::from(ui.input(|i| i.stable_dt)).min(0.1);
    moving.change(|c| camera_moves::fly(c, x * step, y * step, z * step));
    ui.ctx().request_repaint();
}
