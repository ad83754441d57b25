//! Coverage: triangles that share an edge hit each sample exactly once, and published cases of the
//! fill rule hold.

use super::*;

/// A rectangle cut into cells with random diagonals covers each of its samples once, for every cell
/// size.
#[test]
fn shared_edge_is_owned_exactly_once() {
    for_seeds(96, |rng| {
        let cell = [26, 102, 256, 1000, 2560, 8192][rng.between(0, 6) as usize];
        let lattice = [1, 16, 128, 256][rng.between(0, 4) as usize];
        let origin = [0; 2].map(|_| rng.between(-2000, 6000));
        let n = (10_000 / cell).clamp(2, 40) as usize;
        // A corner that stays within a quarter of a cell cannot cross a diagonal.
        let jitter = (cell / 5 - lattice).max(0);
        // Vertices on the border move along it only.
        let mut corner = |column: usize, row: usize| {
            let mut axis = |k: usize, origin: i32| {
                let moved = if k == 0 || k == n {
                    0
                } else {
                    rng.between(-jitter, jitter + 1)
                };
                (origin + k as i32 * cell + moved).div_euclid(lattice) * lattice
            };
            [axis(column, origin[0]), axis(row, origin[1])]
        };
        let points: Vec<Vec<[i32; 2]>> = (0..=n)
            .map(|row| (0..=n).map(|column| corner(column, row)).collect())
            .collect();
        let mut mesh = Vec::new();
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let [a, b] = [points[row][column], points[row][column + 1]];
            let [d, c] = [points[row + 1][column], points[row + 1][column + 1]];
            let halves = if rng.next_u32() & 1 == 0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            for half in halves {
                assert!(area(half) >= 0, "no triangle of the mesh flips");
                mesh.extend(triangle(mesh.len() as u32, half, 0.5));
            }
        }
        let ([x0, y0], [x1, y1]) = (points[0][0], points[n][n]);
        for (pixel, hits) in layers(&mesh, 48, 32).into_iter().enumerate() {
            let (x, y) = (
                256 * (pixel as i32 % 48) + 128,
                256 * (pixel as i32 / 48) + 128,
            );
            let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
            assert_eq!(hits, u32::from(inside), "pixel {pixel}");
        }
    });
}

/// The same rule with a bias: one unit on every edge that is neither top nor left.
fn owns_by_bias(e: i64, dx: i32, dy: i32) -> bool {
    let is_top_left = dy < 0 || dy == 0 && dx > 0;
    e - i64::from(!is_top_left) >= 0
}

#[test]
fn infinitesimal_step_is_the_top_left_rule() {
    let mut rng = Rng(5);
    let mut ties = 0;
    for round in 0..2_000_000 {
        let size = [3, 50, 40_000, 16_000_000][round % 4];
        let (u, v) = (rng.between(-size, size + 1), rng.between(-size, size + 1));
        // A direction with small multiples has exact lattice points on it; step off them by at most
        // one unit.
        let k = if size < 1_000_000 {
            rng.between(1, 300)
        } else {
            1
        };
        let (dx, dy) = (k * u, k * v);
        let j = i64::from(rng.between(-2, 400));
        let (px, py) = (
            j * i64::from(u) + i64::from(rng.between(-1, 2)),
            j * i64::from(v) + i64::from(rng.between(-1, 2)),
        );
        let e = i64::from(dx) * py - i64::from(dy) * px;
        if (dx, dy) == (0, 0) {
            continue;
        }
        ties += u32::from(e == 0);
        assert_eq!(
            owns(e, dx, dy),
            owns_by_bias(e, dx, dy),
            "e {e}, dx {dx}, dy {dy}"
        );
    }
    assert!(ties > 100_000, "{ties} ties");
}
