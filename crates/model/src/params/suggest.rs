//! Suggestions for mistyped names.

/// Least likeness of a name that is suggested: 1 is the same name, and each difference counts as a part of the longer one.
const NEAR: f64 = 0.55;

/// `; did you mean "facet"?`, or nothing when no candidate is close.
pub fn did_you_mean<'a>(written: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let lower = written.to_lowercase();
    let length = lower.chars().count();
    // Every character more or less is a difference, so that names of another length are not compared: a long one would take long.
    let may_be_near = |candidate: &&str| {
        let [shorter, longer] = [length.min(candidate.len()), length.max(candidate.len())];
        shorter as f64 >= NEAR * longer as f64
    };
    let near = candidates
        .filter(may_be_near)
        .map(|candidate| (strsim::normalized_damerau_levenshtein(&lower, &candidate.to_lowercase()), candidate));
    match near.filter(|(likeness, _)| *likeness >= NEAR).max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, candidate)) => suggestion(candidate),
        None => String::new(),
    }
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
        assert_eq!(did_you_mean("fascet", ["facet", "depth"].into_iter()), "; did you mean \"facet\"?");
        assert_eq!(did_you_mean("zzz", ["facet", "depth"].into_iter()), "");
    }
}
