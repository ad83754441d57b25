//! The WGSL files: embedded in the program, or read from a folder while one edits them.

use std::{borrow::Cow, collections::BTreeSet, fs::OpenOptions, io::Write, ops::Range, path::PathBuf, sync::OnceLock};

use include_dir::{Dir, include_dir};

static EMBEDDED: Dir = include_dir!("$CARGO_MANIFEST_DIR/../../shaders");

/// Name and range of every section of a file's text. The first is the head, whose name is empty; a line `//@ variant NAME` or `//@ step NAME`
/// ends it and begins the section of that name, which reaches to the next such line or to the end.
pub fn sections(text: &str) -> Vec<(&str, Range<usize>)> {
    let (mut sections, mut offset) = (vec![("", 0..text.len())], 0);
    for line in text.split_inclusive('\n') {
        let directive = line.strip_prefix("//@ ").and_then(|rest| rest.trim_end().split_once(' '));
        if let Some(("variant" | "step", name)) = directive {
            sections.last_mut().expect("the head is there").1.end = offset;
            sections.push((name, offset..text.len()));
        }
        offset += line.len();
    }
    sections
}

/// Where shader text comes from.
#[derive(Clone, Debug, Default)]
pub enum Library {
    /// The files as they were when the program was built.
    #[default]
    Embedded,
    /// A `shaders` folder on disk.
    Folder(PathBuf),
}

/// The folder of `--shaders`.
static CHOSEN: OnceLock<PathBuf> = OnceLock::new();

impl Library {
    /// The folder of `--shaders`, or else of `RASTERLAB_SHADERS`, for people who edit shaders; without either the embedded files.
    pub fn from_env() -> Self {
        let folder = CHOSEN.get().cloned().or_else(|| std::env::var_os("RASTERLAB_SHADERS").map(PathBuf::from));
        folder.map_or(Self::Embedded, Self::Folder)
    }

    /// Makes [`Library::from_env`] return this folder from now on. Only the first call counts.
    pub fn choose(folder: PathBuf) {
        CHOSEN.get_or_init(|| folder);
    }

    /// Name and text of every embedded file.
    pub(super) fn embedded() -> impl Iterator<Item = (String, &'static str)> {
        fn files(folder: &'static Dir<'static>, found: &mut Vec<(String, &'static str)>) {
            for file in folder.files() {
                if let (Some(name), Some(text)) = (file.path().with_extension("").to_str(), file.contents_utf8()) {
                    found.push((name.replace('\\', "/"), text));
                }
            }
            folder.dirs().for_each(|folder| files(folder, found));
        }
        let mut found = Vec::new();
        files(&EMBEDDED, &mut found);
        found.into_iter()
    }

    /// The text of every file, always in the same order.
    pub fn texts(&self) -> impl Iterator<Item = Cow<'static, str>> {
        let names: BTreeSet<String> = Self::embedded().map(|(name, _)| name).collect();
        names.into_iter().filter_map(|name| self.text(&name))
    }

    /// Adds the names of parts that were linked to the file that `RASTERLAB_PARTS` names: `scripts/mutants.py` asks which parts a command uses.
    pub(super) fn record<'a>(&self, parts: impl Iterator<Item = &'a str>) {
        if let (Self::Folder(_), Some(path)) = (self, std::env::var_os("RASTERLAB_PARTS")) {
            let names: String = parts.map(|name| format!("{name}\n")).collect();
            let file = OpenOptions::new().create(true).append(true).open(path);
            // The script takes a missing file for a command that uses every part.
            let _ = file.and_then(|mut file| file.write_all(names.as_bytes()));
        }
    }

    /// Text of `name` (a path below `shaders`, without `.wgsl`), if there is such a file.
    pub fn text(&self, name: &str) -> Option<Cow<'static, str>> {
        match self {
            Self::Embedded => EMBEDDED.get_file(format!("{name}.wgsl"))?.contents_utf8().map(Cow::Borrowed),
            Self::Folder(folder) => std::fs::read_to_string(folder.join(format!("{name}.wgsl"))).ok().map(Cow::Owned),
        }
    }
}
