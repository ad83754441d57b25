//! The f64 side of effects on the finished picture, and what answers their questions about it.

use std::sync::Arc;

use glam::{DVec2, DVec4};

use super::twin::{Function, each_side, perturbed, strength, surroundings};
use crate::{
    effects::hooks::{ImageAt, ImageHook, ImagePass, PassHook, Picture, Pixel},
    evaluator::{Host, Word},
};

/// Answers what an image effect asks of the picture at these pixels.
struct PictureHost<'a>(&'a Picture<'a>, &'a [usize]);

impl Host for PictureHost<'_> {
    fn external(&mut self, index: usize, lane: usize, arguments: &[Word], result: &mut [Word]) {
        let Self(picture, pixels) = self;
        let at = || {
            (
                i64::from(arguments[0].to_i32()),
                i64::from(arguments[1].to_i32()),
            )
        };
        let pixel = || pixels.get(lane).copied().unwrap_or(0);
        let row = || pixel() as u32 / picture.width;
        match index {
            0 => result[0] = Word::from_bool(picture.has(at().0, at().1)),
            1 => {
                let (id, key, draw) = picture.at(at().0, at().1);
                result.copy_from_slice(&[id.unwrap_or(u32::MAX), key, draw].map(Word::from_u32));
            }
            2 => result.copy_from_slice(&picture.background(row()).to_array().map(Word::from_f64)),
            3 => result.copy_from_slice(&[picture.width, picture.height].map(Word::from_u32)),
            _ => {
                let background = picture.background[row() as usize].map(u32::from);
                let bytes = picture
                    .previous
                    .map_or(background, |previous| previous[pixel()].map(u32::from));
                result.copy_from_slice(&bytes.map(Word::from_u32));
            }
        }
    }
}

/// The image hook, in f32 to one side of a step as [`super::twin::surface`].
pub fn image(exact: Function, rounded: Function, reads_previous: bool) -> ImageHook {
    let finish = move |pixels: &mut [Pixel], picture: &Picture<'_>, words: &[u32]| {
        let sides = [&exact, &rounded];
        each_side(
            pixels,
            sides,
            |q| q.step_offset,
            |together, function| {
                let index = |q: &Pixel| q.y as usize * picture.width as usize + q.x as usize;
                let indices: Vec<usize> = together.iter().map(index).collect();
                function.run(
                    together,
                    words,
                    &mut PictureHost(picture, &indices),
                    |inputs| {
                        inputs
                            .floats(|q| perturbed(q.color.to_array(), 0, strength(q.step_offset)))
                            .whole(|q| [q.x, q.y]);
                    },
                    |outputs| {
                        outputs
                            .floats(|q| q.color.as_mut())
                            .whole(|q| &mut q.x)
                            .whole(|q| &mut q.y);
                    },
                    |q| q.color = DVec4::NAN,
                );
            },
        );
    };
    ImageHook {
        reads_previous,
        finish: Arc::new(finish),
    }
}

/// How far a direction in f32 may be off its place in a picture of surroundings, whose side is 1.
const PLACE_ERROR: f64 = 1.0 / (1 << 20) as f64;

/// That, along both diagonals, where the picture is drawn at the edge of what f32 may do.
fn moved_place(at: &ImageAt<'_>) -> DVec2 {
    let along = match at.step_offset == 0.0 {
        true => 0.0,
        false => at.step_offset.signum(),
    };
    let across = at.input.signs.at(at.x, at.y);
    DVec2::new(along + across, along - across) * PLACE_ERROR
}

/// Answers what a pass asks of the picture and of the pass before it.
struct PassHost<'a>(&'a [ImageAt<'a>]);

impl Host for PassHost<'_> {
    fn external(&mut self, index: usize, lane: usize, arguments: &[Word], result: &mut [Word]) {
        let at = &self.0[lane];
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
            16 | 17 => {
                let light = surroundings(at.input.panorama, index, arguments, moved_place(at));
                result.copy_from_slice(&light.to_array().map(Word::from_f64));
                return;
            }
            18 => {
                result[0] = Word::from_f64(at.meters_apart(place().x, place().y));
                return;
            }
            _ => {
                return PictureHost(at.input.picture, &[]).external(index, lane, arguments, result);
            }
        };
        result.copy_from_slice(&color.to_array().map(Word::from_f64));
    }
}

/// The passes of an effect, each evaluated in f64, and in f32 to one side of a step as
/// [`super::twin::surface`].
pub fn passes(passes: Vec<ImagePass>, exact: Vec<Function>, rounded: Vec<Function>) -> PassHook {
    let run = move |index: usize, pixels: &[ImageAt<'_>], words: &[u32]| {
        let mut written: Vec<(ImageAt<'_>, DVec4)> =
            pixels.iter().map(|at| (*at, DVec4::NAN)).collect();
        let sides = [&exact[index], &rounded[index]];
        let mut next = 0;
        each_side(
            &mut written,
            sides,
            |(at, _)| at.step_offset,
            |together, function| {
                let mut host = PassHost(&pixels[next..next + together.len()]);
                next += together.len();
                function.run(
                    together,
                    words,
                    &mut host,
                    |inputs| {
                        inputs
                            .whole(|(at, _)| [at.x as u32, at.y as u32])
                            .whole(|(at, _)| [at.size[0], at.size[1], at.scale]);
                    },
                    |outputs| {
                        outputs.floats(|(_, color)| color.as_mut());
                    },
                    |_| {},
                );
            },
        );
        written.into_iter().map(|(_, color)| color).collect()
    };
    PassHook {
        passes,
        run: Arc::new(run),
    }
}
