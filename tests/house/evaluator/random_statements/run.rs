//! Direct execution of programs.

use super::{generator::Statement, text::index};

pub type V = [i32; 4];

#[derive(Clone, Default)]
pub struct S {
    pub v: V,
    pub n: [i32; 3],
    pub m: [[i32; 2]; 2],
}

#[derive(Clone)]
pub struct State {
    pub s: S,
    pub w: V,
    pub g: V,
    pub lets: Vec<(usize, V)>,
    pub copies: Vec<(usize, S)>,
}

impl Default for State {
    fn default() -> State {
        State {
            s: S::default(),
            w: [0; 4],
            g: [1, 2, 3, 4],
            lets: Vec::new(),
            copies: Vec::new(),
        }
    }
}

pub fn result(state: &State) -> V {
    let S { v, n, m } = &state.s;
    let more = [m[0][1], m[1][0], m[1][1], 0];
    let tail = [n[0], n[1], n[2], m[0][0]];
    std::array::from_fn(|at| {
        let sum = v[at]
            .wrapping_add(state.w[at].wrapping_mul(3))
            .wrapping_add(state.g[at].wrapping_mul(5));
        sum.wrapping_add(tail[at].wrapping_mul(7))
            .wrapping_add(more[at].wrapping_mul(11))
    })
}

#[derive(Clone, Copy, PartialEq)]
pub enum End {
    Block,
    Return,
}

pub fn run(statements: &[Statement], state: &mut State) -> End {
    let scope = (state.lets.len(), state.copies.len());
    let mut end = End::Block;
    for statement in statements {
        end = step(statement, state);
        if end == End::Return {
            break;
        }
    }
    state.lets.truncate(scope.0);
    state.copies.truncate(scope.1);
    end
}

pub fn step(statement: &Statement, state: &mut State) -> End {
    match statement {
        Statement::Let(name, source) => state.lets.push((*name, source.value(state))),
        Statement::Copy(name) => state.copies.push((*name, state.s.clone())),
        Statement::SetV(source) => state.s.v = source.value(state),
        Statement::SetW(source) => state.w = source.value(state),
        Statement::SetG(source) => state.g = source.value(state),
        Statement::SetComponent(at, number) => state.s.v[*at] = number.value(state),
        Statement::AddW(at, number) => {
            state.w[*at] = state.w[*at].wrapping_add(number.value(state))
        }
        Statement::SetDynamic(at, number) => {
            let at = index(at.value(state), 4);
            state.s.v[at] = number.value(state);
        }
        Statement::SetN(at, number) => {
            let at = index(at.value(state), 3);
            state.s.n[at] = number.value(state);
        }
        Statement::SetM(at, component, number) => {
            let at = index(at.value(state), 2);
            state.s.m[at][*component] = number.value(state);
        }
        Statement::SwapM => state.s.m = [[state.s.m[1][1], state.s.m[1][0]], state.s.m[0]],
        Statement::Touch(source, number) => {
            let (q, k) = (source.value(state), number.value(state));
            let before = state.s.v;
            state.s.v[0] = q[1].wrapping_add(k);
            state.g[1] = state.g[1].wrapping_add(q[0]);
            state.w = if k > 0 {
                std::array::from_fn(|at| q[at].wrapping_add(state.s.v[at]))
            } else {
                state.s.v.reverse();
                before
            };
        }
        Statement::Blend(source) => {
            let q = source.value(state);
            let v = &mut state.s.v;
            v[0] = v[0].wrapping_add(1);
            v[2] = q[0];
            *v = std::array::from_fn(|at| v[at].wrapping_add(q[at]));
        }
        Statement::Late(number, source) => {
            if number.value(state) > 0 {
                let late = source.value(state);
                state.w[1] = state.w[1].wrapping_add(late[0]);
                state.w = std::array::from_fn(|at| state.w[at].wrapping_add(late[at]));
            }
        }
        Statement::LoopOver(source, component) => {
            let r = source.value(state);
            for _ in 0..3 {
                state.w = std::array::from_fn(|at| state.w[at].wrapping_add(r[at]));
                state.s.v[*component] = state.s.v[*component].wrapping_add(1);
                state.g[*component] = state.g[*component].wrapping_sub(2);
            }
        }
        Statement::Read => {
            let before = state.s.v;
            state.s.v[0] = state.s.v[0].wrapping_add(1);
            state.w = std::array::from_fn(|at| state.w[at].wrapping_add(before[at]));
        }
        Statement::Globals(number) => {
            let k = number.value(state);
            let before = state.g;
            state.g[0] ^= k;
            let r = if k < 0 { before } else { state.g };
            state.g[0] = state.g[0].wrapping_add(1);
            state.w = std::array::from_fn(|at| state.w[at] ^ r[at]);
        }
        Statement::Restore(name) => {
            state.s = state
                .copies
                .iter()
                .rev()
                .find(|(other, _)| other == name)
                .expect("in scope")
                .1
                .clone();
        }
        Statement::If(number, accept, reject) => {
            return run(
                if number.value(state) > 0 {
                    accept
                } else {
                    reject
                },
                state,
            );
        }
        Statement::For(_, count, body) => {
            for _ in 0..*count {
                if run(body, state) == End::Return {
                    return End::Return;
                }
            }
        }
        Statement::Switch(number, first, second, other) => {
            return run(
                match number.value(state) & 3 {
                    0 => first,
                    1 | 2 => second,
                    _ => other,
                },
                state,
            );
        }
        Statement::BreakIf(number) => {
            if number.value(state) <= 3 {
                state.w[0] = state.w[0].wrapping_add(1);
            }
        }
        Statement::ContinueIf(number) => {
            for t in 0..3 {
                if number.value(state) <= t {
                    state.s.v[1] = state.s.v[1].wrapping_add(t);
                }
            }
        }
        Statement::ReturnIf(number) => {
            if number.value(state) == 1 {
                return End::Return;
            }
        }
    }
    End::Block
}
