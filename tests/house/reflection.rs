//! Promise: studio reflects light as the authors of its formulas say and loses none, and environments
//! shine as the integrals say that their formulas stand for. The text of the effect, in f64, is what
//! is asked. Needs no adapter.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rasterlab::{
    effects::{Effect, EnabledEffect, Surface, hooks::Finish},
    evaluator::{Program, Word},
    scene::material::Material,
};

use super::evaluator::common::{floats, link, program, to_floats, words_of_all};

/// Stratified points of the unit square.
fn square(side: u32) -> Vec<DVec2> {
    let middle = move |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let at = |i| DVec2::new(middle(i / side), middle(i % side));
    (0..side * side).map(at).collect()
}

/// A direction about +z at an angle with this cosine, this part of a turn around.
fn around(cosine: f64, turn: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * turn);
    let aside = (1.0 - cosine * cosine).max(0.0).sqrt();
    DVec3::new(aside * cos, aside * sin, cosine)
}

/// Functions of `shaders/effects/studio.wgsl` and of `shaders/lib/environment.wgsl`.
struct Text(String);

impl Text {
    fn of_studio() -> Self {
        Self(link("studio"))
    }

    fn function(&self, name: &str) -> Program {
        program(&self.0, name)
    }

    fn all(program: &Program, arguments: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let words: Vec<Vec<Word>> = arguments.iter().map(|all| floats(all)).collect();
        let results = words_of_all(program, &words);
        results.iter().map(|words| to_floats(words)).collect()
    }

    fn one(&self, name: &str, arguments: &[f64]) -> Vec<f64> {
        Self::all(&self.function(name), vec![arguments.to_vec()]).remove(0)
    }

    /// The scalars of a `StudioReflector`.
    fn reflector(&self, diffuse: DVec3, straight: DVec3, alpha: f64) -> Vec<f64> {
        let [diffuse, straight] = [diffuse, straight].map(|color| color.to_array());
        self.one(
            "studio_reflector",
            &[&diffuse[..], &straight, &[1.0, alpha]].concat(),
        )
    }
}

/// The same without a body and without what several facets reflect: one reflection alone.
fn of_one_facet(mut reflector: Vec<f64>) -> Vec<f64> {
    reflector[..3].fill(0.0);
    reflector[8..11].fill(0.0);
    reflector
}

/// The light that leaves towards `view` of light from `toward`, on a surface that faces +z.
fn from_sun(
    text: &Text,
    reflector: &[f64],
    ways: impl IntoIterator<Item = (DVec3, DVec3)>,
) -> Vec<DVec3> {
    let (albedo, from_sun) = (
        text.function("studio_albedo"),
        text.function("studio_from_sun"),
    );
    let ways: Vec<(DVec3, DVec3)> = ways.into_iter().collect();
    let cosine = |(view, _): &(DVec3, DVec3)| [reflector, &[view.z]].concat();
    let seen = Text::all(&albedo, ways.iter().map(cosine).collect());
    let arguments = ways.iter().zip(&seen).map(|((view, toward), seen)| {
        let vectors = [DVec3::Z, *view, *toward].map(|v| v.to_array());
        [reflector, seen, vectors.as_flattened()].concat()
    });
    let light = Text::all(&from_sun, arguments.collect());
    light.iter().map(|light| DVec3::from_slice(light)).collect()
}

/// What a surface shows in a room that shines with 1 from all sides, lit as by suns.
fn furnace(text: &Text, reflector: &[f64], alpha: f64, cosine: f64) -> f64 {
    let (view, points) = (around(cosine, 0.0), square(96));
    let squared = alpha * alpha;
    // Microfacets as often as there are, and directions by their cosine.
    let halves = points.iter().map(|at| {
        let along = ((1.0 - at.x) / (1.0 + (squared - 1.0) * at.x)).sqrt();
        around(along, at.y)
    });
    let halves: Vec<DVec3> = halves.collect();
    let mirrored = halves
        .iter()
        .map(|half| half * (2.0 * half.dot(view)) - view);
    let facets = of_one_facet(reflector.to_vec());
    let facets_seen = from_sun(text, &facets, mirrored.map(|toward| (view, toward)));
    let facet = |(half, seen): (&DVec3, DVec3)| {
        let height = 1.0 - half.z * half.z * (1.0 - squared);
        let density = squared * half.z / (height * height);
        seen.x * 4.0 * half.dot(view).max(0.0) / density
    };
    let once: f64 = halves.iter().zip(facets_seen).map(facet).sum();
    let ways: Vec<(DVec3, DVec3)> = points
        .iter()
        .map(|at| (view, around(at.x.sqrt(), at.y)))
        .collect();
    let [all, facets] = [reflector, &facets].map(|of| from_sun(text, of, ways.iter().copied()));
    let rest = ways.iter().zip(all.iter().zip(&facets));
    let rest: f64 = rest
        .map(|((_, toward), (all, facets))| (all.x - facets.x) / toward.z)
        .sum();
    (once + rest) / points.len() as f64
}

#[test]
fn what_is_white_stays_white_at_every_roughness_and_angle() {
    let text = Text::of_studio();
    for roughness in [0.08, 0.3, 0.6, 1.0f64] {
        for cosine in [0.1, 0.35, 1.0] {
            let alpha = roughness * roughness;
            for (kind, diffuse, straight) in [
                ("metal", 0.0, 1.0),
                ("glaze", 1.0, 0.04),
                ("both", 0.5, 0.52),
            ] {
                let reflector =
                    text.reflector(DVec3::splat(diffuse), DVec3::splat(straight), alpha);
                let white = furnace(&text, &reflector, alpha, cosine);
                // What the fitted fractions err by.
                let dark = if kind == "both" { 0.5 } else { 0.98 };
                assert!(
                    (dark..1.007).contains(&white),
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
    let text = Text::of_studio();
    for (alpha, straight, [view, toward, turned], expected) in [
        (0.25, 0.04, [40.0, 40.0, 180.0], 0.271_334_861),
        (0.25, 0.04, [70.0, 65.0, 150.0], 0.075_818_778_8),
        (0.6, 0.5, [20.0, 55.0, 40.0], 0.210_539_752),
        (0.04, 0.9, [80.0, 79.0, 180.0], 3_933.829_54),
    ] {
        let cosine = |deg: f64| libm::cos(deg.to_radians());
        let (view, toward) = (
            around(cosine(view), 0.0),
            around(cosine(toward), turned / 360.0),
        );
        let reflector = text.reflector(DVec3::ZERO, DVec3::splat(straight), alpha);
        let seen = from_sun(&text, &of_one_facet(reflector), [(view, toward)])[0].x / toward.z;
        assert!(
            (seen / expected - 1.0).abs() < 1e-8,
            "{seen}, and {expected} is right"
        );
    }
}

#[test]
fn light_goes_the_same_way_back() {
    let text = Text::of_studio();
    let (diffuse, straight) = (DVec3::new(0.5, 0.2, 0.1), DVec3::new(0.04, 0.2, 0.6));
    for alpha in [0.0064, 0.1, 0.5, 1.0] {
        let reflector = text.reflector(diffuse, straight, alpha);
        let ways: Vec<(DVec3, DVec3)> = square(12)
            .iter()
            .map(|at| (around(0.02 + 0.97 * at.x, at.y), around(at.y, 3.0 * at.x)))
            .collect();
        let there = from_sun(&text, &reflector, ways.iter().copied());
        let back = from_sun(&text, &reflector, ways.iter().map(|&(a, b)| (b, a)));
        for (((a, b), there), back) in ways.iter().zip(there).zip(back) {
            let (there, back) = (there / b.z, back / a.z);
            assert!(
                (there - back).length() < 1e-9 * there.length().max(1.0),
                "{a} {b}"
            );
        }
    }
}

/// An environment: the scalars of the struct, and what it shows.
struct Sky<'a> {
    text: &'a Text,
    scalars: Vec<f64>,
}

impl<'a> Sky<'a> {
    /// All that are formulas.
    fn all(text: &'a Text) -> Vec<Self> {
        let of = text.function("environment_of");
        let numbers: Vec<Vec<Word>> = (0..4).map(|number| vec![Word::from_u32(number)]).collect();
        let skies = words_of_all(&of, &numbers);
        let sky = |words: &Vec<Word>| Self {
            text,
            scalars: to_floats(words),
        };
        skies.iter().map(sky).collect()
    }

    fn radiance(&self, directions: &[DVec3], alpha: f64) -> Vec<DVec3> {
        let arguments = |d: &DVec3| [&self.scalars[..], &d.to_array(), &[alpha]].concat();
        let light = Text::all(
            &self.text.function("environment_radiance"),
            directions.iter().map(arguments).collect(),
        );
        light.iter().map(|light| DVec3::from_slice(light)).collect()
    }

    fn irradiance(&self, normal: DVec3) -> DVec3 {
        let arguments = [&self.scalars[..], &normal.to_array()].concat();
        DVec3::from_slice(&self.text.one("environment_irradiance", &arguments))
    }

    /// Where its first light is.
    fn first_light(&self) -> DVec3 {
        DVec3::from_slice(&self.scalars[9..])
    }
}

/// Directions all around, each for as much of the sphere.
fn all_around() -> Vec<DVec3> {
    let points = square(128);
    let toward = |at: &DVec2| around(2.0 * at.x - 1.0, at.y);
    points.iter().map(toward).collect()
}

/// The mean of lights, each times a weight.
fn mean(lights: &[DVec3], weights: impl Iterator<Item = f64>) -> DVec3 {
    let sum: DVec3 = lights.iter().zip(weights).map(|(light, w)| light * w).sum();
    sum / lights.len() as f64
}

#[test]
fn light_on_a_matt_surface_is_that_of_the_environment_up_to_the_second_band() {
    let (text, directions) = (Text::of_studio(), all_around());
    for sky in Sky::all(&text) {
        let seen = sky.radiance(&directions, 0.0);
        for normal in [
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::Z,
            DVec3::new(-0.6, 0.64, 0.48),
        ] {
            let cosines = || directions.iter().map(|d| d.dot(normal));
            // Legendre polynomials, weighted as the clamped cosine does.
            let band = |c: f64| 1.0 + 2.0 * c + 1.25 * (1.5 * c * c - 0.5);
            let banded = mean(&seen, cosines().map(band)).max(DVec3::ZERO);
            let exact = mean(&seen, cosines().map(|c| 4.0 * c.max(0.0)));
            let given = sky.irradiance(normal);
            assert!((given - banded).length() < 2e-3, "{given} for {banded}");
            assert!(
                (given - exact).length() < 0.08 * (0.5 + exact.length()),
                "{given} for {exact}"
            );
        }
    }
}

#[test]
fn rough_mirrors_show_about_what_the_integral_over_microfacets_does() {
    let (text, directions, points) = (Text::of_studio(), all_around(), square(128));
    let one = || std::iter::repeat(1.0);
    for sky in Sky::all(&text) {
        let all = mean(&sky.radiance(&directions, 0.0), one());
        for roughness in [0.3f64, 1.0] {
            let alpha = roughness * roughness;
            for direction in [DVec3::Y, DVec3::NEG_Y, DVec3::X, sky.first_light()] {
                let (right, up) = direction.any_orthonormal_pair();
                let lobes: Vec<DVec3> = points
                    .iter()
                    .map(|at| {
                        let tangent = alpha * alpha * at.x / (1.0 - at.x);
                        let half = around(1.0 / (1.0 + tangent).sqrt(), at.y);
                        half * (2.0 * half.z) - DVec3::Z
                    })
                    .collect();
                let turned = lobes
                    .iter()
                    .map(|d| right * d.x + up * d.y + direction * d.z);
                let seen = sky.radiance(&turned.collect::<Vec<_>>(), 0.0);
                let weights = || lobes.iter().map(|d| d.z.max(0.0));
                let light = mean(&seen, weights()) * lobes.len() as f64;
                let exact = light / weights().sum::<f64>();
                let given = sky.radiance(&[direction], alpha)[0];
                assert!(
                    (given - exact).length() < 0.2 * exact.length() + 0.35 * all.length(),
                    "roughness {roughness}, {direction}: {given} for {exact}"
                );
            }
        }
        // However rough the mirror, no light is lost.
        let blurred = mean(&sky.radiance(&directions, 0.5), one());
        assert!(
            (blurred - all).length() < 0.03 * all.length(),
            "{blurred} for {all}"
        );
    }
}

#[test]
fn a_material_that_lights_do_not_change_keeps_its_color() {
    let unlit = Material {
        unlit: true,
        ..Material::default()
    };
    let surface = Surface {
        glow: DVec3::splat(0.4),
        finish: Finish::from(&unlit),
        ..Surface::example(DVec3::splat(0.4), 0)
    };
    for material in [0.0, 1.0] {
        let mut studio = EnabledEffect::new(Effect::named("studio"));
        studio.set("material", &[material]).set("metallic", &[1.0]);
        let shade = studio.effect.hooks.surface.as_ref();
        let mut all = [surface];
        shade.expect("it is on the hook")(&mut all, &studio.words);
        assert_eq!(all[0].color, surface.color);
    }
}
