//! Promise: stdout carries data only, exit codes mean what they say, nothing is overwritten
//! unasked, a closed pipe is no error.

mod arrays;
mod effects;
mod faults;
mod files_kept;
mod films;
mod limits;
mod links;
mod looks;
mod manual;
mod parts;
mod review;
mod sequences;
mod sweeps;
mod toward;

use std::{
    fs,
    io::{Read as _, Write as _},
    path::Path,
    process::{Command, Output, Stdio},
};

use serde_json::Value;

/// The program in a clean world: no environment of ours, no presets of the person's own.
fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterlab"));
    command
        .current_dir(folder)
        .env_remove("RASTERLAB_ADAPTER")
        .env_remove("RASTERLAB_PRESETS")
        .env_remove("RASTERLAB_MEMORY");
    command
        .env("XDG_CONFIG_HOME", folder.join("config"))
        .env("APPDATA", folder.join("config"))
        .env("HOME", folder);
    command
}

struct Run {
    code: i32,
    out: String,
    err: String,
    bytes: Vec<u8>,
}

fn finished(output: Output) -> Run {
    Run {
        code: output.status.code().expect("the program ends by itself"),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
        bytes: output.stdout,
    }
}

fn run_in(folder: &Path, args: &[&str]) -> Run {
    finished(
        command(folder)
            .args(args)
            .stdin(Stdio::null())
            .output()
            .expect("the program starts"),
    )
}

fn run(args: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), args)
}

fn piped(folder: &Path, args: &[&str], text: &str) -> Run {
    let mut child = command(folder)
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(text.as_bytes())
        .unwrap();
    finished(child.wait_with_output().unwrap())
}

fn json(run: &Run) -> Value {
    let object: Value = serde_json::from_str(&run.out)
        .unwrap_or_else(|e| panic!("stdout is not one JSON object: {e}\n{}", run.out));
    assert_eq!(object["schema"], 2);
    object
}

#[test]
fn list_shows_presets_effects_and_ranges_on_stdout_alone() {
    let list = run(&["list"]);
    assert_eq!((list.code, list.err.as_str()), (0, ""));
    for wanted in [
        "facet-sweep",
        "Half cut",
        "facet.amount",
        "0..=1",
        "uniform | sweep | radial | random",
        "teapot",
        "?tess",
        "built in",
    ] {
        assert!(
            list.out.contains(wanted),
            "{wanted:?} is missing in\n{}",
            list.out
        );
    }
    let axes = run(&["list", "axes"]).out;
    assert!(
        axes.contains("accuracy.coverage")
            && axes.contains("float-top-left")
            && !axes.contains("lambert.sun")
    );
    let effects = run(&["list", "effects"]).out;
    assert!(effects.contains("lambert.sun") && !effects.contains("Half cut"));
}

#[test]
fn list_as_json_has_every_preset_and_effect() {
    let object = json(&run(&["list", "--json"]));
    assert_eq!(object["command"], "list");
    let of_kind = |kind: &str| {
        object["results"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|r| r["kind"] == kind)
            .map(|r| r["id"].clone())
            .collect::<Vec<_>>()
    };
    for effect in rasterlab::effects::EFFECTS.iter() {
        assert!(
            of_kind("effect").contains(&effect.name.clone().into())
                && of_kind("preset").contains(&effect.name.clone().into())
        );
    }
    let preset_files = object["results"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|r| r["kind"] == "preset");
    preset_files.for_each(|preset_file| assert_eq!(preset_file["warnings"], Value::Array(vec![])));
}

#[test]
fn list_shows_which_preset_shadows_which() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("facet.toml"),
        "schema = 2\nname = \"Mine\"\n",
    )
    .unwrap();
    let list = run_in(folder.path(), &["list", "presets", "--presets", "."]);
    assert!(
        list.out.contains("--presets, shadows built in"),
        "{}",
        list.out
    );
}

#[test]
fn adapters_always_end_with_cpu() {
    let adapters = run(&["adapters"]);
    assert_eq!(adapters.code, 0);
    assert!(
        adapters.out.lines().last().unwrap().starts_with("cpu "),
        "{}",
        adapters.out
    );
    let object = json(&run(&["adapters", "--json"]));
    assert_eq!(
        object["results"].as_array().unwrap().last().unwrap()["name"],
        "cpu"
    );
}

#[test]
fn usage_errors_exit_with_2_and_leave_stdout_empty() {
    let cases: [&[&str]; 20] = [
        &["--no-such-flag"],
        &["--log", "no-such-folder/window.log"],
        &["--log", "window.log", "list"],
        &["render"],
        &["render", "fascet", "--adapter", "cpu"],
        &["render", "facet", "--adapter", "cpu", "--size", "10"],
        &["render", "facet", "--adapter", "cpu", "--size", "20000x1"],
        &[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--set",
            "facet.amount=2",
        ],
        &[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--set",
            "facet.amuont=1",
        ],
        &["render", "facet", "--adapter", "cpu", "--tier", "sloppy"],
        &["render", "facet", "--adapter", "cpu", "-o", "{frame}.png"],
        &[
            "render",
            "facet",
            "depth",
            "--adapter",
            "cpu",
            "-o",
            "one.png",
        ],
        &["render", "absent.toml", "--adapter", "cpu"],
        &["render", "builtin:no-such-scene", "--adapter", "cpu"],
        &["verify", "facet", "--adapter", "cpu", "--frames", "0"],
        &["bench", "--adapter", "cpu"],
        &["stress", "--adapter", "cpu"],
        &["stress", "--filter", "no-such-case"],
        &["bless", "facet", "--adapter", "cpu"],
        &["facet", "list"],
    ];
    for args in cases {
        let run = run(args);
        assert_eq!(
            (run.code, run.out.as_str()),
            (2, ""),
            "{args:?}\n{}",
            run.err
        );
        assert!(
            run.err.contains("error: "),
            "{args:?} says nothing: {}",
            run.err
        );
    }
}

#[test]
fn a_folder_of_presets_that_is_not_there_is_named() {
    for args in [
        &["list", "presets"][..],
        &["check", "facet"],
        &["render", "facet", "--adapter", "cpu"],
    ] {
        let run = run(&[args, &["--presets", "absent"]].concat());
        assert_eq!(run.code, 2, "{args:?}");
        assert!(run.err.contains("there is no folder absent"), "{}", run.err);
    }
}

#[test]
fn what_no_adapter_could_draw_is_wrong_usage_from_check_on() {
    for (preset, set) in [
        ("facet", &["accuracy.tier=strict", "wobble"][..]),
        (
            "facet",
            &["accuracy.coverage=float", "accuracy.depth=integer"],
        ),
        ("walk-dissolve", &["accuracy.position_format=packed10"]),
    ] {
        let sets: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let check = run(&[&["check", preset], &sets[..]].concat());
        assert_eq!(check.code, 2, "{set:?}: {}", check.out);
        assert!(check.out.contains("FAIL"), "{}", check.out);
        // On an adapter, too, if one is here: another one would not help.
        let render = run(&[
            &["render", preset, "--size", "8x6", "-o", "{preset}.png"],
            &sets[..],
        ]
        .concat());
        assert!(
            render.code == 2 || render.err.contains("no adapter"),
            "{set:?}: {}: {}",
            render.code,
            render.err
        );
    }
    assert_eq!(
        run(&["check"]).code,
        0,
        "every preset of the gallery has a kernel"
    );
}

#[test]
fn a_model_that_breaks_its_standard_loads_and_strictness_refuses_it() {
    let folder = tempfile::tempdir().unwrap();
    let model = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},{"children":[0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    fs::write(folder.path().join("m.gltf"), model).unwrap();
    let render = |extra: &[&str]| {
        run_in(
            folder.path(),
            &[
                &["render", "m.gltf", "--adapter", "cpu", "--size", "8x6"],
                extra,
            ]
            .concat(),
        )
    };
    let drawn = render(&[]);
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    assert_eq!(
        drawn.err.matches("must list root nodes only").count(),
        1,
        "{}",
        drawn.err
    );
    let refused = render(&["--strict", "--force"]);
    assert!(
        refused.code == 2 && refused.err.contains("must list root nodes only"),
        "{}",
        refused.err
    );
}

#[test]
fn a_preset_is_found_by_its_id_and_else_by_its_name_in_any_case() {
    let folder = tempfile::tempdir().unwrap();
    for (id, name) in [
        ("mine", "First light"),
        ("facet", "Second light"),
        ("other", "second light"),
        ("third", "mine"),
    ] {
        let text = format!(
            "schema = 2\nname = \"{name}\"\n[scene]\nbuiltin = \"teapot?tess=2\"\n[effects.facet]\n"
        );
        fs::write(folder.path().join(format!("{id}.toml")), text).unwrap();
    }
    let render = |name: &str| {
        let args = [
            "render",
            name,
            "--presets",
            ".",
            "--adapter",
            "cpu",
            "--size",
            "8x6",
            "--json",
            "--force",
        ];
        run_in(folder.path(), &args)
    };
    for (name, id) in [
        ("First light", "mine"),
        ("FIRST LIGHT", "mine"),
        ("Third", "third"),
        ("mine", "mine"),
        ("cel", "toon"),
    ] {
        let drawn = render(name);
        assert_eq!(
            (drawn.code, &json(&drawn)["results"][0]["preset"]),
            (0, &Value::from(id)),
            "{name}: {}",
            drawn.err
        );
    }
    for (name, ids) in [("SECOND LIGHT", "facet, other"), ("Mine", "mine, third")] {
        let refused = render(name);
        let wanted = format!("several presets are called {name:?}: {ids}; give the id of one");
        assert!(
            refused.code == 2 && refused.err.contains(&wanted),
            "{}",
            refused.err
        );
    }
}

#[test]
fn errors_suggest_what_was_meant() {
    assert!(
        run(&["render", "fascet", "--adapter", "cpu"])
            .err
            .contains("did you mean \"facet\" (Half cut)?")
    );
    let near_name = run(&["render", "Coperplate", "--adapter", "cpu"]);
    assert!(
        near_name.code == 2
            && near_name
                .err
                .contains("did you mean \"hero-etching\" (Copperplate)?"),
        "{}",
        near_name.err
    );
    assert!(
        run(&[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--set",
            "facet.amuont=1"
        ])
        .err
        .contains("did you mean \"amount\"?")
    );
    assert!(
        run(&[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--set",
            "facet.amount=2"
        ])
        .err
        .contains("lies outside 0..=1")
    );
}

#[test]
#[cfg(feature = "gui")]
fn a_mistyped_command_is_named_and_opens_no_window() {
    let run = run(&["verfy"]);
    assert_eq!(run.code, 2);
    assert!(run.err.contains("did you mean \"verify\"?"), "{}", run.err);
}

#[test]
fn an_unknown_adapter_exits_with_3_and_points_to_cpu() {
    let run = run(&["render", "facet", "--adapter", "no such adapter"]);
    assert_eq!((run.code, run.out.as_str()), (3, ""), "{}", run.err);
    assert!(run.err.contains("adapter"), "{}", run.err);
}

#[test]
fn errors_as_json_have_code_message_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("bad.toml"),
        "schema = 2\n\n[effects.facet]\namount = 3\n",
    )
    .unwrap();
    let run = run_in(
        folder.path(),
        &["render", "bad.toml", "--adapter", "cpu", "--json"],
    );
    let error = &json(&run)["errors"][0];
    assert_eq!(
        (run.code, &error["code"], &error["file"], &error["line"]),
        (2, &2.into(), &"bad.toml".into(), &4.into())
    );
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("amount 3 lies outside 0..=1")
    );
}

#[test]
fn render_on_the_cpu_writes_a_picture_that_restores_its_preset() {
    let folder = tempfile::tempdir().unwrap();
    let first = run_in(
        folder.path(),
        &[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--size",
            "48x36",
            "--set",
            "facet.amount=.25",
            "-o",
            "{preset}_{n:2}.png",
        ],
    );
    assert_eq!(
        (first.code, first.out.as_str()),
        (0, "facet_01.png\n"),
        "{}",
        first.err
    );
    assert!(first.err.contains("adapter: cpu"));
    let again = run_in(
        folder.path(),
        &[
            "render",
            "facet_01.png",
            "--adapter",
            "cpu",
            "--json",
            "-o",
            "b.png",
        ],
    );
    assert_eq!(again.code, 0, "{}", again.err);
    let result = &json(&again)["results"][0];
    assert_eq!(result["size"], serde_json::json!([48, 36]));
    assert!(result["covered"].as_u64().unwrap() > 100);
    let same = run_in(
        folder.path(),
        &["compare", "facet_01.png", "b.png", "--max-channel", "0"],
    );
    assert_eq!(same.code, 0, "{}", same.out);
}

#[test]
fn the_same_preset_gives_the_same_bytes() {
    let args = [
        "render",
        "facet-random",
        "--adapter",
        "cpu",
        "--size",
        "40x30",
        "-o",
        "-",
        "--quiet",
    ];
    let (a, b) = (run(&args), run(&args));
    assert_eq!((a.code, a.err.as_str()), (0, ""));
    assert!(a.bytes.starts_with(b"\x89PNG") && a.bytes == b.bytes);
}

/// A preset that turns while a front crosses it.
const MOVING: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\nspin_deg_per_s = 90.0\n[clock]\nrange_s = [0.0, 1.0]\n\
    [effects.facet]\n[effects.lambert]\n[animation.facet]\namount = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n\
    [output]\nsize = [24, 18]\n";

/// A folder with the moving preset as `move.toml`.
fn studio() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("move.toml"), MOVING).unwrap();
    folder
}

/// Draws eight frames a second into `f_{frame:3}.png`.
fn sequence(folder: &Path, extra: &[&str]) -> Run {
    let args = [
        "sequence",
        "move.toml",
        "-o",
        "f_{frame:3}.png",
        "--fps",
        "8",
        "--adapter",
        "cpu",
    ];
    run_in(folder, &[&args[..], extra].concat())
}

fn frames(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = files.filter(|name| name.ends_with(".png")).collect();
    names.sort();
    names
        .into_iter()
        .map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap()))
        .collect()
}

#[test]
fn a_film_shows_the_frames() {
    let folder = studio();
    let drawn = sequence(folder.path(), &["--apng", "film.apng"]);
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    let bytes = fs::read(folder.path().join("film.apng")).unwrap();
    let mut film = png::Decoder::new(std::io::Cursor::new(&bytes))
        .read_info()
        .unwrap();
    let control = *film.info().animation_control().expect("an animated PNG");
    assert_eq!(
        (control.num_frames, control.num_plays),
        (8, 0),
        "it loops as the preset does"
    );
    for i in 0..8 {
        let mut pixels = vec![0; film.output_buffer_size().unwrap()];
        film.next_frame(&mut pixels).unwrap();
        let control = film.info().frame_control().unwrap();
        assert_eq!((control.delay_num, control.delay_den), (1, 8));
        let (frame, _) =
            rasterlab::preset_file::png_pixels(&folder.path().join(format!("f_{i:03}.png")))
                .unwrap();
        assert_eq!(pixels, frame.concat(), "frame {i}");
    }
    assert!(rasterlab::preset_file::preset_from_png(&bytes, "film").is_ok());
    // The film is the same with and without frame files.
    fs::remove_file(folder.path().join("film.apng")).unwrap();
    assert!(
        sequence(folder.path(), &["--apng", "film.apng"])
            .err
            .contains("0 frames drawn, 8 kept")
    );
    let alone = studio();
    let args = [
        "sequence",
        "move.toml",
        "--apng",
        "film.apng",
        "--fps",
        "8",
        "--adapter",
        "cpu",
    ];
    assert_eq!(run_in(alone.path(), &args).code, 0);
    for other in [&folder, &alone] {
        assert!(fs::read(other.path().join("film.apng")).unwrap() == bytes);
    }
    assert!(
        run_in(alone.path(), &args).err.contains("0 frames drawn"),
        "a finished film is kept"
    );
    let other = run_in(
        alone.path(),
        &[&args[..], &["--fps", "4"][..]]
            .concat()
            .into_iter()
            .filter(|a| *a != "8")
            .collect::<Vec<_>>(),
    );
    assert!(other.code == 2, "{}", other.err);
}

#[test]
fn a_film_that_stands_still_shows_the_moment_of_its_preset() {
    let folder = studio();
    let text = MOVING.replace("[clock]\n", "[clock]\ntime_s = 0.5\n");
    fs::write(folder.path().join("move.toml"), text).unwrap();
    let drawn = sequence(folder.path(), &["--apng", "film.apng"]);
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    let film = fs::File::open(folder.path().join("film.apng")).unwrap();
    let mut film = png::Decoder::new(std::io::BufReader::new(film))
        .read_info()
        .unwrap();
    assert_eq!(film.info().animation_control().unwrap().num_frames, 8);
    let mut pixels = vec![0; film.output_buffer_size().unwrap()];
    film.next_frame(&mut pixels).unwrap();
    assert!(film.info().frame_control().is_none(), "it is no frame");
    let frame = |name| rasterlab::preset_file::png_pixels(&folder.path().join(name)).unwrap();
    assert_eq!(pixels, frame("f_004.png").0.concat());
    film.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, frame("f_000.png").0.concat());
}

#[test]
fn frames_of_another_preset_are_overwritten_with_force_alone() {
    let folder = studio();
    sequence(folder.path(), &[]);
    let changed = ["--set", "lambert.headlight=0.5"];
    let refused = sequence(folder.path(), &changed);
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("f_000.png exists and is no frame of this preset, as do 7 more files; use --force to overwrite"),
        "{}",
        refused.err
    );
    let forced = sequence(folder.path(), &[&changed[..], &["--force"]].concat());
    assert!(
        forced.err.contains("8 frames drawn, 0 kept"),
        "{}",
        forced.err
    );
    fs::remove_file(folder.path().join("f_000.png")).unwrap();
    let resumed = sequence(folder.path(), &[&changed[..], &["--force"]].concat());
    assert!(
        resumed.err.contains("1 frame drawn, 7 kept"),
        "force draws no finished frame again: {}",
        resumed.err
    );
    fs::write(folder.path().join("f_000.png"), "precious").unwrap();
    assert_eq!(sequence(folder.path(), &changed).code, 2);
    // What decides no picture makes no frame stale.
    fs::remove_file(folder.path().join("f_000.png")).unwrap();
    let renamed = sequence(
        folder.path(),
        &[&changed[..], &["--set", "name=Other"]].concat(),
    );
    assert!(
        renamed.err.contains("1 frame drawn, 7 kept"),
        "{}",
        renamed.err
    );
}

#[test]
fn every_command_draws_the_preset_at_its_time() {
    let folder = studio();
    let held =
        MOVING.split("[animation").next().unwrap().to_owned() + "[output]\nsize = [24, 18]\n";
    fs::write(
        folder.path().join("held.toml"),
        held.replace("[effects.facet]\n", "[effects.facet]\namount = 0.5\n"),
    )
    .unwrap();
    let at = ["--set", "clock.time_s=0.5", "--adapter", "cpu"];
    let same = run_in(
        folder.path(),
        &[
            &["compare", "move.toml", "held.toml", "--max-channel", "0"],
            &at[..],
        ]
        .concat(),
    );
    assert_eq!(same.code, 0, "{}", same.out);
    for preset_file in ["move.toml", "held.toml"] {
        let out = format!("{preset_file}.png");
        assert_eq!(
            run_in(
                folder.path(),
                &[&["render", preset_file, "--bare", "-o", &out], &at[..]].concat()
            )
            .code,
            0
        );
        assert_eq!(
            run_in(folder.path(), &[&["verify", preset_file], &at[..]].concat()).code,
            0,
            "{preset_file}"
        );
    }
    let [moving, held] =
        ["move.toml.png", "held.toml.png"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(moving == held);
}

#[test]
fn a_bare_picture_carries_no_text() {
    let bare = run(&[
        "render",
        "facet",
        "--adapter",
        "cpu",
        "--size",
        "16x16",
        "--bare",
        "-o",
        "-",
    ]);
    let full = run(&[
        "render",
        "facet",
        "--adapter",
        "cpu",
        "--size",
        "16x16",
        "-o",
        "-",
    ]);
    let has_text = |bytes: &[u8]| bytes.windows(4).any(|chunk| chunk == b"iTXt");
    assert_eq!(
        (has_text(&bare.bytes), has_text(&full.bytes)),
        (false, true)
    );
}

#[test]
fn a_preset_comes_from_stdin() {
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.normals]\n[output]\nsize = [20, 10]\n";
    let run = piped(
        folder.path(),
        &["render", "-", "--adapter", "cpu", "-o", "-"],
        text,
    );
    assert_eq!(run.code, 0, "{}", run.err);
    assert_eq!(&run.bytes[16..24], [0, 0, 0, 20, 0, 0, 0, 10]);
    let wrong = piped(
        folder.path(),
        &["render", "-", "--adapter", "cpu"],
        "schema = 2\nnmae = 1\n=\n",
    );
    assert!(
        wrong.code == 2 && wrong.err.contains("stdin:3:"),
        "{}",
        wrong.err
    );
}

#[test]
fn nothing_is_overwritten_without_force() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("a.png");
    fs::write(&target, "precious").unwrap();
    let args = [
        "render",
        "lambert",
        "--adapter",
        "cpu",
        "--size",
        "8x8",
        "-o",
        "a.png",
    ];
    let refused = run_in(folder.path(), &args);
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .err
            .contains("a.png exists; use --force to overwrite it"),
        "{}",
        refused.err
    );
    assert_eq!(fs::read(&target).unwrap(), b"precious");
    assert_eq!(
        run_in(folder.path(), &[&args[..], &["--force"]].concat()).code,
        0
    );
    assert!(fs::read(&target).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = tempfile::tempdir().unwrap();
    for args in [
        &["list", "--json"][..],
        &["completions", "bash"],
        &["render", "facet", "--adapter", "cpu", "-o", "-"],
    ] {
        let mut child = command(folder.path())
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let mut err = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut err)
            .unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{args:?}: {err}");
        assert!(
            !err.contains("panicked") && !err.contains("error"),
            "{args:?}: {err}"
        );
    }
}

#[test]
fn the_oracle_agrees_with_itself_on_shadows() {
    let run = run(&[
        "verify",
        "shadow-soft",
        "--size",
        "64x48",
        "--adapter",
        "cpu",
    ]);
    assert_eq!(run.code, 0, "{}", run.err);
}

#[test]
fn the_oracle_agrees_with_itself() {
    let verify = run(&[
        "verify",
        "facet-radial",
        "depth",
        "--adapter",
        "cpu",
        "--size",
        "64x48",
        "--frames",
        "2",
        "--json",
    ]);
    assert_eq!(verify.code, 0, "{}", verify.err);
    let object = json(&verify);
    assert_eq!(object["results"].as_array().unwrap().len(), 2);
    for row in object["results"].as_array().unwrap() {
        for figure in [
            "wrong_triangles",
            "explained_by_snap",
            "holes",
            "double_hits",
            "depth_without_id",
            "overflow",
            "max_color_delta",
        ] {
            assert_eq!(row[figure], 0, "{figure} of {row}");
        }
        assert_eq!(
            (&row["rms_color_delta"], &row["ok"], &row["class"]),
            (&0.0.into(), &true.into(), &"oracle".into())
        );
    }
}

#[test]
fn compare_exits_with_1_beyond_the_budget_and_0_within() {
    let folder = tempfile::tempdir().unwrap();
    let compare = |extra: &[&str]| {
        run_in(
            folder.path(),
            &[
                &[
                    "compare",
                    "facet",
                    "teapot",
                    "--adapter",
                    "cpu",
                    "--size",
                    "64x48",
                ],
                extra,
            ]
            .concat(),
        )
    };
    let over = compare(&["-o", "diff.png"]);
    assert_eq!(over.code, 1);
    assert!(over.out.contains("FAIL") && folder.path().join("diff.png").exists());
    assert_eq!(
        compare(&["--max-channel", "255", "--max-wrong-triangles", "99999"]).code,
        0
    );
    assert_eq!(
        compare(&["--max-pixels", "99999"]).code,
        1,
        "triangle ids have a budget of their own"
    );
    assert_eq!(
        run(&[
            "compare",
            "facet",
            "facet",
            "--adapter",
            "cpu",
            "--size",
            "32x32"
        ])
        .code,
        0
    );
}

#[test]
fn check_finds_every_bad_preset_and_lists_all() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("good.toml", "schema = 2\n[effects.lambert]\n");
    write("typo.toml", "schema = 2\n[effects.lambert]\nsnu = 1\n");
    write("range.toml", "schema = 2\n[effects.facet]\namount = 7\n");
    write(
        "lost.toml",
        "schema = 2\n[scene]\npath = \"../absent.glb\"\n",
    );
    let loose = run_in(folder.path(), &["check", "good.toml", "typo.toml"]);
    assert_eq!(loose.code, 0, "{}", loose.out);
    assert!(
        loose
            .err
            .contains("typo.toml:3: unknown key effects.lambert.snu; did you mean \"sun\"?"),
        "{}",
        loose.err
    );
    let strict = run_in(
        folder.path(),
        &[
            "check",
            "--strict",
            "good.toml",
            "typo.toml",
            "range.toml",
            "lost.toml",
        ],
    );
    assert_eq!(strict.code, 2);
    for wanted in [
        "ok    good",
        "FAIL  typo",
        "range.toml:3: effects.facet.amount 7 lies outside 0..=1",
        "absent.glb of the preset does not exist",
    ] {
        assert!(
            strict.out.contains(wanted),
            "{wanted:?} is missing in\n{}",
            strict.out
        );
    }
}

#[test]
fn bless_draws_what_check_then_accepts() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("presets")).unwrap();
    let preset_file = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.facet]\n[effects.lambert]\n[output]\nsize = [64, 48]\n[test]\n";
    fs::write(folder.path().join("presets/mine.toml"), preset_file).unwrap();
    let go = |args: &[&str]| run_in(folder.path(), args);
    let check = ["check", "presets/mine.toml", "--render", "--adapter", "cpu"];
    let missing = go(&check);
    assert!(
        missing.code == 1 && missing.out.contains("mine.png is missing"),
        "{}",
        missing.out
    );
    assert_eq!(go(&["bless", "--all", "--dry-run"]).code, 1);
    assert!(
        !folder.path().join("tests").exists(),
        "a dry run writes nothing"
    );
    let first = go(&["bless", "--all"]);
    assert!(
        first.code == 0 && first.out.contains("mine: new"),
        "{}{}",
        first.out,
        first.err
    );
    assert_eq!(go(&["bless", "--all", "--dry-run"]).code, 0);
    let passed = go(&[&check[..], &["--report", "r.html"]].concat());
    assert_eq!(passed.code, 0, "{}", passed.out);
    let report = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(report.contains("data:image/png;base64,") && !report.contains("{{"));
    fs::write(
        folder.path().join("presets/mine.toml"),
        preset_file.replace("[effects.facet]\n", "[effects.facet]\namount = 0.2\n"),
    )
    .unwrap();
    let changed = go(&check);
    assert!(
        changed.code == 1 && changed.out.contains("pixels differ from the golden"),
        "{}",
        changed.out
    );
    assert!(
        go(&["bless", "mine"])
            .out
            .contains("pixels change, at most by")
    );
}

#[test]
fn a_golden_lies_beside_its_preset_or_with_those_of_the_tests() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[output]\nsize = [64, 48]\n[test]\n";
    fs::create_dir(folder.path().join("mine")).unwrap();
    for name in ["mine/one.toml", "two.toml"] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let go = |args: &[&str]| run_in(folder.path(), args);
    let check = |name: &str| go(&["check", name, "--render", "--adapter", "cpu"]).code;
    assert_eq!(go(&["bless", "mine/one.toml"]).code, 0);
    assert!(folder.path().join("mine/snapshots/one.png").exists() && check("mine/one.toml") == 0);
    fs::create_dir_all(folder.path().join("tests/snapshots")).unwrap();
    assert_eq!(go(&["bless", "two.toml"]).code, 0);
    assert!(folder.path().join("tests/snapshots/two.png").exists() && check("two.toml") == 0);
    assert!(
        check("mine/one.toml") == 0,
        "the folder beside the preset comes first"
    );
    assert_eq!(go(&["bless", "two.toml", "--snapshots", "asked"]).code, 0);
    assert!(folder.path().join("asked/two.png").exists());
    assert_eq!(go(&["bless", "absent.toml"]).code, 2);
}

#[test]
fn bless_finds_what_every_command_finds() {
    let folder = tempfile::tempdir().unwrap();
    let go = |args: &[&str]| run_in(folder.path(), args);
    assert_eq!(go(&["new-effect", "ink"]).code, 0);
    // The folder of presets is made with the first one.
    assert_eq!(go(&["new-effect", "wash"]).code, 0);
    assert_eq!(go(&["bless", "wash"]).code, 0);
    assert_eq!(
        go(&["check", "wash", "--render", "--adapter", "cpu"]).code,
        0
    );
    let text = "schema = 2\nname = \"Inked\"\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.ink]\n[output]\nsize = [64, 48]\n[test]\n";
    fs::write(folder.path().join("presets/inked.toml"), text).unwrap();
    for args in [
        &["bless", "inked"][..],
        &["bless", "Inked", "--dry-run"],
        &["check", "inked", "--render", "--adapter", "cpu"],
        &["verify", "inked", "--adapter", "cpu"],
        &["render", "inked", "--adapter", "cpu"],
    ] {
        let run = go(args);
        assert_eq!(run.code, 0, "{args:?}: {}{}", run.out, run.err);
    }
    assert!(
        go(&["list", "presets"])
            .out
            .contains("the folder presets here")
    );
    // A preset without a test gets one in its file, since it was named.
    fs::write(
        folder.path().join("bare.toml"),
        text.replace("[test]\n", ""),
    )
    .unwrap();
    assert_eq!(go(&["bless", "bare.toml"]).code, 0);
    let tested = rasterlab::preset_file::load_with(
        &folder.path().join("bare.toml"),
        &rasterlab::effect_files::Catalog::of_folders([&*folder.path().join("effects")]),
    );
    assert!(tested.is_ok_and(|tested| tested.preset.test.is_some()));
    // An effect without a preset gets its first one.
    let blessed = go(&["bless", "ink"]);
    assert_eq!(blessed.code, 0, "{}", blessed.err);
    assert!(
        blessed.out.contains("(its preset is created, too)"),
        "{}",
        blessed.out
    );
    let first = rasterlab::preset_file::load_with(
        &folder.path().join("presets/ink.toml"),
        &rasterlab::effect_files::Catalog::of_folders([&*folder.path().join("effects")]),
    );
    assert!(first.is_ok_and(|first| first.preset.test.is_some()));
    let checked = go(&["check", "ink", "--render", "--adapter", "cpu"]);
    assert_eq!(checked.code, 0, "{}{}", checked.out, checked.err);
    let unknown = go(&["bless", "no-such-effect"]);
    assert!(
        unknown.code == 2 && unknown.err.contains("no preset and no effect"),
        "{}",
        unknown.err
    );
}

#[test]
fn a_mistyped_command_is_one_sentence_with_the_command_that_was_meant() {
    for args in [&["rendr"][..], &["rendr", "fox.glb", "-o", "x.png"]] {
        let run = run(args);
        assert!(
            run.code == 2 && run.err.contains("did you mean \"render\""),
            "{args:?}: {}",
            run.err
        );
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
    }
}

#[test]
fn a_color_may_be_written_as_on_a_screen() {
    let colors = |color: &str| {
        let set = format!("output.background={color}");
        let folder = tempfile::tempdir().unwrap();
        let run = run_in(
            folder.path(),
            &[
                "render",
                "facet",
                "--adapter",
                "cpu",
                "--size",
                "8x8",
                "-o",
                "x.png",
                "--set",
                &set,
            ],
        );
        (
            run.code,
            run.err,
            rasterlab::preset_file::png_pixels(&folder.path().join("x.png")).ok(),
        )
    };
    let (code, err, pixels) = colors("#3366cc");
    assert_eq!(code, 0, "{err}");
    assert_eq!(
        pixels.map(|(pixels, _)| pixels[0]),
        Some([0x33, 0x66, 0xcc, 255])
    );
    let (code, err, _) = colors("#3366c");
    assert!(code == 2 && err.contains("write #rrggbb"), "{err}");
}

#[test]
fn stress_lists_its_cases_without_an_adapter() {
    let list = run(&["stress", "--list"]);
    assert_eq!((list.code, list.err.as_str()), (0, ""));
    let lines: Vec<_> = list.out.lines().collect();
    assert!(lines[0].starts_with("NAME ") && lines[0].ends_with("WHAT"));
    assert_eq!(lines.len(), 1 + rasterlab::extremes::names(None).len());
    let one = run(&["stress", "--list", "--filter", "d3d-rect"]).out;
    assert!(
        one.lines().count() == 2 && one.contains("25 pixels"),
        "{one}"
    );
}

#[test]
fn stress_says_what_it_expected_and_what_became_of_it() {
    if std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip") {
        eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
        return;
    }
    let table = run(&["stress", "--filter", "d3d-rectangle"]);
    assert_eq!(table.code, 0, "{}", table.err);
    let lines: Vec<_> = table
        .out
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>())
        .collect();
    assert_eq!(lines[0], ["NAME", "OUTCOME", "PICTURES", "TRIANGLES", "MS"]);
    assert_eq!(lines[1][..2], ["d3d-rectangle", "passed"]);
    assert!(
        table.err.contains("adapter: ")
            && table.err.contains("1 case in ")
            && table.err.contains("0 failed"),
        "{}",
        table.err
    );

    let refused = run(&[
        "stress",
        "--filter",
        "too-many-layers-of-glass",
        "--json",
        "--quiet",
    ]);
    assert_eq!(refused.code, 0, "{}", refused.err);
    let object = json(&refused);
    assert_eq!(object["command"], "stress");
    assert!(object["adapter"]["name"].is_string());
    let result = &object["results"][0];
    assert_eq!(result["name"], "too-many-layers-of-glass");
    assert_eq!(result["outcome"], "refused as expected");
    assert!(
        result["why"]
            .as_str()
            .is_some_and(|why| why.contains("layers of glass, the most")),
        "{result}"
    );
    assert!(result["ms"].as_f64().is_some_and(|ms| ms > 0.0), "{result}");
}

#[test]
fn explain_describes_a_preset_without_an_adapter() {
    let explained = run(&["explain", "facet", "--adapter", "cpu"]);
    assert_eq!(explained.code, 0, "{}", explained.err);
    assert!(
        explained.out.contains("facet (surface), lambert (surface)"),
        "{}",
        explained.out
    );
}

#[test]
fn explain_measures_the_frame_and_its_passes_when_asked() {
    if std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip") {
        return eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
    }
    let asked = [
        "explain",
        "facet",
        "--size",
        "64x48",
        "--quiet",
        "--measure",
    ];
    let measured = run(&[&asked[..], &["--json"]].concat());
    let times = &json(&measured)["results"][0]["times"];
    assert!(
        times["whole_ms"].as_f64().is_some_and(|ms| ms > 0.0)
            && times["frames"].as_u64().is_some_and(|frames| frames > 2),
        "{times}"
    );
    let passes = times["passes"].as_array().expect("a list");
    let is_timed = |pass: &Value| {
        pass[0].as_str().is_some_and(|label| !label.is_empty())
            && pass[1].as_f64().is_some_and(|ms| ms >= 0.0)
    };
    assert!(passes.iter().all(is_timed), "{times}");
    assert!(
        run(&asked).out.contains(" ms, measured in "),
        "the time of the frame"
    );
    let unasked = run(&["explain", "facet", "--size", "64x48", "--quiet", "--json"]);
    assert!(
        json(&unasked)["results"][0]["times"].is_null(),
        "{}",
        unasked.out
    );
}

#[test]
fn a_picture_of_no_pixels_is_a_sentence() {
    let run = run(&["render", "facet", "--adapter", "cpu", "--size", "0x10"]);
    assert!(
        run.code == 2 && run.err.contains("each 1 to 16384"),
        "{}",
        run.err
    );
}

#[test]
fn completions_name_every_command() {
    let script = run(&["completions", "bash"]).out;
    for name in [
        "list",
        "adapters",
        "render",
        "sequence",
        "verify",
        "compare",
        "explain",
        "bless",
        "bench",
        "check",
        "completions",
    ] {
        assert!(script.contains(name), "{name}");
    }
}

#[test]
fn help_and_version_go_to_stdout() {
    let version = run(&["--version"]);
    assert_eq!(
        (version.code, version.out.trim()),
        (0, concat!("rasterlab ", env!("CARGO_PKG_VERSION")))
    );
    assert!(run(&["render", "--help"]).out.contains("--bare"));
    assert!(run(&["--help"]).out.contains("Exit codes: 0 done"));
}
