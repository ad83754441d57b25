//! The left panel: presets with thumbnails, effects, and scenes with their parameters.

mod arrange;
mod entry;
mod menu;
mod scenes;
pub mod thumbnails;
pub mod toolbar;

use std::{path::Path, time::SystemTime};

use eframe::egui::{self, Align, Rect, RichText, Ui, vec2};

use self::{
    arrange::{Filter, Item, arrange, tags},
    entry::{Layout, Shown, entry_size, entry_ui},
    menu::menu_ui,
    thumbnails::{Size, Thumbnails},
};
use crate::{
    app::{
        command::{Command, Commands, FileCommand, LibraryCommand},
        favorites::{Favorites, Starred},
        icons::{Icon, icon_button},
        log::Level,
        panel::Panel,
        panels::effect_browser::EffectBrowser,
        session::FileId,
        state::State,
        theme,
    },
    preset_file::{self, Folders, GalleryEntry, PresetFile},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tab {
    Presets,
    Effects,
    Scene,
}

/// The left panel: presets with thumbnails, effects, and scenes with their parameters.
pub struct PresetBrowser {
    entries: Vec<GalleryEntry>,
    /// What the search knows of each entry.
    items: Vec<Item>,
    thumbnails: Thumbnails,
    tab: Tab,
    pub effects: EffectBrowser,
    filter: Filter,
    layout: Layout,
    shows_all_tags: bool,
    /// Indices of the entries that are listed, in order.
    listed: Vec<usize>,
    /// The preset that was open in the last frame: the list scrolls to another one.
    shown: Option<FileId>,
}

impl PresetBrowser {
    /// The presets of `folders`, of the user's folder, and the built-in ones.
    pub fn new(folders: &Folders) -> Self {
        let mut browser = Self {
            entries: Vec::new(),
            items: Vec::new(),
            thumbnails: Thumbnails::default(),
            tab: Tab::Presets,
            effects: EffectBrowser::default(),
            filter: Filter::default(),
            layout: Layout::default(),
            shows_all_tags: false,
            listed: Vec::new(),
            shown: None,
        };
        browser.read(folders);
        browser
    }

    fn read(&mut self, folders: &Folders) {
        self.entries = preset_file::gallery(folders);
        self.items = self.entries.iter().map(item).collect();
        self.listed = arrange(&self.items, &self.filter);
    }

    /// The presets of the gallery.
    pub fn entries(&self) -> &[GalleryEntry] {
        &self.entries
    }

    /// True while thumbnails are still to come.
    pub fn is_busy(&self) -> bool {
        self.thumbnails.is_busy() || self.effects.is_busy()
    }

    /// Reads the folders again and redraws the thumbnail of the preset `changed`.
    pub fn refresh(&mut self, folders: &Folders, changed: &str) {
        self.read(folders);
        self.thumbnails.changed(changed);
    }

    /// The preset whose thumbnail is to be drawn next, and its size in pixels; none while one is being drawn.
    pub fn next_thumbnail(&mut self, ctx: &egui::Context) -> Option<(PresetFile, [u32; 2])> {
        let (id, size) = self.thumbnails.next()?;
        let found = self.entries.iter().find(|entry| entry.id == id).and_then(|entry| entry.preset_file.as_ref().ok());
        // The code of a preset runs only after the user has allowed it, so a preset that brings code has no thumbnail.
        let Some(found) = found.filter(|found| found.brought_effects.is_empty()) else {
            self.thumbnails.arrived(ctx, &id, None);
            return None;
        };
        Some((found.clone(), size.pixels()))
    }

    /// Takes a thumbnail that was drawn; none if the scene is too large or broken.
    pub fn thumbnail_arrived(&mut self, ctx: &egui::Context, id: &str, image: Option<egui::ColorImage>) {
        self.thumbnails.arrived(ctx, id, image);
    }

    /// The preset `step` entries after the one called `id` in the list, wrapping round; the first if `id` is not listed. Where nothing is
    /// listed, every preset counts.
    pub fn neighbor(&self, id: &str, step: isize) -> Option<&PresetFile> {
        let listed = self.listed.iter().filter_map(|index| self.entries.get(*index));
        let mut good: Vec<&GalleryEntry> = listed.filter(|entry| entry.preset_file.is_ok()).collect();
        if good.is_empty() {
            good = self.entries.iter().filter(|entry| entry.preset_file.is_ok()).collect();
        }
        let here = good.iter().position(|entry| entry.id == id);
        let there = here.map_or(0, |here| (here as isize + step).rem_euclid(good.len() as isize) as usize);
        good.get(there)?.preset_file.as_ref().ok()
    }

    fn presets_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.mark_favorites(&state.favorites);
        let chips = tags(&self.items, &self.filter);
        toolbar::toolbar_ui(ui, &mut self.filter, &mut self.layout, &mut self.shows_all_tags, &chips);
        self.listed = arrange(&self.items, &self.filter);
        count_ui(ui, &mut self.filter, self.listed.len(), self.entries.len());
        let has_undo = !state.deleted.is_empty();
        let footer = if has_undo { theme::ROW + theme::GAP } else { 0.0 };
        let area = egui::ScrollArea::vertical().id_salt("presets").auto_shrink(false).max_height(ui.available_height() - footer);
        area.show(ui, |ui| self.gallery_ui(ui, state, commands));
        if let Some(deleted) = state.deleted.last() {
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                    if icon_button(ui, Icon::Cross, "Keep it in the trash").clicked() {
                        commands.send(Command::Library(LibraryCommand::ForgetDeleted));
                    }
                    let undo = ui.button("Undo").on_hover_text(format!("Put {} back", deleted.from.display()));
                    if undo.accessible_name("Undo the deletion").clicked() {
                        commands.send(Command::Library(LibraryCommand::Restore));
                    }
                    ui.with_layout(egui::Layout::left_to_right(Align::Center), |ui| {
                        ui.add(egui::Label::new(theme::weak(format!("{} was deleted", deleted.name()))).truncate());
                    });
                });
            });
        }
    }

    fn mark_favorites(&mut self, favorites: &Favorites) {
        for item in &mut self.items {
            item.is_favorite = favorites.has(Starred::Preset, &item.id);
        }
    }

    fn gallery_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let open = &state.session.preset_file;
        let opened = FileId::of(open);
        let is_other = self.shown.as_ref() != Some(&opened);
        self.thumbnails.begin_frame();
        let (size, columns) = entry_size(self.layout, ui.available_width());
        let quality = if self.layout == Layout::Grid { Size::Large } else { Size::Small };
        let gap = if self.layout == Layout::Grid { theme::GAP } else { theme::HALF };
        for row in self.listed.chunks(columns) {
            let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), size.y), egui::Sense::hover());
            for (column, index) in row.iter().enumerate() {
                let entry = &self.entries[*index];
                let rect = Rect::from_min_size(line.min + vec2(column as f32 * (size.x + gap), 0.0), size);
                let is_open = entry.id == open.id && is_same_file(entry.path.as_deref(), open.path.as_deref());
                if is_open && is_other {
                    ui.scroll_to_rect(rect, None);
                    self.shown = Some(opened.clone());
                }
                let shown = Shown {
                    entry,
                    picture: self.thumbnails.picture(&entry.id, quality, ui.is_rect_visible(rect)),
                    is_open,
                    is_modified: is_open && state.session.is_modified(),
                    is_favorite: self.items[*index].is_favorite,
                };
                let responses = entry_ui(ui, &shown, self.layout, rect);
                responses.entry.context_menu(|ui| menu_ui(ui, entry, commands));
                if responses.star.clicked() {
                    commands.send(Command::Library(LibraryCommand::Star(Starred::Preset, entry.id.clone(), !shown.is_favorite)));
                }
                if responses.entry.clicked() {
                    commands.send(match &entry.preset_file {
                        Ok(found) => Command::File(FileCommand::OpenPreset(Box::new(found.clone()))),
                        Err(error) => Command::Notify(Level::Error, error.to_string()),
                    });
                }
            }
            ui.add_space(gap - ui.spacing().item_spacing.y);
        }
    }
}

/// Says how many presets are listed while not all are.
fn count_ui(ui: &mut Ui, filter: &mut Filter, listed: usize, all: usize) {
    if all == 0 {
        ui.label(theme::weak("No presets found. Build one on the right and save it with Ctrl+S."));
    } else if !filter.is_empty() {
        ui.horizontal(|ui| {
            ui.label(theme::weak(if listed == 0 { "No preset answers.".into() } else { format!("{listed} of {all}") }));
            if ui.small_button("Show all").clicked() {
                *filter = Filter { sort: filter.sort, ..Filter::default() };
            }
        });
    }
}

/// Are two presets the same file? The path of one may be relative.
fn is_same_file(a: Option<&Path>, b: Option<&Path>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a == b || std::path::absolute(a).is_ok_and(|a| std::path::absolute(b).is_ok_and(|b| a == b)),
        (None, None) => true,
        _ => false,
    }
}

/// What the search knows of an entry.
fn item(entry: &GalleryEntry) -> Item {
    let changed: Option<SystemTime> = entry.path.as_ref().and_then(|path| path.metadata().ok()?.modified().ok());
    let (title, about, tags, effects) = match &entry.preset_file {
        Ok(found) => {
            let effects = found.preset.stack.0.iter().map(|enabled| enabled.effect.name.to_owned()).collect();
            (found.title().to_owned(), found.preset.about.clone(), found.preset.tags.clone(), effects)
        }
        Err(_) => (entry.id.clone(), String::new(), Vec::new(), Vec::new()),
    };
    Item { id: entry.id.clone(), title, about, tags, effects, changed, is_favorite: false }
}

impl Panel for PresetBrowser {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (tab, text) in [(Tab::Presets, "Presets"), (Tab::Effects, "Effects"), (Tab::Scene, "Scene")] {
                let button = egui::Button::selectable(self.tab == tab, RichText::new(text).strong()).min_size(vec2(72.0, theme::ROW));
                if ui.add(button).clicked() {
                    self.tab = tab;
                }
            }
        });
        ui.add_space(theme::HALF);
        if self.tab != Tab::Effects {
            self.effects.close();
        }
        match self.tab {
            Tab::Presets => self.presets_ui(ui, state, commands),
            Tab::Effects => self.effects.ui(ui, state, commands),
            Tab::Scene => {
                let area = egui::ScrollArea::vertical().id_salt("scenes").auto_shrink(false);
                area.show(ui, |ui| scenes::scenes_ui(ui, state, commands));
            }
        }
    }
}
