//! Guides over the picture: the box of the scene, its axes, a grid under it, and the distance
//! between two points that were clicked. They are painted over the picture, whatever hides them.

use egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Response, Sense, Ui, vec2};
use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    layout::{fit_aspect, whole_size},
    points::seen_at,
};
use crate::{
    app::{
        picture::apply::measure,
        shell::{command::Commands, log::Level, state::State},
        widgets::{
            panel::{describe, plate},
            text::short,
            theme,
        },
    },
    scene::{Bounds, Scene, pick, view::View},
};

/// Lines of the grid on each side of its middle.
const GRID: i32 = 10;

/// The part of a line whose w is less is behind the eye, or too near to it.
const NEAREST_W: f64 = 1e-6;

/// Where a line in world space is seen: both ends of what lies before the eye, 0 to 1 right and
/// down inside the picture. None if all of it lies behind the eye.
fn seen_line(view: &View, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let [a, b] = ends.map(|point| view.clip_from_world * point.extend(1.0));
    if a.w < NEAREST_W && b.w < NEAREST_W {
        return None;
    }
    let before_the_eye = |end: DVec4, other: DVec4| match end.w < NEAREST_W {
        true => other.lerp(end, (other.w - NEAREST_W) / (other.w - end.w)),
        false => end,
    };
    let seen = [before_the_eye(a, b), before_the_eye(b, a)]
        .map(|p| (DVec2::new(p.x, -p.y) / p.w + 1.0) * 0.5);
    (seen[0].is_finite() && seen[1].is_finite()).then_some(seen)
}

/// A step of 1, 2 or 5 times a power of ten, about a tenth of `length`; none of no length.
fn grid_step(length: f64) -> Option<f64> {
    let tenth = Some(length / 10.0).filter(|tenth| tenth.is_normal() && *tenth > 0.0)?;
    let power = 10f64.powi(tenth.log10().floor() as i32);
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step >= tenth)
}

/// Pairs of corners of a box that an edge joins; corner `i` is the upper one along the axes whose
/// bits it has.
fn edges() -> impl Iterator<Item = [usize; 2]> {
    (0..8usize).flat_map(|i| {
        (0..3)
            .filter(move |axis| i >> axis & 1 == 0)
            .map(move |axis| [i, i | 1 << axis])
    })
}

/// Where lines are painted: the picture, and how the scene stands in it.
struct Paper<'a> {
    ui: &'a Ui,
    painter: Painter,
    at: Rect,
    view: &'a View,
    world_from_scene: DMat4,
}

impl Paper<'_> {
    fn place(&self, uv: DVec2) -> Pos2 {
        self.at.min + vec2(uv.x as f32, uv.y as f32) * self.at.size()
    }

    /// Where a point of the scene is seen; none behind the eye.
    fn seen(&self, point: DVec3) -> Option<Pos2> {
        let world = self.world_from_scene.transform_point3(point);
        seen_at(self.view, world).map(|uv| self.place(uv))
    }

    /// Paints a line between points of the scene. Returns where its ends are seen.
    fn line(&self, ends: [DVec3; 2], width: f32, color: Color32) -> Option<[Pos2; 2]> {
        let ends = ends.map(|end| self.world_from_scene.transform_point3(end));
        let places = seen_line(self.view, ends)?.map(|uv| self.place(uv));
        for (width, color) in [
            (width + 1.5, Color32::from_black_alpha(110)),
            (width, color),
        ] {
            self.painter.line_segment(places, (width, color));
        }
        Some(places)
    }

    /// A text on a plate beside `place`, where it lies inside the picture.
    fn text(&self, place: Pos2, id: &str, text: &str) {
        let corner = place + vec2(8.0, 4.0);
        let plate = plate(&self.painter, corner, Align2::LEFT_TOP, self.at, text);
        let response = self
            .ui
            .interact(plate, egui::Id::unique(("guide", id)), Sense::hover());
        describe(&response, egui::Role::Label, text);
    }

    fn bounding_box(&self, bounds: &Bounds) {
        let corners = bounds.corners();
        for ends in edges() {
            self.line(ends.map(|end| corners[end]), 1.0, theme::text_strong());
        }
        let highest = corners
            .iter()
            .filter_map(|corner| self.seen(*corner))
            .min_by(|a, b| a.y.total_cmp(&b.y));
        let [x, y, z] = (bounds.max - bounds.min).to_array().map(short);
        if let Some(place) = highest {
            self.text(place, "box", &format!("box {x} \u{d7} {y} \u{d7} {z} m"));
        }
    }

    fn axes(&self, bounds: &Bounds) {
        let length = bounds.radius();
        let colors = [
            Color32::from_rgb(235, 72, 72),
            Color32::from_rgb(92, 200, 84),
            Color32::from_rgb(84, 140, 255),
        ];
        for ((axis, color), name) in DVec3::AXES.into_iter().zip(colors).zip(["x", "y", "z"]) {
            if let Some([_, end]) = self.line([DVec3::ZERO, axis * length], 2.0, color) {
                let font = FontId::proportional(13.0);
                self.painter
                    .text(end, Align2::LEFT_BOTTOM, name, font, color);
            }
        }
    }

    fn grid(&self, bounds: &Bounds) {
        let Some(step) = grid_step(2.0 * bounds.radius()) else {
            return;
        };
        let middle = bounds.center();
        let [x, z] = [middle.x, middle.z].map(|v| (v / step).round() * step);
        let point = |i: i32, k: i32| {
            let [i, k] = [i, k].map(|index| f64::from(index) * step);
            DVec3::new(x + i, bounds.min.y, z + k)
        };
        let color = theme::text_weak();
        for i in -GRID..=GRID {
            self.line([point(i, -GRID), point(i, GRID)], 0.7, color);
            self.line([point(-GRID, i), point(GRID, i)], 0.7, color);
        }
        let corners = [(-1, -1), (-1, 1), (1, -1), (1, 1)].map(|(i, k)| point(i * GRID, k * GRID));
        let nearest = corners
            .iter()
            .filter_map(|corner| self.seen(*corner))
            .max_by(|a, b| a.y.total_cmp(&b.y));
        if let Some(place) = nearest {
            self.text(place, "grid", &format!("grid {} m", short(step)));
        }
    }

    fn distance(&self, points: &[DVec3]) {
        for point in points {
            if let Some(place) = self.seen(*point) {
                self.painter
                    .circle(place, 4.0, theme::accent(), (1.5, theme::view()));
            }
        }
        if let [a, b] = *points
            && let Some([from, to]) = self.line([a, b], 1.5, theme::accent())
        {
            let text = format!("distance {} m", short(a.distance(b)));
            self.text(from.lerp(to, 0.5), "distance", &text);
        }
    }
}

/// Paints the guides that are switched on over the picture at `at`, which is drawn for all of
/// `rect`.
pub fn guides_ui(ui: &Ui, state: &State, rect: Rect, at: Rect) {
    let (open, measure) = (&state.open, state.measured_points());
    let is_any = open.bounding_box || open.axes || open.grid || !measure.is_empty();
    let Some(scene) = state.session.scene().filter(|_| is_any) else {
        return;
    };
    let view = state.session.view_at(scene, whole_size(rect));
    let paper = Paper {
        ui,
        painter: ui.painter_at(at),
        at,
        view: &view,
        world_from_scene: view.scene_state.world_from_scene,
    };
    let bounds = scene.content_bounds();
    let is_shown = |is_on: bool| is_on && !bounds.is_empty();
    if is_shown(open.grid) {
        paper.grid(&bounds);
    }
    if is_shown(open.bounding_box) {
        paper.bounding_box(&bounds);
    }
    if is_shown(open.axes) {
        paper.axes(&bounds);
    }
    paper.distance(measure);
}

/// The point of the scene under `uv` of the picture, before the scene's spin; none where there is
/// no triangle.
fn scene_point(scene: &Scene, view: &View, uv: DVec2) -> Option<DVec3> {
    let world = pick::pick(scene, view, uv)?;
    let scene_from_world = view.scene_state.world_from_scene.inverse();
    Some(scene_from_world.transform_point3(world))
}

/// Takes a click with Shift as an end of the distance that is measured. The picture is in `side`.
pub fn take_click(ui: &Ui, response: &Response, side: Rect, state: &State, commands: &Commands) {
    let clicked = response
        .interact_pointer_pos()
        .filter(|_| response.clicked() && ui.input(|i| i.modifiers.shift))
        .filter(|_| state.picture.picking.is_none());
    let Some((pointer, scene)) = clicked.zip(state.session.scene()) else {
        return;
    };
    let size = whole_size(response.rect);
    let at = fit_aspect(side, size);
    if !at.contains(pointer) {
        return;
    }
    let uv = (pointer - at.min) / at.size();
    let view = state.session.view_at(scene, size);
    match scene_point(scene, &view, DVec2::new(uv.x.into(), uv.y.into())) {
        Some(point) => commands.run(move |app| measure(&mut app.state, Some(point))),
        None => commands.notify(
            Level::Info,
            "There is no triangle under this click, so no point is measured from",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::Camera;

    #[test]
    fn a_line_that_begins_behind_the_eye_is_seen_where_it_lies_before_it() {
        let camera = Camera {
            eye: DVec3::new(0.0, 0.0, 5.0),
            target: DVec3::ZERO,
            ..Camera::default()
        };
        let bounds = Bounds {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        };
        let view = View::new(&camera, 300, 200, &bounds, DMat4::IDENTITY, [0.0; 4]);
        let behind = DVec3::new(1.0, 0.0, 9.0);
        let middle = DVec3::ZERO;
        let [from, to] = seen_line(&view, [behind, middle]).expect("a part lies before the eye");
        assert!(from.x > 1.0, "it leaves the picture: {from}");
        assert!(to.distance(DVec2::splat(0.5)) < 1e-9, "{to}");
        assert_eq!(seen_line(&view, [behind, behind + DVec3::Z]), None);
    }

    #[test]
    fn a_box_has_twelve_edges_and_a_grid_round_steps() {
        assert_eq!(edges().count(), 12);
        assert!(edges().all(|[a, b]| (a ^ b).count_ones() == 1));
        for (length, step) in [(10.0, 1.0), (11.0, 2.0), (0.3, 0.05), (7e6, 1e6)] {
            let found = grid_step(length).expect("a length");
            assert!((found / step - 1.0).abs() < 1e-9, "{length}: {found}");
        }
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(grid_step), [None; 3]);
    }
}
