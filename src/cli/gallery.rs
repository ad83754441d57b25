//! `gallery`: the tables of hero presets and of effects in the README. Their pictures are the
//! goldens.

use super::{
    args::Gallery,
    error::{CliError, Exit},
    files,
    streams::Streams,
};
use crate::{
    effects::{EFFECTS, Effect},
    preset_file::{self, BUILTIN_DIR, Existing, PresetFile},
};

/// The tag of the presets that come first.
pub const HERO: &str = "hero";

/// The lines before and after the table.
pub const MARKERS: [&str; 2] = [
    "<!-- gallery: rasterlab gallery --into README.md -->",
    "<!-- end of gallery -->",
];

pub fn run(args: &Gallery, streams: &mut Streams) -> Result<Exit, CliError> {
    let table = table();
    let Some(path) = &args.into else {
        streams.text(&table)?;
        return Ok(Exit::Done);
    };
    let shown = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|e| CliError::from(e).during(format!("{shown} cannot be read")))?;
    let new = replaced(&text, &table).ok_or_else(|| {
        CliError::usage(format!(
            "{shown} has no gallery markers; add the lines {:?} and {:?}",
            MARKERS[0], MARKERS[1]
        ))
    })?;
    if new != text {
        files::write(path, new.as_bytes(), Existing::Replace)?;
    }
    streams.note(&format!(
        "{shown}: {}",
        if new == text {
            "the gallery is up to date"
        } else {
            "the gallery was updated"
        }
    ));
    Ok(Exit::Done)
}

/// `text` with the table between its markers; none without markers.
pub fn replaced(text: &str, table: &str) -> Option<String> {
    let begin = text.find(MARKERS[0])? + MARKERS[0].len();
    let end = begin + text[begin..].find(MARKERS[1])?;
    Some(format!("{}\n{table}{}", &text[..begin], &text[end..]))
}

/// Three hero presets per row, each with its picture, name, id and sentence; then three effects per
/// row, each with picture, name, hooks, description and further presets.
pub fn table() -> String {
    let mut preset_files: Vec<String> = BUILTIN_DIR
        .files()
        .filter_map(|file| Some(file.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    preset_files.sort();
    let heroes: Vec<String> = heroes().iter().map(hero_cell).collect();
    let effects: Vec<String> = EFFECTS
        .iter()
        .map(|effect| cell(effect, &preset_files))
        .collect();
    let rows = |cells: &[String]| {
        cells
            .chunks(3)
            .map(|row| format!("<tr>\n{}</tr>\n", row.concat()))
            .collect::<String>()
    };
    format!("<table>\n{}{}</table>\n", rows(&heroes), rows(&effects))
}

/// The built-in presets that are tagged as heroes, by id.
pub fn heroes() -> Vec<PresetFile> {
    let parsed = BUILTIN_DIR.files().filter_map(|file| {
        let (id, text) = (
            file.path().file_stem()?.to_string_lossy().into_owned(),
            file.contents_utf8()?,
        );
        preset_file::parse_file(text, &id, &id).ok()
    });
    let mut heroes: Vec<PresetFile> = parsed
        .filter(|preset_file| preset_file.preset.tags.iter().any(|tag| tag == HERO))
        .collect();
    heroes.sort_by(|a, b| a.id.cmp(&b.id));
    heroes
}

fn hero_cell(preset_file: &PresetFile) -> String {
    let (id, title, about) = (
        &preset_file.id,
        preset_file.title(),
        &preset_file.preset.about,
    );
    format!(
        "<td valign=\"top\"><img src=\"tests/snapshots/{id}.png\" width=\"260\" alt=\"{id}\"><br><b>{title}</b> <sub>{id}</sub><br>{about}</td>\n"
    )
}

fn cell(effect: &Effect, preset_files: &[String]) -> String {
    let name = &effect.name;
    let is_further = |id: &str| id != name && id.starts_with(&format!("{name}-"));
    let further: Vec<String> = preset_files
        .iter()
        .filter(|id| is_further(id))
        .map(|id| format!("<a href=\"tests/snapshots/{id}.png\">{id}</a>"))
        .collect();
    let further = if further.is_empty() {
        String::new()
    } else {
        format!("<br><sub>also {}</sub>", further.join(", "))
    };
    format!(
        "<td valign=\"top\"><img src=\"tests/snapshots/{name}.png\" width=\"260\" alt=\"{name}\"><br><b>{name}</b> <sub>{}</sub><br>{}{further}</td>\n",
        effect.hooks.names(),
        effect.about,
    )
}
