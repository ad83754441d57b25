//! The image hook: finish the pixel.

use std::sync::Arc;

use glam::DVec4;

/// A finished pixel of the picture; an image effect changes its color and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Gamma-encoded RGBA so far, each 0 to 1: what the picture will hold, before it is rounded to
    /// bytes.
    pub color: DVec4,
    pub x: u32,
    pub y: u32,
    /// As the `step_offset` of a surface.
    pub step_offset: f64,
}

/// What an image effect may read: the integers of the whole picture, row-major.
pub struct Picture<'a> {
    pub width: u32,
    pub height: u32,
    /// Global triangle id per pixel, `u32::MAX` without one.
    pub triangle_ids: &'a [u32],
    /// Depth key per pixel, 0 without a triangle id.
    pub keys: &'a [u32],
    /// First triangle of every draw, rising.
    pub draws: &'a [u32],
    /// The previous picture, gamma-encoded; none for the first.
    pub previous: Option<&'a [[u8; 4]]>,
    /// Gamma-encoded RGBA of the background in every row, in whole bytes.
    pub background: &'a [[u8; 4]],
}

impl Picture<'_> {
    /// The background in row `y`, gamma-encoded RGBA, each 0 to 1.
    pub fn background(&self, y: u32) -> DVec4 {
        DVec4::from_array(self.background[y as usize].map(f64::from)) / 255.0
    }

    /// Does the pixel lie in the picture?
    pub fn has(&self, x: i64, y: i64) -> bool {
        (0..i64::from(self.width)).contains(&x) && (0..i64::from(self.height)).contains(&y)
    }

    /// Triangle id if any, depth key and draw of a pixel; those of the nearest pixel of the picture
    /// when it lies outside.
    pub fn at(&self, x: i64, y: i64) -> (Option<u32>, u32, u32) {
        let x = x.clamp(0, i64::from(self.width) - 1) as usize;
        let y = y.clamp(0, i64::from(self.height) - 1) as usize;
        let triangle_id = self.triangle_ids[y * self.width as usize + x];
        let draw = self.draws.partition_point(|&first| first <= triangle_id) as u32;
        (
            (triangle_id != u32::MAX).then_some(triangle_id),
            self.keys[y * self.width as usize + x],
            draw,
        )
    }
}

/// How an image effect finishes a pixel, given its parameter words.
pub type FinishFunction = dyn Fn(Pixel, &Picture<'_>, &[u32]) -> Pixel + Send + Sync;

/// An image effect's function over its parameter words.
#[derive(Clone)]
pub struct ImageHook {
    pub reads_previous: bool,
    pub finish: Arc<FinishFunction>,
}
