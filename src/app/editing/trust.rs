//! Trust: which effects that came inside a preset may run. The user allows their code once; effects
//! of the user's own files need no answer.

use std::collections::BTreeSet;

use crate::{effect_files::Catalog, effects::Effect, preset_file::PresetFile};

/// The texts of effects that may run, of this run of the program.
#[derive(Default)]
pub struct Trust(BTreeSet<String>);

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
                    .is_some_and(|source| self.0.contains(&source.written))
        })
    }

    /// Allows what `preset_file` brings.
    pub fn allow(&mut self, preset_file: &PresetFile) {
        self.0.extend(
            preset_file
                .brought()
                .filter_map(|effect| Some(effect.source.as_ref()?.written.clone())),
        );
    }
}
