//! Tokens of a WGSL text, with their places. Comments are left out.

/// A word, a number, a text in quotation marks, or one mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    pub text: &'a str,
    /// Byte offset.
    pub offset: usize,
}

impl Token<'_> {
    /// Byte offset behind it.
    pub fn end(&self) -> usize {
        self.offset + self.text.len()
    }

    pub fn is_name(&self) -> bool {
        self.text
            .starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Is it part of a name or a number?
fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Bytes that a comment at the start of `text` takes, none without one, and whether it is closed.
/// Block comments nest; an open one goes to the end.
fn comment(text: &str) -> Option<(usize, bool)> {
    if text.starts_with("//") {
        return Some((text.find('\n').unwrap_or(text.len()), true));
    }
    if !text.starts_with("/*") {
        return None;
    }
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            depth += 1;
            at += 2;
        } else if rest.starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return Some((at, true));
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    Some((text.len(), false))
}

/// Bytes of a text in quotation marks at the start of `text`, none without one that ends in its line.
fn quoted(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('"')?;
    let end = rest.find(['"', '\n'])?;
    rest[end..].starts_with('"').then_some(end + 2)
}

/// Where a block comment begins that has no end.
pub fn open_comment(text: &str) -> Option<usize> {
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        match comment(rest) {
            Some((_, false)) => return Some(at),
            Some((length, true)) => at += length,
            None => at += quoted(rest).unwrap_or(rest.chars().next().map_or(1, char::len_utf8)),
        }
    }
    None
}

/// The tokens of `text`.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        if let Some((length, _)) = comment(&text[at..]) {
            at += length;
            continue;
        }
        let rest = &text[at..];
        let length = if is_word(first) {
            let is_number = first.is_ascii_digit();
            rest.find(|c: char| !(is_word(c) || (is_number && c == '.')))
                .unwrap_or(rest.len())
        } else {
            quoted(rest).unwrap_or(first.len_utf8())
        };
        let is_mark_of_order = at == 0 && first == '\u{feff}';
        if !first.is_whitespace() && !is_mark_of_order {
            found.push(Token {
                text: &rest[..length],
                offset: at,
            });
        }
        at += length;
    }
    found
}

/// Index of the mark that closes the one at `open`, or of the last token if none does.
pub fn closing(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "{" | "[" => depth += 1,
            ")" | "}" | "]" => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return index;
                }
            }
            _ => {}
        }
    }
    tokens.len().saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_left_out_and_offsets_are_bytes() {
        let text = "fn a /* b /* c */ d */ (x: f32) // é\n{ 1.5e3; }";
        let words: Vec<&str> = tokens(text).iter().map(|token| token.text).collect();
        assert_eq!(
            words,
            ["fn", "a", "(", "x", ":", "f32", ")", "{", "1.5e3", ";", "}"]
        );
        assert!(
            tokens(text)
                .iter()
                .all(|token| &text[token.offset..token.end()] == token.text)
        );
    }
}
