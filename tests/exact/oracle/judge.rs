//! The judge passes a correct single-precision adapter and catches every mistake that it is shown.

use super::*;

#[test]
fn an_honest_adapter_passes_every_stage() {
    let (scene, view) = still_life([96, 64]);
    let stack = all_effects();
    let frame = render(&scene, &view, &stack).unwrap();
    let geometry = projected(&scene, &view);
    assert!(frame.covered() > 3000, "{}", frame.covered());
    assert!(frame.counters.clipped == 2 && !geometry.clipped_triangles.is_empty());
    let verdict = judge(
        &scene,
        &view,
        &stack,
        &AdapterPicture::new(&frame, &geometry),
    )
    .unwrap();
    assert_eq!(
        verdict.report.within(&Budget::default()),
        Ok(()),
        "{:?}",
        verdict.report
    );
    assert_eq!(verdict.expected, frame);
}

/// A plain rasterizer that shares no coverage code with the oracle, with an option for every
/// classic mistake.
#[derive(Clone)]
struct Adapter {
    /// Bias of edges that are top or left, and of the others.
    bias: [i64; 2],
    /// Position of the sample in its pixel, in sub-pixel units.
    sample: i64,
    larger_id_wins: bool,
    /// A triangle that is not drawn.
    lost: Option<u32>,
}

impl Default for Adapter {
    fn default() -> Self {
        Self {
            bias: [0, 1],
            sample: 128,
            larger_id_wins: false,
            lost: None,
        }
    }
}

impl Adapter {
    /// Triangle ids, keys, layers and colors of `geometry`.
    fn draw(
        &self,
        scene: &Scene,
        view: &View,
        stack: &Stack,
        geometry: &Geometry,
    ) -> (Frame, Vec<u32>) {
        let draws = draws(scene, view).unwrap();
        let (drawn, counters) = assembled(scene, view, geometry);
        let (width, pixels) = (view.width as usize, view.pixels());
        let mut frame = Frame {
            width: view.width,
            height: view.height,
            triangle_id: vec![NO_TRIANGLE; pixels],
            depth_key: vec![0; pixels],
            ..Default::default()
        };
        let mut layers = vec![0; pixels];
        for triangle in drawn
            .iter()
            .filter(|triangle| Some(triangle.id) != self.lost)
        {
            for (pixel, layers) in layers.iter_mut().enumerate() {
                let (x, y) = (
                    256 * (pixel % width) as i64 + self.sample,
                    256 * (pixel / width) as i64 + self.sample,
                );
                let Some(key) = self.hit(triangle, x, y) else {
                    continue;
                };
                *layers += 1;
                let tie = if self.larger_id_wins {
                    triangle.id > frame.triangle_id[pixel]
                } else {
                    triangle.id < frame.triangle_id[pixel]
                };
                if key > frame.depth_key[pixel] || key == frame.depth_key[pixel] && tie {
                    (frame.depth_key[pixel], frame.triangle_id[pixel]) = (key, triangle.id);
                }
            }
        }
        frame.color = shade(
            &Shot::new(scene, &draws, view, stack),
            &seen(&frame),
            geometry,
        )
        .expect("nobody cancels it");
        frame.counters = counters;
        (frame, layers)
    }

    fn hit(&self, triangle: &OrientedTriangle, x: i64, y: i64) -> Option<u32> {
        let [a, b, c] = triangle.corners;
        let mut weights = [0; 3];
        for (i, (p, q)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
            let (dx, dy) = (i64::from(q.x - p.x), i64::from(q.y - p.y));
            let is_top_left = dy < 0 || dy == 0 && dx > 0;
            weights[i] = dx * (y - i64::from(p.y)) - dy * (x - i64::from(p.x));
            if weights[i] < self.bias[usize::from(!is_top_left)] {
                return None;
            }
        }
        // Single precision, as a device has it.
        let [u, v, w] = weights.map(|weight| weight as f32);
        let (low, high) = (
            a.depth.min(b.depth).min(c.depth),
            a.depth.max(b.depth).max(c.depth),
        );
        Some(
            ((u * a.depth + v * b.depth + w * c.depth) / (u + v + w))
                .clamp(low, high)
                .to_bits()
                .max(1),
        )
    }
}

/// Draws with `adapter` and judges the result; `before` changes the geometry, `after` the frame and
/// the layers.
fn judged(
    (scene, view): &(Scene, View),
    adapter: &Adapter,
    before: impl FnOnce(&mut Geometry),
    after: impl FnOnce(&mut Frame, &mut Vec<u32>),
) -> ErrorReport {
    let stack = all_effects();
    let mut geometry = projected(scene, view);
    before(&mut geometry);
    let (mut frame, mut layers) = adapter.draw(scene, view, &stack, &geometry);
    after(&mut frame, &mut layers);
    judge(
        scene,
        view,
        &stack,
        &AdapterPicture {
            layers: Some(&layers),
            ..AdapterPicture::new(&frame, &geometry)
        },
    )
    .unwrap()
    .report
}

/// Squares whose edges and diagonals run through samples, in layers one behind the other, some of
/// them coplanar.
fn lattice() -> (Scene, View) {
    let mut corners = Vec::new();
    for i in 0..3 {
        for (column, row) in (0..6).flat_map(|column| (0..6).map(move |row| (column, row))) {
            let (x, y, z) = (
                0.5 + 2.0 * column as f32,
                0.5 + 2.0 * row as f32,
                0.625 - 0.125 * (i / 2) as f32,
            );
            let [a, b, c, d] = [
                [x, y, z],
                [x + 2.0, y, z],
                [x + 2.0, y + 2.0, z],
                [x, y + 2.0, z],
            ];
            corners.extend([a, b, c, a, c, d]);
        }
    }
    (scene(&[triangle_soup(corners)]), pixel_view(16, 16))
}

#[test]
fn single_precision_adapter_passes() {
    for fixture in [still_life([64, 48]), lattice()] {
        let accuracy = judged(&fixture, &Adapter::default(), |_| {}, |_, _| {});
        assert_eq!(accuracy.within(&Budget::default()), Ok(()), "{accuracy:?}");
        assert_eq!(
            (accuracy.explained_by_snap, accuracy.max_snap_delta),
            (0, 0)
        );
    }
}

#[test]
fn one_pixel_shift_is_caught() {
    let accuracy = judged(
        &still_life([64, 48]),
        &Adapter::default(),
        |_| {},
        |frame, layers| {
            frame.triangle_id.rotate_right(1);
            frame.depth_key.rotate_right(1);
            frame.color.rotate_right(1);
            layers.rotate_right(1);
        },
    );
    assert!(
        accuracy.wrong_triangles > 50 && accuracy.holes > 10 && accuracy.double_hits > 10,
        "{accuracy:?}"
    );
    assert!(accuracy.within(&Budget::default()).is_err());
}

#[test]
fn two_steps_of_255_are_caught_and_one_passes() {
    for (steps, passes) in [(1, true), (2, false)] {
        let accuracy = judged(
            &still_life([64, 48]),
            &Adapter::default(),
            |_| {},
            |frame, _| {
                frame.color[777][1] = frame.color[777][1].checked_sub(steps).unwrap();
            },
        );
        assert_eq!(
            (
                accuracy.max_color_delta,
                accuracy.within(&Budget::default()).is_ok()
            ),
            (steps, passes)
        );
    }
}

#[test]
fn missing_triangle_is_caught() {
    let fixture = still_life([64, 48]);
    let (frame, _) = Adapter::default().draw(
        &fixture.0,
        &fixture.1,
        &Stack::default(),
        &projected(&fixture.0, &fixture.1),
    );
    let mut triangle_ids = frame.triangle_id.clone();
    triangle_ids.sort_unstable();
    triangle_ids.dedup();
    assert!(triangle_ids.len() > 100);
    for &lost in triangle_ids
        .iter()
        .filter(|&&triangle_id| triangle_id != NO_TRIANGLE)
        .step_by(7)
    {
        let accuracy = judged(
            &fixture,
            &Adapter {
                lost: Some(lost),
                ..Default::default()
            },
            |_| {},
            |_, _| {},
        );
        assert!(
            accuracy.wrong_triangles > 0 && accuracy.holes > 0,
            "{lost}: {accuracy:?}"
        );
    }
}

#[test]
fn exchanged_triangle_ids_are_caught() {
    let accuracy = judged(
        &still_life([64, 48]),
        &Adapter::default(),
        |_| {},
        |frame, _| {
            let a = frame.triangle_id[24 * 64 + 32];
            let b = *frame
                .triangle_id
                .iter()
                .find(|&&triangle_id| triangle_id != a && triangle_id != NO_TRIANGLE)
                .unwrap();
            for triangle_id in &mut frame.triangle_id {
                *triangle_id = if *triangle_id == a {
                    b
                } else if *triangle_id == b {
                    a
                } else {
                    *triangle_id
                };
            }
        },
    );
    assert!(
        accuracy.wrong_triangles > 1 && accuracy.holes + accuracy.double_hits == 0,
        "{accuracy:?}"
    );
}

#[test]
fn edge_rules_off_by_one_are_caught() {
    for (bias, doubled) in [([0, 0], true), ([1, 1], false)] {
        let accuracy = judged(
            &lattice(),
            &Adapter {
                bias,
                ..Default::default()
            },
            |_| {},
            |_, _| {},
        );
        assert!(
            if doubled {
                accuracy.double_hits > 50
            } else {
                accuracy.holes > 50
            },
            "{bias:?}: {accuracy:?}"
        );
    }
    let corner = judged(
        &still_life([64, 48]),
        &Adapter {
            sample: 0,
            ..Default::default()
        },
        |_| {},
        |_, _| {},
    );
    assert!(corner.wrong_triangles > 50, "{corner:?}");
}

#[test]
fn larger_id_at_equal_depth_is_caught() {
    let accuracy = judged(
        &lattice(),
        &Adapter {
            larger_id_wins: true,
            ..Default::default()
        },
        |_| {},
        |_, _| {},
    );
    assert!(
        accuracy.wrong_triangles > 50 && accuracy.depth_band_pixels == 0,
        "{accuracy:?}"
    );
}

#[test]
fn double_hit_behind_the_surface_is_caught() {
    let accuracy = judged(
        &still_life([64, 48]),
        &Adapter::default(),
        |_| {},
        |_, layers| layers[1000] += 1,
    );
    assert_eq!((accuracy.double_hits, accuracy.wrong_triangles), (1, 0));
}

#[test]
fn wrong_depth_key_is_caught() {
    for steps in [-40i32, 40] {
        let accuracy = judged(
            &still_life([64, 48]),
            &Adapter::default(),
            |_| {},
            |frame, _| {
                let pixel = 24 * 64 + 32;
                frame.depth_key[pixel] = frame.depth_key[pixel].wrapping_add_signed(steps);
            },
        );
        assert_eq!(accuracy.key_outside_bound, 1);
    }
    let orphan = judged(
        &still_life([64, 48]),
        &Adapter::default(),
        |_| {},
        |frame, _| {
            let empty = frame
                .triangle_id
                .iter()
                .position(|&triangle_id| triangle_id == NO_TRIANGLE)
                .unwrap();
            frame.depth_key[empty] = 7;
        },
    );
    assert_eq!(orphan.depth_without_id, 1);
}

#[test]
fn either_triangle_is_right_in_the_depth_band_and_nowhere_else() {
    let sheets = [
        [0.0, -70.0, 0.25],
        [0.0, 140.0, 0.25],
        [65.0, 0.0, 0.75],
        [0.0, -70.0, 0.75],
        [0.0, 140.0, 0.75],
        [65.0, 0.0, 0.25],
    ];
    let fixture = (scene(&[triangle_soup(sheets)]), pixel_view(64, 16));
    let other = |x: usize| {
        judged(
            &fixture,
            &Adapter::default(),
            |_| {},
            |frame, _| {
                for triangle_id in frame.triangle_id.iter_mut().skip(x).step_by(64) {
                    *triangle_id = 1 - *triangle_id;
                }
                let (scene, view) = &fixture;
                let draws = draws(scene, view).unwrap();
                frame.color = shade(
                    &Shot::new(scene, &draws, view, &all_effects()),
                    &seen(frame),
                    &projected(scene, view),
                )
                .expect("nobody cancels it");
            },
        )
    };
    // The sheets cross at x = 32.5, on the samples of column 32.
    let columns: Vec<usize> = (0..64).filter(|&x| other(x).wrong_triangles == 0).collect();
    let coverage = {
        bounded(
            &assembled(&fixture.0, &fixture.1, &projected(&fixture.0, &fixture.1)).0,
            &fixture.1,
        )
    };
    let band: Vec<usize> = (0..64).filter(|&x| coverage.samples[x].is_band()).collect();
    assert_eq!((columns, band), (vec![32], vec![32]));
}

#[test]
fn affine_weights_are_caught() {
    let scene = scene(&[ground(2.0, -1.0)]);
    let camera = Camera {
        eye: DVec3::new(0.0, -0.5, 2.5),
        target: DVec3::NEG_Y,
        ..Default::default()
    };
    let view = View::new(&camera, 64, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
    let stack = only("depth", &[]);
    let draws = draws(&scene, &view).unwrap();
    let geometry = projected(&scene, &view);
    let (mut frame, layers) = Adapter::default().draw(&scene, &view, &stack, &geometry);
    let mut affine = geometry.clone();
    affine
        .vertices
        .iter_mut()
        .for_each(|vertex| vertex.inv_w = 0.25);
    frame.color = shade(
        &Shot::new(&scene, &draws, &view, &stack),
        &seen(&frame),
        &affine,
    )
    .expect("nobody cancels it");
    let accuracy = judge(
        &scene,
        &view,
        &stack,
        &AdapterPicture {
            layers: Some(&layers),
            ..AdapterPicture::new(&frame, &geometry)
        },
    )
    .unwrap()
    .report;
    assert!(
        geometry.clipped_triangles.is_empty()
            && accuracy.wrong_triangles == 0
            && accuracy.max_color_delta > 20,
        "{accuracy:?}"
    );
}

#[test]
fn vertices_one_unit_apart_are_explained_and_counted() {
    let mut rng = Rng(31);
    let jitter = |geometry: &mut Geometry| {
        for vertex in geometry
            .vertices
            .iter_mut()
            .filter(|vertex| vertex.flags == 0)
        {
            (vertex.x, vertex.y) = (vertex.x + rng.between(-1, 2), vertex.y + rng.between(-1, 2));
        }
    };
    let accuracy = judged(
        &still_life([128, 96]),
        &Adapter::default(),
        jitter,
        |_, _| {},
    );
    assert_eq!(accuracy.within(&Budget::default()), Ok(()), "{accuracy:?}");
    assert!(
        accuracy.explained_by_snap > 0 && accuracy.max_snap_delta == 1,
        "{accuracy:?}"
    );
    assert!(
        accuracy
            .within(&Budget {
                max_explained: 0,
                ..Default::default()
            })
            .is_err()
    );
}

#[test]
fn crossing_line_that_moves_with_the_snap_is_explained() {
    let right = 65.0 + 1.0 / 256.0;
    let sheets = [
        [0.0, -70.0, 0.25],
        [0.0, 140.0, 0.25],
        [right, 0.0, 0.75],
        [0.0, -70.0, 0.75],
        [0.0, 140.0, 0.75],
        [right, 0.0, 0.25],
    ];
    let fixture = (scene(&[triangle_soup(sheets)]), pixel_view(64, 16));
    // The sheets cross half a unit to the right of the samples of column 32, then half a unit to
    // the left.
    let shift = |geometry: &mut Geometry| {
        geometry
            .vertices
            .iter_mut()
            .for_each(|vertex| vertex.x -= 1)
    };
    let accuracy = judged(&fixture, &Adapter::default(), shift, |_, _| {});
    assert_eq!(
        (
            accuracy.explained_by_snap,
            accuracy.unexplained,
            accuracy.wrong_triangles
        ),
        (16, 0, 0),
        "{accuracy:?}"
    );
}

/// A vertex stage in f32, with fused and unfused sums and a division that is a little off, as WGSL
/// allows.
fn single_precision(scene: &Scene, view: &View, geometry: &mut Geometry, rng: &mut Rng) {
    for draw in draws(scene, view).unwrap() {
        let primitive = &scene.primitives[draw.primitive];
        for vertex in 0..primitive.vertex_count() {
            let record = &mut geometry.vertices[(draw.first_vertex + vertex) as usize];
            if record.flags != 0 {
                continue;
            }
            let [x, y, z] = primitive.position(scene, vertex);
            let m = &draw.clip_from_object;
            let is_fused = rng.next_u32() & 1 == 0;
            let row = |r: usize| match is_fused {
                true => m[0][r].mul_add(x, m[1][r].mul_add(y, m[2][r].mul_add(z, m[3][r]))),
                false => m[0][r] * x + m[1][r] * y + (m[2][r] * z + m[3][r]),
            };
            let inv_w = f32::from_bits(
                (1.0 / row(3))
                    .to_bits()
                    .wrapping_add_signed(rng.between(-2, 3)),
            );
            let [half_x, half_y] = [view.width, view.height].map(|pixels| 128.0 * pixels as f32);
            record.x = half_x as i32 + (row(0) * inv_w * half_x).round_ties_even() as i32;
            record.y = half_y as i32 - (row(1) * inv_w * half_y).round_ties_even() as i32;
            (record.depth, record.inv_w) = (row(2) * inv_w, inv_w);
        }
    }
}

#[test]
fn single_precision_vertices_stay_within_their_bounds() {
    let mut rng = Rng(37);
    let mut largest = 0;
    for away in [0.0, 100.0, 1e4, 1e6] {
        let offset = DVec3::new(away, -0.5 * away, 0.25 * away);
        // Offset in the stored positions too, so that the sums cancel.
        let mut mesh = sphere(12);
        mesh.positions
            .iter_mut()
            .flatten()
            .for_each(|v| *v += away as f32);
        let world_from_object = DMat4::from_translation(offset - DVec3::splat(away));
        let scene = scene(&[
            mesh.at(world_from_object),
            ground(50.0, -1.0).at(DMat4::from_translation(offset)),
        ]);
        let camera = Camera {
            eye: offset + DVec3::new(1.0, 1.5, 4.0),
            target: offset,
            ..Default::default()
        };
        let view = View::new(&camera, 96, 72, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let fixture = (scene, view);
        let accuracy = judged(
            &fixture,
            &Adapter::default(),
            |g| single_precision(&fixture.0, &fixture.1, g, &mut rng),
            |_, _| {},
        );
        assert_eq!(
            accuracy.within(&Budget::default()),
            Ok(()),
            "{away}: {accuracy:?}"
        );
        assert!(
            accuracy.ill_conditioned == 0 || away > 1e5,
            "{away}: {accuracy:?}"
        );
        largest = largest.max(accuracy.max_snap_delta);
    }
    assert!(
        largest > 1,
        "the far scenes are hard enough to need a bound"
    );
}

#[test]
fn vertex_outside_its_bound_is_caught() {
    let fixture = still_life([64, 48]);
    let moved = judged(
        &fixture,
        &Adapter::default(),
        |geometry| geometry.vertices[60].x += 2,
        |_, _| {},
    );
    assert_eq!(
        (
            moved.snap_outside_bound,
            moved.max_snap_delta,
            moved.snap_over_one_unit
        ),
        (1, 2, 1),
        "{moved:?}"
    );
    let lifted = judged(
        &fixture,
        &Adapter::default(),
        |geometry| geometry.vertices[60].depth *= 1.0 + 1e-5,
        |_, _| {},
    );
    assert_eq!(
        (lifted.attribute_outside_bound, lifted.snap_outside_bound),
        (1, 0),
        "{lifted:?}"
    );
    let stretched = judged(
        &fixture,
        &Adapter::default(),
        |geometry| geometry.vertices[60].inv_w *= 1.0 - 1e-5,
        |_, _| {},
    );
    assert_eq!(stretched.attribute_outside_bound, 1, "{stretched:?}");
    let rejected = judged(
        &fixture,
        &Adapter::default(),
        |geometry| geometry.vertices[60].flags = vertex_flags::NONFINITE,
        |_, _| {},
    );
    assert_eq!(rejected.snap_outside_bound, 1, "{rejected:?}");
}

#[test]
fn lost_clipped_triangle_is_caught() {
    let fixture = still_life([64, 48]);
    let count = projected(&fixture.0, &fixture.1).clipped_triangles.len();
    let unexplained = |lost: usize| {
        judged(
            &fixture,
            &Adapter::default(),
            |geometry| _ = geometry.clipped_triangles.remove(lost),
            |_, _| {},
        )
        .unexplained
    };
    assert!((0..count).any(|lost| unexplained(lost) > 50));
    // The clipped triangles of other parents may come in any order.
    let shuffled = judged(
        &fixture,
        &Adapter::default(),
        |geometry| {
            geometry
                .clipped_triangles
                .sort_by_key(|triangle: &ClippedTriangle| !triangle.parent)
        },
        |_, _| {},
    );
    assert_eq!(shuffled.within(&Budget::default()), Ok(()));
}

#[test]
fn wrong_counters_and_overflow_are_caught() {
    let fixture = still_life([64, 48]);
    let overflow = judged(
        &fixture,
        &Adapter::default(),
        |_| {},
        |frame, _| frame.counters.overflow = 1,
    );
    assert!(
        overflow
            .within(&Budget::default())
            .unwrap_err()
            .contains("queue")
    );
    let miscounted = judged(
        &fixture,
        &Adapter::default(),
        |_| {},
        |frame, _| frame.counters.rejected_range = 1,
    );
    assert_eq!(miscounted.counters_wrong, 1);
}

#[test]
fn passes_of_image_effects_are_judged_from_the_adapters_picture_before_them() {
    let (scene, view) = still_life([48, 32]);
    let mut stack = all_effects();
    for name in ["ambient", "blur", "bloom", "halftone"] {
        stack.enable(Effect::find(name).expect("a listed effect"));
    }
    let frame = render(&scene, &view, &stack).unwrap();
    let geometry = projected(&scene, &view);
    let report = |frame: &Frame| {
        let picture = AdapterPicture::new(frame, &geometry);
        judge(&scene, &view, &stack, &picture).unwrap().report
    };
    let honest = report(&frame);
    assert_eq!(honest.within(&Budget::default()), Ok(()), "{honest:?}");
    assert_eq!(honest.max_color_delta, 0);
    let changed = |change: &dyn Fn(&mut Frame)| {
        let mut changed = frame.clone();
        change(&mut changed);
        report(&changed)
    };
    let spot = changed(&|frame| frame.color[700][1] ^= 8);
    assert!(spot.max_color_delta >= 7, "{spot:?}");
    let skipped = changed(&|frame| frame.color = frame.resolved().to_vec());
    assert!(skipped.max_color_delta > 20, "{skipped:?}");
    // Right passes over a wrong picture are no excuse.
    let before = changed(&|frame| {
        let resolved = frame.resolved.as_mut().expect("the picture before");
        resolved.rotate_right(1);
    });
    assert!(before.within(&Budget::default()).is_err(), "{before:?}");
    let faults = rasterlab::preset::GoldenTest::default().faults(&before, 0, false);
    assert!(faults.concat().contains("largest color"), "{faults:?}");
}
