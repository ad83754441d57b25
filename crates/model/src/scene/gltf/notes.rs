//! Messages to the user about a model. A file can give rise to millions, so only the first are
//! built.

use std::{cell::RefCell, fmt::Display};

use super::limits;

/// The first [`limits::NOTES`] messages, each once, and which of them are faults.
#[derive(Debug, Default)]
pub struct Notes(RefCell<Lists>);

#[derive(Debug, Default)]
struct Lists {
    /// All messages.
    notes: Vec<String>,
    /// Those that say how the file breaks its standard.
    faults: Vec<String>,
    /// What says that bytes at the end are missing, and how many faults follow from that alone.
    cut: Option<(String, u64)>,
}

/// What messages say about bytes that a buffer does not have.
const BEHIND: [&str; 2] = [" exceeds buffer ", " exceed buffer "];

impl Notes {
    /// Adds a message about what is drawn differently, while there is room.
    pub fn add<Text: Display>(&self, message: impl FnOnce() -> Text) {
        let Lists { notes, .. } = &mut *self.0.borrow_mut();
        if notes.len() < limits::NOTES {
            let message = message().to_string();
            if !notes.contains(&message) {
                notes.push(message);
            }
        }
    }

    /// Adds a message about how the file breaks its standard. There is always room for one.
    pub fn fault<Text: Display>(&self, message: impl FnOnce() -> Text) {
        let Lists { notes, faults, cut } = &mut *self.0.borrow_mut();
        if notes.len() < limits::NOTES || faults.is_empty() || cut.is_some() {
            let message = message().to_string();
            if let Some((_, lost)) = cut
                && BEHIND.iter().any(|words| message.contains(words))
            {
                *lost += 1;
            } else if !faults.contains(&message) {
                notes.push(message.clone());
                faults.push(message);
            }
        }
    }

    /// Adds the fault that bytes at the end are missing. Faults that follow from it are counted, not
    /// told.
    pub fn cut_off(&self, sentence: String) {
        if !self.is_cut_off() {
            self.fault(|| &sentence);
            self.0.borrow_mut().cut = Some((sentence, 0));
        }
    }

    /// Are bytes at the end missing?
    pub fn is_cut_off(&self) -> bool {
        self.0.borrow().cut.is_some()
    }

    /// Adds a fault unless one tells `reason` already.
    pub fn fault_once<Text: Display>(&self, reason: &str, message: impl FnOnce() -> Text) {
        let is_told = |fault: &String| fault.contains(reason);
        if !self.0.borrow().faults.iter().any(is_told) {
            self.fault(message);
        }
    }

    /// Adds messages that are built only as far as there is room for them.
    pub fn extend(&self, messages: impl IntoIterator<Item = String>) {
        for message in messages {
            if self.0.borrow().notes.len() >= limits::NOTES {
                break;
            }
            self.add(|| message);
        }
    }

    /// The first fault.
    pub fn first_fault(&self) -> Option<String> {
        self.0.borrow().faults.first().cloned()
    }

    /// All messages, and those of them that are faults.
    pub fn into_lists(self) -> [Vec<String>; 2] {
        let Lists { notes, faults, cut } = self.0.into_inner();
        let counted = |message: String| match &cut {
            Some((sentence, lost @ 1..)) if *sentence == message => {
                let parts = if *lost == 1 {
                    "part that needs them is"
                } else {
                    "parts that need them are"
                };
                format!("{sentence}; {lost} {parts} left out")
            }
            _ => message,
        };
        [notes, faults].map(|list| list.into_iter().map(counted).collect())
    }
}
