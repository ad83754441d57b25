//! Loops: how many iterations one invocation may make where a driver limits them.
//!
//! Mesa's software rasterizer silently ends all loops of an invocation after 65,535 iterations
//! together (`LP_MAX_TGSI_LOOP_ITERATIONS` in its `lp_bld_limits.h`). Kernels that visit samples
//! one after another therefore divide them among more invocations where a sample has loops itself.

use super::caps::Caps;
use crate::{
    accuracy::AccuracyOptions,
    effects::hooks::{Layers, Shape},
};

/// Iterations that an invocation may make for its samples; the others are for what precedes them.
pub const MAX_ITERATIONS: u32 = 64_000;

/// Most layers of glass that one invocation of a CPU adapter sorts, a multiple of 8: it visits each
/// twice for every doubling of runs of 8, and three times more.
pub const DEEPEST_GLASS: u32 = 2048;

/// The same on a card, whose driver takes a kernel that works for seconds for one that hangs: each
/// visit may wait for memory.
pub const DEEPEST_GLASS_OF_CARDS: u32 = 1 << 15;

/// Most samples and rows under the discs of a triangle: three of 64 px, the largest that `points`
/// draws.
const DISC_SAMPLES: u32 = 3 * (66 * 66 + 66);

/// Most iterations that the effects of a sample and of a surface make: `stipple` four, `hatch`
/// four.
const EFFECT_ITERATIONS: u32 = 8;

/// Most iterations of all loops that a covered sample takes: in the walk itself, in a mask, in
/// effects and, where every layer is shaded, in the filter of the shadow map and over clipped
/// triangles.
pub fn of_a_sample(has_mask: bool, layers: Option<Layers>, options: &AccuracyOptions) -> u32 {
    // Two quotients, of two guesses and eight corrections each.
    let mask = if has_mask { 20 } else { 0 };
    let taps = options.shadow_taps.side();
    let shading = if matches!(layers, Some(Layers::Xray { .. } | Layers::Glass)) {
        taps * (taps + 1) + 6
    } else {
        0
    };
    1 + mask + EFFECT_ITERATIONS + shading
}

/// Most samples that one invocation walks on this adapter.
pub fn samples(caps: &Caps, loops: u32) -> u32 {
    if caps.software {
        MAX_ITERATIONS / loops
    } else {
        u32::MAX
    }
}

/// Rows of the largest disc.
const DISC_ROWS: u64 = 66;

/// Invocations over which a card divides the discs of few triangles. More of them spare it little
/// of its waiting, and those that find no row in a small disc cost a few microseconds
/// (docs/decisions/README.md, 013).
const DISC_INVOCATIONS: u64 = 1 << 18;

/// Among how many invocations the rows of the discs of each of `triangles` are divided: where they
/// are few, a card has more invocations than triangles, and a CPU adapter has so many that none
/// reaches the limit.
pub fn invocations_per_triangle(caps: &Caps, shape: Shape, triangles: u64, loops: u32) -> u32 {
    match (shape, caps.software) {
        (Shape::Points, true) => (DISC_SAMPLES * loops).div_ceil(MAX_ITERATIONS),
        (Shape::Points, false) => {
            1 << (DISC_INVOCATIONS / triangles.max(1))
                .clamp(1, DISC_ROWS)
                .ilog2()
        }
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ShadowTaps;

    #[test]
    fn few_triangles_are_divided_among_many_invocations_on_a_card() {
        let parts = |triangles| invocations_per_triangle(&Caps::ALL, Shape::Points, triangles, 9);
        assert_eq!(
            [0, 1, 12, 4096, 16_384, 200_000, 1 << 18, u64::MAX].map(parts),
            [64, 64, 64, 64, 16, 1, 1, 1]
        );
        assert_eq!(
            invocations_per_triangle(&Caps::ALL, Shape::Triangles, 12, 9),
            1
        );
    }

    #[test]
    fn no_walk_of_a_triangle_reaches_the_limit() {
        let options = AccuracyOptions {
            shadow_taps: ShadowTaps::TwentyFive,
            ..AccuracyOptions::default()
        };
        let loops = of_a_sample(true, Some(Layers::Xray { bits: 8 }), &options);
        // One invocation of 64 visits up to 17 x 17 samples of a box of 128 px, row after row.
        assert!(
            17 * (17 * loops + 1) < MAX_ITERATIONS,
            "{loops} loops a sample"
        );
        assert!(
            DISC_SAMPLES * loops < MAX_ITERATIONS * 66,
            "a row of a disc is the least that one invocation walks"
        );
    }
}
