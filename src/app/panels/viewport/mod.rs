//! Viewport: the picture, its overlays and the comparison, and the pointer on the camera.

mod badges;
mod camera_input;
mod chips;
mod compare;
mod compare_bar;
mod compare_plates;
pub mod compare_ui;
mod compiling;
mod guides;
mod handles;
mod heat_legend;
mod layout;
mod light;
mod loupe;
mod marker;
mod overlay_image;
mod overlay_legend;
mod overlays;
mod particle_input;
mod pick_input;
mod points;
mod probe;

use std::sync::Arc;

use egui::{self, Align2, FontId, Rect, Response, Sense, Ui, vec2};

use self::{
    compare::Compare,
    layout::{fit_aspect, whole_size},
    loupe::Loupe,
    overlays::OverlayPainter,
};
use crate::{
    app::{
        editing::session::FileId,
        files::scene_loader::SceneKey,
        picture::{
            anti_aliasing::{AutomaticAntiAliasing, Finished},
            screen::Inputs,
            timings::Measurable,
        },
        shell::{
            command::{Commands, Edit},
            log::Level,
            state::State,
        },
        widgets::{panel::describe, theme},
    },
    effects::{Stack, given::Given},
    preset::AccuracyRequest,
    scene::Scene,
};

/// After this long without motion the picture is drawn at full size, seconds.
const REST_S: f64 = 0.2;

/// A frame that takes longer makes moving pictures coarser, milliseconds.
const SMOOTH_MS: f64 = 28.0;

/// The picture, its overlays and the comparison, and the pointer on the camera.
#[derive(Default)]
pub struct Viewport {
    /// When the user last moved the picture, seconds; 0 for never.
    last_motion_s: f64,
    pub compare: Compare,
    overlays: OverlayPainter,
    loupe: Loupe,
    anti_aliasing: AutomaticAntiAliasing,
    /// What the numbers in the header are of.
    measured: Measurable<(FileId, SceneKey)>,
}

/// Where the picture is, and what the pointer did there.
pub struct Interaction {
    pub response: Response,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The pointer moved the camera.
    pub is_moved: bool,
}

impl Viewport {
    /// Takes pointer and keys over the picture. What they change must be applied before
    /// [`Viewport::draw`].
    pub fn interact(&mut self, ui: &mut Ui, state: &State, commands: &Commands) -> Interaction {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        describe(&response, egui::Role::Image, "Picture");
        let pixels = (rect.size() * ui.pixels_per_point()).round();
        let max_side = state.picture.screen.gpu.caps.max_texture_side;
        let size = [pixels.x, pixels.y].map(|side| (side.max(0.0) as u32).min(max_side));
        let camera = if particle_input::attract(&response, &state.session, commands) {
            None
        } else {
            camera_input::navigate(ui, &response, &state.session, state.session.widening(size))
        };
        let is_moved = camera.is_some() && camera != state.session.preset().camera;
        if camera.is_some() {
            commands.edit(Edit::Camera(camera));
        }
        if let Some(picking) = &state.picture.picking {
            pick_input::pick(
                &response,
                self.compare.side_b(rect),
                picking,
                state,
                commands,
            );
        }
        if !self.compare.hides_b() {
            let at = fit_aspect(self.compare.side_b(rect), whole_size(rect));
            match ui.input(|i| i.modifiers.shift) {
                true => {
                    guides::take_click(ui, &response, self.compare.side_b(rect), state, commands)
                }
                false => probe::take_click(&response, state, at, commands),
            }
        }
        Interaction {
            response,
            size,
            is_moved,
        }
    }

    /// Draws the preset, at a lower resolution while it moves on a slow adapter.
    pub fn draw(&mut self, ctx: &egui::Context, state: &mut State, interaction: &Interaction) {
        let now_s = state.now_s;
        if let Err(error) = state.picture.screen.poll() {
            state.log.add(Level::Error, error); // Words stay in the picture as long as this is so.
        }
        // While the scene of another preset is shown there is nothing to draw.
        let Some(scene) = state
            .session
            .scenes
            .shown_for(&SceneKey::of(&state.session.preset_file))
            .cloned()
        else {
            return;
        };
        let file = &state.session.preset_file;
        let shown = (FileId::of(file), SceneKey::of(file));
        let [resets_times, is_other] = self.measured.resets(shown, interaction.size);
        if resets_times {
            state.picture.screen.reset_timings();
            self.compare.reset_measurements();
        }
        if is_other {
            state.picture.verification.reset();
        }
        let session = &state.session;
        let stack = session
            .next_stack()
            .drawn(session.length_scale(session.preset(), interaction.size));
        let accuracy = self.accuracy(state, &scene, &stack, interaction.size);
        let requested = Inputs {
            view: state.session.view_at(&scene, interaction.size),
            scene,
            stack,
            accuracy,
        };
        let rect = interaction.response.rect;
        let at = fit_aspect(self.compare.side_b(rect), whole_size(rect));
        let pointer = interaction.response.hover_pos();
        let requested = requested.given(pointer.map(|pointer| {
            let [width, height] = interaction.size.map(|side| side as f32);
            let uv = (pointer - at.min) / at.size();
            [uv.x * width, uv.y * height]
        }));
        let follows = requested.stack.is_given(Given::Pointer);
        let is_held = ctx.input(|i| i.pointer.any_down());
        let is_changed = state
            .picture
            .screen
            .requested()
            .is_some_and(|before| *before != requested);
        if interaction.is_moved
            || state.session.playback.playing
            || (is_changed && (is_held || follows))
        {
            self.last_motion_s = now_s;
        }
        let rest_in_s = self
            .rest_in_s(now_s)
            .filter(|_| state.picture.screen.requested().is_some());
        let divisor = if rest_in_s.is_some() {
            self.divisor(state, interaction.size)
        } else {
            1
        };
        if divisor > 1 {
            ctx.request_repaint_after_secs(rest_in_s.unwrap_or(0.0) as f32 + 0.01);
        }
        let time_s = state.session.next_time_s();
        state.picture.screen.show(requested, divisor, time_s);
        let seen_s = state.picture.screen.time_s();
        state.session.playback.see(seen_s);
        self.compare.draw(state);
        // What else runs would be measured, too.
        let is_busy = is_held
            || state.session.playback.playing
            || state.jobs.is_computing()
            || self.compare.is_waiting();
        if rest_in_s.is_none() && !is_busy {
            state.picture.screen.measure();
            if !state.picture.screen.is_measuring() {
                self.compare.measure();
            }
        }
    }

    /// The preset's accuracy, with automatic anti-aliasing where the card can afford it.
    fn accuracy(
        &mut self,
        state: &State,
        scene: &Arc<Scene>,
        stack: &Stack,
        size: [u32; 2],
    ) -> AccuracyRequest {
        let screen = &state.picture.screen;
        let newest = screen.options().zip(screen.drawn().filter(|drawn| {
            screen
                .requested()
                .is_some_and(|next| next.shares_kernels(drawn))
        }));
        let finished = newest.map(|(options, drawn)| {
            let is_full_size = [drawn.view.width, drawn.view.height] == size;
            Finished::new(options, screen.timings().cost_ms(), is_full_size)
        });
        let accuracy = state
            .picture
            .tier_times
            .informed(state.session.preset().accuracy);
        self.anti_aliasing
            .applied(accuracy, (scene, stack, size), &screen.gpu.caps, finished)
    }

    /// Seconds until the picture counts as at rest; none when it does.
    fn rest_in_s(&self, now_s: f64) -> Option<f64> {
        let rest_s = REST_S - (now_s - self.last_motion_s);
        (self.last_motion_s > 0.0 && rest_s > 0.0).then_some(rest_s)
    }

    /// By how much a moving picture of `full` pixels must be smaller along a side to stay smooth,
    /// from the time of the last one.
    fn divisor(&self, state: &State, full: [u32; 2]) -> u32 {
        let screen = &state.picture.screen;
        let Some(ms) = screen
            .timings()
            .newest_ms()
            .map(|ms| ms + self.compare.ms())
        else {
            return if screen.gpu.summary.software { 2 } else { 1 };
        };
        let [width, height] = screen.picture().map_or(full, |(_, size)| size);
        let pixels = |w: u32, h: u32| f64::from(w.max(1)) * f64::from(h.max(1));
        // The part of the time that does not depend on the size is unknown; half is assumed to
        // shrink.
        let scale = 0.5 + 0.5 * pixels(full[0], full[1]) / pixels(width, height);
        match ms * scale {
            ms if ms <= SMOOTH_MS => 1,
            ms if ms <= 4.0 * SMOOTH_MS => 2,
            _ => 3,
        }
    }

    /// True if overlays are shown and the picture is at rest but not judged; repaints when it comes
    /// to rest.
    pub fn needs_verdict(&self, ctx: &egui::Context, state: &State) -> bool {
        if state.picture.overlays_are_ready()
            || state.picture.verification.is_running()
            || state.session.playback.playing
        {
            return false;
        }
        let screen = &state.picture.screen;
        let is_drawn = screen.requested().is_some()
            && screen.drawn() == screen.requested()
            && !screen.is_waiting()
            && !screen.is_measuring();
        if !is_drawn || ctx.input(|i| i.pointer.any_down()) {
            return false; // The event that ends this state repaints.
        }
        let rest_in_s = self.rest_in_s(state.now_s);
        if let Some(wait_s) = rest_in_s {
            ctx.request_repaint_after_secs(wait_s as f32 + 0.01);
        }
        rest_in_s.is_none()
    }

    /// Shows the picture in `rect`, and everything over it.
    pub fn show(&mut self, ui: &mut Ui, state: &State, commands: &Commands, rect: Rect) {
        let at = picture_ui(ui, state, self.compare.side_b(rect));
        let free = compare_ui::compare_ui(
            ui,
            &mut self.compare,
            (state, commands),
            (rect, at),
            &mut self.overlays,
        );
        chips::chips_ui(ui, state, commands, rect, self.compare.is_open());
        if !self.compare.hides_b() {
            guides::guides_ui(ui, state, rect, at);
            marker::marker_ui(ui, state, at);
            probe::probed_ui(ui, &mut self.loupe, state, at, commands);
            if state.open.handles {
                handles::handles_ui(ui, state, commands, rect, at);
            }
        }
        // A comparison shows its numbers in the ball's corner.
        if state.open.handles && !self.compare.is_open() {
            light::light_ui(ui, &state.session, commands, at);
        }
        let free = if self.compare.hides_b() {
            free
        } else {
            overlay_legend::legend_ui(ui, state, (free, at), commands)
        };
        if let Some(params) = state.session.visible_stack().params("overdraw") {
            heat_legend::heat_ui(ui, free, &params);
        }
        badges::badges_ui(ui, state, rect);
        compiling::compiling_ui(ui, state, rect);
    }
}

/// The newest picture, or why there is none. Returns where the picture is.
fn picture_ui(ui: &Ui, state: &State, rect: Rect) -> Rect {
    let painter = ui.painter_at(rect);
    if let Some((blit, size)) = state
        .picture
        .screen
        .picture()
        .filter(|(_, size)| size.iter().all(|&side| side > 0))
    {
        let at = fit_aspect(rect, size);
        if at != rect {
            painter.rect_filled(rect, 0.0, theme::view());
        }
        painter.add(blit.shape(at));
        return at;
    }
    painter.rect_filled(rect, 0.0, theme::view());
    let compiling = state.picture.screen.compiling();
    let (title, detail) = if let Some(compiling) = &compiling {
        (compiling.as_str(), "The first picture takes longest.")
    } else if state.session.scenes.has_failed() {
        (
            "This scene cannot be shown",
            "See the log. Choose another scene on the left, or drop a model here.",
        )
    } else if state.picture.screen.is_refused() {
        ("This picture cannot be drawn", "See the log.")
    } else {
        ("Loading the scene", "Large scenes take a moment.")
    };
    painter.text(
        rect.center() - vec2(0.0, 12.0),
        Align2::CENTER_CENTER,
        title,
        FontId::proportional(17.0),
        theme::text(),
    );
    painter.text(
        rect.center() + vec2(0.0, 12.0),
        Align2::CENTER_CENTER,
        detail,
        FontId::proportional(13.0),
        theme::text_weak(),
    );
    rect
}
