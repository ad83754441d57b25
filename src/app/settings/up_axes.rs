//! The axes that the person chose to be up in models, for when those are opened again.

use std::fmt;

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, MapAccess, Visitor},
};

use crate::{host::disk, preset::SceneSource, preset_file::PresetFile, scene::UpAxis};

/// Models that are remembered.
const CAPACITY: usize = 200;

/// For absolute paths of models, the axis that was chosen to be up; the newest last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UpAxes(Vec<(String, UpAxis)>);

impl UpAxes {
    fn get(&self, model: &str) -> Option<UpAxis> {
        let known = self.0.iter().find(|(known, _)| known == model);
        known.map(|(_, axis)| *axis)
    }

    /// Puts a model last, and forgets the oldest beyond [`CAPACITY`].
    fn add(&mut self, model: String, axis: UpAxis) {
        self.0.retain(|(known, _)| *known != model);
        self.0.push((model, axis));
        self.0.drain(..self.0.len().saturating_sub(CAPACITY));
    }

    /// Gives a model that is opened the axis that was chosen for it, if none is named. Returns
    /// whether it did.
    pub fn give(&self, opened: &mut PresetFile) -> bool {
        let is_open = opened.preset.parts.up == UpAxis::Auto;
        let chosen = || self.get(&model(opened)?);
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
            && up != self.get(&model).unwrap_or(before)
        {
            self.add(model, up);
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

impl Serialize for UpAxes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.iter().map(|(model, axis)| (model, axis.word())))
    }
}

impl<'de> Deserialize<'de> for UpAxes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Reader)
    }
}

struct Reader;

impl<'de> Visitor<'de> for Reader {
    type Value = UpAxes;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of models")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<UpAxes, M::Error> {
        let mut axes = UpAxes::default();
        while let Some((model, word)) = map.next_entry::<_, String>()? {
            let axis = UpAxis::ALL.into_iter().find(|axis| axis.word() == word);
            let takes = || M::Error::custom(format_args!("it takes {}", UpAxis::WORDS.join(", ")));
            axes.add(model, axis.ok_or_else(takes)?);
        }
        Ok(axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_models_are_kept_in_order() {
        let mut axes = UpAxes::default();
        (0..CAPACITY + 7).for_each(|i| axes.add(format!("/{i}.ply"), UpAxis::Z));
        axes.add("/9.ply".into(), UpAxis::X);
        let text = toml_edit::ser::to_string(&axes).expect("TOML");
        let read: UpAxes = toml_edit::de::from_str(&text).expect("a table");
        assert_eq!(read, axes);
        assert_eq!((axes.0.len(), &*axes.0[0].0), (CAPACITY, "/7.ply"));
        assert_eq!(axes.0.last(), Some(&("/9.ply".into(), UpAxis::X)));
    }
}
