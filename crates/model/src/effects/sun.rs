//! One sun: where Lambert and Shadow are both on, they are one light.

use glam::{DVec3, Vec4};

use super::{
    lambert::{self, Lambert},
    read,
    shadow::{self, Shading, Shadow},
    stack::{EnabledEffect, Stack},
};

impl Stack {
    /// The stack as it is drawn: with `factor` times as long lengths in pixels, and with one sun.
    #[must_use]
    pub fn drawn(&self, factor: f64) -> Self {
        self.scaled(factor).with_one_sun()
    }

    /// Where Lambert and Shadow both act on the whole scene, the light that casts shadows is that
    /// of Lambert: from its direction, unless Shadow is turned away from its own default, and with
    /// its colors. A shadow that only dims keeps what it does. Lambert's headlight then comes from
    /// above and below.
    #[must_use]
    fn with_one_sun(mut self) -> Self {
        let at = |stack: &Self, name: &str| {
            let is_it = |enabled: &EnabledEffect| {
                enabled.effect.name == name && enabled.on.is_whole_scene()
            };
            stack.0.iter().position(is_it)
        };
        let (Some(sun_at), Some(shadow_at)) = (
            at(&self, &lambert::EFFECT.name),
            at(&self, &shadow::EFFECT.name),
        ) else {
            return self;
        };
        let sun: Lambert = read(&self.0[sun_at].words);
        let mut shadow: Shadow = read(&self.0[shadow_at].words);
        let default = Shadow::default();
        let is_turned = [shadow.azimuth_deg, shadow.elevation_deg]
            != [default.azimuth_deg, default.elevation_deg];
        let toward = DVec3::from([0, 1, 2].map(|axis| f64::from(sun.sun_direction[axis])));
        if !is_turned && let Some(toward) = toward.try_normalize() {
            shadow.azimuth_deg = libm::atan2(toward.x, toward.z).to_degrees() as f32;
            shadow.elevation_deg = libm::asin(toward.y.clamp(-1.0, 1.0)).to_degrees() as f32;
        }
        if Shading::of(shadow.shading) == Shading::Dim {
            self.0[shadow_at].put(&shadow);
            return self;
        }
        // A surface that faces the eye has half of it, as from all sides.
        let headlight = Vec4::new(0.5, 0.5, 0.5, 0.0) * sun.headlight;
        let lit = |color: [f32; 4]| (Vec4::from(color) + headlight).min(Vec4::ONE).to_array();
        (shadow.light, shadow.sky, shadow.ground) = (sun.sun, lit(sun.sky), lit(sun.ground));
        let mut one = self.0[shadow_at].clone();
        one.put(&shadow);
        // What stands between them, such as Toon, sees lit colors as without the shadow.
        self.0[sun_at] = one;
        self.0.remove(shadow_at);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both() -> Stack {
        let mut stack = Stack::default();
        stack.enable(&lambert::EFFECT);
        stack.enable(&shadow::EFFECT);
        stack
    }

    #[test]
    fn lambert_and_shadow_are_one_light_with_the_direction_and_colors_of_lambert() {
        let drawn = both().drawn(1.0);
        assert_eq!(drawn.0.len(), 1);
        let (shadow, sun) = (drawn.light().expect("a light"), Lambert::default());
        assert_eq!(shadow.light, sun.sun);
        let toward = DVec3::from([0, 1, 2].map(|axis| f64::from(sun.sun_direction[axis])));
        assert!(shadow.toward().dot(toward.normalize()) > 0.999_999);
        assert_eq!(drawn.drawn(1.0), drawn, "again it is the same");
    }

    #[test]
    fn a_shadow_that_is_turned_turns_the_sun_and_one_that_dims_only_dims() {
        let mut stack = both();
        let mut turned = Shadow {
            azimuth_deg: -70.0,
            ..Shadow::default()
        };
        let put = |stack: &mut Stack, shadow: Shadow| {
            stack.get_mut("shadow").expect("it is on").put(&shadow);
        };
        put(&mut stack, turned);
        assert_eq!(
            stack.drawn(1.0).light().map(|light| light.azimuth_deg),
            Some(-70.0)
        );
        turned.shading = Shading::Dim as u32;
        put(&mut stack, turned);
        assert_eq!(stack.drawn(1.0), stack);
    }
}
