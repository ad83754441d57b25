//! The WGSL files: embedded in the program, or given from outside while one edits them.

use std::{
    borrow::Cow,
    collections::BTreeSet,
    sync::{Arc, OnceLock},
};

use include_dir::{Dir, include_dir};

static EMBEDDED: Dir = include_dir!("$CARGO_MANIFEST_DIR/../../shaders");

/// Gives the text of a file by its name: a path below `shaders`, without `.wgsl`.
pub type ReadShader = dyn Fn(&str) -> Option<String> + Send + Sync;

/// Where shader text comes from.
#[derive(Clone, Default)]
pub enum Library {
    /// The files as they were when the program was built.
    #[default]
    Embedded,
    /// Files elsewhere, which may change while the program runs.
    Outside(Arc<ReadShader>),
}

static CHOSEN: OnceLock<Library> = OnceLock::new();

impl Library {
    /// The library that was [chosen](Self::choose) for this process, else the embedded files.
    pub fn of_process() -> Self {
        CHOSEN.get().cloned().unwrap_or_default()
    }

    /// Makes it the library of this process. Only the first call counts.
    pub fn choose(self) {
        CHOSEN.get_or_init(|| self);
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

    /// Text of `name` (a path below `shaders`, without `.wgsl`), if there is such a file.
    pub fn text(&self, name: &str) -> Option<Cow<'static, str>> {
        match self {
            Self::Embedded => EMBEDDED.get_file(format!("{name}.wgsl"))?.contents_utf8().map(Cow::Borrowed),
            Self::Outside(read) => read(name).map(Cow::Owned),
        }
    }
}
