//! Promise: inside a crate, a module names only modules that stand before it in the crate's list;
//! crates obey `Cargo.toml`. The core names nothing that a page lacks. Long files have a reason,
//! and unsafe code stands in two places.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Folders of crates with several modules, and their modules in dependency order.
const ORDER: &[(&str, &[&str])] = &[
    (
        "crates/model",
        &[
            "work", "math", "legible", "frame", "accuracy", "measure", "scene", "params",
            "effects", "preset",
        ],
    ),
    ("crates/kernels", &["shader", "plan"]),
    (
        "crates/oracle",
        &[
            "arithmetic",
            "perturbation",
            "shot",
            "budget",
            "render",
            "bounds",
            "judge",
            "probe",
            "probe_text",
        ],
    ),
    (
        "crates/files",
        &["host", "archive", "effect_files", "preset_file", "film"],
    ),
    ("crates/bench", &["baselines", "trade", "extremes"]),
    (".", &["link", "golden", "app", "cli"]),
];

/// The core: crates that can live in a page.
const CORE: &[&str] = &[
    "crates/model",
    "crates/kernels",
    "crates/evaluator",
    "crates/oracle",
    "crates/gpu",
];

/// Modules of the standard library that a page lacks. It has no clock of the standard library's,
/// either, and no thread may wait there.
const NATIVE: &[&str] = &["fs", "env", "net", "process", "thread"];

/// Longest source file, lines. A longer one stands here with its reason.
const LONGEST: usize = 640;
const LONG_FOR_A_REASON: &[(&str, &str)] = &[
    (
        "crates/gpu/src/frame_layout.rs",
        "the only place that computes sizes, offsets and dispatches of a frame",
    ),
    (
        "crates/kernels/src/shader/link.rs",
        "one linker: what a section declares, uses and calls",
    ),
    (
        "crates/model/src/preset/settings.rs",
        "one list of all settings of a preset, in the order of its file",
    ),
];

struct Source {
    /// `crates/oracle/src/render/clip.rs`.
    name: String,
    /// Without comments.
    code: String,
    lines: usize,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every source file below a folder of the repository, sorted by name.
fn sources(folder: &str) -> Vec<Source> {
    let mut files = Vec::new();
    collect(&root().join(folder), &mut files);
    files.sort();
    files.iter().map(|file| source(file)).collect()
}

fn all_sources() -> Vec<Source> {
    ["crates", "src"].into_iter().flat_map(sources).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a source folder can be read") {
        let path = entry.expect("a source folder can be read").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

fn source(file: &Path) -> Source {
    let text = fs::read_to_string(file).expect("a source file is text");
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n");
    let name = file
        .strip_prefix(root())
        .expect("collected below the root")
        .display()
        .to_string()
        .replace('\\', "/");
    Source {
        name,
        code,
        lines: text.lines().count(),
    }
}

/// Does `code` name `crate::MODULE`, alone or as a branch of `crate::{...}`?
fn names_module(code: &str, module: &str) -> bool {
    names_below("crate::", code, module)
}

fn names_below(parent: &str, code: &str, module: &str) -> bool {
    code.match_indices(parent).any(
        |(at, path)| match code[at + path.len()..].strip_prefix('{') {
            None => is_word(&code[at + path.len()..], module),
            Some(group) => {
                let mut depth = 0;
                let mut is_start = true;
                for (at, c) in group.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => is_start = true,
                        c if is_start && !c.is_whitespace() => {
                            if is_word(&group[at..], module) {
                                return true;
                            }
                            is_start = false;
                        }
                        _ => {}
                    }
                }
                false
            }
        },
    )
}

fn is_word(text: &str, word: &str) -> bool {
    text.strip_prefix(word)
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

#[test]
fn a_module_names_only_modules_before_it() {
    let mut faults = Vec::new();
    for (folder, modules) in ORDER {
        for (at, module) in modules.iter().enumerate() {
            let [file, inside] = [
                format!("{folder}/src/{module}.rs"),
                format!("{folder}/src/{module}"),
            ];
            let own = if root().join(&file).exists() {
                vec![source(&root().join(file))]
            } else {
                sources(&inside)
            };
            for source in own {
                let later = modules[at + 1..]
                    .iter()
                    .filter(|later| names_module(&source.code, later));
                faults.extend(later.map(|later| {
                    format!(
                        "{} names {later}, which stands behind {module}",
                        source.name
                    )
                }));
            }
        }
        let mut found: Vec<_> = fs::read_dir(root().join(folder).join("src"))
            .expect("a crate has sources")
            .map(|entry| {
                entry
                    .expect("a crate has sources")
                    .path()
                    .file_stem()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned()
            })
            .filter(|name| name != "lib" && name != "main")
            .collect();
        found.sort();
        let mut listed = modules.to_vec();
        listed.sort_unstable();
        assert_eq!(
            found, listed,
            "the modules of {folder} and the list of this test"
        );
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Does `code` name something that a page lacks?
fn is_native(code: &str) -> bool {
    let is_clock = |line: &str| {
        line.contains("time::")
            && !line.contains("web_time")
            && ["Instant", "SystemTime"]
                .iter()
                .any(|clock| line.contains(clock))
    };
    NATIVE
        .iter()
        .any(|module| names_below("std::", code, module))
        || code.contains("pollster")
        || code.lines().any(is_clock)
}

#[test]
fn the_core_names_nothing_that_a_page_lacks() {
    let native = CORE
        .iter()
        .flat_map(|folder| sources(folder))
        // What a build runs is never in a page.
        .filter(|source| !source.name.ends_with("/build.rs") && is_native(&source.code));
    let native: Vec<_> = native.map(|source| source.name).collect();
    assert_eq!(
        native, [""; 0],
        "files of the core that name what a page lacks: crates/files/src/host gives it from outside"
    );
    for (code, expected) in [
        ("use std::{\n    collections::HashMap,\n    fs,\n};", true),
        ("let now = std::time::Instant::now();", true),
        ("    time::{Duration, Instant},", true),
        (
            "scope.pop().block_on(); use pollster::FutureExt as _;",
            true,
        ),
        (
            "use std::time::Duration;\nuse web_time::Instant;\nlet environment = std::fmt::Debug;",
            false,
        ),
    ] {
        assert_eq!(is_native(code), expected, "{code}");
    }
}

#[test]
fn the_reader_of_imports_sees_what_it_should() {
    let code = "use crate::{\n    gpu::{self, scene::Gpu},\n    work,\n};\nlet x = crate::oracle::render();";
    assert!(
        ["gpu", "work", "oracle"]
            .iter()
            .all(|module| names_module(code, module))
    );
    assert!(
        !["scene", "render", "wor", "g"]
            .iter()
            .any(|module| names_module(code, module))
    );
}

#[test]
fn a_long_file_has_a_reason() {
    let long: Vec<_> = all_sources()
        .into_iter()
        .filter(|source| source.lines > LONGEST)
        .map(|source| source.name)
        .collect();
    let reasons: Vec<_> = LONG_FOR_A_REASON.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        long, reasons,
        "files over {LONGEST} lines, and those with a reason: split one, or give its reason here"
    );
}

#[test]
fn nothing_is_unsafe_but_trusting_our_own_shaders_and_giving_memory_back() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the manifest can be read");
    assert!(
        manifest.contains("unsafe_code = \"deny\""),
        "Cargo.toml does not deny unsafe code"
    );
    let all = all_sources();
    let places: Vec<&str> = all
        .iter()
        .filter(|source| source.code.contains("unsafe {"))
        .map(|source| source.name.as_str())
        .collect();
    assert_eq!(
        places,
        ["crates/gpu/src/pipelines.rs", "src/app/jobs/memory.rs"]
    );
}
