//! Unary and binary operators.

use naga::{BinaryOperator, Expression, Handle, ScalarKind, UnaryOperator};

use super::{Lowering, Scope};
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;

impl<'m> Lowering<'m, '_> {
    pub(super) fn unary(
        &mut self,
        op: UnaryOperator,
        kind: ScalarKind,
        words: &Words,
    ) -> Result<Words, LowerError> {
        let op = match (op, kind) {
            (UnaryOperator::Negate, ScalarKind::Float) => Op::NegF,
            (UnaryOperator::Negate, ScalarKind::Sint) => Op::NegW,
            (UnaryOperator::LogicalNot, ScalarKind::Bool) => Op::NotB,
            (UnaryOperator::BitwiseNot, ScalarKind::Sint | ScalarKind::Uint) => Op::NotW,
            _ => return Err(self.invalid("an operator on a type that does not have it")),
        };
        self.map(op, words)
    }

    pub(super) fn binary(
        &mut self,
        scope: &mut Scope<'m>,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<Words, LowerError> {
        let kind = self.kind(scope, left)?;
        let a = self.words(scope, left)?;
        let b = self.words(scope, right)?;
        if op == BinaryOperator::Multiply {
            match (
                self.matrix_size(scope, left),
                self.matrix_size(scope, right),
            ) {
                (Some(m), Some((columns, _))) => return self.matrix_matrix(&a, m, &b, columns),
                (Some(m), None) if b.len() > 1 => return self.matrix_vector(&a, m, &b),
                (None, Some(m)) if a.len() > 1 => return self.vector_matrix(&a, &b, m),
                _ => {}
            }
        }
        let Some((op, is_swapped)) = instruction(op, kind) else {
            return Err(self.invalid("an operator on a type that does not have it"));
        };
        if is_swapped {
            self.zip(op, &b, &a)
        } else {
            self.zip(op, &a, &b)
        }
    }
}

/// The instruction, and whether it takes the operands the other way around.
fn instruction(op: BinaryOperator, kind: ScalarKind) -> Option<(Op, bool)> {
    use BinaryOperator as B;
    use ScalarKind::{Bool, Float, Sint, Uint};
    let op = match (op, kind) {
        (B::Add, Float) => Op::AddF,
        (B::Add, Sint | Uint) => Op::AddW,
        (B::Subtract, Float) => Op::SubF,
        (B::Subtract, Sint | Uint) => Op::SubW,
        (B::Multiply, Float) => Op::MulF,
        (B::Multiply, Sint | Uint) => Op::MulW,
        (B::Divide, Float) => Op::DivF,
        (B::Divide, Sint) => Op::DivI,
        (B::Divide, Uint) => Op::DivU,
        (B::Modulo, Float) => Op::RemF,
        (B::Modulo, Sint) => Op::RemI,
        (B::Modulo, Uint) => Op::RemU,
        (B::Equal, Float) => Op::EqF,
        (B::Equal, Sint | Uint | Bool) => Op::EqW,
        (B::NotEqual, Float) => Op::NeF,
        (B::NotEqual, Sint | Uint | Bool) => Op::NeW,
        (B::Less, Float) => Op::LtF,
        (B::Less, Sint) => Op::LtI,
        (B::Less, Uint) => Op::LtU,
        (B::LessEqual, Float) => Op::LeF,
        (B::LessEqual, Sint) => Op::LeI,
        (B::LessEqual, Uint) => Op::LeU,
        (B::Greater, Float) => return Some((Op::LtF, true)),
        (B::Greater, Sint) => return Some((Op::LtI, true)),
        (B::Greater, Uint) => return Some((Op::LtU, true)),
        (B::GreaterEqual, Float) => return Some((Op::LeF, true)),
        (B::GreaterEqual, Sint) => return Some((Op::LeI, true)),
        (B::GreaterEqual, Uint) => return Some((Op::LeU, true)),
        (B::And, Sint | Uint | Bool) | (B::LogicalAnd, Bool) => Op::AndW,
        (B::InclusiveOr, Sint | Uint | Bool) | (B::LogicalOr, Bool) => Op::OrW,
        (B::ExclusiveOr, Sint | Uint | Bool) => Op::XorW,
        (B::ShiftLeft, Sint | Uint) => Op::ShiftLeft,
        (B::ShiftRight, Sint) => Op::ShiftRightI,
        (B::ShiftRight, Uint) => Op::ShiftRightU,
        _ => return None,
    };
    Some((op, false))
}
