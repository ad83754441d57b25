//! Fuzzy search: how well a name and its description answer what was typed.
//!
//! Every word of the query must be found: in the name as a subsequence whose letters begin words or
//! stand together, in the description as the beginning of a word. A longer word may also be a
//! mistyped word of the name.

/// Points of a letter that is found.
const LETTER: i32 = 10;
/// More for the first letter of a word.
const WORD_START: i32 = 15;
/// More for a letter right behind the one before it.
const TOGETHER: i32 = 12;
/// Most points that are taken for letters passed over between two that are found, and before the
/// first.
const MAX_GAP: i32 = 5;
const MAX_LEAD: i32 = 3;
/// More for a term that is a whole word, for a name that begins with the query, and for one that is
/// the query.
const WHOLE_WORD: i32 = 20;
const BEGINS: i32 = 100;
const SAME: i32 = 400;
/// Least points per letter: below it the letters lie scattered.
const LEAST: i32 = 13;
/// Points per letter of a term that begins a word of the description, and of one that is mistyped.
const DESCRIBED: i32 = 8;
const MISTYPED: i32 = 6;
/// Letters from which a term may be mistyped, and the least likeness that it needs; 1 is the same
/// word.
const TYPO_LETTERS: usize = 4;
const TYPO_LIKENESS: f64 = 0.7;

/// How well `name` with its description `about` answers `query`, larger for better; none if it does
/// not. Case does not matter, and an empty query is answered by everything with 0.
pub fn score(query: &str, name: &str, about: &str) -> Option<i32> {
    let [query, name, about] = [query, name, about].map(str::to_lowercase);
    let query = query.trim();
    if query.is_empty() {
        return Some(0);
    }
    let letters: Vec<char> = name.chars().collect();
    let mut total = 0;
    for term in query
        .split(|c: char| c.is_whitespace() || matches!(c, '-' | '_'))
        .filter(|term| !term.is_empty())
    {
        total += in_name(term, &name, &letters)
            .into_iter()
            .chain(in_about(term, &about))
            .max()?;
    }
    if name == query {
        total += SAME;
    } else if name.starts_with(query) {
        total += BEGINS;
    }
    // Of two names that contain the same, the shorter one is meant.
    Some(total - letters.len() as i32 / 8)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
}

fn in_name(term: &str, name: &str, letters: &[char]) -> Option<i32> {
    let typed: Vec<char> = term.chars().collect();
    let count = typed.len() as i32;
    let whole = if words(name).any(|word| word == term) {
        WHOLE_WORD
    } else {
        0
    };
    let found =
        subsequence(&typed, letters).filter(|points| count == 1 || *points >= LEAST * count);
    found.map(|points| points + whole).or_else(|| {
        let is_near =
            |word: &str| strsim::normalized_damerau_levenshtein(term, word) >= TYPO_LIKENESS;
        (typed.len() >= TYPO_LETTERS && words(name).any(is_near)).then_some(MISTYPED * count)
    })
}

fn in_about(term: &str, about: &str) -> Option<i32> {
    words(about)
        .any(|word| word.starts_with(term))
        .then(|| DESCRIBED * term.chars().count() as i32)
}

/// The most points of `typed` as a subsequence of `letters`; none if it is none.
fn subsequence(typed: &[char], letters: &[char]) -> Option<i32> {
    if typed.len() > letters.len() {
        return None;
    }
    let points = |at: usize| {
        let starts_word = at == 0 || !letters[at - 1].is_alphanumeric();
        LETTER + if starts_word { WORD_START } else { 0 }
    };
    // The best sum of points with the letter at each index as the newest that was found.
    let mut best: Vec<Option<i32>> = Vec::new();
    for (count, letter) in typed.iter().enumerate() {
        let sum = |at: usize| {
            if letters[at] != *letter {
                return None;
            }
            let before = if count == 0 {
                -(at as i32).min(MAX_LEAD)
            } else {
                let gap = |from: usize| {
                    if from + 1 == at {
                        TOGETHER
                    } else {
                        -((at - from - 1) as i32).min(MAX_GAP)
                    }
                };
                (0..at)
                    .filter_map(|from| Some(best[from]? + gap(from)))
                    .max()?
            };
            Some(before + points(at))
        };
        best = (0..letters.len()).map(sum).collect();
    }
    best.into_iter().flatten().max()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names that answer `query`, best first.
    fn ranked<'a>(query: &str, names: &[&'a str]) -> Vec<&'a str> {
        let mut found: Vec<(i32, &str)> = names
            .iter()
            .filter_map(|name| Some((score(query, name, "")?, *name)))
            .collect();
        found.sort_by_key(|(points, _)| -points);
        found.into_iter().map(|(_, name)| name).collect()
    }

    #[test]
    fn the_name_that_is_typed_comes_before_those_that_contain_it() {
        assert_eq!(
            ranked("facet", &["facet.amount", "Disable facet", "facet"])[0],
            "facet"
        );
        assert_eq!(
            ranked("over", &["Show or hide overlays", "xray", "overdraw"])[0],
            "overdraw"
        );
    }

    #[test]
    fn first_letters_and_parts_of_words_are_enough() {
        assert_eq!(
            ranked("fctamt", &["facet.amount", "fog.density", "front view"]),
            ["facet.amount"]
        );
        assert_eq!(
            ranked("sho", &["Show or hide overlays", "Undo"]),
            ["Show or hide overlays"]
        );
        assert_eq!(
            ranked("soho", &["Show or hide overlays", "Save as…"]),
            ["Show or hide overlays"]
        );
        assert_eq!(
            ranked("amount facet", &["facet.amount", "facet.front"]),
            ["facet.amount"],
            "in any order"
        );
    }

    #[test]
    fn scattered_letters_are_no_match() {
        assert_eq!(
            ranked("rsp", &["Orthographic or perspective projection"]).len(),
            1,
            "together"
        );
        assert!(ranked("hpx", &["Orthographic or perspective export"]).is_empty());
        assert!(ranked("zpz", &["pizza zoo"]).is_empty());
    }

    #[test]
    fn a_mistyped_word_is_found_behind_the_right_ones() {
        assert_eq!(ranked("fascet", &["facet", "fog"]), ["facet"]);
        assert_eq!(
            ranked("radnomize", &["Randomize effects"]),
            ["Randomize effects"]
        );
        assert!(
            ranked("fasc", &["facet"]).is_empty(),
            "half a word may be many words"
        );
    }

    #[test]
    fn words_of_the_description_count_less_than_those_of_the_name() {
        let by_about = score("shadow", "lambert", "diffuse light without shadows")
            .expect("a word of the description");
        assert!(by_about < score("shadow", "shadow", "").expect("the name"));
        assert_eq!(
            score("ight", "lambert", "diffuse light"),
            None,
            "the middle of a word of the description"
        );
        assert!(
            score("lambert light", "lambert", "diffuse light").is_some(),
            "a word of each"
        );
    }

    #[test]
    fn nothing_typed_and_any_text_are_no_trouble() {
        assert_eq!(score("  ", "", ""), Some(0));
        assert_eq!(score("a", "", ""), None);
        assert!(score("É", "é", "").is_some(), "case of other scripts");
        assert!(score(&"a ".repeat(500), &"a".repeat(500), "").is_some());
    }
}
