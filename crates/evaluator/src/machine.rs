//! Executes a program on a file of scalar registers.

use crate::error::EvalError;
use crate::instruction::Op;
use crate::program::{Precision, Program};
use crate::scalar::evaluate;
use crate::word::Word;

/// Functions that the host implements instead of WGSL.
pub trait Host {
    /// Computes function `index` of `Options::externals`; arguments and result are flattened as
    /// those of a program are. `result` comes with the words of an earlier call, and all of it
    /// must be written.
    fn external(&mut self, index: usize, arguments: &[Word], result: &mut [Word]);
}

/// A host without functions: results of external functions are zero.
pub struct NoHost;

impl Host for NoHost {
    fn external(&mut self, _: usize, _: &[Word], result: &mut [Word]) {
        result.fill(Word::ZERO);
    }
}

/// Registers of one thread for a program, reused from call to call.
#[derive(Clone)]
pub struct Machine<'p> {
    program: &'p Program,
    registers: Vec<Word>,
}

impl Program {
    /// Registers for calls from one thread.
    pub fn machine(&self) -> Machine<'_> {
        Machine {
            program: self,
            registers: self.registers(),
        }
    }

    /// The registers of a machine, for [`Program::call`].
    pub fn registers(&self) -> Vec<Word> {
        self.image.clone()
    }

    /// [`Machine::call`] on registers that [`Program::registers`] of this program gave.
    pub fn call<'r>(
        &self,
        registers: &'r mut [Word],
        arguments: &[Word],
        host: &mut dyn Host,
    ) -> Result<&'r [Word], EvalError> {
        let inputs = self.arguments.clone();
        if inputs.len() != arguments.len() {
            return Err(EvalError::Arguments {
                expected: inputs.len(),
                given: arguments.len(),
            });
        }
        registers[inputs].copy_from_slice(arguments);
        let stopped = match self.precision {
            Precision::Double => self.run::<false>(registers, host),
            Precision::Single => self.run::<true>(registers, host),
        };
        if let Some(at) = stopped {
            return Err(EvalError::Steps {
                steps: self.steps,
                function: self.function_at(at).to_owned(),
            });
        }
        Ok(&registers[self.result.clone()])
    }

    /// Runs the program; the instruction at which its steps ran out, if they did.
    fn run<const SINGLE: bool>(&self, r: &mut [Word], host: &mut dyn Host) -> Option<usize> {
        let code = self.code.as_slice();
        let mut steps = self.steps;
        let mut next = 0;
        while let Some(&i) = code.get(next) {
            next += 1;
            let (d, a, b, c) = (i.d as usize, i.a as usize, i.b as usize, i.c as usize);
            match i.op {
                Op::ScaleIndex => r[d] = Word::from_u32(r[a].to_u32().min(i.b).wrapping_mul(i.c)),
                Op::Copy => r.copy_within(a..a + c, d),
                Op::Fill => {
                    let word = r[a];
                    r[d..d + c].fill(word);
                }
                Op::LoadIndexed => {
                    let from = a + r[b].to_u32() as usize;
                    if c == 1 {
                        r[d] = r[from]
                    } else {
                        r.copy_within(from..from + c, d)
                    }
                }
                Op::StoreIndexed => {
                    let to = d + r[b].to_u32() as usize;
                    if c == 1 {
                        r[to] = r[a]
                    } else {
                        r.copy_within(a..a + c, to)
                    }
                }
                Op::External => {
                    let (arguments, result) = r[a..a + b + c].split_at_mut(b);
                    host.external(d, arguments, result);
                }
                Op::Jump => next = d,
                Op::JumpIf => {
                    if r[a].to_bool() {
                        next = d;
                    }
                }
                Op::JumpIfNot => {
                    if !r[a].to_bool() {
                        next = d;
                    }
                }
                Op::JumpIfEqual => {
                    if r[a].to_u32() == i.b {
                        next = d;
                    }
                }
                Op::JumpBack => {
                    let Some(rest) = steps.checked_sub(u64::from(i.b)) else {
                        return Some(next - 1);
                    };
                    steps = rest;
                    next = d;
                }
                op => r[d] = evaluate::<SINGLE>(op, || r[a], || r[b], || r[c]),
            }
        }
        None
    }
}

impl<'p> Machine<'p> {
    pub fn program(&self) -> &'p Program {
        self.program
    }

    /// Sets the global variable `index` of `Options::globals` for the calls that follow; variables
    /// are zero until then. A variable that the function does not reach is ignored.
    pub fn set_global(&mut self, index: usize, words: &[Word]) -> Result<(), EvalError> {
        let Some(range) = self.program.globals.get(index).cloned().flatten() else {
            return Ok(());
        };
        if range.len() != words.len() {
            return Err(EvalError::Global {
                index,
                expected: range.len(),
                given: words.len(),
            });
        }
        self.registers[range].copy_from_slice(words);
        Ok(())
    }

    /// Evaluates the function. `arguments` and the result are flattened in the order in which
    /// members, components, columns and elements are declared; in single precision floats must
    /// be f32 values. Takes no longer than `Limits::steps` allow.
    pub fn call(&mut self, arguments: &[Word], host: &mut dyn Host) -> Result<&[Word], EvalError> {
        self.program.call(&mut self.registers, arguments, host)
    }
}
