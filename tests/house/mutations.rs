//! Promise: whatever comes from anyone is read or refused in one line, and never a panic: models,
//! meshes, images, compressed streams, presets, shared lines, pictures, command lines and effects.
//! The files of the fuzzer's corpus are cut off, bits of them flip, and awkward words get in.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rasterlab::math::hash;
use rasterlab_fuzz::{TARGETS, Target, corpus, targets::assert_told_with_place};
use rayon::prelude::*;

use super::rounds::rounds;

const AWKWARD: &[u8] =
    b"-1 0 255 65536 4294967296 18446744073709551615 1e39 nan / \\\n \0 f v \xff { [ \" #";

fn changed(bytes: &[u8], seed: u32) -> Vec<u8> {
    let awkward: Vec<&[u8]> = AWKWARD.split(|byte| *byte == b' ').collect();
    let mut bytes = bytes.to_vec();
    for edit in 0..1 + hash(seed) % 3 {
        let [place, choice] = [1, 9].map(|salt| hash(seed.wrapping_mul(16) + edit + salt) as usize);
        if bytes.is_empty() {
            break;
        }
        let at = place % bytes.len();
        match choice % 5 {
            0 => bytes.truncate(at),
            1 | 2 => bytes[at] ^= 1 << (choice / 5 % 8),
            _ => drop(bytes.splice(
                at..at + 1,
                awkward[choice / 5 % awkward.len()].iter().copied(),
            )),
        }
    }
    bytes
}

/// What goes wrong with a target.
fn faults(target: &Target) -> Vec<String> {
    let mut faults = Vec::new();
    let mut outcomes = [0, 0];
    let files = corpus::read(target).expect("a corpus");
    for (index, (name, bytes)) in files.iter().enumerate() {
        for round in 0..rounds(12) {
            let input = changed(bytes, (index as u32) << 16 | round);
            let run = catch_unwind(AssertUnwindSafe(|| {
                let outcome = (target.check)(&input);
                outcome
                    .as_ref()
                    .map_err(|refusal| assert_told_with_place(refusal))
                    .is_ok()
            }));
            match run {
                Ok(is_read) => outcomes[usize::from(is_read)] += 1,
                Err(panic) => {
                    let said = panic.downcast_ref::<String>().cloned().unwrap_or_default();
                    faults.push(format!("{} {name} {round}: {said}", target.name));
                }
            }
        }
    }
    let [refused, read] = outcomes;
    // A model opens without a faulty image.
    let may_refuse_none = target.name == "image";
    if read == 0 || refused == 0 && !may_refuse_none {
        faults.push(format!(
            "{}: {refused} refused, {read} read: the changes do not fit",
            target.name
        ));
    }
    faults
}

#[test]
fn what_mutations_make_of_the_corpus_is_read_or_refused_in_a_line() {
    let faults: Vec<String> = TARGETS.par_iter().flat_map_iter(faults).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}
