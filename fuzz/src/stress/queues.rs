//! Queues: more workgroups than a dispatch dimension holds, queues that are exactly full or
//! overflow, and millions of triangles.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, layers},
    context::CaseContext,
    drawing::{WorkDistribution, pinned, stack},
    scenes::{SimpleMesh, pixel_view, scene_of_meshes, triangle_soup, triangle_soup_in_units},
};
use crate::{
    accuracy::{Culling, PinnedOptions, Visibility},
    frame::vertex_flags,
    gpu::{Capacities, Capture},
    math::GUARD_BAND,
    plan::{AccuracyRequest, Tuning},
    scene::{Scene, view::View},
};

pub const CASES: &[Case] = &[
    Case {
        number: 18,
        name: "workgroups-direct",
        about: "65,535 to 65,537 workgroups of triangles and of vertices, dispatched directly: the complete picture",
        expectation: Expectation::Exact,
        run: workgroups_direct,
    },
    Case {
        number: 18,
        name: "workgroups-indirect",
        about: "as many medium and large triangles and tiles, dispatched indirectly",
        expectation: Expectation::Exact,
        run: workgroups_indirect,
    },
    Case {
        number: 19,
        name: "queues",
        about: "each queue with capacities of its demand n, of n - 1, n / 10 and 1: overflow is counted, the queue grows, and the redraw is exact",
        expectation: Expectation::Exact,
        run: queues,
    },
    Case {
        number: 19,
        name: "clipped-in-turns",
        about: "more triangles to clip than a dispatch of 48 workgroups has invocations: each is clipped, in turns",
        expectation: Expectation::Exact,
        run: clipped_in_turns,
    },
    Case {
        number: 27,
        name: "ten-million-triangles",
        about: "ten million tiny triangles with known triangle ids and hits",
        expectation: Expectation::Exact,
        run: ten_million_triangles,
    },
    Case {
        number: 27,
        name: "million-instances",
        about: "a million instances of one triangle, one for each pixel of 1000 x 1000: known triangle ids, culled by instance too",
        expectation: Expectation::Exact,
        run: million_instances,
    },
    Case {
        number: 27,
        name: "thousand-full-screen-triangles",
        about: "triangles far larger than the picture, each of which covers all of it",
        expectation: Expectation::Exact,
        run: thousand_full_screen_triangles,
    },
];

/// Tiny triangles, one hit each, one pixel after another in rows of a 64 x 64 picture; later
/// instances are nearer.
#[derive(Clone, Copy)]
struct TinyTriangles {
    /// Triangles of the mesh.
    count: u32,
    instances: u32,
    vertices: Vertices,
}

/// Whether triangles share vertices.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Vertices {
    /// Triangles on the same pixel share their vertices by an index list.
    Shared,
    /// Each triangle has three vertices of its own.
    Separate,
}

impl TinyTriangles {
    const PIXELS: u32 = 64 * 64;

    fn scene(self) -> (Arc<Scene>, View) {
        let Self {
            count,
            instances,
            vertices,
        } = self;
        let corner = |i: u32, c: usize| {
            let (x, y) = ((i % 64) as f32, (i / 64 % 64) as f32);
            [
                [x + 0.25, y + 0.25, 0.0],
                [x + 0.75, y + 0.5, 0.0],
                [x + 0.25, y + 0.75, 0.0],
            ][c]
        };
        let (distinct, indices) = match vertices {
            Vertices::Shared => {
                let distinct = Self::PIXELS.min(count);
                (
                    distinct,
                    (0..count)
                        .flat_map(|i| [0, 1, 2].map(|c| 3 * (i % distinct) + c))
                        .collect(),
                )
            }
            Vertices::Separate => (count, vec![]),
        };
        let transform = |i: u32| {
            DMat4::from_translation(DVec3::Z * f64::from(i + 1) / f64::from(instances + 1))
        };
        let mesh = SimpleMesh {
            positions: (0..distinct)
                .flat_map(|i| [0, 1, 2].map(|c| corner(i, c)))
                .collect(),
            indices,
            transforms: (0..instances).map(transform).collect(),
            ..SimpleMesh::default()
        };
        (scene_of_meshes(&[mesh]), pixel_view(64, 64))
    }

    /// Checks the hits of each pixel, and its triangle id: the smallest id of the last, nearest
    /// instance.
    fn check(self, capture: &Capture, what: &str) -> Result<(), EarlyEnd> {
        let Self {
            count, instances, ..
        } = self;
        for pixel in 0..Self::PIXELS.min(count) {
            let found = (
                layers(capture)[pixel as usize],
                capture.frame.triangle_id[pixel as usize],
            );
            let hits = instances * (count - pixel).div_ceil(Self::PIXELS);
            equal(
                &found,
                &(hits, (instances - 1) * count + pixel),
                &format!("{what}: hits and triangle id of pixel {pixel}"),
            )?;
        }
        Ok(())
    }
}

fn workgroups_direct(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let option = pinned(context.quick_option());
    // 64 triangles, or vertices, to a group: 65,535, 65,536 and 65,537 groups, the last one with a
    // single active invocation.
    for groups in [65_535u32, 65_536, 65_537] {
        let triangles = 64 * (groups - 1) + 1;
        // A single instance, so the triangle list itself has this length.
        let tiny = TinyTriangles {
            count: triangles,
            instances: 1,
            vertices: Vertices::Shared,
        };
        let (scene, view) = tiny.scene();
        let what = format!("{groups} groups of triangles");
        let capture = context.captured(&scene, &view, &stack(&[]), &option, &what)?;
        tiny.check(&capture, &what)?;
    }
    let tiny = TinyTriangles {
        count: 66_666,
        instances: 21,
        vertices: Vertices::Separate,
    };
    check!(
        3 * tiny.count * tiny.instances > 64 * 65_535,
        "too few vertices"
    );
    let (scene, view) = tiny.scene();
    let what = "65,626 groups of vertices";
    let capture = context.captured(&scene, &view, &stack(&[]), &option, what)?;
    tiny.check(&capture, what)
}

fn workgroups_indirect(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let option = pinned(context.quick_option());
    let [workgroup_each, card] =
        [WorkDistribution::WorkgroupEach, WorkDistribution::Card].map(WorkDistribution::tuning);
    let card = Tuning {
        queue_groups: 0,
        ..card
    };
    // Medium triangles: one workgroup each.
    let demands = [65_537u32, 65_535, 65_536];
    if context.is_slow() {
        context.note(format!(
            "medium triangles: {} alone, since this adapter is slow",
            demands[0]
        ));
    }
    for &demand in &demands[..if context.is_slow() { 1 } else { 3 }] {
        let corners = |i: u32| {
            let [x, y] = [i % 21, i / 21 % 21].map(|k| 768 * k as i32);
            [[x, y], [x + 600, y], [x, y + 600]]
        };
        let triangles: Vec<_> = (0..demand)
            .map(|i| (corners(i), 0.25 + 1e-6 * i as f32))
            .collect();
        let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
        context.renderer.set_tuning(workgroup_each);
        let what = format!("{demand} medium triangles");
        context.exact(&scene, &pixel_view(64, 64), &stack(&[]), &option, &what)?;
        check!(
            context.renderer.capacities().medium >= demand,
            "{what}: {:?}",
            context.renderer.capacities()
        );
    }
    // Large triangles and their tiles: one workgroup each, one tile per triangle. Capacities are
    // set beforehand to save time.
    let needle = |i: i32| {
        [
            [-20_000 - i % 7, i % 16_000],
            [40_000, i % 16_000 + 3],
            [40_000, i % 16_000 + 600],
        ]
    };
    let triangles: Vec<_> = (0..65_600)
        .map(|i| (needle(i), 0.25 + 1e-6 * i as f32))
        .collect();
    let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
    context.renderer.set_tuning(card);
    context.renderer.set_scene(&scene).block_on()?;
    context.renderer.set_capacities(Capacities {
        large: 65_600,
        tiles: 65_600,
        ..Capacities::default()
    });
    context.exact(
        &scene,
        &pixel_view(64, 64),
        &stack(&[]),
        &option,
        "65,600 large triangles",
    )?;
    let foreseen = Capacities {
        clip: 1,
        clipped_triangles: 1,
        medium: 1,
        large: 65_600,
        tiles: 65_600,
        glass: 1,
    };
    equal(
        &context.renderer.capacities(),
        &foreseen,
        "65,600 large triangles: room in the queues",
    )?;
    // Tiles of the resolve: 66,048 of 8 x 8 pixels.
    let [a, b, c, d] = [
        [0, 0],
        [2048 * 256, 0],
        [2048 * 256, 2064 * 256],
        [0, 2064 * 256],
    ];
    context.renderer.set_tuning(Tuning {
        listed_tiles: true,
        ..card
    });
    let scene = scene_of_meshes(&[triangle_soup_in_units(&[
        ([a, b, c], 0.5),
        ([a, c, d], 0.5),
    ])]);
    let view = pixel_view(2048, 2064);
    let what = "66,048 tiles of the picture";
    let (capture, _) = context.exact(
        &scene,
        &view,
        &stack(&["triangle_id"]),
        &pinned(Visibility::Split32),
        what,
    )?;
    equal(
        &capture.frame.covered(),
        &(2048 * 2064),
        &format!("{what}: pixels"),
    )
}

fn clipped_in_turns(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    // Needles through the pixels of a picture, each with one corner beyond the guard band.
    let needle = |i: i32| {
        let [x, y] = [i % 64, i / 64 % 64].map(|k| 256 * k + 128);
        [[x - 60, y - 60], [x + 60, y], [x, y + GUARD_BAND + 70_000]]
    };
    let triangles: Vec<_> = (0..3_500)
        .map(|i| (needle(i), 0.25 + 1e-4 * i as f32))
        .collect();
    let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
    let capture = context.exact_on_all(&scene, &pixel_view(64, 64), "3,500 triangles to clip")?;
    equal(
        &capture.frame.counters.clipped,
        &3_500,
        "triangles that were clipped",
    )
}

/// A known demand on one queue.
struct Demand {
    queue: &'static str,
    /// Exactly enough for the demand, and plenty in all other queues.
    capacities: Capacities,
    /// The scene that makes the demand.
    scene: Arc<Scene>,
    /// The capacity of the queue.
    capacity: fn(&mut Capacities) -> &mut u32,
}

impl Demand {
    fn new(
        queue: &'static str,
        entries: u32,
        scene: &Arc<Scene>,
        capacity: fn(&mut Capacities) -> &mut u32,
    ) -> Self {
        let mut capacities = Capacities {
            clip: 4096,
            clipped_triangles: 4096,
            medium: 4096,
            large: 4096,
            tiles: 4096,
            glass: 4096,
        };
        *capacity(&mut capacities) = entries;
        Self {
            queue,
            capacities,
            scene: scene.clone(),
            capacity,
        }
    }
}

/// A demand on each queue.
fn demands() -> Vec<Demand> {
    let n = 40;
    let many = |triangle: [[i32; 2]; 3]| {
        let moved = |i: i32| {
            (
                triangle.map(|[x, y]| [x, y + 97 * i]),
                0.2 + 0.01 * i as f32,
            )
        };
        scene_of_meshes(&[triangle_soup_in_units(
            &(0..n).map(moved).collect::<Vec<_>>(),
        )])
    };
    let n = n as u32;
    // One corner beyond the guard band leaves a quad of two clipped triangles, both visible.
    let cut = many([[9_000_000, 300], [200, 9000], [300, 200]]);
    let small = many([[300, 300], [9000, 400], [400, 9000]]);
    let large = many([[-3000, -3000], [90_000, 4000], [4000, 90_000]]);
    vec![
        Demand::new("clip", n, &cut, |c| &mut c.clip),
        Demand::new("clipped triangles", 2 * n, &cut, |c| {
            &mut c.clipped_triangles
        }),
        Demand::new("medium", n, &small, |c| &mut c.medium),
        Demand::new("large", n, &large, |c| &mut c.large),
        // A picture of 128 x 128 has four tiles.
        Demand::new("tiles", 4 * n, &large, |c| &mut c.tiles),
    ]
}

fn queues(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(128, 128);
    context
        .renderer
        .set_tuning(WorkDistribution::WorkgroupEach.tuning());
    for option in context.options() {
        for Demand {
            queue,
            capacities,
            scene,
            capacity: field,
        } in demands()
        {
            let demand = *field(&mut capacities.clone());
            for capacity in [demand, demand - 1, demand / 10, 1] {
                let what = format!(
                    "{queue} on {}: demand {demand}, capacity {capacity}",
                    option.name()
                );
                let mut capacities = capacities;
                *field(&mut capacities) = capacity;
                context.renderer.set_scene(&scene).block_on()?;
                context.renderer.set_capacities(capacities);
                context
                    .renderer
                    .draw(&view, &stack(&[]), &pinned(option))
                    .block_on()?;
                let report = context.renderer.finish().block_on()?;
                equal(
                    &report.counters.overflow,
                    &(demand - capacity),
                    &format!("{what}: entries lost"),
                )?;
                equal(
                    &report.redraw,
                    &(capacity < demand),
                    &format!("{what}: drawn again"),
                )?;
                context.exact(&scene, &view, &stack(&[]), &pinned(option), &what)?;
                check!(
                    *field(&mut context.renderer.capacities()) >= demand,
                    "{what}: the queue has not grown"
                );
            }
        }
    }
    Ok(())
}

fn ten_million_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let count = 10_000_000;
    let caps = &context.renderer.gpu().caps;
    let room = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
    if room < 12 * u64::from(count) {
        return Err(EarlyEnd::Skipped(format!(
            "the index list needs {} bytes, and this adapter binds at most {room}",
            12 * count
        )));
    }
    for option in context.options() {
        let tiny = TinyTriangles {
            count,
            instances: 1,
            vertices: Vertices::Shared,
        };
        let (scene, view) = tiny.scene();
        let what = format!("{count} triangles on {}", option.name());
        let capture = context.captured(&scene, &view, &stack(&[]), &pinned(option), &what)?;
        tiny.check(&capture, &what)?;
    }
    Ok(())
}

fn million_instances(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    const SIDE: u32 = 1000;
    let mesh = SimpleMesh {
        transforms: (0..SIDE * SIDE)
            .map(|i| DMat4::from_translation(DVec3::new((i % SIDE).into(), (i / SIDE).into(), 0.0)))
            .collect(),
        ..triangle_soup([[0.25, 0.25, 0.5], [0.75, 0.5, 0.5], [0.25, 0.75, 0.5]])
    };
    let scene = scene_of_meshes(&[mesh]);
    let option = context.quick_option();
    for culling in [Culling::None, Culling::Frustum] {
        let what = format!("a million instances, culling {}", culling.name());
        let pins = PinnedOptions::of(option).with(culling);
        let request = AccuracyRequest {
            pins,
            ..AccuracyRequest::default()
        };
        let capture = context.captured(
            &scene,
            &pixel_view(SIDE, SIDE),
            &stack(&[]),
            &request,
            &what,
        )?;
        let found = (0..).zip(&capture.frame.triangle_id);
        let other = found.clone().find(|(pixel, id)| pixel != *id);
        check!(other.is_none(), "{what}: pixel and triangle id {other:?}");
    }
    Ok(())
}

fn thousand_full_screen_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(3);
    let mut far = || rng.between(60_000, 8_000_000);
    let triangles: Vec<_> = (0..1000)
        .map(|i| {
            (
                [
                    [-far(), -far()],
                    [2 * far() / 2 + 40_000, -far()],
                    [64 * 256, 8_388_607],
                ],
                1e-3 * (i % 997) as f32,
            )
        })
        .collect();
    let scene = scene_of_meshes(&[triangle_soup_in_units(&triangles)]);
    context.renderer.set_tuning(WorkDistribution::Card.tuning());
    for option in context.options() {
        let what = format!("a thousand full-screen triangles on {}", option.name());
        let (capture, _) = context.exact(
            &scene,
            &pixel_view(128, 64),
            &stack(&[]),
            &pinned(option),
            &what,
        )?;
        check!(
            layers(&capture).iter().all(|&hits| hits > 900),
            "{what}: a pixel with fewer than 900 layers"
        );
        let cut = capture
            .geometry
            .vertices
            .iter()
            .any(|vertex| vertex.flags & vertex_flags::CLIPPED != 0);
        check!(!cut, "{what}: a triangle was clipped");
    }
    Ok(())
}
