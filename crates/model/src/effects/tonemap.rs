//! Tone mapping: fits light of any strength into what a screen shows.
//!
//! Sources of the curves: Reinhard and others, *Photographic Tone Reproduction for Digital Images*
//! (2002); Khronos, *PBR Neutral Tone Mapper* (2024); Hill's fit of ACES RRT and ODT; Sobotka's AgX
//! with the polynomial of Wrensch, in linear Rec. 2020.

use glam::{DMat3, DVec3};

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::tone::rgb};
use crate::{choice, params, params::Flag};

choice! {
    /// The curve from light to what is shown.
    pub enum Curve {
        /// Light beyond 1 is cut off.
        None = "none",
        /// c / (1 + c), each channel for itself: soft, and pale where light is strong.
        Reinhard = "reinhard",
        /// Khronos PBR Neutral: base colors below 0.8 stay as they are, highlights fade to white.
        Neutral = "neutral",
        /// ACES filmic, fitted: strong contrast, warm highlights.
        Aces = "aces",
        /// AgX: low contrast, colors lose saturation as they grow bright.
        Agx = "agx",
    }
}

params! {
    pub struct Tonemap {
        /// The curve from light to what is shown.
        curve: Curve = Curve::Neutral as u32;
        /// Exposure before the curve; each stop doubles the light.
        exposure: f32 = 0.0, hard -16.0..=16.0, soft -4.0..=4.0, unit "stops";
        /// The background is exposed and mapped, too.
        background: Flag = 0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Tonemap>(
        "tonemap",
        "Tonemap",
        "fits light of any strength into what a screen shows",
    )
    .into()
});

impl SurfaceEffect for Tonemap {
    const INPUTS: &[SurfaceInput] = &[SurfaceInput::Color, SurfaceInput::Glow];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let light = s.color.truncate();
        let shown = p.shown(light);
        // The part of the light that is emitted stays the same part.
        let part = (s.glow / light.max(DVec3::splat(1e-6))).clamp(DVec3::ZERO, DVec3::ONE);
        s.glow = shown * part;
        s.color = shown.extend(s.color.w);
        s
    }
}

impl Tonemap {
    /// What linear light becomes on the screen, linear, each channel 0 to 1.
    pub fn shown(&self, light: DVec3) -> DVec3 {
        let light = light.max(DVec3::ZERO) * libm::exp2(f64::from(self.exposure));
        let shown = match Curve::of(self.curve) {
            Curve::None => light,
            Curve::Reinhard => light / (light + 1.0),
            Curve::Neutral => neutral(light),
            Curve::Aces => aces(light),
            Curve::Agx => agx(light),
        };
        shown.clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// [`Tonemap::shown`] of a linear RGBA color; alpha stays.
    pub fn shown_color(&self, color: [f32; 4]) -> [f32; 4] {
        let shown = self.shown(rgb(color)).as_vec3();
        shown.extend(color[3]).to_array()
    }
}

/// Light that Khronos PBR Neutral leaves as it is, apart from the reflection of a dielectric.
const COMPRESSED_FROM: f64 = 0.76;
/// 1 - [`COMPRESSED_FROM`]: the range of what is shown into which brighter light is compressed.
const COMPRESSED_ROOM: f64 = 0.24;
/// Reflection of a dielectric that looks straight on.
const DIELECTRIC: f64 = 0.04;
const DESATURATION: f64 = 0.15;

fn neutral(light: DVec3) -> DVec3 {
    let least = light.min_element();
    let offset = if least < 2.0 * DIELECTRIC {
        least - least * least / (4.0 * DIELECTRIC)
    } else {
        DIELECTRIC
    };
    let color = light - offset;
    let peak = color.max_element();
    if peak < COMPRESSED_FROM {
        return color;
    }
    let new_peak = 1.0 - COMPRESSED_ROOM * COMPRESSED_ROOM / (peak + COMPRESSED_ROOM - COMPRESSED_FROM);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    let color = color * (new_peak / peak);
    color + (DVec3::splat(new_peak) - color) * whiteness
}

fn aces(light: DVec3) -> DVec3 {
    let [a, b, c, d, e] = ACES_CURVE;
    // The same quotient for light up to 1e9, whose squares f32 still holds.
    let v = (matrix(ACES_IN) * light).min(DVec3::splat(1e9));
    matrix(ACES_OUT) * ((v * (v + a) - b) / (v * (v * c + d) + e))
}

fn agx(light: DVec3) -> DVec3 {
    let inset = matrix(AGX_IN) * (matrix(REC2020_OF_SRGB) * light);
    let exposed = inset.max(DVec3::splat(1e-10)).map(libm::log2) - AGX_DARKEST;
    let x = (exposed / AGX_STOPS).clamp(DVec3::ZERO, DVec3::ONE);
    let curved = AGX_POLYNOMIAL
        .iter()
        .fold(DVec3::ZERO, |sum, &coefficient| sum * x + coefficient);
    let out = (matrix(AGX_OUT) * curved).max(DVec3::ZERO);
    matrix(SRGB_OF_REC2020) * out.map(|value| libm::pow(value, AGX_GAMMA))
}

/// Hill's quotient: (v (v + a) - b) / (v (c v + d) + e).
const ACES_CURVE: [f64; 5] = [0.024_578_6, 0.000_090_537, 0.983_729, 0.432_951, 0.238_081];
/// The binary logarithm of light that AgX maps to black, and the stops from there to white.
const AGX_DARKEST: f64 = -12.473_93;
const AGX_STOPS: f64 = 16.5;
/// The curve of AgX, highest power first.
const AGX_POLYNOMIAL: [f64; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
const AGX_GAMMA: f64 = 2.2;

const ACES_IN: [[f64; 3]; 3] = [
    [0.597_19, 0.354_58, 0.048_23],
    [0.076, 0.908_34, 0.015_66],
    [0.028_4, 0.133_83, 0.837_77],
];
const ACES_OUT: [[f64; 3]; 3] = [
    [1.604_75, -0.531_08, -0.073_67],
    [-0.102_08, 1.108_13, -0.006_05],
    [-0.003_27, -0.072_76, 1.076_02],
];
const REC2020_OF_SRGB: [[f64; 3]; 3] = [
    [0.6274, 0.3293, 0.0433],
    [0.0691, 0.9195, 0.0113],
    [0.0164, 0.0880, 0.8956],
];
const SRGB_OF_REC2020: [[f64; 3]; 3] = [
    [1.6605, -0.5876, -0.0728],
    [-0.1246, 1.1329, -0.0083],
    [-0.0182, -0.1006, 1.1187],
];
const AGX_IN: [[f64; 3]; 3] = [
    [0.856_627_15, 0.095_121_24, 0.048_251_61],
    [0.137_318_97, 0.761_241_99, 0.101_439_04],
    [0.111_898_21, 0.076_799_42, 0.811_302_37],
];
const AGX_OUT: [[f64; 3]; 3] = [
    [1.127_100_58, -0.110_606_64, -0.016_493_94],
    [-0.141_329_76, 1.157_823_70, -0.016_493_94],
    [-0.141_329_76, -0.110_606_64, 1.251_936_41],
];

/// A matrix from its rows.
fn matrix(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(curve: Curve, light: f64) -> f64 {
        let tonemap = Tonemap {
            curve: curve as u32,
            exposure: 0.0,
            background: 0,
        };
        tonemap.shown(DVec3::splat(light)).y
    }

    #[test]
    fn every_curve_keeps_black_never_falls_and_ends_at_white() {
        for curve in [Curve::None, Curve::Reinhard, Curve::Neutral, Curve::Aces, Curve::Agx] {
            let mut last = shown(curve, 0.0);
            assert!(last < 1e-4, "{}: black is {last}", curve as u32);
            for step in -120..200 {
                let now = shown(curve, 2f64.powf(f64::from(step) / 10.0));
                assert!(now >= last, "curve {} falls to {now}", curve as u32);
                last = now;
            }
            assert!(last > 0.98, "{}: white is {last}", curve as u32);
        }
    }

    #[test]
    fn greys_are_what_the_curves_authors_publish() {
        // Khronos: base colors come back less the 4 % that a dielectric reflects.
        assert!((shown(Curve::Neutral, 0.5) - 0.46).abs() < 1e-6);
        // AgX: middle grey, 18 %, stays near middle grey.
        assert!((shown(Curve::Agx, 0.18) - 0.18).abs() < 0.04);
        assert_eq!(shown(Curve::Reinhard, 1.0), 0.5);
        // ACES as fitted shows 18 % a little darker; three.js and others brighten it by 1 / 0.6.
        assert!((shown(Curve::Aces, 0.18) - 0.106).abs() < 0.01);
    }

    #[test]
    fn strong_colors_turn_white_under_neutral_and_agx() {
        for curve in [Curve::Neutral, Curve::Agx] {
            let tonemap = Tonemap {
                curve: curve as u32,
                exposure: 6.0,
                background: 0,
            };
            let red = tonemap.shown(DVec3::new(4.0, 0.1, 0.1));
            assert!(red.min_element() > 0.5, "{red}");
        }
    }
}
