//! Promise: the house does not grow without payment. Each row holds a ceiling; who raises one
//! writes beside the number what for, and what was taken away for it.

use std::{fs, path::Path};

/// Bytes of Rust below a folder.
const RUST: &[(&str, u64)] = &[
    ("crates/bench", 57_000),
    // 64 samples at once: rows of registers, and masks where samples part (28 KB). Paid by 26 effects
    // that have no Rust any more.
    // A precision that stops at what WGSL leaves open (2), paid by studio's Rust.
    // A precision that stops at what WGSL leaves open (2), paid by studio's Rust.
    ("crates/evaluator", 177_500),
    // The first look at a model: the axis that is up and what its scene tells (4). The plain look itself
    // is a preset, which crates/model lost (4).
    // Rates of films as fractions, those of GIFs, and pasted presets (2).
    // The reach that a vertex effect states (1), paid by crates/model.
    // What effect files are told of returns, conversions, members and their meters, and f32 errors of
    // passes (9). Conditions on built-in effects went.
    // Effects that a folder of shaders has more (1), paid by crates/model.
    // The text of a preset is pasted as it is (1), paid by studio's Rust.
    // The text of a preset is pasted as it is (1), paid by studio's Rust.
    // Formats whose points have several colors (0.7).
    ("crates/files", 394_000),
    ("crates/gpu", 421_500),
    // The variant of points (0.2).
    ("crates/kernels", 239_000),
    // The types of the crate gltf, and what checks them: the reader's own tables went for it.
    // The reader of effects and what evaluates their texts, which crates/files lost. For what people
    // bring 31 KB: places in f64 far from the origin (7), names of other encodings and options of maps
    // (7), textures of transmission and morphed colors (10), all else (7). Paid by 131 KB of tests.
    // The first look at a model (15): the axis that is up (9), frames that fill the picture, cameras that
    // crop, lights that are too strong, and the point from which patterns count. Ten more effects have no
    // Rust any more (-27).
    // Blocks without a brace, and the formulas of facets in numbers (2).
    // Studio and what surrounds it have no Rust any more, and Shadow none for its colors (-25); bounds of
    // vertices whose inputs err at once (3).
    // Points: clouds, their readers and the scene survey (30). LAZ (11), colors of clouds (5), lines, and points
    // of OBJ (8), the plain look of clouds (3).
    ("crates/model", 1_505_500),
    ("crates/one_thread", 4_100),
    // Pixels, vertices and samples of a row handed on together (6).
    // Image passes over the ends of what they read (5), for a share of the picture that was let off.
    // Layers of an x-ray by rows (1), paid by crates/model. The twin of points (8), that of lines (3).
    ("crates/oracle", 483_500),
    // What a model has lost and how many pixels a preset allows to differ are told (1); the canvas of the
    // adapter's own rasterizer went for it.
    ("crates/page", 21_900),
    ("crates/window", 3_500),
    // Plain looks, New, and what the picture of a model offers.
    // The menu Help with the guide (8), folders in dialogs and sheets of sweeps (5), who pins options,
    // tiers that are the same, times of a picture in several sizes (6). Paid in part: contact sheets
    // left src/cli (6), and numbers per million the folder of accuracy (1).
    // Where the pointer is, for effects (1), paid by crates/model.
    // The editor indents and keeps its line numbers in view; f32 errors of built-in effects (3). A
    // phone's one menu and handles, and the address of a page (3).
    // What a file lost is told in the toast, rates as fractions (2), paid by studio's Rust.
    // What a file lost is told in the toast, rates as fractions (2), paid by studio's Rust.
    ("src/app", 1_321_500),
    // Vertex effects beyond their meters, and what to do about steps of image effects (1).
    // Faulty files of a folder of shaders are told (0.1), paid by crates/model.
    ("src/cli", 225_000),
    // Random presets and the cases that need code, which the product had: crates/bench lost 322 KB.
    // Far cameras, pictures of few pixels and long chains of passes (4).
    ("fuzz", 289_500),
    ("tests/common", 18_000),
    // Random programs with conversions on the adapter and in the evaluator (4); extremes of passes (3).
    // Points and lines beside a face, with effects and picking (3).
    ("tests/exact", 309_500),
    // What files hold is tried in tables: 59 KB of transcripts and tables stand in files beside the tests.
    // First looks at models (8).
    // Rates, tags of color and the help of commands (2).
    // f32 errors of built-in effects (2).
    // The formulas of studio are asked of its text (13), which crates/model did (10). An effect that is
    // added, films with the clock, the guide, Kuwahara, reaches and bounds of vertices (16); twins of
    // effects without Rust went (5).
    // Clouds of text and of surveys (4), compressed ones, their colors, lines of glTF, plain clouds (6). Effects at every edge (7), paid by studio's Rust.
    ("tests/house", 696_500),
    // Another program on the display, with which the clipboard is shared (5).
    // An effect more in the window's list (0.3), paid by crates/model.
    ("tests/lab", 365_000),
    // Five more effects of other people, which move with the clock.
    ("tests/picture", 285_000),
];

/// Files and bytes of WGSL in `shaders`: with what effects declare of their parameters, which Rust
/// did, the reach of two (0.5), meters between two depths (1), what explains studio (1), points (6) and lines (2).
const SHADERS: (usize, u64) = (178, 484_000);

/// Packages in `Cargo.lock`, of all platforms. The clipboard of the system costs none: the feature `arboard` of egui-winit
/// alone stands there already, and compiles arboard and wl-clipboard-rs with it. `clipboard` has smithay-clipboard too, with
/// six more, for Wayland without the protocol of clipboard managers; there arboard goes through Xwayland. `laz` came for
/// console_error_panic_hook, which three words of web-sys do.
const PACKAGES: usize = 440;

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
