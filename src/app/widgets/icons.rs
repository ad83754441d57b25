//! The icons of the lab, drawn with lines, so that they look the same with every font.

use egui::{
    self, Color32, ColorImage, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui,
    epaint::text::{GlyphBitmap, GlyphRasterizer, GlyphRasterizerRequest, RasterizedGlyph},
    vec2,
};

use super::{panel::describe_chosen, theme};
use crate::app::editing::key_id::Keying;

/// Draws the sign of copying in egui's color picker where no font has it.
pub fn draw_copy_sign(ctx: &egui::Context) {
    ctx.add_glyph_rasterizer(GlyphRasterizer::new("copy sign", copy_sign));
}

/// A sheet over another.
fn copy_sign(asked: &GlyphRasterizerRequest<'_>) -> Option<RasterizedGlyph> {
    let side = asked.font_size_px.max(6.0) as usize;
    let (sheet, line) = (side * 3 / 4, 1 + side / 24);
    // Whether a pixel of a sheet is of its edge.
    let ink = |at: [usize; 2]| {
        let is_edge = |x: &usize| *x < line || *x + line >= sheet;
        at.iter()
            .all(|x| *x < sheet)
            .then(|| at.iter().any(is_edge))
    };
    let color = |i: usize| {
        let at = [i % side, i / side];
        match ink(at.map(|x| x.wrapping_sub(side - sheet))).or_else(|| ink(at)) {
            Some(true) => Color32::WHITE,
            _ => Color32::TRANSPARENT,
        }
    };
    let is_asked = asked.cluster == "\u{1f4cb}";
    is_asked.then(|| RasterizedGlyph {
        bitmap: GlyphBitmap {
            image: ColorImage::new([side; 2], (0..side * side).map(color).collect()),
            offset_px: vec2(0.0, -0.9 * side as f32),
            is_color: false,
        },
        advance_px: side as f32,
    })
}

/// What an icon shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Eye,
    EyeShut,
    Up,
    Down,
    Left,
    Right,
    /// A circular arrow.
    Reset,
    Cross,
    /// Four corners of a frame.
    Frame,
    Dice,
    Play,
    Pause,
    /// A triangle that points left, to a bar.
    ToStart,
    StepBack,
    StepForward,
    /// Two arrows round a track.
    Loop,
    /// Three dots: a menu.
    More,
    /// A star's outline, and a filled one.
    Star,
    StarFull,
    /// Four squares.
    Grid,
    /// Lines of text beside squares.
    List,
    /// Six dots: something that can be dragged.
    Grip,
}

impl Icon {
    /// The strokes in a square from 0 to 1, right and down, each after a `;`: `l` is a line through
    /// points, `f` a filled convex polygon, `r` a filled rectangle by two corners, `o` dots of a
    /// radius.
    const fn strokes(self) -> &'static str {
        match self {
            Self::Eye => {
                "l -.1 .5 .05 .35 .2 .22 .35 .13 .5 .1 .65 .13 .8 .22 .95 .35 1.1 .5; l -.1 .5 .05 \
             .65 .2 .78 .35 .87 .5 .9 .65 .87 .8 .78 .95 .65 1.1 .5; o .17 .5 .5"
            }
            Self::EyeShut => {
                "l -.1 .5 .05 .35 .2 .22 .35 .13 .5 .1 .65 .13 .8 .22 .95 .35 1.1 .5; l -.1 .5 .05 \
             .65 .2 .78 .35 .87 .5 .9 .65 .87 .8 .78 .95 .65 1.1 .5; l 0 1 1 0"
            }
            Self::Up => "l 0 .7 .5 .25 1 .7",
            Self::Down => "l 0 .3 .5 .75 1 .3",
            Self::Left => "l .7 0 .25 .5 .7 1",
            Self::Right => "l .3 0 .75 .5 .3 1",
            Self::Reset => {
                "l .42 .03 .62 .04 .81 .13 .94 .3 .98 .5 .94 .7 .81 .87 .62 .96 .42 .97 .22 .89 .08 \
             .74 .02 .54; l .67 -.32 .42 .03 .77 .28"
            }
            Self::Cross => "l .1 .1 .9 .9; l .9 .1 .1 .9",
            Self::Frame => "l .3 0 0 0 0 .3; l .7 0 1 0 1 .3; l .7 1 1 1 1 .7; l .3 1 0 1 0 .7",
            Self::Dice => "l 0 0 1 0 1 1 0 1 0 0 1 0; o .1 .27 .27 .5 .5 .73 .73",
            Self::Play => "f .12 -.05 1.05 .5 .12 1.05",
            Self::Pause => "r .08 0 .38 1; r .62 0 .92 1",
            Self::ToStart => "l .05 0 .05 1; f 1 0 .25 .5 1 1",
            Self::StepBack => "l .95 .05 .95 .95; l .65 .05 .1 .5 .65 .95",
            Self::StepForward => "l .05 .05 .05 .95; l .35 .05 .9 .5 .35 .95",
            Self::Loop => {
                "l -.1 .55 -.1 .2 1 .2; l .75 -.05 1.02 .2 .75 .45; l 1.1 .45 1.1 .8 0 .8; l .25 \
             .55 -.02 .8 .25 1.05"
            }
            Self::More => "o .13 .5 .05 .5 .5 .5 .95",
            Self::Star => {
                "l .5 -.1 .65 .29 1.07 .31 .75 .58 .85 .99 .5 .76 .15 .99 .25 .58 -.07 .31 .35 .29 \
             .5 -.1 .65 .29"
            }
            Self::StarFull => {
                "l .5 -.1 .65 .29 1.07 .31 .75 .58 .85 .99 .5 .76 .15 .99 .25 .58 -.07 .31 .35 .29 \
             .5 -.1 .65 .29; f .65 .29 .75 .58 .5 .76 .25 .58 .35 .29; f .35 .29 .5 -.1 .65 \
             .29; f .65 .29 1.07 .31 .75 .58; f .75 .58 .85 .99 .5 .76; f .5 .76 .15 .99 .25 \
             .58; f .25 .58 -.07 .31 .35 .29"
            }
            Self::Grid => "r 0 0 .42 .42; r .58 0 1 .42; r 0 .58 .42 1; r .58 .58 1 1",
            Self::List => {
                "r 0 0 .2 .2; r .34 0 1 .2; r 0 .4 .2 .6; r .34 .4 1 .6; r 0 .8 .2 1; r .34 .8 1 1"
            }
            Self::Grip => "o .1 .3 .05 .3 .5 .3 .95 .7 .05 .7 .5 .7 .95",
        }
    }
}

/// A square button without a frame; `name` is its tooltip and its accessible name.
pub fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let response = bare_button(ui, icon, |ui, response| {
        if ui.is_enabled() {
            ui.style().interact(response).fg_stroke.color
        } else {
            ui.visuals().weak_text_color()
        }
    });
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    response.on_hover_text(name).on_disabled_hover_text(name)
}

/// The star of favorites; `name` says what is listed while it is on.
pub fn star_toggle(ui: &mut Ui, is_on: &mut bool, name: &str) {
    let icon = if *is_on { Icon::StarFull } else { Icon::Star };
    *is_on ^= toggle_button(ui, icon, *is_on, name)
        .on_hover_text("Favorites only")
        .clicked();
}

/// A button that is on or off.
pub fn toggle_button(ui: &mut Ui, icon: Icon, on: bool, name: &str) -> Response {
    let response = bare_button(ui, icon, |_, _| {
        if on {
            theme::accent()
        } else {
            theme::text_weak()
        }
    });
    describe_chosen(&response, Role::CheckBox, on, name);
    response
}

fn bare_button(ui: &mut Ui, icon: Icon, color: impl FnOnce(&Ui, &Response) -> Color32) -> Response {
    let side = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        if response.hovered() || response.has_focus() {
            ui.painter().rect(
                rect.shrink(1.0),
                4.0,
                visuals.weak_bg_fill,
                visuals.bg_stroke,
                egui::StrokeKind::Inside,
            );
        }
        paint(
            ui.painter(),
            icon,
            rect.shrink(side * 0.27),
            color(ui, &response),
        );
    }
    response
}

/// The diamond beside a value: a gray outline if it is not animated, an outline in the accent color
/// if it is, filled at a keyframe.
pub fn key_button(ui: &mut Ui, rect: Rect, keying: Keying, path: &str) -> Response {
    let response = ui.interact(rect, egui::Id::unique((path, "key")), Sense::click());
    let (name, hint) = match keying {
        Keying::Still => (
            format!("Animate {path}"),
            "Animate this value: set its first key at the time shown",
        ),
        Keying::Between => (
            format!("Key {path}"),
            "Set a key at the time shown. Changing the value does the same.",
        ),
        Keying::OnKey => (
            format!("Remove key of {path}"),
            "Remove the key at this time",
        ),
    };
    let near = response.hovered() || response.has_focus();
    let color = match (keying, near && ui.is_enabled()) {
        (Keying::Still, false) => theme::text_weak().gamma_multiply(0.7),
        (Keying::Still, true) => theme::text_strong(),
        (_, false) => theme::accent(),
        (_, true) => theme::text_strong(),
    };
    let fill = if keying == Keying::OnKey {
        color
    } else {
        Color32::TRANSPARENT
    };
    paint_diamond(
        ui.painter(),
        rect.center(),
        if near { 5.5 } else { 4.5 },
        fill,
        color,
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), &name));
    response.on_hover_text(hint)
}

/// The mark of a keyframe: a diamond with corners `r` points from its center.
pub fn paint_diamond(painter: &egui::Painter, at: Pos2, r: f32, fill: Color32, edge: Color32) {
    let points = [(0.0, -r), (r, 0.0), (0.0, r), (-r, 0.0)]
        .map(|(x, y)| at + vec2(x, y))
        .to_vec();
    painter.add(Shape::convex_polygon(points, fill, Stroke::new(1.3, edge)));
}

/// Draws `icon` into `rect`.
pub fn paint(painter: &egui::Painter, icon: Icon, rect: Rect, color: Color32) {
    for stroke in icon.strokes().split(';') {
        let (kind, numbers) = stroke.trim().split_at(1);
        let mut numbers = numbers.split_whitespace().filter_map(|n| n.parse().ok());
        let radius: f32 = if kind == "o" {
            numbers.next().unwrap_or_default()
        } else {
            0.0
        };
        let numbers: Vec<f32> = numbers.collect();
        let at = |xy: &[f32]| rect.min + vec2(xy[0], xy[1]) * rect.size();
        let points: Vec<Pos2> = numbers.chunks_exact(2).map(at).collect();
        match (kind, &points[..]) {
            ("o", dots) => dots.iter().for_each(|dot| {
                painter.circle_filled(*dot, radius * rect.width(), color);
            }),
            ("r", [a, b]) => drop(painter.rect_filled(Rect::from_two_pos(*a, *b), 1.0, color)),
            ("f", _) => drop(painter.add(Shape::convex_polygon(points, color, Stroke::NONE))),
            _ => drop(painter.line(points, Stroke::new(1.5, color))),
        }
    }
}

/// A square of `color`, as in a legend.
pub fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, color);
}
