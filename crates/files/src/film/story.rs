//! What a film shows: a preset from moment to moment.

use std::sync::Arc;

use super::{
    error::FilmError,
    schedule::Schedule,
    turntable::{Turntable, all_around},
};
use crate::{
    preset::{Preset, SceneSource},
    preset_file::{Fnv, PresetError, PresetFile, hex, preset_hash, scene_hash},
    scene::{Scene, camera::Camera},
};

/// A preset from moment to moment. The size of the film is `output.size` of the preset.
pub struct Film {
    preset_file: PresetFile,
    pub scene: Arc<Scene>,
    pub schedule: Schedule,
    turntable: Option<Turntable>,
    /// The preset that the last frame shows; without one, the film stays with its own.
    toward: Option<PresetFile>,
    /// The camera of a turntable where the preset has an automatic one.
    around: Option<Camera>,
    scene_hash: Fnv,
}

impl Film {
    pub fn new(
        preset_file: PresetFile,
        scene: Arc<Scene>,
        schedule: Schedule,
        turntable: Option<Turntable>,
    ) -> Result<Self, PresetError> {
        let around = turntable
            .filter(|turntable| *turntable == Turntable::Camera)
            .and_then(|_| all_around(&preset_file.preset, &scene));
        let film = Self {
            scene_hash: scene_hash(&scene),
            preset_file,
            scene,
            schedule,
            turntable,
            toward: None,
            around,
        };
        film.at(film.schedule.frames.end - 1).check_savable()?;
        Ok(film)
    }

    /// The same film on the way to `other`: its own preset in the first frame, `other` in the last,
    /// evenly in between; see [`PresetFile::toward`].
    ///
    /// # Errors
    /// They show different scenes, or `other` cannot be saved in a picture.
    pub fn toward(mut self, other: PresetFile) -> Result<Self, FilmError> {
        self.preset_file
            .toward(&other, 1.0, &self.scene)
            .map_err(FilmError::Toward)?
            .check_savable()?;
        self.toward = Some(other);
        Ok(self)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.preset_file.preset.output.size
    }

    /// Do several frames show the same, since nothing moves?
    pub fn is_still(&self) -> bool {
        let is_turned = self.turntable.is_some() || self.toward.is_some();
        self.schedule.total > 1 && !is_turned && !self.preset_file.preset.is_moving()
    }

    pub fn is_looping(&self) -> bool {
        self.preset_file.preset.clock.is_looping
    }

    /// The preset as a whole.
    pub fn preset_file(&self) -> &PresetFile {
        &self.preset_file
    }

    /// The preset at its own moment: a film that stands still shows that, rather than a first frame
    /// in which perhaps nothing is to be seen yet. None if the film begins with that moment.
    pub fn still(&self) -> Option<&PresetFile> {
        let first_s = self.schedule.time_s(self.schedule.frames.start);
        (self.preset_file.preset.clock.time_s != first_s).then_some(&self.preset_file)
    }

    /// A preset at the time of a frame; on the way to another with its values at that time, since
    /// keyframes have nothing in between.
    fn moment(&self, preset_file: &PresetFile, frame: u32) -> PresetFile {
        let mut preset_file = preset_file.clone();
        preset_file.preset.clock.time_s = self.schedule.time_s(frame);
        if self.toward.is_some() {
            preset_file.preset = preset_file.preset.evaluated();
        }
        preset_file
    }

    /// The preset at the time of a frame, as far on the way as the film is, with the turn of a
    /// turntable.
    pub fn at(&self, frame: u32) -> PresetFile {
        let mut preset_file = self.moment(&self.preset_file, frame);
        if let Some(other) = &self.toward {
            let by = f64::from(frame) / f64::from((self.schedule.total - 1).max(1));
            let other = self.moment(other, frame);
            // That both show one scene was checked when the film got its end.
            if let Ok(between) = preset_file.toward(&other, by, &self.scene) {
                preset_file = between;
            }
        }
        let preset = &mut preset_file.preset;
        if let Some(turntable) = self.turntable {
            let fraction = f64::from(frame) / f64::from(self.schedule.total);
            turntable.turn(
                preset,
                &self.scene,
                self.around,
                fraction,
                self.schedule.range_s,
            );
        }
        preset_file
    }

    /// Hash of the preset at a frame, the scene's bytes and the version of this program; not of the
    /// adapter.
    pub fn fingerprint(&self, frame: u32) -> String {
        // The path of the scene differs between machines; the hash of its bytes replaces it.
        let anywhere = Preset {
            scene: SceneSource::Builtin(String::new()),
            ..self.at(frame).preset
        };
        let version = Fnv::new().bytes(env!("CARGO_PKG_VERSION").as_bytes());
        let hashes = [preset_hash(&anywhere).0, self.scene_hash.0];
        hex(hashes
            .iter()
            .fold(version, |hash, part| hash.bytes(&part.to_le_bytes())))
    }
}
