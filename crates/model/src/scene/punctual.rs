//! Punctual lights: the lights that come with a scene, as the glTF extension `KHR_lights_punctual`
//! has them. They have no size and cast no shadows.
//!
//! A light is placed in f64 for the moment of a picture and rounded once. Renderers and the oracle
//! start from these rounded bits.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::{DMat4, DVec3};

use super::model::Scene;

/// Most lights of a scene that shine.
pub const MAX_LIGHTS: usize = 16;

/// Nearest distance that makes a light stronger, meters.
const NEAREST_M: f64 = 0.01;

/// Largest coordinate of a light; its square is still an f32.
const MAX_COORDINATE_M: f64 = 1e18;

/// Smallest difference of the cosines of a spot's cones.
const LEAST_EDGE: f64 = 0.001;

/// Where a light shines from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From infinitely far away, along -z of its node. Its intensity is in lux.
    Directional,
    /// From a point, to all sides. Its intensity is in candela.
    Point,
    /// From a point, into a cone about -z of its node: whole within the inner angle, nothing beyond
    /// the outer one. Radians between the axis and the edge, 0 to π/2. Its intensity is in candela.
    Spot { inner: f64, outer: f64 },
}

impl LightKind {
    /// The cone of a spot that says nothing of it.
    pub const SPOT: Self = Self::Spot {
        inner: 0.0,
        outer: FRAC_PI_4,
    };
}

/// A light that comes with the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLight {
    pub name: String,
    pub kind: LightKind,
    /// Linear RGB times the intensity.
    pub light: [f64; 3],
    /// Meters at which a point or spot ends; none: it reaches everywhere.
    pub range_m: Option<f64>,
    /// Transform in the rest pose; its scale does not count.
    pub world_from_light: DMat4,
    /// The node of `Scene::rig` that moves it. `None`: it does not move.
    pub node: Option<usize>,
}

/// A light at the moment of a picture. Each number is rounded to f32 once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacedLight {
    /// Linear RGB that a white matt surface shows that faces it, of a point or spot from a distance
    /// of one meter.
    pub light: [f32; 3],
    /// It shines from `position`; else from infinitely far away.
    pub has_position: bool,
    /// World space, meters.
    pub position: [f32; 3],
    /// 1 / meters; 0 without end.
    pub inverse_range: f32,
    /// Unit vector in world space, against the direction in which it shines.
    pub toward: [f32; 3],
    /// The square of `scale * cosine + offset`, from 0 to 1, is the fraction of its light that
    /// leaves in a direction; `[scale, offset]`. `[0, 1]` to all sides.
    pub cone: [f32; 2],
}

/// The light of one source at a point.
pub struct Arriving {
    /// Unit vector to where it comes from.
    pub toward: DVec3,
    /// Linear RGB that a white matt surface shows that faces it.
    pub light: DVec3,
}

impl SceneLight {
    /// The light at this transform of its node or scene. One without a direction shines along -z.
    pub fn placed(&self, world_from_light: &DMat4) -> PlacedLight {
        let position = world_from_light.w_axis.truncate();
        let toward = world_from_light.z_axis.truncate();
        let range_m = self.range_m.filter(|range| *range > 0.0);
        PlacedLight {
            light: self.light.map(|light| (light * FRAC_1_PI) as f32),
            has_position: self.kind != LightKind::Directional,
            position: round_vector(position),
            inverse_range: range_m.map_or(0.0, |range| (1.0 / range).min(1e18) as f32),
            toward: round_vector(toward.try_normalize().unwrap_or(DVec3::Z)),
            cone: match self.kind {
                LightKind::Directional | LightKind::Point => [0.0, 1.0],
                LightKind::Spot { inner, outer } => {
                    let (least, most) = (libm::cos(outer), libm::cos(inner));
                    let scale = 1.0 / (most - least).max(LEAST_EDGE);
                    [scale as f32, (-least * scale) as f32]
                }
            },
        }
    }
}

impl Scene {
    /// How strong the strongest of its lights is on a white matt surface about its middle, where that
    /// is far beyond 1: files in photometric units are meant for a camera's exposure.
    pub fn glare(&self) -> Option<f64> {
        const MOST: f64 = 4.0;
        let bounds = self.content_bounds();
        let strength = |light: &SceneLight| {
            let place = light.world_from_light.w_axis.truncate();
            let distance = match light.kind {
                LightKind::Directional => 1.0,
                LightKind::Point | LightKind::Spot { .. } => {
                    (place - bounds.center()).length().max(bounds.radius())
                }
            };
            light.light.into_iter().fold(0.0, f64::max) * FRAC_1_PI / (distance * distance)
        };
        let strongest = self.lights.iter().map(strength).fold(0.0, f64::max);
        (strongest > MOST && strongest.is_finite()).then_some(strongest)
    }
}

/// Stands in the note on lights that are far too strong, which no longer holds once they are dimmed.
pub const TOO_STRONG: &str = "times as strong as what a picture holds";

/// What dims lights that are so many times too strong, with one digit.
pub fn dimmed(times: f64) -> f64 {
    let digits = format!("{:.0e}", 1.0 / times);
    digits.parse().unwrap_or(1.0 / times)
}

fn round_vector(vector: DVec3) -> [f32; 3] {
    let within = vector.clamp(
        DVec3::splat(-MAX_COORDINATE_M),
        DVec3::splat(MAX_COORDINATE_M),
    );
    within
        .to_array()
        .map(|v| if v.is_nan() { 0.0 } else { v as f32 })
}

impl PlacedLight {
    /// What arrives at a point of the world: by the inverse square of the distance, which ends
    /// smoothly at the range, and by the cone, as the extension recommends.
    pub fn arriving(&self, position: DVec3) -> Arriving {
        let (light, axis) = (
            DVec3::from(self.light.map(f64::from)),
            DVec3::from(self.toward.map(f64::from)),
        );
        if !self.has_position {
            return Arriving {
                toward: axis,
                light,
            };
        }
        let path = DVec3::from(self.position.map(f64::from)) - position;
        let squared = path.length_squared().max(NEAREST_M * NEAREST_M);
        let toward = path / squared.sqrt();
        let reach = squared * f64::from(self.inverse_range).powi(2);
        let window = (1.0 - reach * reach).max(0.0);
        let [scale, offset] = self.cone.map(f64::from);
        let cone = (axis.dot(toward) * scale + offset).clamp(0.0, 1.0);
        Arriving {
            toward,
            light: light * (window * cone * cone / squared),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};

    use super::*;

    /// A light of π candela or lux, so that numbers are whole, two meters above the origin; it
    /// shines down.
    fn above(kind: LightKind, range_m: Option<f64>) -> PlacedLight {
        let light = SceneLight {
            name: String::new(),
            kind,
            light: [PI, 2.0 * PI, 0.0],
            range_m,
            world_from_light: DMat4::IDENTITY,
            node: None,
        };
        let down = DMat4::from_rotation_x(-FRAC_PI_2);
        light.placed(&(DMat4::from_translation(2.0 * DVec3::Y) * down))
    }

    fn near(arriving: &Arriving, toward: DVec3, red: f64) {
        let light = DVec3::new(red, 2.0 * red, 0.0);
        let off = (arriving.light - light).length() + (arriving.toward - toward).length();
        assert!(off < 1e-6, "{} from {}", arriving.light, arriving.toward);
    }

    #[test]
    fn a_directional_light_is_the_same_everywhere() {
        let sun = above(LightKind::Directional, Some(1.0));
        for place in [DVec3::ZERO, DVec3::new(1e6, -40.0, 3.0)] {
            near(&sun.arriving(place), DVec3::Y, 1.0);
        }
    }

    #[test]
    fn a_point_falls_off_with_the_square_of_the_distance_and_ends_at_its_range() {
        let endless = above(LightKind::Point, None);
        near(&endless.arriving(DVec3::ZERO), DVec3::Y, 0.25);
        near(&endless.arriving(8.0 * DVec3::NEG_Y), DVec3::Y, 0.01);
        near(&endless.arriving(3.0 * DVec3::Y), DVec3::NEG_Y, 1.0);
        let aside = DVec3::new(3.0, 2.0, -4.0);
        near(&endless.arriving(aside), DVec3::new(-0.6, 0.0, 0.8), 0.04);
        let ends = above(LightKind::Point, Some(4.0));
        near(&ends.arriving(DVec3::ZERO), DVec3::Y, 0.25 * 15.0 / 16.0);
        near(&ends.arriving(2.0 * DVec3::NEG_Y), DVec3::Y, 0.0);
        near(&ends.arriving(9.0 * DVec3::NEG_Y), DVec3::Y, 0.0);
        let inside = endless.arriving(2.0 * DVec3::Y);
        assert!(inside.light.is_finite() && inside.toward == DVec3::ZERO);
    }

    #[test]
    fn a_spot_is_whole_inside_its_inner_cone_and_dark_outside_the_outer_one() {
        let spot = LightKind::Spot {
            inner: FRAC_PI_6,
            outer: FRAC_PI_3,
        };
        let spot = above(spot, None);
        // On a sphere of one meter about it, so that distances do not count.
        let at = |angle: f64| {
            let toward = DVec3::new(-angle.sin(), angle.cos(), 0.0);
            (spot.arriving(2.0 * DVec3::Y - toward), toward)
        };
        for (angle, fraction) in [(0.0, 1.0), (0.5, 1.0), (1.1, 0.0), (2.0, 0.0)] {
            let (arriving, toward) = at(angle);
            near(&arriving, toward, fraction);
        }
        let between = (f64::sqrt(3.0) + 1.0) / 4.0;
        let (arriving, toward) = at(between.acos());
        near(&arriving, toward, 0.25);
        let sharp = LightKind::Spot {
            inner: FRAC_PI_3,
            outer: FRAC_PI_3,
        };
        assert!(above(sharp, None).cone.iter().all(|v| v.is_finite()));
    }

    #[test]
    fn no_transform_makes_a_number_that_is_none() {
        let light = |scale: f64| {
            let wild = DMat4::from_scale(DVec3::splat(scale))
                * DMat4::from_translation(DVec3::splat(scale));
            let light = SceneLight {
                name: String::new(),
                kind: LightKind::SPOT,
                light: [1.0; 3],
                range_m: Some(1e-30),
                world_from_light: wild,
                node: None,
            };
            light.placed(&wild)
        };
        for scale in [0.0, 1e200, f64::INFINITY, f64::NAN] {
            let PlacedLight {
                position,
                toward,
                inverse_range,
                ..
            } = light(scale);
            let all = position.iter().chain(&toward).chain([&inverse_range]);
            assert!(all.into_iter().all(|v| (v * v).is_finite()), "{scale}");
        }
    }
}
