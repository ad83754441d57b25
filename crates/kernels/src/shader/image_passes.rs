//! Image passes: which pass of which effect comes when, and which of three pictures it reads and
//! writes.

use super::{key::KernelKey, pass::Pass};
use crate::effects::{Effect, hooks::ImagePass};

/// Most passes of all effects of a stack together.
pub use crate::effects::MAX_IMAGE_PASSES;

/// Pictures in linear light that passes read and write by turns.
pub const IMAGE_SLOTS: usize = 3;

/// The picture that a kept pass writes, which lives to the next frame, behind those.
pub const KEPT_SLOT: usize = IMAGE_SLOTS;

/// One pass of one effect in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageStep {
    /// Index of the effect in the list of the key.
    pub effect: usize,
    /// Index of the pass in that effect.
    pub pass: usize,
    /// Pixels of the picture for one that the pass writes, along a side.
    pub scale: u32,
    /// The same of what the pass before it wrote.
    pub last_scale: u32,
    /// The picture that the effect began with, of [`IMAGE_SLOTS`].
    pub source: usize,
    /// What the pass before it wrote, perhaps [`KEPT_SLOT`]; the source in the first pass of an
    /// effect.
    pub last: usize,
    /// What it writes, [`KEPT_SLOT`] if it is kept; none: the finished picture.
    pub target: Option<usize>,
}

impl KernelKey {
    /// Does an effect have passes over the finished picture?
    pub fn has_passes(&self) -> bool {
        self.effects
            .list
            .iter()
            .any(|effect| effect.hooks.passes.is_some())
    }

    /// The image passes of the stack, in order.
    pub fn image_steps(&self) -> Vec<ImageStep> {
        let mut steps: Vec<ImageStep> = Vec::new();
        let mut source = 0;
        for (index, effect) in self.effects.list.iter().enumerate() {
            let Some(hook) = &effect.hooks.passes else {
                continue;
            };
            let (mut last, mut last_scale) = (source, 1);
            for (pass, spec) in hook.passes.iter().enumerate() {
                let free = match spec.kept {
                    Some(_) => Some(KEPT_SLOT),
                    None => (0..IMAGE_SLOTS).find(|slot| *slot != source && *slot != last),
                };
                steps.push(ImageStep {
                    effect: index,
                    pass,
                    scale: spec.scale,
                    last_scale,
                    source,
                    last,
                    target: free,
                });
                (last, last_scale) = (free.unwrap_or(last), spec.scale);
            }
            source = last;
        }
        if let Some(step) = steps.last_mut() {
            step.target = None;
        }
        steps
    }

    /// The step that a pass of the frame is.
    pub fn image_step(&self, pass: Pass) -> Option<ImageStep> {
        match pass {
            Pass::Image(number) => self.image_steps().get(usize::from(number)).copied(),
            _ => None,
        }
    }

    /// The pass whose result lives to the next frame.
    pub fn kept_pass(&self) -> Option<&ImagePass> {
        let mut hooks = self.effects.list.iter().map(|effect| &effect.hooks);
        hooks.find_map(|hooks| Some(hooks.passes.as_ref()?.kept()?.0))
    }

    /// Pictures in linear light that the passes take by turns, at most [`IMAGE_SLOTS`].
    pub fn image_slots(&self) -> usize {
        let steps = self.image_steps();
        let slots = steps
            .iter()
            .flat_map(|step| [Some(step.last), step.target])
            .flatten()
            .filter(|slot| *slot < IMAGE_SLOTS);
        slots.max().map_or(0, |last| last + 1)
    }

    /// The passes of a frame that run over the finished picture.
    pub(super) fn image_passes(&self) -> Vec<Pass> {
        let steps = 0..self.image_steps().len().min(MAX_IMAGE_PASSES);
        let first = self.has_passes().then_some(Pass::ImageBegin);
        first
            .into_iter()
            .chain(steps.map(|number| Pass::Image(number as u8)))
            .collect()
    }

    /// Label of a pass for profilers and tables: that of [`Pass::label`], and which effect's pass
    /// it is.
    pub fn label_of(&self, pass: Pass) -> String {
        match self.image_step(pass) {
            Some(step) => {
                let effect = &self.effects.list[step.effect];
                let name = effect.hooks.passes.as_ref().map_or("", |hook| {
                    hook.passes.get(step.pass).map_or("", |pass| &pass.name)
                });
                let words = ["image", &effect.name, name];
                words.join(" ").trim_end().to_owned()
            }
            None => pass.label(),
        }
    }
}

/// The WGSL function of a pass of an effect: of a built-in one `<stem>_<name>`, or `<stem>` where
/// the pass has no name.
pub fn pass_function(effect: &Effect, pass: usize) -> String {
    if let Some(source) = &effect.source {
        return source
            .functions
            .passes
            .get(pass)
            .cloned()
            .unwrap_or_default();
    }
    let name = effect
        .hooks
        .passes
        .as_ref()
        .and_then(|hook| hook.passes.get(pass))
        .map_or("", |pass| pass.name.as_str());
    match name {
        "" => effect.file_stem().into(),
        name => format!("{}_{name}", effect.file_stem()),
    }
}

/// The generated function `glue_image_pass` that calls one pass of an effect.
pub fn glue_text(effect: &Effect, pass: usize) -> String {
    format!(
        "fn glue_image_pass(at: ImageAt) -> vec4f {{\n    return {}(at, effects.{});\n}}\n",
        pass_function(effect, pass),
        effect.name
    )
}

/// The numbers of passes as words, for the choice of a pass's text.
pub(super) const NUMBERS: [&str; MAX_IMAGE_PASSES] = [
    "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16",
    "17", "18", "19", "20", "21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{accuracy::Visibility, effects::Effect, shader::key::Fetch};

    #[test]
    fn no_pass_writes_what_it_reads_and_the_picture_of_an_effect_stays_until_its_end() {
        let list = ["blur", "vignette", "bloom"]
            .map(|name| Effect::find(name).expect("it is built in").clone());
        let key = KernelKey::complete(Fetch::Indexed, Visibility::Split32, list.to_vec());
        let steps = key.image_steps();
        let mut written = 0;
        for pair in steps.windows(2) {
            let [step, next] = [pair[0], pair[1]];
            let target = step.target.expect("only the last one writes the picture");
            assert!(target != step.source && target != step.last, "{step:?}");
            assert!(step.last_scale == 1 || step.pass > 0, "{step:?}");
            assert_eq!(next.last, target, "{next:?}");
            let source = if next.effect == step.effect {
                step.source
            } else {
                target
            };
            assert_eq!(next.source, source, "{next:?}");
            written += 1;
        }
        assert_eq!(written + 1, steps.len());
        assert_eq!(steps.last().map(|step| step.target), Some(None));
    }
}
