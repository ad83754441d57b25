//! Loops: how far one invocation may walk where a driver counts.
//!
//! Mesa's software rasterizer ends all loops of an invocation after 65,535 iterations together, without a word
//! (`LP_MAX_TGSI_LOOP_ITERATIONS` in its `lp_bld_limits.h`). Kernels that visit samples one after another therefore share them
//! out among more invocations where a sample has loops of its own.

use super::Caps;
use crate::{
    accuracy::AccuracyOptions,
    effects::{
        Stack,
        hooks::{Layers, Shape},
    },
};

/// Iterations that an invocation may make at its samples; the rest is for what comes before them.
pub const MOST: u32 = 64_000;

/// Most samples under the discs of a triangle, and rows of them: three of 64 px, the largest that `points` draws.
const DISCS: u32 = 3 * (66 * 66 + 66);

/// Most iterations that the effects of a sample and of a surface make: `stipple` four, `hatch` four.
const EFFECTS: u32 = 8;

/// Most iterations of all loops that a covered sample takes: in the walk itself, in a mask, in effects and, where every layer is
/// shaded, in the light's filter and on what clipping left.
pub fn of_a_sample(has_mask: bool, layers: Option<Layers>, options: &AccuracyOptions) -> u32 {
    // Two quotients, of two guesses and eight corrections each.
    let mask = if has_mask { 20 } else { 0 };
    let taps = options.shadow_taps.side();
    let shading = if matches!(layers, Some(Layers::Xray { .. })) { taps * (taps + 1) + 6 } else { 0 };
    1 + mask + EFFECTS + shading
}

/// Most iterations that a tile makes for a triangle on its list, where it asks each time whether a sample is drawn: then the
/// draw of the triangle is searched for, too.
pub fn of_an_entry(has_mask: bool, draws: usize, options: &AccuracyOptions) -> u32 {
    of_a_sample(has_mask, None, options) + if draws > 1 { 32 } else { 0 }
}

/// Most samples that one invocation walks on this adapter.
pub fn samples(caps: &Caps, loops: u32) -> u32 {
    if caps.software { MOST / loops } else { u32::MAX }
}

/// Among how many invocations the discs of one triangle are shared out.
pub fn invocations_per_triangle(caps: &Caps, stack: &Stack, loops: u32) -> u32 {
    if caps.software && stack.shape() == Shape::Points { (DISCS * loops).div_ceil(MOST) } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ShadowTaps;

    #[test]
    fn what_a_workgroup_walks_of_a_triangle_never_ends_early() {
        let options = AccuracyOptions { shadow_taps: ShadowTaps::TwentyFive, ..AccuracyOptions::default() };
        let loops = of_a_sample(true, Some(Layers::Xray { bits: 8 }), &options);
        // A lane of 64 visits up to 17 x 17 samples of a box of 128 px, row after row.
        assert!(17 * (17 * loops + 1) < MOST, "{loops} loops a sample");
        assert!(DISCS * loops < MOST * 66, "a row of a disc is the least share");
    }
}
