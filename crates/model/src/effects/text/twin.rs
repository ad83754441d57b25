//! The f64 side of an effect: its own text, evaluated on the CPU with integers exact and
//! floats in f64.

use std::{
    array,
    cell::RefCell,
    collections::HashMap,
    slice,
    sync::{Arc, Weak},
};

use glam::{DVec3, DVec4};

use crate::{
    effects::{
        Effect,
        hooks::{
            ErrorBound, ROUNDING, Sample, SampleHook, SetupFunction, Surface, SurfaceFunction,
            TriangleSetup, Vertex, VertexFunction, VertexHook,
        },
        image_file::ImageFile,
    },
    evaluator::{Host, LANES, LowerError, NoHost, Options, Precision, Program, Registers, Word},
    math::hash,
    params::{Field, ValueType, WgslType},
};

mod vertex;
pub use vertex::{moving, vertex};

/// Instructions of one call. The loops of an effect end long before.
const MAX_STEPS: u64 = 100_000_000;
/// Functions of the library that read more than their arguments: of `lib/image`,
/// `lib/image_pass`, `lib/image_direction`, `lib/image_kept` and `lib/panorama`, then of
/// `lib/image_file`.
pub const EXTERNALS: [&str; 21] = [
    "image_has",
    "image_at",
    "image_background",
    "image_size",
    "image_previous",
    "image_color",
    "image_color_at",
    "image_last",
    "image_last_at",
    "image_depth_m",
    "image_meters",
    "image_pixel_size_m",
    "image_normal",
    "image_direction",
    "image_kept",
    "image_kept_at",
    "panorama_irradiance",
    "panorama_radiance",
    "image_meters_apart",
    "image_file_size",
    "image_file_texel",
];
/// Index of the first function of `lib/image_file`.
const IMAGE_FILES: usize = 19;
/// How much the inputs of a color may be off on the f32 side, relative to the largest component of
/// each: as a fraction of the step's offset.
const INPUT_ERROR: f64 = 0.25;
/// The farthest that a function behind `@reach` may let a vertex move; beyond that, and where it
/// gives no number, nothing moves.
pub const MOST_REACH_M: f64 = 1e12;
/// Bytes of registers that a thread keeps, beside those of the program that it runs.
const MAX_BYTES: usize = 16 << 20;

/// The registers of a program, which they do not hold.
type Kept = (Weak<Program>, Registers);

/// One function of a linked module.
#[derive(Clone, Debug)]
pub struct Function {
    program: Arc<Program>,
    /// Members of the struct of parameters, in its order.
    members: Vec<Arc<Field>>,
    images: Vec<Arc<ImageFile>>,
}

impl Function {
    /// Lowers `name` of `module`, a function of `effect` that was read from `text`.
    ///
    /// # Errors
    /// The function uses what cannot be evaluated, or is too long with all that it calls.
    pub fn new(
        module: &naga::Module,
        text: &str,
        name: &str,
        effect: &Effect,
        precision: Precision,
    ) -> Result<Self, LowerError> {
        let members = effect.members();
        let mut options = Options {
            precision,
            source: Some(text),
            externals: EXTERNALS.map(str::to_owned).to_vec(),
            alike: members.iter().map(|field| field.wgsl.words()).sum(),
            ..Options::default()
        };
        options.limits.steps = MAX_STEPS;
        let program = Arc::new(Program::new(module, name, &options)?);
        let images = effect.images().iter().map(|image| image.file.clone());
        Ok(Self {
            program,
            members,
            images: images.collect(),
        })
    }

    /// Length of the function with all that it calls.
    pub fn instructions(&self) -> usize {
        self.program.instructions()
    }

    /// Evaluates the function for at most [`LANES`] samples, given the parameter words: `write`
    /// writes the arguments of all, `read` reads the results into the samples. Those for which it
    /// does not end are `left` alone.
    pub(super) fn run<S>(
        &self,
        samples: &mut [S],
        words: &[u32],
        host: &mut dyn Host,
        write: impl Fn(&mut Inputs<'_, S>),
        read: impl Fn(&mut Outputs<'_, S>),
        left: impl Fn(&mut S),
    ) {
        thread_local! {
            /// By the address of the program, which no other has as long as it is weakly held.
            static REGISTERS: RefCell<HashMap<usize, Kept>> = RefCell::new(HashMap::new());
        }
        let mut alike = Vec::new();
        for field in &self.members {
            let words = &words[field.offset / 4..][..field.wgsl.words()];
            alike.extend(words.iter().map(|&word| match field.wgsl {
                WgslType::F32 | WgslType::Vec4F32 => Word::from_f64(f32::from_bits(word).into()),
                WgslType::I32 | WgslType::U32 => Word::from_u32(word),
            }));
        }
        REGISTERS.with_borrow_mut(|kept| {
            let address = Arc::as_ptr(&self.program) as usize;
            let bytes = |kept: &HashMap<usize, Kept>| -> usize {
                kept.values().map(|(_, registers)| registers.bytes()).sum()
            };
            if !kept.contains_key(&address) {
                kept.retain(|_, (program, _)| program.strong_count() > 0);
                if bytes(kept) > MAX_BYTES {
                    kept.clear();
                }
            }
            let (_, registers) = kept
                .entry(address)
                .or_insert_with(|| (Arc::downgrade(&self.program), self.program.registers()));
            write(&mut Inputs {
                program: &self.program,
                registers,
                samples,
                next: 0,
            });
            let images = &self.images;
            let mut host = ImageFileHost { images, host };
            let ended = self
                .program
                .run(registers, &alike, samples.len(), &mut host);
            read(&mut Outputs {
                program: &self.program,
                registers,
                samples,
                ended,
                next: 0,
            });
            let each = samples.iter_mut().enumerate();
            each.filter(|(lane, _)| ended >> lane & 1 == 0)
                .for_each(|(_, sample)| left(sample));
        });
    }
}

impl Function {
    /// What a function behind `@reach` says with these parameter words, meters; no less than 0.
    fn reach_m(&self, takes_radius: bool, radius_m: f64, words: &[u32]) -> f64 {
        // A function that returns its first argument leaves it where it is.
        let first = match takes_radius {
            true => radius_m,
            false => f32::from_bits(words[0]).into(),
        };
        let mut reach = [(radius_m, first)];
        self.run(
            &mut reach,
            words,
            &mut NoHost,
            |inputs| {
                if takes_radius {
                    inputs.floats(|(radius_m, _)| [*radius_m]);
                }
            },
            |outputs| {
                outputs.float(|(_, reach_m)| reach_m);
            },
            |_| {},
        );
        let [(_, reach_m)] = reach;
        if (0.0..=MOST_REACH_M).contains(&reach_m) {
            reach_m
        } else {
            0.0
        }
    }
}

/// Writes the scalars of a struct in the order in which it declares them, those of all samples
/// together.
pub(super) struct Inputs<'a, S> {
    program: &'a Program,
    registers: &'a Registers,
    samples: &'a [S],
    next: usize,
}

impl<S> Inputs<'_, S> {
    pub(super) fn words<const N: usize>(&mut self, of: impl Fn(&S) -> [Word; N]) -> &mut Self {
        let rows: [_; N] =
            std::array::from_fn(|word| self.program.argument(self.registers, self.next + word));
        self.next += N;
        // What the function does not read has no row.
        if rows.iter().any(Option::is_some) {
            for (lane, sample) in self.samples.iter().enumerate() {
                for (row, word) in rows.iter().zip(of(sample)) {
                    if let Some(row) = row {
                        row[lane].set(word);
                    }
                }
            }
        }
        self
    }

    pub(super) fn floats<const N: usize>(&mut self, of: impl Fn(&S) -> [f64; N]) -> &mut Self {
        self.words(|sample| of(sample).map(Word::from_f64))
    }

    pub(super) fn whole<const N: usize>(&mut self, of: impl Fn(&S) -> [u32; N]) -> &mut Self {
        self.words(|sample| of(sample).map(Word::from_u32))
    }
}

/// Reads scalars in the same order.
pub(super) struct Outputs<'a, S> {
    program: &'a Program,
    registers: &'a Registers,
    samples: &'a mut [S],
    ended: u64,
    next: usize,
}

impl<S> Outputs<'_, S> {
    /// Leaves what the function has not changed as it was.
    pub(super) fn words<T, const N: usize>(
        &mut self,
        of: impl for<'s> Fn(&'s mut S) -> &'s mut [T; N],
        value: impl Fn(Word) -> T,
    ) -> &mut Self {
        for word in 0..N {
            let Some(row) = self.program.result(self.registers, self.next + word) else {
                continue;
            };
            for (lane, sample) in self.samples.iter_mut().enumerate() {
                if self.ended >> lane & 1 == 1 {
                    of(sample)[word] = value(row[lane].get());
                }
            }
        }
        self.next += N;
        self
    }

    pub(super) fn floats<const N: usize>(
        &mut self,
        of: impl for<'s> Fn(&'s mut S) -> &'s mut [f64; N],
    ) -> &mut Self {
        self.words(of, Word::to_f64)
    }

    pub(super) fn float(&mut self, of: impl for<'s> Fn(&'s mut S) -> &'s mut f64) -> &mut Self {
        self.floats(|sample| array::from_mut(of(sample)))
    }

    pub(super) fn whole(&mut self, of: impl for<'s> Fn(&'s mut S) -> &'s mut u32) -> &mut Self {
        self.words(|sample| array::from_mut(of(sample)), Word::to_u32)
    }

    /// Passes over words.
    pub(super) fn skip(&mut self, words: usize) -> &mut Self {
        self.next += words;
        self
    }
}

/// Lengths among the parameters: a vertex effect moves a vertex by at most their sum.
pub fn lengths(fields: &[Arc<Field>]) -> impl Iterator<Item = &Arc<Field>> {
    fields
        .iter()
        .filter(|field| field.unit == "m" && field.value_type == ValueType::F32)
}

/// `values`, moved by `strength` times their largest magnitude, each up or down by a hash of its
/// `index`. 0 changes nothing.
pub(super) fn perturbed<const N: usize>(values: [f64; N], index: u32, strength: f64) -> [f64; N] {
    if strength == 0.0 {
        return values;
    }
    let largest = values
        .iter()
        .fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let sign = |component: usize| {
        if hash(index * 4 + component as u32) & 1 == 0 {
            1.0
        } else {
            -1.0
        }
    };
    std::array::from_fn(|component| values[component] + sign(component) * strength * largest)
}

/// How much inputs are moved to a side of a step.
pub(super) fn strength(step_offset: f64) -> f64 {
    INPUT_ERROR * step_offset
}

/// Hands samples to `run` that are evaluated alike: in f32, as `rounded`, to one side of a step, else
/// as `exact`.
pub(super) fn each_side<'f, S>(
    samples: &mut [S],
    [exact, rounded]: [&'f Function; 2],
    step_offset: impl Fn(&S) -> f64,
    mut run: impl FnMut(&mut [S], &'f Function),
) {
    let is_above = |sample: &S| step_offset(sample) > 0.0;
    for side in samples.chunk_by_mut(|a, b| is_above(a) == is_above(b)) {
        for together in side.chunks_mut(LANES) {
            let function = if is_above(&together[0]) {
                rounded
            } else {
                exact
            };
            run(together, function);
        }
    }
}

/// The surface hook. To one side of a step the function is evaluated in f32, as `rounded`: what
/// constants alone decide is moved by no input.
pub fn surface(exact: Function, rounded: Function) -> Arc<SurfaceFunction> {
    Arc::new(move |surfaces: &mut [Surface], words: &[u32]| {
        let sides = [&exact, &rounded];
        each_side(
            surfaces,
            sides,
            |s| s.step_offset,
            |together, function| {
                let (write, read) = (write_surfaces, read_surfaces);
                let left = |s: &mut Surface| s.color = DVec4::NAN;
                function.run(together, words, &mut NoHost, write, read, left);
            },
        );
    })
}

fn write_surfaces(inputs: &mut Inputs<'_, Surface>) {
    fn moved<const N: usize>(s: &Surface, values: impl Into<[f64; N]>, index: u32) -> [f64; N] {
        perturbed(values.into(), index, strength(s.step_offset))
    }
    inputs
        .floats(|s| moved(s, s.color, 0))
        .floats(|s| moved(s, s.glow, 1))
        .floats(|s| moved(s, s.position, 2))
        .floats(|s| moved(s, s.normal, 3))
        .floats(|s| moved(s, s.flat_normal, 4))
        .floats(|s| moved(s, s.view, 5))
        .floats(|s| moved(s, s.center, 6))
        .floats(|s| moved(s, s.center_screen, 7))
        .floats(|s| moved(s, s.screen, 8))
        .floats(|s| moved(s, s.pixel, 9))
        .floats(|s| moved(s, s.barycentrics, 10))
        .floats(|s| moved(s, s.edge_distance_px, 11))
        .floats(|s| moved(s, [s.depth_m], 12))
        .floats(|s| moved(s, [s.pixel_size_m], 13))
        .floats(|s| moved(s, [s.flat_depth_m], 14))
        .floats(|s| s.depth_range_m.to_array())
        .whole(|s| [s.triangle_id])
        .floats(|s| [s.rank, s.lit])
        .floats(|s| moved(s, s.finish.specular, 15))
        .floats(|s| [s.finish.metallic, s.finish.roughness, s.finish.occlusion]);
}

fn read_surfaces(outputs: &mut Outputs<'_, Surface>) {
    outputs
        .floats(|s| s.color.as_mut())
        .floats(|s| s.glow.as_mut())
        .floats(|s| s.position.as_mut())
        .floats(|s| s.normal.as_mut())
        .floats(|s| s.flat_normal.as_mut())
        .floats(|s| s.view.as_mut())
        .floats(|s| s.center.as_mut())
        .floats(|s| s.center_screen.as_mut())
        .floats(|s| s.screen.as_mut())
        .floats(|s| s.pixel.as_mut())
        .floats(|s| s.barycentrics.as_mut())
        .floats(|s| s.edge_distance_px.as_mut())
        .float(|s| &mut s.depth_m)
        .float(|s| &mut s.pixel_size_m)
        .float(|s| &mut s.flat_depth_m)
        .floats(|s| s.depth_range_m.as_mut())
        .whole(|s| &mut s.triangle_id)
        .float(|s| &mut s.rank)
        .float(|s| &mut s.lit)
        .floats(|s| s.finish.specular.as_mut())
        .float(|s| &mut s.finish.metallic)
        .float(|s| &mut s.finish.roughness)
        .float(|s| &mut s.finish.occlusion);
}

/// Answers what an effect asks of the pictures that it takes as inputs, and lets `host` answer the
/// rest.
struct ImageFileHost<'a> {
    images: &'a [Arc<ImageFile>],
    host: &'a mut dyn Host,
}

impl Host for ImageFileHost<'_> {
    fn external(&mut self, index: usize, lane: usize, arguments: &[Word], result: &mut [Word]) {
        let last = self.images.len().saturating_sub(1);
        let image = || self.images.get((arguments[0].to_u32() as usize).min(last));
        match index.checked_sub(IMAGE_FILES) {
            None => self.host.external(index, lane, arguments, result),
            Some(0) => {
                let size = image().map_or([1, 1], |image| image.size);
                result.copy_from_slice(&size.map(Word::from_u32));
            }
            Some(_) => {
                let [x, y] = [1, 2].map(|axis| i64::from(arguments[axis].to_i32()));
                let texel = image().map_or(DVec4::ZERO, |image| image.texel(x, y));
                result.copy_from_slice(&texel.to_array().map(Word::from_f64));
            }
        }
    }
}

/// The sample hook.
pub fn sample(function: Function) -> SampleHook {
    let is_drawn = move |samples: &[Sample], words: &[u32], drawn: &mut [bool]| {
        let mut tested: Vec<(Sample, u32)> = samples.iter().map(|s| (*s, 1)).collect();
        for together in tested.chunks_mut(LANES) {
            function.run(
                together,
                words,
                &mut NoHost,
                |inputs| {
                    inputs
                        .whole(|(s, _)| [s.x, s.y, s.triangle])
                        .whole(|(s, _)| s.areas)
                        .whole(|(s, _)| s.setup);
                },
                |outputs| {
                    outputs.whole(|(_, is_drawn)| is_drawn);
                },
                |_| {},
            );
        }
        for ((_, is_drawn), drawn) in tested.iter().zip(drawn) {
            *drawn &= *is_drawn != 0;
        }
    };
    SampleHook {
        has_setup: false,
        error_bound: Arc::new(|_, _| 0.0),
        is_from_floats: Arc::new(|_| false),
        sample_setup: Arc::new(|_, _, _| [0; 4]),
        is_drawn: Arc::new(is_drawn),
    }
}

/// What a sample effect computes for each triangle. The f64 side may be given the word that comes
/// from floats; the text computes it anew.
pub fn sample_setup(function: Function) -> Arc<SetupFunction> {
    Arc::new(move |t: &TriangleSetup, words: &[u32], _: Option<u32>| {
        let mut setup = (t, [0; 4]);
        function.run(
            slice::from_mut(&mut setup),
            words,
            &mut NoHost,
            |inputs| {
                let corner =
                    |k: usize| move |t: &TriangleSetup| t.corners[k].map(i32::cast_unsigned);
                inputs
                    .whole(|(t, _)| [t.triangle])
                    .whole(|(t, _)| corner(0)(t))
                    .whole(|(t, _)| corner(1)(t))
                    .whole(|(t, _)| corner(2)(t))
                    .whole(|(t, _)| [t.outline, t.size[0], t.size[1]])
                    .floats(|(t, _)| t.center.to_array())
                    .floats(|(t, _)| t.center_screen.to_array());
            },
            |outputs| {
                outputs.words(|(_, setup)| setup, Word::to_u32);
            },
            |_| {},
        );
        setup.1
    })
}
