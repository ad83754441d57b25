//! What attributes before functions say: `@pass`, `@kept`, `@smooth` and `@reach`.

use super::{
    attributes::Attribute,
    declaration::{Author, Function},
    error::{EffectError, Text},
};
use crate::effects::{
    HookFunctions,
    hooks::{EarlierFrames, ImagePass},
};

/// Most passes of one effect.
const MOST_PASSES: usize = 8;

/// Words of `@pass`, and pixels of the picture for one that such a pass writes, along a side.
const PASS_SIZES: [(&str, u32); 3] = [("full", 1), ("half", 2), ("quarter", 4)];

/// What attributes before a function say of a pass.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct OfPass {
    /// `@pass`: pixels of the picture for one that it writes, along a side.
    pub scale: Option<u32>,
    /// `@kept`: what it writes lives to the next frame, and a picture follows so many.
    pub kept: Option<EarlierFrames>,
}

/// Does `@smooth` stand before every function whose color could have steps?
pub fn is_smooth(
    text: &Text<'_>,
    functions: &[Function<'_>],
    hooks: &HookFunctions,
) -> Result<bool, EffectError> {
    let is_hook = |function: &Function<'_>| {
        [&hooks.surface, &hooks.image]
            .iter()
            .any(|hook| hook.as_deref() == Some(function.name.text))
    };
    let wrong = |function: &&Function<'_>| function.is_smooth && !is_hook(function);
    if let Some(other) = functions.iter().find(wrong) {
        let message = format!(
            "@smooth stands before {}, which is no function of a Surface or a Pixel: only their colors are judged for steps",
            other.name.text
        );
        return Err(text.at(other.name, message));
    }
    let mut hooks = functions.iter().filter(|function| is_hook(function));
    Ok(hooks.all(|function| function.is_smooth))
}

/// The function that says how far a vertex moves at most, meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    pub name: String,
    /// Its first argument is the radius of the model, meters, which the lab's own effects read.
    pub takes_radius: bool,
}

/// The function behind `@reach`.
pub fn reach(
    text: &Text<'_>,
    functions: &[Function<'_>],
    hooks: &HookFunctions,
    parameters: &str,
    author: Author,
) -> Result<Option<Reach>, EffectError> {
    let mut marked = functions.iter().filter(|function| function.is_reach);
    let Some(function) = marked.next() else {
        return Ok(None);
    };
    let name = function.name.text;
    if let Some(other) = marked.next() {
        let message = format!(
            "{name} and {} both stand behind @reach, which one function does; remove one @reach",
            other.name.text
        );
        return Err(text.at(other.name, message));
    }
    if hooks.vertex.is_none() {
        let message = format!(
            "@reach stands before {name}, and no function of this file moves a Vertex; remove @reach"
        );
        return Err(text.at(function.name, message));
    }
    let takes_radius = match &function.parameters[..] {
        [p] if p == parameters => false,
        [radius, p] if radius == "f32" && p == parameters && author == Author::Lab => true,
        _ => {
            let message = format!(
                "@reach stands before a function of the parameters alone that returns meters; write fn {name}(p: {parameters}) -> f32"
            );
            return Err(text.at(function.name, message));
        }
    };
    if function.result != "f32" {
        let message = format!("{name} says how far a vertex moves, in meters; write -> f32");
        return Err(text.at(function.name, message));
    }
    Ok(Some(Reach {
        name: name.to_owned(),
        takes_radius,
    }))
}

/// Pixels of the picture for one of a pass, along a side, as `@pass` says.
pub fn pass_scale(text: &Text<'_>, attribute: &Attribute<'_>) -> Result<u32, EffectError> {
    let known = PASS_SIZES
        .iter()
        .find(|(word, _)| attribute.arguments == [*word]);
    known.map(|(_, scale)| *scale).ok_or_else(|| {
        attribute.error(
            text,
            "@pass takes one word: full, half or quarter, the size of what the pass writes",
        )
    })
}

/// The earlier frames that `@kept(frames, seconds)` says.
pub fn kept_frames(
    text: &Text<'_>,
    attribute: &Attribute<'_>,
) -> Result<EarlierFrames, EffectError> {
    let usage = format!(
        "two numbers: 1 to {} earlier frames that a picture follows, and the seconds from one to the next, above 0 and at most {}",
        EarlierFrames::MOST,
        EarlierFrames::LONGEST_STEP_S
    );
    let numbers = attribute.numbers(text, (2, 2), &usage)?;
    let [frames, step_s] = [numbers[0], numbers[1]];
    let is_allowed = frames.fract() == 0.0
        && (1.0..=f64::from(EarlierFrames::MOST)).contains(&frames)
        && step_s > 0.0
        && step_s <= EarlierFrames::LONGEST_STEP_S;
    if !is_allowed {
        return Err(attribute.error(text, format!("@kept takes {usage}")));
    }
    let frames = frames as u32;
    Ok(EarlierFrames { frames, step_s })
}

/// The passes of an effect, of which the last one writes the picture.
pub fn image_passes<'a>(
    text: &Text<'a>,
    functions: &[Function<'a>],
    passes: &[&Function<'a>],
) -> Result<Vec<ImagePass>, EffectError> {
    let error = |function: &Function<'_>, message: String| text.at(function.name, message);
    let is_pass = |function: &&Function<'_>| {
        passes
            .iter()
            .any(|pass| pass.name.offset == function.name.offset)
    };
    if let Some(other) = functions
        .iter()
        .find(|function| function.of_pass != OfPass::default() && !is_pass(function))
    {
        let attribute = if other.of_pass.scale.is_some() {
            "pass"
        } else {
            "kept"
        };
        let message = format!(
            "@{attribute} stands before {}, which is no pass: fn {0}(at: ImageAt, p: Parameters) -> vec4f",
            other.name.text
        );
        return Err(error(other, message));
    }
    let mut kept = passes.iter().filter(|pass| pass.of_pass.kept.is_some());
    if let (Some(first), Some(second)) = (kept.next(), kept.next()) {
        let message = format!(
            "{} and {} are both kept; an effect keeps one pass, so remove one @kept",
            first.name.text, second.name.text
        );
        return Err(error(second, message));
    }
    if let Some(last) = passes.last().filter(|last| last.of_pass.kept.is_some()) {
        let message = format!(
            "{} is the last pass and writes the picture, which is not kept; write another pass after it, for instance one that returns image_last(at.x, at.y)",
            last.name.text
        );
        return Err(error(last, message));
    }
    if let Some(last) = passes
        .last()
        .filter(|last| last.of_pass.scale.unwrap_or(1) != 1)
    {
        let message = format!(
            "{} is the last pass and writes the picture, which has its full size; remove @pass, or write another pass after it",
            last.name.text
        );
        return Err(error(last, message));
    }
    if let Some(extra) = passes.get(MOST_PASSES) {
        let message = format!(
            "{} is pass number {}; an effect has at most {MOST_PASSES}",
            extra.name.text,
            MOST_PASSES + 1
        );
        return Err(error(extra, message));
    }
    let pass = |function: &&Function<'_>| ImagePass {
        name: function.name.text.to_owned(),
        scale: function.of_pass.scale.unwrap_or(1),
        kept: function.of_pass.kept,
    };
    Ok(passes.iter().map(pass).collect())
}
