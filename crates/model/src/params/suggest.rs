//! Suggestions for mistyped names.

/// Least likeness of a name that is suggested: 1 is the same name, and each difference counts as a
/// part of the longer one.
const NEAR: f64 = 0.55;

/// `; did you mean "facet"?`, or nothing when no candidate is close.
pub fn did_you_mean<'a>(written: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let near = candidates.filter_map(|candidate| Some((likeness(written, candidate)?, candidate)));
    near.max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(String::new, |(_, candidate)| suggestion(candidate))
}

/// How much alike two names are, up to 1 for names that differ in the case of letters alone; None
/// if they are not close.
pub fn likeness(written: &str, candidate: &str) -> Option<f64> {
    // Every character more or less is a difference, so that names of another length are not
    // compared: a long one would take long.
    let [written, candidate] = [written, candidate].map(str::to_lowercase);
    let lengths = [&written, &candidate].map(|name| name.chars().count() as f64);
    if lengths[0].min(lengths[1]) < NEAR * lengths[0].max(lengths[1]) {
        return None;
    }
    Some(strsim::normalized_damerau_levenshtein(&written, &candidate))
        .filter(|likeness| *likeness >= NEAR)
}

/// `; did you mean "facet"?`.
pub fn suggestion(candidate: &str) -> String {
    format!("; did you mean {candidate:?}?")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_miss_is_named() {
        assert_eq!(
            did_you_mean("fascet", ["facet", "depth"].into_iter()),
            "; did you mean \"facet\"?"
        );
        assert_eq!(did_you_mean("zzz", ["facet", "depth"].into_iter()), "");
    }
}
