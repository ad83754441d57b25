//! The resolution of shadow maps and of their filter.

use crate::accuracy::{ShadowMapSize, ShadowTaps};

impl ShadowMapSize {
    /// Texels along each side of the map.
    pub const fn side(self) -> u32 {
        256 << self as u32
    }
}

impl ShadowTaps {
    /// Texels along each side of the filter.
    pub const fn side(self) -> u32 {
        2 * self as u32 + 1
    }
}

/// Resolution of a shadow map and of its filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowResolution {
    /// Texels along each side of the shadow map; 0: ray-traced.
    pub side: u32,
    /// Texels along each side of the filter: 1, 3 or 5; 0: ray-traced.
    pub taps: u32,
}

impl Default for ShadowResolution {
    fn default() -> Self {
        Self::of(ShadowMapSize::default(), ShadowTaps::default())
    }
}

impl ShadowResolution {
    /// No map but one shadow ray per sample. Only the oracle supports it.
    pub const TRACED: Self = Self { side: 0, taps: 0 };

    /// The resolution that these options select.
    pub const fn of(map: ShadowMapSize, taps: ShadowTaps) -> Self {
        Self {
            side: map.side(),
            taps: taps.side(),
        }
    }

    /// The accuracy options of this resolution; their defaults where it is none.
    pub fn options(&self) -> (ShadowMapSize, ShadowTaps) {
        let map = ShadowMapSize::ALL
            .iter()
            .find(|option| option.side() == self.side);
        let taps = ShadowTaps::ALL
            .iter()
            .find(|option| option.side() == self.taps);
        (
            map.copied().unwrap_or_default(),
            taps.copied().unwrap_or_default(),
        )
    }
}
