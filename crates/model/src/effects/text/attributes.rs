//! Attributes of a parameter: `@range(0.5, 8.0, 2.0) @unit(px) @log`. They follow the convention of
//! the WESL community's wgsl-play, with the options that parameters of built-in effects have.

use super::{
    error::{EffectError, Text},
    tokens::{Token, closing},
};
use crate::params::did_you_mean;

/// Every attribute that a parameter may have.
pub const NAMES: [&str; 15] = [
    "range", "hard", "soft", "default", "unit", "log", "height", "depth", "color", "point",
    "toggle", "choice", "when", "image", "given",
];

/// `@name(arguments)`.
#[derive(Clone, Debug)]
pub struct Attribute<'a> {
    pub name: &'a str,
    /// The texts between commas, trimmed.
    pub arguments: Vec<&'a str>,
    /// Byte range of the whole attribute.
    pub begin: usize,
    pub end: usize,
}

impl Attribute<'_> {
    /// An error about this attribute.
    pub fn error(&self, text: &Text<'_>, message: impl Into<String>) -> EffectError {
        text.error(self.begin, self.end - self.begin, message)
    }

    /// The arguments as finite numbers, of which there must be `counts.0` to `counts.1`.
    ///
    /// # Errors
    /// Another number of arguments, or one that is no finite number.
    pub fn numbers(
        &self,
        text: &Text<'_>,
        counts: (usize, usize),
        usage: &str,
    ) -> Result<Vec<f64>, EffectError> {
        if !(counts.0..=counts.1).contains(&self.arguments.len()) {
            return Err(self.error(text, format!("@{} takes {usage}", self.name)));
        }
        let number = |argument: &&str| {
            let digits = argument.trim_end_matches(['f', 'h', 'u', 'i']);
            let value = digits
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite() && (*value as f32).is_finite());
            value.ok_or_else(|| {
                self.error(
                    text,
                    format!(
                        "@{}: {argument:?} is no finite number; it takes {usage}",
                        self.name
                    ),
                )
            })
        };
        self.arguments.iter().map(number).collect()
    }
}

/// Reads the attribute at `tokens[at]`, which is `@`; returns it and the index behind it.
///
/// # Errors
/// No name follows, or a parenthesis stays open.
pub fn read<'a>(
    text: &Text<'a>,
    tokens: &[Token<'a>],
    at: usize,
) -> Result<(Attribute<'a>, usize), EffectError> {
    let begin = tokens[at].offset;
    let Some(name) = tokens.get(at + 1).filter(|token| token.is_name()) else {
        return Err(text.error(begin, 1, "an attribute needs a name after @"));
    };
    if tokens.get(at + 2).is_none_or(|token| token.text != "(") {
        return Ok((
            Attribute {
                name: name.text,
                arguments: Vec::new(),
                begin,
                end: name.end(),
            },
            at + 2,
        ));
    }
    let close = closing(tokens, at + 2);
    if tokens[close].text != ")" {
        return Err(text.error(
            begin,
            name.end() - begin,
            format!("the parenthesis of @{} is not closed", name.text),
        ));
    }
    let inner = &text.text[tokens[at + 2].end()..tokens[close].offset];
    let arguments = if inner.trim().is_empty() {
        Vec::new()
    } else {
        inner.split(',').map(str::trim).collect()
    };
    Ok((
        Attribute {
            name: name.text,
            arguments,
            begin,
            end: tokens[close].end(),
        },
        close + 1,
    ))
}

/// Refuses an attribute that no parameter can have.
pub fn check_name(text: &Text<'_>, attribute: &Attribute<'_>) -> Result<(), EffectError> {
    if NAMES.contains(&attribute.name) {
        return Ok(());
    }
    let hint = did_you_mean(attribute.name, NAMES.into_iter());
    Err(attribute.error(
        text,
        format!("@{} is no attribute of a parameter{hint}", attribute.name),
    ))
}
