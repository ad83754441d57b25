//! One scalar of the shader, in 64 bits.

/// One scalar: a float as an f64, an integer in the low 32 bits, or a bool as 0 or 1. The type is
/// known from the function's signature.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Word(u64);

impl Word {
    pub const ZERO: Word = Word(0);

    pub const fn from_f64(value: f64) -> Word {
        Word(value.to_bits())
    }

    pub const fn from_u32(value: u32) -> Word {
        Word(value as u64)
    }

    pub const fn from_i32(value: i32) -> Word {
        Word(value.cast_unsigned() as u64)
    }

    pub const fn from_bool(value: bool) -> Word {
        Word(value as u64)
    }

    pub(crate) const fn from_bits(bits: u64) -> Word {
        Word(bits)
    }

    pub const fn to_f64(self) -> f64 {
        f64::from_bits(self.0)
    }

    pub const fn to_u32(self) -> u32 {
        self.0 as u32
    }

    pub const fn to_i32(self) -> i32 {
        (self.0 as u32).cast_signed()
    }

    pub const fn to_bool(self) -> bool {
        self.0 as u32 != 0
    }

    pub const fn to_bits(self) -> u64 {
        self.0
    }
}

impl std::fmt::Debug for Word {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Word({:#x} = {:?})", self.0, self.to_f64())
    }
}
