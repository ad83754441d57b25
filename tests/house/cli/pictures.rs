//! Promise: a picture restores its preset, is the same bytes every time, and shows the moment and
//! the color that were asked for; a film shows its frames.

use std::{fs::File, io::BufReader, io::Write as _};

use rasterlab::preset_file::preset_from_png;

use super::*;

#[test]
fn pictures_are_written_restored_and_repeated() {
    let place = Place::new();
    place.play(
        r#"
        $ render facet CPU48x36 --set facet.amount=.25 -o {preset}_{n:2}.png
        >= facet_01.png\n
        ! adapter: cpu
        $ render facet_01.png CPU --json -o b.png
        /results/0/size [48,36]
        $ compare facet_01.png b.png --max-channel 0
        # Nothing is overwritten without --force.
        @ a.png precious
        $2 render lambert CPU8x8 -o a.png
        ! a.png exists; use --force to overwrite it
        @ old.png precious
        == a.png old.png
        $ render lambert CPU8x8 -o a.png --force
        $ render facet CPU8x8 -o color.png --set output.background=#3366cc
        "#,
    );
    assert!(
        place.json("render b.png CPU --json -o c.png")["results"][0]["covered"]
            .as_u64()
            .unwrap()
            > 100
    );
    assert!(place.read("a.png").starts_with(b"\x89PNG"));
    assert_eq!(place.pixels("color.png")[0], [0x33, 0x66, 0xcc, 255]);
    let [a, b] = [0, 1].map(|_| Place::new().run("render facet-random CPU40x30 -o - --quiet"));
    assert_eq!((a.code, a.err.as_str()), (0, ""));
    assert!(a.bytes.starts_with(b"\x89PNG") && a.bytes == b.bytes);
    let has_text = |bytes: &[u8]| bytes.windows(4).any(|chunk| chunk == b"iTXt");
    assert!(has_text(&a.bytes) && !has_text(&place.run("render facet CPU16x16 --bare -o -").bytes));
}

#[test]
fn a_preset_comes_from_stdin() {
    let place = Place::new();
    let piped = |line: &str, text: &str| {
        let mut child = place.command(line);
        let child = child
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = child.spawn().unwrap();
        child
            .stdin
            .take()
            .unwrap()
            .write_all(text.as_bytes())
            .unwrap();
        finished(child.wait_with_output().unwrap())
    };
    let text = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.normals]\n[output]\nsize = [20, 10]\n";
    let run = piped("render - CPU -o -", text);
    assert_eq!(run.code, 0, "{}", run.err);
    assert_eq!(&run.bytes[16..24], [0, 0, 0, 20, 0, 0, 0, 10]);
    let wrong = piped("render - CPU", "schema = 2\nnmae = 1\n=\n");
    assert!(
        wrong.code == 2 && wrong.err.contains("stdin:3:"),
        "{}",
        wrong.err
    );
}

fn film(place: &Place) -> png::Reader<BufReader<File>> {
    let film = File::open(place.at("film.apng")).unwrap();
    png::Decoder::new(BufReader::new(film)).read_info().unwrap()
}

#[test]
fn a_film_shows_the_frames() {
    let place = Place::studio();
    place.play(&format!("$ {SEQUENCE} --apng film.apng"));
    let mut film = film(&place);
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
        assert_eq!(
            pixels,
            place.pixels(&format!("f_{i:03}.png")).concat(),
            "frame {i}"
        );
    }
    let bytes = place.read("film.apng");
    assert!(preset_from_png(&bytes, "film").is_ok());
    // The film is the same with and without frame files, and a finished one is kept.
    place.remove("film.apng");
    place.play(&format!(
        "$ {SEQUENCE} --apng film.apng\n! 0 frames drawn, 8 kept"
    ));
    let alone = Place::studio();
    alone.play("$ sequence move.toml --apng film.apng --fps 8 CPU");
    for other in [&place, &alone] {
        assert!(other.read("film.apng") == bytes);
    }
    alone.play(
        r"
        $ sequence move.toml --apng film.apng --fps 8 CPU
        ! 0 frames drawn
        $2 sequence move.toml --apng film.apng --fps 4 CPU
        ",
    );
}

#[test]
fn a_film_that_stands_still_shows_the_moment_of_its_preset() {
    let place = Place::studio();
    place.put(
        "move.toml",
        MOVING.replace("[clock]\n", "[clock]\ntime_s = 0.5\n"),
    );
    place.play(&format!("$ {SEQUENCE} --apng film.apng"));
    let mut film = film(&place);
    assert_eq!(film.info().animation_control().unwrap().num_frames, 8);
    let mut pixels = vec![0; film.output_buffer_size().unwrap()];
    film.next_frame(&mut pixels).unwrap();
    assert!(film.info().frame_control().is_none(), "it is no frame");
    assert_eq!(pixels, place.pixels("f_004.png").concat());
    film.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, place.pixels("f_000.png").concat());
}
