//! Landing: the look of one preset on the scene of another.
//!
//! To the scene belong: what is shown (`scene.builtin` or `scene.path`) with its parts, `spin_deg_per_s`, the clips
//! and how they play, the cameras, and the size of the picture, whose frame the camera fills. To the
//! look belongs everything else: the effects with their parameters (lights among them), keyframes,
//! polyline and unit, the clock, the accuracy, the background, what the scene stands on (ground and
//! room), and the height that lengths in pixels are of. A golden is a picture of both, so what has
//! landed has none.

use super::{Output, Preset};

impl Preset {
    /// This look on the scene of `own`. Lengths and points stay as they are; see
    /// [`Preset::fitted`].
    #[must_use]
    pub fn applied_to(&self, own: &Self) -> Self {
        // Every field is named, so that a new one must be given to the scene or to the look.
        let Self {
            scene,
            parts,
            spin_deg_per_s,
            playback,
            origin,
            camera,
            scene_camera,
            bookmarks,
            output: Output { size, .. },
            ..
        } = own.clone();
        let Self {
            name,
            about,
            tags,
            unit,
            polyline,
            clock,
            stack,
            animation,
            accuracy,
            mut output,
            ground,
            room,
            surroundings,
            ..
        } = self.clone();
        output.resize(size);
        Self {
            name,
            about,
            tags,
            scene,
            parts,
            room,
            surroundings,
            ground,
            spin_deg_per_s,
            playback,
            unit,
            polyline,
            origin,
            camera,
            scene_camera,
            bookmarks,
            clock,
            stack,
            animation,
            accuracy,
            output,
            test: None,
        }
    }

    /// What of this preset's own scene its look needs and cannot take along to the scene of `own`,
    /// a sentence each. Parts that the scene lacks are told by [`Preset::missing_parts`].
    pub fn left_out_on(&self, own: &Self) -> Vec<String> {
        let (clip, own_clip) = (&self.playback.clip, &own.playback.clip);
        let is_left = !clip.is_empty() && own_clip.is_empty();
        let clip =
            format!("scene.clip {clip:?} was left out; choose one that this model has, if any");
        is_left.then_some(clip).into_iter().collect()
    }
}
