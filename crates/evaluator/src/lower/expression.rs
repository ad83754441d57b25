//! Expressions other than built-in functions.

use naga::{Expression, Handle, RelationalFunction, ScalarKind, SwizzleComponent, TypeInner};

use super::{Lowering, Place, Scope, Value};
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;
use crate::word::Word;

impl<'m> Lowering<'m, '_> {
    pub(super) fn expression(
        &mut self,
        scope: &mut Scope<'m>,
        handle: Handle<Expression>,
    ) -> Result<Value, LowerError> {
        let expressions = scope.expressions;
        let words = match expressions[handle] {
            Expression::FunctionArgument(index) => {
                let argument = scope.arguments.get(index as usize).cloned();
                return argument.ok_or_else(|| self.invalid("an argument is missing"));
            }
            Expression::LocalVariable(local) => {
                let base = scope.locals.get(local.index()).copied();
                let Some(base) = base else {
                    return Err(self.invalid("a local variable outside of its function"));
                };
                return Ok(Value::Place(Place {
                    base,
                    offset: None,
                    is_writable: true,
                }));
            }
            Expression::GlobalVariable(global) => return Ok(Value::Place(self.variable(global)?)),
            Expression::AccessIndex { base, index } => return self.part(scope, base, index),
            Expression::Access { base, index } => return self.element(scope, base, index),
            Expression::Literal(literal) => {
                self.literal(literal, expressions.get_span(handle).to_range())?
            }
            Expression::Constant(constant) => self.module_constant(constant)?,
            Expression::Override(constant) => self.override_words(constant)?,
            Expression::ZeroValue(ty) => self.zero(ty)?,
            Expression::Compose { ty, ref components } => {
                let len = self.words_of(ty)?;
                let mut list = Vec::new();
                for &component in components {
                    list.extend(self.words(scope, component)?.iter());
                }
                self.code.count(len).map_err(|full| self.full(full))?;
                if list.len() != len as usize {
                    return Err(
                        self.invalid("a value is composed of parts that do not make up its type")
                    );
                }
                list.into_iter().collect()
            }
            Expression::Splat { size, value } => {
                let register = self.words(scope, value)?.at(0);
                Words::Repeat {
                    register,
                    len: size as u32,
                }
            }
            Expression::Swizzle {
                size,
                vector,
                pattern,
            } => {
                let vector = self.words(scope, vector)?;
                pattern
                    .iter()
                    .take(size as usize)
                    .map(|component| vector.at(component_index(*component)))
                    .collect()
            }
            Expression::Load { pointer } => self.load(scope, handle, pointer)?,
            Expression::Unary { op, expr } => {
                let kind = self.kind(scope, expr)?;
                let words = self.words(scope, expr)?;
                self.unary(op, kind, &words)?
            }
            Expression::Binary { op, left, right } => self.binary(scope, op, left, right)?,
            Expression::Select {
                condition,
                accept,
                reject,
            } => {
                let condition = self.words(scope, condition)?;
                let accept = self.words(scope, accept)?;
                let reject = self.words(scope, reject)?;
                self.select(&condition, &accept, &reject)?
            }
            Expression::Relational { fun, argument } => {
                let words = self.words(scope, argument)?;
                self.relational(fun, &words)?
            }
            Expression::Math {
                fun,
                arg,
                arg1,
                arg2,
                arg3,
            } => {
                let arguments = [Some(arg), arg1, arg2, arg3];
                self.math(scope, fun, arguments)?
            }
            Expression::As {
                expr,
                kind,
                convert,
            } => {
                let from = self.kind(scope, expr)?;
                let words = self.words(scope, expr)?;
                if convert.is_some_and(|width| width != 4 && kind != ScalarKind::Bool) {
                    return Err(self.unsupported("scalars of other than 32 bits"));
                }
                self.convert(&words, from, kind, convert.is_none())?
            }
            Expression::CallResult(_) => {
                return Err(self.invalid("the result of a call is used before the call"));
            }
            Expression::Derivative { .. } => return Err(self.unsupported("a derivative")),
            Expression::ImageSample { .. }
            | Expression::ImageLoad { .. }
            | Expression::ImageQuery { .. } => {
                return Err(self.unsupported("a texture"));
            }
            Expression::ArrayLength(_) => return Err(self.unsupported("`arrayLength`")),
            Expression::AtomicResult { .. } => return Err(self.unsupported("an atomic")),
            Expression::WorkGroupUniformLoadResult { .. } => {
                return Err(self.unsupported("`workgroupUniformLoad`"));
            }
            Expression::RayQueryVertexPositions { .. }
            | Expression::RayQueryProceedResult
            | Expression::RayQueryGetIntersection { .. } => {
                return Err(self.unsupported("ray tracing"));
            }
            Expression::SubgroupBallotResult | Expression::SubgroupOperationResult { .. } => {
                return Err(self.unsupported("an operation of subgroups"));
            }
            Expression::CooperativeLoad { .. } | Expression::CooperativeMultiplyAdd { .. } => {
                return Err(self.unsupported("a cooperative matrix"));
            }
        };
        Ok(Value::Words(words))
    }

    /// Kind of the scalars of an expression.
    pub(super) fn kind(
        &mut self,
        scope: &Scope<'m>,
        handle: Handle<Expression>,
    ) -> Result<ScalarKind, LowerError> {
        match scope.inner(self.module, handle).scalar_kind() {
            Some(ScalarKind::AbstractFloat) => Ok(ScalarKind::Float),
            Some(ScalarKind::AbstractInt) => Ok(ScalarKind::Sint),
            Some(kind) => Ok(kind),
            None => Err(self.invalid("a value of scalars is expected")),
        }
    }

    pub(super) fn one(&mut self, op: Op, a: u32) -> Result<u32, LowerError> {
        self.code.one(op, a).map_err(|full| self.full(full))
    }

    pub(super) fn two(&mut self, op: Op, a: u32, b: u32) -> Result<u32, LowerError> {
        self.code.two(op, a, b).map_err(|full| self.full(full))
    }

    pub(super) fn three(&mut self, op: Op, a: u32, b: u32, c: u32) -> Result<u32, LowerError> {
        self.code.pure(op, a, b, c).map_err(|full| self.full(full))
    }

    /// An instruction on every component.
    pub(super) fn map(&mut self, op: Op, words: &Words) -> Result<Words, LowerError> {
        words.iter().map(|a| self.one(op, a)).collect()
    }

    /// An instruction on the components of two vectors, or of a vector and a scalar.
    pub(super) fn zip(&mut self, op: Op, a: &Words, b: &Words) -> Result<Words, LowerError> {
        (0..a.len().max(b.len()))
            .map(|index| self.two(op, a.at(index), b.at(index)))
            .collect()
    }

    pub(super) fn zip3(
        &mut self,
        op: Op,
        a: &Words,
        b: &Words,
        c: &Words,
    ) -> Result<Words, LowerError> {
        let len = a.len().max(b.len()).max(c.len());
        (0..len)
            .map(|index| self.three(op, a.at(index), b.at(index), c.at(index)))
            .collect()
    }

    pub(super) fn select(
        &mut self,
        condition: &Words,
        accept: &Words,
        reject: &Words,
    ) -> Result<Words, LowerError> {
        if condition.len() == 1
            && let Some(known) = self.code.known(condition.at(0))
        {
            return Ok(if known.to_bool() {
                accept.clone()
            } else {
                reject.clone()
            });
        }
        self.zip3(Op::Select, condition, accept, reject)
    }

    fn relational(&mut self, fun: RelationalFunction, words: &Words) -> Result<Words, LowerError> {
        let op = match fun {
            RelationalFunction::IsNan => return self.map(Op::IsNanF, words),
            RelationalFunction::IsInf => return self.map(Op::IsInfF, words),
            RelationalFunction::All => Op::AndW,
            RelationalFunction::Any => Op::OrW,
        };
        let mut sum = words.at(0);
        for word in words.iter().skip(1) {
            sum = self.two(op, sum, word)?;
        }
        Ok(Words::one(sum))
    }

    fn convert(
        &mut self,
        words: &Words,
        from: ScalarKind,
        to: ScalarKind,
        is_bitcast: bool,
    ) -> Result<Words, LowerError> {
        use ScalarKind::{Bool, Float, Sint, Uint};
        let op = match (from, to) {
            (Float, Float) | (Bool, Bool) | (Sint | Uint, Sint | Uint) => return Ok(words.clone()),
            (Float, Sint | Uint) if is_bitcast => Op::BitsFromFloat,
            (Sint | Uint, Float) if is_bitcast => Op::FloatFromBits,
            (Float, Sint) => Op::IntFromFloat,
            (Float, Uint) => Op::UintFromFloat,
            (Sint, Float) => Op::FloatFromInt,
            (Uint | Bool, Float) => Op::FloatFromUint,
            // A bool is 0 or 1.
            (Bool, Sint | Uint) => return Ok(words.clone()),
            (Float, Bool) => Op::BoolFromFloat,
            (Sint | Uint, Bool) => Op::BoolFromWord,
            _ => return Err(self.invalid("a conversion between kinds that have none")),
        };
        self.map(op, words)
    }

    /// Register with a float constant.
    pub(super) fn float(&mut self, value: f64) -> Result<u32, LowerError> {
        self.constant(Word::from_f64(value))
    }

    /// Register with an integer constant.
    pub(super) fn integer(&mut self, value: u32) -> Result<u32, LowerError> {
        self.constant(Word::from_u32(value))
    }

    /// Columns and rows, if an expression is a matrix.
    pub(super) fn matrix_size(
        &self,
        scope: &Scope<'m>,
        handle: Handle<Expression>,
    ) -> Option<(u32, u32)> {
        match *scope.inner(self.module, handle) {
            TypeInner::Matrix { columns, rows, .. } => Some((columns as u32, rows as u32)),
            _ => None,
        }
    }
}

fn component_index(component: SwizzleComponent) -> u32 {
    match component {
        SwizzleComponent::X => 0,
        SwizzleComponent::Y => 1,
        SwizzleComponent::Z => 2,
        SwizzleComponent::W => 3,
    }
}
