//! Promise: a film becomes a video through ffmpeg: every frame reaches it once and in order, the
//! file takes its name when it is whole, nothing is overwritten unasked, ffmpeg's own error is one
//! line, and without ffmpeg a sentence says so. A turntable turns once.

use rasterlab::preset_file::preset_from_png;

use super::*;

const VIDEO: &str = "sequence move.toml --fps 8 CPU --video film.mp4";

/// Takes all frames and writes a video of five bytes.
const GOOD: &str = "printf '%s\\n' \"$@\" > arguments\ncat > received\nfor last; do :; done\nprintf video > \"${last#file:}\"\n";

/// The folder with the moving preset, where `ffmpeg` is this shell script.
#[cfg(unix)]
fn studio_with_ffmpeg(script: &str) -> Place {
    use std::os::unix::fs::PermissionsExt as _;
    let place = Place::studio();
    place.put("programs/ffmpeg", format!("#!/bin/sh\n{script}"));
    fs::set_permissions(
        place.at("programs/ffmpeg"),
        fs::Permissions::from_mode(0o755),
    )
    .unwrap();
    place
}

/// The line with the script as ffmpeg, which finds the programs of the system.
fn filmed(place: &Place, line: &str) -> String {
    format!(
        "PATH={}:/usr/bin:/bin {line}",
        place.at("programs").display()
    )
}

/// Files whose names begin with a dot: what a film that was not finished leaves behind.
fn unfinished(place: &Place) -> Vec<String> {
    place.files(|name| name.starts_with('.'))
}

#[test]
#[cfg(unix)]
fn ffmpeg_gets_every_frame_in_order_and_the_video_its_name() {
    let place = studio_with_ffmpeg(GOOD);
    let line = filmed(&place, &format!("{VIDEO} -o f_{{frame:3}}.png"));
    place.play(&format!(
        "$ {line}\n> f_007.png\\nfilm.mp4\\n\n! 8 frames drawn, 0 kept"
    ));
    let expected: Vec<u8> = (0..8)
        .flat_map(|i| place.pixels(&format!("f_{i:03}.png")).concat())
        .collect();
    assert!(
        place.read("received") == expected,
        "{} bytes",
        expected.len()
    );
    let arguments = String::from_utf8(place.read("arguments")).unwrap();
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
        (place.read("film.mp4"), unfinished(&place)),
        (b"video".to_vec(), vec![])
    );
    // It is never overwritten unasked, and nothing is drawn for it. With finished frames it is made
    // of them.
    place.play(&format!(
        "@ film.mp4 precious
        @ old precious
        @- received
        $2 {line}
        ! film.mp4 exists; use --force to overwrite it
        == film.mp4 old
        - received
        $ {line} --force --json
        ! 0 frames drawn, 8 kept
        /results/8 {{\"preset\":\"move\",\"video\":\"film.mp4\",\"frames\":8,\"fps\":8.0}}"
    ));
    assert!(place.read("received") == expected && place.read("film.mp4") == b"video");
    // A film of some frames, of another kind, alone.
    let line = filmed(
        &place,
        "sequence move.toml --fps 8 CPU --frames 2..4 --video part.gif",
    );
    place.play(&format!("$ {line}"));
    assert!(place.read("received") == expected[2 * 24 * 18 * 4..4 * 24 * 18 * 4]);
    // A fraction is the rate of the video to the last digit; a GIF has at most 50 a second.
    for (fps, name, said, rate) in [
        ("120000/1001", "fast.mp4", "", "120000/1001"),
        ("30000/1001", "slow.webm", "", "30000/1001"),
        (
            "60",
            "fast.gif",
            "! A GIF shows at most 50 frames a second, so the film has 50 instead of 60.",
            "50/1",
        ),
    ] {
        let line = format!("sequence move.toml --fps {fps} CPU --frames 0..1 --video {name}");
        place.play(&format!("$ {}\n{said}", filmed(&place, &line)));
        let arguments = String::from_utf8(place.read("arguments")).unwrap();
        assert!(arguments.lines().any(|line| line == rate), "{arguments}");
    }
}

#[test]
fn without_ffmpeg_one_sentence_says_so_before_anything_is_drawn() {
    let place = Place::studio();
    // A program of that name in the current folder is not run.
    place.play("@ empty/note\n@ ffmpeg #!/bin/sh\\ntouch ran\\n");
    for path in [&place.at("empty").display().to_string(), "", ".", "empty"] {
        let run = place.run(&format!("PATH={path} {VIDEO} -o f_{{frame}}.png"));
        assert_eq!(
            (run.code, run.out.as_str(), run.err.lines().count()),
            (2, "", 1),
            "{}",
            run.err
        );
        let wanted = "ffmpeg is not installed, so film.mp4 cannot be written; install it";
        assert!(run.err.contains(wanted), "{}", run.err);
        assert!(place.frames().is_empty() && !place.has("film.mp4") && !place.has("ran"));
    }
}

#[test]
#[cfg(unix)]
fn what_ffmpeg_complains_of_is_one_line_and_leaves_no_file() {
    for (script, wanted) in [
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
    ] {
        let place = studio_with_ffmpeg(script);
        let run = place.run(&filmed(&place, &format!("{VIDEO} --quiet")));
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
            !place.has("film.mp4") && unfinished(&place).is_empty(),
            "{script}"
        );
    }
}

#[test]
#[cfg(unix)]
fn a_video_that_cannot_be_is_one_sentence() {
    let place = studio_with_ffmpeg(GOOD);
    let transcript = r"
        $2 BASE film.mp4 --size 25x17
        ! film.mp4: the size is 25x17, but the sides of an MP4 are even; 26x18 is one that fits
        $2 BASE film.avi
        ! film.avi: the name of a video ends with .mp4, .webm or .gif
        $2 BASE film
        ! film: the name of a video ends with
        $2 BASE absent/film.gif
        ! absent/film.gif
        # ffmpeg was not started.
        - received
        $ BASE film.webm --size 25x17
    ";
    place.play(&transcript.replace(
        "BASE",
        &filmed(&place, "sequence move.toml --fps 8 CPU --video"),
    ));
}

#[test]
#[cfg(unix)]
fn a_killed_film_leaves_no_torn_video() {
    let place = studio_with_ffmpeg(GOOD);
    // Long enough that it is not done before it is killed, even where this test waits for a
    // processor.
    let line = "sequence move.toml --to 8 --fps 1000 CPU --video film.mp4 --quiet";
    let mut child = place.start(&filmed(&place, line));
    let received = || fs::metadata(place.at("received")).map_or(0, |about| about.len());
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
    place.play(&format!(
        "- film.mp4\n$ {}\n+ film.mp4",
        filmed(&place, VIDEO)
    ));
}

#[test]
fn the_frames_of_real_videos_are_those_that_were_drawn() {
    let version = Command::new("ffmpeg").arg("-version").output();
    if version.is_err() {
        return eprintln!("skipped: ffmpeg is not installed");
    }
    let place = Place::studio();
    for name in ["film.mp4", "film.webm", "film.gif"] {
        place.play(&format!(
            "$ sequence move.toml --fps 8 CPU64x48 --video {name} -o f_{{frame:3}}.png"
        ));
        assert_eq!(unfinished(&place), [""; 0]);
        let decode = format!("-loglevel error -i {name} -f rawvideo -pix_fmt rgba pipe:1");
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg
            .current_dir(place.at(""))
            .args(decode.split(' '))
            .stdin(Stdio::null());
        let decoded = ffmpeg.output().unwrap();
        assert!(
            decoded.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&decoded.stderr)
        );
        let drawn: Vec<u8> = place
            .frames()
            .keys()
            .flat_map(|file| place.pixels(file).concat())
            .collect();
        assert_eq!(
            decoded.stdout.len(),
            drawn.len(),
            "{name}: frames of the film"
        );
        let probe = format!(
            "-loglevel error -show_entries stream=color_space,color_transfer,color_primaries -of csv=p=0 {name}"
        );
        let mut ffprobe = Command::new("ffprobe");
        let probed = ffprobe
            .current_dir(place.at(""))
            .args(probe.split(' '))
            .output();
        if let Ok(probed) = probed.map(|probed| probed.stdout)
            && name != "film.gif"
        {
            assert_eq!(String::from_utf8_lossy(&probed).trim(), "bt709,bt709,bt709");
        }
        let pairs = decoded.stdout.iter().zip(&drawn);
        let difference: f64 =
            pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / drawn.len() as f64;
        assert!(
            difference < 3.0,
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
        .replace("spin_deg_per_s = 90.0\n", "");
    let still = still + "[output]\nsize = [24, 18]\n";
    for (flag, has_camera, spin) in [
        ("--turntable", true, 0.0),
        ("--turntable=scene", false, 360.0),
    ] {
        let place = Place::with([("move.toml", &still), ("copy.toml", &still)]);
        place.play(&format!(
            "$ {SEQUENCE} {flag}\n! 8 frames drawn\n== move.toml copy.toml"
        ));
        let pixels: Vec<_> = place
            .frames()
            .keys()
            .map(|name| place.pixels(name))
            .collect();
        for (i, one) in pixels.iter().enumerate() {
            assert!(
                !pixels[..i].contains(one),
                "{flag}: frame {i} shows another side"
            );
        }
        let preset = preset_from_png(&place.read("f_002.png"), "f")
            .unwrap()
            .preset;
        assert_eq!(
            (preset.camera.is_some(), preset.spin_deg_per_s),
            (has_camera, spin)
        );
        place.play(&format!(
            "$ {SEQUENCE} {flag}
            ! 0 frames drawn, 8 kept
            # Frames of a turntable are other frames.
            $2 {SEQUENCE}
            $ render f_002.png CPU -o again.png"
        ));
        assert_eq!(place.pixels("again.png"), pixels[2], "{flag}");
    }
}
