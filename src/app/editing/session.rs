//! The session: the open preset, its scene, the time that is shown, and the effects that are muted.
//! Every panel can read it; only commands change it.

use std::{
    collections::{BTreeSet, HashMap},
    path::PathBuf,
    sync::Arc,
};

use super::{particle_trail::Trail, playback::Playback, randomize::Randomizer};
use crate::{
    app::files::scene_loader::SceneLoader,
    effect_files::Catalog,
    effects::{Effect, Stack},
    params::Field,
    preset::{Fit, LengthUnit, Preset, rebind::Replaced},
    preset_file::{Look, PresetFile},
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

/// Which file a preset is, as undo remembers it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileId {
    pub id: String,
    pub path: Option<PathBuf>,
}

impl FileId {
    pub fn of(preset_file: &PresetFile) -> Self {
        Self {
            id: preset_file.id.clone(),
            path: preset_file.path.clone(),
        }
    }
}

/// Everything that undo takes back.
#[derive(Clone, Debug, PartialEq)]
pub struct UndoState {
    pub file: FileId,
    pub preset: Preset,
}

/// The open preset, its scene, the time that is shown, and the effects that are muted.
pub struct Session {
    pub preset_file: PresetFile,
    /// Every preset that was opened or saved since the start, as its file has it.
    files: HashMap<FileId, PresetFile>,
    pub scenes: SceneLoader,
    /// The user opened a preset since the start.
    pub chose_look: bool,
    /// Names of the effects that are hidden: a viewing aid, not saved.
    pub muted: BTreeSet<String>,
    pub playback: Playback,
    pub trail: Trail,
    pub randomizer: Randomizer,
}

impl Session {
    pub fn new(preset_file: PresetFile) -> Self {
        Self {
            files: HashMap::from([(FileId::of(&preset_file), preset_file.clone())]),
            preset_file,
            scenes: SceneLoader::default(),
            chose_look: false,
            muted: BTreeSet::new(),
            playback: Playback::default(),
            trail: Trail::default(),
            randomizer: Randomizer::default(),
        }
    }

    /// The preset as it is edited.
    pub fn preset(&self) -> &Preset {
        &self.preset_file.preset
    }

    pub fn preset_mut(&mut self) -> &mut Preset {
        &mut self.preset_file.preset
    }

    /// Name of the preset, as people read it.
    pub fn title(&self) -> &str {
        self.preset_file.title()
    }

    /// The scene that is shown; none until the first has loaded.
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.scenes.shown()
    }

    /// The open preset as its file has it.
    pub fn as_filed(&self) -> &PresetFile {
        self.files
            .get(&FileId::of(&self.preset_file))
            .unwrap_or(&self.preset_file)
    }

    /// The preset whose look has landed on the user's own scene; none where the preset shows its
    /// own scene.
    pub fn look_file(&self) -> Option<&PresetFile> {
        let look = self.preset_file.look.as_ref()?;
        self.files.get(&FileId {
            id: look.id.clone(),
            path: look.path.clone(),
        })
    }

    /// Makes `preset_file` the open preset, with no effect muted and at the preset's own time.
    pub fn open(&mut self, preset_file: PresetFile) {
        self.remember(preset_file.clone());
        self.muted.clear();
        self.playback = Playback::default();
        self.preset_file = preset_file;
    }

    /// Makes `preset_file`, the open preset as its file is now, the open preset. The time that is
    /// shown stays.
    pub fn reload(&mut self, preset_file: PresetFile) {
        self.remember(preset_file.clone());
        self.muted
            .retain(|name| preset_file.preset.stack.get(name).is_some());
        self.preset_file = preset_file;
    }

    /// The effects of every preset that was opened.
    pub fn catalogs(&self) -> impl Iterator<Item = &Catalog> {
        self.files
            .values()
            .map(|preset_file| &preset_file.effects)
            .chain([&self.preset_file.effects])
    }

    /// Uses new effects in place of old ones in every preset that was opened; see
    /// [`Preset::rebind`]. `effects` are those that the open preset may use from now on.
    pub fn rebind(&mut self, replaced: &[Replaced], effects: &Catalog) {
        let open = FileId::of(&self.preset_file);
        for (file, preset_file) in &mut self.files {
            let effects = if *file == open {
                effects.clone()
            } else {
                preset_file.effects.replaced(replaced)
            };
            preset_file.rebind(replaced, effects);
        }
        self.preset_file.rebind(replaced, effects.clone());
    }

    /// Remembers how a file is now, after it was read or written.
    pub fn remember(&mut self, preset_file: PresetFile) {
        self.files.insert(FileId::of(&preset_file), preset_file);
    }

    /// The presets that were opened or saved since the start.
    pub fn file_ids(&self) -> impl Iterator<Item = &FileId> {
        self.files.keys()
    }

    /// A preset that was opened or saved since the start, as its file has it.
    pub fn filed(&self, id: &FileId) -> Option<&PresetFile> {
        self.files.get(id)
    }

    /// The preset that was `before` has another file, which is now as `after`. The changes of the
    /// open preset stay.
    pub fn refile(&mut self, before: &FileId, after: PresetFile) {
        self.files.remove(before);
        let landed = self
            .files
            .values_mut()
            .chain([&mut self.preset_file])
            .filter_map(|landed| landed.look.as_mut());
        for look in landed.filter(|look| look.id == before.id && look.path == before.path) {
            *look = Look::of(&after);
        }
        if FileId::of(&self.preset_file) == *before {
            let mut preset = std::mem::take(&mut self.preset_file.preset);
            preset.name.clone_from(&after.preset.name);
            self.preset_file = after.clone();
            self.preset_file.preset = preset;
        }
        self.remember(after);
    }

    /// True if the preset differs from its file in more than the camera, which is moved only to
    /// look. A preset without a file does not until it is edited, unless it was pasted: then no file
    /// has it.
    pub fn is_modified(&self) -> bool {
        if self.preset_file.is_pasted() {
            return true;
        }
        let open = &self.preset_file.preset;
        let Some(as_opened) = self.files.get(&FileId::of(&self.preset_file)) else {
            return true;
        };
        as_opened.preset != *open
            && Preset {
                camera: as_opened.preset.camera,
                ..open.clone()
            } != as_opened.preset
    }

    /// Did the user choose the look that is shown, which stays when another model is opened: a preset
    /// since the start, or other effects than it was opened with?
    pub fn has_chosen_look(&self) -> bool {
        self.chose_look && !self.preset_file.is_plain()
            || self.as_filed().preset.stack != self.preset().stack
    }

    pub fn undo_state(&self) -> UndoState {
        UndoState {
            file: FileId::of(&self.preset_file),
            preset: self.preset_file.preset.clone(),
        }
    }

    /// Goes back to `state`. Returns the name of the preset if it is another one than before.
    pub fn restore(&mut self, state: UndoState) -> Option<String> {
        let UndoState { file, preset } = state;
        let is_other = FileId::of(&self.preset_file) != file;
        if is_other && let Some(preset_file) = self.files.get(&file) {
            self.preset_file = preset_file.clone();
        }
        let name = if preset.name.is_empty() {
            file.id
        } else {
            preset.name.clone()
        };
        self.preset_file.preset = preset;
        is_other.then_some(name)
    }

    /// The time that is shown, seconds.
    pub fn shown_time_s(&self) -> f64 {
        self.playback.shown_time_s(&self.preset().clock)
    }

    /// True if another time is shown than the preset's own.
    pub fn is_off_its_time(&self) -> bool {
        self.shown_time_s() != self.preset().clock.time_s
    }

    /// The time of the picture that is asked for next, seconds.
    pub fn next_time_s(&self) -> f64 {
        self.playback.next_time_s(&self.preset().clock)
    }

    /// The preset of the picture that is asked for next, with its lengths in meters.
    pub fn next_preset(&self) -> Preset {
        let mut next = self.metric_preset();
        next.clock.time_s = self.next_time_s();
        next
    }

    /// The preset at the time that is shown.
    pub fn shown_preset(&self) -> Preset {
        let mut preset = self.preset().clone();
        preset.clock.time_s = self.shown_time_s();
        preset
    }

    /// The preset at the time that is shown, with its lengths in meters.
    pub fn metric_preset(&self) -> Preset {
        let shown = self.shown_preset();
        self.scene().map_or_else(
            || shown.clone(),
            |scene| shown.in_meters(scene).into_owned(),
        )
    }

    /// From the unit of the preset to meters; none where that changes nothing.
    pub fn unit_fit(&self) -> Option<Fit> {
        self.preset().unit_fit(self.scene()?)
    }

    /// The preset as it is drawn: at the time shown, without muted effects, in meters.
    pub fn visible_preset(&self) -> Preset {
        Preset {
            stack: self.visible_stack(),
            ..self.metric_preset()
        }
    }

    /// The stack as it is seen: at the time shown, without muted effects, in meters.
    pub fn visible_stack(&self) -> Stack {
        self.stack_at(self.shown_time_s())
    }

    /// The stack of the picture that is asked for next.
    pub fn next_stack(&self) -> Stack {
        self.stack_at(self.next_time_s())
    }

    fn stack_at(&self, time_s: f64) -> Stack {
        let mut stack = match (self.preset().unit, self.scene()) {
            (LengthUnit::Scene, Some(scene)) => self.preset().in_meters(scene).stack_at(time_s),
            _ => self.preset().stack_at(time_s),
        };
        stack
            .0
            .retain(|enabled| !self.muted.contains(&enabled.effect.name));
        stack
    }

    /// Parameter words of an enabled effect at the time shown.
    pub fn shown_words(&self, effect: &Effect) -> Option<Vec<u32>> {
        let preset = self.preset();
        let enabled = preset.stack.get(&effect.name)?;
        Some(
            preset
                .animation
                .evaluate_words(&effect.name, &enabled.words, self.shown_time_s()),
        )
    }

    /// A parameter's value at the time shown.
    pub fn shown_value(&self, effect: &Effect, field: &Field) -> Option<Vec<f64>> {
        self.shown_words(effect).map(|words| field.get(&words))
    }

    /// The camera that is used: the preset's own, the scene's, or the automatic one. None without a
    /// scene.
    pub fn camera(&self) -> Option<Camera> {
        Some(
            self.preset()
                .camera_for(self.scene()?, aspect(self.preset().output.size)),
        )
    }

    /// How much taller than the preset's frame a picture of `size` pixels must be for the frame's
    /// width to fit; at least 1.
    pub fn widening(&self, size: [u32; 2]) -> f64 {
        (aspect(self.preset().output.size) / aspect(size)).max(1.0)
    }

    /// Factor of lengths in pixels of `preset` in a picture of `size` pixels that shows its frame.
    pub fn length_scale(&self, preset: &Preset, size: [u32; 2]) -> f64 {
        let height = f64::from(size[1]) / self.widening(size);
        preset.output.length_scale(height)
    }

    /// The view that the next picture of `size` pixels shows: all of the preset's own frame, and
    /// more where the aspect ratios differ.
    pub fn view_at(&self, scene: &Scene, size: [u32; 2]) -> View {
        let mut next = self.preset().clone();
        next.clock.time_s = self.next_time_s();
        let mut view = self.view_of(next, scene, size);
        if let Some(particle_timeline) = self.trail.particle_timeline(&view) {
            view.scene_state.particles = Some(particle_timeline);
        }
        view
    }

    /// The same for another preset under this one's frame.
    pub fn view_of(&self, preset: Preset, scene: &Scene, size: [u32; 2]) -> View {
        let mut preset = preset.in_meters(scene).into_owned();
        let widening = self.widening(size);
        let mut camera = preset.camera_for(scene, aspect(preset.output.size));
        if widening > 1.0 {
            match &mut camera.projection {
                Projection::Perspective { fov_y_deg } => {
                    *fov_y_deg = 2.0
                        * ((fov_y_deg.to_radians() * 0.5).tan() * widening)
                            .atan()
                            .to_degrees();
                }
                Projection::Orthographic { height_m } => *height_m *= widening,
            }
        }
        preset.camera = Some(camera);
        preset.view(scene, size)
    }

    /// Hides an effect (true) or shows it again: a viewing aid, which is not saved.
    pub fn mute(&mut self, name: String, is_muted: bool) {
        match is_muted {
            true => self.muted.insert(name),
            false => self.muted.remove(&name),
        };
    }

    /// Pauses at the preset's own time, `clock.time_s`.
    pub fn show_own_time(&mut self) {
        self.playback.playing = false;
        self.playback.show_own();
    }

    /// Writes the shown time to `clock.time_s`.
    pub fn keep_shown_time(&mut self) {
        self.preset_mut().clock.time_s = self.shown_time_s();
        self.playback.show_own();
    }

    /// Steps by so many frames, negative for back.
    pub fn step_time(&mut self, frames: f64) {
        let clock = self.preset().clock;
        self.playback.step(&clock, frames);
    }

    /// Goes to the start.
    pub fn rewind(&mut self) {
        let [start_s, _] = self.preset().clock.range_s;
        self.playback.show(start_s);
    }

    /// Advances the time by a frame that took `passed_s` seconds.
    pub fn advance(&mut self, passed_s: f64) {
        let clock = self.preset().clock;
        self.playback.advance(&clock, passed_s);
    }

    /// Records how the particles were led, up to the time shown. Keys of the particles' parameters
    /// take precedence.
    pub fn follow_particles(&mut self) {
        let particle_timeline = self
            .next_preset()
            .particle_timeline()
            .filter(|particle_timeline| particle_timeline.len() == 1);
        match particle_timeline {
            Some(particle_timeline) => self.trail.follow(
                particle_timeline.frame,
                particle_timeline.words(1).to_vec(),
                self.playback.playing,
            ),
            None => self.trail = Trail::default(),
        }
    }
}

/// Width over height.
pub fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width.max(1)) / f64::from(height.max(1))
}
