//! The accuracy axes: every way in which a picture trades speed for accuracy, and its options, from
//! fast to accurate.
//!
//! An option is another shader file, or an override where only arithmetic changes. One list,
//! [`AXES`], drives the settings of presets, panels, benches and tests. The planner chooses the
//! cheapest option within a tolerance.

mod measured;
mod request;

pub use self::{
    measured::MeasuredCosts,
    request::{AccuracyRequest, Tier, Tolerance},
};

/// One option of an axis, known by its type.
pub trait AxisOption: Copy {
    /// Index of the axis in [`AXES`].
    const AXIS: usize;
    /// Index of the option on its axis, 0 for the fastest.
    fn index(self) -> usize;
    /// The option with this index, which must be one of the axis.
    fn from_index(index: usize) -> Self;
    /// The pinned option of the axis.
    fn pinned(pins: &PinnedOptions) -> Option<Self>;
    /// Pins the axis to this option.
    fn pin(self, pins: &mut PinnedOptions);
}

/// An axis: its name, what it decides, and its options.
#[derive(Debug)]
pub struct Axis {
    /// Setting in presets: `accuracy.<name>`.
    pub name: &'static str,
    pub about: &'static str,
    /// The names of the options, fast ones first.
    pub words: &'static [&'static str],
    /// What a preset may say: "planned", or the name of an option.
    pub choices: &'static [&'static str],
    /// What each option does, in the same order.
    pub option_abouts: &'static [&'static str],
    /// Index of the default option.
    pub default: usize,
    get: fn(&AccuracyOptions) -> usize,
    set: fn(&mut AccuracyOptions, usize),
    pinned: fn(&PinnedOptions) -> Option<usize>,
    pin: fn(&mut PinnedOptions, Option<usize>),
}

impl Axis {
    /// Index of the axis in [`AXES`].
    pub fn index(&self) -> usize {
        AXES.iter()
            .position(|axis| axis.name == self.name)
            .expect("an axis of the list")
    }

    pub fn find(name: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.name == name)
    }
}

/// Declares every axis: an enum of its options, its members of [`AccuracyOptions`] and
/// [`PinnedOptions`], and its entry in [`AXES`].
macro_rules! axes {
    ($($(#[doc = $about:literal])+ $axis:ident: $name:ident, default $default:ident {
        $($(#[doc = $option_about:literal])+ $option:ident = $word:literal,)+
    })+) => {
        $(
            $(#[doc = $about])+
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
            pub enum $name { $($(#[doc = $option_about])+ $option,)+ }

            impl $name {
                pub const ALL: &'static [Self] = &[$(Self::$option),+];

                pub const fn name(self) -> &'static str {
                    match self { $(Self::$option => $word),+ }
                }
            }

            impl Default for $name {
                fn default() -> Self { Self::$default }
            }

            impl AxisOption for $name {
                const AXIS: usize = AxisIndex::$name as usize;
                fn index(self) -> usize { self as usize }
                fn from_index(index: usize) -> Self { Self::ALL[index] }
                fn pinned(pins: &PinnedOptions) -> Option<Self> { pins.$axis }
                fn pin(self, pins: &mut PinnedOptions) { pins.$axis = Some(self); }
            }
        )+

        enum AxisIndex { $($name),+ }

        /// One option on every axis.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct AccuracyOptions { $($(#[doc = $about])+ pub $axis: $name,)+ }

        /// Options that a preset pins. They take precedence over its tier.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct PinnedOptions { $($axis: Option<$name>,)+ }

        impl PinnedOptions {
            /// Sets every pinned axis of `options` to its pinned option.
            pub fn apply(&self, options: &mut AccuracyOptions) {
                $(options.$axis = self.$axis.unwrap_or(options.$axis);)+
            }
        }

        /// Every axis, in the order in which they are listed.
        pub const AXES: &[Axis] = &[$(Axis {
            name: stringify!($axis),
            about: concat!($($about),+),
            words: &[$($word),+],
            choices: &["planned", $($word),+],
            option_abouts: &[$(concat!($($option_about),+)),+],
            default: $name::$default as usize,
            get: |options| options.$axis as usize,
            set: |options, index| options.$axis = $name::ALL[index],
            pinned: |pins| pins.$axis.map(AxisOption::index),
            pin: |pins, index| pins.$axis = index.and_then(|index| $name::ALL.get(index).copied()),
        }),+];
    };
}

axes! {
    /// Which samples a triangle covers.
    coverage: Coverage, default Fixed8 {
        /// Edges in f32, all inclusive: samples on a shared edge are drawn twice.
        Float = "float",
        /// Edges in f32 with the top-left rule: rounding leaves holes and doubles.
        FloatTopLeft = "float-top-left",
        /// Exact edges between corners snapped to 1/16 px.
        Fixed4 = "fixed4",
        /// Triangles have exact edges between corners snapped to 1/256 px.
        Fixed8 = "fixed8",
        /// Exact edges between corners snapped to 1/4096 px, in pictures of at most 2,047 px a side.
        Fixed12 = "fixed12",
    }
    /// In how many bits positions are stored, and relative to what.
    position_format: PositionFormat, default Stored {
        /// 10 bits per axis, evenly spaced in the box of each primitive: 4 bytes per vertex, with cracks between neighbors.
        Packed10 = "packed10",
        /// 16 bits per axis, in the same way: 8 bytes per vertex.
        Packed16 = "packed16",
        /// Positions are as the file stores them.
        Stored = "stored",
        /// As the file stores them, then relative to the eye, computed in f64: exact far from the origin, too.
        Relative = "relative",
    }
    /// How vertices are projected and snapped.
    vertex_transform: VertexTransform, default Snapped {
        /// In floats, the shift of the viewport included, then snapped.
        Viewport = "viewport",
        /// Vertices are projected in floats relative to the center of the picture, then snapped.
        Snapped = "snapped",
        /// In integer arithmetic: the same bits on every adapter and on the CPU.
        Strict = "strict",
    }
    /// How the joints of a skin are blended.
    skinning: Skinning, default Linear {
        /// The matrices of joints are averaged, as in glTF: where joints twist or bend, volume is lost.
        Linear = "linear",
        /// The mean of their motions as dual quaternions: lengths are kept, and nearly all volume.
        Dual = "dual",
    }
    /// How the velocity field of particles is derived from noise.
    curl_noise: CurlNoise, default Analytic {
        /// From six samples around a point.
        Difference = "difference",
        /// The flow comes from the exact derivatives of the noise, which take one lattice lookup.
        Analytic = "analytic",
    }
    /// How particles are stored between steps.
    particle_storage: ParticleStorage, default Float32 {
        /// Positions as 16-bit fractions of their bounds, velocities as halves: 16 bytes per particle.
        Half16 = "half16",
        /// All numbers are floats: 32 bytes per particle.
        Float32 = "float32",
    }
    /// Which depth values are compared.
    depth: DepthFormat, default Reversed {
        /// 16 bits, evenly spaced in normalized device depth.
        Ndc16 = "ndc16",
        /// 16 bits, evenly spaced in the (piecewise linear) logarithm of depth.
        Log16 = "log16",
        /// 24 bits of the same.
        Log24 = "log24",
        /// Conventional float depth, 32 bits: 0 at the near plane, 1 far away.
        Standard = "standard",
        /// Depth is a reversed float of 32 bits: 1 at the near plane, 0 far away.
        Reversed = "reversed",
        /// Reversed depth from a quotient of integers: the same bits wherever the corners are the same.
        Integer = "integer",
    }
    /// How the nearest triangle of a pixel is found.
    visibility: Visibility, default Packed64 {
        /// Plain loads and stores: samples that meet on a pixel are lost.
        Race = "race",
        /// One 32-bit atomic per sample, with as much of the depth as the triangle id leaves room for.
        Packed32 = "packed32",
        /// Portable: a depth pass, then a triangle id pass.
        Split32 = "split32",
        /// One 64-bit atomic per sample keeps the nearest.
        Packed64 = "packed64",
    }
    /// How attributes are interpolated across a triangle.
    perspective: Perspective, default Exact {
        /// Linearly on the screen, as if every corner were equally far.
        Affine = "affine",
        /// Attributes are divided by w at every sample.
        Exact = "exact",
    }
    /// What happens to triangles that cross the near plane or the guard band.
    clipping: Clipping, default Exact {
        /// They are not drawn.
        Drop = "drop",
        /// Those that cross the near plane are not drawn, the others are clipped.
        Near = "near",
        /// Such triangles are clipped.
        Exact = "exact",
    }
    /// What is skipped before its triangles are set up.
    culling: Culling, default None {
        /// Nothing is skipped: each triangle is tested on its own.
        None = "none",
        /// Instances and meshlets outside the picture, and meshlets that all face away.
        Frustum = "frustum",
        /// Those, and what the previous frame hides: what has just become visible is missing.
        Hiz = "hiz",
        /// Those, and what this picture hides: first what was visible before is drawn, then what that does not hide.
        TwoPass = "two-pass",
    }
    /// How a draw order counts samples.
    sample_counter: SampleCounter, default Prefix {
        /// Load, test and add without atomics: it overshoots.
        Racy = "racy",
        /// Prefix sums, or one atomic per sample, count exactly.
        Prefix = "prefix",
    }
    /// How an x-ray sums the layers of a pixel.
    xray_sums: XraySums, default Four32 {
        /// Two words of two halves, channels of 8 bits: up to 257 layers of equal weight.
        Packed16 = "packed16",
        /// Three words, channels of 8 bits: up to 4,095 layers of equal weight.
        Three8 = "three8",
        /// Layers are summed in four words, channels of 8 to 16 bits: as many layers as the bits leave room for, with weights.
        Four32 = "four32",
    }
    /// How what is seen through layers is composed.
    transparency: Transparency, default Exact {
        /// Nothing is seen through: what blends is drawn as if it were opaque.
        Opaque = "opaque",
        /// In no order: the mean of all layers, weighted by coverage and nearness, covers what is behind as they do together.
        Weighted = "weighted",
        /// The four nearest layers in the order of depth; the others are left out.
        Nearest4 = "nearest4",
        /// All layers are composed in the order of depth.
        Exact = "exact",
    }
    /// How many pixels are drawn per shown pixel.
    render_scale: RenderScale, default Full {
        /// A sixteenth (a quarter per side), then interpolated in linear light.
        Quarter = "quarter",
        /// A quarter (half per side), then interpolated in linear light.
        Half = "half",
        /// One pixel is drawn per shown pixel.
        Full = "full",
        /// Four (two per side), then averaged in linear light.
        Double = "double",
        /// Sixteen (four per side), then averaged in linear light.
        Quadruple = "quadruple",
    }
    /// How invisible dots are skipped.
    dot_culling: DotCulling, default Gpu {
        /// Not at all: every dot is projected and drawn.
        Brute = "brute",
        /// The CPU searches a tree of lines and uploads the dots that may be visible.
        Cpu = "cpu",
        /// Compute passes cull and thin the dots; an indirect dispatch draws the others.
        Gpu = "gpu",
    }
    /// Resolution of a shadow map.
    shadow_map_size: ShadowMapSize, default Side1024 {
        /// 256 texels a side.
        Side256 = "256",
        /// 512 texels a side.
        Side512 = "512",
        /// The map has 1,024 texels a side.
        Side1024 = "1024",
        /// 2,048 texels a side.
        Side2048 = "2048",
        /// 4,096 texels a side.
        Side4096 = "4096",
    }
    /// How many texels of a shadow map are filtered.
    shadow_taps: ShadowTaps, default Nine {
        /// The one under the sample: hard edges, as jagged as the map.
        One = "1",
        /// 3 by 3 texels are weighted smoothly from texel to texel.
        Nine = "9",
        /// 5 by 5: softer edges.
        TwentyFive = "25",
    }
    /// How the effects' parameters reach the kernels.
    parameters: Parameters, default Uniform {
        /// As constants in the shader text: new text for every value.
        Baked = "baked",
        /// Kernels read them from a uniform buffer.
        Uniform = "uniform",
    }
    /// Whether the compiler adds checks to the kernels.
    shader_checks: ShaderChecks, default Checked {
        /// None: loops and indices are trusted, except where pixels are shaded whose corners an effect has moved.
        Trusted = "trusted",
        /// Loops are bounded, and indices are clamped.
        Checked = "checked",
    }
}

impl Visibility {
    /// The options that find the nearest triangle of every pixel.
    pub const EXACT: [Self; 2] = [Self::Split32, Self::Packed64];

    /// Does it find the nearest triangle of every pixel?
    pub fn is_exact(self) -> bool {
        Self::EXACT.contains(&self)
    }

    /// Can an adapter with or without 64-bit atomics run it?
    pub fn is_supported(self, int64_atomics: bool) -> bool {
        self != Self::Packed64 || int64_atomics
    }
}

impl PositionFormat {
    /// Bits of a packed component; none where positions are stored as in the file.
    pub const fn packed_bits(self) -> Option<u32> {
        match self {
            Self::Packed10 => Some(10),
            Self::Packed16 => Some(16),
            Self::Stored | Self::Relative => None,
        }
    }
}

impl RenderScale {
    /// Drawn pixels per shown pixel, along a side.
    pub const fn factor(self) -> f64 {
        match self {
            Self::Quarter => 0.25,
            Self::Half => 0.5,
            Self::Full => 1.0,
            Self::Double => 2.0,
            Self::Quadruple => 4.0,
        }
    }
}

impl Culling {
    /// Does it test meshlets against depths that were drawn?
    pub const fn occludes(self) -> bool {
        matches!(self, Self::Hiz | Self::TwoPass)
    }
}

impl Transparency {
    /// The most layers of a pixel that are composed; none where all are.
    pub const fn most_layers(self) -> Option<u32> {
        match self {
            Self::Nearest4 => Some(4),
            Self::Opaque | Self::Weighted | Self::Exact => None,
        }
    }
}

impl XraySums {
    /// Words per pixel.
    pub const fn words(self) -> u32 {
        match self {
            Self::Packed16 => 2,
            Self::Three8 => 3,
            Self::Four32 => 4,
        }
    }

    /// Layers of equal weight that fit; none where that depends on the bits per channel.
    pub const fn capacity(self) -> Option<u64> {
        match self {
            Self::Packed16 => Some(257),
            Self::Three8 => Some(4095),
            Self::Four32 => None,
        }
    }
}

impl Coverage {
    /// Bits of the fraction of a snapped position, in pixels.
    pub const fn subpixel_bits(self) -> u32 {
        match self {
            Self::Fixed4 => 4,
            Self::Fixed12 => 12,
            Self::Float | Self::FloatTopLeft | Self::Fixed8 => 8,
        }
    }

    pub const fn is_float(self) -> bool {
        matches!(self, Self::Float | Self::FloatTopLeft)
    }
}

impl AccuracyOptions {
    /// Index of the option on an axis.
    pub fn get(&self, axis: &Axis) -> usize {
        (axis.get)(self)
    }

    /// Takes the option with this index, which must be one of the axis.
    pub fn set(&mut self, axis: &Axis, index: usize) {
        (axis.set)(self, index);
    }

    /// Axes that are not on their default option, each with the name of its option.
    pub fn non_default(&self) -> impl Iterator<Item = (&'static Axis, &'static str)> + use<> {
        let options = *self;
        AXES.iter()
            .map(move |axis| (axis, options.get(axis)))
            .filter(|(axis, index)| *index != axis.default)
            .map(|(axis, index)| (axis, axis.words[index]))
    }
}

impl PinnedOptions {
    /// This option pinned, and no other axis.
    pub fn of<O: AxisOption>(option: O) -> Self {
        Self::default().with(option)
    }

    #[must_use]
    pub fn with<O: AxisOption>(mut self, option: O) -> Self {
        option.pin(&mut self);
        self
    }

    /// The pinned option of a type.
    pub fn option<O: AxisOption>(&self) -> Option<O> {
        O::pinned(self)
    }

    /// Index of the pinned option of an axis.
    pub fn get(&self, axis: &Axis) -> Option<usize> {
        (axis.pinned)(self)
    }

    /// Pins an axis to the option with this index, or unpins it.
    pub fn set(&mut self, axis: &Axis, index: Option<usize>) {
        (axis.pin)(self, index);
    }

    /// `coverage=float depth=log16`, or nothing.
    pub fn words(&self) -> String {
        let pinned = AXES
            .iter()
            .filter_map(|axis| Some(format!("{}={}", axis.name, axis.words[self.get(axis)?])));
        pinned.collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_reads_back_what_it_is_set_to() {
        for axis in AXES {
            assert_eq!(
                (axis.words.len(), axis.default),
                (
                    axis.option_abouts.len(),
                    AccuracyOptions::default().get(axis)
                ),
                "{}",
                axis.name
            );
            for index in 0..axis.words.len() {
                let (mut options, mut pins) =
                    (AccuracyOptions::default(), PinnedOptions::default());
                pins.set(axis, Some(index));
                pins.apply(&mut options);
                assert_eq!(
                    (options.get(axis), pins.get(axis)),
                    (index, Some(index)),
                    "{}",
                    axis.name
                );
                assert_eq!(
                    options.non_default().count(),
                    usize::from(index != axis.default),
                    "{}",
                    axis.name
                );
            }
        }
    }

    #[test]
    fn pins_know_options_by_type() {
        let pins = PinnedOptions::of(DepthFormat::Log16).with(Visibility::Split32);
        assert_eq!(
            (
                pins.option::<DepthFormat>(),
                pins.option::<Visibility>(),
                pins.option::<Coverage>()
            ),
            (Some(DepthFormat::Log16), Some(Visibility::Split32), None)
        );
        assert_eq!(pins.words(), "depth=log16 visibility=split32");
    }
}
