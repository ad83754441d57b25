//! Improves the code after lowering, and gives jumps their final targets.

use std::ops::Range;

use crate::code::Code;
use crate::instruction::{Instruction, Op};

/// Instructions over which a result is moved up to where it is computed.
const WINDOW: usize = 64;

/// Code and marks, with the prologue in front. `result` are the registers read in the end.
pub(crate) fn optimize(
    code: &mut Code,
    prologue: Vec<Instruction>,
    marks: Vec<(u32, u32)>,
    result: Range<usize>,
) -> (Vec<Instruction>, Vec<(u32, u32)>) {
    let shift = prologue.len() as u32;
    let mut all = prologue;
    all.append(&mut code.instructions);
    for instruction in all
        .iter_mut()
        .filter(|instruction| instruction.op.is_jump())
    {
        instruction.d += shift;
    }
    let mut marks: Vec<(u32, u32)> = marks
        .into_iter()
        .map(|(first, function)| (first + shift, function))
        .collect();

    let mut reads = count_reads(&all, code, result);
    let mut is_kept = vec![true; all.len()];
    drop_unread(&all, code, &mut reads, &mut is_kept);
    drop_moves(&mut all, code, &reads, &mut is_kept);
    let mut all = compact(all, &is_kept, &mut marks);
    count_steps(&mut all);
    (all, marks)
}

/// How often each register is read; registers that may be read through an index count once more.
fn count_reads(all: &[Instruction], code: &Code, result: Range<usize>) -> Vec<u32> {
    let mut reads = vec![0u32; code.image.len()];
    for instruction in all {
        for_reads(instruction, |register| reads[register as usize] += 1);
    }
    for register in code.indexed.iter().flat_map(|range| range.clone()) {
        reads[register as usize] += 2;
    }
    for register in result {
        reads[register] += 2;
    }
    reads
}

/// Calls `f` for each register that an instruction reads, but not for those it reads through an
/// index.
pub(crate) fn for_reads(instruction: &Instruction, mut f: impl FnMut(u32)) {
    let Instruction { op, a, b, c, .. } = *instruction;
    match op {
        Op::Copy => (a..a + c).for_each(f),
        Op::StoreIndexed => {
            f(b);
            (a..a + c).for_each(f);
        }
        Op::External => (a..a + b).for_each(f),
        Op::LoadIndexed | Op::LoadTable => f(b),
        Op::ScaleIndex | Op::Fill | Op::JumpIf | Op::JumpIfNot | Op::JumpIfEqual => f(a),
        Op::Jump | Op::JumpBack => {}
        _ => [a, b, c].into_iter().take(op.arity()).for_each(f),
    }
}

/// Drops pure instructions whose results are not read.
fn drop_unread(all: &[Instruction], code: &Code, reads: &mut [u32], is_kept: &mut [bool]) {
    for (at, instruction) in all.iter().enumerate().rev() {
        let d = instruction.d as usize;
        if instruction.op.is_pure() && code.is_temporary[d] && reads[d] == 0 {
            is_kept[at] = false;
            for_reads(instruction, |register| reads[register as usize] -= 1);
        }
    }
}

/// Drops moves of a result that is read only there: it is computed into its destination.
fn drop_moves(all: &mut [Instruction], code: &Code, reads: &[u32], is_kept: &mut [bool]) {
    let mut is_target = vec![false; all.len() + 1];
    for instruction in all.iter().filter(|instruction| instruction.op.is_jump()) {
        is_target[instruction.d as usize] = true;
    }
    for at in 0..all.len() {
        let Instruction { op, d, a, .. } = all[at];
        if op != Op::Move
            || !is_kept[at]
            || !code.is_temporary[a as usize]
            || reads[a as usize] != 1
        {
            continue;
        }
        let mut before = at;
        while before > at.saturating_sub(WINDOW) && !is_target[before] {
            before -= 1;
            if !is_kept[before] {
                continue;
            }
            let earlier = all[before];
            if !earlier.op.is_pure() {
                break;
            }
            if earlier.d == a {
                all[before].d = d;
                is_kept[at] = false;
                break;
            }
            let mut is_read = false;
            for_reads(&earlier, |register| is_read |= register == d);
            if is_read || earlier.d == d {
                break;
            }
        }
    }
}

pub(crate) fn compact(
    all: Vec<Instruction>,
    is_kept: &[bool],
    marks: &mut [(u32, u32)],
) -> Vec<Instruction> {
    let mut moved = Vec::with_capacity(all.len() + 1);
    let mut kept = 0;
    for &keep in is_kept {
        moved.push(kept);
        kept += u32::from(keep);
    }
    moved.push(kept);
    for (first, _) in marks.iter_mut() {
        *first = moved[*first as usize];
    }
    let mut rest: Vec<Instruction> = all
        .into_iter()
        .zip(is_kept)
        .filter(|(_, keep)| **keep)
        .map(|(instruction, _)| instruction)
        .collect();
    for instruction in rest
        .iter_mut()
        .filter(|instruction| instruction.op.is_jump())
    {
        instruction.d = moved[instruction.d as usize];
    }
    rest
}

/// Gives the end of every loop the steps that one turn counts.
fn count_steps(code: &mut [Instruction]) {
    let mut sums = Vec::with_capacity(code.len() + 1);
    let mut sum = 0u64;
    for instruction in code.iter() {
        sums.push(sum);
        sum += instruction.weight();
    }
    for at in 0..code.len() {
        if code[at].op == Op::JumpBack {
            let turn = sums[at] + 1 - sums[code[at].d as usize];
            code[at].b = u32::try_from(turn).unwrap_or(u32::MAX);
        }
    }
}
