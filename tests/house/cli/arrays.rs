//! Promise: `render --triangle-ids` and `--depths` write what the picture shows as NumPy arrays, by
//! the rules of pictures: several presets need several names, nothing is overwritten unasked, and a
//! wrong name is refused before anything is drawn.

use rasterlab::{oracle, preset_file};

use super::*;

/// Two triangles, a square from (-1, -1) to (1, 1) in the plane z = x; number 0 lies below its
/// diagonal.
const MODEL: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":72,"uri":"square.bin"}],
    "bufferViews":[{"buffer":0,"byteLength":72}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}]}"#;

const CORNERS: [[f32; 2]; 6] = [
    [-1., -1.],
    [1., -1.],
    [1., 1.],
    [-1., -1.],
    [1., 1.],
    [-1., 1.],
];

const SIZE: [usize; 2] = [40, 20];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = CORNERS
        .iter()
        .flat_map(|[x, y]| [*x, *y, *x])
        .flat_map(f32::to_le_bytes)
        .collect();
    fs::write(folder.path().join("square.bin"), bytes).unwrap();
    fs::write(folder.path().join("square.gltf"), MODEL).unwrap();
    folder
}

/// Draws the square from (0, 0, 4) with the oracle.
fn render(folder: &Path, extra: &[&str]) -> Run {
    let eye = [
        "--set",
        "camera.eye=[0,0,4]",
        "--set",
        "camera.target=[0,0,0]",
    ];
    let base = [
        "render",
        "square.gltf",
        "--adapter",
        "cpu",
        "--size",
        "40x20",
    ];
    run_in(folder, &[&base[..], &eye, extra].concat())
}

/// The numbers of a .npy file of version 1.0 with this kind and the shape of `SIZE`, as words.
fn words(path: &Path, kind: &str, [width, height]: [usize; 2]) -> Vec<u32> {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
    assert!(
        (10 + length).is_multiple_of(64) && header.ends_with('\n'),
        "{header:?}"
    );
    assert_eq!(
        header.trim_end(),
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({height}, {width}), }}")
    );
    let numbers = &bytes[10 + length..];
    assert_eq!(numbers.len(), width * height * 4);
    numbers
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}

#[test]
fn ids_and_depths_are_those_of_the_plane_that_was_drawn() {
    let half = 22.5_f64.to_radians().tan();
    for (lens, is_perspective) in [
        ("camera.fov_y_deg=45", true),
        ("camera.orthographic_height_m=4", false),
    ] {
        let folder = folder();
        let run = render(
            folder.path(),
            &[
                "--set",
                lens,
                "--unset",
                "ground",
                "--triangle-ids",
                "{preset}-ids.npy",
                "--depths",
                "d.npy",
                "--json",
            ],
        );
        assert_eq!(run.code, 0, "{}", run.err);
        let result = json(&run)["results"][0].clone();
        assert_eq!(
            (&result["file"], &result["triangle_ids"]),
            (&"square.png".into(), &"square-ids.npy".into())
        );
        assert_eq!(result["depths"], "d.npy");
        let ids = words(&folder.path().join("square-ids.npy"), "<u4", SIZE);
        let depths = words(&folder.path().join("d.npy"), "<f4", SIZE);
        let mut seen = [0, 0, 0];
        for (at, (id, bits)) in ids.into_iter().zip(depths).enumerate() {
            let [column, row] = [at % SIZE[0], at / SIZE[0]].map(|pixel| pixel as f64 + 0.5);
            let [across, up] = [(column / 20.0 - 1.0) * 2.0, 1.0 - row / 10.0];
            // Where the ray through the pixel meets the plane z = x.
            let (depth, [x, y]) = if is_perspective {
                let depth = 4.0 / (1.0 + across * half);
                (depth, [across * half * depth, up * half * depth])
            } else {
                (4.0 - 2.0 * across, [2.0 * across, 2.0 * up])
            };
            if [(x.abs() - 1.0).abs(), (y.abs() - 1.0).abs(), (x - y).abs()]
                .iter()
                .any(|distance| *distance < 1e-3)
            {
                continue;
            }
            let expected = if x.abs() > 1.0 || y.abs() > 1.0 {
                u32::MAX
            } else {
                u32::from(y > x)
            };
            assert_eq!(id, expected, "{lens}: pixel {at}");
            seen[expected.min(2) as usize] += 1;
            let found = f64::from(f32::from_bits(bits));
            assert_eq!(found.is_nan(), id == u32::MAX, "{lens}: pixel {at}");
            assert!(
                id == u32::MAX || (found / depth - 1.0).abs() < 1e-3,
                "{lens}: pixel {at} is at {found} m, the plane at {depth} m"
            );
        }
        assert!(seen.iter().all(|count| *count > 30), "{seen:?}");
    }
}

#[test]
fn the_arrays_are_those_of_the_oracles_frame() {
    let folder = tempfile::tempdir().unwrap();
    let size = [48, 36];
    for (name, scale) in [("cube-wall", "full"), ("facet-knot", "half")] {
        let scale_key = format!("accuracy.render_scale={scale}");
        let args = [
            "render",
            name,
            "--adapter",
            "cpu",
            "--size",
            "48x36",
            "--set",
            &scale_key,
            "--triangle-ids",
            "{preset}.npy",
        ];
        let run = run_in(folder.path(), &args);
        assert_eq!(
            (run.code, run.out.as_str()),
            (0, format!("{name}.png\n{name}.npy\n").as_str()),
            "{}",
            run.err
        );
        let mut file = preset_file::open(name, &Default::default()).unwrap();
        preset_file::set(&mut file, "accuracy.render_scale", scale).unwrap();
        let scene = preset_file::load_scene(&file.preset, None).unwrap();
        let factor = file.preset.accuracy.scale().factor();
        let frame =
            oracle::render_scaled(&scene, &file.preset.moments(&scene, size), factor).unwrap();
        assert!(frame.covered() > 100);
        assert_eq!(
            words(
                &folder.path().join(format!("{name}.npy")),
                "<u4",
                size.map(|side| side as usize)
            ),
            frame.triangle_id,
            "{name}"
        );
    }
}

#[test]
fn arrays_follow_the_rules_of_pictures() {
    let folder = folder();
    let is_there = |name: &str| folder.path().join(name).exists();
    let refused = |run: Run, words: &str| {
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{}", run.err);
        assert_eq!(
            run.err
                .lines()
                .filter(|line| line.starts_with("error: "))
                .count(),
            1,
            "{}",
            run.err
        );
        assert!(
            run.err.contains(words),
            "{words:?} is missing in {}",
            run.err
        );
        assert!(!is_there("square.png"), "it was drawn");
    };
    for flag in ["--triangle-ids", "--depths"] {
        fs::write(folder.path().join("old.npy"), "mine").unwrap();
        refused(
            render(folder.path(), &[flag, "old.npy"]),
            "old.npy exists; use --force",
        );
        assert_eq!(fs::read(folder.path().join("old.npy")).unwrap(), b"mine");
        let forced = render(
            folder.path(),
            &[flag, "old.npy", "--force", "-o", "forced.png"],
        );
        assert_eq!(
            (forced.code, forced.out.as_str()),
            (0, "forced.png\nold.npy\n"),
            "{}",
            forced.err
        );
        assert_ne!(fs::read(folder.path().join("old.npy")).unwrap(), b"mine");
        refused(
            render(folder.path(), &[flag, "-"]),
            "arrays are written to files",
        );
        refused(
            render(folder.path(), &[flag, "{presett}.npy"]),
            "unknown placeholder",
        );
        refused(
            render(
                folder.path(),
                &[flag, "a.npy", "facet", "-o", "{preset}.png"],
            ),
            "put {preset} or {n}",
        );
        refused(
            render(folder.path(), &[flag, "a.png", "-o", "a.png"]),
            "names the same file",
        );
        refused(
            render(folder.path(), &[flag, "no/folder/a.npy", "-o", "-"]),
            "no/folder",
        );
    }
    refused(
        render(
            folder.path(),
            &["--depths", "a.npy", "--triangle-ids", "a.npy"],
        ),
        "--triangle-ids names the same file",
    );
    let piped = render(
        folder.path(),
        &["-o", "-", "--triangle-ids", "ids_{n:2}.npy"],
    );
    assert!(
        piped.code == 0 && piped.bytes.starts_with(b"\x89PNG") && is_there("ids_01.npy"),
        "{}",
        piped.err
    );
}
