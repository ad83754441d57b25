//! Bookmarks: cameras that a preset keeps under names, in the order in which they were added.

use super::{Preset, list_names};
use crate::{legible::is_hidden, scene::camera::Camera};

/// Most bookmarks of a preset.
pub const MAX_BOOKMARKS: usize = 64;
/// Most characters of a bookmark's name.
pub const MAX_BOOKMARK_CHARS: usize = 40;

/// A camera under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Bookmark {
    /// Unique in its preset, at most [`MAX_BOOKMARK_CHARS`] characters.
    pub name: String,
    pub camera: Camera,
}

/// Is this a name for a bookmark?
/// Errors: what a name must be, in words that follow the name.
pub fn check_bookmark_name(name: &str) -> Result<(), String> {
    let length = name.chars().count();
    if name.trim() == name
        && (1..=MAX_BOOKMARK_CHARS).contains(&length)
        && !name.chars().any(is_hidden)
    {
        return Ok(());
    }
    Err(format!(
        "must have 1 to {MAX_BOOKMARK_CHARS} visible characters, and no space at either end"
    ))
}

impl Preset {
    /// The camera of a bookmark.
    /// Errors: there is none of this name: in a sentence that names those that are there.
    pub fn bookmark(&self, name: &str) -> Result<Camera, String> {
        let found = self.bookmarks.iter().find(|mark| mark.name == name);
        found.map(|mark| mark.camera).ok_or_else(|| {
            let names = self.bookmarks.iter().map(|mark| &mark.name);
            format!(
                "the preset has no bookmark {name:?}{}",
                list_names(
                    names,
                    "add a table [bookmarks.NAME] with the keys of [camera]"
                )
            )
        })
    }

    /// Keeps `camera` as the last bookmark, `view 1` or the first such name that is free.
    /// Errors: the preset has [`MAX_BOOKMARKS`].
    pub fn add_bookmark(&mut self, camera: Camera) -> Result<(), String> {
        if self.bookmarks.len() >= MAX_BOOKMARKS {
            return Err(format!(
                "a preset has at most {MAX_BOOKMARKS} bookmarks; remove one first"
            ));
        }
        let is_free = |name: &String| self.bookmarks.iter().all(|mark| mark.name != *name);
        let mut names = (1..=MAX_BOOKMARKS).map(|number| format!("view {number}"));
        // Of so many names one is free, since there are fewer bookmarks.
        if let Some(name) = names.find(is_free) {
            self.bookmarks.push(Bookmark { name, camera });
        }
        Ok(())
    }

    /// Gives a bookmark another name; one that is not there stays away.
    /// Errors: the name is none for a bookmark, or another bookmark has it: in a sentence.
    pub fn rename_bookmark(&mut self, from: &str, to: &str) -> Result<(), String> {
        check_bookmark_name(to).map_err(|reason| format!("The name of a bookmark {reason}"))?;
        if from != to && self.bookmarks.iter().any(|mark| mark.name == to) {
            return Err(format!("Another bookmark is called {to:?}"));
        }
        for mark in self.bookmarks.iter_mut().filter(|mark| mark.name == from) {
            to.clone_into(&mut mark.name);
        }
        Ok(())
    }

    /// The bookmark after the one where the preset's camera stands; the first where it stands at
    /// none.
    pub fn next_bookmark(&self) -> Option<Camera> {
        let is_here = |mark: &Bookmark| self.camera == Some(mark.camera);
        let next = self
            .bookmarks
            .iter()
            .position(is_here)
            .map_or(0, |at| at + 1);
        let found = self.bookmarks.get(next).or(self.bookmarks.first());
        found.map(|mark| mark.camera)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(preset: &Preset) -> Vec<&str> {
        preset.bookmarks.iter().map(|mark| &*mark.name).collect()
    }

    fn camera(x: f64) -> Camera {
        Camera {
            eye: glam::DVec3::new(x, 0.0, 3.0),
            ..Camera::default()
        }
    }

    #[test]
    fn bookmarks_have_names_of_their_own_and_a_limit() {
        let mut preset = Preset::default();
        for index in 0..MAX_BOOKMARKS {
            preset.add_bookmark(camera(index as f64)).expect("room");
        }
        let limit = preset.add_bookmark(camera(0.0)).expect_err("it is full");
        assert!(limit.contains("64"), "{limit}");
        preset.bookmarks.remove(1);
        preset.add_bookmark(camera(0.5)).expect("room again");
        assert_eq!(preset.bookmarks[63].name, "view 2");

        let taken = preset.rename_bookmark("view 3", "view 1");
        assert!(taken.is_err_and(|error| error.contains("view 1")));
        for name in ["", " left", "a\u{202e}b", &"x".repeat(41)] {
            assert!(preset.rename_bookmark("view 3", name).is_err(), "{name:?}");
        }
        preset
            .rename_bookmark("view 3", "left")
            .expect("a free name");
        assert_eq!(names(&preset)[1], "left");
        let unknown = preset.bookmark("right").expect_err("there is none");
        assert!(unknown.contains("\"view 1\", \"left\""), "{unknown}");
        assert_eq!(preset.bookmark("left"), Ok(camera(2.0)));
    }

    #[test]
    fn the_next_bookmark_goes_round() {
        let mut preset = Preset::default();
        assert_eq!(preset.next_bookmark(), None);
        for x in [1.0, 2.0] {
            preset.add_bookmark(camera(x)).expect("room");
        }
        for x in [1.0, 2.0, 1.0] {
            preset.camera = preset.next_bookmark();
            assert_eq!(preset.camera, Some(camera(x)));
        }
    }
}
