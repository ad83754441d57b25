//! Promise: deny.toml names every crate that Cargo.lock has in several versions, each but the
//! newest, with the reason; and no other.

use std::collections::{BTreeMap, BTreeSet};

use toml_edit::{DocumentMut, Item, Value};

fn document(name: &str) -> DocumentMut {
    let text = std::fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR")))
        .expect("the file is there");
    text.parse().expect("TOML")
}

/// `0.4.15` is of the series `0.4`, `1.3.2` of `1`: within one, Cargo takes a single version.
fn series(version: &str) -> String {
    let mut parts = version.split('.');
    match (
        parts.next().unwrap_or_default(),
        parts.next().unwrap_or_default(),
    ) {
        ("0", minor) => format!("0.{minor}"),
        (major, _) => major.to_owned(),
    }
}

fn numbers(version: &str) -> Vec<u64> {
    version
        .split(['.', '+', '-'])
        .map_while(|part| part.parse().ok())
        .collect()
}

#[test]
fn crates_in_several_versions_are_listed_with_the_reason() {
    let lock = document("Cargo.lock");
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in lock["package"]
        .as_array_of_tables()
        .expect("packages")
        .iter()
    {
        let text = |key: &str| package[key].as_str().expect("text").to_owned();
        versions
            .entry(text("name"))
            .or_default()
            .push(text("version"));
    }
    assert!(versions.len() > 300, "{} crates", versions.len());
    let mut expected = BTreeSet::new();
    for (name, mut of_crate) in versions {
        of_crate.sort_by_key(|version| numbers(version));
        of_crate.pop();
        expected.extend(
            of_crate
                .iter()
                .map(|version| format!("{name}:{}", series(version))),
        );
    }

    let deny = document("deny.toml");
    let skip = deny["bans"]["skip"].as_array().expect("a list");
    let mut listed = BTreeSet::new();
    for entry in skip {
        let text = |key: &str| {
            entry
                .as_inline_table()
                .and_then(|table| table.get(key))
                .and_then(Value::as_str)
                .unwrap_or_default()
        };
        assert!(text("reason").len() > 4, "{entry} has no reason");
        assert!(
            listed.insert(text("crate").to_owned()),
            "{entry} stands twice"
        );
    }
    assert_eq!(
        listed, expected,
        "deny.toml on the left, Cargo.lock on the right"
    );
    assert_eq!(
        deny["bans"].get("multiple-versions").and_then(Item::as_str),
        Some("deny")
    );
}

#[test]
fn a_series_is_what_cargo_takes_one_version_of() {
    assert_eq!(
        ["1.3.2", "0.4.15", "0.0.3", "2.1.3+4"].map(series),
        ["1", "0.4", "0.0", "2"]
    );
    assert!(numbers("0.10.2") > numbers("0.9.14"));
}
