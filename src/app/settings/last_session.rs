//! The last session: which preset or model was open, with its unsaved edits, as `session.toml`.
//!
//! The window keeps the file while it runs, marked as running, and marks it as closed when it ends.
//! A file that is still marked as running when no window runs was left by a crash.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use toml_edit::DocumentMut;

use crate::{
    app::picture::review::KeptReview,
    host::disk,
    preset::SceneSource,
    preset_file::{self, Folders, Look, PresetFile},
};

/// What was open.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LastSession {
    /// The window that wrote it has not closed in order.
    #[serde(rename = "running")]
    pub is_running: bool,
    id: String,
    /// The file of the preset; none for built-in, pasted and new ones.
    path: Option<PathBuf>,
    #[serde(rename = "read_only", default)]
    is_read_only: bool,
    /// The preset without the edits, as TOML.
    filed: String,
    /// The preset with the edits; none without any.
    edited: Option<String>,
    /// The preset whose look is shown on a scene that the user chose.
    look: Option<Look>,
    /// The review of goldens.
    #[serde(default, skip_serializing_if = "KeptReview::is_empty")]
    pub review: KeptReview,
}

/// A preset that was open, to be opened again.
#[derive(Clone, Debug)]
pub struct Restored {
    /// With the edits.
    pub preset_file: PresetFile,
    /// As its file had it.
    pub filed: PresetFile,
}

impl Restored {
    pub fn has_edits(&self) -> bool {
        self.preset_file.preset != self.filed.preset
    }
}

impl LastSession {
    /// What is open now: the preset, and how its file has it.
    pub fn of(open: &PresetFile, filed: &PresetFile) -> Self {
        let edited =
            (open.preset != filed.preset).then(|| preset_file::to_shared_toml(&absolute(open)));
        Self {
            is_running: true,
            id: open.id.clone(),
            path: open
                .path
                .as_deref()
                .and_then(|path| disk::absolute(path).ok())
                .map(|path| path.to_string_lossy().into_owned().into()),
            is_read_only: open.read_only,
            filed: preset_file::to_shared_toml(&absolute(filed)),
            edited,
            // TOML holds no other paths.
            look: open.look.clone().filter(|look| {
                let path = look.path.as_ref();
                path.is_none_or(|path| path.to_str().is_some())
            }),
            review: KeptReview::default(),
        }
    }

    /// The same with a review of goldens.
    #[must_use]
    pub fn with_review(mut self, review: KeptReview) -> Self {
        self.review = review;
        self
    }

    /// The preset with its edits, as TOML.
    #[cfg(target_arch = "wasm32")]
    pub fn text(&self) -> &str {
        self.edited.as_ref().unwrap_or(&self.filed)
    }

    /// The same, closed in order.
    #[must_use]
    pub fn closed(mut self) -> Self {
        self.is_running = false;
        self
    }

    /// The same without the edits, which the user has discarded.
    #[must_use]
    pub fn without_edits(mut self) -> Self {
        self.edited = None;
        self
    }

    /// The empty document of a session.
    pub fn document() -> DocumentMut {
        let mut document = DocumentMut::new();
        document
            .decor_mut()
            .set_prefix("# What was open in the window of rasterlab when it ran last.\n");
        document
    }

    /// Reads a file.
    ///
    /// # Errors
    /// It is no session: why, in one line.
    pub fn parse(text: &str, file: &str) -> Result<Self, String> {
        toml_edit::de::from_str(text)
            .map_err(|error| format!("{file}: {}", error.message().replace('\n', " ")))
    }

    /// The preset that was open, with its edits. Without edits its file is read again.
    ///
    /// # Errors
    /// The file or the model of the preset is gone, or the texts cannot be read: why, in one line.
    pub fn restore(&self, folders: &Folders) -> Result<Restored, String> {
        let name = self
            .path
            .as_ref()
            .map_or_else(|| self.id.clone(), |path| path.display().to_string());
        let there = self
            .path
            .as_ref()
            .map(|path| preset_file::open(&path.to_string_lossy(), folders));
        let reread = match (&self.edited, &there) {
            (None, Some(Ok(there))) => Some(there.clone()),
            (None, Some(Err(error))) => return Err(error.to_string()),
            (None, None) if self.is_read_only => preset_file::open(&self.id, folders).ok(),
            _ => None,
        };
        let filed = match reread {
            // The user has allowed the model that was shown then.
            Some(reread) if reread.outside_model.is_some() => {
                let then = self.parsed(&self.filed, &name, Some(&reread), folders)?;
                let is_same = matches!(then.scene_source(), SceneSource::File(model)
                    if preset_file::normalized(&model) == reread.outside_model);
                if is_same {
                    reread.with_outside_model()
                } else {
                    reread
                }
            }
            Some(reread) => reread,
            // The text of then: if another program has changed the file since, saving asks what to
            // do.
            None => self.parsed(
                &self.filed,
                &name,
                there.and_then(Result::ok).as_ref(),
                folders,
            )?,
        };
        let preset_file = match &self.edited {
            Some(edited) => {
                let edited = self.parsed(edited, &name, Some(&filed), folders)?;
                let mut open = filed.clone();
                (open.preset, open.effects, open.brought_effects) =
                    (edited.preset, edited.effects, edited.brought_effects);
                open
            }
            None => filed.clone(),
        };
        match missing_model(&preset_file) {
            Some(model) => Err(format!("{name}: its model {} is gone", model.display())),
            None => Ok(Restored { preset_file, filed }),
        }
    }

    /// The preset of a text, with the effects of `known`.
    fn parsed(
        &self,
        text: &str,
        name: &str,
        known: Option<&PresetFile>,
        folders: &Folders,
    ) -> Result<PresetFile, String> {
        let effects = known.map_or(&folders.effects, |known| &known.effects);
        let mut parsed = preset_file::parse_with(text, &self.id, name, effects)
            .map_err(|error| error.to_string())?;
        (parsed.path, parsed.read_only) = (self.path.clone(), self.is_read_only);
        (parsed.look, parsed.chose_scene) = (self.look.clone(), self.look.is_some());
        Ok(parsed)
    }
}

/// The preset with an absolute path of its model, if nothing else says where a relative one starts.
fn absolute(preset_file: &PresetFile) -> PresetFile {
    let mut preset_file = preset_file.clone();
    if preset_file.path.is_none()
        && let SceneSource::File(model) = &preset_file.preset.scene
        && let Ok(model) = disk::absolute(model)
    {
        preset_file.preset.scene = SceneSource::File(model);
    }
    preset_file
}

/// The model of the preset, if it is not there.
fn missing_model(preset_file: &PresetFile) -> Option<PathBuf> {
    let SceneSource::File(model) = &preset_file.preset.scene else {
        return None;
    };
    let folder = preset_file
        .path
        .as_deref()
        .and_then(Path::parent)
        .unwrap_or(Path::new(""));
    Some(folder.join(model)).filter(|model| !disk::exists(model))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_back(open: &PresetFile, filed: &PresetFile) -> LastSession {
        let session = LastSession::of(open, filed);
        let text = toml_edit::ser::to_string(&session).expect("TOML");
        let read = LastSession::parse(&text, "session.toml").expect("a session");
        assert_eq!(read, session);
        read
    }

    fn edited(filed: &PresetFile) -> PresetFile {
        let mut open = filed.clone();
        open.preset.spin_deg_per_s = 12.5;
        open
    }

    #[test]
    fn a_built_in_preset_comes_back_with_its_edits() {
        let folders = Folders::default();
        let filed = preset_file::open("facet-sweep", &folders).expect("a built-in preset");
        let open = edited(&filed);
        let restored = read_back(&open, &filed)
            .restore(&folders)
            .expect("it is restored");
        assert_eq!(
            (&restored.preset_file.preset, &restored.filed.preset),
            (&open.preset, &filed.preset)
        );
        assert_eq!(
            (
                restored.preset_file.id.as_str(),
                restored.preset_file.read_only,
                restored.has_edits()
            ),
            ("facet-sweep", true, true)
        );

        let discarded = read_back(&open, &filed)
            .without_edits()
            .restore(&folders)
            .expect("it is restored");
        assert!(!discarded.has_edits() && discarded.preset_file.preset == filed.preset);
    }

    #[test]
    fn the_edits_of_a_file_that_another_program_changed_come_back_on_the_text_of_then() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("mine.toml");
        std::fs::write(&path, "schema = 2\n[effects.facet]\namount = 0.5\n").expect("a file");
        let folders = Folders::default();
        let filed = preset_file::load(&path).expect("a preset");
        let open = edited(&filed);
        let session = read_back(&open, &filed);
        std::fs::write(&path, "schema = 2\n[effects.facet]\namount = 0.75\n").expect("a file");
        let restored = session.restore(&folders).expect("it is restored");
        assert_eq!(
            (
                &restored.preset_file.preset,
                restored.preset_file.path.as_deref()
            ),
            (&open.preset, Some(path.as_path()))
        );
        assert!(
            !preset_file::load(&path)
                .expect("a preset")
                .has_text_of(&restored.preset_file),
            "saving would not ask"
        );
        // Without edits the file counts.
        let reread = session
            .without_edits()
            .restore(&folders)
            .expect("it is restored");
        assert_eq!(
            reread.preset_file.preset,
            preset_file::load(&path).expect("a preset").preset
        );
    }

    #[test]
    fn a_model_without_a_preset_comes_back_and_one_that_is_gone_is_named() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = folder.path().join("fox.glb");
        std::fs::write(&model, b"glTF").expect("a file");
        let folders = Folders::default();
        let filed = preset_file::open(&model.to_string_lossy(), &folders).expect("a model");
        let open = edited(&filed);
        let session = read_back(&open, &filed);
        let restored = session.restore(&folders).expect("it is restored");
        assert_eq!(
            (&restored.preset_file.preset, &restored.preset_file.path),
            (&open.preset, &None)
        );
        assert!(restored.preset_file.is_look_of("plain", None));
        std::fs::remove_file(&model).expect("it is there");
        let error = session.restore(&folders).expect_err("the model is gone");
        assert!(error.contains("fox.glb is gone"), "{error}");
    }

    #[test]
    fn a_preset_that_is_gone_is_named_unless_it_was_edited() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("mine.toml");
        std::fs::write(&path, "schema = 2\n[effects.facet]\n").expect("a file");
        let filed = preset_file::load(&path).expect("a preset");
        let folders = Folders::default();
        std::fs::remove_file(&path).expect("it is there");
        let error = LastSession::of(&filed, &filed)
            .restore(&folders)
            .expect_err("the preset is gone");
        assert!(
            error.contains("mine.toml") && error.lines().count() == 1,
            "{error}"
        );
        let open = edited(&filed);
        assert_eq!(
            LastSession::of(&open, &filed)
                .restore(&folders)
                .expect("its edits are there")
                .preset_file
                .preset,
            open.preset
        );
    }

    #[test]
    fn a_broken_file_is_one_line() {
        for text in [
            "running = ",
            "running = true\n",
            "",
            "running = 1\nid = \"a\"\nfiled = \"\"\n",
        ] {
            let error = LastSession::parse(text, "session.toml").expect_err("it is broken");
            assert!(
                error.starts_with("session.toml: ") && error.lines().count() == 1,
                "{error}"
            );
        }
    }
}
