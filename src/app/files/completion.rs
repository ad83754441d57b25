//! Completion of paths that are typed: the folder that is listed, the names that match, and what
//! Tab makes of them.

use std::path::{Path, PathBuf, is_separator};

use crate::params::likeness;

/// A file or folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub name: String,
    pub is_folder: bool,
}

/// What is in a folder, or why it cannot be listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    pub folder: PathBuf,
    pub entries: Result<Vec<Entry>, String>,
}

/// Entries of a folder that are read; more cannot be looked through anyway.
const MAX_ENTRIES: usize = 20_000;

impl Listing {
    /// Reads `folder`: folders first, each group by name. Names that are no Unicode cannot be typed
    /// and are left out.
    pub fn read(folder: &Path) -> Self {
        let read = || -> std::io::Result<Vec<Entry>> {
            let files = std::fs::read_dir(folder)?.flatten().take(MAX_ENTRIES);
            // The kind of what a link leads to.
            let entry = |file: std::fs::DirEntry| {
                Some(Entry {
                    name: file.file_name().into_string().ok()?,
                    is_folder: file.path().is_dir(),
                })
            };
            let mut entries: Vec<Entry> = files.filter_map(entry).collect();
            entries.sort_by_cached_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
            Ok(entries)
        };
        Self {
            folder: folder.to_owned(),
            entries: read().map_err(|error| format!("{}: {error}", folder.display())),
        }
    }

    /// The entries that begin like the name in `typed`: folders, and files of these extensions.
    /// Hidden ones only if a dot was typed.
    pub fn matches(&self, typed: &str, extensions: &[&str]) -> Vec<&Entry> {
        let begins = name_of(typed).to_lowercase();
        let has_extension = |name: &str| {
            let extension = Path::new(name).extension().unwrap_or_default();
            extensions
                .iter()
                .any(|known| extension.eq_ignore_ascii_case(known))
        };
        let is_match = |entry: &&Entry| {
            (entry.is_folder || has_extension(&entry.name))
                && entry.name.to_lowercase().starts_with(&begins)
                && (begins.starts_with('.') || !entry.name.starts_with('.'))
        };
        self.entries.iter().flatten().filter(is_match).collect()
    }

    /// What may be meant where nothing matches: entries whose names have the typed one in them, or
    /// are like it.
    pub fn near(&self, typed: &str, extensions: &[&str]) -> Vec<&Entry> {
        let name = name_of(typed);
        let is_near = |entry: &&Entry| {
            let stem = entry
                .name
                .rsplit_once('.')
                .map_or(&*entry.name, |parts| parts.0);
            entry.name.to_lowercase().contains(&name.to_lowercase())
                || [stem, &entry.name]
                    .iter()
                    .any(|known| likeness(name, known).is_some())
        };
        let all = self.matches(&typed[..typed.len() - name.len()], extensions);
        all.into_iter().filter(is_near).collect()
    }
}

/// The path that `typed` means: `~` is the home folder.
pub fn expand_home(typed: &str) -> PathBuf {
    let home = |rest: &str| Some(std::env::home_dir()?.join(rest));
    match typed.strip_prefix('~') {
        Some("") => home(""),
        Some(rest) if rest.starts_with(is_separator) => home(rest.trim_start_matches(is_separator)),
        _ => None,
    }
    .unwrap_or_else(|| PathBuf::from(typed))
}

/// The folder whose entries can complete `typed`.
pub fn folder_of(typed: &str) -> PathBuf {
    let folder = expand_home(&typed[..typed.len() - name_of(typed).len()]);
    let folder = if folder.as_os_str().is_empty() {
        PathBuf::from(".")
    } else {
        folder
    };
    std::path::absolute(&folder).unwrap_or(folder)
}

/// The name at the end of `typed`, behind the last separator.
pub fn name_of(typed: &str) -> &str {
    typed
        .rfind(is_separator)
        .map_or(typed, |at| &typed[at + 1..])
}

/// `typed` with `entry` in place of its name; a folder gets a separator at its end, to go on in it.
pub fn with_entry(typed: &str, entry: &Entry) -> String {
    let folder = &typed[..typed.len() - name_of(typed).len()];
    let end = if entry.is_folder {
        std::path::MAIN_SEPARATOR_STR
    } else {
        ""
    };
    format!("{folder}{}{end}", entry.name)
}

/// `typed` with as much of its name as all `matches` share; the whole entry if there is one match.
/// None if that adds nothing.
pub fn complete_name(typed: &str, matches: &[&Entry]) -> Option<String> {
    let completed = match matches {
        [] => return None,
        [entry] => with_entry(typed, entry),
        [first, others @ ..] => {
            let shared = |name: &str, other: &str| {
                let same = name
                    .chars()
                    .zip(other.chars())
                    .take_while(|(a, b)| a.to_lowercase().eq(b.to_lowercase()));
                name.char_indices()
                    .nth(same.count())
                    .map_or(name.len(), |(at, _)| at)
            };
            let length = others
                .iter()
                .map(|other| shared(&first.name, &other.name))
                .min()
                .unwrap_or_default();
            let name = name_of(typed);
            if first.name[..length].chars().count() <= name.chars().count() {
                return None;
            }
            format!(
                "{}{}",
                &typed[..typed.len() - name.len()],
                &first.name[..length]
            )
        }
    };
    (completed != typed).then_some(completed)
}

/// `path` with this extension, once; as it is where none is asked for.
pub fn with_extension(path: &Path, extension: Option<&str>) -> PathBuf {
    let Some(extension) = extension else {
        return path.to_owned();
    };
    let has = |path: &Path| {
        path.extension()
            .is_some_and(|there| there.eq_ignore_ascii_case(extension))
    };
    match path.file_stem() {
        // Typed in place of the selected name, in front of the extension that stayed.
        Some(stem) if has(path) && has(Path::new(stem)) => path.with_file_name(stem),
        _ if has(path) => path.to_owned(),
        _ => {
            // Appended, so that `preset.v2` keeps its dot.
            let mut name = path.as_os_str().to_owned();
            name.push(format!(".{extension}"));
            name.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (tempfile::TempDir, Listing) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in [
            "fox.glb",
            "Fog.toml",
            "forest.glb",
            "notes.txt",
            ".hidden.glb",
        ] {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        for name in ["zoo", "Foundry"] {
            std::fs::create_dir(folder.path().join(name)).expect("a folder");
        }
        let listing = Listing::read(folder.path());
        (folder, listing)
    }

    fn names(matches: &[&Entry]) -> Vec<String> {
        matches.iter().map(|entry| entry.name.clone()).collect()
    }

    const TYPES: &[&str] = &["glb", "toml"];

    #[test]
    fn folders_come_first_and_only_the_types_that_can_be_opened_are_listed() {
        let (_folder, listing) = folder();
        assert_eq!(
            names(&listing.matches("", TYPES)),
            ["Foundry", "zoo", "Fog.toml", "forest.glb", "fox.glb"]
        );
        assert_eq!(
            names(&listing.matches("/somewhere/FO", TYPES)),
            ["Foundry", "Fog.toml", "forest.glb", "fox.glb"]
        );
        assert_eq!(names(&listing.matches(".", TYPES)), [".hidden.glb"]);
        assert_eq!(names(&listing.matches("notes", TYPES)), [""; 0]);
        for (typed, near) in [
            ("/a/ox", "fox.glb"),
            ("forset", "forest.glb"),
            ("zo0", "zoo"),
        ] {
            assert_eq!(names(&listing.near(typed, TYPES)), [near]);
        }
    }

    #[test]
    fn tab_adds_what_all_matches_share_and_a_single_match_whole() {
        let (_folder, listing) = folder();
        let complete = |typed: &str| complete_name(typed, &listing.matches(typed, TYPES));
        assert_eq!(complete("/a/for"), Some("/a/forest.glb".into()));
        assert_eq!(
            complete("z"),
            Some(format!("zoo{}", std::path::MAIN_SEPARATOR))
        );
        assert_eq!(complete("/a/f"), Some("/a/Fo".into()));
        assert_eq!(complete("/a/fo"), None);
        assert_eq!(complete("/a/x"), None);
        assert_eq!(complete("fox.glb"), None);
    }

    #[test]
    fn names_beyond_ascii_are_cut_between_letters() {
        let entry = |name: &str| Entry {
            name: name.into(),
            is_folder: false,
        };
        let [a, b] = [entry("Ärmel-é.glb"), entry("ärmel-è.glb")];
        assert_eq!(complete_name("ä", &[&a, &b]), Some("Ärmel-".into()));
    }

    #[test]
    fn a_typed_name_gets_its_extension_once() {
        assert_eq!(
            with_extension(Path::new("a/preset"), Some("toml")),
            Path::new("a/preset.toml")
        );
        assert_eq!(
            with_extension(Path::new("preset.v2"), Some("toml")),
            Path::new("preset.v2.toml")
        );
        assert_eq!(
            with_extension(Path::new("preset.TOML"), Some("toml")),
            Path::new("preset.TOML")
        );
        assert_eq!(
            with_extension(Path::new("a/mine.toml.toml"), Some("toml")),
            Path::new("a/mine.toml")
        );
    }

    #[test]
    fn the_folder_is_what_stands_before_the_name() {
        assert_eq!(folder_of("/a/b"), Path::new("/a"));
        assert_eq!(folder_of("/a/b/"), Path::new("/a/b"));
        assert_eq!(
            folder_of("fox"),
            std::env::current_dir().expect("a current folder")
        );
        if let Some(home) = std::env::home_dir() {
            assert_eq!(
                (folder_of("~/mod"), expand_home("~/x.glb"), expand_home("~")),
                (home.clone(), home.join("x.glb"), home)
            );
        }
        assert_eq!(expand_home("~other/x"), Path::new("~other/x"));
    }

    #[test]
    fn a_folder_that_cannot_be_listed_says_why() {
        let listing = Listing::read(Path::new("/nowhere/at/all"));
        assert!(
            listing
                .entries
                .is_err_and(|error| error.starts_with("/nowhere/at/all: "))
        );
    }
}
