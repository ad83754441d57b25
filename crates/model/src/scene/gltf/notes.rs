//! Messages to the user about a model. A file can give rise to millions, so only the first are
//! built.

use std::fmt::Display;

use super::limits;

/// The first [`limits::NOTES`] messages.
#[derive(Debug, Default)]
pub struct Notes(Vec<String>);

impl Notes {
    /// Adds a message unless there are enough, or the last one says the same.
    pub fn add<Text: Display>(&mut self, message: impl FnOnce() -> Text) {
        if self.0.len() < limits::NOTES {
            let message = message().to_string();
            if self.0.last() != Some(&message) {
                self.0.push(message);
            }
        }
    }

    /// Adds messages that are built only as far as there is room for them.
    pub fn extend(&mut self, messages: impl IntoIterator<Item = String>) {
        for message in messages {
            if self.0.len() == limits::NOTES {
                break;
            }
            self.0.push(message);
        }
    }

    pub fn into_vec(self) -> Vec<String> {
        self.0
    }
}
