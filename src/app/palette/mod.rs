//! The command palette without its window: its entries, which of them answer what is typed, and
//! what they do.

mod entries;
mod entry;
mod rank;

pub use self::{
    entries::entries,
    entry::{Choice, Entry, perform},
    rank::{MAX_LISTED, rank},
};
