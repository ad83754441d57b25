//! Parameters: one table per effect feeds sliders, preset keys, `--set`, help, layout test and uniform bytes.
//!
//! [`params!`](crate::params!) declares a struct of 4-byte words exactly as WGSL lays it out, and beside it a table of
//! [`Field`]s. Values travel as plain words (`Vec<u32>`), so the rest of the program needs no type per effect.

use std::ops::RangeInclusive;

/// What a field holds, and so which widget, TOML form and WGSL type it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// WGSL `f32`.
    F32,
    /// WGSL `u32`.
    U32,
    /// WGSL `i32`.
    I32,
    /// WGSL `u32`, 0 or 1.
    Bool,
    /// WGSL `u32`, the index of a name.
    Choice(&'static [&'static str]),
    /// WGSL `vec4f`: linear RGBA.
    Color,
    /// WGSL `vec4f`: a point in world space in metres, the fourth lane unused.
    Point,
}

impl Kind {
    /// Number of 4-byte words.
    pub const fn words(self) -> usize {
        match self {
            Self::Color | Self::Point => 4,
            _ => 1,
        }
    }

    /// Lanes that a person sees and a preset holds.
    pub const fn lanes(self) -> usize {
        match self {
            Self::Color => 4,
            Self::Point => 3,
            _ => 1,
        }
    }

    /// Name of the type in WGSL.
    pub const fn wgsl(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::I32 => "i32",
            Self::U32 | Self::Bool | Self::Choice(_) => "u32",
            Self::Color | Self::Point => "vec4<f32>",
        }
    }

    const fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::Color | Self::Point)
    }
}

/// One parameter: all that any surface of the program needs to know about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Stable name: preset key, WGSL member, `--set` path. Renaming needs a migration.
    pub name: &'static str,
    /// Tooltip and help text.
    pub doc: &'static str,
    pub kind: Kind,
    /// Byte offset in the struct, on both sides.
    pub offset: usize,
    /// What the kernel survives; files and `--set` outside it are errors.
    pub hard: [f64; 2],
    /// What the slider spans.
    pub soft: [f64; 2],
    /// Unit shown after the value, empty when a plain number.
    pub unit: &'static str,
    /// The slider moves in decades.
    pub log: bool,
    /// Shown only while the choice field of this name has one of these values.
    pub when: Option<(&'static str, &'static [&'static str])>,
}

impl Field {
    pub const fn new(name: &'static str, doc: &'static str, kind: Kind, offset: usize) -> Self {
        let (hard, soft) = match kind {
            Kind::F32 | Kind::Point => ([-1e6, 1e6], [-1.0, 1.0]),
            Kind::Color => ([0.0, 1.0], [0.0, 1.0]),
            Kind::U32 => ([0.0, 4_294_967_295.0], [0.0, 100.0]),
            Kind::I32 => ([-2_147_483_648.0, 2_147_483_647.0], [-100.0, 100.0]),
            Kind::Bool => ([0.0, 1.0], [0.0, 1.0]),
            Kind::Choice(names) => ([0.0, (names.len() - 1) as f64], [0.0, (names.len() - 1) as f64]),
        };
        Self { name, doc, kind, offset, hard, soft, unit: "", log: false, when: None }
    }

    pub const fn hard(mut self, range: RangeInclusive<f64>) -> Self {
        self.hard = [*range.start(), *range.end()];
        self.soft = self.hard;
        self
    }

    pub const fn soft(mut self, range: RangeInclusive<f64>) -> Self {
        self.soft = [*range.start(), *range.end()];
        self
    }

    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    pub const fn log(mut self, log: bool) -> Self {
        self.log = log;
        self
    }

    /// Only shown while choice `field` is one of `values`.
    pub const fn when(mut self, condition: (&'static str, &'static [&'static str])) -> Self {
        self.when = Some(condition);
        self
    }

    fn first_word(&self) -> usize {
        self.offset / 4
    }

    /// Lane values as a person sees them; a choice is its index, a bool 0 or 1.
    pub fn get(&self, words: &[u32]) -> Vec<f64> {
        words[self.first_word()..][..self.kind.lanes()]
            .iter()
            .map(|&word| match self.kind {
                k if k.is_float() => f64::from(f32::from_bits(word)),
                Kind::I32 => f64::from(word as i32),
                _ => f64::from(word),
            })
            .collect()
    }

    /// Does it hold whole numbers alone?
    pub const fn is_whole(&self) -> bool {
        !self.kind.is_float()
    }

    /// Writes lane values. Refuses, with the allowed range in words, what is not finite, not whole where it must
    /// be, or outside the hard range; then nothing is changed.
    pub fn set(&self, words: &mut [u32], values: &[f64]) -> Result<(), ValueError> {
        if values.len() != self.kind.lanes() {
            return Err(ValueError::Lanes { field: self.name, wanted: self.kind.lanes(), found: values.len() });
        }
        let [low, high] = self.hard;
        for &value in values {
            if !(low..=high).contains(&value) {
                return Err(ValueError::Range { field: self.name, value, low, high });
            }
            if !self.kind.is_float() && value.fract() != 0.0 {
                return Err(ValueError::Whole { field: self.name, value });
            }
        }
        for (word, &value) in words[self.first_word()..].iter_mut().zip(values) {
            *word = match self.kind {
                k if k.is_float() => (value as f32).to_bits(),
                Kind::I32 => value as i32 as u32,
                _ => value as u32,
            };
        }
        Ok(())
    }

    /// Do both hold the same bits in this field?
    pub fn same(&self, a: &[u32], b: &[u32]) -> bool {
        let range = self.first_word()..self.first_word() + self.kind.words();
        a[range.clone()] == b[range]
    }

    /// Copies this field's bits.
    pub fn copy(&self, from: &[u32], to: &mut [u32]) {
        let range = self.first_word()..self.first_word() + self.kind.words();
        to[range.clone()].copy_from_slice(&from[range]);
    }

    /// Is the field worth showing for these values?
    pub fn is_shown(&self, fields: &[Field], words: &[u32]) -> bool {
        self.when.is_none_or(|(name, allowed)| {
            fields.iter().find(|f| f.name == name).is_some_and(|f| match f.kind {
                Kind::Choice(names) => names.get(words[f.first_word()] as usize).is_some_and(|n| allowed.contains(n)),
                _ => true,
            })
        })
    }
}

/// A value that a field refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    #[error("{field} {value} lies outside {low}..={high}")]
    Range { field: &'static str, value: f64, low: f64, high: f64 },
    #[error("{field} {value} must be a whole number")]
    Whole { field: &'static str, value: f64 },
    #[error("{field} needs {wanted} numbers, {found} given")]
    Lanes { field: &'static str, wanted: usize, found: usize },
}

/// A type that can stand in a `params!` declaration.
pub trait ParamType {
    /// What the struct stores.
    type Raw: bytemuck::Pod + PartialEq + std::fmt::Debug;
    const KIND: Kind;
}

impl ParamType for f32 {
    type Raw = f32;
    const KIND: Kind = Kind::F32;
}

impl ParamType for u32 {
    type Raw = u32;
    const KIND: Kind = Kind::U32;
}

impl ParamType for i32 {
    type Raw = i32;
    const KIND: Kind = Kind::I32;
}

/// An on/off parameter, stored as 0 or 1.
pub enum Flag {}

impl ParamType for Flag {
    type Raw = u32;
    const KIND: Kind = Kind::Bool;
}

/// A linear RGBA parameter.
pub enum Color {}

impl ParamType for Color {
    type Raw = [f32; 4];
    const KIND: Kind = Kind::Color;
}

/// A world-space point parameter.
pub enum Point {}

impl ParamType for Point {
    type Raw = [f32; 4];
    const KIND: Kind = Kind::Point;
}

/// A struct declared by [`params!`](crate::params!).
pub trait Params: bytemuck::Pod + Default {
    const FIELDS: &'static [Field];
}

/// Declares a choice: an enum whose names are the preset's words and, upper-cased, WGSL constants.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$vmeta:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u32)]
        pub enum $name { $($(#[$vmeta])* $variant),+ }

        impl $name {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The choice with this index; out of range (which no checked value is) gives the first.
            pub fn of(index: u32) -> Self {
                Self::ALL.get(index as usize).copied().unwrap_or(Self::ALL[0])
            }
        }

        impl $crate::params::ParamType for $name {
            type Raw = u32;
            const KIND: $crate::params::Kind = $crate::params::Kind::Choice(&[$($word),+]);
        }
    };
}

/// Declares a parameter struct: a doc line, a type, a default and options per field.
#[macro_export]
macro_rules! params {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[doc = $doc:literal])+ $field:ident : $ty:ty = $default:expr $(, $key:ident $value:expr)*;)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct $name { $($(#[doc = $doc])+ pub $field: <$ty as $crate::params::ParamType>::Raw,)* }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default),* }
            }
        }

        impl $crate::params::Params for $name {
            const FIELDS: &'static [$crate::params::Field] = &[$(
                $crate::params::Field::new(
                    stringify!($field),
                    concat!($($doc),+),
                    <$ty as $crate::params::ParamType>::KIND,
                    std::mem::offset_of!($name, $field),
                )$(.$key($value))*
            ),*];
        }
    };
}
