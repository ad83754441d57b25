//! Projection and clipping: the snap is symmetric, clipping leaves no cracks, and vertices that are
//! out of range are rejected.

use super::*;

#[test]
fn snap_is_symmetric_about_the_center_and_rounds_to_even() {
    let half = 1.0 / 512.0;
    let mesh = triangle_soup([
        [32.0 + half, 32.0 + half, 0.5],
        [32.0 - half, 32.0 - half, 0.5],
        [32.0 + 3.0 * half, 32.0 - 3.0 * half, 0.5],
    ]);
    let (scene, view) = (scene(&[mesh]), pixel_view(64, 64));
    let vertices = projected(&scene, &view).vertices;
    assert_eq!(
        vertices
            .iter()
            .map(|v| (v.x - 8192, v.y - 8192))
            .collect::<Vec<_>>(),
        [(0, 0), (0, 0), (2, -2)]
    );
}

#[test]
fn mesh_through_the_guard_band_has_no_cracks() {
    let view = pixel_view(64, 64);
    let guard = f64::from(GUARD_BAND) / 256.0;
    for beyond in [0.0, 1.0 / 256.0, 1.0, 5e3, 1e6, 1e9] {
        let far = (guard + beyond) as f32;
        for hub in [[31.3f32, 12.9], [0.5, 0.5], [63.99, 40.25]] {
            let rim = [[-far, -far], [far, -far], [far, far], [-far, far]];
            let wedge = |i: usize| {
                [
                    [hub[0], hub[1], 0.25],
                    [rim[i][0], rim[i][1], 0.5],
                    [rim[(i + 1) % 4][0], rim[(i + 1) % 4][1], 0.75],
                ]
            };
            let mesh = triangle_soup((0..4).flat_map(wedge));
            let (layers, counters) = covered(&scene(&[mesh]), &view);
            assert!(
                layers.iter().all(|&hits| hits == 1),
                "beyond {beyond}, hub {hub:?}"
            );
            assert_eq!(counters.clipped, if beyond == 0.0 { 0 } else { 4 });
        }
    }
}

/// One long edge runs through the picture and ends beyond a side of the guard band; clipping must
/// not move it.
#[test]
fn edges_cut_by_the_guard_band_keep_their_course() {
    let view = pixel_view(64, 64);
    let center = DVec3::new(32.3, 31.7, 0.5);
    for step in 0..64 {
        let (sin, cos) = libm::sincos(f64::from(step) * std::f64::consts::TAU / 64.0 + 0.01);
        let (along, across) = (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0));
        let corners = [
            center - along * 2e4,
            center + along * 3e5,
            center + across * 3e5,
        ]
        .map(|p| p.as_vec3().to_array());
        let (layers, counters) = covered(&scene(&[triangle_soup(corners)]), &view);
        assert_eq!(counters.clipped, 1);
        for (pixel, hits) in layers.into_iter().enumerate() {
            let sample = DVec3::new((pixel % 64) as f64 + 0.5, (pixel / 64) as f64 + 0.5, 0.5);
            let inside = (sample - center).dot(across);
            // Half a unit of snap at either end, and f32 corners at 3e5 px.
            assert!(
                inside.abs() < 0.04 || hits == u32::from(inside > 0.0),
                "step {step}, pixel {pixel}"
            );
        }
    }
}

#[test]
fn flipped_clipped_triangles_are_dropped_and_counted() {
    let corners = [[0.0, 0.0, 0.5], [16.0, 0.0, 0.5], [40_000.0, 40_000.0, 0.5]];
    let (scene, view) = (scene(&[triangle_soup(corners)]), pixel_view(16, 16));
    let mut geometry = projected(&scene, &view);
    let fan = geometry.clipped_triangles.clone();
    assert!(!fan.is_empty());
    let whole = assembled(&scene, &view, &geometry).0.len();
    let mut folded = ClippedTriangle {
        parent: 0,
        corners: [at(0, 0, 0.5), at(600, 0, 0.5), at(0, 600, 0.5)],
        outline: 7,
    };
    if area(fan[0].corners.map(|c| [c.x, c.y])) > 0 {
        folded.corners.swap(1, 2);
    }
    let line = ClippedTriangle {
        parent: 0,
        corners: [at(0, 0, 0.5), at(600, 600, 0.5), at(900, 900, 0.5)],
        outline: 7,
    };
    geometry.clipped_triangles.extend([folded, line]);
    let (drawn, counters) = assembled(&scene, &view, &geometry);
    assert_eq!(
        (drawn.len(), counters.flipped_clips, counters.clipped),
        (whole, 2, 1)
    );
}

#[test]
fn clipped_triangles_stay_inside_the_guard_band_with_planes_set_exactly() {
    let view = square_perspective(64, 64, 0.5);
    let mut rng = Rng(29);
    let mut number = |scale: f32| rng.between(-1_000_000, 1_000_001) as f32 * 1e-6 * scale;
    let soup: Vec<[f32; 3]> = (0..3000)
        .map(|_| [number(3.0), number(3.0), number(2.0)])
        .collect();
    let scene = scene(&[triangle_soup(soup)]);
    let geometry = projected(&scene, &view);
    assert!(
        geometry.clipped_triangles.len() > 500
            && geometry
                .clipped_triangles
                .is_sorted_by_key(|triangle| triangle.parent)
    );
    let corners: Vec<_> = geometry
        .clipped_triangles
        .iter()
        .flat_map(|triangle| triangle.corners)
        .collect();
    assert!(
        corners
            .iter()
            .all(|c| c.flags == 0 && c.x.abs() <= GUARD_BAND && c.y.abs() <= GUARD_BAND)
    );
    assert!(
        corners
            .iter()
            .all(|c| c.depth > 0.0 && c.depth <= 1.0 && c.inv_w <= 2.0)
    );
    assert!(
        corners.iter().filter(|c| c.depth == 1.0).count() > 500,
        "cuts by the near plane lie on it"
    );
}

/// A tilted plane sweeps through the near plane; the ray through each pixel says where it is cut.
#[test]
fn near_plane_takes_at_most_a_row_too_much() {
    const SIZE: u32 = 24;
    let view = square_perspective(SIZE, SIZE, 1.0);
    for step in 0..1000 {
        let d = 0.2 + 1.6 * f64::from(step) / 1000.0;
        let corner = |x: f32, y: f32| [x, y, -(d + 0.7 * f64::from(y)) as f32];
        let [a, b, c, e] = [
            corner(-100.0, -100.0),
            corner(100.0, -100.0),
            corner(100.0, 100.0),
            corner(-100.0, 100.0),
        ];
        let (layers, counters) = covered(&scene(&[triangle_soup([a, b, c, a, c, e])]), &view);
        assert_eq!(counters.clipped, 2);
        for (pixel, hits) in layers.into_iter().enumerate() {
            // w = d + 0.7 y w along the ray, and w >= 1 is kept.
            let y = 1.0 - (f64::from(pixel as u32 / SIZE) + 0.5) * 2.0 / f64::from(SIZE);
            let rows = (y - (1.0 - d) / 0.7) * f64::from(SIZE) / 2.0;
            assert!(
                hits <= 1 && (rows.abs() <= 1.0 || hits == u32::from(rows > 0.0)),
                "step {step}, pixel {pixel}"
            );
        }
    }
}

#[test]
fn w_at_and_around_zero_stays_inside_its_picture() {
    let near = MIN_NEAR_M;
    let view = square_perspective(32, 32, near);
    let ws = [
        0.0,
        1e-30,
        -1e-30,
        near as f32,
        -(near as f32),
        f32::from_bits((near as f32).to_bits() - 1),
        1.0,
        -1.0,
    ];
    for (i, wa) in ws.iter().enumerate() {
        for (j, wb) in ws.iter().enumerate() {
            let mesh = triangle_soup([[0.3, -0.2, -wa], [-0.4, 0.1, -wb], [0.1, 0.6, -1.0]]);
            let scene = scene(&[mesh]);
            let frame = render(&scene, &view, &all_effects()).unwrap();
            let geometry = projected(&scene, &view);
            let verdict = judge(
                &scene,
                &view,
                &all_effects(),
                &AdapterPicture::new(&frame, &geometry),
            )
            .unwrap();
            assert_eq!(
                verdict.report.within(&Budget::default()),
                Ok(()),
                "w {i} {j}"
            );
        }
    }
}

#[test]
fn rejected_vertices_take_only_their_own_triangles_along() {
    let good = [[0.0, 0.0, 0.5], [16.0, 0.0, 0.5], [0.0, 16.0, 0.5]];
    for (bad, nonfinite, range) in [
        (f32::NAN, 1, 0),
        (f32::INFINITY, 1, 0),
        (f32::NEG_INFINITY, 1, 0),
        (f32::MAX, 0, 1),
        (-1.1e12, 0, 1),
        (f32::from_bits(0x7f80_0001), 1, 0),
        (f32::from_bits(1), 0, 0),
        (1.0e12, 0, 0),
    ] {
        for component in 0..3 {
            let mut broken = [[1.0, 2.0, 0.5], [3.0, 4.0, 0.5], [5.0, 1.0, 0.5]];
            broken[1][component] = bad;
            let mesh = triangle_soup([good, broken].concat());
            let (layers, counters) = covered(&scene(&[mesh]), &pixel_view(16, 16));
            assert_eq!(
                (counters.rejected_nonfinite, counters.rejected_range),
                (nonfinite, range),
                "{bad} in component {component}"
            );
            assert!(layers[0] >= 1 && layers[255] == 0);
        }
    }
    let subnormal = triangle_soup([
        [0.0, 0.0, 0.5],
        [f32::from_bits(0x007f_ffff), 16.0, 0.5],
        [16.0, 0.0, 0.5],
    ]);
    let zero = triangle_soup([[0.0, 0.0, 0.5], [0.0, 16.0, 0.5], [16.0, 0.0, 0.5]]);
    let view = pixel_view(16, 16);
    let [a, b] =
        [subnormal, zero].map(|mesh| render(&scene(&[mesh]), &view, &Stack::default()).unwrap());
    assert_eq!(a, b);
}

#[test]
fn degenerate_triangles_are_counted_and_leave_no_trace() {
    let p = [3.0, 3.0, 0.5];
    let line = [[0.0, 0.0, 0.5], [4.0, 4.0, 0.5], [8.0, 8.0, 0.5]];
    let mesh = triangle_soup([[p, p, p], [p, p, [9.0, 1.0, 0.5]], line].concat());
    let (layers, counters) = covered(&scene(&[mesh]), &pixel_view(16, 16));
    assert_eq!((counters.degenerate, layers.iter().max()), (3, Some(&0)));
    let empty = scene(&[SimpleMesh::default()]);
    let frame = render(&empty, &pixel_view(4, 4), &Stack::default()).unwrap();
    assert_eq!((frame.covered(), frame.counters), (0, Counters::default()));
}

#[test]
fn picture_without_pixels_is_empty() {
    for size in [[0, 0], [0, 7], [7, 0]] {
        let (scene, _) = still_life([4, 4]);
        let view = View::new(
            &Camera::default(),
            size[0],
            size[1],
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        );
        let frame = render(&scene, &view, &all_effects()).unwrap();
        assert_eq!(
            (
                [frame.width, frame.height],
                frame.triangle_id.len(),
                frame.color.len()
            ),
            (size, 0, 0)
        );
        // An adapter dispatches nothing and has no geometry.
        let verdict = judge(
            &scene,
            &view,
            &all_effects(),
            &AdapterPicture::new(&frame, &Geometry::default()),
        )
        .unwrap();
        assert_eq!(
            (verdict.report, verdict.expected),
            (ErrorReport::default(), frame)
        );
    }
}
