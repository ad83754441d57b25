//! `new-effect`: writes a commented effect file, and says what to do next.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{
    args::{Common, NewEffect},
    error::{CliError, Exit},
    files,
    streams::Streams,
};
use crate::{
    effect_files::{check_name, duplicate, template},
    effects::Effect,
    params::did_you_mean,
    preset_file::{Existing, Folders},
};

pub fn run(common: &Common, args: &NewEffect, streams: &mut Streams) -> Result<Exit, CliError> {
    let name = &args.name;
    check_name(name).map_err(|reason| CliError::usage(format!("{name:?} {reason}")))?;
    let text = match &args.from {
        None => template(name, args.hook),
        Some(from) => {
            let effect = named_effect(&common.folders(), "--from", from)?;
            duplicate(&effect, name)
                .map_err(|reason| CliError::usage(format!("{from} {reason}")))?
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

/// The effect that an option names.
pub fn named_effect(folders: &Folders, option: &str, name: &str) -> Result<Arc<Effect>, CliError> {
    let found = folders.effects.find(name);
    let effect = found.map_err(|error| CliError::usage(error.to_string()))?;
    effect.cloned().ok_or_else(|| {
        let hint = did_you_mean(name, folders.effects.names());
        CliError::usage(format!("{option} {name}: there is no such effect{hint}"))
    })
}
