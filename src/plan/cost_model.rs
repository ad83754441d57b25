//! The cost model: milliseconds of a frame as a sum of counted work. The counts follow from the plan; what one unit of each kind costs was
//! measured on the adapter by a calibration.

use super::least_squares::{self, Observation};

/// A kind of work. Operations are those of [`crate::shader::weight::Weight`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unit {
    Frame,
    Clears,
    Pass,
    PassTimed,
    ShadowMap,
    ClearedByte,
    VertexOperation,
    DeformOperation,
    SetupOperation,
    TriangleOperation,
    SampleOperation,
    QueuedOperation,
    QueuedSampleOperation,
    DiscOperation,
    PixelOperation,
    PixelLoopOperation,
    PixelVisited,
    ParticleOperation,
    LineOperation,
    OrderedTriangle,
    ChainOperation,
    PixelTurn,
}

impl Unit {
    /// Every unit with its name in files, and what it is.
    pub const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Frame, "frame", "a frame, beyond its clears and passes"),
        (Self::Clears, "clears", "the clears of a frame, however little they clear"),
        (Self::Pass, "pass", "a pass, however little it does"),
        (Self::PassTimed, "pass_timed", "what a pass takes longer when it is timed alone, because passes overlap"),
        (Self::ShadowMap, "shadow_map", "a shadow map that is drawn before the picture, beyond its passes"),
        (Self::ClearedByte, "cleared_byte", "a byte that is cleared"),
        (Self::VertexOperation, "vertex_operation", "an operation on a vertex that is projected, or on a meshlet"),
        (Self::DeformOperation, "deform_operation", "an operation on a vertex that joints or morph targets deform"),
        (
            Self::SetupOperation,
            "setup_operation",
            "an operation on what sample tests read once per triangle, or on a triangle that is clipped",
        ),
        (Self::TriangleOperation, "triangle_operation", "an operation on a triangle in the first raster pass"),
        (Self::SampleOperation, "sample_operation", "an operation on a candidate sample of a small triangle"),
        (Self::QueuedOperation, "queued_operation", "an operation on a medium or large triangle"),
        (Self::QueuedSampleOperation, "queued_sample_operation", "an operation on a candidate sample of a medium or large triangle"),
        (Self::DiscOperation, "disc_operation", "an operation on a candidate sample of a corner's disc or of a dot"),
        (Self::PixelOperation, "pixel_operation", "an operation on a pixel that is shaded, outside loops"),
        (Self::PixelLoopOperation, "pixel_loop_operation", "an operation on a pixel that is shaded, in a loop"),
        (Self::PixelVisited, "pixel_visited", "a pixel that the resolve visits"),
        (Self::ParticleOperation, "particle_operation", "an operation on a particle"),
        (Self::LineOperation, "line_operation", "an operation on a segment or a run of dots"),
        (Self::OrderedTriangle, "ordered_triangle", "a triangle in a draw order, for each pass over the order"),
        (Self::ChainOperation, "chain_operation", "an operation of the invocation of a pass that has most to do, one after another"),
        (
            Self::PixelTurn,
            "pixel_turn",
            "a turn of the longest loop over pixels: over neighbors of a pixel, or over the square about a disc or a dot",
        ),
    ];

    pub const COUNT: usize = Self::ALL.len();

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub const fn about(self) -> &'static str {
        Self::ALL[self as usize].2
    }
}

/// How much of which work a pass does.
#[derive(Clone, Debug, PartialEq)]
pub struct PassWork {
    /// As the timer calls it.
    pub label: String,
    pub counts: Vec<(Unit, f64)>,
}

/// The work of a frame: the clears first, then every pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameWork {
    /// What belongs to no pass.
    pub counts: Vec<(Unit, f64)>,
    pub passes: Vec<PassWork>,
}

/// A frame that was measured, and the work that was done in it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredFrame {
    pub work: FrameWork,
    /// Milliseconds of the whole frame.
    pub ms: f64,
    /// Milliseconds of each pass where they are known, timed one by one.
    pub passes: Vec<Option<f64>>,
}

/// What the passes of a frame, timed one by one, tell nothing of, or what they have more of than the frame.
const BEYOND_PASSES: [Unit; 3] = [Unit::Frame, Unit::ShadowMap, Unit::PassTimed];
/// The least weight of a pass beside its frame.
const LEAST_WEIGHT: f64 = 0.02;

/// Milliseconds that a unit of each kind of work takes on an adapter, none below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UnitCosts {
    ms: [f64; Unit::COUNT],
}

impl FrameWork {
    /// The work of the whole frame, in which no pass is timed alone.
    pub fn counts(&self) -> Vec<(Unit, f64)> {
        let of_passes = self.passes.iter().flat_map(|pass| pass.counts.iter().copied());
        self.counts.iter().copied().chain(of_passes).filter(|(unit, _)| *unit != Unit::PassTimed).collect()
    }
}

impl MeasuredFrame {
    /// Milliseconds of all passes that were timed.
    fn passes_ms(&self) -> f64 {
        self.passes.iter().flatten().sum()
    }
}

impl UnitCosts {
    /// Milliseconds of one unit.
    pub fn of(&self, unit: Unit) -> f64 {
        self.ms[unit as usize]
    }

    /// Sets the milliseconds of one unit; below 0 or not finite is 0.
    pub fn set(&mut self, unit: Unit, ms: f64) {
        self.ms[unit as usize] = if ms.is_finite() { ms.max(0.0) } else { 0.0 };
    }

    /// The costs that explain the measured times best, each time by its relative error: of whole frames, and of every pass in
    /// proportion to its part of the frame.
    pub fn fitted(measured: &[MeasuredFrame]) -> Self {
        let beyond = Self::beyond_passes(measured);
        let observation = |counts: &[(Unit, f64)], ms: f64, weight: f64| {
            let (mut terms, mut value) = (vec![0.0; Unit::COUNT], ms);
            for &(unit, count) in counts {
                match &beyond {
                    Some(known) if BEYOND_PASSES.contains(&unit) => value -= known.of(unit) * count,
                    _ => terms[unit as usize] += count,
                }
            }
            (value > 0.0).then_some(Observation { terms, value, weight })
        };
        let mut observations = Vec::new();
        for frame in measured {
            observations.extend(observation(&frame.work.counts(), frame.ms, 1.0));
            let all = frame.passes_ms();
            let passes = frame.work.passes.iter().zip(&frame.passes).filter_map(|(pass, ms)| Some((pass, (*ms)?)));
            observations.extend(passes.filter_map(|(pass, ms)| observation(&pass.counts, ms, (ms / all).max(LEAST_WEIGHT))));
        }
        let mut costs = beyond.unwrap_or_default();
        for (&(unit, ..), ms) in Unit::ALL.iter().zip(least_squares::nonnegative(&observations, Unit::COUNT)) {
            if beyond.is_none() || !BEYOND_PASSES.contains(&unit) {
                costs.set(unit, ms);
            }
        }
        costs
    }

    /// What whole frames take beyond the sum of their passes, which are longer when each is timed alone. It follows from measured times
    /// without any other cost, so errors of those cannot distort it. None where no pass was timed.
    fn beyond_passes(measured: &[MeasuredFrame]) -> Option<Self> {
        let observation = |frame: &MeasuredFrame| {
            let mut terms = vec![0.0; BEYOND_PASSES.len()];
            let timed = frame.work.passes.iter().zip(&frame.passes).filter(|(_, ms)| ms.is_some());
            let of_passes = timed.flat_map(|(pass, _)| &pass.counts).map(|(unit, count)| (*unit, -count));
            for (unit, count) in frame.work.counts.iter().copied().chain(of_passes) {
                if let Some(at) = BEYOND_PASSES.iter().position(|beyond| *beyond == unit) {
                    terms[at] += count;
                }
            }
            Observation { terms, value: frame.ms - frame.passes_ms(), weight: 1.0 / (frame.ms * frame.ms) }
        };
        let timed = measured.iter().filter(|frame| frame.ms > 0.0 && frame.passes_ms() > 0.0);
        let observations: Vec<_> = timed.map(observation).collect();
        let found = least_squares::of_any_sign(&observations, BEYOND_PASSES.len());
        let mut costs = Self::default();
        BEYOND_PASSES.iter().zip(found).for_each(|(unit, ms)| costs.set(*unit, ms));
        (!observations.is_empty()).then_some(costs)
    }

    /// Predicted milliseconds of some work.
    pub fn ms_of(&self, counts: &[(Unit, f64)]) -> f64 {
        counts.iter().fold(0.0, |ms, (unit, count)| ms + self.of(*unit) * count)
    }

    /// Predicted milliseconds of a frame.
    pub fn ms(&self, work: &FrameWork) -> f64 {
        self.ms_of(&work.counts())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_in_the_order_of_their_list() {
        assert!(Unit::ALL.iter().enumerate().all(|(index, (unit, ..))| *unit as usize == index));
    }

    #[test]
    fn the_costs_behind_measured_times_are_found_again() {
        let mut known = UnitCosts::default();
        [(Unit::Frame, 0.05), (Unit::Pass, 0.01), (Unit::TriangleOperation, 2e-7), (Unit::PixelOperation, 3e-8)]
            .into_iter()
            .for_each(|(unit, ms)| known.set(unit, ms));
        let measured: Vec<MeasuredFrame> = (0..40u32)
            .map(|i| {
                let counts = vec![
                    (Unit::Frame, 1.0),
                    (Unit::Pass, f64::from(3 + i % 5)),
                    (Unit::TriangleOperation, f64::from(1 + i * i) * 1e4),
                    (Unit::PixelOperation, f64::from(1 + i * 7 % 11) * 1e6),
                ];
                // Every time is up to 2 % off, and one was disturbed.
                let noise = 1.0 + 0.02 * (f64::from(i * 37 % 100) / 50.0 - 1.0);
                let disturbed = if i == 17 { 9.0 } else { 1.0 };
                let ms = known.ms_of(&counts) * noise * disturbed;
                MeasuredFrame { ms, work: FrameWork { counts, passes: Vec::new() }, passes: Vec::new() }
            })
            .collect();
        let found = UnitCosts::fitted(&measured);
        for (unit, ..) in Unit::ALL {
            let (found, known) = (found.of(*unit), known.of(*unit));
            assert!((found - known).abs() <= 0.1 * known, "{}: {found} instead of {known}", unit.name());
        }
    }

    #[test]
    fn a_frame_is_shorter_than_its_passes_timed_alone_and_longer_with_a_shadow_map() {
        let mut known = UnitCosts::default();
        let units = [(Unit::Frame, 0.004), (Unit::Clears, 0.005), (Unit::Pass, 0.003), (Unit::PassTimed, 0.002), (Unit::ShadowMap, 0.05)];
        units.into_iter().for_each(|(unit, ms)| known.set(unit, ms));
        known.set(Unit::ChainOperation, 1e-6);
        let pass = |label: &str, counts: Vec<(Unit, f64)>| PassWork { label: label.into(), counts };
        let measured: Vec<MeasuredFrame> = (0..24u32)
            .map(|i| {
                let mut passes = vec![pass("clear", vec![(Unit::Clears, 1.0)])];
                let chain = |k: u32| (Unit::ChainOperation, f64::from(100 + (7 * i + 13 * k) % 30 * 200));
                passes.extend((0..3 + i % 5).map(|k| pass("drawn", vec![(Unit::Pass, 1.0), (Unit::PassTimed, 1.0), chain(k)])));
                let work = FrameWork { counts: vec![(Unit::Frame, 1.0), (Unit::ShadowMap, f64::from(u8::from(i % 4 == 0)))], passes };
                let times = work.passes.iter().map(|pass| Some(known.ms_of(&pass.counts))).collect();
                MeasuredFrame { ms: known.ms(&work), work, passes: times }
            })
            .collect();
        let all: f64 = measured[1].passes.iter().flatten().sum();
        assert!(measured[1].ms < all, "{} of {all}", measured[1].ms);
        let found = UnitCosts::fitted(&measured);
        for (unit, ..) in Unit::ALL {
            let (found, known) = (found.of(*unit), known.of(*unit));
            assert!((found - known).abs() <= 0.02 * known, "{}: {found} instead of {known}", unit.name());
        }
    }
}
