//! Settings and sections of a preset: what they are, and how a preset stores their values.

use std::{ops::Deref, sync::LazyLock};

use super::Preset;
use crate::{
    accuracy::Axis,
    params::{Param, Value, ValueError, ValueType},
};

/// One setting of a preset.
pub struct Setting {
    pub param: Param,
    /// Name of its section; empty for the top of the file.
    pub section: &'static str,
    /// The setting of the same section that says the same in another way; a file has one of them.
    pub alternative: Option<&'static str>,
    pub(super) rule: Option<Rule>,
    pub(super) storage: Storage,
}

/// A condition on a value that a range cannot say; the error completes a sentence that begins with
/// the setting's name.
pub type Rule = fn(&Value) -> Result<(), String>;

/// Where a preset keeps the value of a setting.
#[derive(Clone, Copy)]
pub enum Storage {
    State {
        /// None where the setting does not apply to the preset.
        get: fn(&Preset) -> Option<Value>,
        set: fn(&mut Preset, &Value) -> Result<(), ValueError>,
        /// Removes an optional value; none where the default is a value like any other.
        clear: Option<fn(&mut Preset)>,
    },
    /// A pinned accuracy axis; choice 0 leaves the option to the planner.
    Axis(&'static Axis),
}

impl Deref for Setting {
    type Target = Param;

    fn deref(&self) -> &Param {
        &self.param
    }
}

impl Setting {
    /// `camera.eye`, `name`.
    pub fn path(&self) -> String {
        if self.section.is_empty() {
            self.name.clone()
        } else {
            format!("{}.{}", self.section, self.name)
        }
    }

    /// The value in `preset`; none where the setting does not apply.
    pub fn get(&self, preset: &Preset) -> Option<Value> {
        match self.storage {
            Storage::State { get, .. } => get(preset),
            Storage::Axis(axis) => Some(Value::Choice(
                preset.accuracy.pins.get(axis).map_or(0, |index| index + 1),
            )),
        }
    }

    /// Gives the setting a value.
    /// Errors: the value has another type, lies outside the range or breaks the setting's rule;
    /// then nothing is changed.
    pub fn set(&self, preset: &mut Preset, value: &Value) -> Result<(), ValueError> {
        self.check(value)?;
        match (self.storage, value) {
            (Storage::State { set, .. }, value) => set(preset, value),
            (Storage::Axis(axis), Value::Choice(index)) => {
                preset.accuracy.pins.set(axis, index.checked_sub(1));
                Ok(())
            }
            (Storage::Axis(_), _) => unreachable!("only a choice passes the check of an axis"),
        }
    }

    /// Would [`Setting::set`] take this value?
    pub fn check(&self, value: &Value) -> Result<(), ValueError> {
        self.param.check(value)?;
        self.rule
            .map_or(Ok(()), |rule| rule(value).map_err(ValueError::Rule))
    }

    pub(super) fn new(name: &str, value_type: ValueType, doc: &str, storage: Storage) -> Self {
        Self {
            param: Param::new(name, doc, value_type),
            section: "",
            alternative: None,
            rule: None,
            storage,
        }
    }

    pub(super) fn range(self, low: f64, high: f64) -> Self {
        Self {
            param: self.param.hard(low..=high),
            ..self
        }
    }

    pub(super) fn slider(self, low: f64, high: f64) -> Self {
        Self {
            param: self.param.soft(low..=high),
            ..self
        }
    }

    pub(super) fn unit(self, unit: &str) -> Self {
        Self {
            param: self.param.unit(unit),
            ..self
        }
    }

    pub(super) fn rule(self, rule: Rule) -> Self {
        Self {
            rule: Some(rule),
            ..self
        }
    }

    pub(super) fn or(self, alternative: &'static str) -> Self {
        Self {
            alternative: Some(alternative),
            ..self
        }
    }

    pub(super) fn of_axis(axis: &'static Axis) -> Self {
        Self::new(
            axis.name,
            ValueType::choice(axis.choices),
            axis.about,
            Storage::Axis(axis),
        )
    }
}

/// A table of a preset file with settings; the top of the file has no name.
pub struct Section {
    pub name: &'static str,
    pub doc: &'static str,
    pub settings: LazyLock<Vec<Setting>>,
    /// None for a table that means nothing by being there.
    pub presence: Option<Presence>,
}

/// How a preset says that an optional section is there.
pub struct Presence {
    pub is_present: fn(&Preset) -> bool,
    /// Adds the section with defaults, if it is missing.
    pub add: fn(&mut Preset),
    pub remove: fn(&mut Preset),
}

impl Section {
    pub fn setting(&'static self, name: &str) -> Option<&'static Setting> {
        self.settings.iter().find(|setting| setting.name == name)
    }

    /// Adds the section with defaults, if it is optional and missing.
    pub fn add(&self, preset: &mut Preset) {
        if let Some(presence) = &self.presence {
            (presence.add)(preset);
        }
    }
}
