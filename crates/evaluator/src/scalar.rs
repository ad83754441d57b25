//! The pure instructions: one result from up to three words.

use crate::float::{
    clamp, fma, frexp, from_half, ldexp, mix, normalized, round, sign, smooth_step, to_half,
    to_i32, to_u32,
};
use crate::instruction::Op;
use crate::word::Word;

/// Result of a pure instruction. The operands are read on demand, so that each reads only its own.
#[inline(always)]
pub(crate) fn evaluate<const SINGLE: bool>(
    op: Op,
    a: impl Fn() -> Word,
    b: impl Fn() -> Word,
    c: impl Fn() -> Word,
) -> Word {
    let f = |x: f64| Word::from_f64(round::<SINGLE>(x));
    // For results that need no rounding.
    let exact = Word::from_f64;
    let (u, i, t) = (Word::from_u32, Word::from_i32, Word::from_bool);
    let af = || a().to_f64();
    let bf = || b().to_f64();
    let cf = || c().to_f64();
    let au = || a().to_u32();
    let bu = || b().to_u32();
    let ai = || a().to_i32();
    let bi = || b().to_i32();
    match op {
        Op::Move => a(),
        Op::NegF => exact(-af()),
        Op::AbsF => exact(af().abs()),
        Op::SignF => exact(sign(af())),
        Op::FloorF => exact(af().floor()),
        Op::CeilF => exact(af().ceil()),
        Op::RoundF => exact(af().round_ties_even()),
        Op::TruncF => exact(af().trunc()),
        Op::FractF => f(af() - af().floor()),
        Op::SaturateF => exact(clamp(af(), 0.0, 1.0)),
        Op::SqrtF => f(af().sqrt()),
        Op::InverseSqrtF => f(1.0 / af().sqrt()),
        Op::SinF => f(libm::sin(af())),
        Op::CosF => f(libm::cos(af())),
        Op::TanF => f(libm::tan(af())),
        Op::AsinF => f(libm::asin(af())),
        Op::AcosF => f(libm::acos(af())),
        Op::AtanF => f(libm::atan(af())),
        Op::SinhF => f(libm::sinh(af())),
        Op::CoshF => f(libm::cosh(af())),
        Op::TanhF => f(libm::tanh(af())),
        Op::AsinhF => f(libm::asinh(af())),
        // libm's is not NaN below 1.
        Op::AcoshF => f(if af() < 1.0 {
            f64::NAN
        } else {
            libm::acosh(af())
        }),
        Op::AtanhF => f(libm::atanh(af())),
        Op::ExpF => f(libm::exp(af())),
        Op::Exp2F => f(libm::exp2(af())),
        Op::LogF => f(libm::log(af())),
        Op::Log2F => f(libm::log2(af())),
        Op::RadiansF => f(af().to_radians()),
        Op::DegreesF => f(af().to_degrees()),
        Op::ModfFractF => f(if af().is_infinite() {
            0.0f64.copysign(af())
        } else {
            af() - af().trunc()
        }),
        Op::FrexpFractF => exact(frexp(af()).0),
        Op::FrexpExponentF => i(frexp(af()).1),
        Op::QuantizeToF16 => exact(from_half(to_half(af()))),
        Op::IsNanF => t(af().is_nan()),
        Op::IsInfF => t(af().is_infinite()),
        Op::NotB => t(!a().to_bool()),
        Op::NegW => i(ai().wrapping_neg()),
        Op::NotW => u(!au()),
        Op::AbsI => i(ai().wrapping_abs()),
        Op::SignI => i(ai().signum()),
        Op::LeadingZeros => u(au().leading_zeros()),
        Op::TrailingZeros => u(au().trailing_zeros()),
        Op::OneBits => u(au().count_ones()),
        Op::ReverseBits => u(au().reverse_bits()),
        // All bits set where there is none.
        Op::FirstLeadingU => u(31u32.wrapping_sub(au().leading_zeros())),
        Op::FirstLeadingI => u(31u32.wrapping_sub((ai() ^ (ai() >> 31)).leading_zeros())),
        Op::FirstTrailing => u(if au() == 0 {
            u32::MAX
        } else {
            au().trailing_zeros()
        }),
        Op::IntFromFloat => i(to_i32::<SINGLE>(af())),
        Op::UintFromFloat => u(to_u32::<SINGLE>(af())),
        Op::FloatFromInt => f(f64::from(ai())),
        Op::FloatFromUint => f(f64::from(au())),
        Op::BoolFromFloat => t(af() != 0.0),
        Op::BoolFromWord => t(au() != 0),
        Op::BitsFromFloat => u((af() as f32).to_bits()),
        Op::FloatFromBits => exact(f64::from(f32::from_bits(au()))),
        Op::Snorm8 => u(normalized(af(), -1.0, 127.0).cast_unsigned() & 0xff),
        Op::Unorm8 => u(normalized(af(), 0.0, 255.0).cast_unsigned()),
        Op::Snorm16 => u(normalized(af(), -1.0, 32767.0).cast_unsigned() & 0xffff),
        Op::Unorm16 => u(normalized(af(), 0.0, 65535.0).cast_unsigned()),
        Op::Half => u(to_half(af())),
        Op::FromSnorm8 => f((f64::from(au() as u8 as i8) / 127.0).max(-1.0)),
        Op::FromUnorm8 => f(f64::from(au() as u8) / 255.0),
        Op::FromSnorm16 => f((f64::from(au() as u16 as i16) / 32767.0).max(-1.0)),
        Op::FromUnorm16 => f(f64::from(au() as u16) / 65535.0),
        Op::FromHalf => exact(from_half(au())),
        Op::AddF => f(af() + bf()),
        Op::SubF => f(af() - bf()),
        Op::MulF => f(af() * bf()),
        Op::DivF => f(af() / bf()),
        Op::RemF => f(af() % bf()),
        Op::MinF => exact(af().min(bf())),
        Op::MaxF => exact(af().max(bf())),
        Op::PowF => f(libm::pow(af(), bf())),
        Op::Atan2F => f(libm::atan2(af(), bf())),
        Op::StepF => exact(if af() <= bf() { 1.0 } else { 0.0 }),
        Op::LdexpF => f(ldexp(af(), bi())),
        Op::EqF => t(af() == bf()),
        Op::NeF => t(af() != bf()),
        Op::LtF => t(af() < bf()),
        Op::LeF => t(af() <= bf()),
        Op::EqW => t(au() == bu()),
        Op::NeW => t(au() != bu()),
        Op::LtU => t(au() < bu()),
        Op::LeU => t(au() <= bu()),
        Op::LtI => t(ai() < bi()),
        Op::LeI => t(ai() <= bi()),
        Op::AndW => u(au() & bu()),
        Op::OrW => u(au() | bu()),
        Op::XorW => u(au() ^ bu()),
        Op::AddW => u(au().wrapping_add(bu())),
        Op::SubW => u(au().wrapping_sub(bu())),
        Op::MulW => u(au().wrapping_mul(bu())),
        Op::DivU => u(au().checked_div(bu()).unwrap_or(au())),
        Op::DivI => i(if bi() == 0 {
            ai()
        } else {
            ai().wrapping_div(bi())
        }),
        Op::RemU => u(au().checked_rem(bu()).unwrap_or(0)),
        Op::RemI => i(if bi() == 0 {
            0
        } else {
            ai().wrapping_rem(bi())
        }),
        Op::MinU => u(au().min(bu())),
        Op::MinI => i(ai().min(bi())),
        Op::MaxU => u(au().max(bu())),
        Op::MaxI => i(ai().max(bi())),
        Op::ShiftLeft => u(au().wrapping_shl(bu())),
        Op::ShiftRightU => u(au().wrapping_shr(bu())),
        Op::ShiftRightI => i(ai().wrapping_shr(bu())),
        Op::BitMask => u(bit_mask(au(), bu())),
        Op::Dot4U => u((0..4).map(|byte| lane(au(), byte) * lane(bu(), byte)).sum()),
        Op::Dot4I => i((0..4)
            .map(|byte| signed_lane(au(), byte) * signed_lane(bu(), byte))
            .sum()),
        Op::MulAddF => f(round::<SINGLE>(af() * bf()) + cf()),
        Op::FmaF => exact(fma::<SINGLE>(af(), bf(), cf())),
        Op::MixF => exact(mix::<SINGLE>(af(), bf(), cf())),
        Op::SmoothStepF => exact(smooth_step::<SINGLE>(af(), bf(), cf())),
        Op::ClampF => exact(clamp(af(), bf(), cf())),
        Op::Select => {
            if a().to_bool() {
                b()
            } else {
                c()
            }
        }
        Op::ExtractBitsU => u(extract_bits(au(), bu(), c().to_u32())),
        Op::ExtractBitsI => {
            let count = c().to_u32().min(32 - bu().min(32));
            let unused = 32 - count;
            let bits = extract_bits(au(), bu(), count);
            i(if count == 0 {
                0
            } else {
                (bits << unused).cast_signed() >> unused
            })
        }
        Op::ScaleIndex
        | Op::Copy
        | Op::Fill
        | Op::LoadIndexed
        | Op::StoreIndexed
        | Op::External
        | Op::Jump
        | Op::JumpIf
        | Op::JumpIfNot
        | Op::JumpIfEqual
        | Op::JumpBack => Word::ZERO,
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
