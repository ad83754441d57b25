//! What GPU tests share: devices and renderers, scenes by query, pictures with their verdict,
//! shaders with mistakes.
#![allow(dead_code, unused_imports, reason = "each test file uses its own part")]

use std::{
    collections::{BTreeMap, VecDeque},
    fs,
    ops::{Deref, DerefMut},
    path::{Path, PathBuf},
    sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, OnceLock},
    thread,
};

mod shader_parts;

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{AxisOption, PinnedOptions, Visibility},
    effects::Stack,
    frame::Frame,
    gpu::{Capture, Gpu, Renderer, device::AdapterChoice},
    host,
    measure::{Verdict, compare},
    oracle,
    plan::{self, AccuracyRequest, Tuning},
    preset::Preset,
    scene::{Scene, builtin, view::View},
    shader::library::Library,
};
use rasterlab_fuzz::stress;
pub use rasterlab_fuzz::stress::{
    adversarial::near_miss_triangle,
    exactness,
    matrix::{DEFORMED_SCENES, GALLERY_SCENES, SCENES},
    pinned,
    scenes::{
        Rng, SimpleMesh, camera_view, pixel_view, scene_of_meshes, triangle_soup,
        triangle_soup_in_units,
    },
    stack, tunings,
};

/// The adapter under test: `RASTERLAB_ADAPTER` (a part of its name) or the best there is. A missing
/// one fails the test; only `RASTERLAB_GPU=skip` leaves GPU tests out, and says so.
pub fn gpu() -> Option<Arc<Gpu>> {
    static GPU: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    GPU.get_or_init(|| {
        let gpu = own_gpu()?;
        eprintln!(
            "adapter: {} ({}), caps {}",
            gpu.summary.name,
            gpu.summary.driver,
            gpu.caps.class()
        );
        Some(gpu)
    })
    .clone()
}

/// The adapter under test, with a new device that no other test uses.
pub fn own_gpu() -> Option<Arc<Gpu>> {
    if std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip") {
        eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
        return None;
    }
    let choice =
        std::env::var("RASTERLAB_ADAPTER").map_or(AdapterChoice::Any, AdapterChoice::Named);
    Some(
        Gpu::open(&choice)
            .block_on()
            .unwrap_or_else(|error| panic!("{error}")),
    )
}

/// Renderers that tests share: one for each of two tests that draw at the same time. Each has its
/// own device, because a software adapter runs and compiles the kernels of one device one after the
/// other.
struct Pool {
    state: Mutex<PoolState>,
    returned: Condvar,
}

#[derive(Default)]
struct PoolState {
    idle: Vec<Renderer>,
    lent: usize,
}

static POOL: LazyLock<Pool> = LazyLock::new(|| Pool {
    state: Mutex::default(),
    returned: Condvar::new(),
});

const RENDERERS: usize = 2;

impl Pool {
    fn state(&self) -> MutexGuard<'_, PoolState> {
        self.state
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// A renderer of the pool, which it goes back to when this is dropped.
pub struct Loan(Option<Renderer>);

impl Deref for Loan {
    type Target = Renderer;

    fn deref(&self) -> &Renderer {
        self.0.as_ref().expect("it is there until this is dropped")
    }
}

impl DerefMut for Loan {
    fn deref_mut(&mut self) -> &mut Renderer {
        self.0.as_mut().expect("it is there until this is dropped")
    }
}

impl Drop for Loan {
    fn drop(&mut self) {
        let mut state = POOL.state();
        state.lent -= 1;
        // A failed test may leave a renderer half-way: the next test gets a new one.
        state
            .idle
            .extend(self.0.take().filter(|_| !thread::panicking()));
        POOL.returned.notify_one();
    }
}

/// A renderer with the tuning that suits the adapter. Earlier tests may have drawn with it, so it
/// knows their pipelines.
pub fn loan() -> Option<Loan> {
    let first = gpu()?;
    let mut state = POOL
        .returned
        .wait_while(POOL.state(), |state| state.lent == RENDERERS)
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    state.lent += 1;
    let idle = state.idle.pop();
    let is_first_free = state.lent == 1;
    drop(state);
    let mut loan = Loan(None);
    loan.0 = match idle {
        Some(renderer) => Some(renderer),
        None => Some(Renderer::new(if is_first_free {
            first
        } else {
            own_gpu()?
        })),
    };
    let tuning = loan.gpu().caps.tuning();
    loan.set_tuning(tuning);
    Some(loan)
}

/// The visibility options that lose nothing and that the adapter has.
pub fn options(renderer: &Renderer) -> Vec<Visibility> {
    stress::options(&renderer.gpu().caps)
}

/// How far a test goes: the few pictures that every run draws, or all of them in `.ci/full`.
/// Compiling kernels takes most of a test's time, so the few have few kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    Few,
    All,
}

impl Reach {
    /// The first `few` of a list, or all of it.
    pub fn of<T>(self, few: usize, list: impl IntoIterator<Item = T>) -> Vec<T> {
        let count = if self == Reach::Few { few } else { usize::MAX };
        list.into_iter().take(count).collect()
    }

    /// One of the [`options`], or all of them.
    pub fn options(self, renderer: &Renderer) -> Vec<Visibility> {
        self.of(1, options(renderer))
    }
}

/// Two tests of each function of a [`Reach`].
#[allow(unused_macros)]
macro_rules! few_and_all {
    ($($test:ident),* $(,)?) => {
        $(mod $test {
            #[test]
            fn few() {
                super::$test(crate::common::Reach::Few);
            }

            #[test]
            #[ignore = "slow: .ci/full"]
            fn all() {
                super::$test(crate::common::Reach::All);
            }
        })*
    };
}
pub(crate) use few_and_all;

/// The exact option that a CPU adapter is quickest on, for what takes long.
pub fn quick_option(renderer: &Renderer) -> Visibility {
    stress::quick_option(&renderer.gpu().caps)
}

/// A built-in scene; small ones are built once for all tests of a process.
pub fn scene(query: &str) -> Arc<Scene> {
    const LARGE: u64 = 100_000;
    static BUILT: Mutex<BTreeMap<String, Arc<Scene>>> = Mutex::new(BTreeMap::new());
    let built = || {
        BUILT
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    };
    if let Some(scene) = built().get(query) {
        return scene.clone();
    }
    let scene = Arc::new(builtin::build(query).unwrap_or_else(|error| panic!("{query}: {error}")));
    if scene.triangle_count() > LARGE {
        return scene;
    }
    built().entry(query.to_owned()).or_insert(scene).clone()
}

/// A scene within the picture ([`Preset::of_sphere`]).
pub fn view(scene: &Scene, size: [u32; 2]) -> View {
    Preset::of_sphere(scene, size).view(scene, size)
}

/// A picture with its verdict.
struct Judged {
    scene: Arc<Scene>,
    view: View,
    stack: Stack,
    capture: Capture,
    verdict: Verdict,
}

/// What the judge says about a picture. Options and tunings that draw the same picture to the last
/// bit, geometry included, are judged once: the verdict follows from nothing else.
pub fn verdict(scene: &Arc<Scene>, view: &View, stack: &Stack, capture: &Capture) -> Verdict {
    /// Pixels of all stored verdicts together.
    const MOST_PIXELS: usize = 1 << 20;
    static LATEST: Mutex<VecDeque<Judged>> = Mutex::new(VecDeque::new());
    let latest = || {
        LATEST
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    };
    let is_same = |judged: &&Judged| {
        let (a, b) = (&judged.capture, capture);
        Arc::ptr_eq(&judged.scene, scene)
            && (&judged.view, &judged.stack) == (view, stack)
            && (&a.frame, &a.geometry, &a.layers, &a.previous)
                == (&b.frame, &b.geometry, &b.layers, &b.previous)
    };
    // The judge compares strict vertices bit by bit, but `==` does not tell 0.0 from -0.0.
    let is_by_bits = capture.geometry.bit_exact.vertices;
    if !is_by_bits && let Some(same) = latest().iter().find(is_same) {
        return same.verdict.clone();
    }
    let verdict = oracle::judge(scene, view, stack, &capture.picture())
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let mut latest = latest();
    let mut pixels = view.pixels();
    latest.retain(|judged| {
        pixels += judged.view.pixels();
        pixels <= MOST_PIXELS
    });
    let judged = Judged {
        scene: scene.clone(),
        view: view.clone(),
        stack: stack.clone(),
        capture: capture.clone(),
        verdict,
    };
    let verdict = judged.verdict.clone();
    latest.push_front(judged);
    verdict
}

/// What a test asks of a renderer.
pub trait Draws {
    /// Draws without judging.
    fn captured(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Capture;

    /// Draws and judges.
    fn judged(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> (Capture, Verdict) {
        let capture = self.captured(scene, view, stack, accuracy);
        let verdict = verdict(scene, view, stack, &capture);
        (capture, verdict)
    }

    /// Draws, judges and insists on [`exactness`]; `what` names the case.
    fn exact(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        what: &str,
    ) -> (Capture, Verdict) {
        let (capture, verdict) = self.judged(scene, view, stack, accuracy);
        if let Err(faults) = exactness(&verdict.report) {
            panic!(
                "{what}: {faults}\n{:?}\n{:?}",
                verdict.report, capture.frame.counters
            );
        }
        (capture, verdict)
    }

    /// The picture of a preset, after those that lead up to it, with its verdict.
    fn judged_preset(
        &mut self,
        scene: &Arc<Scene>,
        preset: &Preset,
        accuracy: &AccuracyRequest,
    ) -> (Capture, Verdict);
}

impl Draws for Renderer {
    fn captured(
        &mut self,
        scene: &Arc<Scene>,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Capture {
        stress::captured(self, scene, view, stack, accuracy)
            .unwrap_or_else(|error| panic!("{error:?}"))
    }

    fn judged_preset(
        &mut self,
        scene: &Arc<Scene>,
        preset: &Preset,
        accuracy: &AccuracyRequest,
    ) -> (Capture, Verdict) {
        let moments = preset.moments(scene, preset.output.size);
        self.set_scene(scene)
            .block_on()
            .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        let capture = self
            .capture_last(&moments, accuracy)
            .block_on()
            .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        let (view, stack) = moments.last().expect("a preset shows a moment");
        let verdict = verdict(scene, view, stack, &capture);
        (capture, verdict)
    }
}

/// Small triangles walk alone, middling ones get a workgroup, as on a GPU.
pub const GRAPHICS_CARD: Tuning = Tuning {
    max_small_samples: 32,
    max_small_side: 32,
    group_size: 256,
    listed_tiles: false,
    early_load: false,
    exchanges_maximum: true,
    queue_groups: 64,
    dot_groups: 1024,
    interleaves_triangles: false,
    clears_in_passes: true,
    hides_blocks: true,
    stored_uniforms: false,
    wide_loads: false,
    buffered_shadow_map: false,
    glass_layers: plan::MOST_GLASS_LAYERS,
    projects_points: true,
    specialized: true,
};

/// Every image of `a` is that of `b`, bit for bit.
pub fn assert_same(a: &Frame, b: &Frame, what: &str) {
    let triangle_ids = compare::triangle_ids(&a.triangle_id, &b.triangle_id);
    assert_eq!(
        triangle_ids.different,
        0,
        "{what}: triangle ids differ, first {:?}",
        triangle_ids.mismatches.first()
    );
    let keys = compare::triangle_ids(&a.depth_key, &b.depth_key);
    assert_eq!(
        keys.different,
        0,
        "{what}: keys differ, first {:?}",
        keys.mismatches.first()
    );
    let colors = compare::pictures(&a.color, &b.color, 0);
    assert_eq!(
        colors.pixels_over_tolerance,
        0,
        "{what}: colors differ, first {:?}",
        colors.mismatches.first()
    );
}

/// What the planner chooses.
pub fn unpinned() -> AccuracyRequest {
    AccuracyRequest::default()
}

pub fn request(pins: PinnedOptions) -> AccuracyRequest {
    AccuracyRequest {
        pins,
        ..AccuracyRequest::default()
    }
}

/// What the planner chooses beside this option.
pub fn pin<O: AxisOption>(option: O) -> AccuracyRequest {
    request(PinnedOptions::of(option))
}

/// The option that every adapter has.
pub fn split32() -> AccuracyRequest {
    pinned(Visibility::Split32)
}

// The same as functions.

pub fn renderer() -> Option<Loan> {
    loan()
}

pub fn captured(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Capture {
    renderer.captured(scene, view, stack, accuracy)
}

pub fn judged(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> (Capture, Verdict) {
    renderer.judged(scene, view, stack, accuracy)
}

pub fn exact(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
    what: &str,
) -> (Capture, Verdict) {
    renderer.exact(scene, view, stack, accuracy, what)
}

pub fn judged_preset(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    preset: &Preset,
    accuracy: &AccuracyRequest,
) -> (Capture, Verdict) {
    renderer.judged_preset(scene, preset, accuracy)
}

// -------- mutants

/// Shaders with one mistake, in a folder that lasts as long as this.
pub struct Mutated(tempfile::TempDir);

impl Mutated {
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    pub fn shaders(&self) -> Library {
        host::shaders::library(self.folder())
    }

    /// One more mistake, as in [`mutated`].
    #[must_use]
    pub fn and(self, from: &str, to: &str) -> Self {
        let mut files = Vec::new();
        files_below(self.0.path(), &mut files);
        let texts = files
            .into_iter()
            .map(|path| (fs::read_to_string(&path).expect("a shader is read"), path));
        let found: Vec<_> = texts.filter(|(text, _)| text.contains(from)).collect();
        let [(text, path)] = &found[..] else {
            panic!("{from:?} stands in {} shader files", found.len())
        };
        assert_eq!(
            text.matches(from).count(),
            1,
            "{from:?} in {}",
            path.display()
        );
        fs::write(path, text.replace(from, to)).expect("a shader is written");
        self
    }
}

/// The project's shaders with `from`, which stands in them exactly once, replaced by `to`.
pub fn mutated(from: &str, to: &str) -> Mutated {
    own_shaders().and(from, to)
}

/// A copy of the project's shaders.
pub fn own_shaders() -> Mutated {
    Mutated(shader_parts::copied())
}

/// A renderer whose shaders have one mistake.
pub struct Mistaken {
    renderer: Renderer,
    _shaders: Mutated,
}

impl Mistaken {
    /// As [`mutated`].
    pub fn new(gpu: &Arc<Gpu>, from: &str, to: &str) -> Self {
        let shaders = mutated(from, to);
        Self {
            renderer: Renderer::with_library(gpu.clone(), shaders.shaders()),
            _shaders: shaders,
        }
    }
}

impl Deref for Mistaken {
    type Target = Renderer;

    fn deref(&self) -> &Renderer {
        &self.renderer
    }
}

impl DerefMut for Mistaken {
    fn deref_mut(&mut self) -> &mut Renderer {
        &mut self.renderer
    }
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of shaders can be read") {
        let path = entry.expect("a folder of shaders can be read").path();
        if path.is_dir() {
            files_below(&path, files)
        } else {
            files.push(path)
        }
    }
}

/// The oracle's own picture of a scene, from its own vertices.
pub fn reference(scene: &Scene, view: &View) -> oracle::Coverage {
    stress::scenes::reference_coverage(scene, view).expect("a scene that fits")
}
