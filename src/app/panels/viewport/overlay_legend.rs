//! The legend of the overlays: what each shows and on how many pixels. An overlay that paints
//! nothing has no line.

use egui::{self, Color32, Pos2, Rect, RichText, Ui, pos2, vec2};

use crate::{
    app::{
        picture::{
            findings::Findings,
            overlay::{Overlay, OverlaySelection},
        },
        shell::{action::Action, command::Commands, state::State},
        widgets::{icons::swatch, text::group_digits, theme},
    },
    effect_files::Crossing,
    effects::Stack,
    preset_file::toml_value,
};

/// Height of a line, and the space round all of them, points.
const LINE: f32 = 18.0;
const MARGIN: f32 = 8.0;

/// A line of the legend; a sentence has no swatch.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    swatch: Option<Color32>,
    text: String,
    color: Color32,
}

impl Line {
    fn sentence(color: Color32, text: impl Into<String>) -> Self {
        Self {
            swatch: None,
            text: text.into(),
            color,
        }
    }
}

/// The lines on a picture that was judged.
fn lines(overlays: &OverlaySelection, found: &Findings, stack: &Stack) -> Vec<Line> {
    let shown: Vec<Overlay> = Overlay::listed()
        .filter(|overlay| overlays.contains(*overlay))
        .collect();
    let mut lines: Vec<Line> = shown
        .iter()
        .filter(|overlay| found.count(**overlay) > 0)
        .map(|o| line(*o, overlays.gain, found))
        .collect();
    if overlays.contains(Overlay::Unsound) {
        let crossed = found.crossed();
        lines.extend(crossed.iter().map(|(crossing, count)| {
            Line::sentence(
                theme::text_strong(),
                format!(
                    "    {} px: {}",
                    group_digits(*count),
                    crossing_text(crossing, stack)
                ),
            )
        }));
    }
    let errors: Vec<Overlay> = shown
        .into_iter()
        .filter(|overlay| overlay.is_error())
        .collect();
    let pixels = group_digits(found.faults.pixels() as u64);
    if !errors.is_empty() && errors.iter().all(|overlay| found.count(*overlay) == 0) {
        let what = if let [one] = errors[..] {
            format!("no {}", one.name().to_lowercase())
        } else {
            "no errors".into()
        };
        lines.push(Line::sentence(
            theme::green(),
            format!("{what}: 0 of {pixels} pixels"),
        ));
    } else if lines.is_empty() {
        lines.push(Line::sentence(
            theme::text(),
            format!("nothing to show in {pixels} pixels"),
        ));
    }
    lines
}

/// `facet made NaN, amount = 2.0`.
fn crossing_text(crossing: &Crossing, stack: &Stack) -> String {
    let Crossing {
        effect,
        made,
        parameter,
        only_f32,
        ..
    } = crossing;
    let side = if *only_f32 { " in f32" } else { "" };
    let value = parameter
        .as_ref()
        .zip(stack.get(&effect.name))
        .map(|(field, enabled)| {
            let value = toml_value::write_text(&field.value_type, &field.value(&enabled.words));
            format!(", {} = {value}", field.name)
        });
    format!(
        "{} made {}{side}{}",
        effect.name,
        made.word(),
        value.unwrap_or_default()
    )
}

/// The line of one overlay.
fn line(overlay: Overlay, gain: u8, found: &Findings) -> Line {
    let (name, count) = (
        overlay.name().to_lowercase(),
        group_digits(found.count(overlay)),
    );
    let text = match overlay {
        Overlay::Color => {
            let max = found.faults.color_delta.iter().max().copied().unwrap_or(0);
            format!("{name} × {gain}: {count} px, at most {max} of 255")
        }
        Overlay::Layers => format!(
            "{name}: up to {}",
            found.layers.iter().max().copied().unwrap_or(0)
        ),
        Overlay::TriangleIds => format!("{name}: {count} px are covered"),
        Overlay::Unsound => format!("{}: {count} px", overlay.name()),
        _ => format!("{name}: {count} px"),
    };
    Line {
        swatch: Some(overlay.color()),
        text,
        color: theme::text_strong(),
    }
}

/// The judged pixel at `pointer` over the picture at `at`, while it is whole.
pub fn judged_pixel(state: &State, at: Rect, pointer: Pos2) -> Option<[u32; 2]> {
    let found = state
        .picture
        .findings()
        .filter(|_| state.picture.screen.divisor() == 1 && at.contains(pointer))?;
    let uv = (pointer - at.min) / at.size();
    let place = |t: f32, side: u32| ((t * side as f32) as u32).min(side.saturating_sub(1));
    Some([place(uv.x, found.size[0]), place(uv.y, found.size[1])])
}

/// What is known of the pixel under the pointer.
fn hovered_line(ui: &Ui, state: &State, at: Rect) -> Option<Line> {
    let pointer = ui
        .input(|i| i.pointer.hover_pos())
        .filter(|_| ui.rect_contains_pointer(at))?;
    let [x, y] = judged_pixel(state, at, pointer)?;
    let found = state.picture.findings()?;
    let i = (y * found.size[0] + x) as usize;
    let crossing = found
        .crossing(i)
        .filter(|_| state.picture.overlays.contains(Overlay::Unsound));
    let crossing = crossing.map_or(String::new(), |crossing| {
        format!(
            ", {}",
            crossing_text(crossing, &state.session.visible_stack())
        )
    });
    // A click on the pixel is taken by the probe.
    let why = found.geometry.as_ref().map_or("", |_| "; click: why");
    Some(Line::sentence(
        theme::text_weak(),
        format!("{x}, {y}: {}{crossing}{why}", found.pixel_text(i)),
    ))
}

/// Shows the legend at the lower left of `free`; the picture is at `at`. Returns what of `free` it
/// does not cover.
pub fn legend_ui(
    ui: &mut Ui,
    state: &State,
    (free, at): (Rect, Rect),
    commands: &Commands,
) -> Rect {
    if !state.picture.overlays.is_any() || state.picture.screen.picture().is_none() {
        return free;
    }
    let mut lines = match state.picture.findings() {
        Some(found) if state.picture.screen.divisor() == 1 => lines(
            &state.picture.overlays,
            found,
            &state.session.visible_stack(),
        ),
        _ if state.picture.verification.is_running() => vec![Line::sentence(
            theme::text(),
            "Comparing this picture with the oracle",
        )],
        _ if state.picture.overlays_are_ready() => vec![Line::sentence(
            theme::red(),
            "This picture could not be verified. See the log.",
        )],
        _ => vec![Line::sentence(
            theme::text_weak(),
            "Overlays appear when the picture is at rest",
        )],
    };
    let painted = state.picture.findings().map_or(0, |found| {
        let shown = state.picture.overlays.shown().iter();
        let doubts = shown.filter(|overlay| overlay.is_doubt() && **overlay != Overlay::Color);
        doubts.map(|overlay| found.count(*overlay)).sum::<u64>()
    });
    lines.extend(hovered_line(ui, state, at));
    let buttons = if painted > 0 { LINE } else { 0.0 };
    let height = lines.len() as f32 * LINE + buttons + 2.0 * MARGIN;
    let plate = Rect::from_min_size(
        pos2(free.left() + 12.0, free.bottom() - 12.0 - height),
        vec2(400.0, height),
    );
    if plate.top() < free.top() + 44.0 || free.width() < 240.0 {
        return free;
    }
    let mut child = ui.new_child(
        egui::UiBuilder::new()
            .id_salt("overlay legend")
            .max_rect(plate),
    );
    let frame =
        theme::toast_frame(theme::line()).inner_margin(egui::Margin::symmetric(10, MARGIN as i8));
    frame.show(&mut child, |ui| {
        ui.spacing_mut().item_spacing = vec2(theme::GAP, 0.0);
        ui.spacing_mut().interact_size.y = LINE;
        for Line {
            swatch: color,
            text,
            color: ink,
        } in &lines
        {
            ui.horizontal(|ui| {
                ui.set_height(LINE);
                if let Some(color) = color {
                    swatch(ui, *color);
                }
                ui.label(RichText::new(text).size(12.0).color(*ink));
            });
        }
        if painted > 0 {
            ui.horizontal(|ui| {
                for (action, text) in [
                    (Action::PreviousPixel, "Previous pixel"),
                    (Action::NextPixel, "Next pixel"),
                ] {
                    let button = ui.add(egui::Button::new(text).small());
                    if button.on_hover_text(action.hint()).clicked() {
                        commands.perform(action);
                    }
                }
            });
        }
    });
    Rect::from_min_max(free.min, pos2(free.right(), plate.top() + 4.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        frame::Frame,
        gpu::Capture,
        measure::{
            Verdict,
            error_map::{ErrorMap, PixelError},
        },
    };

    fn found(marked: &[usize]) -> Findings {
        let picture = [[9; 4]; 6];
        let faults = ErrorMap::new(&picture, &picture, |i| {
            if marked.contains(&i) {
                vec![PixelError::WrongTriangle, PixelError::Hole]
            } else {
                Vec::new()
            }
        });
        let frame = Frame {
            width: 3,
            height: 2,
            triangle_id: vec![0; 6],
            color: picture.to_vec(),
            ..Default::default()
        };
        let capture = Capture {
            frame,
            geometry: Default::default(),
            layers: None,
            previous: None,
            shown: None,
        };
        Findings::new(
            capture,
            Verdict {
                error_map: faults,
                ..Default::default()
            },
            None,
            Vec::new(),
        )
    }

    #[test]
    fn the_legend_names_what_there_is_and_says_so_when_there_is_nothing() {
        let mut overlays = OverlaySelection::default();
        overlays.toggle();
        let only = |overlay: Overlay| {
            let mut overlays = OverlaySelection::default();
            overlays.set(overlay, true);
            overlays
        };
        let text = |overlays: &OverlaySelection, found: &Findings| {
            lines(overlays, found, &Stack::default())
                .into_iter()
                .map(|line| line.text)
                .collect::<Vec<_>>()
        };
        assert_eq!(text(&overlays, &found(&[])), ["no errors: 0 of 6 pixels"]);
        assert_eq!(
            text(&overlays, &found(&[1, 4])),
            ["wrong: 2 px", "holes: 2 px"]
        );
        assert_eq!(
            text(&only(Overlay::WrongDepth), &found(&[1])),
            ["no wrong depth winner: 0 of 6 pixels"]
        );
        assert_eq!(
            text(&only(Overlay::Edges), &found(&[1])),
            ["nothing to show in 6 pixels"]
        );
        assert_eq!(
            text(&only(Overlay::TriangleIds), &found(&[1])),
            ["triangle ids: 6 px are covered"]
        );
    }
}
