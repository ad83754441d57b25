//! The pictures of the gallery: of each preset with its own scene, or on the user's own scene. Only
//! what is in view is drawn, one picture at a time, and it is kept.

use std::sync::{Arc, Weak};

use egui::{self, ColorImage, Context, TextureHandle, Ui};

use super::thumbnails::{Size, Thumbnails};
use crate::{
    app::{editing::session::Session, files::scene_loader::SceneKey},
    preset_file::{GalleryEntry, PresetFile},
    scene::Scene,
};

/// Most scenes of the user whose pictures are kept.
const MAX_SCENES: usize = 3;

/// The pictures of the gallery.
#[derive(Default)]
pub struct Pictures {
    /// With the scene of each preset.
    own: Thumbnails,
    /// The user wants them on the open model.
    is_on_model: bool,
    /// On scenes of the user, the one that was shown last first.
    on_models: Vec<OnModel>,
}

/// Pictures of presets on a scene of the user.
struct OnModel {
    key: SceneKey,
    /// The scene as it was when they were drawn: a model that changes on disk becomes another one.
    scene: Weak<Scene>,
    thumbnails: Thumbnails,
}

impl Pictures {
    /// True while a picture in view is still to come.
    pub fn is_busy(&self) -> bool {
        self.own.is_busy() || self.on_models.iter().any(|on| on.thumbnails.is_busy())
    }

    /// The gallery is about to be shown, or is hidden: what is in view is told anew.
    pub fn begin_frame(&mut self) {
        self.own.begin_frame();
        self.on_models
            .iter_mut()
            .for_each(|on| on.thumbnails.begin_frame());
    }

    /// The preset `id` is another one now.
    pub fn changed(&mut self, id: &str) {
        self.own.changed(id);
        self.on_models
            .iter_mut()
            .for_each(|on| on.thumbnails.changed(id));
    }

    /// The switch for pictures on the user's own scene.
    pub fn switch_ui(&mut self, ui: &mut Ui, session: &Session) {
        let open = &session.preset_file;
        if open.has_own_scene() {
            let text = format!("Thumbnails on {}", open.scene_name());
            ui.checkbox(&mut self.is_on_model, text)
                .on_hover_text("Show every preset on this model, drawn as it comes into view");
        }
    }

    /// The picture of a preset: on the user's own scene if the switch says so, and until that is
    /// drawn with its own.
    pub fn picture(
        &mut self,
        entry: &GalleryEntry,
        session: &Session,
        size: Size,
        is_in_view: bool,
    ) -> Option<&TextureHandle> {
        let open = &session.preset_file;
        if !self.is_on_model || !open.has_own_scene() || !may_be_drawn(entry) {
            return self.own.picture(&entry.id, size, is_in_view);
        }
        let key = SceneKey::of(open);
        let Some(scene) = session.scenes.shown_for(&key) else {
            return self.own.picture(&entry.id, size, false);
        };
        let thumbnails = on_model(&mut self.on_models, &key, scene);
        let is_impossible = thumbnails.has_failed(&entry.id, size);
        let drawn = thumbnails.picture(&entry.id, size, is_in_view);
        drawn.or_else(|| {
            self.own
                .picture(&entry.id, size, is_in_view && is_impossible)
        })
    }

    /// The preset of `entries` that is drawn next with its own scene, and its size in pixels; none
    /// while one is being drawn.
    pub fn next(
        &mut self,
        ctx: &Context,
        entries: &[GalleryEntry],
    ) -> Option<(PresetFile, [u32; 2])> {
        next_of(&mut self.own, ctx, entries)
    }

    /// The preset that is drawn next on the scene of `key`, the user's own; none while another is
    /// being drawn.
    pub fn next_on_model(
        &mut self,
        ctx: &Context,
        key: &SceneKey,
        entries: &[GalleryEntry],
    ) -> Option<(PresetFile, [u32; 2])> {
        if self.on_models.iter().any(|on| on.thumbnails.is_drawing()) {
            return None;
        }
        let on = self.on_models.iter_mut().find(|on| on.key == *key)?;
        next_of(&mut on.thumbnails, ctx, entries)
    }

    /// Takes a picture that was drawn; none if the scene is too large or broken.
    pub fn take_picture(&mut self, ctx: &Context, id: &str, image: Option<ColorImage>) {
        self.own.take_picture(ctx, id, image);
    }

    /// Takes a picture on the user's own scene; none if the preset or the scene does not allow it.
    pub fn on_model_arrived(
        &mut self,
        ctx: &Context,
        key: &SceneKey,
        id: &str,
        image: Option<ColorImage>,
    ) {
        if let Some(on) = self.on_models.iter_mut().find(|on| on.key == *key) {
            on.thumbnails.take_picture(ctx, id, image);
        }
    }
}

/// The pictures on the scene of `key`.
fn on_model<'a>(
    on_models: &'a mut Vec<OnModel>,
    key: &SceneKey,
    scene: &Arc<Scene>,
) -> &'a mut Thumbnails {
    match on_models.iter().position(|on| on.key == *key) {
        Some(index) => on_models[..=index].rotate_right(1),
        None => {
            on_models.truncate(MAX_SCENES - 1);
            on_models.insert(
                0,
                OnModel {
                    key: key.clone(),
                    scene: Arc::downgrade(scene),
                    thumbnails: Thumbnails::default(),
                },
            );
        }
    }
    let on = &mut on_models[0];
    if on.scene.as_ptr() != Arc::as_ptr(scene) {
        on.scene = Arc::downgrade(scene);
        on.thumbnails.all_changed();
    }
    &mut on.thumbnails
}

/// The code of a preset runs only after the user has allowed it, so a preset that brings code has
/// no picture.
fn may_be_drawn(entry: &GalleryEntry) -> bool {
    entry
        .preset_file
        .as_ref()
        .is_ok_and(|found| found.brought_effects.is_empty())
}

fn next_of(
    thumbnails: &mut Thumbnails,
    ctx: &egui::Context,
    entries: &[GalleryEntry],
) -> Option<(PresetFile, [u32; 2])> {
    let (id, size) = thumbnails.next()?;
    let found = entries
        .iter()
        .find(|entry| entry.id == id)
        .filter(|entry| may_be_drawn(entry));
    let Some(found) = found.and_then(|entry| entry.preset_file.as_ref().ok()) else {
        thumbnails.take_picture(ctx, &id, None);
        return None;
    };
    Some((found.clone(), size.pixels()))
}
