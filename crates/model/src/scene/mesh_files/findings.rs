//! What a file may have millions of: each kind is told once, by its first place.

use crate::scene::gltf::notes::Notes;

/// The kinds of messages about a model, in the order of its file.
#[derive(Default)]
pub struct Findings(Vec<Finding>);

struct Finding {
    /// What was done about it.
    remedy: &'static str,
    /// What was found first.
    first: String,
    /// How often it was found again.
    more: u64,
    /// It breaks the format.
    is_fault: bool,
}

impl Findings {
    /// Adds what breaks the format; the sentence is `REASON; REMEDY`.
    pub fn fault(&mut self, remedy: &'static str, reason: impl FnOnce() -> String) {
        self.add(true, remedy, reason);
    }

    /// Adds what is drawn differently.
    pub fn note(&mut self, remedy: &'static str, reason: impl FnOnce() -> String) {
        self.add(false, remedy, reason);
    }

    fn add(&mut self, is_fault: bool, remedy: &'static str, reason: impl FnOnce() -> String) {
        match self.0.iter_mut().find(|known| known.remedy == remedy) {
            Some(known) => known.more += 1,
            None => self.0.push(Finding {
                remedy,
                first: reason(),
                more: 0,
                is_fault,
            }),
        }
    }

    /// Adds a sentence for each kind to the messages of a model.
    pub fn tell(self, notes: &Notes) {
        for finding in self.0 {
            let Finding {
                remedy,
                first,
                more,
                is_fault,
            } = finding;
            let sentence = || match more {
                0 => format!("{first}; {remedy}"),
                _ => format!("{first}; {remedy}, and {more} more like it"),
            };
            match is_fault {
                true => notes.fault(sentence),
                false => notes.add(sentence),
            }
        }
    }
}
