//! The picture of what surrounds a scene (`scene.surroundings`): a file in the folder of the preset,
//! one of the built-in presets, or base64 inside the text of the preset.

use std::{
    borrow::Cow,
    path::{Component, Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    atomic::{Existing, write_atomically},
    file::{PresetFile, model_path},
    gallery::BUILTIN_DIR,
    hash::Fnv,
};
use crate::{
    host::{disk, stays_inside},
    scene::{panorama::Panorama, radiance},
};

/// What a picture begins with that stands in the text of a preset, as base64.
const EMBEDDED: &str = "data:image/vnd.radiance;base64,";
/// Most bytes of a file that a preset takes into its text when it is shared.
const MAX_EMBEDDED_BYTES: usize = 384 << 10;
/// The ending of such files.
pub const EXTENSION: &str = "hdr";

/// A picture, and what the user should know of it.
#[derive(Clone)]
pub struct Surroundings {
    pub panorama: Arc<Panorama>,
    pub note: Option<String>,
}

/// The picture that was prepared last, by the hash and number of its bytes: scenes are loaded again
/// more often than pictures change.
static LAST: Mutex<Option<((Fnv, usize), Surroundings)>> = Mutex::new(None);

/// Loads the picture that a preset at `preset_path`, or in the current folder, names; none for an
/// empty name.
///
/// # Errors
/// Completes a sentence that begins with the picture: it is not in the folder, no picture, or too
/// large. The work was canceled.
pub fn load(named: &str, preset_path: Option<&Path>) -> Result<Option<Surroundings>, String> {
    if named.is_empty() {
        return Ok(None);
    }
    let bytes = bytes_of(named, preset_path)?;
    let of = (Fnv::new().bytes(&bytes), bytes.len());
    let last = LAST.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if let Some((_, known)) = last.filter(|(known, _)| *known == of) {
        return Ok(Some(known));
    }
    let picture = radiance::read(&bytes)?;
    let panorama = Panorama::of(&picture).map_err(|canceled| canceled.to_string())?;
    let note = (picture.clamped > 0).then(|| {
        format!(
            "{} has {} pixels that are brighter than {}, which they count as",
            shown(named),
            picture.clamped,
            radiance::BRIGHTEST
        )
    });
    let surroundings = Surroundings {
        panorama: Arc::new(panorama),
        note,
    };
    *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some((of, surroundings.clone()));
    Ok(Some(surroundings))
}

/// A picture as people are told of it.
pub fn shown(named: &str) -> &str {
    if named.starts_with(EMBEDDED) {
        "the picture inside the preset"
    } else {
        named
    }
}

fn bytes_of(named: &str, preset_path: Option<&Path>) -> Result<Cow<'static, [u8]>, String> {
    if let Some(base64) = named.strip_prefix(EMBEDDED) {
        let bytes = STANDARD.decode(base64);
        return bytes
            .map(Cow::Owned)
            .map_err(|_| "is cut off or garbled; name an .hdr file instead".into());
    }
    let path = Path::new(named);
    if !stays_inside(path) {
        return Err("lies outside of the folder of the preset; put the .hdr beside the preset and write its name alone".into());
    }
    if !is_picture(path) {
        return Err("is no .hdr file; name a Radiance picture".into());
    }
    let place = model_path(path, preset_path);
    let absent =
        |error: std::io::Error| format!("cannot be read: {error}; put the .hdr beside the preset");
    let size = match disk::size_of(&place) {
        Ok(size) => size.ok_or("is no regular file; name an .hdr file")?,
        Err(error) => {
            let built_in = BUILTIN_DIR.get_file(path);
            let built_in = built_in.map(|file| Cow::Borrowed(file.contents()));
            return built_in.ok_or_else(|| absent(error));
        }
    };
    let folder = match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // A folder below that of the preset is inside, too.
    let folder = folder.ancestors().nth(folders_of(path)).unwrap_or(folder);
    let leads_out = || -> std::io::Result<bool> {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        Ok(!disk::canonical(&place)?.starts_with(disk::canonical(folder)?))
    };
    if leads_out().map_err(absent)? {
        return Err("is a link that leads out of the folder of the preset; put the .hdr itself beside the preset".into());
    }
    if size > radiance::MAX_BYTES {
        return Err(format!(
            "has {size} bytes; allowed: at most {}",
            radiance::MAX_BYTES
        ));
    }
    disk::read(&place).map(Cow::Owned).map_err(absent)
}

/// Folders of a relative path: 0 for `a.hdr` and `./a.hdr`.
fn folders_of(path: &Path) -> usize {
    let names = path.components().filter(|part| *part != Component::CurDir);
    names.count().saturating_sub(1)
}

fn is_picture(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// Names of the pictures that a preset at `preset_path`, or in the current folder, may name: those
/// beside it, and those of the built-in presets.
pub fn known(preset_path: Option<&Path>) -> Vec<String> {
    let folder = model_path(Path::new("."), preset_path);
    let beside = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let built_in = BUILTIN_DIR.files().map(|file| file.path().to_owned());
    let mut names: Vec<String> = beside
        .map(|entry| PathBuf::from(entry.file_name()))
        .chain(built_in)
        .filter(|name| is_picture(name))
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    names.sort();
    names.dedup();
    names
}

impl PresetFile {
    /// The file of the picture of surroundings, if the preset names one.
    pub fn surroundings_path(&self) -> Option<PathBuf> {
        let named = &self.preset.surroundings;
        let is_file = !named.is_empty() && !named.starts_with(EMBEDDED);
        is_file.then(|| model_path(Path::new(named), self.path.as_deref()))
    }

    /// `scene.surroundings` as it can be read anywhere: a picture of the folder of the preset is
    /// inside, where it can be read and is not too large.
    pub fn shared_surroundings(&self) -> String {
        let named = &self.preset.surroundings;
        match bytes_of(named, self.path.as_deref()) {
            Ok(Cow::Owned(bytes)) if !named.is_empty() && bytes.len() <= MAX_EMBEDDED_BYTES => {
                format!("{EMBEDDED}{}", STANDARD.encode(bytes))
            }
            _ => named.clone(),
        }
    }

    /// `scene.surroundings` for this preset as it is saved at `to`: its picture is put beside it where
    /// none is. One that is there stays; if it is another, the picture is inside the preset.
    pub(super) fn surroundings_beside(&self, to: &Path) -> String {
        let named = &self.preset.surroundings;
        let stays = self
            .path
            .as_deref()
            .is_some_and(|path| path.parent() == to.parent());
        if stays || named.is_empty() || named.starts_with(EMBEDDED) {
            return named.clone();
        }
        let bytes = match bytes_of(named, self.path.as_deref()) {
            Ok(Cow::Owned(bytes)) => bytes,
            _ => return named.clone(),
        };
        let place = model_path(Path::new(named), Some(to));
        let is_there = || match bytes_of(named, Some(to)) {
            Ok(there) if *there == bytes => true,
            Ok(Cow::Owned(_)) => false,
            _ => {
                // A folder that cannot be made is one that cannot be written to.
                let _ = place.parent().map(std::fs::create_dir_all);
                write_atomically(&place, &bytes, Existing::Keep).is_ok()
            }
        };
        match is_there() {
            true => named.clone(),
            false => self.shared_surroundings(),
        }
    }
}
