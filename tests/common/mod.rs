//! What GPU tests share: the adapter (never silently missing), scenes by query, pictures with their verdict.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

use rasterlab::{
    effects::{Effect, Stack},
    gpu::{Capture, Gpu, Renderer, device::AdapterChoice},
    measure::Verdict,
    oracle,
    plan::Accuracy,
    scene::{Scene, builtin, camera::View},
    session::{SceneSource, Session},
    shader::key::Visibility,
};

/// The adapter under test: `RASTERLAB_ADAPTER` (a part of its name) or the best there is. A missing one fails the test;
/// only `RASTERLAB_GPU=skip` leaves GPU tests out, and says so.
pub fn gpu() -> Option<Arc<Gpu>> {
    static GPU: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    GPU.get_or_init(|| {
        if std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip") {
            eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
            return None;
        }
        let choice = std::env::var("RASTERLAB_ADAPTER").map_or(AdapterChoice::Any, AdapterChoice::Named);
        let gpu = Gpu::open(&choice).unwrap_or_else(|error| panic!("{error}"));
        eprintln!("adapter: {} ({}), caps {}", gpu.summary.name, gpu.summary.driver, gpu.caps.class());
        Some(gpu)
    })
    .clone()
}

/// A renderer, one at a time: software adapters share two cores among all tests.
pub fn renderer() -> Option<MutexGuard<'static, Renderer>> {
    static RENDERER: OnceLock<Option<Mutex<Renderer>>> = OnceLock::new();
    let renderer = RENDERER.get_or_init(|| gpu().map(|gpu| Mutex::new(Renderer::new(gpu)))).as_ref()?;
    Some(renderer.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
}

/// The visibility rungs that the adapter has.
pub fn rungs(renderer: &Renderer) -> Vec<Visibility> {
    Visibility::ALL.into_iter().filter(|v| *v == Visibility::Split32 || renderer.gpu().caps.int64_atomics).collect()
}

pub fn pinned(visibility: Visibility) -> Accuracy {
    Accuracy { visibility: Some(visibility), ..Accuracy::default() }
}

pub fn scene(query: &str) -> Arc<Scene> {
    Arc::new(builtin::build(query).unwrap_or_else(|error| panic!("{query}: {error}")))
}

/// A stack of effects with their defaults.
pub fn stack(names: &[&str]) -> Stack {
    let mut stack = Stack::default();
    for name in names {
        stack.enable(Effect::find(name).unwrap_or_else(|| panic!("no effect {name}")));
    }
    stack
}

/// A scene as a look without a camera shows it.
pub fn view(scene: &Scene, size: [u32; 2]) -> View {
    Session { scene: SceneSource::Builtin(scene.name.clone()), ..Session::default() }.view(scene, size)
}

/// Draws and judges.
pub fn judged(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View, stack: &Stack, accuracy: &Accuracy) -> (Capture, Verdict) {
    renderer.set_scene(scene).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let capture = renderer.capture(view, stack, accuracy).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    if let Some(error) = renderer.gpu().take_error() {
        panic!("{}: the device says {error}", scene.name);
    }
    let verdict = oracle::judge(scene, view, stack, &capture.frame, &capture.geometry, capture.layers.as_deref())
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    (capture, verdict)
}
