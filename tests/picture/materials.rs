//! Promise: textures and alpha masks appear in the picture as in the oracle's, whichever way they
//! are sampled.

use std::sync::Arc;

use glam::DVec3;
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::Visibility,
    effects::{EFFECTS, Effect, Stack},
    host,
    measure::compare,
    oracle,
    plan::{AccuracyRequest, Tier},
    preset::{Preset, SceneSource},
    scene::{
        Accessor, Scene,
        camera::{Camera, Projection},
        memory::MemoryBudget,
        mesh_files::{LoadModel, load_obj, load_ply, load_stl},
        texture::{Filter, Image, MipFilter, Texture, Wrap},
        view::View,
    },
    shader::{Fetch, KernelKey, Pass, library::Library, link, reflect},
};

use crate::common::*;

mod masks;

type Picture = Vec<[u8; 4]>;

/// `scene` from `eye` to `target`.
fn from_eye(scene: &Scene, eye: [f64; 3], target: [f64; 3], size: [u32; 2]) -> View {
    let camera = Camera {
        eye: eye.into(),
        target: target.into(),
        ..Camera::default()
    };
    seen_by(scene, camera, size)
}

fn seen_by(scene: &Scene, camera: Camera, size: [u32; 2]) -> View {
    let scene_source = SceneSource::Builtin(scene.name.clone());
    Preset {
        scene: scene_source,
        camera: Some(camera),
        ..Preset::default()
    }
    .view(scene, size)
}

/// The panels as the preset of that name sees them.
fn panels(size: [u32; 2]) -> (Arc<Scene>, View) {
    let scene = scene("panels");
    let view = from_eye(&scene, [1.4, 0.7, 6.4], [0.1, -0.35, 0.0], size);
    (scene, view)
}

// -------- pictures

fn images_look_as_in_the_oracle_from_every_side(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (panels, front) = panels([200, 150]);
    // Over the ground, which is cut behind the eye and runs to the horizon.
    let low = from_eye(&panels, [0.3, -1.9, 1.5], [0.0, -2.2, -6.0], [200, 150]);
    let flat = Camera {
        eye: DVec3::new(2.0, 1.5, 5.0),
        projection: Projection::Orthographic { height_m: 5.0 },
        ..Camera::default()
    };
    let parallel = seen_by(&panels, flat, [160, 120]);
    let globe = scene("globe?tess=6");
    let near = from_eye(&globe, [0.4, 0.5, 1.5], [0.0, 0.0, 0.0], [160, 120]);
    let (mut cut, options) = (0, reach.options(&renderer));
    for (turn, (what, scene, view)) in [
        ("in front", &panels, &front),
        ("over the ground", &panels, &low),
        ("parallel", &panels, &parallel),
        ("globe", &globe, &near),
    ]
    .into_iter()
    .enumerate()
    {
        let names = [&["facet", "lambert", "fog"][..], &["explode", "lambert"]][turn / 2];
        let (capture, _) = renderer.exact(
            scene,
            view,
            &stack(names),
            &pinned(options[turn % options.len()]),
            what,
        );
        cut += capture.frame.counters.clipped;
    }
    assert!(cut > 0, "no triangle was cut");
}

#[test]
fn models_of_every_format_of_meshes_look_as_in_the_oracle() {
    let Some(mut renderer) = loan() else { return };
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_fn(5, 3, |x, y| {
        image::Rgba([50 * x as u8, 80 * y as u8, 99, 255])
    })
    .write_to(&mut png, image::ImageFormat::Png)
    .expect("it is encoded");
    let mtl = b"newmtl a\nKd 1 0.8 0.5\nmap_Kd a.png\nKe 0 0 0.1\n".to_vec();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.4 0.3\nv 0 0 1\nv 0 1 1\nvt 0 0\nvt 2 0\nvt 1 1\nusemtl a\ns 1\nf 1/1 2/2 3/3 5/1 4/2\nf 1/1 4/2 7/3 6/1\nusemtl none\nf 1 6 2\n";
    let stl = "solid x\nfacet\nvertex 0 0 0 vertex 1 0 0 vertex 0 1 0\nendfacet\nfacet\nvertex 1 1 -1\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0.9 1 0.3 9 9 9\n0.2 0.2 0.1 0 0 255\n4 0 1 2 3\n";
    for (what, load, text) in [
        ("OBJ", load_obj as LoadModel, obj),
        ("STL", load_stl, stl),
        ("PLY", load_ply, ply),
    ] {
        let scene = load(&text.as_bytes(), MemoryBudget::LEAST, &mut |path, _| {
            let is_image = path.extension().is_some_and(|extension| extension == "png");
            Ok(if is_image {
                png.get_ref().clone()
            } else {
                mtl.clone()
            })
        });
        let scene = Arc::new(scene.expect("a model"));
        let view = from_eye(&scene, [1.4, 1.2, 2.5], [0.5, 0.5, 0.0], [120, 90]);
        let option = quick_option(&renderer);
        let (capture, _) =
            renderer.exact(&scene, &view, &stack(&["lambert"]), &pinned(option), what);
        let background = capture.frame.color[0];
        let is_drawn = capture
            .frame
            .color
            .iter()
            .filter(|texel| **texel != background)
            .count();
        assert!(is_drawn > 500, "{what}: {is_drawn} pixels");
    }
}

/// A square of `side` pixels, its image's coordinates running from `from` to `to` along both axes.
fn pixel_square(
    side: u32,
    [from, to]: [f32; 2],
    image: Image,
    texture: Texture,
) -> (Arc<Scene>, View) {
    let s = side as f32;
    let corners = [[0.0, 0.0, 0.5], [s, 0.0, 0.5], [s, s, 0.5], [0.0, s, 0.5]];
    let mut scene = (*scene_of_meshes(&[SimpleMesh {
        positions: corners.to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..SimpleMesh::default()
    }]))
    .clone();
    let texcoords: Vec<f32> = [[from, from], [to, from], [to, to], [from, to]].concat();
    let offset = scene.vertex_bytes.len();
    scene
        .vertex_bytes
        .extend(texcoords.iter().flat_map(|v| v.to_le_bytes()));
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
    let mut pictures = vec![(
        "oracle",
        oracle::render(scene, view, &Stack::default())
            .expect("it fits")
            .color,
    )];
    if let Some(mut renderer) = loan() {
        let option = quick_option(&renderer);
        pictures.push((
            "adapter",
            renderer
                .captured(scene, view, &Stack::default(), &pinned(option))
                .frame
                .color,
        ));
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
    for (across, down) in wraps
        .iter()
        .flat_map(|&across| wraps.map(|down| (across, down)))
    {
        for filter in [Filter::Nearest, Filter::Linear] {
            let texture = Texture {
                wrap: [across, down],
                mag_filter: filter,
                ..Texture::plain(0)
            };
            let (scene, view) = pixel_square(3 * SIDE as u32, [-1.0, 2.0], image.clone(), texture);
            for (who, picture) in pictures(&scene, &view) {
                for (at, pixel) in picture.iter().enumerate() {
                    let (x, y) = (at as i64 % (3 * SIDE) - SIDE, at as i64 / (3 * SIDE) - SIDE);
                    let texel = texels[(expected(down, y) * SIDE + expected(across, x)) as usize];
                    assert_eq!(
                        *pixel, texel,
                        "{who}: {across:?} x {down:?} {filter:?} at {x}, {y}"
                    );
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
        let sum: f64 = [(0, 0), (1, 0), (0, 1), (1, 1)]
            .iter()
            .map(|(i, j)| light(texel((x + i) % 8, (y + j) % 8)[c]))
            .sum();
        rasterlab::math::srgb_byte(sum / 4.0)
    };
    // Half a texel aside every pixel has four texels around it.
    let half = 1.0 / 16.0;
    let (scene, view) = pixel_square(
        8,
        [half, 1.0 + half],
        image.clone(),
        Texture {
            mip_filter: MipFilter::Unused,
            ..Texture::plain(0)
        },
    );
    // Two texels a pixel: the first copy, whose texels are the means of four.
    let (far, far_view) = pixel_square(4, [0.0, 1.0], image.clone(), Texture::plain(0));
    for (who, scene, view, step) in [("between", &scene, &view, 1), ("afar", &far, &far_view, 2)] {
        for (by, picture) in pictures(scene, view) {
            let width = view.width as usize;
            for (at, pixel) in picture.iter().enumerate() {
                let (x, y) = (at % width * step, at / width * step);
                let off = (0..3)
                    .map(|c| pixel[c].abs_diff(mean(x, y, c)))
                    .max()
                    .expect("three channels");
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
            field
                .set(&mut effect.words, &[0.0, 0.0, 0.0, 1.0])
                .expect("black");
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

fn mistakes_in_looking_up_texels_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let (scene, view) = panels([200, 150]);
    let (stack, option) = (stack(&["lambert"]), split32());
    healthy.exact(&scene, &view, &stack, &option, "without a mistake");
    let mistakes = [
        (
            "a hundredth of a texel aside",
            "clamp(uv * vec2f(size),",
            "clamp(uv * vec2f(size) + 0.01,",
        ),
        (
            "a copy too small",
            "atlas_filtered(lookup, uv, 0.5 * log2(",
            "atlas_filtered(lookup, uv, 0.125 + 0.5 * log2(",
        ),
    ];
    let mut missed = Vec::new();
    for (what, from, to) in reach.of(1, mistakes) {
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &option);
        match exactness(&verdict.report) {
            Ok(()) => missed.push(what),
            Err(why) => eprintln!("{what}: {why}"),
        }
    }
    assert_eq!(missed, Vec::<&str>::new());
}

#[test]
fn a_scene_of_plain_colors_has_no_texture_and_no_word_of_one() {
    for effects in [
        vec![],
        EFFECTS
            .iter()
            .filter(|effect| effect.hooks.slot.is_none())
            .filter(|effect| !effect.hooks.casts_shadows && !effect.hooks.reads_finish())
            .cloned()
            .collect::<Vec<Arc<Effect>>>(),
    ] {
        // A shadow map is a texture, too, and how materials reflect stands in the atlas.
        let mut plain = KernelKey::complete(Fetch::Indexed, Visibility::Split32, effects.clone());
        (plain.surface.has_material_atlas, plain.surface.has_finish) = (false, false);
        (plain.surface.has_finish_maps, plain.surface.has_normal_maps) = (false, false);
        assert!(!plain.to_string().contains("material_atlas"));
        for pass in plain.frame() {
            let root = pass.path();
            let linked = link::link(&Library::Embedded, &root, &plain, &plain.variants(pass))
                .expect("every file is there");
            for trace in [
                "texture",
                "Lookup",
                "Slopes",
                "alpha_threshold",
                "fn alpha_mask",
            ] {
                assert!(!linked.text.contains(trace), "{}: {trace}", pass.label());
            }
        }
        let mut painted = plain;
        painted.surface.has_material_atlas = true;
        let text = |key: &KernelKey, pass: Pass| {
            let root = pass.path();
            link::link(&Library::Embedded, &root, key, &key.variants(pass))
                .expect("every file is there")
                .text
        };
        // What a mask adds are a texture and records behind the vertices; storage buffers stay
        // within the portable eight.
        let mut masked = painted.clone();
        masked.samples.has_mask = true;
        for pass in masked.frame() {
            assert!(
                !text(&painted, pass).contains("fn alpha_mask_texel"),
                "{}",
                pass.label()
            );
            let root = pass.path();
            let linked = link::link(&Library::Embedded, &root, &masked, &masked.variants(pass))
                .expect("every file is there");
            let reflected = reflect::reflect(&linked, false)
                .unwrap_or_else(|error| panic!("{}: {error}", pass.label()));
            let bindings = reflected.bindings(pass.stem());
            let storage = bindings
                .iter()
                .filter(|binding| matches!(binding.kind, reflect::BindingKind::Storage { .. }))
                .count();
            assert!(
                storage <= 8,
                "{} binds {storage} storage buffers",
                pass.label()
            );
        }
        let root = Pass::Resolve.path();
        let linked = link::link(
            &Library::Embedded,
            &root,
            &painted,
            &painted.variants(Pass::Resolve),
        )
        .expect("every file is there");
        let reflected = reflect::reflect(&linked, false).expect("valid");
        let textures = reflected
            .bindings("resolve")
            .into_iter()
            .filter(|binding| binding.kind == (reflect::BindingKind::Texture { layered: true }));
        assert_eq!(
            textures.map(|binding| binding.name).collect::<Vec<_>>(),
            ["material_atlas"]
        );
    }
    let Some(mut renderer) = loan() else { return };
    let mut buffers = |query: &str| {
        let scene = scene(query);
        let view = view(&scene, [64, 48]);
        renderer.captured(&scene, &view, &stack(&["lambert"]), &split32());
        let explained = renderer.explain();
        let said = explained
            .omitted
            .iter()
            .chain(&explained.reasons)
            .find(|note| note.name == "material atlas")
            .map(|note| note.why.clone());
        (
            explained
                .buffers
                .iter()
                .find(|buffer| buffer.name == "material_atlas")
                .map(|buffer| buffer.bytes),
            said.expect("a line about it"),
        )
    };
    assert_eq!(
        buffers("teapot?tess=4"),
        (None, "no material is more than a base color".into())
    );
    let (bytes, why) = buffers("panels");
    assert!(
        bytes.is_some_and(|bytes| bytes >= 4 * 64 * 64) && why.starts_with("7 of 7 materials"),
        "{bytes:?} {why}"
    );
    assert_eq!(
        buffers("teapot?tess=4").0,
        None,
        "a texture outlives its scene"
    );
}

#[test]
fn another_scene_of_textures_brings_its_own() {
    let Some(mut renderer) = loan() else { return };
    let scenes = ["panels", "globe?tess=4", "panels?repeats=2"].map(scene);
    for scene in scenes.iter().chain(&scenes) {
        let view = view(scene, [96, 72]);
        renderer.exact(scene, &view, &stack(&["lambert"]), &split32(), &scene.name);
    }
}

#[test]
fn textured_boxes_of_the_corpus_show_their_image() {
    let corpus = std::path::Path::new("/usr/share/assimp/models/glTF2");
    if std::env::var_os("RASTERLAB_CORPUS").is_some_and(|value| value == "skip") {
        eprintln!("RASTERLAB_CORPUS=skip: the models of assimp-testmodels were not read");
        return;
    }
    let mut pictures = Vec::new();
    for file in [
        "BoxTextured-glTF/BoxTextured.gltf",
        "BoxTextured-glTF-Embedded/BoxTextured.gltf",
        "BoxTextured-glTF-Binary/BoxTextured.glb",
    ] {
        let mut scene =
            host::model::load(&corpus.join(file)).unwrap_or_else(|error| panic!("{error}"));
        // The one with its image beside it is mirrored and clamped, which mixes other texels at the
        // image's edge.
        let texture = scene.materials[0].base_texture.as_mut().expect("a texture");
        let is_beside = file == "BoxTextured-glTF/BoxTextured.gltf";
        assert_eq!(
            texture.wrap,
            if is_beside {
                [Wrap::Mirrored, Wrap::Clamp]
            } else {
                [Wrap::Repeat; 2]
            },
            "{file}"
        );
        texture.wrap = [Wrap::Repeat; 2];
        assert_eq!(
            (scene.images.len(), scene.images[0].size()),
            (1, [211, 211]),
            "{file}"
        );
        let view = view(&scene, [96, 72]);
        let frame = oracle::render(&scene, &view, &Stack::default()).expect("it fits");
        let colors: std::collections::BTreeSet<[u8; 4]> = frame.color.iter().copied().collect();
        assert!(colors.len() > 100, "{file} shows {} colors", colors.len());
        pictures.push(frame.color);
    }
    assert!(
        pictures
            .iter()
            .all(|picture| compare::pictures(picture, &pictures[0], 0).pixels_over_tolerance == 0),
        "three ways to store one box"
    );
}

few_and_all!(
    images_look_as_in_the_oracle_from_every_side,
    mistakes_in_looking_up_texels_are_caught,
);
