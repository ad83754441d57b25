//! Promise: the house does not grow without payment. Each row holds a ceiling; who raises one
//! writes beside the number what for, and what was taken away for it.

use std::{fs, path::Path};

/// Bytes of Rust below a folder; a comment says what the last raises were for, in KB, and what went.
const RUST: &[(&str, u64)] = &[
    // Rows without an error, of what the oracle cannot draw (1.1).
    ("crates/bench", 58_200),
    // A precision that stops at what WGSL leaves open (2); studio's Rust went.
    ("crates/evaluator", 177_500),
    // First looks (4), rates of films as fractions and pasted presets (3), what effect files are told
    // (9); conditions on built-in effects went.
    // A missing model is told before the output (0.5). Pasted looks, pictures of the plain look, loops
    // without an end (1.8).
    ("crates/files", 396_300),
    // Clouds: points without records, boxes of their blocks, attributes in two buffers, the pipeline's
    // own points (9.7); a still no longer asks for what a judge does.
    ("crates/gpu", 431_300),
    // Their pass and its features (4.6).
    ("crates/kernels", 243_700),
    // Points: readers, looks, compressed surveys, lines, colors of intensity and class (58). Studio, what
    // surrounds it and the colors of Shadow have no Rust any more (25).
    // Places that cannot be drawn leave the rest of a model (5.3); encoding by roots (0.5). Heights of
    // terrains and surveys that are black (3.4). Points in an order of places, a volume of them (8.9).
    ("crates/model", 1_524_000),
    ("crates/one_thread", 4_100),
    // The twin of points (11), layers of an x-ray by rows (1), what a compiler may make of no number (1).
    ("crates/oracle", 485_000),
    ("crates/page", 21_900),
    ("crates/window", 3_500),
    // Near names, the axis of a model, verdicts that stay while a picture changes its size (8);
    // notes of a model once, though it is loaded again for a look (1); where a new effect is written,
    // Trade and badges in a small window (3); Compare there (3), the folder of films, the sign of
    // copying, looks and axes that stay (3.5); what a newcomer met a third time: tables of the guide,
    // pasted looks, missing files told in Open, what menus gray and mark (6.5).
    ("src/app", 1_347_000),
    // One rule for shared options of commands (2.5); explain in sentences (1); a missing model (0.4).
    ("src/cli", 229_700),
    ("fuzz", 289_500),
    // Memory of a process, which two rooms had each (0.5).
    ("tests/common", 18_100),
    // Steady points (2), a number in place of none (1); strict and lattice share what runs a kernel.
    // Clouds from everywhere and in two buffers (2.5).
    ("tests/exact", 313_100),
    // Compressed surveys, lines and plain clouds (8); terrains and black surveys (1.6), what is timed
    // without an oracle (1.7).
    ("tests/house", 697_700),
    // Random edits and kills (10), what a newcomer met (6); what the program holds, counted (1.5), for which
    // tests/house came down by 2.5. What a newcomer met again (1), and a third time (1.7).
    ("tests/lab", 386_700),
    ("tests/picture", 285_000),
];

/// Files and bytes of WGSL in `shaders`: lines and steady points (2), clouds (9).
const SHADERS: (usize, u64) = (180, 493_300);

/// Packages in `Cargo.lock`, of all platforms. The clipboard of the system costs none: the feature `arboard` of egui-winit
/// alone stands there already, and compiles arboard and wl-clipboard-rs with it. `clipboard` has smithay-clipboard too, with
/// six more, for Wayland without the protocol of clipboard managers; there arboard goes through Xwayland. `laz` came for
/// console_error_panic_hook, which three words of web-sys do. Fonts of the system are nine: without them names of other
/// alphabets are boxes; nothing went for them.
const PACKAGES: usize = 449;

/// Words of the pages that people read.
const WORDS: usize = 38_000;

/// Widest line of prose, in characters. Rows of tables and of HTML stand on one line.
const WIDEST_LINE: usize = 160;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Paths of all files below a folder whose name ends so.
fn files_below(folder: &Path, ending: &str) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("a folder of the repository").path();
        if path.is_dir() && !path.ends_with("target") {
            found.extend(files_below(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found
}

fn bytes_below(folder: &str, ending: &str) -> u64 {
    files_below(&root().join(folder), ending)
        .iter()
        .map(|file| fs::metadata(file).expect("a file of the repository").len())
        .sum()
}

/// Pages with their texts: those of the top level, of `docs` and of its decisions.
fn pages() -> Vec<(String, String)> {
    let mut files = files_below(&root().join("docs"), ".md");
    files.extend(["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    files
        .into_iter()
        .map(|file| {
            let text = fs::read_to_string(&file).expect("a page is text");
            (file.display().to_string(), text)
        })
        .collect()
}

#[test]
fn nothing_is_above_its_ceiling() {
    let mut too_much = Vec::new();
    let mut hold = |what: &str, size: u64, ceiling: u64| {
        if size > ceiling {
            too_much.push(format!("{what}: {size}, at most {ceiling}"));
        }
    };
    for (folder, ceiling) in RUST {
        let bytes = bytes_below(folder, ".rs");
        assert!(bytes > 0, "{folder} has no Rust: take its row away");
        hold(folder, bytes, *ceiling);
    }
    let shaders = files_below(&root().join("shaders"), ".wgsl").len();
    hold("files of shaders", shaders as u64, SHADERS.0 as u64);
    hold(
        "bytes of shaders",
        bytes_below("shaders", ".wgsl"),
        SHADERS.1,
    );
    let lock = fs::read_to_string(root().join("Cargo.lock")).expect("the lock file is text");
    let packages = lock.matches("\n[[package]]\n").count();
    hold("packages in Cargo.lock", packages as u64, PACKAGES as u64);
    let words: usize = pages()
        .iter()
        .map(|(_, text)| text.split_whitespace().count())
        .sum();
    hold("words of documentation", words as u64, WORDS as u64);
    assert!(too_much.is_empty(), "{}", too_much.join("\n"));
}

#[test]
fn no_line_of_a_page_is_too_wide() {
    let wide: Vec<String> = pages()
        .iter()
        .flat_map(|(name, text)| {
            text.lines()
                .enumerate()
                .filter(|(_, line)| !line.trim_start().starts_with(['|', '<']))
                .filter(|(_, line)| line.chars().count() > WIDEST_LINE)
                .map(move |(at, _)| format!("{name}:{}", at + 1))
        })
        .collect();
    assert!(
        wide.is_empty(),
        "wider than {WIDEST_LINE}: {}",
        wide.join(", ")
    );
}
