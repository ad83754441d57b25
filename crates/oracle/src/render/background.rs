//! The background as the passes of the oracle read it.

use glam::DVec4;

use crate::scene::view::View;

/// The background in every row, gamma-encoded and rounded to the bytes that a picture holds.
pub fn background(view: &View) -> Vec<DVec4> {
    let encoded = |row: [u8; 4]| DVec4::from_array(row.map(f64::from)) / 255.0;
    view.background
        .rows(view.height)
        .into_iter()
        .map(encoded)
        .collect()
}
