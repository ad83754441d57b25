//! Executes a program for up to [`LANES`] samples at once: every register has a word for each.
//!
//! Where samples part, those that are behind go first: the rest wait where they jumped to. Code is
//! in the order of its source, so all meet again where branches and loops end.

use std::cell::Cell;

use crate::error::EvalError;
use crate::instruction::{Instruction, Op};
use crate::program::{Precision, Program};
use crate::scalar::{One, Operands, evaluate};
use crate::word::Word;

/// Most samples that are evaluated at once.
pub const LANES: usize = 64;

/// The words of a register, one for each sample.
pub type Row = [Cell<Word>; LANES];

/// Words that are computed before any is written.
const CHUNK: usize = 8;

/// Functions that the host implements instead of WGSL.
pub trait Host {
    /// Computes function `index` of `Options::externals` for the sample `lane`; arguments and
    /// result are flattened as those of a program are. `result` comes with the words of an earlier
    /// call, and all of it must be written.
    fn external(&mut self, index: usize, lane: usize, arguments: &[Word], result: &mut [Word]);
}

/// A host without functions: results of external functions are zero.
pub struct NoHost;

impl Host for NoHost {
    fn external(&mut self, _: usize, _: usize, _: &[Word], result: &mut [Word]) {
        result.fill(Word::ZERO);
    }
}

/// Memory of one thread for a program, reused from run to run.
#[derive(Clone)]
pub struct Registers {
    /// What is alike in every sample, and constants.
    alike: Vec<Word>,
    rows: Vec<Row>,
    /// Have the rows what `alike` says?
    are_spread: bool,
    /// Steps of each sample so far.
    spent: Row,
    /// Samples that wait, and at which instruction: the lowest last.
    waiting: Vec<(usize, u64)>,
    /// Arguments and result of a function of the host.
    external: Vec<Word>,
    /// Instruction at which the steps of a sample ran out.
    stopped_at: usize,
}

impl Registers {
    /// How much memory they take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.alike.as_slice()) + size_of_val(self.rows.as_slice())
    }
}

/// Registers of one thread for a program, for one sample at a time.
#[derive(Clone)]
pub struct Machine<'p> {
    program: &'p Program,
    registers: Registers,
}

/// A word for every sample.
fn row() -> Row {
    std::array::from_fn(|_| Cell::new(Word::ZERO))
}

impl Program {
    /// Registers for calls of one sample at a time from one thread.
    pub fn machine(&self) -> Machine<'_> {
        Machine {
            program: self,
            registers: self.registers(),
        }
    }

    /// The memory of a thread, for [`Program::run`].
    pub fn registers(&self) -> Registers {
        Registers {
            alike: self.image.clone(),
            rows: vec![row(); self.rows],
            are_spread: false,
            spent: row(),
            waiting: Vec::new(),
            external: Vec::new(),
            stopped_at: 0,
        }
    }

    /// Where the argument word `index` of every sample is written before a run; none if the function
    /// does not read it, or if it is one of those that are alike.
    pub fn argument<'r>(&self, registers: &'r Registers, index: usize) -> Option<&'r Row> {
        Some(&registers.rows[(*self.arguments.get(index)?)? as usize])
    }

    /// The word `index` of the result of every sample; none if it is the argument word of that index.
    pub fn result<'r>(&self, registers: &'r Registers, index: usize) -> Option<&'r Row> {
        Some(&registers.rows[(*self.result.get(index)?)? as usize])
    }

    /// Evaluates the function for the first `count` samples, whose arguments are in their rows, but
    /// for the last words, which are `alike` in all ([`Options::alike`]). Returns the samples that
    /// ended within `Limits::steps`, as bits.
    ///
    /// [`Options::alike`]: crate::Options::alike
    pub fn run(
        &self,
        registers: &mut Registers,
        alike: &[Word],
        count: usize,
        host: &mut dyn Host,
    ) -> u64 {
        let given = &mut registers.alike[self.alike.clone()];
        if given != alike {
            given.copy_from_slice(&alike[..given.len()]);
            registers.are_spread = false;
        }
        if !registers.are_spread {
            for i in &self.first {
                let word = |register: u32| registers.alike[register as usize];
                let (operands, mut result) = ([i.a, i.b, i.c].map(word), Word::ZERO);
                match self.precision {
                    Precision::Double => evaluate::<false>(i.op, One(operands, &mut result)),
                    Precision::Single | Precision::Strict => {
                        evaluate::<true>(i.op, One(operands, &mut result))
                    }
                }
                registers.alike[i.d as usize] = result;
            }
        }
        let spread = |&(from, to): &(u32, u32)| {
            let word = registers.alike[from as usize];
            registers.rows[to as usize]
                .iter()
                .for_each(|lane| lane.set(word));
        };
        if !registers.are_spread {
            self.spread.iter().for_each(spread);
        }
        self.spread_again.iter().for_each(spread);
        registers.are_spread = true;
        registers.spent.iter().for_each(|lane| lane.set(Word::ZERO));
        let all = u64::MAX >> (LANES - count.clamp(1, LANES));
        match self.precision {
            Precision::Double => self.execute::<false>(registers, all, host),
            Precision::Single | Precision::Strict => self.execute::<true>(registers, all, host),
        }
    }

    /// Executes the code for the samples `all`; those that ended.
    fn execute<const SINGLE: bool>(
        &self,
        registers: &mut Registers,
        all: u64,
        host: &mut dyn Host,
    ) -> u64 {
        let code = self.code.as_slice();
        let Registers {
            alike,
            rows,
            spent,
            waiting,
            external,
            stopped_at,
            ..
        } = registers;
        let rows = rows.as_slice();
        waiting.clear();
        let (mut active, mut next, mut ended, mut total) = (all, 0, all, 0u64);
        // Where others wait who are not ahead.
        let mut meeting = usize::MAX;
        loop {
            if next >= meeting || active == 0 {
                let Some((at, lanes)) = waiting.pop() else {
                    return ended;
                };
                if active != 0 && at < next {
                    wait(waiting, next, active);
                }
                active = lanes | if at == next { active } else { 0 };
                next = at;
                meeting = waiting.last().map_or(usize::MAX, |&(at, _)| at);
                continue;
            }
            let Some(i) = code.get(next) else {
                return ended;
            };
            next += 1;
            let (d, a, b, c) = (i.d as usize, i.a as usize, i.b as usize, i.c as usize);
            match i.op {
                Op::ScaleIndex => {
                    let offset = |word: Word| word.to_u32().min(i.b).wrapping_mul(i.c);
                    let lanes = Lanes::new(rows, i, active, 1);
                    lanes.each(|a, _, _| Word::from_u32(offset(a)));
                }
                Op::Copy if d <= a => (0..c).for_each(|at| copy(rows, d + at, a + at, active)),
                Op::Copy => (0..c)
                    .rev()
                    .for_each(|at| copy(rows, d + at, a + at, active)),
                Op::Fill => (0..c).for_each(|at| copy(rows, d + at, a, active)),
                Op::LoadIndexed => each_lane(active, |lane| {
                    let from = a + rows[b][lane].get().to_u32() as usize;
                    (0..c).for_each(|at| rows[d + at][lane].set(rows[from + at][lane].get()));
                }),
                Op::LoadTable => each_lane(active, |lane| {
                    let from = a + rows[b][lane].get().to_u32() as usize;
                    (0..c).for_each(|at| rows[d + at][lane].set(alike[from + at]));
                }),
                Op::StoreIndexed => each_lane(active, |lane| {
                    let to = d + rows[b][lane].get().to_u32() as usize;
                    (0..c).for_each(|at| rows[to + at][lane].set(rows[a + at][lane].get()));
                }),
                Op::External => {
                    external.resize(b + c, Word::ZERO);
                    let (arguments, result) = external.split_at_mut(b);
                    let (given, results) = rows[a..a + b + c].split_at(b);
                    each_lane(active, |lane| {
                        let given = arguments.iter_mut().zip(given);
                        given.for_each(|(word, row)| *word = row[lane].get());
                        host.external(d, lane, arguments, result);
                        let results = results.iter().zip(&*result);
                        results.for_each(|(row, word)| row[lane].set(*word));
                    });
                }
                Op::Jump => next = d,
                Op::JumpIf | Op::JumpIfNot | Op::JumpIfEqual => {
                    let wanted = if i.op == Op::JumpIfEqual { i.b } else { 0 };
                    let equal = lanes_of(&rows[a], active, |word| word.to_u32() == wanted);
                    let jumping = if i.op == Op::JumpIf {
                        active & !equal
                    } else {
                        equal
                    };
                    if jumping == active {
                        next = d;
                    } else if jumping != 0 {
                        wait(waiting, d, jumping);
                        meeting = meeting.min(d);
                        active &= !jumping;
                    }
                }
                Op::JumpBack => {
                    total += u64::from(i.b);
                    each_lane(active, |lane| {
                        spent[lane].set(Word::from_bits(
                            spent[lane].get().to_bits() + u64::from(i.b),
                        ));
                    });
                    if total > self.steps {
                        let out = lanes_of(spent, active, |spent| spent.to_bits() > self.steps);
                        if out != 0 {
                            *stopped_at = next - 1;
                            (active, ended) = (active & !out, ended & !out);
                        }
                    }
                    next = d;
                }
                op if self.precision == Precision::Strict => {
                    let arity = op.arity();
                    let read = |lane: usize| {
                        let of = |register: u32| rows[register as usize][lane].get().to_f64();
                        let floats = [i.a, i.b, i.c];
                        std::array::from_fn(|at| if at < arity { of(floats[at]) } else { 0.0 })
                    };
                    let mut open = 0;
                    each_lane(active, |lane| {
                        open |= u64::from(op.is_open(read(lane))) << lane
                    });
                    evaluate::<SINGLE>(op, Lanes::new(rows, i, active, arity));
                    let is_finite = |word: Word| word.to_f64().is_finite();
                    if op.makes_float() {
                        open |= active & !lanes_of(&rows[d], active, is_finite);
                    }
                    if open != 0 {
                        *stopped_at = next - 1;
                        (active, ended) = (active & !open, ended & !open);
                    }
                }
                op => evaluate::<SINGLE>(op, Lanes::new(rows, i, active, op.arity())),
            }
        }
    }
}

/// Lets samples wait at an instruction.
fn wait(waiting: &mut Vec<(usize, u64)>, at: usize, lanes: u64) {
    let place = waiting.partition_point(|&(other, _)| other > at);
    match waiting.get_mut(place) {
        Some((other, waiting)) if *other == at => *waiting |= lanes,
        _ => waiting.insert(place, (at, lanes)),
    }
}

/// Those of these samples whose word is as asked for.
#[inline(always)]
fn lanes_of(row: &Row, active: u64, is_so: impl Fn(Word) -> bool) -> u64 {
    let mut found = 0;
    each_chunk(active, |chunk, _| {
        let words = row.as_chunks::<CHUNK>().0[chunk].iter().enumerate();
        let bits = words.map(|(lane, word)| u64::from(is_so(word.get())) << lane);
        found |= bits.fold(0, |a, b| a | b) << (CHUNK * chunk);
    });
    found & active
}

/// Calls `f` for each of these samples.
#[inline(always)]
fn each_lane(mut lanes: u64, mut f: impl FnMut(usize)) {
    while lanes != 0 {
        f(lanes.trailing_zeros() as usize % LANES);
        lanes &= lanes - 1;
    }
}

/// Calls `f` for the chunks of samples some of which take part: with its index, and which of them.
#[inline(always)]
fn each_chunk(mut active: u64, mut f: impl FnMut(usize, u8)) {
    while active != 0 {
        let chunk = active.trailing_zeros() as usize / CHUNK % (LANES / CHUNK);
        f(chunk, (active >> (CHUNK * chunk)) as u8);
        active &= !(0xff << (CHUNK * chunk));
    }
}

fn copy(rows: &[Row], d: usize, a: usize, active: u64) {
    let [d, a] = [&rows[d], &rows[a]];
    let lanes = Lanes {
        d,
        of: [a; 3],
        active,
        is_free: false,
    };
    lanes.each(|a, _, _| a);
}

/// The operands of all samples that take part.
struct Lanes<'r> {
    d: &'r Row,
    of: [&'r Row; 3],
    active: u64,
    is_free: bool,
}

impl<'r> Lanes<'r> {
    /// Those of an instruction with so many operands.
    #[inline(always)]
    fn new(rows: &'r [Row], i: &Instruction, active: u64, arity: usize) -> Lanes<'r> {
        let a = &rows[i.a as usize];
        let more = |at: usize, register: u32| match arity > at {
            true => &rows[register as usize],
            false => a,
        };
        Lanes {
            d: &rows[i.d as usize],
            of: [a, more(1, i.b), more(2, i.c)],
            active,
            is_free: i.is_free,
        }
    }
}

impl Operands for Lanes<'_> {
    #[inline(never)]
    fn each(self, f: impl Fn(Word, Word, Word) -> Word) {
        if self.active.is_power_of_two() {
            return self.each_slowly(f);
        }
        each_chunk(self.active, |chunk, active| {
            let [a, b, c] = self.of.map(|row| &row.as_chunks::<CHUNK>().0[chunk]);
            let d = &self.d.as_chunks::<CHUNK>().0[chunk];
            let result = |lane: usize| f(a[lane].get(), b[lane].get(), c[lane].get());
            if self.is_free || active == u8::MAX {
                let results: [Word; CHUNK] = std::array::from_fn(result);
                d.iter().zip(results).for_each(|(to, word)| to.set(word));
            } else {
                each_lane(active.into(), |lane| {
                    d[lane % CHUNK].set(result(lane % CHUNK))
                });
            }
        });
    }

    #[inline(never)]
    fn each_slowly(self, f: impl Fn(Word, Word, Word) -> Word) {
        let [a, b, c] = self.of;
        each_lane(self.active, |lane| {
            self.d[lane].set(f(a[lane].get(), b[lane].get(), c[lane].get()));
        });
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
        self.registers.alike[range].copy_from_slice(words);
        self.registers.are_spread = false;
        Ok(())
    }

    /// Evaluates the function. `arguments` and the result are flattened in the order in which
    /// members, components, columns and elements are declared; in single precision floats must
    /// be f32 values. Takes no longer than `Limits::steps` allow.
    pub fn call(
        &mut self,
        arguments: &[Word],
        host: &mut dyn Host,
    ) -> Result<Vec<Word>, EvalError> {
        let (program, registers) = (self.program, &mut self.registers);
        let expected = program.argument_words();
        if expected != arguments.len() {
            return Err(EvalError::Arguments {
                expected,
                given: arguments.len(),
            });
        }
        for (index, word) in arguments.iter().enumerate() {
            if let Some(row) = program.argument(registers, index) {
                row[0].set(*word);
            }
        }
        let alike = &arguments[expected - program.alike.len()..];
        if program.run(registers, alike, 1, host) == 0 {
            return Err(EvalError::Steps {
                steps: program.steps,
                function: program.function_at(registers.stopped_at).to_owned(),
            });
        }
        let word = |(index, argument): (usize, Word)| {
            let row = program.result(registers, index);
            row.map_or(argument, |row| row[0].get())
        };
        let arguments = arguments
            .iter()
            .copied()
            .chain(std::iter::repeat(Word::ZERO));
        let results = arguments.take(program.result_words()).enumerate();
        Ok(results.map(word).collect())
    }
}
