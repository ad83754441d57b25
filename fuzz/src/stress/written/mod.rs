//! Effects as people write them: each is refused with a sentence that has file and line, or it is
//! drawn by the adapter as by the oracle, which evaluates the same text.

mod constants;
mod expressions;
mod helpers;
mod writer;

use rasterlab::effect_files::read;

use super::{
    case::{Case, Expectation},
    checks::EarlyEnd,
    context::CaseContext,
    drawing::pinned,
};
use crate::{effects::Stack, measure::Budget};

pub use writer::{Place, Written, effect};

/// The name of every effect of the corpus.
pub const NAME: &str = "written";
/// Effects of the whole corpus.
pub const COUNT: u32 = 320;
/// Effects of the sample that the tests draw.
const SAMPLE: u32 = 12;
/// Most effects of a hundred that may be refused.
const MOST_REFUSED: u32 = 10;

pub const CASES: &[Case] = &[
    Case {
        number: 37,
        name: "written-sample",
        about: "a few effects of a random corpus, as in written-corpus",
        expectation: Expectation::Bounded("colors one step of 255 apart, or in the band of a step"),
        run: |context| draw_corpus(context, SAMPLE),
    },
    Case {
        number: 37,
        name: "written-corpus",
        about: "320 random effects of the kind people write: refused with file and line, or drawn as the oracle draws them",
        expectation: Expectation::Bounded("colors one step of 255 apart, or in the band of a step"),
        run: |context| draw_corpus(context, COUNT),
    },
];

/// What is allowed of a picture: values that decide a step of color may lie on either side, and an
/// effect may have many such steps.
fn budget(has_sine_hash: bool) -> Budget {
    Budget {
        max_color_delta: if has_sine_hash { u8::MAX } else { 1 },
        max_step_band_fraction: 1.0,
        max_rounding_fraction: if has_sine_hash { 1.0 } else { 0.05 },
        ..Budget::default()
    }
}

fn draw_corpus(context: &mut CaseContext, count: u32) -> Result<(), EarlyEnd> {
    let scene = context.scene("sphere?triangles=200")?;
    let view = context.view(&scene, [40, 30]);
    let seed = context.rng(0x3d7e_5eed).next_u32();
    let (mut refused, mut failures) = (Vec::new(), Vec::new());
    for index in 0..count {
        let Written {
            text,
            place,
            has_sine_hash,
        } = effect(seed, index);
        let file = format!("{NAME}.wgsl");
        let effect = match read(&file, NAME, &text) {
            Ok(effect) => effect,
            Err(error) if error.place.is_some() => {
                refused.push(format!("effect {index}: {error}"));
                continue;
            }
            Err(error) => {
                failures.push(format!("effect {index} is refused without a line: {error}"));
                continue;
            }
        };
        let mut stack = Stack::default();
        stack.enable(&effect);
        let what = format!("effect {index} of seed {seed:#x}, {place:?}");
        match context.judged(
            &scene,
            &view,
            &stack,
            &pinned(context.quick_option()),
            &what,
        ) {
            Ok((_, verdict)) => {
                if let Err(fault) = verdict.report.within(&budget(has_sine_hash)) {
                    failures.push(format!("{what}: {fault}"));
                }
            }
            Err(EarlyEnd::Failed(why)) => failures.push(why),
            Err(end) => return Err(end),
        }
    }
    context.note(format!("{} of {count} effects are refused", refused.len()));
    if failures.is_empty() && refused.len() as u32 * 100 > count * MOST_REFUSED {
        failures.push(format!(
            "too many effects are refused, the first: {}",
            refused[0]
        ));
    }
    match failures.first() {
        None => Ok(()),
        Some(_) => Err(EarlyEnd::Failed(format!(
            "{} of {count} effects fail: {}",
            failures.len(),
            failures.join("; ")
        ))),
    }
}
