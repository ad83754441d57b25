//! Image passes: effects that read the finished picture, in linear light.

use glam::DVec4;
use rayon::prelude::*;

use super::{
    super::shot::Shot,
    resolve::{PictureTables, ResolveInput, bytes},
    shading::TOGETHER,
};
use crate::{
    effects::hooks::{Image, ImageAt, ImagePass, Lens, PassHook, PassInput, Picture, Signs},
    frame::{KeptPass, linear_bytes},
    math::srgb,
    work::{Canceled, map_each},
};

/// How a pass errs: every value that decides a step by `step_offset`, and depths in meters in the
/// direction of `signs`. Channels that are NaN or infinite become `no_number`.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassPerturbation {
    pub step_offset: f64,
    pub signs: Signs,
    pub no_number: f64,
}

/// What the passes of a stack read: the picture before them, and what the kept one wrote in the
/// previous frame, which reads as zeros where that had another size.
#[derive(Clone, Copy, Debug)]
pub struct PassStart<'a> {
    pub resolved: &'a [[u8; 4]],
    pub kept: &'a [[f32; 4]],
}

/// One pass of a stack.
pub struct Step<'a> {
    hook: &'a PassHook,
    words: &'a [u32],
    index: usize,
    pass: &'a ImagePass,
    /// What the kept pass of its effect wrote in the previous frame.
    before: Option<Image>,
}

impl Step<'_> {
    /// Is what it writes the picture that the next effect begins with?
    pub fn ends_effect(&self) -> bool {
        self.index + 1 == self.hook.passes.len()
    }

    /// Does what it writes live to the next frame?
    pub fn is_kept(&self) -> bool {
        self.pass.kept.is_some()
    }

    /// What it writes, given the picture that its effect began with and what the pass before it
    /// wrote. All channels are finite.
    pub fn written(
        &self,
        shot: &Shot,
        picture: &Picture,
        [source, last]: [&Image; 2],
        perturbation: PassPerturbation,
    ) -> Result<Image, Canceled> {
        let input = PassInput {
            picture,
            lens: Lens::of(shot.view),
            source,
            last,
            kept: self.before.as_ref(),
            signs: perturbation.signs,
            panorama: shot.scene.panorama.as_deref(),
        };
        let size = self.pass.size([shot.view.width, shot.view.height]);
        let pixels = size[0] as usize * size[1] as usize;
        let at = |i: usize| ImageAt {
            x: (i % size[0] as usize) as i64,
            y: (i / size[0] as usize) as i64,
            size,
            scale: self.pass.scale,
            step_offset: perturbation.step_offset,
            input: &input,
        };
        let write = |part: usize| {
            let first = part * TOGETHER;
            let part: Vec<ImageAt<'_>> = (first..pixels.min(first + TOGETHER)).map(at).collect();
            let written = (self.hook.run)(self.index, &part, self.words);
            let finite = |color| finite(color, perturbation.no_number);
            written.into_iter().map(finite).collect::<Vec<_>>()
        };
        let parts = map_each((0..pixels.div_ceil(TOGETHER)).into_par_iter(), write)?;
        Ok(Image {
            size,
            colors: parts.concat(),
        })
    }
}

/// A channel that is NaN or infinite in f32 is `no_number`, so that no pass spreads it.
fn finite(color: DVec4, no_number: f64) -> DVec4 {
    color.map(|channel| {
        if (channel as f32).is_finite() {
            channel
        } else {
            no_number
        }
    })
}

/// The passes of a stack, in order.
pub fn steps<'a>(shot: &Shot<'a>, kept: &[[f32; 4]]) -> Vec<Step<'a>> {
    let size = [shot.view.width, shot.view.height];
    let hooks = shot.stack.each(|hooks| hooks.passes.as_ref());
    hooks
        .flat_map(|(hook, words)| {
            hook.passes
                .iter()
                .enumerate()
                .map(move |(index, pass)| Step {
                    hook,
                    words,
                    index,
                    pass,
                    before: hook
                        .kept()
                        .and_then(|(pass, _)| kept_image(pass.size(size), kept)),
                })
        })
        .collect()
}

/// The picture before the passes in linear light.
pub fn begun(shot: &Shot, resolved: &[[u8; 4]]) -> Result<Image, Canceled> {
    let light = linear_bytes();
    let of_bytes = |bytes: &[u8; 4]| {
        let [r, g, b, alpha] = bytes.map(usize::from);
        DVec4::new(light[r], light[g], light[b], alpha as f64 / 255.0)
    };
    Ok(Image {
        size: [shot.view.width, shot.view.height],
        colors: map_each(resolved.par_iter(), of_bytes)?,
    })
}

/// A color of linear light, gamma-encoded.
pub fn gamma_encoded(color: DVec4) -> DVec4 {
    DVec4::new(srgb(color.x), srgb(color.y), srgb(color.z), color.w)
}

/// Bytes of the picture that the passes of a stack make of `start`, and what the kept one wrote. If
/// the picture is not `shown`, it has no bytes, and no pass after the kept one is drawn.
pub fn passed(
    shot: &Shot,
    input: &ResolveInput,
    start: PassStart<'_>,
    shown: bool,
) -> Result<(Vec<[u8; 4]>, Option<KeptPass>), Canceled> {
    let tables = PictureTables::of(shot);
    let picture = tables.picture(shot, input);
    let mut source = begun(shot, start.resolved)?;
    let (mut last, mut kept) = (None::<Image>, None);
    let mut steps = steps(shot, start.kept);
    if !shown {
        steps.truncate(steps.iter().rposition(Step::is_kept).map_or(0, |at| at + 1));
    }
    for step in steps {
        let read = [&source, last.as_ref().unwrap_or(&source)];
        let written = step.written(shot, &picture, read, PassPerturbation::default())?;
        if step.is_kept() {
            let colors = written.colors.iter();
            kept = Some(KeptPass {
                before: start.kept.to_vec(),
                after: colors.map(|c| c.as_vec4().to_array()).collect(),
            });
        }
        if step.ends_effect() {
            (source, last) = (written, None);
        } else {
            last = Some(written);
        }
    }
    if !shown {
        return Ok((Vec::new(), kept));
    }
    let encoded = source.colors.into_iter().map(gamma_encoded);
    Ok((encoded.map(bytes).collect(), kept))
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
