//! `parts`: the materials, nodes and meshes of a scene, each as the pattern that limits an effect
//! to it, and the variants of its materials.

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
    let mut preset_file = open(common, &args.input)?;
    let scene = scene_of(common, &mut preset_file, streams)?;
    let parts = parts(&scene);
    if streams.json {
        let variant = |name: &String| json!({ "kind": "variant", "name": name });
        let variants = scene.variants.iter().map(variant);
        let results = parts.iter().map(part_json).chain(variants).collect();
        streams.object("parts", Value::Null, results)?;
    } else {
        streams.text(&text(&parts, &scene.variants))?;
    }
    Ok(Exit::Done)
}

fn part_json(part: &Part) -> Value {
    json!({
        "kind": part.kind.name(), "name": part.name, "pattern": part.pattern().to_string(), "depth": part.depth,
        "draws": part.instances, "triangles": part.triangles,
    })
}

/// A table per kind; nodes are indented below their parents. Variants come last, each as what
/// `--set` takes.
fn text(parts: &[Part], variants: &[String]) -> String {
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
    let mut tables: Vec<String> = PartKind::ALL.into_iter().filter_map(of_kind).collect();
    if !variants.is_empty() {
        let rows = variants
            .iter()
            .map(|name| format!("scene.variant={name}\n"));
        tables.push(format!("VARIANT\n{}", rows.collect::<String>()));
    }
    if tables.is_empty() {
        "the scene draws nothing\n".into()
    } else {
        tables.join("\n")
    }
}
