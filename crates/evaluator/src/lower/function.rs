//! Calls and statements.

use std::rc::Rc;

use naga::proc::ResolveContext;
use naga::{Block, Expression, Function, Handle, Span, Statement, SwitchCase, SwitchValue};

use super::{DEPTH_LIMIT, Lowering, Scope, Value};
use crate::code::{Label, Words};
use crate::error::LowerError;
use crate::facts::{Facts, Returning};
use crate::instruction::Op;

impl<'m> Lowering<'m, '_> {
    fn facts(
        &mut self,
        handle: Handle<Function>,
    ) -> Result<(Rc<naga::front::Typifier>, Rc<Facts>), LowerError> {
        if let Some((types, facts)) = self.functions.get(&handle) {
            return Ok((types.clone(), facts.clone()));
        }
        let function = &self.module.functions[handle];
        let context = ResolveContext::with_locals(
            self.module,
            &function.local_variables,
            &function.arguments,
        );
        let types = Rc::new(self.typed(&function.expressions, &context)?);
        let facts = Facts::new(self.module, function, &types, &mut self.layout)
            .map_err(|reason| self.no_layout(reason))?;
        let facts = Rc::new(facts);
        self.functions
            .insert(handle, (types.clone(), facts.clone()));
        Ok((types, facts))
    }

    /// Lowers a call; the words of its result.
    pub(super) fn inline(
        &mut self,
        handle: Handle<Function>,
        arguments: Vec<Value>,
    ) -> Result<Words, LowerError> {
        if self.calls.contains(&handle) {
            return Err(self.invalid("a function calls itself"));
        }
        if self.calls.len() >= DEPTH_LIMIT {
            let (function, span) = (self.function_name(), self.location.span.to_range());
            return Err(LowerError::Depth {
                limit: DEPTH_LIMIT,
                function,
                span,
            });
        }
        self.code.count(0).map_err(|full| self.full(full))?;
        let function = &self.module.functions[handle];
        let caller = self.enter(function);
        self.calls.push(handle);
        let (types, facts) = self.facts(handle)?;
        let mut scope = Scope::new(&function.expressions, types, Some(facts.clone()));
        scope.function = Some(function);
        scope.arguments = arguments;
        self.variables(&mut scope, function, &facts)?;
        if let Some(result) = &function.result {
            let len = self.words_of(result.ty)?;
            scope.result = match facts.returning {
                Returning::Last => Words::none(),
                Returning::Variable(local) => Words::Range {
                    start: scope.locals[local.index()],
                    len,
                },
                Returning::Mixed => Words::Range {
                    start: self.allocate(len)?,
                    len,
                },
            };
        }
        self.block(&mut scope, &function.body)?;
        self.code.bind(std::mem::take(&mut scope.end));
        self.calls.pop();
        self.leave(caller);
        Ok(scope.result)
    }

    /// Code from here on belongs to a function; the caller's location.
    fn enter(&mut self, function: &Function) -> (usize, Span) {
        let caller = (self.location.function, self.location.span);
        let name = function.name.clone().unwrap_or_default();
        self.location.function = match self.names.iter().position(|other| *other == name) {
            Some(known) => known,
            None => {
                self.names.push(name);
                self.names.len() - 1
            }
        };
        self.mark();
        caller
    }

    fn leave(&mut self, (function, span): (usize, Span)) {
        self.location.function = function;
        self.location.span = span;
        self.mark();
    }

    fn mark(&mut self) {
        self.marks.push((
            self.code.instructions.len() as u32,
            self.location.function as u32,
        ));
    }

    /// Gives the local variables registers and their first values.
    fn variables(
        &mut self,
        scope: &mut Scope<'m>,
        function: &'m Function,
        facts: &Facts,
    ) -> Result<(), LowerError> {
        for (handle, variable) in function.local_variables.iter() {
            self.location.span = function.local_variables.get_span(handle);
            let len = self.words_of(variable.ty)?;
            // Arguments of the outermost function are copies already, which a variable may change.
            let argument = facts.argument[handle.index()].filter(|_| self.calls.len() == 1);
            let base = match argument.and_then(|number| scope.arguments.get(number as usize)) {
                Some(&Value::Words(Words::Range { start, .. })) => {
                    self.code.variables.push(start..start + len);
                    start
                }
                _ => self.allocate(len)?,
            };
            scope.locals.push(base);
            if facts.stored_first[handle.index()] {
                continue;
            }
            let first = match variable.init {
                Some(init) => self.words(scope, init)?,
                None => self.zero(variable.ty)?,
            };
            self.copy(base, &first)?;
        }
        Ok(())
    }

    pub(super) fn block(
        &mut self,
        scope: &mut Scope<'m>,
        block: &'m Block,
    ) -> Result<(), LowerError> {
        for (statement, span) in block.span_iter() {
            self.location.span = *span;
            self.code.count(0).map_err(|full| self.full(full))?;
            self.statement(scope, statement)?;
            if matches!(
                statement,
                Statement::Break | Statement::Continue | Statement::Return { .. }
            ) {
                break;
            }
        }
        Ok(())
    }

    fn statement(
        &mut self,
        scope: &mut Scope<'m>,
        statement: &'m Statement,
    ) -> Result<(), LowerError> {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    self.location.span = scope.expressions.get_span(handle);
                    let value = self.expression(scope, handle)?;
                    scope.values[handle.index()] = Some(value);
                }
                Ok(())
            }
            Statement::Block(block) => self.block(scope, block),
            Statement::If {
                condition,
                accept,
                reject,
            } => self.branch(scope, *condition, accept, reject),
            Statement::Switch { selector, cases } => self.switch(scope, *selector, cases),
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => self.repeat(scope, body, continuing, *break_if),
            Statement::Break => self.jump_out(scope.breaks.last_mut()),
            Statement::Continue => self.jump_out(scope.continues.last_mut()),
            Statement::Return { value } => self.give_back(scope, *value),
            Statement::Store { pointer, value } => {
                let words = self.words(scope, *value)?;
                self.store(scope, *pointer, &words)
            }
            Statement::Call {
                function,
                arguments,
                result,
            } => {
                let words = self.call(scope, *function, arguments)?;
                if let Some(result) = result {
                    scope.values[result.index()] = Some(Value::Words(words));
                }
                Ok(())
            }
            Statement::Kill => Err(self.unsupported("`discard`")),
            Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) => {
                Err(self.unsupported("a barrier"))
            }
            Statement::ImageStore { .. } | Statement::ImageAtomic { .. } => {
                Err(self.unsupported("a texture"))
            }
            Statement::Atomic { .. } => Err(self.unsupported("an atomic")),
            Statement::WorkGroupUniformLoad { .. } => {
                Err(self.unsupported("`workgroupUniformLoad`"))
            }
            Statement::RayQuery { .. } | Statement::RayPipelineFunction(_) => {
                Err(self.unsupported("ray tracing"))
            }
            Statement::SubgroupBallot { .. }
            | Statement::SubgroupGather { .. }
            | Statement::SubgroupCollectiveOperation { .. } => {
                Err(self.unsupported("an operation of subgroups"))
            }
            Statement::CooperativeStore { .. } => Err(self.unsupported("a cooperative matrix")),
        }
    }

    fn jump_out(&mut self, label: Option<&mut Label>) -> Result<(), LowerError> {
        let Some(label) = label else {
            return Err(self.invalid("a jump out of no loop"));
        };
        self.code
            .jump(Op::Jump, 0, 0, label)
            .map_err(|full| self.full(full))
    }

    fn jump(&mut self, op: Op, a: u32, b: u32, label: &mut Label) -> Result<(), LowerError> {
        self.code
            .jump(op, a, b, label)
            .map_err(|full| self.full(full))
    }

    fn give_back(
        &mut self,
        scope: &mut Scope<'m>,
        value: Option<Handle<Expression>>,
    ) -> Result<(), LowerError> {
        let returning = scope.facts.as_ref().map(|facts| facts.returning);
        if let Some(value) = value {
            match returning {
                Some(Returning::Last) => scope.result = self.words(scope, value)?,
                // Already where the result is.
                Some(Returning::Variable(_)) => {}
                _ => {
                    let words = self.words(scope, value)?;
                    self.copy(scope.result.at(0), &words)?;
                }
            }
        }
        if returning == Some(Returning::Last) {
            return Ok(());
        }
        self.code
            .jump(Op::Jump, 0, 0, &mut scope.end)
            .map_err(|full| self.full(full))
    }

    fn branch(
        &mut self,
        scope: &mut Scope<'m>,
        condition: Handle<Expression>,
        accept: &'m Block,
        reject: &'m Block,
    ) -> Result<(), LowerError> {
        let condition = self.words(scope, condition)?.at(0);
        if let Some(known) = self.code.known(condition) {
            return self.block(scope, if known.to_bool() { accept } else { reject });
        }
        let (mut otherwise, mut end) = (Label::default(), Label::default());
        if accept.is_empty() {
            self.jump(Op::JumpIf, condition, 0, &mut end)?;
            self.block(scope, reject)?;
        } else {
            self.jump(Op::JumpIfNot, condition, 0, &mut otherwise)?;
            self.block(scope, accept)?;
            if !reject.is_empty() {
                self.jump(Op::Jump, 0, 0, &mut end)?;
            }
            self.code.bind(otherwise);
            self.block(scope, reject)?;
        }
        self.code.bind(end);
        Ok(())
    }

    fn switch(
        &mut self,
        scope: &mut Scope<'m>,
        selector: Handle<Expression>,
        cases: &'m [SwitchCase],
    ) -> Result<(), LowerError> {
        let selector = self.words(scope, selector)?.at(0);
        let known = self.code.known(selector).map(|word| word.to_u32());
        let mut labels: Vec<Label> = cases.iter().map(|_| Label::default()).collect();
        let mut default = None;
        let mut chosen = None;
        for (index, case) in cases.iter().enumerate() {
            let value = match case.value {
                SwitchValue::I32(value) => value.cast_unsigned(),
                SwitchValue::U32(value) => value,
                SwitchValue::Default => {
                    default = Some(index);
                    continue;
                }
            };
            match known {
                Some(known) if known == value => chosen = Some(index),
                Some(_) => {}
                None => self.jump(Op::JumpIfEqual, selector, value, &mut labels[index])?,
            }
        }
        scope.breaks.push(Label::default());
        let first = match (known, chosen.or(default)) {
            // Without a case for a value that is known, none runs.
            (Some(_), first) => first.unwrap_or(cases.len()),
            (None, Some(default)) => {
                self.jump(Op::Jump, 0, 0, &mut labels[default])?;
                0
            }
            (None, None) => {
                self.jump_out(scope.breaks.last_mut())?;
                0
            }
        };
        for (case, label) in cases.iter().zip(labels).skip(first) {
            self.code.bind(label);
            self.block(scope, &case.body)?;
            if !case.fall_through {
                if known.is_some() {
                    break;
                }
                self.jump_out(scope.breaks.last_mut())?;
            }
        }
        let end = scope.breaks.pop().unwrap_or_default();
        self.code.bind(end);
        Ok(())
    }

    fn repeat(
        &mut self,
        scope: &mut Scope<'m>,
        body: &'m Block,
        continuing: &'m Block,
        break_if: Option<Handle<Expression>>,
    ) -> Result<(), LowerError> {
        scope.breaks.push(Label::default());
        scope.continues.push(Label::default());
        let start = self.code.instructions.len();
        self.block(scope, body)?;
        let next = scope.continues.pop().unwrap_or_default();
        self.code.bind(next);
        self.block(scope, continuing)?;
        let mut end = scope.breaks.pop().unwrap_or_default();
        if let Some(condition) = break_if {
            let condition = self.words(scope, condition)?.at(0);
            self.jump(Op::JumpIf, condition, 0, &mut end)?;
        }
        self.code.jump_back(start).map_err(|full| self.full(full))?;
        self.code.bind(end);
        Ok(())
    }

    fn call(
        &mut self,
        scope: &mut Scope<'m>,
        function: Handle<Function>,
        arguments: &[Handle<Expression>],
    ) -> Result<Words, LowerError> {
        let name = self.module.functions[function]
            .name
            .as_deref()
            .unwrap_or_default();
        let external = self
            .options
            .externals
            .iter()
            .position(|external| external == name);
        let mut values = Vec::new();
        for &argument in arguments {
            values.push(self.value(scope, argument)?);
        }
        match external {
            Some(index) => self.external(index, function, &values),
            None => self.inline(function, values),
        }
    }

    fn external(
        &mut self,
        index: usize,
        function: Handle<Function>,
        arguments: &[Value],
    ) -> Result<Words, LowerError> {
        let mut given = Vec::new();
        for argument in arguments {
            match argument {
                Value::Words(words) => given.extend(words.iter()),
                Value::Place(_) => {
                    return Err(
                        self.unsupported("a pointer as an argument of a function of the host")
                    );
                }
            }
        }
        let given: Words = given.into_iter().collect();
        let result = match &self.module.functions[function].result {
            Some(result) => self.words_of(result.ty)?,
            None => 0,
        };
        let start = self.allocate(given.len() + result)?;
        self.copy(start, &given)?;
        let pushed = self
            .code
            .push(Op::External, index as u32, start, given.len(), result);
        pushed.map_err(|full| self.full(full))?;
        Ok(Words::Range {
            start: start + given.len(),
            len: result,
        })
    }
}
