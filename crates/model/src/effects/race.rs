//! Race: what goes wrong without atomics, live: load the depth, compare, store depth and triangle
//! id.
//!
//! Two invocations that meet on a pixel both see the old depth, and the last store remains, near or
//! far. The true picture is the one without the race; the oracle draws that, and the judge counts
//! the pixels that were lost.

use super::{BuiltIn, Effect, hooks::Slot};
use crate::params;

params! {
    pub struct Race {
        /// Idle work between the look at the depth and the store, each step twice the one before: the longer, the more is lost.
        delay: u32 = 0, hard 0.0..=4.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Race>(
        "race",
        "Race",
        "stores depth and triangle id without atomics: wrong, and not twice the same",
    )
    .in_slot(Slot::Visibility)
    .repeatable_if(|_| false)
    .into()
});
