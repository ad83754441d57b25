//! `parts`: the materials, nodes and meshes of a scene, each as the pattern that limits an effect
//! to it.

use serde_json::{Value, json};

use super::{
    args::{Common, Parts},
    backend::scene_of,
    error::{CliError, Exit},
    open::open,
    streams::{Streams, table},
};
use crate::scene::parts::{Part, PartKind, parts};

pub fn run(common: &Common, args: &Parts, streams: &mut Streams) -> Result<Exit, CliError> {
    let preset_file = open(common, &args.input)?;
    let scene = scene_of(common, &preset_file, streams)?;
    let parts = parts(&scene);
    if streams.json {
        streams.object("parts", Value::Null, parts.iter().map(part_json).collect())?;
    } else {
        streams.text(&text(&parts))?;
    }
    Ok(Exit::Done)
}

fn part_json(part: &Part) -> Value {
    json!({
        "kind": part.kind.name(), "name": part.name, "pattern": part.pattern().to_string(), "depth": part.depth,
        "draws": part.instances, "triangles": part.triangles,
    })
}

/// A table per kind; nodes are indented below their parents.
fn text(parts: &[Part]) -> String {
    let of_kind = |kind: PartKind| {
        let mut rows = vec![
            [kind.name().to_uppercase().as_str(), "DRAWS", "TRIANGLES"]
                .map(str::to_owned)
                .to_vec(),
        ];
        let of_kind = parts.iter().filter(|part| part.kind == kind);
        rows.extend(of_kind.map(|part| {
            vec![
                format!("{}{}", "  ".repeat(part.depth), part.pattern()),
                part.instances.to_string(),
                part.triangles.to_string(),
            ]
        }));
        if rows.len() > 1 {
            Some(table(&rows))
        } else {
            None
        }
    };
    let tables: Vec<String> = PartKind::ALL.into_iter().filter_map(of_kind).collect();
    if tables.is_empty() {
        "the scene draws nothing\n".into()
    } else {
        tables.join("\n")
    }
}
