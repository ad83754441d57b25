//! PinnedOptions: the keys that hold an accuracy axis on a option.

use super::{
    form::{Value, ValueType},
    keys::{Key, key},
};
use crate::{
    accuracy::{AXES, AxisOption},
    preset::Preset,
};

/// The key that pins an accuracy axis; its first word leaves the choice to the planner.
pub const fn pin<R: AxisOption>() -> Key {
    let axis = &AXES[R::AXIS];
    key("accuracy", axis.name, ValueType::Word(axis.choices), axis.about, pinned::<R>, set_pin::<R>)
}

fn pinned<R: AxisOption>(preset: &Preset) -> Option<Value> {
    Some(Value::number(preset.accuracy.pins.get(&AXES[R::AXIS]).map_or(0, |place| 1 + place as u32)))
}

fn set_pin<R: AxisOption>(preset: &mut Preset, plain: Value) {
    preset.accuracy.pins.set(&AXES[R::AXIS], (plain.first() as usize).checked_sub(1));
}
