//! The jobs of threads that a page has in another way: what the oracle draws beside the window.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::{
    Done, Jobs, background, caught, caught_future, done,
    finished::{
        take_effect_picture, take_golden, take_link, take_precision, take_thumbnail,
        take_thumbnail_on, take_trade,
    },
    giving_back, land_look, memory, small_picture,
};
use crate::{
    app::{
        files::scene_loader::SceneKey,
        picture::{
            apply::{take_blessed, take_reviewed},
            effect_picture::EffectPicture,
            golden_check, precision, review,
            screen::Inputs,
        },
        trade::{
            measure,
            request::{Progress, Request},
        },
    },
    gpu::{Gpu, device::AdapterChoice},
    link,
    preset::Preset,
    preset_file::{self, Folders, PresetFile},
    scene::Scene,
};

impl Jobs {
    /// Measures the f32 errors of the effects with the oracle.
    pub fn measure_precision(&self, inputs: Inputs, cancelled: Arc<AtomicBool>) {
        self.spawn("precision", move || {
            let measure = || precision::measure(&inputs, &cancelled);
            let measured = caught("measuring the f32 error", || {
                giving_back(|| background::compute(measure)).map(|measured| measured.map(Box::new))
            });
            done(move |app| take_precision(app, inputs, measured))
        });
    }

    /// Measures combinations of accuracy options on a second device of this adapter, so that the
    /// window stays responsive.
    pub fn measure(
        &self,
        adapter: String,
        scene: Arc<Scene>,
        request: Request,
        progress: Arc<Progress>,
    ) {
        // What it measures is time, so it yields to nothing.
        self.spawn_waiting("trade", move || async move {
            let work = async {
                let opened = Gpu::open(&AdapterChoice::Named(adapter)).await;
                let gpu = opened.map_err(|error| error.to_string())?;
                measure::measure(&gpu, &scene, &request, &progress).await
            };
            let measured = caught_future("measuring the trade", work).await;
            memory::give_back();
            done(move |app| take_trade(app, measured))
        });
    }

    /// Draws the golden of a preset again and compares.
    pub fn check_golden(&self, number: u64, preset_file: PresetFile) {
        self.spawn_oracle("golden", move || {
            let checked = caught("drawing the golden", || {
                Ok(golden_check::check(&preset_file))
            });
            done(move |app| take_golden(app, number, checked.ok().flatten()))
        });
    }

    /// Draws a preset for the review of goldens.
    pub fn draw_golden(&self, name: String, folders: Folders) {
        self.spawn_oracle("review", move || {
            let drawn = caught("drawing a golden", || review::draw(&name, &folders));
            done(move |app| take_reviewed(&mut app.state, &name, drawn))
        });
    }

    /// Makes the picture that the review has shown the golden of a preset.
    pub fn bless(&self, name: String, folders: Folders, shown: Arc<review::Drawn>) {
        self.spawn_oracle("bless", move || {
            let blessed = caught("drawing a golden", || {
                review::bless(&name, &folders, &shown)
            });
            done(move |app| take_blessed(&mut app.state, &name, blessed))
        });
    }

    /// Makes the link to `page` with the line of a preset on its scene, and the bits of its picture.
    pub fn link(&self, page: String, line: String, preset_file: PresetFile, scene: Arc<Scene>) {
        self.spawn_oracle("link", move || {
            let bits = caught("drawing the picture of the link", || {
                link::bits(&preset_file.preset, &scene)
            });
            let address = link::address(&page, &line, bits.as_deref().ok());
            done(move |app| take_link(app, address, bits.err()))
        });
    }

    /// Draws the picture of a preset with the oracle, which needs no device. Width and height are
    /// in pixels.
    pub fn thumbnail(&self, preset_file: PresetFile, size: [u32; 2]) {
        self.spawn_oracle("thumbnail", move || {
            let image = caught("drawing a thumbnail", || {
                thumbnail(&preset_file, size).ok_or_else(String::new)
            });
            done(move |app| take_thumbnail(app, &preset_file.id, image.ok()))
        });
    }

    /// Draws the picture of a preset on the scene of `own` with the oracle.
    pub fn thumbnail_on(
        &self,
        look: PresetFile,
        own: PresetFile,
        scene: Arc<Scene>,
        size: [u32; 2],
    ) {
        self.spawn_oracle("thumbnail", move || {
            let image = caught("drawing a thumbnail", || {
                thumbnail_on(&look, &own, &scene, size).ok_or_else(String::new)
            });
            let key = SceneKey::of(&own);
            done(move |app| take_thumbnail_on(app, &key, &look.id, image.ok()))
        });
    }

    /// Draws the picture of an effect on the open model with the oracle.
    pub fn effect_picture(
        &self,
        EffectPicture {
            effect,
            preset,
            scene,
            size,
            cancelled,
        }: EffectPicture,
    ) {
        self.spawn_oracle("effect picture", move || {
            let draw = || match cancelled.load(Ordering::Relaxed) {
                true => Err(String::new()),
                false => thumbnail_of(&preset, &scene, size).ok_or_else(String::new),
            };
            let image = caught("drawing a picture of an effect", draw).ok();
            done(move |app| take_effect_picture(app, &effect, image))
        });
    }

    /// Draws pictures with the oracle.
    fn spawn_oracle(&self, name: &str, work: impl FnOnce() -> Done + Send + 'static) {
        self.spawn(name, || background::compute(work));
    }
}

fn thumbnail(preset_file: &PresetFile, size: [u32; 2]) -> Option<egui::ColorImage> {
    let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref()).ok()?;
    thumbnail_of(&preset_file.preset, &scene, size)
}

fn thumbnail_on(
    look: &PresetFile,
    own: &PresetFile,
    scene: &Scene,
    size: [u32; 2],
) -> Option<egui::ColorImage> {
    let preset = land_look(look, own, scene)?.preset;
    if preset.ground == own.preset.ground && preset.room == own.preset.room {
        return thumbnail_of(&preset, scene, size);
    }
    thumbnail_of(
        &preset,
        &*preset_file::load_scene(&preset, None).ok()?,
        size,
    )
}

/// The picture of a preset on `scene`; none if the scene is too large or the preset cannot be
/// drawn.
fn thumbnail_of(preset: &Preset, scene: &Scene, size: [u32; 2]) -> Option<egui::ColorImage> {
    let colors = small_picture(preset, scene, size)?;
    Some(egui::ColorImage::from_rgba_unmultiplied(
        size.map(|side| side as usize),
        colors.as_flattened(),
    ))
}
