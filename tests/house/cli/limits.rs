//! Promise: what would take more memory or work than is allowed is refused in one sentence before
//! anything is allocated.

use std::time::Instant;

use serde_json::json;

use super::*;

/// A model of `nodes` nodes, each with `triangles` copies of one triangle of a mesh of `vertices`
/// vertices and `targets` morph targets.
fn crowd(nodes: usize, vertices: usize, triangles: usize, targets: usize) -> Vec<u8> {
    use base64::Engine as _;
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions: Vec<u8> = (0..vertices)
        .flat_map(|vertex| corners[vertex % 3])
        .flat_map(f32::to_le_bytes)
        .collect();
    let indices = [0u8, 1, 2].repeat(triangles);
    let bytes = [&positions[..], &indices[..]].concat();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(&bytes)
    );
    let accessor = |view: usize, kind: u32, of: &str, count: usize| json!({ "bufferView": view, "componentType": kind, "type": of, "count": count, "min": [0, 0, 0], "max": [1, 1, 0] });
    let mut index_accessor = accessor(1, 5121, "SCALAR", 3 * triangles);
    index_accessor
        .as_object_mut()
        .unwrap()
        .retain(|name, _| !["min", "max"].contains(&name.as_str()));
    let mut primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
    if targets > 0 {
        primitive["targets"] = vec![json!({ "POSITION": 0 }); targets].into();
    }
    json!({
        "asset": { "version": "2.0" }, "buffers": [{ "byteLength": bytes.len(), "uri": uri }],
        "bufferViews": [{ "buffer": 0, "byteLength": positions.len() }, { "buffer": 0, "byteOffset": positions.len(), "byteLength": indices.len() }],
        "accessors": [accessor(0, 5126, "VEC3", vertices), index_accessor], "meshes": [{ "primitives": [primitive] }],
        "nodes": vec![json!({ "mesh": 0 }); nodes], "scenes": [{ "nodes": (0..nodes).collect::<Vec<_>>() }],
    })
    .to_string()
    .into_bytes()
}

#[test]
fn the_memory_budget_is_a_flag_or_a_variable_and_names_itself() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("crowd.gltf"), crowd(1, 3, 1, 0)).unwrap();
    let args = ["parts", "crowd.gltf", "--memory", "2GiB"];
    assert_eq!(run_in(folder.path(), &args).code, 0);
    for (size, wanted) in [
        ("1MiB", "--memory 1MiB: it must be at least 1280 MiB"),
        (
            "8",
            "--memory 8: it must be a number with a unit, for instance 8GiB or 1500MiB",
        ),
    ] {
        let run = run_in(folder.path(), &["parts", "crowd.gltf", "--memory", size]);
        assert!(run.code == 2 && run.err.contains(wanted), "{}", run.err);
    }
    let with_variable = |args: &[&str], size: &str| {
        finished(
            command(folder.path())
                .args(args)
                .env("RASTERLAB_MEMORY", size)
                .output()
                .unwrap(),
        )
    };
    let run = with_variable(&["parts", "crowd.gltf"], "much");
    assert!(
        run.code == 2
            && run
                .err
                .contains("RASTERLAB_MEMORY much: it must be a number with a unit"),
        "{}",
        run.err
    );
    // A built-in scene counts as a model does.
    let run = with_variable(&["parts", "builtin:sphere?triangles=100000000"], "1280MiB");
    let wanted = "sphere: 100000000 triangles; allowed: at most 22369621 within the memory budget of 1280 MiB; raise it with --memory";
    assert!(run.code == 2 && run.err.contains(wanted), "{}", run.err);
    // Beyond the budget, beyond the flag.
    fs::File::create(folder.path().join("huge.glb"))
        .unwrap()
        .set_len(600 << 20)
        .unwrap();
    let run = with_variable(&["parts", "huge.glb"], "1300MiB");
    assert!(
        run.code == 2
            && run
                .err
                .contains("within the memory budget of 1300 MiB; raise it with --memory"),
        "{}",
        run.err
    );
}

#[test]
fn what_the_oracle_cannot_judge_is_not_measured_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    for more in [&[][..], &["--axes", "visibility"], &["--every-effect"]] {
        let args = [
            &[
                "bench",
                "--scene",
                "sphere?triangles=20000",
                "--size",
                "64x48",
                "--samples",
                "2",
            ][..],
            more,
        ]
        .concat();
        let run = finished(
            command(folder.path())
                .args(&args)
                .env("RASTERLAB_ORACLE_GIB", "0.001")
                .output()
                .unwrap(),
        );
        if run.code == 3 {
            return eprintln!("skipped: no adapter is here");
        }
        assert!(
            run.code == 2 && run.err.contains("and the oracle may take 0.001;"),
            "{args:?}: {}",
            run.err
        );
        assert!(
            run.err.contains("set RASTERLAB_ORACLE_GIB") && !run.err.contains("panicked"),
            "{}",
            run.err
        );
    }
}

#[test]
fn a_scene_that_the_adapter_cannot_bind_names_its_buffer_and_its_limit() {
    let adapters = json(&run(&["adapters", "--json"]));
    let most = adapters["results"][0]["limits"]["max_storage_binding_bytes"].as_u64();
    if most.is_none_or(|most| most > 128 << 20) {
        return eprintln!(
            "skipped: the first adapter binds more than the least that every adapter must, or there is none"
        );
    }
    let run = run(&[
        "render",
        "builtin:sphere?triangles=12000000",
        "--size",
        "64x48",
        "-o",
        "large.png",
    ]);
    let wanted = "the buffer vertex_bytes would take 144019656 bytes; this adapter binds at most 134217728; take another adapter, or fewer";
    assert!(
        run.code == 3 && run.err.contains(wanted),
        "{}: {}",
        run.code,
        run.err
    );
}

#[test]
fn particles_that_the_oracle_would_follow_for_minutes_are_refused_in_a_moment() {
    let folder = tempfile::tempdir().unwrap();
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    for (count, time) in [("5000", "590"), ("4000000", "149")] {
        let sets = [
            format!("particles.count={count}"),
            format!("clock.time_s={time}"),
            "particles.octaves=6".into(),
        ];
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let run = run_in(
            folder.path(),
            &[
                &[
                    "render",
                    "builtin:chamber",
                    "--adapter",
                    "cpu",
                    "--size",
                    "8x6",
                    "-o",
                    "p.png",
                ],
                &sets[..],
            ]
            .concat(),
        );
        assert!(
            run.code == 2
                && run
                    .err
                    .contains(&format!("would follow {count} particles over")),
            "{}",
            run.err
        );
        assert!(
            run.err.contains("or take a GPU") && !folder.path().join("p.png").exists(),
            "{}",
            run.err
        );
    }
    assert!(began.elapsed().as_secs() < 60, "{:?}", began.elapsed());
}

#[test]
fn images_that_the_oracle_would_draw_for_minutes_are_refused_in_a_moment() {
    let folder = tempfile::tempdir().unwrap();
    let look = "schema = 2\n[scene]\nbuiltin = \"stack?layers=1000&gap=0.001\"\n[accuracy]\nshadow_map_size = \"4096\"\n[effects.shadow]\n\
                [effects.boxes]\n[output]\nsize = [64, 48]\n";
    fs::write(folder.path().join("look.toml"), look).unwrap();
    fs::write(
        folder.path().join("smear.toml"),
        look.replace("1000", "60")
            .replace("[output]", "[effects.smear]\nframes = 32\n[output]"),
    )
    .unwrap();
    fs::write(
        folder.path().join("crowd.gltf"),
        crowd(1_000, 3, 100_000, 0),
    )
    .unwrap();
    let large = [
        "builtin:stack?layers=1000",
        "--size",
        "6000x4000",
        "--set",
        "boxes",
    ];
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    for (args, wanted) in [
        (
            &["verify", "look.toml"][..],
            "samples of triangles for the shadow map, and may test 2147483648; take a smaller shadow map",
        ),
        (
            &["verify", "look.toml", "--adapter", "cpu"],
            "samples of triangles for the shadow map",
        ),
        (
            &["render", "look.toml", "--adapter", "cpu", "-o", "a.png"],
            "samples of triangles for the shadow map",
        ),
        (
            &[&["render", "--adapter", "cpu", "-o", "a.png"][..], &large].concat(),
            "samples of triangles (pictures drawn one after the other: 1)",
        ),
        (
            &["verify", "smear.toml", "--adapter", "cpu"],
            "samples of triangles (pictures drawn one after the other: 33)",
        ),
        (&["verify", "crowd.gltf"], "GiB of memory"),
    ] {
        let run = run_in(folder.path(), args);
        if run.code == 3 {
            eprintln!("skipped without an adapter: {args:?}");
            continue;
        }
        assert!(
            run.code == 2 && run.err.contains(wanted) && !folder.path().join("a.png").exists(),
            "{args:?}: {}: {}",
            run.code,
            run.err
        );
    }
    assert!(began.elapsed().as_secs() < 60, "{:?}", began.elapsed());
}

#[test]
fn a_measurement_of_many_layers_reports_no_holes() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "bench",
        "--scene",
        "stack?layers=300",
        "--size",
        "256x192",
        "--samples",
        "2",
        "--json",
    ];
    let run = run_in(folder.path(), &args);
    if run.code == 3 {
        return eprintln!("skipped: no adapter is here");
    }
    assert_eq!(run.code, 0, "{}", run.err);
    let rows = json(&run);
    assert_eq!(
        rows["results"][0]["triangles"], 600,
        "a scene alone is measured without ground"
    );
    let promised: Vec<_> = rows["results"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|row| row["is_promised"] == true)
        .collect();
    assert!(!promised.is_empty(), "{rows}");
    for row in promised {
        for figure in ["holes", "double_hits", "wrong_triangles"] {
            assert_eq!(row["error"][figure], 0, "{figure}: {row}");
        }
    }
}

#[test]
fn a_picture_that_is_too_large_for_the_oracle_is_refused_in_a_moment() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("crowd.gltf"),
        crowd(1_000, 3, 100_000, 0),
    )
    .unwrap();
    fs::write(
        folder.path().join("throng.gltf"),
        crowd(10_000, 3, 100_000, 0),
    )
    .unwrap();
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    for (args, wanted) in [
        (
            &["render", "facet", "--size", "16384x16384"][..],
            "the picture would take about 56.",
        ),
        (
            &["render", "xray", "--size", "16384x8192"],
            "and the oracle may take 4;",
        ),
        (
            &["render", "crowd.gltf"],
            "draw it smaller or with fewer triangles, or set RASTERLAB_ORACLE_GIB",
        ),
        (&["render", "throng.gltf"], "GiB of memory"),
    ] {
        let run = run_in(
            folder.path(),
            &[args, &["--adapter", "cpu", "-o", "a.png"]].concat(),
        );
        assert_eq!(run.code, 2, "{args:?}: {}", run.err);
        assert!(
            run.err.contains(wanted) && run.err.matches("error: ").count() == 1,
            "{args:?}: {}",
            run.err
        );
    }
    assert!(began.elapsed().as_secs() < 40, "{:?}", began.elapsed());
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn the_budget_of_the_oracle_can_be_changed() {
    let folder = tempfile::tempdir().unwrap();
    let render = |gib: &str| {
        let args = [
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--size",
            "64x48",
            "--force",
            "-o",
            "a.png",
        ];
        finished(
            command(folder.path())
                .args(args)
                .env("RASTERLAB_ORACLE_GIB", gib)
                .stdin(Stdio::null())
                .output()
                .unwrap(),
        )
    };
    assert_eq!(render("0.5").code, 0);
    let refused = render("0.0001");
    assert!(
        refused.code == 2 && refused.err.contains("the oracle may take 0.0001;"),
        "{}",
        refused.err
    );
}

#[test]
fn morph_targets_times_nodes_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("chorus.gltf"),
        crowd(10_000, 3_000, 1, 256),
    )
    .unwrap();
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let began = Instant::now();
    let run = run_in(
        folder.path(),
        &["render", "chorus.gltf", "--adapter", "cpu", "-o", "a.png"],
    );
    assert!(
        run.code == 2
            && run
                .err
                .contains("positions of vertices and morph targets, and may compute 4294967296"),
        "{}",
        run.err
    );
    assert!(began.elapsed().as_secs() < 30, "{:?}", began.elapsed());
}
