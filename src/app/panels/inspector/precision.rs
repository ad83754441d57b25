//! The largest f32 error of an effect, below its parameters; a click marks where it is.

use std::sync::Arc;

use egui::{self, Ui};

use crate::{
    app::{
        picture::apply::mark,
        picture::{command::Marker, precision::Error},
        shell::{command::Commands, state::State},
        widgets::theme,
    },
    effect_files::{Quantity, has_f32_error},
    effects::Effect,
};

/// Shows what is known of the errors of `effect`; nothing where no function can be measured.
pub fn precision_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>) {
    if !has_f32_error(effect) {
        return;
    }
    // Flush with the labels of the parameters.
    ui.horizontal(|ui| {
        ui.add_space(theme::GAP);
        ui.vertical(|ui| errors_ui(ui, state, commands, effect));
    });
}

fn errors_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>) {
    let requested = state.picture.screen.requested();
    let Some(measured) = state.picture.precision.of(requested) else {
        let text = if state.picture.precision.has_failed(requested) {
            "f32 error: not measured, see the log"
        } else if state.picture.precision.is_running() {
            "f32 error: measuring"
        } else {
            "f32 error: measured at rest"
        };
        ui.label(theme::small(text));
        return;
    };
    let found = measured.effects.iter().find(|(known, _)| known == effect);
    let Some((_, found)) = found else {
        ui.label(theme::small("f32 error: not measured here"))
            .on_hover_text("This picture does not call the effect's function: nothing that it acts on is seen, or the light of the scene takes its place.");
        return;
    };
    let [width, height] = measured.size;
    let about = format!(
        "The effect's text in f32 against f64, on the oracle's picture of {width}x{height} pixels."
    );
    if found.is_empty() {
        ui.label(theme::small("f32 error: none"))
            .on_hover_text(&about);
    }
    for error in found {
        let text = match error.quantity {
            Quantity::Reach => words(error),
            _ => format!("f32 error: {}", words(error)),
        };
        let [x, y] = error.uv.unwrap_or_default();
        let place = match error.uv {
            Some(_) => format!(
                "It is largest at {:.0}, {:.0}. Click to mark the place.",
                x * f64::from(width),
                y * f64::from(height)
            ),
            None => "The place lies outside the picture.".into(),
        };
        let button = egui::Button::new(theme::small(&text)).frame(false).small();
        let button = ui.add_enabled(error.uv.is_some(), button);
        if button
            .on_hover_text(format!("{about} {place}"))
            .accessible_name(&text)
            .clicked()
            && let Some(of) = requested
        {
            let marker = Marker {
                of: of.clone(),
                uv: [x as f32, y as f32],
                text: format!("{}: {}", effect.name, words(error)),
            };
            commands.run(|app| mark(&mut app.state, Some(marker)));
        }
    }
}

/// `0.02 of 255`.
fn words(error: &Error) -> String {
    if error.quantity == Quantity::Reach {
        return format!(
            "moves a vertex {:.2} times as far as its @unit(m) add up to",
            error.error
        );
    }
    let number = match error.error {
        error if error.is_infinite() => return "f32 is not finite, f64 is".into(),
        error if error >= 0.01 => format!("{error:.2}"),
        error => format!("{error:.1e}"),
    };
    match error.quantity {
        Quantity::Color => format!("{number} of 255"),
        Quantity::Normal => format!("{number} in the normal"),
        Quantity::Vertex => format!("{number} m"),
        _ => "a sample is decided otherwise".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_said_in_its_unit() {
        let said = |quantity, error| {
            words(&Error {
                quantity,
                error,
                uv: None,
            })
        };
        assert_eq!(said(Quantity::Color, 1.5), "1.50 of 255");
        assert_eq!(said(Quantity::Color, 0.000_123), "1.2e-4 of 255");
        assert_eq!(said(Quantity::Vertex, 3.1e-7), "3.1e-7 m");
        assert_eq!(
            said(Quantity::Color, f64::INFINITY),
            "f32 is not finite, f64 is"
        );
    }
}
