//! Overlays: images of where the picture is wrong and what it is made of, any of which can lie over
//! it.

use egui::Color32;

use crate::measure::error_map::PixelError;

/// One overlay, from the lowest to the topmost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlay {
    TriangleIds,
    Layers,
    Color,
    Edges,
    Ties,
    NotReference,
    Doubles,
    Holes,
    WrongTriangle,
    WrongDepth,
    Unsound,
}

/// Each with its name, what it shows, and its color.
const TABLE: [(Overlay, &str, &str, Color32); 11] = [
    (
        Overlay::TriangleIds,
        "Triangle ids",
        "One color per triangle, at the pixels it covers",
        Color32::from_rgb(150, 120, 210),
    ),
    (
        Overlay::Layers,
        "Layers",
        "How many triangles cover each pixel, visible or hidden",
        Color32::from_rgb(214, 86, 60),
    ),
    (
        Overlay::Color,
        "Color difference",
        "The largest difference of a channel from the oracle's color, times the gain",
        Color32::from_rgb(126, 255, 142),
    ),
    (
        Overlay::Edges,
        "Triangle edges",
        "Where neighboring pixels show different triangles",
        Color32::from_rgb(150, 154, 164),
    ),
    (
        Overlay::Ties,
        "Depth ties",
        "Two triangles are right: their depths are closer than the depth format can tell apart. Not an error",
        Color32::from_rgb(96, 134, 255),
    ),
    (
        Overlay::NotReference,
        "By rounding",
        "Another triangle than in the exact picture of the true positions, on the finest grid. The header and Trade count the same; \
         it includes the error of snapping and of every other option",
        Color32::from_rgb(204, 156, 255),
    ),
    (
        Overlay::Doubles,
        "Drawn twice",
        "A triangle was drawn more often than it covers the sample",
        Color32::from_rgb(255, 233, 74),
    ),
    (
        Overlay::Holes,
        "Holes",
        "A triangle covers the sample and was not drawn there",
        Color32::from_rgb(60, 225, 255),
    ),
    (
        Overlay::WrongTriangle,
        "Wrong",
        "Another triangle than the oracle draws from the same snapped corners, and no rounding that is allowed explains it. The header counts the same",
        Color32::from_rgb(255, 64, 224),
    ),
    (
        Overlay::WrongDepth,
        "Wrong depth winner",
        "The triangle covers the sample but is not the nearest. These pixels are wrong, too",
        Color32::from_rgb(255, 150, 48),
    ),
    (
        Overlay::Unsound,
        "NaN, infinite, negative",
        "Found in the depth, in the depth, 1/w, normal or color at the triangle's corners, or in what an effect makes of a color. The legend names \
         the effect, and its parameter where that can be told",
        Color32::from_rgb(255, 48, 48),
    ),
];

/// What the shortcut shows before any overlay was chosen.
const FIRST: [Overlay; 7] = [
    Overlay::NotReference,
    Overlay::WrongTriangle,
    Overlay::WrongDepth,
    Overlay::Holes,
    Overlay::Doubles,
    Overlay::Color,
    Overlay::Unsound,
];

impl Overlay {
    /// From the lowest to the topmost.
    pub const ALL: [Self; 11] = [
        Self::TriangleIds,
        Self::Layers,
        Self::Color,
        Self::Edges,
        Self::Ties,
        Self::NotReference,
        Self::Doubles,
        Self::Holes,
        Self::WrongTriangle,
        Self::WrongDepth,
        Self::Unsound,
    ];

    /// In the order of lists: errors first, and each group from the topmost to the lowest.
    pub fn listed() -> impl Iterator<Item = Self> {
        let of_kind = |is_error: bool| {
            Self::ALL
                .into_iter()
                .rev()
                .filter(move |overlay| overlay.is_error() == is_error)
        };
        of_kind(true).chain(of_kind(false))
    }

    pub const fn name(self) -> &'static str {
        TABLE[self as usize].1
    }

    pub const fn doc(self) -> &'static str {
        TABLE[self as usize].2
    }

    pub const fn color(self) -> Color32 {
        TABLE[self as usize].3
    }

    /// The fault that it shows, if it shows one.
    pub const fn fault(self) -> Option<PixelError> {
        match self {
            Self::WrongTriangle => Some(PixelError::WrongTriangle),
            Self::WrongDepth => Some(PixelError::WrongDepthOrder),
            Self::Holes => Some(PixelError::Hole),
            Self::Doubles => Some(PixelError::DoubleHit),
            Self::Ties => Some(PixelError::DepthBand),
            Self::Unsound => Some(PixelError::Unsound),
            Self::TriangleIds | Self::Layers | Self::Color | Self::Edges | Self::NotReference => {
                None
            }
        }
    }

    /// True if it shows errors. The others show what the picture is made of.
    pub const fn is_error(self) -> bool {
        !matches!(
            self,
            Self::TriangleIds | Self::Layers | Self::Edges | Self::Ties
        )
    }
}

impl Overlay {
    /// True if it shows pixels that are wrong, or of which two triangles are right.
    pub const fn is_doubt(self) -> bool {
        self.is_error() || matches!(self, Self::Ties)
    }
}

/// Which overlays are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlaySelection {
    shown: Vec<Overlay>,
    /// Those that the shortcut shows again.
    last: Vec<Overlay>,
    /// Factor of the color difference.
    pub gain: u8,
}

impl Default for OverlaySelection {
    fn default() -> Self {
        Self {
            shown: Vec::new(),
            last: FIRST.to_vec(),
            gain: 32,
        }
    }
}

impl OverlaySelection {
    pub fn is_any(&self) -> bool {
        !self.shown.is_empty()
    }

    /// Those that are shown, in the order in which they were switched on.
    pub fn shown(&self) -> &[Overlay] {
        &self.shown
    }

    pub fn contains(&self, overlay: Overlay) -> bool {
        self.shown.contains(&overlay)
    }

    pub fn set(&mut self, overlay: Overlay, on: bool) {
        self.shown.retain(|shown| *shown != overlay);
        if on {
            self.shown.push(overlay);
        }
    }

    /// Hides all, or shows those that were shown before.
    pub fn toggle(&mut self) {
        if self.is_any() {
            self.last = std::mem::take(&mut self.shown);
        } else {
            self.shown = self.last.clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_list() {
        for (index, overlay) in Overlay::ALL.into_iter().enumerate() {
            assert_eq!((overlay as usize, TABLE[index].0), (index, overlay));
        }
    }
}
