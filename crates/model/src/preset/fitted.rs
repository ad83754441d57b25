//! Fitting: the lengths and points of a preset for a scene of another size at another place.

use std::{borrow::Cow, sync::Arc};

use glam::DVec3;

use super::{
    Preset,
    animation::{Animation, Keyframe, Track},
    fit::{Fit, LengthUnit},
    setting::Storage,
};
use crate::{
    effects::{Effect, EnabledEffect},
    params::{Field, Measure, Value, ValueType, format_number},
    scene::Scene,
};

/// How a preset keeps the setting `unit`.
pub(super) const UNIT: Storage = Storage::State {
    get: |preset| Some(Value::Choice(preset.unit as usize)),
    set: |preset, value| {
        if let Value::Choice(index) = value {
            preset.unit = LengthUnit::ALL[*index];
        }
        Ok(())
    },
    clear: None,
};

impl Preset {
    /// Does it have lengths or points that count, so that its picture depends on the size of the
    /// scene?
    pub fn has_lengths(&self) -> bool {
        let counts = |enabled: &EnabledEffect| measured(self, enabled).next().is_some();
        self.stack.0.iter().any(counts) || !self.polyline.is_empty()
    }

    /// The preset with its lengths and points fitted to another scene, values of keyframes and the
    /// polyline too; parameters that do not count for the picture keep their values. The
    /// sentences say which values their range did not allow.
    pub fn fitted(&self, fit: &Fit) -> (Self, Vec<String>) {
        let (mut fitted, mut warnings) = (self.clone(), Vec::new());
        if fit.is_identity() {
            return (fitted, warnings);
        }
        for (before, after) in self.stack.0.iter().zip(&mut fitted.stack.0) {
            for field in measured(self, before) {
                let value = field.get(&before.words);
                let (components, is_clamped) = fit.components(field, &value);
                let outcome = field.set(&mut after.words, &components);
                debug_assert!(outcome.is_ok(), "{}: {outcome:?}", field.name);
                if is_clamped
                    && self
                        .animation
                        .get(&before.effect.name, &field.name)
                        .is_none()
                {
                    warnings.push(clamped(&before.effect.name, field));
                }
            }
        }
        if let Some([offset, per]) = fit.depth_line() {
            for enabled in &mut fitted.stack.0 {
                let original = enabled.effect.base.as_ref().unwrap_or(&enabled.effect);
                if original == Effect::named("depth") {
                    let moved = enabled.number("offset") + enabled.number("scale") / per * offset;
                    enabled.set("offset", &[moved.clamp(-1e6, 1e6)]);
                }
            }
        }
        fitted.animation = Animation::default();
        for track in self.animation.tracks() {
            fitted
                .animation
                .put(fitted_track(fit, track, &mut warnings));
        }
        fitted.polyline = fit.polyline(&self.polyline).into();
        (fitted, warnings)
    }

    /// The preset with its lengths in meters, for `scene`.
    pub fn metric(&self, scene: &Scene) -> Cow<'_, Self> {
        if self.unit == LengthUnit::Meter {
            return Cow::Borrowed(self);
        }
        let fit = Fit::of_scene_unit(&scene.content_bounds());
        let fitted = fit.map_or_else(|| self.clone(), |fit| self.fitted(&fit).0);
        Cow::Owned(Self {
            unit: LengthUnit::Meter,
            ..fitted
        })
    }

    /// The preset as a picture of `scene` has it: with its lengths in meters, and with points that
    /// count from [`Scene::origin`].
    pub fn in_meters(&self, scene: &Scene) -> Cow<'_, Self> {
        match self.metric(scene) {
            Cow::Borrowed(metric) if metric.origin == scene.origin => Cow::Borrowed(metric),
            metric => Cow::Owned(metric.into_owned().counted_from(scene.origin)),
        }
    }

    /// The same preset, in meters, whose points count from another point of the scene.
    #[must_use]
    pub fn counted_from(self, origin: DVec3) -> Self {
        let apart = origin - self.origin;
        if apart == DVec3::ZERO {
            return self;
        }
        Self {
            origin,
            camera: self.camera.map(|camera| camera.counted_from(apart)),
            // It lies in the scene.
            polyline: self.polyline.clone(),
            ..self.fitted(&Fit::to_origin(apart)).0
        }
    }

    /// From the unit of the preset to meters in a picture of `scene`; none where that changes
    /// nothing.
    pub fn unit_fit(&self, scene: &Scene) -> Option<Fit> {
        let apart = scene.origin - self.origin;
        match self.unit {
            LengthUnit::Meter => (apart != DVec3::ZERO).then(|| Fit::to_origin(apart)),
            LengthUnit::Scene => {
                let fit = Fit::of_scene_unit(&scene.content_bounds());
                fit.map(|fit| fit.counted_from(apart))
            }
        }
    }
}

/// The parameters of an effect that measure something and count for the picture. One that depends
/// on a choice counts if the choice is made, or may be made by a keyframe.
fn measured<'a>(
    preset: &'a Preset,
    enabled: &'a EnabledEffect,
) -> impl Iterator<Item = &'a Arc<Field>> {
    let effect = &enabled.effect;
    let is_animated = |name: &str| preset.animation.get(&effect.name, name).is_some();
    let counts = move |field: &&Arc<Field>| {
        field.measure() != Measure::None
            && (field.is_shown(&effect.fields, &enabled.words)
                || field
                    .when
                    .as_ref()
                    .is_some_and(|(choice, _)| is_animated(choice)))
    };
    effect.fields.iter().filter(counts)
}

fn fitted_track(fit: &Fit, track: &Track, warnings: &mut Vec<String>) -> Track {
    let field = track.field();
    if field.measure() == Measure::None {
        return track.clone();
    }
    let mut is_any_clamped = false;
    let keys = track.keys().iter().map(|key| {
        let (value, is_clamped) = fit.components(field, &key.value);
        is_any_clamped |= is_clamped;
        Keyframe {
            value,
            ..key.clone()
        }
    });
    let keys: Vec<Keyframe> = keys.collect();
    if is_any_clamped {
        warnings.push(clamped(&track.effect().name, field));
    }
    // Times, easings and the number of keyframes are those of a track, and the values lie in their
    // range.
    Track::new(track.effect(), field, keys).unwrap_or_else(|_| track.clone())
}

fn clamped(effect: &str, field: &Field) -> String {
    let [low, high] = field.hard.map(format_number);
    let each = if matches!(field.value_type, ValueType::Point) {
        "each coordinate of it "
    } else {
        ""
    };
    format!(
        "{effect}.{}: fitted to this scene it would leave its range; {each}was kept inside {low}..={high}",
        field.name
    )
}
