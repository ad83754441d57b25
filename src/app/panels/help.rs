//! The window Help: the guide, how a problem is reported, and what runs here.

use egui::{
    self, FontId, Grid, ScrollArea, TextFormat, Ui,
    text::{LayoutJob, TextWrapping},
    vec2,
};

use crate::app::{
    panels::panel::Panel,
    shell::{command::Commands, log::Level, state::State},
    widgets::{
        form::words_ui,
        panel::{centered_window, main_button},
        theme,
    },
};

/// What the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Page {
    Guide,
    Report,
    About,
}

/// Pages with their titles. A page of the web has its guide beside it.
const PAGES: [(Page, &str, &str); 3] = [
    (Page::Guide, "Guide", ""),
    (Page::Report, "Report a problem", ""),
    (Page::About, "About", ""),
];

#[cfg(not(target_arch = "wasm32"))]
const GUIDE: &str = include_str!("../../../docs/guide.md");
#[cfg(target_arch = "wasm32")]
const GUIDE: &str = "The guide is docs/guide.md of the project.";

const REPORT: &str = "Say in an issue of the project:\n\n\
    - what you did, what you saw, and what you expected;\n\
    - the details below: version, system and adapter;\n\
    - the preset (*File › Copy preset*), and the model if it may be public;\n\
    - the log (L), if something failed.\n\n\
    What others could use to harm people is reported in private, as *docs/security.md* says.";

const WIDTH: f32 = 640.0;

/// The window Help.
#[derive(Default)]
pub struct HelpWindow(Option<Page>);

impl HelpWindow {
    pub fn show_guide(&mut self) {
        self.0 = Some(Page::Guide);
    }

    pub fn show_report(&mut self) {
        self.0 = Some(Page::Report);
    }

    pub fn show_about(&mut self) {
        self.0 = Some(Page::About);
    }

    pub fn close(&mut self) {
        self.0 = None;
    }

    pub fn is_open(&self) -> bool {
        self.0.is_some()
    }
}

/// Version, system and adapter, a line for each: what a report of a problem needs.
pub fn details(state: &State) -> String {
    let gpu = &state.picture.screen.gpu;
    let summary = &gpu.summary;
    let kind = if summary.software { ", software" } else { "" };
    [
        format!("rasterlab {}", env!("CARGO_PKG_VERSION")),
        format!("system {} {}", std::env::consts::OS, std::env::consts::ARCH),
        format!("adapter {}{kind}", summary.name),
        format!("driver {} {}", summary.backend, summary.driver),
        format!("class {}", gpu.caps.class()),
    ]
    .join("\n")
}

impl Panel for HelpWindow {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(mut page) = self.0 else { return };
        let mut is_open = true;
        let area = ui.ctx().content_rect();
        let size = vec2(
            WIDTH.min(area.width() - 48.0),
            (area.height() - 160.0).clamp(120.0, 560.0),
        );
        centered_window(ui.ctx(), "Help", &mut is_open).show(ui.ctx(), |ui| {
            ui.set_width(size.x);
            ui.horizontal(|ui| words_ui(ui, "Help: ", &mut page, PAGES));
            ui.separator();
            match page {
                Page::Guide => {
                    let scroll = ScrollArea::vertical().max_height(size.y);
                    let scroll = scroll.min_scrolled_height(size.y);
                    scroll
                        .auto_shrink([false, true])
                        .show(ui, |ui| text_ui(ui, GUIDE));
                }
                Page::Report => {
                    text_ui(ui, REPORT);
                    details_ui(ui, state, commands);
                }
                Page::About => {
                    ui.label(theme::title(format!(
                        "rasterlab {}",
                        env!("CARGO_PKG_VERSION")
                    )));
                    ui.label(env!("CARGO_PKG_DESCRIPTION"));
                    ui.label(theme::weak(format!(
                        "License: {}",
                        env!("CARGO_PKG_LICENSE")
                    )));
                    details_ui(ui, state, commands);
                }
            }
        });
        self.0 = Some(page).filter(|_| is_open);
    }
}

fn details_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let details = details(state);
    ui.add_space(theme::GAP);
    for line in details.lines() {
        ui.label(egui::RichText::new(line).monospace());
    }
    ui.add_space(theme::GAP);
    if ui.add(main_button("Copy details")).clicked() {
        ui.copy_text(details);
        commands.notify(Level::Info, "Copied the details");
    }
}

/// Shows a page of the documentation: headings, paragraphs, lists, tables and code; no pictures.
fn text_ui(ui: &mut Ui, page: &str) {
    let mut lines = page.lines().peekable();
    while let Some(line) = lines.next() {
        let starts_block = |line: &str| {
            line.is_empty()
                || line.starts_with(['#', '|', '<'])
                || line.starts_with("- ")
                || line.starts_with("```")
        };
        if let Some(heading) = line.strip_prefix('#') {
            ui.add_space(theme::GAP);
            ui.label(theme::title(heading.trim_start_matches('#').trim()));
        } else if line.starts_with("```") {
            let code: Vec<&str> = lines
                .by_ref()
                .take_while(|line| !line.starts_with("```"))
                .collect();
            let frame = egui::Frame::new().fill(theme::well()).inner_margin(6.0);
            frame.show(ui, |ui| {
                ui.label(egui::RichText::new(code.join("\n")).monospace())
            });
        } else if line.starts_with('|') {
            let mut rows = vec![line];
            while let Some(row) = lines.next_if(|line| line.starts_with('|')) {
                rows.push(row);
            }
            table_ui(ui, &rows);
        } else if !line.is_empty() && !line.starts_with('<') {
            let mut text = line.replacen("- ", "•  ", usize::from(line.starts_with("- ")));
            while let Some(more) = lines.next_if(|line| !starts_block(line)) {
                text = format!("{text} {}", more.trim());
            }
            ui.label(inline(ui, &text, ui.available_width()));
            ui.add_space(theme::HALF);
        }
    }
}

fn table_ui(ui: &mut Ui, rows: &[&str]) {
    let cells = |row: &str| -> Vec<String> {
        let row = row.trim().trim_matches('|');
        row.split(" | ")
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    let rows: Vec<_> = rows
        .iter()
        .filter(|row| !row.starts_with("|-"))
        .map(|row| cells(row))
        .collect();
    // A column has room for its longest cell, as a share of the longest ones of all.
    let columns = 0..rows[0].len();
    let longest = |at: usize| {
        rows.iter()
            .filter_map(|row| row.get(at))
            .map(String::len)
            .max()
    };
    let shares: Vec<f32> = columns
        .map(|at| longest(at).unwrap_or(0).clamp(8, 64) as f32)
        .collect();
    let each = (ui.available_width() - 8.0 * shares.len() as f32) / shares.iter().sum::<f32>();
    Grid::new(&rows[0]).spacing([8.0, 4.0]).show(ui, |ui| {
        for row in &rows {
            for (cell, share) in row.iter().zip(&shares) {
                // A grid would lay a text out on one line.
                let job = inline(ui, cell, each * share);
                ui.label(ui.fonts_mut(|fonts| fonts.layout_job(job)));
            }
            ui.end_row();
        }
    });
    ui.add_space(theme::HALF);
}

/// A text with its `code`, *words* and links, of which the text stays.
fn inline(ui: &Ui, text: &str, width: f32) -> LayoutJob {
    let body = egui::TextStyle::Body.resolve(ui.style());
    let code = FontId::monospace(body.size * 0.92);
    let mut job = LayoutJob {
        wrap: TextWrapping::wrap_at_width(width),
        ..LayoutJob::default()
    };
    for (at, part) in text.split('`').enumerate() {
        let (font, color) = match at % 2 {
            0 => (&body, theme::text()),
            _ => (&code, theme::accent()),
        };
        if at % 2 == 1 {
            job.append(part, 0.0, TextFormat::simple(font.clone(), color));
            continue;
        }
        let mut plain = String::new();
        let mut rest = part;
        while let Some((before, link)) = rest.split_once('[') {
            plain += before;
            match link
                .split_once("](")
                .and_then(|(name, to)| Some((name, to.split_once(')')?.1)))
            {
                Some((name, after)) => {
                    plain += name;
                    rest = after;
                }
                None => {
                    plain.push('[');
                    rest = link;
                }
            }
        }
        plain += rest;
        for (at, part) in plain.replace("**", "*").split('*').enumerate() {
            let color = if at % 2 == 1 {
                theme::text_strong()
            } else {
                color
            };
            job.append(part, 0.0, TextFormat::simple(font.clone(), color));
        }
    }
    job
}
