//! Measures of error and of time. Nothing here returns a time without an error beside it.

pub mod compare;

/// How wrong a picture is, against the oracle. Counts are pixels unless they say otherwise.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Accuracy {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels whose owner is wrong outside every named band.
    pub owner_mismatch: u64,
    /// Pixels that differ from the oracle's own picture only because a vertex snapped one unit apart.
    pub explained_by_snap: u64,
    /// Pixels where two owners are right: depths closer than the float key's bound.
    pub band_pixels: u64,
    /// Samples that a triangle covers and that were not drawn.
    pub holes: u64,
    /// Samples that were drawn more often than they are covered.
    pub double_hits: u64,
    /// Pixels with a depth but no owner.
    pub orphans: u64,
    /// Queue entries lost; not 0 means an incomplete picture.
    pub overflow: u64,
    /// Pixels whose depth key lies outside its relative bound.
    pub key_outside_bound: u64,
    /// Vertices that snapped more than their forward error bound away from the oracle's.
    pub snap_outside_bound: u64,
    /// Largest distance between a snapped vertex and the oracle's, in units of 1/256 px, among well-conditioned vertices.
    pub max_snap_delta: u32,
    /// Largest difference of a colour channel, of 255.
    pub max_colour_delta: u8,
    /// Root mean square over all channels, of 255.
    pub rms_colour_delta: f64,
}
