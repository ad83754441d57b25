//! Session: everything a look says, as plain data that is always finite, and the view it describes.
//!
//! `Clone + PartialEq`, so undo is a list of sessions. Playback, window layout and overlays live elsewhere.

use std::path::PathBuf;

use glam::{DMat4, DVec3};

use crate::{
    effects::Stack,
    math::rotation_y,
    scene::{
        Scene,
        camera::{Camera, View},
    },
};
pub use crate::{
    plan::{Accuracy, Tier},
    shader::key::Visibility,
};

/// Which scene a look shows.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// A procedural scene by its query, for instance `teapot?tess=16`.
    Builtin(String),
    /// A model file; relative paths are relative to the look's own folder.
    File(PathBuf),
}

/// The time of a look.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    pub time_s: f64,
}

/// The picture to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Width and height in pixels, each 0 to 16,384.
    pub size: [u32; 2],
    /// Linear RGBA.
    pub background: [f32; 4],
}

impl Default for Output {
    fn default() -> Self {
        Self { size: [320, 240], background: [0.012, 0.014, 0.02, 1.0] }
    }
}

/// What a golden of this look may differ by; a look without it has no golden.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// Largest difference of a channel of 255.
    pub max_channel: u8,
    /// Pixels that may differ by more.
    pub max_pixels: u32,
    /// Why a budget above the default is needed.
    pub why: String,
}

impl Default for Test {
    fn default() -> Self {
        Self { max_channel: 1, max_pixels: 0, why: String::new() }
    }
}

/// A look.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Shown; the file stem is the id.
    pub name: String,
    pub about: String,
    pub tags: Vec<String>,
    pub scene: SceneSource,
    /// Turns the whole scene about +y.
    pub spin_deg_per_s: f64,
    /// None: framed so that the whole scene shows.
    pub camera: Option<Camera>,
    pub clock: Clock,
    pub stack: Stack,
    pub accuracy: Accuracy,
    pub output: Output,
    pub test: Option<Test>,
}

impl Default for Session {
    fn default() -> Self {
        Self {
            name: String::new(),
            about: String::new(),
            tags: Vec::new(),
            scene: SceneSource::Builtin("teapot".into()),
            spin_deg_per_s: 0.0,
            camera: None,
            clock: Clock::default(),
            stack: Stack::default(),
            accuracy: Accuracy::default(),
            output: Output::default(),
            test: None,
        }
    }
}

/// Where a look without a camera stands: in front, a little to the right and above.
pub const FRAMING_DIRECTION: DVec3 = DVec3::new(-0.45, -0.42, -1.0);

impl Session {
    /// The camera of the look, or the pose that frames `scene`.
    pub fn camera_for(&self, scene: &Scene, aspect: f64) -> Camera {
        self.camera
            .or_else(|| scene.cameras.first().map(|c| c.pose))
            .unwrap_or_else(|| Camera::framing(&scene.bounds(), FRAMING_DIRECTION, aspect))
    }

    /// The view of `scene` on a target of `size` pixels, its depths ranging as far as the effects may move anything.
    pub fn view(&self, scene: &Scene, [width, height]: [u32; 2]) -> View {
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        // Reduced before the trigonometry, so that a day of spinning costs no precision.
        let turns = self.spin_deg_per_s * self.clock.time_s / 360.0;
        let spin = if turns == 0.0 { DMat4::IDENTITY } else { rotation_y(turns.fract() * std::f64::consts::TAU) };
        let mut bounds = scene.bounds();
        if !bounds.is_empty() {
            let reach_m = self.stack.reach_m(bounds.radius());
            (bounds.min, bounds.max) = (bounds.min - reach_m, bounds.max + reach_m);
        }
        View::new(&self.camera_for(scene, aspect), width, height, &bounds, spin, self.output.background)
    }
}
