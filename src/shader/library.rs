//! The WGSL files: embedded in the program, or read from a folder while one edits them.

use std::{borrow::Cow, path::PathBuf};

use include_dir::{Dir, include_dir};

static EMBEDDED: Dir = include_dir!("$CARGO_MANIFEST_DIR/shaders");

/// Where shader text comes from.
#[derive(Clone, Debug, Default)]
pub enum Library {
    /// The files as they were when the program was built.
    #[default]
    Embedded,
    /// A `shaders` folder on disk.
    Folder(PathBuf),
}

impl Library {
    /// The folder named by `RASTERLAB_SHADERS`, for people who edit shaders; else the embedded files.
    pub fn from_env() -> Self {
        std::env::var_os("RASTERLAB_SHADERS").map_or(Self::Embedded, |folder| Self::Folder(folder.into()))
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

    /// Text of `name` (a path below `shaders`, without `.wgsl`), if there is such a file.
    pub fn text(&self, name: &str) -> Option<Cow<'static, str>> {
        match self {
            Self::Embedded => EMBEDDED.get_file(format!("{name}.wgsl"))?.contents_utf8().map(Cow::Borrowed),
            Self::Folder(folder) => std::fs::read_to_string(folder.join(format!("{name}.wgsl"))).ok().map(Cow::Owned),
        }
    }
}
