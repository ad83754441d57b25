//! Promise: inside a crate, a module names only modules that stand before it in the crate's list, and
//! files of the GPU stand in no circle; crates obey `Cargo.toml`. The core names nothing that a page lacks. Long files have a reason,
//! and unsafe code stands in two places.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Folders of crates with several modules, and their modules in dependency order.
const ORDER: &[(&str, &[&str])] = &[
    (
        "crates/model",
        &[
            "work", "math", "legible", "frame", "accuracy", "measure", "scene", "shaders",
            "params", "effects", "preset",
        ],
    ),
    ("crates/kernels", &["shader", "plan"]),
    (
        "crates/oracle",
        &[
            "arithmetic",
            "point",
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
    (".", &["contact_sheet", "link", "golden", "app", "cli"]),
];

/// Folders whose `mod` lines, in `lib.rs` or `mod.rs`, are in order: each names only those above it.
/// With the imports that do not obey, and the files that stand in circles of imports: these
/// numbers only fall.
const FOLDERS: &[(&str, &[&str], usize, usize)] =
    &[("crates/gpu/src", &[], 0, 0), ("src", &["app"], 139, 33)];

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
        "crates/gpu/src/layout/frame_layout.rs",
        "the only place that computes sizes and offsets of a frame",
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

/// Every path that stands in `code` behind `parent` (`crate::`, `super::`, `std::`), name by name.
fn paths_below(parent: &str, code: &str) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    for (at, _) in code.match_indices(parent) {
        if !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
            collect_paths(&code[at + parent.len()..], &[], &mut paths);
        }
    }
    paths
}

/// Adds the paths of a tree of imports, and returns what stands behind it.
fn collect_paths<'a>(tree: &'a str, before: &[String], paths: &mut Vec<Vec<String>>) -> &'a str {
    let tree = tree.trim_start();
    if let Some(mut group) = tree.strip_prefix('{') {
        loop {
            group = collect_paths(group, before, paths).trim_start();
            match group.strip_prefix(',') {
                Some(next) if !next.trim_start().starts_with('}') => group = next,
                Some(end) => return end.trim_start().trim_start_matches('}'),
                None => return group.strip_prefix('}').unwrap_or(group),
            }
        }
    }
    let end = tree
        .find(|c: char| !c.is_alphanumeric() && c != '_' && c != '*')
        .unwrap_or(tree.len());
    let path = [before, &[tree[..end].to_owned()]].concat();
    match tree[end..].strip_prefix("::") {
        Some(inside) => collect_paths(inside, &path, paths),
        None => {
            paths.push(path);
            &tree[end..]
        }
    }
}

/// A module of a crate, name by name; empty for its root.
type Module = Vec<String>;

/// Which modules below a folder of sources name which others, without those of unit tests. A
/// folder's `mod.rs` names what it exports once more. The root of a crate names all, and all name it.
fn imports(src: &str) -> BTreeMap<Module, BTreeSet<Module>> {
    let module = |source: &Source| -> Module {
        let inside = &source.name[src.len() + 1..source.name.len() - ".rs".len()];
        let names = inside.split('/').map(str::to_owned);
        names
            .filter(|name| !["mod", "lib", "main"].contains(&name.as_str()))
            .collect()
    };
    let all = sources(src);
    let modules: BTreeSet<Module> = all.iter().map(&module).collect();
    let mut imports = BTreeMap::new();
    for source in &all {
        let own = module(source);
        let code = source.code.split("#[cfg(test)]\nmod tests {").next();
        let code = code.unwrap_or_default();
        let parent = &own[..own.len().saturating_sub(1)];
        let mut named = Vec::new();
        for (word, base) in [("crate::", &[][..]), ("super::", parent), ("self::", &own)] {
            for path in paths_below(word, code) {
                let ups = path.iter().take_while(|name| *name == "super").count();
                let base = &base[..base.len().saturating_sub(ups)];
                named.push([base, &path[ups..]].concat());
            }
        }
        let children = modules.iter().filter(|module| {
            module.strip_prefix(&own[..]).is_some_and(|rest| {
                rest.len() == 1 && !paths_below(&format!("{}::", rest[0]), code).is_empty()
            })
        });
        named.extend(children.cloned());
        let found = named.into_iter().filter_map(|mut path| {
            while !path.is_empty() && !modules.contains(&path) {
                path.pop();
            }
            (!path.is_empty() && path != own).then_some(path)
        });
        imports.insert(own.clone(), found.collect());
    }
    imports
}

/// Imports below `folder` that go against the order of `mod` lines in its `lib.rs` or `mod.rs`.
fn uphill(src: &str, folder: &[&str]) -> Vec<String> {
    let inside = [&[src], folder].concat().join("/");
    let list = ["lib.rs", "mod.rs"].map(|file| root().join(&inside).join(file));
    let list = list.iter().find(|file| file.exists());
    let text = fs::read_to_string(list.expect("a folder lists its modules")).expect("text");
    let order: Vec<&str> = text
        .lines()
        .filter_map(|line| line.split_once("mod ")?.1.strip_suffix(';'))
        .collect();
    let place = |module: &Module| {
        let rest =
            module.strip_prefix(&folder.iter().map(|s| s.to_string()).collect::<Vec<_>>()[..]);
        let first = rest?.first()?.clone();
        order.iter().position(|name| **name == first)
    };
    let mut faults = Vec::new();
    for (from, all) in imports(src) {
        for to in all {
            if place(&from).is_some() && place(&to) > place(&from) {
                faults.push(format!("{} names {}", from.join("::"), to.join("::")));
            }
        }
    }
    faults
}

/// Modules that reach themselves by what they name.
fn in_circles(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<String> {
    let reaches_itself = |start: &Module| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(module) = next.pop() {
            for named in imports.get(module).into_iter().flatten() {
                if seen.insert(named) {
                    next.push(named);
                }
            }
        }
        seen.contains(start)
    };
    let found = imports.keys().filter(|module| reaches_itself(module));
    found.map(|module| module.join("::")).collect()
}

#[test]
fn folders_have_a_direction_and_files_no_circles() {
    for (src, folder, most_uphill, most_in_circles) in FOLDERS {
        let mut folders = vec![folder.to_vec()];
        if *most_uphill == 0 {
            let inside = fs::read_dir(root().join(src).join(folder.join("/"))).expect("a folder");
            let inside = inside.map(|entry| entry.expect("a folder").path());
            let names = inside.filter(|path| path.join("mod.rs").exists());
            let names = names.map(|path| {
                path.file_name()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned()
            });
            folders.extend(names.map(|name| [folder, &[&*name.leak()][..]].concat()));
        }
        let uphill: Vec<_> = folders
            .iter()
            .flat_map(|folder| uphill(src, folder))
            .collect();
        assert!(
            uphill.len() <= *most_uphill,
            "{} imports go uphill:\n{}",
            uphill.len(),
            uphill.join("\n")
        );
        let mut imports = imports(src);
        imports.retain(|module, _| module.iter().zip(*folder).all(|(a, b)| a == b));
        let circles = in_circles(&imports);
        assert!(
            circles.len() <= *most_in_circles,
            "{} files are in circles: {}",
            circles.len(),
            circles.join(", ")
        );
    }
}

#[test]
fn a_module_names_only_modules_before_it() {
    let mut faults = Vec::new();
    for (folder, modules) in ORDER {
        let src = if *folder == "." {
            "src".to_owned()
        } else {
            format!("{folder}/src")
        };
        let imports = imports(&src);
        let place = |module: &Module| {
            modules
                .iter()
                .position(|name| module.first().is_some_and(|m| m == name))
        };
        for (from, all) in &imports {
            let Some(at) = place(from) else { continue };
            let later = all.iter().filter(|to| place(to).is_some_and(|to| to > at));
            faults.extend(later.map(|to| format!("{} names {}", from.join("::"), to.join("::"))));
        }
        let found: BTreeSet<&str> = imports
            .keys()
            .filter_map(|module| Some(module.first()?.as_str()))
            .collect();
        let listed: BTreeSet<&str> = modules.iter().copied().collect();
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
    paths_below("std::", code)
        .iter()
        .any(|path| NATIVE.contains(&path[0].as_str()))
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
    let code = "use crate::{\n    gpu::{self, scene::Gpu,},\n    work,\n};\nlet x = crate::oracle::render();";
    let paths = paths_below("crate::", code);
    let paths: Vec<String> = paths.iter().map(|path| path.join("::")).collect();
    assert_eq!(
        paths,
        ["gpu::self", "gpu::scene::Gpu", "work", "oracle::render"]
    );
    let names = |names: &[&str]| names.iter().map(|name| vec![name.to_string()]).collect();
    let imports = [
        ("a", &["b"][..]),
        ("b", &["c"]),
        ("c", &["b"]),
        ("d", &["a"]),
    ];
    let imports = imports.map(|(from, to)| (vec![from.to_owned()], names(to)));
    assert_eq!(in_circles(&BTreeMap::from(imports)), ["b", "c"]);
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
        [
            "crates/gpu/src/resources/pipelines.rs",
            "src/app/jobs/memory.rs"
        ]
    );
}
