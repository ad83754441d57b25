//! `migrate`: shows what the current schema changes in preset files, and writes it with `--write`.

use std::path::Path;

use serde_json::{Value, json};

use super::{
    args::Migrate,
    error::{CliError, Exit},
    files,
    streams::Streams,
};
use crate::preset_file::{self, Existing, Migrated, migrate::CURRENT};

pub fn run(args: &Migrate, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut results = Vec::new();
    // Every file is read before the first is written.
    let files = args.files.iter().map(|file| Ok((file, preset_file::migrated(file)?))).collect::<Result<Vec<_>, CliError>>()?;
    for (file, migrated) in &files {
        let changes = migrated.before != migrated.after;
        if !streams.json {
            streams.text(&diff(file, migrated))?;
        }
        if changes && args.write {
            files::write(file, migrated.after.as_bytes(), Existing::Replace)?;
        }
        results.push(json!({
            "file": file.to_string_lossy(), "from": migrated.from, "to": migrated.from.max(CURRENT), "changes": changes,
            "written": changes && args.write,
        }));
    }
    let changed = results.iter().filter(|result| result["changes"] == json!(true)).count();
    if streams.json {
        streams.object("migrate", Value::Null, results)?;
    }
    let hint = if changed > 0 && !args.write { "; --write changes the files" } else { "" };
    streams.note(&format!("{changed} of {} files change to schema {CURRENT}{hint}", files.len()));
    Ok(Exit::Done)
}

/// The changed lines of a file; a migration neither adds nor removes lines.
fn diff(file: &Path, Migrated { from, before, after }: &Migrated) -> String {
    if before == after {
        return String::new();
    }
    let shown = file.display();
    let mut text = format!("--- {shown} (schema {from})\n+++ {shown} (schema {CURRENT})\n");
    for (index, (old, new)) in before.lines().zip(after.lines()).enumerate().filter(|(_, (old, new))| old != new) {
        text += &format!("@@ line {} @@\n-{old}\n+{new}\n", index + 1);
    }
    text
}
