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
mod depth;
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
pub use context::{CaseContext, Counts};
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

/// The cases whose number is one of the parts of `filter`, which commas separate, or whose name
/// contains one; all cases without a filter.
pub fn chosen(filter: Option<&str>) -> Vec<&'static Case> {
    let filter = filter.unwrap_or_default().to_lowercase();
    let is_meant = |case: &&Case| {
        let mut parts = filter
            .split(',')
            .map(str::trim)
            .filter(|part| !part.is_empty() || filter.trim().is_empty());
        parts.any(|part| match part.parse::<u32>() {
            Ok(number) => case.number == number,
            Err(_) => case.name.contains(part),
        })
    };
    cases().into_iter().filter(is_meant).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique_and_plain() {
        let cases = cases();
        let names: BTreeSet<_> = cases.iter().map(|case| case.name).collect();
        assert_eq!(names.len(), cases.len());
        let is_plain = |name: &str| {
            name.chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
        };
        assert!(names.iter().all(|name| is_plain(name)), "{names:?}");
    }

    #[test]
    fn a_filter_is_a_number_or_a_part_of_a_name() {
        assert!(chosen(Some("9")).iter().all(|case| case.number == 9));
        assert!(!chosen(Some("9")).is_empty() && chosen(Some("99")).is_empty());
        assert!(
            chosen(Some(" Near "))
                .iter()
                .any(|case| case.name.contains("near"))
        );
        let both = chosen(Some("near-, 9,"));
        assert_eq!(
            both.len(),
            chosen(Some("near-")).len() + chosen(Some("9")).len()
        );
        assert!(
            both.iter()
                .all(|case| case.number == 9 || case.name.contains("near-"))
        );
        assert_eq!(chosen(None).len(), cases().len());
    }
}
