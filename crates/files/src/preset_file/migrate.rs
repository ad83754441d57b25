//! The schema of preset files. A changed name or default changes what files mean, so it raises the
//! schema.

use toml_edit::Document;

use super::{error::PresetError, reader};

/// The schema that this program writes, and the only one that it knows.
pub const CURRENT: i64 = 2;

/// A document in the current schema; true if its schema is newer, so that parts of it may be
/// unknown. A missing schema is taken for the current one, with a warning.
///
/// No release had a schema before [`CURRENT`]. The next one is migrated here, in memory: a
/// migration changes keys and words inside their lines, so that the lines of later errors are those
/// of the file, and saving writes the new schema down.
pub fn migrate(
    document: Document<String>,
    file: &str,
    warnings: &mut Vec<String>,
) -> Result<(Document<String>, bool), PresetError> {
    let Some(item) = document.get("schema") else {
        warnings.push(format!(
            "{file}: schema is missing; write schema = {CURRENT} on the first line"
        ));
        return Ok((document, false));
    };
    let at = reader::position(document.as_table(), "schema", file, document.raw());
    match item.as_integer() {
        Some(CURRENT) => Ok((document, false)),
        Some(schema) if schema > CURRENT => {
            warnings.push(format!("{at}: schema {schema} is newer than {CURRENT}, the newest that this program knows; opened read-only"));
            Ok((document, true))
        }
        Some(schema) => {
            let todo = format!(
                "write schema = {CURRENT}, then mend the keys that are reported as unknown"
            );
            Err(PresetError::value(
                at,
                "schema",
                format!(
                    "{schema} is older than {CURRENT}, the oldest that this program reads; {todo}"
                ),
            ))
        }
        None => Err(PresetError::value(
            at,
            "schema",
            format!("must be the whole number {CURRENT}"),
        )),
    }
}
