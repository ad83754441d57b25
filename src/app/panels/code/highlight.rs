//! The colors of WGSL text.

use egui::{Color32, FontId, TextFormat, text::LayoutJob};

use crate::app::widgets::theme;

/// Words of the language, types among them.
const WORDS: &[&str] = &[
    "alias",
    "array",
    "bool",
    "break",
    "case",
    "const",
    "const_assert",
    "continue",
    "continuing",
    "default",
    "discard",
    "else",
    "f16",
    "f32",
    "false",
    "fn",
    "for",
    "i32",
    "if",
    "let",
    "loop",
    "mat2x2f",
    "mat3x3f",
    "mat4x4f",
    "override",
    "return",
    "struct",
    "switch",
    "true",
    "u32",
    "var",
    "vec2f",
    "vec2i",
    "vec2u",
    "vec3f",
    "vec3i",
    "vec3u",
    "vec4f",
    "vec4i",
    "vec4u",
    "while",
];

/// What a piece of text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Plain,
    Comment,
    Word,
    Number,
    /// `@` and the name behind it.
    Attribute,
}

/// The text as pieces that follow each other without a gap.
fn pieces(text: &str) -> Vec<(Kind, &str)> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let length_while = |from: usize, is_in: &dyn Fn(char) -> bool| {
            rest[from..]
                .find(|c| !is_in(c))
                .map_or(rest.len(), |length| from + length)
        };
        let (kind, length) = if rest.starts_with("//") {
            (Kind::Comment, rest.find('\n').unwrap_or(rest.len()))
        } else if rest.starts_with("/*") {
            let end = rest.find("*/").map_or(rest.len(), |at| at + 2);
            (Kind::Comment, end)
        } else if first == '@' {
            (Kind::Attribute, length_while(1, &is_name))
        } else if first.is_ascii_digit() {
            (Kind::Number, length_while(0, &|c| is_name(c) || c == '.'))
        } else if is_name(first) {
            let length = length_while(0, &is_name);
            let is_word = WORDS.binary_search(&&rest[..length]).is_ok();
            (if is_word { Kind::Word } else { Kind::Plain }, length)
        } else {
            (Kind::Plain, first.len_utf8())
        };
        let (piece, after) = rest.split_at(length);
        pieces.push((kind, piece));
        rest = after;
    }
    pieces
}

/// The text laid out in one long line for each of its lines.
pub fn layout(text: &str, font: &FontId) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (kind, piece) in pieces(text) {
        let color: Color32 = match kind {
            Kind::Plain => theme::text_strong(),
            Kind::Comment => theme::text_weak(),
            Kind::Word => theme::accent(),
            Kind::Number => theme::green(),
            Kind::Attribute => theme::amber(),
        };
        job.append(piece, 0.0, TextFormat::simple(font.clone(), color));
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_the_text_and_know_their_kind() {
        assert!(WORDS.is_sorted());
        let text = "@range(0.5, 2)\nlet größe = vec2f(1e3, -0x1Fu); // é /* no */\n/* open";
        let found = pieces(text);
        assert_eq!(
            found.iter().map(|(_, piece)| *piece).collect::<String>(),
            text
        );
        for expected in [
            (Kind::Attribute, "@range"),
            (Kind::Number, "0.5"),
            (Kind::Word, "let"),
            (Kind::Plain, "größe"),
            (Kind::Word, "vec2f"),
            (Kind::Number, "0x1Fu"),
            (Kind::Comment, "// é /* no */"),
            (Kind::Comment, "/* open"),
        ] {
            assert!(found.contains(&expected), "{expected:?} in {found:?}");
        }
    }
}
