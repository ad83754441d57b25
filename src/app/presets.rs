//! The left panel: looks with thumbnails, and scenes with their parameters.

use std::{
    collections::{HashMap, HashSet, VecDeque},
    path::Path,
};

use eframe::egui::{self, Align2, DragValue, FontId, Pos2, Rect, RichText, Sense, Ui, pos2, vec2};

use super::{App, Level, dialogs::Dialog, jobs, theme};
use crate::{
    preset::SceneSource,
    preset_file::{self, GalleryEntry, Origin},
    scene::builtin::{BUILTINS, Builtin},
};

/// What the panel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tab {
    Presets,
    Scene,
}

/// The gallery, and its pictures as they arrive.
pub struct PresetBrowser {
    entries: Vec<GalleryEntry>,
    pictures: HashMap<String, egui::TextureHandle>,
    /// Presets that wait for a picture; one is drawn at a time.
    queue: VecDeque<String>,
    drawing: Option<String>,
    /// Presets that have none: too large, or broken.
    without: HashSet<String>,
    tab: Tab,
}

impl PresetBrowser {
    pub fn new(folder: Option<&Path>) -> Self {
        let entries = preset_file::gallery(folder);
        let queue = entries.iter().filter(|entry| entry.preset_file.is_ok()).map(|entry| entry.id.clone()).collect();
        Self { entries, queue, pictures: HashMap::new(), drawing: None, without: HashSet::new(), tab: Tab::Presets }
    }

    /// Are thumbnails still to come?
    pub fn is_busy(&self) -> bool {
        self.drawing.is_some() || !self.queue.is_empty()
    }

    pub fn thumbnail_arrived(&mut self, ctx: &egui::Context, id: String, image: Option<egui::ColorImage>) {
        if self.drawing.as_ref() == Some(&id) {
            self.drawing = None;
        }
        match image {
            Some(image) => {
                let picture = ctx.load_texture(format!("look {id}"), image, egui::TextureOptions::LINEAR);
                self.pictures.insert(id, picture);
            }
            None => drop(self.without.insert(id)),
        }
    }

    /// Reads the folders again and redraws `changed`.
    pub fn refresh(&mut self, folder: Option<&Path>, changed: &str) {
        self.entries = preset_file::gallery(folder);
        self.without.remove(changed);
        if self.entries.iter().any(|entry| entry.id == changed) && !self.queue.iter().any(|id| id == changed) {
            self.queue.push_back(changed.to_owned());
        }
    }
}

const THUMBNAIL_POINTS: egui::Vec2 = vec2(jobs::THUMBNAIL[0] as f32 / 2.0, jobs::THUMBNAIL[1] as f32 / 2.0);

impl App {
    /// Keeps one thumbnail in the making.
    pub(super) fn feed_thumbnails(&mut self) {
        // The picture and its figures come first: all want the same cores.
        if self.preset_browser.drawing.is_some() || self.scene_loader.loading.is_some() || self.screen.is_waiting() {
            return;
        }
        let Some(id) = self.preset_browser.queue.pop_front() else { return };
        let preset_file = self.preset_browser.entries.iter().find(|entry| entry.id == id).and_then(|entry| entry.preset_file.as_ref().ok());
        if let Some(preset_file) = preset_file.cloned() {
            self.preset_browser.drawing = Some(id);
            self.jobs.thumbnail(preset_file);
        }
    }

    pub(super) fn left_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (tab, text) in [(Tab::Presets, "Presets"), (Tab::Scene, "Scene")] {
                let button =
                    egui::Button::selectable(self.preset_browser.tab == tab, RichText::new(text).strong()).min_size(vec2(72.0, theme::ROW));
                if ui.add(button).clicked() {
                    self.preset_browser.tab = tab;
                }
            }
        });
        ui.add_space(theme::HALF);
        egui::ScrollArea::vertical().id_salt(self.preset_browser.tab as u8).auto_shrink(false).show(ui, |ui| {
            match self.preset_browser.tab {
                Tab::Presets => self.presets_ui(ui),
                Tab::Scene => self.scenes_ui(ui),
            }
        });
    }

    fn presets_ui(&mut self, ui: &mut Ui) {
        if self.preset_browser.entries.is_empty() {
            ui.label(theme::weak("No presets were found. Build one on the right and save it with Ctrl+S."));
        }
        let mut chosen = None;
        for index in 0..self.preset_browser.entries.len() {
            let entry = &self.preset_browser.entries[index];
            let is_open = entry.id == self.preset_file.id && entry.path == self.preset_file.path;
            if preset_row(ui, entry, self.preset_browser.pictures.get(&entry.id), is_open, is_open && self.is_modified()).clicked() {
                chosen = Some(index);
            }
        }
        if let Some(index) = chosen {
            self.open_entry(index);
        }
    }

    fn open_entry(&mut self, index: usize) {
        match self.preset_browser.entries[index].preset_file.clone() {
            Ok(preset_file) => {
                let title = preset_file.title().to_owned();
                self.open_preset(preset_file);
                self.tell(Level::Info, title);
            }
            Err(error) => self.tell(Level::Error, error.to_string()),
        }
    }

    /// Opens the preset before or after this one in the gallery, round the ends.
    pub(super) fn neighbour_preset(&mut self, step: isize) {
        let entries = &self.preset_browser.entries;
        let good: Vec<usize> = (0..entries.len()).filter(|&index| entries[index].preset_file.is_ok()).collect();
        if good.is_empty() {
            return self.tell(Level::Info, "The gallery is empty");
        }
        let here = good.iter().position(|&index| entries[index].id == self.preset_file.id);
        let there = match here {
            Some(here) => (here as isize + step).rem_euclid(good.len() as isize) as usize,
            None => 0,
        };
        self.open_entry(good[there]);
    }

    fn scenes_ui(&mut self, ui: &mut Ui) {
        self.scene_loader_ui(ui);
        ui.add_space(theme::HALF);
        if ui.button("Open model…").on_hover_text("A .glb or .gltf file").clicked() {
            self.dialog = Some(Dialog::open(self.options.presets_dir.as_deref()));
        }
        ui.label(theme::weak("Or drop a .glb, .gltf, look or one of our pictures anywhere on the window."));
        ui.add_space(theme::GAP);
        ui.label(theme::heading("Built in"));
        let query = match &self.preset_file.preset.scene {
            SceneSource::Builtin(query) => query.clone(),
            SceneSource::File(_) => String::new(),
        };
        let open = query.split('?').next().unwrap_or_default().to_owned();
        for builtin in BUILTINS {
            let is_open = builtin.name == open;
            let button = egui::Button::selectable(is_open, builtin.name).min_size(vec2(ui.available_width(), theme::ROW));
            if ui.add(button).on_hover_text(builtin.about).clicked() && !is_open {
                self.preset_file.preset.scene = SceneSource::Builtin(builtin.name.into());
                // A pose for one scene says nothing about another.
                self.preset_file.preset.camera = None;
                self.preset_file.preset.scene_camera.clear();
            }
            if is_open && let Some(changed) = params_ui(ui, builtin, &query) {
                self.preset_file.preset.scene = SceneSource::Builtin(changed);
            }
        }
    }

    /// What is on stage: name, counts, notes.
    fn scene_loader_ui(&mut self, ui: &mut Ui) {
        let source = match &self.preset_file.preset.scene {
            SceneSource::Builtin(query) => query.clone(),
            SceneSource::File(path) => path.display().to_string(),
        };
        ui.add(egui::Label::new(RichText::new(&source).color(theme::TEXT_STRONG).strong()).truncate()).on_hover_text(&source);
        if self.scene_loader.loading.is_some() {
            ui.horizontal(|ui| {
                ui.add(egui::Spinner::new().size(12.0));
                ui.label(theme::weak("loading"));
            });
            return;
        }
        if self.scene_loader.failed.is_some() {
            theme::notice(ui, theme::RED, "This scene cannot be shown; the log says why.");
            return;
        }
        let Some((_, scene)) = &self.scene_loader.shown else { return };
        ui.label(theme::weak(format!("{} triangles · {} vertices", grouped(scene.triangle_count()), grouped(scene.vertex_count()))));
        if scene.instances.len() > 1 {
            ui.label(theme::weak(format!("{} placements", grouped(scene.instances.len() as u64))));
        }
        if scene.triangle_count() == 0 {
            theme::notice(ui, theme::AMBER, "There is no triangle in this scene, so the picture is background alone.");
        }
        scene.notes.iter().for_each(|note| theme::notice(ui, theme::AMBER, note));
    }
}

/// A row of the gallery: picture, name, what it is.
fn preset_row(
    ui: &mut Ui,
    entry: &GalleryEntry,
    picture: Option<&egui::TextureHandle>,
    is_open: bool,
    is_modified: bool,
) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), THUMBNAIL_POINTS.y + 8.0), Sense::click());
    let (name, about, color) = match &entry.preset_file {
        Ok(preset_file) => (preset_file.title(), preset_file.preset.about.clone(), theme::TEXT_STRONG),
        Err(error) => (entry.id.as_str(), error.to_string(), theme::RED),
    };
    if is_open {
        ui.painter().rect_filled(rect, 6.0, theme::ACCENT_GROUND);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 6.0, theme::RAISED);
    }
    let frame = Rect::from_min_size(rect.min + vec2(4.0, 4.0), THUMBNAIL_POINTS);
    match picture {
        Some(picture) => {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            egui::Image::from_texture((picture.id(), THUMBNAIL_POINTS)).uv(whole).corner_radius(4.0).paint_at(ui, frame);
        }
        None => drop(ui.painter().rect_filled(frame, 4.0, theme::WELL)),
    }
    let text = Rect::from_min_max(pos2(frame.right() + 8.0, frame.top()), rect.max - vec2(6.0, 4.0));
    let painter = ui.painter_at(text);
    let title = painter.layout_no_wrap(name.to_owned(), FontId::proportional(13.0), color);
    painter.galley(text.min + vec2(0.0, 2.0), title.clone(), color);
    if is_modified {
        painter.circle_filled(text.min + vec2(title.size().x + 8.0, 10.0), 3.0, theme::ACCENT);
    }
    let mut job =
        egui::text::LayoutJob::single_section(about.clone(), egui::TextFormat::simple(FontId::proportional(11.5), weak_on(is_open)));
    job.wrap = egui::text::TextWrapping { max_width: text.width(), max_rows: 2, break_anywhere: false, overflow_character: Some('…') };
    painter.galley(text.min + vec2(0.0, 20.0), painter.layout_job(job), theme::TEXT_WEAK);
    if entry.preset_file.is_err() && picture.is_none() {
        ui.painter().text(frame.center(), Align2::CENTER_CENTER, "!", FontId::proportional(18.0), theme::RED);
    }
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_open, format!("Look {name}")));
    response.on_hover_ui(|ui| {
        ui.label(RichText::new(name).color(theme::TEXT_STRONG));
        ui.label(&about);
        ui.label(theme::weak(place_text(entry)));
    })
}

fn weak_on(selected: bool) -> egui::Color32 {
    if selected { theme::TEXT } else { theme::TEXT_WEAK }
}

fn place_text(entry: &GalleryEntry) -> String {
    let place = match (&entry.path, entry.origin) {
        (Some(path), _) => path.display().to_string(),
        (None, Origin::Builtin) => "built in".into(),
        (None, _) => String::new(),
    };
    if entry.shadows.is_empty() { place } else { format!("{place}; hides {} of the same name", entry.shadows.len()) }
}

/// Fields for the parameters of a builtin; the changed query, if any.
fn params_ui(ui: &mut Ui, builtin: &Builtin, query: &str) -> Option<String> {
    let mut values = values_of(builtin, query);
    let before = values.clone();
    egui::Frame::new().inner_margin(egui::Margin { left: 12, right: 0, top: 2, bottom: 8 }).show(ui, |ui| {
        ui.label(theme::weak(builtin.about));
        for (param, value) in builtin.params.iter().zip(&mut values) {
            ui.horizontal(|ui| {
                let (label, response) = ui.allocate_exact_size(vec2(84.0, theme::ROW - 4.0), Sense::hover());
                response.on_hover_text(param.doc);
                let font = egui::TextStyle::Body.resolve(ui.style());
                ui.painter_at(label).text(label.left_center(), Align2::LEFT_CENTER, param.name, font, theme::TEXT);
                let speed = if param.whole { value.abs().max(10.0) * 0.02 } else { value.abs().max(0.1) * 0.02 };
                // A scene is costly, so a drag shows its number and the scene is built on release.
                let id = egui::Id::unique((builtin.name, param.name));
                let mut shown = ui.data(|data| data.get_temp(id)).unwrap_or(*value);
                let drag = DragValue::new(&mut shown).range(param.range.clone()).speed(speed).max_decimals(if param.whole { 0 } else { 4 });
                let response = ui.add_sized([96.0, theme::ROW - 4.0], drag.update_while_editing(false));
                if response.dragged() {
                    ui.data_mut(|data| data.insert_temp(id, shown));
                } else {
                    ui.data_mut(|data| data.remove::<f64>(id));
                    *value = shown;
                }
                response.on_hover_text(param.doc).accessible_name(format!("{} {}", builtin.name, param.name));
            });
        }
    });
    (values != before).then(|| written(builtin, &values))
}

/// The value of every parameter in `query`; the default where it says nothing readable.
fn values_of(builtin: &Builtin, query: &str) -> Vec<f64> {
    let pairs: HashMap<&str, &str> =
        query.split_once('?').map_or("", |(_, pairs)| pairs).split('&').filter_map(|pair| pair.split_once('=')).collect();
    builtin.params.iter().map(|param| pairs.get(param.name).and_then(|text| text.parse().ok()).unwrap_or(param.default)).collect()
}

/// The query that says what differs from the defaults.
fn written(builtin: &Builtin, values: &[f64]) -> String {
    let changed = builtin.params.iter().zip(values).filter(|(param, value)| param.default != **value);
    let pairs: Vec<String> =
        changed.map(|(param, value)| format!("{}={}", param.name, if param.whole { value.round() } else { *value })).collect();
    if pairs.is_empty() { builtin.name.into() } else { format!("{}?{}", builtin.name, pairs.join("&")) }
}

/// `1234567` as `1,234,567`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_grouped_by_three() {
        assert_eq!([grouped(7), grouped(1000), grouped(1_234_567)], ["7", "1,000", "1,234,567"]);
    }

    #[test]
    fn a_query_says_only_what_differs_and_reads_back() {
        for builtin in BUILTINS {
            let mut values = values_of(builtin, builtin.name);
            assert_eq!(written(builtin, &values), builtin.name);
            if let (Some(value), Some(param)) = (values.first_mut(), builtin.params.first()) {
                *value = *param.range.start();
            }
            let query = written(builtin, &values);
            assert_eq!(values_of(builtin, &query), values, "{query}");
        }
    }
}
