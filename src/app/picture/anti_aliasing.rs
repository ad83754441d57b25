//! Anti-aliasing: how many samples of a pixel are drawn and averaged in linear light. It is the
//! accuracy axis `render_scale`.
//!
//! A preset that does not pin the axis is drawn with [`AUTOMATIC`] samples where a graphics card
//! can afford it. That is a viewing aid: it is not saved, and a CPU adapter never does it.

use std::sync::{Arc, Weak};

use super::screen::Inputs;
use crate::{
    accuracy::{AccuracyOptions, Axis, AxisOption, RenderScale},
    effects::Stack,
    plan::Caps,
    preset::{AccuracyRequest, Preset},
    scene::Scene,
};

/// The options that the top bar offers, with their names.
pub const CHOICES: [(RenderScale, &str); 3] = [
    (RenderScale::Full, "off"),
    (RenderScale::Double, "2×2"),
    (RenderScale::Quadruple, "4×4"),
];

/// What a preset that does not pin the axis is drawn with on a graphics card.
pub const AUTOMATIC: RenderScale = RenderScale::Double;

/// A picture with automatic anti-aliasing that takes longer is drawn without from then on,
/// milliseconds.
const AFFORDABLE_MS: f64 = 16.0;

/// Bytes of a drawn pixel in the largest buffer: four words where an x-ray sums layers.
const PIXEL_BYTES: u64 = 16;

/// `2×2`; fewer pixels than shown are no anti-aliasing and are named by their option.
pub fn name(scale: RenderScale) -> &'static str {
    CHOICES
        .iter()
        .find(|(choice, _)| *choice == scale)
        .map_or(scale.name(), |(_, name)| name)
}

/// Returns true if an adapter may draw a picture of `size` pixels with [`AUTOMATIC`] samples
/// without being asked to.
pub fn may_be_automatic(caps: &Caps, size: [u32; 2]) -> bool {
    let [width, height] = size.map(|side| AUTOMATIC.factor() * f64::from(side));
    let is_within_limits = width.max(height) <= f64::from(caps.max_texture_side)
        && width * height * PIXEL_BYTES as f64
            <= caps.max_storage_binding_bytes.min(caps.max_buffer_bytes) as f64;
    !caps.software && is_within_limits
}

/// Is this axis the one of anti-aliasing, and is the picture drawn with more samples than the
/// preset says?
pub fn is_automatic(axis: &Axis, preset: &Preset, drawn: Option<&Inputs>) -> bool {
    let is_pinned = preset.accuracy.pins.option::<RenderScale>().is_some();
    axis.index() == RenderScale::AXIS
        && !is_pinned
        && drawn.is_some_and(|inputs| inputs.accuracy.scale() != RenderScale::Full)
}

/// What the time of a picture depends on, as far as automatic anti-aliasing looks at it.
#[derive(Clone, Debug)]
struct Subject {
    scene: Weak<Scene>,
    effects: Vec<String>,
    size: [u32; 2],
}

impl PartialEq for Subject {
    fn eq(&self, other: &Self) -> bool {
        self.scene.ptr_eq(&other.scene) && self.effects == other.effects && self.size == other.size
    }
}

/// A finished picture: its options, its cost as far as it is known (the time of its first frame is
/// not), and whether it was drawn as large as it is shown.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    pub options: AccuracyOptions,
    pub gpu_ms: Option<f64>,
    pub is_full_size: bool,
}

impl Finished {
    pub fn new(options: AccuracyOptions, gpu_ms: Option<f64>, is_full_size: bool) -> Self {
        Self {
            options,
            gpu_ms,
            is_full_size,
        }
    }
}

/// Decides whether pictures are drawn with automatic anti-aliasing.
#[derive(Debug, Default)]
pub struct AutomaticAntiAliasing {
    drawn: Option<Subject>,
    /// What was too slow with it.
    too_slow: Option<Subject>,
}

impl AutomaticAntiAliasing {
    /// The accuracy with which the next picture is drawn; `finished` is the newest one.
    pub fn applied(
        &mut self,
        accuracy: AccuracyRequest,
        (scene, stack, size): (&Arc<Scene>, &Stack, [u32; 2]),
        caps: &Caps,
        finished: Option<Finished>,
    ) -> AccuracyRequest {
        let subject = Subject {
            scene: Arc::downgrade(scene),
            effects: stack
                .0
                .iter()
                .map(|enabled| enabled.effect.name.clone())
                .collect(),
            size,
        };
        // The first report after a change may still be that of the picture before.
        let is_same = self.drawn.as_ref() == Some(&subject);
        let is_slow = |finished: &Finished| {
            finished.is_full_size
                && finished.options.render_scale == AUTOMATIC
                && finished.gpu_ms.is_some_and(|ms| ms > AFFORDABLE_MS)
        };
        if is_same
            && accuracy.pins.option::<RenderScale>().is_none()
            && finished.as_ref().is_some_and(is_slow)
        {
            self.too_slow = Some(subject.clone());
        }
        let is_too_slow = self.too_slow.as_ref() == Some(&subject);
        self.drawn = Some(subject);
        if may_be_automatic(caps, size) && !is_too_slow {
            accuracy.anti_aliased()
        } else {
            accuracy
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{accuracy::PinnedOptions, scene::builtin};

    const CARD: Caps = Caps {
        max_texture_side: 16_384,
        max_storage_binding_bytes: 1 << 30,
        max_buffer_bytes: 1 << 30,
        ..Caps::ALL
    };

    fn scale(accuracy: &AccuracyRequest) -> Option<RenderScale> {
        accuracy.pins.option()
    }

    #[test]
    fn a_card_is_asked_for_two_by_two_samples_that_it_holds_and_a_cpu_adapter_never() {
        assert!(may_be_automatic(&CARD, [1280, 800]));
        let software = Caps {
            software: true,
            ..CARD
        };
        assert!(!may_be_automatic(&software, [1280, 800]));
        assert!(
            !may_be_automatic(&CARD, [9000, 100]),
            "wider than a texture"
        );
        assert!(
            !may_be_automatic(&CARD, [8000, 8000]),
            "more than a buffer holds"
        );
    }

    #[test]
    fn what_the_preset_pins_stays() {
        for option in RenderScale::ALL {
            let pinned = AccuracyRequest {
                pins: PinnedOptions::of(*option),
                ..AccuracyRequest::default()
            };
            assert_eq!(pinned.anti_aliased(), pinned);
        }
    }

    #[test]
    fn a_picture_that_was_too_slow_is_drawn_without_until_it_is_another() {
        let mut automatic = AutomaticAntiAliasing::default();
        let (scene, other) = (
            Arc::new(builtin::build("cube-wall").expect("a scene")),
            Arc::new(builtin::build("cube-wall").expect("a scene")),
        );
        let (plain, stack) = (AccuracyRequest::default(), Stack::default());
        let finished = |ms: f64, render_scale: RenderScale| {
            Some(Finished {
                options: AccuracyOptions {
                    render_scale,
                    ..AccuracyOptions::default()
                },
                gpu_ms: Some(ms),
                is_full_size: true,
            })
        };
        let mut next = |scene: &Arc<Scene>, finished| {
            scale(&automatic.applied(plain, (scene, &stack, [64, 64]), &CARD, finished))
        };
        assert_eq!(
            next(&scene, finished(99.0, RenderScale::Double)),
            Some(RenderScale::Double),
            "that was another picture"
        );
        assert_eq!(
            next(&scene, finished(15.0, RenderScale::Double)),
            Some(RenderScale::Double)
        );
        assert_eq!(next(&scene, finished(17.0, RenderScale::Double)), None);
        assert_eq!(
            next(&scene, finished(5.0, RenderScale::Full)),
            None,
            "it does not flicker"
        );
        assert_eq!(
            next(&other, finished(5.0, RenderScale::Full)),
            Some(RenderScale::Double)
        );
    }

    #[test]
    fn the_names_are_those_of_the_samples() {
        assert_eq!(
            [
                RenderScale::Full,
                RenderScale::Double,
                RenderScale::Quadruple,
                RenderScale::Half
            ]
            .map(name),
            ["off", "2×2", "4×4", "half"]
        );
    }
}
