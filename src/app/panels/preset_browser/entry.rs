//! An entry of the gallery, as a row of the list or a tile of the grid: thumbnail, name, star, and
//! what the preset shows.

use eframe::egui::{self, Align2, FontId, Pos2, Rect, Response, RichText, Sense, Ui, pos2, vec2};

use crate::{
    app::{
        picture::effect_picture,
        settings::browsing::Layout,
        widgets::{
            icons::{Icon, paint},
            theme,
        },
    },
    preset_file::{GalleryEntry, Origin},
};

/// Size of a thumbnail in the list, points.
const THUMBNAIL: egui::Vec2 = vec2(
    effect_picture::THUMBNAIL[0] as f32 / 2.0,
    effect_picture::THUMBNAIL[1] as f32 / 2.0,
);
/// Least width of a tile, points, and the height of its name.
const TILE: f32 = 104.0;
const NAME: f32 = 22.0;
/// Side of the star, points.
const STAR: f32 = 20.0;

/// What is shown of an entry.
pub struct Shown<'a> {
    pub entry: &'a GalleryEntry,
    pub picture: Option<&'a egui::TextureHandle>,
    pub is_open: bool,
    pub is_modified: bool,
    pub is_favorite: bool,
}

/// The entry, and its star.
pub struct Responses {
    pub entry: Response,
    pub star: Response,
}

impl Shown<'_> {
    fn about(&self) -> String {
        match &self.entry.preset_file {
            Ok(preset_file) => preset_file.preset.about.clone(),
            Err(error) => error.to_string(),
        }
    }

    fn color(&self) -> egui::Color32 {
        if self.entry.preset_file.is_ok() {
            theme::text_strong()
        } else {
            theme::red()
        }
    }
}

/// Size of an entry in a gallery that is `width` points wide, and how many stand side by side.
pub fn entry_size(layout: Layout, width: f32) -> (egui::Vec2, usize) {
    match layout {
        Layout::List => (vec2(width, THUMBNAIL.y + 8.0), 1),
        Layout::Grid => {
            let columns = ((width + theme::GAP) / (TILE + theme::GAP))
                .floor()
                .max(1.0);
            let tile = (width - (columns - 1.0) * theme::GAP) / columns;
            (
                vec2(tile, (tile - 8.0) * THUMBNAIL.y / THUMBNAIL.x + NAME + 8.0),
                columns as usize,
            )
        }
    }
}

/// Shows an entry in `rect`.
pub fn entry_ui(ui: &mut Ui, shown: &Shown<'_>, layout: Layout, rect: Rect) -> Responses {
    let id = egui::Id::unique(("preset", &shown.entry.id));
    let response = ui.interact(rect, id, Sense::click());
    let name = shown.entry.title();
    response.widget_info(|| {
        egui::WidgetInfo::selected(
            egui::Role::Button,
            true,
            shown.is_open,
            format!("Preset {name}"),
        )
    });
    let is_near = ui.rect_contains_pointer(rect) || response.has_focus();
    if shown.is_open {
        ui.painter().rect_filled(rect, 6.0, theme::accent_ground());
    } else if is_near {
        ui.painter().rect_filled(rect, 6.0, theme::raised());
    }
    let picture = match layout {
        Layout::List => Rect::from_min_size(rect.min + vec2(4.0, 4.0), THUMBNAIL),
        Layout::Grid => {
            Rect::from_min_max(rect.min + vec2(4.0, 4.0), rect.max - vec2(4.0, NAME + 4.0))
        }
    };
    picture_ui(ui, shown, picture);
    let star_rect = match layout {
        Layout::List => Rect::from_min_size(
            pos2(rect.right() - STAR - 2.0, rect.top() + 3.0),
            vec2(STAR, STAR),
        ),
        Layout::Grid => Rect::from_min_size(
            pos2(picture.right() - STAR, picture.top()),
            vec2(STAR, STAR),
        ),
    };
    match layout {
        Layout::List => text_ui(
            ui,
            shown,
            Rect::from_min_max(
                pos2(picture.right() + 8.0, picture.top()),
                rect.max - vec2(6.0, 4.0),
            ),
        ),
        Layout::Grid => name_ui(
            ui,
            shown,
            Rect::from_min_max(
                pos2(picture.left(), picture.bottom()),
                rect.max - vec2(4.0, 2.0),
            ),
        ),
    }
    let star = star_ui(ui, shown, star_rect, is_near, layout == Layout::Grid);
    let about = shown.about();
    let entry = response.on_hover_ui(|ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(name).color(theme::text_strong()));
            ui.label(theme::weak(&shown.entry.id));
        });
        ui.label(&about);
        if let Ok(found) = &shown.entry.preset_file {
            let effects: Vec<&str> = found
                .preset
                .stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.as_str())
                .collect();
            ui.label(theme::weak(format!(
                "Effects: {}",
                if effects.is_empty() {
                    "none".into()
                } else {
                    effects.join(", ")
                }
            )));
            if !found.preset.tags.is_empty() {
                ui.label(theme::weak(format!(
                    "Tags: {}",
                    found.preset.tags.join(", ")
                )));
            }
        }
        ui.label(theme::weak(source_text(shown.entry)));
    });
    Responses { entry, star }
}

fn picture_ui(ui: &Ui, shown: &Shown<'_>, rect: Rect) {
    match shown.picture {
        Some(picture) => {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            egui::Image::from_texture((picture.id(), rect.size()))
                .uv(whole)
                .corner_radius(4.0)
                .paint_at(ui, rect);
        }
        None => drop(ui.painter().rect_filled(rect, 4.0, theme::raised())),
    }
    if shown.entry.preset_file.is_err() && shown.picture.is_none() {
        ui.painter().text(
            rect.center(),
            Align2::CENTER_CENTER,
            "!",
            FontId::proportional(18.0),
            theme::red(),
        );
    }
}

/// Name and description beside the thumbnail.
fn text_ui(ui: &Ui, shown: &Shown<'_>, rect: Rect) {
    let name = Rect::from_min_max(rect.min, pos2(rect.right() - STAR, rect.top() + 20.0));
    name_ui(ui, shown, name);
    let ink = if shown.is_open {
        theme::text()
    } else {
        theme::text_weak()
    };
    let format = egui::TextFormat::simple(FontId::proportional(11.5), ink);
    let mut job = egui::text::LayoutJob::single_section(shown.about(), format);
    job.wrap = egui::text::TextWrapping {
        max_width: rect.width(),
        max_rows: 2,
        break_anywhere: false,
        overflow_character: Some('…'),
    };
    let painter = ui.painter_at(rect);
    painter.galley(rect.min + vec2(0.0, 20.0), painter.layout_job(job), ink);
}

/// The name, in one line, and a dot for unsaved changes.
fn name_ui(ui: &Ui, shown: &Shown<'_>, rect: Rect) {
    let dot = if shown.is_modified { 12.0 } else { 0.0 };
    let format = egui::TextFormat::simple(FontId::proportional(13.0), shown.color());
    let mut job = egui::text::LayoutJob::single_section(shown.entry.title().to_owned(), format);
    job.wrap = egui::text::TextWrapping {
        max_width: rect.width() - dot,
        max_rows: 1,
        break_anywhere: true,
        overflow_character: Some('…'),
    };
    let painter = ui.painter_at(rect);
    let name = painter.layout_job(job);
    let top = rect.center().y - name.size().y / 2.0;
    if shown.is_modified {
        painter.circle_filled(
            pos2(rect.left() + name.size().x + 7.0, rect.center().y),
            3.0,
            theme::accent(),
        );
    }
    painter.galley(pos2(rect.left(), top), name, shown.color());
}

/// The star of a favorite, or a faint one to click while the pointer is near.
fn star_ui(
    ui: &Ui,
    shown: &Shown<'_>,
    rect: Rect,
    is_near: bool,
    is_over_picture: bool,
) -> Response {
    let response = ui.interact(
        rect,
        egui::Id::unique(("star", &shown.entry.id)),
        Sense::click(),
    );
    let name = format!("Favorite {}", shown.entry.title());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::CheckBox, true, shown.is_favorite, &name)
    });
    let is_seen = shown.is_favorite || is_near || response.has_focus();
    if is_seen && is_over_picture {
        ui.painter().circle_filled(
            rect.center(),
            STAR / 2.0 - 1.0,
            theme::panel().gamma_multiply(0.75),
        );
    }
    if is_seen {
        let icon = if shown.is_favorite {
            Icon::StarFull
        } else {
            Icon::Star
        };
        let ink = match (shown.is_favorite, response.hovered()) {
            (true, _) => theme::amber(),
            (false, true) => theme::text_strong(),
            (false, false) => theme::text(),
        };
        paint(
            ui.painter(),
            icon,
            Rect::from_center_size(rect.center(), vec2(11.0, 11.0)),
            ink,
        );
    }
    response.on_hover_text(if shown.is_favorite {
        "Remove it from the favorites"
    } else {
        "Make it a favorite"
    })
}

/// Where the preset comes from.
fn source_text(entry: &GalleryEntry) -> String {
    let source = match (&entry.path, entry.origin) {
        (Some(path), _) => path.display().to_string(),
        (None, Origin::Builtin) => "Built in".into(),
        (None, _) => String::new(),
    };
    if entry.shadows.is_empty() {
        source
    } else {
        format!("{source}; hides {} of the same name", entry.shadows.len())
    }
}
