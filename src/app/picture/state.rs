//! The picture in the window and what is known of it.

use std::sync::Arc;

use super::{
    findings::Findings, overlay::OverlaySelection, precision::PrecisionState, review::Review,
    screen::Screen, tier_times::TierTimes, verification::Verification,
};
use crate::{
    app::picture::command::{Marker, Measured, Picking, Probed},
    measure::ErrorReport,
};

/// The picture in the window and what is known of it.
pub struct PictureState {
    /// What the accuracy tiers cost. Dropped before the screen, which waits for its thread.
    pub tier_times: TierTimes,
    pub screen: Screen,
    pub verification: Verification,
    pub overlays: OverlaySelection,
    /// The f32 errors of the effects.
    pub precision: PrecisionState,
    /// Presets whose picture differs from its golden.
    pub review: Review,
    /// The place in the picture that is marked.
    pub marker: Option<Marker>,
    /// What was told of a pixel.
    pub probed: Option<Probed>,
    /// What a distance is measured between.
    pub measured: Option<Measured>,
    /// What the next click on the model sets.
    pub picking: Option<Picking>,
}

impl PictureState {
    pub fn new(screen: Screen) -> Self {
        Self {
            tier_times: TierTimes::default(),
            screen,
            verification: Verification::default(),
            overlays: OverlaySelection::default(),
            precision: PrecisionState::default(),
            review: Review::default(),
            marker: None,
            probed: None,
            measured: None,
            picking: None,
        }
    }

    /// The verdict on the picture that is drawn, as numbers.
    pub fn accuracy(&self) -> Option<&ErrorReport> {
        self.verification
            .verdict_on(self.screen.drawn())
            .map(|verdict| &verdict.findings.accuracy)
    }

    /// The verdict on the requested picture, pixel by pixel.
    pub fn findings(&self) -> Option<&Arc<Findings>> {
        self.verification
            .verdict_on(self.screen.requested())
            .map(|verdict| &verdict.findings)
    }

    /// False while overlays are shown and the picture has not been judged.
    pub fn overlays_are_ready(&self) -> bool {
        !self.overlays.is_any()
            || self.findings().is_some()
            || self.verification.has_failed(self.screen.requested())
    }
}
