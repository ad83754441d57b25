//! Promise: `render --triangle-ids` and `--depths` write what the picture shows as NumPy arrays, by
//! the rules of pictures: several presets need several names, nothing is overwritten unasked, and a
//! wrong name is refused before anything is drawn.

use rasterlab::{oracle, preset_file};

use super::*;

const SIZE: [usize; 2] = [40, 20];

/// Draws the square from (0, 0, 4) with the oracle.
const RENDER: &str =
    "render square.gltf CPU40x20 --set camera.eye=[0,0,4] --set camera.target=[0,0,0]";

/// With two triangles, a square from (-1, -1) to (1, 1) in the plane z = x; number 0 lies below its
/// diagonal.
fn square() -> Place {
    let corners = [
        [-1f32, -1.],
        [1., -1.],
        [1., 1.],
        [-1., -1.],
        [1., 1.],
        [-1., 1.],
    ];
    let numbers = corners.iter().flat_map(|[x, y]| [*x, *y, *x]);
    let place = Place::new();
    place.put(
        "square.bin",
        numbers.flat_map(f32::to_le_bytes).collect::<Vec<u8>>(),
    );
    let data = TRIANGLE
        .split('"')
        .find(|text| text.starts_with("data:"))
        .unwrap();
    let model = TRIANGLE
        .replace(data, "square.bin")
        .replace("\"byteLength\":36", "\"byteLength\":72");
    place.put("square.gltf", model.replace("\"count\":3", "\"count\":6"));
    place
}

/// The numbers of a .npy file of version 1.0 with this kind and the shape of `SIZE`, as words.
fn words(place: &Place, name: &str, kind: &str, [width, height]: [usize; 2]) -> Vec<u32> {
    let bytes = place.read(name);
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
    assert!(
        (10 + length).is_multiple_of(64) && header.ends_with('\n'),
        "{header:?}"
    );
    let wanted =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    assert_eq!(header.trim_end(), wanted);
    let numbers = &bytes[10 + length..];
    assert_eq!(numbers.len(), width * height * 4);
    numbers
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}

#[test]
fn ids_and_depths_are_those_of_the_plane_that_was_drawn() {
    let half = 22.5_f64.to_radians().tan();
    for (lens, is_perspective) in [
        ("camera.fov_y_deg=45", true),
        ("camera.orthographic_height_m=4", false),
    ] {
        let place = square();
        place.play(&format!(
            "$ {RENDER} --set {lens} --unset ground --triangle-ids {{preset}}-ids.npy --depths d.npy --json
            /results/0/file \"square.png\"
            /results/0/triangle_ids \"square-ids.npy\"
            /results/0/depths \"d.npy\""
        ));
        let ids = words(&place, "square-ids.npy", "<u4", SIZE);
        let depths = words(&place, "d.npy", "<f4", SIZE);
        let mut seen = [0, 0, 0];
        for (at, (id, bits)) in ids.into_iter().zip(depths).enumerate() {
            let [column, row] = [at % SIZE[0], at / SIZE[0]].map(|pixel| pixel as f64 + 0.5);
            let [across, up] = [(column / 20.0 - 1.0) * 2.0, 1.0 - row / 10.0];
            // Where the ray through the pixel meets the plane z = x.
            let (depth, [x, y]) = if is_perspective {
                let depth = 4.0 / (1.0 + across * half);
                (depth, [across * half * depth, up * half * depth])
            } else {
                (4.0 - 2.0 * across, [2.0 * across, 2.0 * up])
            };
            let edges = [x.abs() - 1.0, y.abs() - 1.0, x - y];
            if edges.iter().any(|distance: &f64| distance.abs() < 1e-3) {
                continue;
            }
            let is_outside = x.abs() > 1.0 || y.abs() > 1.0;
            let expected = if is_outside {
                u32::MAX
            } else {
                u32::from(y > x)
            };
            assert_eq!(id, expected, "{lens}: pixel {at}");
            seen[expected.min(2) as usize] += 1;
            let found = f64::from(f32::from_bits(bits));
            assert_eq!(found.is_nan(), is_outside, "{lens}: pixel {at}");
            assert!(
                is_outside || (found / depth - 1.0).abs() < 1e-3,
                "{lens}: pixel {at} is at {found} m, not {depth}"
            );
        }
        assert!(seen.iter().all(|count| *count > 30), "{seen:?}");
    }
}

#[test]
fn the_arrays_are_those_of_the_oracles_frame() {
    let place = Place::new();
    let size = [48, 36];
    for (name, scale) in [("cube-wall", "full"), ("facet-knot", "half")] {
        place.play(&format!(
            "$ render {name} CPU48x36 --set accuracy.render_scale={scale} --triangle-ids {{preset}}.npy
            >= {name}.png\\n{name}.npy\\n"
        ));
        let mut file = preset_file::open(name, &Default::default()).unwrap();
        preset_file::set(&mut file, "accuracy.render_scale", scale).unwrap();
        let scene = preset_file::load_scene(&file.preset, None).unwrap();
        let factor = file.preset.accuracy.scale().factor();
        let frame =
            oracle::render_scaled(&scene, &file.preset.moments(&scene, size), factor).unwrap();
        assert!(frame.covered() > 100);
        let ids = words(
            &place,
            &format!("{name}.npy"),
            "<u4",
            size.map(|side| side as usize),
        );
        assert_eq!(ids, frame.triangle_id, "{name}");
    }
}

#[test]
fn arrays_follow_the_rules_of_pictures() {
    let place = square();
    let transcript = r"
        @ old.npy mine
        $2 RENDER FLAG old.npy
        ! old.npy exists; use --force
        @ mine.npy mine
        == old.npy mine.npy
        $2 RENDER FLAG -
        ! arrays are written to files
        $2 RENDER FLAG {presett}.npy
        ! unknown placeholder
        $2 RENDER FLAG a.npy facet -o {preset}.png
        ! put {preset} or {n}
        $2 RENDER FLAG a.png -o a.png
        ! names the same file
        $2 RENDER FLAG no/folder/a.npy -o -
        ! no/folder
        $2 RENDER --depths a.npy --triangle-ids a.npy
        ! --triangle-ids names the same file
        - square.png
        $ RENDER FLAG old.npy --force -o forced.png
        >= forced.png\nold.npy\n
        @- forced.png
    ";
    for flag in ["--triangle-ids", "--depths"] {
        place.play(&transcript.replace("RENDER", RENDER).replace("FLAG", flag));
        assert_ne!(place.read("old.npy"), b"mine");
    }
    let piped = place.run(&format!("{RENDER} -o - --triangle-ids ids_{{n:2}}.npy"));
    assert!(
        piped.code == 0 && piped.bytes.starts_with(b"\x89PNG") && place.has("ids_01.npy"),
        "{}",
        piped.err
    );
}
