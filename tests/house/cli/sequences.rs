//! Promise: a sequence is the same bytes every time, goes on where it stopped, and overwrites
//! nothing that is not its own.

use super::*;

#[test]
fn a_sequence_is_the_same_bytes_every_time_and_moves() {
    let (place, other) = (Place::studio(), Place::studio());
    let names: String = (0..8).map(|i| format!("f_{i:03}.png\\n")).collect();
    place.play(&format!(
        "$ {SEQUENCE}\n! 8 frames drawn, 0 kept\n>= {names}"
    ));
    other.play(&format!("$ {SEQUENCE}"));
    let drawn = place.frames();
    assert_eq!(drawn, other.frames());
    let bytes: Vec<_> = drawn.values().collect();
    assert!(bytes.windows(2).all(|pair| pair[0] != pair[1]));
    // A frame is the picture that render draws at its time, and gives that preset back.
    place.play("$ render move.toml --time 0.375 -o alone.png CPU");
    assert_eq!(place.pixels("f_003.png"), place.pixels("alone.png"));
    let preset = rasterlab::preset_file::preset_from_png(&drawn["f_003.png"], "f")
        .unwrap()
        .preset;
    assert_eq!(
        (preset.clock.time_s, preset.animation.tracks().len()),
        (0.375, 1)
    );
}

#[test]
fn a_sequence_goes_on_where_it_stopped() {
    let place = Place::studio();
    place.run(SEQUENCE);
    let whole = place.frames();
    let stamps = || {
        [0, 1, 3, 4, 6, 7].map(|i| {
            fs::metadata(place.at(&format!("f_{i:03}.png")))
                .unwrap()
                .modified()
                .unwrap()
        })
    };
    let before = stamps();
    place.remove("f_002.png");
    let bytes = &whole["f_005.png"];
    place.put("f_005.png", &bytes[..bytes.len() / 2]); // As no interruption of ours leaves it.
    let again = place.run(&format!("{SEQUENCE} --json"));
    assert!(
        again.err.contains("2 frames drawn, 6 kept"),
        "{}",
        again.err
    );
    let object = json(&again);
    let kept: Vec<bool> = object["results"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["kept"].as_bool().unwrap())
        .collect();
    assert_eq!(kept, [true, true, false, true, true, false, true, true]);
    assert_eq!(place.frames(), whole);
    assert_eq!(stamps(), before, "a frame was written again");
    assert!(
        place.files(|name| name.starts_with('.')).is_empty(),
        "something unfinished is left behind"
    );
}

#[test]
#[cfg(unix)]
fn an_interrupted_sequence_leaves_whole_files_alone() {
    let place = Place::studio();
    let mut child = place.start("sequence move.toml -o f_{frame:3}.png --fps 500 CPU --quiet");
    // Asks for the real time only to give up: another process draws meanwhile.
    let patience = std::time::Instant::now();
    while place.frames().len() < 3 && patience.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let left = place.frames();
    assert!((3..500).contains(&left.len()), "{}", left.len());
    for (name, bytes) in left {
        assert!(is_whole(&bytes), "{name}");
    }
}

/// A frame shows what the clock and the keyframes say at its time, for an effect that asks for the
/// time, and is judged as it is drawn.
#[test]
fn an_effect_with_the_clock_is_exported_and_judged_at_the_time_of_each_frame() {
    let place = Place::new();
    place.put(
        "effects/plasma.wgsl",
        include_str!("../../picture/ported/plasma.wgsl"),
    );
    let preset = |scale: &str, more: &str| {
        format!(
            "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[clock]\nrange_s = [0.0, 1.0]\n[output]\nsize = [24, 18]\n\
            [effects.plasma]\nspeed = 1.5\nscale = {scale}\n{more}"
        )
    };
    let keys = "[animation.plasma]\nscale = [{ time_s = 0.0, value = 1.0 }, { time_s = 1.0, value = 3.0 }]\n";
    place.put("move.toml", preset("1.0", keys));
    place.put("scaled.toml", preset("2.0", ""));
    place.put("still.toml", preset("2.0", "").replace("1.5", "0.0"));
    place.play(
        "$ SEQUENCE
        ! 8 frames drawn, 0 kept
        $ render move.toml --time 0.375 -o alone.png CPU
        =~ f_003.png alone.png
        # Half way between the keyframes; the clock alone, and without it.
        $ render scaled.toml --time 0.5 -o scaled.png CPU
        =~ f_004.png scaled.png
        $ render scaled.toml --time 0.75 -o later.png CPU
        !~ later.png scaled.png
        $ render still.toml --time 0.5 -o still.png CPU
        !~ still.png scaled.png
        $ verify f_003.png CPU --json
        /results/0/judged_by_own_text/0 \"plasma\"",
    );
}
