//! Lowers a function of a naga module to flat code: all calls are inlined, and vectors become
//! scalars.

mod builtins;
mod expression;
mod function;
mod geometry;
mod matrix;
mod operators;
mod pointer;
mod values;

use std::collections::HashMap;
use std::rc::Rc;

use naga::front::Typifier;
use naga::proc::ResolveContext;
use naga::{Arena, Expression, Function, GlobalVariable, Handle, Module, Span, TypeInner};

use crate::code::{Code, Full, Label, Words};
use crate::error::LowerError;
use crate::facts::Facts;
use crate::instruction::Instruction;
use crate::layout::{Layout, NoLayout};
use crate::optimize::optimize;
use crate::program::{Options, Program};
use crate::rows::{Interface, assign};

/// Deepest nesting of calls.
const DEPTH_LIMIT: usize = 100;

/// A value of an expression.
#[derive(Clone)]
enum Value {
    Words(Words),
    Place(Place),
}

/// What a pointer leads to: registers from `base`, plus the value of a register.
#[derive(Clone, Copy)]
struct Place {
    base: u32,
    offset: Option<u32>,
    is_writable: bool,
}

/// Expressions of one inlined call, or those of the module.
struct Scope<'m> {
    expressions: &'m Arena<Expression>,
    types: Rc<Typifier>,
    facts: Option<Rc<Facts>>,
    function: Option<&'m Function>,
    values: Vec<Option<Value>>,
    /// Registers of the local variables.
    locals: Vec<u32>,
    arguments: Vec<Value>,
    result: Words,
    end: Label,
    breaks: Vec<Label>,
    continues: Vec<Label>,
}

/// What messages say about where lowering is.
struct Location {
    /// Index in the names of functions.
    function: usize,
    span: Span,
}

struct Lowering<'m, 'o> {
    module: &'m Module,
    options: &'o Options<'o>,
    layout: Layout<'m>,
    code: Code,
    global: Scope<'m>,
    constants: HashMap<Handle<naga::Constant>, Words>,
    overrides: HashMap<Handle<naga::Override>, Words>,
    functions: HashMap<Handle<Function>, (Rc<Typifier>, Rc<Facts>)>,
    variables: HashMap<Handle<GlobalVariable>, Place>,
    /// Registers of the variables that the host supplies.
    supplied: Vec<Option<std::ops::Range<usize>>>,
    /// Sets private variables before the function begins.
    prologue: Vec<Instruction>,
    calls: Vec<Handle<Function>>,
    location: Location,
    marks: Vec<(u32, u32)>,
    names: Vec<String>,
}

impl Program {
    /// Lowers `function` of a module that naga's validator accepts.
    ///
    /// # Errors
    /// The function uses what cannot be evaluated here, or more than the limits allow.
    pub fn new(module: &Module, function: &str, options: &Options) -> Result<Self, LowerError> {
        lower(module, function, options)
    }
}

fn lower(module: &Module, function: &str, options: &Options) -> Result<Program, LowerError> {
    let named = module
        .functions
        .iter()
        .find(|(_, candidate)| candidate.name.as_deref() == Some(function));
    let Some((handle, _)) = named else {
        return Err(LowerError::NoFunction(function.to_owned()));
    };
    let mut lowering = Lowering {
        module,
        options,
        layout: Layout::new(module, options.limits.slots),
        code: Code::new(options.precision, options.limits),
        global: Scope::new(&module.global_expressions, Rc::new(Typifier::new()), None),
        constants: HashMap::new(),
        overrides: HashMap::new(),
        functions: HashMap::new(),
        variables: HashMap::new(),
        supplied: vec![None; options.globals.len()],
        prologue: Vec::new(),
        calls: Vec::new(),
        location: Location {
            function: 0,
            span: Span::UNDEFINED,
        },
        marks: Vec::new(),
        names: vec![function.to_owned()],
    };
    lowering.prepare()?;
    lowering.program(handle)
}

impl<'m> Scope<'m> {
    fn new(
        expressions: &'m Arena<Expression>,
        types: Rc<Typifier>,
        facts: Option<Rc<Facts>>,
    ) -> Scope<'m> {
        Scope {
            expressions,
            types,
            facts,
            function: None,
            values: vec![None; expressions.len()],
            locals: Vec::new(),
            arguments: Vec::new(),
            result: Words::none(),
            end: Label::default(),
            breaks: Vec::new(),
            continues: Vec::new(),
        }
    }

    fn inner<'a>(&'a self, module: &'a Module, handle: Handle<Expression>) -> &'a TypeInner {
        self.types[handle].inner_with(&module.types)
    }
}

impl<'m> Lowering<'m, '_> {
    /// Types of the module's expressions, and lengths of arrays that override constants give.
    fn prepare(&mut self) -> Result<(), LowerError> {
        let no_locals = Arena::new();
        let context = ResolveContext::with_locals(self.module, &no_locals, &[]);
        let types = self.typed(&self.module.global_expressions, &context)?;
        self.global.types = Rc::new(types);
        for (_, ty) in self.module.types.iter() {
            let TypeInner::Array {
                size: naga::ArraySize::Pending(constant),
                ..
            } = ty.inner
            else {
                continue;
            };
            match self.override_words(constant) {
                Ok(words) => {
                    let length = self.code.known(words.at(0)).map_or(0, |word| word.to_u32());
                    // An override may be negative or 0, which no array is.
                    let length = if length.cast_signed() < 1 { 1 } else { length };
                    self.layout.lengths.push((constant, length));
                }
                // Matters only if a variable is of this type.
                Err(LowerError::Override { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn typed(
        &self,
        expressions: &Arena<Expression>,
        context: &ResolveContext,
    ) -> Result<Typifier, LowerError> {
        let mut types = Typifier::new();
        if let Some((last, _)) = expressions.iter().next_back() {
            types
                .grow(last, expressions, context)
                .map_err(|error| self.invalid(error.to_string()))?;
        }
        Ok(types)
    }

    fn program(mut self, handle: Handle<Function>) -> Result<Program, LowerError> {
        let function = &self.module.functions[handle];
        self.location.span = self.module.functions.get_span(handle);
        let mut words = 0;
        for argument in &function.arguments {
            if self.module.types[argument.ty]
                .inner
                .pointer_space()
                .is_some()
            {
                return Err(self.unsupported("a pointer as its argument"));
            }
            words = self.words_of(argument.ty)?.saturating_add(words);
        }
        let start = self.allocate(words)?;
        let mut at = start;
        let mut arguments = Vec::new();
        for argument in &function.arguments {
            let len = self.words_of(argument.ty)?;
            arguments.push(Value::Words(Words::Range { start: at, len }));
            at += len;
        }
        let result = self.inline(handle, arguments)?;
        let result_start = match result {
            Words::Range { start, .. } => start,
            _ => {
                let d = self.allocate(result.len())?;
                self.copy(d, &result)?;
                d
            }
        } as usize;
        let result = result_start..result_start + result.len() as usize;
        let (mut code, mut marks) =
            optimize(&mut self.code, self.prologue, self.marks, result.clone());
        let interface = Interface {
            arguments: start..start + words,
            alike: words.min(self.options.alike as u32),
            result: result.start as u32..result.end as u32,
            globals: &self.supplied,
        };
        let (first, rows) = assign(&mut code, &mut marks, &self.code, &interface);
        let end = interface.arguments.end as usize;
        Ok(Program {
            precision: self.options.precision,
            steps: self.options.limits.steps,
            alike: end - interface.alike as usize..end,
            image: self.code.image,
            first,
            spread: rows.spread,
            spread_again: rows.spread_again,
            code,
            rows: rows.count,
            arguments: rows.arguments,
            result: rows.result,
            globals: self.supplied,
            marks,
            names: self.names,
        })
    }

    fn words_of(&mut self, ty: Handle<naga::Type>) -> Result<u32, LowerError> {
        self.layout
            .words_of(ty)
            .map_err(|reason| self.no_layout(reason))
    }

    fn allocate(&mut self, words: u32) -> Result<u32, LowerError> {
        self.code.allocate(words).map_err(|full| self.full(full))
    }

    fn copy(&mut self, d: u32, words: &Words) -> Result<(), LowerError> {
        self.code.copy(d, words).map_err(|full| self.full(full))
    }

    fn function_name(&self) -> String {
        self.names
            .get(self.location.function)
            .cloned()
            .unwrap_or_default()
    }

    fn unsupported(&self, what: &str) -> LowerError {
        LowerError::Unsupported {
            what: what.to_owned(),
            function: self.function_name(),
            span: self.location.span.to_range(),
        }
    }

    fn invalid(&self, what: impl Into<String>) -> LowerError {
        LowerError::Invalid {
            what: what.into(),
            function: self.function_name(),
            span: self.location.span.to_range(),
        }
    }

    fn full(&self, full: Full) -> LowerError {
        let (function, span) = (self.function_name(), self.location.span.to_range());
        match full {
            Full::Slots => LowerError::Slots {
                limit: self.options.limits.slots,
                function,
                span,
            },
            Full::Instructions => LowerError::Instructions {
                limit: self.options.limits.instructions,
                function,
                span,
            },
        }
    }

    fn no_layout(&self, reason: NoLayout) -> LowerError {
        match reason {
            NoLayout::Unsupported(what) => self.unsupported(&what),
            NoLayout::TooLarge => self.full(Full::Slots),
            NoLayout::Pending(constant) => LowerError::Override {
                name: self.module.overrides[constant]
                    .name
                    .clone()
                    .unwrap_or_default(),
            },
        }
    }
}
