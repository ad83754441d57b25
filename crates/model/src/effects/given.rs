//! What an effect is given beside its parameters: words that no one sets, such as the time.

use crate::params::WgslType;

/// A member of an effect's struct that the lab fills in for every picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenMember {
    pub name: String,
    /// Byte offset in the struct.
    pub offset: usize,
    pub given: Given,
}

/// What a member holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// Seconds of the clock.
    Seconds,
    /// The part of the clock's range that has passed, 0 to 1.
    Loop,
    /// Sixtieths of a second since the begin of the range.
    Frame,
    /// Width and height of the picture, pixels.
    Width,
    Height,
    /// Where the eye is, world space.
    Eye,
    /// Where it looks: unit length, world space.
    Forward,
    /// Where the pointer is over the picture: pixels to the right and down, and 1; elsewhere the
    /// middle of the picture, and 0.
    Pointer,
}

impl Given {
    pub const ALL: [Self; 8] = [
        Self::Seconds,
        Self::Loop,
        Self::Frame,
        Self::Width,
        Self::Height,
        Self::Eye,
        Self::Forward,
        Self::Pointer,
    ];

    /// The word in `@given(word)`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Seconds => "seconds",
            Self::Loop => "loop",
            Self::Frame => "frame",
            Self::Width => "width",
            Self::Height => "height",
            Self::Eye => "eye",
            Self::Forward => "forward",
            Self::Pointer => "pointer",
        }
    }

    /// The type of such a member.
    pub const fn wgsl(self) -> WgslType {
        match self {
            Self::Seconds | Self::Loop => WgslType::F32,
            Self::Frame | Self::Width | Self::Height => WgslType::U32,
            Self::Eye | Self::Forward | Self::Pointer => WgslType::Vec4F32,
        }
    }

    /// Does it change while the clock runs?
    pub const fn is_of_clock(self) -> bool {
        matches!(self, Self::Seconds | Self::Loop | Self::Frame)
    }
}

/// The moment and the place of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    pub time_s: f64,
    /// Begin and end of the clock.
    pub range_s: [f64; 2],
}

impl Moment {
    /// The words of what is given of the clock; none of anything else.
    pub fn words(&self, given: Given) -> Option<Vec<u32>> {
        let [from_s, to_s] = self.range_s;
        let passed_s = self.time_s - from_s;
        Some(vec![match given {
            Given::Seconds => (self.time_s as f32).to_bits(),
            Given::Loop => ((passed_s / (to_s - from_s)).clamp(0.0, 1.0) as f32).to_bits(),
            Given::Frame => (60.0 * passed_s).round().max(0.0) as u32,
            _ => return None,
        }])
    }
}

/// The words of a picture of this size, seen from `eye` towards `forward`, without a pointer; none
/// of the clock.
pub fn words_of_view(
    given: Given,
    [width, height]: [u32; 2],
    eye: glam::DVec3,
    forward: glam::DVec3,
) -> Option<Vec<u32>> {
    let middle = || [width, height].map(|side| side as f32 / 2.0);
    let of_vector = |v: glam::DVec3| {
        v.as_vec3()
            .extend(0.0)
            .to_array()
            .map(f32::to_bits)
            .to_vec()
    };
    Some(match given {
        Given::Width => vec![width],
        Given::Height => vec![height],
        Given::Eye => of_vector(eye),
        Given::Forward => of_vector(forward),
        Given::Pointer => words_of_pointer(middle(), false),
        _ => return None,
    })
}

/// The words of a pointer at a place in pixels.
pub fn words_of_pointer([x, y]: [f32; 2], is_there: bool) -> Vec<u32> {
    let is_there = f32::from(u8::from(is_there));
    [x, y, is_there, 0.0].map(f32::to_bits).to_vec()
}
