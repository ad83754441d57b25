//! Images of every kind that the decoders tell apart, and pictures that hold a preset.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat, RgbaImage, codecs::jpeg::JpegEncoder};
use rasterlab::{
    frame::Frame,
    preset_file::{self, Provenance},
    scene::radiance,
};

use crate::{Seed, texts};

fn gradient(width: u32, height: u32) -> RgbaImage {
    RgbaImage::from_fn(width, height, |x, y| {
        image::Rgba([
            (x * 37) as u8,
            (y * 51) as u8,
            (x ^ y) as u8,
            255 - (x * y) as u8,
        ])
    })
}

/// Lines with runs, lines that are too short for them, old runs, and a size without pixels.
pub fn light() -> Vec<Seed> {
    let picture = |size: [usize; 2]| {
        let light = |i: usize| glam::DVec3::new(i as f64, (i % 7) as f64, 2.0) * 0.1;
        let light: Vec<_> = (0..size[0] * size[1]).map(light).collect();
        radiance::write(size, &light)
    };
    let old = b"#?RGBE\nEXPOSURE=2\n\n-Y 1 +X 9\n\x80\x40\0\x81\x01\x01\x01\x08".to_vec();
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n\x02\x02\x20\0".to_vec();
    vec![
        ("runs.hdr".into(), picture([32, 8])),
        ("narrow.hdr".into(), picture([5, 3])),
        ("old-runs.hdr".into(), old),
        ("huge.hdr".into(), huge),
    ]
}

pub fn images() -> Vec<Seed> {
    let picture = DynamicImage::from(gradient(13, 7));
    let kinds = [
        ("rgba8", picture.clone()),
        ("rgb8", picture.to_rgb8().into()),
        ("gray8", picture.to_luma8().into()),
        ("gray-alpha16", picture.to_luma_alpha16().into()),
        ("rgba16", picture.to_rgba16().into()),
    ];
    let encoded = |picture: &DynamicImage, format: ImageFormat| {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("it is encoded");
        bytes.into_inner()
    };
    let mut seeds: Vec<Seed> = kinds
        .iter()
        .map(|(name, picture)| (format!("{name}.png"), encoded(picture, ImageFormat::Png)))
        .collect();
    seeds.extend([
        ("palette-1.png".into(), palette(png::BitDepth::One)),
        ("palette-4.png".into(), palette(png::BitDepth::Four)),
    ]);
    seeds.push(("rgba.webp".into(), encoded(&kinds[0].1, ImageFormat::WebP)));
    seeds.push(("rgb.webp".into(), encoded(&kinds[1].1, ImageFormat::WebP)));
    for (name, picture) in [("rgb", &kinds[1].1), ("gray", &kinds[2].1)] {
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, 60)
            .encode_image(picture)
            .expect("it is encoded");
        seeds.push((format!("{name}.jpg"), bytes));
    }
    seeds.push(("huge.png".into(), of_size(300_000, 300_000)));
    seeds.push(("within-the-limits.png".into(), of_size(8192, 8192)));
    seeds.push(("no-pixels.png".into(), of_size(0, 5)));
    seeds
}

fn palette(depth: png::BitDepth) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 16, 4);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(depth);
    encoder.set_palette(vec![9, 200, 30, 250, 10, 90]);
    encoder.set_trns(vec![128]);
    let row = 16 * depth as usize / 8;
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&vec![0x10; 4 * row]))
        .expect("it is encoded");
    bytes
}

/// A PNG whose header states this size, with the pixels of a small one.
fn of_size(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = preset_file::png_bytes(&[[9, 8, 7, 255]; 4], [2, 2]).expect("it is encoded");
    bytes[16..24].copy_from_slice(&[width.to_be_bytes(), height.to_be_bytes()].concat());
    with_checksums(&bytes)
}

fn with_checksums(png: &[u8]) -> Vec<u8> {
    (rasterlab_fuzz::views::PNG_CHUNKS.close)(png, png)
}

/// Pictures of 8 x 6 pixels.
pub fn saved() -> Vec<Seed> {
    let color: Vec<[u8; 4]> = gradient(8, 6).pixels().map(|pixel| pixel.0).collect();
    let frame = Frame {
        width: 8,
        height: 6,
        color: color.clone(),
        ..Frame::default()
    };
    let made_by = Provenance {
        adapter: "cpu".into(),
        driver: "oracle".into(),
    };
    let mut seeds: Vec<Seed> = Vec::new();
    for (name, text) in texts::PRESETS
        .iter()
        .filter(|(name, _)| !name.starts_with("not-"))
    {
        let preset_file =
            preset_file::parse(text, "seed").unwrap_or_else(|error| panic!("{name}: {error}"));
        let png = preset_file::png_with_preset(&frame, &preset_file, &made_by);
        seeds.extend(png.ok().map(|png| (format!("{name}.png"), png)));
    }
    let plain = preset_file::parse("schema = 2\n", "seed").expect("a preset");
    let of_film =
        preset_file::png_of_frame(&frame, &plain, &made_by, "cafe").expect("it is encoded");
    let bare = preset_file::png_bytes(&color, [8, 6]).expect("it is encoded");
    let mut wrong_checksum = of_film.clone();
    let last = wrong_checksum.len() - 1;
    wrong_checksum[last - 20] ^= 1;
    seeds.extend([
        ("frame.png".into(), of_film.clone()),
        ("bare.png".into(), bare.clone()),
        ("cut.png".into(), of_film[..of_film.len() - 30].to_vec()),
        ("wrong-checksum.png".into(), wrong_checksum),
        (
            "bytes-behind-the-end.png".into(),
            [&of_film[..], b"more"].concat(),
        ),
        ("huge.png".into(), of_size(300_000, 300_000)),
        (
            "many-unknown-keys.png".into(),
            with_text(&bare, &unknown_keys()),
        ),
        (
            "packed.png".into(),
            with_packed_text(&bare, &"name = \"a\"\n# ".repeat(2000)),
        ),
        (
            "path-elsewhere.png".into(),
            with_text(
                &bare,
                "schema = 2\n[scene]\npath = \"../../../../etc/passwd\"\n",
            ),
        ),
    ]);
    seeds
}

/// Each key is unknown and long: warnings were once made in quadratic time.
fn unknown_keys() -> String {
    let keys: String = (0..150)
        .map(|number| format!("{}{number} = 1\n", "key".repeat(12)))
        .collect();
    format!("schema = 2\n{keys}")
}

fn with_text(png: &[u8], text: &str) -> Vec<u8> {
    with_chunk(
        png,
        &[b"rasterlab preset\0\0\0\0\0", text.as_bytes()].concat(),
    )
}

/// As [`with_text`], deflated.
fn with_packed_text(png: &[u8], text: &str) -> Vec<u8> {
    use std::io::Write as _;
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    packed
        .write_all(text.as_bytes())
        .expect("memory takes all bytes");
    with_chunk(
        png,
        &[
            b"rasterlab preset\0\x01\0\0\0",
            &packed.finish().expect("memory takes all bytes")[..],
        ]
        .concat(),
    )
}

/// The picture with an iTXt chunk behind its header.
fn with_chunk(png: &[u8], data: &[u8]) -> Vec<u8> {
    let (head, rest) = png.split_at(33);
    let chunk = [&(data.len() as u32).to_be_bytes(), b"iTXt", data, &[0; 4]].concat();
    with_checksums(&[head, &chunk, rest].concat())
}
