//! Slots: parts of the rasterizer that an effect replaces. A slot takes one effect.

/// A part of the rasterizer that an effect replaces. A slot takes one effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// Which samples a triangle covers.
    Coverage,
    /// How many samples are drawn, and in which order they are counted.
    Order,
    /// What the picture shows of the samples of one pixel.
    Visibility,
}

impl Slot {
    pub const ALL: [Self; 3] = [Self::Coverage, Self::Order, Self::Visibility];

    /// Name for listings and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coverage => "coverage",
            Self::Order => "order",
            Self::Visibility => "visibility",
        }
    }
}

/// What a triangle covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Its own samples, by the top-left rule.
    #[default]
    Triangles,
    /// The samples of its bounding box.
    Boxes,
    /// Discs around its corners.
    Points,
}

/// What the effect in [`Slot::Visibility`] makes of the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layers {
    /// Their average, in sums of so many bits per channel.
    Xray { bits: u32 },
    /// Their number.
    Overdraw,
    /// The nearest, unless invocations interfere.
    Race,
    /// The nearest opaque one through all glass in front of it.
    Glass,
}

impl Layers {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xray { .. } => "xray",
            Self::Overdraw => "overdraw",
            Self::Race => "race",
            Self::Glass => "glass",
        }
    }
}
