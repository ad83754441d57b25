//! The preset that the window opens with, and saving it when the device is lost. Settings and
//! sessions: see `settings`.

use std::path::PathBuf;

use crate::{
    app::{
        editing::{session::Session, trust::Trust},
        settings::{
            keeper::{Keeper, PreviousSession},
            last_session::Restored,
        },
        shell::log::{Level, Log},
    },
    preset::SceneSource,
    preset_file::{self, Folders, PresetFile},
};

/// The preset of a window that was opened without one; it plays, except on a software adapter.
pub const FIRST_PRESET: &str = "hero-day";

/// What the window begins with.
pub struct Start {
    pub session: Session,
    /// It is that of the last time.
    pub is_restored: bool,
    /// A preset that brings code, or names a model outside of its folder, which the user has not
    /// allowed yet.
    pub asks: Option<PresetFile>,
    /// What a crash left, to be asked about.
    pub crashed: Option<Box<Restored>>,
}

/// What the window begins with: what it was asked to open, or the last session if it was asked for
/// nothing. After a crash, and until the user has decided about code that a preset brings, the
/// first preset is shown.
pub fn start(
    opened: Option<PresetFile>,
    open: Option<&str>,
    folders: &Folders,
    (keeper, trust): (&Keeper, &Trust),
    log: &mut Log,
) -> Start {
    let previous = if opened.is_none() && open.is_none() {
        keeper.previous_session(folders)
    } else {
        PreviousSession::None
    };
    let (mut filed, mut crashed) = (None, None);
    let first = match previous {
        PreviousSession::Closed(restored) => {
            restored
                .preset_file
                .remarks()
                .into_iter()
                .for_each(|remark| log.add(Level::Warning, remark));
            filed = Some(restored.filed);
            restored.preset_file
        }
        PreviousSession::Crashed(restored) => {
            crashed = Some(restored);
            first_preset(None, None, folders, log)
        }
        PreviousSession::Lost(reason) => {
            log.notify(
                Level::Warning,
                format!("The last session cannot be opened again: {reason}"),
                0.0,
            );
            first_preset(None, None, folders, log)
        }
        PreviousSession::None => first_preset(opened, open, folders, log),
    };
    if first.outside_model.is_some() || !trust.allows(&first, &folders.effects) {
        let session = Session::new(first_preset(None, None, folders, log));
        return Start {
            session,
            is_restored: false,
            asks: Some(first),
            crashed,
        };
    }
    let is_restored = filed.is_some();
    let mut session = Session::new(filed.unwrap_or_else(|| first.clone()));
    session.preset_file = first;
    Start {
        session,
        is_restored,
        asks: None,
        crashed,
    }
}

/// The preset to begin with: one that is open already, or `open`. If it cannot be opened, the error
/// is logged and the teapot is shown.
fn first_preset(
    opened: Option<PresetFile>,
    open: Option<&str>,
    folders: &Folders,
    log: &mut Log,
) -> PresetFile {
    let what = open.unwrap_or(FIRST_PRESET);
    match opened.map_or_else(|| preset_file::open(what, folders), Ok) {
        Ok(mut preset_file) => {
            preset_file
                .remarks()
                .into_iter()
                .for_each(|remark| log.add(Level::Warning, remark));
            // A recovered preset is not saved to the recovery file: Save asks for another.
            preset_file.read_only |=
                preset_file.path.is_some() && preset_file.path == recovery_path();
            preset_file
        }
        Err(error) => {
            if open.is_some() {
                log.notify(Level::Error, error.to_string(), 0.0);
            }
            // The user did not choose this scene, so presets bring their own.
            let mut fallback =
                PresetFile::of_scene("teapot", SceneSource::Builtin("teapot".into()));
            fallback.chose_scene = false;
            fallback
        }
    }
}

/// The file that the preset is saved to when the device is lost.
pub fn recovery_path() -> Option<PathBuf> {
    Some(config_folder()?.join("recovery.toml"))
}

/// The folder of the user's configuration of this program, with settings and session.
pub fn config_folder() -> Option<PathBuf> {
    Some(preset_file::user_folder()?.parent()?.to_owned())
}

/// Saves the preset for the next start. Returns in words whether that worked. A page has its session
/// for that.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_recovery(preset_file: &PresetFile) -> String {
    use std::path::Path;

    use anyhow::Context as _;

    let written = || -> anyhow::Result<PathBuf> {
        let path = recovery_path().context("there is no folder for it")?;
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        preset_file::save(&mut preset_file.clone(), &path)?;
        Ok(path)
    };
    match written() {
        Ok(path) => format!("the preset is saved in {}", path.display()),
        Err(error) => format!("the preset could not be saved: {error:#}"),
    }
}
