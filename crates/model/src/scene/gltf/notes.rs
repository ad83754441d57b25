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
}

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
        let Lists { notes, faults } = &mut *self.0.borrow_mut();
        if notes.len() < limits::NOTES || faults.is_empty() {
            let message = message().to_string();
            if !faults.contains(&message) {
                notes.push(message.clone());
                faults.push(message);
            }
        }
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
        let Lists { notes, faults } = self.0.into_inner();
        [notes, faults]
    }
}
