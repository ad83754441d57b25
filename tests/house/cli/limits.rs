//! Promise: what would take more memory or work than is allowed is refused in one sentence before
//! anything is allocated.

use std::time::Instant;

use serde_json::json;

use super::*;

/// A model of `nodes` nodes, each with `triangles` copies of one triangle of a mesh of `vertices`
/// vertices and `targets` morph targets.
fn crowd([nodes, vertices, triangles, targets]: [usize; 4]) -> String {
    use base64::{Engine as _, engine::general_purpose::STANDARD};
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let numbers = (0..vertices).flat_map(|vertex| corners[vertex % 3]);
    let positions: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let indices = [0u8, 1, 2].repeat(triangles);
    let bytes = [&positions[..], &indices[..]].concat();
    let mut primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
    if targets > 0 {
        primitive["targets"] = vec![json!({ "POSITION": 0 }); targets].into();
    }
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes)) }],
        "bufferViews": [{ "buffer": 0, "byteLength": positions.len() }, { "buffer": 0, "byteOffset": positions.len(), "byteLength": indices.len() }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": vertices, "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3 * triangles },
        ],
        "meshes": [{ "primitives": [primitive] }],
        "nodes": vec![json!({ "mesh": 0 }); nodes], "scenes": [{ "nodes": (0..nodes).collect::<Vec<_>>() }],
    })
    .to_string()
}

#[test]
fn the_memory_budget_is_a_flag_or_a_variable_and_names_itself() {
    let place = Place::with([("crowd.gltf", &crowd([1, 3, 1, 0]))]);
    let huge = fs::File::create(place.at("huge.glb")).unwrap();
    huge.set_len(600 << 20).unwrap();
    place.play(
        r"
        $ parts crowd.gltf --memory 2GiB
        $2 parts crowd.gltf --memory 1MiB
        ! --memory 1MiB: it must be at least 1280 MiB
        $2 parts crowd.gltf --memory 8
        ! --memory 8: it must be a number with a unit, for instance 8GiB or 1500MiB
        $2 RASTERLAB_MEMORY=much parts crowd.gltf
        ! RASTERLAB_MEMORY much: it must be a number with a unit
        # A built-in scene counts as a model does.
        $2 RASTERLAB_MEMORY=1280MiB parts builtin:sphere?triangles=100000000
        ! sphere: 100000000 triangles; allowed: at most 22369621 within the memory budget of 1280 MiB; raise it with --memory
        # Beyond the budget, beyond the flag.
        $2 RASTERLAB_MEMORY=1300MiB parts huge.glb
        ! within the memory budget of 1300 MiB; raise it with --memory
        ",
    );
}

#[test]
fn what_the_oracle_cannot_judge_is_not_measured_and_says_so() {
    let place = Place::new();
    for more in ["", "--axes visibility", "--every-effect"] {
        let line = "RASTERLAB_ORACLE_GIB=0.001 bench --scene sphere?triangles=20000 --size 64x48 --samples 2";
        let run = place.run(&format!("{line} {more}"));
        if run.code == 3 {
            return eprintln!("skipped: no adapter is here");
        }
        // Whole pictures are timed without it; a trade is nothing without its errors.
        let code = if more.contains("axes") { 2 } else { 0 };
        let words = [
            "and the oracle may take 0.001;",
            "set RASTERLAB_ORACLE_GIB",
            "no error is measured",
        ];
        let wanted = &words[..if code == 2 { 2 } else { 3 }];
        assert!(
            run.code == code && wanted.iter().all(|words| run.err.contains(words)),
            "{more}: {}: {}",
            run.code,
            run.err
        );
        assert!(!run.err.contains("panicked"), "{}", run.err);
    }
}

#[test]
fn a_scene_that_the_adapter_cannot_bind_names_its_buffer_and_its_limit() {
    let place = Place::new();
    let adapters = place.json("adapters --json");
    let most = adapters["results"][0]["limits"]["max_storage_binding_bytes"].as_u64();
    if most.is_none_or(|most| most > 128 << 20) {
        return eprintln!(
            "skipped: the first adapter binds more than the least that every adapter must, or there is none"
        );
    }
    place.play(
        r"
        $3 render builtin:sphere?triangles=12000000 --size 64x48 -o large.png
        ! the buffer index_bytes would take 144018432 bytes; this adapter binds at most 134217728; take another adapter, or fewer
        ",
    );
}

/// These models and presets are refused in these seconds, in one sentence, before anything is drawn.
/// Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
fn refuse_at_once(place: &Place, seconds: u64, cases: &[(&str, &str)]) {
    let began = Instant::now();
    for (line, wanted) in cases {
        let run = place.run(line);
        if run.code == 3 && !line.contains("CPU") {
            eprintln!("skipped without an adapter: {line}");
            continue;
        }
        assert!(
            run.code == 2 && wanted.split(" && ").all(|part| run.err.contains(part)),
            "{line}: {}: {}",
            run.code,
            run.err
        );
        assert!(
            run.errors() == 1 && !place.has("a.png"),
            "{line}: {}",
            run.err
        );
    }
    assert!(began.elapsed().as_secs() < seconds, "{:?}", began.elapsed());
}

#[test]
fn particles_that_the_oracle_would_follow_for_minutes_are_refused_in_a_moment() {
    let line = |count, time| {
        format!(
            "render builtin:chamber CPU8x6 -o a.png --set particles.octaves=6 --set particles.count={count} --set clock.time_s={time}"
        )
    };
    let cases = [(5000, 590), (4_000_000, 149)].map(|(count, time)| {
        let wanted = format!("would follow {count} particles over && or take a GPU");
        (line(count, time), wanted)
    });
    let cases = cases.each_ref().map(|(line, wanted)| (&**line, &**wanted));
    refuse_at_once(&Place::new(), 60, &cases);
}

#[test]
fn images_that_the_oracle_would_draw_for_minutes_are_refused_in_a_moment() {
    let look = "schema = 2\n[scene]\nbuiltin = \"stack?layers=1000&gap=0.001\"\n[accuracy]\nshadow_map_size = \"4096\"\n[effects.shadow]\n\
                [effects.boxes]\n[output]\nsize = [64, 48]\n";
    let smear = look
        .replace("1000", "60")
        .replace("[output]", "[effects.smear]\nframes = 32\n[output]");
    let crowd = crowd([1_000, 3, 100_000, 0]);
    let place = Place::with([
        ("look.toml", look),
        ("smear.toml", &smear),
        ("crowd.gltf", &crowd),
    ]);
    let shadows = "samples of triangles for the shadow map";
    let cases = [
        (
            "verify look.toml",
            "samples of triangles for the shadow map, and may test 2147483648; take a smaller shadow map",
        ),
        ("verify look.toml CPU", shadows),
        ("render look.toml CPU -o a.png", shadows),
        (
            "render CPU -o a.png builtin:stack?layers=1000 --size 6000x4000 --set boxes",
            "samples of triangles (pictures drawn one after the other: 1)",
        ),
        (
            "verify smear.toml CPU",
            "samples of triangles (pictures drawn one after the other: 33)",
        ),
        ("verify crowd.gltf", "GiB of memory"),
    ];
    refuse_at_once(&place, 60, &cases);
}

#[test]
fn a_picture_that_is_too_large_for_the_oracle_is_refused_in_a_moment() {
    let [crowd, throng] = [1_000, 10_000].map(|nodes| crowd([nodes, 3, 100_000, 0]));
    let place = Place::with([("crowd.gltf", &crowd), ("throng.gltf", &throng)]);
    let cases = [
        (
            "render facet CPU16384x16384 -o a.png",
            "the picture would take about 56.",
        ),
        (
            "render xray CPU16384x8192 -o a.png",
            "and the oracle may take 4;",
        ),
        (
            "render crowd.gltf CPU -o a.png",
            "draw it smaller or with fewer triangles, or set RASTERLAB_ORACLE_GIB",
        ),
        ("render throng.gltf CPU -o a.png", "GiB of memory"),
    ];
    refuse_at_once(&place, 40, &cases);
}

#[test]
fn morph_targets_times_nodes_are_bounded() {
    let place = Place::with([("chorus.gltf", &crowd([10_000, 3_000, 1, 256]))]);
    let wanted = "positions of vertices and morph targets, and may compute 4294967296";
    refuse_at_once(&place, 30, &[("render chorus.gltf CPU -o a.png", wanted)]);
}

#[test]
fn a_measurement_of_many_layers_reports_no_holes() {
    let place = Place::new();
    let run = place.run("bench --scene stack?layers=300 --size 256x192 --samples 2 --json");
    if run.code == 3 {
        return eprintln!("skipped: no adapter is here");
    }
    assert_eq!(run.code, 0, "{}", run.err);
    let rows = super::json(&run);
    assert_eq!(
        rows["results"][0]["triangles"], 600,
        "a scene alone is measured without ground"
    );
    let results = rows["results"].as_array().unwrap().iter();
    let promised: Vec<_> = results.filter(|row| row["is_promised"] == true).collect();
    assert!(!promised.is_empty(), "{rows}");
    for row in promised {
        for figure in ["holes", "double_hits", "wrong_triangles"] {
            assert_eq!(row["error"][figure], 0, "{figure}: {row}");
        }
    }
}
