//! Files that commands write: names from templates, nothing overwritten unasked.

use std::{
    io::Read as _,
    path::{Path, PathBuf},
};

use super::fault::Fault;
use crate::preset_file;

/// Longest text taken from stdin, bytes.
const MAX_STDIN: u64 = 1 << 20;

/// What a template may name.
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
pub fn stdin_text() -> Result<String, Fault> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().take(MAX_STDIN + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_STDIN {
        return Err(Fault::usage("stdin: a preset is at most 1 MiB"));
    }
    String::from_utf8(bytes).map_err(|_| Fault::usage("stdin: a preset is UTF-8 text"))
}

/// The file that `template` means: the first free number for `{n}`, and otherwise a name that is free or may be overwritten.
pub fn target(template: &str, names: &Names, force: bool) -> Result<PathBuf, Fault> {
    if has_number(template)? {
        // Counting up is bounded so that a full disk of pictures ends in a sentence.
        for n in 1..1_000_000 {
            let path = PathBuf::from(expand(template, names, n)?);
            if !path.exists() {
                return Ok(path);
            }
        }
        return Err(Fault::usage(format!("{template}: no number is free")));
    }
    let path = PathBuf::from(expand(template, names, 0)?);
    if path.exists() && !force {
        return Err(Fault::usage(format!("{} exists; --force overwrites it, or name it with {{n}}", path.display())));
    }
    Ok(path)
}

/// The file of a frame of a sequence, taken or not.
pub fn frame_path(template: &str, names: &Names) -> Result<PathBuf, Fault> {
    Ok(PathBuf::from(expand(template, names, 0)?))
}

/// Does the template name the frame?
pub fn has_frame(template: &str) -> Result<bool, Fault> {
    Ok(pieces(template)?.iter().any(|piece| matches!(piece, ClippedTriangle::Place { name: "frame", .. })))
}

/// Writes whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    Ok(preset_file::write_atomically(path, bytes)?)
}

/// Does the template count by itself?
pub fn has_number(template: &str) -> Result<bool, Fault> {
    Ok(pieces(template)?.iter().any(|piece| matches!(piece, ClippedTriangle::Place { name: "n", .. })))
}

/// Does the template name the preset?
pub fn has_preset(template: &str) -> Result<bool, Fault> {
    Ok(pieces(template)?.iter().any(|piece| matches!(piece, ClippedTriangle::Place { name: "preset", .. })))
}

enum ClippedTriangle<'a> {
    Text(String),
    Place { name: &'a str, width: usize },
}

fn expand(template: &str, names: &Names, n: usize) -> Result<String, Fault> {
    let pieces = pieces(template)?;
    if names.frame.is_none() && has_frame(template)? {
        return Err(Fault::usage(format!("{template}: only sequence has frames, and so {{frame}}")));
    }
    let text = |piece: ClippedTriangle<'_>| match piece {
        ClippedTriangle::Text(text) => text,
        ClippedTriangle::Place { name: "frame", width } => format!("{:0width$}", names.frame.unwrap_or_default()),
        ClippedTriangle::Place { name: "preset", .. } => safe(&names.preset),
        ClippedTriangle::Place { name: "effect", .. } => safe(&names.effect),
        ClippedTriangle::Place { name: "adapter", .. } => safe(&names.adapter),
        ClippedTriangle::Place { name: "tier", .. } => safe(&names.tier),
        ClippedTriangle::Place { width, .. } => format!("{n:0width$}"),
    };
    Ok(pieces.into_iter().map(text).collect())
}

/// A name without anything that a path could take for a folder.
fn safe(name: &str) -> String {
    let kept: String = name.chars().map(|c| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' }).collect();
    kept.trim_matches(['-', '.']).to_owned()
}

fn pieces(template: &str) -> Result<Vec<ClippedTriangle<'_>>, Fault> {
    let (mut pieces, mut rest) = (Vec::new(), template);
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        pieces.push(ClippedTriangle::Text(before.to_owned()));
        if from.starts_with("{{") || from.starts_with("}}") {
            pieces.push(ClippedTriangle::Text(from[..1].to_owned()));
            rest = &from[2..];
            continue;
        }
        let wrong = || {
            Fault::usage(format!(
                "{template}: {{preset}}, {{effect}}, {{n}}, {{n:3}}, {{frame:4}}, {{adapter}} and {{tier}} can be filled in; double a brace to write it"
            ))
        };
        let (place, after) = from.strip_prefix('{').and_then(|from| from.split_once('}')).ok_or_else(wrong)?;
        let (name, width) = place.split_once(':').unwrap_or((place, "0"));
        let width = width.parse().ok().filter(|width| *width <= 9).ok_or_else(wrong)?;
        if !["preset", "effect", "adapter", "tier", "n", "frame"].contains(&name) || (width > 0 && !["n", "frame"].contains(&name)) {
            return Err(wrong());
        }
        pieces.push(ClippedTriangle::Place { name, width });
        rest = after;
    }
    pieces.push(ClippedTriangle::Text(rest.to_owned()));
    Ok(pieces)
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
        let seventh = Names { frame: Some(7), ..names() };
        assert_eq!(expand("{preset}/{frame:4}-{frame}.png", &seventh, 0).unwrap(), "facet/0007-7.png");
        for wrong in ["{frame}", "{preset", "a}b", "{tier:3}", "{n:x}"] {
            assert!(expand(wrong, &names(), 0).is_err(), "{wrong}");
        }
    }

    #[test]
    fn nothing_is_overwritten_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
        std::fs::write(at("a.png"), "x").unwrap();
        std::fs::write(at("b_1.png"), "x").unwrap();
        assert!(target(&at("a.png"), &names(), false).is_err());
        assert_eq!(target(&at("a.png"), &names(), true).unwrap(), PathBuf::from(at("a.png")));
        assert_eq!(target(&at("b_{n}.png"), &names(), false).unwrap(), PathBuf::from(at("b_2.png")));
    }
}
