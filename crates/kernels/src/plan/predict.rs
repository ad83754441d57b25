//! Predictions: how far an option will be off in a scene, before anything is drawn. Where there is
//! a bound it is the bound, else an estimate; measurements are compared with them, and a wrong
//! prediction is shown.

use crate::{
    accuracy::{
        AXES, AccuracyOptions, AxisOption, Clipping, Coverage, Culling, DepthFormat, Perspective,
        PositionFormat, RenderScale, Tolerance, Transparency, VertexTransform, Visibility,
        XraySums,
    },
    scene::needs::{Needs, outgrows},
};

/// Error of a picture against the oracle's, as predicted before it is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Prediction {
    /// Pixels with the wrong triangle, per million.
    pub wrong_ppm: f64,
    /// Difference of a color channel where the triangle is right, of 255.
    pub channel: f64,
}

impl Prediction {
    fn wrong(wrong_ppm: f64) -> Self {
        Self {
            wrong_ppm,
            channel: 0.0,
        }
    }

    /// Does it stay within a tolerance?
    pub fn is_within(&self, tolerance: &Tolerance) -> bool {
        self.wrong_ppm <= tolerance.wrong_ppm && self.channel <= tolerance.channel.into()
    }

    /// Both errors in one picture.
    pub fn and(self, other: Self) -> Self {
        Self {
            wrong_ppm: self.wrong_ppm + other.wrong_ppm,
            channel: self.channel + other.channel,
        }
    }
}

/// What an option adds to the error of a picture, given the indices of axis and option. Infinite
/// where nothing is known.
pub fn predict(axis: usize, option: usize, needs: &Needs) -> Prediction {
    debug_assert!(axis < AXES.len(), "an axis of the list");
    match axis {
        Coverage::AXIS => coverage(Coverage::from_index(option), needs),
        VertexTransform::AXIS => vertex(VertexTransform::from_index(option), needs),
        PositionFormat::AXIS => vertices(PositionFormat::from_index(option), needs),
        DepthFormat::AXIS => depth(DepthFormat::from_index(option), needs),
        Perspective::AXIS => perspective(Perspective::from_index(option), needs),
        Clipping::AXIS => clipping(Clipping::from_index(option), needs),
        RenderScale::AXIS => scale(RenderScale::from_index(option)),
        // What comes out from behind something is missing for one picture, and may be any number of
        // pixels.
        Culling::AXIS if Culling::from_index(option) == Culling::Hiz => {
            Prediction::wrong(f64::INFINITY)
        }
        XraySums::AXIS => sums(XraySums::from_index(option), needs),
        Transparency::AXIS => transparency(Transparency::from_index(option), needs),
        Visibility::AXIS => visibility(Visibility::from_index(option), needs),
        _ => Prediction::default(),
    }
}

/// The sum over all axes.
pub fn predict_all(options: &AccuracyOptions, needs: &Needs) -> Prediction {
    let each = AXES
        .iter()
        .enumerate()
        .map(|(i, axis)| predict(i, options.get(axis), needs));
    each.fold(Prediction::default(), Prediction::and)
}

/// Pixels that change their triangle when edges move by a fraction of a pixel, per million.
fn moved_ppm(shift_px: f64, needs: &Needs) -> f64 {
    1e6 * needs
        .sizes
        .changed_fraction(shift_px, needs.size.into_iter().map(f64::from).product())
}

fn coverage(option: Coverage, needs: &Needs) -> Prediction {
    // Products of two differences of 16.8 are exact in an f32 up to 16 px.
    const EXACT_PX: f64 = 16.0;
    match option {
        Coverage::Fixed8 => Prediction::default(),
        // Against 1/256 px: corners lie up to half a unit off either way, a quarter as a rule.
        Coverage::Fixed4 => Prediction::wrong(moved_ppm(0.25 / 16.0, needs)),
        Coverage::Fixed12 => Prediction::wrong(moved_ppm(0.25 / 256.0, needs)),
        // Rounding decides only within 2^-24 of the largest product; ties are what meets it.
        Coverage::FloatTopLeft if needs.largest_px <= EXACT_PX => Prediction::default(),
        Coverage::FloatTopLeft => Prediction::wrong(moved_ppm(1.0 / 2048.0, needs)),
        // A shared sample is drawn twice, and the later triangle may win: 1/256 of all samples lie
        // on an edge's lattice.
        Coverage::Float => Prediction::wrong(moved_ppm(1.0 / 256.0, needs)),
    }
}

fn vertex(option: VertexTransform, needs: &Needs) -> Prediction {
    match option {
        // 1.4 % of the corners lie one unit off at 1080p, where center-relative ones are at 0.65 %.
        VertexTransform::Viewport => Prediction::wrong(moved_ppm(0.014 / 256.0, needs)),
        _ => Prediction::default(),
    }
}

fn vertices(option: PositionFormat, needs: &Needs) -> Prediction {
    // Bounds of rounding add up every step the wrong way; as a rule it comes to an eighth of that.
    const USUAL: f64 = 1.0 / 8.0;
    let [stored, relative] = needs.rounding_px;
    match (option, option.packed_bits()) {
        // A quarter of a step is the mean distance to the nearest one; the box is as wide as it
        // looks from where it is nearest.
        (_, Some(bits)) => Prediction::wrong(moved_ppm(
            0.25 * needs.box_px / libm::exp2(bits.into()),
            needs,
        )),
        (PositionFormat::Stored, _) if outgrows(needs.rounding_px) => {
            Prediction::wrong(moved_ppm(USUAL * (stored - relative), needs))
        }
        _ => Prediction::default(),
    }
}

fn depth(option: DepthFormat, needs: &Needs) -> Prediction {
    let [nearest, farthest] = needs.depth_m;
    let span = (farthest - nearest).max(f64::MIN_POSITIVE);
    // Smallest distance that always gives another key, at the far end: surfaces nearer to each
    // other than that are confused, and in a scene as deep as its box, that fraction of the
    // pixels has another surface so close behind.
    let step_m = match option {
        DepthFormat::Ndc16 => needs.depth_unit_m(farthest) / 65_536.0,
        DepthFormat::Log16 => needs.doubling_span_m(farthest) / 2048.0,
        DepthFormat::Log24 => needs.doubling_span_m(farthest) / 524_288.0,
        DepthFormat::Standard => needs.depth_unit_m(farthest) / f64::from(1 << 24),
        _ => return Prediction::default(),
    };
    Prediction::wrong(1e6 * (step_m / span).min(1.0))
}

fn scale(option: RenderScale) -> Prediction {
    // Triangle ids are those of the pixels that are drawn. Where fewer are drawn than shown, an
    // edge may lie anywhere between two.
    Prediction {
        wrong_ppm: 0.0,
        channel: if option < RenderScale::Full {
            255.0
        } else {
            0.0
        },
    }
}

fn perspective(option: Perspective, needs: &Needs) -> Prediction {
    let ratio = needs.w_ratio;
    match option {
        Perspective::Exact => Prediction::default(),
        Perspective::Affine if !needs.perspective => Prediction::default(),
        // An attribute errs by at most (sqrt(ratio) - 1) / (sqrt(ratio) + 1) of its span within a
        // triangle.
        Perspective::Affine => Prediction {
            wrong_ppm: 0.0,
            channel: 255.0 * ((ratio.sqrt() - 1.0) / (ratio.sqrt() + 1.0)).min(1.0),
        },
    }
}

fn visibility(option: Visibility, needs: &Needs) -> Prediction {
    match option {
        // Of 28 bits of a depth below 1, five for the exponent, ids leave what remains of the word.
        Visibility::Packed32 => {
            let lost = (64 - (needs.triangles | 1).leading_zeros()).saturating_sub(4);
            let [nearest, farthest] = needs.depth_m;
            let step_m = needs.doubling_span_m(farthest) * libm::exp2(f64::from(lost) - 23.0);
            Prediction::wrong(1e6 * (step_m / (farthest - nearest).max(f64::MIN_POSITIVE)).min(1.0))
        }
        Visibility::Race => Prediction::wrong(f64::INFINITY),
        Visibility::Split32 | Visibility::Packed64 => Prediction::default(),
    }
}

fn sums(option: XraySums, needs: &Needs) -> Prediction {
    match option.capacity() {
        None => Prediction::default(),
        // More layers than triangles there are not.
        Some(capacity) if needs.triangles > capacity => Prediction {
            wrong_ppm: 0.0,
            channel: f64::INFINITY,
        },
        // Half a step of 8 bits of linear light, where its curve is steepest.
        Some(_) => Prediction {
            wrong_ppm: 0.0,
            channel: 0.5 * 12.92,
        },
    }
}

fn transparency(option: Transparency, needs: &Needs) -> Prediction {
    let is_exact = match option {
        Transparency::Exact => true,
        // More layers than triangles there are not.
        Transparency::Weighted => needs.triangles <= 1,
        _ => option
            .most_layers()
            .is_some_and(|most| needs.triangles <= most.into()),
    };
    // The nearest triangle is the same; nothing bounds how far the colors of layers are apart.
    Prediction {
        wrong_ppm: 0.0,
        channel: if is_exact || needs.glass_draws == 0 {
            0.0
        } else {
            255.0
        },
    }
}

fn clipping(option: Clipping, needs: &Needs) -> Prediction {
    match option {
        Clipping::Exact => Prediction::default(),
        _ if !needs.clipping => Prediction::default(),
        _ => Prediction {
            wrong_ppm: f64::INFINITY,
            channel: 0.0,
        },
    }
}
