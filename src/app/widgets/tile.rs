//! Tiles: what a browser lists, side by side with their pictures, names and stars.

use egui::{
    self, Align2, FontId, Rect, Response, Role, Sense, Ui, Vec2, pos2, text::LayoutJob, vec2,
};

use super::{
    icons::{Icon, paint},
    panel::{describe_chosen, picture_ui},
    theme,
};
use crate::app::picture::effect_picture::THUMBNAIL;

const STAR: f32 = 20.0;

/// How tiles are laid out: the least width, the height of the name, and the space around.
#[derive(Clone, Copy)]
pub struct Tiling {
    pub width: f32,
    pub name: f32,
    pub margin: f32,
    pub gap: f32,
    /// A thumbnail of this width stands beside name and description, one tile a row.
    pub list: Option<f32>,
}

/// What is shown of an entry.
pub struct Tile<'a> {
    /// `Effect` or `Preset`.
    pub kind: &'static str,
    pub id: &'a str,
    /// What it is called for assistive technology.
    pub title: &'a str,
    pub name: String,
    /// Shown beside the picture in a list.
    pub about: String,
    pub picture: Option<&'a egui::TextureHandle>,
    pub is_chosen: bool,
    pub is_modified: bool,
    pub is_favorite: bool,
    pub is_faulty: bool,
}

impl Tiling {
    /// Shows a tile for each entry in rows, the visible and the others.
    pub fn show<T>(self, ui: &mut Ui, entries: &[T], mut show: impl FnMut(&mut Ui, &T, Rect)) {
        let (size, columns) = self.size(ui.available_width());
        for row in entries.chunks(columns) {
            let all = vec2(ui.available_width(), size.y);
            let (line, _) = ui.allocate_exact_size(all, Sense::hover());
            for (column, entry) in row.iter().enumerate() {
                let left = column as f32 * (size.x + self.gap);
                let rect = Rect::from_min_size(line.min + vec2(left, 0.0), size);
                show(ui, entry, rect);
            }
            ui.add_space(self.gap - ui.spacing().item_spacing.y);
        }
    }

    /// Height of a picture that is so wide.
    fn height(width: f32) -> f32 {
        width * THUMBNAIL[1] as f32 / THUMBNAIL[0] as f32
    }

    fn size(self, width: f32) -> (Vec2, usize) {
        if let Some(picture) = self.list {
            return (vec2(width, Self::height(picture) + 2.0 * self.margin), 1);
        }
        let columns = ((width + self.gap) / (self.width + self.gap))
            .floor()
            .max(1.0);
        let tile = (width - (columns - 1.0) * self.gap) / columns;
        let height = Self::height(tile - 2.0 * self.margin) + self.name + self.margin;
        (vec2(tile, height), columns as usize)
    }
}

impl Tile<'_> {
    /// Shows the tile in `rect`. Returns the tile and its star.
    pub fn show(&self, ui: &mut Ui, tiling: Tiling, rect: Rect, sense: Sense) -> [Response; 2] {
        let id = (self.kind, self.id);
        let response = ui.interact(rect, egui::Id::unique(id), sense);
        let called = format!("{} {}", self.kind, self.title);
        describe_chosen(&response, Role::Button, self.is_chosen, called);
        let is_near = ui.rect_contains_pointer(rect) || response.has_focus();
        if self.is_chosen {
            ui.painter().rect_filled(rect, 6.0, theme::accent_ground());
        } else if is_near {
            ui.painter().rect_filled(rect, 6.0, theme::raised());
        }
        let inner = rect.shrink(tiling.margin);
        let (picture, text) = match tiling.list {
            Some(width) => inner.split_left_right_at_x(inner.left() + width),
            None => rect.split_top_bottom_at_y(rect.bottom() - tiling.name),
        };
        let picture = picture.intersect(inner);
        picture_ui(ui, picture, self.picture);
        if self.is_faulty && self.picture.is_none() {
            let (font, ink) = (FontId::proportional(18.0), theme::red());
            let at = picture.center();
            ui.painter().text(at, Align2::CENTER_CENTER, "!", font, ink);
        }
        let corner = if tiling.list.is_some() {
            self.text_ui(ui, text.with_min_x(text.left() + theme::GAP));
            rect.right_top() + vec2(-STAR - 2.0, 3.0)
        } else {
            self.name_ui(ui, text.intersect(rect.shrink2(vec2(tiling.margin, 0.0))));
            picture.right_top() - vec2(STAR, 0.0)
        };
        let star = Rect::from_min_size(corner, Vec2::splat(STAR));
        let star = self.star_ui(ui, star, is_near, tiling.list.is_none());
        [response, star]
    }

    fn ink(&self) -> egui::Color32 {
        if self.is_faulty {
            theme::red()
        } else {
            theme::text_strong()
        }
    }

    /// Name and description beside the picture.
    fn text_ui(&self, ui: &Ui, rect: Rect) {
        let (name, about) = rect.split_top_bottom_at_y(rect.top() + 20.0);
        self.name_ui(ui, name.with_max_x(name.right() - STAR));
        let ink = if self.is_chosen {
            theme::text()
        } else {
            theme::text_weak()
        };
        let galley = short_galley(ui, &self.about, (11.5, ink), rect.width(), 2);
        ui.painter_at(rect).galley(about.min, galley, ink);
    }

    /// The name in one line, and a dot for unsaved changes.
    fn name_ui(&self, ui: &Ui, rect: Rect) {
        let dot = if self.is_modified { 12.0 } else { 0.0 };
        let painter = ui.painter_at(rect);
        let name = short_galley(ui, &self.name, (13.0, self.ink()), rect.width() - dot, 1);
        let (end, middle) = (rect.left() + name.size().x, rect.center().y);
        if self.is_modified {
            painter.circle_filled(pos2(end + 7.0, middle), 3.0, theme::accent());
        }
        let top = middle - name.size().y / 2.0;
        painter.galley(pos2(rect.left(), top), name, self.ink());
    }

    /// The star of a favorite, or a faint one to click while the pointer is near.
    fn star_ui(&self, ui: &Ui, rect: Rect, is_near: bool, is_over_picture: bool) -> Response {
        let id = egui::Id::unique(("star", self.kind, self.id));
        let response = ui.interact(rect, id, Sense::click());
        let of = match self.kind {
            "Effect" => "effect ",
            _ => "",
        };
        let name = format!("Favorite {of}{}", self.title);
        describe_chosen(&response, Role::CheckBox, self.is_favorite, name);
        if self.is_favorite || is_near || response.has_focus() {
            if is_over_picture {
                let ground = theme::panel().gamma_multiply(0.75);
                let radius = STAR / 2.0 - 1.0;
                ui.painter().circle_filled(rect.center(), radius, ground);
            }
            let (icon, ink) = match (self.is_favorite, response.hovered()) {
                (true, _) => (Icon::StarFull, theme::amber()),
                (false, true) => (Icon::Star, theme::text_strong()),
                (false, false) => (Icon::Star, theme::text()),
            };
            paint(ui.painter(), icon, rect.shrink(4.5), ink);
        }
        response.on_hover_text(if self.is_favorite {
            "Remove it from the favorites"
        } else {
            "Make it a favorite"
        })
    }
}

/// Text in at most so many lines, which ends with … where it is longer.
pub fn short_galley(
    ui: &Ui,
    text: &str,
    (size, ink): (f32, egui::Color32),
    width: f32,
    lines: usize,
) -> std::sync::Arc<egui::Galley> {
    let format = egui::TextFormat::simple(FontId::proportional(size), ink);
    let mut job = LayoutJob::single_section(text.replace('\n', " "), format);
    job.wrap = egui::text::TextWrapping {
        max_width: width.max(8.0),
        max_rows: lines,
        break_anywhere: lines == 1,
        overflow_character: Some('…'),
    };
    ui.painter().layout_job(job)
}
