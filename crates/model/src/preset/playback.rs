//! Clocks of presets, and how clips of a model play.

use super::*;

/// Which animation clips of a scene play, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipPlayback {
    /// Name of the clip; empty: none.
    pub clip: String,
    /// Seconds of the clips that pass in one second of the clock.
    pub speed: f64,
    /// Freezes the clips at this time.
    pub clip_time_s: Option<f64>,
    /// Name of a second clip to blend with; empty: none.
    pub second_clip: String,
    /// Weight of the second clip, 0 to 1.
    pub blend: f64,
}

impl Default for ClipPlayback {
    fn default() -> Self {
        Self {
            clip: String::new(),
            speed: 1.0,
            clip_time_s: None,
            second_clip: String::new(),
            blend: 0.0,
        }
    }
}

/// A variant, clip or camera that a scene does not have.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{key}: the scene has no {what} {name:?}{known}")]
pub struct MissingInScene {
    pub key: &'static str,
    pub what: &'static str,
    pub name: String,
    /// `; it has "Walk", "Run"`.
    pub known: String,
}

/// `; it has "Walk", "Run"`, or `; <none>` where there are no names.
pub(super) fn list_names<'a>(names: impl Iterator<Item = &'a String>, none: &str) -> String {
    let names: Vec<String> = names.take(12).map(|name| format!("{name:?}")).collect();
    if names.is_empty() {
        format!("; {none}")
    } else {
        format!("; it has {}", names.join(", "))
    }
}

impl ClipPlayback {
    /// Does a clip play with the clock?
    pub fn is_moving(&self) -> bool {
        !self.clip.is_empty() && self.clip_time_s.is_none() && self.speed != 0.0
    }

    /// Does the scene have the clips?
    /// Errors: the first clip that is missing.
    pub fn check(&self, scene: &Scene) -> Result<(), MissingInScene> {
        for (key, name) in [
            ("scene.clip", &self.clip),
            ("scene.second_clip", &self.second_clip),
        ] {
            if !name.is_empty() && scene.rig.clip(name).is_none() {
                let known = list_names(
                    scene.rig.clips.iter().map(|clip| &clip.name),
                    "it has no clips",
                );
                return Err(MissingInScene {
                    key,
                    what: "clip",
                    name: name.clone(),
                    known,
                });
            }
        }
        Ok(())
    }
}

/// The time of a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the picture.
    pub time_s: f64,
    /// Begin and end of the timeline and of a sequence; the end comes later than the begin and is
    /// not drawn.
    pub range_s: [f64; 2],
    /// Starts again at the begin of the range after its end.
    pub is_looping: bool,
    /// Seconds of the clock that pass in one second of playback, above 0.
    pub speed: f64,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            range_s: [0.0, 4.0],
            is_looping: true,
            speed: 1.0,
        }
    }
}

impl Clock {
    /// The time of the clock `passed_s` seconds of playback after `time_s`, and whether it
    /// continues from there. A time before the range runs into it.
    pub fn after(&self, time_s: f64, passed_s: f64) -> (f64, bool) {
        let [from_s, to_s] = self.range_s;
        let next_s = time_s + passed_s * self.speed;
        if next_s < to_s {
            return (next_s, true);
        }
        if !self.is_looping {
            return (to_s, false);
        }
        // The remainder of a tiny negative number may round up to the length of the range.
        let wrapped_s = from_s + (next_s - from_s).rem_euclid(to_s - from_s);
        (if wrapped_s < to_s { wrapped_s } else { from_s }, true)
    }
}
