//! Plain files of the window, such as its settings: TOML that serde reads, field by field, and
//! writes. Comments stay.

use std::{fmt::Display, io::ErrorKind, path::Path};

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeOwned, Error as _},
};
use toml_edit::{DocumentMut, Item, Table, TableLike, TomlError, de::from_document};

use crate::{
    host::disk,
    preset_file::{Existing, write_atomically},
};

/// Reads the file at `path`, the default value where there is none, and its document with the
/// user's comments. Each remark is something that cannot be used. A file that is no TOML becomes
/// `NAME.broken`, so that the next write does not replace what the user has typed into it.
pub fn read<T: Default + DeserializeOwned>(
    path: &Path,
    remarks: &mut Vec<String>,
) -> (T, DocumentMut) {
    let name = path.display().to_string();
    let text = match disk::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Default::default(),
        Err(error) => {
            remarks.push(format!(
                "{name}: it cannot be read, so its defaults are used: {error}"
            ));
            return Default::default();
        }
    };
    parse(&text, &name, remarks).unwrap_or_else(|error| {
        let mut aside = path.as_os_str().to_owned();
        aside.push(".broken");
        let kept = match std::fs::rename(path, &aside) {
            Ok(()) => format!("it is kept as {name}.broken"),
            Err(error) => format!("it could not be put aside: {error}"),
        };
        remarks.push(format!("{error}; its defaults are used, and {kept}"));
        Default::default()
    })
}

/// Reads the text of a file. A field that cannot be used, or is unknown, keeps its default and is
/// named in `remarks`.
///
/// # Errors
/// The text is no TOML: why, in one line.
pub fn parse<T: Default + DeserializeOwned>(
    text: &str,
    file: &str,
    remarks: &mut Vec<String>,
) -> Result<(T, DocumentMut), String> {
    let document: DocumentMut = text.parse().map_err(|error: TomlError| {
        let line = error.span().map_or(1, |span| {
            text[..span.start.min(text.len())].lines().count().max(1)
        });
        format!(
            "{file}, line {line}: {}",
            error.message().lines().next().unwrap_or("it is no TOML")
        )
    })?;
    let value = from_document(document.clone()).unwrap_or_else(|_| {
        let mut usable = DocumentMut::new();
        add_usable::<T>(
            &mut usable,
            document.as_table(),
            &[],
            &mut |field, item, error| {
                remarks.push(format!(
                    "{file}: {field} = {}: {error}; it is not used",
                    item.to_string().trim()
                ));
            },
        );
        from_document(usable).unwrap_or_default()
    });
    Ok((value, document))
}

/// Adds the fields of `table`, which stands at `path`, to a document from which a `T` can be read,
/// one at a time: those with which it still can be. The others are refused.
fn add_usable<T: DeserializeOwned>(
    usable: &mut DocumentMut,
    table: &dyn TableLike,
    path: &[&str],
    refuse: &mut dyn FnMut(String, &Item, String),
) {
    for (key, item) in table.iter() {
        let field = [path, &[key]].concat();
        if let Some(table) = item.as_table_like() {
            add_usable::<T>(usable, table, &field, refuse);
            continue;
        }
        let mut tried = usable.clone();
        let new_table = || Item::Table(Table::new());
        let owner = path.iter().try_fold(tried.as_table_mut(), |table, key| {
            table.entry(key).or_insert_with(new_table).as_table_mut()
        });
        owner.map(|owner| owner.insert(key, item.clone()));
        match from_document::<T>(tried.clone()) {
            Ok(_) => *usable = tried,
            Err(error) => refuse(field.join("."), item, error.message().replace('\n', " ")),
        }
    }
}

/// Reads a field and checks it; `takes` says what it takes.
///
/// # Errors
/// `takes`, if the field has another type or fails the check.
pub fn checked<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    from: D,
    check: impl Fn(&T) -> bool,
    takes: &str,
) -> Result<T, D::Error> {
    T::deserialize(from)
        .ok()
        .filter(check)
        .ok_or_else(|| D::Error::custom(takes))
}

/// Reads a number in a range.
///
/// # Errors
/// No number, or one outside; the range is said.
pub fn number_in<'de, D, T>(from: D, [low, high]: [T; 2]) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + PartialOrd + Display,
{
    checked(
        from,
        |number| (&low..=&high).contains(&number),
        &format!("it takes a number from {low} to {high}"),
    )
}

/// Reads one of `words`.
///
/// # Errors
/// Another word, or no text; the words are said.
pub fn word_of<'de, D: Deserializer<'de>, T: Copy>(
    from: D,
    words: &[(&str, T)],
) -> Result<T, D::Error> {
    let quoted: Vec<String> = words.iter().map(|(word, _)| format!("{word:?}")).collect();
    let written = String::deserialize(from).ok();
    let found = words
        .iter()
        .find(|(word, _)| written.as_deref() == Some(word));
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| D::Error::custom(format_args!("it takes {}", quoted.join(" or "))))
}

/// Writes a number as people do: `1.1`, not `1.10000002384`.
///
/// # Errors
/// As the serializer.
pub fn write_rounded<S: Serializer>(number: &f32, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64((f64::from(*number) * 1000.0).round() / 1000.0)
}

/// Writes `value` to `path`; the comments of `document`, which was read from there, stay. Folders
/// that do not exist are created.
///
/// # Errors
/// The value or the file cannot be written: why, in one line.
pub fn write<T: Serialize>(
    value: &T,
    document: &mut DocumentMut,
    path: &Path,
) -> Result<(), String> {
    let new = toml_edit::ser::to_document(value)
        .map_err(|error| format!("{}: {error}", path.display()))?;
    replace(document.as_table_mut(), new.as_table());
    write_text(&document.to_string(), path)
}

/// Writes the text of a file. Folders that do not exist are created.
///
/// # Errors
/// The file cannot be written: why, in one line.
pub fn write_text(text: &str, path: &Path) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new("."));
    disk::create_folder(folder).map_err(|error| {
        format!(
            "{}: the folder cannot be created: {error}",
            folder.display()
        )
    })?;
    write_atomically(path, text.as_bytes(), Existing::Replace).map_err(|error| error.to_string())
}

/// Makes the fields of `table` those of `new`, and keeps the comments round them.
fn replace(table: &mut dyn TableLike, new: &dyn TableLike) {
    let before: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    before
        .iter()
        .filter(|key| !new.contains_key(key))
        .for_each(|key| drop(table.remove(key)));
    for (key, item) in new.iter() {
        match (table.get_mut(key), item) {
            (Some(there), item) if there.is_table_like() && item.is_table_like() => {
                if let Some((there, item)) = there.as_table_like_mut().zip(item.as_table_like()) {
                    replace(there, item);
                }
            }
            (Some(Item::Value(there)), Item::Value(value)) => {
                let decor = there.decor().clone();
                *there = value.clone();
                *there.decor_mut() = decor;
            }
            _ => drop(
                table.insert(
                    key,
                    item.clone()
                        .into_table()
                        .map_or_else(|value| value, Item::Table),
                ),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_cannot_be_written_is_one_sentence() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        std::fs::write(&file, "").expect("a file");
        let error = write_text("", &file.join("settings.toml")).expect_err("a file is no folder");
        assert!(
            error.contains("the folder cannot be created") && error.lines().count() == 1,
            "{error}"
        );
    }
}
