//! The list of effects.

use std::sync::{Arc, LazyLock};

use super::effect::Effect;

macro_rules! list {
    ($($name:ident),* $(,)?) => {
        /// Every effect, in the order in which a preset without a `stack` setting applies them.
        pub static EFFECTS: LazyLock<Vec<Arc<Effect>>> = LazyLock::new(|| vec![$((*super::$name::EFFECT).clone()),*]);
    };
}

for_each_effect!(list);

impl Effect {
    /// The effect called `name`.
    pub fn find(name: &str) -> Option<&'static Arc<Self>> {
        EFFECTS.iter().find(|effect| effect.name == name)
    }

    /// Index in [`EFFECTS`]; an effect of a file comes after all of them.
    pub fn rank(&self) -> usize {
        let original = self.base.as_deref().unwrap_or(self);
        EFFECTS
            .iter()
            .position(|effect| **effect == *original)
            .unwrap_or(EFFECTS.len())
    }
}
