//! Promise: every mistake that a test makes in a shader replaces text that stands there exactly once. The tests that draw with the
//! mistakes insist on it too, but take minutes and an adapter to say so.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::shader_parts;

/// String literals and everything between them, comments left out.
#[derive(Debug, PartialEq)]
enum Token {
    Text(String),
    Code(String),
}

fn tokens(source: &str) -> Vec<Token> {
    let (mut tokens, mut code) = (Vec::new(), String::new());
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        if rest.starts_with("//") {
            rest = rest.find('\n').map_or("", |end| &rest[end..]);
        } else if rest.starts_with("'\"'") {
            rest = &rest[3..];
        } else if first == '"' {
            let (text, after) = literal(&rest[1..]);
            tokens.extend([Token::Code(std::mem::take(&mut code)), Token::Text(text)]);
            rest = after;
        } else {
            code.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    tokens.push(Token::Code(code));
    tokens
}

/// The literal that `source` begins with, behind its opening quote, and what follows it.
fn literal(source: &str) -> (String, &str) {
    let mut text = String::new();
    let mut chars = source.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        match c {
            '"' => return (text, &source[at + 1..]),
            '\\' => match chars.next() {
                Some((_, 'n')) => text.push('\n'),
                Some((_, '\n')) => while chars.next_if(|(_, c)| c.is_whitespace()).is_some() {},
                Some((_, other)) => text.push(other),
                None => break,
            },
            _ => text.push(c),
        }
    }
    panic!("a literal without an end: {text}");
}

/// Parts of shaders, each with what stands behind it: the text to be replaced.
fn mistakes(source: &str) -> Vec<(String, String)> {
    let is_part = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    let is_file = |text: &str| text.contains('/') && text.split('/').all(is_part) && text != "image/png";
    let found = |window: &[Token]| match window {
        [Token::Text(file), Token::Code(between), Token::Text(from)] if is_file(file) && between.trim() == "," => {
            Some((file.clone(), from.clone()))
        }
        _ => None,
    };
    tokens(source).windows(3).filter_map(found).collect()
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("tests/ can be read") {
        let path = entry.expect("tests/ can be read").path();
        if path.is_dir() {
            sources(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn every_mistake_replaces_text_that_is_there_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    ["exact", "picture", "lab"].iter().for_each(|binary| sources(&root.join("tests").join(binary), &mut files));
    let (mut wrong, mut count) = (Vec::new(), 0);
    for file in files {
        let source = fs::read_to_string(&file).expect("a test can be read");
        for (shader, from) in mistakes(&source) {
            let said = format!("{}: {from:?} in {shader}", file.strip_prefix(root).unwrap_or(&file).display());
            match shader_parts::find(&root.join("shaders"), &shader) {
                Ok((_, text, part)) if text[part.clone()].matches(&from).count() == 1 => count += 1,
                Ok((_, text, part)) => wrong.push(format!("{said}: {} times", text[part].matches(&from).count())),
                Err(error) => wrong.push(format!("{said}: {error}")),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 100, "{count} mistakes were found in the tests");
}

#[test]
fn the_reader_of_mistakes_sees_what_it_should() {
    let source = r#"
        ("what", "lib/fixed", "return \"0\";\n  a", "return 1;"), // "lib/comment", "none"
        mutated("stages/raster/clip", "one \
            line", "b"), '"', ("lib/fixed", rule, "b"), ("a", "b")
    "#;
    let expected = [("lib/fixed", "return \"0\";\n  a"), ("stages/raster/clip", "one line")];
    assert_eq!(mistakes(source), expected.map(|(file, from)| (file.to_owned(), from.to_owned())));
}
