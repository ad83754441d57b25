//! Random expressions on integers, against direct evaluation.

use rasterlab::evaluator::{NoHost, Word};
use rasterlab_fuzz::stress::scenes::{Rng, for_seeds};

use super::common::program;

enum Expr {
    Constant(i32),
    /// Argument 0 to 2.
    Argument(usize),
    Negate(Box<Expr>),
    Not(Box<Expr>),
    Binary(&'static str, Box<Expr>, Box<Expr>),
    Select(Box<Expr>, Box<Expr>, Box<Expr>),
}

const OPERATORS: [&str; 12] = [
    "+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "min", "max",
];

fn binary(operator: &str, a: i32, b: i32) -> i32 {
    match operator {
        "+" => a.wrapping_add(b),
        "-" => a.wrapping_sub(b),
        "*" => a.wrapping_mul(b),
        "/" => a.checked_div(b).unwrap_or(a),
        "%" => a.checked_rem(b).unwrap_or(0),
        "&" => a & b,
        "|" => a | b,
        "^" => a ^ b,
        "<<" => a << (b & 31),
        ">>" => a >> (b & 31),
        "min" => a.min(b),
        _ => a.max(b),
    }
}

impl Expr {
    fn text(&self) -> String {
        match self {
            // Variables of the module: constant expressions that overflow would not compile.
            Expr::Constant(value) => format!("bitcast<i32>({}u + zero)", value.cast_unsigned()),
            Expr::Argument(index) => ["a", "b", "c"][*index].to_owned(),
            Expr::Negate(x) => format!("(-{})", x.text()),
            Expr::Not(x) => format!("(~{})", x.text()),
            Expr::Binary(operator @ ("min" | "max"), a, b) => {
                format!("{operator}({}, {})", a.text(), b.text())
            }
            Expr::Binary(operator @ ("<<" | ">>"), a, b) => {
                format!("({} {operator} bitcast<u32>({}))", a.text(), b.text())
            }
            Expr::Binary(operator, a, b) => format!("({} {operator} {})", a.text(), b.text()),
            Expr::Select(a, b, c) => {
                format!("select({}, {}, {} < 0)", a.text(), b.text(), c.text())
            }
        }
    }

    fn value(&self, arguments: [i32; 3]) -> i32 {
        match self {
            Expr::Constant(value) => *value,
            Expr::Argument(index) => arguments[*index],
            Expr::Negate(x) => x.value(arguments).wrapping_neg(),
            Expr::Not(x) => !x.value(arguments),
            Expr::Binary(operator, a, b) => {
                binary(operator, a.value(arguments), b.value(arguments))
            }
            Expr::Select(a, b, c) => {
                if c.value(arguments) < 0 {
                    b.value(arguments)
                } else {
                    a.value(arguments)
                }
            }
        }
    }
}

fn number(rng: &mut Rng) -> i32 {
    match rng.between(0, 4) {
        0 => rng.next_u32().cast_signed(),
        1 => rng.between(-3, 40),
        2 => i32::MIN,
        _ => i32::MAX,
    }
}

/// An expression at most so deep.
fn tree(rng: &mut Rng, depth: u32) -> Expr {
    let kind = if depth == 0 { 0 } else { rng.between(0, 6) };
    let inner = |rng: &mut Rng| Box::new(tree(rng, depth - 1));
    match kind {
        0 if rng.between(0, 2) == 0 => Expr::Constant(number(rng)),
        0 => Expr::Argument(rng.between(0, 3) as usize),
        1 => Expr::Negate(inner(rng)),
        2 => Expr::Not(inner(rng)),
        3 => Expr::Select(inner(rng), inner(rng), inner(rng)),
        _ => {
            let (a, b) = (inner(rng), inner(rng));
            Expr::Binary(OPERATORS[rng.between(0, 12) as usize], a, b)
        }
    }
}

#[test]
fn expressions() {
    for_seeds(256, |rng| {
        let tree = tree(rng, 6);
        let source = format!(
            "var<private> zero: u32; fn f(a: i32, b: i32, c: i32) -> i32 {{ return {}; }}",
            tree.text()
        );
        let program = program(&source, "f");
        let mut machine = program.machine();
        for _ in 0..8 {
            let arguments = [0; 3].map(|_| number(rng));
            let given = machine.call(&arguments.map(Word::from_i32), &mut NoHost);
            let given = given.expect("no loops")[0].to_i32();
            assert_eq!(given, tree.value(arguments), "{source} at {arguments:?}");
        }
    });
}
