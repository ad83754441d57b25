//! Stills: pictures that are drawn once, however many samples their pixels have.

use super::{error::RenderError, renderer::Renderer};
use crate::{
    accuracy::RenderScale,
    effects::Stack,
    frame::{Frame, LightSum, linear_bytes},
    plan::AccuracyRequest,
    scene::view::View,
};

impl Renderer {
    /// The picture of the last of `moments`, as it is shown. Where the adapter cannot hold all
    /// samples at once, it is the mean of as many pictures with one sample per pixel, each moved by
    /// a part of a pixel.
    ///
    /// # Errors
    /// As [`Renderer::capture_last`].
    pub async fn still(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
    ) -> Result<Frame, RenderError> {
        let scale = accuracy.scale();
        match self.capture_last(moments, accuracy).await {
            Err(RenderError::Scaled { .. }) if scale > RenderScale::Full => {
                let accuracy = AccuracyRequest {
                    pins: accuracy.pins.with(RenderScale::Full),
                    ..*accuracy
                };
                self.mean(moments, &accuracy, scale.factor() as u32).await
            }
            drawn => Ok(drawn?.into_shown()),
        }
    }

    /// The mean of `side` by `side` pictures, in linear light. Its integers are those of the last
    /// one, as [`Frame::shown`] takes them.
    async fn mean(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
        side: u32,
    ) -> Result<Frame, RenderError> {
        let light = linear_bytes();
        let (mut sums, mut last) = (Vec::new(), None);
        for sample in 0..side * side {
            let shift = [sample % side, sample / side]
                .map(|i| 0.5 - (f64::from(i) + 0.5) / f64::from(side));
            let moved: Vec<(View, Stack)> = moments
                .iter()
                .map(|(view, stack)| (view.shifted(shift), stack.clone()))
                .collect();
            let frame = self.capture_last(&moved, accuracy).await?.into_shown();
            sums.resize(frame.color.len(), LightSum::default());
            let weight = 1.0 / f64::from(side * side);
            for (sum, pixel) in sums.iter_mut().zip(&frame.color) {
                sum.add(pixel, weight, &light);
            }
            last = Some(frame);
        }
        let color = sums.iter().map(LightSum::bytes).collect();
        Ok(Frame {
            color,
            ..last.expect("a side has at least one picture")
        })
    }
}
