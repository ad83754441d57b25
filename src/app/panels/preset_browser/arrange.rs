//! Which presets the browser lists, and in which order: search, tags and sorting, without a window.

use std::{cmp::Reverse, collections::BTreeMap, time::SystemTime};

use crate::app::{settings::browsing::Sort, widgets::fuzzy};

/// What is known of a preset.
#[derive(Clone, Debug, Default)]
pub struct Item {
    pub id: String,
    pub title: String,
    pub about: String,
    pub tags: Vec<String>,
    /// Names of its effects.
    pub effects: Vec<String>,
    /// When its file was changed; none for a built-in preset.
    pub changed: Option<SystemTime>,
    pub is_favorite: bool,
}

/// What the user looks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filter {
    pub search: String,
    /// A preset is listed if it has all of these tags.
    pub tags: Vec<String>,
    pub only_favorites: bool,
    pub sort: Sort,
}

impl Filter {
    /// True if every preset is listed.
    pub fn is_empty(&self) -> bool {
        self.search.trim().is_empty() && self.tags.is_empty() && !self.only_favorites
    }

    /// How well `item` answers; none if it does not.
    fn score(&self, item: &Item) -> Option<i32> {
        if self.only_favorites && !item.is_favorite
            || !self.tags.iter().all(|tag| item.tags.contains(tag))
        {
            return None;
        }
        let others = format!(
            "{} {} {} {}",
            item.id,
            item.tags.join(" "),
            item.effects.join(" "),
            item.about
        );
        fuzzy::score(&self.search, &item.title, &others)
    }
}

/// Indices of the items that answer `filter`, in order: the best answers first while something is
/// searched.
pub fn arrange(items: &[Item], filter: &Filter) -> Vec<usize> {
    let mut found: Vec<(i32, usize)> = items
        .iter()
        .enumerate()
        .filter_map(|(index, item)| Some((filter.score(item)?, index)))
        .collect();
    let name = |index: usize| (items[index].title.to_lowercase(), items[index].id.as_str());
    found.sort_by(|(a_score, a), (b_score, b)| {
        let by_choice = match filter.sort {
            Sort::Name => std::cmp::Ordering::Equal,
            Sort::Newest => Reverse(items[*a].changed).cmp(&Reverse(items[*b].changed)),
            Sort::FavoritesFirst => items[*b].is_favorite.cmp(&items[*a].is_favorite),
        };
        b_score
            .cmp(a_score)
            .then(by_choice)
            .then_with(|| name(*a).cmp(&name(*b)))
    });
    found.into_iter().map(|(_, index)| index).collect()
}

/// The tags of the items that answer `filter`, the most frequent first, with the number of items
/// that have each. Chosen ones come first.
pub fn tags(items: &[Item], filter: &Filter) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<&str, usize> =
        filter.tags.iter().map(|tag| (tag.as_str(), 0)).collect();
    for index in arrange(items, filter) {
        items[index]
            .tags
            .iter()
            .for_each(|tag| *counts.entry(tag).or_default() += 1);
    }
    let mut tags: Vec<(String, usize)> = counts
        .into_iter()
        .map(|(tag, count)| (tag.to_owned(), count))
        .collect();
    tags.sort_by_key(|(tag, count)| (!filter.tags.contains(tag), Reverse(*count)));
    tags
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn item(id: &str, title: &str, tags: &[&str], effects: &[&str]) -> Item {
        let owned = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
        Item {
            id: id.into(),
            title: title.into(),
            tags: owned(tags),
            effects: owned(effects),
            ..Item::default()
        }
    }

    fn items() -> Vec<Item> {
        let mut items = vec![
            item(
                "comic",
                "Comic",
                &["toon", "outline"],
                &["lambert", "toon", "outline"],
            ),
            item(
                "one-bit",
                "One bit",
                &["dither", "outline"],
                &["dither", "outline"],
            ),
            item("facet-knot", "Cut knot", &["facet"], &["lambert", "facet"]),
            item("toon", "Toon", &["canonical"], &["toon"]),
        ];
        items[2].is_favorite = true;
        items[1].changed = Some(SystemTime::UNIX_EPOCH + Duration::from_secs(10));
        items[3].changed = Some(SystemTime::UNIX_EPOCH + Duration::from_secs(20));
        items
    }

    fn ids(filter: &Filter) -> Vec<String> {
        let items = items();
        arrange(&items, filter)
            .into_iter()
            .map(|index| items[index].id.clone())
            .collect()
    }

    fn search_words(search: &str) -> Vec<String> {
        ids(&Filter {
            search: search.into(),
            ..Filter::default()
        })
    }

    #[test]
    fn presets_are_found_by_name_id_tag_and_effect() {
        assert_eq!(search_words("knot"), ["facet-knot"]);
        assert_eq!(search_words("one-bit"), ["one-bit"], "by id");
        assert_eq!(
            search_words("toon"),
            ["toon", "comic"],
            "the name before a tag"
        );
        assert_eq!(
            search_words("lambert"),
            ["comic", "facet-knot"],
            "by effect"
        );
        assert_eq!(search_words("outline dither"), ["one-bit"]);
        assert!(search_words("nothing of the kind").is_empty());
    }

    #[test]
    fn the_order_is_that_of_the_choice() {
        let sorted = |sort: Sort| {
            ids(&Filter {
                sort,
                ..Filter::default()
            })
        };
        assert_eq!(
            sorted(Sort::Name),
            ["comic", "facet-knot", "one-bit", "toon"],
            "by the name that is shown"
        );
        assert_eq!(
            sorted(Sort::Newest),
            ["toon", "one-bit", "comic", "facet-knot"],
            "built-in ones behind files"
        );
        assert_eq!(
            sorted(Sort::FavoritesFirst),
            ["facet-knot", "comic", "one-bit", "toon"]
        );
    }

    #[test]
    fn chosen_tags_must_all_be_there_and_the_others_are_counted() {
        let filter = Filter {
            tags: vec!["outline".into()],
            ..Filter::default()
        };
        assert_eq!(ids(&filter), ["comic", "one-bit"]);
        let counted = [("outline", 2), ("dither", 1), ("toon", 1)]
            .map(|(tag, count)| (tag.to_owned(), count));
        assert_eq!(tags(&items(), &filter), counted);
        let both = Filter {
            tags: vec!["outline".into(), "facet".into()],
            ..Filter::default()
        };
        assert!(ids(&both).is_empty());
        assert_eq!(
            tags(&items(), &both).len(),
            2,
            "a chosen tag stays, to be removed"
        );
        assert_eq!(
            ids(&Filter {
                only_favorites: true,
                ..Filter::default()
            }),
            ["facet-knot"]
        );
    }
}
