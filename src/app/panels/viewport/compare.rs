//! Compare: A, the most exact picture of this preset or a picture that was kept, beside B, the
//! preset as it is. Both have the same camera and time. They are shown with a divider that can be
//! dragged, side by side, one instead of the other, or as their difference; below each are its time
//! and its error.

use std::sync::Arc;

use egui::Rect;

use crate::{
    accuracy::{PinnedOptions, RenderScale},
    app::{
        picture::{
            screen::{Inputs, Screen},
            verification::Verdict,
        },
        shell::{log::Level, state::State},
    },
    preset::{AccuracyRequest, Preset, Tier},
    scene::{Ground, Scene},
};

/// How A and B are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A on the left of the divider, B on the right.
    Wipe,
    /// All of A in the left half, all of B in the right.
    SideBySide,
    Difference,
    A,
    B,
}

/// How A and B differ, by their verdicts.
pub struct Difference {
    pub of: [Verdict; 2],
    pub text: String,
}

/// The comparison. Closed, it has no renderer.
pub struct Compare {
    pub mode: Option<Mode>,
    /// Position of the divider, as a fraction of the picture's width.
    pub split: f32,
    /// The preset that A shows; none for the reference.
    pub kept: Option<Box<Preset>>,
    /// How far A is on the way from the kept preset to B, 0 to 1.
    pub toward: f64,
    pub screen: Option<Screen>,
    pub verdict: Option<Verdict>,
    /// The scene of B, and the same on the ground of A.
    grounded: Option<(Option<Ground>, [Arc<Scene>; 2])>,
    /// Factor of the difference.
    pub gain: u8,
    /// The newest difference between verdicts on A and B.
    pub difference: Option<Difference>,
}

impl Default for Compare {
    fn default() -> Self {
        Self {
            mode: None,
            split: 0.5,
            kept: None,
            toward: 0.0,
            screen: None,
            verdict: None,
            grounded: None,
            gain: 16,
            difference: None,
        }
    }
}

impl Compare {
    pub fn is_open(&self) -> bool {
        self.mode.is_some()
    }

    /// Position of the divider, as a fraction of the picture's width; none unless the wipe is open.
    pub fn wipe_split(&self) -> Option<f32> {
        (self.mode == Some(Mode::Wipe)).then_some(self.split)
    }

    /// The part of `rect` that B is fitted into.
    pub fn side_b(&self, rect: Rect) -> Rect {
        if self.mode == Some(Mode::SideBySide) {
            rect.split_left_right_at_fraction(0.5).1
        } else {
            rect
        }
    }

    /// True if B cannot be seen.
    pub fn hides_b(&self) -> bool {
        matches!(self.mode, Some(Mode::A | Mode::Difference))
    }

    /// Goes on to the next of wipe, side by side, difference and closed.
    pub fn cycle(&mut self) {
        match self.mode {
            Some(Mode::Wipe) => self.mode = Some(Mode::SideBySide),
            Some(Mode::SideBySide) => self.mode = Some(Mode::Difference),
            Some(Mode::Difference) => self.close(),
            None | Some(Mode::A | Mode::B) => self.mode = Some(Mode::Wipe),
        }
    }

    /// Shows A instead of B, or B instead of A.
    pub fn flip(&mut self) {
        self.mode = Some(if self.mode == Some(Mode::A) {
            Mode::B
        } else {
            Mode::A
        });
    }

    /// Draws A's next picture with the shaders as they are now.
    pub fn reload_shaders(&mut self) {
        self.screen.iter_mut().for_each(Screen::reload_shaders);
    }

    /// Drops A's renderer with all that it holds.
    pub fn close(&mut self) {
        *self = Self {
            split: self.split,
            gain: self.gain,
            kept: self.kept.take(),
            toward: self.toward,
            ..Self::default()
        };
    }

    /// What A shows, as `A` is labeled.
    pub fn name(&self) -> String {
        let name: &str = match &self.kept {
            None => return "this preset, most exact".into(),
            Some(kept) if kept.name.is_empty() => "kept preset",
            Some(kept) => &format!("{}, as kept", kept.name),
        };
        match self.toward > 0.0 {
            true => format!("{name}, {:.0} % toward B", 100.0 * self.toward),
            false => name.into(),
        }
    }

    /// What B shows, as `B` is labeled.
    pub fn name_b(state: &State) -> String {
        format!(
            "this preset, {}",
            state.session.preset().accuracy.tier.name()
        )
    }

    /// True while a report on A is still to come.
    pub fn is_waiting(&self) -> bool {
        self.shown().is_some_and(Screen::is_waiting)
    }

    /// True while a picture of A is still to come, other than the next moment of a preset that
    /// plays.
    pub fn is_awaited(&self, is_playing: bool) -> bool {
        self.shown()
            .is_some_and(|screen| screen.is_awaited(is_playing))
    }

    /// True while the cost of A is to be measured.
    pub fn needs_measuring(&self) -> bool {
        self.shown().is_some_and(Screen::needs_measuring)
    }

    /// Measures the cost of A, if that is needed.
    pub fn measure(&mut self) {
        if self.needs_measuring()
            && let Some(screen) = &mut self.screen
        {
            screen.measure();
        }
    }

    /// Forgets what was measured of another preset, or at another size.
    pub fn reset_measurements(&mut self) {
        self.verdict = None;
        self.screen.iter_mut().for_each(Screen::reset_timings);
    }

    /// A's picture, unless only B is shown.
    fn shown(&self) -> Option<&Screen> {
        self.screen
            .as_ref()
            .filter(|_| !matches!(self.mode, None | Some(Mode::B)))
    }

    /// Time of A's newest frame, milliseconds; 0 if there is none.
    pub fn ms(&self) -> f64 {
        self.shown()
            .and_then(|screen| screen.timings().newest_ms())
            .unwrap_or(0.0)
    }

    /// The inputs that were requested for A, at full size.
    pub fn requested(&self) -> Option<&Inputs> {
        self.screen.as_ref().and_then(Screen::requested)
    }

    /// The picture of A, if it has no verdict yet.
    pub fn unjudged(&self) -> Option<Inputs> {
        let judged = self.verdict.as_ref().map(|verdict| &verdict.of);
        self.mode
            .and(self.requested())
            .filter(|requested| judged != Some(requested))
            .cloned()
    }

    /// Keeps a verdict if it is on A. Returns true if so.
    pub fn take_verdict(&mut self, verdict: &Verdict) -> bool {
        let is_ours = self.requested() == Some(&verdict.of);
        if is_ours {
            self.verdict = Some(verdict.clone());
        }
        is_ours
    }

    /// What A shows at full size, under the camera of `live`: the preset's effects with the most
    /// exact options, or the kept preset.
    fn inputs(&self, state: &State, live: &Inputs) -> Inputs {
        let full = [live.view.width, live.view.height];
        let session = &state.session;
        let Some(kept) = &self.kept else {
            // Both sides have the same samples for each pixel, or every edge would be a difference.
            let scale = live
                .accuracy
                .pins
                .option::<RenderScale>()
                .filter(|scale| *scale >= RenderScale::Full);
            let pins = scale.map_or_else(PinnedOptions::default, PinnedOptions::of);
            let accuracy = AccuracyRequest {
                tier: Tier::Reference,
                pins,
                ..AccuracyRequest::default()
            };
            return Inputs {
                view: session.view_at(&live.scene, full),
                accuracy,
                ..live.clone()
            };
        };
        let own = session.next_preset();
        let kept = kept.in_meters(&live.scene).into_owned();
        let look = match self.toward > 0.0 {
            true => kept.toward(&own, self.toward, &live.scene),
            false => kept,
        };
        let preset = own.with_look_of(look);
        let accuracy = preset.accuracy;
        let scene = match &self.grounded {
            Some((_, [of, grounded])) if Arc::ptr_eq(of, &live.scene) => grounded,
            _ => &live.scene,
        };
        let stack = preset
            .evaluated_stack()
            .drawn(session.length_scale(&preset, full));
        Inputs {
            view: session.view_of(preset, scene, full),
            stack,
            accuracy,
            scene: scene.clone(),
        }
        .given(None)
    }

    /// Draws A at the size of B.
    pub fn draw(&mut self, state: &mut State) {
        if matches!(self.mode, None | Some(Mode::B)) {
            return;
        }
        let Some(live) = state.picture.screen.requested() else {
            return;
        };
        let (live_scene, own_ground) = (&live.scene, state.session.preset().ground);
        match &self.kept {
            Some(kept) if kept.ground != own_ground => {
                let is_known = self.grounded.as_ref().is_some_and(|(ground, [of, _])| {
                    *ground == kept.ground && Arc::ptr_eq(of, live_scene)
                });
                if !is_known {
                    let bare = Scene::clone(live_scene).without_ground();
                    let grounded = kept.ground.iter().fold(bare, Scene::on_ground);
                    self.grounded = Some((kept.ground, [live_scene.clone(), Arc::new(grounded)]));
                }
            }
            _ => self.grounded = None,
        }
        let inputs = self.inputs(state, live);
        let screen = self
            .screen
            .get_or_insert_with(|| state.picture.screen.sibling());
        let polled = screen.poll();
        let time_s = state.session.next_time_s();
        screen.show(inputs, state.picture.screen.divisor(), time_s);
        if let Err(error) = polled {
            state.notify(
                Level::Error,
                format!("The comparison cannot be drawn: {error}"),
            );
        }
    }
}
