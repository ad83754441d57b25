//! Overdraw: how many layers each pixel has, as heat.

use glam::DVec3;

use super::{BuiltIn, Effect, hooks::Slot};
use crate::{choice, words};

choice! {
    /// How layers become heat.
    pub enum Scale {
        /// Every layer is one equal step.
        Linear,
        /// Every doubling is one equal step.
        Log,
    }
}

choice! {
    /// The colors of heat.
    pub enum Palette {
        /// Night blue, magenta, orange, pale yellow.
        Ember,
        /// Deep violet, teal, green, yellow.
        Reef,
        /// Black to white.
        Grey,
    }
}

words! {
    pub struct Overdraw of "overdraw" {
        max_layers: u32,
        scale: u32,
        palette: u32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Overdraw>()
    .in_slot(Slot::Visibility)
    .into()
});

/// Colors of a palette from cold to hot at equal steps of heat, as gamma-encoded bytes: lightness
/// rises evenly.
const EMBER: [[u8; 3]; 9] = [
    [22, 20, 58],
    [62, 26, 105],
    [112, 31, 130],
    [165, 40, 132],
    [215, 59, 115],
    [249, 92, 86],
    [252, 147, 66],
    [253, 192, 77],
    [252, 232, 148],
];
const REEF: [[u8; 3]; 9] = [
    [52, 18, 74],
    [57, 45, 109],
    [47, 77, 128],
    [36, 107, 137],
    [28, 137, 137],
    [40, 167, 125],
    [92, 195, 96],
    [166, 216, 60],
    [246, 230, 60],
];
const GREY: [[u8; 3]; 9] = [
    [28, 28, 28],
    [56, 56, 56],
    [84, 84, 84],
    [113, 113, 113],
    [141, 141, 141],
    [170, 170, 170],
    [198, 198, 198],
    [227, 227, 227],
    [255, 255, 255],
];

impl Overdraw {
    /// Heat of so many layers: 0 for one, 1 at full heat.
    pub fn heat(&self, layers: u32) -> f64 {
        let (layers, full) = (f64::from(layers.max(1)), f64::from(self.max_layers.max(2)));
        let heat = match Scale::of(self.scale) {
            Scale::Linear => (layers - 1.0) / (full - 1.0),
            Scale::Log => libm::log2(layers) / libm::log2(full),
        };
        heat.min(1.0)
    }

    /// Layers that have this heat.
    pub fn layers_at(&self, heat: f64) -> f64 {
        let full = f64::from(self.max_layers.max(2));
        match Scale::of(self.scale) {
            Scale::Linear => 1.0 + heat * (full - 1.0),
            Scale::Log => libm::exp2(heat * libm::log2(full)),
        }
    }

    /// Color of a heat from 0 to 1, gamma-encoded, 0 to 1.
    pub fn color(&self, heat: f64) -> DVec3 {
        let stops = match Palette::of(self.palette) {
            Palette::Ember => &EMBER,
            Palette::Reef => &REEF,
            Palette::Grey => &GREY,
        };
        let position = heat.clamp(0.0, 1.0) * 8.0;
        let first = (position.floor() as usize).min(7);
        let [low, high] =
            [stops[first], stops[first + 1]].map(|stop| DVec3::from_array(stop.map(f64::from)));
        (low + (high - low) * (position - first as f64)) / 255.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_runs_from_one_layer_to_the_full_number() {
        for scale in [Scale::Linear, Scale::Log] {
            let heat = Overdraw {
                max_layers: 16,
                scale: scale as u32,
                ..Overdraw::default()
            };
            assert_eq!(
                [heat.heat(1), heat.heat(16), heat.heat(1000)],
                [0.0, 1.0, 1.0]
            );
            for layers in 1..=16 {
                assert!((heat.layers_at(heat.heat(layers)) - f64::from(layers)).abs() < 1e-9);
            }
        }
        assert!(
            Overdraw {
                max_layers: 1,
                ..Overdraw::default()
            }
            .heat(2)
                == 1.0,
            "a full heat of one layer divides by nothing"
        );
    }

    #[test]
    fn every_palette_grows_lighter_evenly() {
        for palette in [Palette::Ember, Palette::Reef, Palette::Grey] {
            let heat = Overdraw {
                palette: palette as u32,
                ..Overdraw::default()
            };
            let linear = |v: f64| {
                if v <= 0.04045 {
                    v / 12.92
                } else {
                    libm::pow((v + 0.055) / 1.055, 2.4)
                }
            };
            let lightness = |position: usize| {
                let c = heat.color(position as f64 / 8.0);
                let y = 0.2126 * linear(c.x) + 0.7152 * linear(c.y) + 0.0722 * linear(c.z);
                if y > 216.0 / 24389.0 {
                    116.0 * libm::cbrt(y) - 16.0
                } else {
                    y * 24389.0 / 27.0
                }
            };
            let steps: Vec<f64> = (0..8)
                .map(|position| lightness(position + 1) - lightness(position))
                .collect();
            let mean = steps.iter().sum::<f64>() / 8.0;
            assert!(
                steps
                    .iter()
                    .all(|step| (0.7..1.35).contains(&(step / mean))),
                "{palette:?}: {steps:?} L* between stops"
            );
        }
    }
}
