//! Image passes: effects that read the finished picture, in linear light.

use glam::DVec4;
use rayon::prelude::*;

use super::{
    super::shot::Shot,
    resolve::{PictureTables, ResolveInput, bytes},
    shading::TOGETHER,
};
use crate::{
    effects::hooks::{Image, ImageAt, Lens, PassInput, Picture, Signs},
    frame::{KeptPass, linear_bytes},
    math::srgb,
    work::{Canceled, map_each},
};

/// How much a color that a pass reads may be off in f32, as a fraction of its largest channel:
/// what `pow` may err by, and some 2^6 operations.
const COLOR_ERROR: f64 = 1.0 / (1 << 17) as f64;

/// How a chain of passes errs: every value that decides a step by `step_offset`, and every color
/// that is written by [`COLOR_ERROR`], in the direction of `signs`.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassPerturbation {
    pub step_offset: f64,
    pub signs: Signs,
}

/// What the passes of a stack read: the picture before them, and what the kept one wrote in the
/// previous frame, which reads as zeros where that had another size.
#[derive(Clone, Copy, Debug)]
pub struct PassStart<'a> {
    pub resolved: &'a [[u8; 4]],
    pub kept: &'a [[f32; 4]],
}

/// What they make of it.
pub struct Passed {
    /// The picture, gamma-encoded, not yet rounded to bytes; without passes that before them.
    pub colors: Vec<DVec4>,
    /// What the kept pass wrote, if there is one.
    pub kept: Option<Vec<DVec4>>,
}

/// Bytes of the picture that the passes of a stack make of `start`, and what the kept one wrote.
pub fn passed(
    shot: &Shot,
    input: &ResolveInput,
    start: PassStart<'_>,
) -> Result<(Vec<[u8; 4]>, Option<KeptPass>), Canceled> {
    let passed = passed_colors(shot, input, start, PassPerturbation::default())?;
    let kept = passed.kept.map(|after| KeptPass {
        before: start.kept.to_vec(),
        after: after.iter().map(|c| c.as_vec4().to_array()).collect(),
    });
    Ok((passed.colors.into_iter().map(bytes).collect(), kept))
}

/// The same before anything is rounded.
pub fn passed_colors(
    shot: &Shot,
    input: &ResolveInput,
    start: PassStart<'_>,
    perturbation: PassPerturbation,
) -> Result<Passed, Canceled> {
    let tables = PictureTables::of(shot);
    let picture = tables.picture(shot, input);
    let light = linear_bytes();
    let size = [shot.view.width, shot.view.height];
    let of_bytes = |(i, bytes): (usize, &[u8; 4])| {
        let [r, g, b, alpha] = bytes.map(usize::from);
        let color = DVec4::new(light[r], light[g], light[b], alpha as f64 / 255.0);
        perturbed(color, i, size, perturbation)
    };
    let mut source = Image {
        size,
        colors: map_each(start.resolved.par_iter().enumerate(), of_bytes)?,
    };
    let mut written = None;
    for (hook, words) in shot.stack.each(|hooks| hooks.passes.as_ref()) {
        let before = hook
            .kept()
            .and_then(|(pass, _)| kept_image(pass.size(size), start.kept));
        let mut last: Option<Image> = None;
        for (index, pass) in hook.passes.iter().enumerate() {
            let input = PassInput {
                picture: &picture,
                lens: Lens::of(shot.view),
                source: &source,
                last: last.as_ref().unwrap_or(&source),
                kept: before.as_ref(),
                signs: perturbation.signs,
                panorama: shot.scene.panorama.as_deref(),
            };
            let size = pass.size(size);
            let pixels = size[0] as usize * size[1] as usize;
            let at = |i: usize| ImageAt {
                x: (i % size[0] as usize) as i64,
                y: (i / size[0] as usize) as i64,
                size,
                scale: pass.scale,
                step_offset: perturbation.step_offset,
                input: &input,
            };
            let write = |part: usize| {
                let first = part * TOGETHER;
                let part: Vec<ImageAt<'_>> =
                    (first..pixels.min(first + TOGETHER)).map(at).collect();
                let written = (hook.run)(index, &part, words);
                let each = (first..).zip(written);
                each.map(|(i, color)| perturbed(color, i, size, perturbation))
                    .collect::<Vec<_>>()
            };
            let parts = map_each((0..pixels.div_ceil(TOGETHER)).into_par_iter(), write)?;
            let colors = parts.concat();
            if pass.kept.is_some() {
                written = Some(colors.clone());
            }
            last = Some(Image { size, colors });
        }
        source = last.unwrap_or(source);
    }
    let encoded = |color: DVec4| DVec4::new(srgb(color.x), srgb(color.y), srgb(color.z), color.w);
    Ok(Passed {
        colors: source.colors.into_iter().map(encoded).collect(),
        kept: written,
    })
}

/// What a kept pass of this size wrote in the previous frame; none, which reads as zeros, if that
/// frame had another size.
fn kept_image(size: [u32; 2], pixels: &[[f32; 4]]) -> Option<Image> {
    let is_same = pixels.len() == size[0] as usize * size[1] as usize;
    let color = |pixel: &[f32; 4]| DVec4::from_array(pixel.map(f64::from));
    is_same.then(|| Image {
        size,
        colors: pixels.iter().map(color).collect(),
    })
}

/// A color of the pixel with this index, moved as a perturbation says.
fn perturbed(
    color: DVec4,
    index: usize,
    [width, _]: [u32; 2],
    PassPerturbation { signs, .. }: PassPerturbation,
) -> DVec4 {
    let (x, y) = (index % width as usize, index / width as usize);
    let by = signs.at(x as i64, y as i64) * COLOR_ERROR * color.truncate().abs().max_element();
    (color.truncate() + by).extend(color.w)
}

impl PictureTables {
    /// What image effects read of the images of `input`.
    pub fn picture<'a>(&'a self, shot: &Shot, input: &ResolveInput<'a>) -> Picture<'a> {
        Picture {
            width: shot.view.width,
            height: shot.view.height,
            triangle_ids: input.triangle_ids,
            keys: input.depth_keys,
            draws: &self.draws,
            previous: input.previous,
            background: &self.background,
        }
    }
}
