//! Covering arrays: few rows in which every pair of levels of two factors meets.

use std::collections::BTreeSet;

use super::scenes::Rng;

/// Rows of levels, one level of each factor, in which every pair of levels of two factors stands at
/// least once: a covering array of strength 2. `counts`: the number of levels of each factor, at
/// least 1.
///
/// Greedy: a row begins with a pair that no row has, and takes the level of each other factor that
/// adds most new pairs.
pub fn covering_rows(counts: &[usize], rng: &mut Rng) -> Vec<Vec<usize>> {
    let pair = |(f, a): (usize, usize), (g, b): (usize, usize)| {
        if f < g { (f, a, g, b) } else { (g, b, f, a) }
    };
    let mut missing: BTreeSet<(usize, usize, usize, usize)> = BTreeSet::new();
    for g in 0..counts.len() {
        for f in 0..g {
            missing.extend((0..counts[f]).flat_map(|a| (0..counts[g]).map(move |b| (f, a, g, b))));
        }
    }
    let mut rows = Vec::new();
    while let Some(&(f, a, g, b)) = missing.first() {
        let mut chosen = vec![(f, a), (g, b)];
        let mut others: Vec<usize> = (0..counts.len()).filter(|&h| h != f && h != g).collect();
        rng.shuffle(&mut others);
        for h in others {
            let mut levels: Vec<usize> = (0..counts[h]).collect();
            rng.shuffle(&mut levels);
            let gain = |level: &usize| {
                chosen
                    .iter()
                    .filter(|&&one| missing.contains(&pair(one, (h, *level))))
                    .count()
            };
            let best = levels
                .into_iter()
                .max_by_key(gain)
                .expect("a factor has a level");
            chosen.push((h, best));
        }
        chosen.sort_unstable();
        for (i, &one) in chosen.iter().enumerate() {
            for &other in &chosen[..i] {
                missing.remove(&pair(one, other));
            }
        }
        rows.push(chosen.into_iter().map(|(_, level)| level).collect());
    }
    rows
}

/// For each row the scenes to draw with it, so that every scene meets every level of every factor.
/// Pictures of a row share their kernels.
pub fn scenes_of_rows(rows: &[Vec<usize>], scenes: usize) -> Vec<Vec<usize>> {
    let mut missing: BTreeSet<(usize, usize, usize)> = rows
        .iter()
        .flat_map(|row| row.iter().enumerate())
        .flat_map(|(f, &a)| (0..scenes).map(move |scene| (scene, f, a)))
        .collect();
    let mut of_rows = vec![Vec::new(); rows.len()];
    while !missing.is_empty() {
        for (at, (row, of_row)) in rows.iter().zip(&mut of_rows).enumerate() {
            let gain = |scene: usize| {
                row.iter()
                    .enumerate()
                    .filter(|&(f, &a)| missing.contains(&(scene, f, a)))
                    .count()
            };
            // Rows begin with different scenes, so that equal gains do not all go to the first.
            let best = (0..scenes)
                .map(|scene| (scene + at) % scenes)
                .max_by_key(|&scene| gain(scene))
                .expect("a scene");
            if gain(best) > 0 {
                missing.retain(|&(scene, f, a)| scene != best || row[f] != a);
                of_row.push(best);
            }
        }
    }
    of_rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_levels_stands_in_a_row_and_every_scene_meets_every_level() {
        for seed in 0..20 {
            let counts = [9, 7, 4, 4, 2, 1, 5, 3];
            let rows = covering_rows(&counts, &mut Rng(seed));
            assert!(rows.iter().all(|row| row.len() == counts.len()
                && row.iter().zip(counts).all(|(level, count)| *level < count)));
            for (g, f) in (0..counts.len()).flat_map(|g| (0..g).map(move |f| (g, f))) {
                let met: BTreeSet<[usize; 2]> = rows.iter().map(|row| [row[f], row[g]]).collect();
                assert_eq!(
                    met.len(),
                    counts[f] * counts[g],
                    "seed {seed}, factors {f} and {g}"
                );
            }
            assert!(rows.len() <= 2 * 9 * 7, "seed {seed}: {} rows", rows.len());
            let of_rows = scenes_of_rows(&rows, 5);
            for (f, count) in counts.iter().enumerate() {
                let met: BTreeSet<[usize; 2]> = rows
                    .iter()
                    .zip(&of_rows)
                    .flat_map(|(row, scenes)| scenes.iter().map(|&scene| [scene, row[f]]))
                    .collect();
                assert_eq!(met.len(), 5 * count, "seed {seed}, factor {f}");
            }
        }
    }
}
