//! The axes that the person chose to be up in models, for when those are opened again.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{host::disk, preset::SceneSource, preset_file::PresetFile, scene::UpAxis};

/// For absolute paths of models, the axis that was chosen to be up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    try_from = "BTreeMap<String, String>",
    into = "BTreeMap<String, String>"
)]
pub struct UpAxes(BTreeMap<String, UpAxis>);

impl UpAxes {
    /// Gives a model that is opened the axis that was chosen for it, if none is named. Returns
    /// whether it did.
    pub fn give(&self, opened: &mut PresetFile) -> bool {
        let is_open = opened.preset.parts.up == UpAxis::Auto;
        let chosen = || self.0.get(&model(opened)?).copied();
        let given = is_open.then(chosen).flatten();
        opened.preset.parts.up = given.unwrap_or(opened.preset.parts.up);
        given.is_some()
    }

    /// Takes the axis of the open model once it is another one than when the model was opened, as
    /// `filed` has it.
    pub fn follow(&mut self, open: &PresetFile, filed: &PresetFile) {
        let [up, before] = [open, filed].map(|file| file.preset.parts.up);
        if (up != before || !self.0.is_empty())
            && let Some(model) = model(open)
            && up != UpAxis::Auto
            && up != self.0.get(&model).copied().unwrap_or(before)
        {
            self.0.insert(model, up);
        }
    }
}

/// The model that is shown, where no file of a preset keeps its axis.
fn model(open: &PresetFile) -> Option<String> {
    match &open.preset.scene {
        SceneSource::File(model) if open.path.is_none() => {
            Some(disk::absolute(model).ok()?.to_str()?.to_owned())
        }
        _ => None,
    }
}

impl TryFrom<BTreeMap<String, String>> for UpAxes {
    type Error = String;

    fn try_from(words: BTreeMap<String, String>) -> Result<Self, String> {
        let axis = |(model, word): (String, String)| {
            let mut axes = UpAxis::ALL.into_iter();
            let found = axes.find(|axis| axis.word() == word);
            let axis = found.ok_or_else(|| format!("it takes {}", UpAxis::WORDS.join(", ")))?;
            Ok((model, axis))
        };
        words
            .into_iter()
            .map(axis)
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

impl From<UpAxes> for BTreeMap<String, String> {
    fn from(axes: UpAxes) -> Self {
        let word = |(model, axis): (String, UpAxis)| (model, axis.word().to_owned());
        axes.0.into_iter().map(word).collect()
    }
}
