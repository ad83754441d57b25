//! Stills: pictures that are drawn once, however many samples their pixels have.

use super::drawing::Renderer;
use crate::{
    accuracy::RenderScale,
    device::error::RenderError,
    effects::Stack,
    frame::{Frame, MeanPicture},
    plan::AccuracyRequest,
    scene::view::View,
};

impl Renderer {
    /// The picture of the last of `moments`, as it is shown. Where the adapter cannot hold all
    /// samples at once, it is the mean of as many pictures with one sample per pixel, each moved by
    /// a part of a pixel.
    pub async fn still(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
    ) -> Result<Frame, RenderError> {
        let scale = accuracy.scale();
        match self.draw_last(moments, accuracy).await {
            Err(RenderError::Scaled { .. }) if scale > RenderScale::Full => {
                let accuracy = AccuracyRequest {
                    pins: accuracy.pins.with(RenderScale::Full),
                    ..*accuracy
                };
                self.mean(moments, &accuracy, scale.factor() as u32).await
            }
            drawn => drawn,
        }
    }

    /// The mean of `side` by `side` pictures.
    async fn mean(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
        side: u32,
    ) -> Result<Frame, RenderError> {
        let mut mean = MeanPicture::default();
        for shift in MeanPicture::shifts(side) {
            let moved: Vec<(View, Stack)> = moments
                .iter()
                .map(|(view, stack)| (view.shifted(shift), stack.clone()))
                .collect();
            mean.add(self.draw_last(&moved, accuracy).await?);
        }
        Ok(mean.frame().expect("a side has at least one picture"))
    }
}
