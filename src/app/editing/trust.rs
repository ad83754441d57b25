//! Trust: which effects that came inside a preset may run, and which models that a picture or a
//! pasted line names outside of its folder may be read. The user allows each once; effects of the
//! user's own files need no answer.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use crate::{effect_files::Catalog, effects::Effect, preset_file::PresetFile};

/// What this run of the program may use.
#[derive(Default)]
pub struct Trust {
    /// Texts of effects.
    effects: BTreeSet<String>,
    /// Models, by their absolute paths.
    models: BTreeSet<PathBuf>,
}

impl Trust {
    /// May everything run that `preset_file` brings? `own` are the effects of the user's files.
    pub fn allows(&self, preset_file: &PresetFile, own: &Catalog) -> bool {
        let is_own = |effect: &Effect| {
            own.custom()
                .any(|(_, known)| known.path.is_some() && known.read.as_deref() == Ok(effect))
        };
        preset_file.brought().all(|effect| {
            is_own(effect)
                || effect
                    .source
                    .as_ref()
                    .is_some_and(|source| self.effects.contains(&source.written))
        })
    }

    /// Allows what `preset_file` brings.
    pub fn allow(&mut self, preset_file: &PresetFile) {
        self.effects.extend(
            preset_file
                .brought()
                .filter_map(|effect| Some(effect.source.as_ref()?.written.clone())),
        );
    }

    /// May the model at this absolute path be read?
    pub fn allows_model(&self, model: &Path) -> bool {
        self.models.contains(model)
    }

    /// Allows reading the model at this absolute path.
    pub fn allow_model(&mut self, model: PathBuf) {
        self.models.insert(model);
    }
}
