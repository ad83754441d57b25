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

    /// The bytes of a file that is named in `folder`, which lies below that of the model, or else in
    /// that of the model. A name that leads elsewhere, as those of other machines do, stands for the
    /// file of that name there. `\ ` may stand for a space.
    ///
    /// # Errors
    /// There is no such file, or it is too large.
    pub fn file(&mut self, folder: &Path, name: &str) -> Result<Vec<u8>, LoadError> {
        let most = self.left.min(self.limits.file_bytes);
        let mut failed = None;
        let plain = name.replace("\\ ", " ");
        for name in [name, &plain] {
            for folder in [folder, Path::new("")] {
                let read = match path(folder, name) {
                    Ok(path) => {
                        (self.read)(&path, most).map_err(|error| error.within(quoted(name)))
                    }
                    Err(reason) => {
                        Err(LoadError::new(reason).after(format_args!("{} ", quoted(name))))
                    }
                };
                match read {
                    Ok(bytes) => {
                        self.left = self.left.saturating_sub(bytes.len() as u64);
                        return Ok(bytes);
                    }
                    Err(error) => drop(failed.get_or_insert(error)),
                }
                if folder == Path::new("") {
                    break;
                }
            }
            if name == plain {
                break;
            }
        }
        Err(failed.unwrap_or_else(|| LoadError::new("it has no name")))
    }

    /// The texture that shows the first of the images `names` that can be read, which messages call
    /// `place`; none, with a message about the first, if none can.
    pub fn texture(
        &mut self,
        folder: &Path,
        names: &[String],
        place: &str,
    ) -> Result<Option<Texture>, LoadError> {
        let Some((first, others)) = names.split_first() else {
            return Ok(None);
        };
        let key = path(folder, first).unwrap_or_default();
        if let Some(&image) = self.known.get(&key) {
            return Ok(image.map(Texture::plain));
        }
        let mut found = self.image(folder, first);
        for other in others {
            if found.is_ok() {
                break;
            }
            found = self.image(folder, other).or(found);
        }
        let image = match found {
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
        let image = Image::new(&format!("image {}", quoted(name)), size, texels);
        let (image, note) = images::fitted(image);
        self.notes.extend(note);
        self.decoded += image.bytes();
        Ok(image)
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
