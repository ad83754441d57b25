//! Promise: finer maps are nearer to the rays, a preset pins them, a preset without a light has no
//! pass, buffer or text of it, and walls catch shadows and cast none.

use super::*;

#[test]
fn finer_maps_are_nearer_to_the_rays() {
    let scene = boxed("knot?tess=8");
    let stack = lit(&["shadow"], &[]);
    let errors = |map: ShadowMapSize, taps: ShadowTaps| {
        let view = on(&view(&scene, [240, 180]), map, taps);
        let triangle_ids = oracle::render(&scene, &view, &stack)
            .expect("a scene that fits")
            .triangle_id;
        let draws = rasterlab::scene::draw::draws(&scene, &view).expect("a scene that fits");
        let light = oracle::shadow_map(&scene, &view, &stack).expect("a scene that fits");
        let geometry = rasterlab::frame::Geometry {
            shadow_map: light,
            ..oracle::project(&oracle::Shot::new(&scene, &draws, &view, &Stack::default()))
                .expect("nobody cancels it")
        };
        oracle::shadow_errors(&scene, &view, &stack, &triangle_ids, &geometry)
            .expect("a scene that fits")
            .expect("there is a light")
    };
    let [coarse, usual, fine] = [
        ShadowMapSize::Side256,
        ShadowMapSize::Side1024,
        ShadowMapSize::Side4096,
    ]
    .map(|map| errors(map, ShadowTaps::One));
    assert!(coarse.pixels > 10_000 && coarse.pixels == fine.pixels);
    assert!(
        coarse.wrong > usual.wrong && usual.wrong > fine.wrong,
        "{coarse:?} {usual:?} {fine:?}"
    );
    assert!(
        coarse.rms > 1.2 * usual.rms && usual.rms > 1.2 * fine.rms,
        "{coarse:?} {usual:?} {fine:?}"
    );
    assert!(
        fine.wrong * 1000 < fine.pixels,
        "{fine:?}: one in a thousand even with the finest map"
    );
    // A wider filter is softer than a light without extent, so it errs more in all, and seldom by
    // half.
    let soft = errors(ShadowMapSize::Side1024, ShadowTaps::TwentyFive);
    assert!(soft.wrong < 2 * usual.wrong, "{usual:?} {soft:?}");
}

#[test]
fn rays_know_a_plate_from_the_sky() {
    let scene = scene_of_meshes(&[plate(2.0, 0.0), plate(0.6, 1.0)]);
    let stack = light_alone(&[("shadow", "elevation_deg", 90.0)]);
    let view = slanted(&scene, [120, 90]);
    let frame = oracle::render_reference(&scene, &view, &stack).expect("a scene that fits");
    let mut counts = [0, 0];
    for (i, color) in frame
        .color
        .iter()
        .enumerate()
        .filter(|(i, _)| frame.triangle_id[*i] < 2)
    {
        let at = on_floor(&view, i % 120, i / 120);
        let inside = 0.6 - at.x.abs().max(at.z.abs());
        if inside.abs() > 1e-3 {
            assert_eq!(color[0] == 0, inside > 0.0, "pixel {i}");
            counts[usize::from(inside > 0.0)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
}

// -------- what is not there

#[test]
fn a_preset_without_a_light_has_no_pass_buffer_or_text_of_it() {
    let key = |effects: Vec<Arc<Effect>>| {
        KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects)
    };
    let shadow = Effect::find("shadow").expect("an effect");
    for (effects, is_there) in [
        (vec![], false),
        (
            vec![Effect::find("lambert").expect("an effect").clone()],
            false,
        ),
        (vec![shadow.clone()], true),
    ] {
        let key = key(effects);
        for pass in key.frame() {
            let linked = link::link(&Library::Embedded, &pass.path(), &key, &key.variants(pass))
                .expect("links");
            let has_text = linked.text.contains("shadow_map");
            assert!(!has_text || is_there, "{} of {key}", pass.label());
            assert_eq!(
                has_text,
                is_there && pass.stem() == "resolve",
                "{} of {key}",
                pass.label()
            );
        }
    }
    let Some(gpu) = own_gpu() else { return };
    let mut renderer = Renderer::new(gpu);
    // Small triangles, whose kernels are the same in every map.
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [64, 48]);
    renderer.captured(&scene, &view, &stack(&["shadow"]), &unpinned());
    let known = renderer.compiled();
    renderer.captured(
        &scene,
        &on(&view, ShadowMapSize::Side512, ShadowTaps::Nine),
        &stack(&["shadow"]),
        &unpinned(),
    );
    assert_eq!(
        renderer.compiled(),
        known,
        "another size of map compiles nothing"
    );
}

#[test]
fn a_preset_pins_size_and_taps() {
    let pins = PinnedOptions::of(ShadowMapSize::Side2048).with(ShadowTaps::One);
    let preset = Preset {
        accuracy: AccuracyRequest {
            pins,
            ..AccuracyRequest::default()
        },
        ..Preset::default()
    };
    let view = preset.view(&scene("teapot?tess=2"), [8, 8]);
    assert_eq!(
        view.precision.shadow,
        ShadowResolution {
            side: 2048,
            taps: 1
        }
    );
    assert_eq!(
        view.precision.shadow.options(),
        (ShadowMapSize::Side2048, ShadowTaps::One)
    );
}

#[test]
fn walls_catch_shadows_and_cast_none_and_stand_still() {
    let Some(mut renderer) = loan() else { return };
    let scene = boxed("teapot?tess=4");
    let walls = u64::from(
        scene.primitives[scene.instances.last().expect("a room").primitive].vertex_count(),
    );
    let from_below = lit(&["shadow"], &[("shadow", "elevation_deg", -50.0)]);
    let coarse = on(
        &view(&scene, [96, 72]),
        ShadowMapSize::Side256,
        ShadowTaps::Nine,
    );
    let mut turned = coarse;
    turned.scene_state.world_from_scene = rasterlab::math::rotation_y(0.7);
    let (capture, _) = renderer.exact(&scene, &turned, &from_below, &unpinned(), "from below");
    let map = capture.geometry.shadow_map.expect("there is a map");
    assert_eq!(
        map.geometry.vertices.len() as u64 + walls,
        scene.vertex_count()
    );
    assert!(map.depth_keys.contains(&0) && map.depth_keys.iter().any(|&key| key != 0));
    let draws = rasterlab::scene::draw::draws(&scene, &turned).expect("a scene that fits");
    assert_eq!(
        draws.last().expect("a room").world_from_object,
        DMat4::IDENTITY
    );
}
