//! One preset on the way to another: numbers, colors and cameras in between, and everything else of
//! the nearer one.

use std::borrow::Cow;

use glam::DVec3;

use super::{
    Preset,
    animation::{Keyframe, Track, default_easing, steps},
};
use crate::{
    effects::{EnabledEffect, Stack},
    scene::{
        Scene,
        camera::{Camera, Projection},
    },
};

/// The number `by` of the way from `a` to `b`; exactly these at 0 and 1.
fn mix(a: f64, b: f64, by: f64) -> f64 {
    if by >= 1.0 { b } else { a + (b - a) * by }
}

fn mixed_color(a: [f32; 4], b: [f32; 4], by: f64) -> [f32; 4] {
    std::array::from_fn(|k| mix(f64::from(a[k]), f64::from(b[k]), by) as f32)
}

/// The direction in between; none between opposite ones.
fn mixed_direction(a: DVec3, b: DVec3, by: f64) -> Option<DVec3> {
    let [a, b] = [a, b].map(|v| v.try_normalize().unwrap_or(DVec3::Y));
    a.lerp(b, by).try_normalize()
}

impl Camera {
    /// The camera `by` of the way to another, 0 to 1: it goes round what both look at, and its
    /// distance changes by equal factors. A perspective and a parallel projection switch half way.
    pub fn toward(&self, other: &Self, by: f64) -> Self {
        let nearer = if by < 0.5 { self } else { other };
        if by <= 0.0 || by >= 1.0 || self == other {
            return *nearer;
        }
        let [from, to] = [self, other].map(|camera| camera.eye - camera.target);
        let apart = mixed_direction(from, to, by);
        let distance = libm::exp(mix(libm::log(from.length()), libm::log(to.length()), by));
        let target = self.target.lerp(other.target, by);
        let camera = Self {
            eye: target + apart.unwrap_or(nearer.target - nearer.eye) * distance,
            target,
            up: mixed_direction(self.up, other.up, by).unwrap_or(nearer.up),
            projection: match (self.projection, other.projection) {
                (
                    Projection::Perspective { fov_y_deg: a },
                    Projection::Perspective { fov_y_deg: b },
                ) => Projection::Perspective {
                    fov_y_deg: mix(a, b, by),
                },
                (
                    Projection::Orthographic { height_m: a },
                    Projection::Orthographic { height_m: b },
                ) => Projection::Orthographic {
                    height_m: mix(a, b, by),
                },
                _ => nearer.projection,
            },
            near_m: mix(self.near_m, other.near_m, by),
        };
        // Nothing lies between cameras on opposite sides, or where a distance is 0.
        match apart.is_some() && camera.eye.is_finite() && camera.eye != camera.target {
            true => camera,
            false => *nearer,
        }
    }
}

/// The effects of `nearer`, with the values in between of those that both stacks have.
fn mixed_stack(a: &Stack, b: &Stack, nearer: &Stack, by: f64) -> Stack {
    let both = |name: &str| {
        let (a, b) = (a.get(name)?, b.get(name)?);
        (a.effect == b.effect).then_some((a, b))
    };
    let mut stack = nearer.clone();
    for EnabledEffect { effect, words, .. } in &mut stack.0 {
        let Some((a, b)) = both(&effect.name) else {
            continue;
        };
        for field in effect.fields.iter().filter(|field| !steps(field)) {
            let [low, high] = field.hard;
            let (a, b) = (field.get(&a.words), field.get(&b.words));
            let values: Vec<f64> = a
                .iter()
                .zip(&b)
                .map(|(a, b)| mix(*a, *b, by).clamp(low, high))
                .collect();
            let written = field.set(words, &values);
            debug_assert!(written.is_ok(), "{}: {written:?}", field.name);
        }
    }
    stack
}

impl Preset {
    /// This preset with the look of another: its effects, keyframes, options of accuracy and
    /// background. Scene, camera, clock and size stay.
    #[must_use]
    pub fn with_look_of(self, other: Self) -> Self {
        let mut output = other.output;
        output.resize(self.output.size);
        Self {
            stack: other.stack,
            animation: other.animation,
            accuracy: other.accuracy,
            output,
            ..self
        }
    }

    /// The preset `by` of the way from this one to `other`, 0 to 1, both on `scene`. Numbers, colors
    /// and cameras are in between, also those of effects that both have; everything else is that of
    /// the nearer: effects, choices, whole numbers, keyframes, the ground. Size and accuracy of the
    /// picture stay; it has no golden.
    #[must_use]
    pub fn toward(&self, other: &Self, by: f64, scene: &Scene) -> Self {
        let by = by.clamp(0.0, 1.0);
        let (a, b) = (self.in_meters(scene), other.in_meters(scene));
        let (a, b) = (&*a, &*b);
        let nearer = if by < 0.5 { a } else { b };
        let is_automatic = a.camera.is_none() && b.camera.is_none();
        let camera = if is_automatic && a.scene_camera == b.scene_camera {
            None
        } else {
            let [width, height] = self.output.size.map(|side| f64::from(side.max(1)));
            let seen = |preset: &Self| preset.camera_for(scene, width / height);
            Some(seen(a).toward(&seen(b), by))
        };
        let mut mixture = nearer.clone();
        mixture.camera = camera;
        mixture.stack = mixed_stack(&a.stack, &b.stack, &nearer.stack, by);
        mixture.spin_deg_per_s = mix(a.spin_deg_per_s, b.spin_deg_per_s, by);
        mixture.clock.time_s = mix(a.clock.time_s, b.clock.time_s, by);
        mixture.playback.speed = mix(a.playback.speed, b.playback.speed, by);
        mixture.playback.blend = mix(a.playback.blend, b.playback.blend, by);
        mixture.playback.clip_time_s = match (a.playback.clip_time_s, b.playback.clip_time_s) {
            (Some(a), Some(b)) => Some(mix(a, b, by)),
            _ => nearer.playback.clip_time_s,
        };
        let bottom = |preset: &Self| preset.output.backdrop().bottom;
        let is_even = [a, b].map(|preset| preset.output.background_bottom.is_none()) == [true; 2];
        mixture.output = a.output;
        mixture.output.background = mixed_color(a.output.background, b.output.background, by);
        mixture.output.background_bottom =
            (!is_even).then(|| mixed_color(bottom(a), bottom(b), by));
        mixture.accuracy = a.accuracy;
        mixture.test = None;
        mixture.counted_from(self.origin)
    }
}

impl Preset {
    /// Sets keyframes with which this preset begins its clock as `other` and ends it as it is: of
    /// numbers and colors that differ, of the effects that both have. Tracks of these are replaced;
    /// everything else stays, but that lengths are in meters of `scene` from now on where the other's
    /// have another unit. Returns how many parameters move; where none does, nothing changes.
    pub fn key_from(&mut self, other: &Self, scene: &Scene) -> usize {
        let (mut keyed, mut other) = (self.clone(), Cow::Borrowed(other));
        if (self.unit, self.origin) != (other.unit, other.origin) {
            keyed = self.metric(scene).into_owned();
            other = Cow::Owned(other.metric(scene).into_owned().counted_from(self.origin));
        }
        let [from_s, to_s] = keyed.clock.range_s;
        let start = other.animation.evaluate(&other.stack, from_s);
        let end = keyed.animation.evaluate(&keyed.stack, to_s);
        let mut moving = 0;
        for enabled in &end.0 {
            let effect = &enabled.effect;
            let Some(before) = start.get(&effect.name).filter(|e| e.effect == *effect) else {
                continue;
            };
            for field in effect.fields.iter().filter(|field| !steps(field)) {
                let values = [field.get(&before.words), field.get(&enabled.words)];
                if values[0] == values[1] {
                    continue;
                }
                let keys = [from_s, to_s].into_iter().zip(values);
                let keys = keys.map(|(time_s, value)| Keyframe {
                    time_s,
                    value,
                    easing: default_easing(field),
                });
                if let Ok(track) = Track::new(effect, field, keys.collect()) {
                    keyed.animation.put(track);
                    moving += 1;
                }
            }
        }
        if moving > 0 {
            *self = keyed;
        }
        moving
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{effects::Effect, preset::LengthUnit, scene::builtin};

    fn camera(eye: [f64; 3], fov_y_deg: f64) -> Camera {
        Camera {
            eye: eye.into(),
            projection: Projection::Perspective { fov_y_deg },
            ..Camera::default()
        }
    }

    fn scene() -> Scene {
        crate::scene::builtin::build("cube-wall").expect("a built-in scene")
    }

    #[test]
    fn a_camera_goes_round_its_target_and_ends_at_both_cameras() {
        let (a, b) = (camera([4.0, 0.0, 0.0], 30.0), camera([0.0, 0.0, 1.0], 60.0));
        assert_eq!((a.toward(&b, 0.0), a.toward(&b, 1.0)), (a, b));
        let middle = a.toward(&b, 0.5);
        assert!((middle.eye.length() - 2.0).abs() < 1e-12, "{middle:?}");
        assert!((middle.eye.x - middle.eye.z).abs() < 1e-12, "{middle:?}");
        assert_eq!(
            middle.projection,
            Projection::Perspective { fov_y_deg: 45.0 }
        );
        let opposite = camera([-4.0, 0.0, 0.0], 30.0);
        for k in 0..=8 {
            let by = f64::from(k) / 8.0;
            let between = a.toward(&opposite, by);
            assert!(between.eye.is_finite() && between.eye != between.target);
        }
    }

    #[test]
    fn numbers_are_in_between_and_choices_switch_half_way() {
        let scene = scene();
        let mut a = Preset {
            camera: Some(camera([4.0, 1.0, 0.0], 30.0)),
            ..Preset::default()
        };
        let mut b = a.clone();
        a.output.background = [0.0, 0.0, 0.0, 1.0];
        b.output.background = [1.0, 0.5, 0.0, 1.0];
        b.output.size = [64, 64];
        a.stack.enable(Effect::named("facet"));
        a.stack.enable(Effect::named("lambert"));
        b.stack.enable(Effect::named("facet"));
        b.stack.enable(Effect::named("posterize"));
        let amount = Effect::named("facet").field("amount").expect("a parameter");
        for (preset, value) in [(&mut a, 0.25), (&mut b, 0.75)] {
            let enabled = preset.stack.get_mut("facet").expect("it is enabled");
            amount.set(&mut enabled.words, &[value]).expect("in range");
        }
        for k in 0..=8 {
            let by = f64::from(k) / 8.0;
            let mixture = a.toward(&b, by, &scene);
            let words = &mixture.stack.get("facet").expect("both have it").words;
            assert!((amount.get(words)[0] - (0.25 + 0.5 * by)).abs() < 1e-6);
            let background = mixture.output.background;
            assert!((f64::from(background[1]) - 0.5 * by).abs() < 1e-6);
            assert_eq!(mixture.output.size, a.output.size);
            let has = |name| mixture.stack.get(name).is_some();
            assert_eq!((has("lambert"), has("posterize")), (k < 4, k >= 4));
        }
        assert_eq!(a.toward(&b, 0.0, &scene), a);
    }

    #[test]
    fn keys_lead_from_one_preset_to_the_other_in_its_clock() {
        let [mut a, mut b] = [Preset::default(), Preset::default()];
        b.clock.range_s = [1.0, 3.0];
        let amount = Effect::named("facet").field("amount").expect("a parameter");
        for (preset, value) in [(&mut a, 0.25), (&mut b, 0.75)] {
            preset.stack.enable(Effect::named("facet"));
            preset.stack.enable(Effect::named("lambert"));
            let enabled = preset.stack.get_mut("facet").expect("it is enabled");
            amount.set(&mut enabled.words, &[value]).expect("in range");
        }
        let scene = Scene::default();
        assert_eq!(b.key_from(&a, &scene), 1);
        let at = |time_s| {
            let stack = b.animation.evaluate(&b.stack, time_s);
            amount.get(&stack.get("facet").expect("it is enabled").words)[0]
        };
        assert_eq!([at(0.0), at(1.0), at(3.0)], [0.25, 0.25, 0.75]);
        assert!(at(2.0) > 0.25 && at(2.0) < 0.75);
        // From itself nothing moves that is not keyed already.
        let mut same = a.clone();
        assert_eq!((same.key_from(&a, &scene), same), (0, a));
    }

    #[test]
    fn keys_between_presets_of_two_units_are_in_meters() {
        let scene = builtin::build("sphere?triangles=200").expect("a scene");
        let [mut a, mut b] = [LengthUnit::Scene, LengthUnit::Meter].map(|unit| Preset {
            unit,
            ..Preset::default()
        });
        let amount = Effect::named("explode")
            .field("amount_m")
            .expect("a parameter");
        for (preset, value) in [(&mut a, 0.5), (&mut b, 4.0)] {
            let enabled = preset.stack.enable(Effect::named("explode"));
            amount.set(&mut enabled.words, &[value]).expect("in range");
        }
        let of = |preset: &Preset| {
            let stack = preset.animation.evaluate(&preset.stack, 0.0);
            amount.get(&stack.get("explode").expect("it is enabled").words)[0]
        };
        let meters = of(&a.in_meters(&scene));
        assert_ne!(meters, 0.5);
        let plain = b.clone();
        assert_eq!((b.key_from(&a, &scene), of(&b)), (1, meters));
        assert_eq!((a.key_from(&plain, &scene), of(&a)), (1, 4.0));
        assert_eq!(a.unit, LengthUnit::Meter);
        let bare = Preset {
            unit: LengthUnit::Scene,
            ..Preset::default()
        };
        let mut same = bare.clone();
        assert_eq!((same.key_from(&plain, &scene), same), (0, bare));
    }
}
