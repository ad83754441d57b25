//! Thumbnails of presets: which are drawn, which are to be drawn, and which has to be drawn again.
//! Only what is in view is drawn.

use std::collections::{HashMap, HashSet};

use egui::{self, TextureHandle};

use crate::app::picture::effect_picture;

/// How large a thumbnail is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Size {
    /// For a row of the list.
    Small,
    /// For a tile of the grid.
    Large,
}

impl Size {
    /// Width and height, pixels.
    pub const fn pixels(self) -> [u32; 2] {
        match self {
            Self::Small => effect_picture::THUMBNAIL,
            Self::Large => effect_picture::LARGE_THUMBNAIL,
        }
    }
}

type Key = (String, Size);

/// The thumbnails of the gallery.
#[derive(Default)]
pub struct Thumbnails {
    drawn: HashMap<Key, TextureHandle>,
    /// Those that cannot be drawn.
    failed: HashSet<Key>,
    /// Those that show an earlier state of their preset.
    stale: HashSet<Key>,
    /// Those in view that are still to be drawn.
    wanted: Vec<Key>,
    drawing: Option<Key>,
    /// What is being drawn shows an earlier state.
    outdated: bool,
}

impl Thumbnails {
    /// The gallery is about to be shown: what is in view is told anew.
    pub fn begin_frame(&mut self) {
        self.wanted.clear();
    }

    /// The thumbnail of the preset `id`, or that of the other size while this one is to be drawn.
    pub fn picture(&mut self, id: &str, size: Size, is_in_view: bool) -> Option<&TextureHandle> {
        let key = (id.to_owned(), size);
        let is_drawn = self.drawn.contains_key(&key) && !self.stale.contains(&key);
        if is_in_view
            && !is_drawn
            && !self.failed.contains(&key)
            && self.drawing.as_ref() != Some(&key)
        {
            self.wanted.push(key.clone());
        }
        let other = (
            key.0.clone(),
            if size == Size::Small {
                Size::Large
            } else {
                Size::Small
            },
        );
        self.drawn.get(&key).or_else(|| self.drawn.get(&other))
    }

    /// The preset `id` is another one now.
    pub fn changed(&mut self, id: &str) {
        self.outdated |= self
            .drawing
            .as_ref()
            .is_some_and(|(drawing, _)| drawing == id);
        for key in [Size::Small, Size::Large].map(|size| (id.to_owned(), size)) {
            self.failed.remove(&key);
            self.stale.insert(key);
        }
    }

    /// Everything shows another scene now.
    pub fn all_changed(&mut self) {
        self.failed.clear();
        self.stale.extend(self.drawn.keys().cloned());
        // What is being drawn shows the scene before.
        self.stale.extend(self.drawing.clone());
        self.outdated = self.drawing.is_some();
    }

    /// What was being drawn was given up: it may be wanted again.
    pub fn abandoned(&mut self, id: &str) {
        self.drawing.take_if(|(drawing, _)| drawing == id);
        self.outdated = false;
    }

    /// What is drawn next; none while one is being drawn.
    pub fn next(&mut self) -> Option<(String, Size)> {
        if self.drawing.is_some() || self.wanted.is_empty() {
            return None;
        }
        let next = self.wanted.remove(0);
        self.drawing = Some(next.clone());
        Some(next)
    }

    /// Takes the picture that was drawn; none if it cannot be drawn.
    pub fn take_picture(&mut self, ctx: &egui::Context, id: &str, image: Option<egui::ColorImage>) {
        let Some(key) = self.drawing.take_if(|(drawing, _)| drawing == id) else {
            return;
        };
        if std::mem::take(&mut self.outdated) {
            return;
        }
        self.stale.remove(&key);
        match image {
            Some(image) => {
                let texture =
                    ctx.load_texture(format!("preset {id}"), image, egui::TextureOptions::LINEAR);
                self.drawn.insert(key, texture);
            }
            None => drop(self.failed.insert(key)),
        }
    }

    /// Is one being drawn?
    pub fn is_drawing(&self) -> bool {
        self.drawing.is_some()
    }

    /// Can the thumbnail not be drawn?
    pub fn has_failed(&self, id: &str, size: Size) -> bool {
        self.failed.contains(&(id.to_owned(), size))
    }

    /// True while a thumbnail in view is still to come.
    pub fn is_busy(&self) -> bool {
        self.drawing.is_some() || !self.wanted.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Option<egui::ColorImage> {
        Some(egui::ColorImage::filled([2, 2], egui::Color32::WHITE))
    }

    #[test]
    fn only_what_is_in_view_is_drawn_one_at_a_time_and_once() {
        let (ctx, mut thumbnails) = (egui::Context::default(), Thumbnails::default());
        thumbnails.begin_frame();
        assert!(
            thumbnails.picture("a", Size::Small, true).is_none()
                && thumbnails.picture("b", Size::Small, false).is_none()
        );
        thumbnails.picture("c", Size::Small, true);
        assert_eq!(thumbnails.next(), Some(("a".into(), Size::Small)));
        assert_eq!(thumbnails.next(), None, "one at a time");
        thumbnails.take_picture(&ctx, "a", image());
        assert_eq!(thumbnails.next(), Some(("c".into(), Size::Small)));
        thumbnails.take_picture(&ctx, "c", None);
        assert!(!thumbnails.is_busy());
        thumbnails.begin_frame();
        assert!(
            thumbnails.picture("a", Size::Small, true).is_some()
                && thumbnails.picture("c", Size::Small, true).is_none()
        );
        assert!(
            !thumbnails.is_busy(),
            "what is drawn or cannot be drawn is not drawn again"
        );
        assert!(
            thumbnails.picture("a", Size::Large, true).is_some(),
            "the small one until the large one is there"
        );
        assert_eq!(thumbnails.next(), Some(("a".into(), Size::Large)));
    }

    #[test]
    fn a_changed_preset_shows_its_old_picture_until_the_new_one_is_there() {
        let (ctx, mut thumbnails) = (egui::Context::default(), Thumbnails::default());
        thumbnails.picture("a", Size::Small, true);
        thumbnails.next();
        thumbnails.take_picture(&ctx, "a", image());
        thumbnails.changed("a");
        assert!(thumbnails.picture("a", Size::Small, true).is_some());
        assert_eq!(thumbnails.next(), Some(("a".into(), Size::Small)));
        // One that was scrolled away while it waited is not drawn.
        thumbnails.take_picture(&ctx, "a", image());
        thumbnails.picture("b", Size::Small, true);
        thumbnails.begin_frame();
        assert_eq!(thumbnails.next(), None);
    }
}
