//! Packing: positions in fewer bits, evenly spaced in the box of each primitive. Read by
//! `shaders/lib/attributes.wgsl`.

use rayon::prelude::*;

use crate::scene::{Scene, draw::MAX_MAGNITUDE};

/// Packed positions of a scene, and where those of each primitive lie.
#[derive(Default)]
pub struct Packing {
    pub words: Vec<u32>,
    pub boxes: Vec<PackedBox>,
}

/// One primitive's box, and its first word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedBox {
    pub first_word: u32,
    pub origin: [f32; 3],
    pub step: [f32; 3],
}

/// Why a position was refused, above its lanes.
const NONFINITE: u32 = 1;
const OUT_OF_RANGE: u32 = 2;

/// Words of a vertex.
pub const fn words_of(bits: u32) -> u32 {
    if 3 * bits + 2 <= 32 { 1 } else { 2 }
}

/// Bytes that a scene's packed positions take.
pub fn bytes_of(scene: &Scene, bits: u32) -> u64 {
    scene
        .primitives
        .iter()
        .map(|primitive| 4 * u64::from(words_of(bits)) * u64::from(primitive.vertex_count()))
        .sum()
}

impl Packing {
    /// Every position of the scene in so many bits an axis, 10 or 16.
    pub fn new(scene: &Scene, bits: u32) -> Self {
        let mut packing = Self::default();
        for primitive in &scene.primitives {
            let bounds = primitive.drawable_box(scene);
            let most = f64::from((1u32 << bits) - 1);
            let extent = if bounds.is_empty() {
                glam::DVec3::ZERO
            } else {
                bounds.max - bounds.min
            };
            let origin = if bounds.is_empty() {
                [0.0; 3]
            } else {
                bounds.min.as_vec3().to_array()
            };
            let step = (extent / most).as_vec3().to_array();
            packing.boxes.push(PackedBox {
                first_word: packing.words.len() as u32,
                origin,
                step,
            });
            // Rounded to what the shader will have, so that the nearest step is the nearest place.
            let lane = |value: f32, axis: usize| {
                let step = f64::from(step[axis]);
                let steps = if step > 0.0 {
                    (f64::from(value) - f64::from(origin[axis])) / step
                } else {
                    0.0
                };
                steps.round_ties_even().clamp(0.0, most) as u32
            };
            let packed = |vertex: u32| {
                let place = primitive.position(scene, vertex);
                let refusal = refusal(place);
                let [x, y, z] = if refusal == 0 {
                    [0, 1, 2].map(|axis| lane(place[axis], axis))
                } else {
                    [0; 3]
                };
                if bits == 10 {
                    [x | y << 10 | z << 20 | refusal << 30, 0]
                } else {
                    [x | y << 16, z | refusal << 16]
                }
            };
            let words = words_of(bits) as usize;
            let of_primitive: Vec<[u32; 2]> = (0..primitive.vertex_count())
                .into_par_iter()
                .map(packed)
                .collect();
            packing
                .words
                .extend(of_primitive.iter().flat_map(|packed| &packed[..words]));
        }
        packing
    }
}

fn refusal(place: [f32; 3]) -> u32 {
    match () {
        () if place.iter().any(|v| !v.is_finite()) => NONFINITE,
        () if place.iter().any(|v| f64::from(v.abs()) >= MAX_MAGNITUDE) => OUT_OF_RANGE,
        () => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn no_lane_is_further_from_its_place_than_half_a_step() {
        for query in ["teapot?tess=3", "cube-wall", "knot?tess=2"] {
            let scene = builtin::build(query).expect("a builtin");
            for bits in [10, 16] {
                let packing = Packing::new(&scene, bits);
                assert_eq!(4 * packing.words.len() as u64, bytes_of(&scene, bits));
                for (primitive, packed) in scene.primitives.iter().zip(&packing.boxes) {
                    for vertex in 0..primitive.vertex_count() {
                        let words = &packing.words
                            [(packed.first_word + words_of(bits) * vertex) as usize..];
                        let steps = match bits {
                            10 => [words[0] & 1023, words[0] >> 10 & 1023, words[0] >> 20],
                            _ => [words[0] & 0xffff, words[0] >> 16, words[1]],
                        };
                        let place = primitive.position(&scene, vertex);
                        for axis in 0..3 {
                            let [origin, step] =
                                [packed.origin[axis], packed.step[axis]].map(f64::from);
                            let off = (origin + step * f64::from(steps[axis])
                                - f64::from(place[axis]))
                            .abs();
                            // The step itself is rounded to a float.
                            assert!(
                                off <= 0.5 * step + 1e-6 * (step * 65_535.0).max(origin.abs()),
                                "{query}, {bits} bits: {off} of {step}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_refused_stays_refused() {
        assert_eq!(
            [
                [0.0; 3],
                [f32::NAN, 0.0, 0.0],
                [0.0, f32::MAX, 0.0],
                [f32::MAX, 0.0, f32::INFINITY]
            ]
            .map(refusal),
            [0, 1, 2, 1]
        );
    }
}
