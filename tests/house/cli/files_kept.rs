//! Promise: no file is lost: what is not ours is never overwritten, drawing at once never takes a
//! name twice, and pipes, devices and unfinished files are left alone or refused in words.

use rasterlab::preset_file::{FrameStatus, frame_status};

use super::*;

/// Bytes of a PNG's signature and its first chunk.
const AFTER_HEADER: usize = 33;

/// A PNG of 2x2 pixels that some other program made.
fn foreign() -> Vec<u8> {
    rasterlab::preset_file::png_bytes(&[[9, 8, 7, 255]; 4], [2, 2]).unwrap()
}

/// `png` with one more chunk in front of its end.
fn with_chunk(png: &[u8], name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    with_chunk_at(png, png.len() - 12, name, data)
}

fn with_chunk_at(png: &[u8], at: usize, name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let (body, end) = png.split_at(at);
    let mut crc = flate2::Crc::new();
    crc.update(name);
    crc.update(data);
    [
        body,
        &(data.len() as u32).to_be_bytes(),
        name,
        data,
        &crc.sum().to_be_bytes(),
        end,
    ]
    .concat()
}

#[test]
fn a_sequence_overwrites_no_picture_of_others() {
    let whole = foreign();
    let cut = whole[..whole.len() - 20].to_vec();
    // 300,000 x 300,000 pixels: the decoder refuses it.
    let mut huge = whole.clone();
    huge[16..24].copy_from_slice(&[0, 4, 0x93, 0xe0, 0, 4, 0x93, 0xe0]);
    let mut crc = flate2::Crc::new();
    crc.update(&huge[12..29]);
    huge[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    let cases = [
        ("whole", whole.clone()),
        ("bytes after its end", [&whole[..], b"more"].concat()),
        ("cut off", cut),
        ("huge", huge),
    ];
    for (what, bytes) in cases {
        for (args, name) in [
            (&["-o", "f_{frame:3}.png"][..], "f_003.png"),
            (&["--apng", "a.png"], "a.png"),
        ] {
            let folder = studio();
            fs::write(folder.path().join(name), &bytes).unwrap();
            let base = ["sequence", "move.toml", "--fps", "8", "--adapter", "cpu"];
            let refused = run_in(folder.path(), &[&base[..], args].concat());
            assert_eq!(refused.code, 2, "{what}, {name}: {}", refused.err);
            assert!(refused.err.contains("--force"), "{what}: {}", refused.err);
            assert_eq!(
                fs::read(folder.path().join(name)).unwrap(),
                bytes,
                "{what}, {name}"
            );
            let forced = run_in(folder.path(), &[&base[..], args, &["--force"]].concat());
            assert_eq!(forced.code, 0, "{what}, {name}: {}", forced.err);
            assert_ne!(fs::read(folder.path().join(name)).unwrap(), bytes);
        }
    }
}

#[test]
fn a_flipped_bit_anywhere_makes_a_frame_unfinished() {
    let folder = studio();
    assert_eq!(
        sequence(folder.path(), &["--frames", "0..1", "--size", "8x6"]).code,
        0
    );
    let path = folder.path().join("f_000.png");
    let good = fs::read(&path).unwrap();
    let at = |bytes: &[u8], what: &[u8]| {
        bytes
            .windows(what.len())
            .position(|found| found == what)
            .unwrap()
    };
    let text = at(&good, b"rasterlab frame\0");
    let fingerprint = String::from_utf8(good[text + 20..text + 36].to_vec()).unwrap();
    let status = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        frame_status(&path, [8, 6], &fingerprint).unwrap()
    };
    assert_eq!(
        status(&good),
        FrameStatus::Finished {
            adapter: "cpu".into()
        }
    );
    assert_eq!(
        frame_status(&path, [8, 7], &fingerprint).unwrap(),
        FrameStatus::Other
    );
    // Every byte after the signature: lengths, names, texts, pixels and checksums.
    for byte in 8..good.len() {
        let mut flipped = good.clone();
        flipped[byte] ^= 1 << (byte % 8);
        assert_eq!(
            status(&flipped),
            FrameStatus::Unfinished,
            "byte {byte} of {}",
            good.len()
        );
    }
    for length in [text + 40, good.len() / 2 + 200, good.len() - 1] {
        assert_eq!(
            status(&good[..length.min(good.len() - 1)]),
            FrameStatus::Unfinished,
            "cut to {length}"
        );
    }
    // Added by somebody, so not ours to throw away.
    assert_eq!(status(&[&good[..], b"note"].concat()), FrameStatus::Other);
    let flipped = at(&good, b"[output]");
    let mut damaged = good.clone();
    damaged[flipped + 1] ^= 1;
    fs::write(&path, &damaged).unwrap();
    let again = sequence(folder.path(), &["--frames", "0..1", "--size", "8x6"]);
    assert!(
        again.code == 0 && again.err.contains("1 frame drawn, 0 kept"),
        "{}",
        again.err
    );
    assert_eq!(fs::read(&path).unwrap(), good);
}

#[test]
fn a_frame_is_judged_by_its_chunks_and_not_by_a_stated_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.png");
    let marked = with_chunk(&foreign(), b"iTXt", b"rasterlab frame\0\0\0\0\x00cafe");
    fs::write(&path, &marked).unwrap();
    assert_eq!(
        frame_status(&path, [2, 2], "cafe").unwrap(),
        FrameStatus::Finished {
            adapter: String::new()
        }
    );
    assert_eq!(
        frame_status(&path, [2, 2], "c0de").unwrap(),
        FrameStatus::Other
    );
    // An animation that announces more frames than it has.
    fs::write(
        &path,
        with_chunk(&marked, b"acTL", &[0, 0, 0, 5, 0, 0, 0, 0]),
    )
    .unwrap();
    assert_eq!(
        frame_status(&path, [2, 2], "cafe").unwrap(),
        FrameStatus::Other
    );
}

#[test]
fn pictures_drawn_at_once_never_take_a_name_twice() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", "facet", "--adapter", "cpu", "--size", "4x3", "-o"];
    for _ in 0..20 {
        let draws = |output: &str| {
            command(folder.path())
                .args(args)
                .arg(output)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
        };
        let at_once: Vec<_> = (0..3).map(|_| draws("{n:4}.png").unwrap()).collect();
        for child in at_once {
            let run = finished(child.wait_with_output().unwrap());
            assert_eq!(run.code, 0, "{}", run.err);
        }
    }
    assert_eq!(frames(folder.path()).len(), 60);
    for round in 0..8 {
        let name = format!("fixed{round}.png");
        let at_once: Vec<_> = (0..3)
            .map(|_| {
                command(folder.path())
                    .args(args)
                    .arg(&name)
                    .stdout(Stdio::piped())
                    .stderr(Stdio::piped())
                    .spawn()
                    .unwrap()
            })
            .collect();
        let codes: Vec<i32> = at_once
            .into_iter()
            .map(|child| finished(child.wait_with_output().unwrap()).code)
            .collect();
        assert_eq!(
            codes.iter().filter(|code| **code == 0).count(),
            1,
            "{codes:?}"
        );
        assert_eq!(
            codes.iter().filter(|code| **code == 2).count(),
            2,
            "{codes:?}"
        );
    }
}

#[test]
fn saved_pictures_can_be_opened_or_are_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("newer.toml"),
        "schema = 99\nname = \"Later\"\n[effects.facet]\namount = 0.5\n",
    )
    .unwrap();
    let render = |args: &[&str]| {
        run_in(
            folder.path(),
            &[
                &["render"],
                args,
                &["--adapter", "cpu", "--size", "8x6", "-o", "a.png"],
            ]
            .concat(),
        )
    };
    let refused = render(&["facet", "--set", "test.max_pixels=5"]);
    assert!(
        refused.code == 2
            && refused
                .err
                .contains("test.why must say why the budget is above the default"),
        "{}",
        refused.err
    );
    let refused = render(&["newer.toml", "--set", "facet.amount=1"]);
    assert!(
        refused.code == 2
            && refused
                .err
                .contains("its schema is newer than this program"),
        "{}",
        refused.err
    );
    assert!(!folder.path().join("a.png").exists());
    let changed = [
        "facet",
        "--set",
        "test.max_pixels=5",
        "--set",
        "test.why=broad",
        "--set",
        "facet.amount=0.25",
    ];
    let saved = render(&changed);
    assert_eq!(saved.code, 0, "{}", saved.err);
    let again = run_in(
        folder.path(),
        &["render", "a.png", "--adapter", "cpu", "-o", "b.png"],
    );
    assert_eq!(again.code, 0, "{}", again.err);
    let [a, b] = ["a.png", "b.png"]
        .map(|name| rasterlab::preset_file::png_pixels(&folder.path().join(name)).unwrap());
    assert_eq!(a, b);
}

#[test]
fn a_picture_of_a_model_opens_where_the_model_is_and_elsewhere_gives_its_look_or_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let make = |path: &str| {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        path
    };
    let triangle = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    fs::write(make("models/t.gltf"), triangle).unwrap();
    fs::write(
        make("p/mine.toml"),
        "schema = 2\n[scene]\npath = \"../models/t.gltf\"\n",
    )
    .unwrap();
    make("elsewhere/x");
    let render_with = |from: &str, to: &str, flags: &[&str]| {
        let args = [
            "render",
            from,
            "--adapter",
            "cpu",
            "--size",
            "8x6",
            "-o",
            to,
        ];
        run_in(folder.path(), &[&args[..], flags].concat())
    };
    let render = |from: &str, to: &str| render_with(from, to, &[]);
    let beside = render("p/mine.toml", "models/a.png");
    assert_eq!(beside.code, 0, "{}", beside.err);
    let opened = render("models/a.png", "b.png");
    assert_eq!(opened.code, 0, "{}", opened.err);
    // The folder of b.png holds the folder of the model.
    assert_eq!(render("b.png", "elsewhere/c.png").code, 0);
    let look = render("elsewhere/c.png", "look.png");
    assert!(
        look.code == 0
            && look
                .err
                .contains("t.gltf lies outside of its folder, so only its look is used")
            && look.err.contains("--allow-outside opens the model"),
        "{}",
        look.err
    );
    let strict = render_with("elsewhere/c.png", "d.png", &["--strict"]);
    assert_eq!(strict.code, 2, "{}", strict.err);
    let whole = render_with("elsewhere/c.png", "whole.png", &["--allow-outside"]);
    assert!(
        whole.code == 0 && !whole.err.contains("outside"),
        "{}",
        whole.err
    );
    let pixels =
        |name: &str| rasterlab::preset_file::png_pixels(&folder.path().join(name)).unwrap();
    assert_eq!(pixels("elsewhere/c.png"), pixels("whole.png"));
    assert_ne!(pixels("elsewhere/c.png"), pixels("look.png"));
    // Nothing is read of a file of the system, or of one on another machine.
    for name in [
        "/etc/passwd",
        "/etc/t.gltf",
        "C:\\\\t.gltf",
        "\\\\\\\\host\\\\share\\\\t.gltf",
        "//host/share/t.gltf",
    ] {
        let text = format!("schema = 2\n[scene]\npath = \"{name}\"\n");
        let chunk = format!("rasterlab preset\0\0\0\0\0{text}");
        fs::write(
            folder.path().join("elsewhere/e.png"),
            with_chunk_at(&foreign(), AFTER_HEADER, b"iTXt", chunk.as_bytes()),
        )
        .unwrap();
        let look = render_with("elsewhere/e.png", "f.png", &["--force"]);
        assert!(
            look.code == 0 && look.err.contains("only its look is used"),
            "{name}: {}",
            look.err
        );
        let refused = render_with("elsewhere/e.png", "g.png", &["--allow-outside"]);
        assert!(
            refused.code == 2 && !folder.path().join("g.png").exists(),
            "{name}: {}",
            refused.err
        );
    }
}

#[test]
fn a_damaged_picture_is_called_damaged() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(
        run_in(
            folder.path(),
            &[
                "render",
                "facet",
                "--adapter",
                "cpu",
                "--size",
                "4x3",
                "-o",
                "a.png"
            ]
        )
        .code,
        0
    );
    let mut bytes = fs::read(folder.path().join("a.png")).unwrap();
    let text = bytes
        .windows(10)
        .position(|window| window == b"schema = 2")
        .unwrap();
    bytes[text] ^= 1;
    fs::write(folder.path().join("a.png"), bytes).unwrap();
    let run = run_in(
        folder.path(),
        &["render", "a.png", "--adapter", "cpu", "-o", "b.png"],
    );
    assert!(
        run.code == 2 && run.err.contains("the file is damaged"),
        "{}",
        run.err
    );
}

#[test]
fn files_that_cannot_be_what_they_are_called_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("model.fbx"), "v 0 0 0\n").unwrap();
    fs::create_dir(at("folder")).unwrap();
    fs::create_dir(at("effects")).unwrap();
    fs::write(at("effects/mist.wgsl"), "fn mist(").unwrap();
    let refused = |args: &[&str], wanted: &str| {
        let run = run_in(folder.path(), args);
        assert!(
            run.code == 2 && run.err.contains(wanted),
            "{args:?}: {} {}",
            run.code,
            run.err
        );
    };
    refused(
        &["render", "model.fbx", "--adapter", "cpu"],
        "models in .glb, .gltf, .vrm, .obj, .stl and .ply files",
    );
    refused(
        &["render", "folder", "--adapter", "cpu"],
        "models in .glb, .gltf, .vrm, .obj, .stl and .ply files",
    );
    refused(
        &["render", "facet", "--adapter", "cpu", "-o", "a.jpg"],
        "a.jpg: pictures are written as PNG",
    );
    refused(
        &["explain", "facet", "--adapter", "cpu", "--measure"],
        "the built-in oracle, is not timed",
    );
    let missing = run_in(
        folder.path(),
        &[
            "render",
            "facet",
            "--adapter",
            "cpu",
            "--size",
            "4x3",
            "-o",
            "no/a.png",
        ],
    );
    assert!(
        missing.code != 0
            && missing.err.contains("there is no folder no")
            && !missing.err.contains(".tmp"),
        "{}",
        missing.err
    );
    assert!(!at("a.jpg").exists());
    let listed = run_in(folder.path(), &["list", "effects"]);
    assert!(
        listed.code == 0 && listed.err.contains("mist.wgsl"),
        "{}",
        listed.err
    );
}

#[cfg(unix)]
mod special {
    use std::os::unix::fs::{FileTypeExt as _, symlink};

    use super::*;

    fn pipe(path: &Path) {
        assert!(
            Command::new("mkfifo")
                .arg(path)
                .status()
                .expect("mkfifo is there")
                .success()
        );
    }

    #[test]
    fn pipes_and_devices_are_never_replaced_and_never_waited_for() {
        let folder = studio();
        pipe(&folder.path().join("out.png"));
        pipe(&folder.path().join("pipe.toml"));
        pipe(&folder.path().join("pipe.png"));
        pipe(&folder.path().join(".rasterlab-abcdefabcdef.tmp"));
        let refused = |args: &[&str], wanted: &str| {
            let run = run_in(folder.path(), args);
            assert!(
                run.code == 2 && run.err.contains(wanted),
                "{args:?}: {} {}",
                run.code,
                run.err
            );
        };
        let render = |name: &str, to: &str, wanted: &str| {
            refused(
                &[
                    "render",
                    name,
                    "--adapter",
                    "cpu",
                    "--size",
                    "4x3",
                    "--force",
                    "-o",
                    to,
                ],
                wanted,
            );
        };
        render(
            "facet",
            "out.png",
            "is a device, pipe or socket, not a regular file",
        );
        render(
            "facet",
            "/dev/null",
            "is a device, pipe or socket, not a regular file",
        );
        render("facet", ".", "is a folder, not a regular file");
        render("pipe.toml", "a.png", "it is not a regular file");
        render("pipe.png", "a.png", "it is not a regular file");
        assert!(
            fs::metadata(folder.path().join("out.png"))
                .unwrap()
                .file_type()
                .is_fifo()
        );
        // A pipe beside the frames, and one in the place of a frame.
        assert_eq!(sequence(folder.path(), &[]).code, 0);
        fs::remove_file(folder.path().join("f_003.png")).unwrap();
        pipe(&folder.path().join("f_003.png"));
        let output = [
            "sequence",
            "move.toml",
            "-o",
            "f_{frame:3}.png",
            "--fps",
            "8",
            "--adapter",
            "cpu",
        ];
        refused(&output, "f_003.png exists and is no frame of this preset");
        refused(
            &[&output[..], &["--force"]].concat(),
            "is a device, pipe or socket",
        );
    }

    #[test]
    fn links_are_written_through_and_a_link_takes_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).unwrap();
        symlink("deep/target.png", at("link.png")).unwrap();
        let render = |extra: &[&str]| {
            run_in(
                folder.path(),
                &[
                    &[
                        "render",
                        "facet",
                        "--adapter",
                        "cpu",
                        "--size",
                        "4x3",
                        "-o",
                        "link.png",
                    ],
                    extra,
                ]
                .concat(),
            )
        };
        let refused = render(&[]);
        assert!(
            refused.code == 2 && refused.err.contains("link.png exists"),
            "{}",
            refused.err
        );
        let written = render(&["--force"]);
        assert_eq!(written.code, 0, "{}", written.err);
        assert!(
            fs::symlink_metadata(at("link.png")).unwrap().is_symlink()
                && at("deep/target.png").is_file()
        );
        symlink("b.png", at("a.png")).unwrap();
        symlink("a.png", at("b.png")).unwrap();
        let circle = run_in(
            folder.path(),
            &[
                "render",
                "facet",
                "--adapter",
                "cpu",
                "--size",
                "4x3",
                "--force",
                "-o",
                "a.png",
            ],
        );
        assert!(
            circle.code == 2 && circle.err.contains("lead in a circle"),
            "{}",
            circle.err
        );
    }

    #[test]
    fn unfinished_files_of_killed_processes_are_swept_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (dead, alive, young, not_ours) = (
            at(".rasterlab-aaaaaaaaaaaa.tmp"),
            at(".rasterlab-bbbbbbbbbbbb.tmp"),
            at(".rasterlab-cccccccccccc.tmp"),
            at(".rasterlab-notes"),
        );
        for path in [&dead, &alive, &young, &not_ours] {
            let file = fs::File::create(path).unwrap();
            if *path != young {
                file.set_modified(
                    // Asks for the time of the day: whether an unfinished file is old is told from it.
                    std::time::SystemTime::now() - std::time::Duration::from_secs(7200),
                )
                .unwrap();
            }
        }
        let held = fs::File::open(&alive).unwrap();
        held.lock().unwrap();
        assert_eq!(
            run_in(
                folder.path(),
                &[
                    "render",
                    "facet",
                    "--adapter",
                    "cpu",
                    "--size",
                    "4x3",
                    "-o",
                    "a.png"
                ]
            )
            .code,
            0
        );
        assert_eq!(
            [&dead, &alive, &young, &not_ours].map(|path| path.exists()),
            [false, true, true, true]
        );
    }
}
