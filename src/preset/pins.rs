//! Pins: the keys that hold an axis of the ladder on a rung.

use super::{
    form::{Form, Plain},
    keys::{Key, key},
};
use crate::{
    ladder::{AXES, Rung},
    session::Session,
};

/// The key that pins an axis of the ladder; its first word leaves the choice to the planner.
pub const fn pin<R: Rung>() -> Key {
    let axis = &AXES[R::AXIS];
    key("accuracy", axis.name, Form::Word(axis.choices), axis.about, pinned::<R>, set_pin::<R>)
}

fn pinned<R: Rung>(session: &Session) -> Option<Plain> {
    Some(Plain::number(session.accuracy.pins.get(&AXES[R::AXIS]).map_or(0, |place| 1 + place as u32)))
}

fn set_pin<R: Rung>(session: &mut Session, plain: Plain) {
    session.accuracy.pins.set(&AXES[R::AXIS], (plain.first() as usize).checked_sub(1));
}
