//! Built-in functions.

use naga::{Expression, Handle, MathFunction, ScalarKind};

use super::{Lowering, Scope};
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;

/// Shape of a built-in function that works on each component for itself.
enum Componentwise {
    One(Op),
    Two(Op),
    Three(Op),
    /// The value as it is.
    Same,
    /// The larger of the first two arguments, and the smaller of that and the third.
    Clamp(Op, Op),
}

impl<'m> Lowering<'m, '_> {
    pub(super) fn math(
        &mut self,
        scope: &mut Scope<'m>,
        fun: MathFunction,
        arguments: [Option<Handle<Expression>>; 4],
    ) -> Result<Words, LowerError> {
        let Some(first) = arguments[0] else {
            return Err(self.invalid("a built-in function without arguments"));
        };
        let kind = self.kind(scope, first)?;
        let matrix = self.matrix_size(scope, first);
        let mut given = Vec::with_capacity(4);
        for argument in arguments.into_iter().flatten() {
            given.push(self.words(scope, argument)?);
        }
        let argument = |index: usize| given.get(index).cloned().unwrap_or(Words::none());
        let (a, b, c) = (argument(0), argument(1), argument(2));
        let needed = match fun {
            MathFunction::InsertBits => 4,
            _ => 1,
        };
        if given.len() < needed {
            return Err(self.invalid("a built-in function with too few arguments"));
        }
        if let Some(shape) = componentwise(fun, kind) {
            return match shape {
                Componentwise::One(op) => self.map(op, &a),
                Componentwise::Same => Ok(a),
                Componentwise::Two(op) if given.len() >= 2 => self.zip(op, &a, &b),
                Componentwise::Three(op) if given.len() >= 3 => self.zip3(op, &a, &b, &c),
                Componentwise::Clamp(least, most) if given.len() >= 3 => {
                    let raised = self.zip(least, &a, &b)?;
                    self.zip(most, &raised, &c)
                }
                _ => Err(self.invalid("a built-in function with too few arguments")),
            };
        }
        match (fun, matrix) {
            (MathFunction::Transpose, Some(size)) => Ok(self.transpose(&a, size)),
            (MathFunction::Determinant, Some((size, _))) => {
                Ok(Words::one(self.determinant(&a, size)?))
            }
            (MathFunction::Inverse, Some((size, _))) => self.inverse(&a, size),
            (MathFunction::Modf, _) => self.pair(Op::ModfFractF, Op::TruncF, &a),
            (MathFunction::Frexp, _) => self.pair(Op::FrexpFractF, Op::FrexpExponentF, &a),
            (MathFunction::Dot, _) => Ok(Words::one(self.dot(kind, &a, &b)?)),
            (MathFunction::Outer, _) => self.outer(&a, &b),
            (MathFunction::Cross, _) => self.cross(&a, &b),
            (MathFunction::Distance, _) => Ok(Words::one(self.distance(&a, &b)?)),
            (MathFunction::Length, _) => Ok(Words::one(self.length(&a)?)),
            (MathFunction::Normalize, _) => self.normalize(&a),
            (MathFunction::FaceForward, _) => self.face_forward(&a, &b, &c),
            (MathFunction::Reflect, _) => self.reflect(&a, &b),
            (MathFunction::Refract, _) => self.refract(&a, &b, c.at(0)),
            (MathFunction::InsertBits, _) => self.insert_bits(&a, &b, c.at(0), argument(3).at(0)),
            _ => self.packing(fun, &a),
        }
    }

    /// First results of all components, then second results.
    fn pair(&mut self, first: Op, second: Op, words: &Words) -> Result<Words, LowerError> {
        let first = self.map(first, words)?;
        let second = self.map(second, words)?;
        Ok(first.iter().chain(second.iter()).collect())
    }

    fn insert_bits(
        &mut self,
        word: &Words,
        bits: &Words,
        offset: u32,
        count: u32,
    ) -> Result<Words, LowerError> {
        let mask = self.two(Op::BitMask, offset, count)?;
        let rest = self.one(Op::NotW, mask)?;
        let kept = self.zip(Op::AndW, word, &Words::one(rest))?;
        let shifted = self.zip(Op::ShiftLeft, bits, &Words::one(offset))?;
        let inserted = self.zip(Op::AndW, &shifted, &Words::one(mask))?;
        self.zip(Op::OrW, &kept, &inserted)
    }

    fn packing(&mut self, fun: MathFunction, a: &Words) -> Result<Words, LowerError> {
        match fun {
            MathFunction::Pack4x8snorm => self.pack(Some(Op::Snorm8), a, 8),
            MathFunction::Pack4x8unorm => self.pack(Some(Op::Unorm8), a, 8),
            MathFunction::Pack2x16snorm => self.pack(Some(Op::Snorm16), a, 16),
            MathFunction::Pack2x16unorm => self.pack(Some(Op::Unorm16), a, 16),
            MathFunction::Pack2x16float => self.pack(Some(Op::Half), a, 16),
            MathFunction::Pack4xI8 | MathFunction::Pack4xU8 => self.pack(None, a, 8),
            MathFunction::Pack4xI8Clamp => {
                let (low, high) = (self.integer((-128i32).cast_unsigned())?, self.integer(127)?);
                let raised = self.zip(Op::MaxI, a, &Words::one(low))?;
                let limited = self.zip(Op::MinI, &raised, &Words::one(high))?;
                self.pack(None, &limited, 8)
            }
            MathFunction::Pack4xU8Clamp => {
                let high = self.integer(255)?;
                let limited = self.zip(Op::MinU, a, &Words::one(high))?;
                self.pack(None, &limited, 8)
            }
            MathFunction::Unpack4x8snorm => self.unpack(Some(Op::FromSnorm8), false, a.at(0), 8),
            MathFunction::Unpack4x8unorm => self.unpack(Some(Op::FromUnorm8), false, a.at(0), 8),
            MathFunction::Unpack2x16snorm => self.unpack(Some(Op::FromSnorm16), false, a.at(0), 16),
            MathFunction::Unpack2x16unorm => self.unpack(Some(Op::FromUnorm16), false, a.at(0), 16),
            MathFunction::Unpack2x16float => self.unpack(Some(Op::FromHalf), false, a.at(0), 16),
            MathFunction::Unpack4xI8 => self.unpack(None, true, a.at(0), 8),
            MathFunction::Unpack4xU8 => self.unpack(None, false, a.at(0), 8),
            _ => Err(self.unsupported(&format!("`{fun:?}` of this type"))),
        }
    }

    /// One word from lanes of so many bits, the first lowest.
    fn pack(&mut self, op: Option<Op>, lanes: &Words, bits: u32) -> Result<Words, LowerError> {
        let mut packed = self.integer(0)?;
        let mask = self.integer((1 << bits) - 1)?;
        for (index, lane) in lanes.iter().enumerate() {
            let word = match op {
                Some(op) => self.one(op, lane)?,
                None => self.two(Op::AndW, lane, mask)?,
            };
            let shift = self.integer(index as u32 * bits)?;
            let shifted = self.two(Op::ShiftLeft, word, shift)?;
            packed = self.two(Op::OrW, packed, shifted)?;
        }
        Ok(Words::one(packed))
    }

    fn unpack(
        &mut self,
        op: Option<Op>,
        is_signed: bool,
        word: u32,
        bits: u32,
    ) -> Result<Words, LowerError> {
        let width = self.integer(bits)?;
        let extract = if is_signed {
            Op::ExtractBitsI
        } else {
            Op::ExtractBitsU
        };
        (0..32 / bits)
            .map(|index| {
                let offset = self.integer(index * bits)?;
                let lane = self.three(extract, word, offset, width)?;
                op.map_or(Ok(lane), |op| self.one(op, lane))
            })
            .collect()
    }
}

fn componentwise(fun: MathFunction, kind: ScalarKind) -> Option<Componentwise> {
    use Componentwise::{Clamp, One, Same, Three, Two};
    use MathFunction as M;
    let is_float = kind == ScalarKind::Float;
    let is_signed = kind == ScalarKind::Sint;
    let by_kind = |float: Op, signed: Op, unsigned: Op| match kind {
        ScalarKind::Float => float,
        ScalarKind::Sint => signed,
        _ => unsigned,
    };
    Some(match fun {
        M::Abs if is_float => One(Op::AbsF),
        M::Abs if is_signed => One(Op::AbsI),
        M::Abs => Same,
        M::Min => Two(by_kind(Op::MinF, Op::MinI, Op::MinU)),
        M::Max => Two(by_kind(Op::MaxF, Op::MaxI, Op::MaxU)),
        M::Clamp if is_float => Three(Op::ClampF),
        M::Clamp if is_signed => Clamp(Op::MaxI, Op::MinI),
        M::Clamp => Clamp(Op::MaxU, Op::MinU),
        M::Saturate => One(Op::SaturateF),
        M::Cos => One(Op::CosF),
        M::Cosh => One(Op::CoshF),
        M::Sin => One(Op::SinF),
        M::Sinh => One(Op::SinhF),
        M::Tan => One(Op::TanF),
        M::Tanh => One(Op::TanhF),
        M::Acos => One(Op::AcosF),
        M::Asin => One(Op::AsinF),
        M::Atan => One(Op::AtanF),
        M::Atan2 => Two(Op::Atan2F),
        M::Asinh => One(Op::AsinhF),
        M::Acosh => One(Op::AcoshF),
        M::Atanh => One(Op::AtanhF),
        M::Radians => One(Op::RadiansF),
        M::Degrees => One(Op::DegreesF),
        M::Ceil => One(Op::CeilF),
        M::Floor => One(Op::FloorF),
        M::Round => One(Op::RoundF),
        M::Fract => One(Op::FractF),
        M::Trunc => One(Op::TruncF),
        M::Ldexp => Two(Op::LdexpF),
        M::Exp => One(Op::ExpF),
        M::Exp2 => One(Op::Exp2F),
        M::Log => One(Op::LogF),
        M::Log2 => One(Op::Log2F),
        M::Pow => Two(Op::PowF),
        M::Dot4I8Packed => Two(Op::Dot4I),
        M::Dot4U8Packed => Two(Op::Dot4U),
        M::Sign if is_signed => One(Op::SignI),
        M::Sign if is_float => One(Op::SignF),
        M::Fma => Three(Op::FmaF),
        M::Mix => Three(Op::MixF),
        M::Step => Two(Op::StepF),
        M::SmoothStep => Three(Op::SmoothStepF),
        M::Sqrt => One(Op::SqrtF),
        M::InverseSqrt => One(Op::InverseSqrtF),
        M::QuantizeToF16 => One(Op::QuantizeToF16),
        M::CountTrailingZeros => One(Op::TrailingZeros),
        M::CountLeadingZeros => One(Op::LeadingZeros),
        M::CountOneBits => One(Op::OneBits),
        M::ReverseBits => One(Op::ReverseBits),
        M::ExtractBits if is_signed => Three(Op::ExtractBitsI),
        M::ExtractBits => Three(Op::ExtractBitsU),
        M::FirstTrailingBit => One(Op::FirstTrailing),
        M::FirstLeadingBit if is_signed => One(Op::FirstLeadingI),
        M::FirstLeadingBit => One(Op::FirstLeadingU),
        _ => return None,
    })
}
