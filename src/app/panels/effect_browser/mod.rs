//! The browser of effects: every effect in its group, with a picture of it on the open model.

pub mod groups;

use std::sync::{
    Arc, Weak,
    atomic::{AtomicBool, Ordering},
};

use egui::{self, ScrollArea, Ui};

use self::groups::{Group, best, group_effects};
use super::{
    inspector::effect_menu,
    preset_browser::thumbnails::{Size, Thumbnails},
};
use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::{session::Session, stack_drag::StackDrag},
        files::favorites::Starred,
        files::library,
        picture::effect_picture::EffectPicture,
        shell::{
            action::Action,
            command::{Commands, Edit},
            log::Level,
            state::State,
        },
        widgets::{
            form::{is_entered, search_ui},
            icons::star_toggle,
            panel::modal,
            theme,
            tile::{Tile, Tiling},
        },
    },
    effects::Effect,
    params::did_you_mean,
    preset::{AccuracyRequest, Preset},
    preset_file::{Folders, open},
    scene::Scene,
};

/// A group with those of its effects that are shown.
type ShownGroup<'a> = (Group, Vec<&'a Arc<Effect>>);

/// The browser of effects.
#[derive(Default)]
pub struct EffectBrowser {
    search: String,
    only_favorites: bool,
    /// The dialog that adds an effect is open, with its own search.
    adding: Option<String>,
    /// Something in the dialog was chosen in this frame, so that it closes.
    has_added: bool,
    pictures: Thumbnails,
    /// The scene that the pictures show.
    scene: Weak<Scene>,
    /// Set when the pictures that are being drawn are no longer needed.
    cancelled: Arc<AtomicBool>,
}

/// Width of the dialog, and the most height of its list, points.
const DIALOG: [f32; 2] = [560.0, 460.0];
const SEARCH: &str = "Search effects to add";

const TILING: Tiling = Tiling {
    width: 72.0,
    name: 20.0,
    margin: 2.0,
    gap: theme::HALF,
    list: None,
};

impl EffectBrowser {
    /// Opens the dialog that adds an effect.
    pub fn begin_adding(&mut self, search: String) {
        self.adding = Some(search);
    }

    /// Is that dialog open?
    pub fn is_adding(&self) -> bool {
        self.adding.is_some()
    }

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
            self.pictures.take_picture(ctx, &name, None);
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
        self.pictures.take_picture(ctx, effect, image);
    }

    /// Shows the browser in its tab.
    pub fn tab_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.horizontal(|ui| {
            let side = ui.spacing().interact_size.y;
            ui.scope(|ui| {
                ui.set_max_width(ui.available_width() - side - theme::GAP);
                search_ui(ui, &mut self.search, "Search effects");
            });
            star_toggle(ui, &mut self.only_favorites, "Favorite effects only");
        });
        ui.add_space(theme::HALF);
        let is_kept = |effect: &Effect| {
            !self.only_favorites || state.files.favorites.has(Starred::Effect, &effect.name)
        };
        let groups = group_effects(&all_effects(state), &self.search, is_kept);
        ScrollArea::vertical()
            .id_salt("effects")
            .auto_shrink(false)
            .show(ui, |ui| {
                let search = self.search.clone();
                self.groups_ui(ui, state, commands, (&groups, &search));
                if groups.is_empty() && ui.small_button("Show all effects").clicked() {
                    (self.search, self.only_favorites) = (String::new(), false);
                }
            });
    }

    /// Shows the dialog that adds an effect, if it is open: a search, and the effects that are not
    /// in the stack. Enter adds the one that answers best.
    pub fn dialog_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let Some(mut search) = self.adding.take() else {
            return;
        };
        let area = ui.ctx().content_rect();
        let stack = &state.session.preset().stack;
        let all = all_effects(state);
        let is_absent = |effect: &Effect| stack.get(&effect.name).is_none();
        let modal =
            modal(ui.ctx(), "add effect", 12.0).backdrop_color(egui::Color32::from_black_alpha(60));
        let shown = modal.show(ui.ctx(), |ui| {
            ui.set_width(DIALOG[0].min(area.width() - 48.0));
            ui.label(theme::title("Add effect"));
            ui.add_space(theme::HALF);
            let field = search_ui(ui, &mut search, SEARCH);
            let is_entered = is_entered(ui, &field);
            ui.add_space(theme::HALF);
            let groups = group_effects(&all, &search, is_absent);
            ScrollArea::vertical()
                .id_salt("effects to add")
                .auto_shrink([false, true])
                .max_height(DIALOG[1].min(area.height() - 200.0).max(80.0))
                .show(ui, |ui| {
                    ui.spacing_mut().item_spacing.y = 2.0;
                    self.groups_ui(ui, state, commands, (&groups, &search))
                });
            let is_best = is_entered && !search.trim().is_empty();
            best(&groups, &search).filter(|_| is_best)
        });
        let (is_closed, entered) = (shown.should_close(), shown.inner);
        if let Some(effect) = entered {
            add(
                commands,
                effect,
                stack.rival_of(effect).map(|rival| rival.name.as_str()),
            );
        } else if !is_closed && !self.has_added {
            self.adding = Some(search);
        }
        self.has_added = false;
    }

    /// The groups with their tiles, and what leads to an effect of one's own.
    fn groups_ui(
        &mut self,
        ui: &mut Ui,
        state: &State,
        commands: &Commands,
        (groups, search): (&[ShownGroup<'_>], &str),
    ) {
        self.follow_scene(state);
        self.pictures.begin_frame();
        for (group, effects) in groups {
            self.group_ui(ui, state, commands, *group, effects);
        }
        if groups.is_empty() {
            let all = all_effects(state);
            let near = did_you_mean(search, all.iter().map(|effect| effect.name.as_str()));
            ui.label(theme::weak(format!("No effect answers{near}")));
        }
        ui.add_space(theme::GAP);
        let own = ui
            .button("New effect…")
            .on_hover_text("Write an effect of your own, in one WGSL file");
        if own.accessible_name("Write a new effect").clicked() {
            self.has_added = true;
            commands.perform(Action::NewEffect);
        }
        ui.add_space(theme::GAP);
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
            let about = theme::weak(group.about()).size(11.5);
            ui.add(egui::Label::new(about).truncate());
        });
        let stack = &state.session.preset().stack;
        TILING.show(ui, effects, |ui, effect, rect| {
            let name = &effect.name;
            let is_seen = ui.is_rect_visible(rect);
            let is_enabled = stack.get(name).is_some();
            let rival = stack.rival_of(effect).map(|rival| rival.name.as_str());
            let is_favorite = state.files.favorites.has(Starred::Effect, name);
            let tile = Tile {
                kind: "Effect",
                id: name,
                title: name,
                name: name.replace('_', " "),
                about: String::new(),
                picture: self.pictures.picture(name, Size::Small, is_seen),
                is_chosen: is_enabled,
                is_modified: false,
                is_favorite,
                is_faulty: false,
            };
            let [tile, star] = tile.show(ui, TILING, rect, egui::Sense::click_and_drag());
            tile.dnd_set_drag_payload(StackDrag::Enable((*effect).clone()));
            tile.context_menu(|ui| effect_menu::menu_ui(ui, state, commands, effect));
            if star.clicked() {
                let name = name.clone();
                commands.run(move |app| library::star(app, Starred::Effect, &name, !is_favorite));
            }
            if tile.clicked() {
                self.has_added = true;
                // Enables it in place of its rival if there is one, or disables it.
                match is_enabled {
                    true => commands.edit(Edit::Disable((*effect).clone())),
                    false => add(commands, effect, rival),
                }
            }
            tile.on_hover_ui(|ui| about_ui(ui, effect, is_enabled, rival));
        });
        ui.add_space(theme::HALF);
    }
}

/// What a tile says on hover.
fn about_ui(ui: &mut Ui, effect: &Effect, is_enabled: bool, rival: Option<&str>) {
    ui.label(theme::strong(&effect.name));
    ui.label(&effect.about);
    ui.label(theme::weak(format!("Hooks: {}", effect.hooks.names())));
    let action = match (is_enabled, rival) {
        (true, _) => "Click to take it out of the stack".to_owned(),
        (false, Some(rival)) => format!("Click to use it instead of {rival}"),
        (false, None) => "Click to enable it, or drag it to its place in the stack".to_owned(),
    };
    ui.label(theme::weak(action));
}

/// The dialog that adds an effect; the tab belongs to the browser of presets.
impl Panel for EffectBrowser {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        self.dialog_ui(ui, state, commands);
    }
}

/// Every effect that the open preset may use.
fn all_effects(state: &State) -> Vec<&Arc<Effect>> {
    let preset_file = &state.session.preset_file;
    let stack = &preset_file.preset.stack.0;
    preset_file
        .effects
        .effects_with(stack.iter().map(|enabled| &enabled.effect))
}

/// Enables an effect, in place of its rival if there is one, and shows it in the inspector.
fn add(commands: &Commands, effect: &Arc<Effect>, rival: Option<&str>) {
    let name = &effect.name;
    match rival {
        Some(rival) => {
            commands.edit(Edit::Replace(rival.into(), effect.clone()));
            let text =
                format!("{name} replaced {rival}: both take the same slot of the rasterizer");
            commands.notify(Level::Info, text);
        }
        None => commands.edit(Edit::Enable(effect.clone())),
    }
    commands.reveal(name.into());
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
                preset.stack.enable(Effect::named("lambert"));
            }
            preset.stack.enable(effect);
        }
    }
    preset
}
