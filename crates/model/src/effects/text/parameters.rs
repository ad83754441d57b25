//! Parameters: the struct of an effect file as fields of the registry. Documentation stands in the
//! comment above a member, and type, range, unit, default and widget in its attributes.

use std::{collections::BTreeSet, ops::Range, sync::Arc};

use super::{
    attributes::{self, Attribute},
    error::{EffectError, Text},
    member::{Member, condition},
    tokens::{Token, closing},
    words,
};
use crate::{
    effects::{constant_name, given::GivenMember},
    params::{Field, ValueType, WgslType},
};

/// Longest name of a parameter.
const MAX_NAME_CHARS: usize = 40;
/// Most members of the struct.
const MAX_MEMBERS: usize = 64;
/// Names that preset files use beside those of parameters.
const RESERVED: [&str; 2] = ["effect", "on"];

/// The struct of an effect's parameters.
#[derive(Debug)]
pub struct Parameters {
    pub fields: Vec<Arc<Field>>,
    /// Members that are pictures, in order.
    pub images: Vec<NamedImage>,
    /// Members that the lab fills in.
    pub given: Vec<GivenMember>,
    /// Parameter words with every default.
    pub defaults: Vec<u32>,
    /// Byte ranges of attributes, which WGSL does not know.
    pub attributes: Vec<Range<usize>>,
}

/// A member of the struct that is a picture.
#[derive(Debug)]
pub struct NamedImage {
    /// Name of the member.
    pub member: String,
    /// Byte offset of the member in the struct.
    pub offset: usize,
    /// Bytes of the text that are the name of the picture, in quotation marks.
    pub named: Range<usize>,
}

/// Reads the members between the braces of a struct; `open` is the index of the opening one.
///
/// # Errors
/// A member of a type that no parameter has, an unknown or contradictory attribute, or a range
/// without its default.
pub fn read(text: &Text<'_>, tokens: &[Token<'_>], open: usize) -> Result<Parameters, EffectError> {
    let close = closing(tokens, open);
    let (mut fields, mut defaults, mut ranges) = (Vec::<Field>::new(), Vec::new(), Vec::new());
    let mut conditions = Vec::new();
    let (mut images, mut given) = (Vec::<NamedImage>::new(), Vec::<GivenMember>::new());
    let mut at = open + 1;
    while at < close {
        let first = tokens[at];
        let attributes = attributes_before(text, tokens, &mut at, close)?;
        ranges.extend(
            attributes
                .iter()
                .map(|attribute| attribute.begin..attribute.end),
        );
        let (name, types) = name_and_type(text, tokens, first, at, close)?;
        at = types.end + 1;
        check_name(text, name)?;
        let mut names = fields.iter().map(|field| &field.name);
        if names.any(|other| other == name.text)
            || images.iter().any(|image| image.member == name.text)
            || given.iter().any(|member| member.name == name.text)
        {
            let message = format!("the parameter {} is declared twice", name.text);
            return Err(text.at(name, message));
        }
        if fields.len() == MAX_MEMBERS {
            let message = format!("an effect has at most {MAX_MEMBERS} parameters");
            return Err(text.at(name, message));
        }
        let kind = &text.text[tokens[types.start].offset..tokens[types.end - 1].end()];
        let member = Member {
            text,
            name,
            kind,
            attributes: &attributes,
        };
        if let Some(image) = member.attribute("image") {
            let named = member.image(image, images.len())?;
            images.push(NamedImage {
                member: name.text.into(),
                offset: 4 * defaults.len(),
                named,
            });
            defaults.push(images.len() as u32 - 1);
            continue;
        }
        if let Some(attribute) = member.attribute("given") {
            let found = member.given(attribute)?;
            let words = found.wgsl().words();
            let offset = (4 * defaults.len()).next_multiple_of(4 * words);
            defaults.resize(offset / 4 + words, 0);
            given.push(GivenMember {
                name: name.text.into(),
                offset,
                given: found,
            });
            continue;
        }
        let (param, wgsl, numbers) = member.param(&documentation(text.text, first.offset))?;
        let offset = (4 * defaults.len()).next_multiple_of(4 * wgsl.words());
        defaults.resize(offset / 4 + wgsl.words(), 0);
        let field = Field::new(param, wgsl, offset);
        field
            .set(&mut defaults, &numbers)
            .map_err(|error| member.error(format!("the default of {}: {error}", name.text)))?;
        fields.push(field);
        let when = attributes.into_iter().find(|other| other.name == "when");
        conditions.extend(when.map(|when| (fields.len() - 1, when)));
    }
    for (at, when) in conditions {
        fields[at].param.when = Some(condition(text, &when, &fields)?);
    }
    if fields.is_empty() && images.is_empty() && given.is_empty() {
        return Err(text.error(
            tokens[open].offset,
            1,
            "the struct of an effect's parameters needs at least one member",
        ));
    }
    let has_vectors = fields.iter().any(|field| field.wgsl == WgslType::Vec4F32)
        || given
            .iter()
            .any(|member| member.given.wgsl() == WgslType::Vec4F32);
    let align = if has_vectors { 4 } else { 1 };
    defaults.resize(defaults.len().next_multiple_of(align), 0);
    Ok(Parameters {
        fields: fields.into_iter().map(Arc::new).collect(),
        images,
        given,
        defaults,
        attributes: ranges,
    })
}

/// The attributes before a member; `at` goes on to what follows them.
fn attributes_before<'a>(
    text: &Text<'a>,
    tokens: &[Token<'a>],
    at: &mut usize,
    close: usize,
) -> Result<Vec<Attribute<'a>>, EffectError> {
    let mut attributes: Vec<Attribute<'_>> = Vec::new();
    while *at < close && tokens[*at].text == "@" {
        let (attribute, behind) = attributes::read(text, tokens, *at)?;
        attributes::check_name(text, &attribute)?;
        if attributes.iter().any(|other| other.name == attribute.name) {
            let message = format!("@{} stands twice before one parameter", attribute.name);
            return Err(attribute.error(text, message));
        }
        attributes.push(attribute);
        *at = behind;
    }
    Ok(attributes)
}

/// The name at `at` of the member that begins with `first`, and the indices of its type, which is not empty.
fn name_and_type<'a>(
    text: &Text<'a>,
    tokens: &[Token<'a>],
    first: Token<'a>,
    at: usize,
    close: usize,
) -> Result<(Token<'a>, Range<usize>), EffectError> {
    let name = tokens.get(at).copied().filter(Token::is_name);
    let (Some(name), Some(colon)) = (name, tokens.get(at + 1)) else {
        return Err(text.error(first.offset, 1, "a parameter has the form name: type"));
    };
    let end = (at + 2..close)
        .find(|&index| tokens[index].text == ",")
        .unwrap_or(close);
    if colon.text != ":" || end <= at + 2 {
        return Err(text.at(name, format!("the parameter {} needs a type", name.text)));
    }
    let mut types = tokens[at + 2..end].iter();
    if let Some(token) = types.find(|token| [":", ";", "@"].contains(&token.text)) {
        let message = format!("expected , between parameters, and found {}", token.text);
        return Err(text.at(token, message));
    }
    Ok((name, at + 2..end))
}

/// Refuses names that presets, the command line or WGSL could not write.
fn check_name(text: &Text<'_>, name: Token<'_>) -> Result<(), EffectError> {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_plain = name.text.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.text.chars().all(is_letter);
    let message = if !is_plain || name.text.len() > MAX_NAME_CHARS {
        format!(
            "the name of a parameter begins with a letter and has at most {MAX_NAME_CHARS} letters a to z, digits and _"
        )
    } else if words::is_reserved(name.text) {
        format!(
            "{} is a reserved word of WGSL; give the parameter another name",
            name.text
        )
    } else if RESERVED.contains(&name.text) {
        format!(
            "a preset uses {} itself; give the parameter another name",
            name.text
        )
    } else {
        return Ok(());
    };
    Err(text.at(name, message))
}

/// The constants that the choices of an effect called `stem` are given: `INK_MODE_DOTS`.
///
/// # Errors
/// Two choices make the same name.
pub fn constants(
    text: &Text<'_>,
    stem: &str,
    parameters: &Parameters,
) -> Result<BTreeSet<String>, EffectError> {
    let mut constants = BTreeSet::new();
    for field in &parameters.fields {
        let ValueType::Choice(words) = &field.value_type else {
            continue;
        };
        for word in words {
            let name = constant_name(stem, &field.name, word);
            if constants.contains(&name) {
                return Err(
                    text.whole(format!("two words of choices both have the constant {name}; change a word or the name of a parameter"))
                );
            }
            constants.insert(name);
        }
    }
    Ok(constants)
}

/// The comment lines directly above byte `offset`, joined.
fn documentation(text: &str, offset: usize) -> String {
    let before = &text[..offset];
    let begin = before.rfind('\n').map_or(0, |at| at + 1);
    let mut lines: Vec<&str> = Vec::new();
    for line in before[..begin].lines().rev() {
        let Some(comment) = line
            .trim()
            .strip_prefix("//")
            .filter(|comment| !comment.starts_with('@'))
        else {
            break;
        };
        lines.push(comment.trim_start_matches(['/', '!']).trim());
    }
    lines.reverse();
    lines.join(" ").trim().chars().take(400).collect()
}
