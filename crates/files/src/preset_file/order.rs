//! The `stack` key: the order of the enabled effects, each named once.

use std::collections::HashSet;

use toml_edit::Value as Toml;

use crate::{effect_files::Catalog, effects::Stack, params::did_you_mean};

/// `stack` in the order that `toml` names. `has_table` tells whether the file has a table for an
/// effect that this program does not know; such a name is kept in the file and passed over here.
pub fn read(
    toml: Option<&Toml>,
    stack: &Stack,
    catalog: &Catalog,
    has_table: &dyn Fn(&str) -> bool,
) -> Result<Stack, String> {
    let names: Option<Vec<&str>> = toml
        .and_then(Toml::as_array)
        .and_then(|list| list.iter().map(Toml::as_str).collect());
    let names = names.ok_or("must be a list of effect names")?;
    let mut ordered = Vec::new();
    let mut known = HashSet::new();
    for name in &names {
        if !known.insert(*name) {
            return Err(format!("names {name} twice"));
        }
        match (stack.get(name), catalog.find(name).ok().flatten()) {
            (Some(enabled), _) => ordered.push(enabled.clone()),
            (None, Some(_)) => {
                return Err(format!(
                    "names {name}, which is not enabled; add [effects.{name}]"
                ));
            }
            (None, None) if has_table(name) => {}
            (None, None) => {
                let hint = did_you_mean(name, catalog.names());
                return Err(format!("names {name:?}, which is no effect{hint}"));
            }
        }
    }
    match stack
        .0
        .iter()
        .find(|enabled| !known.contains(enabled.effect.name.as_str()))
    {
        Some(missing) => Err(format!(
            "leaves out {}, which is enabled",
            missing.effect.name
        )),
        None => Ok(Stack(ordered)),
    }
}
