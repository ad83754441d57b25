//! All exact rows again with strict accuracy, where triangle ids and depth keys must equal the
//! CPU's bit by bit.

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    table,
};

pub const CASES: &[Case] = &[Case {
    number: NUMBER,
    name: "strict-rows",
    about: "the pictures of all exact rows on the strict option: triangle ids and depth keys are those of the CPU, to the bit",
    expectation: Expectation::Exact,
    run: strict_rows,
}];

const NUMBER: u32 = 33;

/// Long rows, which software adapters skip here because they have drawn them once.
const LONG: [u32; 7] = [18, 19, 20, 21, 22, 23, 27];

/// Rows of effects, which adapters with slow compilers skip here because they have compiled their
/// kernels once.
const SLOW: [u32; 2] = [12, 26];

/// The row whose pictures pin what strict accuracy decides otherwise.
const MATRIX: u32 = 36;

fn strict_rows(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let (is_software, is_slow) = (context.is_software(), context.is_slow());
    let is_meant = |case: &&Case| {
        let is_long =
            is_software && LONG.contains(&case.number) || is_slow && SLOW.contains(&case.number);
        case.expectation == Expectation::Exact && case.number != MATRIX && !is_long
    };
    let (mut rows, mut pictures, mut floats) = (Vec::new(), 0, 0);
    let mut hashes = Vec::new();
    for case in table::by_number().into_iter().filter(is_meant) {
        let strict = context.strictly(case.name, case.run)?;
        check!(
            strict.adapter == strict.cpu,
            "{}: the adapter's hash is {:016x}, the CPU's {:016x}",
            case.name,
            strict.adapter,
            strict.cpu
        );
        (pictures, floats) = (pictures + strict.pictures, floats + strict.floats);
        if strict.pictures > 0 {
            rows.push(case.number);
            hashes.extend([strict.cpu as u32, (strict.cpu >> 32) as u32]);
        }
    }
    rows.dedup();
    check!(
        pictures > 40,
        "only {pictures} pictures have a strict option"
    );
    let hash = crate::math::fnv1a(&hashes);
    context.note(format!("{pictures} pictures of rows {rows:?} come to {hash:016x} here and on the CPU; {floats} more hang on floats"));
    if is_software {
        context.note(format!("rows {LONG:?} are skipped on software adapters"));
    }
    if is_slow {
        context.note(format!(
            "rows {SLOW:?} are skipped on adapters that compile slowly"
        ));
    }
    Ok(())
}
