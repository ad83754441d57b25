//! Promise: strict arithmetic gives the same bits on every adapter and on the CPU: soft floats, and
//! whole pictures by a committed list of hashes. `UPDATE_SNAPSHOTS=1` writes the list anew, always
//! by the oracle. Needs an adapter.

use std::{fs, path::Path, sync::Arc};

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{DepthFormat, PinnedOptions, VertexTransform, Visibility},
    effects::Stack,
    frame::NO_TRIANGLE,
    gpu::{Gpu, Renderer},
    math::{fnv1a, hash},
    measure::compare,
    oracle::{self, ftz},
    plan::{AccuracyRequest, Tuning},
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
    shader::library::Library,
};

use crate::{common::*, evaluator_gpu};

// -------- soft floats

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4u>;

@compute @workgroup_size(64)
fn calculate(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    let x = pairs[i].x;
    let y = pairs[i].y;
    results[i] = vec4u(softfloat_add(x, y), softfloat_multiply(x, y), softfloat_divide(x, y), bitcast<u32>(softfloat_round(x)));
}
";

/// Sum, product, quotient and the first rounded, of each pair, by the shaders of `library` on the
/// adapter.
fn calculated(gpu: &Gpu, library: &Library, pairs: &[[u32; 2]]) -> Vec<[u32; 4]> {
    let softfloat = library.text("lib/softfloat").expect("the file is there");
    let workgroups = [1024, pairs.len() as u32 / 65_536];
    evaluator_gpu::calculated(
        gpu,
        format!("{softfloat}{KERNEL}"),
        pairs,
        16 * pairs.len(),
        workgroups,
    )
}

/// Pairs that are hard in one way or another; none is NaN or infinite.
fn hard_pairs(seed: u32, count: u32) -> Vec<[u32; 2]> {
    let number = |word: u32| {
        if word >> 23 & 255 == 255 {
            word ^ 0x4000_0000
        } else {
            word
        }
    };
    let near =
        |value: f32, steps: u32| number(value.to_bits().wrapping_add(steps % 7).wrapping_sub(3));
    let pair = |i: u32| {
        let rng =
            |k: u32| hash(hash(seed ^ i.wrapping_mul(0x9e37_79b9)) ^ k.wrapping_mul(0x85eb_ca6b));
        let (x, y) = (number(rng(1)), number(rng(2)));
        let of_few_bits =
            |word: u32| number(word & 0xff80_0000 | rng(3) & rng(4) & rng(5) & 0x7f_ffff);
        // An exponent that differs by at most 27.
        let beside = |word: u32| {
            let exponent = (x >> 23 & 255) as i32 + (word >> 23 & 63) as i32 % 55 - 27;
            number(word & 0x807f_ffff | (exponent.clamp(1, 254) as u32) << 23)
        };
        let value = f32::from_bits(x);
        match i % 9 {
            0 => [x, y],
            1 => [x, beside(y)],
            2 => [of_few_bits(x), of_few_bits(beside(y))],
            // Cancellation, to nothing or next to it.
            3 => [x, near(-value, rng(6))],
            // Products and quotients about 2^-126.
            4 => [
                x,
                near(
                    (f64::from(f32::MIN_POSITIVE) / f64::from(value)) as f32,
                    rng(6),
                ),
            ],
            5 => [
                x,
                near(
                    (f64::from(value) / f64::from(f32::MIN_POSITIVE)) as f32,
                    rng(6),
                ),
            ],
            // Subnormals and zeros.
            6 => [
                x & 0x807f_ffff,
                if rng(6) % 2 == 0 { y } else { y & 0x807f_ffff },
            ],
            // About integers and halves.
            7 => [
                near((rng(6) >> (7 + rng(7) % 25)) as f32 / 2.0, rng(8)) | x & 0x8000_0000,
                x,
            ],
            // Quotients about powers of two, products about squares.
            _ => [x, near(value, rng(6)) ^ rng(7) & 0x8000_0000],
        }
    };
    (0..count).map(pair).collect()
}

/// Results that differ from Rust's f32 with explicit flushing; those that leave the range of f32
/// are no promise.
fn differences(gpu: &Gpu, library: &Library, seed: u32, count: u32) -> Vec<String> {
    let pairs = hard_pairs(seed, count);
    let mut different = Vec::new();
    let mut compared = 0u64;
    for (&[x, y], found) in pairs.iter().zip(calculated(gpu, library, &pairs)) {
        let (a, b) = (f32::from_bits(x), f32::from_bits(y));
        let expected = [
            Some(ftz::sum(a, b))
                .filter(|v| v.is_finite())
                .map(f32::to_bits),
            Some(ftz::product(a, b))
                .filter(|v| v.is_finite())
                .map(f32::to_bits),
            Some(ftz::quotient(a, b))
                .filter(|v| v.is_finite())
                .map(f32::to_bits),
            Some(ftz::round(a) as u32),
        ];
        for (name, (expected, found)) in ["+", "*", "/", "round"]
            .into_iter()
            .zip(expected.into_iter().zip(found))
        {
            compared += u64::from(expected.is_some());
            if expected.is_some_and(|expected| expected != found) {
                different.push(format!(
                    "{x:08x} {name} {y:08x} is {:08x}, not {found:08x}",
                    expected.unwrap_or_default()
                ));
            }
        }
    }
    assert!(
        compared > 3 * u64::from(count),
        "hardly anything was compared: {compared} of {count} pairs"
    );
    different
}

fn soft_floats_are_those_of_the_cpu_with_subnormals_flushed(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    for seed in reach.of(1, 0..4) {
        let different = differences(&gpu, &Library::Embedded, seed, 1 << 20);
        assert!(
            different.is_empty(),
            "seed {seed}: {} of 2^20 pairs, such as {:?}",
            different.len(),
            &different[..different.len().min(5)]
        );
    }
}

#[test]
fn a_soft_float_with_one_mistake_is_told_from_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let mutant = mutated("+ 127u + (kept & 1u)", "+ 127u");
    assert!(
        !differences(&gpu, &mutant.shaders(), 1, 1 << 17).is_empty(),
        "halves that are not rounded to even make no difference"
    );
}

// -------- pictures

/// One picture of the list.
struct Picture {
    name: String,
    scene: Arc<Scene>,
    view: View,
    stack: Stack,
}

impl Picture {
    fn new(name: &str, scene: Arc<Scene>, view: View, effects: &[&str]) -> Self {
        Self {
            name: name.into(),
            scene,
            view,
            stack: stack(effects),
        }
    }

    /// Triangle ids and keys by the oracle alone.
    fn reference(&self) -> (Vec<u32>, Vec<u32>) {
        oracle::strict_frame(&self.scene, &self.view, &self.stack)
            .unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    /// Its line in the list.
    fn line(&self, triangle_ids: &[u32], keys: &[u32]) -> String {
        format!(
            "{} {}x{} {:016x} {:016x}",
            self.name,
            self.view.width,
            self.view.height,
            fnv1a(triangle_ids),
            fnv1a(keys)
        )
    }
}

/// Random triangles about the eye, of all sizes: in front of the near plane, behind the eye, and
/// past the guard band.
fn about_the_eye(seed: u32, is_indexed: bool) -> Vec<SimpleMesh> {
    let mut rng = Rng(seed);
    let mut corner = |reach: f64| [0, 1, 2].map(|_| rng.real(-1.0, 1.0) * reach);
    let mut positions = Vec::new();
    for i in 0..500 {
        let reach = [0.02, 0.3, 3.0, 60.0][i % 4];
        let middle = corner([0.5, 5.0, 50.0][i % 3]);
        let mut place = || {
            let offset = corner(reach);
            [0, 1, 2].map(|k| (middle[k] + offset[k]) as f32)
        };
        positions.extend([place(), place(), place()]);
    }
    let indices = if is_indexed {
        (0..1500).map(|i| (i * 7 + i / 3) % 1500).collect()
    } else {
        Vec::new()
    };
    let placed = |scale: DVec3, turn: f64| {
        DMat4::from_scale(scale)
            * DMat4::from_cols_array_2d(&rasterlab::math::rotation_y(turn).to_cols_array_2d())
    };
    let transforms = vec![
        DMat4::IDENTITY,
        placed(DVec3::new(-0.3, 0.7, 1.1), 0.4),
        placed(DVec3::splat(1e-3), 2.0),
    ];
    let loose = SimpleMesh {
        positions: positions.clone(),
        transforms,
        ..SimpleMesh::default()
    };
    // A second draw with backs that do not show, and corners that are no numbers.
    let mut broken = positions.split_off(1200);
    broken[5][1] = f32::NAN;
    broken[50][2] = f32::MAX;
    broken[77] = [f32::MIN_POSITIVE / 2.0, -0.0, 1e-39];
    vec![
        SimpleMesh { indices, ..loose },
        SimpleMesh {
            positions: broken,
            double_sided: false,
            ..SimpleMesh::default()
        },
    ]
}

/// Every picture of the list: all classes of triangles, clipped ones, several draws, with and
/// without indices, both projections, and effects on every hook that decides in integers.
fn pictures() -> Vec<Picture> {
    let mut pictures = Vec::new();
    for query in SCENES {
        let scene = scene(query);
        let view = view(&scene, [320, 240]);
        pictures.push(Picture::new(query, scene, view, &[]));
    }
    for (effects, query, size) in [
        (&["stipple"][..], "near", [161, 119]),
        (&["wireframe", "xray"], "teapot?tess=8", [200, 150]),
        (&["dissolve"], "sizes", [150, 200]),
        (&["draw_order", "overdraw"], "knot?tess=24", [200, 150]),
        (&["boxes"], "near", [200, 150]),
        (&["points"], "sphere?triangles=200", [200, 150]),
    ] {
        let scene = scene(query);
        let view = view(&scene, size);
        pictures.push(Picture::new(
            &format!("{}+{query}", effects.join("+")),
            scene,
            view,
            effects,
        ));
    }
    let inside = |fov_y_deg: f64, near_m: f64| Camera {
        eye: DVec3::new(0.01, 0.02, 0.03),
        target: DVec3::new(0.3, -0.2, -1.0),
        projection: Projection::Perspective { fov_y_deg },
        near_m,
        ..Camera::default()
    };
    let parallel = Camera {
        projection: Projection::Orthographic { height_m: 0.7 },
        ..inside(90.0, 0.01)
    };
    for (name, seed, is_indexed, camera, size) in [
        ("direct", 1, false, inside(90.0, 0.01), [320, 240]),
        ("indexed", 2, true, inside(100.0, 1e-4), [333, 250]),
        ("narrow", 3, true, inside(0.02, 0.3), [128, 128]),
        ("wide", 4, false, inside(170.0, 1e-5), [1000, 30]),
        ("parallel", 5, true, parallel, [320, 240]),
    ] {
        let scene = scene_of_meshes(&about_the_eye(seed, is_indexed));
        let view = camera_view(&scene, &camera, size);
        pictures.push(Picture::new(name, scene, view, &[]));
    }
    pictures
}

fn strict(visibility: Visibility) -> AccuracyRequest {
    request(
        PinnedOptions::of(visibility)
            .with(VertexTransform::Strict)
            .with(DepthFormat::Integer),
    )
}

const HASHES: &str = include_str!("../strict_hashes.txt");

#[test]
fn the_oracle_finds_the_hashes_of_the_list() {
    let lines: Vec<String> = pictures()
        .iter()
        .map(|picture| {
            let (triangle_ids, keys) = picture.reference();
            let covered = triangle_ids
                .iter()
                .filter(|&&triangle_id| triangle_id != NO_TRIANGLE)
                .count();
            assert!(
                covered > 50,
                "{} shows next to nothing: {covered} pixels",
                picture.name
            );
            picture.line(&triangle_ids, &keys)
        })
        .collect();
    let text = lines.join("\n") + "\n";
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/strict_hashes.txt");
        fs::write(path, &text).expect("the list is written");
        return;
    }
    assert_eq!(
        text, HASHES,
        "the oracle on the left, the list on the right; UPDATE_SNAPSHOTS=1 writes it"
    );
}

/// One option draws nearly every triangle with its own workgroup, the other uses the adapter's
/// tuning.
fn ways(renderer: &Renderer) -> [(Tuning, Visibility); 2] {
    let options = options(renderer);
    [
        (tunings()[0], options[0]),
        (renderer.gpu().caps.tuning(), options[options.len() - 1]),
    ]
}

/// How a picture that `renderer` draws differs from its line in the list, if it does.
fn stray(
    renderer: &mut Renderer,
    picture: &Picture,
    line: &str,
    (tuning, option): (Tuning, Visibility),
) -> Option<String> {
    renderer.set_tuning(tuning);
    let frame = renderer
        .captured(
            &picture.scene,
            &picture.view,
            &picture.stack,
            &strict(option),
        )
        .frame;
    (picture.line(&frame.triangle_id, &frame.depth_key) != line).then(|| {
        let (triangle_ids, keys) = picture.reference();
        let [triangle_ids, keys] = [
            compare::triangle_ids(&frame.triangle_id, &triangle_ids),
            compare::triangle_ids(&frame.depth_key, &keys),
        ]
        .map(|images| {
            format!(
                "{} differ, first {:?}",
                images.different,
                images.mismatches.first()
            )
        });
        format!(
            "{} {} {tuning:?}: triangle ids: {triangle_ids}; keys: {keys}",
            picture.name,
            option.name()
        )
    })
}

fn the_adapter_finds_the_hashes_of_the_list(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let pictures = pictures();
    assert_eq!(
        pictures.len(),
        HASHES.lines().count(),
        "the list is of other pictures"
    );
    let ways = reach.of(1, ways(&renderer));
    let strays: Vec<String> = pictures
        .iter()
        .zip(HASHES.lines())
        .flat_map(|(picture, line)| {
            ways.iter()
                .filter_map(|&way| stray(&mut renderer, picture, line, way))
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(
        strays.is_empty(),
        "{} pictures differ from the list:\n{}",
        strays.len(),
        strays.join("\n")
    );
}

fn the_judge_finds_nothing_to_excuse_in_strict_pictures(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    for picture in reach.of(2, pictures().into_iter().step_by(5)) {
        let option = Visibility::Split32;
        let Picture {
            name,
            scene,
            view,
            stack,
        } = &picture;
        let (capture, verdict) = renderer.exact(scene, view, stack, &strict(option), name);
        let a = &verdict.report;
        assert_eq!(
            [
                a.depth_band_pixels,
                a.ill_conditioned,
                a.explained_by_snap,
                a.max_snap_delta.into()
            ],
            [0; 4],
            "{name}"
        );
        assert_eq!(
            verdict.expected.depth_key, capture.frame.depth_key,
            "{name}"
        );
    }
}

fn integer_keys_alone_leave_no_depth_band(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    for query in reach.of(1, ["sizes", "knot?tess=24", "near"]) {
        let scene = scene(query);
        let view = view(&scene, [256, 192]);
        for (tuning, option) in reach.of(1, ways(&renderer)) {
            renderer.set_tuning(tuning);
            let accuracy = request(PinnedOptions::of(option).with(DepthFormat::Integer));
            let (capture, verdict) =
                renderer.exact(&scene, &view, &stack(&["depth"]), &accuracy, query);
            assert_eq!(verdict.report.depth_band_pixels, 0, "{query}");
            assert_eq!(
                verdict.expected.triangle_id, capture.frame.triangle_id,
                "{query}"
            );
            assert_eq!(
                verdict.expected.depth_key, capture.frame.depth_key,
                "{query}"
            );
        }
    }
}

fn a_strict_picture_with_one_mistake_differs_from_the_list(reach: Reach) {
    let Some(healthy) = loan() else { return };
    let pictures = pictures();
    let way = (
        Tuning {
            max_small_samples: 64,
            max_small_side: 32,
            ..healthy.gpu().caps.tuning()
        },
        Visibility::Split32,
    );
    let mistakes = [
        (
            "another order of the sum",
            "teapot?tess=8",
            "softfloat_add(softfloat_add(sum, softfloat_multiply(row.z, p.z)), row.w)",
            "softfloat_add(softfloat_add(sum, row.w), softfloat_multiply(row.z, p.z))",
        ),
        (
            "large keys from biased edges",
            "direct",
            "large_depth_exact[index] = fixed_edge(begin, end, p);",
            "large_depth_exact[index] = fixed_sub(fixed_edge(begin, end, p), Wide(0u, u32(fixed_bias(end - begin))));",
        ),
        (
            "the float's guess is taken",
            "teapot?tess=8",
            "select(0u, 1u, left < 0)",
            "0u",
        ),
    ];
    for (what, name, from, to) in reach.of(1, mistakes) {
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        let (picture, line) = pictures
            .iter()
            .zip(HASHES.lines())
            .find(|(picture, _)| picture.name == name)
            .expect("a listed picture");
        assert!(
            stray(&mut wrong, picture, line, way).is_some(),
            "{what}: {name} does not differ"
        );
    }
}

#[test]
fn what_floats_decide_is_refused_by_name() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("sphere?triangles=200");
    let view = view(&scene, [64, 64]);
    renderer
        .set_scene(&scene)
        .block_on()
        .expect("a builtin fits");
    let accuracy = pin(VertexTransform::Strict);
    for name in ["explode", "inflate", "wobble", "race"] {
        let error = renderer
            .draw(&view, &stack(&["lambert", name]), &accuracy)
            .block_on()
            .expect_err(name)
            .to_string();
        assert!(
            error.starts_with("vertex_transform strict ")
                && error.contains(&format!("the effect {name} ")),
            "{error}"
        );
    }
    renderer
        .draw(&view, &stack(&["dissolve", "lambert", "xray"]), &accuracy)
        .block_on()
        .expect("integers decide here");
}

few_and_all!(
    a_strict_picture_with_one_mistake_differs_from_the_list,
    integer_keys_alone_leave_no_depth_band,
    the_judge_finds_nothing_to_excuse_in_strict_pictures,
    soft_floats_are_those_of_the_cpu_with_subnormals_flushed,
    the_adapter_finds_the_hashes_of_the_list,
);
