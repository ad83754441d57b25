//! Promise: the tests add no feature to what the program depends on. One that does would compile
//! egui, wgpu and the library a second time for `cargo test`, and test another program than the one
//! that people run.

use std::{collections::BTreeMap, process::Command};

/// Features of every package, by name and version, that these edges of the dependency graph reach.
fn features(edges: &str) -> BTreeMap<String, String> {
    let tree = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--color",
            "never",
            "--offline",
            "--locked",
            "--prefix",
            "none",
            "--format",
            "{p}|{f}",
            "--edges",
            edges,
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(
        tree.status.success(),
        "{}",
        String::from_utf8_lossy(&tree.stderr)
    );
    let lines = String::from_utf8(tree.stdout).expect("package names are UTF-8");
    let entry = |line: &str| {
        line.trim_end_matches(" (*)")
            .split_once('|')
            .map(|(package, features)| (package.to_owned(), features.to_owned()))
    };
    lines.lines().filter_map(entry).collect()
}

#[test]
fn tests_add_no_feature_to_what_the_program_depends_on() {
    let (program, tests) = (features("normal,build"), features("normal,build,dev"));
    assert!(
        program.len() > 100 && tests.len() > program.len(),
        "{} and {} packages",
        program.len(),
        tests.len()
    );
    let differs = |(package, features): (&String, &String)| {
        let with_tests = &tests[package];
        (features != with_tests)
            .then(|| format!("{package}: {features} without tests, {with_tests} with them"))
    };
    assert_eq!(
        program.iter().filter_map(differs).collect::<Vec<_>>(),
        Vec::<String>::new(),
        "see [dev-dependencies] in Cargo.toml"
    );
}
