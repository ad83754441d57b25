//! Arrays that `render` writes beside a picture, as NumPy files (.npy, version 1.0).

use crate::{
    frame::{Frame, NO_TRIANGLE},
    scene::view::View,
};

/// The header is padded so that the numbers begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// The triangle id of every pixel, or [`NO_TRIANGLE`]: little-endian u32 of shape (height, width),
/// top row first.
pub fn triangle_ids(frame: &Frame) -> Vec<u8> {
    npy(
        "<u4",
        frame,
        frame.triangle_id.iter().map(|id| id.to_le_bytes()),
    )
}

/// The distance from the eye along the viewing direction, in meters, of the visible sample of every
/// pixel, NaN without a triangle: little-endian f32 of shape (height, width), top row first. `view`
/// is the view that `frame` shows.
pub fn depths(frame: &Frame, view: &View) -> Vec<u8> {
    let depth_m = |(id, key): (&u32, &u32)| {
        let depth_m = if *id == NO_TRIANGLE {
            f64::NAN
        } else {
            view.depth_m(f64::from(f32::from_bits(*key)))
        };
        (depth_m as f32).to_le_bytes()
    };
    npy(
        "<f4",
        frame,
        frame.triangle_id.iter().zip(&frame.depth_key).map(depth_m),
    )
}

/// `numbers`, row-major, as an array with the shape of `frame`; `kind` is NumPy's name of their
/// type.
fn npy(kind: &str, frame: &Frame, numbers: impl Iterator<Item = [u8; 4]>) -> Vec<u8> {
    let mut header = format!(
        "{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}, {}), }}",
        frame.height, frame.width
    );
    // Before the header: 6 bytes of magic, 2 of version, 2 of its length; after it a line feed.
    let padding = (10 + header.len() + 1).next_multiple_of(ALIGNMENT) - (10 + header.len() + 1);
    header.extend(std::iter::repeat_n(' ', padding));
    header.push('\n');
    let length = u16::try_from(header.len())
        .expect("a header of one line")
        .to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes()]
        .concat()
        .into_iter()
        .chain(numbers.flatten())
        .collect()
}
