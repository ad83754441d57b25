//! Viewport: the picture, and the hand on the camera.

use eframe::egui::{self, Align2, Color32, FontId, PointerButton, Rect, RichText, Sense, Ui, Vec2, pos2, vec2};

use super::{
    App, Level,
    icons::{Icon, icon_button},
    jobs::SceneKey,
    legend, orbit,
    screen::Inputs,
    shortcuts::Action,
    theme,
};
use crate::{
    params::Stored as _,
    preset::Preset,
    scene::{
        Scene,
        camera::{Camera, Projection},
        pick,
        view::View,
    },
};
use glam::DVec2;

/// What moves in the picture, and what should be drawn.
#[derive(Default)]
pub struct Motion {
    /// The picture as asked for, at full size.
    pub wanted: Option<Inputs>,
    /// When a hand last changed the picture.
    last_s: f64,
    /// Full pixels per drawn pixel, along a side.
    pub divisor: u32,
    /// How much more than the preset's own frame the window shows, at least 1.
    widening: f64,
}

impl Motion {
    /// Seconds until the picture counts as resting; none when it does.
    pub fn rest_in_s(&self, now_s: f64) -> Option<f64> {
        let rest_s = REST_S - (now_s - self.last_s);
        (self.last_s > 0.0 && rest_s > 0.0).then_some(rest_s)
    }
}

/// Where a picture goes: all of `rect`, or its own shape in the middle, so that one from before a resize is not stretched.
pub fn fitted(rect: Rect, [width, height]: [u32; 2]) -> Rect {
    let scale = (rect.width() / width as f32).min(rect.height() / height as f32);
    let size = vec2(width as f32, height as f32) * scale;
    let fits = (size - rect.size()).abs().max_elem() < 4.0;
    if fits { rect } else { Rect::from_center_size(rect.center(), size) }
}

fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width.max(1)) / f64::from(height.max(1))
}

/// After this long without motion the picture is drawn at full size, seconds.
const REST_S: f64 = 0.2;

/// A frame that takes longer makes moving pictures coarser, milliseconds.
const SMOOTH_MS: f64 = 28.0;

/// Radians that a drag over one point turns the camera by.
const TURN_PER_POINT: f64 = 0.008;

/// How much closer one point of wheel comes.
const ZOOM_PER_POINT: f64 = 0.0022;

/// Share of the scene's radius that flying covers in a second.
const FLY_PER_S: f64 = 0.9;

impl App {
    pub(super) fn viewport_ui(&mut self, ui: &mut Ui) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        let pixels = (rect.size() * ui.pixels_per_point()).round();
        let most = self.screen.gpu.caps.max_texture_side;
        let size = [pixels.x, pixels.y].map(|side| (side.max(0.0) as u32).min(most));
        self.motion.widening = self.widening(size);
        let moved = if self.attract(&response) { false } else { self.navigate(ui, &response) };
        self.pick_under(&response);
        self.draw(ui.ctx(), size, moved);
        self.feed_overlays(ui.ctx());
        let at = self.picture_ui(ui, self.compare.side_b(rect));
        let below = self.compare_ui(ui, rect, at);
        self.overlay_ui(ui, rect);
        self.light_ui(ui, at);
        let below = self.overlay_legend_ui(ui, below, at);
        if let Some(params) = self.visible_stack().params("overdraw") {
            legend::heat_ui(ui, below, &params);
        }
    }

    /// Where a point of an effect is being chosen, a click on the model gives it.
    fn pick_under(&mut self, response: &egui::Response) {
        let Some((effect, field)) = self.picking else { return };
        if response.ctx.input(|i| i.key_pressed(egui::Key::Escape)) {
            self.picking = None;
        }
        let Some((at, (_, scene))) = response.interact_pointer_pos().filter(|_| response.clicked()).zip(self.scene_loader.shown.clone())
        else {
            return;
        };
        let size = response.rect.size().round();
        // Side by side the picture is smaller, and beside it there is nothing to click on.
        let shown = fitted(self.compare.side_b(response.rect), [size.x.max(1.0) as u32, size.y.max(1.0) as u32]);
        if !shown.contains(at) {
            return;
        }
        let place = (at - shown.min) / shown.size();
        let view = self.view_at(&scene, [size.x.max(1.0) as u32, size.y.max(1.0) as u32]);
        match pick::pick(&scene, &view, DVec2::new(place.x.into(), place.y.into())) {
            Some(point) => {
                self.picking = None;
                self.put_value(effect, field, &point.to_value());
            }
            None => self.log.tell(Level::Info, "There is nothing under this click; the point stays where it was.", self.now_s),
        }
    }

    /// Pose of the camera, to be moved.
    pub(super) fn pose(&self) -> Option<Camera> {
        let (_, scene) = self.scene_loader.shown.as_ref()?;
        Some(self.preset_file.preset.camera_for(scene, aspect(self.preset_file.preset.output.size)))
    }

    /// How much taller than the preset's frame a picture of `size` must be for the frame's width to fit.
    fn widening(&self, size: [u32; 2]) -> f64 {
        (aspect(self.preset_file.preset.output.size) / aspect(size)).max(1.0)
    }

    /// The preset as a picture of `size` shows it: the whole of the preset's own frame, and more where the shapes differ.
    pub(super) fn view_at(&self, scene: &Scene, size: [u32; 2]) -> View {
        self.with_trail(self.view_of(self.shown_preset(), scene, size))
    }

    /// The same of another session.
    pub(super) fn view_of(&self, mut preset: Preset, scene: &Scene, size: [u32; 2]) -> View {
        let widening = self.widening(size);
        let mut camera = preset.camera_for(scene, aspect(preset.output.size));
        if widening > 1.0 {
            match &mut camera.projection {
                Projection::Perspective { fov_y_deg } => {
                    *fov_y_deg = 2.0 * ((fov_y_deg.to_radians() * 0.5).tan() * widening).atan().to_degrees();
                }
                Projection::Orthographic { height_m } => *height_m *= widening,
            }
        }
        preset.camera = Some(camera);
        preset.view(scene, size)
    }

    /// Moves the camera of the preset.
    pub(super) fn move_camera(&mut self, change: impl FnOnce(&mut Camera)) {
        if let Some(mut camera) = self.pose() {
            change(&mut camera);
            let finite = camera.eye.is_finite() && camera.target.is_finite() && camera.up.is_finite();
            if finite {
                self.preset_file.preset.camera = Some(camera);
            }
        }
    }

    /// Shows the whole scene from where the camera looks now.
    pub(super) fn frame_scene(&mut self) {
        let Some((_, scene)) = &self.scene_loader.shown else { return };
        let preset = self.shown_preset();
        // The spin carries the box along.
        let turn = preset.view(scene, [1, 1]).world_from_scene;
        let mut bounds = crate::scene::Bounds::EMPTY;
        let corners = if scene.bounds().is_empty() { None } else { Some(scene.bounds().corners()) };
        corners.into_iter().flatten().for_each(|corner| bounds.include(turn.transform_point3(corner)));
        let aspect = aspect(preset.output.size);
        self.move_camera(|camera| *camera = orbit::framing(camera, &bounds, aspect));
    }

    /// Moves the camera by pointer, wheel and fly keys; true while a hand is at it.
    fn navigate(&mut self, ui: &Ui, response: &egui::Response) -> bool {
        let before = self.preset_file.preset.camera;
        let drag = response.drag_delta();
        let (right, down) = (f64::from(drag.x), f64::from(drag.y));
        let height = f64::from(response.rect.height().max(1.0)) / self.motion.widening;
        let shift = ui.input(|i| i.modifiers.shift);
        if drag != Vec2::ZERO {
            let pans = response.dragged_by(PointerButton::Middle) || (response.dragged_by(PointerButton::Primary) && shift);
            if pans {
                self.move_camera(|c| orbit::pan(c, right / height, down / height));
            } else if response.dragged_by(PointerButton::Primary) {
                self.move_camera(|c| orbit::orbit(c, right * TURN_PER_POINT, down * TURN_PER_POINT));
            } else if response.dragged_by(PointerButton::Secondary) {
                self.move_camera(|c| orbit::turn(c, right * TURN_PER_POINT * 0.5, down * TURN_PER_POINT * 0.5));
            }
        }
        if response.dragged_by(PointerButton::Secondary)
            || (response.is_pointer_button_down_on() && ui.input(|i| i.pointer.secondary_down()))
        {
            self.fly(ui);
        }
        if response.contains_pointer() && !ui.ctx().any_popup_open() {
            let (scroll, pinch) = ui.input(|i| (f64::from(i.smooth_scroll_delta().y), f64::from(i.zoom_delta())));
            if scroll != 0.0 || pinch != 1.0 {
                self.move_camera(|c| orbit::zoom(c, (-scroll * ZOOM_PER_POINT).exp() / pinch.clamp(0.2, 5.0)));
            }
        }
        if response.double_clicked() {
            self.frame_scene();
        }
        self.preset_file.preset.camera != before
    }

    /// W A S D Q E, while the right button is held.
    fn fly(&mut self, ui: &Ui) {
        use egui::Key;
        let axis = |plus: Key, minus: Key| ui.input(|i| f64::from(u8::from(i.key_down(plus))) - f64::from(u8::from(i.key_down(minus))));
        let (x, y, z) = (axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
        if (x, y, z) == (0.0, 0.0, 0.0) {
            return;
        }
        let radius = self.scene_loader.shown.as_ref().map_or(1.0, |(_, scene)| scene.bounds().radius()).max(1e-3);
        let step = radius * FLY_PER_S * f64::from(ui.input(|i| i.stable_dt)).min(0.1);
        self.move_camera(|c| orbit::fly(c, x * step, y * step, z * step));
        ui.ctx().request_repaint();
    }

    /// Draws what the preset asks for, coarser while a hand moves it on a slow adapter.
    fn draw(&mut self, ctx: &egui::Context, full: [u32; 2], camera_moved: bool) {
        let now_s = self.now_s;
        if let Err(error) = self.screen.poll(now_s) {
            self.log.add(Level::Error, error.to_string());
        }
        let Some((key, scene)) = self.scene_loader.shown.clone() else { return };
        if key != SceneKey::of(&self.preset_file.preset, self.preset_file.path.as_ref()) {
            return; // Another preset's scene in the light of this one would be a picture of neither.
        }
        let (stack, accuracy) = (self.visible_stack(), self.preset_file.preset.accuracy);
        let wanted = Inputs { view: self.view_at(&scene, full), scene, stack, accuracy };
        let held = ctx.input(|i| i.pointer.any_down());
        let changed = self.motion.wanted.as_ref().is_some_and(|before| *before != wanted);
        if camera_moved || self.playback.playing || (changed && held) {
            self.motion.last_s = now_s;
        }
        let moving = self.motion.wanted.is_some() && self.motion.rest_in_s(now_s).is_some();
        let divisor = if moving { self.coarseness(full) } else { 1 };
        if divisor > 1 {
            ctx.request_repaint_after_secs(self.motion.rest_in_s(now_s).unwrap_or(0.0) as f32 + 0.01);
        }
        let mut inputs = wanted.clone();
        if divisor > 1 {
            // The same frustum on fewer pixels, so that nothing jumps when the motion ends.
            (inputs.view.width, inputs.view.height) = (full[0].div_ceil(divisor), full[1].div_ceil(divisor));
        }
        self.motion.divisor = divisor;
        self.motion.wanted = Some(wanted);
        if let Err(error) = self.screen.show(&inputs, now_s) {
            self.log.tell(Level::Error, error.to_string(), now_s);
        }
        self.draw_reference(&inputs, full);
        if self.screen.is_waiting() || self.compare.is_waiting() {
            ctx.request_repaint_after_secs(0.015);
        }
    }

    /// By how much a moving picture must be smaller to stay smooth, from what the last one took.
    fn coarseness(&self, full: [u32; 2]) -> u32 {
        let Some(ms) = self.screen.report().and_then(|report| report.gpu_ms).map(|ms| ms + self.compare.ms()) else {
            return if self.screen.gpu.summary.software { 2 } else { 1 };
        };
        let [width, height] = self.screen.picture().map_or(full, |(_, size)| size);
        let pixels = |w: u32, h: u32| f64::from(w.max(1)) * f64::from(h.max(1));
        // The share that does not shrink with the picture is unknown, so half is taken to shrink.
        let scale = 0.5 + 0.5 * pixels(full[0], full[1]) / pixels(width, height);
        match ms * scale {
            ms if ms <= SMOOTH_MS => 1,
            ms if ms <= 4.0 * SMOOTH_MS => 2,
            _ => 3,
        }
    }

    /// The newest picture, and where it is; what stands where there is none.
    fn picture_ui(&self, ui: &Ui, rect: Rect) -> Rect {
        let painter = ui.painter_at(rect);
        if let Some((blit, size)) = self.screen.picture().filter(|(_, size)| size.iter().all(|&side| side > 0)) {
            let at = fitted(rect, size);
            if at != rect {
                painter.rect_filled(rect, 0.0, theme::VIEW);
            }
            painter.add(blit.shape(at));
            return at;
        }
        painter.rect_filled(rect, 0.0, theme::VIEW);
        let (title, detail) = if self.scene_loader.failed.is_some() {
            ("This scene cannot be shown", "The log says why. Choose another one on the left, or drop a .glb here.")
        } else if self.motion.wanted.as_ref().is_some_and(|inputs| self.screen.is_refused(inputs)) {
            ("This picture cannot be drawn", "The log says why.")
        } else {
            ("Loading the scene", "Large ones take a moment.")
        };
        painter.text(rect.center() - vec2(0.0, 12.0), Align2::CENTER_CENTER, title, FontId::proportional(17.0), theme::TEXT);
        painter.text(rect.center() + vec2(0.0, 12.0), Align2::CENTER_CENTER, detail, FontId::proportional(13.0), theme::TEXT_WEAK);
        rect
    }

    /// Chips over the picture: state on the left, views on the right, a hint while a file hovers.
    fn overlay_ui(&mut self, ui: &mut Ui, rect: Rect) {
        let corner = Rect::from_min_max(rect.min + vec2(12.0, 10.0), rect.max);
        let mut left =
            ui.new_child(egui::UiBuilder::new().id_salt("state").max_rect(corner).layout(egui::Layout::left_to_right(egui::Align::TOP)));
        for (color, text) in self.states() {
            theme::toast_frame(theme::LINE)
                .inner_margin(egui::Margin::symmetric(8, 4))
                .show(&mut left, |ui| ui.label(RichText::new(text).size(12.0).color(color)));
        }
        let corner = Rect::from_min_max(pos2(rect.right() - 320.0, rect.top() + 8.0), pos2(rect.right() - 10.0, rect.top() + 36.0));
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        let mut right = ui.new_child(egui::UiBuilder::new().id_salt("views").max_rect(corner).layout(layout));
        right.spacing_mut().item_spacing.x = 2.0;
        self.views_ui(&mut right);
        if ui.ctx().input(|i| !i.raw.hovered_files.is_empty()) {
            ui.painter().rect(
                rect.shrink(8.0),
                8.0,
                theme::ACCENT_GROUND.gamma_multiply(0.5),
                (2.0, theme::ACCENT),
                egui::StrokeKind::Inside,
            );
            ui.painter().text(rect.center(), Align2::CENTER_CENTER, "Drop to open", FontId::proportional(20.0), theme::TEXT_STRONG);
        }
    }

    /// What is unusual about the picture just now.
    fn states(&self) -> Vec<(Color32, String)> {
        let mut states = Vec::new();
        if self.scene_loader.loading.is_some() && self.screen.picture().is_some() {
            states.push((theme::TEXT, "loading the scene".into()));
        }
        if self.scene_loader.failed.is_some() && self.screen.picture().is_some() {
            states.push((theme::RED, "last good picture: the scene cannot be shown".into()));
        } else if self.motion.wanted.as_ref().is_some_and(|inputs| self.screen.is_refused(inputs)) && self.screen.picture().is_some() {
            states.push((theme::RED, "last good picture: this one cannot be drawn".into()));
        }
        if self.motion.divisor > 1 {
            states.push((theme::TEXT_WEAK, format!("1/{} resolution while moving", self.motion.divisor)));
        }
        if !self.muted.is_empty() {
            let names: Vec<_> = self.muted.iter().copied().collect();
            states.push((theme::AMBER, format!("muted: {}", names.join(", "))));
        }
        let full = self.screen.report().map_or(0, |report| report.counters.full_pixels);
        if full > 0 {
            states.push((theme::RED, format!("x-ray overflow: {full} pixels have more layers than its sums hold")));
        }
        if let Some(order) = self.screen.report().and_then(|report| report.order) {
            let over = order.drawn.saturating_sub(order.limit);
            let share = 100.0 * order.drawn as f64 / order.covered.max(1) as f64;
            if order.exceeds_sample_counter() {
                states.push((theme::RED, "more than 2^32 samples: the hardware's order lost count; take submission".into()));
            }
            states.push((theme::TEXT, format!("drew {} of {} samples ({share:.1} %), {over} too many", order.drawn, order.covered)));
        }
        if self.picking.is_some() {
            states.push((theme::ACCENT, "click a point of the model (Esc: never mind)".into()));
        }
        if !self.visible_stack().is_repeatable() {
            states.push((theme::AMBER, "not reproducible: every frame may differ".into()));
        }
        if self.is_off_its_time() && !self.panels.timeline {
            states.push((theme::TEXT_WEAK, format!("time {:.2} s", self.shown_time_s())));
        }
        states
    }

    fn views_ui(&mut self, ui: &mut Ui) {
        let orthographic = self.pose().is_some_and(|camera| matches!(camera.projection, Projection::Orthographic { .. }));
        if icon_button(ui, Icon::Frame, "Frame the scene (Home)").clicked() {
            self.frame_scene();
        }
        let text = if orthographic { "Ortho" } else { "Persp" };
        if ui.small_button(text).on_hover_text("Perspective or orthographic (5)").accessible_name("Orthographic").clicked() {
            self.move_camera(orbit::toggle_orthographic);
        }
        for (text, name, key, direction) in
            [("Top", "Top view", 7, orbit::TOP), ("Side", "Side view", 3, orbit::SIDE), ("Front", "Front view", 1, orbit::FRONT)]
        {
            if ui.small_button(text).on_hover_text(format!("{name} ({key})")).accessible_name(name).clicked() {
                self.move_camera(|camera| orbit::look_along(camera, direction));
            }
        }
        ui.add_space(theme::GAP);
        for (text, on, action) in
            [("Overlays", self.overlays.is_any(), Action::Overlays), ("Compare", self.compare.is_open(), Action::Compare)]
        {
            let button = egui::Button::new(text).small().selected(on);
            let hint = format!("{} ({})", action.about(), action.keys_text());
            if ui.add(button).on_hover_text(hint).accessible_name(action.about()).clicked() {
                self.perform(ui.ctx(), action);
            }
        }
    }
}
