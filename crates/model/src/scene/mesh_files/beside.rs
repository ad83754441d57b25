//! Files beside a model: its material files, and the images of its textures.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use crate::scene::{
    gltf::{LoadError, ReadFile, error::quoted, images, limits::Limits, notes::Notes, uri},
    texture::{Image, Texture},
};

/// Reads the files beside a model.
pub struct Beside<'a, 'b> {
    read: &'a mut ReadFile<'b>,
    notes: &'a Notes,
    limits: Limits,
    /// Bytes that the model may still read from files.
    left: u64,
    /// The images that were decoded.
    pub images: Vec<Image>,
    /// Decoded size of all images.
    decoded: u64,
    /// Index of each image by its path; none of one that cannot be read.
    known: HashMap<PathBuf, Option<usize>>,
}

impl<'a, 'b> Beside<'a, 'b> {
    /// Of a model file of so many bytes. `limits` are those of files.
    pub fn of(file: u64, limits: Limits, read: &'a mut ReadFile<'b>, notes: &'a Notes) -> Self {
        Self {
            read,
            notes,
            limits,
            left: limits.total_bytes.saturating_sub(file),
            images: Vec::new(),
            decoded: 0,
            known: HashMap::new(),
        }
    }

    /// The bytes of a file that is named in `folder`, which lies below that of the model. A name
    /// that leads elsewhere, as those of other machines do, stands for the file of that name in
    /// `folder`.
    ///
    /// # Errors
    /// There is no such file, or it is too large.
    pub fn file(&mut self, folder: &Path, name: &str) -> Result<Vec<u8>, LoadError> {
        let path = path(folder, name)
            .map_err(|reason| LoadError::new(reason).after(format_args!("{} ", quoted(name))))?;
        let most = self.left.min(self.limits.file_bytes);
        let bytes = (self.read)(&path, most).map_err(|error| error.within(quoted(name)))?;
        self.left = self.left.saturating_sub(bytes.len() as u64);
        Ok(bytes)
    }

    /// The texture that shows the image `name`, which messages call `place`; none, with a message,
    /// if it cannot be read.
    pub fn texture(
        &mut self,
        folder: &Path,
        name: &str,
        place: &str,
    ) -> Result<Option<Texture>, LoadError> {
        let key = path(folder, name).unwrap_or_default();
        if let Some(&image) = self.known.get(&key) {
            return Ok(image.map(Texture::plain));
        }
        let image = match self.image(folder, name) {
            Ok(image) => {
                self.images.push(image.with_mipmaps());
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let reason = error.within(place).of_part()?;
                self.notes.fault(|| format!("{reason}; it is left out"));
                None
            }
        };
        self.known.insert(key, image);
        Ok(image.map(Texture::plain))
    }

    fn image(&mut self, folder: &Path, name: &str) -> Result<Image, LoadError> {
        let bytes = self.file(folder, name)?;
        let decoded = images::format_of(&bytes)
            .and_then(|format| images::decode(&bytes, format, &self.limits, self.decoded));
        let (size, texels) = decoded.map_err(|error| error.within(quoted(name)))?;
        self.decoded += 4 * texels.len() as u64;
        Ok(Image::new(&format!("image {}", quoted(name)), size, texels))
    }
}

/// The path of a file that is named in `folder`.
pub fn path(folder: &Path, name: &str) -> Result<PathBuf, &'static str> {
    let joined = folder.join(name.replace('\\', "/"));
    let inside = joined.to_str().ok_or("is not UTF-8").and_then(uri::inside);
    inside.or_else(|_| {
        let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
        uri::inside(last).map(|last| folder.join(last))
    })
}
