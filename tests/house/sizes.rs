//! Promise: sizes of triangles are sampled where the effects of a stack have moved them.

use glam::DVec3;
use rasterlab::{
    effects::Stack,
    oracle::moved_sizes,
    scene::{builtin, camera::Camera, draw::draws, sizes::TriangleSizes, view::View},
    stress,
};

const SIZE: [u32; 2] = [160, 120];

/// One effect with one value.
fn stack_of(name: &str, field: &str, value: f64) -> Stack {
    let mut stack = stress::stack(&[name]);
    let enabled = &mut stack.0[0];
    let field = enabled.effect.field(field).expect("a parameter");
    field.set(&mut enabled.words, &[value]).expect("an allowed value");
    stack
}

fn view_of(scene: &rasterlab::scene::Scene) -> View {
    let camera = Camera::framing(&scene.bounds(), DVec3::new(-0.4, -0.4, -1.0), 4.0 / 3.0);
    View::new(&camera, SIZE[0], SIZE[1], &scene.bounds(), glam::DMat4::IDENTITY, [0.0; 4])
}

#[test]
fn where_nothing_moves_they_are_those_of_the_scene() {
    for query in ["teapot?tess=4", "near", "tentacle?tess=3", "sphere?triangles=20000"] {
        let scene = builtin::build(query).expect("a built-in scene");
        let view = view_of(&scene);
        let still = TriangleSizes::of(&scene, &draws(&scene, &view).expect("it fits"), &view);
        let moved = moved_sizes(&scene, &view, &stress::stack(&["lambert"])).expect("it fits");
        let [still, moved] = [still, moved].map(|sizes| {
            let work = sizes.work(32, 32, 128.0);
            [work.small.triangles, work.medium.triangles, work.large.triangles, work.cut.triangles, work.small.longest, work.medium.longest]
        });
        // A deformed corner may fall on the other side of a sample.
        let differs = still.iter().zip(moved).any(|(still, moved)| (still - moved).abs() > 0.02 * still.max(50.0));
        assert!(!differs, "{query}: {still:?} {moved:?}");
        assert!(still.iter().sum::<f64>() > 0.0, "{query} shows something");
    }
}

#[test]
fn triangles_that_fly_out_of_the_picture_are_not_seen_and_inflated_ones_are_larger() {
    let scene = builtin::build("sphere?triangles=2000").expect("a built-in scene");
    let view = view_of(&scene);
    let sizes = |stack: &Stack| moved_sizes(&scene, &view, stack).expect("it fits");
    let gone = sizes(&stack_of("explode", "amount_m", 900.0));
    assert!(gone.visible() < sizes(&Stack::default()).visible() / 20, "{} are still seen", gone.visible());
    let covered = |stack: &Stack| {
        let work = sizes(stack).work(1 << 20, 1 << 20, 1e9);
        work.small.covered / work.small.triangles
    };
    let (small, large) = (covered(&Stack::default()), covered(&stack_of("inflate", "amount_m", 0.3)));
    assert!(large > 1.2 * small, "{small} and {large} pixels");
}
