//! Promise: a ground under a scene is an ordinary mesh to every option, effect and judge, catches
//! the scene's shadow, and leaves the camera, the lengths and the triangle ids of the scene as they
//! are. Needs an adapter.

use std::sync::Arc;

use rasterlab::{
    accuracy::{PinnedOptions, PositionFormat},
    frame::NO_TRIANGLE,
    oracle,
    preset::{LengthUnit, Preset, SceneSource},
    preset_file,
    scene::{Ground, GroundShape, Scene},
};

use crate::common::*;

const SIZE: [u32; 2] = [120, 90];

fn preset(query: &str, effects: &[&str], ground: Option<Ground>) -> Preset {
    let mut preset = Preset {
        scene: SceneSource::Builtin(query.into()),
        stack: stack(effects),
        ground,
        ..Preset::default()
    };
    preset.output.size = SIZE;
    preset
}

fn loaded(preset: &Preset) -> Arc<Scene> {
    preset_file::load_scene(preset, None).expect("a built-in scene")
}

fn grounds() -> [Ground; 2] {
    [
        Ground {
            size: 2.5,
            cells: 5,
            ..Ground::default()
        },
        Ground {
            shape: GroundShape::Square,
            size: 40.0,
            cells: 3,
            color: [0.2, 0.4, 0.1, 1.0],
        },
    ]
}

fn a_model_on_a_ground_with_its_shadow_is_exact_with_every_option(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let stands = ["teapot?tess=4", "walker?tess=1", "tentacle?tess=3"]
        .into_iter()
        .flat_map(|query| grounds().map(|g| (query, g)));
    for (query, ground) in reach.of(2, stands) {
        let mut preset = preset(query, &["shadow", "facet"], Some(ground));
        (preset.spin_deg_per_s, preset.clock.time_s) = (30.0, 1.0);
        let scene = loaded(&preset);
        let (view, stack) = (preset.view(&scene, SIZE), preset.stack_on(&scene, SIZE));
        let first = scene.triangle_count()
            - u64::from(scene.primitives[scene.ground_instances()[0].primitive].triangle_count());
        for option in reach.options(&renderer) {
            let what = format!("{query} on {:?} with {}", ground.shape, option.name());
            let (capture, _) = renderer.exact(&scene, &view, &stack, &pinned(option), &what);
            let shown = capture
                .frame
                .triangle_id
                .iter()
                .filter(|&&id| id != NO_TRIANGLE && u64::from(id) >= first)
                .count();
            assert!(shown > 300, "{what}: {shown} pixels of ground");
        }
        // Meshes that joints deform are not packed.
        let packed = query
            .starts_with("teapot")
            .then_some(PositionFormat::Packed16);
        for format in [PositionFormat::Relative].into_iter().chain(packed) {
            let accuracy = request(PinnedOptions::of(format));
            let (_, verdict) = renderer.judged(&scene, &view, &stack, &accuracy);
            assert_eq!(
                verdict.report.unexplained, 0,
                "{query} with {format:?}: {:?}",
                verdict.report
            );
        }
    }
}

#[test]
fn the_scene_itself_keeps_its_camera_its_unit_and_its_triangle_ids() {
    for query in ["teapot?tess=4", "walker?tess=1"] {
        for ground in grounds() {
            let mut alone = preset(query, &["lambert", "inflate"], None);
            alone.unit = LengthUnit::Scene;
            let mut standing = Preset {
                ground: Some(ground),
                ..alone.clone()
            };
            let (bare, scene) = (loaded(&alone), loaded(&standing));
            assert_eq!(
                standing.camera_for(&scene, 4.0 / 3.0),
                alone.camera_for(&bare, 4.0 / 3.0),
                "{query}"
            );
            assert_eq!(
                standing.stack_on(&scene, SIZE),
                alone.stack_on(&bare, SIZE),
                "{query}: lengths in radii"
            );
            let render = |preset: &Preset, scene: &Scene| {
                oracle::render_sequence(scene, &preset.moments(scene, SIZE)).expect("it is drawn")
            };
            // Nothing of the model is moved below the ground.
            [&mut alone, &mut standing]
                .into_iter()
                .for_each(|preset| preset.disable("inflate"));
            let (without, with) = (render(&alone, &bare), render(&standing, &scene));
            let first = bare.triangle_count();
            for i in 0..without.triangle_id.len() {
                // Seen from above, the ground hides nothing of what stands on it.
                if without.triangle_id[i] != NO_TRIANGLE {
                    assert_eq!(
                        with.triangle_id[i], without.triangle_id[i],
                        "{query}, pixel {i}"
                    );
                } else {
                    assert!(
                        with.triangle_id[i] == NO_TRIANGLE
                            || u64::from(with.triangle_id[i]) >= first,
                        "{query}, pixel {i}"
                    );
                }
            }
            // Nothing of the ground lies outside the depths that an orthographic camera keeps.
            let view = standing.view(&scene, SIZE);
            for corner in scene.bounds_of(scene.ground_instances()).corners() {
                let depth_m = (corner - view.eye).dot(view.forward);
                assert!(depth_m <= view.depth_range_m[1], "{query}: {depth_m} m");
            }
        }
    }
}

#[test]
fn the_shadow_of_the_scene_falls_on_the_ground_and_is_as_fine_as_without_it() {
    for query in ["teapot?tess=4", "walker?tess=1"] {
        let ground = Ground {
            size: 4.0,
            color: [1.0; 4],
            ..Ground::default()
        };
        let with_shadow = preset(query, &["shadow"], Some(ground));
        let scene = loaded(&with_shadow);
        let bare = loaded(&Preset {
            ground: None,
            ..with_shadow.clone()
        });
        let (view, stack) = (
            with_shadow.view(&scene, SIZE),
            with_shadow.stack_on(&scene, SIZE),
        );
        let [on_ground, alone] = [&scene, &bare].map(|scene| {
            let light = stack
                .light_view(scene, &with_shadow.view(scene, SIZE))
                .expect("there is a light");
            (light.clip_from_world, light.ndc_axes)
        });
        assert_eq!(on_ground, alone, "{query}: the light sees the scene alone");
        let frame = oracle::render(&scene, &view, &stack).expect("it is drawn");
        let first = bare.triangle_count() as u32;
        let light: Vec<u8> = (0..frame.color.len())
            .filter(|&i| (first..NO_TRIANGLE).contains(&frame.triangle_id[i]))
            .map(|i| frame.color[i][1])
            .collect();
        let brightest = light.iter().copied().max().expect("ground is seen");
        let dark = light
            .iter()
            .filter(|&&value| value < brightest - brightest / 4)
            .count();
        assert!(
            dark > light.len() / 100 && dark < light.len() / 2,
            "{query}: {dark} of {} pixels lie in shadow",
            light.len()
        );
    }
}

#[test]
fn particles_come_before_the_ground_and_fall_on_it_in_shadow() {
    let Some(mut renderer) = loan() else { return };
    let mut preset = preset(
        "teapot?tess=3",
        &["shadow", "particles"],
        Some(grounds()[0]),
    );
    let particles = preset.stack.get_mut("particles").expect("it is enabled");
    particles
        .effect
        .field("count")
        .expect("a field")
        .set(&mut particles.words, &[200.0])
        .expect("it is allowed");
    preset.clock.time_s = 0.5;
    let scene = loaded(&preset);
    let with_particles =
        scene.with_particles(preset.evaluated_stack().particle_settings().as_ref());
    assert_eq!(
        with_particles.shadow_casters().len(),
        scene.shadow_casters().len() + 1
    );
    assert_eq!(with_particles.ground_instances(), scene.ground_instances());
    let accuracy = pinned(quick_option(&renderer));
    let (_, verdict) = renderer.judged_preset(&scene, &preset, &accuracy);
    exactness(&verdict.report).unwrap_or_else(|why| panic!("{why}"));
}

few_and_all!(a_model_on_a_ground_with_its_shadow_is_exact_with_every_option,);
