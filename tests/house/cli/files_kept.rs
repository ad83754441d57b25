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

fn checksum(parts: &[&[u8]]) -> [u8; 4] {
    let mut crc = flate2::Crc::new();
    parts.iter().for_each(|part| crc.update(part));
    crc.sum().to_be_bytes()
}

/// `png` with one more chunk at this byte.
fn with_chunk(png: &[u8], at: usize, name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let (body, end) = png.split_at(at);
    [
        body,
        &(data.len() as u32).to_be_bytes(),
        name,
        data,
        &checksum(&[name, data]),
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
    let sum = checksum(&[&huge[12..29]]);
    huge[29..33].copy_from_slice(&sum);
    let longer = [&whole[..], b"more"].concat();
    for (what, bytes) in [
        ("whole", whole),
        ("bytes after its end", longer),
        ("cut off", cut),
        ("huge", huge),
    ] {
        for (words, name) in [
            ("-o f_{frame:3}.png", "f_003.png"),
            ("--apng a.png", "a.png"),
        ] {
            let place = Place::studio();
            place.put(name, &bytes);
            let line = format!("sequence move.toml --fps 8 CPU {words}");
            place.play(&format!("$2 {line}\n! --force"));
            assert_eq!(place.read(name), bytes, "{what}, {name}");
            place.play(&format!("$ {line} --force"));
            assert_ne!(place.read(name), bytes, "{what}, {name}");
        }
    }
}

#[test]
fn a_flipped_bit_anywhere_makes_a_frame_unfinished() {
    let place = Place::studio();
    let line = format!("{SEQUENCE} --frames 0..1 --size 8x6");
    place.play(&format!("$ {line}"));
    let good = place.read("f_000.png");
    let at = |what: &[u8]| {
        good.windows(what.len())
            .position(|found| found == what)
            .unwrap()
    };
    let text = at(b"rasterlab frame\0");
    let fingerprint = String::from_utf8(good[text + 20..text + 36].to_vec()).unwrap();
    let status = |bytes: &[u8], size| {
        place.put("f_000.png", bytes);
        frame_status(&place.at("f_000.png"), size, &fingerprint).unwrap()
    };
    assert_eq!(
        status(&good, [8, 6]),
        FrameStatus::Finished {
            adapter: "cpu".into()
        }
    );
    assert_eq!(status(&good, [8, 7]), FrameStatus::Other);
    // Every byte after the signature: lengths, names, texts, pixels and checksums.
    let flipped = |byte: usize, bit: u32| {
        let mut flipped = good.clone();
        flipped[byte] ^= 1 << bit;
        flipped
    };
    for byte in 8..good.len() {
        let found = status(&flipped(byte, byte as u32 % 8), [8, 6]);
        assert_eq!(
            found,
            FrameStatus::Unfinished,
            "byte {byte} of {}",
            good.len()
        );
    }
    for length in [text + 40, good.len() / 2 + 200, good.len() - 1] {
        let cut = &good[..length.min(good.len() - 1)];
        assert_eq!(
            status(cut, [8, 6]),
            FrameStatus::Unfinished,
            "cut to {length}"
        );
    }
    // Added by somebody, so not ours to throw away.
    assert_eq!(
        status(&[&good[..], b"note"].concat(), [8, 6]),
        FrameStatus::Other
    );
    place.put("f_000.png", flipped(at(b"[output]") + 1, 0));
    place.play(&format!("$ {line}\n! 1 frame drawn, 0 kept"));
    assert_eq!(place.read("f_000.png"), good);
}

#[test]
fn a_frame_is_judged_by_its_chunks_and_not_by_a_stated_size() {
    let place = Place::new();
    let status = |bytes: &[u8], fingerprint| {
        place.put("f.png", bytes);
        frame_status(&place.at("f.png"), [2, 2], fingerprint).unwrap()
    };
    let before_end = |png: &[u8], name, data| with_chunk(png, png.len() - 12, name, data);
    let marked = before_end(&foreign(), b"iTXt", b"rasterlab frame\0\0\0\0\x00cafe");
    assert_eq!(
        status(&marked, "cafe"),
        FrameStatus::Finished {
            adapter: String::new()
        }
    );
    assert_eq!(status(&marked, "c0de"), FrameStatus::Other);
    // An animation that announces more frames than it has.
    let animated = before_end(&marked, b"acTL", &[0, 0, 0, 5, 0, 0, 0, 0]);
    assert_eq!(status(&animated, "cafe"), FrameStatus::Other);
}

#[test]
fn pictures_drawn_at_once_never_take_a_name_twice() {
    let place = Place::new();
    let codes = |name: &str| {
        let at_once = [0; 3].map(|_| place.start(&format!("render facet CPU4x3 -o {name}")));
        at_once.map(|child| finished(child.wait_with_output().unwrap()).code)
    };
    for _ in 0..20 {
        assert_eq!(codes("{n:4}.png"), [0; 3]);
    }
    assert_eq!(place.frames().len(), 60);
    for round in 0..8 {
        let mut codes = codes(&format!("fixed{round}.png"));
        codes.sort_unstable();
        assert_eq!(codes, [0, 2, 2]);
    }
}

#[test]
fn a_picture_of_a_model_opens_where_the_model_is_and_elsewhere_gives_its_look_or_is_asked_for() {
    let place = Place::with([
        ("models/t.gltf", TRIANGLE),
        (
            "p/mine.toml",
            "schema = 2\n[scene]\npath = \"../models/t.gltf\"\n",
        ),
        ("elsewhere/x", ""),
    ]);
    place.play(
        r"
        $ render p/mine.toml CPU8x6 -o models/a.png
        $ render models/a.png CPU8x6 -o b.png
        # The folder of b.png holds the folder of the model.
        $ render b.png CPU8x6 -o elsewhere/c.png
        $ render elsewhere/c.png CPU8x6 -o look.png
        ! t.gltf lies outside of its folder, so only its look is used && --allow-outside opens the model
        $2 render elsewhere/c.png CPU8x6 -o d.png --strict
        $ render elsewhere/c.png CPU8x6 -o whole.png --allow-outside
        !- outside
        ",
    );
    assert_eq!(place.pixels("elsewhere/c.png"), place.pixels("whole.png"));
    assert_ne!(place.pixels("elsewhere/c.png"), place.pixels("look.png"));
    // Nothing is read of a file of the system, or of one on another machine.
    for name in [
        "/etc/passwd",
        "/etc/t.gltf",
        "C:\\\\t.gltf",
        "\\\\\\\\host\\\\share\\\\t.gltf",
        "//host/share/t.gltf",
    ] {
        let text = format!("rasterlab preset\0\0\0\0\0schema = 2\n[scene]\npath = \"{name}\"\n");
        place.put(
            "elsewhere/e.png",
            with_chunk(&foreign(), AFTER_HEADER, b"iTXt", text.as_bytes()),
        );
        place.play(
            r"
            $ render elsewhere/e.png CPU8x6 -o f.png --force
            ! only its look is used
            $2 render elsewhere/e.png CPU8x6 -o g.png --allow-outside
            - g.png
            ",
        );
    }
}

#[test]
fn a_damaged_picture_is_called_damaged() {
    let place = Place::new();
    place.play("$ render facet CPU4x3 -o a.png");
    let mut bytes = place.read("a.png");
    let text = bytes
        .windows(10)
        .position(|window| window == b"schema = 2")
        .unwrap();
    bytes[text] ^= 1;
    place.put("a.png", bytes);
    place.play("$2 render a.png CPU -o b.png\n! the file is damaged");
}

#[cfg(unix)]
mod special {
    use std::{
        os::unix::fs::{FileTypeExt as _, symlink},
        time::{Duration, SystemTime},
    };

    use super::*;

    fn pipe(place: &Place, name: &str) {
        let made = Command::new("mkfifo").arg(place.at(name)).status();
        assert!(made.expect("mkfifo is there").success());
    }

    #[test]
    fn pipes_and_devices_are_never_replaced_and_never_waited_for() {
        let place = Place::studio();
        for name in [
            "out.png",
            "pipe.toml",
            "pipe.png",
            ".rasterlab-abcdefabcdef.tmp",
        ] {
            pipe(&place, name);
        }
        place.play(&format!(
            "$2 render facet CPU4x3 --force -o out.png
            ! is a device, pipe or socket, not a regular file
            $2 render facet CPU4x3 --force -o /dev/null
            ! is a device, pipe or socket, not a regular file
            $2 render facet CPU4x3 --force -o .
            ! is a folder, not a regular file
            $2 render pipe.toml CPU4x3 --force -o a.png
            ! it is not a regular file
            $2 render pipe.png CPU4x3 --force -o a.png
            ! it is not a regular file
            # A pipe beside the frames, and one in the place of a frame.
            $ {SEQUENCE}
            @- f_003.png"
        ));
        assert!(
            fs::metadata(place.at("out.png"))
                .unwrap()
                .file_type()
                .is_fifo()
        );
        pipe(&place, "f_003.png");
        place.play(&format!(
            "$2 {SEQUENCE}
            ! f_003.png exists and is no frame of this preset
            $2 {SEQUENCE} --force
            ! is a device, pipe or socket"
        ));
    }

    #[test]
    fn links_are_written_through_and_a_link_takes_its_name() {
        let place = Place::with([("deep/note", "")]);
        let link = |to: &str, name: &str| symlink(to, place.at(name)).unwrap();
        link("deep/target.png", "link.png");
        link("b.png", "a.png");
        link("a.png", "b.png");
        place.play(
            r"
            $2 render facet CPU4x3 -o link.png
            ! link.png exists
            $ render facet CPU4x3 -o link.png --force
            + deep/target.png
            $2 render facet CPU4x3 --force -o a.png
            ! lead in a circle
            ",
        );
        assert!(
            fs::symlink_metadata(place.at("link.png"))
                .unwrap()
                .is_symlink()
        );
    }

    #[test]
    fn unfinished_files_of_killed_processes_are_swept_and_others_stay() {
        let place = Place::new();
        let [dead, alive, young, not_ours] = [
            "aaaaaaaaaaaa.tmp",
            "bbbbbbbbbbbb.tmp",
            "cccccccccccc.tmp",
            "notes",
        ]
        .map(|name| format!(".rasterlab-{name}"));
        place.put(&young, "");
        for name in [&dead, &alive, &not_ours] {
            let file = fs::File::create(place.at(name)).unwrap();
            // Asks for the time of the day: whether an unfinished file is old is told from it.
            file.set_modified(SystemTime::now() - Duration::from_secs(7200))
                .unwrap();
        }
        let held = fs::File::open(place.at(&alive)).unwrap();
        held.lock().unwrap();
        place.play("$ render facet CPU4x3 -o a.png");
        assert_eq!(
            [&dead, &alive, &young, &not_ours].map(|name| place.has(name)),
            [false, true, true, true]
        );
    }
}
