//! `page`: a web page with the picture of a preset. The picture itself stands in the file; where the
//! browser has WebGPU, the page that is hosted elsewhere replaces it by one that moves.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde_json::{Value, json};

use super::{
    args::{Common, Page},
    backend::{Backend, check_model, scene_of},
    error::{CliError, Exit},
    files,
    open::open_as,
    streams::Streams,
};
use crate::{
    link,
    preset_file::{self, Existing, is_taken},
};

const PAGE: &str = include_str!("page.html");

pub fn run(common: &Common, args: &Page, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_file = open_as(common, &args.input, args.size, None, None)?;
    let size = preset_file.preset.output.size;
    if size.contains(&0) {
        return Err(CliError::usage(format!(
            "{}: a page needs a picture of at least 1x1 pixels, and output.size is {}x{}",
            preset_file.id, size[0], size[1]
        )));
    }
    check_model(&preset_file)?;
    if is_taken(&args.output) && !common.force {
        return Err(CliError::usage(format!(
            "{} exists; --force overwrites it",
            args.output.display()
        )));
    }
    let existing = if common.force {
        Existing::Replace
    } else {
        Existing::Keep
    };
    let scene = scene_of(common, &mut preset_file, streams)?;
    let line = link::line(&preset_file).map_err(CliError::usage)?;
    let frame = Backend::Oracle.frame(&preset_file.preset, &scene)?;
    let png = preset_file::png_bytes(&frame.color, [frame.width, frame.height])?;
    let text = PAGE
        .replace("{width}", &size[0].to_string())
        .replace("{height}", &size[1].to_string())
        .replace("{title}", &escaped(preset_file.title()))
        .replace("{page}", &escaped(&args.page))
        .replace("{line}", &line)
        .replace("{png}", &STANDARD.encode(png));
    files::write(&args.output, text.as_bytes(), existing)?;
    let file = args.output.to_string_lossy();
    if streams.json {
        streams.object("page", Value::Null, vec![json!({ "file": file })])?;
    } else {
        streams.text(&format!("{file}\n"))?;
    }
    Ok(Exit::Done)
}

/// Text that stands for itself in HTML, between tags and in attributes.
fn escaped(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '&' => "&amp;".into(),
            '<' => "&lt;".into(),
            '>' => "&gt;".into(),
            '"' => "&quot;".into(),
            '\'' => "&#39;".into(),
            c => c.to_string(),
        })
        .collect()
}
