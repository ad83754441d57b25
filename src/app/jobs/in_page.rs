//! The jobs of a page. Workers do what takes long, from the text of a preset.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use js_sys::Uint8Array;

use super::{
    Jobs, THUMBNAIL_TRIANGLES, done,
    finished::{
        take_effect_picture, take_golden, take_link, take_precision, take_thumbnail,
        take_thumbnail_on, take_trade,
    },
    land_look, worker,
    worker::{Question, Task, Wish},
};
use crate::{
    app::{
        editing::session::FileId,
        files::{command::Purpose, scene_loader::SceneKey, system_dialog},
        picture::{
            apply::{take_blessed, take_reviewed, take_verdict},
            effect_picture::EffectPicture,
            findings::Findings,
            golden_check::{self, GoldenCheck, Outcome},
            precision::{self, Measured},
            review,
            screen::Inputs,
        },
        shell::page,
        trade::{
            point::Point,
            request::{Progress, Request},
            sent,
        },
        window::input,
    },
    link,
    preset::Preset,
    preset_file::{self, Folders, PresetFile},
    scene::Scene,
    work::Work,
};

/// What a review says here.
const NO_GOLDENS: &str = "a page reviews no goldens";

impl Jobs {
    /// Refuses to draw a preset for the review of goldens.
    pub fn draw_golden(&self, name: String, _: Folders) {
        self.spawn("review", move || {
            done(move |app| take_reviewed(&mut app.state, &name, Err(NO_GOLDENS.into())))
        });
    }

    /// Refuses to make a picture a golden.
    pub fn bless(&self, name: String, _: Folders, _: Arc<review::Drawn>) {
        self.spawn("bless", move || {
            done(move |app| take_blessed(&mut app.state, &name, Err(NO_GOLDENS.into())))
        });
    }

    /// Draws `inputs`, which the preset says, and judges the picture with the oracle.
    pub fn verify_in_worker(&self, preset_file: PresetFile, inputs: Inputs, work: Arc<Work>) {
        self.spawn_waiting("verify", async move || {
            let size = [inputs.view.width, inputs.view.height];
            let is_canceled = || work.is_canceled();
            let asked =
                worker::ask(Task::Judge, &preset_file, size, work.clone(), is_canceled).await;
            let received = |sent| Findings::received(sent, &inputs.stack).map(Box::new);
            let judged = asked.and_then(|sent| sent.map(received).transpose());
            done(move |app| take_verdict(app, inputs, &work, judged))
        });
    }

    /// Measures combinations of accuracy options in a worker, on a device of its own; the preset is
    /// that of the request as a file.
    pub fn measure_in_worker(
        &self,
        preset_file: PresetFile,
        scene: Arc<Scene>,
        request: Request,
        progress: Arc<Progress>,
    ) {
        self.spawn_waiting("trade", async move || {
            let measured = measured(&preset_file, &scene, &request, &progress).await;
            done(move |app| take_trade(app, measured))
        });
    }

    /// Fetches the golden of a preset of the gallery, or has its picture drawn.
    pub fn thumbnail(&self, preset_file: PresetFile, size: [u32; 2]) {
        self.spawn_idle("thumbnail", async move || {
            let image = match page::golden(&preset_file.id).await {
                Ok((colors, size)) => Some(image(colors.as_flattened(), size)),
                Err(_) => picture(&preset_file, size).await,
            };
            done(move |app| take_thumbnail(app, &preset_file.id, image))
        });
    }

    /// Draws the picture of a preset on the scene of `own`.
    pub fn thumbnail_on(
        &self,
        look: PresetFile,
        own: PresetFile,
        scene: Arc<Scene>,
        size: [u32; 2],
    ) {
        self.spawn_idle("thumbnail", async move || {
            let image = match land_look(&look, &own, &scene) {
                Some(landed) => picture(&landed, size).await,
                None => None,
            };
            let key = SceneKey::of(&own);
            done(move |app| take_thumbnail_on(app, &key, &look.id, image))
        });
    }

    /// Draws the picture of an effect on the open model.
    pub fn effect_picture(&self, asked: EffectPicture) {
        self.spawn_idle("effect picture", async move || {
            let preset_file = PresetFile::new("effect", asked.preset);
            let is_unwanted = asked.cancelled.load(Ordering::Relaxed)
                || asked.scene.triangle_count() > THUMBNAIL_TRIANGLES;
            let image = match is_unwanted {
                true => None,
                false => picture(&preset_file, asked.size).await,
            };
            done(move |app| take_effect_picture(app, &asked.effect, image))
        });
    }

    /// Measures the f32 errors of the effects in `inputs`, which the preset says; on the
    /// thread of the page where no preset does.
    pub fn measure_precision(
        &self,
        preset_file: Option<PresetFile>,
        inputs: Inputs,
        cancelled: Arc<AtomicBool>,
    ) {
        self.spawn_waiting("precision", async move || {
            let measured = match preset_file {
                None => precision::measure(&inputs, &cancelled),
                Some(preset_file) => {
                    let size = [inputs.view.width, inputs.view.height];
                    let is_canceled = || cancelled.load(Ordering::Relaxed);
                    let task = Task::Precision;
                    let asked =
                        worker::ask(task, &preset_file, size, Arc::default(), is_canceled).await;
                    let received = |sent| Measured::received(sent, &inputs);
                    asked.and_then(|sent| sent.map(received).transpose())
                }
            };
            let measured = measured.map(|measured| measured.map(Box::new));
            done(move |app| take_precision(app, inputs, measured))
        });
    }

    /// Makes the link to the page beside the window with the line of a preset, and the bits of its
    /// picture.
    pub fn link(&self, _: String, line: String, preset_file: PresetFile, _: Arc<Scene>) {
        self.spawn_idle("link", async move || {
            let size = preset_file.preset.output.size;
            let asked = worker::ask(Task::Bits, &preset_file, size, Arc::default(), || false).await;
            let bits = asked.map(|bits| bits.and_then(|bits| bits.as_string()));
            let known = bits.as_ref().ok().and_then(Option::as_deref);
            let address = link::address(&page::beside(), &line, known);
            done(move |app| take_link(app, address, bits.err()))
        });
    }

    /// Draws the golden of a preset of the gallery again and compares.
    pub fn check_golden(&self, number: u64, preset_file: PresetFile) {
        self.spawn_idle("golden", async move || {
            let check = match page::golden(&preset_file.id).await {
                Ok((golden, size)) => Some(GoldenCheck {
                    file: FileId::of(&preset_file),
                    golden: page::golden_name(&preset_file.id).into(),
                    outcome: compared(&preset_file, &golden, size)
                        .await
                        .unwrap_or_else(Outcome::Failed),
                }),
                Err(_) => None,
            };
            done(move |app| take_golden(app, number, check))
        });
    }

    /// Asks for files to be opened.
    pub fn ask_files(&self) {
        let extensions = system_dialog::extensions(Purpose::Open);
        self.spawn_idle("files", async move || {
            let given = page::ask_files(&extensions).await;
            done(move |app| input::take_given(app, given))
        });
    }

    /// Reads files that were dropped.
    pub fn take_dropped(&self, files: Vec<egui::DroppedFileHandle>) {
        self.spawn_idle("files", async move || {
            let given = page::take_dropped(files).await;
            done(move |app| input::take_given(app, given))
        });
    }
}

/// What a worker measures. Canceled, it ends as soon as it hears that, with what has been timed; it
/// hears nothing while the oracle draws its references, and has timed nothing then.
///
/// # Errors
/// No text says what is to be measured, or the worker cannot: why, in one sentence.
async fn measured(
    preset_file: &PresetFile,
    scene: &Scene,
    request: &Request,
    progress: &Arc<Progress>,
) -> Result<Vec<Point>, String> {
    let size = request.size;
    let text = preset_file::to_shared_toml(preset_file);
    let said = preset_file::parse(&text, "preset").map_err(|error| error.to_string())?;
    let drawn = |preset: &Preset| (preset.view(scene, size), preset.stack_on(scene, size));
    if drawn(&said.preset) != drawn(&request.preset) {
        return Err("the text of the preset says another picture than this one, so no worker can measure it".into());
    }
    let hearing = progress.clone();
    let told = move |text: String| {
        sent::heard(&text)
            .into_iter()
            .for_each(|report| hearing.report(report))
    };
    let wish = || match (progress.is_canceled(), progress.pause_left()) {
        (true, _) if !progress.has_reference() => Wish::End,
        (true, _) => Wish::Stop,
        (false, Duration::ZERO) => Wish::GoOn,
        (false, left) => Wish::Pause(left),
    };
    let question = Question {
        task: Task::Trade,
        preset_file,
        size,
        axes: &sent::names(&request.axes),
    };
    match worker::converse(&question, told, wish).await? {
        Some(answer) => sent::received(&answer.as_string().unwrap_or_default()),
        None => Ok(Vec::new()),
    }
}

/// The oracle's picture of a preset, RGBA, drawn by a worker.
///
/// # Errors
/// The worker cannot: why, in one sentence.
async fn drawn(preset_file: &PresetFile, size: [u32; 2]) -> Result<Vec<u8>, String> {
    let asked = worker::ask(Task::Picture, preset_file, size, Arc::default(), || false).await?;
    let colors = Uint8Array::new(&asked.unwrap_or_default()).to_vec();
    let [width, height] = size.map(|side| side as usize);
    match colors.len() == 4 * width * height {
        true => Ok(colors),
        false => Err("a worker of the page has drawn another size".into()),
    }
}

async fn picture(preset_file: &PresetFile, size: [u32; 2]) -> Option<egui::ColorImage> {
    let colors = drawn(preset_file, size).await.ok()?;
    Some(image(&colors, size))
}

fn image(colors: &[u8], size: [u32; 2]) -> egui::ColorImage {
    egui::ColorImage::from_rgba_unmultiplied(size.map(|side| side as usize), colors)
}

/// Compares the oracle's picture of a preset with its golden of this size.
async fn compared(
    preset_file: &PresetFile,
    golden: &[[u8; 4]],
    size: [u32; 2],
) -> Result<Outcome, String> {
    golden_check::check_size(size, preset_file.preset.output.size)?;
    let colors = drawn(preset_file, size).await?;
    Ok(golden_check::difference(golden, colors.as_chunks().0))
}
