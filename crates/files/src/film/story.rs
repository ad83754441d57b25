//! What a film shows: a preset from moment to moment.

use std::sync::Arc;

use super::{
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
    /// The camera of a turntable where the preset has an automatic one.
    around: Option<Camera>,
    scene_hash: Fnv,
}

impl Film {
    /// # Errors
    /// The preset cannot be saved in a picture.
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
            around,
        };
        film.at(film.schedule.frames.end - 1).check_savable()?;
        Ok(film)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.preset_file.preset.output.size
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

    /// The preset at the time of a frame, with the turn of a turntable.
    pub fn at(&self, frame: u32) -> PresetFile {
        let mut preset_file = self.preset_file.clone();
        let preset = &mut preset_file.preset;
        preset.clock.time_s = self.schedule.time_s(frame);
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
