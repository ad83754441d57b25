//! Dots: draws dots along the edges of the meshes, or along a polyline, evenly spaced in the world.
//!
//! A dot's level is how often its number can be halved: every second dot is of level 0, every
//! fourth of level 1 and so on. Where dots would crowd on the screen, those of the lowest level
//! fade until they are gone when the gap has halved, then the next ones begin; so the pattern thins
//! continuously as the camera moves away. The position of a dot is a float that is snapped once;
//! its level, its fading and the samples that it covers are integers from there on. Of several dots
//! on a pixel the strongest shows, in any drawing order.

use super::{BuiltIn, Effect};
use crate::{
    choice,
    words,
    scene::view::View,
};

choice! {
    /// The lines along which dots are drawn.
    pub enum LineSource {
        /// Every edge of every mesh, once.
        Edges,
        /// The edges at which faces meet at an angle, and open ones.
        Creases,
        /// The preset's own line, `scene.polyline`.
        Polyline,
    }
}

words! {
    pub struct Dots of "dots" {
        color: [f32; 4],
        lines: u32,
        crease_deg: f32,
        spacing_m: f32,
        size_px: f32,
        min_gap_px: f32,
        levels: u32,
        fade: f32,
        hidden_opacity: f32,
        bias: f32,
        show_model: u32,
        dash_m: f32,
        gap_m: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Dots>()
        .with_lines()
        .into()
});

/// Most dots of a picture: 8 bytes each fit the binding of every adapter.
pub const MAX_DOTS: u64 = 1 << 24;

/// Strength of an opaque dot; strengths range from 0 to this.
pub const FULL: u32 = 256;

/// Bits of a float's fraction: so many steps lead from a power of two to the next.
const STEPS: u32 = 23;

/// Where the dots of one line lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DotRow {
    /// Dots of a dash, at least 1; without dashes all of the line.
    pub per_dash: u64,
    /// Dashes of the line, at least 1.
    pub dashes: u64,
    /// From one dot of a dash to the next, meters: at most the spacing.
    pub step_m: f64,
    /// From the beginning of one dash to that of the next, meters.
    pub period_m: f64,
}

impl DotRow {
    /// Dots of the line.
    pub const fn count(&self) -> u64 {
        self.per_dash.saturating_mul(self.dashes)
    }

    /// The dash of a dot.
    pub const fn dash(&self, dot: u64) -> u64 {
        dot / self.per_dash
    }

    /// Where a dot lies, meters from the beginning of the line.
    pub fn place_m(&self, dot: u64) -> f64 {
        self.dash(dot) as f64 * self.period_m + (dot % self.per_dash) as f64 * self.step_m
    }
}

impl Dots {
    /// The dots on a line so long, above 0: one at its beginning, the others evenly, or in dashes
    /// of which the last one ends where the line does.
    pub fn row(&self, length_m: f64) -> DotRow {
        let spacing_m = f64::from(self.spacing_m);
        if self.dash_m == 0.0 {
            return DotRow {
                per_dash: ((length_m / spacing_m).floor() as u64).saturating_add(1),
                dashes: 1,
                step_m: spacing_m,
                period_m: 0.0,
            };
        }
        let (dash_m, gap_m) = (
            f64::from(self.dash_m.max(self.spacing_m)),
            f64::from(self.gap_m),
        );
        let dashes = ((length_m + gap_m) / (dash_m + gap_m)).round().max(1.0);
        let stretched = length_m / (dashes * dash_m + (dashes - 1.0) * gap_m);
        let steps = (dash_m * stretched / spacing_m).ceil().max(1.0);
        DotRow {
            per_dash: (steps as u64).saturating_add(1),
            dashes: dashes as u64,
            step_m: dash_m * stretched / steps,
            period_m: (dash_m + gap_m) * stretched,
        }
    }

    /// Radius in units of 1/256 px.
    pub fn radius(&self) -> u32 {
        (f64::from(self.size_px) * 128.0).round_ties_even() as u32
    }

    /// Bits of the f32 nearest to the 1/w at which dots of level 0 begin to fade: there they lie
    /// `min_gap_px` apart.
    pub fn fade_from(&self, view: &View) -> u32 {
        let pixel_size_m = view.ndc_axes[1].length() * 2.0 / f64::from(view.height.max(1));
        ((pixel_size_m * f64::from(self.min_gap_px) / f64::from(self.spacing_m)).clamp(1e-30, 1e30)
            as f32)
            .to_bits()
    }

    /// How fast dots fade, in strengths per level.
    pub fn fade_rate(&self) -> u32 {
        (f64::from(FULL) / f64::from(self.fade)).round() as u32
    }

    /// Strength of a hidden dot, of [`FULL`].
    pub fn hidden_share(&self) -> u32 {
        (f64::from(self.hidden_opacity) * f64::from(FULL)).round() as u32
    }

    /// The bias as a difference of the bits of two depths, which are a piecewise linear logarithm.
    pub fn bias_steps(&self) -> u32 {
        (f64::from(self.bias) * f64::from(1u32 << STEPS)) as u32
    }

    /// Strength of the dot of this number where 1/w has these bits, 0 to [`FULL`]. Bits of floats
    /// rise by one level when the float doubles, so their difference is how often the gap has
    /// halved.
    pub fn strength(&self, number: u32, inv_w: u32, fade_from: u32) -> u32 {
        let halved = (i64::from(fade_from) - i64::from(inv_w))
            .clamp(0, i64::from(self.levels) << STEPS) as u32;
        let level = if number == 0 {
            31
        } else {
            number.trailing_zeros()
        };
        match level.cmp(&(halved >> STEPS)) {
            std::cmp::Ordering::Greater => FULL,
            std::cmp::Ordering::Less => 0,
            std::cmp::Ordering::Equal => {
                let left = (1 << STEPS) - (halved & ((1 << STEPS) - 1));
                (((left >> 8) * self.fade_rate()) >> (STEPS - 8)).min(FULL)
            }
        }
    }

    /// How much of a pixel a dot covers, of [`FULL`], given the squared distance of its center from
    /// the sample: half at the radius, falling over about a pixel and linearly with the square,
    /// so that all covers sum to the dot's area.
    pub fn cover(&self, squared: u64) -> u32 {
        let radius = u64::from(self.radius());
        (((radius + 256) * radius).saturating_sub(squared) / (2 * radius)).min(u64::from(FULL))
            as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_begins_and_ends_with_a_whole_dash_wherever_it_ends() {
        for (dash_m, gap_m, spacing_m) in [(0.2, 0.1, 0.01), (0.3, 0.02, 0.07), (0.01, 0.4, 0.05)] {
            let dots = Dots {
                dash_m,
                gap_m,
                spacing_m,
                ..Dots::default()
            };
            for k in 1..400 {
                let length_m = 0.013 * f64::from(k);
                let row = dots.row(length_m);
                let last_m = row.place_m(row.count() - 1);
                assert_eq!(row.place_m(0), 0.0);
                assert!((last_m - length_m).abs() < 1e-9, "{last_m} of {length_m}");
                assert!(row.step_m <= f64::from(spacing_m) * (1.0 + 1e-9));
                let places = (0..row.count()).map(|dot| row.place_m(dot));
                assert!(places.is_sorted(), "{row:?}");
                // Where there are several, they are stretched by half at most.
                let dash = f64::from(dash_m.max(spacing_m));
                let drawn = row.step_m * (row.per_dash - 1) as f64;
                assert!(row.dashes == 1 || drawn < 1.5 * dash + 1e-9, "{drawn} m");
            }
        }
        let even = Dots::default().row(1.0);
        assert_eq!((even.dashes, even.place_m(3)), (1, 3.0 * f64::from(0.05f32)));
    }
}
