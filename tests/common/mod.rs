//! What GPU tests share: the adapter (never silently missing), scenes by query, pictures with their verdict.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::{
    fs,
    path::Path,
    sync::{Arc, Mutex, MutexGuard, OnceLock},
};

use glam::{DMat4, DVec3, DVec4};
use rasterlab::{
    effects::{Effect, Stack},
    gpu::{Capture, Gpu, Renderer, device::AdapterChoice},
    ladder::{Pins, Visibility},
    math::hash,
    measure::{Accuracy as Errors, Budget, Verdict},
    oracle,
    plan::{Accuracy, Tuning},
    scene::{
        Accessor, Bounds, Component, Instance, Material, Primitive, Scene, Topology, builtin,
        camera::{Camera, View},
        draw::draws,
    },
    session::{SceneSource, Session},
    shader::library::Library,
};

/// A scene of every builtin: together they take each path through the kernels.
pub const SCENES: &[&str] = &[
    "teapot?tess=8",
    "sphere?triangles=5000",
    "sphere?triangles=200",
    "knot?tess=24",
    "cube-wall",
    "grid?cell=1",
    "grid?cell=0.4",
    "fan?n=13",
    "sizes",
    "slivers",
    "stack",
    "near",
];

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

/// A renderer as the adapter likes it, one at a time: software adapters share two cores among all tests.
pub fn renderer() -> Option<MutexGuard<'static, Renderer>> {
    static RENDERER: OnceLock<Option<Mutex<Renderer>>> = OnceLock::new();
    let renderer = RENDERER.get_or_init(|| gpu().map(|gpu| Mutex::new(Renderer::new(gpu)))).as_ref()?;
    let mut renderer = renderer.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let usual = renderer.gpu().caps.tuning();
    renderer.set_tuning(usual);
    Some(renderer)
}

/// The visibility rungs that the adapter has.
pub fn rungs(renderer: &Renderer) -> Vec<Visibility> {
    Visibility::EXACT.into_iter().filter(|v| v.is_there(renderer.gpu().caps.int64_atomics)).collect()
}

/// The exact rung that a CPU adapter is quickest on, for what takes long.
pub fn quick_rung(renderer: &Renderer) -> Visibility {
    if renderer.gpu().caps.int64_atomics { Visibility::Packed64 } else { Visibility::Split32 }
}

pub fn pinned(visibility: Visibility) -> Accuracy {
    Accuracy { pins: Pins::of(visibility), ..Accuracy::default() }
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
    let capture = captured(renderer, scene, view, stack, accuracy);
    let (layers, previous) = (capture.layers.as_deref(), capture.previous.as_deref());
    let verdict = oracle::judge_after(scene, view, stack, &capture.frame, &capture.geometry, layers, previous)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    (capture, verdict)
}

/// Draws without judging.
pub fn captured(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View, stack: &Stack, accuracy: &Accuracy) -> Capture {
    renderer.set_scene(scene).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let capture = renderer.capture(view, stack, accuracy).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    if let Some(error) = renderer.gpu().take_error() {
        panic!("{}: the device says {error}", scene.name);
    }
    capture
}

/// The picture of a look, after those that lead up to it, with its verdict.
pub fn judged_look(renderer: &mut Renderer, scene: &Arc<Scene>, session: &Session, accuracy: &Accuracy) -> (Capture, Verdict) {
    let moments = session.moments(scene, session.output.size);
    renderer.set_scene(scene).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let capture = renderer.capture_last(&moments, accuracy).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let (view, stack) = moments.last().expect("a look shows a moment");
    let (layers, previous) = (capture.layers.as_deref(), capture.previous.as_deref());
    let verdict = oracle::judge_after(scene, view, stack, &capture.frame, &capture.geometry, layers, previous)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    (capture, verdict)
}

/// Largest share of pixels that may lie in the depth band, where two owners are right; 16 pixels are always allowed.
pub const BAND_SHARE: f64 = 0.01;

/// Nothing exact is wrong, colours are within one step, and the band is small.
pub fn exactness(errors: &Errors) -> Result<(), String> {
    errors.within(&Budget { max_band_pixels: ((errors.pixels as f64 * BAND_SHARE) as u64).max(16), ..Budget::default() })
}

/// Draws, judges and insists on [`exactness`]; `what` names the case.
pub fn exact(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    accuracy: &Accuracy,
    what: &str,
) -> (Capture, Verdict) {
    let (capture, verdict) = judged(renderer, scene, view, stack, accuracy);
    if let Err(faults) = exactness(&verdict.accuracy) {
        panic!("{what}: {faults}\n{:?}\n{:?}", verdict.accuracy, capture.frame.counters);
    }
    (capture, verdict)
}

/// Ways to share out work that use every kernel: all but the tiniest triangles by a workgroup each, the usual limits of
/// a GPU, all by one invocation; with the resolve over all pixels or over listed tiles.
pub fn tunings() -> [Tuning; 4] {
    [(1, 1, false), (64, 32, true), (64, 32, false), (128 * 128, 128, true)].map(|(small_samples, small_side, listed_tiles)| Tuning {
        small_samples,
        list_group: if small_samples == 64 { 256 } else { 64 },
        small_side,
        listed_tiles,
        early_load: listed_tiles,
        specialized: true,
    })
}

// ---------------------------------------------------------------- mutants

/// Shaders with one mistake, in a folder that lasts as long as this.
pub struct Mutated(tempfile::TempDir);

impl Mutated {
    pub fn shaders(&self) -> Library {
        Library::Folder(self.0.path().into())
    }
}

/// The project's shaders with `from`, which stands in `file` exactly once, replaced by `to`.
pub fn mutated(file: &str, from: &str, to: &str) -> Mutated {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), folder.path());
    let path = folder.path().join(format!("{file}.wgsl"));
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"));
    assert_eq!(text.matches(from).count(), 1, "{from:?} is not once in {file}");
    fs::write(&path, text.replace(from, to)).expect("a shader is written");
    Mutated(folder)
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder for shaders");
    for entry in fs::read_dir(from).expect("shaders/ can be read") {
        let path = entry.expect("shaders/ can be read").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_folder(&path, &target);
        } else {
            fs::copy(&path, target).expect("a shader is copied");
        }
    }
}

// ---------------------------------------------------------------- near misses

/// `g`, `x` and `y` with a x + b y = g, the greatest common divisor up to its sign.
fn bezout(a: i64, b: i64) -> (i64, i64, i64) {
    if b == 0 {
        return (a, 1, 0);
    }
    let (g, x, y) = bezout(b, a % b);
    (g, y, x - a / b * y)
}

/// A flat triangle, units of 1/256 px, up to `extent` to a side. One edge passes a sample of a picture of `size` pixels
/// as closely as its direction allows: on it, or one step of the edge function (for most, 1) to either side.
pub fn near_miss(dice: &mut Dice, extent: i32, size: [i32; 2]) -> [[i32; 2]; 3] {
    let sample = size.map(|side| i64::from(256 * dice.between(0, side) + 128));
    // A third of the edges have lattice points inside, which can lie on the sample.
    let factor = if dice.roll().is_multiple_of(3) { dice.between(2, 30) } else { 1 };
    let reach = (extent / factor).max(2);
    let mut side = || i64::from(factor * dice.between(-reach + 1, reach));
    let (dx, dy) = match (side(), side()) {
        (0, 0) => (i64::from(factor), i64::from(factor)),
        d => d,
    };
    // From the edge's first end to the sample: dx fy - dy fx is -g, 0 or g.
    let (g, x, y) = bezout(dx, dy);
    let t = i64::from(dice.between(-1, 2));
    let (fx, fy) = (-t * y, t * x);
    let g = g.abs();
    let along = (i128::from(fx * dx + fy * dy) * i128::from(g)).div_euclid(i128::from(dx * dx + dy * dy)) as i64;
    let place = i64::from(dice.between(0, i32::try_from(g.min(1 << 30)).expect("a small number"))) - along;
    let (fx, fy) = (fx + place * (dx / g), fy + place * (dy / g));
    let a = [sample[0] - fx, sample[1] - fy];
    let b = [a[0] + dx, a[1] + dy];
    let mut third = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        let slack = (i64::from(extent) - (high - low)).max(0) as i32;
        low - i64::from(dice.between(0, slack + 1)) + i64::from(dice.between(0, extent + 1))
    };
    let c = [third(0), third(1)];
    [a, b, c].map(|corner| corner.map(|at| at.clamp(-8_388_607, 8_388_607) as i32))
}

// ---------------------------------------------------------------- hand-made scenes and views

/// Triangles in their own bytes; everything a hand-made scene needs.
#[derive(Clone)]
pub struct Part {
    pub positions: Vec<[f32; 3]>,
    /// Empty: (0, 0, 1) everywhere.
    pub normals: Vec<[f32; 3]>,
    /// Empty: none.
    pub colors: Vec<[f32; 4]>,
    /// Empty: corners count upwards.
    pub indices: Vec<u32>,
    pub double_sided: bool,
    pub placements: Vec<DMat4>,
}

impl Default for Part {
    fn default() -> Self {
        let placements = vec![DMat4::IDENTITY];
        Self { positions: vec![], normals: vec![], colors: vec![], indices: vec![], double_sided: true, placements }
    }
}

/// Loose triangles that show both sides.
pub fn sheet(positions: Vec<[f32; 3]>) -> Part {
    Part { positions, ..Part::default() }
}

/// Loose triangles from units of 1/256 px and one depth each; exact on a [`pixel_view`] up to the guard band.
pub fn units(triangles: &[([[i32; 2]; 3], f32)]) -> Part {
    let place = |[x, y]: [i32; 2], depth: f32| [x as f32 / 256.0, y as f32 / 256.0, depth];
    sheet(triangles.iter().flat_map(|(corners, depth)| corners.map(|corner| place(corner, *depth))).collect())
}

pub fn hand_made(parts: &[Part]) -> Arc<Scene> {
    let mut scene = Scene { name: "hand-made".into(), ..Scene::default() };
    for (i, part) in parts.iter().enumerate() {
        let mut push = |lanes: u32, values: &[f32]| {
            let offset = scene.vertex_bytes.len();
            scene.vertex_bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
            Accessor::packed_f32(offset, lanes, values.len() / lanes as usize)
        };
        let positions = push(3, part.positions.as_flattened());
        let normals = if part.normals.is_empty() { vec![[0.0, 0.0, 1.0]; part.positions.len()] } else { part.normals.clone() };
        let normals = push(3, normals.as_flattened());
        let colors = (!part.colors.is_empty()).then(|| push(4, part.colors.as_flattened()));
        let indices = (!part.indices.is_empty()).then(|| {
            let (offset, count) = (scene.index_bytes.len() as u32, part.indices.len() as u32);
            scene.index_bytes.extend(part.indices.iter().flat_map(|i| i.to_le_bytes()));
            Accessor { offset, stride: 4, component: Component::U32, lanes: 1, normalized: false, count }
        });
        let mut bounds = Bounds::EMPTY;
        let finite = part.positions.iter().filter(|p| p.iter().all(|v| v.is_finite()));
        finite.for_each(|p| bounds.include(DVec3::from_array(p.map(f64::from))));
        let corner = |place: usize| {
            let vertex = part.indices.get(place).map_or(place, |&i| i as usize);
            DVec3::from_array(part.positions[vertex].map(f64::from))
        };
        let corners = if part.indices.is_empty() { part.positions.len() } else { part.indices.len() };
        let edges = (0..corners / 3).flat_map(|t| [(0, 1), (1, 2), (2, 0)].map(|(a, b)| corner(3 * t + a).distance(corner(3 * t + b))));
        let longest_edge = edges.filter(|edge| edge.is_finite()).fold(0.0, f64::max);
        let material = scene.materials.len();
        scene.materials.push(Material { double_sided: part.double_sided, ..Material::default() });
        scene.primitives.push(Primitive {
            name: format!("part {i}"),
            topology: Topology::List,
            indices,
            positions,
            normals,
            colors,
            material,
            bounds,
            longest_edge,
            sound_normals: false,
        });
        scene.instances.extend(part.placements.iter().map(|&world_from_object| Instance { primitive: i, world_from_object }));
    }
    Arc::new(scene)
}

/// Positions are pixels right and down, z is the depth itself: larger is nearer. Exact where sides are powers of two.
pub fn pixel_view(width: u32, height: u32) -> View {
    let (w, h) = (f64::from(width), f64::from(height));
    View {
        width,
        height,
        clip_from_world: DMat4::from_cols(DVec4::X * 2.0 / w, DVec4::Y * -2.0 / h, DVec4::Z, DVec4::new(-1.0, 1.0, 0.0, 1.0)),
        world_from_scene: DMat4::IDENTITY,
        eye: DVec3::new(w / 2.0, h / 2.0, 1.0),
        forward: DVec3::NEG_Z,
        ndc_axes: [DVec3::X * w / 2.0, DVec3::NEG_Y * h / 2.0],
        linear_depth_m: Some([0.0, 1.0]),
        scene_range_m: [0.0, 1.0],
        background: [0.0; 4],
        subpixel_bits: 8,
    }
}

/// What `camera` sees of `scene`.
pub fn seen(scene: &Scene, camera: &Camera, [width, height]: [u32; 2]) -> View {
    View::new(camera, width, height, &scene.bounds(), DMat4::IDENTITY, [0.01, 0.02, 0.03, 1.0])
}

/// What the oracle makes of a scene all by itself: the truth that an adapter has not touched.
pub fn truth(scene: &Scene, view: &View) -> oracle::Coverage {
    let draws = draws(scene, view).expect("a scene that fits");
    let (triangles, _) = oracle::triangles(scene, &draws, &oracle::project(scene, &draws, view));
    oracle::cover(&triangles, view, None)
}

/// Numbers that look random and are the same on every run.
pub struct Dice(pub u32);

impl Dice {
    pub fn roll(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        hash(self.0)
    }

    /// From `low` up to but without `high`.
    pub fn between(&mut self, low: i32, high: i32) -> i32 {
        low + ((u64::from(self.roll()) * u64::from(high.abs_diff(low))) >> 32) as i32
    }

    /// From `low` up to but without `high`.
    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.roll()) / 4_294_967_296.0
    }
}
