//! Random expressions on integers, against direct evaluation.

use proptest::prelude::*;
use rasterlab::evaluator::{NoHost, Word};

use super::common::program;

#[derive(Clone, Debug)]
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

fn number() -> impl Strategy<Value = i32> {
    prop_oneof![any::<i32>(), -3..40, Just(i32::MIN), Just(i32::MAX)]
}

fn tree() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        number().prop_map(Expr::Constant),
        (0..3usize).prop_map(Expr::Argument)
    ];
    leaf.prop_recursive(6, 60, 3, |inner| {
        let boxed = inner.prop_map(Box::new).boxed();
        prop_oneof![
            boxed.clone().prop_map(Expr::Negate),
            boxed.clone().prop_map(Expr::Not),
            (
                prop::sample::select(OPERATORS.as_slice()),
                boxed.clone(),
                boxed.clone()
            )
                .prop_map(|(op, a, b)| Expr::Binary(op, a, b)),
            (boxed.clone(), boxed.clone(), boxed).prop_map(|(a, b, c)| Expr::Select(a, b, c)),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(256), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn expressions(tree in tree(), inputs in prop::collection::vec([number(), number(), number()], 8)) {
        let source = format!("var<private> zero: u32; fn f(a: i32, b: i32, c: i32) -> i32 {{ return {}; }}", tree.text());
        let program = program(&source, "f");
        let mut machine = program.machine();
        for arguments in inputs {
            let given = machine.call(&arguments.map(Word::from_i32), &mut NoHost).expect("no loops")[0].to_i32();
            prop_assert_eq!(given, tree.value(arguments));
        }
    }
}
