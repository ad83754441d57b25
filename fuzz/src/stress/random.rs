//! Random presets: effects, scenes, cameras, times and options, each preset from one seed. Every
//! preset is one that a file may hold.

use std::sync::Arc;

use glam::DVec3;

use super::scenes::Rng;
use crate::{
    accuracy::{AXES, Visibility},
    effects::{EFFECTS, Effect, EnabledEffect, Stack},
    math::{hash, hash_unit},
    params::{Field, Param, ValueType},
    plan::Tier,
    preset::{
        ClipPlayback, Preset, SceneSource,
        animation::{Easing, Keyframe, Track, steps},
        settings::Setting,
    },
    scene::{
        Bounds, Ground, GroundShape, Scene,
        builtin::{self, BUILTINS, BuiltinParam},
        camera::{Camera, MIN_NEAR_M, Projection},
        parts::{Scope, parts},
    },
};

/// Numbers at which formulas change: nothing, hardly anything, and what floats round.
const SPECIAL: [f64; 6] = [0.0, 1e-38, 1.0 / 3.0, 0.999_999, 1.0, -1.0];

/// Most triangles of a random scene, so that the oracle draws it within about a second.
const MAX_TRIANGLES: u64 = 20_000;
/// Most pixels to a side of a random picture.
const MAX_SIDE: i32 = 160;
/// Most particles of seven random presets in eight: a picture of more takes minutes with every
/// option.
const MAX_PARTICLES: f64 = 5_000.0;
/// The scene where a random one has too many triangles several times.
const SMALL_SCENE: &str = "teapot?tess=4";

/// Longest side of a picture of a few pixels.
const MAX_TINY_SIDE: i32 = 9;
/// Latest time of a clock, seconds.
const LATEST_S: f64 = 86_400.0;
/// What tells the turns of [`stretch`] from the others of a seed.
const STRETCH_SEED: u32 = 0x5eed_0004;

/// Which values random parameters take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// What the slider spans.
    OfSlider,
    /// Mostly what the slider spans, now and then anything that is allowed.
    Allowed,
}

impl Rng {
    /// True in one of `n` cases.
    fn one_in(&mut self, n: i32) -> bool {
        self.between(0, n) == 0
    }

    fn pick<T: Clone>(&mut self, list: &[T]) -> T {
        list[self.between(0, list.len() as i32) as usize].clone()
    }

    /// A unit vector.
    fn direction(&mut self) -> DVec3 {
        let component = |rng: &mut Self| rng.real(-1.0, 1.0);
        DVec3::new(component(self), component(self), component(self))
            .try_normalize()
            .unwrap_or(DVec3::Z)
    }

    /// A number of any magnitude within a range: 0.001 is as likely as 1000.
    fn magnitude(&mut self, [low, high]: [f64; 2]) -> f64 {
        if low < 0.0 && high > 0.0 {
            let side = if self.one_in(2) { low } else { high };
            return side.signum() * self.magnitude([0.0, side.abs()]);
        }
        let (sign, near, far) = if high <= 0.0 {
            (-1.0, -high, -low)
        } else {
            (1.0, low, high)
        };
        let near = near.max(far * 1e-12);
        // A range of one number, zero among them, has no magnitudes to choose from.
        let value = if near < far {
            near * (far / near).powf(self.real(0.0, 1.0))
        } else {
            far
        };
        (sign * value).clamp(low, high)
    }

    /// A number that the parameter allows.
    fn number(&mut self, param: &Param) -> f64 {
        match self.between(0, 12) {
            0 => self.pick(&param.hard),
            1 => self.magnitude(param.hard),
            2 => self.pick(&param.soft),
            3 => self.pick(&SPECIAL).clamp(param.hard[0], param.hard[1]),
            _ if param.log => self.magnitude(param.soft),
            _ => self.real(param.soft[0], param.soft[1]),
        }
    }
}

/// The components of a legal value.
fn components(rng: &mut Rng, field: &Field, values: Values) -> Vec<f64> {
    let [low, high] = field.soft;
    let mut component = || {
        let chance = rng.between(0, 8);
        match (&field.value_type, values) {
            (ValueType::Choice(_) | ValueType::Bool, _) => {
                f64::from(rng.between(low as i32, high as i32 + 1))
            }
            (ValueType::U32 | ValueType::I32, Values::Allowed) => rng.number(field).round(),
            (_, Values::Allowed) => rng.number(field),
            (whole, Values::OfSlider) => match chance {
                0 => low,
                1 => high,
                _ if matches!(whole, ValueType::U32 | ValueType::I32) => {
                    rng.real(low, high + 1.0).floor().min(high)
                }
                _ if field.log => low * (high / low).powf(rng.real(0.0, 1.0)),
                _ => rng.real(low, high),
            },
        }
    };
    (0..field.value_type.components())
        .map(|_| component())
        .collect()
}

/// A pair of effects and up to seven more, at most one in each slot, in random order. Pairs come in
/// turn: as many consecutive seeds as there are pairs have each once.
pub fn stack(rng: &mut Rng, seed: u32, values: Values) -> Stack {
    let mut stack = Stack::default();
    let more = (0..rng.between(0, 8)).map(|_| rng.pick(&EFFECTS).clone());
    for effect in pair(seed).into_iter().chain(more.collect::<Vec<_>>()) {
        if stack.get(&effect.name).is_none() && stack.rival_of(&effect).is_none() {
            shake(rng, stack.enable(&effect), values);
        }
    }
    rng.shuffle(&mut stack.0);
    stack
}

/// The pair of effects whose turn it is.
fn pair(seed: u32) -> [Arc<Effect>; 2] {
    let pairs = (0..EFFECTS.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let count = EFFECTS.len() * (EFFECTS.len() - 1) / 2;
    let turn = pairs.into_iter().nth(seed as usize % count);
    turn.expect("one of the pairs").map(|i| EFFECTS[i].clone())
}

/// Gives every parameter of an effect a random value.
pub(super) fn shake(rng: &mut Rng, enabled: &mut EnabledEffect, values: Values) {
    for field in &enabled.effect.fields {
        let value = components(rng, field, values);
        field
            .set(&mut enabled.words, &value)
            .unwrap_or_else(|error| panic!("{}.{}: {error}", enabled.effect.name, field.name));
    }
}

/// A value of a built-in scene's parameter: small scenes are likelier than large ones, and the ends
/// of its range, if the scene allows them, than any other.
fn builtin_value(rng: &mut Rng, param: &BuiltinParam) -> f64 {
    let [low, high] = [*param.range.start(), *param.range.end()];
    if rng.one_in(4) {
        return rng.pick(&[low, high]);
    }
    let value = rng.magnitude([
        low,
        if param.whole {
            high.min(4.0 * param.default.max(1.0))
        } else {
            high
        },
    ]);
    if param.whole {
        value.round().clamp(low, high)
    } else {
        value
    }
}

/// A built-in scene with its query.
fn scene(rng: &mut Rng) -> (String, Scene) {
    for _ in 0..6 {
        let builtin = &BUILTINS[rng.between(0, BUILTINS.len() as i32) as usize];
        let changed: Vec<&BuiltinParam> = builtin.params.iter().filter(|_| rng.one_in(2)).collect();
        let pairs: Vec<String> = changed
            .iter()
            .map(|param| format!("{}={}", param.name, builtin_value(rng, param)))
            .collect();
        let query = if pairs.is_empty() {
            builtin.name.to_owned()
        } else {
            format!("{}?{}", builtin.name, pairs.join("&"))
        };
        // A query with too many triangles for the scene itself is an error.
        if let Ok(scene) = builtin::build(&query)
            && scene.triangle_count() <= MAX_TRIANGLES
        {
            return (query, scene);
        }
    }
    (
        SMALL_SCENE.into(),
        builtin::build(SMALL_SCENE).expect("a small scene of the list"),
    )
}

/// The range of a setting of the camera.
fn camera_number(rng: &mut Rng, name: &str) -> f64 {
    rng.number(
        &Setting::find(&format!("camera.{name}"))
            .expect("a setting of the camera")
            .param,
    )
}

/// A camera from inside the scene to a hundred times its radius away, now and then from much
/// farther; and often a few meters from the origin, where scenes that are far larger have details.
fn camera(rng: &mut Rng, bounds: &Bounds) -> Camera {
    let radius = if bounds.is_empty() {
        1.0
    } else {
        bounds.radius().max(1e-3)
    };
    let center = if bounds.is_empty() {
        DVec3::ZERO
    } else {
        bounds.center()
    };
    let decades = if rng.one_in(8) {
        [2.0, 6.0]
    } else {
        [-2.0, 2.0]
    };
    let (radius, center) = if rng.one_in(3) {
        (radius.min(3.0), DVec3::ZERO)
    } else {
        (radius, center)
    };
    let distance = radius * 10f64.powf(rng.real(decades[0], decades[1]));
    let target = center + rng.direction() * rng.real(0.0, radius);
    let up = if rng.one_in(4) {
        rng.direction()
    } else {
        DVec3::Y
    };
    let projection = if rng.one_in(4) {
        let height_m = if rng.one_in(8) {
            camera_number(rng, "orthographic_height_m")
        } else {
            radius * rng.real(0.1, 4.0)
        };
        Projection::Orthographic { height_m }
    } else {
        Projection::Perspective {
            fov_y_deg: camera_number(rng, "fov_y_deg"),
        }
    };
    let near_m = if rng.one_in(4) {
        1e-3
    } else {
        (distance * 10f64.powf(rng.real(-6.0, 0.0))).clamp(MIN_NEAR_M, 1e6)
    };
    let within = |point: DVec3| point.clamp(DVec3::splat(-1e9), DVec3::splat(1e9));
    Camera {
        eye: within(target - rng.direction() * distance),
        target: within(target),
        up,
        projection,
        near_m,
    }
}

/// What hardly any scene and camera of [`preset`] have, each by turns of its own, so that seeds
/// keep what else they draw: pictures of a few pixels, cameras far away, chains of image effects,
/// glass, late clocks, scopes and keyframes.
fn stretch(preset: &mut Preset, scene: &Scene, seed: u32) {
    let mut rng = Rng(hash(seed ^ STRETCH_SEED));
    let rng = &mut rng;
    if rng.one_in(6) {
        let side = |rng: &mut Rng| rng.between(1, MAX_TINY_SIDE + 1) as u32;
        let longer = rng.between(0, 3) as usize;
        preset.output.size = [side(rng), side(rng)];
        // One side in three pictures stays narrower than a workgroup while the other is not.
        if let Some(side) = preset.output.size.get_mut(longer) {
            *side *= 16;
        }
    }
    if rng.one_in(8) && !scene.bounds().is_empty() {
        preset.camera = Some(far_camera(rng, &scene.bounds()));
    }
    let mut added: Vec<Arc<Effect>> = Vec::new();
    if rng.one_in(4) {
        let passes = EFFECTS
            .iter()
            .filter(|effect| effect.hooks.passes.is_some());
        let passes: Vec<_> = passes.cloned().collect();
        added.extend((0..rng.between(4, 8)).map(|_| rng.pick(&passes)));
    }
    if rng.one_in(8) {
        added.extend(Effect::find("glass").cloned());
    }
    for effect in added {
        if preset.stack.get(&effect.name).is_none() && preset.stack.conflict_with(&effect).is_none()
        {
            shake(rng, preset.stack.enable(&effect), Values::Allowed);
        }
    }
    if rng.one_in(6) {
        limit_an_effect(rng, &mut preset.stack, scene);
    }
    if rng.one_in(6) {
        animate(rng, preset);
    }
    // Particles fly from the first second on, so they would take minutes.
    if rng.one_in(8) && preset.stack.get("particles").is_none() {
        preset.clock.time_s = rng.magnitude([0.0, LATEST_S]);
    }
}

/// A camera 10³ to 10⁷ m away, which the scene fills the picture of.
fn far_camera(rng: &mut Rng, bounds: &Bounds) -> Camera {
    let (radius, distance) = (bounds.radius().max(1e-3), rng.magnitude([1e3, 1e7]));
    let projection = if rng.one_in(2) {
        Projection::Orthographic {
            height_m: radius * rng.real(0.5, 3.0),
        }
    } else {
        let [least, most] = Setting::find("camera.fov_y_deg")
            .expect("a setting")
            .param
            .hard;
        let fitting = (2.0 * radius / distance).atan().to_degrees() * rng.real(1.0, 3.0);
        Projection::Perspective {
            fov_y_deg: fitting.clamp(least, most),
        }
    };
    Camera {
        eye: bounds.center() - rng.direction() * distance,
        target: bounds.center(),
        projection,
        ..Camera::default()
    }
}

/// The preset of `seed` with these effects among its own: each replaces its rivals, and takes
/// random values where the preset has it not.
pub fn preset_with(seed: u32, effects: &[Arc<Effect>]) -> Preset {
    let mut preset = preset(seed);
    let mut rng = Rng(hash(seed));
    for effect in effects {
        while let Some(rival) = preset.stack.rival_of(effect).cloned() {
            preset.disable(&rival.name);
        }
        if preset.stack.get(&effect.name).is_none() {
            shake(&mut rng, preset.stack.enable(effect), Values::Allowed);
        }
    }
    preset
}

/// A preset of `seed`.
pub fn preset(seed: u32) -> Preset {
    let mut rng = Rng(seed.wrapping_mul(0x1234_5679).wrapping_add(0x51ed_270b));
    let rng = &mut rng;
    let (query, scene) = scene(rng);
    let mut preset = Preset {
        name: format!("random {seed}"),
        scene: SceneSource::Builtin(query),
        ..Preset::default()
    };
    preset.output.size = [
        rng.between(1, MAX_SIDE + 1) as u32,
        rng.between(1, MAX_SIDE * 3 / 4 + 1) as u32,
    ];
    preset.output.background = std::array::from_fn(|_| rng.real(0.0, 1.0) as f32);
    if rng.one_in(2) {
        // Colors of what cannot be seen must not show.
        preset.output.background[3] = rng.pick(&[0.0, 1.0]);
    }
    if seed % 3 == 1 {
        // Not a turn of `rng`, so that seeds keep what else they draw.
        preset.output.background_bottom = Some(std::array::from_fn(|c| {
            hash_unit(seed.wrapping_mul(4).wrapping_add(c as u32)) as f32
        }));
    }
    preset.stack = stack(rng, seed, Values::Allowed);
    if seed % 8 != 3 {
        thin_out(&mut preset.stack, hash_unit(seed));
    }
    if rng.one_in(6) {
        limit_an_effect(rng, &mut preset.stack, &scene);
    }
    if !rng.one_in(3) {
        preset.camera = Some(camera(rng, &scene.bounds()));
    }
    if rng.one_in(10) {
        preset.room = rng.real(1.0, 4.0);
    }
    if seed % 5 == 2 {
        let shape = GroundShape::ALL[(seed / 5 % 2) as usize];
        preset.ground = Some(Ground {
            shape,
            size: 0.5 + 4.0 * hash_unit(seed),
            cells: 1 + seed % 7,
            ..Ground::default()
        });
    }
    if rng.one_in(2) {
        preset.clock.time_s = rng.real(0.0, 4.0);
    }
    if rng.one_in(4) {
        preset.spin_deg_per_s = rng.real(-180.0, 180.0);
    }
    if preset
        .stack
        .0
        .iter()
        .any(|enabled| enabled.effect.hooks.has_lines)
        && !rng.one_in(3)
    {
        let radius = scene.bounds().radius().clamp(1e-3, 1e5);
        let points: Vec<[f32; 3]> = (0..rng.between(2, 9))
            .map(|_| (rng.direction() * radius).as_vec3().to_array())
            .collect();
        preset.polyline = Arc::from(points);
    }
    preset.playback = playback(rng, &scene);
    if rng.one_in(4) {
        animate(rng, &mut preset);
    }
    for axis in AXES {
        if rng.one_in(10) {
            preset
                .accuracy
                .pins
                .set(axis, Some(rng.between(0, axis.words.len() as i32) as usize));
        }
    }
    // One exact option takes half the time of both.
    if preset.accuracy.pins.option::<Visibility>().is_none() && !rng.one_in(3) {
        preset.accuracy.pins = preset.accuracy.pins.with(Visibility::Split32);
    }
    if rng.one_in(8) {
        preset.accuracy.tier = rng.pick(&Tier::ALL);
    }
    stretch(&mut preset, &scene, seed);
    preset
}

/// Lowers a number of particles above the most that is quickly judged to one of any magnitude
/// below, chosen by `unit` of 0 to 1. No turn of the generator, so that seeds keep what else they
/// draw.
fn thin_out(stack: &mut Stack, unit: f64) {
    let Some(enabled) = stack
        .0
        .iter_mut()
        .find(|enabled| enabled.effect.name == "particles")
    else {
        return;
    };
    let field = enabled
        .effect
        .fields
        .iter()
        .find(|field| field.name == "count")
        .expect("a field of the particles");
    if field.get(&enabled.words)[0] > MAX_PARTICLES {
        field
            .set(&mut enabled.words, &[MAX_PARTICLES.powf(unit).floor()])
            .expect("a number within the range");
    }
}

/// Gives one parameter of one effect up to three keyframes about the clock's time.
fn animate(rng: &mut Rng, preset: &mut Preset) {
    let animated: Vec<&EnabledEffect> = preset
        .stack
        .0
        .iter()
        .filter(|enabled| !enabled.effect.fields.is_empty())
        .collect();
    if animated.is_empty() {
        return;
    }
    let effect = rng.pick(&animated).effect.clone();
    let field = rng.pick(&effect.fields);
    // Particles are drawn from the start of their flight on.
    if effect.name == "particles" && field.name == "count" {
        return;
    }
    let easing = if steps(&field) {
        Easing::Hold
    } else {
        rng.pick(&Easing::ALL)
    };
    let first_s = preset.clock.time_s + rng.real(-2.0, 0.5);
    let keys = (0..rng.between(1, 4))
        .map(|i| Keyframe {
            time_s: first_s + 2.0 * f64::from(i),
            value: components(rng, &field, Values::Allowed),
            easing,
        })
        .collect();
    preset
        .animation
        .put(Track::new(&effect, &field, keys).expect("values and times that are allowed"));
}

/// Limits one effect to one part of the scene.
fn limit_an_effect(rng: &mut Rng, stack: &mut Stack, scene: &Scene) {
    let parts = parts(scene);
    let limited: Vec<_> = stack
        .0
        .iter()
        .map(|enabled| enabled.effect.clone())
        .filter(|effect| effect.has_scope())
        .collect();
    if !limited.is_empty() && !parts.is_empty() {
        let pattern = parts[rng.between(0, parts.len() as i32) as usize].pattern();
        stack
            .limit(&rng.pick(&limited), Scope::new([pattern]))
            .expect("one scope is allowed");
    }
}

fn playback(rng: &mut Rng, scene: &Scene) -> ClipPlayback {
    let clips: Vec<&str> = scene
        .rig
        .clips
        .iter()
        .map(|clip| clip.name.as_str())
        .collect();
    if clips.is_empty() || rng.one_in(4) {
        return ClipPlayback::default();
    }
    let mut playback = ClipPlayback {
        clip: rng.pick(&clips).into(),
        speed: rng.real(-2.0, 2.0),
        ..ClipPlayback::default()
    };
    if rng.one_in(3) {
        playback.second_clip = rng.pick(&clips).into();
        playback.blend = rng.real(0.0, 1.0);
    }
    playback
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_one_preset_and_other_seeds_give_others() {
        assert_eq!(preset(7), preset(7));
        assert_ne!(preset(7), preset(8));
    }

    #[test]
    fn effects_that_are_asked_for_are_among_those_of_every_preset() {
        let asked = ["glass", "studio"].map(|name| Effect::find(name).expect("an effect").clone());
        for seed in 0..200 {
            let (with, without) = (preset_with(seed, &asked), preset(seed));
            let names = |preset: &Preset| -> Vec<String> {
                let enabled = preset.stack.0.iter();
                enabled.map(|enabled| enabled.effect.name.clone()).collect()
            };
            assert!(
                asked
                    .iter()
                    .all(|effect| with.stack.get(&effect.name).is_some()
                        && with.stack.rival_of(effect).is_none()),
                "{seed}: {:?}",
                names(&with)
            );
            assert_eq!(with.scene, without.scene);
            let rivals = names(&without)
                .into_iter()
                .filter(|name| !names(&with).contains(name));
            assert!(rivals.count() <= asked.len() + 1, "{seed}");
        }
        assert_eq!(preset_with(9, &[]), preset(9));
    }

    #[test]
    fn seeds_draw_what_is_rare_in_files_of_people() {
        type Kind = fn(&Preset) -> bool;
        let kinds: [(&str, Kind); 5] = [
            ("9 pixels a side", |p| {
                p.output.size.iter().all(|side| *side <= 9)
            }),
            ("1 pixel of many", |p| {
                p.output.size.contains(&1) && p.output.size.iter().any(|side| *side > 15)
            }),
            ("10⁵ m away", |p| {
                p.camera
                    .as_ref()
                    .is_some_and(|camera| camera.eye.length() > 1e5)
            }),
            ("glass with four image effects", |p| {
                let passes = p.stack.each(|hooks| hooks.passes.as_ref()).count();
                passes > 3 && p.stack.get("glass").is_some()
            }),
            ("an hour", |p| p.clock.time_s > 3600.0),
        ];
        for (what, is_one) in kinds {
            assert!(
                (0..2_000).map(preset).any(|preset| is_one(&preset)),
                "{what}"
            );
        }
    }

    #[test]
    fn every_pair_of_effects_has_its_turn() {
        let pairs = EFFECTS.len() * (EFFECTS.len() - 1) / 2;
        let first_seed = 7_000;
        let stacks: Vec<Stack> = (first_seed..first_seed + pairs as u32)
            .map(|seed| stack(&mut Rng(seed), seed, Values::OfSlider))
            .collect();
        for (i, a) in EFFECTS.iter().enumerate() {
            for b in &EFFECTS[..i] {
                let mut stack = Stack::default();
                stack.enable(a);
                let has_both = |stack: &Stack| {
                    [a, b]
                        .iter()
                        .all(|effect| stack.get(&effect.name).is_some())
                };
                assert!(
                    stack.rival_of(b).is_some() || stacks.iter().any(has_both),
                    "{} with {}",
                    a.name,
                    b.name
                );
            }
        }
    }

    #[test]
    fn magnitudes_stay_in_their_range_and_reach_all_of_it() {
        let mut rng = Rng(1);
        for range in [
            [-1e6, 1e6],
            [0.0, 1.0],
            [-3.0, 0.0],
            [0.0, 0.0],
            [2.0, 2.0],
            [1e-3, 1e9],
        ] {
            let values: Vec<f64> = (0..2_000).map(|_| rng.magnitude(range)).collect();
            assert!(
                values
                    .iter()
                    .all(|value| (range[0]..=range[1]).contains(value)),
                "{range:?}"
            );
        }
        let signs: Vec<f64> = (0..100)
            .map(|_| rng.magnitude([-1.0, 1.0]).signum())
            .collect();
        assert!(signs.contains(&1.0) && signs.contains(&-1.0));
    }
}
