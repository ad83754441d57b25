//! Following a measurement while it runs, and ending it.

/// What a measurement does next.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// The combination, in words.
    pub what: &'a str,
    pub phase: Phase,
    /// Steps of the phase that are done, and all of them.
    pub done: usize,
    pub all: usize,
}

/// The phases of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// A combination is compiled, drawn and judged.
    SetUp,
    /// A combination is drawn and timed.
    Time,
}

/// Follows a measurement, and ends it.
pub trait Watch {
    /// Called before each step; false ends the measurement. It may wait, for instance until the
    /// device is free.
    fn goes_on(&mut self, step: &Step<'_>) -> impl Future<Output = bool>;

    /// False ends the measurement.
    fn is_wanted(&mut self) -> bool {
        true
    }

    /// Returns true if nothing else has used the device since the last step began, so that its time
    /// counts.
    fn was_undisturbed(&mut self) -> bool {
        true
    }
}
