//! A row of the gallery: thumbnail, name, and what the preset shows.

use eframe::egui::{self, Align2, FontId, Pos2, Rect, RichText, Sense, Ui, pos2, vec2};

use crate::{
    app::{jobs, theme},
    preset_file::{GalleryEntry, Origin},
};

/// Size of a thumbnail, points.
const THUMBNAIL: egui::Vec2 = vec2(jobs::THUMBNAIL[0] as f32 / 2.0, jobs::THUMBNAIL[1] as f32 / 2.0);

/// Where the next row of the gallery comes to lie.
pub fn row_rect(ui: &Ui) -> Rect {
    Rect::from_min_size(ui.next_widget_position(), vec2(ui.available_width(), THUMBNAIL.y + 8.0))
}

pub fn entry_ui(
    ui: &mut Ui,
    entry: &GalleryEntry,
    picture: Option<&egui::TextureHandle>,
    is_open: bool,
    is_modified: bool,
) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), THUMBNAIL.y + 8.0), Sense::click());
    let (name, about, color) = match &entry.preset_file {
        Ok(preset_file) => (preset_file.title(), preset_file.preset.about.clone(), theme::text_strong()),
        Err(error) => (entry.id.as_str(), error.to_string(), theme::red()),
    };
    if is_open {
        ui.painter().rect_filled(rect, 6.0, theme::accent_ground());
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 6.0, theme::raised());
    }
    let frame = Rect::from_min_size(rect.min + vec2(4.0, 4.0), THUMBNAIL);
    match picture {
        Some(picture) => {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            egui::Image::from_texture((picture.id(), THUMBNAIL)).uv(whole).corner_radius(4.0).paint_at(ui, frame);
        }
        None => drop(ui.painter().rect_filled(frame, 4.0, theme::well())),
    }
    let text = Rect::from_min_max(pos2(frame.right() + 8.0, frame.top()), rect.max - vec2(6.0, 4.0));
    let painter = ui.painter_at(text);
    let title = painter.layout_no_wrap(name.to_owned(), FontId::proportional(13.0), color);
    painter.galley(text.min + vec2(0.0, 2.0), title.clone(), color);
    if is_modified {
        painter.circle_filled(text.min + vec2(title.size().x + 8.0, 10.0), 3.0, theme::accent());
    }
    let mut job =
        egui::text::LayoutJob::single_section(about.clone(), egui::TextFormat::simple(FontId::proportional(11.5), about_color(is_open)));
    job.wrap = egui::text::TextWrapping { max_width: text.width(), max_rows: 2, break_anywhere: false, overflow_character: Some('…') };
    painter.galley(text.min + vec2(0.0, 20.0), painter.layout_job(job), theme::text_weak());
    if entry.preset_file.is_err() && picture.is_none() {
        ui.painter().text(frame.center(), Align2::CENTER_CENTER, "!", FontId::proportional(18.0), theme::red());
    }
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_open, format!("Preset {name}")));
    response.on_hover_ui(|ui| {
        ui.label(RichText::new(name).color(theme::text_strong()));
        ui.label(&about);
        ui.label(theme::weak(source_text(entry)));
    })
}

fn about_color(is_open: bool) -> egui::Color32 {
    if is_open { theme::text() } else { theme::text_weak() }
}

/// Where the preset comes from.
fn source_text(entry: &GalleryEntry) -> String {
    let source = match (&entry.path, entry.origin) {
        (Some(path), _) => path.display().to_string(),
        (None, Origin::Builtin) => "Built in".into(),
        (None, _) => String::new(),
    };
    if entry.shadows.is_empty() { source } else { format!("{source}; hides {} of the same name", entry.shadows.len()) }
}
