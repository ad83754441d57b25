//! Suggestions for mistyped names.

/// `; did you mean "facet"?`, or nothing when no candidate is close.
pub fn did_you_mean<'a>(written: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let lower = written.to_lowercase();
    let near = candidates.map(|candidate| (strsim::normalized_damerau_levenshtein(&lower, &candidate.to_lowercase()), candidate));
    match near.filter(|(likeness, _)| *likeness >= 0.55).max_by(|a, b| a.0.total_cmp(&b.0)) {
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
