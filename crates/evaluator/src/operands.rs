//! Operands of expressions.

use naga::{Expression, Handle, MathFunction};

/// Calls `f` for each operand of an expression that can be lowered.
pub(crate) fn operands(expression: &Expression, mut f: impl FnMut(Handle<Expression>)) {
    match *expression {
        Expression::Compose { ref components, .. } => components.iter().copied().for_each(f),
        Expression::Access { base, index } => {
            f(base);
            f(index);
        }
        Expression::AccessIndex { base, .. } => f(base),
        Expression::Splat { value, .. } => f(value),
        Expression::Swizzle { vector, .. } => f(vector),
        Expression::Load { pointer } => f(pointer),
        Expression::Unary { expr, .. } | Expression::As { expr, .. } => f(expr),
        Expression::Binary { left, right, .. } => {
            f(left);
            f(right);
        }
        Expression::Select {
            condition,
            accept,
            reject,
        } => {
            f(condition);
            f(accept);
            f(reject);
        }
        Expression::Relational { argument, .. } => f(argument),
        Expression::Math {
            arg,
            arg1,
            arg2,
            arg3,
            ..
        } => {
            f(arg);
            [arg1, arg2, arg3].into_iter().flatten().for_each(f);
        }
        _ => {}
    }
}

/// May the value be made of the registers of its operands?
pub(crate) fn passes_operands_on(expression: &Expression) -> bool {
    match expression {
        Expression::Compose { .. }
        | Expression::Access { .. }
        | Expression::AccessIndex { .. }
        | Expression::Splat { .. }
        | Expression::Swizzle { .. }
        | Expression::Select { .. }
        | Expression::Relational { .. }
        | Expression::As { .. } => true,
        Expression::Math { fun, .. } => matches!(fun, MathFunction::Transpose | MathFunction::Abs),
        _ => false,
    }
}
