//! The window Sweep: one or two parameters through several steps each, as a contact sheet; a click
//! on a picture takes its values.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use egui::{self, RichText, Sense, Ui, vec2};

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::apply::set_values,
        files::{apply::ask_path, command::Purpose},
        picture::{
            cells::{self, CellOf, CellResult, Cells},
            screen::Inputs,
        },
        shell::{command::Commands, state::State},
        widgets::{
            form::{field_ui, form_ui, menu_ui, number_ui},
            panel::{describe, main_button, picture_ui, window},
            theme,
        },
    },
    contact_sheet::{ContactSheet, Picture},
    params::{Field, ValueType},
    preset::Preset,
    preset_file::sweep::{Cell, Sheet, Variation},
};

/// Most steps of one parameter.
const MAX_STEPS: usize = 9;

/// The whole sheet is at most this wide, points.
const WIDTH: f32 = 760.0;

/// A parameter that is varied.
#[derive(Clone, Debug, PartialEq)]
struct Varied {
    /// `facet.amount`.
    path: String,
    ends: [f64; 2],
    steps: usize,
}

/// A sheet that has been asked for.
struct Drawn {
    number: u64,
    columns: usize,
    cells: Vec<DrawnCell>,
    /// The picture whose values were varied.
    of: Box<Preset>,
    is_canceled: Arc<AtomicBool>,
}

struct DrawnCell {
    caption: String,
    /// Path and value of each parameter.
    values: Vec<(String, String)>,
    picture: Option<Result<egui::TextureHandle, String>>,
    /// The same, for the sheet that is saved.
    image: Option<egui::ColorImage>,
}

/// The window Sweep.
#[derive(Default)]
pub struct SweepPanel {
    is_open: bool,
    /// The parameter along the rows, and the one from row to row.
    varied: [Option<Varied>; 2],
    drawn: Option<Drawn>,
    sheets: u64,
    error: Option<String>,
}

/// The parameters of the enabled effects that can be varied: single numbers, words and flags.
fn parameters(preset: &Preset) -> Vec<(String, Arc<Field>)> {
    let is_single = |field: &&Arc<Field>| field.value_type.components() == 1;
    let of_stack = preset.stack.0.iter().flat_map(|enabled| {
        let fields = enabled
            .effect
            .fields
            .iter()
            .filter(is_single)
            .filter(|field| field.is_shown(&enabled.effect.fields, &enabled.words));
        fields.map(|field| {
            (
                format!("{}.{}", enabled.effect.name, field.name),
                field.clone(),
            )
        })
    });
    of_stack.collect()
}

impl Varied {
    fn new(path: &str, field: &Field) -> Self {
        Self {
            path: path.into(),
            ends: field.soft,
            steps: 5,
        }
    }

    /// Its values: every word of a choice, both of a flag, or the steps from end to end.
    fn variation(&self, field: &Field) -> Variation {
        let words = |values: Vec<String>| Variation {
            path: self.path.clone(),
            values,
        };
        match &field.value_type {
            ValueType::Bool => words(vec!["false".into(), "true".into()]),
            ValueType::Choice(choices) => words(choices.clone()),
            ValueType::U32 | ValueType::I32 => {
                let mut variation = Variation::range(&self.path, self.ends, self.steps);
                variation.values.iter_mut().for_each(|value| {
                    *value = value
                        .parse::<f64>()
                        .map_or_else(|_| value.clone(), |v| v.round().to_string())
                });
                variation.values.dedup();
                variation
            }
            _ => Variation::range(&self.path, self.ends, self.steps),
        }
    }
}

impl SweepPanel {
    /// Shows or hides the window.
    pub fn toggle(&mut self) {
        self.is_open = !self.is_open;
        if !self.is_open {
            self.cancel();
        }
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// True while pictures are still to come.
    pub fn is_drawing(&self) -> bool {
        let is_wanted = |drawn: &&Drawn| !drawn.is_canceled.load(Ordering::Relaxed);
        self.drawn
            .as_ref()
            .filter(is_wanted)
            .is_some_and(|drawn| drawn.cells.iter().any(|cell| cell.picture.is_none()))
    }

    /// Number of pictures of the newest sheet that are drawn.
    pub fn pictures(&self) -> usize {
        self.drawn.as_ref().map_or(0, |drawn| {
            drawn
                .cells
                .iter()
                .filter(|cell| matches!(cell.picture, Some(Ok(_))))
                .count()
        })
    }

    /// Takes a picture.
    pub fn take_picture(
        &mut self,
        ctx: &egui::Context,
        (number, index): (u64, usize),
        picture: CellResult,
    ) {
        let Some(drawn) = self.drawn.as_mut().filter(|drawn| drawn.number == number) else {
            return;
        };
        let image = picture.as_ref().ok().cloned();
        let texture = picture.map(|image| {
            ctx.load_texture(
                format!("sweep {index}"),
                image,
                egui::TextureOptions::LINEAR,
            )
        });
        if let Some(cell) = drawn.cells.get_mut(index) {
            (cell.picture, cell.image) = (Some(texture), image);
        }
    }

    /// The newest sheet as one picture; none before all of its pictures that can be drawn are.
    pub fn sheet(&self, of: &str) -> Option<ContactSheet> {
        let drawn = self.drawn.as_ref().filter(|_| !self.is_drawing())?;
        let first = drawn.cells.iter().find_map(|cell| cell.image.as_ref())?;
        let size = first.size.map(|side| side as u32);
        let paths = drawn.cells.first()?.values.iter().map(|(path, _)| &**path);
        let title = format!("{of}: {}", paths.collect::<Vec<_>>().join(", "));
        let mut sheet = ContactSheet::new(&title, drawn.columns, drawn.cells.len(), size);
        for (index, cell) in drawn.cells.iter().enumerate() {
            let color = cell.image.iter().flat_map(|image| &image.pixels);
            let picture = Picture {
                caption: cell.caption.clone(),
                color: color.map(|color| color.to_srgba_unmultiplied()).collect(),
            };
            sheet.put(index, &picture);
        }
        Some(sheet)
    }

    /// Begins to draw a sheet of the picture that is shown.
    fn start(&mut self, state: &State, commands: &Commands, requested: &Inputs) {
        let known = parameters(state.session.preset());
        let field = |varied: &Varied| {
            known
                .iter()
                .find(|(path, _)| *path == varied.path)
                .map(|(_, field)| field)
        };
        let variations: Vec<_> = self
            .varied
            .iter()
            .flatten()
            .filter_map(|varied| Some(varied.variation(field(varied)?)))
            .collect();
        let mut base = state.session.preset_file.clone();
        base.preset = state.session.visible_preset();
        self.cancel();
        let sheet = match Sheet::new(&base, &variations) {
            Ok(sheet) => sheet,
            Err(error) => return self.error = Some(error),
        };
        self.error = None;
        self.sheets += 1;
        let width = (WIDTH / sheet.columns as f32 - theme::GAP).clamp(64.0, 240.0) as u32;
        let size = cells::size(width, [requested.view.width, requested.view.height]);
        let cell = |(index, cell): (usize, &Cell)| {
            let preset = cell.preset_file.preset.clone();
            let stack = preset
                .evaluated_stack()
                .drawn(state.session.length_scale(&preset, size));
            let view = state.session.view_of(preset, &requested.scene, size);
            (
                CellOf::Sweep {
                    number: self.sheets,
                    index,
                },
                Inputs {
                    view,
                    stack,
                    ..requested.clone()
                },
            )
        };
        let is_canceled = Arc::new(AtomicBool::new(false));
        let cells = sheet.cells.iter().enumerate().map(cell).collect();
        let cells = Cells {
            cells,
            is_canceled: is_canceled.clone(),
        };
        commands.run(|app| app.state.draw_cells(cells));
        let captions = sheet.cells.iter().map(|cell| DrawnCell {
            caption: cell.caption(),
            values: cell.values.clone(),
            picture: None,
            image: None,
        });
        let of = Box::new(base.preset);
        self.drawn = Some(Drawn {
            number: self.sheets,
            columns: sheet.columns,
            cells: captions.collect(),
            of,
            is_canceled,
        });
    }

    fn cancel(&mut self) {
        if let Some(drawn) = &self.drawn {
            drawn.is_canceled.store(true, Ordering::Relaxed);
        }
    }

    /// The parameters, and the button.
    fn start_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let known = parameters(state.session.preset());
        let is_known = |varied: &Varied| known.iter().any(|(path, _)| *path == varied.path);
        self.varied
            .iter_mut()
            .for_each(|varied| *varied = varied.take().filter(is_known));
        if self.varied[0].is_none() {
            self.varied[0] = self.varied[1]
                .take()
                .or_else(|| known.first().map(|(path, field)| Varied::new(path, field)));
        }
        if known.is_empty() {
            ui.label(theme::weak(
                "No effect with parameters is enabled, so there is nothing to vary.",
            ));
            return;
        }
        form_ui(ui, "varied", |ui| {
            for (name, varied) in VARIED.into_iter().zip(&mut self.varied) {
                field_ui(ui, name, "", |ui| varied_ui(ui, name, varied, &known));
            }
        });
        ui.horizontal(|ui| {
            let requested = state.picture.screen.requested();
            let button = main_button("Draw the sheet");
            let is_clicked = ui.add_enabled(requested.is_some(), button).clicked();
            if let Some(requested) = requested.filter(|_| is_clicked) {
                self.start(state, commands, requested);
            }
            if self.is_drawing() {
                if ui
                    .button("Stop")
                    .on_hover_text("Keep the pictures that are drawn")
                    .clicked()
                {
                    self.cancel();
                }
                ui.label(theme::weak(format!(
                    "{} of {}",
                    self.pictures(),
                    self.drawn.as_ref().map_or(0, |drawn| drawn.cells.len())
                )));
            } else if cfg!(not(target_arch = "wasm32"))
                && self.pictures() > 0
                && ui.button("Save sheet…").clicked()
            {
                commands.run(|app| ask_path(app, Purpose::Sheet));
            }
        });
        if let Some(error) = &self.error {
            theme::notice(ui, theme::red(), error);
        }
    }
}

/// Where the first and the second parameter change.
const VARIED: [&str; 2] = ["along the rows", "from row to row"];

/// The choice of a parameter, with its ends and the number of steps.
fn varied_ui(ui: &mut Ui, name: &str, varied: &mut Option<Varied>, known: &[(String, Arc<Field>)]) {
    let now = varied
        .as_ref()
        .map_or("none", |varied| &varied.path)
        .to_owned();
    let none = (name != VARIED[0]).then(|| (String::new(), "none".to_owned(), ""));
    let paths = known
        .iter()
        .map(|(path, _)| (path.clone(), path.clone(), ""));
    let chosen = varied
        .as_ref()
        .map_or_else(String::new, |varied| varied.path.clone());
    let offers = none.into_iter().chain(paths);
    let name = format!("Parameter {name}");
    if let (Some(path), _) = menu_ui(ui, &name, (&now, 190.0), Some(&chosen), offers) {
        let found = known.iter().find(|(known, _)| *known == path);
        *varied = found.map(|(path, field)| Varied::new(path, field));
    }
    let Some(varied) = varied else { return };
    let Some((_, field)) = known.iter().find(|(path, _)| *path == varied.path) else {
        return;
    };
    if matches!(field.value_type, ValueType::Bool | ValueType::Choice(_)) {
        ui.label(theme::weak("every value"));
        return;
    }
    let ([low, high], path) = (field.hard, &varied.path);
    let speed = (field.soft[1] - field.soft[0]) / 300.0;
    for (end, name) in varied.ends.iter_mut().zip(["from", "to"]) {
        ui.label(theme::weak(name));
        number_ui(
            ui,
            &format!("{name} of {path}"),
            end,
            low..=high,
            (speed, ""),
        );
        if !field.value_type.is_continuous() {
            *end = end.round();
        }
    }
    let (steps, name) = (&mut varied.steps, format!("Steps of {path}"));
    number_ui(ui, &name, steps, 2..=MAX_STEPS, (0.05, " steps"));
}

impl Panel for SweepPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !self.is_open {
            return;
        }
        let mut is_open = true;
        let area = ui.ctx().content_rect();
        window("Sweep", &mut is_open)
            .default_pos(area.left_top() + vec2(280.0, 72.0))
            .show(ui.ctx(), |ui| {
                ui.set_width(WIDTH.min(area.width() - 48.0));
                self.start_ui(ui, state, commands);
                if let Some(drawn) = &self.drawn {
                    sheet_ui(
                        ui,
                        drawn,
                        state,
                        commands,
                        (area.height() - 260.0).max(160.0),
                    );
                }
            });
        self.is_open = is_open;
        if !is_open {
            self.cancel();
        }
    }
}

fn sheet_ui(ui: &mut Ui, drawn: &Drawn, state: &State, commands: &Commands, height: f32) {
    ui.add_space(theme::HALF);
    if *drawn.of != state.session.visible_preset() {
        ui.label(
            RichText::new("Drawn from an earlier picture, or a picture of the sheet was taken")
                .size(11.0)
                .color(theme::amber()),
        );
    }
    let aspect = drawn
        .cells
        .iter()
        .find_map(|cell| cell.picture.as_ref()?.as_ref().ok())
        .map_or(0.625, |texture| texture.aspect_ratio().recip());
    let width = (ui.available_width() / drawn.columns as f32 - theme::GAP).min(240.0);
    egui::ScrollArea::both()
        .id_salt("sheet")
        .max_height(height)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            egui::Grid::new("sheet")
                .spacing([theme::GAP, theme::GAP])
                .show(ui, |ui| {
                    for (index, cell) in drawn.cells.iter().enumerate() {
                        if cell_ui(ui, cell, vec2(width, width * aspect)).clicked() {
                            let values = cell.values.clone();
                            commands.step(move |app| set_values(&mut app.state, &values));
                        }
                        if (index + 1) % drawn.columns == 0 {
                            ui.end_row();
                        }
                    }
                });
        });
}

fn cell_ui(ui: &mut Ui, cell: &DrawnCell, size: egui::Vec2) -> egui::Response {
    ui.vertical(|ui| {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let picture = cell.picture.as_ref();
        picture_ui(ui, rect, picture.and_then(|picture| picture.as_ref().ok()));
        if response.hovered() || response.has_focus() {
            let edge = (2.0, theme::accent());
            ui.painter()
                .rect_stroke(rect, 4.0, edge, egui::StrokeKind::Inside);
            ui.set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        let caption = RichText::new(&cell.caption).size(11.0).color(theme::text());
        ui.add_sized([size.x, 14.0], egui::Label::new(caption).truncate());
        let name = format!("Take {}", cell.caption);
        describe(&response, egui::Role::Button, name.as_str());
        match picture {
            Some(Err(error)) => response.on_hover_text(error),
            _ => response.on_hover_text(name),
        }
    })
    .inner
}
