//! The targets, one for each kind of thing that comes from anyone.

mod command_line;
mod compressed;
mod effect;
mod image;
mod light;
mod mesh;
mod model;
mod picture;
mod preset;
mod share;

use rasterlab::params::is_hidden;

use crate::{guard::Limit, views::View};

/// Something that reads input.
pub struct Target {
    /// Also the name of its folder in the corpus.
    pub name: &'static str,
    /// What it reads, for listings.
    pub about: &'static str,
    /// What is packed inside of its input.
    pub views: &'static [View],
    pub limit: Limit,
    /// Reads the input. Panics, with a sentence, where it is not handled as promised.
    pub check: fn(&[u8]) -> Outcome,
}

/// What became of input: it was accepted, or refused with this text.
pub type Outcome = Result<(), String>;

pub const TARGETS: [Target; 10] = [
    model::TARGET,
    mesh::TARGET,
    image::TARGET,
    light::TARGET,
    compressed::TARGET,
    preset::TARGET,
    share::TARGET,
    picture::TARGET,
    command_line::TARGET,
    effect::TARGET,
];

/// A refusal is one line, short enough to be read, and no panic that somebody caught.
fn assert_told(error: &str) {
    assert!(
        !error.is_empty() && !error.contains('\n'),
        "the refusal is not one line: {error:?}"
    );
    assert!(
        error.chars().count() < 1200,
        "the refusal has {} characters: {error:?}",
        error.chars().count()
    );
    assert!(!error.contains("is a bug"), "a panic was caught: {error}");
    assert!(
        !error.chars().any(is_hidden),
        "the refusal has characters that steer a terminal: {error:?}"
    );
}

/// As [`assert_told`]; the refusal of an effect that came along also shows its line, and a caret
/// below that.
pub fn assert_told_with_place(error: &str) {
    let is_place = |line: &str| {
        line.trim_start_matches(|c: char| c == ' ' || c.is_ascii_digit())
            .starts_with("| ")
    };
    match error.split('\n').collect::<Vec<_>>()[..] {
        [sentence, line, caret]
            if sentence.contains("cannot be used: ") && is_place(line) && is_place(caret) =>
        {
            assert_told(sentence)
        }
        _ => assert_told(error),
    }
}
