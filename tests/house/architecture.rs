//! Promise: a module of the crate ("room") names only the rooms that it may know. [`MAY_KNOW`] is the whole diagram, in the order
//! in which `src/lib.rs` lists the rooms; the tests read the arrows from the sources. Inside rooms, see `circles.rs`.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Room, and the rooms it may name. `tests` inside a room obey the same arrows.
const MAY_KNOW: &[(&str, &[&str])] = &[
    ("work", &[]),
    ("math", &[]),
    ("frame", &["math"]),
    ("accuracy", &[]),
    ("measure", &["frame", "math"]),
    ("scene", &["accuracy", "math", "work"]),
    ("params", &[]),
    ("effects", &["math", "params", "scene"]),
    ("shader", &["effects", "frame", "accuracy", "math", "params", "scene"]),
    ("plan", &["effects", "accuracy", "math", "params", "scene", "shader"]),
    ("evaluator", &[]),
    ("effect_files", &["effects", "evaluator", "math", "params", "shader"]),
    ("preset", &["effects", "accuracy", "math", "params", "plan", "scene", "shader"]),
    ("oracle", &["effects", "frame", "math", "measure", "params", "scene", "work"]),
    ("gpu", &["effects", "frame", "accuracy", "math", "measure", "params", "plan", "scene", "preset", "shader"]),
    ("preset_file", &["effect_files", "effects", "frame", "accuracy", "math", "params", "plan", "scene", "preset", "shader"]),
    // A film names neither `gpu` nor `oracle`: whoever asks for one says who draws it.
    ("film", &["frame", "math", "scene", "preset", "preset_file"]),
    ("stress", &["effects", "frame", "gpu", "accuracy", "math", "measure", "oracle", "params", "plan", "scene", "preset", "work"]),
    (
        "app",
        &[
            "effect_files",
            "effects",
            "frame",
            "gpu",
            "accuracy",
            "math",
            "measure",
            "oracle",
            "params",
            "plan",
            "preset_file",
            "film",
            "scene",
            "preset",
            "shader",
            "stress",
            "work",
        ],
    ),
    (
        "cli",
        &[
            "app",
            "effect_files",
            "effects",
            "frame",
            "gpu",
            "accuracy",
            "math",
            "measure",
            "oracle",
            "params",
            "plan",
            "preset_file",
            "film",
            "scene",
            "preset",
            "shader",
            "stress",
            "work",
        ],
    ),
];

/// Longest source file, lines. A longer one stands here with its reason.
const LONGEST: usize = 450;
const LONG_FOR_A_REASON: &[(&str, &str)] = &[
    ("src/cli/args.rs", "one list of all commands and flags, as the help shows them"),
    ("src/accuracy.rs", "one list of all axes, with what every option does"),
    ("src/preset/settings.rs", "one list of all settings of a preset, in the order of its file"),
    ("src/gpu/records.rs", "one list of all structs that Rust and the kernels share"),
    ("src/gpu/frame_layout.rs", "the only place that computes sizes, offsets and dispatches of a frame"),
];

/// Crates that only some rooms may name.
const GUARDED: &[(&str, &[&str])] = &[
    ("wgpu", &["gpu", "app"]),
    ("naga", &["effect_files", "evaluator", "shader", "gpu"]),
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("egui_wgpu", &["app"]),
    ("rfd", &["app"]),
    ("notify", &["app"]),
    ("trash", &["app"]),
    ("etcetera", &["preset_file"]),
    ("rstar", &["gpu"]),
    ("clap", &["cli", "main"]),
    ("indicatif", &["cli"]),
    ("anyhow", &["cli", "app", "main"]),
];

struct Source {
    /// `src/oracle/render/clip.rs`.
    name: String,
    room: String,
    /// Without comments and without text in quotes.
    code: String,
    lines: usize,
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    collect(&root.join("src"), &mut files);
    files.sort();
    files.iter().map(|file| source(root, file)).collect()
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

fn source(root: &Path, file: &Path) -> Source {
    let text = fs::read_to_string(file).expect("a source file is text");
    let inside = file.strip_prefix(root.join("src")).expect("collected below src");
    let first = inside.components().next().expect("a file has a name").as_os_str().to_string_lossy();
    let room = first.trim_end_matches(".rs").to_owned();
    Source { name: format!("src/{}", inside.display()).replace('\\', "/"), room, code: code_of(&text), lines: text.lines().count() }
}

/// Drops comments, and what stands in quotes on one line.
fn code_of(text: &str) -> String {
    let strip = |line: &str| {
        let mut kept = String::new();
        let (mut in_quotes, mut previous) = (false, ' ');
        for c in line.chars() {
            if !in_quotes && c == '/' && previous == '/' {
                kept.pop();
                break;
            }
            if c == '"' && previous != '\\' && previous != '\'' {
                in_quotes = !in_quotes;
            } else if !in_quotes {
                kept.push(c);
            }
            previous = if previous == '\\' && c == '\\' { ' ' } else { c };
        }
        kept
    };
    text.lines().map(strip).collect::<Vec<_>>().join("\n")
}

/// Rooms that `code` names: behind every `crate::`, and each branch of `crate::{...}`.
fn rooms_named(code: &str) -> BTreeSet<String> {
    let mut rooms = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &code[at + "crate::".len()..];
        match rest.strip_prefix('{') {
            Some(group) => rooms.extend(branches(group)),
            None => rooms.extend(word(rest)),
        }
    }
    rooms
}

/// First word of each branch of a `{...}` group, whose opening brace is gone.
fn branches(group: &str) -> Vec<String> {
    let (mut depth, mut starts, mut words) = (0, true, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => starts = true,
            c if starts && c.is_alphabetic() => {
                words.extend(word(&group[at..]));
                starts = false;
            }
            _ => {}
        }
    }
    words
}

fn word(text: &str) -> Option<String> {
    let word: String = text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (!word.is_empty()).then_some(word)
}

#[test]
fn no_room_names_a_room_above_it() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_KNOW.iter().copied().collect();
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| !["lib", "main"].contains(&source.room.as_str())) {
        let Some(allowed) = allowed.get(source.room.as_str()) else {
            faults.push(format!("{}: the room {} is not in the diagram", source.name, source.room));
            continue;
        };
        for named in rooms_named(&source.code) {
            let is_room = MAY_KNOW.iter().any(|(room, _)| *room == named);
            if is_room && named != source.room && !allowed.contains(&named.as_str()) {
                faults.push(format!("{} names {named}, which {} may not know", source.name, source.room));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Rooms in the order in which the documentation of `src/lib.rs` lists them: the names in front of each line's colon.
fn rooms_of_lib() -> Vec<String> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).expect("src/lib.rs can be read");
    let heads = text.lines().filter_map(|line| line.strip_prefix("//! * ")?.split(": ").next());
    heads.flat_map(|head| head.split('`').skip(1).step_by(2).map(str::to_owned)).collect()
}

#[test]
fn lib_rs_lists_every_room_after_the_rooms_that_it_may_know() {
    let rooms: Vec<&str> = MAY_KNOW.iter().map(|(room, _)| *room).collect();
    assert_eq!(rooms_of_lib(), rooms, "src/lib.rs and MAY_KNOW list the rooms in the same order");
    for (at, (room, knows)) in MAY_KNOW.iter().enumerate() {
        // This order also rules out circles among rooms.
        let later: Vec<_> = knows.iter().filter(|known| !rooms[..at].contains(known)).collect();
        assert!(later.is_empty(), "{room} may know {later:?}, which stand behind it in the list");
    }
}

#[test]
fn wgpu_and_egui_stay_behind_their_doors() {
    let mut faults = Vec::new();
    for source in sources() {
        for (name, rooms) in GUARDED {
            let names = source.code.match_indices(&format!("{name}::")).any(|(at, _)| {
                let before = source.code[..at].chars().next_back().unwrap_or(' ');
                !(before.is_alphanumeric() || before == '_' || before == ':')
            });
            if names && !rooms.contains(&source.room.as_str()) {
                faults.push(format!("{} names {name}", source.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn oracle_and_gpu_never_see_each_other_and_the_oracle_sees_no_shader() {
    let knows = |room: &str| MAY_KNOW.iter().find(|(name, _)| *name == room).expect("the room is in the diagram").1;
    assert!(!knows("oracle").iter().any(|room| ["gpu", "shader", "plan"].contains(room)));
    assert!(!knows("gpu").contains(&"oracle"));
    for source in sources().iter().filter(|source| ["oracle", "gpu", "shader"].contains(&source.room.as_str())) {
        let other = if source.room == "oracle" { ["gpu", "shader"] } else { ["oracle", "preset_file"] };
        let named = rooms_named(&source.code);
        assert!(!other.iter().any(|other| named.contains(*other)), "{} names one of {other:?}", source.name);
    }
}

#[test]
fn a_long_file_has_a_reason() {
    let long: Vec<_> = sources().into_iter().filter(|source| source.lines > LONGEST).collect();
    for source in &long {
        let reason = LONG_FOR_A_REASON.iter().find(|(name, _)| *name == source.name);
        assert!(reason.is_some(), "{} has {} lines; split it, or give a reason here", source.name, source.lines);
    }
    for (name, _) in LONG_FOR_A_REASON {
        assert!(long.iter().any(|source| source.name == *name), "{name} is not long any more; drop its reason");
    }
}

#[test]
fn nothing_is_unsafe_but_trusting_our_own_shaders_and_giving_memory_back() {
    let root = source(Path::new(env!("CARGO_MANIFEST_DIR")), &Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    assert!(root.code.contains("#![deny(unsafe_code)]"), "src/lib.rs does not deny unsafe code");
    let all = sources();
    let unsafe_in = |source: &&Source| source.code.contains("unsafe {");
    let places: Vec<&str> = all.iter().filter(unsafe_in).map(|source| source.name.as_str()).collect();
    assert_eq!(places, ["src/app/memory.rs", "src/gpu/pipelines.rs"]);
}

#[test]
fn the_reader_of_arrows_sees_what_it_should() {
    let code = code_of(
        "use crate::{\n    gpu::{self, device::Gpu},\n    scene::Scene, // crate::app\n};\nlet x = crate::oracle::render(\"crate::cli\");",
    );
    assert_eq!(rooms_named(&code).into_iter().collect::<Vec<_>>(), ["gpu", "oracle", "scene"]);
    assert_eq!(rooms_named("$crate::params::Kind").into_iter().collect::<Vec<_>>(), ["params"]);
    assert!(rooms_named("use mycrate::gpu;").is_empty());
}
