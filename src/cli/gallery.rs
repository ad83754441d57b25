//! `gallery`: the README's table of effects. Pictures are the goldens, so what it shows is what the lab draws.

use super::{
    args::Gallery,
    fault::{Exit, Fault},
    files,
    streams::Streams,
};
use crate::{
    effects::{EFFECTS, Effect},
    preset_file::BUILTIN_DIR,
};

/// Between these lines the table stands.
pub const MARKS: [&str; 2] = ["<!-- gallery: rasterlab gallery --into README.md -->", "<!-- end of gallery -->"];

pub fn run(args: &Gallery, streams: &mut Streams) -> Result<Exit, Fault> {
    let table = table();
    let Some(path) = &args.into else {
        streams.text(&table)?;
        return Ok(Exit::Done);
    };
    let shown = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| Fault::from(e).during(format!("{shown} cannot be read")))?;
    let new = replaced(&text, &table)
        .ok_or_else(|| Fault::usage(format!("{shown} has no gallery: it needs the lines {:?} and {:?}", MARKS[0], MARKS[1])))?;
    if new != text {
        files::write(path, new.as_bytes())?;
    }
    streams.note(&format!("{shown}: {}", if new == text { "the gallery is up to date" } else { "the gallery is new" }));
    Ok(Exit::Done)
}

/// `text` with the table between its marks; none without marks.
pub fn replaced(text: &str, table: &str) -> Option<String> {
    let begin = text.find(MARKS[0])? + MARKS[0].len();
    let end = begin + text[begin..].find(MARKS[1])?;
    Some(format!("{}\n{table}{}", &text[..begin], &text[end..]))
}

/// Three effects a row: picture, name, what it does, hooks, and its other presets.
pub fn table() -> String {
    let mut preset_files: Vec<String> =
        BUILTIN_DIR.files().filter_map(|file| Some(file.path().file_stem()?.to_string_lossy().into_owned())).collect();
    preset_files.sort();
    let cells: Vec<String> = EFFECTS.iter().map(|effect| cell(effect, &preset_files)).collect();
    let mut text = String::from("<table>\n");
    for row in cells.chunks(3) {
        text.push_str(&format!("<tr>\n{}</tr>\n", row.concat()));
    }
    text.push_str("</table>\n");
    text
}

fn cell(effect: &Effect, preset_files: &[String]) -> String {
    let name = effect.name;
    let is_other = |id: &str| id != name && id.starts_with(&format!("{name}-"));
    let others: Vec<String> =
        preset_files.iter().filter(|id| is_other(id)).map(|id| format!("<a href=\"tests/snapshots/{id}.png\">{id}</a>")).collect();
    let others = if others.is_empty() { String::new() } else { format!("<br><sub>also {}</sub>", others.join(", ")) };
    format!(
        "<td valign=\"top\"><img src=\"tests/snapshots/{name}.png\" width=\"260\" alt=\"{name}\"><br><b>{name}</b> <sub>{}</sub><br>{}{others}</td>\n",
        effect.hooks.names(),
        effect.about,
    )
}
