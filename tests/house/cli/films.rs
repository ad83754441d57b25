//! Promise: a film becomes a video through ffmpeg: every frame reaches it once and in order, the
//! file takes its name when it is whole, nothing is overwritten unasked, ffmpeg's own error is one
//! line, and without ffmpeg a sentence says so. A turntable turns once.

use rasterlab::preset_file::{png_pixels, preset_from_png};

use super::*;

const VIDEO: [&str; 8] = [
    "sequence",
    "move.toml",
    "--fps",
    "8",
    "--adapter",
    "cpu",
    "--video",
    "film.mp4",
];

/// Takes all frames and writes a video of five bytes.
const GOOD: &str = "printf '%s\\n' \"$@\" > arguments\ncat > received\nfor last; do :; done\nprintf video > \"${last#file:}\"\n";

/// The folder with the moving preset, where `ffmpeg` is this shell script.
#[cfg(unix)]
fn studio_with_ffmpeg(script: &str) -> tempfile::TempDir {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = studio();
    let program = folder.path().join("programs/ffmpeg");
    fs::create_dir(folder.path().join("programs")).unwrap();
    fs::write(&program, format!("#!/bin/sh\n{script}")).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    folder
}

fn run_with_path(folder: &Path, path: &str, args: &[&str]) -> Run {
    finished(
        command(folder)
            .env("PATH", path)
            .args(args)
            .stdin(Stdio::null())
            .output()
            .expect("the program starts"),
    )
}

/// Runs with the script as ffmpeg, which finds the programs of the system.
fn filmed(folder: &Path, args: &[&str]) -> Run {
    run_with_path(
        folder,
        &format!("{}:/usr/bin:/bin", folder.join("programs").display()),
        args,
    )
}

fn is_there(folder: &Path, name: &str) -> bool {
    folder.join(name).exists()
}

/// Files whose names begin with a dot: what a film that was not finished leaves behind.
fn unfinished(folder: &Path) -> usize {
    fs::read_dir(folder)
        .unwrap()
        .filter(|entry| {
            entry
                .as_ref()
                .unwrap()
                .file_name()
                .to_string_lossy()
                .starts_with('.')
        })
        .count()
}

#[test]
#[cfg(unix)]
fn ffmpeg_gets_every_frame_in_order_and_the_video_its_name() {
    let folder = studio_with_ffmpeg(GOOD);
    let args = [&VIDEO[..], &["-o", "f_{frame:3}.png"]].concat();
    let drawn = filmed(folder.path(), &args);
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    assert!(
        drawn.out.ends_with("f_007.png\nfilm.mp4\n")
            && drawn.err.contains("8 frames drawn, 0 kept"),
        "{}{}",
        drawn.out,
        drawn.err
    );
    let pixels = |i: usize| {
        png_pixels(&folder.path().join(format!("f_{i:03}.png")))
            .unwrap()
            .0
            .concat()
    };
    let expected: Vec<u8> = (0..8).flat_map(pixels).collect();
    let received = || fs::read(folder.path().join("received")).unwrap();
    assert!(
        received() == expected,
        "{} of {} bytes",
        received().len(),
        expected.len()
    );
    let arguments = fs::read_to_string(folder.path().join("arguments")).unwrap();
    for wanted in ["rawvideo", "rgba", "24x18", "8/1", "libx264", "mp4"] {
        assert!(
            arguments.lines().any(|line| line == wanted),
            "{wanted}: {arguments}"
        );
    }
    assert!(
        !arguments.contains("film.mp4"),
        "ffmpeg writes elsewhere: {arguments}"
    );
    assert_eq!(
        (
            fs::read(folder.path().join("film.mp4")).unwrap(),
            unfinished(folder.path())
        ),
        (b"video".to_vec(), 0)
    );

    // It is never overwritten unasked, and nothing is drawn for it.
    fs::write(folder.path().join("film.mp4"), "precious").unwrap();
    let refused = filmed(folder.path(), &args);
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .err
            .contains("film.mp4 exists; use --force to overwrite it"),
        "{}",
        refused.err
    );
    assert_eq!(
        fs::read(folder.path().join("film.mp4")).unwrap(),
        b"precious"
    );

    // With finished frames it is made of them.
    fs::remove_file(folder.path().join("received")).unwrap();
    let forced = filmed(folder.path(), &[&args[..], &["--force", "--json"]].concat());
    assert!(
        forced.code == 0 && forced.err.contains("0 frames drawn, 8 kept"),
        "{}",
        forced.err
    );
    assert_eq!(
        json(&forced)["results"][8],
        serde_json::json!({ "preset": "move", "video": "film.mp4", "frames": 8, "fps": 8.0 })
    );
    assert!(
        received() == expected && fs::read(folder.path().join("film.mp4")).unwrap() == b"video"
    );

    // A film of some frames, of another kind, alone.
    let some = [
        "sequence",
        "move.toml",
        "--fps",
        "8",
        "--adapter",
        "cpu",
        "--frames",
        "2..4",
        "--video",
        "part.gif",
    ];
    assert_eq!(filmed(folder.path(), &some).code, 0);
    assert!(received() == expected[2 * 24 * 18 * 4..4 * 24 * 18 * 4]);
}

#[test]
fn without_ffmpeg_one_sentence_says_so_before_anything_is_drawn() {
    let folder = studio();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let empty = folder.path().join("empty").display().to_string();
    // A program of that name in the current folder is not run.
    fs::write(folder.path().join("ffmpeg"), "#!/bin/sh\ntouch ran\n").unwrap();
    for path in [empty.as_str(), "", ".", "empty"] {
        let run = run_with_path(
            folder.path(),
            path,
            &[&VIDEO[..], &["-o", "f_{frame}.png"]].concat(),
        );
        assert_eq!(
            (run.code, run.out.as_str(), run.err.lines().count()),
            (2, "", 1),
            "{}",
            run.err
        );
        assert!(
            run.err
                .contains("ffmpeg is not installed, so film.mp4 cannot be written; install it"),
            "{}",
            run.err
        );
        assert!(
            frames(folder.path()).is_empty()
                && !is_there(folder.path(), "film.mp4")
                && !is_there(folder.path(), "ran")
        );
    }
}

#[test]
#[cfg(unix)]
fn what_ffmpeg_complains_of_is_one_line_and_leaves_no_file() {
    let cases = [
        (
            "echo \"[vost#0:0 @ 0x55d0] Unknown encoder 'libx264'\" >&2\necho 'Error opening output' >&2\nexit 1\n",
            "Unknown encoder 'libx264'",
        ),
        (
            "cat > /dev/null\necho 'No space left on device' >&2\nexit 228\n",
            "No space left on device",
        ),
        (
            "cat > /dev/null\nexit 3\n",
            "it ended with exit status: 3 before the film did, and said nothing",
        ),
        ("cat > /dev/null\n", "it wrote nothing"),
        ("kill -9 $$\n", "it ended with signal: 9"),
    ];
    for (script, wanted) in cases {
        let folder = studio_with_ffmpeg(script);
        let run = filmed(folder.path(), &[&VIDEO[..], &["--quiet"]].concat());
        assert_eq!(
            (run.code, run.out.as_str(), run.err.lines().count()),
            (2, "", 1),
            "{script}: {}",
            run.err
        );
        assert!(
            run.err
                .contains(&format!("film.mp4: ffmpeg failed: {wanted}")),
            "{script}: {}",
            run.err
        );
        assert!(
            !is_there(folder.path(), "film.mp4") && unfinished(folder.path()) == 0,
            "{script}"
        );
    }
}

#[test]
#[cfg(unix)]
fn a_video_that_cannot_be_is_one_sentence() {
    let folder = studio_with_ffmpeg(GOOD);
    let base = [
        "sequence",
        "move.toml",
        "--fps",
        "8",
        "--adapter",
        "cpu",
        "--video",
    ];
    let cases: [(&[&str], &str); 4] = [
        (
            &["film.mp4", "--size", "25x17"],
            "film.mp4: the size is 25x17, but the sides of an MP4 are even; 26x18 is one that fits",
        ),
        (
            &["film.avi"],
            "film.avi: the name of a video ends with .mp4, .webm or .gif",
        ),
        (&["film"], "film: the name of a video ends with"),
        (&["absent/film.gif"], "absent/film.gif"),
    ];
    for (args, wanted) in cases {
        let run = filmed(folder.path(), &[&base[..], args].concat());
        assert_eq!(
            (run.code, run.out.as_str()),
            (2, ""),
            "{args:?}: {}",
            run.err
        );
        assert!(run.err.contains(wanted), "{args:?}: {}", run.err);
    }
    assert!(!is_there(folder.path(), "received"), "ffmpeg was started");
    assert_eq!(
        filmed(
            folder.path(),
            &[&base[..], &["film.webm", "--size", "25x17"]].concat()
        )
        .code,
        0
    );
}

#[test]
#[cfg(unix)]
fn a_killed_film_leaves_no_torn_video() {
    let folder = studio_with_ffmpeg(GOOD);
    let path = format!("{}:/usr/bin:/bin", folder.path().join("programs").display());
    // Long enough that it is not done before it is killed, even where this test waits for a
    // processor.
    let args = [
        "sequence",
        "move.toml",
        "--to",
        "8",
        "--fps",
        "1000",
        "--adapter",
        "cpu",
        "--video",
        "film.mp4",
    ];
    let mut child = command(folder.path())
        .env("PATH", path)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let received = || fs::metadata(folder.path().join("received")).map_or(0, |about| about.len());
    // Asks for the real time only to give up: another process draws meanwhile.
    let patience = std::time::Instant::now();
    while received() < 10 * 24 * 18 * 4 && patience.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(
        (1..8000 * 24 * 18 * 4).contains(&received()),
        "{}",
        received()
    );
    assert!(!is_there(folder.path(), "film.mp4"));
    let again = filmed(folder.path(), &VIDEO);
    assert!(
        again.code == 0 && is_there(folder.path(), "film.mp4"),
        "{}",
        again.err
    );
}

#[test]
fn the_frames_of_real_videos_are_those_that_were_drawn() {
    let has = |program: &str| {
        Command::new(program)
            .arg("-version")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok()
    };
    if !has("ffmpeg") {
        return eprintln!("skipped: ffmpeg is not installed");
    }
    let folder = studio();
    for (name, tolerance) in [("film.mp4", 3.0), ("film.webm", 3.0), ("film.gif", 3.0)] {
        let args = [
            "sequence",
            "move.toml",
            "--fps",
            "8",
            "--adapter",
            "cpu",
            "--size",
            "64x48",
            "--video",
            name,
            "-o",
            "f_{frame:3}.png",
        ];
        let drawn = run_in(folder.path(), &args);
        assert_eq!(
            (drawn.code, unfinished(folder.path())),
            (0, 0),
            "{}",
            drawn.err
        );
        let decode = [
            "-loglevel",
            "error",
            "-i",
            name,
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgba",
            "pipe:1",
        ];
        let decoded = Command::new("ffmpeg")
            .current_dir(folder.path())
            .args(decode)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        assert!(
            decoded.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&decoded.stderr)
        );
        let drawn: Vec<u8> = frames(folder.path())
            .iter()
            .flat_map(|(file, _)| png_pixels(&folder.path().join(file)).unwrap().0.concat())
            .collect();
        assert_eq!(
            decoded.stdout.len(),
            drawn.len(),
            "{name}: frames of the film"
        );
        let difference: f64 = decoded
            .stdout
            .iter()
            .zip(&drawn)
            .map(|(a, b)| f64::from(a.abs_diff(*b)))
            .sum::<f64>()
            / drawn.len() as f64;
        assert!(
            difference < tolerance,
            "{name}: channels differ by {difference:.2} of 255 on average"
        );
    }
}

#[test]
fn a_turntable_turns_once_and_its_frames_give_themselves_back() {
    let still = MOVING
        .split("[animation")
        .next()
        .unwrap()
        .replace("spin_deg_per_s = 90.0\n", "")
        + "[output]\nsize = [24, 18]\n";
    for flag in ["--turntable", "--turntable=scene"] {
        let folder = studio();
        fs::write(folder.path().join("move.toml"), &still).unwrap();
        let turned = sequence(folder.path(), &[flag]);
        assert!(
            turned.code == 0 && turned.err.contains("8 frames drawn"),
            "{}",
            turned.err
        );
        assert_eq!(
            fs::read_to_string(folder.path().join("move.toml")).unwrap(),
            still,
            "the preset stays"
        );
        let pixels: Vec<_> = frames(folder.path())
            .iter()
            .map(|(name, _)| png_pixels(&folder.path().join(name)).unwrap().0)
            .collect();
        for (i, one) in pixels.iter().enumerate() {
            assert!(
                !pixels[..i].contains(one),
                "{flag}: frame {i} shows another side"
            );
        }
        let preset = preset_from_png(&fs::read(folder.path().join("f_002.png")).unwrap(), "f")
            .unwrap()
            .preset;
        assert_eq!(
            (preset.camera.is_some(), preset.spin_deg_per_s),
            (
                flag == "--turntable",
                if flag == "--turntable" { 0.0 } else { 360.0 }
            )
        );
        let again = run_in(
            folder.path(),
            &["render", "f_002.png", "--adapter", "cpu", "-o", "again.png"],
        );
        assert_eq!(again.code, 0, "{}", again.err);
        assert_eq!(
            png_pixels(&folder.path().join("again.png")).unwrap().0,
            pixels[2],
            "{flag}"
        );
        assert!(
            sequence(folder.path(), &[flag])
                .err
                .contains("0 frames drawn, 8 kept"),
            "{flag}"
        );
        assert_eq!(
            sequence(folder.path(), &[]).code,
            2,
            "frames of a turntable are other frames"
        );
    }
    let wrong = sequence(studio().path(), &["--turntable=sideways"]);
    assert!(
        wrong.code == 2 && wrong.err.contains("write camera or scene"),
        "{}",
        wrong.err
    );
}

#[test]
fn the_number_of_frames_is_told_without_drawing() {
    let folder = studio();
    let args = ["sequence", "move.toml", "--fps", "8", "--count"];
    let count = |more: &[&str]| run_in(folder.path(), &[&args[..], more].concat());
    assert_eq!((count(&[]).code, count(&[]).out.as_str()), (0, "8\n"));
    assert_eq!(count(&["--frames", "2..5"]).out, "3\n");
    assert_eq!(
        json(&count(&["--json", "--frames", "6.."]))["results"][0],
        serde_json::json!({ "frames": 2, "total": 8, "fps": 8.0 })
    );
    assert_eq!(count(&["--frames", "2..50"]).code, 2);
    assert!(frames(folder.path()).is_empty());
}
