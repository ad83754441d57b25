//! Coverage: triangles that share an edge hit each sample exactly once, and published cases of the fill rule hold.

use super::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..Default::default() })]

    /// A rectangle cut into cells with random diagonals covers each of its samples once, for every cell size.
    #[test]
    fn shared_edge_is_owned_exactly_once(
        seed in any::<u32>(),
        cell in prop::sample::select(vec![26, 102, 256, 1000, 2560, 8192]),
        lattice in prop::sample::select(vec![1, 16, 128, 256]),
        origin in prop::array::uniform2(-2000i32..6000),
    ) {
        let mut rng = Rng(seed);
        let n = (10_000 / cell).clamp(2, 40) as usize;
        // A corner that stays within a quarter of a cell cannot cross a diagonal.
        let jitter = (cell / 5 - lattice).max(0);
        // Vertices on the border move along it only.
        let mut corner = |column: usize, row: usize| {
            let mut axis = |k: usize, origin: i32| {
                let moved = if k == 0 || k == n { 0 } else { rng.between(-jitter, jitter + 1) };
                (origin + k as i32 * cell + moved).div_euclid(lattice) * lattice
            };
            [axis(column, origin[0]), axis(row, origin[1])]
        };
        let points: Vec<Vec<[i32; 2]>> = (0..=n).map(|row| (0..=n).map(|column| corner(column, row)).collect()).collect();
        let mut mesh = Vec::new();
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let [a, b, c, d] = [points[row][column], points[row][column + 1], points[row + 1][column + 1], points[row + 1][column]];
            let halves = if rng.next_u32() & 1 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for half in halves {
                // No triangle of the mesh flips.
                prop_assert!(area(half) >= 0);
                mesh.extend(triangle(mesh.len() as u32, half, 0.5));
            }
        }
        let ([x0, y0], [x1, y1]) = (points[0][0], points[n][n]);
        for (pixel, hits) in layers(&mesh, 48, 32).into_iter().enumerate() {
            let (x, y) = (256 * (pixel as i32 % 48) + 128, 256 * (pixel as i32 / 48) + 128);
            let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
            prop_assert_eq!(hits, u32::from(inside), "pixel {}", pixel);
        }
    }
}

#[test]
fn rectangle_of_the_d3d11_rules_owns_fifteen_and_ten_pixels() {
    let [a, b, c, d] = [[0, 0], [5 * 256, 0], [5 * 256, 5 * 256], [0, 5 * 256]];
    let halves = [triangle(0, [a, b, c], 0.5).unwrap(), triangle(1, [a, c, d], 0.5).unwrap()];
    let coverage = cover(&halves, &pixel_view(8, 8)).expect("nobody cancels it");
    let count = |triangle_id| coverage.samples.iter().filter(|sample| sample.triangle_id == triangle_id).count();
    assert_eq!((count(0), count(1), coverage.layers().iter().max()), (15, 10, Some(&1)));
}

#[test]
fn fan_around_a_sample_hits_it_exactly_once() {
    let mut rng = Rng(3);
    for round in 0..2000 {
        // Around the sample itself, or a hub that lies up to a unit away from it.
        let hub = [128 + rng.between(-1, 2) * (round & 1), 128 + rng.between(-1, 2) * (round & 1)];
        let mut ring: Vec<[i32; 2]> =
            [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]].map(|[x, y]| [128 + x * 60, 128 + y * 60]).to_vec();
        ring.iter_mut().for_each(|p| *p = [p[0] + rng.between(-20, 21), p[1] + rng.between(-20, 21)]);
        let wedges: Vec<_> = (0..8).filter_map(|i| triangle(i as u32, [hub, ring[i], ring[(i + 1) % 8]], 0.5)).collect();
        assert_eq!(wedges.len(), 8);
        assert_eq!(layers(&wedges, 1, 1), [1], "round {round}");
    }
}

/// The fill-rule cases of VK-GL-CTS: small quads, plain, reversed, and with a different w at each corner.
#[test]
fn rotated_quads_cover_each_sample_once_and_miss_none() {
    const SIZE: u32 = 128;
    let view = square_perspective(SIZE, SIZE, 0.01);
    let mut rng = Rng(7);
    for (reversed, projective) in [(false, false), (true, false), (false, true), (true, true)] {
        let quads: Vec<[[f64; 2]; 4]> = (0..16)
            .map(|i| {
                let center = [-0.75 + 0.5 * f64::from(i % 4), -0.75 + 0.5 * f64::from(i / 4)];
                rotated_square(center, 0.15, f64::from(i) * std::f64::consts::FRAC_PI_2 / 16.0)
            })
            .collect();
        let mut w = || if projective { 0.1 + 3.9 * f64::from(rng.next_u32()) / 4_294_967_296.0 } else { 1.0 };
        let meshes: Vec<_> = quads
            .iter()
            .map(|&corners| triangle_soup(quad(corners, [w(), w(), w(), w()], if reversed { Winding::Reversed } else { Winding::Forward })))
            .collect();
        let (layers, _) = covered(&scene(&meshes), &view);
        for (pixel, hits) in layers.into_iter().enumerate() {
            let ndc = [pixel as u32 % SIZE, pixel as u32 / SIZE].map(|k| (f64::from(k) + 0.5) * 2.0 / f64::from(SIZE) - 1.0);
            let point = [ndc[0], -ndc[1]];
            // Distance into each quad; a snapped corner moves by half a unit at most.
            let depth = |corners: &[[f64; 2]; 4]| {
                let edge = |i: usize| {
                    let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 4]);
                    ((bx - ax) * (point[1] - ay) - (by - ay) * (point[0] - ax)) / libm::hypot(bx - ax, by - ay)
                };
                (0..4).map(edge).fold(f64::INFINITY, f64::min)
            };
            let unit = 2.0 / f64::from(256 * SIZE);
            let inside = quads.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
            match inside {
                d if d > unit => assert_eq!(hits, 1, "pixel {pixel}, {reversed} {projective}"),
                d if d < -unit => assert_eq!(hits, 0, "pixel {pixel}, {reversed} {projective}"),
                _ => assert!(hits <= 1, "pixel {pixel}, {reversed} {projective}"),
            }
        }
    }
}

#[test]
fn quad_larger_than_the_view_covers_everything_once() {
    let view = square_perspective(96, 64, 0.01);
    for turn in 0..15 {
        let angle = f64::from(turn) * std::f64::consts::FRAC_PI_2 / 15.0;
        // Once beyond every corner, then far past the guard band.
        for half in [2.5, 40.0, 1e5, 1e8] {
            let mesh = triangle_soup(quad(
                rotated_square([0.1, -0.2], half, angle),
                [1.0, 0.7, 2.0, 1.3],
                if turn % 2 == 0 { Winding::Reversed } else { Winding::Forward },
            ));
            let (layers, _) = covered(&scene(&[mesh]), &view);
            assert!(layers.iter().all(|&hits| hits == 1), "turn {turn}, half {half}");
        }
    }
}

#[test]
fn whole_pixel_translation_moves_every_triangle_id() {
    let mut rng = Rng(11);
    let mut point = || [rng.between(0, 32 * 256), rng.between(0, 32 * 256)];
    let soup: Vec<[[i32; 2]; 3]> = (0..40).map(|_| [point(), point(), point()]).collect();
    let triangle_ids = |dx: i32, dy: i32| {
        let moved = |p: [i32; 2]| [p[0] + 256 * dx, p[1] + 256 * dy];
        let mesh: Vec<_> = soup.iter().enumerate().filter_map(|(i, t)| triangle(i as u32, t.map(moved), 0.1 + 0.01 * (i as f32))).collect();
        cover(&mesh, &pixel_view(64, 64)).expect("nobody cancels it").triangle_ids()
    };
    let still = triangle_ids(0, 0);
    for (dx, dy) in [(1, 0), (0, 1), (31, 17), (32, 32)] {
        let moved = triangle_ids(dx, dy);
        for (x, y) in (0..32).flat_map(|x| (0..32).map(move |y| (x, y))) {
            assert_eq!(still[y * 64 + x], moved[(y + dy as usize) * 64 + x + dx as usize]);
        }
    }
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
        // A direction with small multiples has exact lattice points on it; step off them by at most one unit.
        let k = if size < 1_000_000 { rng.between(1, 300) } else { 1 };
        let (dx, dy) = (k * u, k * v);
        let j = i64::from(rng.between(-2, 400));
        let (px, py) = (j * i64::from(u) + i64::from(rng.between(-1, 2)), j * i64::from(v) + i64::from(rng.between(-1, 2)));
        let e = i64::from(dx) * py - i64::from(dy) * px;
        if (dx, dy) == (0, 0) {
            continue;
        }
        ties += u32::from(e == 0);
        assert_eq!(owns(e, dx, dy), owns_by_bias(e, dx, dy), "e {e}, dx {dx}, dy {dy}");
    }
    assert!(ties > 100_000, "{ties} ties");
}

/// One edge runs through the picture; the other two are outside of it.
#[test]
fn triangles_of_every_size_cover_their_half_plane() {
    let view = pixel_view(64, 64);
    for exponent in -3..=9 {
        let size = libm::pow(10.0, f64::from(exponent)) as f32;
        let (x, y) = (32.3f32, 31.7f32);
        let mesh = triangle_soup([[x, y - size, 0.5], [x + size, y, 0.5], [x, y + size, 0.5]]);
        let (layers, _) = covered(&scene(&[mesh]), &view);
        for (pixel, hits) in layers.into_iter().enumerate() {
            let (px, py) = ((pixel % 64) as f32 + 0.5, (pixel / 64) as f32 + 0.5);
            let error_bound = (size - (py - y).abs() - (px - x)).min(px - x);
            if error_bound.abs() > 1.0 / 128.0 {
                assert_eq!(hits, u32::from(error_bound > 0.0), "size {size}, pixel {pixel}");
            }
        }
    }
}

/// Needles of a million to one, a few units high, back to back: each sample between them once.
#[test]
fn slivers_share_their_edges_too() {
    let mut rng = Rng(17);
    for height in 1..=8 {
        let left = [-GUARD_BAND, rng.between(2000, 4000)];
        let right = [GUARD_BAND, rng.between(2000, 4000)];
        let middle = [left[1], right[1]].iter().sum::<i32>() / 2;
        let (up, down) = ([rng.between(0, 9000), middle - height - 40], [rng.between(0, 9000), middle + height + 40]);
        let needles = [triangle(0, [left, up, right], 0.5).unwrap(), triangle(1, [left, right, down], 0.5).unwrap()];
        let [whole, pair] = [
            layers(&[triangle(0, [left, up, down], 0.5), triangle(1, [up, right, down], 0.5)].map(Option::unwrap), 40, 20),
            layers(&needles, 40, 20),
        ];
        assert_eq!(whole, pair, "height {height}");
        assert!(pair.iter().all(|&hits| hits <= 1));
    }
}

#[test]
fn borders_of_size_classes_are_invisible() {
    for extent in [SMALL_EXTENT - 1, SMALL_EXTENT, SMALL_EXTENT + 1, 46_340, 46_341] {
        let [a, b, c, d] = [[3, 5], [3 + extent, 5], [3 + extent, 5 + extent], [3, 5 + extent]];
        let halves = [triangle(0, [a, b, c], 0.5).unwrap(), triangle(1, [a, c, d], 0.5).unwrap()];
        for (pixel, hits) in layers(&halves, 200, 200).into_iter().enumerate() {
            let (x, y) = (256 * (pixel as i32 % 200) + 128, 256 * (pixel as i32 / 200) + 128);
            let inside = (3..3 + extent).contains(&x) && (5..5 + extent).contains(&y);
            assert_eq!(hits, u32::from(inside), "extent {extent}, pixel {pixel}");
        }
    }
}
