//! Colors: numbers as they are shown on a screen (sRGB), in linear light.

use crate::math::linear_light;

/// The brightest light, the largest finite f16.
const BRIGHTEST: f32 = 65_504.0;

/// Linear light of a color from 0 up. What is brighter than white is linear already.
pub fn linear(color: [f32; 3]) -> [f32; 3] {
    color.map(|value| match value.max(0.0) {
        value if value <= 1.0 => linear_light(value.into()) as f32,
        value => value.min(BRIGHTEST),
    })
}

/// A color of a vertex from 0 to 1 in linear light, in units of 1/65535; the last is unused.
pub fn of_vertex(color: [f32; 3]) -> [u16; 4] {
    let unit = |value: f32| (linear_light(value.clamp(0.0, 1.0).into()) * 65_535.0).round() as u16;
    let [r, g, b] = color.map(unit);
    [r, g, b, u16::MAX]
}

/// What the points of a cloud are colored by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    Color,
    Intensity,
    Class,
}

impl Shown {
    const ALL: [(Self, &str); 3] = [
        (Self::Color, "color"),
        (Self::Intensity, "intensity"),
        (Self::Class, "class"),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// What is called `name`; where that is nothing that the cloud has, its color, or else its
    /// intensity.
    pub fn named(name: &str, has_color: bool) -> Self {
        let known = Self::ALL.into_iter().find(|(_, known)| *known == name);
        match known {
            Some((shown, _)) if shown != Self::Color || has_color => shown,
            _ if has_color => Self::Color,
            _ => Self::Intensity,
        }
    }

    /// The names of those that the cloud has.
    pub fn offered(has_color: bool, has_intensity: bool, has_classes: bool) -> Vec<String> {
        let has = [has_color, has_intensity, has_classes];
        let named = Self::ALL.into_iter().zip(has).filter(|(_, has)| *has);
        named.map(|((_, name), _)| name.to_owned()).collect()
    }
}

/// A color for a class of the standard, as it is shown, of three bytes; others go around.
pub fn of_class(class: usize) -> [u8; 3] {
    const COLORS: [[u8; 3]; 12] = [
        [170, 170, 170],
        [150, 150, 150],
        [150, 110, 70],
        [160, 200, 110],
        [100, 170, 70],
        [40, 120, 50],
        [200, 90, 70],
        [220, 60, 160],
        [240, 200, 60],
        [60, 130, 200],
        [120, 100, 150],
        [90, 95, 105],
    ];
    COLORS[class % COLORS.len()]
}
