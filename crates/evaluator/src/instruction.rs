//! Instructions of the machine.

/// What an instruction does. Unless stated otherwise `d` is the register written and `a`, `b`, `c`
/// are registers read.
///
/// Suffixes: F float, U u32, I i32, W a word of either signedness or a bool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Op {
    // One operand.
    Move,
    NegF,
    AbsF,
    SignF,
    FloorF,
    CeilF,
    RoundF,
    TruncF,
    FractF,
    SaturateF,
    SqrtF,
    InverseSqrtF,
    SinF,
    CosF,
    TanF,
    AsinF,
    AcosF,
    AtanF,
    SinhF,
    CoshF,
    TanhF,
    AsinhF,
    AcoshF,
    AtanhF,
    ExpF,
    Exp2F,
    LogF,
    Log2F,
    RadiansF,
    DegreesF,
    ModfFractF,
    FrexpFractF,
    FrexpExponentF,
    QuantizeToF16,
    IsNanF,
    IsInfF,
    NotB,
    NegW,
    NotW,
    AbsI,
    SignI,
    LeadingZeros,
    TrailingZeros,
    OneBits,
    ReverseBits,
    FirstLeadingU,
    FirstLeadingI,
    FirstTrailing,
    IntFromFloat,
    UintFromFloat,
    FloatFromInt,
    FloatFromUint,
    BoolFromFloat,
    BoolFromWord,
    BitsFromFloat,
    FloatFromBits,
    Snorm8,
    Unorm8,
    Snorm16,
    Unorm16,
    Half,
    FromSnorm8,
    FromUnorm8,
    FromSnorm16,
    FromUnorm16,
    FromHalf,
    // Two operands.
    AddF,
    SubF,
    MulF,
    DivF,
    RemF,
    MinF,
    MaxF,
    PowF,
    Atan2F,
    StepF,
    LdexpF,
    EqF,
    NeF,
    LtF,
    LeF,
    EqW,
    NeW,
    LtU,
    LeU,
    LtI,
    LeI,
    AndW,
    OrW,
    XorW,
    AddW,
    SubW,
    MulW,
    DivU,
    DivI,
    RemU,
    RemI,
    MinU,
    MinI,
    MaxU,
    MaxI,
    ShiftLeft,
    ShiftRightU,
    ShiftRightI,
    /// Mask of `b` bits from bit `a` up, both limited to the word.
    BitMask,
    Dot4U,
    Dot4I,
    // Three operands.
    /// a * b + c, rounded after the product.
    MulAddF,
    /// a * b + c, rounded once.
    FmaF,
    MixF,
    SmoothStepF,
    ClampF,
    Select,
    ExtractBitsU,
    ExtractBitsI,
    // Memory and control: not pure, and some operands are immediate numbers.
    /// d = min(a, b) * c, where b and c are immediate: offset of a clamped index.
    ScaleIndex,
    /// `c` words from `a` to `d`.
    Copy,
    /// `c` words at `d` become the word in `a`.
    Fill,
    /// `c` words from register `a` + value of `b` to `d`.
    LoadIndexed,
    /// The same, where all words are alike in every sample.
    LoadTable,
    /// `c` words from `a` to register `d` + value of `b`.
    StoreIndexed,
    /// Function `d` of the host with `b` words of arguments at `a`, followed by `c` words of
    /// results.
    External,
    /// To instruction `d`.
    Jump,
    /// To instruction `d` if `a`.
    JumpIf,
    /// To instruction `d` unless `a`.
    JumpIfNot,
    /// To instruction `d` if the low 32 bits of `a` are the immediate `b`.
    JumpIfEqual,
    /// Back to instruction `d`; the loop's body counts as `b` steps.
    JumpBack,
}

impl Op {
    /// Depends only on its operands, and does nothing but write `d`.
    pub(crate) fn is_pure(self) -> bool {
        self < Op::ScaleIndex
    }

    /// Number of registers that a pure instruction reads.
    pub(crate) fn arity(self) -> usize {
        if self < Op::AddF {
            1
        } else if self < Op::MulAddF {
            2
        } else {
            3
        }
    }

    /// Does it compute a float of floats?
    pub(crate) fn makes_float(self) -> bool {
        matches!(
            self,
            Op::SqrtF
                | Op::InverseSqrtF
                | Op::LogF
                | Op::Log2F
                | Op::ExpF
                | Op::Exp2F
                | Op::PowF
                | Op::TanF
                | Op::AsinF
                | Op::AcosF
                | Op::AcoshF
                | Op::AtanhF
                | Op::Atan2F
                | Op::AddF
                | Op::SubF
                | Op::MulF
                | Op::DivF
                | Op::RemF
                | Op::MulAddF
                | Op::FmaF
                | Op::MinF
                | Op::MaxF
                | Op::ClampF
                | Op::SaturateF
                | Op::MixF
                | Op::SmoothStepF
                | Op::FractF
        )
    }

    /// Does WGSL leave open what it makes of these operands?
    pub(crate) fn is_open(self, operands: [f64; 3]) -> bool {
        let is_edge = match self {
            Op::PowF => operands[0] <= 0.0,
            Op::SmoothStepF => operands[0] == operands[1],
            _ => false,
        };
        is_edge || self.makes_float() && !operands.iter().all(|float| float.is_finite())
    }

    /// Is `d` the index of an instruction?
    pub(crate) fn is_jump(self) -> bool {
        self >= Op::Jump
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Instruction {
    pub op: Op,
    /// No sample that does not take part needs what is in `d`.
    pub is_free: bool,
    pub d: u32,
    pub a: u32,
    pub b: u32,
    pub c: u32,
}

impl Instruction {
    pub(crate) fn new(op: Op, d: u32, a: u32, b: u32, c: u32) -> Instruction {
        Instruction {
            op,
            is_free: false,
            d,
            a,
            b,
            c,
        }
    }

    /// Steps that one execution counts.
    pub(crate) fn weight(&self) -> u64 {
        match self.op {
            Op::Copy | Op::Fill | Op::LoadIndexed | Op::LoadTable | Op::StoreIndexed => {
                1 + u64::from(self.c) / 4
            }
            Op::External => 1 + u64::from(self.b) + u64::from(self.c),
            _ => 1,
        }
    }
}
