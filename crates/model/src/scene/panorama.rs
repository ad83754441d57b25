//! Panoramas: a picture of what surrounds a scene, prepared once so that kernels and oracle read the
//! same words.
//!
//! A matt surface is lit by a quadratic form of its normal: the spherical harmonics of the picture
//! up to the second band (Ramamoorthi and Hanrahan 2001). Mirrors see one of several levels, each
//! blurred as microfacets of one roughness do (GGX, about the normal). A level is a square onto which
//! the octahedron of all directions is unfolded, upper half inside (Engelhardt and Dachsbacher
//! 2008); its texels share an exponent as those of RGB9E5.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::radiance::{BRIGHTEST, LightPicture};
use crate::work::{Canceled, map_each};

/// Words of the quadratic form: three floats for each of 1, x, y, z, x², y², z², xy, yz and zx.
const FORM_WORDS: usize = 30;
/// The number of levels. Their perceptual roughness rises evenly from 0 to 1.
const LEVELS: usize = 7;
/// Texels along a side of the first level, and least of the others, each half of the one before.
const SIDE: usize = 512;
const LEAST_SIDE: usize = 32;

/// Texels along a side of a level.
const fn side(level: usize) -> usize {
    let side = SIDE >> level;
    if side > LEAST_SIDE { side } else { LEAST_SIDE }
}

/// The first word of a level.
fn first(level: usize) -> usize {
    FORM_WORDS
        + (0..level)
            .map(|level| side(level) * side(level))
            .sum::<usize>()
}

/// What surrounds a scene, as a picture.
#[derive(Clone, PartialEq, Eq)]
pub struct Panorama {
    words: Vec<u32>,
}

impl Panorama {
    /// Prepares a picture.
    pub fn of(picture: &LightPicture) -> Result<Self, Canceled> {
        let sharp = Square::of(picture)?;
        let mut words: Vec<u32> = form(picture)
            .into_iter()
            .flat_map(|light| light.to_array().map(|channel| (channel as f32).to_bits()))
            .collect();
        words.extend(sharp.light.iter().map(|light| word(*light)));
        let coarser = coarser(sharp);
        for level in 1..LEVELS {
            words.extend(blurred(&coarser, level)?.into_iter().map(word));
        }
        Ok(Self { words })
    }

    /// What kernels read: the quadratic form as f32, then every level row by row.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// Light that a white matt surface shows whose normal, a unit vector, is this.
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = normal;
        let terms = [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x];
        let light = |term: usize| {
            DVec3::from([0, 1, 2].map(|c| f64::from(f32::from_bits(self.words[3 * term + c]))))
        };
        let sum: DVec3 = terms
            .iter()
            .enumerate()
            .map(|(term, by)| light(term) * *by)
            .sum();
        sum.max(DVec3::ZERO)
    }

    /// What a mirror whose microfacets have this roughness shows in a direction, a unit vector; at
    /// 0, the picture itself. `moved` moves the place on the unfolded octahedron, whose side is 1.
    pub fn radiance(&self, d: DVec3, alpha: f64, moved: DVec2) -> DVec3 {
        let place = place_of(d) + moved;
        let level = alpha.clamp(0.0, 1.0).sqrt() * (LEVELS - 1) as f64;
        let lower = (level as usize).min(LEVELS - 2);
        let [fine, coarse] = [lower, lower + 1].map(|level| {
            let (first, side) = (first(level), side(level));
            between(side, place, |x, y| light(self.words[first + y * side + x]))
        });
        fine.lerp(coarse, level - lower as f64)
    }
}

impl std::fmt::Debug for Panorama {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a panorama of {} words", self.words.len())
    }
}

/// A value between the middles of four texels of a square of so many texels along a side. A texel
/// beyond an edge is the one that the edge is folded onto.
fn between(side: usize, place: DVec2, texel: impl Fn(usize, usize) -> DVec3) -> DVec3 {
    let at = place * side as f64 - 0.5;
    let near = at.floor();
    let part = at - near;
    let texel = |x: i64, y: i64| {
        let [x, y] = fold_place(side as i64, x, y);
        texel(x, y)
    };
    let (x, y) = (near.x as i64, near.y as i64);
    let [upper, lower] = [y, y + 1].map(|y| texel(x, y).lerp(texel(x + 1, y), part.x));
    upper.lerp(lower, part.y)
}

/// The texel that lies at a place at most one texel beyond an edge.
fn fold_place(side: i64, mut x: i64, mut y: i64) -> [usize; 2] {
    let back = |at: i64| (-1 - at).max(at.min(2 * side - 1 - at)).clamp(0, side - 1);
    if x < 0 || x >= side {
        (x, y) = (back(x), side - 1 - y);
    }
    if y < 0 || y >= side {
        (x, y) = (side - 1 - x, back(y));
    }
    [x, y].map(|at| at.clamp(0, side - 1) as usize)
}

/// Where a direction lies on the unfolded octahedron, from 0 to 1.
fn place_of(d: DVec3) -> DVec2 {
    let sum = d.x.abs() + d.y.abs() + d.z.abs();
    let p = DVec2::new(d.x, d.z) / sum;
    let outside = || {
        let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
        DVec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
    };
    (if d.y < 0.0 { outside() } else { p }) * 0.5 + 0.5
}

/// The point of the octahedron that lies at a place.
fn point_at(place: DVec2) -> DVec3 {
    let p = place * 2.0 - 1.0;
    let height = 1.0 - p.x.abs() - p.y.abs();
    let fold = (-height).max(0.0);
    let folded = |v: f64| if v < 0.0 { v + fold } else { v - fold };
    DVec3::new(folded(p.x), height, folded(p.y))
}

/// The middle of the texel of this index, on the octahedron.
fn middle(side: usize, index: usize) -> DVec3 {
    let at = DVec2::new((index % side) as f64, (index / side) as f64);
    point_at((at + 0.5) / side as f64)
}

/// How much of all directions a place takes, relative to others.
fn share(point: DVec3) -> f64 {
    1.0 / (point.length_squared() * point.length())
}

/// A square of light with the share of every texel.
struct Square {
    side: usize,
    light: Vec<DVec3>,
    shares: Vec<f64>,
}

impl Square {
    /// The picture, at four places of every texel.
    fn of(picture: &LightPicture) -> Result<Self, Canceled> {
        let seen = |index: usize| {
            let at = DVec2::new((index % SIDE) as f64, (index / SIDE) as f64);
            let places = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
            let seen = places.map(|place| {
                picture_at(picture, point_at((at + DVec2::from(place)) / SIDE as f64))
            });
            seen.iter().sum::<DVec3>() / 4.0
        };
        Ok(Self {
            side: SIDE,
            light: map_each((0..SIDE * SIDE).into_par_iter(), seen)?,
            shares: (0..SIDE * SIDE)
                .map(|index| share(middle(SIDE, index)))
                .collect(),
        })
    }

    /// The same with half as many texels along a side.
    fn halved(&self) -> Self {
        let side = self.side / 2;
        let four = |index: usize| {
            let corner = 2 * (index / side) * self.side + 2 * (index % side);
            [
                corner,
                corner + 1,
                corner + self.side,
                corner + self.side + 1,
            ]
        };
        let shares: Vec<f64> = (0..side * side)
            .map(|index| four(index).iter().map(|&at| self.shares[at]).sum())
            .collect();
        let light = (0..side * side).map(|index| {
            let sum: DVec3 = four(index)
                .iter()
                .map(|&at| self.light[at] * self.shares[at])
                .sum();
            sum / shares[index]
        });
        Self {
            side,
            light: light.collect(),
            shares,
        }
    }

    fn at(&self, d: DVec3) -> DVec3 {
        between(self.side, place_of(d), |x, y| self.light[y * self.side + x])
    }
}

/// A square and coarser ones, each with half as many texels along a side.
fn coarser(sharp: Square) -> Vec<Square> {
    let mut squares = vec![sharp];
    while squares[squares.len() - 1].side > 8 {
        squares.push(squares[squares.len() - 1].halved());
    }
    squares
}

/// A level of a mirror of microfacets.
fn blurred(squares: &[Square], level: usize) -> Result<Vec<DVec3>, Canceled> {
    let roughness = level as f64 / (LEVELS - 1) as f64;
    let lobe = lobe(roughness * roughness, 48 * level.min(4), squares.len());
    let weights: f64 = lobe.iter().map(|sample| sample.toward.z).sum();
    let side = side(level);
    let seen = |index: usize| {
        let normal = middle(side, index).normalize();
        let (right, ahead) = normal.any_orthonormal_pair();
        let sum: DVec3 = lobe
            .iter()
            .map(|Sample { toward, square }| {
                let d = right * toward.x + ahead * toward.y + normal * toward.z;
                squares[*square].at(d) * toward.z
            })
            .sum();
        sum / weights
    };
    map_each((0..side * side).into_par_iter(), seen)
}

/// A direction that a mirror about +z reflects to an eye on that axis, and the square whose texels
/// are about as large as the part of the lobe that the direction stands for.
struct Sample {
    toward: DVec3,
    square: usize,
}

/// Directions as often as microfacets of this roughness reflect them.
fn lobe(alpha: f64, count: usize, squares: usize) -> Vec<Sample> {
    let squared = alpha * alpha;
    let texel = 4.0 * PI / (SIDE * SIDE) as f64;
    let sample = |index: usize| {
        // Points that fill the unit square evenly, by multiples of powers of the plastic number.
        let at = [0.754_877_666_246_693, 0.569_840_290_998_053_2]
            .map(|step: f64| (0.5 + step * index as f64).fract());
        let upward = ((1.0 - at[0]) / (1.0 + (squared - 1.0) * at[0])).sqrt();
        let (sin, cos) = libm::sincos(TAU * at[1]);
        let aside = (1.0 - upward * upward).max(0.0).sqrt();
        let half = DVec3::new(aside * cos, aside * sin, upward);
        let toward = half * (2.0 * half.z) - DVec3::Z;
        let height = upward * upward * (squared - 1.0) + 1.0;
        let density = squared / (PI * height * height) / 4.0;
        let texels = 1.0 / (count as f64 * density) / texel;
        let square = (0.5 * libm::log2(texels)).round().max(0.0) as usize;
        Sample {
            toward,
            square: square.min(squares - 1),
        }
    };
    (0..count)
        .map(sample)
        .filter(|sample| sample.toward.z > 0.0)
        .collect()
}

/// The light of a picture in a direction of any length but 0.
fn picture_at(picture: &LightPicture, d: DVec3) -> DVec3 {
    let [width, height] = picture.size;
    let across = libm::atan2(d.x, -d.z) / TAU + 0.5;
    let down = libm::acos((d.y / d.length()).clamp(-1.0, 1.0)) / PI;
    let at = DVec2::new(across * width as f64, down * height as f64) - 0.5;
    let near = at.floor();
    let part = at - near;
    let pixel = |x: f64, y: f64| {
        let x = (x as i64).rem_euclid(width as i64) as usize;
        let y = (y.max(0.0) as usize).min(height - 1);
        picture.light[y * width + x]
    };
    let row = |y: f64| pixel(near.x, y).lerp(pixel(near.x + 1.0, y), part.x);
    row(near.y).lerp(row(near.y + 1.0), part.y)
}

/// Sides with fewer pixels do not tell the second band from the first.
const NARROW: usize = 16;

/// A picture with pixels enough to add up directions: the same, but between the pixels of a narrow
/// one.
fn widened(picture: &LightPicture) -> Option<LightPicture> {
    let [width, height] = picture.size.map(|side| match side {
        ..NARROW => side * (16 * NARROW).div_ceil(side),
        wide => wide,
    });
    let light = |i: usize| {
        let [x, y] = [i % width, i / width].map(|at| at as f64 + 0.5);
        let (right, ahead) = libm::sincos(TAU * (x / width as f64 - 0.5));
        let (sin, cos) = libm::sincos(PI * y / height as f64);
        picture_at(picture, DVec3::new(sin * right, cos, -sin * ahead))
    };
    ([width, height] != picture.size).then(|| LightPicture {
        size: [width, height],
        light: (0..width * height).map(light).collect(),
        clamped: 0,
    })
}

/// The quadratic form of a normal that gives the light on a matt surface: the mean over all
/// directions of their light, weighted as the clamped cosine is up to the second band.
fn form(picture: &LightPicture) -> [DVec3; 10] {
    let wide = widened(picture);
    let picture = wide.as_ref().unwrap_or(picture);
    let [width, height] = picture.size;
    let columns: Vec<(f64, f64)> = (0..width)
        .map(|x| libm::sincos(TAU * ((x as f64 + 0.5) / width as f64 - 0.5)))
        .collect();
    let (mut sums, mut weights) = ([DVec3::ZERO; 10], 0.0);
    for (y, row) in picture.light.chunks(width).enumerate() {
        let (sin, cos) = libm::sincos(PI * (y as f64 + 0.5) / height as f64);
        for (light, (right, ahead)) in row.iter().zip(&columns) {
            let DVec3 { x, y, z } = DVec3::new(sin * right, cos, -sin * ahead);
            // With the cosine c to the normal: 1 + 2 c + 1.25 (1.5 c² − 0.5).
            let linear = [0.375, 2.0 * x, 2.0 * y, 2.0 * z];
            let squares = [x * x, y * y, z * z].map(|square| 1.875 * square);
            let products = [x * y, y * z, z * x].map(|product| 3.75 * product);
            let terms = linear.into_iter().chain(squares).chain(products);
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += *light * (term * sin);
            }
            weights += sin;
        }
    }
    sums.map(|sum| sum / weights)
}

/// Light as a word: 9 bits for each channel, the lowest for red, and 5 for their exponent.
fn word(light: DVec3) -> u32 {
    let light = light.clamp(DVec3::ZERO, DVec3::splat(BRIGHTEST));
    let (_, exponent) = libm::frexp(light.max_element().max(1e-9));
    let exponent = (exponent + 15).max(0);
    let scaled = |exponent: i32| (light * power_of_two(24 - exponent)).round();
    let exponent = exponent + i32::from(scaled(exponent).max_element() > 511.0);
    let [red, green, blue] = scaled(exponent).to_array().map(|channel| channel as u32);
    red | green << 9 | blue << 18 | (exponent as u32) << 27
}

/// The light of a word.
fn light(word: u32) -> DVec3 {
    let channel = |shift: u32| f64::from(word >> shift & 511);
    DVec3::new(channel(0), channel(9), channel(18)) * power_of_two((word >> 27) as i32 - 24)
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bright window above a floor.
    fn picture() -> LightPicture {
        let size = [64, 32];
        let light = |i: usize| match [i % 64, i / 64] {
            [20..28, 6..12] => DVec3::new(12.0, 11.0, 9.0),
            [_, y] if y > 16 => DVec3::new(0.2, 0.15, 0.1),
            _ => DVec3::splat(0.4),
        };
        LightPicture {
            size,
            light: (0..size[0] * size[1]).map(light).collect(),
            clamped: 0,
        }
    }

    /// Directions that are spread evenly.
    fn directions(count: usize) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (sin, cos) = libm::sincos(2.399_963_229_728_653 * i as f64);
            let aside = (1.0 - y * y).sqrt();
            DVec3::new(aside * cos, y, aside * sin)
        })
    }

    #[test]
    fn a_place_leads_back_to_its_direction_and_edges_are_folded_onto_each_other() {
        for d in directions(500) {
            assert!(
                (point_at(place_of(d)).normalize() - d).length() < 1e-12,
                "{d}"
            );
        }
        for along in 0..8i64 {
            for [[x, y], [to_x, to_y]] in [
                [[-1, along], [0, 7 - along]],
                [[8, along], [7, 7 - along]],
                [[along, -1], [7 - along, 0]],
                [[along, 8], [7 - along, 7]],
            ] {
                assert_eq!(fold_place(8, x, y), [to_x as usize, to_y as usize]);
            }
        }
    }

    #[test]
    fn a_word_holds_light_within_half_of_its_last_bit() {
        for light_in in [
            DVec3::ZERO,
            DVec3::splat(BRIGHTEST),
            DVec3::new(1.0, 0.3, 1e-6),
            DVec3::new(511.9, 2.0, 3.0),
            DVec3::new(1e-5, 2e-5, 0.0),
        ] {
            let most = light_in.max_element().max(1e-4);
            let error = (light(word(light_in)) - light_in).abs().max_element();
            assert!(
                error <= most / 511.0,
                "{} for {light_in}",
                light(word(light_in))
            );
        }
        assert_eq!(light(word(DVec3::splat(1e9))), DVec3::splat(BRIGHTEST));
    }

    #[test]
    fn a_narrow_picture_lights_as_a_wide_one_of_the_same_light() {
        let of_rows = |size: [usize; 2]| {
            let light = |i: usize| DVec3::splat(1.0 + (i / size[0]) as f64 / size[1] as f64);
            Panorama::of(&LightPicture {
                size,
                light: (0..size[0] * size[1]).map(light).collect(),
                clamped: 0,
            })
            .expect("nobody cancels it")
        };
        let near = |a: &Panorama, b: &Panorama, normal| {
            let error = (a.irradiance(normal) - b.irradiance(normal)).length();
            assert!(error < 1e-3, "{normal}: {error}");
        };
        let wide = of_rows([64, 64]);
        let even = of_rows([1, 1]);
        for normal in directions(12) {
            for width in 1..=3 {
                near(&of_rows([width, 64]), &wide, normal);
            }
            assert!((even.irradiance(normal) - 1.0).length() < 1e-3, "{normal}");
        }
    }

    #[test]
    fn matt_and_rough_surfaces_show_about_what_the_integrals_over_the_picture_do() {
        let picture = picture();
        let panorama = Panorama::of(&picture).expect("nobody cancels it");
        let mean = |weight: &dyn Fn(DVec3) -> f64| {
            let (sum, weights) = directions(20_000).fold((DVec3::ZERO, 0.0), |(sum, all), d| {
                (sum + picture_at(&picture, d) * weight(d), all + weight(d))
            });
            sum / weights
        };
        let all = mean(&|_| 1.0);
        for normal in directions(12) {
            let exact = mean(&|d| d.dot(normal).max(0.0));
            let given = panorama.irradiance(normal);
            assert!(
                (given - exact).length() < 0.06 * (all + exact).length(),
                "{given} for {exact}"
            );
            for roughness in [1.0 / 3.0, 0.6, 1.0] {
                let alpha: f64 = roughness * roughness;
                let exact = mean(&|d| {
                    let half = (d + normal).normalize_or(normal);
                    let height = half.dot(normal).powi(2) * (alpha * alpha - 1.0) + 1.0;
                    d.dot(normal).max(0.0) / (height * height)
                });
                let given = panorama.radiance(normal, alpha, DVec2::ZERO);
                let error = (given - exact).length();
                assert!(
                    error < 0.08 * (exact + all).length(),
                    "roughness {roughness}: {given} for {exact}"
                );
            }
        }
        // However rough the mirror, light is neither lost nor won.
        for alpha in [0.0, 0.1, 0.5, 1.0] {
            let seen: DVec3 = directions(4000)
                .map(|d| panorama.radiance(d, alpha, DVec2::ZERO) / 4000.0)
                .sum();
            assert!(
                (seen - all).length() < 0.03 * all.length(),
                "{seen} for {all}"
            );
        }
    }
}
