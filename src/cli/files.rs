//! Files that commands write: names from templates; nothing is overwritten without `--force`.

use std::{
    io::Read as _,
    path::{Path, PathBuf},
};

use super::error::CliError;
use crate::preset_file::{self, Existing, PresetError, is_taken};

/// Longest text taken from stdin, bytes.
const MAX_STDIN: u64 = 1 << 20;

/// Largest number of a numbered file, so that the search for a free one ends.
const MAX_NUMBER: usize = 999_999;

/// What the placeholders of a template stand for.
#[derive(Clone, Debug, Default)]
pub struct Names {
    pub preset: String,
    pub effect: String,
    pub adapter: String,
    pub tier: String,
    /// Number of a frame, where there are frames.
    pub frame: Option<u32>,
}

/// All of stdin as text.
pub fn stdin_text() -> Result<String, CliError> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .take(MAX_STDIN + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_STDIN {
        return Err(CliError::usage("stdin: the preset is longer than 1 MiB"));
    }
    String::from_utf8(bytes).map_err(|_| CliError::usage("stdin: the preset is not UTF-8 text"))
}

/// Refuses a name for a picture that says it is no PNG.
pub fn check_picture_name(template: &str) -> Result<(), CliError> {
    match Path::new(template).extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => Err(CliError::usage(format!(
            "{template}: pictures are written as PNG; give the file a name that ends with .png"
        ))),
        _ => Ok(()),
    }
}

/// The file that `template` names: with `{n}` the first free number, otherwise a file that is free
/// or may be overwritten.
pub fn target(template: &str, names: &Names, force: bool) -> Result<PathBuf, CliError> {
    if has_number(template)? {
        return free_number(template, names, 1).map(|(_, path)| path);
    }
    let path = PathBuf::from(expand(template, names, 0)?);
    if is_taken(&path) && !force {
        return Err(exists(&path));
    }
    Ok(path)
}

/// Writes the whole file or nothing under the name that `template` gives, and returns it. A file
/// that another process wrote in the meantime stays: with `{n}` the next free number is taken.
pub fn create(
    template: &str,
    names: &Names,
    force: bool,
    bytes: &[u8],
) -> Result<PathBuf, CliError> {
    if !has_number(template)? {
        let path = PathBuf::from(expand(template, names, 0)?);
        write(
            &path,
            bytes,
            if force {
                Existing::Replace
            } else {
                Existing::Keep
            },
        )?;
        return Ok(path);
    }
    let mut from = 1;
    loop {
        let (n, path) = free_number(template, names, from)?;
        match preset_file::write_atomically(&path, bytes, Existing::Keep) {
            Err(PresetError::Exists { .. }) => from = n + 1,
            written => return Ok(written.map(|()| path)?),
        }
    }
}

/// The first number from `from` up whose name is free, with its file.
fn free_number(template: &str, names: &Names, from: usize) -> Result<(usize, PathBuf), CliError> {
    for n in from..=MAX_NUMBER {
        let path = PathBuf::from(expand(template, names, n)?);
        if !is_taken(&path) {
            return Ok((n, path));
        }
    }
    Err(CliError::usage(format!(
        "{template}: every number up to {MAX_NUMBER} is taken"
    )))
}

fn exists(path: &Path) -> CliError {
    CliError::usage(format!(
        "{} exists; use --force to overwrite it, or {{n}} in the name to number files",
        path.display()
    ))
}

/// The file of a frame of a sequence; it may exist.
pub fn frame_path(template: &str, names: &Names) -> Result<PathBuf, CliError> {
    Ok(PathBuf::from(expand(template, names, 0)?))
}

/// Does the template name the frame?
pub fn has_frame(template: &str) -> Result<bool, CliError> {
    Ok(parts(template)?
        .iter()
        .any(|part| matches!(part, TemplatePart::Placeholder { name: "frame", .. })))
}

/// Writes the whole file or nothing.
pub fn write(path: &Path, bytes: &[u8], existing: Existing) -> Result<(), CliError> {
    preset_file::write_atomically(path, bytes, existing).map_err(|error| match error {
        PresetError::Exists { .. } => exists(path),
        error => error.into(),
    })
}

/// Does the template number files?
pub fn has_number(template: &str) -> Result<bool, CliError> {
    Ok(parts(template)?
        .iter()
        .any(|part| matches!(part, TemplatePart::Placeholder { name: "n", .. })))
}

/// Does the template name the preset?
pub fn has_preset(template: &str) -> Result<bool, CliError> {
    Ok(parts(template)?
        .iter()
        .any(|part| matches!(part, TemplatePart::Placeholder { name: "preset", .. })))
}

enum TemplatePart<'a> {
    Text(String),
    Placeholder { name: &'a str, width: usize },
}

fn expand(template: &str, names: &Names, n: usize) -> Result<String, CliError> {
    let parts = parts(template)?;
    if names.frame.is_none() && has_frame(template)? {
        return Err(CliError::usage(format!(
            "{template}: {{frame}} is for the command sequence only"
        )));
    }
    let text = |part: TemplatePart<'_>| match part {
        TemplatePart::Text(text) => text,
        TemplatePart::Placeholder {
            name: "frame",
            width,
        } => format!("{:0width$}", names.frame.unwrap_or_default()),
        TemplatePart::Placeholder { name: "preset", .. } => safe(&names.preset),
        TemplatePart::Placeholder { name: "effect", .. } => safe(&names.effect),
        TemplatePart::Placeholder {
            name: "adapter", ..
        } => safe(&names.adapter),
        TemplatePart::Placeholder { name: "tier", .. } => safe(&names.tier),
        TemplatePart::Placeholder { width, .. } => format!("{n:0width$}"),
    };
    Ok(parts.into_iter().map(text).collect())
}

/// A name without path separators and other special characters.
fn safe(name: &str) -> String {
    let kept: String = name
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || "-_.+".contains(c) {
                c
            } else {
                '-'
            }
        })
        .collect();
    kept.trim_matches(['-', '.']).to_owned()
}

fn parts(template: &str) -> Result<Vec<TemplatePart<'_>>, CliError> {
    let (mut parts, mut rest) = (Vec::new(), template);
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        parts.push(TemplatePart::Text(before.to_owned()));
        if from.starts_with("{{") || from.starts_with("}}") {
            parts.push(TemplatePart::Text(from[..1].to_owned()));
            rest = &from[2..];
            continue;
        }
        let wrong = || {
            CliError::usage(format!(
                "{template}: unknown placeholder; use {{preset}}, {{effect}}, {{n}}, {{n:3}}, {{frame:4}}, {{adapter}} or {{tier}}, and double a brace to write it"
            ))
        };
        let (placeholder, after) = from
            .strip_prefix('{')
            .and_then(|from| from.split_once('}'))
            .ok_or_else(wrong)?;
        let (name, width) = placeholder.split_once(':').unwrap_or((placeholder, "0"));
        let width = width
            .parse()
            .ok()
            .filter(|width| *width <= 9)
            .ok_or_else(wrong)?;
        if !["preset", "effect", "adapter", "tier", "n", "frame"].contains(&name)
            || (width > 0 && !["n", "frame"].contains(&name))
        {
            return Err(wrong());
        }
        parts.push(TemplatePart::Placeholder { name, width });
        rest = after;
    }
    parts.push(TemplatePart::Text(rest.to_owned()));
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Names {
        Names {
            preset: "facet".into(),
            effect: "facet+lambert".into(),
            adapter: "llvmpipe (LLVM 15/256)".into(),
            tier: "fast".into(),
            frame: None,
        }
    }

    #[test]
    fn templates_are_filled_in() {
        let filled = |template| expand(template, &names(), 7).unwrap();
        assert_eq!(filled("{preset}_{n:3}.png"), "facet_007.png");
        assert_eq!(filled("{{{tier}}}-{n}-{effect}"), "{fast}-7-facet+lambert");
        assert_eq!(filled("{adapter}.png"), "llvmpipe--LLVM-15-256.png");
        let seventh = Names {
            frame: Some(7),
            ..names()
        };
        assert_eq!(
            expand("{preset}/{frame:4}-{frame}.png", &seventh, 0).unwrap(),
            "facet/0007-7.png"
        );
        for wrong in ["{frame}", "{preset", "a}b", "{tier:3}", "{n:x}"] {
            assert!(expand(wrong, &names(), 0).is_err(), "{wrong}");
        }
    }

    #[test]
    fn nothing_is_overwritten_without_force() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
        std::fs::write(at("a.png"), "x").unwrap();
        std::fs::write(at("b_1.png"), "x").unwrap();
        assert!(target(&at("a.png"), &names(), false).is_err());
        assert_eq!(
            target(&at("a.png"), &names(), true).unwrap(),
            PathBuf::from(at("a.png"))
        );
        assert_eq!(
            target(&at("b_{n}.png"), &names(), false).unwrap(),
            PathBuf::from(at("b_2.png"))
        );
    }
}
