//! Where a picture goes in the window.

use egui::{Rect, vec2};

/// All of `rect`, or the largest rectangle of the picture's aspect ratio in its middle, so that a
/// picture from before a resize is not stretched.
pub fn fit_aspect(rect: Rect, [width, height]: [u32; 2]) -> Rect {
    let scale = (rect.width() / width as f32).min(rect.height() / height as f32);
    let size = vec2(width as f32, height as f32) * scale;
    let fits = (size - rect.size()).abs().max_elem() < 4.0;
    if fits {
        rect
    } else {
        Rect::from_center_size(rect.center(), size)
    }
}

/// Size of a rectangle in whole points, at least 1 x 1.
pub fn whole_size(rect: Rect) -> [u32; 2] {
    let size = rect.size().round();
    [size.x.max(1.0) as u32, size.y.max(1.0) as u32]
}
