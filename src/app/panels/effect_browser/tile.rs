//! A tile of the effect browser: a picture of the effect, its name, and its star.

use std::sync::Arc;

use eframe::egui::{self, Align2, FontId, Pos2, Rect, Response, RichText, Sense, Ui, pos2, vec2};

use crate::{
    app::{
        picture::effect_picture,
        widgets::{
            icons::{Icon, paint},
            theme,
        },
    },
    effects::Effect,
};

/// Least width of a tile, points, and the height of its name.
const TILE: f32 = 72.0;
const NAME: f32 = 20.0;
const STAR: f32 = 18.0;

/// What is shown of an effect.
pub struct Tile<'a> {
    pub effect: &'a Arc<Effect>,
    pub picture: Option<&'a egui::TextureHandle>,
    pub is_enabled: bool,
    /// The effect of the stack that it would replace.
    pub rival: Option<&'a str>,
    pub is_favorite: bool,
}

/// The tile, and its star.
pub struct Responses {
    pub tile: Response,
    pub star: Response,
}

/// Size of a tile in a browser that is `width` points wide, and how many stand side by side.
pub fn tile_size(width: f32) -> (egui::Vec2, usize) {
    let columns = ((width + theme::HALF) / (TILE + theme::HALF))
        .floor()
        .max(1.0);
    let tile = (width - (columns - 1.0) * theme::HALF) / columns;
    let [w, h] = effect_picture::THUMBNAIL.map(|side| side as f32);
    (
        vec2(tile, (tile - 4.0) * h / w + NAME + 2.0),
        columns as usize,
    )
}

/// Shows a tile in `rect`.
pub fn tile_ui(ui: &mut Ui, tile: &Tile<'_>, rect: Rect) -> Responses {
    let name = &tile.effect.name;
    let response = ui.interact(
        rect,
        egui::Id::unique(("effect", name)),
        Sense::click_and_drag(),
    );
    response.widget_info(|| {
        egui::WidgetInfo::selected(
            egui::Role::Button,
            true,
            tile.is_enabled,
            format!("Effect {name}"),
        )
    });
    let is_near = ui.rect_contains_pointer(rect) || response.has_focus();
    if tile.is_enabled {
        ui.painter().rect_filled(rect, 5.0, theme::accent_ground());
    } else if is_near {
        ui.painter().rect_filled(rect, 5.0, theme::raised());
    }
    let picture = Rect::from_min_max(rect.min + vec2(2.0, 2.0), rect.max - vec2(2.0, NAME));
    match tile.picture {
        Some(texture) => {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            egui::Image::from_texture((texture.id(), picture.size()))
                .uv(whole)
                .corner_radius(3.0)
                .paint_at(ui, picture);
        }
        None => drop(ui.painter().rect_filled(picture, 3.0, theme::well())),
    }
    let text = Rect::from_min_max(
        pos2(picture.left() + 2.0, picture.bottom()),
        rect.max - vec2(2.0, 0.0),
    );
    let ink = if tile.is_enabled || is_near {
        theme::text_strong()
    } else {
        theme::text()
    };
    ui.painter_at(text).text(
        text.left_center(),
        Align2::LEFT_CENTER,
        name.replace('_', " "),
        FontId::proportional(12.0),
        ink,
    );
    let star = star_ui(
        ui,
        tile,
        Rect::from_min_size(
            pos2(picture.right() - STAR, picture.top()),
            vec2(STAR, STAR),
        ),
        is_near,
    );
    let response = response.on_hover_ui(|ui| {
        ui.label(RichText::new(name).color(theme::text_strong()));
        ui.label(&tile.effect.about);
        ui.label(theme::weak(format!("Hooks: {}", tile.effect.hooks.names())));
        let action = match (tile.is_enabled, tile.rival) {
            (true, _) => "Click to take it out of the stack".to_owned(),
            (false, Some(rival)) => format!("Click to use it instead of {rival}"),
            (false, None) => "Click to enable it, or drag it to its place in the stack".to_owned(),
        };
        ui.label(theme::weak(action));
    });
    Responses {
        tile: response,
        star,
    }
}

fn star_ui(ui: &Ui, tile: &Tile<'_>, rect: Rect, is_near: bool) -> Response {
    let name = &tile.effect.name;
    let response = ui.interact(
        rect,
        egui::Id::unique(("star of effect", name)),
        Sense::click(),
    );
    response.widget_info(|| {
        egui::WidgetInfo::selected(
            egui::Role::CheckBox,
            true,
            tile.is_favorite,
            format!("Favorite effect {name}"),
        )
    });
    if tile.is_favorite || is_near || response.has_focus() {
        ui.painter().circle_filled(
            rect.center(),
            STAR / 2.0 - 1.0,
            theme::panel().gamma_multiply(0.75),
        );
        let icon = if tile.is_favorite {
            Icon::StarFull
        } else {
            Icon::Star
        };
        let ink = match (tile.is_favorite, response.hovered()) {
            (true, _) => theme::amber(),
            (false, true) => theme::text_strong(),
            (false, false) => theme::text(),
        };
        paint(
            ui.painter(),
            icon,
            Rect::from_center_size(rect.center(), vec2(10.0, 10.0)),
            ink,
        );
    }
    response.on_hover_text(if tile.is_favorite {
        "Remove it from the favorites"
    } else {
        "Make it a favorite"
    })
}
