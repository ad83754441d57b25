//! Promise: models of any size load within the memory budget, with at most 2.5 times as much memory
//! as they have decoded; loading tells its progress and ends within a moment when it is canceled.

use std::{
    fs,
    process::{Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use rasterlab::{
    host,
    scene::{Scene, gltf, memory::MemoryBudget},
    work::Work,
};
use serde_json::json;

use super::{
    model::*,
    motion::{morphed, skinned},
};

/// A wavy cloth of `side` x `side` vertices without normals: 12 bytes for each, and 24 for its two
/// triangles.
fn cloth(side: u32) -> Model {
    let mut model = Model::empty();
    let height = |x: u32, y: u32| ((x * 7 + y * 5) % 64) as f32 * 0.01;
    let place = |i: u32| {
        [
            (i % side) as f32,
            height(i % side, i / side),
            (i / side) as f32,
        ]
    };
    let positions: Vec<f32> = (0..side * side).flat_map(place).collect();
    let corner = |i: u32| i / (side - 1) * side + i % (side - 1);
    let cells = (0..(side - 1) * (side - 1)).map(corner);
    let indices = cells.flat_map(|a| [a, a + side, a + 1, a + 1, a + side, a + side + 1]);
    let bytes: Vec<u8> = indices.flat_map(u32::to_le_bytes).collect();
    model.floats("VEC3", &positions);
    model.accessor(&bytes, U32, "SCALAR", bytes.len() / 4);
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    model
}

#[test]
fn a_large_file_may_have_more_than_a_small_one() {
    // More vertices than a small file may ask for, in three bytes each and one of padding.
    let count = 4_000_001u32;
    let mut model = Model::empty();
    let corners = [[0i8, 0, 0, 0], [100, 0, 0, 0], [0, 100, 0, 0]];
    let numbers = (0..count).flat_map(|vertex| corners[vertex as usize % 3]);
    let bytes: Vec<u8> = numbers.map(|value| value as u8).collect();
    model.accessor(&bytes, I8, "VEC3", count as usize);
    model.numbers("SCALAR U16 0 1 2");
    model.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    let model = model.set(
        r#"
        /bufferViews/0/byteStride 4
        /accessors/0/normalized true
        /extensionsUsed ["KHR_mesh_quantization"]
        "#,
    );
    let scene = model.load().expect("it fits the least budget");
    assert_eq!(scene.vertex_count(), u64::from(count));

    // As many vertices without bytes for them are refused, however much memory there is.
    let mut claim = model.set(
        r#"
        /buffers/0/byteLength 64
        /bufferViews [{"buffer":0,"byteLength":16},{"buffer":0,"byteLength":8}]
        /accessors/0/componentType 5126
        - /accessors/0/normalized
        - /accessors/0/bufferView
        "#,
    );
    claim.bytes.truncate(64);
    let claim = claim.with("/accessors/0/sparse", sparse(1, 0, 0)).glb();
    let budget = MemoryBudget::of(1 << 50);
    let loaded = gltf::load_within(&claim.as_slice(), budget, &mut |_, _| unreachable!());
    let error = loaded.unwrap_err().to_string();
    let wanted = "POSITION: the model has 4000001 vertices or more; allowed: at most 4000000, because its files have only ";
    assert!(
        error.contains(wanted) && error.ends_with(" bytes"),
        "{error}"
    );
}

#[test]
fn a_file_beyond_the_budget_is_refused_unread_and_the_remedy_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.glb");
    let budget = MemoryBudget::LEAST;
    // A budget of ten gigabytes has room for files of four, so a file of 600 MB would be read
    // there; one of five would not.
    for (bytes, budget, most) in [
        (
            budget.decoded() + 1,
            budget,
            "at most 536870912 within the memory budget of 1280 MiB",
        ),
        (
            5 << 30,
            MemoryBudget::of(10 << 30),
            "at most 4294967296 within the memory budget of 10 GiB",
        ),
    ] {
        // Sparse on disk.
        fs::File::create(&path).unwrap().set_len(bytes).unwrap();
        let error = host::model::load_within(&path, budget)
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            format!("huge.glb: it has {bytes} bytes; allowed: {most}; raise it with --memory")
        );
    }
}

#[test]
fn a_file_that_is_cut_short_while_it_is_open_is_a_sentence() {
    // The header still tells the old length, as when another program has begun to write the file
    // again.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.glb");
    let glb = cloth(300).glb();
    fs::write(&path, &glb[..glb.len() / 2]).unwrap();
    let error = host::model::load(&path).unwrap_err().to_string();
    let place = "cut.glb: the file is cut off after 1,613,074 of ";
    assert!(error.starts_with(place), "{error}");
}

#[test]
fn a_model_is_the_same_from_its_file_as_from_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.glb");
    let mut overlaid = Model::square();
    let (at, values) = (overlaid.view(&[1, 3]), overlaid.view(&[0; 24]));
    let overlaid = overlaid.with("/accessors/0/sparse", sparse(2, at, values));
    for (what, model) in [
        ("cloth", cloth(40)),
        ("textured", Model::textured()),
        ("sparse", overlaid),
        ("morphed", morphed()),
        ("skinned", skinned(0.3)),
    ] {
        fs::write(&path, model.glb()).unwrap();
        let from_file = host::model::load(&path).unwrap_or_else(|error| panic!("{what}: {error}"));
        let unnamed = Scene {
            name: String::new(),
            ..from_file
        };
        assert!(unnamed == model.scene(), "{what}");
    }
}

#[test]
fn progress_counts_every_byte_that_is_read_and_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloth.glb");
    let glb = cloth(200).glb();
    fs::write(&path, &glb).unwrap();
    let work = Arc::new(Work::default());
    let loaded = work
        .run(|| host::model::load(&path))
        .expect("nobody cancels it");
    loaded.expect("it is a good model");
    let progress = work.progress().expect("bytes were expected");
    assert_eq!(progress.done, progress.expected);
    let decoded = 12 * 200 * 200 + 24 * 199 * 199;
    let once = (glb.len() + decoded) as u64;
    assert_eq!(
        progress.expected, once,
        "each byte is read once, and decoded once"
    );
}

#[test]
fn canceled_loading_ends_within_a_moment_wherever_it_is() {
    let glb = cloth(700).glb();
    let load = || gltf::load(&glb, &mut |_, _| unreachable!());
    // Asks for the real time: loading is canceled at shares of what it takes here, and ends soon after.
    let began = Instant::now();
    load().expect("it is a good model");
    let whole = began.elapsed();
    for tenth in 0..10 {
        let work = Arc::new(Work::default());
        let canceled = thread::scope(|scope| {
            let canceling = scope.spawn(|| {
                thread::sleep(whole * tenth / 10);
                work.cancel();
                Instant::now()
            });
            // It is loaded again where it was faster than the other thread.
            let outcome = work.run(|| while load().is_ok() {});
            assert!(outcome.is_none(), "canceled work goes on");
            canceling.join().expect("it sleeps")
        });
        // What is promised is a tenth of a second; tests share the machine.
        let late = canceled.elapsed();
        assert!(
            late < Duration::from_secs(1),
            "after {tenth} tenths: {late:?}"
        );
    }
}

/// The most memory that `rasterlab parts` of a model takes, bytes.
#[cfg(target_os = "linux")]
fn peak(model: &std::path::Path) -> u64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterlab"));
    command
        .arg("parts")
        .arg(model)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut program = command.spawn().expect("the program starts");
    let mut peak = 0;
    loop {
        // It only grows, and is gone when the program has ended.
        let status = format!("/proc/{}/status", program.id());
        let status = fs::read_to_string(status).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        peak = peak.max(1024 * kib.unwrap_or(0));
        if let Some(ended) = program.try_wait().expect("it can be waited for") {
            assert!(ended.success() && peak > 0);
            return peak;
        }
        // Sleeps between two looks at another process.
        thread::sleep(Duration::from_millis(1));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn loading_takes_at_most_two_and_a_half_times_what_is_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let [small, large] = [3, 1200].map(|side| {
        let path = folder.path().join(format!("{side}.glb"));
        fs::write(&path, cloth(side).glb()).unwrap();
        path
    });
    // A program that ends between two looks at it is seen smaller than it was.
    let before = (0..5).map(|_| peak(&small)).max().expect("five runs");
    let peak = peak(&large);
    let decoded = host::model::load(&large)
        .expect("a good model")
        .byte_count();
    assert!(decoded > 68_000_000, "{decoded}");
    let taken = peak - before;
    assert!(
        taken <= decoded * 5 / 2,
        "{taken} bytes for {decoded}, beside the {before} of the program"
    );
}

#[test]
fn the_script_that_writes_large_models_writes_good_ones() {
    let folder = tempfile::tempdir().unwrap();
    let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/big_glb.py");
    let path = folder.path().join("model.glb");
    for (options, bytes_of_vertex) in [(&[][..], 12), (&["--normals"], 24), (&["--cubes"], 0)] {
        let mut command = Command::new("python3");
        command.arg(&script).arg("2000").arg(&path).args(options);
        let Ok(run) = command.output() else {
            return eprintln!("skipped: scripts/big_glb.py needs python3, which is not here");
        };
        assert!(
            run.status.success(),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        let scene = host::model::load(&path).expect("a good model");
        assert_sound(&scene);
        if bytes_of_vertex == 0 {
            assert_eq!((scene.instances.len(), scene.primitives.len()), (166, 1));
            assert_eq!(scene.triangle_count(), 12 * 166);
            continue;
        }
        assert_eq!((scene.triangle_count(), scene.vertex_count()), (2000, 1000));
        assert!(fs::metadata(&path).unwrap().len() > 1000 * bytes_of_vertex + 2000 * 12);
        // A closed surface seen from outside: the volume that its triangles enclose is positive,
        // and every normal points out.
        let primitive = &scene.primitives[0];
        let corner =
            |vertex: u32| glam::DVec3::from(primitive.position(&scene, vertex).map(f64::from));
        let volume = |t: u32| {
            let [a, b, c] = primitive.corners(&scene, t).map(corner);
            a.dot(b.cross(c)) / 6.0
        };
        let volume: f64 = (0..2000).map(volume).sum();
        let is_right = (2.5..3.5).contains(&volume);
        assert!(
            is_right,
            "{volume}: two pi squared times 0.4 squared is 3.2"
        );
        assert!(primitive.normals_agree != primitive.is_faceted);
    }
}
