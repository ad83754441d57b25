//! Messages that quote files of anyone, made safe to show.

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
