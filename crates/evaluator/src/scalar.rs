//! The pure instructions: one result from up to three words.

use crate::float::{
    clamp, fma, frexp, from_half, ldexp, mix, normalized, round, sign, smooth_step, to_half,
    to_i32, to_u32,
};
use crate::instruction::Op;
use crate::word::Word;

/// The words that an instruction reads, and where its results go: of one sample or of many.
pub(crate) trait Operands: Sized {
    /// Writes what `f` makes of the operands of every sample.
    fn each(self, f: impl Fn(Word, Word, Word) -> Word);

    /// The same with a function that takes long.
    fn each_slowly(self, f: impl Fn(Word, Word, Word) -> Word) {
        self.each(f);
    }

    #[inline(always)]
    fn floats(self, f: impl Fn(f64, f64, f64) -> f64) {
        self.each(|a, b, c| Word::from_f64(f(a.to_f64(), b.to_f64(), c.to_f64())));
    }

    #[inline(always)]
    fn slow(self, f: impl Fn(f64, f64) -> f64) {
        self.each_slowly(|a, b, _| Word::from_f64(f(a.to_f64(), b.to_f64())));
    }

    #[inline(always)]
    fn compare(self, f: impl Fn(f64, f64) -> bool) {
        self.each(|a, b, _| Word::from_bool(f(a.to_f64(), b.to_f64())));
    }

    #[inline(always)]
    fn words(self, f: impl Fn(u32, u32, u32) -> u32) {
        self.each(|a, b, c| Word::from_u32(f(a.to_u32(), b.to_u32(), c.to_u32())));
    }

    #[inline(always)]
    fn whole(self, f: impl Fn(i32, i32) -> i32) {
        self.each(|a, b, _| Word::from_i32(f(a.to_i32(), b.to_i32())));
    }

    #[inline(always)]
    fn bits(self, f: impl Fn(f64) -> u32) {
        self.each_slowly(|a, _, _| Word::from_u32(f(a.to_f64())));
    }

    #[inline(always)]
    fn float_of(self, f: impl Fn(u32) -> f64) {
        self.each(|a, _, _| Word::from_f64(f(a.to_u32())));
    }
}

/// The operands of one sample.
pub(crate) struct One<'a>(pub [Word; 3], pub &'a mut Word);

impl Operands for One<'_> {
    #[inline(always)]
    fn each(self, f: impl Fn(Word, Word, Word) -> Word) {
        let [a, b, c] = self.0;
        *self.1 = f(a, b, c);
    }
}

/// Executes a pure instruction.
#[inline(always)]
pub(crate) fn evaluate<const SINGLE: bool>(op: Op, o: impl Operands) {
    let r = round::<SINGLE>;
    match op {
        Op::Move => o.each(|a, _, _| a),
        Op::NegF => o.floats(|a, _, _| -a),
        Op::AbsF => o.floats(|a, _, _| a.abs()),
        Op::SignF => o.floats(|a, _, _| sign(a)),
        Op::FloorF => o.floats(|a, _, _| a.floor()),
        Op::CeilF => o.floats(|a, _, _| a.ceil()),
        Op::RoundF => o.floats(|a, _, _| a.round_ties_even()),
        Op::TruncF => o.floats(|a, _, _| a.trunc()),
        Op::FractF => o.floats(|a, _, _| r(a - a.floor())),
        Op::SaturateF => o.floats(|a, _, _| clamp(a, 0.0, 1.0)),
        Op::SqrtF => o.floats(|a, _, _| r(a.sqrt())),
        Op::InverseSqrtF => o.floats(|a, _, _| r(1.0 / a.sqrt())),
        Op::SinF => o.slow(|a, _| r(libm::sin(a))),
        Op::CosF => o.slow(|a, _| r(libm::cos(a))),
        Op::TanF => o.slow(|a, _| r(libm::tan(a))),
        Op::AsinF => o.slow(|a, _| r(libm::asin(a))),
        Op::AcosF => o.slow(|a, _| r(libm::acos(a))),
        Op::AtanF => o.slow(|a, _| r(libm::atan(a))),
        Op::SinhF => o.slow(|a, _| r(libm::sinh(a))),
        Op::CoshF => o.slow(|a, _| r(libm::cosh(a))),
        Op::TanhF => o.slow(|a, _| r(libm::tanh(a))),
        Op::AsinhF => o.slow(|a, _| r(libm::asinh(a))),
        // libm's is not NaN below 1.
        Op::AcoshF => o.slow(|a, _| r(if a < 1.0 { f64::NAN } else { libm::acosh(a) })),
        Op::AtanhF => o.slow(|a, _| r(libm::atanh(a))),
        Op::ExpF => o.slow(|a, _| r(libm::exp(a))),
        Op::Exp2F => o.slow(|a, _| r(libm::exp2(a))),
        Op::LogF => o.slow(|a, _| r(libm::log(a))),
        Op::Log2F => o.slow(|a, _| r(libm::log2(a))),
        Op::RadiansF => o.floats(|a, _, _| r(a.to_radians())),
        Op::DegreesF => o.floats(|a, _, _| r(a.to_degrees())),
        Op::ModfFractF => o.slow(|a, _| {
            r(if a.is_infinite() {
                0.0f64.copysign(a)
            } else {
                a - a.trunc()
            })
        }),
        Op::FrexpFractF => o.slow(|a, _| frexp(a).0),
        Op::FrexpExponentF => o.bits(|a| frexp(a).1.cast_unsigned()),
        Op::QuantizeToF16 => o.slow(|a, _| from_half(to_half(a))),
        Op::IsNanF => o.compare(|a, _| a.is_nan()),
        Op::IsInfF => o.compare(|a, _| a.is_infinite()),
        Op::NotB => o.words(|a, _, _| u32::from(a == 0)),
        Op::NegW => o.words(|a, _, _| a.wrapping_neg()),
        Op::NotW => o.words(|a, _, _| !a),
        Op::AbsI => o.whole(|a, _| a.wrapping_abs()),
        Op::SignI => o.whole(|a, _| a.signum()),
        Op::LeadingZeros => o.words(|a, _, _| a.leading_zeros()),
        Op::TrailingZeros => o.words(|a, _, _| a.trailing_zeros()),
        Op::OneBits => o.words(|a, _, _| a.count_ones()),
        Op::ReverseBits => o.words(|a, _, _| a.reverse_bits()),
        // All bits set where there is none.
        Op::FirstLeadingU => o.words(|a, _, _| 31u32.wrapping_sub(a.leading_zeros())),
        Op::FirstLeadingI => o.whole(|a, _| 31 - (a ^ (a >> 31)).leading_zeros().cast_signed()),
        Op::FirstTrailing => o.words(|a, _, _| if a == 0 { u32::MAX } else { a.trailing_zeros() }),
        Op::IntFromFloat => o.bits(|a| to_i32(a).cast_unsigned()),
        Op::UintFromFloat => o.bits(to_u32),
        Op::FloatFromInt => o.float_of(|a| r(f64::from(a.cast_signed()))),
        Op::FloatFromUint => o.float_of(|a| r(f64::from(a))),
        Op::BoolFromFloat => o.compare(|a, _| a != 0.0),
        Op::BoolFromWord => o.words(|a, _, _| u32::from(a != 0)),
        Op::BitsFromFloat => o.bits(|a| (a as f32).to_bits()),
        Op::FloatFromBits => o.float_of(|a| f64::from(f32::from_bits(a))),
        Op::Snorm8 => o.bits(|a| normalized(a, -1.0, 127.0).cast_unsigned() & 0xff),
        Op::Unorm8 => o.bits(|a| normalized(a, 0.0, 255.0).cast_unsigned()),
        Op::Snorm16 => o.bits(|a| normalized(a, -1.0, 32767.0).cast_unsigned() & 0xffff),
        Op::Unorm16 => o.bits(|a| normalized(a, 0.0, 65535.0).cast_unsigned()),
        Op::Half => o.bits(to_half),
        Op::FromSnorm8 => o.float_of(|a| r((f64::from(a as u8 as i8) / 127.0).max(-1.0))),
        Op::FromUnorm8 => o.float_of(|a| r(f64::from(a as u8) / 255.0)),
        Op::FromSnorm16 => o.float_of(|a| r((f64::from(a as u16 as i16) / 32767.0).max(-1.0))),
        Op::FromUnorm16 => o.float_of(|a| r(f64::from(a as u16) / 65535.0)),
        Op::FromHalf => o.float_of(from_half),
        Op::AddF => o.floats(|a, b, _| r(a + b)),
        Op::SubF => o.floats(|a, b, _| r(a - b)),
        Op::MulF => o.floats(|a, b, _| r(a * b)),
        Op::DivF => o.floats(|a, b, _| r(a / b)),
        Op::RemF => o.slow(|a, b| r(a % b)),
        Op::MinF => o.floats(|a, b, _| a.min(b)),
        Op::MaxF => o.floats(|a, b, _| a.max(b)),
        Op::PowF => o.slow(|a, b| r(libm::pow(a, b))),
        Op::Atan2F => o.slow(|a, b| r(libm::atan2(a, b))),
        Op::StepF => o.floats(|a, b, _| if a <= b { 1.0 } else { 0.0 }),
        Op::LdexpF => {
            o.each_slowly(|a, b, _| Word::from_f64(r(ldexp(a.to_f64(), b.to_i32()))));
        }
        Op::EqF => o.compare(|a, b| a == b),
        Op::NeF => o.compare(|a, b| a != b),
        Op::LtF => o.compare(|a, b| a < b),
        Op::LeF => o.compare(|a, b| a <= b),
        Op::EqW => o.words(|a, b, _| u32::from(a == b)),
        Op::NeW => o.words(|a, b, _| u32::from(a != b)),
        Op::LtU => o.words(|a, b, _| u32::from(a < b)),
        Op::LeU => o.words(|a, b, _| u32::from(a <= b)),
        Op::LtI => o.whole(|a, b| i32::from(a < b)),
        Op::LeI => o.whole(|a, b| i32::from(a <= b)),
        Op::AndW => o.words(|a, b, _| a & b),
        Op::OrW => o.words(|a, b, _| a | b),
        Op::XorW => o.words(|a, b, _| a ^ b),
        Op::AddW => o.words(|a, b, _| a.wrapping_add(b)),
        Op::SubW => o.words(|a, b, _| a.wrapping_sub(b)),
        Op::MulW => o.words(|a, b, _| a.wrapping_mul(b)),
        Op::DivU => o.words(|a, b, _| a.checked_div(b).unwrap_or(a)),
        Op::DivI => o.whole(|a, b| if b == 0 { a } else { a.wrapping_div(b) }),
        Op::RemU => o.words(|a, b, _| a.checked_rem(b).unwrap_or(0)),
        Op::RemI => o.whole(|a, b| if b == 0 { 0 } else { a.wrapping_rem(b) }),
        Op::MinU => o.words(|a, b, _| a.min(b)),
        Op::MinI => o.whole(|a, b| a.min(b)),
        Op::MaxU => o.words(|a, b, _| a.max(b)),
        Op::MaxI => o.whole(|a, b| a.max(b)),
        Op::ShiftLeft => o.words(|a, b, _| a.wrapping_shl(b)),
        Op::ShiftRightU => o.words(|a, b, _| a.wrapping_shr(b)),
        Op::ShiftRightI => o.whole(|a, b| a.wrapping_shr(b.cast_unsigned())),
        Op::BitMask => o.words(|a, b, _| bit_mask(a, b)),
        Op::Dot4U => {
            o.words(|a, b, _| (0..4).map(|byte| lane(a, byte) * lane(b, byte)).sum());
        }
        Op::Dot4I => o.words(|a, b, _| {
            (0..4)
                .map(|byte| signed_lane(a, byte) * signed_lane(b, byte))
                .sum::<i32>()
                .cast_unsigned()
        }),
        Op::MulAddF => o.floats(|a, b, c| r(r(a * b) + c)),
        Op::FmaF => {
            o.each_slowly(|a, b, c| {
                Word::from_f64(fma::<SINGLE>(a.to_f64(), b.to_f64(), c.to_f64()))
            });
        }
        Op::MixF => o.floats(mix::<SINGLE>),
        Op::SmoothStepF => o.floats(smooth_step::<SINGLE>),
        Op::ClampF => o.floats(clamp),
        Op::Select => o.each(|a, b, c| if a.to_bool() { b } else { c }),
        Op::ExtractBitsU => o.words(extract_bits),
        Op::ExtractBitsI => o.words(|a, b, c| {
            let count = c.min(32 - b.min(32));
            let unused = 32 - count;
            let bits = extract_bits(a, b, count);
            if count == 0 {
                0
            } else {
                ((bits << unused).cast_signed() >> unused).cast_unsigned()
            }
        }),
        Op::ScaleIndex
        | Op::Copy
        | Op::Fill
        | Op::LoadIndexed
        | Op::LoadTable
        | Op::StoreIndexed
        | Op::External
        | Op::Jump
        | Op::JumpIf
        | Op::JumpIfNot
        | Op::JumpIfEqual
        | Op::JumpBack => {}
    }
}
fn bit_mask(offset: u32, count: u32) -> u32 {
    let offset = offset.min(32);
    let count = count.min(32 - offset);
    (((1u64 << count) - 1) << offset) as u32
}

fn extract_bits(word: u32, offset: u32, count: u32) -> u32 {
    let offset = offset.min(32);
    ((u64::from(word) >> offset) as u32) & bit_mask(0, count.min(32 - offset))
}

fn lane(word: u32, byte: u32) -> u32 {
    (word >> (8 * byte)) & 0xff
}

fn signed_lane(word: u32, byte: u32) -> i32 {
    i32::from((word >> (8 * byte)) as u8 as i8)
}
