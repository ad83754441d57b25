//! Pictures that effects of files take as inputs, as `shaders/lib/image_file.wgsl` reads them, and
//! that of what surrounds the scene, as `shaders/lib/panorama.wgsl` does.

use std::{borrow::Cow, sync::Arc};

use crate::{
    effects::{
        EnabledEffect,
        image_file::{ImageFile, LIGHT_OF_BYTES},
    },
    scene::panorama::Panorama,
};

/// The pictures of a stack, in order. Instances of one file share theirs.
pub fn of_stack(stack: &[EnabledEffect]) -> Vec<Arc<ImageFile>> {
    let mut files: Vec<Arc<ImageFile>> = Vec::new();
    for image in stack.iter().flat_map(|enabled| enabled.effect.images()) {
        if !files.iter().any(|known| Arc::ptr_eq(known, &image.file)) {
            files.push(image.file.clone());
        }
    }
    files
}

/// The parameter words of every effect of a stack as kernels have them: a picture is its number in
/// [`of_stack`].
pub fn kernel_words(stack: &[EnabledEffect]) -> impl Iterator<Item = Cow<'_, [u32]>> {
    let files = of_stack(stack);
    stack.iter().map(move |enabled| {
        let mut words = Cow::Borrowed(enabled.words.as_slice());
        for image in enabled.effect.images() {
            let number = files.iter().position(|file| Arc::ptr_eq(file, &image.file));
            words.to_mut()[image.offset / 4] = number.unwrap_or(0) as u32;
        }
        words
    })
}

/// Everything that kernels read of pictures, word after word: linear light of every byte; how many
/// pictures there are; the first word and the size of each, and the first word of a panorama; then
/// texels, red in the lowest byte, and the words of the panorama.
pub fn words(files: &[Arc<ImageFile>], panorama: Option<&Panorama>) -> Vec<u32> {
    let mut words: Vec<u32> = LIGHT_OF_BYTES.iter().map(|light| light.to_bits()).collect();
    words.push(files.len() as u32);
    let mut first = words.len() + 2 * files.len() + 1;
    for file in files {
        words.extend([first as u32, file.size[0] | file.size[1] << 16]);
        first += file.texels.len();
    }
    words.push(first as u32);
    let texels = files.iter().flat_map(|file| &file.texels);
    words.extend(texels.map(|texel| u32::from_le_bytes(*texel)));
    words.extend(panorama.map_or([].as_slice(), Panorama::words));
    words
}
