//! Studio: materials of glTF 2.0 under a sun and an environment.
//!
//! A surface reflects as its specification says: microfacets distributed after Trowbridge and Reitz
//! (GGX), masked and shadowed after Smith with heights correlated (Heitz 2014), with Schlick's
//! Fresnel. Light that meets several facets is not lost: it leaves matt, in the color of that many
//! reflections (Kulla and Conty 2017), and what is not reflected enters a matt body, so that white
//! stays white. The fractions of light that this takes are rational functions fitted to the integral
//! over all directions, within 0.013 of it.

use glam::DVec3;

use super::{
    BuiltIn, Effect, Surface, SurfaceEffect,
    hooks::{
        LitEffect, Lighting,
        environment::{Environment, Seen, turned_by},
        tone::{rgb, turned},
    },
};
use crate::{
    choice,
    words,
    scene::{panorama::Panorama, punctual::PlacedLight},
};

choice! {
    /// Where metallic and roughness come from.
    pub enum MaterialSource {
        /// From the materials of the scene.
        Scene,
        /// From this effect, for every material that lights change.
        Own,
    }
}

words! {
    pub struct Studio of "studio" {
        sun: [f32; 4],
        sun_direction: [f32; 4],
        environment: u32,
        turn_deg: f32,
        strength: f32,
        material: u32,
        metallic: f32,
        roughness: f32,
        lights: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Studio>().on_surface::<Studio>()
    .in_light::<Studio>()
    .into()
});

impl SurfaceEffect for Studio {
    fn apply(s: Surface, p: &Self) -> Surface {
        p.in_surroundings(s, None)
    }
}

impl Studio {
    /// Under the sun, in an environment, which may be the picture of the scene's surroundings.
    fn in_surroundings(&self, mut s: Surface, picture: Option<&Panorama>) -> Surface {
        let p = self;
        let reflector = Reflector::of(&s, p);
        let seen = reflector.albedo(s.normal.dot(s.view).max(GRAZING));

        let [x, y, z, shadowed] = p.sun_direction.map(f64::from);
        let toward = DVec3::new(x, y, z).try_normalize().unwrap_or(DVec3::Y);
        let arrives = 1.0 - shadowed * (1.0 - s.lit);
        let sunlight =
            rgb(p.sun) * arrives * reflector.sunlight(&seen, s.normal, s.view, toward);

        let mirrored = s.normal * (2.0 * s.normal.dot(s.view)) - s.view;
        // The rougher a surface, the nearer to its normal is what it mirrors (Lagarde 2014).
        let spread = mirrored + (s.normal - mirrored) * (reflector.alpha * reflector.alpha);
        let spread = spread / spread.length_squared().max(1e-12).sqrt();
        let turn = turned(p.turn_deg.into());
        let sky = Seen::of(Environment::of(p.environment), picture);
        let diffuse = sky.irradiance(turned_by(s.normal, turn));
        let reflected = sky.radiance(turned_by(spread, turn), reflector.alpha);
        let from_sky = (reflector.diffuse * (1.0 - seen.all) + seen.repeated) * diffuse
            + seen.once * reflected;

        let light = sunlight + from_sky * (f64::from(p.strength) * s.finish.occlusion) + s.glow;
        s.color = light.extend(s.color.w);
        s
    }
}

impl LitEffect for Studio {
    fn in_light(surface: Surface, light: &Lighting<'_>, p: &Self) -> Surface {
        let reflector = Reflector::of(&surface, p);
        let (normal, view) = (surface.normal, surface.view);
        let seen = reflector.albedo(normal.dot(view).max(GRAZING));
        let reflected = |light: &PlacedLight| {
            let arriving = light.arriving(surface.position);
            arriving.light * reflector.sunlight(&seen, normal, view, arriving.toward)
        };
        let sum: DVec3 = light.lights.iter().map(reflected).sum();
        let mut s = p.in_surroundings(surface, light.panorama);
        s.color += (sum * f64::from(p.lights)).extend(0.0);
        s
    }
}

/// Smallest perceptual roughness: a sun without width is not seen in a smoother surface, and the
/// squares of f32 still tell its directions apart.
const SMOOTHEST: f64 = 0.08;
/// Smallest cosine between a normal and the eye. Interpolated normals may face away from it.
const GRAZING: f64 = 0.001;

/// What a material does with light.
struct Reflector {
    /// Color of the light that enters and leaves again.
    diffuse: DVec3,
    /// Fraction of light reflected that meets it straight on.
    straight: DVec3,
    /// Of light that grazes it.
    grazing: f64,
    /// Roughness of its microfacets.
    alpha: f64,
    /// Of light that a microfacet reflects onto another: the fraction that leaves.
    again: DVec3,
    /// Of one reflection, the mean over all directions of what meets another microfacet.
    lost_mean: f64,
    /// Mean over all directions of what is reflected.
    all_mean: DVec3,
}

/// Of the light that comes from a direction, the fractions that are reflected.
struct Albedo {
    /// Cosine of the angle between the direction and the normal.
    cosine: f64,
    /// By a white metal: what meets another microfacet.
    lost: f64,
    /// By one reflection.
    once: DVec3,
    /// By several.
    repeated: DVec3,
    all: DVec3,
}

impl Reflector {
    fn of(s: &Surface, p: &Studio) -> Self {
        let finish = s.finish;
        let has_own =
            MaterialSource::of(p.material) == MaterialSource::Own && finish.specular.w > 0.0;
        let (metallic, roughness) = if has_own {
            (p.metallic.into(), p.roughness.into())
        } else {
            (finish.metallic, finish.roughness)
        };
        let roughness = roughness.clamp(SMOOTHEST, 1.0);
        let base = s.color.truncate() - s.glow;
        Self::new(
            base * (1.0 - metallic),
            finish.specular.truncate().lerp(base, metallic),
            finish.specular.w + (1.0 - finish.specular.w) * metallic,
            roughness * roughness,
        )
    }

    fn new(diffuse: DVec3, straight: DVec3, grazing: f64, alpha: f64) -> Self {
        let lost_mean = alpha * (0.2233 + alpha * (2.928 * alpha - 0.3193)) / (1.0 + alpha * (6.4332 * alpha - 2.5664));
        let edge = (0.0506 + 0.0513 * alpha) / (1.0 + alpha * (2.4128 + 26.4021 * alpha));
        let mean = straight + (DVec3::splat(grazing) - straight) / 21.0;
        let again = mean * mean * (1.0 - lost_mean) / (1.0 - mean * lost_mean);
        Self {
            diffuse,
            straight,
            grazing,
            alpha,
            again,
            lost_mean,
            all_mean: straight * (1.0 - lost_mean - edge) + grazing * edge + again * lost_mean,
        }
    }

    /// Of light from a direction at an angle to the normal with this cosine.
    fn albedo(&self, cosine: f64) -> Albedo {
        let (a, c) = (self.alpha, cosine);
        let lost = a
            * c
            * (0.0963
                + a * (0.6126 + 3.1906 * a)
                + c * (0.621 + a * (25.3101 * a - 3.1938) + c * (0.3654 - 2.4222 * a)))
            / (a * a
                + c * (a * (15.6251 * a - 1.0455)
                    + c * (0.9363 + a * (34.3901 * a - 12.4282) + c * (7.4696 - 10.5106 * a))));
        // Square of the cosine at which microfacets reflect as all of them do together.
        let sharp = (c * c
            + a * (c * (9.474 * a + 16.5521 * c - 0.9144) + a * (8.1679 - 0.2622 * a)))
            / (1.0 + a * (17.0046 + 19.1896 * a + 7.1277 * c));
        let edge = (1.0 - lost) * fifth(1.0 - sharp.sqrt());
        let once = self.straight * (1.0 - lost - edge) + self.grazing * edge;
        let repeated = self.again * lost;
        Albedo {
            cosine,
            lost,
            once,
            repeated,
            all: once + repeated,
        }
    }

    /// Light that leaves towards the eye, of light from one direction that gives a white matt
    /// surface its own strength: π times the BRDF, times the cosine.
    fn sunlight(&self, seen: &Albedo, normal: DVec3, view: DVec3, toward: DVec3) -> DVec3 {
        let facing = normal.dot(toward);
        if facing <= 0.0 {
            return DVec3::ZERO;
        }
        (self.facets(seen.cosine, normal, view, toward) + self.rest(seen, &self.albedo(facing)))
            * facing
    }

    /// π times the BRDF of one reflection.
    fn facets(&self, cosine: f64, normal: DVec3, view: DVec3, toward: DVec3) -> DVec3 {
        let facing = normal.dot(toward);
        let sum = toward + view;
        let half = sum / sum.length_squared().max(1e-12).sqrt();
        let along = normal.dot(half);
        let squared = self.alpha * self.alpha;
        let height = normal.cross(half).length_squared() + along * along * squared;
        let facets = squared / (height * height);
        let masked = |cosine: f64| (cosine * cosine * (1.0 - squared) + squared).sqrt();
        let visible = 0.5 / (facing * masked(cosine) + cosine * masked(facing));
        let fresnel = self.straight
            + (DVec3::splat(self.grazing) - self.straight)
                * fifth(1.0 - view.dot(half).clamp(0.0, 1.0));
        fresnel * (facets * visible)
    }

    /// π times the BRDF of several reflections, and of what enters and leaves again.
    fn rest(&self, seen: &Albedo, met: &Albedo) -> DVec3 {
        let repeated = self.again * (seen.lost * met.lost / self.lost_mean.max(1e-4));
        let left = (1.0 - self.all_mean).max(DVec3::splat(1e-3));
        repeated + self.diffuse * (1.0 - seen.all) * (1.0 - met.all) / left
    }
}

fn fifth(x: f64) -> f64 {
    let squared = x * x;
    squared * squared * x
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;

    use super::{super::hooks::environment::Surroundings, *};

    /// Stratified points of the unit square.
    fn square(side: u32) -> impl Iterator<Item = DVec2> {
        let middle = move |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        (0..side * side).map(move |i| DVec2::new(middle(i / side), middle(i % side)))
    }

    /// A direction about +z at an angle with this cosine, this part of a turn around.
    fn around(cosine: f64, turn: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(TAU * turn);
        let aside = (1.0 - cosine * cosine).max(0.0).sqrt();
        DVec3::new(aside * cos, aside * sin, cosine)
    }

    /// What a surface shows in a room that shines with 1 from all sides, lit as by suns.
    fn furnace(reflector: &Reflector, cosine: f64) -> f64 {
        const SIDE: u32 = 192;
        let view = around(cosine, 0.0);
        let seen = reflector.albedo(cosine);
        let squared = reflector.alpha * reflector.alpha;
        let sum: f64 = square(SIDE)
            .map(|at| {
                // Microfacets as often as there are.
                let half = around(
                    ((1.0 - at.x) / (1.0 + (squared - 1.0) * at.x)).sqrt(),
                    at.y,
                );
                let toward = half * (2.0 * half.dot(view)) - view;
                let height = 1.0 - half.z * half.z * (1.0 - squared);
                let density = squared * half.z / (height * height);
                let facets = if toward.z > 0.0 && half.dot(view) > 0.0 {
                    let seen = reflector.facets(cosine, DVec3::Z, view, toward).x;
                    seen * toward.z * 4.0 * half.dot(view) / density
                } else {
                    0.0
                };
                facets + reflector.rest(&seen, &reflector.albedo(at.x.sqrt())).x
            })
            .sum();
        sum / f64::from(SIDE * SIDE)
    }

    #[test]
    fn what_is_white_stays_white_at_every_roughness_and_angle() {
        for roughness in [SMOOTHEST, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0] {
            for cosine in [0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0] {
                let alpha = roughness * roughness;
                for (kind, diffuse, straight) in
                    [("metal", 0.0, 1.0), ("glaze", 1.0, 0.04), ("both", 0.5, 0.52)]
                {
                    let reflector =
                        Reflector::new(DVec3::splat(diffuse), DVec3::splat(straight), 1.0, alpha);
                    let white = furnace(&reflector, cosine);
                    // What the fitted fractions err by.
                    let bright = 1.007;
                    let dark = if kind == "both" { 0.5 } else { 0.98 };
                    assert!(
                        (dark..bright).contains(&white),
                        "{kind}, roughness {roughness}, cosine {cosine}: {white}"
                    );
                }
            }
        }
    }

    /// Trowbridge and Reitz 1975 as in Walter and others 2007, equation 33; Heitz 2014, equations 72
    /// and 99; Schlick 1994: computed from angles, apart from this text.
    #[test]
    fn facets_reflect_as_their_authors_say() {
        for (alpha, straight, [view, toward, turned], expected) in [
            (0.25, 0.04, [40.0, 40.0, 180.0], 0.271_334_861),
            (0.25, 0.04, [70.0, 65.0, 150.0], 0.075_818_778_8),
            (0.6, 0.5, [20.0, 55.0, 40.0], 0.210_539_752),
            (0.04, 0.9, [80.0, 79.0, 180.0], 3_933.829_54),
        ] {
            let cosine = |deg: f64| libm::cos(deg.to_radians());
            let (view, toward) =
                (around(cosine(view), 0.0), around(cosine(toward), turned / 360.0));
            let reflector = Reflector::new(DVec3::ZERO, DVec3::splat(straight), 1.0, alpha);
            let seen = reflector.facets(view.z, DVec3::Z, view, toward).x;
            assert!((seen / expected - 1.0).abs() < 1e-8, "{seen}, and {expected} is right");
        }
    }

    #[test]
    fn light_goes_the_same_way_back() {
        let reflector = |alpha| {
            let (diffuse, straight) = (DVec3::new(0.5, 0.2, 0.1), DVec3::new(0.04, 0.2, 0.6));
            Reflector::new(diffuse, straight, 1.0, alpha)
        };
        for alpha in [0.0064, 0.1, 0.5, 1.0] {
            let reflector = reflector(alpha);
            let brdf = |view: DVec3, toward: DVec3| {
                let seen = reflector.albedo(view.z);
                reflector.sunlight(&seen, DVec3::Z, view, toward) / toward.z
            };
            for at in square(12) {
                let (a, b) = (around(0.02 + 0.97 * at.x, at.y), around(at.y, 3.0 * at.x));
                let (there, back) = (brdf(a, b), brdf(b, a));
                assert!((there - back).length() < 1e-9 * there.length().max(1.0), "{a} {b}");
            }
        }
    }

    const ENVIRONMENTS: [Environment; 4] = [
        Environment::Studio,
        Environment::Overcast,
        Environment::LowSun,
        Environment::Night,
    ];

    /// The mean of `value` over all directions.
    fn mean(value: impl Fn(DVec3) -> DVec3) -> DVec3 {
        const SIDE: u32 = 256;
        let sum: DVec3 = square(SIDE)
            .map(|at| value(around(2.0 * at.x - 1.0, at.y)))
            .sum();
        sum / f64::from(SIDE * SIDE)
    }

    #[test]
    fn light_on_a_matt_surface_is_that_of_the_environment_up_to_the_second_band() {
        for sky in ENVIRONMENTS.map(Surroundings::of) {
            for normal in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::new(-0.6, 0.64, 0.48)] {
                // Legendre polynomials, weighted as the clamped cosine does.
                let banded = mean(|d| {
                    let c = d.dot(normal);
                    sky.radiance(d, 0.0) * (1.0 + 2.0 * c + 1.25 * (1.5 * c * c - 0.5))
                });
                let exact = mean(|d| sky.radiance(d, 0.0) * (4.0 * d.dot(normal).max(0.0)));
                let given = sky.irradiance(normal);
                assert!((given - banded.max(DVec3::ZERO)).length() < 2e-3, "{given} for {banded}");
                assert!((given - exact).length() < 0.08 * (0.5 + exact.length()), "{given} for {exact}");
            }
        }
    }

    #[test]
    fn rough_mirrors_show_about_what_the_integral_over_microfacets_does() {
        for sky in ENVIRONMENTS.map(Surroundings::of) {
            let all = mean(|d| sky.radiance(d, 0.0));
            for roughness in [0.3f64, 0.6, 1.0] {
                let alpha = roughness * roughness;
                for direction in [DVec3::Y, DVec3::NEG_Y, DVec3::X, sky.lamps[0].toward] {
                    let (right, up) = direction.any_orthonormal_pair();
                    let lobes = square(128).map(|at| {
                        let tangent = alpha * alpha * at.x / (1.0 - at.x);
                        let half = around(1.0 / (1.0 + tangent).sqrt(), at.y);
                        let d = half * (2.0 * half.z) - DVec3::Z;
                        let weight = d.z.max(0.0);
                        (sky.radiance(right * d.x + up * d.y + direction * d.z, 0.0) * weight, weight)
                    });
                    let (light, weights) = lobes.fold((DVec3::ZERO, 0.0), |(light, sum), (l, w)| {
                        (light + l, sum + w)
                    });
                    let (given, exact) = (sky.radiance(direction, alpha), light / weights);
                    assert!(
                        (given - exact).length() < 0.2 * exact.length() + 0.35 * all.length(),
                        "roughness {roughness}, {direction}: {given} for {exact}"
                    );
                }
            }
            // However rough the mirror, no light is lost.
            let blurred = mean(|d| sky.radiance(d, 0.5));
            assert!((blurred - all).length() < 0.03 * all.length(), "{blurred} for {all}");
        }
    }

    #[test]
    fn a_material_that_lights_do_not_change_keeps_its_color() {
        let surface = Surface {
            glow: DVec3::splat(0.4),
            finish: crate::effects::hooks::Finish::from(&crate::scene::material::Material {
                unlit: true,
                ..Default::default()
            }),
            ..Surface::example(DVec3::splat(0.4), 0)
        };
        for material in [MaterialSource::Scene, MaterialSource::Own] {
            let params = Studio {
                material: material as u32,
                metallic: 1.0,
                ..Studio::default()
            };
            assert_eq!(Studio::apply(surface, &params).color, surface.color);
        }
    }
}
