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
    let positions: Vec<f32> = (0..side * side)
        .flat_map(|i| {
            [
                (i % side) as f32,
                height(i % side, i / side),
                (i / side) as f32,
            ]
        })
        .collect();
    let corner = |i: u32| i / (side - 1) * side + i % (side - 1);
    let cells = (0..(side - 1) * (side - 1)).map(corner);
    let indices: Vec<u32> = cells
        .flat_map(|a| [a, a + side, a + 1, a + 1, a + side, a + side + 1])
        .collect();
    let positions = model.floats("VEC3", &positions);
    let view = model.view(
        &indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect::<Vec<u8>>(),
    );
    let indices = model.push("accessors", json!({ "bufferView": view, "componentType": U32, "count": indices.len(), "type": "SCALAR" }));
    model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    model
}

#[test]
fn a_large_file_may_have_more_than_a_small_one() {
    // More vertices than a small file may ask for, in three bytes each and one of padding.
    let count = 4_000_001u32;
    let mut model = Model::empty();
    let corners = [[0i8, 0, 0, 0], [100, 0, 0, 0], [0, 100, 0, 0]];
    let bytes: Vec<u8> = (0..count)
        .flat_map(|vertex| corners[vertex as usize % 3])
        .map(|value| value as u8)
        .collect();
    let view = model.view(&bytes);
    model.json["bufferViews"][view]["byteStride"] = json!(4);
    let about = json!({ "bufferView": view, "componentType": 5120, "normalized": true, "count": count, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] });
    let positions = model.push("accessors", about);
    let triangle = model.shorts("SCALAR", &[0, 1, 2]);
    model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": triangle }));
    model.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let scene = model.load().expect("it fits the least budget");
    assert_eq!(scene.vertex_count(), u64::from(count));

    // As many vertices without bytes for them are refused, however much memory there is.
    let mut claim = model.clone();
    claim.bytes.truncate(64);
    claim.json["buffers"][0]["byteLength"] = json!(64);
    claim.json["bufferViews"] =
        json!([{ "buffer": 0, "byteLength": 16 }, { "buffer": 0, "byteLength": 8 }]);
    let overlay = json!({ "count": 1, "indices": { "bufferView": 0, "componentType": U8 }, "values": { "bufferView": 0 } });
    claim.json["accessors"][positions] = json!({ "sparse": overlay, "componentType": F32, "count": count, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] });
    let error = gltf::load_within(
        &claim.glb().as_slice(),
        MemoryBudget::of(1 << 50),
        &mut |_, _| unreachable!(),
    )
    .unwrap_err();
    let wanted = "POSITION: the model has 4000001 vertices or more; allowed: at most 4000000, because its files have only ";
    assert!(
        error.to_string().contains(wanted) && error.to_string().ends_with(" bytes"),
        "{error}"
    );
}

#[test]
fn a_file_beyond_the_budget_is_refused_unread_and_the_remedy_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.glb");
    let budget = MemoryBudget::LEAST;
    // Sparse on disk.
    fs::File::create(&path)
        .unwrap()
        .set_len(budget.decoded() + 1)
        .unwrap();
    let wanted = "huge.glb: it has 536870913 bytes; allowed: at most 536870912 within the memory budget of 1280 MiB; raise it with --memory";
    assert_eq!(
        host::model::load_within(&path, budget)
            .unwrap_err()
            .to_string(),
        wanted
    );
    // A budget of ten gigabytes has room for files of four, so a file of 600 MB would be read
    // there; one of five would not.
    fs::File::create(&path).unwrap().set_len(5 << 30).unwrap();
    let error = host::model::load_within(&path, MemoryBudget::of(10 << 30)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "huge.glb: it has 5368709120 bytes; allowed: at most 4294967296 within the memory budget of 10 GiB; raise it with --memory"
    );
}

#[test]
fn a_file_that_is_cut_short_while_it_is_open_is_a_sentence() {
    // The header still tells the old length, as when another program has begun to write the file
    // again.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.glb");
    let glb = cloth(300).glb();
    fs::write(&path, &glb[..glb.len() / 2]).unwrap();
    let error = host::model::load(&path).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("cut.glb: the file is cut off after 1,613,074 of "),
        "{error}"
    );
}

#[test]
fn a_model_is_the_same_from_its_file_as_from_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.glb");
    let mut sparse = Model::square();
    let (at, values) = (sparse.view(&[1, 3]), sparse.view(&[0; 24]));
    let overlay = json!({ "count": 2, "indices": { "bufferView": at, "componentType": U8 }, "values": { "bufferView": values } });
    let sparse = sparse.with("/accessors/0/sparse", overlay);
    for (what, model) in [
        ("cloth", cloth(40)),
        ("textured", Model::textured()),
        ("sparse", sparse),
        ("morphed", morphed()),
        ("skinned", skinned(0.3)),
    ] {
        fs::write(&path, model.glb()).unwrap();
        let from_file = host::model::load(&path).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(
            Scene {
                name: String::new(),
                ..from_file
            } == model.scene(),
            "{what}"
        );
    }
}

#[test]
fn progress_counts_every_byte_that_is_read_and_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloth.glb");
    let glb = cloth(200).glb();
    fs::write(&path, &glb).unwrap();
    let work = Arc::new(Work::default());
    work.run(|| host::model::load(&path))
        .expect("nobody cancels it")
        .expect("it is a good model");
    let progress = work.progress().expect("bytes were expected");
    assert_eq!(progress.done, progress.expected);
    let decoded = 12 * 200 * 200 + 24 * 199 * 199;
    assert_eq!(
        progress.expected,
        (glb.len() + decoded) as u64,
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
        assert!(
            canceled.elapsed() < Duration::from_secs(1),
            "after {tenth} tenths: {:?}",
            canceled.elapsed()
        );
    }
}

/// The most memory that `rasterlab parts` of a model takes, bytes.
#[cfg(target_os = "linux")]
fn peak(model: &std::path::Path) -> u64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterlab"));
    let mut program = command
        .arg("parts")
        .arg(model)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut peak = 0;
    loop {
        // It only grows, and is gone when the program has ended.
        let status =
            fs::read_to_string(format!("/proc/{}/status", program.id())).unwrap_or_default();
        let kib = status.lines().find_map(|line| {
            line.strip_prefix("VmHWM:")?
                .trim()
                .strip_suffix(" kB")?
                .trim()
                .parse::<u64>()
                .ok()
        });
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
    assert!(
        peak - before <= decoded * 5 / 2,
        "{} bytes for {decoded}, beside the {before} of the program",
        peak - before
    );
}

#[test]
fn the_script_that_writes_large_models_writes_good_ones() {
    let folder = tempfile::tempdir().unwrap();
    let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/big_glb.py");
    for (name, options, bytes_of_vertex) in [
        ("bare.glb", &[][..], 12),
        ("normals.glb", &["--normals"], 24),
    ] {
        let path = folder.path().join(name);
        let Ok(run) = Command::new("python3")
            .arg(&script)
            .arg("2000")
            .arg(&path)
            .args(options)
            .output()
        else {
            eprintln!("skipped: scripts/big_glb.py needs python3, which is not here");
            return;
        };
        assert!(
            run.status.success(),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        let scene = host::model::load(&path).expect("a good model");
        assert_sound(&scene);
        assert_eq!((scene.triangle_count(), scene.vertex_count()), (2000, 1000));
        assert!(fs::metadata(&path).unwrap().len() > 1000 * bytes_of_vertex + 2000 * 12);
        // A closed surface seen from outside: the volume that its triangles enclose is positive,
        // and every normal points out.
        let corner = |vertex: u32| {
            glam::DVec3::from(scene.primitives[0].position(&scene, vertex).map(f64::from))
        };
        let volume = |t: u32| {
            let [a, b, c] = scene.primitives[0].corners(&scene, t).map(corner);
            a.dot(b.cross(c)) / 6.0
        };
        let volume: f64 = (0..2000).map(volume).sum();
        assert!(
            (2.5..3.5).contains(&volume),
            "{volume}: two pi squared times 0.4 squared is 3.2"
        );
        let primitive = &scene.primitives[0];
        assert!(primitive.normals_agree != primitive.is_faceted);
    }
    let path = folder.path().join("cubes.glb");
    let run = Command::new("python3")
        .args([&script, std::path::Path::new("2000"), &path])
        .arg("--cubes")
        .output()
        .expect("it ran above");
    assert!(run.status.success());
    let scene = host::model::load(&path).expect("a good model");
    assert_sound(&scene);
    assert_eq!((scene.instances.len(), scene.primitives.len()), (166, 1));
    assert_eq!(scene.triangle_count(), 12 * 166);
}
