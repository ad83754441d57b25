//! The left panel: presets with thumbnails, effects, and scenes with their parameters.

mod arrange;
mod menu;
pub mod pictures;
mod scenes;
pub mod thumbnails;
pub mod toolbar;

use std::time::SystemTime;

use egui::{self, Align, RichText, Ui, vec2};

use self::{
    arrange::{Filter, Item, arrange, tags},
    menu::{menu_ui, open_entry},
    pictures::Pictures,
    thumbnails::Size,
};
use super::effect_browser::EffectBrowser;
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::session::FileId,
        files::library,
        files::{
            command::Manner,
            favorites::{Favorites, Starred},
            scene_loader::SceneKey,
        },
        picture::effect_picture::THUMBNAIL,
        settings::browsing::{Browsing, Layout, Tab},
        shell::{action::Action, command::Commands, state::State},
        widgets::{
            icons::{Icon, icon_button},
            panel::at_right,
            text::with_own_paths,
            theme,
            tile::{Tile, Tiling},
        },
    },
    params::did_you_mean,
    preset_file::{self, Folders, GalleryEntry, Origin, PresetFile},
};

/// The left panel: presets with thumbnails, effects, and scenes with their parameters.
pub struct PresetBrowser {
    entries: Vec<GalleryEntry>,
    /// What the search knows of each entry.
    items: Vec<Item>,
    pub pictures: Pictures,
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
            pictures: Pictures::default(),
            tab: Tab::default(),
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

    /// Files of the presets that have a golden, or ids of built-in ones.
    pub fn with_goldens(&self) -> Vec<String> {
        #[cfg(target_arch = "wasm32")]
        let has_golden = |_: &PresetFile| false; // A page has no goldens.
        #[cfg(not(target_arch = "wasm32"))]
        use crate::golden::has_golden;
        let reviewed = self.entries.iter().filter_map(|entry| {
            let preset_file = entry.preset_file.as_ref().ok()?;
            has_golden(preset_file).then(|| match &entry.path {
                Some(path) => path.to_string_lossy().into_owned(),
                None => entry.id.clone(),
            })
        });
        reviewed.collect()
    }

    /// What the panel shows, and how it lists presets, for the next start.
    pub fn browsing(&self) -> Browsing {
        Browsing {
            tab: self.tab,
            layout: self.layout,
            sort: self.filter.sort,
        }
    }

    /// Shows what was shown at the end of the last session.
    pub fn show(&mut self, Browsing { tab, layout, sort }: Browsing) {
        (self.tab, self.layout, self.filter.sort) = (tab, layout, sort);
    }

    /// True while thumbnails are still to come.
    pub fn is_busy(&self) -> bool {
        self.pictures.is_busy() || self.effects.is_busy()
    }

    /// Reads the folders again and redraws the thumbnail of the preset `changed`.
    pub fn refresh(&mut self, folders: &Folders, changed: &str) {
        self.read(folders);
        self.pictures.changed(changed);
    }

    /// What is in view is told anew; nothing is while the panel is hidden.
    pub fn begin_frame(&mut self) {
        self.pictures.begin_frame();
    }

    /// The panel is not shown any more: what is not drawn yet is not needed.
    pub fn close(&mut self) {
        self.begin_frame();
        self.effects.close();
    }

    /// The preset whose thumbnail is to be drawn next, and its size in pixels; none while one is
    /// being drawn.
    pub fn next_thumbnail(&mut self, ctx: &egui::Context) -> Option<(PresetFile, [u32; 2])> {
        self.pictures.next(ctx, &self.entries)
    }

    /// The same on the scene of `key`, the user's own.
    pub fn next_on_model(
        &mut self,
        ctx: &egui::Context,
        key: &SceneKey,
    ) -> Option<(PresetFile, [u32; 2])> {
        self.pictures.next_on_model(ctx, key, &self.entries)
    }

    /// The preset `step` entries after the one called `id` in the list, wrapping round; the first
    /// if `id` is not listed. Where nothing is listed, every preset counts.
    pub fn neighbor(&self, id: &str, step: isize) -> Option<&PresetFile> {
        let listed = self
            .listed
            .iter()
            .filter_map(|index| self.entries.get(*index));
        let mut good: Vec<&GalleryEntry> =
            listed.filter(|entry| entry.preset_file.is_ok()).collect();
        if good.is_empty() {
            good = self
                .entries
                .iter()
                .filter(|entry| entry.preset_file.is_ok())
                .collect();
        }
        let here = good.iter().position(|entry| entry.id == id);
        let there = here.map_or(0, |here| {
            (here as isize + step).rem_euclid(good.len() as isize) as usize
        });
        good.get(there)?.preset_file.as_ref().ok()
    }

    fn presets_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.mark_favorites(&state.files.favorites);
        let chips = tags(&self.items, &self.filter);
        self.pictures.switch_ui(ui, &state.session);
        toolbar::toolbar_ui(
            ui,
            &mut self.filter,
            &mut self.layout,
            &mut self.shows_all_tags,
            &chips,
        );
        self.listed = arrange(&self.items, &self.filter);
        let counts = [self.listed.len(), self.entries.len()];
        let titles = self.entries.iter().map(GalleryEntry::title);
        let near = match self.listed.is_empty() {
            true => did_you_mean(&self.filter.search, titles),
            false => String::new(),
        };
        count_ui(ui, &mut self.filter, counts, &near);
        let has_undo = !state.files.deleted.is_empty();
        let footer = if has_undo {
            theme::ROW + theme::GAP
        } else {
            0.0
        };
        let area = egui::ScrollArea::vertical()
            .id_salt("presets")
            .auto_shrink(false)
            .max_height(ui.available_height() - footer);
        area.show(ui, |ui| self.gallery_ui(ui, state, commands));
        if let Some(deleted) = state.files.deleted.last() {
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                at_right(ui, |ui| {
                    if icon_button(ui, Icon::Cross, "Keep it in the trash").clicked() {
                        commands.run(|app| app.state.files.deleted.clear());
                    }
                    let hint = format!("Put {} back", deleted.path.display());
                    let undo = ui.button("Undo").on_hover_text(hint);
                    if undo.accessible_name("Undo the deletion").clicked() {
                        commands.run(|app| library::notify_outcome(app, library::restore));
                    }
                    ui.with_layout(egui::Layout::left_to_right(Align::Center), |ui| {
                        let text = format!("{} was deleted", deleted.name());
                        ui.add(egui::Label::new(theme::weak(text)).truncate());
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
        let (tiling, quality) = match self.layout {
            Layout::Grid => (GRID, Size::Large),
            Layout::List => (LIST, Size::Small),
        };
        let is_modified = state.session.is_modified();
        tiling.show(ui, &self.listed, |ui, index, rect| {
            let (entry, item) = (&self.entries[*index], &self.items[*index]);
            let is_open = open.is_look_of(&entry.id, entry.path.as_deref());
            if is_open && is_other {
                ui.scroll_to_rect(rect, None);
                self.shown = Some(opened.clone());
            }
            let is_seen = ui.is_rect_visible(rect);
            let about = match &entry.preset_file {
                Ok(preset_file) => preset_file.preset.about.clone(),
                Err(error) => error.to_string(),
            };
            let picture = self
                .pictures
                .picture(entry, &state.session, quality, is_seen);
            let tile = Tile {
                kind: "Preset",
                id: &entry.id,
                title: entry.title(),
                name: entry.title().to_owned(),
                about: about.clone(),
                picture,
                is_chosen: is_open,
                is_modified: is_open && is_modified,
                is_favorite: item.is_favorite,
                is_faulty: entry.preset_file.is_err(),
            };
            let [tile, star] = tile.show(ui, tiling, rect, egui::Sense::click());
            tile.context_menu(|ui| menu_ui(ui, entry, commands));
            if star.clicked() {
                let (name, is_on) = (entry.id.clone(), !item.is_favorite);
                commands.run(move |app| library::star(app, Starred::Preset, &name, is_on));
            }
            if tile.clicked() {
                let with_scene = ui.input(|i| i.modifiers.shift || i.modifiers.alt);
                let manner = match with_scene {
                    true => Manner::WithScene,
                    false => Manner::Look,
                };
                open_entry(entry, manner, commands);
            }
            tile.on_hover_ui(|ui| about_ui(ui, entry, item, &about));
        });
    }
}

const GRID: Tiling = Tiling {
    width: 104.0,
    name: 24.0,
    margin: 4.0,
    gap: theme::GAP,
    list: None,
};
const LIST: Tiling = Tiling {
    gap: theme::HALF,
    list: Some(THUMBNAIL[0] as f32 / 2.0),
    ..GRID
};

/// What an entry says on hover.
fn about_ui(ui: &mut Ui, entry: &GalleryEntry, item: &Item, about: &str) {
    ui.horizontal(|ui| {
        ui.label(theme::strong(entry.title()));
        ui.label(theme::weak(&entry.id));
    });
    ui.label(about);
    if entry.preset_file.is_ok() {
        let effects = match item.effects.join(", ") {
            none if none.is_empty() => "none".into(),
            effects => effects,
        };
        ui.label(theme::weak(format!("Effects: {effects}")));
        if !item.tags.is_empty() {
            ui.label(theme::weak(format!("Tags: {}", item.tags.join(", "))));
        }
    }
    let mut source = match (&entry.path, entry.origin) {
        (Some(path), _) => with_own_paths(path.display().to_string()),
        (None, Origin::Builtin) => "Built in".into(),
        (None, _) => String::new(),
    };
    if !entry.shadows.is_empty() {
        source += &format!("; hides {} of the same name", entry.shadows.len());
    }
    ui.label(theme::weak(source));
}

/// Says how many presets are listed while not all are, and which is `near` where none is.
fn count_ui(ui: &mut Ui, filter: &mut Filter, [listed, all]: [usize; 2], near: &str) {
    if all == 0 {
        let save = match Action::Save.shortcut_text() {
            keys if keys.is_empty() => "with File › Save".to_owned(),
            keys => format!("with {keys}"),
        };
        ui.label(theme::weak(format!(
            "No presets found. Build one on the right and save it {save}."
        )));
    } else if !filter.is_empty() {
        ui.horizontal_wrapped(|ui| {
            ui.label(theme::weak(if listed == 0 {
                format!("No preset answers{near}")
            } else {
                format!("{listed} of {all}")
            }));
            if ui.small_button("Show all").clicked() {
                *filter = Filter {
                    sort: filter.sort,
                    ..Filter::default()
                };
            }
        });
    }
}

/// What the search knows of an entry.
fn item(entry: &GalleryEntry) -> Item {
    let changed: Option<SystemTime> = entry
        .path
        .as_ref()
        .and_then(|path| path.metadata().ok()?.modified().ok());
    let (title, about, tags, effects) = match &entry.preset_file {
        Ok(found) => {
            let effects = found
                .preset
                .stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.to_owned())
                .collect();
            (
                found.title().to_owned(),
                found.preset.about.clone(),
                found.preset.tags.clone(),
                effects,
            )
        }
        Err(_) => (entry.id.clone(), String::new(), Vec::new(), Vec::new()),
    };
    Item {
        id: entry.id.clone(),
        title,
        about,
        tags,
        effects,
        changed,
        is_favorite: false,
    }
}

impl Panel for PresetBrowser {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for tab in Tab::ALL {
                let button =
                    egui::Button::selectable(self.tab == tab, RichText::new(tab.label()).strong())
                        .min_size(vec2(72.0, theme::ROW));
                if ui.add(button).clicked() {
                    self.tab = tab;
                }
            }
        });
        ui.add_space(theme::HALF);
        self.begin_frame();
        let is_adding = self.effects.is_adding();
        if self.tab != Tab::Effects && !is_adding {
            self.effects.close();
        }
        match self.tab {
            Tab::Presets => self.presets_ui(ui, state, commands),
            // The dialog shows the same tiles.
            Tab::Effects if is_adding => {}
            Tab::Effects => self.effects.tab_ui(ui, state, commands),
            Tab::Scene => {
                let area = egui::ScrollArea::vertical()
                    .id_salt("scenes")
                    .auto_shrink(false);
                area.show(ui, |ui| scenes::scenes_ui(ui, state, commands));
            }
        }
    }
}
