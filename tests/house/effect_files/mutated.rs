//! Files made from good ones by changing one token: each is read or refused, and a refusal is told
//! well.

use rasterlab::effect_files::{Hook, template};

use super::{accepted::EXAMPLES, read_ink};

/// Byte ranges of words, numbers and marks.
fn tokens(text: &str) -> Vec<std::ops::Range<usize>> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = match (rest.starts_with("//"), is_word(first)) {
            (true, _) => rest.find('\n').unwrap_or(rest.len()),
            (_, true) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        if !first.is_whitespace() && !rest.starts_with("//") {
            found.push(at..at + length);
        }
        at += length;
    }
    found
}

#[test]
fn a_changed_token_is_refused_in_one_sentence_or_read() {
    let words = [
        "fn",
        "{",
        ")",
        "@",
        "0",
        "-1e39",
        "Surface",
        "\"",
        "é",
        "custom_ink__x",
        ";",
        "<",
        "loop",
    ];
    let (mut refused, mut read, mut faults) = (0, 0, Vec::new());
    let templates = Hook::ALL.map(|hook| template("ink", hook));
    for text in templates.iter().map(String::as_str).chain(EXAMPLES) {
        let tokens = tokens(text);
        for (index, range) in tokens.iter().enumerate() {
            let (before, token, after) = (
                &text[..range.start],
                &text[range.clone()],
                &text[range.end..],
            );
            let other = words[index % words.len()];
            let next = tokens.get(index + 1).map_or("", |next| &text[next.clone()]);
            let changed = [
                format!("{before}{after}"),
                format!("{before}{token} {token}{after}"),
                format!("{before}{other}{after}"),
                format!("{before}{next} {token}{after}"),
                before.to_owned(),
            ];
            for text in changed {
                match std::panic::catch_unwind(|| read_ink(&text).is_ok()) {
                    Ok(true) => read += 1,
                    Ok(false) => refused += 1,
                    Err(panic) => {
                        faults.push(panic.downcast_ref::<String>().cloned().unwrap_or_default())
                    }
                }
            }
        }
    }
    faults.truncate(8);
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    println!("{refused} refused, {read} read");
    assert!(refused > 1000 && read > 0, "{refused} refused, {read} read");
}
