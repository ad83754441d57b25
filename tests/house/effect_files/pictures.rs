//! Pictures that an effect takes as inputs are found beside its file alone, travel inside its text
//! when it is shared, and are read again when they change.

use std::path::Path;

use rasterlab::{
    effect_files::{Catalog, read_beside},
    preset_file::{from_line, load_with, to_line},
};

const EFFECT: &str = "// Ink: a sheet of paper.
//@ use lib/color
struct Ink {
    /// The sheet.
    @image(\"sheet.png\") sheet: u32,
    @range(0, 1, 0.5) amount: f32,
    @image( \"sheet.png\" ) again: u32,
}
fn ink(at: ImageAt, p: Ink) -> vec4f {
    let size = vec2f(image_file_size(p.again)); // \"a comment\"
    return p.amount * image_file_at(p.sheet, image_middle(at) / size) + image_file_tiled(p.again, vec2f(2.5));
}
";
const PRESET: &str = "schema = 2\n[effects.ink]\namount = 0.25\n";

/// A PNG of so many texels, all of this brightness.
fn png(size: [u32; 2], brightness: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    let texels = vec![brightness; (size[0] * size[1]) as usize];
    writer.write_image_data(&texels).unwrap();
    writer.finish().unwrap();
    bytes
}

fn write(folder: &Path, name: &str, bytes: &[u8]) {
    std::fs::write(folder.join(name), bytes).unwrap();
}

#[test]
fn a_shared_preset_brings_the_pictures_of_its_effects() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "ink.wgsl", EFFECT.as_bytes());
    write(folder.path(), "sheet.png", &png([3, 2], 90));
    write(folder.path(), "mine.toml", PRESET.as_bytes());
    let catalog = Catalog::of_folders([folder.path()]);
    let preset = load_with(&folder.path().join("mine.toml"), &catalog).unwrap();
    let brought = from_line(&to_line(&preset)).unwrap();
    assert_eq!(brought.brought_effects, ["ink"]);
    let here = &preset.preset.stack.0[0].effect;
    let there = &brought.preset.stack.0[0].effect;
    assert_eq!(here.images().len(), 2);
    assert_eq!(here.images()[0].file.size, [3, 2]);
    assert_eq!(here.images()[0].file, there.images()[0].file);
    // Numbers of pictures stand among the words, and shared text is shared as it is.
    assert_eq!(here.defaults, [0, 0.5_f32.to_bits(), 1]);
    assert_eq!(to_line(&brought), to_line(&preset));
}

#[test]
fn a_picture_that_changes_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "ink.wgsl", EFFECT.as_bytes());
    write(folder.path(), "sheet.png", &png([3, 2], 90));
    let first = Catalog::of_folders([folder.path()]);
    let same = first.reread([folder.path()]);
    assert_eq!(first, same);
    write(folder.path(), "sheet.png", &png([3, 2], 91));
    let changed = first.reread([folder.path()]);
    let texel = |catalog: &Catalog| {
        let effect = catalog.find("ink").unwrap().unwrap();
        effect.images()[0].file.texels[0]
    };
    assert_eq!([texel(&same)[0], texel(&changed)[0]], [90, 91]);
}

#[test]
fn what_is_no_picture_beside_the_file_is_refused() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("effects");
    std::fs::create_dir(&folder).unwrap();
    write(outer.path(), "sheet.png", &png([1, 1], 0));
    write(&folder, "text.png", b"no PNG");
    write(&folder, "wide.png", &png([4097, 1], 0));
    write(&folder, "long.png", &vec![0; 200_000]);
    #[cfg(unix)]
    std::os::unix::fs::symlink(outer.path().join("sheet.png"), folder.join("link.png")).unwrap();
    let cases = [
        ("\"../sheet.png\"", "lies outside of the folder"),
        ("\"/sheet.png\"", "lies outside of the folder"),
        ("\"none.png\"", "cannot be read"),
        ("\"text.png\"", "is no PNG that can be read"),
        ("\"wide.png\"", "has 4097 x 1 texels; allowed: at most 4096"),
        (
            "\"long.png\"",
            "is a file of 200000 bytes; all pictures of an effect have at most",
        ),
        #[cfg(unix)]
        ("\"link.png\"", "is a link that leads out of the folder"),
        ("\"data:image/png;base64,A*\"", "is cut off or garbled"),
        ("sheet", "@image takes the name of a PNG in quotation marks"),
        (
            "\"a.png\", \"b.png\"",
            "@image takes the name of a PNG in quotation marks",
        ),
    ];
    for (named, reason) in cases {
        let text = EFFECT.replacen("\"sheet.png\"", named, 1);
        let error = read_beside("ink.wgsl", "ink", &text, Some(&folder)).unwrap_err();
        assert!(error.message.contains(reason), "{error}\n{named}");
        super::check_telling(&error, &text);
    }
    let error = read_beside("ink.wgsl", "ink", EFFECT, None).unwrap_err();
    assert!(error.message.contains("has no folder"), "{error}");
}
