//! What a file is that is no model: said instead of what a parser finds wrong with it.

/// How files begin, and what is said of them.
const BEGINNINGS: &[(&[u8], &str)] = &[
    (
        b"version https://git-lfs.github.com/",
        "it is a Git LFS pointer, which stands for the file; fetch the file with \"git lfs pull\"",
    ),
    (b"PK\x03\x04", "it is a zip archive; unpack it first"),
    (b"\x1f\x8b", "it is a gzip archive; unpack it first"),
    (
        b"7z\xbc\xaf\x27\x1c",
        "it is a 7-Zip archive; unpack it first",
    ),
    (b"Rar!", "it is a RAR archive; unpack it first"),
    (
        b"\x28\xb5\x2f\xfd",
        "it is a Zstandard archive; unpack it first",
    ),
    (b"\x89PNG", "it is a PNG picture"),
    (b"\xff\xd8\xff", "it is a JPEG picture"),
    (b"GIF8", "it is a GIF picture"),
    (b"\xabKTX", "it is a KTX texture"),
    (b"DDS ", "it is a DDS texture"),
    (b"%PDF", "it is a PDF document"),
    (b"Kaydara FBX", "it is an FBX model; convert it to glTF"),
    (b"; FBX", "it is an FBX model; convert it to glTF"),
    (b"BLENDER", "it is a Blender file; export it as glTF"),
    (b"#usda", "it is a USD scene; convert it to glTF"),
    (b"PXR-USDC", "it is a USD scene; convert it to glTF"),
    (b"glTF", "it is a glTF model; let its name end with .glb"),
    (b"ply\n", "it is a PLY model; let its name end with .ply"),
    (b"ply\r\n", "it is a PLY model; let its name end with .ply"),
    (b"solid ", "it is an STL model; let its name end with .stl"),
    (b"b3dm", "it is a 3D tile; convert it to glTF"),
    (b"i3dm", "it is a 3D tile; convert it to glTF"),
    (b"\xff\xfe", "it is UTF-16 text; save it as UTF-8"),
    (b"\xfe\xff", "it is UTF-16 text; save it as UTF-8"),
];

/// How texts begin, in small letters and after white space.
const TEXTS: &[(&str, &str)] = &[
    (
        "<!doctype html",
        "it is an HTML page, perhaps one that a download ended at; fetch the file itself",
    ),
    (
        "<html",
        "it is an HTML page, perhaps one that a download ended at; fetch the file itself",
    ),
    (
        "<?xml",
        "it is an XML file; a model of another format must be converted to glTF",
    ),
];

/// What a file is instead, and what to do; nothing where its beginning does not tell.
pub fn named(bytes: &[u8]) -> Option<&'static str> {
    if bytes.is_empty() {
        return Some("it is empty");
    }
    let by_bytes = BEGINNINGS
        .iter()
        .find(|(start, _)| bytes.starts_with(start));
    let text: String = String::from_utf8_lossy(&bytes[..bytes.len().min(200)])
        .trim_start_matches('\u{feff}')
        .trim_start()
        .to_lowercase();
    let by_text = || {
        TEXTS
            .iter()
            .find(|(start, _)| text.starts_with(start))
            .map(|(_, what)| *what)
    };
    by_bytes.map(|(_, what)| *what).or_else(by_text)
}
