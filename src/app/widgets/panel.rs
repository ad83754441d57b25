//! How every panel places and describes what it shows.

use egui::{
    Align, Align2, Button, Context, FontId, Image, Layout, Modal, Painter, Pos2, Rect, Response,
    Role, TextureHandle, Ui, WidgetInfo, Window,
    text::{LayoutJob, TextWrapping},
    vec2,
};

use super::theme;

/// Below this width a window is a phone's, points: one menu, and handles for the side panels.
const PHONE: f32 = 600.0;

/// Is the window as narrow as a phone?
pub fn is_phone(ctx: &Context) -> bool {
    ctx.content_rect().width() < PHONE
}

/// Contents at the right end, from right to left.
pub fn at_right<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.with_layout(Layout::right_to_left(Align::Center), contents)
        .inner
}

/// A row of a folder, as high as the others and flush with their labels.
pub fn row<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(theme::GAP);
        contents(ui)
    })
    .inner
}

/// A window over the picture that the user can move and close.
pub fn window<'a>(title: &'a str, is_open: &'a mut bool) -> Window<'a> {
    Window::new(title)
        .open(is_open)
        .collapsible(false)
        .resizable(false)
}

/// The same in the middle of all.
pub fn centered_window<'a>(ctx: &Context, title: &'a str, is_open: &'a mut bool) -> Window<'a> {
    window(title, is_open)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
}

/// A dialog that takes all keys.
pub fn modal(ctx: &Context, id: &str, margin: f32) -> Modal {
    let frame = egui::Frame::window(&ctx.global_style()).inner_margin(margin);
    Modal::new(egui::Id::unique(id)).frame(frame)
}

/// The button of what a window is there for.
pub fn main_button(text: &str) -> Button<'_> {
    Button::new(text).fill(theme::accent_ground())
}

/// An entry of a menu that is so wide.
pub fn entry(text: &str, width: f32) -> Button<'_> {
    Button::new(text).min_size(vec2(width, theme::ROW))
}

/// Tells assistive technology what was painted by hand.
pub fn describe(response: &Response, role: Role, name: impl Into<String>) {
    let name = name.into();
    response.widget_info(|| WidgetInfo::labeled(role, true, &name));
}

/// The same of what is chosen or not.
pub fn describe_chosen(response: &Response, role: Role, is_chosen: bool, name: impl Into<String>) {
    let name = name.into();
    response.widget_info(|| WidgetInfo::selected(role, true, is_chosen, &name));
}

/// Paints a picture in `rect`, and a well while there is none.
pub fn picture_ui(ui: &Ui, rect: Rect, picture: Option<&TextureHandle>) {
    match picture {
        Some(texture) => Image::from_texture((texture.id(), rect.size()))
            .corner_radius(4.0)
            .paint_at(ui, rect),
        None => drop(ui.painter().rect_filled(rect, 4.0, theme::well())),
    }
}

/// Paints a text on a plate whose corner `align` lies at `at`, moved into `within`. Returns where
/// the plate is.
pub fn plate(painter: &Painter, at: Pos2, align: Align2, within: Rect, text: &str) -> Rect {
    let ink = theme::text_strong();
    let font = FontId::proportional(12.0);
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, ink);
    job.wrap = TextWrapping::truncate_at_width(within.width() - 12.0);
    let galley = painter.layout_job(job);
    let size = galley.size() + vec2(12.0, 6.0);
    let min = align.anchor_size(at, size).min;
    let plate = Rect::from_min_size(min.min(within.max - size).max(within.min), size);
    painter.rect_filled(plate, 4.0, theme::bar().gamma_multiply(0.9));
    painter.galley(plate.min + vec2(6.0, 3.0), galley, ink);
    plate
}
