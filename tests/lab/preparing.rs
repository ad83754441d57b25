//! Promise: a drag of an effect's slider prepares nothing: no picture of it is planned, no kernel's text linked, no pipeline compiled, no
//! buffer, texture or bind group made, and nothing explained anew. Only a change of the drawn size, with which a slow adapter keeps up, may
//! plan and make buffers.

use std::time::{Duration, Instant};

use eframe::egui::Pos2;
use rasterlab::gpu::preparations::Prepared;

use crate::harness::*;

/// Moves of the pointer, at most, and how many pairs of neighbors with pictures of the same size must come of them.
const MOST_MOVES: usize = 60;
const PAIRS: usize = 12;

/// Pixels that the newest picture has, and what was prepared so far.
fn now(lab: &Lab) -> ([u32; 2], Prepared) {
    let drawn = lab.state().drawn_size().expect("a picture");
    (drawn, lab.state().gpu().prepared.so_far())
}

#[test]
fn a_drag_of_a_slider_prepares_nothing() {
    let Some(mut lab) = lab_on_new_devices("facet") else { return };
    let rail = slider(&lab, "facet.amount").rect();
    let at = |i: usize| Pos2::new(rail.left() + rail.width() * (0.2 + 0.6 * i as f32 / MOST_MOVES as f32), rail.center().y);
    lab.hover_at(at(0));
    lab.step();
    lab.drag_at(at(0));
    lab.step();
    let (mut pairs, mut before) = (0, None);
    let first = lab.state().gpu().prepared.so_far();
    let mut seen = vec![value(&lab, "facet", "amount")];
    for i in 1..=MOST_MOVES {
        lab.hover_at(at(i));
        let (draws, patience) = (lab.state().draws(), Instant::now() + Duration::from_secs(60));
        while lab.state().draws() == draws || lab.state().is_waiting() {
            lab.step();
            assert!(Instant::now() < patience, "no picture comes\n{}", lab.state().log_text());
            std::thread::sleep(Duration::from_millis(2));
        }
        seen.push(value(&lab, "facet", "amount"));
        let after = now(&lab);
        if let Some((size, prepared)) = before.filter(|(size, _)| *size == after.0) {
            assert_eq!(prepared, after.1, "a picture of {size:?} at {:?} was prepared", seen.last());
            pairs += 1;
        }
        before = Some(after);
        if pairs == PAIRS {
            break;
        }
    }
    assert_eq!(pairs, PAIRS, "the size of the pictures never rests");
    assert!(first.plans > 0 && first.texts > 0 && first.pipelines > 0 && first.buffers > 0 && first.bind_groups > 0, "{first:?}");
    seen.dedup();
    assert!(seen.len() > PAIRS, "the slider moves with every picture: {seen:?}");
    lab.drop_at(at(MOST_MOVES));
    settle(&mut lab);
}
