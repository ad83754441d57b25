//! Promise: what a material's images show arrives in the picture as the oracle has it, whichever way they are looked up; and a
//! file's textures load as the standard has them, or are refused in a sentence. The pictures alone need an adapter.

use std::sync::Arc;

use crate::common::*;
use glam::DVec3;
use image::{ImageBuffer, ImageFormat, Rgba};
use rasterlab::{
    accuracy::Visibility,
    effects::{EFFECTS, Effect, Stack},
    gpu::Renderer,
    measure::compare,
    oracle,
    plan::{AccuracyRequest, Tier},
    preset::{ClipPlayback, Clock, Preset, SceneSource},
    scene::{
        Accessor, Material, Scene,
        camera::{Camera, Projection},
        gltf::{self, LoadError, limits},
        texture::{Filter, Image, MipFilter, Texture, Wrap},
        view::View,
    },
    shader::{Fetch, KernelKey, Pass, library::Library, link, reflect},
};
use serde_json::{Value, json};

type Picture = Vec<[u8; 4]>;

/// `scene` from `eye` to `target`.
fn from_eye(scene: &Scene, eye: [f64; 3], target: [f64; 3], size: [u32; 2]) -> View {
    let camera = Camera { eye: eye.into(), target: target.into(), ..Camera::default() };
    preset_file(scene, camera, size)
}

fn preset_file(scene: &Scene, camera: Camera, size: [u32; 2]) -> View {
    let scene_source = SceneSource::Builtin(scene.name.clone());
    Preset { scene: scene_source, camera: Some(camera), ..Preset::default() }.view(scene, size)
}

/// The panels as the preset of that name sees them.
fn panels(size: [u32; 2]) -> (Arc<Scene>, View) {
    let scene = scene("panels");
    let view = from_eye(&scene, [1.4, 0.7, 6.4], [0.1, -0.35, 0.0], size);
    (scene, view)
}

// ---------------------------------------------------------------- pictures

#[test]
fn images_look_as_the_oracle_has_them_on_every_rung_and_under_every_kind_of_effect() {
    let Some(mut renderer) = renderer() else { return };
    let (panels, front) = panels([200, 150]);
    // Over the ground, which is cut behind the eye and runs to the horizon.
    let low = from_eye(&panels, [0.3, -1.9, 1.5], [0.0, -2.2, -6.0], [200, 150]);
    let flat = Camera { eye: DVec3::new(2.0, 1.5, 5.0), projection: Projection::Orthographic { height_m: 5.0 }, ..Camera::default() };
    let parallel = preset_file(&panels, flat, [160, 120]);
    let globe = scene("globe?tess=6");
    let near = from_eye(&globe, [0.4, 0.5, 1.5], [0.0, 0.0, 0.0], [160, 120]);
    let stacks =
        [&[][..], &["lambert"], &["facet", "lambert", "fog"], &["explode", "lambert"], &["boxes"], &["points"], &["xray"], &["toon"]];
    let mut cut = 0;
    for (what, scene, view) in
        [("in front", &panels, &front), ("over the ground", &panels, &low), ("parallel", &panels, &parallel), ("globe", &globe, &near)]
    {
        for (place, names) in stacks.iter().enumerate() {
            let options = if place == 1 { options(&renderer) } else { vec![quick_option(&renderer)] };
            for option in options {
                let about = format!("{what} {names:?} {}", option.name());
                let (capture, _) = exact(&mut renderer, scene, view, &stack(names), &pinned(option), &about);
                cut += capture.frame.counters.clipped;
            }
        }
    }
    assert!(cut > 0, "no triangle was cut");
}

/// A square of `side` pixels, its image's coordinates running from `from` to `to` along both axes.
fn pixel_square(side: u32, [from, to]: [f32; 2], image: Image, texture: Texture) -> (Arc<Scene>, View) {
    let s = side as f32;
    let corners = [[0.0, 0.0, 0.5], [s, 0.0, 0.5], [s, s, 0.5], [0.0, s, 0.5]];
    let mut scene =
        (*scene_of_meshes(&[SimpleMesh { positions: corners.to_vec(), indices: vec![0, 1, 2, 0, 2, 3], ..SimpleMesh::default() }])).clone();
    let texcoords: Vec<f32> = [[from, from], [to, from], [to, to], [from, to]].concat();
    let offset = scene.vertex_bytes.len();
    scene.vertex_bytes.extend(texcoords.iter().flat_map(|v| v.to_le_bytes()));
    scene.primitives[0].texcoords[0] = Some(Accessor::packed_f32(offset, 2, 4));
    scene.materials[0].base_texture = Some(texture);
    scene.images.push(image);
    (Arc::new(scene), pixel_view(side, side))
}

/// Texels that are all different.
fn noise(side: u32) -> Image {
    let texel = |at: u32| {
        let [r, g, b, _] = rasterlab::math::hash(at + 1).to_le_bytes();
        [r, g, b, 255]
    };
    Image::new("noise", [side, side], (0..side * side).map(texel).collect())
}

/// The oracle's picture, and the adapter's, where there is one.
fn pictures(scene: &Arc<Scene>, view: &View) -> Vec<(&'static str, Picture)> {
    let mut pictures = vec![("oracle", oracle::render(scene, view, &Stack::default()).expect("it fits").color)];
    if let Some(mut renderer) = renderer() {
        let option = quick_option(&renderer);
        pictures.push(("adapter", captured(&mut renderer, scene, view, &Stack::default(), &pinned(option)).frame.color));
    }
    pictures
}

#[test]
fn a_texel_a_pixel_is_the_image_itself_and_beyond_its_edges_what_the_sampler_says() {
    const SIDE: i64 = 8;
    let image = noise(SIDE as u32);
    let texels = image.levels[0].texels.clone();
    // Three images wide: before it, itself, behind it.
    let expected = |wrap: Wrap, at: i64| match (wrap, at) {
        (_, 0..SIDE) => at,
        (Wrap::Repeat, ..0) => at + SIDE,
        (Wrap::Repeat, _) => at - SIDE,
        (Wrap::Mirrored, ..0) => -1 - at,
        (Wrap::Mirrored, _) => 2 * SIDE - 1 - at,
        (Wrap::Clamp, ..0) => 0,
        (Wrap::Clamp, _) => SIDE - 1,
    };
    let wraps = [Wrap::Repeat, Wrap::Mirrored, Wrap::Clamp];
    for (across, down) in wraps.iter().flat_map(|&across| wraps.map(|down| (across, down))) {
        for filter in [Filter::Nearest, Filter::Linear] {
            let texture = Texture { wrap: [across, down], mag_filter: filter, ..Texture::plain(0) };
            let (scene, view) = pixel_square(3 * SIDE as u32, [-1.0, 2.0], image.clone(), texture);
            for (who, picture) in pictures(&scene, &view) {
                for (at, pixel) in picture.iter().enumerate() {
                    let (x, y) = (at as i64 % (3 * SIDE) - SIDE, at as i64 / (3 * SIDE) - SIDE);
                    let texel = texels[(expected(down, y) * SIDE + expected(across, x)) as usize];
                    assert_eq!(*pixel, texel, "{who}: {across:?} x {down:?} {filter:?} at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn between_texels_their_light_is_mixed_and_from_afar_their_mean_is_seen() {
    let light = |byte: u8| rasterlab::math::linear_light(f64::from(byte) / 255.0);
    let image = noise(8).with_mipmaps();
    let texel = |x: usize, y: usize| image.levels[0].texels[y * 8 + x];
    let mean = |x: usize, y: usize, c: usize| {
        let sum: f64 = [(0, 0), (1, 0), (0, 1), (1, 1)].iter().map(|(i, j)| light(texel((x + i) % 8, (y + j) % 8)[c])).sum();
        rasterlab::math::srgb_byte(sum / 4.0)
    };
    // Half a texel aside every pixel has four texels around it.
    let half = 1.0 / 16.0;
    let (scene, view) = pixel_square(8, [half, 1.0 + half], image.clone(), Texture { mip_filter: MipFilter::Unused, ..Texture::plain(0) });
    // Two texels a pixel: the first copy, whose texels are the means of four.
    let (far, far_view) = pixel_square(4, [0.0, 1.0], image.clone(), Texture::plain(0));
    for (who, scene, view, step) in [("between", &scene, &view, 1), ("afar", &far, &far_view, 2)] {
        for (by, picture) in pictures(scene, view) {
            let width = view.width as usize;
            for (at, pixel) in picture.iter().enumerate() {
                let (x, y) = (at % width * step, at / width * step);
                let off = (0..3).map(|c| pixel[c].abs_diff(mean(x, y, c))).max().expect("three channels");
                assert!(off <= 1, "{who} {by} at {x}, {y}: {pixel:?}");
            }
        }
    }
}

#[test]
fn what_shines_is_seen_in_the_dark_and_what_is_unlit_in_any_light() {
    let (scene, view) = panels([160, 120]);
    let dark = {
        let mut stack = stack(&["lambert"]);
        let effect = stack.get_mut("lambert").expect("just enabled");
        for name in ["sun", "sky", "ground"] {
            let field = effect.effect.field(name).expect("lambert has it");
            field.set(&mut effect.words, &[0.0, 0.0, 0.0, 1.0]).expect("black");
        }
        let field = effect.effect.field("headlight").expect("lambert has it");
        field.set(&mut effect.words, &[0.0]).expect("off");
        stack
    };
    let lit = oracle::render(&scene, &view, &Stack::default()).expect("it fits");
    let unlit = oracle::render(&scene, &view, &dark).expect("it fits");
    // Two triangles a panel: the fifth shines, the sixth is unlit.
    let black = |pixel: &[u8; 4]| pixel[..3] == [0, 0, 0];
    let mut seen = [0; 3];
    for ((triangle_id, lit), dark) in lit.triangle_id.iter().zip(&lit.color).zip(&unlit.color) {
        match triangle_id {
            10 | 11 => assert_eq!(lit, dark, "an unlit panel"),
            8 | 9 => seen[usize::from(!black(dark))] += 1,
            0..14 => assert!(black(dark), "{triangle_id}: {dark:?}"),
            _ => {}
        }
        seen[2] += u32::from(matches!(triangle_id, 10 | 11));
    }
    assert!(seen.iter().all(|count| *count > 50), "{seen:?}");
}

#[test]
fn mistakes_in_looking_up_texels_are_caught() {
    let Some(mut healthy) = renderer() else { return };
    let (scene, view) = panels([200, 150]);
    let (stack, option) = (stack(&["lambert"]), pinned(Visibility::Split32));
    exact(&mut healthy, &scene, &view, &stack, &option, "without a mistake");
    let decoded = "return vec3f(texels_float(texel & 255u), texels_float((texel >> 8u) & 255u), texels_float((texel >> 16u) & 255u));";
    let mistakes = [
        ("half a texel aside", "common/texels", "clamp(place * vec2f(size),", "clamp(place * vec2f(size) + 0.5,"),
        ("a hundredth of a texel aside", "common/texels", "clamp(place * vec2f(size),", "clamp(place * vec2f(size) + 0.01,"),
        ("no decoding", "common/texels", decoded, "return vec3f(vec3u(texel, texel >> 8u, texel >> 16u) & vec3u(255u)) / 255.0;"),
        ("mirrored is repeated", "common/texels", "period - 1 - within", "within - side"),
        ("clamped a texel early", "common/texels", "clamp(at, 0, side - 1)", "clamp(at, 0, side - 2)"),
        ("down as across", "common/texels", "size.y, (look.sampling >> 2u) & 3u", "size.y, look.sampling & 3u"),
        ("always mixed", "common/texels", "((look.sampling >> 4u) & 1u) != 0u", "true"),
        ("no copies", "common/texels", "if copies != COPIES_MIXED {", "if true {"),
        ("a copy twice", "common/texels", "u32(low) + 1u", "u32(low)"),
        ("a copy too small", "slots/texels/atlas", "0.5 * log2(", "0.125 + 0.5 * log2("),
        (
            "scale without perspective",
            "common/slopes",
            "select(bitcast<vec3f>(vec3u(t.a.w, t.b.w, t.c.w)), vec3f(1.0), IS_AFFINE)",
            "vec3f(1.0)",
        ),
        ("scale across alone", "slots/texels/atlas", "max(dot(right, right), dot(down, down))", "dot(right, right)"),
        ("turned the other way", "slots/texels/atlas", "look.u_per_v * stored.y", "look.v_per_u * stored.y"),
        ("emission is lit", "effects/lambert", "(s.color.rgb - s.glow) * light + s.glow", "s.color.rgb * light"),
        ("emission without its image", "slots/texels/atlas", "glow *= texels_at", "glow += 0.0 * texels_at"),
        ("another primitive's material", "slots/texels/atlas", "texels_record(t.draw)", "texels_record(t.draw ^ 1u)"),
    ];
    let mut missed = Vec::new();
    for (what, file, from, to) in mistakes {
        let library = mutated(file, from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        let (_, verdict) = judged(&mut wrong, &scene, &view, &stack, &option);
        match exactness(&verdict.accuracy) {
            Ok(()) => missed.push(what),
            Err(why) => eprintln!("{what}: {why}"),
        }
    }
    assert_eq!(missed, Vec::<&str>::new());
}

// ---------------------------------------------------------------- masks

/// The crown from outside, and from inside, where leaves are cut at the eye.
fn crowns(size: [u32; 2]) -> (Arc<Scene>, [(&'static str, View); 2]) {
    let scene = scene("leaves?n=60");
    let outside = from_eye(&scene, [0.6, 0.9, 3.6], [0.0, 0.0, 0.0], size);
    let camera = Camera { eye: DVec3::new(0.55, 0.1, 0.75), target: DVec3::new(-0.3, -0.1, 0.0), near_m: 0.2, ..Camera::default() };
    let inside = preset_file(&scene, camera, size);
    (scene, [("outside", outside), ("inside", inside)])
}

#[test]
fn masks_leave_out_the_same_samples_on_every_rung_in_every_kernel_and_in_the_oracle() {
    let Some(mut renderer) = renderer() else { return };
    let (scene, views) = crowns([160, 120]);
    let stacks =
        [&["lambert"][..], &["dissolve", "stipple"], &["wireframe"], &["xray"], &["draw_order"], &["explode"], &["boxes"], &["points"]];
    let usual = renderer.gpu().caps.tuning();
    let mut cut = 0;
    for (what, view) in &views {
        for (place, names) in stacks.iter().enumerate() {
            let stack = stack(names);
            let options = if place == 0 { options(&renderer) } else { vec![Visibility::Split32] };
            for option in options {
                for tuning in if place == 0 { tunings().to_vec() } else { vec![usual] } {
                    renderer.set_tuning(tuning);
                    let about = format!("{what} {names:?} {}", option.name());
                    let (capture, _) = exact(&mut renderer, &scene, view, &stack, &pinned(option), &about);
                    cut += capture.geometry.pieces.len();
                }
            }
        }
    }
    renderer.set_tuning(usual);
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
        let least = cut_at(&scene, Some(byte as f32 / 255.0)).materials[0].alpha_threshold().expect("a mask");
        assert!(least <= byte << 16 && least + 2 > byte << 16, "{byte}: {least}");
    }
}

#[test]
fn a_higher_cutoff_draws_a_part_of_what_a_lower_one_does() {
    let (scene, [(_, view), _]) = crowns([200, 150]);
    let stack = stack(&["xray"]);
    let layers = |alpha_cutoff| oracle::render(&cut_at(&scene, alpha_cutoff), &view, &stack).expect("it fits").counted;
    let cutoffs = [None, Some(0.0), Some(0.2), Some(0.5), Some(0.51), Some(0.9), Some(1.0), Some(1.5)];
    let counts: Vec<Vec<u32>> = cutoffs.iter().map(|&alpha_cutoff| layers(alpha_cutoff)).collect();
    for pair in counts.windows(2) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(more, fewer)| more >= fewer));
    }
    let sums: Vec<u32> = counts.iter().map(|counts| counts.iter().sum()).collect();
    assert!(sums[0] == sums[1] && sums[1] > sums[2] && sums[2] > sums[3] && sums[5] > sums[6] && sums[6] > 0 && sums[7] == 0, "{sums:?}");
}

#[test]
fn a_mask_of_a_texel_a_pixel_is_the_alpha_of_the_image() {
    let image = Image::new("dots", [8, 8], (0..64).map(|at| [255, 255, 255, rasterlab::math::hash(at) as u8]).collect());
    for filter in [Filter::Nearest, Filter::Linear] {
        for (wrap, span) in [(Wrap::Repeat, [0.0, 1.0]), (Wrap::Mirrored, [1.0, 2.0]), (Wrap::Clamp, [0.0, 1.0])] {
            let texture = Texture { wrap: [wrap; 2], mag_filter: filter, ..Texture::plain(0) };
            let (scene, view) = pixel_square(8, span, image.clone(), texture);
            for least in [1u8, 100, 128, 200, 255] {
                let masked = Arc::new(cut_at(&scene, Some((f32::from(least) - 0.5) / 255.0)));
                let own = oracle::render(&masked, &view, &Stack::default()).expect("it fits").triangle_id;
                let mut all = vec![("oracle", own)];
                if let Some(mut renderer) = renderer() {
                    let capture = captured(&mut renderer, &masked, &view, &Stack::default(), &pinned(Visibility::Split32));
                    assert_eq!(capture.frame.counters.depth_without_id, 0);
                    all.push(("adapter", capture.frame.triangle_id));
                }
                for (who, triangle_ids) in all {
                    for (at, triangle_id) in triangle_ids.iter().enumerate() {
                        let (x, y) = if wrap == Wrap::Mirrored { (7 - at % 8, 7 - at / 8) } else { (at % 8, at / 8) };
                        let is_drawn = image.levels[0].texels[8 * y + x][3] >= least;
                        assert_eq!(*triangle_id != u32::MAX, is_drawn, "{who}: {filter:?} {wrap:?} {least} at {at}");
                    }
                }
            }
        }
    }
}

#[test]
fn mistakes_in_masks_are_caught() {
    let Some(mut healthy) = renderer() else { return };
    let (scene, views) = crowns([200, 150]);
    let (stack, option) = (stack(&[]), pinned(Visibility::Split32));
    let mistakes = [
        ("half a texel aside", "slots/mask/asked", "let corner = place - 128;", "let corner = place;"),
        ("the nearest texel", "slots/mask/asked", "if ((look.sampling >> 4u) & 1u) == 0u {", "if true {"),
        (
            "without perspective",
            "slots/mask/asked",
            "fixed_umul(spread.x, near.x).hi, fixed_umul(spread.y, near.y).hi, fixed_umul(spread.z, near.z).hi",
            "spread",
        ),
        ("another channel", "slots/mask/asked", ">> 24u", ">> 16u & 255u"),
        ("mirrored", "slots/mask/asked", "vec3u(first.x, first.z, last.x)", "vec3u(first.z, first.x, last.x)"),
        ("a piece placed as its parent", "slots/mask/settled", "corners[1] = a +", "corners[1] = b + 0 *"),
        ("upside down", "slots/mask/settled", "-ndc.y", "ndc.y"),
        (
            "settled two units aside",
            "slots/mask/settled",
            "var corners = array<vec2i, 3>(a, b, c);",
            "var corners = array<vec2i, 3>(a + 2, b, c);",
        ),
        ("not asked in the second pass", "common/gate", "mask_is_drawn(t, at) && order", "order"),
    ];
    for (what, view) in &views {
        exact(&mut healthy, &scene, view, &stack, &option, &format!("without a mistake {what}"));
    }
    let mut missed = Vec::new();
    for (what, file, from, to) in mistakes {
        let library = mutated(file, from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        let why = views.iter().find_map(|(_, view)| exactness(&judged(&mut wrong, &scene, view, &stack, &option).1.accuracy).err());
        match why {
            None => missed.push(what),
            Some(why) => eprintln!("{what}: {why}"),
        }
    }
    assert_eq!(missed, Vec::<&str>::new());
}

#[test]
fn the_tier_strict_takes_masks_unless_something_masked_is_cut() {
    let Some(mut renderer) = renderer() else { return };
    let (scene, [(_, outside), (_, inside)]) = crowns([96, 72]);
    let strict = AccuracyRequest { tier: Tier::Strict, ..AccuracyRequest::default() };
    let (capture, _) = exact(&mut renderer, &scene, &outside, &stack(&["lambert"]), &strict, "strict");
    let (triangle_ids, keys) = oracle::strict_frame(&scene, &outside, &stack(&["lambert"])).expect("it fits");
    assert_eq!((capture.frame.triangle_id, capture.frame.key), (triangle_ids, keys));
    renderer.set_scene(&scene).expect("it fits");
    let error = renderer.draw(&inside, &stack(&["lambert"]), &strict).expect_err("a cut leaf").to_string();
    assert!(error.contains("the mask of a triangle that is cut is placed in floats"), "{error}");
}

// ---------------------------------------------------------------- nothing that a scene does not need

#[test]
fn a_scene_of_plain_colours_has_no_texture_and_no_word_of_one() {
    for effects in [
        vec![],
        EFFECTS.iter().copied().filter(|effect| effect.hooks.slot.is_none() && effect.name != "shadow").collect::<Vec<&'static Effect>>(),
    ] {
        // A shadow map is a texture, too.
        let mut plain = KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects.clone());
        plain.surface.has_material_atlas = false;
        assert!(!plain.to_string().contains("material_atlas"));
        for pass in plain.frame() {
            let root = format!("passes/{}", pass.stem());
            let linked = link::link(&Library::Embedded, &root, &plain, &plain.variants(pass)).expect("every file is there");
            for trace in ["texture", "Lookup", "Slopes", "alpha_threshold", "fn mask_alpha"] {
                assert!(!linked.text.contains(trace), "{}: {trace}", pass.label());
            }
        }
        let mut painted = plain;
        painted.surface.has_material_atlas = true;
        let text = |key: &KernelKey, pass: Pass| {
            let root = format!("passes/{}", pass.stem());
            link::link(&Library::Embedded, &root, key, &key.variants(pass)).expect("every file is there").text
        };
        // What a mask adds are a texture and records behind the vertices; storage buffers stay within the portable eight.
        let mut masked = painted.clone();
        masked.samples.has_mask = true;
        for pass in masked.frame() {
            assert!(!text(&painted, pass).contains("mask_alpha"), "{}", pass.label());
            let root = format!("passes/{}", pass.stem());
            let linked = link::link(&Library::Embedded, &root, &masked, &masked.variants(pass)).expect("every file is there");
            let reflected = reflect::reflect(&linked, false).unwrap_or_else(|error| panic!("{}: {error}", pass.label()));
            let bindings = reflected.bindings(pass.entry());
            let storage = bindings.iter().filter(|binding| matches!(binding.kind, reflect::BindingKind::Storage { .. })).count();
            assert!(storage <= 8, "{} binds {storage} storage buffers", pass.label());
        }
        let root = format!("passes/{}", Pass::Resolve.stem());
        let linked = link::link(&Library::Embedded, &root, &painted, &painted.variants(Pass::Resolve)).expect("every file is there");
        let reflected = reflect::reflect(&linked, false).expect("valid");
        let textures =
            reflected.bindings("resolve").into_iter().filter(|binding| binding.kind == (reflect::BindingKind::Texture { layered: true }));
        assert_eq!(textures.map(|binding| binding.name).collect::<Vec<_>>(), ["texels"]);
    }
    let Some(mut renderer) = renderer() else { return };
    let mut buffers = |query: &str| {
        let scene = scene(query);
        let view = view(&scene, [64, 48]);
        captured(&mut renderer, &scene, &view, &stack(&["lambert"]), &pinned(Visibility::Split32));
        let explained = renderer.explain();
        let said =
            explained.omitted.iter().chain(&explained.reasons).find(|note| note.name == "material atlas").map(|note| note.why.clone());
        (explained.buffers.iter().find(|buffer| buffer.name == "texels").map(|buffer| buffer.bytes), said.expect("a line about it"))
    };
    assert_eq!(buffers("teapot?tess=4"), (None, "no material is more than a base colour".into()));
    let (bytes, why) = buffers("panels");
    assert!(bytes.is_some_and(|bytes| bytes >= 4 * 64 * 64) && why.starts_with("atlas: 7 of 7 materials"), "{bytes:?} {why}");
    assert_eq!(buffers("teapot?tess=4").0, None, "a texture outlives its scene");
}

#[test]
fn another_scene_of_textures_brings_its_own() {
    let Some(mut renderer) = renderer() else { return };
    let scenes = ["panels", "globe?tess=4", "panels?repeats=2"].map(scene);
    for scene in scenes.iter().chain(&scenes) {
        let view = view(scene, [96, 72]);
        exact(&mut renderer, scene, &view, &stack(&["lambert"]), &pinned(Visibility::Split32), &scene.name);
    }
}

// ---------------------------------------------------------------- files

/// A square whose material looks up one PNG.
struct Model {
    json: Value,
    bytes: Vec<u8>,
}

const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const F32: u32 = 5126;

fn le<const N: usize>(values: impl IntoIterator<Item = [u8; N]>) -> Vec<u8> {
    values.into_iter().flatten().collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    le(values.iter().map(|v| v.to_le_bytes()))
}

/// 2 x 1 texels, red and translucent green.
fn encoded(format: ImageFormat) -> Vec<u8> {
    let picture = ImageBuffer::<Rgba<u8>, _>::from_raw(2, 1, vec![255, 0, 0, 255, 0, 200, 0, 100]).expect("eight bytes");
    let mut bytes = std::io::Cursor::new(Vec::new());
    match format {
        ImageFormat::Png => picture.write_to(&mut bytes, format).expect("it is encoded"),
        _ => image::DynamicImage::from(picture).into_rgb8().write_to(&mut bytes, format).expect("it is encoded"),
    }
    bytes.into_inner()
}

impl Model {
    fn new() -> Self {
        let mut model = Self {
            json: json!({
                "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
                "meshes": [{ "name": "X", "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
                "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
                "materials": [{ "name": "paper", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
                "textures": [{ "source": 0, "sampler": 0 }], "samplers": [{}],
                "images": [{ "name": "flag", "bufferView": 3, "mimeType": "image/png" }],
            }),
            bytes: Vec::new(),
        };
        let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
        let positions = model.accessor(&floats(&square), F32, "VEC3", 4);
        (model.json["accessors"][positions]["min"], model.json["accessors"][positions]["max"]) = (json!([0, 0, 0]), json!([1, 1, 0]));
        model.accessor(&floats(&[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]), F32, "VEC2", 4);
        model.accessor(&le([0u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes)), U16, "SCALAR", 6);
        assert_eq!(model.view(&encoded(ImageFormat::Png)), 3);
        model
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = json!(self.bytes.len());
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }))
    }

    fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a path");
        let parent = self.json.pointer_mut(parent).unwrap_or_else(|| panic!("no {parent}"));
        match parent {
            Value::Array(list) => list[key.parse::<usize>().expect("a place")] = value,
            _ => parent[key] = value,
        }
        self
    }

    /// With another image.
    fn showing(mut self, bytes: &[u8]) -> Self {
        let view = self.view(bytes);
        self.with("/images/0/bufferView", json!(view))
    }

    fn glb(&self) -> Vec<u8> {
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = (12 + 8 + text.len() + 8 + self.bytes.len()) as u32;
        let word = |v: u32| v.to_le_bytes();
        let head = [b"glTF".as_slice(), &word(2), &word(length), &word(text.len() as u32), b"JSON", &text].concat();
        [&head[..], &word(self.bytes.len() as u32), b"BIN\0", &self.bytes].concat()
    }

    fn load(&self) -> Result<Scene, LoadError> {
        gltf::parse(&self.glb(), &mut |path, _| panic!("{} was asked for", path.display()))
    }

    fn scene(&self) -> Scene {
        self.load().unwrap_or_else(|error| panic!("{error}\n{}", self.json))
    }

    fn material(&self) -> Material {
        let scene = self.scene();
        scene.materials[scene.primitives[0].material].clone()
    }

    fn texture(&self) -> Texture {
        self.material().base_texture.expect("a texture")
    }

    #[track_caller]
    fn refused(&self, sentence: &str) {
        let error = self.load().expect_err(sentence).to_string();
        assert!(error.contains(sentence), "said: {error}\nnot:  {sentence}");
        assert!(!error.contains('\n') && !error.contains("is a bug"), "{error}");
    }
}

const BASE: &str = "/materials/0/pbrMetallicRoughness/baseColorTexture";

#[test]
fn images_come_as_png_or_jpeg_from_bytes_uris_and_files() {
    let texels = vec![[255, 0, 0, 255], [0, 200, 0, 100]];
    let scene = Model::new().scene();
    assert_eq!((scene.images.len(), &scene.images[0].levels[0].texels), (1, &texels));
    assert_eq!(scene.images[0].levels.len(), 2, "an open sampler mixes copies");
    assert_eq!(Model::new().with("/samplers/0/minFilter", json!(9729)).scene().images[0].levels.len(), 1, "no sampler asks for copies");

    let jpeg = Model::new().showing(&encoded(ImageFormat::Jpeg)).with("/images/0/mimeType", json!("image/jpeg")).scene();
    assert_eq!(jpeg.images[0].size(), [2, 1]);
    assert!(jpeg.notes.is_empty(), "{:?}", jpeg.notes);
    let misnamed = Model::new().showing(&encoded(ImageFormat::Jpeg)).scene();
    assert!(misnamed.notes.iter().any(|note| note.contains("image \"flag\" is image/jpeg, although the file declares \"image/png\"")));

    use base64::{Engine, prelude::BASE64_STANDARD};
    let data = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(encoded(ImageFormat::Png)));
    let data = Model::new().with("/images/0", json!({ "uri": data })).scene();
    assert_eq!(data.images[0].levels[0].texels, texels);

    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("inside")).expect("a folder");
    for place in ["flag.png", "inside/flag one.png"] {
        std::fs::write(folder.path().join(place), encoded(ImageFormat::Png)).expect("written");
    }
    let load = |uri: &str| {
        let model = Model::new().with("/images/0", json!({ "uri": uri }));
        std::fs::write(folder.path().join("inside/model.glb"), model.glb()).expect("written");
        gltf::load(&folder.path().join("inside/model.glb"))
    };
    assert_eq!(load("flag%20one.png").expect("it lies beside the model").images[0].levels[0].texels, texels);
    for (uri, sentence) in [
        ("../flag.png", "image 0: URI \"../flag.png\" leads out of the model's folder"),
        ("http://example.org/flag.png", "has a scheme"),
        ("none.png", "image 0: \"none.png\": cannot read the file"),
    ] {
        let error = load(uri).expect_err(uri).to_string();
        assert!(error.contains(sentence), "{error}");
    }
}

#[test]
fn only_images_that_something_drawn_looks_up_are_read() {
    let broken = Model::new().with("/images/0", json!({ "uri": "../../etc/passwd" }));
    broken.refused("leads out of the model's folder");
    let unused = broken.with("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0 }, "indices": 2 })).scene();
    assert_eq!((unused.images.len(), unused.triangle_count()), (0, 2));
    let twice =
        Model::new().with("/materials/0/emissiveTexture", json!({ "index": 0 })).with("/materials/0/emissiveFactor", json!([1, 1, 1]));
    assert_eq!(twice.scene().images.len(), 1, "an image is stored once");
    let dark = Model::new().with("/materials/0/emissiveTexture", json!({ "index": 0 })).material();
    assert_eq!(dark.emission_texture, None, "what does not shine needs no image");
}

#[test]
fn samplers_keep_their_wraps_and_filters() {
    let plain = Model::new().texture();
    assert_eq!(plain, Texture::plain(0));
    let all = Model::new().with("/samplers/0", json!({ "wrapS": 33648, "wrapT": 33071, "magFilter": 9728, "minFilter": 9985 })).texture();
    let wrap = [Wrap::Mirrored, Wrap::Clamp];
    assert_eq!(all, Texture { wrap, mag_filter: Filter::Nearest, min_filter: Filter::Linear, mip_filter: MipFilter::Nearest, ..plain });
    for (filter, min_filter, mip_filter) in [
        (9728, Filter::Nearest, MipFilter::Unused),
        (9729, Filter::Linear, MipFilter::Unused),
        (9984, Filter::Nearest, MipFilter::Nearest),
        (9986, Filter::Nearest, MipFilter::Mixed),
        (9987, Filter::Linear, MipFilter::Mixed),
    ] {
        let texture = Model::new().with("/samplers/0/minFilter", json!(filter)).texture();
        assert_eq!((texture.min_filter, texture.mip_filter), (min_filter, mip_filter), "{filter}");
    }
    assert_eq!(Model::new().with("/textures/0", json!({ "source": 0 })).texture(), plain, "no sampler");
}

#[test]
fn transforms_scale_turn_and_move_and_may_name_another_set() {
    let mut model = Model::new();
    let other = model.accessor(&le([0u16, 0, 65535, 0, 65535, 65535, 0, 65535].map(u16::to_le_bytes)), U16, "VEC2", 4);
    model.json["accessors"][other]["normalized"] = json!(true);
    let model = model.with("/meshes/0/primitives/0/attributes/TEXCOORD_3", json!(other));
    let transform = json!({ "offset": [0.25, -1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 3 });
    let model = model.with(&format!("{BASE}/extensions"), json!({ "KHR_texture_transform": transform }));
    let texture = model.texture();
    assert_eq!(texture.set, 3);
    // A quarter turn, counterclockwise with v down, takes u to -v and v to u.
    for (stored, placed) in [([0.0, 0.0], [0.25, -1.0]), ([1.0, 0.0], [0.25, -3.0]), ([0.0, 1.0], [3.25, -1.0])] {
        let place = texture.placed(stored.into());
        assert!(place.abs_diff_eq(placed.into(), 1e-6), "{stored:?}: {place}");
    }
    assert_eq!(model.scene().primitives[0].texcoords[0].map(|texcoords| texcoords.normalized), Some(true));
    let named = Model::new().with(&format!("{BASE}/texCoord"), json!(0));
    assert_eq!(named.texture(), Texture::plain(0));
}

#[test]
fn coordinates_come_in_every_width_of_the_standard_and_quantized_ones_where_the_file_says_so() {
    let sets = [
        (U8, true, vec![0, 0, 255, 0, 255, 255, 0, 255]),
        (U16, true, le([0u16, 0, 65535, 0, 65535, 65535, 0, 65535].map(u16::to_le_bytes))),
        (I16, false, le([0i16, 0, 1, 0, 1, 1, 0, 1].map(i16::to_le_bytes))),
    ];
    for (component, normalized, bytes) in sets {
        let mut model = Model::new();
        let texcoords = model.accessor(&bytes, component, "VEC2", 4);
        model.json["accessors"][texcoords]["normalized"] = json!(normalized);
        let mut model = model.with("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(texcoords));
        if component == I16 {
            model.refused("mesh \"X\" primitive 0 TEXCOORD_0: accessor 3 has the type 2 x I16, which glTF does not allow for it");
            model = model
                .with("/extensionsRequired", json!(["KHR_mesh_quantization"]))
                .with("/extensionsUsed", json!(["KHR_mesh_quantization"]));
        }
        let scene = model.scene();
        let texcoords = scene.primitives[0].texcoords[0].expect("coordinates");
        let corner = |vertex| [0, 1].map(|lane| texcoords.value(&scene.vertex_bytes, vertex, lane));
        assert_eq!([0, 1, 2, 3].map(corner), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "{component}");
    }
}

#[test]
fn materials_shine_and_stay_unlit_as_the_file_says() {
    let shining = Model::new()
        .with("/materials/0/emissiveFactor", json!([1, 0.5, 0]))
        .with("/materials/0/extensions", json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4 } }))
        .with("/extensionsUsed", json!(["KHR_materials_emissive_strength"]));
    assert_eq!(shining.material().emission, [4.0, 2.0, 0.0]);
    assert!(shining.scene().notes.is_empty(), "{:?}", shining.scene().notes);
    let unlit = shining.with("/materials/0/extensions", json!({ "KHR_materials_unlit": {} })).material();
    assert!(unlit.unlit && unlit.emission == [0.0; 3] && unlit.base_texture.is_some());
}

#[test]
fn alpha_modes_say_what_is_cut_out() {
    let with_mode = |mode: &str| Model::new().with("/materials/0/alphaMode", json!(mode));
    assert_eq!(Model::new().material().alpha_cutoff, None, "an opaque material ignores alpha");
    assert_eq!(with_mode("MASK").material().alpha_cutoff, Some(0.5));
    let faint = with_mode("MASK")
        .with("/materials/0/alphaCutoff", json!(0.25))
        .with("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1, 1, 1, 0.5]));
    let faint = faint.material();
    assert_eq!((faint.alpha_cutoff, faint.base_color[3]), (Some(0.5), 1.0), "what is left is opaque");
    assert_eq!(with_mode("MASK").with("/materials/0/alphaCutoff", json!(0)).material().alpha_cutoff, None);
    with_mode("MASK")
        .with("/materials/0/alphaCutoff", json!(-0.1))
        .refused("material \"paper\": alphaCutoff -0.1 is not a number from 0 up");
    with_mode("TRANSLUCENT").refused("alphaMode");

    let blended = with_mode("BLEND").scene();
    assert_eq!(blended.materials[0].alpha_cutoff, Some(0.5), "its image has a texel of 100 of 255");
    let note = "material \"paper\": blending is not drawn; it is cut out where its alpha is below one half";
    assert!(blended.notes.iter().any(|given| given == note), "{:?}", blended.notes);
    let solid = with_mode("BLEND").showing(&encoded(ImageFormat::Jpeg)).scene();
    assert!(
        solid.materials[0].alpha_cutoff.is_none() && solid.notes.iter().any(|note| note.ends_with("blending is not drawn; it is opaque"))
    );

    let plain = |alpha: f64| {
        let model = with_mode("MASK").with("/materials/0/pbrMetallicRoughness", json!({ "baseColorFactor": [1, 1, 1, alpha] }));
        model.scene()
    };
    assert_eq!((plain(0.6).triangle_count(), plain(0.6).materials[0].base_color[3]), (2, 1.0));
    let nothing = plain(0.4);
    assert!(nothing.triangle_count() == 0 && nothing.notes[0].contains("is left out: the alpha of its material"), "{:?}", nothing.notes);
}

#[test]
fn textures_that_do_not_fit_are_refused_by_name() {
    let at = |place: &str, value: Value| Model::new().with(place, value);
    at(&format!("{BASE}/index"), json!(9)).refused("baseColorTexture.index: Index out of bounds");
    at("/textures/0/source", json!(9)).refused("textures[0].source: Index out of bounds");
    at("/textures/0/sampler", json!(9)).refused("textures[0].sampler: Index out of bounds");
    at("/textures/0", json!({ "sampler": 0 })).refused("source");
    at("/samplers/0/wrapS", json!(1)).refused("wrapS");
    at("/samplers/0/magFilter", json!(9985)).refused("magFilter");
    at("/samplers/0/minFilter", json!(1)).refused("minFilter");
    at("/images/0", json!({})).refused("image 0: it has neither a URI nor a bufferView");
    at("/images/0/uri", json!("flag.png")).refused("image \"flag\": has both a URI and a bufferView");
    at("/images/0/bufferView", json!(99)).refused("bufferView");
    at("/bufferViews/3/byteLength", json!(100_000)).refused("image \"flag\": bufferView 3");
    at(&format!("{BASE}/extensions"), json!({ "KHR_texture_transform": { "scale": [1e39, 1] } })).refused("KHR_texture_transform");
    at("/materials/0/extensions", json!({ "KHR_materials_emissive_strength": { "emissiveStrength": -1 } }))
        .refused("material \"paper\": emissiveStrength -1 lies outside 0..=65504");
    for extension in ["KHR_texture_basisu", "EXT_texture_webp"] {
        at("/extensionsRequired", json!([extension]))
            .refused(&format!("it requires the extension \"{extension}\", which is not supported"));
    }
}

#[test]
fn images_that_are_none_are_refused_by_name() {
    let place = "material \"paper\": baseColorTexture: image \"flag\": ";
    let png = encoded(ImageFormat::Png);
    Model::new().showing(b"RIFF....WEBP").refused(&format!("{place}is neither PNG nor JPEG"));
    Model::new().showing(&[]).refused("is neither PNG nor JPEG");
    for length in [8, 20, 40, png.len() - 16] {
        Model::new().showing(&png[..length]).refused(&format!("{place}cannot be decoded"));
    }
    let mut flipped = png.clone();
    flipped[20] ^= 64;
    Model::new().showing(&flipped).refused("image \"flag\": ");
    let jpeg = encoded(ImageFormat::Jpeg);
    Model::new().showing(&jpeg[..60]).refused(&format!("{place}cannot be decoded"));
}

/// A PNG of one colour: a few bytes for any size.
fn blank(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&vec![0; width.div_ceil(8) as usize * height as usize]).expect("texels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn an_image_cannot_ask_for_more_than_the_budget() {
    let bomb = blank(60_000, 60_000 / 50);
    assert!(bomb.len() < 100_000, "{} bytes", bomb.len());
    Model::new().showing(&bomb).refused("image \"flag\": is 60000 x 1200 texels; 1 to 8192 a side are read");
    let side = limits::IMAGE_SIDE;
    assert_eq!(Model::new().showing(&blank(side, 16)).with("/samplers/0/minFilter", json!(9729)).scene().images[0].size(), [side, 16]);
    // Two of the largest fit, a third does not; its header is enough to know.
    let mut model = Model::new();
    let largest = model.view(&blank(side, side));
    for place in 0..3 {
        let image = model.push("images", json!({ "bufferView": largest, "mimeType": "image/png", "name": format!("large {place}") }));
        let texture = model.push("textures", json!({ "source": image, "sampler": 0 }));
        let material = model.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }));
        let primitive = json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": material });
        model.json["meshes"][0]["primitives"].as_array_mut().expect("a list").push(primitive);
    }
    let model = model.with("/samplers/0/minFilter", json!(9729));
    model.refused("image \"large 1\": brings the model's images to 536870920 bytes once decoded; at most 536870912 are read");
}

#[test]
fn coordinates_that_do_not_fit_are_refused_by_name() {
    let place = "mesh \"X\" primitive 0 TEXCOORD_0: ";
    Model::new()
        .with("/meshes/0/primitives/0/attributes", json!({ "POSITION": 0 }))
        .refused(&format!("{place}is missing, and a texture of its material is looked up there"));
    Model::new().with(&format!("{BASE}/texCoord"), json!(2)).refused("mesh \"X\" primitive 0 TEXCOORD_2: is missing");
    for (values, sentence) in [
        ([0.0, 0.0, f32::NAN, 0.0, 1.0, 1.0, 0.0, 1.0], "vertex 1 is not finite"),
        ([0.0, 0.0, 1.0, 0.0, 1.0, f32::INFINITY, 0.0, 1.0], "vertex 2 is not finite"),
        ([0.0, 0.0, 1e6, 0.0, 1.0, 1.0, 0.0, 1.0], "vertex 1 lies at 1000000 0 of the image, which is followed to 65536 repeats"),
    ] {
        let mut model = Model::new();
        let texcoords = model.accessor(&floats(&values), F32, "VEC2", 4);
        model.with("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(texcoords)).refused(&format!("{place}{sentence}"));
    }
    let mut short = Model::new();
    let texcoords = short.accessor(&floats(&[0.0; 6]), F32, "VEC2", 3);
    short.with("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(texcoords)).refused("accessor 3 has 3 elements for 4 vertices");
    Model::new().with("/accessors/1/type", json!("SCALAR")).refused(place);
    Model::new().with("/accessors/1/componentType", json!(U16)).refused(place);
}

#[test]
fn broken_images_never_panic() {
    let (png, jpeg) = (encoded(ImageFormat::Png), encoded(ImageFormat::Jpeg));
    let mut loaded = 0;
    for seed in 0..600u32 {
        let mut bytes = if seed % 2 == 0 { png.clone() } else { jpeg.clone() };
        for flip in 0..1 + seed % 3 {
            let at = rasterlab::math::hash(8 * seed + flip) as usize % (8 * bytes.len());
            bytes[at / 8] ^= 1 << (at % 8);
        }
        match Model::new().showing(&bytes).load() {
            Ok(_) => loaded += 1,
            Err(error) => assert!(!error.to_string().contains("is a bug"), "seed {seed}: a panic was caught"),
        }
    }
    assert!(loaded > 20, "only {loaded} still load: the mutations are too rough");
}

#[test]
fn textured_boxes_of_the_corpus_show_their_image() {
    let corpus = std::path::Path::new("/usr/share/assimp/models/glTF2");
    if std::env::var_os("RASTERLAB_CORPUS").is_some_and(|value| value == "skip") {
        eprintln!("RASTERLAB_CORPUS=skip: the models of assimp-testmodels were not read");
        return;
    }
    let mut pictures = Vec::new();
    for file in
        ["BoxTextured-glTF/BoxTextured.gltf", "BoxTextured-glTF-Embedded/BoxTextured.gltf", "BoxTextured-glTF-Binary/BoxTextured.glb"]
    {
        let mut scene = gltf::load(&corpus.join(file)).unwrap_or_else(|error| panic!("{error}"));
        // The one with its image beside it is mirrored and clamped, which mixes other texels at the image's edge.
        let texture = scene.materials[0].base_texture.as_mut().expect("a texture");
        let is_beside = file == "BoxTextured-glTF/BoxTextured.gltf";
        assert_eq!(texture.wrap, if is_beside { [Wrap::Mirrored, Wrap::Clamp] } else { [Wrap::Repeat; 2] }, "{file}");
        texture.wrap = [Wrap::Repeat; 2];
        assert_eq!((scene.images.len(), scene.images[0].size()), (1, [211, 211]), "{file}");
        let view = view(&scene, [96, 72]);
        let frame = oracle::render(&scene, &view, &Stack::default()).expect("it fits");
        let colors: std::collections::BTreeSet<[u8; 4]> = frame.color.iter().copied().collect();
        assert!(colors.len() > 100, "{file} shows {} colours", colors.len());
        pictures.push(frame.color);
    }
    assert!(
        pictures.iter().all(|picture| compare::pictures(picture, &pictures[0], 0).pixels_over_tolerance == 0),
        "three ways to store one box"
    );
}

// ---------------------------------------------------------------- the validator of the standard

/// Classes of errors that we leave alone: what a file says about itself and nobody reads, and normals of any length.
const UNREAD: [&str; 4] =
    ["ACCESSOR_MIN_MISMATCH", "ACCESSOR_MAX_MISMATCH", "ACCESSOR_VECTOR3_NON_UNIT", "MESH_PRIMITIVE_NO_TANGENT_SPACE"];

/// Reads every file named after it and prints a line of JSON each: the codes of its errors.
const VALIDATE: &str = r#"
const validator = require('gltf-validator'), fs = require('fs'), path = require('path');
const beside = file => uri => new Promise((found, failed) =>
    fs.readFile(path.resolve(path.dirname(file), decodeURIComponent(uri)), (error, bytes) => error ? failed(String(error)) : found(new Uint8Array(bytes))));
const codes = report => report.issues.messages.filter(message => message.severity === 0).map(message => message.code);
(async () => {
    for (const file of process.argv.slice(1)) {
        const options = { uri: path.basename(file), externalResourceFunction: beside(file) };
        const found = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), options).then(codes, error => [String(error)]);
        console.log(JSON.stringify(found));
    }
})();
"#;

/// Codes of the errors that the validator finds in every file; none where node or the validator is missing.
fn validated(files: &[std::path::PathBuf]) -> Option<Vec<Vec<String>>> {
    let node = |script: &str| {
        let mut command = std::process::Command::new("node");
        command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["-e", script]);
        command
    };
    let is_there = node("require('gltf-validator')").output().is_ok_and(|output| output.status.success());
    if !is_there {
        eprintln!("gltf-validator is not installed (npm install gltf-validator here, or NODE_PATH): nothing is held against it");
        return None;
    }
    let output = node(VALIDATE).arg("--").args(files).output().expect("node runs");
    let lines = String::from_utf8(output.stdout).expect("JSON");
    let lines: Vec<Vec<String>> = lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(lines.len(), files.len(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(lines)
}

fn models_below(folder: &std::path::Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the corpus can be read") {
        let path = entry.expect("the corpus can be read").path();
        if path.is_dir() {
            models_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn what_we_accept_the_validator_accepts_and_the_malformed_are_refused_by_both() {
    let corpus = std::path::Path::new("/usr/share/assimp/models/glTF2");
    let mut files = Vec::new();
    if corpus.is_dir() {
        models_below(corpus, &mut files);
    }
    files.sort();
    let from_corpus = files.len();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let malformed: Vec<(&str, Model)> = malformed();
    for (name, model) in &malformed {
        let path = folder.path().join(format!("{name}.glb"));
        std::fs::write(&path, model.glb()).expect("written");
        files.push(path);
    }
    std::fs::write(folder.path().join("well.glb"), Model::new().glb()).expect("written");
    files.push(folder.path().join("well.glb"));
    let Some(errors) = validated(&files) else { return };
    let mut disagreements = Vec::new();
    for (place, (file, codes)) in files.iter().zip(&errors).enumerate() {
        let codes: Vec<&String> = codes.iter().filter(|code| !UNREAD.contains(&code.as_str())).collect();
        // Beyond the standard, or a schema of its own: extensions that we lack, and a scene that must have nodes.
        let is_ours = ["techniqueWebGL", "draco", "SceneWithoutNodes"].iter().any(|name| file.to_string_lossy().contains(name));
        match gltf::load(file) {
            Ok(_) if !codes.is_empty() => disagreements.push(format!("{} is accepted, and the validator says {codes:?}", file.display())),
            Err(error) if codes.is_empty() && !is_ours => disagreements.push(format!("the validator has nothing against it: {error}")),
            _ => {}
        }
        if place >= from_corpus {
            assert_eq!(gltf::load(file).is_err(), place < from_corpus + malformed.len(), "{}", file.display());
        }
    }
    assert_eq!(disagreements, Vec::<String>::new());
}

/// Files that break a rule of the standard about textures, one each.
fn malformed() -> Vec<(&'static str, Model)> {
    let at = |place: &str, value: Value| Model::new().with(place, value);
    let mut not_finite = Model::new();
    let texcoords = not_finite.accessor(&floats(&[0.0, 0.0, f32::NAN, 0.0, 1.0, 1.0, 0.0, 1.0]), F32, "VEC2", 4);
    let mut few = Model::new();
    let three = few.accessor(&floats(&[0.0; 6]), F32, "VEC2", 3);
    let set = "/meshes/0/primitives/0/attributes/TEXCOORD_0";
    vec![
        ("texture beyond the list", at(&format!("{BASE}/index"), json!(9))),
        ("image beyond the list", at("/textures/0/source", json!(9))),
        ("sampler beyond the list", at("/textures/0/sampler", json!(9))),
        ("an image of nothing", at("/images/0", json!({}))),
        ("an image of two things", at("/images/0/uri", json!("flag.png"))),
        ("a view beyond its buffer", at("/bufferViews/3/byteLength", json!(100_000))),
        ("no coordinates", at("/meshes/0/primitives/0/attributes", json!({ "POSITION": 0 }))),
        ("coordinates of one lane", at("/accessors/1/type", json!("SCALAR"))),
        ("coordinates that are no numbers", not_finite.with(set, json!(texcoords))),
        ("fewer coordinates than vertices", few.with(set, json!(three))),
        ("a negative cutoff", at("/materials/0/alphaMode", json!("MASK")).with("/materials/0/alphaCutoff", json!(-1))),
    ]
}

// ---------------------------------------------------------------- cameras

#[test]
fn cameras_of_a_file_are_chosen_by_name_and_go_with_their_nodes() {
    let mut model = Model::new();
    let (times, places) = (model.accessor(&floats(&[0.0, 2.0]), F32, "SCALAR", 2), floats(&[0.0, 0.0, 5.0, 4.0, 0.0, 5.0]));
    (model.json["accessors"][times]["min"], model.json["accessors"][times]["max"]) = (json!([0]), json!([2]));
    let places = model.accessor(&places, F32, "VEC3", 2);
    let lens = json!({ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } });
    let model = model
        .with("/cameras", json!([lens.clone(), lens]))
        .with("/nodes", json!([{ "mesh": 0 }, { "children": [2] }, { "camera": 0, "name": "chase", "translation": [0, 1, 0] }, { "camera": 1, "name": "still", "translation": [0, 0, 9] }]))
        .with("/scenes/0/nodes", json!([0, 1, 3]))
        .with(
            "/animations",
            json!([{ "name": "Drive", "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }], "samplers": [{ "input": times, "output": places }] }]),
        );
    let scene = model.scene();
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["chase", "still"]);
    let eye = |camera: &str, clip: &str, time_s: f64| {
        let play = ClipPlayback { clip: clip.into(), ..ClipPlayback::default() };
        let preset =
            Preset { scene_camera: camera.into(), playback: play, clock: Clock { time_s, ..Clock::default() }, ..Preset::default() };
        preset.check(&scene).unwrap_or_else(|error| panic!("{error}"));
        let view = preset.view(&scene, [64, 48]);
        (view.eye, view.forward)
    };
    assert_eq!(eye("", "", 0.5).0, DVec3::new(0.0, 1.0, 0.0), "at rest its node stands in its parent's place");
    assert_eq!(eye("", "Drive", 0.5), (DVec3::new(1.0, 1.0, 5.0), DVec3::NEG_Z), "the first, unasked");
    assert_eq!(eye("chase", "Drive", 1.5).0, DVec3::new(3.0, 1.0, 5.0));
    assert_eq!(eye("#1", "Drive", 1.5).0, DVec3::new(0.0, 0.0, 9.0));
    assert_eq!(eye("still", "", 0.0).0, DVec3::new(0.0, 0.0, 9.0));
    let lost = Preset { scene_camera: "crane".into(), ..Preset::default() };
    assert_eq!(lost.check(&scene).unwrap_err().to_string(), "scene.camera: the scene has no camera \"crane\"; it has \"chase\", \"still\"");
    let own = Camera { eye: DVec3::splat(7.0), ..Camera::default() };
    let own = Preset { scene_camera: "still".into(), camera: Some(own), ..Preset::default() };
    assert_eq!(own.view(&scene, [64, 48]).eye, DVec3::splat(7.0), "a preset's own camera comes first");
}
