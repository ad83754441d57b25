//! What is known about a function before it is lowered: which loads need a copy, and which
//! variables need not be initialized.
//!
//! Statements are numbered in the order of the source. A load may stand for the variable's own
//! registers if nothing is stored to them before the last use of what was loaded.

use naga::{
    AddressSpace, Block, Expression, Function, Handle, LocalVariable, Module, Statement, TypeInner,
};

use crate::layout::{Layout, NoLayout};
use crate::operands::{operands, passes_operands_on};

pub(crate) struct Facts {
    /// Loads whose value must be copied, by expression.
    pub copied: Vec<bool>,
    /// Variables that are stored to as a whole before they are read, by variable.
    pub stored_first: Vec<bool>,
    /// The argument that is stored first to a variable and used nowhere else, by variable; only
    /// outside of loops and branches.
    pub argument: Vec<Option<u32>>,
    pub returning: Returning,
}

/// How a function returns its value.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Returning {
    /// Only at its very end.
    Last,
    /// Everywhere the value of one variable.
    Variable(Handle<LocalVariable>),
    /// Different values at different places.
    Mixed,
}

/// What a pointer leads to. Pointers that were passed in and private variables may lead to the same
/// memory.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Root {
    Local(Handle<LocalVariable>),
    Outer,
    Constant,
}

/// Words `start..end` of what a pointer leads to.
#[derive(Clone, Copy)]
struct Extent {
    root: Root,
    start: u32,
    end: u32,
}

struct Store {
    extent: Extent,
    at: u32,
    /// A call stores while it still reads its arguments.
    is_call: bool,
}

struct Loop {
    start: u32,
    end: u32,
    parent: Option<usize>,
}

struct Walk<'a, 'm> {
    module: &'m Module,
    function: &'m Function,
    types: &'a naga::front::Typifier,
    layout: &'a mut Layout<'m>,
    /// Number of statements so far.
    at: u32,
    emitted: Vec<u32>,
    last: Vec<u32>,
    uses: Vec<u32>,
    /// Values that may be returned.
    escapes: Vec<bool>,
    stores: Vec<Store>,
    loops: Vec<Loop>,
    /// Innermost loop of each statement.
    loop_of: Vec<Option<usize>>,
    open_loop: Option<usize>,
    calls: Vec<(Vec<Handle<Expression>>, Handle<Expression>)>,
    locals: Vec<Local>,
    /// Numbers of the last statement of each block in which the walk is.
    blocks: Vec<usize>,
    /// First and last statement of each block.
    block_ends: Vec<u32>,
    returns: Vec<Option<Handle<Expression>>>,
    returns_last: bool,
}

#[derive(Clone, Default)]
struct Local {
    last: u32,
    /// The store that is its first use: the block it is in, and the value stored.
    first: Option<Option<(usize, Handle<Expression>)>>,
}

impl Facts {
    pub(crate) fn new<'m>(
        module: &'m Module,
        function: &'m Function,
        types: &naga::front::Typifier,
        layout: &mut Layout<'m>,
    ) -> Result<Facts, NoLayout> {
        let count = function.expressions.len();
        let mut walk = Walk {
            module,
            function,
            types,
            layout,
            at: 0,
            emitted: vec![0; count],
            last: vec![0; count],
            uses: vec![0; count],
            escapes: vec![false; count],
            stores: Vec::new(),
            loops: Vec::new(),
            loop_of: vec![None],
            open_loop: None,
            calls: Vec::new(),
            locals: vec![Local::default(); function.local_variables.len()],
            blocks: Vec::new(),
            block_ends: Vec::new(),
            returns: Vec::new(),
            returns_last: false,
        };
        walk.block(&function.body)?;
        walk.returns_last = ends_with_return(&function.body);
        walk.pass_on();
        walk.conclude()
    }
}

fn ends_with_return(block: &Block) -> bool {
    match block.last() {
        Some(Statement::Return { .. }) => true,
        Some(Statement::Block(inner)) => ends_with_return(inner),
        _ => false,
    }
}

impl<'m> Walk<'_, 'm> {
    fn block(&mut self, block: &'m Block) -> Result<(), NoLayout> {
        let id = self.block_ends.len();
        self.block_ends.push(0);
        self.blocks.push(id);
        for statement in block {
            self.step();
            self.statement(statement)?;
        }
        self.blocks.pop();
        self.block_ends[id] = self.at;
        Ok(())
    }

    fn step(&mut self) {
        self.at += 1;
        self.loop_of.push(self.open_loop);
    }

    fn statement(&mut self, statement: &'m Statement) -> Result<(), NoLayout> {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    self.emitted[handle.index()] = self.at;
                    let expression = &self.function.expressions[handle];
                    operands(expression, |operand| self.used(operand, None));
                }
            }
            Statement::Block(block) => self.block(block)?,
            Statement::If {
                condition,
                accept,
                reject,
            } => {
                self.used(*condition, None);
                self.block(accept)?;
                self.block(reject)?;
            }
            Statement::Switch { selector, cases } => {
                self.used(*selector, None);
                for case in cases {
                    self.block(&case.body)?;
                }
            }
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => {
                let id = self.loops.len();
                self.loops.push(Loop {
                    start: self.at,
                    end: u32::MAX,
                    parent: self.open_loop,
                });
                let outside = self.open_loop.replace(id);
                self.block(body)?;
                self.block(continuing)?;
                self.step();
                if let Some(condition) = break_if {
                    self.used(*condition, None);
                }
                self.loops[id].end = self.at;
                self.open_loop = outside;
            }
            Statement::Return { value } => {
                if let Some(value) = value {
                    self.used(*value, None);
                    self.escapes[value.index()] = true;
                }
                self.returns.push(*value);
            }
            Statement::Store { pointer, value } => {
                self.used(*value, None);
                self.used(*pointer, Some(*value));
                let extent = self.extent(*pointer)?;
                self.stores.push(Store {
                    extent,
                    at: self.at,
                    is_call: false,
                });
            }
            Statement::Call {
                arguments, result, ..
            } => {
                for &argument in arguments {
                    self.used(argument, None);
                    let inner = self.types[argument].inner_with(&self.module.types);
                    if inner.pointer_space().is_some() {
                        let mut extent = self.extent(argument)?;
                        (extent.start, extent.end) = (0, u32::MAX);
                        self.stores.push(Store {
                            extent,
                            at: self.at,
                            is_call: true,
                        });
                    }
                }
                // It may store to private variables.
                let extent = Extent {
                    root: Root::Outer,
                    start: 0,
                    end: u32::MAX,
                };
                self.stores.push(Store {
                    extent,
                    at: self.at,
                    is_call: true,
                });
                if let Some(result) = *result {
                    self.emitted[result.index()] = self.at;
                    self.calls.push((arguments.clone(), result));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The value of a store, if this use is its pointer.
    fn used(&mut self, handle: Handle<Expression>, stored: Option<Handle<Expression>>) {
        let (at, index) = (self.at, handle.index());
        self.uses[index] += 1;
        self.last[index] = self.last[index].max(at);
        if let Expression::LocalVariable(local) = self.function.expressions[handle] {
            let local = &mut self.locals[local.index()];
            local.last = at;
            local
                .first
                .get_or_insert(stored.and_then(|value| Some((*self.blocks.last()?, value))));
        }
    }

    /// The last moment at which a value from `from` is needed that is used at `to`: if that is in a
    /// loop that it comes from outside of, the loop's end.
    fn extended(&self, from: u32, to: u32) -> u32 {
        let mut last = to;
        let mut inside = self.loop_of.get(to as usize).copied().flatten();
        while let Some(id) = inside {
            let Loop { start, end, parent } = self.loops[id];
            if start < from && from <= end {
                break;
            }
            last = last.max(end);
            inside = parent;
        }
        last
    }

    /// Extends the life of values by that of the values which may stand for the same registers.
    fn pass_on(&mut self) {
        for index in 0..self.last.len() {
            self.last[index] = self.extended(self.emitted[index], self.last[index]);
        }
        loop {
            let mut changed = false;
            for (handle, expression) in self.function.expressions.iter().rev() {
                if passes_operands_on(expression) {
                    operands(expression, |operand| {
                        changed |= self.lives_as(operand, handle)
                    });
                }
            }
            // The last first: arguments may be results of earlier calls.
            let calls = std::mem::take(&mut self.calls);
            for (arguments, result) in calls.iter().rev() {
                for &argument in arguments {
                    changed |= self.lives_as(argument, *result);
                }
            }
            self.calls = calls;
            if !changed {
                return;
            }
        }
    }

    /// Lets `operand` live as long as `user`; whether that changed anything.
    fn lives_as(&mut self, operand: Handle<Expression>, user: Handle<Expression>) -> bool {
        let (index, user) = (operand.index(), user.index());
        let last = self.extended(self.emitted[index], self.last[user]);
        let changed = last > self.last[index] || (self.escapes[user] && !self.escapes[index]);
        self.last[index] = self.last[index].max(last);
        self.escapes[index] |= self.escapes[user];
        changed
    }

    fn extent(&mut self, pointer: Handle<Expression>) -> Result<Extent, NoLayout> {
        Ok(match self.function.expressions[pointer] {
            Expression::LocalVariable(local) => {
                let end = self
                    .layout
                    .words_of(self.function.local_variables[local].ty)?;
                Extent {
                    root: Root::Local(local),
                    start: 0,
                    end,
                }
            }
            Expression::GlobalVariable(global) => {
                let is_private =
                    self.module.global_variables[global].space == AddressSpace::Private;
                Extent {
                    root: if is_private {
                        Root::Outer
                    } else {
                        Root::Constant
                    },
                    start: 0,
                    end: u32::MAX,
                }
            }
            Expression::AccessIndex { base, index } => {
                let whole = self.extent(base)?;
                let inner = self.types[base].inner_with(&self.module.types);
                let is_pointer_to_composite =
                    !matches!(inner, TypeInner::ValuePointer { size: None, .. });
                if whole.root == Root::Outer
                    || whole.root == Root::Constant
                    || !is_pointer_to_composite
                {
                    return Ok(whole);
                }
                let inner = self.layout.pointee(inner).into_owned();
                let (offset, words) = self.layout.part(&inner, index)?;
                // After a dynamic index the extent is wider than the type.
                let of_base = self.layout.words(&inner)?;
                if whole.end - whole.start != of_base {
                    return Ok(whole);
                }
                Extent {
                    root: whole.root,
                    start: whole.start + offset,
                    end: whole.start + offset + words,
                }
            }
            Expression::Access { base, .. } => self.extent(base)?,
            _ => Extent {
                root: Root::Outer,
                start: 0,
                end: u32::MAX,
            },
        })
    }

    fn conclude(mut self) -> Result<Facts, NoLayout> {
        let mut copied = vec![false; self.last.len()];
        for (handle, expression) in self.function.expressions.iter() {
            let Expression::Load { pointer } = *expression else {
                continue;
            };
            if self.uses[handle.index()] == 0 {
                continue;
            }
            let extent = self.extent(pointer)?;
            let (from, last) = (self.emitted[handle.index()], self.last[handle.index()]);
            if extent.root == Root::Outer && self.escapes[handle.index()] {
                // The caller cannot tell what the result of a call stands for.
                copied[handle.index()] = true;
                continue;
            }
            let after = self.stores.partition_point(|store| store.at <= from);
            copied[handle.index()] = self.stores[after..]
                .iter()
                .take_while(|store| store.at <= last)
                .any(|store| {
                    let overlaps = store.extent.root == extent.root
                        && store.extent.start < extent.end
                        && extent.start < store.extent.end;
                    overlaps && (store.at < last || store.is_call)
                });
        }
        let mut stored_first = vec![false; self.locals.len()];
        let mut argument = vec![None; self.locals.len()];
        for (index, local) in self.locals.iter().enumerate() {
            let Some(Some((block, value))) = local.first else {
                continue;
            };
            stored_first[index] = local.last <= self.block_ends[block];
            if let Expression::FunctionArgument(number) = self.function.expressions[value]
                && stored_first[index]
                && block == 0
                && self.uses[value.index()] == 1
                && self.is_only_argument(number)
            {
                argument[index] = Some(number);
            }
        }
        let returning = self.returning(&copied);
        Ok(Facts {
            copied,
            stored_first,
            argument,
            returning,
        })
    }

    /// Does one expression alone stand for the argument?
    fn is_only_argument(&self, number: u32) -> bool {
        let stands_for = |expression: &Expression| matches!(expression, Expression::FunctionArgument(other) if *other == number);
        self.function
            .expressions
            .iter()
            .filter(|(_, expression)| stands_for(expression))
            .count()
            == 1
    }

    fn returning(&self, copied: &[bool]) -> Returning {
        if self.returns_last && self.returns.len() == 1 {
            return Returning::Last;
        }
        let mut variable = None;
        for value in &self.returns {
            let Some(value) = *value else {
                return Returning::Mixed;
            };
            let Expression::Load { pointer } = self.function.expressions[value] else {
                return Returning::Mixed;
            };
            let Expression::LocalVariable(local) = self.function.expressions[pointer] else {
                return Returning::Mixed;
            };
            if copied[value.index()] || variable.is_some_and(|other| other != local) {
                return Returning::Mixed;
            }
            variable = Some(local);
        }
        variable.map_or(Returning::Mixed, Returning::Variable)
    }
}
