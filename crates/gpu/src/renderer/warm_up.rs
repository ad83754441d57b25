//! Keeping a graphics card busy, so that frames are timed at the clock of a card at work: an idle
//! card lowers its clock, and one short frame after another with a wait between them does not raise
//! it.

use std::time::Duration;

use web_time::Instant;

use crate::device::{Gpu, error::RenderError};

/// Frames of a sample, drawn without a pause; the last is timed, since other contenders' frames
/// have emptied the caches.
pub const FRAMES_PER_SAMPLE: usize = 2;
/// Frames of a contender in turn while warming up, drawn without a pause.
const FRAMES_IN_TURN: usize = 8;
/// How long a card that may have been idle is kept busy before anything is timed.
pub const FROM_IDLE: Duration = Duration::from_millis(800);

/// Draws `contenders` in turn for so long. `draw` takes a contender's index and how many frames to
/// draw before it waits; it returns false to end the warm-up. Software adapters have no clock of
/// their own, so nothing is drawn there.
pub async fn warm_up(
    gpu: &Gpu,
    duration: Duration,
    contenders: usize,
    mut draw: impl AsyncFnMut(usize, usize) -> Result<bool, RenderError>,
) -> Result<(), RenderError> {
    let begin = Instant::now();
    let mut turn = 0;
    while contenders > 0
        && !gpu.caps.software
        && begin.elapsed() < duration
        && draw(turn % contenders, FRAMES_IN_TURN).await?
    {
        turn += 1;
    }
    Ok(())
}
