//! Precision probes: effects that do what another effect does in f64, and record on the way how far
//! its text in f32 is from that. The oracle draws with them as with any other effect.

use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError, Weak,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

use glam::{DVec2, DVec3, DVec4};

use super::evaluated::{EvaluatedError, evaluated_in};
use crate::{
    effects::{
        Effect, Stack,
        hooks::{
            Finish, ImageAt, ImageHook, PassHook, Picture, Pixel, Sample, SampleHook, Surface,
            SurfaceFunction, Vertex, VertexHook,
        },
    },
    evaluator::Precision,
    math::srgb,
    shader::library::Library,
};

/// What the f32 side of an effect gets wrong.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub enum Quantity {
    /// Largest difference of a channel of the picture, of 255.
    Color,
    /// Largest difference of a component of the normal.
    Normal,
    /// Largest difference of a coordinate of a moved vertex, meters.
    Vertex,
    /// 1 where another decision is made about a sample.
    Sample,
    /// How many times as far as it states an effect moves a vertex; in f64, too.
    Reach,
}

/// Where something was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Pixels from the left and the top of the picture, to the middle of the pixel.
    Pixel([f64; 2]),
    /// World space, meters.
    World(DVec3),
}

/// The largest error of the f32 side of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestError {
    pub quantity: Quantity,
    /// Infinite where the f32 side is not finite and the f64 side is.
    pub error: f64,
    pub place: Place,
}

/// An effect and the largest error of each of its quantities.
pub type ErrorsOfEffect = (Arc<Effect>, Vec<LargestError>);

/// What the probes of an effect have found.
#[derive(Default)]
struct Errors {
    cancelled: Arc<AtomicBool>,
    /// A function of the effect was called.
    has_run: bool,
    largest: Vec<LargestError>,
}

/// An effect that records the error of its f32 side.
pub struct PrecisionProbe {
    effect: Arc<Effect>,
    errors: Arc<Mutex<Errors>>,
    /// Held by the one measurement that uses it.
    in_use: Mutex<()>,
}

pub(super) fn locked<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Probes, each with the effect that it probes. A probe does not hold that effect, so that both go
/// when nobody uses it any more.
pub(super) type Probes<T> = Mutex<Vec<(Weak<Effect>, Arc<T>)>>;

/// The probe of `effect`; there is one of each.
pub(super) fn kept<T>(
    known: &Probes<T>,
    effect: &Arc<Effect>,
    make: impl FnOnce() -> Result<T, EvaluatedError>,
) -> Result<Arc<T>, EvaluatedError> {
    let find = |known: &[(Weak<Effect>, Arc<T>)]| {
        let found = known
            .iter()
            .find(|(probed, _)| std::ptr::eq(probed.as_ptr(), Arc::as_ptr(effect)));
        found.map(|(_, probe)| probe.clone())
    };
    if let Some(probe) = find(&locked(known)) {
        return Ok(probe);
    }
    let made = Arc::new(make()?);
    let mut known = locked(known);
    known.retain(|(probed, _)| probed.strong_count() > 0);
    Ok(find(&known).unwrap_or_else(|| {
        known.push((Arc::downgrade(effect), made.clone()));
        made
    }))
}

impl Errors {
    fn record(&mut self, quantity: Quantity, error: f64, place: Place) {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error == 0.0 {
            return;
        }
        // Threads come in any order; of equal errors the topmost, then leftmost pixel is kept.
        let order = |place: Place| match place {
            Place::Pixel([x, y]) => [y, x, 0.0],
            Place::World(at) => at.to_array(),
        };
        match self
            .largest
            .iter_mut()
            .find(|known| known.quantity == quantity)
        {
            None => self.largest.push(LargestError {
                quantity,
                error,
                place,
            }),
            Some(known) => {
                if error > known.error
                    || (error == known.error && order(place) < order(known.place))
                {
                    (known.error, known.place) = (error, place);
                }
            }
        }
    }
}

/// Is there a function of the effect whose error can be measured?
pub fn has_f32_error(effect: &Effect) -> bool {
    let hooks = &effect.hooks;
    let sample = hooks.sample.as_ref();
    hooks.surface.is_some()
        || hooks.image.is_some()
        || hooks.passes.is_some()
        || hooks.vertex.is_some()
        || sample.is_some_and(|hook| !hook.has_setup)
}

/// Records the errors of the f32 side of the effects of `stack` while `draw` draws a picture with the
/// stack that it is given. Of passes, that of the last one counts, which writes the picture. An effect
/// of which no function was called is left out. Once `cancelled` is set, the picture is finished
/// quickly and nothing is returned.
///
/// # Errors
/// The text of an effect cannot be evaluated.
pub fn precision(
    stack: &Stack,
    cancelled: &Arc<AtomicBool>,
    draw: impl FnOnce(&Stack),
) -> Result<Vec<ErrorsOfEffect>, EvaluatedError> {
    let mut probed = stack.clone();
    let mut probes = Vec::new();
    for enabled in probed
        .0
        .iter_mut()
        .filter(|enabled| has_f32_error(&enabled.effect))
    {
        let probe = PrecisionProbe::of(&enabled.effect)?;
        let original = std::mem::replace(&mut enabled.effect, probe.effect.clone());
        probes.push((original, probe));
    }
    // In one order, so that two measurements never wait for each other.
    let mut ordered: Vec<&PrecisionProbe> = probes.iter().map(|(_, probe)| &**probe).collect();
    ordered.sort_by_key(|probe| std::ptr::from_ref(*probe) as usize);
    let _in_use: Vec<_> = ordered.iter().map(|probe| locked(&probe.in_use)).collect();
    for (_, probe) in &probes {
        *locked(&probe.errors) = Errors {
            cancelled: cancelled.clone(),
            ..Errors::default()
        };
    }
    draw(&probed);
    let measured = |(effect, probe): &(Arc<Effect>, Arc<PrecisionProbe>)| {
        let errors = std::mem::take(&mut *locked(&probe.errors));
        errors.has_run.then(|| (effect.clone(), errors.largest))
    };
    let mut found: Vec<_> = probes.iter().filter_map(measured).collect();
    found
        .iter_mut()
        .for_each(|(_, largest)| largest.sort_by_key(|error| error.quantity));
    if cancelled.load(Ordering::Relaxed) {
        found.clear();
    }
    Ok(found)
}

impl PrecisionProbe {
    fn of(effect: &Arc<Effect>) -> Result<Arc<Self>, EvaluatedError> {
        static KNOWN: Probes<PrecisionProbe> = Mutex::new(Vec::new());
        kept(&KNOWN, effect, || {
            let single = evaluated_in(&Library::of_process(), effect, Precision::Single)?;
            let errors = Arc::new(Mutex::new(Errors::default()));
            let mut hooks = effect.hooks.clone();
            let probes = hooks.clone();
            if let (Some(exact), Some(single)) = (probes.surface, single.surface) {
                hooks.surface = Some(probed_surface(exact, single, errors.clone()));
            }
            if let (Some(exact), Some(single)) = (probes.image, single.image) {
                hooks.image = Some(probed_image(exact, single, errors.clone()));
            }
            if let (Some(exact), Some(single)) = (probes.passes, single.passes) {
                hooks.passes = Some(probed_passes(exact, single, errors.clone()));
            }
            if let (Some(exact), Some(single)) = (probes.vertex, single.vertex) {
                hooks.vertex = Some(probed_vertex(exact, single, errors.clone()));
            }
            let sample = probes.sample.filter(|hook| !hook.has_setup);
            if let (Some(exact), Some(single)) = (sample, single.sample) {
                hooks.sample = Some(probed_sample(exact, single, errors.clone()));
            }
            Ok(Self {
                effect: Arc::new(Effect {
                    hooks,
                    ..Effect::clone(effect)
                }),
                errors,
                in_use: Mutex::new(()),
            })
        })
    }
}

fn probed_surface(
    exact: Arc<SurfaceFunction>,
    single: Arc<SurfaceFunction>,
    errors: Arc<Mutex<Errors>>,
) -> Arc<SurfaceFunction> {
    Arc::new(move |surfaces: &mut [Surface], words: &[u32]| {
        if is_cancelled(&errors) {
            return;
        }
        let given = surfaces.to_vec();
        exact(surfaces, words);
        let mut others: Vec<Surface> = given.iter().copied().map(rounded).collect();
        single(&mut others, words);
        let all = given.iter().zip(surfaces).zip(others);
        for ((s, result), other) in all.filter(|((s, _), _)| s.step_offset == 0.0) {
            let place = Place::Pixel(s.pixel.to_array());
            let color = color_error(in_picture(result.color), in_picture(other.color));
            // A normal is changed on purpose, or it is passed on as it came.
            let normal = match result.normal == s.normal {
                true => 0.0,
                false => (result.normal - other.normal).abs().max_element(),
            };
            let mut errors = locked(&errors);
            errors.has_run = true;
            errors.record(Quantity::Color, color, place);
            errors.record(Quantity::Normal, normal, place);
        }
    })
}

fn probed_image(exact: ImageHook, single: ImageHook, errors: Arc<Mutex<Errors>>) -> ImageHook {
    let exact_finish = exact.finish.clone();
    let finish = move |pixels: &mut [Pixel], picture: &Picture<'_>, words: &[u32]| {
        if is_cancelled(&errors) {
            return;
        }
        let rounded = |q: &Pixel| Pixel {
            color: q.color.as_vec4().as_dvec4(),
            ..*q
        };
        let mut others: Vec<Pixel> = pixels.iter().map(rounded).collect();
        exact_finish(pixels, picture, words);
        (single.finish)(&mut others, picture, words);
        for (result, other) in pixels.iter().zip(others) {
            if other.step_offset == 0.0 {
                let error = color_error(result.color, other.color);
                let mut errors = locked(&errors);
                errors.has_run = true;
                errors.record(Quantity::Color, error, middle(result.x, result.y));
            }
        }
    };
    ImageHook {
        finish: Arc::new(finish),
        ..exact
    }
}

fn probed_passes(exact: PassHook, single: PassHook, errors: Arc<Mutex<Errors>>) -> PassHook {
    let (exact_run, last) = (exact.run.clone(), exact.passes.len() - 1);
    let run = move |index: usize, pixels: &[ImageAt<'_>], words: &[u32]| {
        if is_cancelled(&errors) {
            return vec![DVec4::ZERO; pixels.len()];
        }
        let written = exact_run(index, pixels, words);
        // A text does not see the picture of what surrounds the scene.
        let is_measured = |at: &ImageAt<'_>| {
            at.step_offset == 0.0 && index == last && at.input.panorama.is_none()
        };
        if pixels.first().is_some_and(is_measured) {
            let others = (single.run)(index, pixels, words);
            let mut errors = locked(&errors);
            errors.has_run = true;
            for ((at, result), other) in pixels.iter().zip(&written).zip(others) {
                let error = color_error(in_picture(*result), in_picture(other));
                errors.record(Quantity::Color, error, middle(at.x as u32, at.y as u32));
            }
        }
        written
    };
    PassHook {
        run: Arc::new(run),
        ..exact
    }
}

/// How many times as far as it states the text behind `hook` moves each vertex before it is held; 0
/// where that is allowed, or nothing is held.
fn over_reaches(hook: &VertexHook, given: &[Vertex], words: &[u32]) -> Vec<f64> {
    let mut moved = given.to_vec();
    if let Some(unheld) = &hook.unheld {
        unheld(&mut moved, words);
    }
    let limit_m = (hook.max_displacement_m)(0.0, words);
    let factor = |(moved, given): (Vertex, &Vertex)| {
        let moved_m = moved.offset.distance(given.offset);
        // Normals are as long as f32 makes them.
        match moved_m > 1.0001 * limit_m {
            true => moved_m / limit_m,
            false => 0.0,
        }
    };
    moved.into_iter().zip(given).map(factor).collect()
}

/// The effects of files in `stack` that move a vertex farther than they state while `draw` draws with
/// the stack that it is given, each with the largest such factor.
pub fn overreaching<T>(
    stack: &Stack,
    draw: impl FnOnce(&Stack) -> T,
) -> (T, Vec<(Arc<Effect>, f64)>) {
    let mut watched = stack.clone();
    let mut watches = Vec::new();
    for enabled in &mut watched.0 {
        let effect = enabled.effect.clone();
        let is_held = |hook: &VertexHook| hook.unheld.is_some();
        let Some(hook) = effect.hooks.vertex.clone().filter(is_held) else {
            continue;
        };
        // Floats that are not negative are in the order of their bits.
        let most = Arc::new(AtomicU64::new(0));
        let mut probe = Effect::clone(&effect);
        watches.push((effect, most.clone()));
        let exact = hook.clone();
        let moved = move |vertices: &mut [Vertex], words: &[u32]| {
            for factor in over_reaches(&exact, vertices, words) {
                most.fetch_max(factor.to_bits(), Ordering::Relaxed);
            }
            (exact.moved)(vertices, words);
        };
        probe.hooks.vertex = Some(VertexHook {
            moved: Arc::new(moved),
            ..hook
        });
        enabled.effect = Arc::new(probe);
    }
    let drawn = draw(&watched);
    let factor = |(effect, most): (Arc<Effect>, Arc<AtomicU64>)| {
        let factor = f64::from_bits(most.load(Ordering::Relaxed));
        (factor > 0.0).then_some((effect, factor))
    };
    (drawn, watches.into_iter().filter_map(factor).collect())
}

fn probed_vertex(exact: VertexHook, single: VertexHook, errors: Arc<Mutex<Errors>>) -> VertexHook {
    let measured = exact.clone();
    let moved = move |vertices: &mut [Vertex], words: &[u32]| {
        if is_cancelled(&errors) {
            return;
        }
        let mut others = vertices.to_vec();
        let reaches = over_reaches(&measured, vertices, words);
        (measured.moved)(vertices, words);
        (single.moved)(&mut others, words);
        let mut errors = locked(&errors);
        errors.has_run = true;
        for ((result, other), reach) in vertices.iter().zip(others).zip(reaches) {
            let error = (result.offset - other.offset).abs().max_element();
            let place = Place::World(result.position + result.offset);
            errors.record(Quantity::Vertex, error, place);
            if measured.unheld.is_some() {
                errors.record(Quantity::Reach, reach, place);
            }
        }
    };
    VertexHook {
        moved: Arc::new(moved),
        ..exact
    }
}

fn probed_sample(exact: SampleHook, single: SampleHook, errors: Arc<Mutex<Errors>>) -> SampleHook {
    let exact_is_drawn = exact.is_drawn.clone();
    let is_drawn = move |samples: &[Sample], words: &[u32], drawn: &mut [bool]| {
        let mut others = drawn.to_vec();
        exact_is_drawn(samples, words, drawn);
        if is_cancelled(&errors) {
            return;
        }
        (single.is_drawn)(samples, words, &mut others);
        locked(&errors).has_run = true;
        for ((s, drawn), other) in samples.iter().zip(drawn).zip(others) {
            if *drawn != other {
                locked(&errors).record(Quantity::Sample, 1.0, middle(s.x, s.y));
            }
        }
    };
    SampleHook {
        is_drawn: Arc::new(is_drawn),
        ..exact
    }
}

/// The middle of a pixel.
fn middle(x: impl Into<f64>, y: impl Into<f64>) -> Place {
    Place::Pixel([x.into() + 0.5, y.into() + 0.5])
}

fn is_cancelled(errors: &Mutex<Errors>) -> bool {
    locked(errors).cancelled.load(Ordering::Relaxed)
}

/// The surface as the f32 side gets it.
pub(super) fn rounded(s: Surface) -> Surface {
    let three = |v: DVec3| v.as_vec3().as_dvec3();
    let two = |v: DVec2| v.as_vec2().as_dvec2();
    let one = |v: f64| f64::from(v as f32);
    Surface {
        color: s.color.as_vec4().as_dvec4(),
        glow: three(s.glow),
        position: three(s.position),
        normal: three(s.normal),
        flat_normal: three(s.flat_normal),
        view: three(s.view),
        center: three(s.center),
        center_screen: two(s.center_screen),
        screen: two(s.screen),
        pixel: two(s.pixel),
        barycentrics: three(s.barycentrics),
        edge_distance_px: three(s.edge_distance_px),
        depth_m: one(s.depth_m),
        pixel_size_m: one(s.pixel_size_m),
        flat_depth_m: one(s.flat_depth_m),
        depth_range_m: two(s.depth_range_m),
        rank: one(s.rank),
        lit: one(s.lit),
        finish: Finish {
            specular: s.finish.specular.as_vec4().as_dvec4(),
            metallic: one(s.finish.metallic),
            roughness: one(s.finish.roughness),
            occlusion: one(s.finish.occlusion),
        },
        ..s
    }
}

/// A linear color as the picture holds it, before it is rounded to bytes.
fn in_picture(color: DVec4) -> DVec4 {
    DVec4::new(srgb(color.x), srgb(color.y), srgb(color.z), color.w)
}

/// Largest difference of a channel of two colors of a picture, of 255; infinite if only the second
/// is not a color.
fn color_error(exact: DVec4, other: DVec4) -> f64 {
    if !exact.is_finite() {
        return 0.0; // Nothing can be told of an error of what is no color.
    }
    if !other.is_finite() {
        return f64::INFINITY;
    }
    255.0
        * (exact.clamp(DVec4::ZERO, DVec4::ONE) - other.clamp(DVec4::ZERO, DVec4::ONE))
            .abs()
            .max_element()
}
