//! Code while it is being written: registers, constants and jumps.

use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

use crate::instruction::{Instruction, Op};
use crate::program::{Limits, Precision};
use crate::scalar::{One, evaluate};
use crate::word::Word;

/// A limit was reached.
pub(crate) enum Full {
    Slots,
    Instructions,
}

/// Registers that hold a value, one for each of its words.
#[derive(Clone, Debug)]
pub(crate) enum Words {
    Range { start: u32, len: u32 },
    Repeat { register: u32, len: u32 },
    List(Rc<[u32]>),
}

impl Words {
    pub(crate) fn one(register: u32) -> Words {
        Words::Range {
            start: register,
            len: 1,
        }
    }

    pub(crate) fn none() -> Words {
        Words::Range { start: 0, len: 0 }
    }

    pub(crate) fn len(&self) -> u32 {
        match self {
            Words::Range { len, .. } | Words::Repeat { len, .. } => *len,
            Words::List(list) => list.len() as u32,
        }
    }

    /// Register of a word; the last for an index beyond.
    pub(crate) fn at(&self, index: u32) -> u32 {
        match self {
            Words::Range { start, len } => start + index.min(len.saturating_sub(1)),
            Words::Repeat { register, .. } => *register,
            Words::List(list) => list
                .get(index as usize)
                .or(list.last())
                .copied()
                .unwrap_or(0),
        }
    }

    pub(crate) fn slice(&self, offset: u32, words: u32) -> Words {
        match self {
            Words::Range { start, .. } => Words::Range {
                start: start + offset,
                len: words,
            },
            Words::Repeat { register, .. } => Words::Repeat {
                register: *register,
                len: words,
            },
            Words::List(_) => (offset..offset + words)
                .map(|index| self.at(index))
                .collect(),
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> {
        (0..self.len()).map(|index| self.at(index))
    }
}

impl FromIterator<u32> for Words {
    fn from_iter<I: IntoIterator<Item = u32>>(registers: I) -> Words {
        let list: Rc<[u32]> = registers.into_iter().collect();
        match list.first() {
            Some(&start)
                if list
                    .iter()
                    .enumerate()
                    .all(|(at, &register)| start + at as u32 == register) =>
            {
                Words::Range {
                    start,
                    len: list.len() as u32,
                }
            }
            _ => Words::List(list),
        }
    }
}

/// A place in the code that jumps go to before it is known.
#[derive(Default)]
pub(crate) struct Label(Vec<usize>);

pub(crate) struct Code {
    pub instructions: Vec<Instruction>,
    /// First value of every register.
    pub image: Vec<Word>,
    /// Registers that one pure instruction writes, and that are no part of a variable.
    pub is_temporary: Vec<bool>,
    /// Registers of values that are read through an index.
    pub indexed: Vec<Range<u32>>,
    /// Registers of arguments that are variables too.
    pub variables: Vec<Range<u32>>,
    precision: Precision,
    limits: Limits,
    /// Registers that never change.
    pub is_constant: Vec<bool>,
    constants: HashMap<Word, u32>,
    tables: HashMap<Vec<Word>, u32>,
    /// Everything lowered so far, whether or not it made code.
    work: usize,
}

impl Code {
    pub(crate) fn new(precision: Precision, limits: Limits) -> Code {
        Code {
            instructions: Vec::new(),
            image: Vec::new(),
            is_temporary: Vec::new(),
            indexed: Vec::new(),
            variables: Vec::new(),
            precision,
            limits,
            is_constant: Vec::new(),
            constants: HashMap::new(),
            tables: HashMap::new(),
            work: 0,
        }
    }

    /// Counts towards the length of the code; for what may make none.
    pub(crate) fn count(&mut self, words: u32) -> Result<(), Full> {
        self.work += 1 + words as usize / 8;
        // Lowering may take longer than its result is long, but not without end.
        if self.work > self.limits.instructions.saturating_mul(4) {
            Err(Full::Instructions)
        } else {
            Ok(())
        }
    }

    pub(crate) fn allocate(&mut self, words: u32) -> Result<u32, Full> {
        let start = self.image.len();
        let end = start + words as usize;
        if end > self.limits.slots.min(i32::MAX as usize) {
            return Err(Full::Slots);
        }
        self.image.resize(end, Word::ZERO);
        self.is_constant.resize(end, false);
        self.is_temporary.resize(end, false);
        Ok(start as u32)
    }

    pub(crate) fn constant(&mut self, word: Word) -> Result<u32, Full> {
        if let Some(&register) = self.constants.get(&word) {
            return Ok(register);
        }
        let register = self.allocate(1)?;
        self.image[register as usize] = word;
        self.is_constant[register as usize] = true;
        self.constants.insert(word, register);
        Ok(register)
    }

    /// Value of a register that never changes.
    pub(crate) fn known(&self, register: u32) -> Option<Word> {
        let register = register as usize;
        self.is_constant
            .get(register)?
            .then(|| self.image[register])
    }

    pub(crate) fn push(&mut self, op: Op, d: u32, a: u32, b: u32, c: u32) -> Result<(), Full> {
        if self.instructions.len() >= self.limits.instructions {
            return Err(Full::Instructions);
        }
        self.instructions.push(Instruction::new(op, d, a, b, c));
        Ok(())
    }

    pub(crate) fn one(&mut self, op: Op, a: u32) -> Result<u32, Full> {
        self.pure(op, a, a, a)
    }

    pub(crate) fn two(&mut self, op: Op, a: u32, b: u32) -> Result<u32, Full> {
        self.pure(op, a, b, a)
    }

    /// Register with the result of a pure instruction, which is computed at once if its operands
    /// are constants.
    pub(crate) fn pure(&mut self, op: Op, a: u32, b: u32, c: u32) -> Result<u32, Full> {
        if let (Some(a), Some(b), Some(c)) = (self.known(a), self.known(b), self.known(c)) {
            let mut word = Word::ZERO;
            let one = One([a, b, c], &mut word);
            match self.precision {
                Precision::Double => evaluate::<false>(op, one),
                Precision::Single | Precision::Strict => evaluate::<true>(op, one),
            }
            return self.constant(word);
        }
        let d = self.allocate(1)?;
        self.is_temporary[d as usize] = true;
        self.push(op, d, a, b, c)?;
        Ok(d)
    }

    /// Copies words to the registers from `d` on; right also where they are among those registers.
    pub(crate) fn copy(&mut self, d: u32, words: &Words) -> Result<(), Full> {
        let len = words.len();
        match *words {
            Words::Range { start, .. } if start == d => Ok(()),
            Words::Range { start, .. } if len > 4 => self.push(Op::Copy, d, start, 0, len),
            Words::Repeat { register, .. } if len > 4 => self.push(Op::Fill, d, register, 0, len),
            _ => {
                let (first, end) = (d, d + len);
                let moves = || {
                    words
                        .iter()
                        .enumerate()
                        .filter(|&(at, from)| d + at as u32 != from)
                };
                if moves().any(|(_, from)| (first..end).contains(&from)) {
                    let scratch = self.allocate(len)?;
                    self.moves(scratch, words)?;
                    return self.moves(
                        d,
                        &Words::Range {
                            start: scratch,
                            len,
                        },
                    );
                }
                self.moves(d, words)
            }
        }
    }

    /// Moves words one by one, or in runs.
    fn moves(&mut self, d: u32, words: &Words) -> Result<(), Full> {
        let mut at = 0;
        while at < words.len() {
            let from = words.at(at);
            let mut run = 1;
            while at + run < words.len() && words.at(at + run) == from + run {
                run += 1;
            }
            if run > 4 {
                self.push(Op::Copy, d + at, from, 0, run)?;
                at += run;
            } else {
                if d + at != from {
                    self.push(Op::Move, d + at, from, from, from)?;
                }
                at += 1;
            }
        }
        Ok(())
    }

    /// First of adjacent registers that hold the words.
    pub(crate) fn adjacent(&mut self, words: &Words) -> Result<u32, Full> {
        if let Words::Range { start, .. } = *words {
            return Ok(start);
        }
        let len = words.len();
        if let Some(known) = words
            .iter()
            .map(|register| self.known(register))
            .collect::<Option<Vec<Word>>>()
        {
            if let Some(&start) = self.tables.get(&known) {
                return Ok(start);
            }
            let start = self.allocate(len)?;
            let range = start as usize..start as usize + known.len();
            self.image[range.clone()].copy_from_slice(&known);
            self.is_constant[range].fill(true);
            self.tables.insert(known, start);
            return Ok(start);
        }
        let start = self.allocate(len)?;
        self.copy(start, words)?;
        Ok(start)
    }

    /// A jump to a label; `a` and `b` as the instruction has them.
    pub(crate) fn jump(&mut self, op: Op, a: u32, b: u32, to: &mut Label) -> Result<(), Full> {
        to.0.push(self.instructions.len());
        self.push(op, 0, a, b, 0)
    }

    /// The label is here.
    pub(crate) fn bind(&mut self, label: Label) {
        let here = self.instructions.len() as u32;
        for at in label.0 {
            self.instructions[at].d = here;
        }
    }

    /// Ends a loop that began at instruction `start`.
    pub(crate) fn jump_back(&mut self, start: usize) -> Result<(), Full> {
        self.push(Op::JumpBack, start as u32, 0, 0, 0)
    }
}
