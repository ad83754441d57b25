//! Accuracy requests: the tolerance that a preset asks for, and the options that it pins.

use super::{
    AXES, AccuracyOptions, AxisOption, DepthFormat, MeasuredCosts, Parameters, PinnedOptions,
    RenderScale, SampleCounter, ShaderChecks, Skinning, Transparency, VertexTransform, Visibility,
};

/// Named tolerances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tier {
    /// For interaction: up to 2 % of the pixels may be wrong.
    Draft,
    /// Up to 0.1 % of the pixels may be wrong.
    Fast,
    /// Exact, given the snapped corners.
    #[default]
    Precise,
    /// Depths in integers too: there is one right answer.
    Reference,
    /// The same bits of triangle ids and depths on every adapter and on the CPU.
    Strict,
}

impl Tier {
    pub const ALL: [Self; 5] = [
        Self::Draft,
        Self::Fast,
        Self::Precise,
        Self::Reference,
        Self::Strict,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Fast => "fast",
            Self::Precise => "precise",
            Self::Reference => "reference",
            Self::Strict => "strict",
        }
    }

    /// The tolerance of that name.
    pub const fn tolerance(self) -> Tolerance {
        match self {
            Self::Draft => Tolerance {
                wrong_ppm: 20_000.0,
                channel: 48,
            },
            Self::Fast => Tolerance {
                wrong_ppm: 1000.0,
                channel: 6,
            },
            Self::Precise | Self::Reference | Self::Strict => Tolerance {
                wrong_ppm: 0.0,
                channel: 1,
            },
        }
    }

    /// The options that planning starts from; it leaves them only for a gain within the tolerance.
    pub fn base(self) -> AccuracyOptions {
        match self {
            Self::Draft | Self::Fast | Self::Precise => AccuracyOptions::default(),
            Self::Reference => AccuracyOptions {
                depth: DepthFormat::Integer,
                ..AccuracyOptions::default()
            },
            Self::Strict => AccuracyOptions {
                depth: DepthFormat::Integer,
                vertex_transform: VertexTransform::Strict,
                ..AccuracyOptions::default()
            },
        }
    }
}

/// How far a picture may be off the oracle's.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Tolerance {
    /// Pixels with the wrong triangle, per million.
    pub wrong_ppm: f64,
    /// Difference of a color channel, of 255.
    pub channel: u8,
}

/// Axes whose faster options lose nothing, or whose loss is judged in other ways.
const EXACT_AXES: [usize; 5] = [
    Visibility::AXIS,
    Skinning::AXIS,
    RenderScale::AXIS,
    Parameters::AXIS,
    ShaderChecks::AXIS,
];

/// How exact the picture must be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AccuracyRequest {
    pub tier: Tier,
    /// Pinned options take precedence over the tier.
    pub pins: PinnedOptions,
    /// Tolerance instead of the tier's: pixels with the wrong triangle, per million.
    pub wrong_ppm: Option<f64>,
    /// Tolerance instead of the tier's: difference of a color channel, of 255.
    pub channel: Option<u8>,
    /// What options cost on the adapter at hand, as far as it was measured. The window fills it
    /// in; no preset holds it.
    pub measured: MeasuredCosts,
}

impl AccuracyRequest {
    /// The same, with 2×2 samples for each pixel unless it pins how many: what a still or a film is
    /// drawn with.
    #[must_use]
    pub fn anti_aliased(self) -> Self {
        if self.pins.option::<RenderScale>().is_some() {
            return self;
        }
        Self {
            pins: self.pins.with(RenderScale::Double),
            ..self
        }
    }

    /// The request whose triangle ids and depth keys are the same bits on every adapter, in every
    /// browser and on the CPU.
    pub fn portable_bits() -> Self {
        let pins = PinnedOptions::of(Visibility::Split32)
            .with(VertexTransform::Strict)
            .with(DepthFormat::Integer);
        Self {
            pins,
            ..Self::default()
        }
    }

    /// How many pixels are drawn for one that is shown: as the preset pins it.
    pub fn scale(&self) -> RenderScale {
        self.pins.option().unwrap_or_default()
    }

    /// Is anything shown behind what blends?
    pub fn is_seen_through(&self) -> bool {
        self.pins.option() != Some(Transparency::Opaque)
    }

    /// Does it pin an option whose picture differs from run to run?
    pub fn is_left_to_chance(&self) -> bool {
        self.pins.option() == Some(Visibility::Race)
            || self.pins.option() == Some(SampleCounter::Racy)
    }

    /// Does it allow a picture that is not exact?
    pub fn may_err(&self) -> bool {
        self.inexact_pins().next().is_some() || self.tolerance().wrong_ppm > 0.0
    }

    /// The pinned options whose picture may be wrong, as `depth=log16`.
    pub fn inexact_pins(&self) -> impl Iterator<Item = String> + '_ {
        AXES.iter().filter_map(|axis| {
            let index = self.pins.get(axis)?;
            let is_inexact = match axis.index() {
                Visibility::AXIS => !Visibility::from_index(index).is_exact(),
                exact if EXACT_AXES.contains(&exact) => false,
                _ => index < axis.default,
            };
            is_inexact.then(|| format!("{}={}", axis.name, axis.words[index]))
        })
    }

    /// The preset's own tolerance, or the tier's.
    pub fn tolerance(&self) -> Tolerance {
        let named = self.tier.tolerance();
        Tolerance {
            wrong_ppm: self.wrong_ppm.unwrap_or(named.wrong_ppm),
            channel: self.channel.unwrap_or(named.channel),
        }
    }
}
