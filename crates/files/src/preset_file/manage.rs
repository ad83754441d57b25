//! Managing preset files: renaming and duplicating. Files are read anew first, so what another
//! program has written meanwhile is kept, and no file is ever overwritten.

use std::path::{Path, PathBuf};

use toml_edit::DocumentMut;

use super::{
    atomic::{Existing, is_taken, write_atomically},
    error::{Position, PresetError},
    file::{MAX_NAME, PresetFile, stem, to_toml},
    goldens::golden_paths,
    load::{load_with, read_text},
    migrate,
};

/// The file stem of a preset called `name`: its letters and digits in lower case, with `-` between
/// words.
///
/// # Errors
/// A name without letters or digits, with control characters, or longer than [`MAX_NAME`]
/// characters.
pub fn file_stem(name: &str) -> Result<String, PresetError> {
    let refused = |reason: String| {
        PresetError::value(
            Position {
                file: "the preset".into(),
                line: None,
            },
            "name",
            reason,
        )
    };
    if name.chars().count() > MAX_NAME {
        return Err(refused(format!(
            "has {} characters; at most {MAX_NAME} are allowed",
            name.chars().count()
        )));
    }
    if name.chars().any(char::is_control) {
        return Err(refused("contains a control character; remove it".into()));
    }
    let is_kept = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '+');
    let words = name.to_lowercase();
    let words: Vec<&str> = words
        .split(|c: char| !is_kept(c))
        .map(|word| word.trim_matches('.'))
        .filter(|word| !word.is_empty())
        .collect();
    let joined = words.join("-");
    if joined.chars().any(char::is_alphanumeric) {
        Ok(joined)
    } else {
        Err(refused(format!(
            "{name:?} has no letter or digit; type at least one"
        )))
    }
}

/// Calls the preset at `path` `name`: the file is named after it, and the file's key `name` says
/// it. Returns the new path. The golden beside the preset keeps its preset. A file that is no TOML,
/// or of a newer schema, only gets another file name.
///
/// # Errors
/// No name for a file, a file of that name exists, or a file cannot be read or written; then
/// nothing has changed.
pub fn rename(path: &Path, name: &str) -> Result<PathBuf, PresetError> {
    let (name, new_stem) = (name.trim(), file_stem(name)?);
    let to = path.with_file_name(format!("{new_stem}.toml"));
    let text = read_text(path)?;
    let renamed = with_name(&text, name, &new_stem);
    if to == path {
        if renamed != text {
            write_atomically(path, renamed.as_bytes(), Existing::Replace)?;
        }
        return Ok(to);
    }
    write_atomically(&to, renamed.as_bytes(), Existing::Keep)?;
    if !std::fs::read(path).is_ok_and(|now| now == text.as_bytes()) {
        let reason = format!(
            "another program has changed it at this moment, so it stays beside {}",
            to.display()
        );
        return Err(PresetError::Write {
            file: path.display().to_string(),
            reason,
        });
    }
    std::fs::remove_file(path).map_err(|error| PresetError::Write {
        file: path.display().to_string(),
        reason: error.to_string(),
    })?;
    let snapshots = path.with_file_name("snapshots");
    for (from, to) in golden_paths(&snapshots, &stem(path))
        .into_iter()
        .zip(golden_paths(&snapshots, &new_stem))
    {
        if from.is_file() && !is_taken(&to) {
            // The preset is renamed by now. Without its golden it is as one that was never blessed.
            drop(std::fs::rename(from, to));
        }
    }
    Ok(to)
}

/// The text with `name` as its name. A preset that has none needs none if its file is called so.
fn with_name(text: &str, name: &str, stem: &str) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else {
        return text.into();
    };
    let is_newer = document
        .get("schema")
        .and_then(toml_edit::Item::as_integer)
        .is_some_and(|schema| schema > migrate::CURRENT);
    let before = document.get("name").and_then(toml_edit::Item::as_str);
    if is_newer || before == Some(name) || (before.is_none() && name == stem) {
        return text.into();
    }
    let mut value = toml_edit::Value::from(name);
    match document
        .get_mut("name")
        .and_then(toml_edit::Item::as_value_mut)
    {
        Some(before) => {
            *value.decor_mut() = before.decor().clone();
            *before = value;
        }
        None => drop(document.insert("name", toml_edit::Item::Value(value))),
    }
    document.to_string()
}

/// Writes a copy of a preset, as its file has it, into `folder`, under a name that is free. It has
/// no golden. Returns its path.
pub fn duplicate(source: &PresetFile, folder: &Path) -> Result<PathBuf, PresetError> {
    let source = match &source.path {
        Some(path) => &load_with(path, &source.effects)?,
        None => source,
    };
    std::fs::create_dir_all(folder).map_err(|error| PresetError::Write {
        file: folder.display().to_string(),
        reason: error.to_string(),
    })?;
    let title: String = source.title().chars().take(MAX_NAME - 10).collect();
    for number in 1.. {
        let name = if number == 1 {
            format!("{title} copy")
        } else {
            format!("{title} copy {number}")
        };
        let to = folder.join(format!("{}.toml", file_stem(&name)?));
        let mut copy = source.for_picture(&to);
        let text = if copy.is_newer {
            to_toml(source)
        } else {
            copy.preset.name.clone_from(&name);
            copy.preset.test = None;
            to_toml(&copy)
        };
        match write_atomically(&to, text.as_bytes(), Existing::Keep) {
            Err(PresetError::Exists { .. }) => {}
            written => return written.map(|()| to),
        }
    }
    unreachable!("every number is tried")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset_file::{Folders, load, open};

    const TEXT: &str = "schema = 2\n# The first.\nname = \"One\" # shown\n[effects.facet]\namount = 0.5 # half\n[test]\nmax_pixels = 4\nwhy = \"noise\"\n";

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("a folder")
    }

    fn text(path: &Path) -> String {
        std::fs::read_to_string(path).expect("a file")
    }

    #[test]
    fn names_become_names_of_files() {
        let stems = [
            "Cut knot",
            " Mein  Würfel! ",
            "a/b\\c:d",
            "../x",
            "v1.2",
            "snake_case",
        ]
        .map(|name| file_stem(name).expect("a stem"));
        assert_eq!(
            stems,
            [
                "cut-knot",
                "mein-würfel",
                "a-b-c-d",
                "x",
                "v1.2",
                "snake_case"
            ]
        );
        for (name, part) in [
            ("", "no letter"),
            ("  ", "no letter"),
            ("...", "no letter"),
            ("a\nb", "control"),
            (&"x".repeat(101), "at most 100"),
        ] {
            let error = file_stem(name).expect_err(name).to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn renaming_moves_the_file_with_its_comments_and_golden_and_says_the_name() {
        let folder = folder();
        let path = folder.path().join("one.toml");
        std::fs::write(&path, TEXT).expect("a file");
        std::fs::create_dir(folder.path().join("snapshots")).expect("a folder");
        for golden in golden_paths(&folder.path().join("snapshots"), "one") {
            std::fs::write(golden, "golden").expect("a file");
        }
        let to = rename(&path, "Second try").expect("a free name");
        assert_eq!(to, folder.path().join("second-try.toml"));
        assert_eq!(text(&to), TEXT.replace("\"One\"", "\"Second try\""));
        assert!(!path.exists());
        assert!(
            golden_paths(&folder.path().join("snapshots"), "second-try")
                .iter()
                .all(|golden| golden.is_file())
        );
        assert_eq!(rename(&to, "Second Try").expect("the same file"), to);
        assert_eq!(load(&to).expect("a preset").title(), "Second Try");
    }

    #[test]
    fn a_taken_name_is_refused_and_nothing_changes() {
        let folder = folder();
        let [one, two] = ["one.toml", "two.toml"].map(|name| folder.path().join(name));
        std::fs::write(&one, TEXT).expect("a file");
        std::fs::write(&two, "# mine\n").expect("a file");
        let error = rename(&one, "Two").expect_err("a taken name").to_string();
        assert!(error.ends_with("two.toml exists already"), "{error}");
        assert_eq!(
            (text(&one).as_str(), text(&two).as_str()),
            (TEXT, "# mine\n")
        );
        assert!(rename(&folder.path().join("none.toml"), "x").is_err());
    }

    #[test]
    fn a_faulty_file_and_one_of_a_newer_schema_keep_their_text() {
        let folder = folder();
        for written in ["schema = 2\nname = [", "schema = 99\nname = \"later\"\n"] {
            let path = folder.path().join("odd.toml");
            std::fs::write(&path, written).expect("a file");
            let to = rename(&path, "other").expect("a free name");
            assert_eq!(text(&to), written);
            std::fs::remove_file(to).expect("a file");
        }
    }

    #[test]
    fn a_copy_has_a_free_name_no_golden_and_what_the_file_has_now() {
        let folder = folder();
        let path = folder.path().join("one.toml");
        std::fs::write(&path, TEXT).expect("a file");
        let known = load(&path).expect("a preset");
        std::fs::write(&path, TEXT.replace("0.5", "0.75")).expect("a file");
        let copies = [1, 2].map(|_| duplicate(&known, folder.path()).expect("a copy"));
        assert_eq!(
            copies,
            ["one-copy.toml", "one-copy-2.toml"].map(|name| folder.path().join(name))
        );
        let copy = load(&copies[1]).expect("a preset");
        assert_eq!((copy.title(), &copy.preset.test), ("One copy 2", &None));
        assert!(
            text(&copies[0]).contains("amount = 0.75 # half"),
            "{}",
            text(&copies[0])
        );
        assert_eq!(text(&path), TEXT.replace("0.5", "0.75"));
    }

    #[test]
    fn a_copy_of_a_built_in_preset_is_a_file_and_one_elsewhere_finds_its_model() {
        let folder = folder();
        let built_in = open("comic", &Folders::default()).expect("a built-in preset");
        let copy = load(&duplicate(&built_in, &folder.path().join("new")).expect("a copy"))
            .expect("a preset");
        assert_eq!(
            (copy.preset.stack, copy.read_only),
            (built_in.preset.stack, false)
        );

        std::fs::write(
            folder.path().join("m.toml"),
            "schema = 2\n[scene]\npath = \"fox.glb\"\n",
        )
        .expect("a file");
        let with_model = load(&folder.path().join("m.toml")).expect("a preset");
        let copy = duplicate(&with_model, &folder.path().join("new")).expect("a copy");
        assert!(
            text(&copy).contains("path = \"../fox.glb\""),
            "{}",
            text(&copy)
        );
    }
}
