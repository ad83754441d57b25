//! The review of goldens: presets whose picture differs from their golden wait in a queue, to be
//! accepted or rejected. The oracle draws them, one after another, beside the window.

use std::{collections::VecDeque, sync::Arc};

use serde::{Deserialize, Serialize};

#[cfg(not(target_arch = "wasm32"))]
pub use native::{bless, draw};

/// The oracle's picture of a preset, beside its golden. A page has none.
#[cfg_attr(target_arch = "wasm32", allow(dead_code))]
#[derive(Debug, PartialEq)]
pub struct Drawn {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// None if the golden is missing, cannot be read, or has another size.
    pub golden: Option<Vec<[u8; 4]>>,
    pub now: Vec<[u8; 4]>,
    /// The file that accepting writes.
    pub png: Vec<u8>,
    /// How both differ, in words.
    pub text: String,
}

/// A preset of the queue.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its file, or the id of a built-in one.
    pub name: String,
    pub is_rejected: bool,
    /// Why it cannot be drawn is a sentence; none until it was drawn in this run of the window.
    pub drawn: Option<Result<Arc<Drawn>, String>>,
}

impl Entry {
    fn new(name: String, is_rejected: bool) -> Self {
        Self {
            name,
            is_rejected,
            drawn: None,
        }
    }
}

/// The queue as the session keeps it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptReview {
    waiting: Vec<String>,
    rejected: Vec<String>,
}

impl KeptReview {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Presets whose picture differs from its golden, and those that are still to be drawn.
#[derive(Default)]
pub struct Review {
    entries: Vec<Entry>,
    shown: usize,
    to_draw: VecDeque<String>,
    /// Presets that were to be drawn when it began.
    planned: usize,
    /// The preset that the oracle draws now.
    drawing: Option<String>,
    /// The preset whose golden is written now.
    blessing: Option<String>,
}

impl From<KeptReview> for Review {
    fn from(kept: KeptReview) -> Self {
        let entry = |is_rejected| move |name| Entry::new(name, is_rejected);
        let rejected = kept.rejected.into_iter().map(entry(true));
        Self {
            entries: kept
                .waiting
                .into_iter()
                .map(entry(false))
                .chain(rejected)
                .collect(),
            ..Self::default()
        }
    }
}

impl Review {
    /// What comes back at the next start.
    pub fn kept(&self) -> KeptReview {
        let names = |is_rejected| {
            let of_kind = self.entries.iter();
            of_kind
                .filter(|entry| entry.is_rejected == is_rejected)
                .map(|entry| entry.name.clone())
                .collect()
        };
        KeptReview {
            waiting: names(false),
            rejected: names(true),
        }
    }

    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Index of the entry that is shown.
    pub fn shown(&self) -> usize {
        self.shown
    }

    pub fn shown_entry(&self) -> Option<&Entry> {
        self.entries.get(self.shown)
    }

    /// How many of how many presets were drawn; none when all are.
    pub fn progress(&self) -> Option<[usize; 2]> {
        (!self.to_draw.is_empty()).then(|| [self.planned - self.to_draw.len(), self.planned])
    }

    /// Has it looked at every preset since the window began?
    pub fn is_complete(&self) -> bool {
        self.planned > 0 && self.to_draw.is_empty() && self.drawing.is_none()
    }

    /// Draws these presets. Those of the queue are drawn again, too.
    pub fn begin(&mut self, names: Vec<String>) {
        for entry in &mut self.entries {
            entry.drawn = None;
        }
        self.planned = names.len();
        self.to_draw = names.into();
    }

    pub fn stop(&mut self) {
        self.to_draw.clear();
    }

    pub fn show(&mut self, index: usize) {
        self.shown = index.min(self.entries.len().saturating_sub(1));
    }

    /// Shows the next entry that is not rejected, behind the last the first.
    pub fn next(&mut self) {
        let count = self.entries.len();
        let next = (1..=count)
            .map(|step| (self.shown + step) % count)
            .find(|index| !self.entries[*index].is_rejected);
        self.show(next.unwrap_or(self.shown));
    }

    /// Marks the shown entry as wrong, and shows the next.
    pub fn reject(&mut self) {
        if let Some(entry) = self.entries.get_mut(self.shown) {
            entry.is_rejected = true;
            self.next();
        }
    }

    /// The shown preset with the picture that is to become its golden; none while another is
    /// written, or before it was drawn.
    pub fn accept(&mut self) -> Option<(String, Arc<Drawn>)> {
        let entry = self.entries.get(self.shown)?;
        let Some(Ok(drawn)) = &entry.drawn else {
            return None;
        };
        let accepted = (entry.name.clone(), drawn.clone());
        self.blessing
            .is_none()
            .then(|| self.blessing.insert(accepted.0.clone()))?;
        Some(accepted)
    }

    /// The golden of a preset was written: it leaves the queue. Otherwise it is drawn again.
    pub fn blessed(&mut self, name: &str, is_written: bool) {
        self.blessing = None;
        let Some(index) = self.entries.iter().position(|entry| entry.name == name) else {
            return;
        };
        if is_written {
            self.remove(index);
        } else {
            self.entries[index].drawn = None;
        }
    }

    /// The preset that the oracle shall draw next, if it draws none: the one that is shown, or one
    /// that has not been drawn.
    pub fn next_to_draw(&mut self) -> Option<String> {
        if self.drawing.is_some() {
            return None;
        }
        let shown = self
            .entries
            .get(self.shown)
            .filter(|entry| entry.drawn.is_none());
        let next = match shown {
            Some(entry) => {
                let name = entry.name.clone();
                self.to_draw.retain(|other| *other != name);
                name
            }
            None => self.to_draw.pop_front()?,
        };
        Some(self.drawing.insert(next).clone())
    }

    /// A preset was drawn; none if its picture is the golden.
    pub fn drawn(&mut self, name: &str, drawn: Result<Option<Arc<Drawn>>, String>) {
        self.drawing = None;
        let index = self.entries.iter().position(|entry| entry.name == name);
        match (drawn.transpose(), index) {
            (None, Some(index)) => self.remove(index),
            (None, None) => {}
            (drawn, Some(index)) => self.entries[index].drawn = drawn,
            (drawn, None) => self.entries.push(Entry {
                drawn,
                ..Entry::new(name.to_owned(), false)
            }),
        }
    }

    fn remove(&mut self, index: usize) {
        self.entries.remove(index);
        if index < self.shown {
            self.shown -= 1;
        }
        self.show(self.shown);
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::sync::Arc;

    use super::Drawn;
    use crate::{
        golden::{self, Change, Golden},
        preset_file::{self, Folders, PresetFile, golden_folder},
    };

    fn golden_of(name: &str, folders: &Folders) -> Result<(PresetFile, Golden), String> {
        let preset_file = preset_file::open(name, folders).map_err(|error| error.to_string())?;
        let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
            .map_err(|error| format!("{}: {error}", preset_file.id))?;
        let golden = golden::draw(&preset_file, &scene)?;
        Ok((preset_file, golden))
    }

    /// Draws a preset and compares it with its golden; none if no pixel differs.
    pub fn draw(name: &str, folders: &Folders) -> Result<Option<Arc<Drawn>>, String> {
        let (preset_file, golden) = golden_of(name, folders)?;
        let size = preset_file.preset.output.size;
        let change = Change::of(&golden, &golden_folder(&preset_file), &preset_file.id);
        if change.has_same_picture() {
            return Ok(None);
        }
        let text = match (&change.delta, &change.stored) {
            (Some(delta), _) => golden::difference_text(delta, size),
            (None, Some((_, [width, height]))) => {
                format!("the golden has {width}x{height} pixels")
            }
            (None, None) => "there is no golden that can be read".into(),
        };
        let stored = change.stored.filter(|_| change.delta.is_some());
        Ok(Some(Arc::new(Drawn {
            size,
            golden: stored.map(|(color, _)| color),
            now: golden.frame.color,
            png: golden.png,
            text,
        })))
    }

    /// Makes the oracle's picture of a preset its golden, if it is still the one that was shown.
    pub fn bless(name: &str, folders: &Folders, shown: &Drawn) -> Result<(), String> {
        let (preset_file, golden) = golden_of(name, folders)?;
        if golden.png != shown.png {
            return Err(format!(
                "{}: its picture has changed since it was shown, so it was not accepted; look at it again",
                preset_file.id
            ));
        }
        golden::store(&golden, &golden_folder(&preset_file), &preset_file.id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(text: &str) -> Result<Option<Arc<Drawn>>, String> {
        Ok(Some(Arc::new(Drawn {
            size: [1, 1],
            golden: None,
            now: vec![[0; 4]],
            png: Vec::new(),
            text: text.into(),
        })))
    }

    fn names(review: &Review) -> Vec<&str> {
        let entries = review.entries().iter();
        entries.map(|entry| entry.name.as_str()).collect()
    }

    #[test]
    fn the_queue_keeps_what_differs_and_comes_back_as_it_was() {
        let mut review = Review::default();
        review.begin(["a", "b", "c", "d"].map(str::to_owned).to_vec());
        assert_eq!(review.progress(), Some([0, 4]));
        for (name, result) in [
            ("a", drawn("1 pixel")),
            ("b", Ok(None)),
            ("c", Err("no scene".into())),
            ("d", drawn("2 pixels")),
        ] {
            assert_eq!(review.next_to_draw().as_deref(), Some(name));
            assert_eq!(review.next_to_draw(), None, "one at a time");
            review.drawn(name, result);
        }
        assert!(review.is_complete());
        assert_eq!(names(&review), ["a", "c", "d"]);
        review.reject();
        assert_eq!(review.shown_entry().map(|e| e.name.as_str()), Some("c"));
        assert!(review.accept().is_none(), "it was not drawn");
        review.next();
        let (name, _) = review.accept().expect("it was drawn");
        assert!(review.accept().is_none(), "one at a time");
        review.blessed(&name, true);
        assert_eq!(names(&review), ["a", "c"]);

        let mut again = Review::from(review.kept());
        assert_eq!(
            (names(&again), again.kept()),
            (vec!["c", "a"], review.kept())
        );
        assert!(again.entries()[1].is_rejected);
        // The one that is shown is drawn; of the others only the names are known.
        assert_eq!(again.next_to_draw().as_deref(), Some("c"));
        again.drawn("c", Ok(None));
        assert_eq!(names(&again), ["a"]);
        again.next();
        assert_eq!(again.shown(), 0);
    }
}
