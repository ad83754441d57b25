//! Soundness probes: effects that do what another effect does, and record on the way where its
//! result stops being a color, or what a pass writes stops being finite.

use std::sync::{
    Arc, Mutex, Weak,
    atomic::{AtomicBool, AtomicU32, Ordering},
};

use glam::DVec4;

use super::{
    evaluated::{EvaluatedError, evaluated_in},
    precision::{Probes, kept, locked, rounded},
};
use crate::{
    effects::{
        Effect, Stack,
        hooks::{
            FinishFunction, Hooks, ImageAt, ImageHook, PassHook, Picture, Pixel, Signs, Surface,
            SurfaceFunction,
        },
    },
    evaluator::Precision,
    params::Field,
    shader::library::Library,
};

/// Pixels at which the parameter is looked for; at more of them only the effect is named.
const MAX_EXPLAINED: u32 = 4096;

/// In what way a color is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Unsound {
    NotANumber,
    Infinite,
    Negative,
}

impl Unsound {
    /// The word for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NotANumber => "NaN",
            Self::Infinite => "infinity",
            Self::Negative => "a negative color",
        }
    }

    fn of(color: DVec4, others: &[f64]) -> Option<Self> {
        let mut all = color.to_array().into_iter().chain(others.iter().copied());
        if all.clone().any(f64::is_nan) {
            Some(Self::NotANumber)
        } else if all.any(f64::is_infinite) {
            Some(Self::Infinite)
        } else {
            (color.min_element() < 0.0).then_some(Self::Negative)
        }
    }
}

/// A pixel at which an effect makes no color of a color.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Column and row.
    pub pixel: [u32; 2],
    pub effect: Arc<Effect>,
    pub made: Unsound,
    /// The parameter whose default would have given a color; none if it cannot be told.
    pub parameter: Option<Arc<Field>>,
    /// Only the f32 side does, or both.
    pub only_f32: bool,
}

/// An effect that records where it crosses.
struct SoundnessProbe {
    effect: Arc<Effect>,
    recorder: Arc<Recorder>,
}

#[derive(Default)]
struct Recorder {
    crossings: Mutex<Vec<Crossing>>,
    explained: AtomicU32,
    is_on: AtomicBool,
}

/// One result of an effect, as far as it must be sound.
type Outcome = Option<Unsound>;

fn of_surface(s: &Surface) -> Outcome {
    let [g, n, p] = [s.glow, s.normal, s.position].map(|v| v.to_array());
    Unsound::of(s.color, &[g, n, p].concat())
}

/// Pixels of a picture at which an effect of `stack` makes no color of a color, by row; the first
/// effect where there are several. `draw` draws the picture with the stack that it is given, or
/// anything that shades its samples.
///
/// # Errors
/// The text of an effect cannot be evaluated in f32.
pub fn crossings<T>(
    stack: &Stack,
    draw: impl FnOnce(&Stack) -> T,
) -> Result<(T, Vec<Crossing>), EvaluatedError> {
    // One picture at a time, since the probes are shared.
    static IN_USE: Mutex<()> = Mutex::new(());
    let _in_use = locked(&IN_USE);
    let mut probed = stack.clone();
    let mut probes = Vec::new();
    for enabled in &mut probed.0 {
        let probe = SoundnessProbe::of(&enabled.effect)?;
        enabled.effect = probe.effect.clone();
        probe.recorder.explained.store(0, Ordering::Relaxed);
        locked(&probe.recorder.crossings).clear();
        probe.recorder.is_on.store(true, Ordering::Relaxed);
        probes.push(probe);
    }
    let drawn = draw(&probed);
    let mut all = Vec::new();
    for probe in probes {
        probe.recorder.is_on.store(false, Ordering::Relaxed);
        all.append(&mut locked(&probe.recorder.crossings));
    }
    // The sort is stable, so the effects of a pixel stay in the order of the stack.
    all.sort_by_key(|crossing| [crossing.pixel[1], crossing.pixel[0]]);
    all.dedup_by_key(|crossing| crossing.pixel);
    Ok((drawn, all))
}

impl SoundnessProbe {
    fn of(effect: &Arc<Effect>) -> Result<Arc<Self>, EvaluatedError> {
        static KNOWN: Probes<SoundnessProbe> = Mutex::new(Vec::new());
        kept(&KNOWN, effect, || {
            // The kernels are f32, and the text says what they do.
            let is_colored = effect.hooks.surface.is_some() || effect.hooks.image.is_some();
            let single = match is_colored {
                true => evaluated_in(&Library::of_process(), effect, Precision::Single)?,
                false => Hooks::default(),
            };
            let (single_surface, single_image) = (single.surface, single.image);
            let recorder = Arc::new(Recorder::default());
            let mut hooks = effect.hooks.clone();
            if let Some(exact) = hooks.surface.clone() {
                let (recorder, probed, single) =
                    (recorder.clone(), Arc::downgrade(effect), single_surface);
                hooks.surface = Some(Arc::new(move |surfaces: &mut [Surface], words: &[u32]| {
                    let given = surfaces.to_vec();
                    exact(surfaces, words);
                    if !recorder.is_on.load(Ordering::Relaxed) {
                        return;
                    }
                    let mut in_single: Vec<Surface> = given.iter().copied().map(rounded).collect();
                    if let Some(single) = &single {
                        single(&mut in_single, words);
                    }
                    let one = |function: &SurfaceFunction, mut s: Surface, words: &[u32]| {
                        function(std::slice::from_mut(&mut s), words);
                        of_surface(&s)
                    };
                    for ((s, result), other) in given.into_iter().zip(surfaces).zip(in_single) {
                        if s.step_offset != 0.0 || of_surface(&s).is_some() {
                            continue;
                        }
                        let only_f32 = || single.as_ref().and_then(|_| of_surface(&other));
                        let retried = |is_f32: bool, words: &[u32]| match &single {
                            Some(single) if is_f32 => one(&**single, rounded(s), words),
                            _ => one(&*exact, s, words),
                        };
                        let pixel = s.pixel.to_array().map(|v| v as u32);
                        let made = [of_surface(result), only_f32()];
                        recorder.record(&probed, pixel, made, &retried, words);
                    }
                }));
            }
            if let Some(exact) = hooks.image.clone() {
                let (recorder, probed, single) =
                    (recorder.clone(), Arc::downgrade(effect), single_image);
                let exact_finish = exact.finish.clone();
                let finish = move |pixels: &mut [Pixel], picture: &Picture<'_>, words: &[u32]| {
                    let given = pixels.to_vec();
                    (exact_finish)(pixels, picture, words);
                    if !recorder.is_on.load(Ordering::Relaxed) {
                        return;
                    }
                    let rounded = |q: Pixel| Pixel {
                        color: q.color.as_vec4().as_dvec4(),
                        ..q
                    };
                    let mut in_single: Vec<Pixel> = given.iter().copied().map(rounded).collect();
                    if let Some(single) = &single {
                        (single.finish)(&mut in_single, picture, words);
                    }
                    let one = |function: &FinishFunction, mut q: Pixel, words: &[u32]| {
                        function(std::slice::from_mut(&mut q), picture, words);
                        Unsound::of(q.color, &[])
                    };
                    for ((q, result), other) in given.into_iter().zip(pixels).zip(in_single) {
                        if q.step_offset != 0.0 || Unsound::of(q.color, &[]).is_some() {
                            continue;
                        }
                        let only_f32 =
                            || single.as_ref().and_then(|_| Unsound::of(other.color, &[]));
                        let retried = |is_f32: bool, words: &[u32]| match &single {
                            Some(single) if is_f32 => one(&*single.finish, rounded(q), words),
                            _ => one(&*exact_finish, q, words),
                        };
                        let made = [Unsound::of(result.color, &[]), only_f32()];
                        recorder.record(&probed, [q.x, q.y], made, &retried, words);
                    }
                };
                hooks.image = Some(ImageHook {
                    finish: Arc::new(finish),
                    ..exact
                });
            }
            if let Some(exact) = hooks.passes.clone() {
                let (recorder, probed) = (recorder.clone(), Arc::downgrade(effect));
                let run = exact.run.clone();
                let run = move |index: usize, pixels: &[ImageAt<'_>], words: &[u32]| {
                    let written = run(index, pixels, words);
                    if recorder.is_on.load(Ordering::Relaxed) {
                        let judged = pixels.iter().zip(&written).filter(|(at, _)| {
                            at.step_offset == 0.0 && at.input.signs == Signs::None
                        });
                        for (at, color) in judged {
                            // What a pass writes may be data, so a negative number is none's fault.
                            let made = |color: DVec4| Unsound::of(color.abs(), &[]);
                            let retried =
                                |_: bool, words: &[u32]| made(run(index, &[*at], words)[0]);
                            let pixel = [at.x, at.y].map(|place| place as u32 * at.scale);
                            let of_both = [made(*color), None];
                            recorder.record(&probed, pixel, of_both, &retried, words);
                        }
                    }
                    written
                };
                hooks.passes = Some(PassHook {
                    run: Arc::new(run),
                    ..exact
                });
            }
            Ok(Self {
                effect: Arc::new(Effect {
                    hooks,
                    ..Effect::clone(effect)
                }),
                recorder,
            })
        })
    }
}

/// What an effect makes of the same input with other parameter words, in f32 or in f64.
type Retried<'a> = &'a dyn Fn(bool, &[u32]) -> Outcome;

impl Recorder {
    /// Records what `probed` made at a pixel with `words`, in f64 and in f32.
    fn record(
        &self,
        probed: &Weak<Effect>,
        pixel: [u32; 2],
        [exact, single]: [Outcome; 2],
        retried: Retried,
        words: &[u32],
    ) {
        let only_f32 = exact.is_none();
        let Some(made) = exact.or(single) else {
            return;
        };
        let Some(effect) = probed.upgrade() else {
            return;
        };
        let is_explained = self.explained.fetch_add(1, Ordering::Relaxed) < MAX_EXPLAINED;
        let parameter = if is_explained {
            parameter_of(&effect, words, |words| retried(only_f32, words))
        } else {
            None
        };
        locked(&self.crossings).push(Crossing {
            pixel,
            effect,
            made,
            parameter,
            only_f32,
        });
    }
}

/// The first parameter whose default, with all others as they are, gives a color.
fn parameter_of(
    effect: &Effect,
    words: &[u32],
    retried: impl Fn(&[u32]) -> Outcome,
) -> Option<Arc<Field>> {
    let defaults = &effect.defaults;
    let found = effect
        .fields
        .iter()
        .filter(|field| !field.same(words, defaults))
        .find(|field| {
            let mut changed = words.to_vec();
            field.set(&mut changed, &field.get(defaults)).is_ok() && retried(&changed).is_none()
        });
    found.cloned()
}
