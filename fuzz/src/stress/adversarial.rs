//! Adversarial geometry: triangles whose edges pass samples, and vertices that lie near ties of the
//! snap, as closely as possible.
//!
//! Uniform random numbers almost never produce a tie. These generators do, in the manner of the
//! tests of exact predicates that step through neighboring floats around a line (georust/robust,
//! linebender/kurbo).

use super::scenes::Rng;

/// `g`, `x` and `y` with a x + b y = g, the greatest common divisor up to its sign (extended
/// Euclid).
fn bezout(a: i64, b: i64) -> (i64, i64, i64) {
    if b == 0 {
        return (a, 1, 0);
    }
    let (g, x, y) = bezout(b, a % b);
    (g, y, x - a / b * y)
}

/// A triangle in units of 1/256 px, up to `extent` wide and high. One edge passes a sample of a
/// picture of `size` pixels as closely as its direction allows: through it, or one step of the edge
/// function (mostly 1) to either side.
pub fn near_miss_triangle(rng: &mut Rng, extent: i32, size: [i32; 2]) -> [[i32; 2]; 3] {
    let sample = size.map(|side| i64::from(256 * rng.between(0, side) + 128));
    // A third of the edges have lattice points inside, which can coincide with the sample.
    let factor = if rng.next_u32().is_multiple_of(3) {
        rng.between(2, 30)
    } else {
        1
    };
    let reach = (extent / factor).max(2);
    let mut side = || i64::from(factor * rng.between(-reach + 1, reach));
    let (dx, dy) = match (side(), side()) {
        (0, 0) => (i64::from(factor), i64::from(factor)),
        d => d,
    };
    // From the edge's first end to the sample: dx fy - dy fx is -g, 0 or g.
    let (g, x, y) = bezout(dx, dy);
    let t = i64::from(rng.between(-1, 2));
    let (fx, fy) = (-t * y, t * x);
    let g = g.abs();
    let along = (i128::from(fx * dx + fy * dy) * i128::from(g))
        .div_euclid(i128::from(dx * dx + dy * dy)) as i64;
    let coordinate =
        i64::from(rng.between(0, i32::try_from(g.min(1 << 30)).expect("a small number"))) - along;
    let (fx, fy) = (fx + coordinate * (dx / g), fy + coordinate * (dy / g));
    let a = [sample[0] - fx, sample[1] - fy];
    let b = [a[0] + dx, a[1] + dy];
    let mut third = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        let room = (i64::from(extent) - (high - low)).max(0) as i32;
        low - i64::from(rng.between(0, room + 1)) + i64::from(rng.between(0, extent + 1))
    };
    let c = [third(0), third(1)];
    [a, b, c].map(|corner| corner.map(|at| at.clamp(-8_388_607, 8_388_607) as i32))
}

/// The float `steps` representable values away from `value`, which must be positive and far from
/// the ends of its range.
fn stepped(value: f32, steps: i32) -> f32 {
    f32::from_bits(value.to_bits().wrapping_add_signed(steps))
}

/// The most floats between a vertex and its tie.
const NEIGHBOURS: i32 = 32;

/// The most units of 1/256 px between a vertex and its sample.
const FEW_UNITS: i32 = 3;

/// A coordinate in pixels, within a few units of the sample of pixel `pixel`: on a tie of the snap
/// (halfway between two units), or up to 32 floats to either side of it. One in four lies on a unit
/// instead.
fn near_tie_coordinate(rng: &mut Rng, pixel: i32) -> f32 {
    let unit = (256 * pixel + 128 + rng.between(-FEW_UNITS, FEW_UNITS + 1)) as f32;
    let half = if rng.next_u32().is_multiple_of(4) {
        0.0
    } else {
        0.5
    };
    let tie = (unit + half) / 256.0;
    stepped(tie, rng.between(-NEIGHBOURS, NEIGHBOURS + 1))
}

/// A mesh that covers a picture of `size` pixels, each of whose inner vertices lies within a few
/// units of a sample and within 32 floats of a tie of the snap. Cells are `cell` pixels wide, at
/// least 2, and the rim lies outside the picture, so every sample is covered exactly once: no cell
/// can fold.
pub fn near_tie_mesh(rng: &mut Rng, size: [i32; 2], cell: i32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let [columns, rows] = size.map(|side| side / cell + 1);
    let mut vertices = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let mut coordinate = |index: i32, last: i32, side: i32| match index {
                0 => -2.0,
                _ if index == last => side as f32 + 2.0,
                _ => near_tie_coordinate(rng, (index - 1) * cell + cell / 2),
            };
            let at = [
                coordinate(column, columns, size[0]),
                coordinate(row, rows, size[1]),
            ];
            vertices.push([at[0], at[1], 0.25 + 0.5 * rng.real(0.0, 1.0) as f32]);
        }
    }
    let vertex = |column: i32, row: i32| (row * (columns + 1) + column) as u32;
    let mut indices = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [vertex(column, row), vertex(column + 1, row)];
            let [c, d] = [vertex(column, row + 1), vertex(column + 1, row + 1)];
            // Random diagonals, so that edges have several slopes.
            let pair = if rng.next_u32().is_multiple_of(2) {
                [[a, c, b], [b, c, d]]
            } else {
                [[a, c, d], [a, d, b]]
            };
            indices.extend(pair.as_flattened());
        }
    }
    (vertices, indices)
}

/// A triangle whose third corner lies within 32 floats of the line through the other two, near a
/// sample: almost no area, of either orientation.
pub fn near_collinear_triangle(rng: &mut Rng, size: [i32; 2]) -> [[f32; 2]; 3] {
    let mut corner = || {
        size.map(|side| {
            let pixel = rng.between(1, side.max(2));
            near_tie_coordinate(rng, pixel)
        })
    };
    let (a, b) = (corner(), corner());
    let fraction = rng.real(0.0, 1.0);
    let c = [0, 1].map(|axis| {
        let on_line =
            (f64::from(a[axis]) * (1.0 - fraction) + f64::from(b[axis]) * fraction) as f32;
        stepped(on_line, rng.between(-NEIGHBOURS, NEIGHBOURS + 1))
    });
    [a, b, c]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_misses_pass_a_sample_within_one_step() {
        let mut rng = Rng(3);
        for _ in 0..2000 {
            let [a, b, _] =
                near_miss_triangle(&mut rng, 4000, [32, 32]).map(|corner| corner.map(i64::from));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let g = bezout(dx, dy).0.abs();
            let passes = |x: i64, y: i64| {
                (dx * (256 * y + 128 - a[1]) - dy * (256 * x + 128 - a[0])).abs() <= g
            };
            assert!(
                (0..32).any(|y| (0..32).any(|x| passes(x, y))),
                "{a:?} {b:?}"
            );
        }
    }

    #[test]
    fn a_troubled_sheet_sits_on_ties_and_cannot_fold() {
        let (vertices, indices) = near_tie_mesh(&mut Rng(1), [32, 32], 2);
        let ties = vertices.iter().filter(|[x, y, _]| {
            let from_tie =
                |v: f32| (f64::from(v) * 256.0 - 0.5 - (f64::from(v) * 256.0 - 0.5).round()).abs();
            [x, y].iter().all(|v| **v > 0.0 && from_tie(**v) < 0.05)
        });
        assert!(
            ties.count() > vertices.len() / 3,
            "too few vertices near ties"
        );
        for t in indices.as_chunks::<3>().0 {
            let [a, b, c] = t.map(|i| vertices[i as usize].map(f64::from));
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(area < 0.0, "a cell has folded: {area}");
        }
    }
}
