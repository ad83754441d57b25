//! Stress: the table of extreme cases that need code, shared by the tests and `rasterlab-fuzz
//! cases`; the others are the presets of `presets/extremes`.
//!
//! Each case states its expectation, draws what can disprove it, and compares with the oracle;
//! where an answer is published or easy to count, also with that answer. A case is a row in the
//! table of its file and a function there.

pub mod adversarial;
mod case;
mod checks;
mod clipping;
mod context;
mod coverage;
mod covering;
pub mod culling;
mod drawing;
mod effects;
mod hardware;
pub mod matrix;
mod occlusion;
mod parameters;
mod picture_sizes;
mod published;
mod queues;
pub mod random;
pub mod scenes;
pub mod shrink;
mod skins;
mod strict;
mod table;
mod time;
mod values;
pub mod written;

pub use case::{Case, Expectation, Outcome, Report};
pub use checks::EarlyEnd;
pub use context::CaseContext;
pub use drawing::{
    WorkDistribution, captured, exactness, judged, options, pinned, quick_option, stack, tunings,
};

/// All cases, sorted by number.
pub fn cases() -> Vec<&'static Case> {
    let mut cases = table::by_number();
    cases.extend(strict::CASES);
    cases.sort_by_key(|case| case.number);
    cases
}

/// The cases whose name contains one of the parts of `filter`, which commas separate; all cases
/// without a filter.
pub fn chosen(filter: Option<&str>) -> Vec<&'static Case> {
    let parts: Vec<&str> = filter.unwrap_or_default().split(',').collect();
    let is_meant = |case: &&Case| parts.iter().any(|part| case.name.contains(part.trim()));
    cases().into_iter().filter(is_meant).collect()
}
