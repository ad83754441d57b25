//! Promise: a mesh is the same in every format of meshes; polygons keep their area; truncated and
//! edited files never panic and end; small files take little; every mesh of assimp opens or is
//! refused in words.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use rasterlab::{
    math::{hash, hash_unit},
    preset_file::ModelFormat,
    scene::{
        gltf::LoadError,
        mesh_files::{LoadModel, load_obj, load_ply, load_stl},
    },
};

use super::{
    mesh_files::{load, stl, stl_text},
    model::{assert_sound, triangles},
};

type Triangle = [[f32; 3]; 3];

/// Triangles among some vertices.
fn mesh(seed: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let value = |i: u32| (hash_unit(seed.wrapping_mul(7919) + i) * 8.0 - 4.0) as f32;
    let count = 3 + hash(seed) % 40;
    let vertices = (0..count).map(|i| [0, 1, 2].map(|c| value(3 * i + c)));
    let corner = |i: u32| hash(seed ^ 0x5bd1 ^ i << 8) % count;
    let faces = (0..1 + hash(seed + 1) % 60).map(|i| {
        let first = corner(i);
        [first, (first + 1) % count, (first + 2) % count]
    });
    (vertices.collect(), faces.collect())
}

/// The mesh in every format and encoding.
fn written(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<(&'static str, LoadModel, Vec<u8>)> {
    let corners: Vec<Triangle> = faces
        .iter()
        .map(|face| face.map(|i| vertices[i as usize]))
        .collect();
    let lines = |before: &str| -> String {
        let line = |[x, y, z]: &[f32; 3]| format!("{before}{x} {y} {z}\n");
        vertices.iter().map(line).collect()
    };
    let obj_faces: String = faces
        .iter()
        .map(|face| format!("f {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1))
        .collect();
    let ply_faces: String = faces
        .iter()
        .map(|[a, b, c]| format!("3 {a} {b} {c}\n"))
        .collect();
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
            vertices.len(),
            faces.len()
        )
    };
    let binary = |is_big: bool| {
        let word = |word: u32| {
            if is_big {
                word.to_be_bytes()
            } else {
                word.to_le_bytes()
            }
        };
        let format = if is_big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = head(format).into_bytes();
        bytes.extend(vertices.iter().flatten().flat_map(|v| word(v.to_bits())));
        for face in faces {
            bytes.push(3);
            bytes.extend(face.iter().flat_map(|&i| word(i)));
        }
        bytes
    };
    let facets: Vec<_> = corners.iter().map(|&corners| (corners, 0)).collect();
    vec![
        (
            "OBJ",
            load_obj as LoadModel,
            format!("{}{obj_faces}", lines("v ")).into_bytes(),
        ),
        ("STL text", load_stl, stl_text(&corners).into_bytes()),
        ("STL binary", load_stl, stl(b"x", &facets)),
        (
            "PLY text",
            load_ply,
            format!("{}{}{ply_faces}", head("ascii"), lines("")).into_bytes(),
        ),
        ("PLY little endian", load_ply, binary(false)),
        ("PLY big endian", load_ply, binary(true)),
    ]
}

#[test]
fn a_mesh_is_the_same_in_every_format() {
    for seed in 0..200 {
        let (vertices, faces) = mesh(seed);
        let wanted: Vec<[[f64; 3]; 3]> = faces
            .iter()
            .map(|face| face.map(|i| vertices[i as usize].map(f64::from)))
            .collect();
        for (name, format, bytes) in written(&vertices, &faces) {
            let scene = load(format, &bytes, &[]).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_sound(&scene);
            assert_eq!(
                (triangles(&scene), scene.notes.len()),
                (wanted.clone(), 0),
                "{name} {seed}"
            );
        }
    }
}

/// A face of an OBJ with these corners, in a plane that leans.
fn polygon(corners: &[[f64; 2]]) -> Vec<u8> {
    let vertices: String = corners
        .iter()
        .map(|[x, y]| format!("v {x} {y} {}\n", 0.25 * x - 0.5 * y))
        .collect();
    let face: String = (1..=corners.len()).map(|i| format!(" {i}")).collect();
    format!("{vertices}f{face}\n").into_bytes()
}

/// The sum of the areas of its triangles, seen along z; each is turned the same way.
fn area(corners: &[[f64; 2]]) -> f64 {
    let scene = load(load_obj, &polygon(corners), &[]).expect("a polygon");
    assert_sound(&scene);
    let found = triangles(&scene);
    assert_eq!((found.len(), scene.notes.len()), (corners.len() - 2, 0));
    let areas: Vec<f64> = found
        .iter()
        .map(|[a, b, c]| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])))
        .collect();
    let is_one_way = |sign: f64| areas.iter().all(|area| area * sign >= -1e-5);
    assert!(is_one_way(1.0) || is_one_way(-1.0), "{areas:?}");
    areas.into_iter().sum()
}

/// By the shoelace formula.
fn own_area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1]))
        .sum()
}

#[test]
fn triangles_of_a_polygon_have_its_area() {
    let star = |count: u32, seed: u32| -> Vec<[f64; 2]> {
        let corner = |i: u32| {
            let (angle, radius) = (
                std::f64::consts::TAU * f64::from(i) / f64::from(count),
                0.2 + hash_unit(seed * 977 + i),
            );
            [radius * angle.cos(), radius * angle.sin()]
        };
        (0..count).map(corner).collect()
    };
    let comb = |teeth: u32| -> Vec<[f64; 2]> {
        let mut corners = vec![[f64::from(2 * teeth), -1.0], [0.0, -1.0]];
        corners.extend((0..2 * teeth).map(|i| [f64::from(i), f64::from(i % 2 * 9)]));
        corners.reverse();
        corners
    };
    // A square with a square hole, which a doubled edge joins to the outside.
    let keyhole = vec![
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];
    let square_with_points_on_edges = vec![
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 1.0],
    ];
    let stars = (0..60).map(|seed| star(4 + hash(seed) % 40, seed));
    let others = [
        comb(3),
        comb(200),
        keyhole,
        square_with_points_on_edges,
        star(2000, 3),
    ];
    for mut corners in stars.chain(others) {
        for _ in 0..2 {
            let (found, wanted) = (area(&corners), own_area(&corners));
            assert!(
                (found - wanted).abs() < 1e-4 * wanted.abs(),
                "{found} for {wanted}: {corners:?}"
            );
            corners.reverse();
        }
    }
}

#[test]
fn a_polygon_beyond_the_limit_is_left_out_and_one_below_it_ends() {
    let zigzag = |count: u32| -> Vec<[f64; 2]> {
        (0..count)
            .map(|i| [hash_unit(i), hash_unit(i + count)])
            .collect()
    };
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let start = Instant::now();
    let scene = load(load_obj, &polygon(&zigzag(3000)), &[]).expect("it crosses itself");
    assert_eq!(scene.triangle_count(), 2998);
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    let error = load(load_obj, &polygon(&zigzag(16_385)), &[])
        .unwrap_err()
        .to_string();
    let wanted = "it is not convex and has 16385 corners; allowed: at most 16384; it is left out";
    assert!(error.ends_with(wanted), "{error}");
}

/// It loads soundly, or is refused in a sentence.
fn ends(format: LoadModel, bytes: &[u8], about: &str) -> bool {
    match load(format, bytes, &[("a.mtl", MTL)]) {
        Ok(scene) => {
            assert_sound(&scene);
            true
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                sentence.len() > 9 && !sentence.contains('\n'),
                "{about}: {sentence:?}"
            );
            false
        }
    }
}

const MTL: &[u8] = b"newmtl a\nKd 1 0 0\nmap_Kd -o 1 a.mtl\n";

#[test]
fn truncated_and_edited_meshes_never_panic() {
    const AWKWARD: [&[u8]; 12] = [
        b"-1",
        b"0",
        b"99999999999999999999",
        b"nan",
        b"1e39",
        b"/",
        b"\\\n",
        b"\0",
        b"f",
        b"v",
        b"\xff",
        b"4294967295",
    ];
    let (vertices, faces) = mesh(5);
    let mut files = written(&vertices, &faces);
    files[0].2.splice(
        0..0,
        *b"mtllib a.mtl\no x\ng y z\ns 1\nusemtl a\nvt 1 1\nvn 0 0 1\nf 1/1/1 2//1 3/1 4\n",
    );
    for (name, format, bytes) in files {
        for length in (0..bytes.len()).step_by(7) {
            ends(format, &bytes[..length], name);
        }
        let mut opened = 0;
        for seed in 0..400u32 {
            let mut bytes = bytes.clone();
            for edit in 0..1 + hash(seed) % 3 {
                let at = hash(seed * 16 + edit + 1) as usize % bytes.len();
                match hash(seed * 16 + edit + 9) as usize % 16 {
                    awkward @ 0..12 => {
                        drop(bytes.splice(at..at + 1, AWKWARD[awkward].iter().copied()))
                    }
                    bit => bytes[at] ^= 1 << (bit % 8),
                }
            }
            opened += u32::from(ends(format, &bytes, name));
        }
        assert!(opened > 40, "{name}: only {opened} still open");
    }
}

#[test]
fn what_a_small_file_claims_takes_neither_time_nor_memory() {
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let start = Instant::now();
    let huge = "18446744073709551615";
    for body in [
        format!(
            "format binary_little_endian 1.0\nelement none {huge}\nelement vertex {huge}\nproperty float x\n"
        ),
        format!("format binary_little_endian 1.0\nelement vertex {huge}\n"),
        format!("format ascii 1.0\nelement none {huge}\nelement x {huge}\nproperty int a\n"),
        format!(
            "format binary_big_endian 1.0\nelement face {huge}\nproperty list uint double vertex_indices\n"
        ),
    ] {
        let text = format!("ply\n{body}end_header\n\u{7f}\u{7f}\u{7f}\u{7f}");
        assert!(load(load_ply, text.as_bytes(), &[]).is_err());
    }
    let mut claim = stl(b"", &[]);
    claim[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(load(load_stl, &claim, &[]).is_err());
    // As many parts as a file has bytes for are no claim.
    let groups: String = (0..262_145).map(|i| format!("g {i}\nf 1 2 3\n")).collect();
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{groups}");
    let scene = load(load_obj, text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.instances.len(), 262_145);
    assert!(
        start.elapsed() < Duration::from_secs(20),
        "{:?}",
        start.elapsed()
    );
}

const CORPUS: &str = "/usr/share/assimp/models";

/// Meshes of the corpus that are refused, with what is said.
const REFUSED: &[(&str, &str)] = &[
    ("OBJ/box_UTF16BE.obj", "it is UTF-16 text; save it as UTF-8"),
    (
        "OBJ/point_cloud.obj",
        "it has 3 vertices and no faces; export it with faces",
    ),
    ("OBJ/testline.obj", "no faces; export it with faces"),
    ("OBJ/testpoints.obj", "no faces; export it with faces"),
    (
        "PLY/points.ply",
        "it has 4 points and no faces; export it with faces",
    ),
    ("invalid/empty.obj", "it is empty"),
    ("invalid/empty.ply", "it is empty"),
    // Without the line of its faces.
    (
        "PLY/issue623.ply",
        "it has 24 points and no faces; export it with faces",
    ),
    (
        "PLY/pond.0.ply",
        "it has 70048 points and no faces; export it with faces",
    ),
];

#[test]
fn every_mesh_of_the_corpus_opens_or_is_refused_as_expected() {
    if std::env::var_os("RASTERLAB_CORPUS").is_some_and(|value| value == "skip") {
        eprintln!("RASTERLAB_CORPUS=skip: the models of assimp-testmodels were not read");
        return;
    }
    let corpus = Path::new(CORPUS);
    let mut models: Vec<PathBuf> = ["OBJ", "PLY", "STL", "invalid"]
        .iter()
        .flat_map(|folder| fs::read_dir(corpus.join(folder)).expect("assimp-testmodels"))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    models.retain(|path| {
        ["obj", "ply", "stl"]
            .iter()
            .any(|e| path.extension().is_some_and(|x| x.eq_ignore_ascii_case(e)))
    });
    assert!(models.len() > 35, "{} models", models.len());
    for path in models {
        let name = path.strip_prefix(corpus).unwrap().display().to_string();
        let expected = REFUSED.iter().find(|(file, _)| *file == name);
        let format = ModelFormat::of(&path).expect("a format");
        match (format.load(&path), expected) {
            (Ok(scene), None) => {
                assert_sound(&scene);
                assert!(scene.triangle_count() > 0, "{name}");
            }
            (Ok(_), Some((_, sentence))) => panic!("{name} was accepted; expected: {sentence}"),
            (Err(error), Some((_, sentence))) => {
                let sentence_said = error.to_string();
                assert!(
                    sentence_said.contains(sentence),
                    "{name} said: {error}\nnot: {sentence}"
                )
            }
            (Err(error), None) => panic!("{name} was refused: {error}"),
        }
    }
}

#[test]
fn files_are_read_only_beside_the_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).expect("a folder");
    fs::write(folder.path().join("a.mtl"), MTL).expect("a file");
    let model = inside.join("m.obj");
    let text = format!(
        "mtllib ../a.mtl\nmtllib {}\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        folder.path().join("a.mtl").display()
    );
    fs::write(&model, text).expect("a file");
    let load = || ModelFormat::of(&model).expect("a format").load(&model);
    let scene = load().expect("it opens");
    assert_eq!(scene.materials[0].base_color, [1.0; 4], "{:?}", scene.notes);
    assert!(scene.faults[0].starts_with("material file: \"../a.mtl\": cannot read the file"));
    // A file of that name beside the model is meant.
    fs::write(inside.join("a.mtl"), MTL).expect("a file");
    assert_eq!(
        load().expect("it opens").materials[0].base_color,
        [1.0, 0.0, 0.0, 1.0]
    );
    let error = load_obj(
        &&b"\xff\xd8\xff"[..],
        rasterlab::scene::memory::MemoryBudget::LEAST,
        &mut |_, _| Err(LoadError::new("unused")),
    );
    assert_eq!(
        error.unwrap_err().to_string(),
        "it is not an OBJ file: it is a JPEG picture"
    );
}
