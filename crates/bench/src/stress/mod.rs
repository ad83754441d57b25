//! Stress: the table of extreme cases, shared by the tests, `rasterlab stress` and the window.
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
mod normals;
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
    fn names_are_unique_and_every_row_of_the_table_has_a_case() {
        let cases = cases();
        let names: BTreeSet<_> = cases.iter().map(|case| case.name).collect();
        assert_eq!(names.len(), cases.len());
        let is_plain = |name: &str| {
            name.chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
        };
        assert!(names.iter().all(|name| is_plain(name)), "{names:?}");
        let rows: BTreeSet<_> = cases.iter().map(|case| case.number).collect();
        assert_eq!(rows, (1..=37).collect());
    }

    #[test]
    fn a_filter_is_a_number_or_a_part_of_a_name() {
        assert!(chosen(Some("3")).iter().all(|case| case.number == 3));
        assert!(!chosen(Some("3")).is_empty() && chosen(Some("99")).is_empty());
        assert!(
            chosen(Some(" Fan "))
                .iter()
                .any(|case| case.name.contains("fan"))
        );
        let both = chosen(Some("fan-, 3,"));
        assert_eq!(
            both.len(),
            chosen(Some("fan-")).len() + chosen(Some("3")).len()
        );
        assert!(
            both.iter()
                .all(|case| case.number == 3 || case.name.contains("fan-"))
        );
        assert_eq!(chosen(None).len(), cases().len());
    }
}
