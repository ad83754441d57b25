//! The f64 side of an effect: its own text, evaluated on the CPU with integers exact and
//! floats in f64.

use std::{
    cell::RefCell,
    collections::HashMap,
    sync::{Arc, Weak},
};

use glam::{DVec2, DVec3, DVec4};

use crate::{
    effects::{
        Effect,
        hooks::{
            ErrorBound, ImageAt, ImageHook, ImagePass, PassHook, Picture, Pixel, ROUNDING, Sample,
            SampleHook, SetupFunction, Surface, SurfaceFunction, TriangleSetup, Vertex, VertexHook,
        },
        image_file::ImageFile,
    },
    evaluator::{Host, LowerError, NoHost, Options, Precision, Program, Word},
    math::hash,
    params::{Field, ValueType, WgslType},
};

/// Instructions of one call. The loops of an effect end long before.
const MAX_STEPS: u64 = 100_000_000;
/// Functions of the library that read more than their arguments: of `lib/image`,
/// `lib/image_pass`, `lib/image_direction` and `lib/image_kept`, then of `lib/image_file`.
pub const EXTERNALS: [&str; 18] = [
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
    "image_file_size",
    "image_file_texel",
];
/// Index of the first function of `lib/image_file`.
const IMAGE_FILES: usize = 16;
/// How much the inputs of a color may be off on the f32 side, relative to the largest component of
/// each.
const INPUT_ERROR: f64 = 1.0 / (1 << 17) as f64;
/// Programs whose registers a thread keeps.
const MAX_PROGRAMS: usize = 64;

/// The registers of a program, which they do not hold.
type Kept = (Weak<Program>, Vec<Word>);

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
        let mut options = Options {
            precision,
            source: Some(text),
            externals: EXTERNALS.map(str::to_owned).to_vec(),
            ..Options::default()
        };
        options.limits.steps = MAX_STEPS;
        let program = Arc::new(Program::new(module, name, &options)?);
        let images = effect.images().iter().map(|image| image.file.clone());
        Ok(Self {
            program,
            members: effect.members(),
            images: images.collect(),
        })
    }

    /// Length of the function with all that it calls.
    pub fn instructions(&self) -> usize {
        self.program.instructions()
    }

    /// Evaluates the function for arguments and parameter words; none if it does not end.
    fn call<R>(
        &self,
        mut arguments: Vec<Word>,
        words: &[u32],
        host: &mut dyn Host,
        read: impl FnOnce(&mut Reader<'_>) -> R,
    ) -> Option<R> {
        thread_local! {
            /// By the address of the program, which no other has as long as it is weakly held.
            static REGISTERS: RefCell<HashMap<usize, Kept>> = RefCell::new(HashMap::new());
        }
        for field in &self.members {
            let words = &words[field.offset / 4..][..field.wgsl.words()];
            arguments.extend(words.iter().map(|&word| match field.wgsl {
                WgslType::F32 | WgslType::Vec4F32 => Word::from_f64(f32::from_bits(word).into()),
                WgslType::I32 | WgslType::U32 => Word::from_u32(word),
            }));
        }
        REGISTERS.with_borrow_mut(|kept| {
            let address = Arc::as_ptr(&self.program) as usize;
            if kept.len() >= MAX_PROGRAMS && !kept.contains_key(&address) {
                kept.retain(|_, (program, _)| program.strong_count() > 0);
                if kept.len() >= MAX_PROGRAMS {
                    kept.clear();
                }
            }
            let (_, registers) = kept
                .entry(address)
                .or_insert_with(|| (Arc::downgrade(&self.program), self.program.registers()));
            let images = &self.images;
            let mut host = ImageFileHost { images, host };
            let result = self.program.call(registers, &arguments, &mut host).ok()?;
            Some(read(&mut Reader(result)))
        })
    }
}

/// Scalars of a struct, in the order in which it declares them.
#[derive(Default)]
struct Writer(Vec<Word>);

impl Writer {
    fn floats<const N: usize>(&mut self, values: [f64; N]) -> &mut Self {
        self.0.extend(values.map(Word::from_f64));
        self
    }

    fn whole(&mut self, value: u32) -> &mut Self {
        self.0.push(Word::from_u32(value));
        self
    }
}

/// Reads scalars in the same order.
struct Reader<'a>(&'a [Word]);

impl Reader<'_> {
    fn word(&mut self) -> Word {
        let (first, rest) = self
            .0
            .split_first()
            .expect("a result has the scalars of its type");
        self.0 = rest;
        *first
    }

    fn floats<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.word().to_f64())
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
fn perturbed<const N: usize>(values: [f64; N], index: u32, strength: f64) -> [f64; N] {
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

/// The surface hook. To one side of a step the function is evaluated in f32, as `rounded`: what
/// constants alone decide is moved by no input.
pub fn surface(exact: Function, rounded: Function) -> Arc<SurfaceFunction> {
    Arc::new(move |mut s: Surface, words: &[u32]| {
        let function = if s.step_offset > 0.0 {
            &rounded
        } else {
            &exact
        };
        let strength = INPUT_ERROR
            * if s.step_offset == 0.0 {
                0.0
            } else {
                s.step_offset.signum()
            };
        let mut arguments = Writer::default();
        arguments
            .floats(perturbed(s.color.to_array(), 0, strength))
            .floats(perturbed(s.glow.to_array(), 1, strength))
            .floats(perturbed(s.position.to_array(), 2, strength))
            .floats(perturbed(s.normal.to_array(), 3, strength))
            .floats(perturbed(s.flat_normal.to_array(), 4, strength))
            .floats(perturbed(s.view.to_array(), 5, strength))
            .floats(perturbed(s.center.to_array(), 6, strength))
            .floats(perturbed(s.center_screen.to_array(), 7, strength))
            .floats(perturbed(s.screen.to_array(), 8, strength))
            .floats(perturbed(s.pixel.to_array(), 9, strength))
            .floats(perturbed(s.barycentrics.to_array(), 10, strength))
            .floats(perturbed(s.edge_distance_px.to_array(), 11, strength))
            .floats(perturbed([s.depth_m], 12, strength))
            .floats(perturbed([s.pixel_size_m], 13, strength))
            .floats(perturbed([s.flat_depth_m], 14, strength))
            .floats(s.depth_range_m.to_array())
            .whole(s.triangle_id)
            .floats([s.rank, s.lit])
            .floats(perturbed(s.finish.specular.to_array(), 15, strength))
            .floats([s.finish.metallic, s.finish.roughness, s.finish.occlusion]);
        let read = function.call(arguments.0, words, &mut NoHost, |result| {
            s.color = DVec4::from_array(result.floats());
            s.glow = DVec3::from_array(result.floats());
            s.position = DVec3::from_array(result.floats());
            s.normal = DVec3::from_array(result.floats());
            s.flat_normal = DVec3::from_array(result.floats());
            s.view = DVec3::from_array(result.floats());
            s.center = DVec3::from_array(result.floats());
            s.center_screen = DVec2::from_array(result.floats());
            s.screen = DVec2::from_array(result.floats());
            s.pixel = DVec2::from_array(result.floats());
            s.barycentrics = DVec3::from_array(result.floats());
            s.edge_distance_px = DVec3::from_array(result.floats());
            [s.depth_m, s.pixel_size_m, s.flat_depth_m] = result.floats();
            s.depth_range_m = DVec2::from_array(result.floats());
            s.triangle_id = result.word().to_u32();
            [s.rank, s.lit] = result.floats();
            s.finish.specular = DVec4::from_array(result.floats());
            let finish = &mut s.finish;
            [finish.metallic, finish.roughness, finish.occlusion] = result.floats();
            s
        });
        read.unwrap_or(Surface {
            color: DVec4::NAN,
            ..s
        })
    })
}

/// Answers what an effect asks of the pictures that it takes as inputs, and lets `host` answer the
/// rest.
struct ImageFileHost<'a> {
    images: &'a [Arc<ImageFile>],
    host: &'a mut dyn Host,
}

impl Host for ImageFileHost<'_> {
    fn external(&mut self, index: usize, arguments: &[Word], result: &mut [Word]) {
        let last = self.images.len().saturating_sub(1);
        let image = || self.images.get((arguments[0].to_u32() as usize).min(last));
        match index.checked_sub(IMAGE_FILES) {
            None => self.host.external(index, arguments, result),
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

/// Answers what an image effect asks of the picture.
struct PictureHost<'a>(&'a Picture<'a>, usize);

impl Host for PictureHost<'_> {
    fn external(&mut self, index: usize, arguments: &[Word], result: &mut [Word]) {
        let Self(picture, pixel) = self;
        let at = || {
            (
                i64::from(arguments[0].to_i32()),
                i64::from(arguments[1].to_i32()),
            )
        };
        let row = *pixel as u32 / picture.width;
        match index {
            0 => result[0] = Word::from_bool(picture.has(at().0, at().1)),
            1 => {
                let (id, key, draw) = picture.at(at().0, at().1);
                result.copy_from_slice(&[id.unwrap_or(u32::MAX), key, draw].map(Word::from_u32));
            }
            2 => result.copy_from_slice(&picture.background(row).to_array().map(Word::from_f64)),
            3 => result.copy_from_slice(&[picture.width, picture.height].map(Word::from_u32)),
            _ => {
                let background = picture.background[row as usize].map(u32::from);
                let bytes = picture
                    .previous
                    .map_or(background, |previous| previous[*pixel].map(u32::from));
                result.copy_from_slice(&bytes.map(Word::from_u32));
            }
        }
    }
}

/// The image hook, in f32 to one side of a step as [`surface`].
pub fn image(exact: Function, rounded: Function, reads_previous: bool) -> ImageHook {
    let finish = move |mut q: Pixel, picture: &Picture<'_>, words: &[u32]| {
        let function = if q.step_offset > 0.0 {
            &rounded
        } else {
            &exact
        };
        let strength = INPUT_ERROR
            * if q.step_offset == 0.0 {
                0.0
            } else {
                q.step_offset.signum()
            };
        let mut arguments = Writer::default();
        arguments
            .floats(perturbed(q.color.to_array(), 0, strength))
            .whole(q.x)
            .whole(q.y);
        let mut host = PictureHost(
            picture,
            q.y as usize * picture.width as usize + q.x as usize,
        );
        let read = function.call(arguments.0, words, &mut host, |result| {
            q.color = DVec4::from_array(result.floats());
            [q.x, q.y] = [result.word().to_u32(), result.word().to_u32()];
            q
        });
        read.unwrap_or(Pixel {
            color: DVec4::NAN,
            ..q
        })
    };
    ImageHook {
        reads_previous,
        finish: Arc::new(finish),
    }
}

/// Answers what a pass asks of the picture and of the pass before it.
struct PassHost<'a>(&'a ImageAt<'a>);

impl Host for PassHost<'_> {
    fn external(&mut self, index: usize, arguments: &[Word], result: &mut [Word]) {
        let at = self.0;
        let pixel = || [0, 1].map(|axis| i64::from(arguments[axis].to_i32()));
        let place = || DVec2::new(arguments[0].to_f64(), arguments[1].to_f64());
        let color = match index {
            5 => at.color(pixel()[0], pixel()[1]),
            6 => at.color_at(place()),
            7 => at.last(pixel()[0], pixel()[1]),
            8 => at.last_at(place()),
            9 => {
                result[0] = Word::from_f64(at.depth_m(pixel()[0], pixel()[1]));
                return;
            }
            10 => {
                result[0] = Word::from_f64(at.input.lens.meters(arguments[0].to_f64()));
                return;
            }
            11 => {
                result[0] = Word::from_f64(at.input.lens.pixel_size_m(arguments[0].to_f64()));
                return;
            }
            12 => {
                let normal = at.normal(pixel()[0], pixel()[1]);
                result.copy_from_slice(&normal.to_array().map(Word::from_f64));
                return;
            }
            13 => {
                let direction = at.direction(place());
                result.copy_from_slice(&direction.to_array().map(Word::from_f64));
                return;
            }
            14 => at.kept(pixel()[0], pixel()[1]),
            15 => at.kept_at(place()),
            _ => return PictureHost(at.input.picture, 0).external(index, arguments, result),
        };
        result.copy_from_slice(&color.to_array().map(Word::from_f64));
    }
}

/// The passes of an effect, each evaluated in f64, and in f32 to one side of a step as
/// [`surface`].
pub fn passes(passes: Vec<ImagePass>, exact: Vec<Function>, rounded: Vec<Function>) -> PassHook {
    let run = move |index: usize, at: &ImageAt<'_>, words: &[u32]| {
        let functions = if at.step_offset > 0.0 {
            &rounded
        } else {
            &exact
        };
        let mut arguments = Writer::default();
        for word in [at.x as u32, at.y as u32, at.size[0], at.size[1], at.scale] {
            arguments.whole(word);
        }
        let read = |result: &mut Reader<'_>| DVec4::from_array(result.floats());
        functions[index]
            .call(arguments.0, words, &mut PassHost(at), read)
            .unwrap_or(DVec4::NAN)
    };
    PassHook {
        passes,
        run: Arc::new(run),
    }
}

/// The sample hook.
pub fn sample(function: Function) -> SampleHook {
    let is_drawn = move |s: &Sample, words: &[u32]| {
        let mut arguments = Writer::default();
        arguments.whole(s.x).whole(s.y).whole(s.triangle);
        s.areas
            .iter()
            .chain(&s.setup)
            .for_each(|&word| arguments.0.push(Word::from_u32(word)));
        function
            .call(arguments.0, words, &mut NoHost, |result| {
                result.word().to_bool()
            })
            .unwrap_or(true)
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
        let mut arguments = Writer::default();
        arguments.whole(t.triangle);
        t.corners
            .as_flattened()
            .iter()
            .for_each(|at| arguments.0.push(Word::from_i32(*at)));
        arguments.whole(t.outline).whole(t.size[0]).whole(t.size[1]);
        arguments
            .floats(t.center.to_array())
            .floats(t.center_screen.to_array());
        let read = |result: &mut Reader<'_>| std::array::from_fn(|_| result.word().to_u32());
        function
            .call(arguments.0, words, &mut NoHost, read)
            .unwrap_or([0; 4])
    })
}

/// A corner with its members moved by up to `bound` times `strength`, by a hash of `turn`.
fn moved_within(v: &Vertex, bound: &ErrorBound, turn: u32) -> Vertex {
    let away = |values: DVec3, index: u32, by: f64| {
        let sign = |component: u32| {
            if hash(turn * 64 + index * 4 + component) & 1 == 0 {
                by
            } else {
                -by
            }
        };
        values + DVec3::new(sign(0), sign(1), sign(2))
    };
    let screen = away(v.center_screen.extend(0.0), 6, bound.center_screen);
    Vertex {
        position: away(v.position, 0, bound.position_m),
        offset: away(v.offset, 1, bound.offset_m),
        normal: away(v.normal, 2, bound.normal),
        flat_normal: away(v.flat_normal, 3, bound.flat_normal),
        center: away(v.center, 4, bound.center_m),
        arm: away(v.arm, 5, bound.arm_m),
        center_screen: screen.truncate(),
        triangle: v.triangle,
        cell_px: v.cell_px,
    }
}

/// The vertex hook: `double` in f64, `single` with every operation rounded to f32.
pub fn vertex(double: Function, single: Function, needs_triangle: bool) -> VertexHook {
    let evaluate = |function: &Function, v: &Vertex, words: &[u32]| {
        let mut arguments = Writer::default();
        arguments
            .floats(v.position.to_array())
            .floats(v.offset.to_array())
            .floats(v.normal.to_array())
            .floats(v.flat_normal.to_array())
            .floats(v.center.to_array())
            .floats(v.arm.to_array())
            .floats(v.center_screen.to_array())
            .whole(v.triangle)
            .whole(v.cell_px);
        let read = function.call(arguments.0, words, &mut NoHost, |result| {
            let _position: [f64; 3] = result.floats();
            let [offset, normal] = [(); 2].map(|()| DVec3::from_array(result.floats()));
            // What lies between is only read.
            let _: [f64; 11] = result.floats();
            let _triangle = result.word();
            (offset, normal, result.word().to_u32())
        });
        read.map_or(
            Vertex {
                offset: DVec3::NAN,
                ..*v
            },
            |(offset, normal, cell_px)| Vertex {
                offset,
                normal,
                cell_px,
                ..*v
            },
        )
    };
    let (moving, fields) = (double.clone(), double.members.clone());
    let moved = move |v: Vertex, words: &[u32]| evaluate(&moving, &v, words);
    let limit = move |_: f64, words: &[u32]| {
        lengths(&fields)
            .map(|field| field.get(words)[0].abs())
            .sum()
    };
    // The text is evaluated at inputs at the ends of their bounds and in f32. Twice the largest
    // difference is the bound.
    let error_bound = move |v: &Vertex, bound: ErrorBound, words: &[u32]| {
        let exact = evaluate(&double, v, words);
        let rounded = Vertex {
            position: v.position.as_vec3().as_dvec3(),
            offset: v.offset.as_vec3().as_dvec3(),
            normal: v.normal.as_vec3().as_dvec3(),
            flat_normal: v.flat_normal.as_vec3().as_dvec3(),
            center: v.center.as_vec3().as_dvec3(),
            arm: v.arm.as_vec3().as_dvec3(),
            center_screen: v.center_screen.as_vec2().as_dvec2(),
            triangle: v.triangle,
            cell_px: v.cell_px,
        };
        let others = (0..6)
            .map(|turn| evaluate(&double, &moved_within(v, &bound, turn), words))
            .chain([evaluate(&single, &rounded, words)]);
        let (mut offset_m, mut normal) = (0.0_f64, 0.0_f64);
        for other in others {
            offset_m = offset_m.max((other.offset - exact.offset).abs().max_element());
            normal = normal.max((other.normal - exact.normal).abs().max_element());
        }
        let scale = v.position.abs().max_element() + exact.offset.abs().max_element();
        let (offset_m, normal) = (
            2.0 * offset_m + 16.0 * ROUNDING * scale,
            2.0 * normal + 16.0 * ROUNDING,
        );
        ErrorBound {
            offset_m,
            along_m: DVec3::ZERO,
            normal,
            ..bound
        }
    };
    VertexHook {
        needs_triangle,
        moved: Arc::new(moved),
        error_bound: Arc::new(error_bound),
        max_displacement_m: Arc::new(limit),
    }
}
