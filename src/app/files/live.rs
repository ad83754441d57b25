//! Live files: what is wrong with files on disk, and what is compiled before it replaces what is
//! shown.

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use super::watch::Watcher;
use crate::{
    app::picture::golden_check::GoldenCheck, effect_files::Catalog, effects::Effect,
    preset::rebind::Replaced, preset_file::PresetFile,
};

/// What a fault is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// The file of an effect, by the effect's name.
    Effect(String),
    /// Effects that are sound and yet cannot be compiled.
    Pipelines,
    Preset,
    Model,
    Shaders,
}

/// Effects as their files have them now.
pub struct EffectReload {
    /// Tells requests apart.
    pub number: u64,
    /// For every preset.
    pub shared: Catalog,
    /// For the open preset.
    pub open: Catalog,
    pub replaced: Vec<Replaced>,
}

/// A new or dropped effect file that is enabled when it has been read.
#[derive(Clone, Debug, PartialEq)]
pub struct Waiting {
    pub path: PathBuf,
    /// The effect of the stack that it replaces.
    pub replaces: Option<Arc<Effect>>,
}

/// What is watched on disk, and its faults.
pub struct Live {
    pub watcher: Watcher,
    /// What is wrong with files. The last good version of each is shown.
    faults: BTreeMap<Subject, String>,
    /// Numbers of the newest requests that are still compiled.
    pub compiling_effects: Option<u64>,
    pub compiling_shaders: Option<u64>,
    /// The number of the newest golden that is still drawn, and the newest comparison.
    pub checking_golden: Option<u64>,
    pub golden: Option<GoldenCheck>,
    /// Files of new effects that are being written.
    pub writing: u32,
    requests: u64,
    pub enable: Option<Waiting>,
    /// A preset's file as it was when the user decided for the changes made here: saving may
    /// overwrite that.
    pub overruled: Option<Box<PresetFile>>,
}

impl Live {
    pub fn new(watcher: Watcher) -> Self {
        Self {
            watcher,
            faults: BTreeMap::new(),
            compiling_effects: None,
            compiling_shaders: None,
            checking_golden: None,
            writing: 0,
            golden: None,
            requests: 0,
            enable: None,
            overruled: None,
        }
    }

    /// The number of a new request.
    pub fn request(&mut self) -> u64 {
        self.requests += 1;
        self.requests
    }

    /// True while something is compiled or written, or a golden is drawn.
    pub fn is_busy(&self) -> bool {
        self.compiling_effects.is_some()
            || self.compiling_shaders.is_some()
            || self.checking_golden.is_some()
            || self.writing > 0
    }

    /// Notes a fault. Returns false if it was known.
    pub fn set_fault(&mut self, subject: Subject, text: String) -> bool {
        self.faults
            .insert(subject, text.clone())
            .is_none_or(|before| before != text)
    }

    /// Forgets a fault. Returns true if there was one.
    pub fn clear_fault(&mut self, subject: &Subject) -> bool {
        self.faults.remove(subject).is_some()
    }

    /// Forgets the faults of effects for which `is_kept` is false.
    pub fn keep_effect_faults(&mut self, is_kept: impl Fn(&str) -> bool) {
        self.faults
            .retain(|subject, _| !matches!(subject, Subject::Effect(name) if !is_kept(name)));
    }

    /// Effects with faulty files, by name, with what is wrong.
    pub fn effect_faults(&self) -> impl Iterator<Item = (&str, &str)> {
        self.faults
            .iter()
            .filter_map(|(subject, text)| match subject {
                Subject::Effect(name) => Some((name.as_str(), text.as_str())),
                _ => None,
            })
    }

    /// What is wrong with files that the picture depends on; `is_used` tells it of effects.
    pub fn shown_faults(
        &self,
        is_used: impl Fn(&str) -> bool,
    ) -> impl Iterator<Item = (&Subject, &str)> {
        let waiting = self
            .enable
            .as_ref()
            .and_then(|waiting| waiting.path.file_stem())
            .map(|stem| stem.to_string_lossy().into_owned());
        let is_shown = move |subject: &Subject| match subject {
            Subject::Effect(name) => is_used(name) || waiting.as_deref() == Some(name),
            _ => true,
        };
        self.faults
            .iter()
            .filter(move |(subject, _)| is_shown(subject))
            .map(|(subject, text)| (subject, text.as_str()))
    }
}
