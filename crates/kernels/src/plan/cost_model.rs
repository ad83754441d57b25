//! The cost model: milliseconds of a frame as a sum of counted work. The counts follow from the plan; what one unit of each kind costs was
//! measured on the adapter by a calibration.

use super::least_squares::{self, Observation};

/// A kind of work. Operations are those of [`crate::shader::weight::Weight`].
///
/// Where a picture is small, a pass takes as long as the invocation that has most to do, and the others wait at its end. *Chains* are the
/// operations of that invocation, *turns* how often its longest loop runs, during which it waits for memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unit {
    Frame,
    Fill,
    ShortFill,
    ClearedByte,
    Pass,
    IdlePass,
    LonePass,
    VertexOperation,
    StrictVertices,
    DeformChain,
    DeformOperation,
    SetupChain,
    SetupOperation,
    SmallTurn,
    MaskTurn,
    RaceTurn,
    SmallChain,
    SmallOperation,
    QueuedTurn,
    MediumOperation,
    LargeOperation,
    SumTurn,
    SumBlock,
    SumOperation,
    TexturedTurn,
    Clipping,
    StrictClipping,
    ClipOperation,
    DiscTurn,
    DiscOperation,
    Pixel,
    PixelTurn,
    LoopedPixel,
    Neighbor,
    NeighborPixel,
    NeighborDraw,
    SeveralDraws,
    SearchedPixel,
    Textures,
    TexturedPixel,
    PixelOperation,
    ParticleChain,
    ParticleOperation,
    RunChain,
    ListedOperation,
    DotTurn,
    DotOperation,
    OrderedTriangle,
}

impl Unit {
    /// Every unit with its name in files, and what it is.
    pub const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Frame, "frame", "a frame, however little it draws"),
        (Self::Fill, "fill", "a region of more than 4 KiB that is filled with zeros before the passes"),
        (Self::ShortFill, "short_fill", "a shorter one"),
        (Self::ClearedByte, "cleared_byte", "a byte that is cleared"),
        (Self::Pass, "pass", "a pass that finds work, however little"),
        (Self::IdlePass, "idle_pass", "a pass that finds none, or has one workgroup"),
        (Self::LonePass, "lone_pass", "a pass that is timed alone, beyond what it adds to a frame"),
        (
            Self::VertexOperation,
            "vertex_operation",
            "an operation on a vertex or the end of a segment that is projected, on a meshlet, or on a run of dots",
        ),
        (Self::StrictVertices, "strict_vertices", "a pass that projects strictly, beyond its operations"),
        (Self::DeformChain, "deform_chain", "an operation on the longest way through the kernel that deforms vertices"),
        (Self::DeformOperation, "deform_operation", "an operation on a vertex that joints or morph targets deform"),
        (Self::SetupChain, "setup_chain", "an operation on the rows of a triangle that its sample setup visits, one after another"),
        (Self::SetupOperation, "setup_operation", "an operation on what sample tests read once per triangle"),
        (Self::SmallTurn, "small_turn", "a sample of the small triangle that has most, one after another"),
        (Self::MaskTurn, "mask_turn", "the same where an image decides which samples are seen"),
        (Self::RaceTurn, "race_turn", "the same, or a sample of a triangle's discs, where samples race without atomics"),
        (Self::SmallChain, "small_chain", "an operation on these samples"),
        (
            Self::SmallOperation,
            "small_operation",
            "an operation on a triangle in a first raster pass, or on a candidate sample of a small one",
        ),
        (Self::QueuedTurn, "queued_turn", "a block of 64 pixels of the queued triangle that has most, one after another"),
        (Self::MediumOperation, "medium_operation", "an operation on a candidate sample of a medium triangle"),
        (Self::LargeOperation, "large_operation", "an operation on a large triangle whose tiles are found, or on a candidate sample of it"),
        (Self::SumTurn, "sum_turn", "a layer of the small triangle that adds most to sums, one after another"),
        (Self::SumBlock, "sum_block", "a block of 64 pixels of the queued triangle that adds most, one after another"),
        (Self::SumOperation, "sum_operation", "an operation on a candidate sample of a queued triangle that is added to sums"),
        (Self::TexturedTurn, "textured_turn", "a layer or block of these that reads images of materials, beyond that"),
        (Self::Clipping, "clipping", "a pass that clips many triangles"),
        (Self::StrictClipping, "strict_clipping", "such a pass with strict vertices, beyond that"),
        (Self::ClipOperation, "clip_operation", "an operation on a triangle that is clipped"),
        (Self::DiscTurn, "disc_turn", "a candidate sample of the discs of one triangle, one after another"),
        (Self::DiscOperation, "disc_operation", "an operation on a candidate sample of a corner's disc"),
        (Self::Pixel, "pixel", "a pixel that the resolve visits, or a block of them that a pass over tiles does"),
        (Self::PixelTurn, "pixel_turn", "a turn of the longest loop of an effect over what belongs to one pixel"),
        (Self::LoopedPixel, "looped_pixel", "such a turn of one pixel among many"),
        (Self::Neighbor, "neighbor", "a pixel that an image effect reads for each, one after another"),
        (Self::NeighborPixel, "neighbor_pixel", "such a pixel for one among many"),
        (Self::NeighborDraw, "neighbor_draw", "a pixel that an image effect reads for each, where its draw is looked for among several"),
        (Self::SeveralDraws, "several_draws", "a resolve that looks for the draw of a triangle among several"),
        (Self::SearchedPixel, "searched_pixel", "such a search for one pixel among many"),
        (Self::Textures, "textures", "a resolve that reads images of materials"),
        (Self::TexturedPixel, "textured_pixel", "a pixel among many that reads images of materials"),
        (Self::PixelOperation, "pixel_operation", "an operation on a pixel that is shaded or scaled"),
        (Self::ParticleChain, "particle_chain", "an operation on the longest way through the kernel that moves particles"),
        (Self::ParticleOperation, "particle_operation", "an operation on a particle"),
        (Self::RunChain, "run_chain", "an operation on the longest way through the kernel that lists dots"),
        (Self::ListedOperation, "listed_operation", "an operation on a dot that may be visible"),
        (Self::DotTurn, "dot_turn", "a candidate sample of one dot, one after another"),
        (Self::DotOperation, "dot_operation", "an operation on a candidate sample of a dot"),
        (Self::OrderedTriangle, "ordered_triangle", "a triangle in a draw order, for each pass over the order"),
    ];

    pub const COUNT: usize = Self::ALL.len();

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// Does it count how long the invocation with most to do keeps the others waiting? Where invocations run one after another, as on a CPU
    /// adapter, nothing waits for it.
    pub const fn is_wait(self) -> bool {
        matches!(
            self,
            Self::StrictVertices
                | Self::DeformChain
                | Self::SetupChain
                | Self::SmallTurn
                | Self::MaskTurn
                | Self::RaceTurn
                | Self::SmallChain
                | Self::QueuedTurn
                | Self::SumTurn
                | Self::SumBlock
                | Self::TexturedTurn
                | Self::Clipping
                | Self::StrictClipping
                | Self::DiscTurn
                | Self::PixelTurn
                | Self::Neighbor
                | Self::NeighborDraw
                | Self::SeveralDraws
                | Self::Textures
                | Self::ParticleChain
                | Self::RunChain
                | Self::DotTurn
        )
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
    pub passes: Vec<PassWork>,
}

/// A time that was measured, and the work that was done in it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredWork {
    pub counts: Vec<(Unit, f64)>,
    /// Milliseconds, above 0.
    pub ms: f64,
    /// How much its error counts beside that of others; 1 as a rule.
    pub weight: f64,
}

/// Milliseconds that a unit of each kind of work takes on an adapter, none below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCosts {
    ms: [f64; Unit::COUNT],
}

impl Default for UnitCosts {
    fn default() -> Self {
        Self { ms: [0.0; Unit::COUNT] }
    }
}

impl FrameWork {
    /// The work of all passes together.
    pub fn counts(&self) -> Vec<(Unit, f64)> {
        self.passes.iter().flat_map(|pass| pass.counts.iter().copied()).collect()
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

    /// The costs that explain the measured times best, each time by its relative error; without `waits`, [`Unit::is_wait`] costs nothing.
    pub fn fitted(measured: &[MeasuredWork], waits: bool) -> Self {
        let observation = |work: &MeasuredWork| {
            let mut terms = vec![0.0; Unit::COUNT];
            let counted = work.counts.iter().filter(|(unit, _)| waits || !unit.is_wait());
            counted.for_each(|(unit, count)| terms[*unit as usize] += count);
            Observation { terms, value: work.ms, weight: work.weight }
        };
        let observations: Vec<_> = measured.iter().filter(|work| work.ms > 0.0).map(observation).collect();
        let mut costs = Self::default();
        for (&(unit, ..), ms) in Unit::ALL.iter().zip(least_squares::nonnegative(&observations, Unit::COUNT)) {
            costs.set(unit, ms);
        }
        costs
    }

    /// Predicted milliseconds of some work.
    pub fn ms_of(&self, counts: &[(Unit, f64)]) -> f64 {
        counts.iter().fold(0.0, |ms, (unit, count)| ms + self.of(*unit) * count)
    }

    /// Predicted milliseconds of a pass that is timed alone.
    pub fn lone_ms(&self, pass: &PassWork) -> f64 {
        self.ms_of(&pass.counts) + self.of(Unit::LonePass)
    }

    /// Predicted milliseconds of a frame.
    pub fn ms(&self, work: &FrameWork) -> f64 {
        work.passes.iter().map(|pass| self.ms_of(&pass.counts)).sum()
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
        [(Unit::Frame, 0.05), (Unit::Pass, 0.01), (Unit::SmallOperation, 2e-7), (Unit::PixelOperation, 3e-8)]
            .into_iter()
            .for_each(|(unit, ms)| known.set(unit, ms));
        let measured: Vec<MeasuredWork> = (0..40u32)
            .map(|i| {
                let counts = vec![
                    (Unit::Frame, 1.0),
                    (Unit::Pass, f64::from(3 + i % 5)),
                    (Unit::SmallOperation, f64::from(1 + i * i) * 1e4),
                    (Unit::PixelOperation, f64::from(1 + i * 7 % 11) * 1e6),
                ];
                // Every time is up to 2 % off, and one was disturbed.
                let noise = 1.0 + 0.02 * (f64::from(i * 37 % 100) / 50.0 - 1.0);
                let disturbed = if i == 17 { 9.0 } else { 1.0 };
                MeasuredWork { ms: known.ms_of(&counts) * noise * disturbed, counts, weight: 1.0 }
            })
            .collect();
        let found = UnitCosts::fitted(&measured, true);
        for (unit, ..) in Unit::ALL {
            let (found, known) = (found.of(*unit), known.of(*unit));
            assert!((found - known).abs() <= 0.1 * known, "{}: {found} instead of {known}", unit.name());
        }
    }
}
