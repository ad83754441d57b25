//! Shading: facing, normals, weights and depths are those of the ray through each pixel.

use super::*;

/// Bytes of the normals effect for a direction.
fn normal_bytes(n: DVec3) -> [u8; 4] {
    let byte = |v: f64| rasterlab::math::srgb_byte(0.5 + 0.5 * v);
    [byte(n.x), byte(n.y), byte(n.z), 255]
}

#[test]
fn mirrored_placement_keeps_fronts_in_front() {
    let mesh = SimpleMesh {
        double_sided: false,
        ..sphere(8)
    };
    let view_of = |scene: &Scene| {
        View::new(
            &Camera::default(),
            48,
            48,
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        )
    };
    let plain = scene(std::slice::from_ref(&mesh));
    let mirrored = scene(&[mesh.at(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)))]);
    let stack = only("normals", &[]);
    let [a, b] = [plain, mirrored].map(|scene| render(&scene, &view_of(&scene), &stack).unwrap());
    assert!(a.covered() > 300);
    let keys = |frame: &Frame| {
        frame
            .depth_key
            .chunks(48)
            .map(|row| row.to_vec())
            .collect::<Vec<_>>()
    };
    // Both show the front half, one of them mirrored; the picture is symmetric, its triangles are
    // not.
    let flipped: Vec<Vec<u32>> = keys(&b)
        .into_iter()
        .map(|row| row.into_iter().rev().collect())
        .collect();
    let differing = keys(&a)
        .concat()
        .iter()
        .zip(flipped.concat())
        .filter(|(a, b)| (**a == 0) != (*b == 0))
        .count();
    assert!(differing <= 4, "{differing} pixels of the outline differ");
    let nearest = |frame: &Frame| *frame.depth_key.iter().max().unwrap();
    assert!(
        rasterlab::math::ulp_distance(f32::from_bits(nearest(&a)), f32::from_bits(nearest(&b)))
            < 1 << 12
    );
    // Normals point outward, to the eye, in both.
    for frame in [&a, &b] {
        assert!(
            frame.color[24 * 48 + 24][2] > 230,
            "{:?}",
            frame.color[24 * 48 + 24]
        );
    }
}

#[test]
fn backs_show_only_when_double_sided_and_with_turned_normals() {
    let back = [[0.0, 0.0, 0.5], [16.0, 0.0, 0.5], [0.0, 16.0, 0.5]];
    let front = [back[0], back[2], back[1]];
    let view = pixel_view(16, 16);
    let toward = normal_bytes(DVec3::Z);
    for (corners, double_sided, expected) in [
        (front, false, Some(toward)),
        (front, true, Some(toward)),
        (back, false, None),
    ] {
        let mesh = SimpleMesh {
            double_sided,
            ..triangle_soup(corners)
        };
        let frame = render(&scene(&[mesh]), &view, &only("normals", &[])).unwrap();
        assert_eq!(
            (frame.triangle_id[0] != NO_TRIANGLE).then_some(frame.color[0]),
            expected
        );
    }
    let frame = render(&scene(&[triangle_soup(back)]), &view, &only("normals", &[])).unwrap();
    assert_eq!(
        frame.color[0],
        normal_bytes(DVec3::NEG_Z),
        "the stored normal (0, 0, 1), turned over"
    );
}

#[test]
fn normals_follow_skewed_and_mirrored_placements() {
    // A plane x + z = const with its true normal stays perpendicular to itself under a stretch.
    let n = [0.6f32, 0.0, 0.8];
    let positions = [[-4.0, -9.0, 3.0], [4.0, -9.0, -3.0], [-4.0, 9.0, 3.0]];
    for placement in [
        DVec3::new(3.0, 1.0, 0.5),
        DVec3::new(-1.0, 1.0, 1.0),
        DVec3::new(0.25, -2.0, 1.0),
    ] {
        let mesh = SimpleMesh {
            normals: vec![n; 3],
            ..triangle_soup(positions)
        };
        let world_from_object = DMat4::from_scale(placement);
        let scene = scene(&[mesh.at(world_from_object)]);
        let camera = Camera {
            eye: DVec3::Z * 30.0,
            ..Default::default()
        };
        let view = View::new(&camera, 64, 64, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let reference = (DVec3::from_array(n.map(f64::from)) / placement).normalize();
        let [smooth, flat] = [only("normals", &[]), {
            let mut stack = only("normals", &[]);
            stack.enable(Effect::find("facet").unwrap());
            stack
        }]
        .map(|stack| render(&scene, &view, &stack).unwrap());
        let owned = smooth
            .triangle_id
            .iter()
            .position(|&triangle_id| triangle_id == 0)
            .expect("the sheet shows");
        // Both face the eye, which is on the side of +z.
        let reference = reference * reference.z.signum();
        for frame in [smooth, flat] {
            let delta = (0..4)
                .map(|c| frame.color[owned][c].abs_diff(normal_bytes(reference)[c]))
                .max();
            assert!(
                delta <= Some(1),
                "{placement}: {:?} for {:?}",
                frame.color[owned],
                normal_bytes(reference)
            );
        }
    }
}

#[test]
fn broken_normals_and_colors_take_finite_defaults() {
    let positions = [[0.0, 0.0, 0.5], [0.0, 16.0, 0.5], [16.0, 0.0, 0.5]];
    let view = pixel_view(16, 16);
    // Pixel coordinates run downwards, so this sheet's front looks along -z; its stored normal
    // would say +z.
    let flat = normal_bytes(DVec3::NEG_Z);
    for bad in [
        [f32::NAN, 0.0, 1.0],
        [f32::INFINITY, 1.0, 0.0],
        [f32::MAX, 0.0, 0.0],
        [0.0; 3],
        [f32::from_bits(1); 3],
    ] {
        let mesh = SimpleMesh {
            normals: vec![bad; 3],
            ..triangle_soup(positions)
        };
        let frame = render(&scene(&[mesh]), &view, &only("normals", &[])).unwrap();
        assert_eq!(frame.color[0], flat, "{bad:?}");
    }
    let mesh = SimpleMesh {
        colors: vec![[f32::NAN, 0.0, f32::NEG_INFINITY, 1.0]; 3],
        ..triangle_soup(positions)
    };
    let frame = render(&scene(&[mesh]), &view, &Stack::default()).unwrap();
    // A vertex with one bad component is white, as without colors.
    assert_eq!(frame.color[0], [255; 4]);
}

/// Colors of a ground that carries its own coordinates, from the ray through each pixel.
#[test]
fn cut_ground_is_shaded_as_its_rays_say() {
    let mut mesh = ground(8.0, -1.0);
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| [0.5 + p[0] / 16.0, 0.5 + p[2] / 16.0, 0.25, 1.0])
        .collect();
    let scene = scene(&[mesh]);
    let camera = Camera {
        eye: DVec3::new(0.3, 0.5, 5.0),
        target: DVec3::new(0.0, -0.6, 0.0),
        ..Default::default()
    };
    let view = View::new(&camera, 80, 60, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
    let world_from_clip = view.clip_from_world.inverse();
    let [plain, depth] = [
        Stack::default(),
        only(
            "depth",
            &[
                (8, f32::from_bits(0)),
                (9, 0.1),
                (0, 0.0),
                (1, 0.0),
                (2, 0.0),
                (4, 1.0),
                (5, 1.0),
                (6, 1.0),
            ],
        ),
    ]
    .map(|stack| render(&scene, &view, &stack).unwrap());
    assert_eq!(plain.counters.clipped, 2);
    assert!(plain.covered() > 2000);
    let byte = rasterlab::math::srgb_byte;
    for pixel in
        (0..plain.triangle_id.len()).filter(|&pixel| plain.triangle_id[pixel] != NO_TRIANGLE)
    {
        let x = ((pixel % 80) as f64 + 0.5) / 40.0 - 1.0;
        let y = 1.0 - ((pixel / 80) as f64 + 0.5) / 30.0;
        let through = world_from_clip * DVec4::new(x, y, 1.0, 1.0);
        let ray = through.truncate() / through.w - view.eye;
        let hit = view.eye + ray * ((-1.0 - view.eye.y) / ray.y);
        let expected = [
            byte(0.5 + hit.x / 16.0),
            byte(0.5 + hit.z / 16.0),
            byte(0.25),
            255,
        ];
        let meters = byte(0.1 * (hit - view.eye).dot(view.forward));
        let delta = (0..4)
            .map(|c| plain.color[pixel][c].abs_diff(expected[c]))
            .max()
            .unwrap();
        assert!(
            delta <= 1,
            "pixel {pixel}: {:?} for {expected:?}",
            plain.color[pixel]
        );
        assert!(
            depth.color[pixel][0].abs_diff(meters) <= 1,
            "pixel {pixel}: {:?} for {meters}",
            depth.color[pixel]
        );
    }
}

/// Whole triangles: weights are perspective-correct from the snapped corners.
#[test]
fn whole_ground_is_shaded_as_its_rays_say() {
    let mut mesh = ground(2.0, -1.0);
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| [0.5 + p[0] / 4.0, 0.5 + p[2] / 4.0, 0.25, 1.0])
        .collect();
    let scene = scene(&[mesh]);
    let camera = Camera {
        eye: DVec3::new(0.2, -0.4, 2.6),
        target: DVec3::NEG_Y,
        ..Default::default()
    };
    let view = View::new(
        &camera,
        256,
        192,
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.0; 4],
    );
    let frame = render(&scene, &view, &Stack::default()).unwrap();
    assert_eq!((frame.counters.clipped, frame.covered() > 4000), (0, true));
    let world_from_clip = view.clip_from_world.inverse();
    for pixel in
        (0..frame.triangle_id.len()).filter(|&pixel| frame.triangle_id[pixel] != NO_TRIANGLE)
    {
        let (x, y) = (
            ((pixel % 256) as f64 + 0.5) / 128.0 - 1.0,
            1.0 - ((pixel / 256) as f64 + 0.5) / 96.0,
        );
        let through = world_from_clip * DVec4::new(x, y, 1.0, 1.0);
        let ray = through.truncate() / through.w - view.eye;
        let hit = view.eye + ray * ((-1.0 - view.eye.y) / ray.y);
        let byte = rasterlab::math::srgb_byte;
        let expected = [
            byte(0.5 + hit.x / 4.0),
            byte(0.5 + hit.z / 4.0),
            byte(0.25),
            255,
        ];
        // Corners snap by half a unit, which changes dark bytes most.
        let delta = (0..4)
            .map(|c| frame.color[pixel][c].abs_diff(expected[c]))
            .max()
            .unwrap();
        assert!(
            delta <= 3,
            "pixel {pixel}: {:?} for {expected:?}",
            frame.color[pixel]
        );
    }
}

/// Sets a parameter by its name.
fn set(stack: &mut Stack, effect: &str, field: &str, bits: u32) {
    let enabled = stack.enable(Effect::find(effect).expect("a listed effect"));
    enabled.words[enabled.effect.field(field).expect("a field").offset / 4] = bits;
}

/// Shades by depth alone, black at the eye and white at `far_m`.
fn by_depth(far_m: f32) -> Stack {
    let mut stack = only(
        "depth",
        &[(0, 0.0), (1, 0.0), (2, 0.0), (4, 1.0), (5, 1.0), (6, 1.0)],
    );
    set(&mut stack, "depth", "fit", 0);
    set(&mut stack, "depth", "scale", (1.0 / far_m).to_bits());
    stack
}

#[test]
fn flat_shading_is_one_value_per_triangle() {
    let scene = scene(&[sphere(10).at(DMat4::from_scale(DVec3::new(1.0, 1.3, 0.8)))]);
    let camera = Camera {
        eye: DVec3::new(0.4, 0.8, 3.0),
        near_m: 0.1,
        ..Default::default()
    };
    let view = View::new(&camera, 96, 96, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
    let object = |triangle_id: u32| {
        let primitive = &scene.primitives[0];
        let world_from_object = scene.instances[0].world_from_object;
        primitive.corners(&scene, triangle_id).map(|v| {
            world_from_object.transform_point3(DVec3::from_array(
                primitive.position(&scene, v).map(f64::from),
            ))
        })
    };
    for (mut stack, reference) in [
        (
            only("normals", &[]),
            &(|[a, b, c]: [DVec3; 3]| normal_bytes((b - a).cross(c - a).normalize()))
                as &dyn Fn([DVec3; 3]) -> [u8; 4],
        ),
        (by_depth(5.0), &|corners| {
            let mean = corners
                .map(|p| (p - view.eye).dot(view.forward))
                .iter()
                .sum::<f64>()
                / 3.0;
            let byte = rasterlab::math::srgb_byte(mean / 5.0);
            [byte, byte, byte, 255]
        }),
    ] {
        stack.enable(Effect::find("facet").unwrap());
        let frame = render(&scene, &view, &stack).unwrap();
        assert!(frame.covered() > 2000);
        for (triangle_id, color) in frame
            .triangle_id
            .iter()
            .zip(&frame.color)
            .filter(|(triangle_id, _)| **triangle_id != NO_TRIANGLE)
        {
            let expected = reference(object(*triangle_id));
            assert!(
                (0..4).all(|c| color[c].abs_diff(expected[c]) <= 1),
                "{triangle_id}: {color:?} for {expected:?}"
            );
        }
    }
}

#[test]
fn cut_ground_faces_the_viewer_and_knows_its_center() {
    let scene = scene(&[ground(8.0, -1.0)]);
    for (eye_y, up) in [(0.5, DVec3::Y), (-2.5, DVec3::NEG_Y)] {
        let camera = Camera {
            eye: DVec3::new(0.3, eye_y, 5.0),
            target: DVec3::new(0.0, -1.0, 0.0),
            ..Default::default()
        };
        let view = View::new(&camera, 40, 30, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let frame = render(&scene, &view, &only("normals", &[])).unwrap();
        let mut owned = frame
            .triangle_id
            .iter()
            .zip(&frame.color)
            .filter(|(triangle_id, _)| **triangle_id != NO_TRIANGLE);
        assert!(frame.counters.clipped == 2 && owned.all(|(_, color)| *color == normal_bytes(up)));
        // Both triangles have their center on the ground's side of the picture; a sweep from there
        // makes them flat.
        for (along_y, flat) in [(up.y as f32, false), (-up.y as f32, true)] {
            let mut stack = by_depth(20.0);
            for (field, value) in [
                ("along_x", 0.0),
                ("along_y", along_y),
                ("front", 0.5),
                ("width", 0.001),
            ] {
                set(&mut stack, "facet", field, f32::to_bits(value));
            }
            set(&mut stack, "facet", "pattern", 1);
            let frame = render(&scene, &view, &stack).unwrap();
            let seen = if up.y > 0.0 { 29 * 40 + 20 } else { 20 };
            assert_ne!(frame.triangle_id[seen], NO_TRIANGLE);
            let mut colors: Vec<_> = (0..1200)
                .filter(|&i| frame.triangle_id[i] == frame.triangle_id[seen])
                .map(|i| frame.color[i])
                .collect();
            colors.dedup();
            assert_eq!(
                colors.len() == 1,
                flat,
                "eye {eye_y}, along {along_y}: {} colors",
                colors.len()
            );
        }
    }
}

#[test]
fn orthographic_depth_is_in_meters_too() {
    let scene = scene(&[sphere(16)]);
    let projection = Projection::Orthographic { height_m: 3.0 };
    let camera = Camera {
        eye: DVec3::Z * 4.0,
        projection,
        ..Default::default()
    };
    let view = View::new(&camera, 65, 65, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
    let words = [(8, f32::from_bits(0)), (9, 0.25), (0, 0.0), (4, 1.0)];
    let frame = render(&scene, &view, &only("depth", &words)).unwrap();
    // The sphere's pole towards the eye is 3 m away.
    let middle = frame.color[32 * 65 + 32][0];
    assert!(
        middle.abs_diff(rasterlab::math::srgb_byte(0.75)) <= 1,
        "{middle}"
    );
}

#[test]
fn number_of_threads_does_not_change_the_picture() {
    let (scene, view) = still_life([97, 61]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| render(&scene, &view, &all_effects()).unwrap())
    };
    let one = with(1);
    assert!((2..=5).all(|threads| with(threads) == one));
}
