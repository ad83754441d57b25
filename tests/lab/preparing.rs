//! Promise: a drag of an effect's slider prepares nothing: no picture of it is planned, no kernel's
//! text linked, no pipeline compiled, no buffer, texture or bind group made, and nothing explained
//! anew. Only a change of the drawn size, with which a slow adapter keeps up, may make any of
//! these.

use std::time::{Duration, Instant};

use egui::Pos2;

use crate::harness::*;

/// Pictures of one size after which the thread of the picture has no order of an earlier size left:
/// it draws one and keeps one.
const BEFORE: u64 = 3;
/// Pictures that are looked at.
const PICTURES: u64 = 12;

#[test]
fn a_drag_of_a_slider_prepares_nothing() {
    draw_pictures();
    let Some(mut lab) = lab_on_new_devices("facet") else {
        return;
    };
    let rail = slider(&lab, "facet.amount").rect();
    // To and fro, never the same twice in a row.
    let at = |i: u32| {
        Pos2::new(
            rail.left() + rail.width() * (0.2 + 0.6 * (i as f32 * 0.37).sin().abs()),
            rail.center().y,
        )
    };
    let first = lab.state().gpu().prepared.so_far();
    assert!(
        first.plans > 0
            && first.texts > 0
            && first.pipelines > 0
            && first.buffers > 0
            && first.bind_groups > 0,
        "{first:?}"
    );
    lab.hover_at(at(0));
    lab.step();
    lab.drag_at(at(0));
    lab.step();
    let patience = Instant::now() + Duration::from_secs(120);
    let (mut size, mut begun, mut known, mut seen, mut amounts) = (None, 0, None, 0, Vec::new());
    for i in 1.. {
        lab.hover_at(at(i));
        lab.step();
        std::thread::sleep(Duration::from_millis(2));
        let (ordered, draws) = (lab.state().ordered_size(), lab.state().draws());
        if ordered != size {
            (size, begun, known) = (ordered, draws, None);
        }
        if draws < begun + BEFORE {
            continue;
        }
        let prepared = lab.state().gpu().prepared.so_far();
        match known {
            None => known = Some((prepared, draws)),
            Some((before, of)) => {
                assert_eq!(
                    before,
                    prepared,
                    "after {} pictures of {size:?}",
                    draws - of
                );
                amounts.push(value(&lab, "facet", "amount"));
                seen += draws - of;
                known = Some((prepared, draws));
            }
        }
        if seen >= PICTURES {
            break;
        }
        assert!(
            Instant::now() < patience,
            "{seen} pictures of a size that rests\n{}",
            lab.state().log_text()
        );
    }
    amounts.dedup();
    assert!(amounts.len() > 3, "the slider does not move: {amounts:?}");
    lab.drop_at(at(0));
    settle(&mut lab);
}
