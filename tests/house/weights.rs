//! Promise: the weight of a kernel, from which costs are predicted, follows its text: more work weighs more, loops and calls count where
//! they stand, and a branch that a constant closes weighs nothing.

use rasterlab::shader::{
    link::Linked,
    reflect::{Reflected, reflect},
    weight::Weight,
};

const HEAD: &str = "
override IS_LONG: bool = false;
const IS_NEVER = false;
@group(0) @binding(0) var<storage, read_write> cells: array<u32>;
@group(0) @binding(1) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read> quads: array<vec4f>;
var<workgroup> shared_cells: array<u32, 64>;
fn some(x: f32) -> f32 { return x * x + x; }
";

fn module(functions: &str, body: &str) -> Reflected {
    let entry = "@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) at: u32) {";
    // The arguments of a kernel, so that naga folds nothing.
    let text = format!("{HEAD}\n{functions}\n{entry}\n var x = f32(at); var n = at; var v = vec4f(x);\n{body}\n}}");
    reflect(&Linked { text, parts: Vec::new() }, false).unwrap_or_else(|error| panic!("{body}: {}", error.message))
}

/// What a body adds to the weight of an empty kernel.
fn added(body: &str) -> Weight {
    added_with(body, &[])
}

fn added_with(body: &str, constants: &[(String, f64)]) -> Weight {
    let weight = |body| module("", body).weight("main", constants).expect("the entry point is there");
    let (whole, empty) = (weight(body), weight(""));
    Weight { once: whole.once - empty.once, looped: whole.looped - empty.looped }
}

#[test]
fn what_takes_longer_weighs_more() {
    let of = |body| added(body).once;
    let chain = ["x = x + 1.5;", "x = x / 1.5;", "x = sqrt(x);", "x = sin(x);"].map(of);
    assert!(chain[0] > 0.0 && chain.is_sorted_by(|a, b| a < b), "{chain:?}");
    let memory = ["n = n;", "n = shared_cells[3];", "n = cells[3];", "n = atomicAdd(&counts[3], 1u);"].map(of);
    assert!(memory.is_sorted_by(|a, b| a < b), "a register, shared memory, memory and an atomic: {memory:?}");
    assert!(of("v = quads[3];") > of("n = cells[3];"), "four words take longer than one");
    assert!(of("workgroupBarrier();") > 0.0);
}

#[test]
fn vectors_weigh_as_their_numbers_and_sequences_as_their_parts() {
    assert_eq!(added("v = v + v;").once, 4.0 * added("x = x + x;").once);
    assert_eq!(added("v = sqrt(v);").once, 4.0 * added("x = sqrt(x);").once);
    let (first, second) = ("x = sin(x) * 2.5;", "cells[n] = n * 3u;");
    let both = added(&format!("{first} {second}"));
    assert_eq!(both.once, added(first).once + added(second).once);
    assert_eq!(both.looped, 0.0);
}

#[test]
fn a_loop_counts_its_body_once_and_apart() {
    let body = "x = sin(x); cells[n] = n;";
    let plain = added(body);
    let looped = |body: &str| added(&format!("loop {{ {body} break; }}"));
    assert_eq!(looped(body).looped - looped("").looped, plain.once);
    assert!(looped(body).once < plain.once, "the body counts outside the loop too");
    // Loops within loops run more often, but that is not counted.
    assert_eq!(looped(&format!("loop {{ {body} break; }}")).looped - looped("loop { break; }").looped, plain.once);
}

#[test]
fn a_call_weighs_what_it_calls_wherever_it_stands() {
    let call = |body: &str| added(body);
    let once = call("x = some(x);");
    assert!(once.once > 0.0 && once.looped == 0.0, "{once:?}");
    assert_eq!(call("x = some(x); x = some(x);").once, 2.0 * once.once);
    assert_eq!(call("loop { x = some(x); break; }").looped, once.once);
    let weight = |functions: &str| module(functions, "n = turns(n);").weight("main", &[]).expect("it is there");
    let within = weight("fn turns(n: u32) -> u32 { var m = n; loop { m = m * 3u; break; } return m; }");
    assert!(within.looped > 0.0, "a loop of a function counts as a loop of its caller: {within:?}");
}

#[test]
fn a_constant_that_closes_a_branch_takes_its_weight() {
    let (long, short) = ("x = sin(x); x = sin(x);", "x = x + 1.5;");
    let body = format!("if IS_LONG {{ {long} }} else {{ {short} }}");
    let set = |value: f64| added_with(&body, &[("IS_LONG".into(), value)]).once;
    assert_eq!(set(1.0) - set(0.0), added(long).once - added(short).once);
    assert_eq!(added(&body).once, set(0.0), "without a value, the default decides");
    let open = added(&format!("if x > 0.5 {{ {long} }} else {{ {short} }}")).once;
    assert_eq!(
        open - added("if x > 0.5 { } else { }").once,
        added(long).once + added(short).once,
        "both sides of what no constant decides"
    );
    for condition in ["IS_NEVER && x > 0.5", "IS_LONG && x > 0.5", "!(!IS_LONG || x > 0.5)", "IS_LONG == true"] {
        let weight = |body: &str| added(&format!("if {condition} {{ {body} }}")).once;
        assert_eq!(weight(long), weight(""), "{condition}");
    }
}

#[test]
fn an_entry_point_that_is_not_there_weighs_nothing_that_could_be_said() {
    assert_eq!(module("", "").weight("other", &[]), None);
}
