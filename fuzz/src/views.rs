//! What is packed inside of input: mutations there keep the lengths and checksums around it right,
//! so that they reach the code behind.

use std::io::{Read as _, Write as _};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use flate2::{Compression, read::DeflateDecoder, write::DeflateEncoder};

/// A part of input that is mutated by itself.
pub struct View {
    /// The part; none if the input has none.
    pub open: fn(&[u8]) -> Option<Vec<u8>>,
    /// The input with another part, given the whole input and the part.
    pub close: fn(&[u8], &[u8]) -> Vec<u8>,
}

/// The chunks of a PNG, with right checksums.
pub const PNG_CHUNKS: View = View {
    open: |png| png.starts_with(PNG).then(|| png.to_vec()),
    close: |_, png| with_right_checksums(png),
};

/// The preset in a picture that rasterlab saved.
pub const PNG_TEXT: View = View {
    open: |png| text_of(png).map(|(_, text)| text.to_vec()),
    close: with_text,
};

/// The JSON of a GLB.
pub const GLB_JSON: View = View {
    open: |glb| split_glb(glb).map(|[json, _]| json.to_vec()),
    close: |glb, json| joined(json, split_glb(glb).map_or(&[], |[_, binary]| binary)),
};

/// The binary chunk of a GLB.
pub const GLB_BINARY: View = View {
    open: |glb| split_glb(glb).map(|[_, binary]| binary.to_vec()),
    close: |glb, binary| joined(split_glb(glb).map_or(&[], |[json, _]| json), binary),
};

/// The TOML in a shared line.
pub const SHARED_TOML: View = View {
    open: unpack,
    close: |_, toml| pack(toml),
};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const SHARED: &str = "rasterlab1:";

/// Name and data of a PNG's chunk; the second is everything behind the chunk.
fn chunk(bytes: &[u8]) -> Option<([u8; 4], &[u8], &[u8])> {
    let (head, rest) = bytes.split_first_chunk::<8>()?;
    let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
    let (data, rest) = rest.split_at_checked(length)?;
    Some((
        [head[4], head[5], head[6], head[7]],
        data,
        rest.split_at_checked(4)?.1,
    ))
}

fn push_chunk(png: &mut Vec<u8>, name: [u8; 4], data: &[u8]) {
    let mut crc = flate2::Crc::new();
    crc.update(&name);
    crc.update(data);
    png.extend((data.len() as u32).to_be_bytes());
    png.extend(name);
    png.extend(data);
    png.extend(crc.sum().to_be_bytes());
}

/// The PNG with the checksum of each chunk that is whole; what follows the last of those is left as
/// it is.
fn with_right_checksums(bytes: &[u8]) -> Vec<u8> {
    let Some(mut rest) = bytes.strip_prefix(PNG) else {
        return bytes.to_vec();
    };
    let mut png = PNG.to_vec();
    while let Some((name, data, behind)) = chunk(rest) {
        push_chunk(&mut png, name, data);
        rest = behind;
    }
    png.extend_from_slice(rest);
    png
}

/// The keyword of the last text of a PNG with what stands before its text, and the text.
fn text_of(png: &[u8]) -> Option<(&[u8], &[u8])> {
    let mut rest = png.strip_prefix(PNG)?;
    let mut found = None;
    while let Some((name, data, behind)) = chunk(rest) {
        if &name == b"iTXt" {
            // Keyword, zero, two bytes of compression, language and translated keyword, both empty.
            let end = data.iter().position(|byte| *byte == 0)? + 5;
            found = data.split_at_checked(end).or(found);
        }
        rest = behind;
    }
    found
}

/// The PNG with another last text.
fn with_text(bytes: &[u8], text: &[u8]) -> Vec<u8> {
    let (Some((head, before)), Some(mut rest)) = (text_of(bytes), bytes.strip_prefix(PNG)) else {
        return bytes.to_vec();
    };
    let mut png = PNG.to_vec();
    while let Some((name, data, behind)) = chunk(rest) {
        let is_it = &name == b"iTXt" && data.strip_prefix(head) == Some(before);
        push_chunk(&mut png, name, if is_it { &[] } else { data });
        if is_it {
            png.truncate(png.len() - 12);
            push_chunk(&mut png, name, &[head, text].concat());
        }
        rest = behind;
    }
    png.extend_from_slice(rest);
    png
}

/// JSON and binary chunk of a GLB; a `.gltf` is JSON alone.
fn split_glb(glb: &[u8]) -> Option<[&[u8]; 2]> {
    if glb.first() == Some(&b'{') {
        return Some([glb, &[]]);
    }
    let word = |at: usize| {
        glb.get(at..at + 4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
    };
    let json = glb.get(20..20 + word(12)?)?;
    let at = 20 + json.len();
    let binary = word(at)
        .and_then(|length| glb.get(at + 8..at + 8 + length))
        .unwrap_or_default();
    Some([json, binary])
}

/// A GLB of these chunks.
pub fn joined(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    glb
}

fn unpack(line: &[u8]) -> Option<Vec<u8>> {
    let packed = std::str::from_utf8(line)
        .ok()?
        .trim()
        .strip_prefix(SHARED)?;
    let mut toml = Vec::new();
    DeflateDecoder::new(STANDARD.decode(packed).ok()?.as_slice())
        .take(1 << 16)
        .read_to_end(&mut toml)
        .ok()?;
    Some(toml)
}

fn pack(toml: &[u8]) -> Vec<u8> {
    let mut deflate = DeflateEncoder::new(Vec::new(), Compression::fast());
    deflate.write_all(toml).expect("memory takes all bytes");
    format!(
        "{SHARED}{}",
        STANDARD.encode(deflate.finish().expect("memory takes all bytes"))
    )
    .into_bytes()
}
