//! `link`: the address under which a page draws a preset and proves that its picture has the same
//! bits as the oracle's.

use serde_json::{Value, json};

use super::{
    args::{Common, Link},
    backend::scene_of,
    error::{CliError, Exit},
    open::open,
    streams::Streams,
};
use crate::link;

pub fn run(common: &Common, args: &Link, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_file = open(common, &args.input)?;
    let scene = scene_of(common, &mut preset_file, streams)?;
    let line = link::line(&preset_file).map_err(CliError::usage)?;
    let bits = link::bits(&preset_file.preset, &scene);
    if let Err(why) = &bits {
        streams.note(&format!(
            "{}: the page judges its picture, but not bit by bit: {why}",
            preset_file.id
        ));
    }
    let bits = bits.ok();
    let link = link::address(&args.page, &line, bits.as_deref());
    if streams.json {
        let result = json!({ "preset": preset_file.id, "link": link, "bits": bits });
        streams.object("link", Value::Null, vec![result])?;
    } else {
        streams.text(&format!("{link}\n"))?;
    }
    Ok(Exit::Done)
}
