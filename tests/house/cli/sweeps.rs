//! Promise: `sweep` draws every step of one or two values as a contact sheet, says where each is,
//! and refuses what is no sweep.

use super::*;

#[test]
fn a_sheet_has_a_picture_for_every_step_at_the_corner_that_json_names() {
    let place = Place::new();
    let line = "sweep facet-sweep CPU48x36 --vary facet.amount=0..1:3 --vary facet.front=0.2,0.8 -o sheet.png --json";
    let result = place.json(line)["results"][0].clone();
    let picture = |name: &str| image::open(place.at(name)).expect("a picture").to_rgba8();
    let sheet = picture("sheet.png");
    for (key, value) in [
        ("columns", serde_json::json!(3)),
        ("rows", 2.into()),
        ("file", "sheet.png".into()),
        ("size", serde_json::json!([sheet.width(), sheet.height()])),
    ] {
        assert_eq!(result[key], value, "{key}");
    }
    let cells = result["cells"].as_array().expect("a list");
    assert_eq!(cells.len(), 6);
    assert_eq!(
        cells[4]["values"],
        serde_json::json!({ "facet.amount": "0.5", "facet.front": "0.8" })
    );
    let cut = |x, y| image::imageops::crop_imm(&sheet, x, y, 48, 36).to_image();
    // Each picture is the one that `render` draws with the same values.
    for (index, cell) in cells.iter().enumerate() {
        let [amount, front] = ["facet.amount", "facet.front"]
            .map(|path| cell["values"][path].as_str().expect("a value"));
        let sets = format!("--set facet.amount={amount} --set facet.front={front}");
        place.play(&format!(
            "$ render facet-sweep CPU48x36 -o {index}.png {sets}"
        ));
        let alone = picture(&format!("{index}.png"));
        let [x, y] = [0, 1].map(|axis| cell["corner"][axis].as_u64().expect("pixels") as u32);
        assert!(
            alone.pixels().all(|pixel| pixel.0[3] == 255),
            "the background of this preset is opaque"
        );
        assert!(cut(x, y) == alone, "cell {index} is another picture");
    }
    assert!(
        cut(8, 30) != cut(8 + 2 * 56, 30),
        "the value changes the picture"
    );
}

#[test]
fn a_sheet_is_written_once_and_named_after_its_preset() {
    let place = Place::new();
    let line = "sweep facet-sweep CPU48x36 --vary facet.pattern=uniform,sweep";
    place.play(&format!("$ {line}\n>= facet-sweep-sweep.png\\n"));
    let before = place.read("facet-sweep-sweep.png");
    place.play(&format!("$2 {line}\n! exists\n$ {line} --force"));
    assert!(
        before == place.read("facet-sweep-sweep.png"),
        "the same sheet has the same bytes"
    );
    let piped = place.run(&format!("{line} -o -"));
    assert!(piped.code == 0 && piped.bytes == before);
}

#[test]
fn what_is_no_sweep_is_wrong_usage_in_one_sentence() {
    let place = Place::new();
    for (words, why) in [
        ("", "--vary"),
        ("--vary facet.amount", "has no values"),
        ("--vary facet.amount=0..1", "in how many steps"),
        ("--vary facet.amount=0..7:3", "facet.amount"),
        ("--vary facet.amonut=0..1:3", "did you mean"),
        (
            "--vary facet.amount=0..1:3 --vary facet.amount=0..1:3",
            "varied twice",
        ),
        (
            "--vary facet.amount=0..1:3 --vary facet.front=0..1:3 --vary facet.width=0.1,0.2",
            "one or two values",
        ),
        (
            "--vary facet.amount=0..1:1000 --size 4000x4000",
            "pixels, at most",
        ),
        ("--vary facet.amount=0..1:3 -o - --json", "leave out --json"),
        ("--vary facet.amount=0..1:3 --size 0x9", "each 1 to 16384"),
    ] {
        let cpu = if words.contains("--size") {
            "CPU"
        } else {
            "CPU48x36"
        };
        let refused = place.run(&format!("sweep facet-sweep {cpu} {words}"));
        let said = refused.err + &refused.out;
        assert!(refused.code == 2 && said.contains(why), "{words}: {said}");
        assert!(
            !said.contains("panicked") && !said.contains("--set:"),
            "{said}"
        );
    }
    assert_eq!(place.files(|_| true), [""; 0]);
    place.play("$3 sweep facet --vary facet.amount=0..1:2 --adapter 'no such adapter'");
}
