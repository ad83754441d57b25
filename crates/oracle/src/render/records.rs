//! The records of a picture's geometry, computed on all threads: by runs of records and not by
//! draws, of which there may be millions with a few records each.

use rayon::prelude::*;

use super::{super::shot::Shot, vertex::VertexEvaluator};
use crate::{
    scene::draw::{Draw, totals},
    work::{Canceled, checkpoint},
};

/// Most records that are handled between two checkpoints.
const MOST_RECORDS: usize = 1024;

/// The number of records of a picture.
pub fn record_count(shot: &Shot) -> usize {
    let [shared, triangles] = totals(shot.scene, shot.draws);
    let count = if shot.stack.unshares_vertices() {
        3 * triangles
    } else {
        shared
    };
    count as usize
}

/// Index of a draw's first record.
fn first_record(shot: &Shot, draw: &Draw) -> usize {
    if shot.stack.unshares_vertices() {
        3 * draw.first_triangle as usize
    } else {
        draw.first_vertex as usize
    }
}

/// One value for every record, in order. `fill` is given the evaluator of a draw, the index of one
/// of its records, and the values of that record and of some that follow it in the same draw.
pub fn fill_records<T: Clone + Default + Send>(
    shot: &Shot,
    fill: impl Fn(&VertexEvaluator, usize, &mut [T]) + Sync,
) -> Result<Vec<T>, Canceled> {
    let Shot {
        scene,
        draws,
        view,
        stack,
    } = *shot;
    let count = record_count(shot);
    // One list of the right size: growing it would need twice the memory.
    let mut values = vec![T::default(); count];
    let checkpoint = checkpoint();
    // Few records are shared among the threads, too.
    let run = (count / (8 * rayon::current_num_threads())).clamp(1, MOST_RECORDS);
    let fill_run = |(index, mut values): (usize, &mut [T])| {
        checkpoint.pass()?;
        let mut record = index * run;
        while !values.is_empty() {
            let begun = draws.partition_point(|draw| first_record(shot, draw) <= record);
            // Draws without records begin where the next one does, which is the last of these.
            let evaluator = VertexEvaluator::new(scene, &draws[begun - 1], view, stack);
            let end = draws
                .get(begun)
                .map_or(count, |draw| first_record(shot, draw));
            let (own, others) = values.split_at_mut(values.len().min(end - record));
            fill(&evaluator, record, own);
            record = end;
            values = others;
        }
        Ok(())
    };
    values
        .par_chunks_mut(run)
        .enumerate()
        .try_for_each(fill_run)?;
    Ok(values)
}
