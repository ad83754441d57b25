//! One sun: Lambert or Studio and Shadow act as one light.

use glam::Vec4;

use super::{
    effect::read,
    shadow,
    stack::{EnabledEffect, Stack},
};

impl Stack {
    /// The stack as it is drawn: with `factor` times as long lengths in pixels, and with one sun.
    #[must_use]
    pub fn drawn(&self, factor: f64) -> Self {
        self.scaled(factor).with_one_sun()
    }

    /// Where Lambert or Studio and Shadow act on the whole scene, the light that casts shadows is
    /// that of the former: from its direction, unless Shadow is turned away from its own default,
    /// and with its colors. A shadow that only dims keeps what it does. Lambert's headlight then
    /// comes from above and below.
    #[must_use]
    fn with_one_sun(mut self) -> Self {
        let at = |stack: &Self, name: &str| {
            let is_it = |enabled: &EnabledEffect| {
                enabled.effect.name == name && enabled.on.is_whole_scene()
            };
            stack.0.iter().position(is_it)
        };
        let Some(shadow_at) = at(&self, &shadow::EFFECT.name) else {
            return self;
        };
        let mut shadow: shadow::Shadow = read(&self.0[shadow_at].words);
        let sun = at(&self, "studio").and_then(|at| {
            let field = self.0[at].effect.field("sun_direction")?;
            Some((at, field.offset / 4))
        });
        if let Some((studio_at, first)) = sun {
            let dims = shadow::Shading::of(shadow.shading) == shadow::Shading::Dim;
            if dims && shadow.strength == 0.0 {
                return self;
            }
            let words = &mut self.0[studio_at].words[first..first + 4];
            let mut toward = std::array::from_fn(|axis| f32::from_bits(words[axis]));
            shadow.face(&mut toward);
            if !dims {
                // Studio takes the shadow from its sun alone; Shadow itself then dims by nothing.
                toward[3] = shadow.strength;
                (shadow.shading, shadow.strength) = (shadow::Shading::Dim as u32, 0.0);
            }
            words.copy_from_slice(&toward.map(f32::to_bits));
            self.0[shadow_at].put(&shadow);
            return self;
        }
        let Some(sun_at) = at(&self, "lambert") else {
            return self;
        };
        let sun = &self.0[sun_at];
        let color = |name: &str| -> [f32; 4] {
            let numbers = sun.numbers(name);
            std::array::from_fn(|at| numbers.get(at).map_or(0.0, |number| *number as f32))
        };
        shadow.face(&mut color("sun_direction"));
        if shadow::Shading::of(shadow.shading) == shadow::Shading::Dim {
            self.0[shadow_at].put(&shadow);
            return self;
        }
        // A surface that faces the eye has half of it, as from all sides.
        let headlight = Vec4::new(0.5, 0.5, 0.5, 0.0) * sun.number("headlight") as f32;
        let lit = |color: [f32; 4]| (Vec4::from(color) + headlight).min(Vec4::ONE).to_array();
        (shadow.light, shadow.sky, shadow.ground) =
            (color("sun"), lit(color("sky")), lit(color("ground")));
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
    use glam::DVec3;

    use super::{
        super::{
            Effect,
            hooks::{Lighting, Surface},
            shadow::Shadow,
        },
        *,
    };

    fn both() -> Stack {
        let mut stack = Stack::default();
        stack.enable(Effect::named("lambert"));
        stack.enable(&shadow::EFFECT);
        stack
    }

    #[test]
    fn lambert_and_shadow_are_one_light_with_the_direction_and_colors_of_lambert() {
        let drawn = both().drawn(1.0);
        assert_eq!(drawn.0.len(), 1);
        let shadow = drawn.light().expect("a light");
        let sun = EnabledEffect::new(Effect::named("lambert"));
        assert_eq!(shadow.light.map(f64::from).to_vec(), sun.numbers("sun"));
        let toward = DVec3::from_slice(&sun.numbers("sun_direction"));
        assert!(shadow.toward().dot(toward.normalize()) > 0.999_999);
        assert_eq!(drawn.drawn(1.0), drawn, "again it is the same");
    }

    #[test]
    fn studio_takes_a_shadow_from_its_sun_alone() {
        let mut stack = Stack::default();
        stack.enable(Effect::named("studio"));
        stack.enable(&shadow::EFFECT).put(&Shadow {
            strength: 0.75,
            ..Shadow::default()
        });
        let drawn = stack.drawn(1.0);
        let sun = drawn.get("studio").expect("it is on").clone();
        let field = sun.effect.field("sun_direction").expect("it has a sun");
        let strength = f32::from_bits(sun.words[field.offset / 4 + 3]);
        let light = drawn.light().expect("a light");
        assert_eq!((strength, light.strength), (0.75, 0.0));
        let toward = DVec3::from_slice(&sun.numbers("sun_direction"));
        assert!(light.toward().dot(toward.normalize()) > 0.999_999);
        assert_eq!(drawn.drawn(1.0), drawn, "again it is the same");
        let shade = |sun: [f64; 4], lit: f64| {
            let mut stack = drawn.clone();
            stack.get_mut("studio").expect("it is on").set("sun", &sun);
            let surface = Surface {
                lit,
                ..Surface::example(DVec3::splat(0.5), 0)
            };
            stack
                .shade(surface, u32::MAX, &Lighting::default())
                .color
                .truncate()
        };
        let (bright, none) = ([0.5, 0.4, 0.3, 1.0], [0.0, 0.0, 0.0, 1.0]);
        let sky = shade(none, 1.0);
        assert_eq!(shade(none, 0.0), sky, "the sky casts no shadow");
        let (lit, dark) = (shade(bright, 1.0) - sky, shade(bright, 0.0) - sky);
        assert!((dark - lit * 0.25).length() < 1e-12, "{dark} of {lit}");
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
        turned.shading = shadow::Shading::Dim as u32;
        put(&mut stack, turned);
        assert_eq!(stack.drawn(1.0), stack);
    }
}
