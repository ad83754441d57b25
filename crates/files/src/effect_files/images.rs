//! Pictures that an effect file names: found in the folder of the file, or inside its text. Every
//! limit is checked before memory is taken.

use std::{io::Cursor, ops::Range, path::Path, sync::Arc};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    error::{EffectError, Text},
    parameters::NamedImage,
};
use crate::{
    effects::{
        EMBEDDED_IMAGE, EffectSource,
        image_file::{ImageFile, ImageInput},
    },
    host::{disk, stays_inside},
};

/// Most bytes of all pictures of an effect, as files.
pub const MAX_IMAGE_BYTES: usize = 128 << 10;
/// Most texels of all pictures of an effect.
const MAX_TEXELS: u64 = 1 << 20;
/// Most bytes of the name of a picture that an error marks: a picture inside the text has many.
const MAX_MARKED: usize = 40;
/// Most texels along a side.
const MAX_SIDE: u32 = 4096;

/// The pictures that `text` names, where `folder` is that of its file.
///
/// # Errors
/// The first picture that is outside of the folder, not there, no PNG, or too large.
pub fn read(
    text: &Text<'_>,
    images: &[NamedImage],
    folder: Option<&Path>,
) -> Result<Vec<ImageInput>, EffectError> {
    let (mut bytes_left, mut texels_left) = (MAX_IMAGE_BYTES, MAX_TEXELS);
    let input = |image: &NamedImage| {
        let file = bytes_of(text.text, &image.named, folder, bytes_left)
            .and_then(|png| decoded(png, texels_left));
        let file = file.map_err(|reason| {
            let message = format!("the picture {} {reason}", image.member);
            text.error(
                image.named.start,
                image.named.len().min(MAX_MARKED),
                message,
            )
        })?;
        bytes_left -= file.png.len();
        texels_left -= file.texels.len() as u64;
        Ok(ImageInput {
            name: image.member.clone(),
            offset: image.offset,
            named: image.named.clone(),
            file: Arc::new(file),
        })
    };
    images.iter().map(input).collect()
}

/// Are the pictures of an effect those that its text now leads to from `folder`?
pub fn are_current(source: &EffectSource, folder: Option<&Path>) -> bool {
    source.images.iter().all(|image| {
        let found = bytes_of(&source.written, &image.named, folder, MAX_IMAGE_BYTES);
        found.is_ok_and(|png| png == image.file.png)
    })
}

/// Bytes of a text that pictures inside it take.
pub fn embedded_bytes(text: &str, images: &[NamedImage]) -> usize {
    let named = images.iter().map(|image| &text[image.named.clone()]);
    named
        .filter(|named| named[1..].starts_with(EMBEDDED_IMAGE))
        .map(str::len)
        .sum()
}

/// The bytes of a picture, at most `most`.
///
/// # Errors
/// Completes a sentence that begins with the picture.
fn bytes_of(
    text: &str,
    named: &Range<usize>,
    folder: Option<&Path>,
    most: usize,
) -> Result<Vec<u8>, String> {
    let too_large = |bytes: u64| {
        format!(
            "is a file of {bytes} bytes; all pictures of an effect have at most {MAX_IMAGE_BYTES} together"
        )
    };
    let name = &text[named.start + 1..named.end - 1];
    if let Some(base64) = name.strip_prefix(EMBEDDED_IMAGE) {
        // Its last four characters may stand for one byte.
        let least = (base64.len() / 4 * 3).saturating_sub(2);
        if least > most {
            return Err(too_large(least as u64));
        }
        let png = STANDARD
            .decode(base64)
            .map_err(|_| "is cut off or garbled; name a PNG instead")?;
        return match png.len() > most {
            true => Err(too_large(png.len() as u64)),
            false => Ok(png),
        };
    }
    let path = Path::new(name);
    if !stays_inside(path) {
        return Err(
            "lies outside of the folder of the effect; put the PNG beside the file and write its name alone"
                .into(),
        );
    }
    let folder = folder.ok_or("is a file, and this effect has no folder to find it in")?;
    let absent = |error: std::io::Error| format!("cannot be read: {error}");
    let place = disk::canonical(&folder.join(path)).map_err(absent)?;
    // A file named without a folder lies in the current one.
    let inside = disk::canonical(folder).or_else(|_| disk::canonical(Path::new(".")));
    if !inside.is_ok_and(|inside| place.starts_with(inside)) {
        return Err("is a link that leads out of the folder of the effect; put the PNG itself beside the file".into());
    }
    match disk::size_of(&place).map_err(absent)? {
        None => Err("is no regular file".into()),
        Some(bytes) if bytes > most as u64 => Err(too_large(bytes)),
        Some(_) => disk::read(&place).map_err(absent),
    }
}

/// Decodes a picture of at most `most` texels.
///
/// # Errors
/// Completes a sentence that begins with the picture.
fn decoded(png: Vec<u8>, most: u64) -> Result<ImageFile, String> {
    let faulty = |error: image::ImageError| {
        let reason = error.to_string().replace('\n', " ");
        format!(
            "is no PNG that can be read: {}",
            reason.trim_end_matches('.')
        )
    };
    let mut reader =
        image::ImageReader::with_format(Cursor::new(png.as_slice()), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    // Far more than a picture within the limits takes, which its header is checked for below.
    limits.max_alloc = Some(64 << 20);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(faulty)?;
    let (width, height) = image::ImageDecoder::dimensions(&decoder);
    let texels = u64::from(width) * u64::from(height);
    if texels == 0 || width.max(height) > MAX_SIDE || texels > most {
        return Err(format!(
            "has {width} x {height} texels; allowed: at most {MAX_SIDE} along each side, and {MAX_TEXELS} in all pictures of an effect together"
        ));
    }
    let pixels = image::DynamicImage::from_decoder(decoder)
        .map_err(faulty)?
        .into_rgba8();
    let texels = bytemuck::pod_collect_to_vec(pixels.as_raw());
    Ok(ImageFile {
        size: [width, height],
        texels,
        png,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_larger_than_the_limit_is_refused_by_its_header() {
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, 4096, 4096);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::One);
        let mut writer = encoder.write_header().expect("memory takes all bytes");
        writer
            .write_image_data(&vec![0; 4096 * 4096 / 8])
            .expect("it has all its texels");
        writer.finish().expect("memory takes all bytes");
        let error = decoded(png, MAX_TEXELS).expect_err("it is too large");
        assert!(error.starts_with("has 4096 x 4096 texels"), "{error}");
    }
}
