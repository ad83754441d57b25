//! Pictures that the effects of a stack take as inputs and that of what surrounds the scene, on the
//! device.

use std::sync::Arc;

use crate::{
    device::{Gpu, error::RenderError},
    effects::{Stack, image_file::ImageFile},
    layout::TextureId,
    resources::textures::WordTexture,
    scene::panorama::Panorama,
    shader::image_files,
};

/// The pictures of a stack and a scene.
pub struct ImageFiles {
    files: Vec<Arc<ImageFile>>,
    panorama: Option<Arc<Panorama>>,
    pub texture: WordTexture,
}

impl ImageFiles {
    /// Those of `stack` and `panorama`, of which there may be none; `known` where they are the same.
    pub async fn of(
        gpu: &Gpu,
        stack: &Stack,
        panorama: Option<&Arc<Panorama>>,
        known: Option<Self>,
    ) -> Result<Option<Self>, RenderError> {
        let files = image_files::of_stack(&stack.0);
        let is_same = |known: &Self| known.files == files && known.panorama.as_ref() == panorama;
        match known.filter(is_same) {
            Some(known) => Ok(Some(known)),
            None if files.is_empty() && panorama.is_none() => Ok(None),
            None => {
                let words = image_files::words(&files, panorama.map(|panorama| &**panorama));
                let texture = WordTexture::of_words(gpu, TextureId::ImageFiles, words).await?;
                Ok(Some(Self {
                    files,
                    panorama: panorama.cloned(),
                    texture,
                }))
            }
        }
    }
}
