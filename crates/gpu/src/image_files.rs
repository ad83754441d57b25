//! Pictures that the effects of a stack take as inputs, on the device.

use std::sync::Arc;

use super::{device::Gpu, error::RenderError, resource_id::TextureId, textures::WordTexture};
use crate::{
    effects::{Stack, image_file::ImageFile},
    shader::image_files,
};

/// The pictures of a stack.
pub struct ImageFiles {
    files: Vec<Arc<ImageFile>>,
    pub texture: WordTexture,
}

impl ImageFiles {
    /// Those of `stack`, of which there may be none; `known` where they are the same.
    ///
    /// # Errors
    /// When they do not fit.
    pub async fn of(
        gpu: &Gpu,
        stack: &Stack,
        known: Option<Self>,
    ) -> Result<Option<Self>, RenderError> {
        let files = image_files::of_stack(&stack.0);
        match known.filter(|known| known.files == files) {
            Some(known) => Ok(Some(known)),
            None if files.is_empty() => Ok(None),
            None => {
                let words = image_files::words(&files);
                let texture = WordTexture::of_words(gpu, TextureId::ImageFiles, words).await?;
                Ok(Some(Self { files, texture }))
            }
        }
    }
}
