//! Variables, pointers, loads and stores.

use naga::{AddressSpace, Expression, GlobalVariable, Handle, StorageAccess, TypeInner};

use super::{Lowering, Place, Scope, Value};
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;

impl<'m> Lowering<'m, '_> {
    /// Registers of a module-scope variable.
    pub(super) fn variable(&mut self, handle: Handle<GlobalVariable>) -> Result<Place, LowerError> {
        if let Some(&place) = self.variables.get(&handle) {
            return Ok(place);
        }
        let variable = &self.module.global_variables[handle];
        let name = variable.name.clone().unwrap_or_default();
        let supplied = self
            .options
            .globals
            .iter()
            .position(|global| *global == name);
        let is_private = variable.space == AddressSpace::Private;
        let is_read_only = match variable.space {
            AddressSpace::Uniform | AddressSpace::Immediate => true,
            AddressSpace::Storage { access } => !access.contains(StorageAccess::STORE),
            _ => false,
        };
        if !is_private && (supplied.is_none() || matches!(variable.space, AddressSpace::Handle)) {
            return Err(LowerError::Global {
                name,
                function: self.function_name(),
                span: self.location.span.to_range(),
            });
        }
        if !is_private && !is_read_only {
            return Err(self.unsupported(&format!("`{name}`, which can be written,")));
        }
        let len = self.words_of(variable.ty)?;
        let base = self.allocate(len)?;
        if let Some(index) = supplied {
            self.supplied[index] = Some(base as usize..(base + len) as usize);
        }
        let mut place = Place {
            base,
            offset: None,
            is_writable: is_private,
        };
        if is_private {
            let first = match (supplied, variable.init) {
                (Some(_), _) => {
                    // The function works on a copy, so that every call begins with the same value.
                    place.base = self.allocate(len)?;
                    Words::Range { start: base, len }
                }
                (None, Some(init)) => self.global_words(init)?,
                (None, None) => self.zero(variable.ty)?,
            };
            let body = std::mem::take(&mut self.code.instructions);
            let copied = self.copy(place.base, &first);
            let start = std::mem::replace(&mut self.code.instructions, body);
            copied?;
            self.prologue.extend(start);
        }
        self.variables.insert(handle, place);
        Ok(place)
    }

    pub(super) fn load(
        &mut self,
        scope: &mut Scope<'m>,
        handle: Handle<Expression>,
        pointer: Handle<Expression>,
    ) -> Result<Words, LowerError> {
        let place = self.place(scope, pointer)?;
        let inner = self
            .layout
            .pointee(scope.inner(self.module, pointer))
            .into_owned();
        let len = self
            .layout
            .words(&inner)
            .map_err(|reason| self.no_layout(reason))?;
        let words = Words::Range {
            start: place.base,
            len,
        };
        if let Some(offset) = place.offset {
            let d = self.allocate(len)?;
            self.code
                .push(Op::LoadIndexed, d, place.base, offset, len)
                .map_err(|full| self.full(full))?;
            return Ok(Words::Range { start: d, len });
        }
        let is_copied = scope
            .facts
            .as_ref()
            .is_some_and(|facts| facts.copied[handle.index()]);
        if !is_copied || !place.is_writable {
            return Ok(words);
        }
        let d = self.allocate(len)?;
        self.copy(d, &words)?;
        Ok(Words::Range { start: d, len })
    }

    pub(super) fn store(
        &mut self,
        scope: &mut Scope<'m>,
        pointer: Handle<Expression>,
        words: &Words,
    ) -> Result<(), LowerError> {
        let place = self.place(scope, pointer)?;
        if !place.is_writable {
            return Err(self.unsupported("a store to a variable of the host"));
        }
        let Some(offset) = place.offset else {
            return self.copy(place.base, words);
        };
        let from = self.adjacent(words)?;
        self.code
            .push(Op::StoreIndexed, place.base, from, offset, words.len())
            .map_err(|full| self.full(full))
    }

    fn place(
        &mut self,
        scope: &mut Scope<'m>,
        pointer: Handle<Expression>,
    ) -> Result<Place, LowerError> {
        match self.value(scope, pointer)? {
            Value::Place(place) => Ok(place),
            Value::Words(_) => Err(self.invalid("a value is used as a pointer")),
        }
    }

    pub(super) fn adjacent(&mut self, words: &Words) -> Result<u32, LowerError> {
        self.code.adjacent(words).map_err(|full| self.full(full))
    }

    /// Part `index` of a value or of what a pointer leads to.
    pub(super) fn part(
        &mut self,
        scope: &mut Scope<'m>,
        base: Handle<Expression>,
        index: u32,
    ) -> Result<Value, LowerError> {
        let value = self.value(scope, base)?;
        let inner = self
            .layout
            .pointee(scope.inner(self.module, base))
            .into_owned();
        let (offset, words) = self
            .layout
            .part(&inner, index)
            .map_err(|reason| self.no_layout(reason))?;
        Ok(match value {
            Value::Words(all) => Value::Words(all.slice(offset, words)),
            Value::Place(place) => Value::Place(Place {
                base: place.base + offset,
                ..place
            }),
        })
    }

    /// Element of a value or of what a pointer leads to, the last one for an index beyond.
    pub(super) fn element(
        &mut self,
        scope: &mut Scope<'m>,
        base: Handle<Expression>,
        index: Handle<Expression>,
    ) -> Result<Value, LowerError> {
        let value = self.value(scope, base)?;
        let index = self.words(scope, index)?.at(0);
        let inner = self
            .layout
            .pointee(scope.inner(self.module, base))
            .into_owned();
        let (count, stride) = self.elements(&inner)?;
        if let Some(known) = self.code.known(index) {
            let offset = known.to_u32().min(count.saturating_sub(1)) * stride;
            return Ok(match value {
                Value::Words(all) => Value::Words(all.slice(offset, stride)),
                Value::Place(place) => Value::Place(Place {
                    base: place.base + offset,
                    ..place
                }),
            });
        }
        let mut offset = self.allocate(1)?;
        let pushed = self.code.push(
            Op::ScaleIndex,
            offset,
            index,
            count.saturating_sub(1),
            stride,
        );
        pushed.map_err(|full| self.full(full))?;
        match value {
            Value::Words(all) => {
                let from = self.adjacent(&all)?;
                self.code.indexed.push(from..from + all.len());
                let d = self.allocate(stride)?;
                self.code
                    .push(Op::LoadIndexed, d, from, offset, stride)
                    .map_err(|full| self.full(full))?;
                Ok(Value::Words(Words::Range {
                    start: d,
                    len: stride,
                }))
            }
            Value::Place(place) => {
                if let Some(before) = place.offset {
                    offset = self.two(Op::AddW, before, offset)?;
                }
                Ok(Value::Place(Place {
                    offset: Some(offset),
                    ..place
                }))
            }
        }
    }

    fn elements(&mut self, inner: &TypeInner) -> Result<(u32, u32), LowerError> {
        self.layout
            .elements(inner)
            .map_err(|reason| self.no_layout(reason))
    }
}
