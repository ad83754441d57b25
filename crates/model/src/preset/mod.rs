//! The state of a preset: plain data that is always finite, and the view that it describes.
//!
//! Playback, window layout and overlays are no part of it. [`Preset::evaluated_stack`] is drawn, not
//! the stack itself: keyframes change its values with the time.

pub mod animation;
mod backdrop;
mod bookmark;
mod cloud;
mod fit;
mod fitted;
mod golden_budget;
mod landing;
mod missing_parts;
mod output;
mod particle_timeline;
mod playback;
pub mod polyline;
pub mod rebind;
mod rules;
mod setting;
pub mod settings;
mod toward;

use std::{path::PathBuf, sync::Arc};

use glam::{DMat4, DVec3};

use crate::{
    effects::{
        EnabledEffect, Stack,
        given::{Moment, words_of_view},
    },
    math::{rotation_y, turned_about},
    scene::{
        Bounds, Ground, Scene, SceneCamera,
        camera::{Camera, Frame},
        needs,
        parts::ShownParts,
        pose::{Motion, Pose, scene_from_nodes},
        punctual::{PlacedLight, SceneLight, TOO_STRONG, dimmed},
        shadow_resolution::ShadowResolution,
        view::{SceneState, View},
    },
};
pub use animation::{Animation, Track};
pub use bookmark::{Bookmark, MAX_BOOKMARK_CHARS, MAX_BOOKMARKS, check_bookmark_name};
pub use fit::{Fit, LengthUnit};
pub use golden_budget::GoldenTest;
pub use output::{NAMED_SIZES, Output, named_size};
use playback::list_names;
pub use playback::{ClipPlayback, Clock, MissingInScene};

pub use crate::accuracy::{AccuracyRequest, PinnedOptions, Tier, Visibility};

/// The name of no camera of the scene: the whole scene is framed.
pub const NO_CAMERA: &str = "#none";

/// How far beyond the scene's box particles widen what the automatic camera frames, in radii of it.
const PARTICLES_ASIDE: f64 = 0.35;

/// Which scene a preset shows.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// A procedural scene by its query, for instance `teapot?tess=16`.
    Builtin(String),
    /// A model file; relative paths are relative to the folder of the preset.
    File(PathBuf),
}

/// The state of a preset.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Shown; the file stem is the id.
    pub name: String,
    pub about: String,
    pub tags: Vec<String>,
    pub scene: SceneSource,
    /// Distance of the walls of a room, as a multiple of the scene's width; 0: no room.
    pub room: f64,
    /// The picture of what surrounds the scene: an `.hdr` file in the folder of the preset, or
    /// base64; empty: none.
    pub surroundings: String,
    /// The parts of the scene that are shown.
    pub parts: ShownParts,
    /// What the scene stands on; none: nothing.
    pub ground: Option<Ground>,
    /// Turns the whole scene about +y.
    pub spin_deg_per_s: f64,
    /// The animation clips of the scene.
    pub playback: ClipPlayback,
    /// The unit of the lengths and points of effects, keyframes and polyline.
    pub unit: LengthUnit,
    /// A polyline for effects that draw along lines; it turns with the scene.
    pub polyline: Arc<[[f32; 3]]>,
    /// The point of the scene from which its points count, meters: the file's origin, but as a picture
    /// has it [`Scene::origin`].
    pub origin: DVec3,
    /// None: a camera of the scene, or one that frames the whole scene.
    pub camera: Option<Camera>,
    /// Name of the scene's camera to use without a `camera`; empty: the first; [`NO_CAMERA`]: none.
    pub scene_camera: String,
    /// Cameras under names; the picture shows none of them until `camera` is one.
    pub bookmarks: Vec<Bookmark>,
    pub clock: Clock,
    /// The effects with their values; keyframes change some of them with the time.
    pub stack: Stack,
    /// The keyframes.
    pub animation: Animation,
    pub accuracy: AccuracyRequest,
    pub output: Output,
    pub test: Option<GoldenTest>,
}

impl Default for Preset {
    fn default() -> Self {
        Self {
            name: String::new(),
            about: String::new(),
            tags: Vec::new(),
            scene: SceneSource::Builtin("teapot".into()),
            room: 0.0,
            surroundings: String::new(),
            parts: ShownParts::default(),
            ground: None,
            spin_deg_per_s: 0.0,
            playback: ClipPlayback::default(),
            unit: LengthUnit::default(),
            polyline: Arc::default(),
            origin: DVec3::ZERO,
            camera: None,
            scene_camera: String::new(),
            bookmarks: Vec::new(),
            clock: Clock::default(),
            stack: Stack::default(),
            animation: Animation::default(),
            accuracy: AccuracyRequest::default(),
            output: Output::default(),
            test: None,
        }
    }
}

/// The view direction of a camera that frames the scene: from the front, slightly right and above.
pub const FRAMING_DIRECTION: DVec3 = DVec3::new(-0.45, -0.42, -1.0);

/// Height over width below which a model is looked at from higher.
const FLAT: f64 = 0.3;

/// The points as they come to lie while a scene turns once about a vertical axis through `center`.
pub fn turned_all_around(points: &[DVec3], center: DVec3) -> Vec<DVec3> {
    const SIDES: u32 = 16;
    let turned = |side: u32| {
        let turn = rotation_y(f64::from(side) / f64::from(SIDES) * std::f64::consts::TAU);
        points
            .iter()
            .map(move |point| center + turn.transform_vector3(*point - center))
    };
    (0..SIDES).flat_map(turned).collect()
}

impl Preset {
    /// The stack at the time of the clock, in the unit of the preset. What is drawn is that of
    /// [`Preset::in_meters`].
    pub fn evaluated_stack(&self) -> Stack {
        self.stack_at(self.clock.time_s)
    }

    /// The stack at the time of the clock for a picture of `scene` of this size, with lengths in
    /// meters and in its pixels, which is drawn.
    pub fn stack_on(&self, scene: &Scene, size: [u32; 2]) -> Stack {
        let preset = self.in_meters(scene);
        let stack = preset
            .evaluated_stack()
            .drawn(self.output.length_scale(size[1].into()));
        preset.stack_in_view(stack, scene, size)
    }

    /// The preset as a picture of `scene` of this height draws it: with its values at its time, in
    /// meters and in pixels of that picture.
    pub fn drawn_on(&self, scene: &Scene, height: u32) -> Self {
        let mut drawn = self.in_meters(scene).evaluated();
        drawn.stack = drawn.stack.drawn(self.output.length_scale(height.into()));
        drawn.output.reference_height_px = Some(height.max(1));
        drawn
    }

    /// The stack at another time.
    pub fn stack_at(&self, time_s: f64) -> Stack {
        let moment = Moment {
            time_s,
            range_s: self.clock.range_s,
        };
        let stack = self.animation.evaluate(&self.stack, time_s);
        stack.with_given(|given| moment.words(given))
    }

    /// `stack` for a picture of `scene` of this size.
    fn stack_in_view(&self, stack: Stack, scene: &Scene, size: [u32; 2]) -> Stack {
        if stack
            .0
            .iter()
            .all(|enabled| enabled.effect.given.is_empty())
        {
            return stack;
        }
        let view = self.view(scene, size);
        stack.with_given(|given| words_of_view(given, size, view.eye, view.forward))
    }

    /// The preset with its values at its time and without keyframes, except those that change the
    /// particle simulation. It gives the same picture.
    pub fn evaluated(&self) -> Self {
        Self {
            stack: self.evaluated_stack(),
            animation: self.animation.only(Track::changes_simulation),
            ..self.clone()
        }
    }

    /// Does the picture depend on the time?
    pub fn is_moving(&self) -> bool {
        let keyed = self
            .animation
            .tracks()
            .iter()
            .any(|t| t.keys().len() > 1 && self.stack.get(&t.effect().name).is_some());
        let has_particles = self.stack.particle_settings().is_some();
        let is_given_time = |enabled: &EnabledEffect| enabled.effect.is_given_time();
        let of_time = self.stack.0.iter().any(is_given_time);
        keyed || has_particles || of_time || self.spin_deg_per_s != 0.0 || self.playback.is_moving()
    }

    /// Removes an effect and its keyframes.
    pub fn disable(&mut self, effect: &str) {
        self.stack.disable(effect);
        self.animation.remove_effect(effect);
    }

    /// The clips of `scene` and their time at the time of the clock.
    fn motion(&self, scene: &Scene) -> Motion {
        let clip = |name: &str| scene.rig.clip(name).filter(|_| !name.is_empty());
        Motion {
            clip: clip(&self.playback.clip),
            other: clip(&self.playback.second_clip),
            blend: self.playback.blend,
            time_s: self
                .playback
                .clip_time_s
                .unwrap_or(self.clock.time_s * self.playback.speed),
            skinning: self.accuracy.pins.option().unwrap_or_default(),
        }
    }

    /// The union of `bounds` and the bounds of the particles.
    fn with_particles(&self, mut bounds: Bounds) -> Bounds {
        if let Some(particle_settings) = self.evaluated_stack().particle_settings() {
            let reach = particle_settings.disc_bounds();
            [reach.min, reach.max]
                .into_iter()
                .for_each(|corner| bounds.include(corner + self.origin));
        }
        bounds
    }

    /// The pose of `scene` at the time of the clock; none for a scene without nodes.
    pub fn pose(&self, scene: &Scene) -> Option<Arc<Pose>> {
        (!scene.rig.is_empty()).then(|| Arc::new(Pose::at(scene, &self.motion(scene))))
    }

    /// The lights that come with `scene`, at its moment and after its spin.
    fn lights(&self, scene: &Scene, spin: &DMat4) -> Arc<[PlacedLight]> {
        let moves = scene.lights.iter().any(|light| light.node.is_some());
        let scene_from_node = if moves {
            scene_from_nodes(&scene.rig, &self.motion(scene))
        } else {
            Vec::new()
        };
        let placed = |light: &SceneLight| {
            let node = light.node.map(|node| scene_from_node[node]);
            light.placed(&(*spin * node.unwrap_or(light.world_from_light)))
        };
        scene.lights.iter().map(placed).collect()
    }

    /// Does `scene` have the variant, the clips and the camera that the preset names?
    /// Errors: the first that is missing.
    pub fn check(&self, scene: &Scene) -> Result<(), MissingInScene> {
        let variant = &self.parts.variant;
        if !variant.is_empty() && scene.variant(variant).is_none() {
            return Err(MissingInScene {
                key: "scene.variant",
                what: "variant",
                name: variant.clone(),
                known: list_names(scene.variants.iter(), "it has no variants"),
            });
        }
        let is_named = !["", NO_CAMERA].contains(&&*self.scene_camera);
        if is_named && scene.camera(&self.scene_camera).is_none() {
            let known = list_names(
                scene.cameras.iter().map(|camera| &camera.name),
                "it has no cameras",
            );
            return Err(MissingInScene {
                key: "scene.camera",
                what: "camera",
                name: self.scene_camera.clone(),
                known,
            });
        }
        self.playback.check(scene)
    }

    /// What `studio.lights` must be for the lights of `scene`, which are far too strong for its
    /// picture; none where they are not, or where keyframes lead them.
    pub fn dimmed_lights(&self, scene: &Scene) -> Option<f64> {
        let lights = self.stack.get("studio")?.number("lights");
        let times = scene.glare()?;
        let is_led = self.animation.get("studio", "lights").is_some();
        (!is_led && lights > 2.0 * dimmed(times)).then(|| dimmed(times))
    }

    /// The notes on `scene` without that on its lights where they are dimmed.
    pub fn notes_on<'a>(&self, scene: &'a Scene) -> impl Iterator<Item = &'a String> {
        let is_dimmed = self.dimmed_lights(scene).is_none();
        let holds = move |note: &&String| !(is_dimmed && note.contains(TOO_STRONG));
        scene.notes.iter().filter(holds)
    }

    /// Dims lights of `scene` that are far too strong.
    pub fn dim_lights(&mut self, scene: &Scene) {
        if let Some(dimmed) = self.dimmed_lights(scene)
            && let Some(studio) = self.stack.get_mut("studio")
        {
            studio.set("lights", &[dimmed]);
        }
    }

    /// The camera of the preset, else that of the scene at its node, else one that frames `scene`.
    pub fn camera_for(&self, scene: &Scene, aspect: f64) -> Camera {
        let own = || {
            let camera = self.camera_of(scene)?;
            Some(camera.node.map_or(camera.pose, |node| {
                camera.carried(&scene_from_nodes(&scene.rig, &self.motion(scene))[node])
            }))
        };
        let framing = || {
            let points = self.framing_points(scene);
            Camera::around(&points, self.looks_along(&points), self.frame(aspect))
        };
        self.camera
            .unwrap_or_else(|| own().unwrap_or_else(framing).counted_from(self.origin))
    }

    /// The camera that comes with `scene` and is used where the preset has none of its own.
    pub fn camera_of<'a>(&self, scene: &'a Scene) -> Option<&'a SceneCamera> {
        let index = scene.camera(&self.scene_camera).unwrap_or(0);
        scene
            .cameras
            .get(index)
            .filter(|_| self.scene_camera != NO_CAMERA)
    }

    /// The direction in which the automatic camera looks at these points: at a model that is flatter
    /// than 0.3 of its width the steeper the flatter it is, so that the picture is filled down, too.
    pub fn looks_along(&self, points: &[DVec3]) -> DVec3 {
        let mut bounds = Bounds::EMPTY;
        points.iter().for_each(|point| bounds.include(*point));
        let extent = bounds.max - bounds.min;
        let is_model = matches!(self.scene, SceneSource::File(_));
        let lacks = FLAT - extent.y / extent.x.max(extent.z);
        let steeper = if is_model && lacks > 0.0 { lacks } else { 0.0 };
        FRAMING_DIRECTION - DVec3::Y * (1.6 * steeper)
    }

    /// What the automatic camera fills of the picture: of a model as much as there is, of a built-in
    /// scene a square.
    pub fn frame(&self, aspect: f64) -> Frame {
        match self.scene {
            SceneSource::File(_) => Frame::whole(aspect),
            SceneSource::Builtin(_) => Frame::square(aspect),
        }
    }

    /// The camera of the model's file that is used, if it leaves out some of the model.
    pub fn cropping_camera<'a>(&self, scene: &'a Scene) -> Option<&'a SceneCamera> {
        // Of half the picture's side.
        const BEYOND: f64 = 1.02;
        let camera = self.camera_of(scene)?;
        if self.camera.is_some() || !matches!(self.scene, SceneSource::File(_)) {
            return None;
        }
        let view = self.view(scene, self.output.size);
        let clip_from_scene = view.clip_from_world * view.scene_state.world_from_scene;
        let is_outside = |point: &DVec3| {
            let clip = clip_from_scene * point.extend(1.0);
            clip.w <= 0.0 || clip.x.abs().max(clip.y.abs()) > BEYOND * clip.w
        };
        scene
            .framing_points(self.motion(scene).clip)
            .iter()
            .any(is_outside)
            .then_some(camera)
    }

    /// The box of `scene` that a look is fitted to, see [`Scene::subject_bounds`].
    pub fn subject_bounds(&self, scene: &Scene) -> Bounds {
        scene.subject_bounds(self.motion(scene).clip)
    }

    /// The points of `scene` that its automatic camera frames, before the scene's spin: of its clips
    /// from their begin to their end and of its particles near them, and of a scene that spins from
    /// all sides.
    pub fn framing_points(&self, scene: &Scene) -> Vec<DVec3> {
        let Motion { clip, other, .. } = self.motion(scene);
        let mut points = scene.framing_points(clip).to_vec();
        if other.is_some() {
            points.extend(scene.framing_points(other).iter());
        }
        let preset = self.in_meters(scene);
        if let Some(particle_settings) = preset.evaluated_stack().particle_settings() {
            // Particles may fly far, but the scene is what is looked at.
            let mut near = Bounds::EMPTY;
            points.iter().for_each(|point| near.include(*point));
            let aside = PARTICLES_ASIDE * near.radius();
            let corners = particle_settings.disc_bounds().corners();
            let corners = corners.map(|corner| corner + preset.origin);
            points.extend(corners.map(|corner| {
                if near.is_empty() {
                    corner
                } else {
                    corner.clamp(near.min - aside, near.max + aside)
                }
            }));
        }
        if self.spin_deg_per_s != 0.0 {
            points = turned_all_around(&points, scene.axis());
        }
        points
    }

    /// A preset of a built-in scene whose camera, unless the scene has one, stands where the sphere
    /// about the scene's box fills the picture of `size` pixels: pictures of tests, which stay as
    /// they are when what presets frame by themselves changes.
    pub fn of_sphere(scene: &Scene, size: [u32; 2]) -> Self {
        let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
        let framing = || Camera::framing(&scene.bounds(), FRAMING_DIRECTION, aspect);
        Self {
            scene: SceneSource::Builtin(scene.name.clone()),
            camera: scene.cameras.is_empty().then(framing),
            ..Self::default()
        }
    }

    /// The view and stack of every frame that this picture depends on, in order; the last is the
    /// picture itself. There are several where an effect remembers earlier ones.
    pub fn moments(&self, scene: &Scene, size: [u32; 2]) -> Vec<(View, Stack)> {
        let preset = self.in_meters(scene);
        let (frames, step_s) = preset
            .evaluated_stack()
            .earlier_frames()
            .map_or((0, 0.0), |earlier| (earlier.frames, earlier.step_s));
        let moment = |before: u32| {
            let clock = Clock {
                time_s: preset.clock.time_s - f64::from(before) * step_s,
                ..preset.clock
            };
            let then = Self {
                clock,
                ..preset.clone().into_owned()
            };
            (then.view(scene, size), then.stack_on(scene, size))
        };
        (0..=frames).rev().map(moment).collect()
    }

    /// The view of `scene` on a target of `size` pixels. Its depth range holds everything that
    /// effects may move.
    pub fn view(&self, scene: &Scene, [width, height]: [u32; 2]) -> View {
        let preset = self.in_meters(scene);
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        // Reduced before the trigonometry, so that a day of spinning costs no precision.
        let turns = preset.spin_deg_per_s * preset.clock.time_s / 360.0;
        let spin = if turns == 0.0 {
            DMat4::IDENTITY
        } else {
            turned_about(scene.axis(), turns.fract() * std::f64::consts::TAU)
        };
        let spin = match preset.origin {
            DVec3::ZERO => spin,
            origin => DMat4::from_translation(-origin) * spin,
        };
        let pose = preset.pose(scene);
        let mut bounds = preset.with_particles(
            pose.as_ref()
                .map_or_else(|| scene.bounds_with_ground(), |pose| pose.bounds(scene)),
        );
        if preset
            .stack
            .0
            .iter()
            .any(|enabled| enabled.effect.hooks.has_lines)
        {
            preset
                .polyline
                .iter()
                .for_each(|point| bounds.include(DVec3::from(point.map(f64::from))));
        }
        if !bounds.is_empty() {
            let max_displacement_m = preset.evaluated_stack().max_displacement_m(bounds.radius());
            (bounds.min, bounds.max) = (
                bounds.min - max_displacement_m,
                bounds.max + max_displacement_m,
            );
            if scene.walls > 0 {
                // Walls do not turn with the scene; this box holds them at every angle.
                let aside = DVec3::new(std::f64::consts::SQRT_2, 1.0, std::f64::consts::SQRT_2);
                let axis = scene.axis();
                let moved = |corner: DVec3| axis + (corner - axis) * aside;
                (bounds.min, bounds.max) = (moved(bounds.min), moved(bounds.max));
            }
        }
        let pins = &preset.accuracy.pins;
        let shadow = ShadowResolution::of(
            pins.option().unwrap_or_default(),
            pins.option().unwrap_or_default(),
        );
        let scene_state = SceneState {
            world_from_scene: spin,
            origin: preset.origin,
            pose,
            lights: preset.lights(scene, &spin),
            polyline: preset.polyline.clone(),
            particles: preset.particle_timeline(),
        };
        let camera = preset.camera_for(scene, aspect);
        let view = View::new(&camera, width, height, &bounds, spin, preset.backdrop());
        let view = View {
            scene_state,
            ..view
        }
        .with_shadow(shadow);
        let is_far = needs::is_far(scene, &view);
        let view = view.with_grid(view.precision.subpixel_bits, is_far);
        if scene.ground_instances().is_empty() {
            view
        } else {
            view.with_content(&camera, &scene.bounds())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_looping_clock_stays_in_its_range_and_the_other_stops_at_its_end() {
        let clock = Clock {
            range_s: [1.0, 3.0],
            speed: 2.0,
            ..Clock::default()
        };
        assert_eq!(clock.after(1.0, 0.5), (2.0, true));
        assert_eq!(clock.after(2.5, 0.5), (1.5, true));
        assert_eq!(
            clock.after(-4.0, 0.5),
            (-3.0, true),
            "it runs into the range"
        );
        assert!(clock.after(1e9, 1e-9).1);
        let once = Clock {
            is_looping: false,
            ..clock
        };
        assert_eq!(once.after(2.5, 0.5), (3.0, false));
        for start in 0..10_000 {
            let (time_s, goes_on) = clock.after(f64::from(start) * 0.377, 1.0 / 60.0);
            assert!(
                goes_on && (1.0..3.0).contains(&time_s) || f64::from(start) * 0.377 < 1.0,
                "{start}: {time_s}"
            );
        }
    }

    #[test]
    fn a_day_of_play_costs_no_precision() {
        let preset = Preset {
            spin_deg_per_s: 90.0,
            ..Preset::default()
        };
        let scene = crate::scene::builtin::build("teapot?tess=2").expect("a scene");
        let turn = |time_s: f64| {
            let preset = Preset {
                clock: Clock {
                    time_s,
                    ..Clock::default()
                },
                ..preset.clone()
            };
            preset.view(&scene, [8, 8]).scene_state.world_from_scene
        };
        let (fresh, late) = (turn(0.37), turn(86_400.0 + 0.37));
        let error = fresh
            .to_cols_array()
            .iter()
            .zip(late.to_cols_array())
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        // A millionth of a period is an angle of 6e-6.
        assert!(error < 1e-9, "{error}");
    }
}
