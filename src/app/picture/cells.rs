//! Cells: small pictures that are drawn on the window's device, in the background: a sweep's
//! contact sheet, and the newest seeds.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use egui::ColorImage;

use super::screen::Inputs;
use crate::gpu::{Gpu, Renderer};

/// Whose picture a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellOf {
    /// A picture of the sweep with this number, by its index.
    Sweep { number: u64, index: usize },
    /// The picture of a seed.
    Seed(u32),
}

/// Pictures to be drawn.
pub struct Cells {
    pub cells: Vec<(CellOf, Inputs)>,
    /// Ends the work before its next picture.
    pub is_canceled: Arc<AtomicBool>,
}

/// A picture, or why it cannot be drawn, in a sentence for people.
pub type CellResult = Result<ColorImage, String>;

/// Draws cells one after another and hands out each.
pub async fn draw(gpu: &Arc<Gpu>, cells: &Cells, mut take: impl FnMut(CellOf, CellResult)) {
    let mut renderer = Renderer::new(gpu.clone());
    for (of, inputs) in &cells.cells {
        if cells.is_canceled.load(Ordering::Relaxed) {
            return;
        }
        take(*of, picture(&mut renderer, inputs).await);
    }
}

async fn picture(
    renderer: &mut Renderer,
    Inputs {
        scene,
        view,
        stack,
        accuracy,
    }: &Inputs,
) -> CellResult {
    renderer
        .set_scene(scene)
        .await
        .map_err(|error| error.to_string())?;
    let frame = renderer
        .capture(view, stack, accuracy)
        .await
        .map_err(|error| error.to_string())?
        .into_shown();
    Ok(ColorImage::from_rgba_unmultiplied(
        [frame.width as usize, frame.height as usize],
        &frame.color.concat(),
    ))
}

/// The size of a cell `width` pixels wide with the aspect ratio of a picture.
pub fn size(width: u32, [of_width, of_height]: [u32; 2]) -> [u32; 2] {
    let height = f64::from(width) * f64::from(of_height) / f64::from(of_width.max(1));
    [width, (height.round() as u32).clamp(width / 4, 2 * width)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_the_aspect_of_its_picture_within_limits() {
        assert_eq!(size(160, [1280, 800]), [160, 100]);
        assert_eq!(
            [
                size(160, [10, 8000]),
                size(160, [8000, 10]),
                size(160, [0, 0])
            ],
            [[160, 320], [160, 40], [160, 40]]
        );
    }
}
