//! Which entries of the palette answer what is typed, best first; and values that are typed behind
//! a path, as `facet.amount 0.5`.

use super::entry::{Choice, Entry, Kind};
use crate::app::widgets::fuzzy;

/// Most entries that are listed.
pub const MAX_LISTED: usize = 60;
/// Most values that are offered for a path that is typed inexactly.
const MAX_VALUES: usize = 3;

/// A path and the text of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Assignment {
    path: String,
    value: String,
    /// The path was typed as it is.
    is_exact: bool,
}

/// What `query` may set: `facet.amount 0.5`, `facet.amount = 0.5`, or `amount 0.5` with every
/// parameter that answers the first word.
fn assignments(query: &str, entries: &[Entry]) -> Vec<Assignment> {
    let paths = || {
        entries
            .iter()
            .filter(|entry| matches!(entry.kind, Kind::Parameter | Kind::Setting))
    };
    let query = query.trim();
    let split = |at: usize| {
        let (path, value) = query.split_at(at);
        (
            path.trim_end_matches([' ', '\t', '=']).trim(),
            value.trim_start_matches([' ', '\t', '=']).trim(),
        )
    };
    let splits: Vec<(&str, &str)> = query
        .match_indices([' ', '='])
        .map(|(at, _)| split(at))
        .filter(|(_, value)| !value.is_empty())
        .collect();
    for (path, value) in &splits {
        let short = path.strip_prefix("effects.").unwrap_or(path);
        let axis = entries.iter().any(|entry| {
            entry.kind == Kind::Accuracy && entry.text.split(" = ").next() == Some(short)
        });
        if axis || paths().any(|known| known.text == short) {
            return vec![Assignment {
                path: short.into(),
                value: (*value).into(),
                is_exact: true,
            }];
        }
    }
    let Some((typed, value)) = splits.last() else {
        return Vec::new();
    };
    // What is typed inexactly switches no effect on.
    let mut near: Vec<(i32, &str)> = paths()
        .filter(|entry| !matches!(entry.choice, Choice::Offer(_)))
        .filter_map(|entry| Some((fuzzy::score(typed, &entry.text, "")?, entry.text.as_str())))
        .collect();
    near.sort_by_key(|(points, _)| -points);
    near.into_iter()
        .map(|(_, path)| Assignment {
            path: path.into(),
            value: (*value).into(),
            is_exact: false,
        })
        .collect()
}

/// The entries that answer `query`, best first: those whose whole text it is, values that it sets,
/// then the others. `probe` tells whether a path takes the text of a value, and if not, says why in
/// a sentence.
pub fn rank(
    entries: &[Entry],
    query: &str,
    probe: impl Fn(&str, &str) -> Result<(), String>,
) -> Vec<Entry> {
    let mut values = Vec::new();
    for Assignment {
        path,
        value,
        is_exact,
    } in assignments(query, entries)
    {
        let known = entries.iter().find(|entry| entry.text == path);
        let kind = known.map_or(Kind::Accuracy, |known| known.kind);
        let text = format!("Set {path} to {value}");
        let entry =
            |choice, detail: String| Entry::new(kind, text.clone(), choice).with(detail, "");
        match probe(&path, &value) {
            Ok(()) => {
                let now = known.map_or_else(String::new, |known| match &known.choice {
                    Choice::Offer(effect) => format!("enables {}", effect.name),
                    _ => format!("now {}", known.detail),
                });
                values.push(entry(Choice::Set(path.clone(), value.clone()), now));
            }
            Err(sentence) if is_exact => {
                values.push(entry(Choice::Refuse(sentence.clone()), sentence))
            }
            Err(_) => {}
        }
        if values.len() == MAX_VALUES {
            break;
        }
    }
    let mut found: Vec<(i32, &Entry)> = entries
        .iter()
        .filter_map(|entry| {
            Some((
                fuzzy::score(query, &entry.text, &entry.about)? + preference(entry),
                entry,
            ))
        })
        .collect();
    found.sort_by_key(|(points, _)| -points);
    // What is called exactly so comes before values and parameters, as does an action that begins
    // so: "Scene sphere" could also set `scene.builtin`, and "About rast" the text `about`.
    let typed = query.trim().to_lowercase();
    let begins_so = |entry: &Entry| {
        entry.kind == Kind::Action
            && typed.contains(' ')
            && entry.text.to_lowercase().starts_with(&typed)
    };
    let (mut whole, rest): (Vec<_>, Vec<_>) = found
        .into_iter()
        .partition(|(_, entry)| !typed.is_empty() && (entry.is_called(query) || begins_so(entry)));
    whole.sort_by_key(|(_, entry)| {
        let is_text = entry.text.eq_ignore_ascii_case(query.trim());
        (!is_text, by_name(entry))
    });
    let [whole, rest] =
        [whole, rest].map(|found| found.into_iter().map(|(_, entry)| entry.clone()));
    // While nothing is typed, who lists them brings what was used last to the front.
    let most = match query.trim() {
        "" => usize::MAX,
        _ => MAX_LISTED,
    };
    whole.chain(values).chain(rest).take(most).collect()
}

/// The order of entries of the same name.
const fn by_name(entry: &Entry) -> u32 {
    match (entry.kind, &entry.choice) {
        (_, Choice::Disable(_)) => 4,
        (Kind::Effect, _) => 0,
        (Kind::Preset, _) => 1,
        (Kind::Action, _) => 2,
        _ => 3,
    }
}

/// Of two entries that answer equally well, that of the rarer kind comes first.
const fn preference(entry: &Entry) -> i32 {
    match (entry.kind, &entry.choice) {
        (_, Choice::Refuse(_)) => -20,
        (Kind::Action | Kind::Effect, _) => 12,
        (Kind::Preset, _) => 8,
        (Kind::Parameter, Choice::Reveal(_)) => 6,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effect;

    fn entry(kind: Kind, text: &str, choice: Choice) -> Entry {
        Entry::new(kind, text, choice).with("0.25", "")
    }

    fn entries() -> Vec<Entry> {
        let reveal = |path: &str| entry(Kind::Parameter, path, Choice::Reveal(path.into()));
        let facet = Effect::find("facet").expect("a built-in effect");
        vec![
            reveal("facet.amount"),
            reveal("fog.amount"),
            reveal("facet.pattern"),
            entry(
                Kind::Setting,
                "clock.speed",
                Choice::Reveal("clock.speed".into()),
            ),
            entry(
                Kind::Accuracy,
                "accuracy.depth = log16",
                Choice::Set("accuracy.depth".into(), "log16".into()),
            ),
            entry(
                Kind::Effect,
                "Disable facet",
                Choice::Disable(facet.clone()),
            ),
            entry(
                Kind::Preset,
                "Open Cut knot (facet-knot)",
                Choice::Open("facet-knot".into()),
            ),
        ]
    }

    /// Takes numbers up to 1, and one word.
    fn probe(path: &str, value: &str) -> Result<(), String> {
        match value.parse::<f64>() {
            Ok(number) if number <= 1.0 && path != "facet.pattern" => Ok(()),
            Ok(number) => Err(format!("{path} takes 0 to 1, not {number}")),
            Err(_) if value == "sweep" && path == "facet.pattern" => Ok(()),
            Err(_) if path == "accuracy.depth" => Ok(()),
            Err(_) => Err(format!("{path} must be a number")),
        }
    }

    fn texts(query: &str) -> Vec<String> {
        rank(&entries(), query, probe)
            .into_iter()
            .map(|entry| entry.text)
            .collect()
    }

    #[test]
    fn a_value_behind_a_path_is_set() {
        for query in [
            "facet.amount 0.5",
            "facet.amount=0.5",
            "facet.amount = 0.5",
            "effects.facet.amount 0.5",
            " facet.amount  0.5 ",
        ] {
            let first = rank(&entries(), query, probe).swap_remove(0);
            assert_eq!(
                first.choice,
                Choice::Set("facet.amount".into(), "0.5".into()),
                "{query}"
            );
            assert_eq!(
                (first.kind, first.detail.as_str()),
                (Kind::Parameter, "now 0.25")
            );
        }
        assert_eq!(
            texts("facet.pattern sweep")[0],
            "Set facet.pattern to sweep"
        );
        assert_eq!(
            texts("accuracy.depth log24")[0],
            "Set accuracy.depth to log24",
            "also an option that is not typed to its end in the list"
        );
    }

    #[test]
    fn a_value_that_is_refused_says_why() {
        let first = rank(&entries(), "facet.amount 7", probe).swap_remove(0);
        assert_eq!(
            first.choice,
            Choice::Refuse("facet.amount takes 0 to 1, not 7".into())
        );
        assert_eq!(first.detail, "facet.amount takes 0 to 1, not 7");
    }

    #[test]
    fn part_of_a_path_offers_every_parameter_that_takes_the_value() {
        assert_eq!(
            texts("amount 0.5"),
            ["Set facet.amount to 0.5", "Set fog.amount to 0.5"]
        );
        assert!(texts("fctpat sweep").contains(&"Set facet.pattern to sweep".into()));
        assert!(
            texts("amount seven").is_empty(),
            "{:?}",
            texts("amount seven")
        );
    }

    #[test]
    fn entries_are_ordered_by_how_well_they_answer() {
        assert_eq!(
            texts("facet")[..2],
            ["Disable facet", "facet.amount"],
            "the name of an effect comes before its parameters"
        );
        assert_eq!(texts("facet-knot")[0], "Open Cut knot (facet-knot)");
        assert_eq!(texts("cut knot"), ["Open Cut knot (facet-knot)"]);
        assert_eq!(texts("log16"), ["accuracy.depth = log16"]);
        assert_eq!(
            texts("").len(),
            entries().len(),
            "nothing typed lists everything"
        );
        assert!(texts("qqq").is_empty());
    }
}
