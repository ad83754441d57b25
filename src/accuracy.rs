//! The accuracy axes: every axis on which a picture trades speed for accuracy, and its options, from fast to accurate.
//!
//! A option is a file behind a slot of the kernels, or an override where only arithmetic changes. One list, [`AXES`], drives
//! keys of presets, panels, benches and tests; which option is cheapest within a tolerance is the planner's affair.

/// One option of an axis, known by its type.
pub trait AxisOption: Copy {
    /// Place of the axis in [`AXES`].
    const AXIS: usize;
    /// Place of the option on its axis.
    fn place(self) -> usize;
    /// The option at a place that [`AxisOption::place`] gave.
    fn at(place: usize) -> Self;
}

/// An axis: its name, what it decides, and its options.
#[derive(Debug)]
pub struct Axis {
    /// Key in presets: `accuracy.<name>`.
    pub name: &'static str,
    pub about: &'static str,
    /// The options' words, fast ones first.
    pub words: &'static [&'static str],
    /// What a preset may say: "planned", or a option's word.
    pub choices: &'static [&'static str],
    /// What each option does, in the same order.
    pub option_abouts: &'static [&'static str],
    /// Place of the option that is taken unless something speaks for another.
    pub default: usize,
    get: fn(&AccuracyOptions) -> usize,
    set: fn(&mut AccuracyOptions, usize),
}

impl Axis {
    /// Place of the axis in [`AXES`].
    pub fn index(&self) -> usize {
        AXES.iter().position(|axis| axis.name == self.name).expect("an axis of the list")
    }

    pub fn find(name: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.name == name)
    }
}

macro_rules! accuracy {
    ($($(#[doc = $about:literal])+ $axis:ident: $name:ident = $key:literal, default $default:ident {
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
                const AXIS: usize = Place::$name as usize;
                fn place(self) -> usize { self as usize }
                fn at(place: usize) -> Self { Self::ALL[place] }
            }
        )+

        /// Places of the axes.
        enum Place { $($name),+ }

        /// A option on every axis.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct AccuracyOptions { $($(#[doc = $about])+ pub $axis: $name,)+ }

        /// Every axis, in the order in which people read about them.
        pub const AXES: &[Axis] = &[$(Axis {
            name: $key,
            about: concat!($($about),+),
            words: &[$($word),+],
            choices: &["planned", $($word),+],
            option_abouts: &[$(concat!($($option_about),+)),+],
            default: $name::$default as usize,
            get: |options| options.$axis as usize,
            set: |options, place| options.$axis = $name::ALL[place],
        }),+];
    };
}

accuracy! {
    /// How it is decided which samples a triangle covers.
    coverage: Coverage = "coverage", default Fixed8 {
        /// Edges in f32, every edge inclusive: samples on a shared edge are drawn twice.
        Float = "float",
        /// Edges in f32 with the top-left rule: rounding leaves holes and doubles.
        FloatTopLeft = "float-top-left",
        /// Exact edges between corners on 1/16 px.
        Fixed4 = "fixed4",
        /// Exact edges between corners on 1/256 px.
        Fixed8 = "fixed8",
        /// Exact edges between corners on 1/4096 px, in pictures of at most 2,047 px a side.
        Fixed12 = "fixed12",
    }
    /// In how many bits vertices say where they are, and from where they count.
    position_format: PositionFormat = "position_format", default Stored {
        /// 10 bits an axis, evenly spaced in the box of each primitive: 4 bytes a vertex, and cracks between neighbours.
        Packed10 = "packed10",
        /// 16 bits an axis of the same: 8 bytes a vertex.
        Packed16 = "packed16",
        /// As the file has them.
        Stored = "stored",
        /// The same relative to the eye, which is taken out in f64 first: what lies far from its origin keeps its places.
        Relative = "relative",
    }
    /// How vertices come to their place in the picture.
    vertex_transform: VertexTransform = "vertex_transform", default Snapped {
        /// Floats, with the viewport's shift in floats too, then snapped.
        Viewport = "viewport",
        /// Floats relative to the centre of the picture, snapped once.
        Snapped = "snapped",
        /// The same in integer arithmetic: the same bits on every adapter and on the CPU.
        Strict = "strict",
    }
    /// How joints hold the vertices of a skin together.
    skinning: Skinning = "skinning", default Linear {
        /// The mean of their matrices, as glTF has it: where they twist or bend apart, volume is lost.
        Linear = "linear",
        /// The mean of their motions as dual quaternions: lengths are kept, and nearly all of the volume.
        Dual = "dual",
    }
    /// How the flow of particles is derived from noise.
    curl_noise: CurlNoise = "curl_noise", default Analytic {
        /// From six values about a point.
        Difference = "difference",
        /// From the exact derivatives of the noise, which take one visit to its lattice.
        Analytic = "analytic",
    }
    /// How particles are kept from one step to the next.
    particle_storage: ParticleStorage = "particle_storage", default Float32 {
        /// Places as 16-bit shares of the room, velocities as halves: 16 bytes a particle.
        Half16 = "half16",
        /// All numbers as floats: 32 bytes a particle.
        Float32 = "float32",
    }
    /// What a depth is compared by.
    depth: DepthFormat = "depth", default Reversed {
        /// 16 bits, evenly spaced in normalized device depth.
        Ndc16 = "ndc16",
        /// 16 bits, evenly spaced in the (piecewise linear) logarithm of depth.
        Log16 = "log16",
        /// 24 bits of the same.
        Log24 = "log24",
        /// All 32 bits of a float that is 0 at the near plane, as most pictures had it for decades.
        Standard = "standard",
        /// All 32 bits of a float that is 1 at the near plane and 0 far away.
        Reversed = "reversed",
        /// The same from a quotient of integers: the same bits wherever the corners are the same.
        Integer = "integer",
    }
    /// Where depth and triangle id of a pixel meet.
    visibility: Visibility = "visibility", default Packed64 {
        /// Value loads and stores: samples that meet on a pixel lose each other.
        Race = "race",
        /// One 32-bit atomic per sample, for as much of the depth as the id leaves room for.
        Packed32 = "packed32",
        /// Portable: a depth pass, then an triangle id pass.
        Split32 = "split32",
        /// One 64-bit atomic per sample.
        Packed64 = "packed64",
        /// Portable: lists of triangles per tile, and an invocation that owns its pixel, without atomics on pixels.
        Tiled = "tiled",
    }
    /// How attributes run across a triangle.
    perspective: Perspective = "perspective", default Exact {
        /// Linear on the screen, as if every corner were equally far.
        Affine = "affine",
        /// Divided by w at every sample.
        Exact = "exact",
    }
    /// What becomes of triangles that reach before the near plane or beyond the guard band.
    clipping: Clipping = "clipping", default Exact {
        /// They are left out.
        Drop = "drop",
        /// Those that reach before the near plane are left out, the others are cut.
        Near = "near",
        /// They are cut, and what lies inside is drawn.
        Exact = "exact",
    }
    /// What is left out before it is set up, since it cannot be seen.
    culling: Culling = "culling", default None {
        /// Nothing: every triangle finds out by itself.
        None = "none",
        /// Instances and meshlets outside the picture, and meshlets that all face away.
        Frustum = "frustum",
        /// Those, and what lies behind the picture before this one: what has come out from behind it is missing.
        Hiz = "hiz",
        /// Those, and what lies behind this picture: first what was seen before is drawn, then what that does not hide.
        TwoPass = "two-pass",
    }
    /// How a draw order counts samples.
    sample_counter: SampleCounter = "sample_counter", default Prefix {
        /// Load, test, add, as a beginner's kernel does it: it overshoots.
        Racy = "racy",
        /// Prefix sums, or one ticket for each sample: exact.
        Prefix = "prefix",
    }
    /// How an x-ray adds up the layers of a pixel.
    xray_sums: XraySums = "xray_sums", default Four32 {
        /// Two words of two halves, channels of 8 bits: up to 257 layers that count alike.
        Packed16 = "packed16",
        /// Three words, channels of 8 bits: up to 4,095 layers that count alike.
        Three8 = "three8",
        /// Four words, channels of 8 to 16 bits: as many layers as the bits leave room for, with weights.
        Four32 = "four32",
    }
    /// How many pixels are drawn for one that is shown.
    render_scale: RenderScale = "render_scale", default Full {
        /// A sixteenth: a quarter to a side, and light in between.
        Quarter = "quarter",
        /// A quarter: half to a side, and light in between.
        Half = "half",
        /// One.
        Full = "full",
        /// Four, two to a side, and the mean of their light.
        Double = "double",
        /// Sixteen, four to a side, and the mean of their light.
        Quadruple = "quadruple",
    }
    /// How dots that nobody would see are left out.
    dot_culling: DotCulling = "dot_culling", default Gpu {
        /// They are not: every dot is placed and drawn.
        Brute = "brute",
        /// The CPU searches a tree of lines, and hands over the dots that may show.
        Cpu = "cpu",
        /// Lines are culled and thinned in compute, and what is left is drawn by an indirect dispatch.
        Gpu = "gpu",
    }
    /// How finely a shadow map samples what its light sees.
    shadow_map_size: ShadowMapSize = "shadow_map_size", default Side1024 {
        /// 256 texels a side.
        Side256 = "256",
        /// 512 texels a side.
        Side512 = "512",
        /// 1,024 texels a side.
        Side1024 = "1024",
        /// 2,048 texels a side.
        Side2048 = "2048",
        /// 4,096 texels a side.
        Side4096 = "4096",
    }
    /// How many texels of a shadow map tell how much of the light arrives.
    shadow_taps: ShadowTaps = "shadow_taps", default Nine {
        /// The one under the sample: edges as hard and as jagged as the map.
        One = "1",
        /// 3 by 3, their share smooth from texel to texel.
        Nine = "9",
        /// 5 by 5: softer edges.
        TwentyFive = "25",
    }
    /// How the effects' parameters reach the kernels.
    parameters: Parameters = "parameters", default Uniform {
        /// As constants in the text: a new text for every value.
        Baked = "baked",
        /// In a uniform buffer.
        Uniform = "uniform",
    }
    /// Whether the compiler adds checks to our kernels.
    shader_checks: ShaderChecks = "shader_checks", default Checked {
        /// None: loops and indices are trusted.
        Trusted = "trusted",
        /// Loops are bounded, indices clamped.
        Checked = "checked",
    }
}

impl Visibility {
    /// The options that lose nothing.
    pub const EXACT: [Self; 3] = [Self::Split32, Self::Packed64, Self::Tiled];

    /// Does it lose nothing?
    pub fn is_exact(self) -> bool {
        Self::EXACT.contains(&self)
    }

    /// Does an adapter with or without 64-bit atomics have it?
    pub fn is_there(self, int64_atomics: bool) -> bool {
        self != Self::Packed64 || int64_atomics
    }
}

impl PositionFormat {
    /// Bits of a packed lane; none where positions are as the file has them.
    pub const fn packed_bits(self) -> Option<u32> {
        match self {
            Self::Packed10 => Some(10),
            Self::Packed16 => Some(16),
            Self::Stored | Self::Relative => None,
        }
    }
}

impl RenderScale {
    /// Drawn pixels for one that is shown, along a side.
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
    /// Does it hold meshlets against depths that were drawn?
    pub const fn occludes(self) -> bool {
        matches!(self, Self::Hiz | Self::TwoPass)
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

    /// Layers that fit where they count alike, if that is a matter of the option alone.
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
    /// The option of an axis, by its place.
    pub fn get(&self, axis: &Axis) -> usize {
        (axis.get)(self)
    }

    /// Takes a option by its place, which must be one of the axis.
    pub fn set(&mut self, axis: &Axis, place: usize) {
        (axis.set)(self, place);
    }

    /// Axes that are not on their usual option, with the word they are on.
    pub fn non_default(&self) -> impl Iterator<Item = (&'static Axis, &'static str)> + use<> {
        let options = *self;
        AXES.iter()
            .map(move |axis| (axis, options.get(axis)))
            .filter(|(axis, place)| *place != axis.default)
            .map(|(axis, place)| (axis, axis.words[place]))
    }
}

/// AccuracyOptions that a preset pins: they beat its tier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct PinnedOptions([Option<u8>; AXES.len()]);

impl PinnedOptions {
    /// No axis pinned but the one of this option.
    pub fn of<R: AxisOption>(option: R) -> Self {
        Self::default().with(option)
    }

    #[must_use]
    pub fn with<R: AxisOption>(mut self, option: R) -> Self {
        self.0[R::AXIS] = Some(option.place() as u8);
        self
    }

    /// The pinned option of a type.
    pub fn option<R: AxisOption>(&self) -> Option<R> {
        self.0[R::AXIS].map(|place| R::at(place.into()))
    }

    /// Place of the pinned option of an axis.
    pub fn get(&self, axis: &Axis) -> Option<usize> {
        self.0[axis.index()].map(usize::from)
    }

    /// PinnedOptions an axis to the option at a place, or frees it.
    pub fn set(&mut self, axis: &Axis, place: Option<usize>) {
        self.0[axis.index()] = place.filter(|place| *place < axis.words.len()).map(|place| place as u8);
    }

    /// Puts every pinned axis of `options` on its pin.
    pub fn apply(&self, options: &mut AccuracyOptions) {
        for (axis, pin) in AXES.iter().zip(self.0) {
            if let Some(place) = pin {
                options.set(axis, place.into());
            }
        }
    }

    /// `coverage=float depth=log16`, or nothing.
    pub fn words(&self) -> String {
        let pinned = AXES.iter().zip(self.0).filter_map(|(axis, pin)| Some(format!("{}={}", axis.name, axis.words[usize::from(pin?)])));
        pinned.collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_reads_back_what_it_is_set_to() {
        for axis in AXES {
            assert_eq!((axis.words.len(), axis.default), (axis.option_abouts.len(), AccuracyOptions::default().get(axis)), "{}", axis.name);
            for place in 0..axis.words.len() {
                let (mut options, mut pins) = (AccuracyOptions::default(), PinnedOptions::default());
                pins.set(axis, Some(place));
                pins.apply(&mut options);
                assert_eq!((options.get(axis), pins.get(axis)), (place, Some(place)), "{}", axis.name);
                assert_eq!(options.non_default().count(), usize::from(place != axis.default), "{}", axis.name);
            }
        }
    }

    #[test]
    fn pins_know_rungs_by_type() {
        let pins = PinnedOptions::of(DepthFormat::Log16).with(Visibility::Split32);
        assert_eq!(
            (pins.option::<DepthFormat>(), pins.option::<Visibility>(), pins.option::<Coverage>()),
            (Some(DepthFormat::Log16), Some(Visibility::Split32), None)
        );
        assert_eq!(pins.words(), "depth=log16 visibility=split32");
    }
}
