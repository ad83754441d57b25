//! The WGSL files: embedded in the program, or given from outside while one edits them.

use std::{
    borrow::Cow,
    collections::BTreeSet,
    ops::Range,
    sync::{Arc, OnceLock},
};

use include_dir::{Dir, include_dir};

static EMBEDDED: Dir = include_dir!("$RASTERLAB_SHADERS");

/// WGSL files outside of the program.
pub trait ShaderFiles: Send + Sync {
    /// Text of `name` (a path below `shaders`, without `.wgsl`), if there is such a file.
    fn text(&self, name: &str) -> Option<String>;

    /// Names of the files in `folder` (a folder below `shaders`), without `.wgsl`.
    fn names(&self, _folder: &str) -> Vec<String> {
        Vec::new()
    }

    /// Is told the names of the parts of every module that was linked.
    fn linked(&self, parts: &mut dyn Iterator<Item = &str>);
}

/// Name and range of every section of a file's text. The first is the head, whose name is empty; a
/// line `//@ variant NAME` or `//@ step NAME` ends it and begins the section of that name, which
/// reaches to the next such line or to the end.
pub fn sections(text: &str) -> Vec<(&str, Range<usize>)> {
    let (mut sections, mut offset) = (vec![("", 0..text.len())], 0);
    for line in text.split_inclusive('\n') {
        let directive = line
            .strip_prefix("//@ ")
            .and_then(|rest| rest.trim_end().split_once(' '));
        if let Some(("variant" | "step", name)) = directive {
            sections.last_mut().expect("the head is there").1.end = offset;
            sections.push((name, offset..text.len()));
        }
        offset += line.len();
    }
    sections
}

/// Where shader text comes from.
#[derive(Clone, Default)]
pub enum Library {
    /// The files as they were when the program was built.
    #[default]
    Embedded,
    /// Files elsewhere, which may change while the program runs.
    Outside(Arc<dyn ShaderFiles>),
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
    pub fn embedded() -> impl Iterator<Item = (String, &'static str)> {
        fn files(folder: &'static Dir<'static>, found: &mut Vec<(String, &'static str)>) {
            for file in folder.files() {
                if let (Some(name), Some(text)) = (
                    file.path().with_extension("").to_str(),
                    file.contents_utf8(),
                ) {
                    found.push((name.replace('\\', "/"), text));
                }
            }
            folder.dirs().for_each(|folder| files(folder, found));
        }
        let mut found = Vec::new();
        files(&EMBEDDED, &mut found);
        found.into_iter()
    }

    /// Text of `name` for what judges: the embedded one, so that a changed folder is judged by it; of
    /// a file that the library of this process has more, that one.
    pub fn reference(name: &str) -> Option<Cow<'static, str>> {
        Self::Embedded
            .text(name)
            .or_else(|| Self::of_process().text(name))
    }

    /// Names of the files of effects: the embedded ones, and those that the library of this process
    /// has more.
    pub fn effects() -> BTreeSet<String> {
        let embedded = Self::embedded()
            .filter_map(|(name, _)| Some(name.strip_prefix("effects/")?.to_owned()));
        let outside = match Self::of_process() {
            Self::Embedded => Vec::new(),
            Self::Outside(files) => files.names("effects"),
        };
        embedded.chain(outside).collect()
    }

    /// The text of every file, always in the same order.
    pub fn texts(&self) -> impl Iterator<Item = Cow<'static, str>> {
        let names: BTreeSet<String> = Self::embedded().map(|(name, _)| name).collect();
        names.into_iter().filter_map(|name| self.text(&name))
    }

    /// Tells files outside the names of parts that were linked.
    pub fn record<'a>(&self, mut parts: impl Iterator<Item = &'a str>) {
        if let Self::Outside(files) = self {
            files.linked(&mut parts);
        }
    }

    /// Text of `name` (a path below `shaders`, without `.wgsl`), if there is such a file.
    pub fn text(&self, name: &str) -> Option<Cow<'static, str>> {
        match self {
            Self::Embedded => EMBEDDED
                .get_file(format!("{name}.wgsl"))?
                .contents_utf8()
                .map(Cow::Borrowed),
            Self::Outside(files) => files.text(name).map(Cow::Owned),
        }
    }
}
