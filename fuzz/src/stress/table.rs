//! The table of stress cases, except [`super::strict`], which runs the others again.

use super::{
    case::Case, clipping, coverage, culling, effects, hardware, matrix, occlusion, parameters,
    picture_sizes, published, queues, skins, time, values, written,
};

/// All cases by kind, except those that run other cases.
const CASES: &[&[Case]] = &[
    published::CASES,
    coverage::CASES,
    clipping::CASES,
    values::CASES,
    queues::CASES,
    picture_sizes::CASES,
    time::CASES,
    effects::CASES,
    parameters::CASES,
    skins::CASES,
    hardware::CASES,
    culling::CASES,
    occlusion::CASES,
    matrix::CASES,
    written::CASES,
];

/// The cases of the table, sorted by number.
pub fn by_number() -> Vec<&'static Case> {
    let mut cases: Vec<&Case> = CASES.iter().copied().flatten().collect();
    cases.sort_by_key(|case| case.number);
    cases
}
