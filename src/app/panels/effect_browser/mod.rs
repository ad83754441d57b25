//! The browser of effects: every effect in its group, with a picture of it on the open model.

pub mod groups;
mod tile;

use std::sync::{
    Arc, Weak,
    atomic::{AtomicBool, Ordering},
};

use eframe::egui::{self, RichText, ScrollArea, Ui, vec2};

use self::{
    groups::{Group, grouped},
    tile::{Tile, tile_size, tile_ui},
};
use super::{
    inspector::effect_menu,
    preset_browser::{
        thumbnails::{Size, Thumbnails},
        toolbar::search_ui,
    },
};
use crate::{
    app::{
        editing::{session::Session, stack_drag::StackDrag},
        files::{
            command::{FileCommand, LibraryCommand},
            favorites::Starred,
        },
        picture::effect_picture::EffectPicture,
        shell::{
            command::{Command, Commands, Edit},
            log::Level,
            state::State,
        },
        widgets::{
            icons::{Icon, toggle_button},
            theme,
        },
    },
    effects::{Effect, lambert},
    preset::{AccuracyRequest, Preset},
    preset_file::{Folders, open},
    scene::Scene,
};

/// The browser of effects.
#[derive(Default)]
pub struct EffectBrowser {
    search: String,
    only_favorites: bool,
    pictures: Thumbnails,
    /// The scene that the pictures show.
    scene: Weak<Scene>,
    /// Set when the pictures that are being drawn are no longer needed.
    cancelled: Arc<AtomicBool>,
}

impl EffectBrowser {
    /// True while a picture in view is still to come.
    pub fn is_busy(&self) -> bool {
        self.pictures.is_busy()
    }

    /// The browser is not shown any more: what is not drawn yet is not needed.
    pub fn close(&mut self) {
        self.pictures.begin_frame();
        if self.pictures.is_busy() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// The picture that is to be drawn next; none while one is being drawn.
    pub fn next_picture(
        &mut self,
        ctx: &egui::Context,
        session: &Session,
    ) -> Option<EffectPicture> {
        let (name, size) = self.pictures.next()?;
        let found = session
            .scene()
            .cloned()
            .zip(session.preset_file.effects.find(&name).ok().flatten());
        let Some((scene, effect)) = found else {
            self.pictures.arrived(ctx, &name, None);
            return None;
        };
        self.cancelled = Arc::default();
        let (preset, size, cancelled) = (
            sample(effect, session),
            size.pixels(),
            self.cancelled.clone(),
        );
        Some(EffectPicture {
            effect: effect.name.clone(),
            preset,
            scene,
            size,
            cancelled,
        })
    }

    /// Takes a picture that was drawn; none if it was cancelled or the scene is too large.
    pub fn picture_arrived(
        &mut self,
        ctx: &egui::Context,
        effect: &str,
        image: Option<egui::ColorImage>,
    ) {
        if image.is_none() && self.cancelled.load(Ordering::Relaxed) {
            return self.pictures.abandoned(effect);
        }
        self.pictures.arrived(ctx, effect, image);
    }

    /// Shows the browser.
    pub fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.follow_scene(state);
        ui.horizontal(|ui| {
            let side = ui.spacing().interact_size.y;
            ui.scope(|ui| {
                ui.set_max_width(ui.available_width() - side - theme::GAP);
                search_ui(ui, &mut self.search, "Search effects");
            });
            let star = if self.only_favorites {
                Icon::StarFull
            } else {
                Icon::Star
            };
            if toggle_button(ui, star, self.only_favorites, "Favorite effects only")
                .on_hover_text("Favorites only")
                .clicked()
            {
                self.only_favorites = !self.only_favorites;
            }
        });
        ui.add_space(theme::HALF);
        let session = &state.session;
        let all = session.preset_file.effects.effects_with(
            session
                .preset()
                .stack
                .0
                .iter()
                .map(|enabled| &enabled.effect),
        );
        let is_kept = |effect: &Effect| {
            !self.only_favorites || state.files.favorites.has(Starred::Effect, &effect.name)
        };
        let groups = grouped(&all, &self.search, is_kept);
        self.pictures.begin_frame();
        ScrollArea::vertical()
            .id_salt("effects")
            .auto_shrink(false)
            .show(ui, |ui| {
                for (group, effects) in &groups {
                    self.group_ui(ui, state, commands, *group, effects);
                }
                if groups.is_empty() {
                    ui.label(theme::weak("No effect answers."));
                    if ui.small_button("Show all effects").clicked() {
                        (self.search, self.only_favorites) = (String::new(), false);
                    }
                }
                ui.add_space(theme::GAP);
                let own = ui
                    .button("New effect…")
                    .on_hover_text("Write an effect of your own, in one WGSL file");
                if own.accessible_name("Write a new effect").clicked() {
                    commands.send(Command::File(FileCommand::AskNewEffect(None)));
                }
                ui.add_space(theme::GAP);
            });
    }

    /// Pictures of another scene are drawn anew.
    fn follow_scene(&mut self, state: &State) {
        let Some(scene) = state.session.scene() else {
            return;
        };
        if self.scene.as_ptr() != Arc::as_ptr(scene) {
            self.scene = Arc::downgrade(scene);
            self.pictures.all_changed();
        }
    }

    fn group_ui(
        &mut self,
        ui: &mut Ui,
        state: &State,
        commands: &Commands,
        group: Group,
        effects: &[&Arc<Effect>],
    ) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            ui.label(theme::heading(group.name()));
            ui.add(
                egui::Label::new(
                    RichText::new(group.about())
                        .size(11.5)
                        .color(theme::text_weak()),
                )
                .truncate(),
            );
        });
        let stack = &state.session.preset().stack;
        let (size, columns) = tile_size(ui.available_width());
        for row in effects.chunks(columns) {
            let (line, _) =
                ui.allocate_exact_size(vec2(ui.available_width(), size.y), egui::Sense::hover());
            for (column, effect) in row.iter().enumerate() {
                let rect = egui::Rect::from_min_size(
                    line.min + vec2(column as f32 * (size.x + theme::HALF), 0.0),
                    size,
                );
                let tile = Tile {
                    effect,
                    picture: self.pictures.picture(
                        &effect.name,
                        Size::Small,
                        ui.is_rect_visible(rect),
                    ),
                    is_enabled: stack.get(&effect.name).is_some(),
                    rival: stack.rival_of(effect).map(|rival| rival.name.as_str()),
                    is_favorite: state.files.favorites.has(Starred::Effect, &effect.name),
                };
                let responses = tile_ui(ui, &tile, rect);
                responses
                    .tile
                    .dnd_set_drag_payload(StackDrag::Enable((*effect).clone()));
                responses
                    .tile
                    .context_menu(|ui| effect_menu::menu_ui(ui, state, commands, effect));
                if responses.star.clicked() {
                    commands.send(Command::Library(LibraryCommand::Star(
                        Starred::Effect,
                        effect.name.clone(),
                        !tile.is_favorite,
                    )));
                }
                if responses.tile.clicked() {
                    toggle(commands, &tile);
                }
            }
        }
        ui.add_space(theme::HALF);
    }
}

/// Enables the effect of a tile, in place of its rival if there is one, or disables it.
fn toggle(commands: &Commands, tile: &Tile<'_>) {
    let name = &tile.effect.name;
    match (tile.is_enabled, tile.rival) {
        (true, _) => return commands.edit(Edit::Disable(tile.effect.clone())),
        (false, Some(rival)) => {
            commands.edit(Edit::Replace(rival.into(), tile.effect.clone()));
            let text =
                format!("{name} replaced {rival}: both take the same slot of the rasterizer");
            commands.send(Command::Notify(Level::Info, text));
        }
        (false, None) => commands.edit(Edit::Enable(tile.effect.clone())),
    }
    commands.send(Command::Reveal(name.into()));
}

/// The open preset with nothing but `effect`: with the values of the built-in preset that shows it,
/// or else with defaults, in daylight.
fn sample(effect: &Arc<Effect>, session: &Session) -> Preset {
    let own = session.shown_preset();
    let mut preset = Preset {
        accuracy: AccuracyRequest::default(),
        test: None,
        animation: Default::default(),
        ..own.clone()
    };
    let shown = if effect.source.is_none() {
        open(&effect.name, &Folders::default()).ok()
    } else {
        None
    };
    match shown.filter(|shown| shown.preset.stack.get(&effect.name).is_some()) {
        Some(shown) => {
            preset.stack = shown.preset.evaluated_stack();
            if own.polyline.is_empty() {
                preset.polyline = shown.preset.polyline;
            }
        }
        None => {
            preset.stack = Default::default();
            if effect.hooks.surface.is_none() || effect.is_of_file() {
                preset.stack.enable(&lambert::EFFECT);
            }
            preset.stack.enable(effect);
        }
    }
    preset
}
