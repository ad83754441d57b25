//! Effect files. What is read is kept as long as the process runs, so processes of many inputs
//! grow.

use rasterlab::{
    effect_files::{self, EffectError, evaluated},
    shader::library::Library,
};

use super::{Outcome, Target};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "effect",
    about: "effect files",
    views: &[],
    limit: Limit::new(5, 512),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Err("it is no UTF-8".into());
    };
    let effect = effect_files::read("ink.wgsl", "ink", text).map_err(
        |EffectError { message, place, .. }| {
            let shown = place.map(|place| place.text).unwrap_or_default();
            assert!(
                shown.chars().count() <= 200 && !shown.chars().any(char::is_control),
                "the line is shown as {shown:?}"
            );
            message
        },
    )?;
    // A file that needs what the evaluator lacks is refused when it is read.
    evaluated(&Library::of_process(), &effect)
        .unwrap_or_else(|error| panic!("it was read and cannot be evaluated: {error}"));
    Ok(())
}
