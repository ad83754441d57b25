//! Images of textures: PNG, JPEG and WebP, decoded within [`limits`] and only at the size in their
//! header.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits as DecoderLimits};

use super::{
    error::LoadError,
    limits::{self, Limits},
    other_file,
};
use crate::scene::texture::Image;

/// The format of an image, which its first bytes tell.
///
/// # Errors
/// It is none that is read.
pub fn format_of(bytes: &[u8]) -> Result<ImageFormat, LoadError> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Ok(ImageFormat::Png),
        [0xff, 0xd8, 0xff, ..] => Ok(ImageFormat::Jpeg),
        bytes if bytes.starts_with(b"RIFF") && bytes[4..].get(4..8) == Some(b"WEBP") => {
            Ok(ImageFormat::WebP)
        }
        other => {
            let what = other_file::named(other).map_or(String::new(), |what| format!("{what}; "));
            Err(LoadError::new(format!(
                "{what}it is neither PNG, JPEG nor WebP; convert it to one of them"
            )))
        }
    }
}

/// An image with at most as many texels as are drawn, and what is told where it had more.
pub fn fitted(image: Image) -> (Image, Option<String>) {
    let most = limits::IMAGE_SIDE;
    let [width, height] = image.size();
    if width.max(height) <= most {
        return (image, None);
    }
    let image = image.at_most(most);
    let [w, h] = image.size();
    let note = format!(
        "{} has {width} x {height} texels; it is drawn with {w} x {h}, at most {most} along each side",
        image.name
    );
    (image, Some(note))
}

/// Decodes an image, besides others of `taken` bytes. Its header is checked against the limits
/// before anything is decoded.
pub fn decode(
    bytes: &[u8],
    format: ImageFormat,
    allowed: &Limits,
    taken: u64,
) -> Result<([u32; 2], Vec<[u8; 4]>), LoadError> {
    let failed = |error: image::ImageError| {
        LoadError::new(format!(
            "cannot decode the image: {}",
            error.to_string().replace('\n', " ")
        ))
    };
    let left = allowed.total_bytes - taken;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut most = DecoderLimits::default();
    // Up to eight bytes per texel while it is decoded, and as much again for the decoder.
    most.max_alloc = Some(4 * left.max(1 << 20));
    reader.limits(most);
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let side = limits::LARGEST_IMAGE_SIDE;
    if width == 0 || height == 0 || width.max(height) > side {
        return Err(LoadError::new(format!(
            "it has {width} x {height} texels; allowed: 1 to {side} along each side"
        )));
    }
    let decoded = 4 * u64::from(width) * u64::from(height);
    if decoded > left {
        return Err(allowed.exceeded(
            format_args!("with it the decoded images have {} bytes", taken + decoded),
            allowed.total_bytes,
        ));
    }
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(failed)?
        .into_rgba8();
    Ok((
        [width, height],
        bytemuck::pod_collect_to_vec(pixels.as_raw()),
    ))
}
