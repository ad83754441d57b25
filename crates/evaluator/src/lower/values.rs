//! Constants: literals, zero values, constants of the module and overrides.

use naga::{Expression, Handle, Literal, ScalarKind, Type, TypeInner};

use super::{Lowering, Scope, Value};
use crate::code::Words;
use crate::error::LowerError;
use crate::program::Precision;
use crate::word::Word;

impl<'m> Lowering<'m, '_> {
    /// Register with a constant.
    pub(super) fn constant(&mut self, word: Word) -> Result<u32, LowerError> {
        self.code.constant(word).map_err(|full| self.full(full))
    }

    pub(super) fn zero(&mut self, ty: Handle<Type>) -> Result<Words, LowerError> {
        let len = self.words_of(ty)?;
        // Zero of every kind has the same bits.
        let register = self.constant(Word::ZERO)?;
        Ok(if len == 1 {
            Words::one(register)
        } else {
            Words::Repeat { register, len }
        })
    }

    pub(super) fn literal(
        &mut self,
        literal: Literal,
        source: Option<std::ops::Range<usize>>,
    ) -> Result<Words, LowerError> {
        let word = match literal {
            Literal::F32(value) => Word::from_f64(self.decimal(value, source)),
            Literal::U32(value) => Word::from_u32(value),
            Literal::I32(value) => Word::from_i32(value),
            Literal::Bool(value) => Word::from_bool(value),
            // Expressions of the module may be abstract; functions only see them converted.
            Literal::AbstractInt(value) => Word::from_i32(value as i32),
            Literal::AbstractFloat(value) => Word::from_f64(value),
            Literal::F64(_) | Literal::F16(_) => {
                return Err(self.unsupported("floats of other than 32 bits"));
            }
            Literal::U16(_) | Literal::I16(_) | Literal::U64(_) | Literal::I64(_) => {
                return Err(self.unsupported("integers of other than 32 bits"));
            }
        };
        Ok(Words::one(self.constant(word)?))
    }

    /// The number that a literal means.
    fn decimal(&self, value: f32, source: Option<std::ops::Range<usize>>) -> f64 {
        if self.options.precision != Precision::Double {
            return f64::from(value);
        }
        // The text may also be an expression that naga computed, or the name of a constant.
        let text = source.and_then(|range| self.options.source?.get(range));
        if let Some(written) = text.and_then(written_number)
            && written as f32 == value
        {
            return written;
        }
        shortest(value)
    }

    pub(super) fn module_constant(
        &mut self,
        handle: Handle<naga::Constant>,
    ) -> Result<Words, LowerError> {
        if let Some(words) = self.constants.get(&handle) {
            return Ok(words.clone());
        }
        let words = self.global_words(self.module.constants[handle].init)?;
        self.constants.insert(handle, words.clone());
        Ok(words)
    }

    pub(super) fn override_words(
        &mut self,
        handle: Handle<naga::Override>,
    ) -> Result<Words, LowerError> {
        if let Some(words) = self.overrides.get(&handle) {
            return Ok(words.clone());
        }
        let constant = &self.module.overrides[handle];
        let name = constant.name.clone().unwrap_or_default();
        let number = constant.id.map(|id| id.to_string());
        let given = number
            .and_then(|number| self.options.overrides.get(&number))
            .or(self.options.overrides.get(&name));
        let words = match (given, constant.init) {
            (Some(&value), _) => {
                let TypeInner::Scalar(scalar) = self.module.types[constant.ty].inner else {
                    return Err(self.invalid("an override constant is not a scalar"));
                };
                let word = match scalar.kind {
                    ScalarKind::Bool => Word::from_bool(value != 0.0),
                    ScalarKind::Sint | ScalarKind::AbstractInt => Word::from_i32(value as i32),
                    ScalarKind::Uint => Word::from_u32(value as u32),
                    ScalarKind::Float | ScalarKind::AbstractFloat => match self.options.precision {
                        Precision::Double => Word::from_f64(value),
                        _ => Word::from_f64(f64::from(value as f32)),
                    },
                };
                Words::one(self.constant(word)?)
            }
            (None, Some(init)) => self.global_words(init)?,
            (None, None) => return Err(LowerError::Override { name }),
        };
        self.overrides.insert(handle, words.clone());
        Ok(words)
    }

    /// Words of an expression of the module.
    pub(super) fn global_words(&mut self, handle: Handle<Expression>) -> Result<Words, LowerError> {
        let empty = Scope::new(
            &self.module.global_expressions,
            self.global.types.clone(),
            None,
        );
        let mut scope = std::mem::replace(&mut self.global, empty);
        let words = self.words(&mut scope, handle);
        self.global.values = scope.values;
        words
    }

    /// Value of an expression; one that no statement emits is lowered when it is first needed.
    pub(super) fn value(
        &mut self,
        scope: &mut Scope<'m>,
        handle: Handle<Expression>,
    ) -> Result<Value, LowerError> {
        if let Some(Some(value)) = scope.values.get(handle.index()) {
            return Ok(value.clone());
        }
        let before = self.code.instructions.len();
        let value = self.expression(scope, handle)?;
        // What took instructions may be needed again where they have not been executed.
        if self.code.instructions.len() == before {
            scope.values[handle.index()] = Some(value.clone());
        }
        Ok(value)
    }

    pub(super) fn words(
        &mut self,
        scope: &mut Scope<'m>,
        handle: Handle<Expression>,
    ) -> Result<Words, LowerError> {
        match self.value(scope, handle)? {
            Value::Words(words) => Ok(words),
            Value::Place(_) => Err(self.unsupported("a pointer as a value")),
        }
    }
}

/// The shortest decimal number that names an f32.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Number that a decimal literal of WGSL is.
fn written_number(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_decimal = text.bytes().all(|byte| {
        byte.is_ascii_digit() || matches!(byte, b'.' | b'e' | b'E' | b'+' | b'-' | b'f')
    });
    if !is_decimal {
        return None;
    }
    text.strip_suffix('f').unwrap_or(text).parse().ok()
}
