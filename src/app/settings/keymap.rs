//! Shortcuts that the user has bound. An action that is not bound anew keeps the shortcuts of the
//! table of actions.

use std::collections::BTreeMap;

use egui::{Key, KeyboardShortcut, Modifiers};
use serde::{Deserialize, Serialize};

use crate::app::shell::action::{
    ACTIONS, Action, actions, modifiers_text, shortcut_text, show_shortcuts,
};

/// Which keys carry out which action.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(
    try_from = "BTreeMap<String, Vec<String>>",
    into = "BTreeMap<String, Vec<String>>"
)]
pub struct Keymap {
    /// The actions that were bound anew, with all of their shortcuts; none where the user took
    /// them away.
    bound: Vec<(Action, Vec<KeyboardShortcut>)>,
}

/// Keys that the window needs for itself.
const RESERVED: [Key; 3] = [Key::Escape, Key::Tab, Key::Enter];

impl Keymap {
    /// Makes texts on this thread name these shortcuts.
    pub fn show(&self) {
        show_shortcuts(
            self.bound
                .iter()
                .map(|(action, shortcuts)| (*action, shortcuts.first().copied()))
                .collect(),
        );
    }

    /// The shortcuts of `action`.
    pub fn of(&self, action: Action) -> &[KeyboardShortcut] {
        let bound = self.bound.iter().find(|(bound, _)| *bound == action);
        bound.map_or(action.default_shortcuts(), |(_, shortcuts)| shortcuts)
    }

    /// Has the user bound it?
    pub fn is_bound(&self, action: Action) -> bool {
        self.bound.iter().any(|(bound, _)| *bound == action)
    }

    /// The action of a pressed key. A shortcut with exactly these modifiers comes before one that
    /// leaves Shift open, such as `?`, which some keyboards type with Shift.
    pub fn action_of(
        &self,
        key: Key,
        modifiers: Modifiers,
        is_allowed: impl Fn(&KeyboardShortcut) -> bool,
    ) -> Option<Action> {
        let find = |matches: &dyn Fn(Modifiers) -> bool| {
            let pressed = |shortcut: &KeyboardShortcut| {
                shortcut.logical_key == key && matches(shortcut.modifiers) && is_allowed(shortcut)
            };
            actions()
                .map(|(action, ..)| *action)
                .find(|action| self.of(*action).iter().any(pressed))
        };
        find(&|pattern| modifiers.matches_exact(pattern))
            .or_else(|| find(&|pattern| modifiers.matches_logically(pattern)))
    }

    /// The action that has this shortcut.
    pub fn owner(&self, shortcut: &KeyboardShortcut) -> Option<Action> {
        ACTIONS
            .iter()
            .map(|(action, ..)| *action)
            .find(|action| self.of(*action).contains(shortcut))
    }

    /// Makes `shortcut` the only one of `action`.
    ///
    /// # Errors
    /// Another action has it, or the window needs it: why, in words.
    pub fn bind(&mut self, action: Action, shortcut: KeyboardShortcut) -> Result<(), String> {
        self.check(action, &shortcut)?;
        self.set(action, vec![shortcut]);
        Ok(())
    }

    /// Leaves `action` without a shortcut.
    pub fn clear(&mut self, action: Action) {
        self.set(action, Vec::new());
    }

    /// Gives `action` the shortcuts of the table again.
    ///
    /// # Errors
    /// Another action was bound to one of them.
    pub fn reset(&mut self, action: Action) -> Result<(), String> {
        action
            .default_shortcuts()
            .iter()
            .try_for_each(|shortcut| self.check(action, shortcut))?;
        self.bound.retain(|(bound, _)| *bound != action);
        Ok(())
    }

    /// Forgets everything that was bound.
    pub fn reset_all(&mut self) {
        self.bound.clear();
    }

    fn set(&mut self, action: Action, shortcuts: Vec<KeyboardShortcut>) {
        self.bound.retain(|(bound, _)| *bound != action);
        if shortcuts != action.default_shortcuts() {
            self.bound.push((action, shortcuts));
        }
    }

    fn check(&self, action: Action, shortcut: &KeyboardShortcut) -> Result<(), String> {
        let text = shortcut_text(shortcut);
        let is_clipboard =
            shortcut.modifiers.command && matches!(shortcut.logical_key, Key::C | Key::V | Key::X);
        if is_clipboard || RESERVED.contains(&shortcut.logical_key) {
            return Err(format!(
                "{text} is used by the window itself. Press another key for {:?}.",
                action.label()
            ));
        }
        match self.owner(shortcut).filter(|owner| *owner != action) {
            Some(owner) => Err(format!(
                "{text} belongs to {:?}. Give that another key first, or press another key.",
                owner.label()
            )),
            None => Ok(()),
        }
    }
}

/// Binds the keys of all actions of a settings file. An action gives its keys up first, so that two
/// can exchange theirs.
impl TryFrom<BTreeMap<String, Vec<String>>> for Keymap {
    type Error = String;

    fn try_from(written: BTreeMap<String, Vec<String>>) -> Result<Self, String> {
        let (mut keys, mut stated) = (Self::default(), Vec::new());
        for (id, texts) in &written {
            let action = Action::of_id(id).ok_or("it is no action")?;
            let shortcuts: Option<Vec<KeyboardShortcut>> =
                texts.iter().map(|text| parse(text)).collect();
            keys.clear(action);
            stated.push((
                action,
                shortcuts
                    .ok_or("it takes a list of shortcuts such as \"Ctrl+Shift+Z\" or \"F5\"")?,
            ));
        }
        for (action, shortcuts) in stated {
            shortcuts
                .iter()
                .try_for_each(|shortcut| keys.check(action, shortcut))?;
            keys.set(action, shortcuts);
        }
        Ok(keys)
    }
}

impl From<Keymap> for BTreeMap<String, Vec<String>> {
    fn from(keys: Keymap) -> Self {
        keys.bound
            .iter()
            .map(|(action, shortcuts)| (action.id(), shortcuts.iter().map(written).collect()))
            .collect()
    }
}

/// A shortcut as the settings file has it: `Ctrl+Shift+Z`, with the names of keys rather than their
/// signs.
pub fn written(shortcut: &KeyboardShortcut) -> String {
    format!(
        "{}{}",
        modifiers_text(shortcut.modifiers),
        shortcut.logical_key.name()
    )
}

/// The shortcut that `text` names; none if it names no key.
pub fn parse(text: &str) -> Option<KeyboardShortcut> {
    let (mut rest, mut modifiers) = (text.trim(), Modifiers::NONE);
    while let Some((name, key)) = rest
        .split_once('+')
        .filter(|(name, key)| !name.is_empty() && !key.is_empty())
    {
        match name.trim().to_ascii_lowercase().as_str() {
            "ctrl" | "cmd" | "command" => modifiers.command = true,
            "shift" => modifiers.shift = true,
            "alt" => modifiers.alt = true,
            _ => return None,
        }
        rest = key.trim();
    }
    let key = Key::from_name(rest).or_else(|| Key::from_name(&rest.to_ascii_uppercase()))?;
    Some(KeyboardShortcut::new(modifiers, key))
}

/// The shortcut of a key press.
pub fn pressed(key: Key, modifiers: Modifiers) -> KeyboardShortcut {
    let Modifiers {
        alt,
        shift,
        command,
        ..
    } = modifiers;
    KeyboardShortcut::new(
        Modifiers {
            alt,
            shift,
            command,
            ..Modifiers::NONE
        },
        key,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn any(_: &KeyboardShortcut) -> bool {
        true
    }

    /// Modifiers as a keyboard without a Mac sends them.
    const CTRL: Modifiers = Modifiers {
        ctrl: true,
        ..Modifiers::COMMAND
    };

    #[test]
    fn a_bound_key_carries_out_its_action_and_the_old_one_no_longer() {
        let mut keys = Keymap::default();
        assert_eq!(
            keys.action_of(Key::R, Modifiers::NONE, any),
            Some(Action::Randomize)
        );
        keys.bind(Action::Randomize, pressed(Key::J, Modifiers::NONE))
            .expect("J is free");
        assert_eq!(
            keys.action_of(Key::J, Modifiers::NONE, any),
            Some(Action::Randomize)
        );
        assert_eq!(keys.action_of(Key::R, Modifiers::NONE, any), None);
        keys.show();
        assert_eq!(
            [
                Action::Randomize.shortcut_text(),
                Action::Verify.shortcut_text()
            ],
            ["J", "V"]
        );
        keys.reset(Action::Randomize).expect("R is free");
        assert_eq!(
            (keys.action_of(Key::R, Modifiers::NONE, any), keys),
            (Some(Action::Randomize), Keymap::default())
        );
    }

    #[test]
    fn a_key_of_another_action_is_refused_with_its_name() {
        let mut keys = Keymap::default();
        let refused = keys
            .bind(Action::Randomize, pressed(Key::S, CTRL))
            .expect_err("Ctrl+S saves");
        assert!(
            refused.contains("\"Save\"") && refused.starts_with(&modifiers_text(CTRL)),
            "{refused}"
        );
        assert_eq!(keys, Keymap::default());
        keys.clear(Action::Save);
        keys.bind(Action::Randomize, pressed(Key::S, CTRL))
            .expect("Ctrl+S is free now");
        let refused = keys.reset(Action::Save).expect_err("Ctrl+S randomizes");
        assert!(refused.contains("Randomize"), "{refused}");
        keys.reset_all();
        assert_eq!(keys.action_of(Key::S, CTRL, any), Some(Action::Save));
    }

    #[test]
    fn keys_of_the_window_itself_are_refused() {
        let mut keys = Keymap::default();
        for shortcut in [
            pressed(Key::Escape, Modifiers::NONE),
            pressed(Key::C, CTRL),
            pressed(Key::Tab, Modifiers::SHIFT),
        ] {
            assert!(
                keys.bind(Action::Verify, shortcut)
                    .is_err_and(|refused| refused.contains("window itself")),
                "{shortcut:?}"
            );
        }
    }

    #[test]
    fn exact_modifiers_come_first_and_shift_may_be_part_of_a_sign() {
        let keys = Keymap::default();
        let shifted = Modifiers {
            shift: true,
            ..CTRL
        };
        assert_eq!(keys.action_of(Key::Z, shifted, any), Some(Action::Redo));
        assert_eq!(keys.action_of(Key::Z, CTRL, any), Some(Action::Undo));
        assert_eq!(
            keys.action_of(Key::Questionmark, Modifiers::SHIFT, any),
            Some(Action::CheatSheet)
        );
        assert_eq!(
            keys.action_of(Key::Num0, CTRL, any),
            Some(Action::ScaleReset)
        );
        assert_eq!(
            keys.action_of(Key::Num0, Modifiers::NONE, any),
            Some(Action::Rewind)
        );
    }

    #[test]
    fn every_shortcut_of_the_table_is_read_back_as_it_was_written() {
        for shortcut in ACTIONS.iter().flat_map(|(_, _, shortcuts)| *shortcuts) {
            assert_eq!(
                parse(&written(shortcut)),
                Some(*shortcut),
                "{}",
                written(shortcut)
            );
        }
        assert_eq!(parse("ctrl + shift + z"), parse("Ctrl+Shift+Z"));
        assert_eq!(
            parse("Ctrl++").map(|shortcut| shortcut.logical_key),
            Some(Key::Plus)
        );
        assert_eq!([parse("Hyper+Z"), parse("nokey"), parse("")], [None; 3]);
    }
}
