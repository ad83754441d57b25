//! Promise: `sweep` draws every step of one or two values as a contact sheet, says where each is,
//! and refuses what is no sweep.

use super::*;

const SMALL: [&str; 4] = ["--adapter", "cpu", "--size", "48x36"];

fn sweep_in(folder: &Path, args: &[&str]) -> Run {
    run_in(
        folder,
        &[&["sweep", "facet-sweep"], &SMALL[..], args].concat(),
    )
}

#[test]
fn a_sheet_has_a_picture_for_every_step_at_the_corner_that_json_names() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = sweep_in(
        folder.path(),
        &[
            "--vary",
            "facet.amount=0..1:3",
            "--vary",
            "facet.front=0.2,0.8",
            "-o",
            "sheet.png",
            "--json",
        ],
    );
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    let object = json(&drawn);
    let result = &object["results"][0];
    assert_eq!(
        (&result["columns"], &result["rows"], &result["file"]),
        (&3.into(), &2.into(), &"sheet.png".into())
    );
    let sheet = image::open(folder.path().join("sheet.png"))
        .expect("a picture")
        .to_rgba8();
    assert_eq!(
        result["size"],
        serde_json::json!([sheet.width(), sheet.height()])
    );
    let cells = result["cells"].as_array().expect("a list");
    assert_eq!(cells.len(), 6);
    assert_eq!(
        cells[4]["values"],
        serde_json::json!({ "facet.amount": "0.5", "facet.front": "0.8" })
    );
    // Each picture is the one that `render` draws with the same values.
    for (index, cell) in cells.iter().enumerate() {
        let name = format!("{index}.png");
        let sets = ["facet.amount", "facet.front"]
            .map(|path| format!("{path}={}", cell["values"][path].as_str().expect("a value")));
        let render = [
            &[
                "render",
                "facet-sweep",
                "-o",
                &name,
                "--set",
                &sets[0],
                "--set",
                &sets[1],
            ],
            &SMALL[..],
        ]
        .concat();
        assert_eq!(run_in(folder.path(), &render).code, 0);
        let alone = image::open(folder.path().join(&name))
            .expect("a picture")
            .to_rgba8();
        let [x, y] = [0, 1].map(|axis| cell["corner"][axis].as_u64().expect("pixels") as u32);
        let placed = image::imageops::crop_imm(&sheet, x, y, 48, 36).to_image();
        assert!(
            alone.pixels().all(|pixel| pixel.0[3] == 255),
            "the background of this preset is opaque"
        );
        assert!(placed == alone, "cell {index} is another picture");
    }
    let first = image::imageops::crop_imm(&sheet, 8, 30, 48, 36).to_image();
    let last = image::imageops::crop_imm(&sheet, 8 + 2 * 56, 30, 48, 36).to_image();
    assert!(first != last, "the value changes the picture");
}

#[test]
fn a_sheet_is_written_once_and_named_after_its_preset() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--vary", "facet.pattern=uniform,sweep"];
    let first = sweep_in(folder.path(), &args);
    assert_eq!(
        (first.code, first.out.trim()),
        (0, "facet-sweep-sweep.png"),
        "{}",
        first.err
    );
    let before = fs::read(folder.path().join("facet-sweep-sweep.png")).unwrap();
    let second = sweep_in(folder.path(), &args);
    assert!(
        second.code == 2 && second.err.contains("exists") && second.out.is_empty(),
        "{}",
        second.err
    );
    assert_eq!(
        sweep_in(folder.path(), &[&args[..], &["--force"]].concat()).code,
        0
    );
    assert!(
        before == fs::read(folder.path().join("facet-sweep-sweep.png")).unwrap(),
        "the same sheet has the same bytes"
    );
    let piped = sweep_in(folder.path(), &[&args[..], &["-o", "-"]].concat());
    assert!(piped.code == 0 && piped.bytes == before);
}

#[test]
fn what_is_no_sweep_is_wrong_usage_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (args, why) in [
        (&[][..], "--vary"),
        (&["--vary", "facet.amount"], "has no values"),
        (&["--vary", "facet.amount=0..1"], "in how many steps"),
        (&["--vary", "facet.amount=0..7:3"], "facet.amount"),
        (&["--vary", "facet.amonut=0..1:3"], "did you mean"),
        (
            &[
                "--vary",
                "facet.amount=0..1:3",
                "--vary",
                "facet.amount=0..1:3",
            ],
            "varied twice",
        ),
        (
            &[
                "--vary",
                "facet.amount=0..1:3",
                "--vary",
                "facet.front=0..1:3",
                "--vary",
                "facet.width=0.1,0.2",
            ],
            "one or two values",
        ),
        (
            &["--vary", "facet.amount=0..1:1000", "--size", "4000x4000"],
            "pixels, at most",
        ),
        (
            &["--vary", "facet.amount=0..1:3", "-o", "-", "--json"],
            "leave out --json",
        ),
        (
            &["--vary", "facet.amount=0..1:3", "--size", "0x9"],
            "each 1 to 16384",
        ),
    ] {
        let args: Vec<&str> = if args.contains(&"--size") {
            [&["sweep", "facet-sweep", "--adapter", "cpu"], args].concat()
        } else {
            [&["sweep", "facet-sweep"], &SMALL[..], args].concat()
        };
        let refused = run_in(folder.path(), &args);
        assert!(
            refused.code == 2 && refused.err.contains(why),
            "{args:?}: {}",
            refused.err
        );
        assert!(
            !refused.err.contains("panicked") && !refused.err.contains("--set:"),
            "{}",
            refused.err
        );
    }
    assert_eq!(
        fs::read_dir(folder.path())
            .unwrap()
            .filter(|entry| entry.as_ref().unwrap().path().is_file())
            .count(),
        0
    );
    let no_adapter = run_in(
        folder.path(),
        &[
            "sweep",
            "facet",
            "--vary",
            "facet.amount=0..1:2",
            "--adapter",
            "no such adapter",
        ],
    );
    assert_eq!(no_adapter.code, 3, "{}", no_adapter.err);
}
