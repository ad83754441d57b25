//! Improves the code after lowering, and gives jumps their final targets.

use std::ops::Range;

use crate::evaluator::instruction::{Instruction, Op};

/// Code and marks with the prologue in front.
pub(crate) fn optimize(
    body: Vec<Instruction>,
    prologue: Vec<Instruction>,
    marks: Vec<(u32, u32)>,
    _result: Range<usize>,
    _registers: usize,
) -> (Vec<Instruction>, Vec<(u32, u32)>) {
    let shift = prologue.len() as u32;
    let mut code = prologue;
    code.extend(body);
    for instruction in code.iter_mut().filter(|instruction| instruction.op.is_jump()) {
        instruction.d += shift;
    }
    count_steps(&mut code);
    let marks = marks.into_iter().map(|(first, function)| (first + shift, function)).collect();
    (code, marks)
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
