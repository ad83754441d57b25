//! `new-effect`: writes a commented effect file, and says what to do next.

use serde_json::{Value, json};

use super::{
    args::{Common, NewEffect},
    error::{CliError, Exit},
    files,
    streams::Streams,
};
use crate::{
    effect_files::{check_name, duplicate, template},
    params::did_you_mean,
    preset_file::Existing,
};

pub fn run(common: &Common, args: &NewEffect, streams: &mut Streams) -> Result<Exit, CliError> {
    let name = &args.name;
    check_name(name).map_err(|reason| CliError::usage(format!("{name:?} {reason}")))?;
    let text = match &args.from {
        None => template(name, args.hook),
        Some(from) => {
            let folders = common.folders();
            let found = folders
                .effects
                .find(from)
                .map_err(|error| CliError::usage(error.to_string()))?;
            let effect = found.ok_or_else(|| {
                let hint = did_you_mean(from, folders.effects.names());
                CliError::usage(format!("--from {from}: there is no such effect{hint}"))
            })?;
            duplicate(effect, name).map_err(|reason| CliError::usage(format!("{from} {reason}")))?
        }
    };
    let path = common.effects_dir().join(format!("{name}.wgsl"));
    if path.exists() && !common.force {
        return Err(CliError::usage(format!(
            "{} exists; --force overwrites it",
            path.display()
        )));
    }
    std::fs::create_dir_all(common.effects_dir()).map_err(|error| {
        CliError::usage(format!(
            "{} cannot be made: {error}",
            common.effects_dir().display()
        ))
    })?;
    files::write(
        &path,
        text.as_bytes(),
        if common.force {
            Existing::Replace
        } else {
            Existing::Keep
        },
    )?;
    if streams.json {
        streams.object(
            "new-effect",
            Value::Null,
            vec![json!({ "file": path.to_string_lossy(), "hook": args.hook.name() })],
        )?;
    } else {
        streams.text(&format!("{}\n", path.display()))?;
    }
    streams.note(&format!(
        "edit it while the lab shows it: rasterlab teapot --set {name}"
    ));
    Ok(Exit::Done)
}
