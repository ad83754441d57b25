//! Taking in what jobs have finished that threads do in one way, and a page in another.

use egui::ColorImage;

use crate::app::{
    App,
    files::scene_loader::SceneKey,
    picture::{golden_check::GoldenCheck, precision::Measured, screen::Inputs},
    shell::log::Level,
    trade::point::Point,
};

/// Takes measured combinations of accuracy options.
pub fn take_trade(app: &mut App, points: Result<Vec<Point>, String>) {
    let timed = points.as_ref().map_or(0, |points| {
        points.iter().filter(|point| point.ms.is_some()).count()
    });
    let log = &mut app.state.log;
    match app.panels.trade.take_points(points) {
        Some(error) => log.add(Level::Error, error),
        None if timed > 0 => log.add(
            Level::Info,
            format!("Trade: combinations measured: {timed}"),
        ),
        None => {}
    }
}

/// Takes the thumbnail of a preset.
pub fn take_thumbnail(app: &mut App, id: &str, image: Option<ColorImage>) {
    app.panels
        .browser
        .pictures
        .take_picture(&app.ctx, id, image);
}

/// Takes the thumbnail of a preset on the user's own scene.
pub fn take_thumbnail_on(app: &mut App, key: &SceneKey, id: &str, image: Option<ColorImage>) {
    let pictures = &mut app.panels.browser.pictures;
    pictures.on_model_arrived(&app.ctx, key, id, image);
}

/// Takes the picture of an effect on the open model; none if it was canceled or cannot be drawn.
pub fn take_effect_picture(app: &mut App, effect: &str, image: Option<ColorImage>) {
    let effects = &mut app.panels.browser.effects;
    effects.picture_arrived(&app.ctx, effect, image);
}

/// Takes the f32 errors of the effects in a picture; none if the measurement was canceled.
pub fn take_precision(app: &mut App, of: Inputs, measured: Result<Option<Box<Measured>>, String>) {
    if let Some(error) = app.state.picture.precision.take_errors(of, measured) {
        app.state.log.add(Level::Error, error);
    }
}

/// Takes the golden of a preset, compared again, by the number of its request; none if the preset
/// has no golden.
pub fn take_golden(app: &mut App, number: u64, check: Option<GoldenCheck>) {
    let live = &mut app.state.files.live;
    if live.checking_golden == Some(number) {
        (live.checking_golden, live.golden) = (None, check);
    }
}

/// Puts a link to a page on the clipboard; `why` it does not carry the bits of its picture, if it
/// does not.
pub fn take_link(app: &mut App, link: String, why: Option<String>) {
    app.ctx.copy_text(link);
    let why = why.map_or_else(String::new, |why| {
        format!("; its picture is judged there, but not bit by bit: {why}")
    });
    app.notify(Level::Info, format!("Copied the link to a page{why}"));
}
