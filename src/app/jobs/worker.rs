//! Workers of a page. Each has an instance of the module for itself and does one task after another,
//! while the page goes on. The text of a preset and the files that the page was given say what to do.

use std::{
    cell::RefCell,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use js_sys::{Array, Function, Promise, Uint8Array};
use wasm_bindgen::{JsCast as _, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{DedicatedWorkerGlobalScope, Event, MessageEvent, Worker, WorkerOptions, WorkerType};

use super::{small_picture, threads, verify};
use crate::{
    app::{
        files::scene_loader::SceneKey,
        picture::{inputs::Inputs, precision},
        shell::page::GIVEN,
        trade::{
            measure,
            request::{Progress, Report, Request},
            sent,
        },
    },
    gpu::{Gpu, device::AdapterChoice},
    host::disk,
    link,
    preset_file::{self, PresetFile},
    scene::Scene,
    work::Work,
};

/// The script of a worker, beside the page.
const SCRIPT: &str = "window_worker.js";

/// How often a page looks whether what a worker does is still wanted.
const LOOK: Duration = Duration::from_millis(50);

/// The stages that a worker tells by name.
const STAGES: [&str; 7] = [
    "drawing",
    "vertices",
    "coverage",
    "the whole picture",
    "colors",
    "the error map",
    "the reference picture",
];

/// What a worker does with a preset.
#[derive(Clone, Copy, Debug)]
pub enum Task {
    /// Draws it on a device of its own and judges the picture. The answer is that of
    /// [`Findings::sent`](crate::app::picture::findings::Findings::sent).
    Judge,
    /// Draws its picture with the oracle, as RGBA.
    Picture,
    /// Measures the f32 errors of the effects, as TOML.
    Precision,
    /// Finds the bits of its picture for a link.
    Bits,
    /// Measures combinations of the options of axes on a device of its own. The answer is that of
    /// [`sent::sent`].
    Trade,
}

impl Task {
    const ALL: [Self; 5] = [
        Self::Judge,
        Self::Picture,
        Self::Precision,
        Self::Bits,
        Self::Trade,
    ];
}

/// What a worker is asked.
pub struct Question<'a> {
    pub task: Task,
    pub preset_file: &'a PresetFile,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Names of the axes that are measured; empty where none are.
    pub axes: &'a str,
}

/// What the page wishes of a worker meanwhile.
pub enum Wish {
    GoOn,
    /// It waits for so long.
    Pause(Duration),
    /// It ends with what it has.
    Stop,
    /// It ends at once and gives no answer.
    End,
}

/// A worker that waits for its next task.
struct Idle {
    worker: Worker,
    /// [`disk::puts`] when it was given the files of the page.
    puts: u64,
}

thread_local! {
    static IDLE: RefCell<Vec<Idle>> = const { RefCell::new(Vec::new()) };
}

/// Has a worker do `task` with a preset at `size` pixels; `work` is told the stages. Returns the
/// answer; none if the worker was ended because `is_canceled`.
///
/// # Errors
/// The worker cannot: why, in one sentence.
pub async fn ask(
    task: Task,
    preset_file: &PresetFile,
    size: [u32; 2],
    work: Arc<Work>,
    is_canceled: impl Fn() -> bool,
) -> Result<Option<JsValue>, String> {
    let question = Question {
        task,
        preset_file,
        size,
        axes: "",
    };
    let told = move |told: String| {
        let stage = STAGES.into_iter().find(|stage| *stage == told);
        work.begin(stage.unwrap_or("judging"));
    };
    let wish = || match is_canceled() {
        true => Wish::End,
        false => Wish::GoOn,
    };
    converse(&question, told, wish).await
}

/// Asks a worker; `told` is given what it tells meanwhile. Returns the answer; none if the worker
/// was ended by the wish for that.
///
/// # Errors
/// The worker cannot: why, in one sentence.
pub async fn converse(
    question: &Question<'_>,
    told: impl Fn(String) + 'static,
    wish: impl Fn() -> Wish,
) -> Result<Option<JsValue>, String> {
    let failed = |_| "the browser starts no worker".to_owned();
    let idle = IDLE.with_borrow_mut(Vec::pop);
    let Idle { worker, puts: had } = idle.map_or_else(started, Ok).map_err(failed)?;
    let puts = disk::puts();
    let question = Array::from_iter([
        JsValue::from(question.task as u32),
        preset_file::to_shared_toml(question.preset_file).into(),
        question.size[0].into(),
        question.size[1].into(),
        (had != puts).then(given).into(),
        question.axes.into(),
    ]);
    let mut hears = None;
    let mut told = Some(told);
    let answered = Promise::new(&mut |resolve: Function, _: Function| {
        hears = told.take().map(|told| hear(&worker, resolve, told));
    });
    let say = |word: &JsValue| worker.post_message(word).map_err(failed);
    say(&Array::of2(&wasm_bindgen::module(), &question))?;
    loop {
        let first = Promise::race(&Array::of2(&answered, &threads::wait(LOOK)));
        let answer = JsFuture::from(first).await.map_err(failed)?;
        match wish() {
            Wish::GoOn => {}
            Wish::Pause(wait) => say(&(wait.as_secs_f64() * 1e3).into())?,
            Wish::Stop => say(&JsValue::UNDEFINED)?,
            Wish::End => {
                worker.terminate();
                return Ok(None);
            }
        }
        let Ok(answer) = answer.dyn_into::<Array>() else {
            continue;
        };
        drop(hears);
        if let Some(error) = answer.get(1).as_string() {
            worker.terminate();
            return Err(error);
        }
        IDLE.with_borrow_mut(|idle| idle.push(Idle { worker, puts }));
        return Ok(Some(answer.get(0)));
    }
}

fn started() -> Result<Idle, JsValue> {
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker = Worker::new_with_options(SCRIPT, &options)?;
    Ok(Idle { worker, puts: 0 })
}

/// The files that the page was given: a path and bytes each.
fn given() -> JsValue {
    let pair = |(path, bytes): (PathBuf, Arc<[u8]>)| {
        let path = path.to_string_lossy().into_owned();
        Array::of2(&path.into(), &Uint8Array::from(&*bytes).into())
    };
    Array::from_iter(disk::below(Path::new(GIVEN)).into_iter().map(pair)).into()
}

/// What hears a worker: its words are told, an array is the end.
type Hears = (Closure<dyn FnMut(MessageEvent)>, Closure<dyn FnMut(Event)>);

fn hear(worker: &Worker, resolve: Function, told: impl Fn(String) + 'static) -> Hears {
    let end = resolve.clone();
    let message = Closure::new(move |event: MessageEvent| match event.data().as_string() {
        Some(words) => told(words),
        None => drop(end.call1(&JsValue::NULL, &event.data())),
    });
    let error = Closure::new(move |_: Event| {
        let answer = Array::of2(&JsValue::UNDEFINED, &"a worker of the page failed".into());
        drop(resolve.call1(&JsValue::NULL, &answer));
    });
    worker.set_onmessage(Some(message.as_ref().unchecked_ref()));
    worker.set_onerror(Some(error.as_ref().unchecked_ref()));
    (message, error)
}

thread_local! {
    /// The device of this worker.
    static DEVICE: RefCell<Option<Arc<Gpu>>> = const { RefCell::new(None) };
    /// The scene of its last task.
    static SCENE: RefCell<Option<(SceneKey, Arc<Scene>)>> = const { RefCell::new(None) };
    /// The measurement under way.
    static MEASURING: RefCell<Option<Arc<Progress>>> = const { RefCell::new(None) };
}

/// Has the measurement under way in this worker wait for so many milliseconds, or end with what it
/// has. Nothing where none is under way.
pub fn heed(pause_ms: Option<f64>) {
    let Some(progress) = MEASURING.with_borrow(Clone::clone) else {
        return;
    };
    match pause_ms {
        Some(ms) => progress.pause_for(Duration::try_from_secs_f64(ms / 1e3).unwrap_or_default()),
        None => progress.cancel(),
    }
}

/// Does the task of this number, in a worker; `files` are new ones, where there are any, and `axes`
/// the names of those that are measured.
///
/// # Errors
/// It cannot be done: why, in one sentence.
pub async fn answer(
    task: u32,
    text: &str,
    size: [u32; 2],
    files: Option<Array>,
    axes: &str,
) -> Result<JsValue, String> {
    for file in files.iter().flat_map(Array::iter) {
        let file: Array = file.unchecked_into();
        let path = file.get(0).as_string().unwrap_or_default();
        disk::put(Path::new(&path), &Uint8Array::new(&file.get(1)).to_vec());
        SCENE.take();
    }
    let preset_file = preset_file::parse(text, "preset").map_err(|error| error.to_string())?;
    let scene = scene_of(&preset_file)?;
    let task = Task::ALL.into_iter().find(|known| *known as u32 == task);
    match task.ok_or("this is no task of a worker")? {
        Task::Judge => {
            let work = Arc::new(Work::telling(|stage| tell(stage)));
            let inputs = Inputs::of(preset_file, scene, size);
            let found = verify(device().await?, &inputs, &work).await?;
            found.ok_or("it was canceled")?.sent()
        }
        Task::Picture => {
            let colors = small_picture(&preset_file.preset, &scene, size);
            let colors = colors.ok_or("the oracle does not draw it")?;
            Ok(Uint8Array::from(colors.as_flattened()).into())
        }
        Task::Bits => Ok(link::bits(&preset_file.preset, &scene)?.into()),
        Task::Precision => {
            let inputs = Inputs::of(preset_file, scene, size);
            let measured = precision::measure(&inputs, &Arc::default())?;
            measured.ok_or("it was canceled")?.sent()
        }
        Task::Trade => {
            let request = Request {
                preset: preset_file.preset,
                size,
                axes: sent::named(axes),
                title: String::new(),
            };
            let report = |report: &Report| sent::told(report).iter().for_each(|text| tell(text));
            let progress = Arc::new(Progress::telling(report));
            let gpu = device().await?;
            MEASURING.set(Some(progress.clone()));
            let measured = measure::measure(&gpu, &scene, &request, &progress).await;
            MEASURING.take();
            Ok(sent::sent(&measured?)?.into())
        }
    }
}

/// Tells the page these words.
fn tell(words: &str) {
    let worker: DedicatedWorkerGlobalScope = js_sys::global().unchecked_into();
    // A page that has gone does not listen.
    let _ = worker.post_message(&words.into());
}

fn scene_of(preset_file: &PresetFile) -> Result<Arc<Scene>, String> {
    let key = SceneKey::of(preset_file);
    let known = SCENE.with_borrow(Clone::clone);
    if let Some((_, scene)) = known.filter(|(known, _)| *known == key) {
        return Ok(scene);
    }
    let loaded = preset_file::load_scene(&preset_file.preset, None);
    let scene = loaded.map_err(|error| error.to_string())?;
    SCENE.set(Some((key, scene.clone())));
    Ok(scene)
}

async fn device() -> Result<Arc<Gpu>, String> {
    let known = DEVICE.with_borrow(Clone::clone);
    if let Some(gpu) = known.filter(|gpu| !gpu.is_lost()) {
        return Ok(gpu);
    }
    let opened = Gpu::open(&AdapterChoice::Any).await;
    let gpu = opened.map_err(|error| error.to_string())?;
    DEVICE.set(Some(gpu.clone()));
    Ok(gpu)
}
