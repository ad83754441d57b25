//! Promise: an alpha mask leaves out the same samples in every kernel as in the oracle.

use super::*;

// -------- masks

/// The crown from outside, and from inside, where leaves are cut at the eye.
fn crowns(size: [u32; 2]) -> (Arc<Scene>, [(&'static str, View); 2]) {
    let scene = scene("leaves?n=60");
    let outside = from_eye(&scene, [0.6, 0.9, 3.6], [0.0, 0.0, 0.0], size);
    let camera = Camera {
        eye: DVec3::new(0.55, 0.1, 0.75),
        target: DVec3::new(-0.3, -0.1, 0.0),
        near_m: 0.2,
        ..Camera::default()
    };
    let inside = seen_by(&scene, camera, size);
    (scene, [("outside", outside), ("inside", inside)])
}

fn masks_leave_out_the_same_samples_in_every_kernel_and_in_the_oracle(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (scene, views) = crowns([160, 120]);
    let stacks = [
        &["lambert"][..],
        &["dissolve", "stipple"],
        &["draw_order"],
        &["explode"],
    ];
    let (options, mut cut) = (reach.options(&renderer), 0);
    for (what, view) in &views {
        for (turn, names) in reach.of(2, stacks.iter().enumerate()) {
            renderer.set_tuning(tunings()[turn % 4]);
            let option = options[turn % options.len()];
            let (capture, _) = renderer.exact(
                &scene,
                view,
                &stack(names),
                &pinned(option),
                &format!("{what} {names:?}"),
            );
            cut += capture.geometry.clipped_triangles.len();
        }
    }
    assert!(cut > 0, "no leaf was cut");
}

/// The crown with another cutoff.
fn cut_at(scene: &Scene, alpha_cutoff: Option<f32>) -> Scene {
    let mut scene = scene.clone();
    scene.materials[0].alpha_cutoff = alpha_cutoff;
    scene
}

#[test]
fn an_alpha_of_just_the_cutoff_is_drawn_whatever_the_byte() {
    let (scene, _) = crowns([8, 8]);
    for byte in 0..=255u32 {
        let least = cut_at(&scene, Some(byte as f32 / 255.0)).materials[0]
            .alpha_threshold()
            .expect("a mask");
        assert!(
            least <= byte << 16 && least + 2 > byte << 16,
            "{byte}: {least}"
        );
    }
}

#[test]
fn a_higher_cutoff_draws_a_part_of_what_a_lower_one_does() {
    let (scene, [(_, view), _]) = crowns([200, 150]);
    let stack = stack(&["xray"]);
    let layers = |alpha_cutoff| {
        oracle::render(&cut_at(&scene, alpha_cutoff), &view, &stack)
            .expect("it fits")
            .layer_sums
    };
    let cutoffs = [
        None,
        Some(0.0),
        Some(0.2),
        Some(0.5),
        Some(0.51),
        Some(0.9),
        Some(1.0),
        Some(1.5),
    ];
    let counts: Vec<Vec<u32>> = cutoffs
        .iter()
        .map(|&alpha_cutoff| layers(alpha_cutoff))
        .collect();
    for pair in counts.windows(2) {
        assert!(
            pair[0]
                .iter()
                .zip(&pair[1])
                .all(|(more, fewer)| more >= fewer)
        );
    }
    let sums: Vec<u32> = counts.iter().map(|counts| counts.iter().sum()).collect();
    assert!(
        sums[0] == sums[1]
            && sums[1] > sums[2]
            && sums[2] > sums[3]
            && sums[5] > sums[6]
            && sums[6] > 0
            && sums[7] == 0,
        "{sums:?}"
    );
}

#[test]
fn a_mask_of_a_texel_a_pixel_is_the_alpha_of_the_image() {
    let image = Image::new(
        "dots",
        [8, 8],
        (0..64)
            .map(|at| [255, 255, 255, rasterlab::math::hash(at) as u8])
            .collect(),
    );
    for filter in [Filter::Nearest, Filter::Linear] {
        for (wrap, span) in [
            (Wrap::Repeat, [0.0, 1.0]),
            (Wrap::Mirrored, [1.0, 2.0]),
            (Wrap::Clamp, [0.0, 1.0]),
        ] {
            let texture = Texture {
                wrap: [wrap; 2],
                mag_filter: filter,
                ..Texture::plain(0)
            };
            let (scene, view) = pixel_square(8, span, image.clone(), texture);
            for least in [1u8, 100, 128, 200, 255] {
                let masked = Arc::new(cut_at(&scene, Some((f32::from(least) - 0.5) / 255.0)));
                let own = oracle::render(&masked, &view, &Stack::default())
                    .expect("it fits")
                    .triangle_id;
                let mut all = vec![("oracle", own)];
                if let Some(mut renderer) = loan() {
                    let capture = renderer.captured(&masked, &view, &Stack::default(), &split32());
                    assert_eq!(capture.frame.counters.depth_without_id, 0);
                    all.push(("adapter", capture.frame.triangle_id));
                }
                for (who, triangle_ids) in all {
                    for (at, triangle_id) in triangle_ids.iter().enumerate() {
                        let (x, y) = if wrap == Wrap::Mirrored {
                            (7 - at % 8, 7 - at / 8)
                        } else {
                            (at % 8, at / 8)
                        };
                        let is_drawn = image.levels[0].texels[8 * y + x][3] >= least;
                        assert_eq!(
                            *triangle_id != u32::MAX,
                            is_drawn,
                            "{who}: {filter:?} {wrap:?} {least} at {at}"
                        );
                    }
                }
            }
        }
    }
}

fn mistakes_in_masks_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let (scene, views) = crowns([200, 150]);
    let (stack, option) = (stack(&[]), split32());
    let mistakes = [
        (
            "without perspective",
            "fixed_umul(spread.x, near.x).hi, fixed_umul(spread.y, near.y).hi, fixed_umul(spread.z, near.z).hi",
            "spread",
        ),
        (
            "a piece placed as its parent",
            "corners[1] = a +",
            "corners[1] = b + 0 *",
        ),
    ];
    for (what, view) in &views {
        healthy.exact(
            &scene,
            view,
            &stack,
            &option,
            &format!("without a mistake {what}"),
        );
    }
    let mut missed = Vec::new();
    for (what, from, to) in reach.of(1, mistakes) {
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        let why = views.iter().find_map(|(_, view)| {
            exactness(&wrong.judged(&scene, view, &stack, &option).1.report).err()
        });
        match why {
            None => missed.push(what),
            Some(why) => eprintln!("{what}: {why}"),
        }
    }
    assert_eq!(missed, Vec::<&str>::new());
}

#[test]
fn the_tier_strict_takes_masks_unless_something_masked_is_cut() {
    let Some(mut renderer) = loan() else { return };
    let (scene, [(_, outside), (_, inside)]) = crowns([96, 72]);
    let strict = AccuracyRequest {
        tier: Tier::Strict,
        ..AccuracyRequest::default()
    };
    let (capture, _) = renderer.exact(&scene, &outside, &stack(&["lambert"]), &strict, "strict");
    let (triangle_ids, keys) =
        oracle::strict_frame(&scene, &outside, &stack(&["lambert"])).expect("it fits");
    assert_eq!(
        (capture.frame.triangle_id, capture.frame.depth_key),
        (triangle_ids, keys)
    );
    renderer.set_scene(&scene).block_on().expect("it fits");
    let error = renderer
        .draw(&inside, &stack(&["lambert"]), &strict)
        .block_on()
        .expect_err("a cut leaf")
        .to_string();
    assert!(
        error.contains("the mask of a clipped triangle is placed in floats"),
        "{error}"
    );
}

// -------- nothing that a scene does not need

few_and_all!(
    masks_leave_out_the_same_samples_in_every_kernel_and_in_the_oracle,
    mistakes_in_masks_are_caught,
);
