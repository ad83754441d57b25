//! Messages that quote files of anyone, made safe to show.

use std::borrow::Cow;

/// Stands for the backslash that is the second byte of a character of another encoding, and so
/// separates no folders.
const SECOND_BACKSLASH: char = '\u{f05c}';

/// Text of a file of anyone. Bytes that are not UTF-8 are of an encoding that nobody names: each
/// becomes the character of its number, so that names stay distinct and still tell the bytes of the
/// file that they name.
pub fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => {
            let mut is_second = false;
            let character = |&byte: &u8| {
                let of_pair = is_second;
                is_second = !is_second && byte > 0x80;
                match byte {
                    b'\\' if of_pair => SECOND_BACKSLASH,
                    byte => byte.into(),
                }
            };
            bytes.iter().map(character).collect()
        }
    }
}

/// `1234567` as `1,234,567`.
pub fn group_digits(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Most characters of a message that quotes a file.
const MAX_CHARS: usize = 1000;
/// Of a longer one: how many of its first and of its last characters are shown. The last say what
/// is allowed.
const SHOWN_CHARS: [usize; 2] = [300, 500];

/// A message about a file of anyone, made safe to show: characters that steer a terminal, reorder
/// text or cannot be seen are written as `\u{1b}`, and the middle of a long one is left out. Line
/// breaks stay, for the line of an effect file that a message shows.
pub fn legible(message: &str) -> String {
    let mut shown = String::with_capacity(message.len());
    for c in message.chars() {
        if c == '\n' || !is_hidden(c) {
            shown.push(c)
        } else {
            shown.extend(c.escape_unicode())
        }
    }
    let count = shown.chars().count();
    if count <= MAX_CHARS {
        return shown;
    }
    let [first, last] = SHOWN_CHARS;
    let begin: String = shown.chars().take(first).collect();
    let end: String = shown.chars().skip(count - last).collect();
    format!("{begin} … {end}")
}

/// As [`legible`], in one line.
pub fn legible_line(message: &str) -> String {
    legible(&message.replace('\n', "\\n"))
}

/// Does the character steer a terminal, reorder text, or take no room?
pub fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}'
                | '\u{61c}'
                | '\u{115f}'
                | '\u{1160}'
                | '\u{180e}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{3164}'
                | '\u{feff}'
                | '\u{ffa0}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

/// At most `most` characters of a name, with those that are [hidden](is_hidden) written out.
pub fn legible_name(name: &str, most: usize) -> String {
    let mut shown = String::new();
    for c in name.chars() {
        if is_hidden(c) {
            shown.extend(c.escape_unicode());
        } else {
            shown.push(c);
        }
        if shown.len() > 4 * most {
            break;
        }
    }
    shown.chars().take(most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_another_encoding_stay_distinct_and_text_stays_as_it_is() {
        assert_eq!(text_of("a \u{7ea2}".as_bytes()), "a \u{7ea2}");
        let [red, black] = [&b"\xba\xec.png"[..], b"\xba\xda.png"].map(text_of);
        assert_eq!(
            [&red[..], &black[..]],
            ["\u{ba}\u{ec}.png", "\u{ba}\u{da}.png"]
        );
        // A separator of folders is one byte, and so is no part of a pair.
        assert_eq!(
            text_of(b"\x95\\\x8e\x86\\a"),
            "\u{95}\u{f05c}\u{8e}\u{86}\\a"
        );
    }

    #[test]
    fn what_steers_a_terminal_or_reorders_text_is_written_out() {
        assert_eq!(
            legible("a\u{1b}[2J\u{202e}b\nc é"),
            "a\\u{1b}[2J\\u{202e}b\nc é"
        );
        assert_eq!(legible_line("a\nb"), "a\\nb");
        assert_eq!(
            legible_name("Ä\u{2066}\u{200b}b\nc", 22),
            "Ä\\u{2066}\\u{200b}b\\u{a"
        );
    }

    #[test]
    fn of_a_long_message_begin_and_end_are_shown() {
        let shown = legible(&format!("begin {}\0 end", "x".repeat(100_000)));
        assert!(
            shown.starts_with("begin x") && shown.ends_with("x\\u{0} end") && shown.contains(" … ")
        );
        assert_eq!(shown.chars().count(), 803);
    }
}
