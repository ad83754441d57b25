//! Promise: a sequence is the same bytes every time, goes on where it stopped, and overwrites
//! nothing that is not its own.

use super::*;

#[test]
fn a_sequence_is_the_same_bytes_every_time_and_moves() {
    let (a, b) = (studio(), studio());
    let first = sequence(a.path(), &[]);
    assert_eq!(first.code, 0, "{}", first.err);
    assert!(
        first.err.contains("8 frames drawn, 0 kept"),
        "{}",
        first.err
    );
    assert_eq!(
        first.out,
        (0..8)
            .map(|i| format!("f_{i:03}.png\n"))
            .collect::<String>()
    );
    assert_eq!(sequence(b.path(), &[]).code, 0);
    let drawn = frames(a.path());
    assert_eq!(drawn, frames(b.path()));
    assert!(drawn.windows(2).all(|pair| pair[0].1 != pair[1].1));
    // A frame is the picture that render draws at its time, and gives that preset back.
    let path = a.path().join("f_003.png");
    let alone = run_in(
        a.path(),
        &[
            "render",
            "move.toml",
            "--time",
            "0.375",
            "-o",
            "alone.png",
            "--adapter",
            "cpu",
        ],
    );
    assert_eq!(alone.code, 0, "{}", alone.err);
    let [of_sequence, of_render] = [path.clone(), a.path().join("alone.png")]
        .map(|path| rasterlab::preset_file::png_pixels(&path).unwrap());
    assert_eq!(of_sequence, of_render);
    let preset_file =
        rasterlab::preset_file::preset_from_png(&fs::read(path).unwrap(), "f").unwrap();
    assert_eq!(preset_file.preset.clock.time_s, 0.375);
    assert_eq!(preset_file.preset.animation.tracks().len(), 1);
}

#[test]
fn a_sequence_goes_on_where_it_stopped() {
    let folder = studio();
    sequence(folder.path(), &[]);
    let whole = frames(folder.path());
    let stamp = |i: usize| {
        fs::metadata(folder.path().join(&whole[i].0))
            .unwrap()
            .modified()
            .unwrap()
    };
    let before: Vec<_> = (0..8).map(stamp).collect();
    fs::remove_file(folder.path().join("f_002.png")).unwrap();
    let bytes = &whole[5].1;
    fs::write(folder.path().join("f_005.png"), &bytes[..bytes.len() / 2]).unwrap(); // As no interruption of ours leaves it.
    let again = sequence(folder.path(), &["--json"]);
    assert!(
        again.err.contains("2 frames drawn, 6 kept"),
        "{}",
        again.err
    );
    let kept: Vec<bool> = json(&again)["results"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["kept"].as_bool().unwrap())
        .collect();
    assert_eq!(kept, [true, true, false, true, true, false, true, true]);
    assert_eq!(frames(folder.path()), whole);
    for i in (0..8).filter(|i| ![2, 5].contains(i)) {
        assert_eq!(stamp(i), before[i], "frame {i} was written again");
    }
    let hidden = fs::read_dir(folder.path()).unwrap().filter(|entry| {
        entry
            .as_ref()
            .unwrap()
            .file_name()
            .to_string_lossy()
            .starts_with('.')
    });
    assert_eq!(hidden.count(), 0, "nothing unfinished is left behind");
}

#[test]
fn machines_divide_a_sequence_by_ranges() {
    let (whole, shared) = (studio(), studio());
    sequence(whole.path(), &[]);
    assert!(
        sequence(shared.path(), &["--frames", "5.."])
            .err
            .contains("3 frames drawn, 0 kept of 5..8 of 8")
    );
    assert!(
        sequence(shared.path(), &["--frames", "0..5"])
            .err
            .contains("5 frames drawn")
    );
    assert_eq!(frames(shared.path()), frames(whole.path()));
    assert!(
        sequence(shared.path(), &[])
            .err
            .contains("0 frames drawn, 8 kept")
    );
}

#[test]
fn a_sequence_that_cannot_be_is_one_sentence() {
    let cases: [(&[&str], &str); 12] = [
        (
            &["--from", "2", "--to", "1"],
            "--to 1 must come after --from 2",
        ),
        (&["--to", "inf"], "--to inf lies outside -1e9..=1e9"),
        (&["--fps", "0"], "--fps 0 lies outside 0.001..=1000"),
        (&["--fps", "nan"], "--fps NaN lies outside"),
        (
            &["--to", "1e6", "--fps", "1000"],
            "are too many; at most 100000 ",
        ),
        (&["--frames", "3..3"], "has no frame"),
        (&["--frames", "3"], "write A..B"),
        (
            &["--frames", "0..9"],
            "--frames 0..9 lies outside 0..8, the frames from 0 to 1 s at 8 a second",
        ),
        (
            &["-o", "f.png"],
            "put {frame} into the name, since there are 8 frames",
        ),
        (&["-o", "f_{n}.png"], "use {frame} instead of {n}"),
        (
            &["-o", "-"],
            "use --apng FILE or --video FILE for a single file",
        ),
        (&["--size", "0x4"], "each 1 to 16384"),
    ];
    for (args, wanted) in cases {
        let folder = studio();
        let mut all = vec!["sequence", "move.toml", "--adapter", "cpu"];
        if args[0] != "-o" {
            all.extend(["-o", "f_{frame}.png"]);
        }
        if !args.contains(&"--fps") {
            all.extend(["--fps", "8"]);
        }
        let run = run_in(folder.path(), &[&all[..], args].concat());
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{args:?}");
        assert!(run.err.contains(wanted), "{args:?}: {}", run.err);
        assert_eq!(frames(folder.path()), [], "{args:?}");
    }
    assert_eq!(
        run(&["sequence", "facet", "--adapter", "cpu"]).code,
        2,
        "frames must go somewhere"
    );
}

#[test]
#[cfg(unix)]
fn an_interrupted_sequence_leaves_whole_files_alone() {
    let folder = studio();
    let args = [
        "sequence",
        "move.toml",
        "-o",
        "f_{frame:3}.png",
        "--fps",
        "500",
        "--adapter",
        "cpu",
    ];
    let mut child = command(folder.path())
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Asks for the real time only to give up: another process draws meanwhile.
    let patience = std::time::Instant::now();
    while frames(folder.path()).len() < 3 && patience.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let left = frames(folder.path());
    assert!((3..500).contains(&left.len()), "{}", left.len());
    for (name, bytes) in left {
        assert!(
            image::load_from_memory(&bytes).is_ok() && bytes.ends_with(b"IEND\xae\x42\x60\x82"),
            "{name}"
        );
    }
}
