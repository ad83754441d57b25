//! Promise: the flow has no sources, births fill their room evenly, and a disc is the ellipse that
//! its definition says: the oracle alone.

use super::*;

#[test]
fn the_flow_has_no_sources_and_no_sinks() {
    let mut rng = Rng(3);
    for octaves in 1..=6 {
        let p = Particles {
            octaves,
            persistence: 0.8,
            ..Particles::default()
        };
        let (mut largest, mut steepest) = (0.0f64, 0.0f64);
        for _ in 0..300 {
            let place = DVec3::from_array([0, 1, 2].map(|_| rng.real(-3.0, 3.0)));
            let h = 1e-5;
            let slope = |axis: usize| {
                (particles_flow(&p, place + DVec3::AXES[axis] * h)
                    - particles_flow(&p, place - DVec3::AXES[axis] * h))
                    / (2.0 * h)
            };
            let slopes = [slope(0), slope(1), slope(2)];
            largest = largest.max((slopes[0].x + slopes[1].y + slopes[2].z).abs());
            steepest = slopes
                .iter()
                .fold(steepest, |most, slope| most.max(slope.abs().max_element()));
        }
        assert!(
            steepest > 0.3 && largest < 1e-4 * steepest,
            "{octaves} octaves: divergence {largest} where slopes reach {steepest}"
        );
    }
}

fn particles_flow(p: &Particles, place: DVec3) -> DVec3 {
    oracle::particles::flow(p, place, 20)
}

#[test]
fn the_flow_is_about_as_fast_as_it_says_and_nowhere_jumps() {
    let p = Particles {
        octaves: 1,
        speed_mps: 2.0,
        swirl_m: 0.7,
        ..Particles::default()
    };
    let mut rng = Rng(4);
    let speeds: Vec<f64> = (0..4000)
        .map(|_| {
            particles_flow(
                &p,
                DVec3::from_array([0, 1, 2].map(|_| rng.real(-9.0, 9.0))),
            )
            .length()
        })
        .collect();
    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
    assert!((mean / 2.0 - 1.0).abs() < 0.15, "{mean} m/s");
    // Along a line through many cells of the lattice.
    let along = |i: i32| {
        particles_flow(
            &p,
            DVec3::new(0.31, -0.2, 0.05) + DVec3::new(1.0, 0.61, 0.37) * (f64::from(i) * 1e-4),
        )
    };
    let jump = (0..30_000)
        .map(|i| along(i).distance(along(i + 1)))
        .fold(0.0, f64::max);
    assert!(
        jump < 0.02,
        "{jump} m/s between neighbors a tenth of a millimeter apart"
    );
}

#[test]
fn births_fill_the_ellipsoid_evenly_and_lives_begin_at_every_age() {
    let spread = [0.5, 1.0, 2.0];
    let preset = preset_file(&[
        ("count", &[20_000.0]),
        ("half_axes", &spread),
        ("center", &[1.0, 2.0, 3.0]),
    ]);
    let p: Particles = preset.stack.params(&EFFECT.name).expect("particles");
    let particle_states: Vec<_> = (0..20_000)
        .map(|id| oracle::particles::first(&p, id))
        .collect();
    let shares: Vec<DVec3> = particle_states
        .iter()
        .map(|f| (f.position - DVec3::new(1.0, 2.0, 3.0)) / DVec3::from_array(spread))
        .collect();
    assert!(shares.iter().all(|share| share.length() <= 1.0));
    // A ball of half the radius has an eighth of the volume; one of 0.8, 0.512 of it. The last
    // attempt, halved, adds 1 %.
    for (radius, volume) in [(0.5, 0.125), (0.8, 0.512)] {
        let within = shares
            .iter()
            .filter(|share| share.length() <= radius)
            .count() as f64
            / 20_000.0;
        assert!(
            (within - volume).abs() < 0.025,
            "{within} of them within {radius}, where {volume} should be"
        );
    }
    for axis in 0..3 {
        let mean = shares.iter().map(|share| share[axis]).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.02, "axis {axis} leans by {mean}");
    }
    let [longest, chance] = particles::life_steps(&p);
    assert!(
        particle_states
            .iter()
            .all(|f| f.age < longest && f.births == 0 && f.velocity == DVec3::ZERO)
    );
    let young = particle_states
        .iter()
        .filter(|f| f.age * 2 < longest - chance / 2)
        .count();
    assert!(
        (8_000..14_000).contains(&young),
        "{young} of 20000 are in the first half of their life"
    );
}

/// The samples of one triangle that its disc has, in a picture of so many pixels.
fn disc(corners: [[i32; 2]; 3], view: &View) -> Vec<u32> {
    let corners = corners.map(|[x, y]| SnappedVertex {
        x,
        y,
        depth: 0.5,
        inv_w: 1.0,
        flags: 0,
    });
    let geometry = Geometry {
        particle_discs: 0..1,
        ..Geometry::default()
    };
    let stack = stack(&[]);
    oracle::cover_with(
        &SampleTests::of_effects(&stack, &geometry),
        &[OrientedTriangle::clockwise(0, corners)],
        view,
    )
    .expect("nobody cancels it")
    .layers()
}

#[test]
fn a_disc_is_the_ellipse_that_touches_the_sides_in_their_middles() {
    let view = pixel_view(128, 128);
    // Clockwise, upright: radius 40 px about (64, 64), and one that is squeezed and leans.
    let upright = |r: f64, at: [f64; 2]| {
        let unit = |v: f64| (v * 256.0).round() as i32;
        let s = 3f64.sqrt() * r;
        [
            [unit(at[0]), unit(at[1] - 2.0 * r)],
            [unit(at[0] + s), unit(at[1] + r)],
            [unit(at[0] - s), unit(at[1] + r)],
        ]
    };
    for radius in [0.4, 1.0, 2.5, 7.3, 40.0] {
        let layers = disc(upright(radius, [64.2, 63.7]), &view);
        let wrong = layers.iter().enumerate().filter(|(i, layers)| {
            let (x, y) = ((i % 128) as f64 + 0.5 - 64.2, (i / 128) as f64 + 0.5 - 63.7);
            let distance = x.hypot(y) - radius;
            // Corners are snapped to 1/256 px: so near the rim either is right.
            distance.abs() > 0.01 && (distance < 0.0) != (**layers == 1)
        });
        assert_eq!(wrong.count(), 0, "radius {radius}");
        assert!(radius < 1.0 || layers.contains(&1));
    }
    // Corners in any order make the same disc, and half a triangle's fraction of the area is pi /
    // (3 sqrt 3).
    let [a, b, c] = [[1000, 900], [31_000, 5_000], [9_000, 30_000]];
    let count = |corners| disc(corners, &view).iter().sum::<u32>();
    let (one, two) = (disc([a, b, c], &view), disc([b, c, a], &view));
    assert_eq!(one, two);
    let area = f64::from((b[0] - a[0]) as i64 as i32) * f64::from(c[1] - a[1])
        - f64::from(b[1] - a[1]) * f64::from(c[0] - a[0]);
    let share = f64::from(count([a, b, c])) / (area / 2.0 / 65536.0);
    assert!((share - 0.6046).abs() < 0.005, "{share} of the triangle");
}
