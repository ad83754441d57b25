//! Gives registers rows of words, one word for each sample: what is alike in all samples is computed
//! once before, and values that are not needed at the same time share a row.

use std::collections::HashMap;
use std::ops::Range;

use crate::code::Code;
use crate::instruction::{Instruction, Op};
use crate::optimize::{compact, for_reads};

/// What a register is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Alike in all samples.
    Alike,
    /// Written once, by a pure instruction, and read from there on.
    Temporary,
    Variable,
}

/// Where the registers of a program are.
pub(crate) struct Rows {
    pub count: usize,
    pub spread: Vec<(u32, u32)>,
    pub spread_again: Vec<(u32, u32)>,
    pub arguments: Vec<Option<u32>>,
    pub result: Vec<Option<u32>>,
}

/// What is known of a program's registers beside its code.
pub(crate) struct Interface<'a> {
    pub arguments: Range<u32>,
    /// Words at the end of the arguments that are alike in all samples.
    pub alike: u32,
    pub result: Range<u32>,
    pub globals: &'a [Option<Range<usize>>],
}

impl Interface<'_> {
    /// Is a register of the result that of the argument word with the same index?
    fn is_argument_of_result(&self, register: u32) -> bool {
        self.arguments.start == self.result.start && self.arguments.contains(&register)
    }
}

/// A loop, from its first instruction to the jump back.
struct Loop {
    start: usize,
    end: usize,
    parent: Option<usize>,
}

/// Takes what is alike in all samples out of `all`, and lets the rest work on rows; the former.
pub(crate) fn assign(
    all: &mut Vec<Instruction>,
    marks: &mut [(u32, u32)],
    code: &Code,
    interface: &Interface<'_>,
) -> (Vec<Instruction>, Rows) {
    let mut kinds = kinds_of(code, interface);
    let first = take_alike(all, marks, &mut kinds);
    let indexed = indexed_of(code);
    use_tables(all, &indexed, &kinds);
    let lives = Lives::of(all, &indexed, interface, &kinds);
    let rows = place(all, interface, &kinds, &lives).finish(interface, &kinds, &lives);
    (first, rows)
}

fn kinds_of(code: &Code, interface: &Interface<'_>) -> Vec<Kind> {
    let kind = |register: usize| {
        if code.is_constant[register] {
            Kind::Alike
        } else if code.is_temporary[register] {
            Kind::Temporary
        } else {
            Kind::Variable
        }
    };
    let mut kinds: Vec<Kind> = (0..code.image.len()).map(kind).collect();
    let end = interface.arguments.end as usize;
    kinds[end - interface.alike as usize..end].fill(Kind::Alike);
    for range in interface.globals.iter().flatten() {
        kinds[range.clone()].fill(Kind::Alike);
    }
    for range in &code.variables {
        kinds[range.start as usize..range.end as usize].fill(Kind::Variable);
    }
    kinds
}

/// Takes out the pure instructions all of whose operands are alike in all samples.
fn take_alike(
    all: &mut Vec<Instruction>,
    marks: &mut [(u32, u32)],
    kinds: &mut [Kind],
) -> Vec<Instruction> {
    let mut first = Vec::new();
    let mut is_kept = vec![true; all.len()];
    for (at, i) in all.iter().enumerate() {
        let operands = [i.a, i.b, i.c].into_iter().take(i.op.arity());
        if i.op.is_pure()
            && kinds[i.d as usize] == Kind::Temporary
            && operands.clone().all(|a| kinds[a as usize] == Kind::Alike)
        {
            kinds[i.d as usize] = Kind::Alike;
            is_kept[at] = false;
            first.push(*i);
        }
    }
    *all = compact(std::mem::take(all), &is_kept, marks);
    first
}

/// Where values end that are read through an index, by where they begin.
fn indexed_of(code: &Code) -> HashMap<u32, u32> {
    let mut ends = HashMap::new();
    for range in &code.indexed {
        let end = ends.entry(range.start).or_insert(range.end);
        *end = range.end.max(*end);
    }
    ends
}

/// Reads from what is alike in all samples need no rows.
fn use_tables(all: &mut [Instruction], indexed: &HashMap<u32, u32>, kinds: &[Kind]) {
    for i in all.iter_mut().filter(|i| i.op == Op::LoadIndexed) {
        let end = indexed.get(&i.a).copied().unwrap_or(i.a + 1);
        let values = &kinds[i.a as usize..end as usize];
        if values.iter().all(|kind| *kind == Kind::Alike) {
            i.op = Op::LoadTable;
        }
    }
}

/// The loops, and the innermost one around each instruction.
fn loops_of(all: &[Instruction]) -> (Vec<Loop>, Vec<Option<usize>>) {
    let jumps = all.iter().enumerate().rev();
    let mut loops: Vec<Loop> = jumps
        .filter(|(_, i)| i.op == Op::JumpBack)
        .map(|(end, i)| Loop {
            start: i.d as usize,
            end,
            parent: None,
        })
        .collect();
    // Of those that begin at the same instruction, the outer one comes first.
    loops.sort_by_key(|l| l.start);
    let mut loop_of = Vec::with_capacity(all.len());
    let (mut open, mut next) = (None, 0);
    for at in 0..all.len() {
        while next < loops.len() && loops[next].start == at {
            loops[next].parent = open.replace(next);
            next += 1;
        }
        loop_of.push(open);
        while let Some(inner) = open.filter(|&inner: &usize| loops[inner].end == at) {
            open = loops[inner].parent;
        }
    }
    (loops, loop_of)
}

/// From where to where registers are needed, and how they may be placed.
struct Lives {
    written: Vec<usize>,
    /// The last instruction that needs the word; 0 if none does.
    last: Vec<usize>,
    /// It needs a row although it is no variable, and it must lie beside its neighbors.
    is_adjacent: Vec<bool>,
    is_needed: Vec<bool>,
    is_changed: Vec<bool>,
}

impl Lives {
    fn of(
        all: &[Instruction],
        indexed: &HashMap<u32, u32>,
        interface: &Interface<'_>,
        kinds: &[Kind],
    ) -> Lives {
        let (loops, loop_of) = loops_of(all);
        let count = kinds.len();
        let mut lives = Lives {
            written: vec![0; count],
            last: vec![0; count],
            is_adjacent: vec![false; count],
            is_needed: vec![false; count],
            is_changed: vec![false; count],
        };
        let mut adjacent = |range: Range<u32>| {
            lives.is_adjacent[range.start as usize..range.end as usize].fill(true);
        };
        for i in all {
            match i.op {
                Op::Copy | Op::StoreIndexed => adjacent(i.a..i.a + i.c),
                Op::External => adjacent(i.a..i.a + i.b + i.c),
                Op::LoadIndexed => {
                    let end = indexed.get(&i.a);
                    end.into_iter().for_each(|&end| adjacent(i.a..end));
                }
                _ => {}
            }
        }
        for register in interface.result.clone() {
            let at = register as usize;
            lives.is_adjacent[at] |= kinds[at] == Kind::Temporary;
            lives.is_needed[at] |= !interface.is_argument_of_result(register);
        }
        for (at, i) in all.iter().enumerate() {
            for_reads(i, |register| {
                let register = register as usize;
                lives.is_needed[register] = true;
                if kinds[register] != Kind::Temporary {
                    return;
                }
                // What comes from outside of a loop is needed in its next turn, too.
                let mut last = at;
                let mut around = loop_of[at];
                while let Some(l) = around.map(|l| &loops[l]) {
                    if l.start <= lives.written[register] {
                        break;
                    }
                    (last, around) = (l.end, l.parent);
                }
                lives.last[register] = lives.last[register].max(last);
            });
            let d = i.d as usize;
            match i.op {
                Op::External => (i.a + i.b..i.a + i.b + i.c)
                    .for_each(|result| lives.is_changed[result as usize] = true),
                Op::Copy | Op::Fill | Op::LoadIndexed | Op::LoadTable => {
                    lives.is_changed[d..d + i.c as usize].fill(true);
                }
                // It may write to any element of a variable.
                Op::StoreIndexed => {
                    let arguments = interface.arguments.clone();
                    if arguments.contains(&i.d) {
                        let range = arguments.start as usize..arguments.end as usize;
                        lives.is_changed[range].fill(true);
                    }
                }
                op if op.is_jump() => {}
                _ => {
                    lives.is_changed[d] = true;
                    lives.written[d] = at;
                }
            }
        }
        // What a loop leaves behind keeps its row, which only samples that take part change.
        for register in 0..count {
            let inside = loop_of.get(lives.written[register]).copied().flatten();
            if inside.is_some_and(|l| loops[l].end < lives.last[register]) {
                lives.is_adjacent[register] = true;
                lives.last[register] = usize::MAX;
            }
        }
        lives
    }
}

/// Rows of registers; none of those that have none.
struct Placed {
    rows: Vec<Option<u32>>,
    count: u32,
}

/// Places all registers, and makes the code work on rows.
fn place(
    all: &mut [Instruction],
    interface: &Interface<'_>,
    kinds: &[Kind],
    lives: &Lives,
) -> Placed {
    let mut rows = vec![None; kinds.len()];
    let mut count = 0u32;
    // Any element may be meant.
    let is_indexed = |i: &Instruction| match i.op {
        Op::LoadIndexed => interface.arguments.contains(&i.a),
        Op::StoreIndexed => interface.arguments.contains(&i.d),
        _ => false,
    };
    let has_indices = all.iter().any(is_indexed);
    for (register, kind) in kinds.iter().enumerate() {
        let is_used = lives.is_needed[register] || lives.is_adjacent[register];
        let has_row = match kind {
            Kind::Alike => is_used,
            Kind::Temporary => lives.is_adjacent[register],
            Kind::Variable => {
                let given = interface.arguments.contains(&(register as u32));
                is_used || lives.is_changed[register] || has_indices || !given
            }
        };
        if has_row {
            rows[register] = Some(count);
            count += 1;
        }
    }
    let mut free: Vec<u32> = Vec::new();
    // Temporaries by the last instruction that needs them.
    let mut ends: Vec<(usize, usize)> = (0..kinds.len())
        .filter(|&register| kinds[register] == Kind::Temporary && rows[register].is_none())
        .map(|register| (lives.last[register], register))
        .collect();
    ends.sort_unstable();
    let mut ends = ends.into_iter().peekable();
    for (at, i) in all.iter_mut().enumerate() {
        while let Some((_, register)) = ends.next_if(|&(last, _)| last <= at) {
            free.extend(rows[register]);
        }
        let is_written = !(i.op.is_jump() || i.op == Op::External);
        let d = i.d as usize;
        i.is_free = i.op.is_pure() && kinds[d] == Kind::Temporary && lives.last[d] != usize::MAX;
        if is_written && rows[d].is_none() {
            rows[d] = Some(free.pop().unwrap_or_else(|| {
                count += 1;
                count - 1
            }));
        }
        let row = |register: &mut u32| *register = rows[*register as usize].unwrap_or(0);
        if is_written {
            row(&mut i.d);
        }
        match i.op {
            Op::ScaleIndex
            | Op::Copy
            | Op::Fill
            | Op::External
            | Op::JumpIf
            | Op::JumpIfNot
            | Op::JumpIfEqual => row(&mut i.a),
            Op::LoadIndexed | Op::StoreIndexed => {
                row(&mut i.a);
                row(&mut i.b);
            }
            Op::LoadTable => row(&mut i.b),
            Op::Jump | Op::JumpBack => {}
            op => {
                let operands = [&mut i.a, &mut i.b, &mut i.c];
                operands.into_iter().take(op.arity()).for_each(row);
            }
        }
    }
    Placed { rows, count }
}

impl Placed {
    fn finish(self, interface: &Interface<'_>, kinds: &[Kind], lives: &Lives) -> Rows {
        let row = |register: u32| self.rows[register as usize];
        let with_row = |(register, kind): (usize, &Kind)| {
            let row = self.rows[register].filter(|_| *kind == Kind::Alike)?;
            Some((register as u32, row))
        };
        let Range { start, end } = interface.arguments.clone();
        let alike = end - interface.alike;
        let again = (alike..end).filter(|&register| kinds[register as usize] != Kind::Alike);
        let result = |register: u32| {
            let is_argument = interface.is_argument_of_result(register);
            row(register).filter(|_| !is_argument || lives.is_changed[register as usize])
        };
        Rows {
            count: self.count as usize,
            spread: kinds.iter().enumerate().filter_map(with_row).collect(),
            spread_again: again.filter_map(|word| Some((word, row(word)?))).collect(),
            arguments: (start..alike).map(row).collect(),
            result: interface.result.clone().map(result).collect(),
        }
    }
}
