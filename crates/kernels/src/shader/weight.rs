//! The weight of a kernel: how much arithmetic and how many accesses to memory its text asks of one invocation, counted from the
//! module that naga read. Costs of kernels that were never timed follow from it.

use std::collections::HashMap;

use naga::{
    AddressSpace, BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, MathFunction, Module, Statement, TypeInner,
    UnaryOperator, valid::FunctionInfo,
};

use super::reflect::Reflected;

/// Operations of one invocation. One is an addition of numbers; what takes longer counts as several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weight {
    /// Outside loops, both sides of every branch.
    pub once: f64,
    /// In the body of loops, counted once however often it runs.
    pub looped: f64,
}

/// What a read or a write of memory that other invocations see counts, for each word.
const MEMORY: f64 = 4.0;
const ATOMIC: f64 = 16.0;
const DIVISION: f64 = 4.0;
const ROOT: f64 = 6.0;
const TRANSCENDENTAL: f64 = 16.0;
const TEXEL: f64 = 16.0;
const BARRIER: f64 = 16.0;

impl Reflected {
    /// The weight of an entry point with these overrides, by name; branches that they decide count on the taken side alone. None where the
    /// module has no such entry point.
    pub fn weight(&self, entry: &str, constants: &[(String, f64)]) -> Option<Weight> {
        let index = self.module.entry_points.iter().position(|point| point.name == entry)?;
        let mut counter = Counter { reflected: self, constants, known: HashMap::new(), locals: HashMap::new(), loaded: HashMap::new() };
        let (function, info) = (&self.module.entry_points[index].function, self.info.get_entry_point(index));
        Some(counter.function(function, info))
    }
}

struct Counter<'a> {
    reflected: &'a Reflected,
    constants: &'a [(String, f64)],
    known: HashMap<Handle<Function>, Weight>,
    /// Values that variables of the function hold here on every way. `a && b` is a variable that a branch sets.
    locals: HashMap<Handle<LocalVariable>, f64>,
    /// What loads of these variables have found.
    loaded: HashMap<Handle<Expression>, f64>,
}

/// A function while it is counted.
#[derive(Clone, Copy)]
struct Context<'a> {
    function: &'a Function,
    info: &'a FunctionInfo,
}

impl Counter<'_> {
    fn function(&mut self, function: &Function, info: &FunctionInfo) -> Weight {
        let mut weight = Weight::default();
        let outer = (std::mem::take(&mut self.locals), std::mem::take(&mut self.loaded));
        self.block(&function.body, Context { function, info }, false, &mut weight);
        (self.locals, self.loaded) = outer;
        weight
    }

    fn block(&mut self, block: &Block, context: Context<'_>, is_looped: bool, weight: &mut Weight) {
        for statement in block {
            let own = match statement {
                Statement::Emit(range) => {
                    range.clone().for_each(|handle| self.note_load(handle, context));
                    range.clone().map(|handle| self.expression(handle, context)).sum()
                }
                Statement::Store { pointer, value } => {
                    self.stored(*pointer, *value, context);
                    self.access(*pointer, context)
                }
                Statement::Atomic { .. } => ATOMIC,
                Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) | Statement::WorkGroupUniformLoad { .. } => BARRIER,
                Statement::Block(inner) => {
                    self.block(inner, context, is_looped, weight);
                    0.0
                }
                Statement::If { condition, accept, reject } => {
                    let known = self.value(*condition, context);
                    let before = self.locals.clone();
                    if known != Some(0.0) {
                        self.block(accept, context, is_looped, weight);
                    }
                    let accepted = std::mem::replace(&mut self.locals, before);
                    if known.is_none_or(|value| value == 0.0) {
                        self.block(reject, context, is_looped, weight);
                    }
                    match known {
                        Some(0.0) => {}
                        Some(_) => self.locals = accepted,
                        None => self.locals.retain(|local, value| accepted.get(local) == Some(value)),
                    }
                    1.0
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.locals.clear();
                        self.block(&case.body, context, is_looped, weight);
                    }
                    self.locals.clear();
                    1.0
                }
                Statement::Loop { body, continuing, .. } => {
                    self.locals.clear();
                    self.block(body, context, true, weight);
                    self.block(continuing, context, true, weight);
                    self.locals.clear();
                    1.0
                }
                Statement::Call { function, .. } => {
                    let called = self.called(*function);
                    if is_looped {
                        weight.looped += called.once;
                    } else {
                        weight.once += called.once;
                    }
                    weight.looped += called.looped;
                    0.0
                }
                _ => 0.0,
            };
            if is_looped {
                weight.looped += own;
            } else {
                weight.once += own;
            }
        }
    }

    /// Notes what a load of a variable of the function finds here: later stores do not change it.
    fn note_load(&mut self, handle: Handle<Expression>, context: Context<'_>) {
        let Expression::Load { pointer } = context.function.expressions[handle] else { return };
        let Expression::LocalVariable(local) = context.function.expressions[pointer] else { return };
        match self.locals.get(&local) {
            Some(value) => self.loaded.insert(handle, *value),
            None => self.loaded.remove(&handle),
        };
    }

    /// Notes what a variable of the function holds from here on.
    fn stored(&mut self, pointer: Handle<Expression>, value: Handle<Expression>, context: Context<'_>) {
        let Expression::LocalVariable(local) = context.function.expressions[pointer] else { return };
        match self.value(value, context) {
            Some(value) => self.locals.insert(local, value),
            None => self.locals.remove(&local),
        };
    }

    /// WGSL has no recursion, so every function is counted once.
    fn called(&mut self, handle: Handle<Function>) -> Weight {
        if let Some(known) = self.known.get(&handle) {
            return *known;
        }
        let reflected = self.reflected;
        let weight = self.function(&reflected.module.functions[handle], &reflected.info[handle]);
        self.known.insert(handle, weight);
        weight
    }

    fn expression(&self, handle: Handle<Expression>, context: Context<'_>) -> f64 {
        let numbers = |handle: Handle<Expression>| components(context.info[handle].ty.inner_with(&self.module().types));
        match &context.function.expressions[handle] {
            Expression::Load { pointer } => self.access(*pointer, context),
            Expression::Binary { op, left, right } => {
                let sides = numbers(*left).max(numbers(*right));
                match op {
                    BinaryOperator::Divide | BinaryOperator::Modulo => DIVISION * sides,
                    _ => sides,
                }
            }
            Expression::Unary { .. } | Expression::Select { .. } | Expression::As { .. } | Expression::Relational { .. } => numbers(handle),
            Expression::Math { fun, arg, .. } => numbers(*arg) * per_number(*fun),
            Expression::ImageLoad { .. } | Expression::ImageSample { .. } => TEXEL,
            _ => 0.0,
        }
    }

    /// What a load or a store counts: nothing for what a register holds.
    fn access(&self, pointer: Handle<Expression>, context: Context<'_>) -> f64 {
        let mut root = pointer;
        let variable = loop {
            match &context.function.expressions[root] {
                Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => root = *base,
                Expression::GlobalVariable(variable) => break *variable,
                _ => return 0.0,
            }
        };
        let module = self.module();
        let words = match context.info[pointer].ty.inner_with(&module.types) {
            TypeInner::Pointer { base, .. } => components(&module.types[*base].inner),
            TypeInner::ValuePointer { size, .. } => size.map_or(1.0, |size| f64::from(size as u8)),
            _ => 1.0,
        };
        match module.global_variables[variable].space {
            AddressSpace::Storage { .. } => MEMORY * words,
            AddressSpace::Uniform | AddressSpace::WorkGroup => words,
            _ => 0.0,
        }
    }

    /// The value of a condition that overrides and numbers decide; true is 1, false 0.
    fn value(&self, handle: Handle<Expression>, context: Context<'_>) -> Option<f64> {
        let bool = |is_true: bool| Some(f64::from(u8::from(is_true)));
        match &context.function.expressions[handle] {
            Expression::Literal(literal) => number(literal),
            Expression::Override(handle) => {
                let declared = &self.module().overrides[*handle];
                let name = declared.name.as_deref()?;
                let given = self.constants.iter().find(|(other, _)| other == name).map(|(_, value)| *value);
                given.or_else(|| self.global(declared.init?))
            }
            Expression::Load { .. } => self.loaded.get(&handle).copied(),
            Expression::Constant(constant) => self.global(self.module().constants[*constant].init),
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => bool(self.value(*expr, context)? == 0.0),
            Expression::Binary { op, left, right } => {
                let (left, right) = (self.value(*left, context), self.value(*right, context));
                match op {
                    BinaryOperator::LogicalAnd if left == Some(0.0) || right == Some(0.0) => bool(false),
                    BinaryOperator::LogicalOr if [left, right].iter().any(|side| side.is_some_and(|value| value != 0.0)) => bool(true),
                    BinaryOperator::Equal => bool(left? == right?),
                    BinaryOperator::NotEqual => bool(left? != right?),
                    BinaryOperator::Greater => bool(left? > right?),
                    BinaryOperator::Less => bool(left? < right?),
                    BinaryOperator::LogicalAnd => bool(left? != 0.0 && right? != 0.0),
                    BinaryOperator::LogicalOr => bool(left? != 0.0 || right? != 0.0),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn global(&self, handle: Handle<Expression>) -> Option<f64> {
        match &self.module().global_expressions[handle] {
            Expression::Literal(literal) => number(literal),
            _ => None,
        }
    }

    fn module(&self) -> &Module {
        &self.reflected.module
    }
}

fn number(literal: &Literal) -> Option<f64> {
    Some(match *literal {
        Literal::Bool(value) => f64::from(u8::from(value)),
        Literal::U32(value) => value.into(),
        Literal::I32(value) => value.into(),
        Literal::F32(value) => value.into(),
        Literal::AbstractInt(value) => value as f64,
        Literal::AbstractFloat(value) => value,
        _ => return None,
    })
}

/// Numbers that a value consists of.
fn components(inner: &TypeInner) -> f64 {
    match inner {
        TypeInner::Vector { size, .. } => f64::from(*size as u8),
        TypeInner::Matrix { columns, rows, .. } => f64::from(*columns as u8) * f64::from(*rows as u8),
        TypeInner::Struct { span, .. } => f64::from(*span) / 4.0,
        _ => 1.0,
    }
}

fn per_number(function: MathFunction) -> f64 {
    use MathFunction as M;
    match function {
        M::Sqrt | M::InverseSqrt | M::Length | M::Distance | M::Normalize => ROOT,
        M::Sin | M::Cos | M::Tan | M::Asin | M::Acos | M::Atan | M::Atan2 | M::Exp | M::Exp2 | M::Log | M::Log2 | M::Pow => TRANSCENDENTAL,
        M::Dot | M::Cross | M::Mix | M::SmoothStep | M::Fma => 2.0,
        _ => 1.0,
    }
}
