//! Random programs on integers, with random expressions, against direct execution.

use rasterlab::evaluator::{NoHost, Word};
use rasterlab_fuzz::stress::scenes::for_seeds;

use super::common::{OPERATORS, Random, program};

type V = [i32; 4];

/// Functions that the random statements call.
const PRELUDE: &str = "var<private> zero: i32;
struct S { v: vec4i, n: array<i32, 3>, m: array<vec2i, 2> }
var<private> g: vec4i = vec4i(1, 2, 3, 4);
fn touch(p: ptr<function, vec4i>, q: vec4i, k: i32) -> vec4i {
    let before = *p;
    (*p).x = q.y + k;
    g.y += q.x;
    if k > 0 { return q + *p; }
    *p = (*p).wzyx;
    return before;
}
fn blend(p: ptr<function, vec4i>, q: vec4i) { (*p).x += 1; (*p).z = q.x; *p += q; }
fn read(p: ptr<function, vec4i>) -> vec4i { return *p; }
fn same(q: S) -> S { return q; }
fn globals(k: i32) -> vec4i { let before = g; g.x ^= k; if k < 0 { return before; } return g; }";
const RESULT: &str = "s.v + w * 3 + g * 5 + vec4i(s.n[0], s.n[1], s.n[2], s.m[0].x) * 7 + vec4i(s.m[0].y, s.m[1], 0) * 11";

#[derive(Clone, Default)]
struct S {
    v: V,
    n: [i32; 3],
    m: [[i32; 2]; 2],
}

#[derive(Default)]
struct State {
    s: S,
    w: V,
    g: V,
    /// Vectors and copies of the struct, by their names.
    lets: Vec<(usize, V)>,
    copies: Vec<(usize, S)>,
}

fn each(of: impl Fn(usize) -> i32) -> V {
    std::array::from_fn(of)
}

fn sum(a: V, b: V) -> V {
    each(|at| a[at].wrapping_add(b[at]))
}

fn result(state: &State) -> V {
    let S { v, n, m } = &state.s;
    let of_arrays = sum(
        [n[0], n[1], n[2], m[0][0]].map(|x| x.wrapping_mul(7)),
        [m[0][1], m[1][0], m[1][1], 0].map(|x| x.wrapping_mul(11)),
    );
    let of_vectors = sum(
        state.w.map(|x| x.wrapping_mul(3)),
        state.g.map(|x| x.wrapping_mul(5)),
    );
    sum(sum(*v, of_vectors), of_arrays)
}

/// Indices beyond the end mean the last element; negative ones are beyond the end.
fn index(number: i32, len: usize) -> usize {
    (number.cast_unsigned() as usize).min(len - 1)
}

fn named<T: Clone>(known: &[(usize, T)], name: usize) -> T {
    let found = known.iter().rev().find(|(other, _)| *other == name);
    found.expect("in scope").1.clone()
}

/// A value to read: its text, and what it is.
struct Read<T> {
    text: String,
    value: Box<dyn Fn(&State) -> T>,
}

fn read<T>(text: impl Into<String>, value: impl Fn(&State) -> T + 'static) -> Read<T> {
    Read {
        text: text.into(),
        value: Box::new(value),
    }
}

/// Does the function return?
type Run = Box<dyn Fn(&mut State) -> bool>;
/// A statement: its text, and what it does.
type Statement = (String, Run);

/// Names in scope: vectors, and copies of the struct.
type Names = Vec<(usize, bool)>;

/// A statement without others inside: its text, where Q is a vector, K and J are numbers and C is
/// a component, and what it does.
type Simple = (&'static str, fn(&mut State, V, [i32; 2], usize));

const SIMPLE: [Simple; 15] = [
    ("s.v = Q;", |state, q, _, _| state.s.v = q),
    ("w = Q;", |state, q, _, _| state.w = q),
    ("g = Q;", |state, q, _, _| state.g = q),
    ("s.v.C = K;", |state, _, [k, _], c| state.s.v[c] = k),
    ("w.C += K;", |state, _, [k, _], c| {
        state.w[c] = state.w[c].wrapping_add(k)
    }),
    ("s.v[J + zero] = K;", |state, _, [k, j], _| {
        state.s.v[index(j, 4)] = k
    }),
    ("s.n[J + zero] = K;", |state, _, [k, j], _| {
        state.s.n[index(j, 3)] = k
    }),
    ("s.m[J + zero].y = K;", |state, _, [k, j], _| {
        state.s.m[index(j, 2)][1] = k
    }),
    (
        "s.m = array<vec2i, 2>(s.m[1].yx, s.m[0]);",
        |state, _, _, _| {
            let [first, [x, y]] = state.s.m;
            state.s.m = [[y, x], first];
        },
    ),
    ("w = touch(&s.v, Q, K);", |state, q, [k, _], _| {
        let before = state.s.v;
        state.s.v[0] = q[1].wrapping_add(k);
        state.g[1] = state.g[1].wrapping_add(q[0]);
        state.w = if k > 0 {
            sum(q, state.s.v)
        } else {
            state.s.v.reverse();
            before
        };
    }),
    (
        "{ let r = read(&s.v); s.v.x += 1; w += r; }",
        |state, _, _, _| {
            let before = state.s.v;
            state.s.v[0] = before[0].wrapping_add(1);
            state.w = sum(state.w, before);
        },
    ),
    (
        "{ let r = globals(K); g.x += 1; w ^= r; }",
        |state, _, [k, _], _| {
            let before = state.g;
            state.g[0] ^= k;
            let r = if k < 0 { before } else { state.g };
            state.g[0] = state.g[0].wrapping_add(1);
            state.w = each(|at| state.w[at] ^ r[at]);
        },
    ),
    ("blend(&s.v, Q);", |state, q, _, _| {
        state.s.v[0] = state.s.v[0].wrapping_add(1);
        state.s.v[2] = q[0];
        state.s.v = sum(state.s.v, q);
    }),
    (
        "{ var late: vec4i; if K > 0 { late = Q; w.y += late.x; } w += late; }",
        |state, q, [k, _], _| {
            if k > 0 {
                state.w[1] = state.w[1].wrapping_add(q[0]);
                state.w = sum(state.w, q);
            }
        },
    ),
    (
        "{ let r = Q; for (var t = 0; t < 3; t++) { w += r; s.v.C += 1; g.C -= 2; } }",
        |state, q, _, c| {
            for _ in 0..3 {
                state.w = sum(state.w, q);
                state.s.v[c] = state.s.v[c].wrapping_add(1);
                state.g[c] = state.g[c].wrapping_sub(2);
            }
        },
    ),
];

struct Generator<'a> {
    random: &'a mut Random,
    names: usize,
    budget: usize,
}

impl Generator<'_> {
    fn name(&mut self) -> usize {
        self.names += 1;
        self.names
    }

    fn known(&mut self, names: &Names, is_copy: bool) -> Option<usize> {
        let known = names.iter().filter(|(_, copy)| *copy == is_copy);
        let known: Vec<usize> = known.map(|(name, _)| *name).collect();
        (!known.is_empty()).then(|| known[self.random.u32(known.len() as u32) as usize])
    }

    fn component(&mut self) -> (usize, &'static str) {
        let at = self.random.u32(4) as usize;
        (at, ["x", "y", "z", "w"][at])
    }

    fn vector(&mut self, names: &Names, depth: u32) -> Read<V> {
        match self.random.u32(if depth > 2 { 6 } else { 9 }) {
            0 | 1 => read("s.v", |state| state.s.v),
            2 => read("w", |state| state.w),
            3 => read("g", |state| state.g),
            4 => match self.known(names, false) {
                Some(name) => read(format!("k{name}"), move |state| named(&state.lets, name)),
                None => read("s.v", |state| state.s.v),
            },
            5 => match self.known(names, true) {
                Some(name) => read(format!("k{name}.v"), move |state| {
                    named(&state.copies, name).v
                }),
                None => read("w", |state| state.w),
            },
            6 => {
                let pattern: [_; 4] = std::array::from_fn(|_| self.component());
                let Read { text, value } = self.vector(names, depth + 1);
                let letters = pattern.map(|(_, letter)| letter).concat();
                read(format!("({text}).{letters}"), move |state| {
                    pattern.map(|(at, _)| value(state)[at])
                })
            }
            7 => {
                let [a, b] = [0, 1].map(|_| self.vector(names, depth + 1));
                read(format!("({} + {})", a.text, b.text), move |state| {
                    sum((a.value)(state), (b.value)(state))
                })
            }
            _ => {
                let (at, letter) = self.component();
                let Read { text, value } = self.vector(names, depth + 1);
                read(format!("vec4i(({text}).{letter})"), move |state| {
                    [value(state)[at]; 4]
                })
            }
        }
    }

    fn number(&mut self, names: &Names, depth: u32) -> Read<i32> {
        let kind = self.random.u32(if depth > 2 { 3 } else { 9 });
        let (at, letter) = self.component();
        if kind == 0 {
            let value = self.random.bits() as i32 >> self.random.u32(31);
            // With a variable: constant expressions that overflow would not compile.
            let text = format!("(bitcast<i32>({}u) + zero)", value.cast_unsigned());
            return read(text, move |_| value);
        }
        if kind > 5 {
            let (operator, of) = OPERATORS[self.random.u32(OPERATORS.len() as u32) as usize];
            let [a, b] = [0, 1].map(|_| self.number(names, depth + 1));
            let text = operator.replace('A', &a.text).replace('B', &b.text);
            return read(text, move |state| of((a.value)(state), (b.value)(state)));
        }
        if kind < 3 {
            let Read { text, value } = self.vector(names, depth + 1);
            return read(format!("({text}).{letter}"), move |state| value(state)[at]);
        }
        let Read { text, value } = self.number(names, depth + 1);
        match kind {
            3 => read(format!("s.v[{text} + zero]"), move |state| {
                state.s.v[index(value(state), 4)]
            }),
            4 => read(format!("s.n[{text} + zero]"), move |state| {
                state.s.n[index(value(state), 3)]
            }),
            _ => read(
                format!("s.m[{text} + zero].{}", ["x", "y"][at % 2]),
                move |state| state.s.m[index(value(state), 2)][at % 2],
            ),
        }
    }

    fn block(&mut self, depth: u32, names: &mut Names) -> Statement {
        let (mut text, mut runs) = (String::new(), Vec::new());
        let outside = names.len();
        for _ in 0..1 + self.random.u32(if depth == 0 { 14 } else { 6 }) {
            if self.budget == 0 {
                break;
            }
            self.budget -= 1;
            let (statement, run) = self.statement(depth, names);
            text += &(statement + "\n");
            runs.push(run);
        }
        names.truncate(outside);
        let run = move |state: &mut State| {
            let scope = (state.lets.len(), state.copies.len());
            let is_returned = runs.iter().any(|run| run(state));
            state.lets.truncate(scope.0);
            state.copies.truncate(scope.1);
            is_returned
        };
        (text, Box::new(run))
    }

    fn statement(&mut self, depth: u32, names: &mut Names) -> Statement {
        let kind = self.random.u32(if depth > 3 { 20 } else { 27 });
        let Read { text: k, value } = self.number(names, 0);
        match kind {
            0 | 1 => {
                let Read { text, value } = self.vector(names, 0);
                let name = self.name();
                names.push((name, false));
                let run = move |state: &mut State| {
                    let value = value(state);
                    state.lets.push((name, value));
                    false
                };
                (format!("let k{name} = {text};"), Box::new(run))
            }
            2 => {
                let name = self.name();
                names.push((name, true));
                let run = move |state: &mut State| {
                    state.copies.push((name, state.s.clone()));
                    false
                };
                (format!("let k{name} = same(s);"), Box::new(run))
            }
            3 if self.known(names, true).is_some() => {
                let name = self.known(names, true).expect("one is known");
                let run = move |state: &mut State| {
                    state.s = named(&state.copies, name);
                    false
                };
                (format!("s = k{name};"), Box::new(run))
            }
            20 | 21 => {
                let [(a, accept), (b, reject)] = [0, 1].map(|_| self.block(depth + 1, names));
                let run = move |state: &mut State| match value(state) > 0 {
                    true => accept(state),
                    false => reject(state),
                };
                (
                    format!("if {k} > 0 {{\n{a}}} else {{\n{b}}}"),
                    Box::new(run),
                )
            }
            22 | 23 => {
                let (name, count) = (self.name(), self.random.u32(5));
                let (body, run) = self.block(depth + 1, names);
                let head =
                    format!("for (var k{name} = 0u; k{name} < {count}u; k{name} += 1u) {{\n");
                let run = move |state: &mut State| (0..count).any(|_| run(state));
                (head + &body + "}", Box::new(run))
            }
            24 => {
                let [(a, zero), (b, middle), (c, other)] =
                    [0, 1, 2].map(|_| self.block(depth + 1, names));
                let run = move |state: &mut State| match value(state) & 3 {
                    0 => zero(state),
                    1 | 2 => middle(state),
                    _ => other(state),
                };
                let cases = format!("case 0: {{\n{a}}} case 1, 2: {{\n{b}}} default: {{\n{c}}} }}");
                (format!("switch {k} & 3 {{ {cases}"), Box::new(run))
            }
            25 if self.random.u32(2) == 0 => (
                format!("if {k} == 1 {{ return w; }}"),
                Box::new(move |state| value(state) == 1),
            ),
            25 => {
                let run = move |state: &mut State| {
                    if value(state) <= 3 {
                        state.w[0] = state.w[0].wrapping_add(1);
                    }
                    false
                };
                let text = format!("loop {{ if {k} > 3 {{ break; }} w.x += 1; break; }}");
                (text, Box::new(run))
            }
            26 => {
                let run = move |state: &mut State| {
                    for t in 0..3 {
                        if value(state) <= t {
                            state.s.v[1] = state.s.v[1].wrapping_add(t);
                        }
                    }
                    false
                };
                let head = "for (var t = 0; t < 3; t++)";
                let text = format!("{head} {{ if {k} > t {{ continue; }} s.v.y += t; }}");
                (text, Box::new(run))
            }
            _ => {
                let (text, run) = SIMPLE[self.random.u32(SIMPLE.len() as u32) as usize];
                let (q, j) = (self.vector(names, 0), self.number(names, 0));
                let (at, letter) = self.component();
                let text = text
                    .replace(".C", &format!(".{letter}"))
                    .replace('K', &k)
                    .replace('J', &j.text)
                    .replace('Q', &q.text);
                let run = move |state: &mut State| {
                    let numbers = [value(state), (j.value)(state)];
                    let vector = (q.value)(state);
                    run(state, vector, numbers, at);
                    false
                };
                (text, Box::new(run))
            }
        }
    }
}

#[test]
fn statements() {
    for_seeds(256, |rng| {
        let mut random = Random(u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32()));
        let mut generator = Generator {
            random: &mut random,
            names: 0,
            budget: 40,
        };
        let (body, run) = generator.block(0, &mut Vec::new());
        let source = format!(
            "{PRELUDE}\nfn f(a: vec4i, b: vec4i) -> vec4i {{\nvar s: S;\ns.v = a;\nvar w = b;\n{body}return {RESULT};\n}}\n"
        );
        let program = program(&source, "f");
        let mut machine = program.machine();
        for _ in 0..4 {
            let arguments: Vec<i32> = (0..8)
                .map(|_| random.bits() as i32 >> random.u32(30))
                .collect();
            let mut state = State {
                g: [1, 2, 3, 4],
                ..State::default()
            };
            state.s.v.copy_from_slice(&arguments[..4]);
            state.w.copy_from_slice(&arguments[4..]);
            let expected = if run(&mut state) {
                state.w
            } else {
                result(&state)
            };
            let words: Vec<Word> = arguments.iter().map(|&x| Word::from_i32(x)).collect();
            let given = machine.call(&words, &mut NoHost).expect("it ends");
            let given: Vec<i32> = given.iter().map(|word| word.to_i32()).collect();
            assert_eq!(given, expected, "{source} at {arguments:?}");
        }
    });
}
