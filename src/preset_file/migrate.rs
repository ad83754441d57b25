//! Migrations: one pure function from document to document per step of `schema`.
//!
//! A changed default changes what sparse files mean, so it raises the schema, and its migration writes the old value
//! down. Loading never rewrites a file.

use toml_edit::DocumentMut;

/// `MIGRATIONS[n]` takes schema `n + 1` to `n + 2`. Each comes with a before and an after fixture in `tests/house/presets.rs`.
pub const MIGRATIONS: &[fn(DocumentMut) -> DocumentMut] = &[];

/// The schema this program writes.
pub const CURRENT: i64 = 1 + MIGRATIONS.len() as i64;

/// Brings a document of schema `from`, 1 to [`CURRENT`], up to date.
pub fn migrate(document: DocumentMut, from: i64) -> DocumentMut {
    let mut document = MIGRATIONS.iter().skip((from - 1).max(0) as usize).fold(document, |document, step| step(document));
    if let Some(value) = document.get_mut("schema").and_then(|item| item.as_value_mut()) {
        let decor = value.decor().clone();
        *value = CURRENT.into();
        *value.decor_mut() = decor;
    }
    document
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_older_schema_has_a_way_to_the_current_one() {
        for from in 1..=CURRENT {
            let document: DocumentMut = format!("schema = {from} # kept\n").parse().unwrap();
            assert_eq!(migrate(document, from).to_string(), format!("schema = {CURRENT} # kept\n"));
        }
    }
}
